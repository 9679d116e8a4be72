//! Table 5.11 from end to end: the nonlinear plant drives a rounded step at eight heights, the
//! estimator is calibrated at 1.973 m on one run, and estimates the others from their logs.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;
use cg_core::{AlignSettings, Channel};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::belief::{Belief, Covariance};
use cg_vehicle::calibration::Procedure;
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

const HEIGHTS_M: [f64; 8] = [1.854, 1.905, 1.973, 2.007, 2.057, 2.108, 2.159, 2.210];
const CALIBRATED_AT_M: f64 = 1.973;

fn drive(vehicle: &Vehicle, cg_height_m: f64, estimator: &mut LogEstimator) {
    let scenario = Scenario {
        plant: Plant::Nonlinear,
        load: Load { cg_height_m, ..vehicle.reference_load() },
        steer_rad: Some(0.05),
        rate_hz: 50.0,
        start_s: 2.0,
        duration_s: 20.0,
        ..Scenario::of(vehicle, Maneuver::RoundedStep)
    };
    LogSimulation::new(vehicle, scenario)
        .unwrap()
        .run(|row| {
            estimator.push(row).unwrap();
            Ok::<(), VehicleError>(())
        })
        .unwrap();
}

/// Errors of the eight heights with one calibration, relative.
fn errors(plant: &Vehicle, known: &Vehicle, variant: Variant) -> Vec<f64> {
    let load = KnownLoad::exact(CALIBRATED_AT_M, None);
    let log = KnownLog { log: "plant at 1.973 m".to_owned(), load };
    // The way of the thesis: the printed model is known at one load only.
    let procedure = Procedure::Compensation;
    let options = CalibrateOptions { variant, procedure, ..CalibrateOptions::default() };
    let calibration = calibrate::<VehicleError>(known, options, &[log], |_, estimator| {
        drive(plant, CALIBRATED_AT_M, estimator);
        Ok(())
    })
    .unwrap();
    let design = design_with(known, variant, &calibration.belief()).unwrap();
    println!("{variant:?}: R_c {:.4}", calibration.compensation.steer);
    let options =
        EstimateOptions { variant, channel: Some(Channel::Steer), ..EstimateOptions::default() };
    HEIGHTS_M
        .iter()
        .map(|&height_m| {
            let mut estimator = LogEstimator::from_design(&design, AlignSettings::NONE, options);
            drive(plant, height_m, &mut estimator);
            let estimate = estimator.finish();
            let error = estimate.height_m.unwrap() / height_m - 1.0;
            println!("  {height_m:.3} m: {:+.2} %", 100.0 * error);
            error
        })
        .collect()
}

/// At most one percent with the complete model (the target), and the thesis's error pattern
/// (−3.1 to +5.4 %, growing with the distance from 1.973 m) with the printed model.
#[test]
fn one_calibration_holds_over_all_heights_of_table_5_11() {
    let vehicle = common::vehicle("baseline.toml");
    let complete = errors(&vehicle, &vehicle, Variant::Complete);
    assert!(common::largest(&complete) <= 0.01, "{complete:?}");
    let printed = errors(&vehicle, &vehicle, Variant::AsPrinted);
    // The plant of the thesis was another program, so one percentage point is allowed.
    for (ours, theirs) in printed.iter().zip([-3.1, -1.7, 0.0, 0.8, 1.9, 3.2, 4.3, 5.4]) {
        assert!((100.0 * ours - theirs).abs() < 1.0, "{printed:?}");
    }
}

/// A truck whose speed changes by 30 % has samples at which its steer angle says nothing. What it does meanwhile is no noise of
/// the steer angle, for which heights would be corrected: that of seed 34 would be 2.13 ± 0.01 m.
#[test]
fn a_changing_speed_makes_no_height_from_the_steer_angle_wrong() {
    let vehicle = common::vehicle("kraz.toml");
    let certain =
        Belief { covariance: Covariance::zeros(), residual_sd: 1e-4, ..Belief::prior(&vehicle) };
    let design = design_with(&vehicle, Variant::Complete, &certain).unwrap();
    let height_m = 1.9;
    let load =
        Load { trailer_mass_kg: vehicle.empty_trailer_mass_kg() + 20e3, cg_height_m: height_m };
    let mut heights = 0;
    for seed in [1, 2, 3, 10, 11, 34, 48] {
        let scenario = Scenario {
            plant: Plant::Nonlinear,
            load,
            seed,
            rate_hz: 50.0,
            duration_s: 90.0,
            speed_change: 0.3,
            sensors: Sensors { snr_db: Some(30.0), ..Sensors::default() },
            ..Scenario::of(&vehicle, Maneuver::Drive)
        };
        let options = EstimateOptions { channel: Some(Channel::Steer), ..Default::default() };
        let mut estimator = LogEstimator::from_design(&design, AlignSettings::NONE, options);
        let simulation = LogSimulation::new(&vehicle, scenario).unwrap();
        simulation.run(|row| estimator.push(row).map(drop)).unwrap();
        for one in estimator.finish().maneuvers {
            let (Some(found_m), Some(sd_m)) = (one.height_m, one.height_sd_m) else { continue };
            heights += 1;
            let error_m = found_m - height_m;
            println!("{seed}: {found_m:.3} ± {sd_m:.3} m");
            // Three standard deviations of the noise, and 1 % between plant and model.
            assert!(error_m.abs() < 3.0 * sd_m + 0.01 * height_m, "{seed}: {found_m} ± {sd_m}");
            assert!(sd_m < 0.2 * height_m);
        }
    }
    assert!(heights >= 12, "{heights}");
}
