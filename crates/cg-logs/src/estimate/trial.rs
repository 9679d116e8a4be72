//! A truck of round numbers for the tests of the end of a log.

use std::sync::LazyLock;

use cg_core::decide::height::Fusion;
use cg_core::{
    AlignSettings, CHANNELS, Design, Estimator, Fit, Maneuver, Measured, Memory, Prior, RatioLine,
    Reject, Sample, Settings, Spread, ThresholdLine,
};
use cg_vehicle::{Variant, Vehicle};

use super::engine::Engine;
use super::intake::LogEstimator;
use super::options::EstimateOptions;

pub(super) const SPEED_MPS: f64 = 15.0;
pub(super) const MASS_KG: f64 = 20e3;

/// At every speed and mass, the roll angle is `0.1 h` per radian of steer angle and `0.01 h` per
/// m/s²; both are uncertain by 1 %, independently. Heights of 1 to 3 m are possible.
pub(super) fn design() -> Design<f64> {
    static DESIGN: LazyLock<Design<f64>> = LazyLock::new(round);
    *DESIGN
}

/// An estimator for its logs.
pub(super) fn log_with(settings: AlignSettings<f64>, options: EstimateOptions) -> LogEstimator {
    LogEstimator::from_design(&design(), settings, options)
}

/// The same without sensor settings and options.
pub(super) fn plain() -> LogEstimator {
    log_with(AlignSettings::NONE, EstimateOptions::default())
}

fn round() -> Design<f64> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
    let vehicle = Vehicle::load(file).unwrap();
    let mut design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
    design.speed_mps = [5.0, 8.0, 11.0, 14.0, 17.0, 20.0, 23.0, 26.0];
    design.trailer_mass_kg = [5e3, 10e3, 15e3, 20e3, 25e3, 30e3];
    for (channel, slope) in design.channels.iter_mut().zip([0.1, 0.01, 0.01, 0.01]) {
        let line = RatioLine { a0: 0.0, a1: slope, b0: 1.0, b1: 0.0 };
        channel.lines.iter_mut().flatten().for_each(|one| *one = line);
        channel.compensation = 2.0;
    }
    let mut spread = Spread { covariance: [[0.0; CHANNELS]; CHANNELS] };
    for k in 0..CHANNELS {
        spread.covariance[k][k] = 1e-4;
    }
    design.spread.iter_mut().flatten().for_each(|one| *one = spread);
    design.thresholds = [ThresholdLine { threshold_g: [[0.4; 8]; 2] }; 6];
    (design.least_height_m, design.reference_height_m, design.greatest_height_m) = (1.0, 2.0, 3.0);
    (design.nominal_speed_mps, design.nominal_trailer_mass_kg) = (SPEED_MPS, MASS_KG);
    design.gravity_mps2 = 9.81;
    design
}

/// A log in which each maneuver gave these heights (steer angle, lateral acceleration), with the
/// standard deviation due to noise. The model adds no uncertainty.
pub(super) fn log(
    options: EstimateOptions,
    heights: &[[Result<Measured<f64>, Reject<f64>>; 2]],
) -> LogEstimator {
    let design = design();
    let mut memory = Memory {
        fused: [Fusion::new(); CHANNELS],
        correlation: [[0.0; CHANNELS]; CHANNELS],
        trailer_mass_kg: MASS_KG,
        load_mass_kg: None,
        waiting: None,
    };
    let mut log = LogEstimator::from_design(&design, AlignSettings::NONE, options);
    for each in heights {
        let mut maneuver = maneuver();
        for (k, height_m) in each.iter().enumerate() {
            maneuver.outcomes[k].height_m = *height_m;
            if let Ok(height_m) = height_m {
                memory.fused[k].push(*height_m, 0.0);
            }
        }
        log.maneuvers.push(maneuver);
    }
    let (settings, prior) = (Settings::truck(), Prior::standard());
    let estimator = Estimator::restored(design, settings, prior, &memory).unwrap();
    log.engine = Engine::Filtered(Box::new(estimator));
    log
}

/// A maneuver at [`SPEED_MPS`] and [`MASS_KG`] whose signals are both absent.
pub(super) fn maneuver() -> Maneuver<f64> {
    let design = design();
    let mut engine = Engine::new(&design, &EstimateOptions::default());
    for k in 0..500_u64 {
        let mut sample = Sample::absent(k * 10_000);
        (sample.roll_rad, sample.lateral_acceleration_mps2) = (0.02, 1.0);
        (sample.speed_mps, sample.trailer_mass_kg) = (SPEED_MPS, MASS_KG);
        engine.push(&sample).unwrap();
    }
    let mut maneuver = engine.finish().unwrap();
    (maneuver.speed_mps, maneuver.trailer_mass_kg) = (SPEED_MPS, MASS_KG);
    for outcome in &mut maneuver.outcomes {
        (outcome.fit, outcome.height_m) = (None, Err(Reject::Absent));
    }
    maneuver
}

/// A fit with this DC ratio.
pub(super) fn fit(ratio: Measured<f64>, snr_db: f64) -> Fit<f64> {
    let none = Measured::exact(0.0);
    Fit {
        ratio,
        drift_radps: none,
        bend: none,
        noise_sd_rad: 1e-4,
        snr_db,
        fit_percent: 90.0,
        misfit: 0.0,
        rows: 500,
    }
}
