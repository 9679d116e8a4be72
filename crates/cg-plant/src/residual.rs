//! What the equations of a vehicle leave out, as its own nonlinear plant shows it.
//!
//! The plant has the numbers of the vehicle file and perfect sensors. It makes rounded steps and drives with payloads
//! over the whole range, and each identified DC ratio is compared with that of the equations at the true height:
//!
//! ```text
//!     m = ln(identified ratio / ratio of the equations)
//! ```
//!
//! A misfit that is the same in all runs is a gain, which `[uncertainty]` describes and a calibration removes. The rest
//! differs from run to run. Its variance, less what an interval has for the identification, measured springs and tires
//! in turns, is that of the part of `residual_sd` which the plant knows. The rest of `residual_sd` is for what neither plant
//! nor equations contain.

use cg_core::{Channel, Design};
use cg_logs::calibrate::{KnownLoad, KnownLog, run};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::{Misfit, Run, misfits};
use cg_vehicle::design::RatioDesign;
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;
use cg_vehicle::steady_turn::steady_turn_threshold_g;
use cg_vehicle::{Load, Variant, Vehicle};
use rayon::prelude::*;

use crate::maneuver::Maneuver;
use crate::simulate::{LogSimulation, Plant, Scenario};

/// Payloads beside the empty trailer, kg.
const PAYLOADS_KG: [f64; 5] = [5e3, 10e3, 15e3, 20e3, 25e3];
/// Heights of the payload's own c.g. above the floor, m.
const ABOVE_FLOOR_M: [f64; 2] = [0.25, 0.75];
/// Lateral accelerations of usual turns, in g. Those of drives vary within them.
const LATERAL_G: [f64; 3] = [0.08, 0.13, 0.18];
/// Turns above this share of the rollover threshold are not usual, and an estimate says so.
const USUAL_SHARE: f64 = 0.5;
const MANEUVERS: [Maneuver; 2] = [Maneuver::RoundedStep, Maneuver::Drive];
const RATE_HZ: f64 = 50.0;
const DRIVE_S: f64 = 60.0;
/// Greatest share by which the speed of a drive changes.
const SPEED_CHANGE: f64 = 0.3;

/// The residual of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChannelResidual {
    /// The channel.
    pub channel: Channel,
    /// Mean misfit, a gain.
    pub mean: f64,
    /// Standard deviation of the rest.
    pub spread: f64,
    /// What an interval has for it without a residual.
    pub explained: f64,
}

/// What the equations of a vehicle leave out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelResidual {
    /// Number of runs.
    pub runs: usize,
    /// The channels of the roll angle.
    pub channels: Vec<ChannelResidual>,
}

impl ModelResidual {
    /// What `residual_sd` of the vehicle file should be at least: the root mean square over the channels.
    #[allow(clippy::cast_precision_loss)] // a few
    pub fn residual_sd(&self) -> f64 {
        let left = |one: &ChannelResidual| one.spread * one.spread - one.explained * one.explained;
        let sum: f64 = self.channels.iter().map(|one| left(one).max(0.0)).sum();
        libm::sqrt(sum / self.channels.len() as f64)
    }
}

