//! What the equations of a vehicle leave out, as its own nonlinear plant shows it.
//!
//! The plant has the numbers of the vehicle file and perfect sensors. It makes rounded steps, turns on a circle, lane
//! changes and drives with payloads over the whole range, each at one speed, and each identified DC ratio is compared with
//! that of the equations at the true height:
//!
//! ```text
//!     m = ln(identified ratio / ratio of the equations)
//! ```
//!
//! A misfit that is the same in all runs is a gain `g`, which `[uncertainty]` describes and a calibration removes. The rest
//! differs from run to run. For a part of it an interval has the variance `v` of the run: the identification, measured
//! springs, and tires in turns. The part of `residual_sd` that the plant knows is the `r` with which the misfits of `n`
//! runs are distributed as their intervals say:
//!
//! ```text
//!     Σ (m − g)²/(v + r²) = n − 1,     g = Σ m/(v + r²) / Σ 1/(v + r²)
//! ```
//!
//! The rest of `residual_sd` is for what neither plant nor equations contain.
//!
//! The speed does not change, because an interval has more for a changing speed than these drives would show, which would
//! hide the rest.
//!
//! **Reference.** R. C. Paule and J. Mandel, Consensus values and weighting factors, *J. Res. Natl. Bur. Stand.* 87 (1982),
//! 377–385.

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

use crate::maneuver::{Course, Maneuver};
use crate::simulate::{LogSimulation, Plant, Scenario};

/// Payloads beside the empty trailer, kg.
const PAYLOADS_KG: [f64; 5] = [5e3, 10e3, 15e3, 20e3, 25e3];
/// Heights of the payload's own c.g. above the floor, m.
const ABOVE_FLOOR_M: [f64; 2] = [0.25, 0.75];
/// Lateral accelerations of usual turns, in g. Those of drives vary within them.
const LATERAL_G: [f64; 3] = [0.08, 0.13, 0.18];
/// Turns above this share of the rollover threshold are not usual, and an estimate says so.
const USUAL_SHARE: f64 = 0.5;
const MANEUVERS: [Maneuver; 4] =
    [Maneuver::RoundedStep, Maneuver::SteadyTurn, Maneuver::LaneChange, Maneuver::Drive];
/// Angle of a turn on a circle, and its speed: an exit of a motorway.
const TURN_RAD: f64 = 0.7;
const TURN_MPS: f64 = 20.0;
/// Steer angle of a lane change over that of the steady turn with the lateral acceleration to which it comes.
const LANE_CHANGE: f64 = 1.5;
const RATE_HZ: f64 = 50.0;
const DRIVE_S: f64 = 60.0;

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
    /// The residual with which the runs differ as their intervals say.
    pub residual_sd: f64,
}

/// What the equations of a vehicle leave out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelResidual {
    /// Number of runs with a ratio.
    pub runs: usize,
    /// Number of runs without one, for example a gentle lane change in which friction holds the springs.
    pub without_ratio: usize,
    /// The channels of the roll angle.
    pub channels: Vec<ChannelResidual>,
}

impl ModelResidual {
    /// What `residual_sd` of the vehicle file should be at least: the root mean square over the channels.
    #[allow(clippy::cast_precision_loss)] // a few
    pub fn residual_sd(&self) -> f64 {
        let sum: f64 = self.channels.iter().map(|one| one.residual_sd * one.residual_sd).sum();
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
        // Without a ratio there is no interval.
        let has_ratio = estimator.clone().identified().ratio.iter().any(Option::is_some);
        has_ratio.then(|| known(vehicle, load, estimator)).transpose()
    };
    let runs = turns.par_iter().map(of_turn).collect::<Result<Vec<Option<Run>>, VehicleError>>()?;
    let runs: Vec<Run> = runs.into_iter().flatten().collect();
    let misfits = misfits(vehicle, variant, &runs)?;
    let channels = Channel::ALL.into_iter().filter_map(|channel| of_channel(channel, &misfits));
    let without_ratio = turns.len() - runs.len();
    Ok(ModelResidual { runs: runs.len(), without_ratio, channels: channels.collect() })
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
    let usual = Scenario::of(vehicle, maneuver);
    let scenario = Scenario { load, plant: Plant::Nonlinear, rate_hz: RATE_HZ, ..usual };
    let lateral_mps2 = lateral_g * vehicle.gravity_mps2;
    if maneuver == Maneuver::SteadyTurn {
        let radius_m = TURN_MPS * TURN_MPS / lateral_mps2;
        let course = Some(Course::Turn { angle_rad: TURN_RAD, radius_m });
        return Ok(Scenario { course, speed_mps: TURN_MPS, ..scenario });
    }
    let model = Equations::new(vehicle, Variant::Complete, usual.speed_mps, load)?.state_space()?;
    let steer_rad = lateral_mps2 / model.lateral_gain()?;
    Ok(match maneuver {
        Maneuver::LaneChange => Scenario { steer_rad: Some(LANE_CHANGE * steer_rad), ..scenario },
        Maneuver::Drive => Scenario { steer_rad: Some(steer_rad), duration_s: DRIVE_S, ..scenario },
        _ => Scenario { steer_rad: Some(steer_rad), ..scenario },
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
    let residual_sd = residual_sd(&own, spread);
    Some(ChannelResidual { channel, mean, spread, explained, residual_sd })
}

/// The residual with which the misfits differ as their intervals say: their sum of squares falls as it grows, and is below
/// their number less one where it alone is as great as their spread.
#[allow(clippy::cast_precision_loss)] // dozens
fn residual_sd(misfits: &[&Misfit], spread: f64) -> f64 {
    const HALVINGS: usize = 40;
    let is_too_small = |residual: f64| {
        let weight = |one: &Misfit| 1.0 / (one.variance + residual * residual);
        let weights: f64 = misfits.iter().map(|one| weight(one)).sum();
        let gain = misfits.iter().map(|one| weight(one) * one.log).sum::<f64>() / weights;
        let square = |one: &&Misfit| weight(one) * (one.log - gain) * (one.log - gain);
        misfits.iter().map(square).sum::<f64>() > misfits.len() as f64 - 1.0
    };
    let (mut least, mut most) = (0.0, spread);
    if is_too_small(least) {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + most);
            if is_too_small(middle) {
                least = middle;
            } else {
                most = middle;
            }
        }
    }
    least
}