/// Computes what the equations of a vehicle leave out.
///
/// # Errors
/// [`VehicleError`] if the vehicle has no design, or if the plant cannot be computed.
pub fn model_residual(vehicle: &Vehicle) -> Result<ModelResidual, VehicleError> {
    let variant = Variant::Complete;
    let design = RatioDesign::new(vehicle, variant, &Belief::prior(vehicle))?;
    let designs: Vec<(Load, Design<f64>)> = (loads(vehicle).into_iter())
        .map(|load| Ok((load, design.at_height(load.cg_height_m)?)))
        .collect::<Result<_, VehicleError>>()?;
    let mut turns = Vec::new();
    for &(load, ref design) in &designs {
        let threshold_g = steady_turn_threshold_g(vehicle, load, vehicle.nominal_speed_mps)?;
        let usual = LATERAL_G.into_iter().filter(|g| *g < USUAL_SHARE * threshold_g);
        turns.extend(usual.flat_map(|g| MANEUVERS.map(|maneuver| (load, design, maneuver, g))));
    }
    let options = EstimateOptions::default().with_file(vehicle);
    let of_turn = |&(load, design, maneuver, lateral_g): &(Load, &Design<f64>, Maneuver, f64)| {
        let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
        let scenario = scenario(vehicle, load, maneuver, lateral_g)?;
        for row in LogSimulation::new(vehicle, scenario)?.rows() {
            estimator.push(&row).map_err(|error| VehicleError::Model(error.to_string()))?;
        }
        known(vehicle, load, estimator)
    };
    let runs: Vec<Run> = turns.par_iter().map(of_turn).collect::<Result<_, _>>()?;
    let misfits = misfits(vehicle, variant, &runs)?;
    let channels = Channel::ALL.into_iter().filter_map(|channel| of_channel(channel, &misfits));
    Ok(ModelResidual { runs: runs.len(), channels: channels.collect() })
}

fn loads(vehicle: &Vehicle) -> Vec<Load> {
    let empty = vehicle.empty_load();
    let tare = &vehicle.trailer.tare;
    let laden = |payload_kg: f64, above_m: f64| {
        let payload_m = vehicle.trailer.payload.floor_height_m + above_m;
        let moment_kgm = tare.sprung_mass_kg * tare.cg_height_m + payload_kg * payload_m;
        Load {
            trailer_mass_kg: empty.trailer_mass_kg + payload_kg,
            cg_height_m: moment_kgm / (tare.sprung_mass_kg + payload_kg),
        }
    };
    let heights = |payload_kg: f64| ABOVE_FLOOR_M.map(|above_m| laden(payload_kg, above_m));
    let mut loads = vec![empty];
    loads.extend(PAYLOADS_KG.into_iter().flat_map(heights));
    loads
}

fn scenario(
    vehicle: &Vehicle,
    load: Load,
    maneuver: Maneuver,
    lateral_g: f64,
) -> Result<Scenario, VehicleError> {
    let speed_mps = vehicle.nominal_speed_mps;
    let model = Equations::new(vehicle, Variant::Complete, speed_mps, load)?.state_space()?;
    let gain = model.lateral_gain()?;
    let usual = Scenario::of(vehicle, maneuver);
    let drives = maneuver == Maneuver::Drive;
    Ok(Scenario {
        load,
        plant: Plant::Nonlinear,
        steer_rad: Some(lateral_g * vehicle.gravity_mps2 / gain),
        rate_hz: RATE_HZ,
        duration_s: if drives { DRIVE_S } else { usual.duration_s },
        speed_change: if drives { SPEED_CHANGE } else { 0.0 },
        ..usual
    })
}

fn known(vehicle: &Vehicle, load: Load, estimator: LogEstimator) -> Result<Run, VehicleError> {
    let (height_m, trailer_mass_kg) = (load.cg_height_m, Some(load.trailer_mass_kg));
    let log = format!("{:.0} kg at {height_m:.2} m", load.trailer_mass_kg);
    let log = KnownLog { log, load: KnownLoad::exact(height_m, trailer_mass_kg) };
    // An interval does not know how strong its turns are.
    Ok(Run { turn_g: None, ..run(vehicle, &log, estimator)? })
}

#[allow(clippy::cast_precision_loss)] // dozens
fn of_channel(channel: Channel, misfits: &[Misfit]) -> Option<ChannelResidual> {
    let own: Vec<&Misfit> = misfits.iter().filter(|one| one.channel == channel).collect();
    let n = own.len() as f64;
    if own.len() < 2 {
        return None;
    }
    let mean = own.iter().map(|one| one.log).sum::<f64>() / n;
    let total = own.iter().map(|one| (one.log - mean) * (one.log - mean)).sum::<f64>() / (n - 1.0);
    let explained = own.iter().map(|one| one.variance).sum::<f64>() / n;
    let [spread, explained] = [total, explained].map(libm::sqrt);
    Some(ChannelResidual { channel, mean, spread, explained })
}
