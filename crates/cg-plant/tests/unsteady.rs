//! Turns into which the truck brakes and out of which it accelerates, on a flat road, on the nonlinear plant.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Design;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadPoint};
use cg_plant::sensors::{ChassisSensors, Sensors};
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

/// The words of the message.
const TOLD: &str = "the truck braked and accelerated in turns";
const SLOW_MPS: f64 = 13.0;
/// A straight of 120 m and a curve of 110 m of radius and 180 m of length, in which the first and the last 60 m change the speed.
const STRAIGHT_M: f64 = 120.0;
const CURVE_M: f64 = 180.0;
const RADIUS_M: f64 = 110.0;

/// Six such curves to both sides; the truck brakes into them and accelerates out of them with this acceleration.
fn curves(acceleration_mps2: f64) -> Road {
    let speed_mps = |place_m: f64| {
        let slow_m = place_m.clamp(0.0, 60.0).min((CURVE_M - place_m).clamp(0.0, 60.0));
        (SLOW_MPS * SLOW_MPS + 2.0 * acceleration_mps2 * (60.0 - slow_m)).sqrt()
    };
    let points = (0..900_u32).map(|k| {
        let distance_m = 2.0 * f64::from(k);
        let place_m = distance_m % (STRAIGHT_M + CURVE_M) - STRAIGHT_M;
        let left = (k / 150).is_multiple_of(2); // 300 m
        let entered = (place_m / 25.0).min((CURVE_M - place_m) / 25.0).clamp(0.0, 1.0);
        RoadPoint {
            distance_m,
            curvature_per_m: if left { entered } else { -entered } / RADIUS_M,
            bank_rad: 0.0,
            grade_rad: 0.0,
            speed_mps: speed_mps(place_m),
        }
    });
    Road::new("curves", points.collect()).unwrap()
}

fn rows(vehicle: &Vehicle, load: Load, acceleration_mps2: f64, seed: u64) -> Vec<LogRow> {
    let plain = Scenario::of(vehicle, Maneuver::Drive);
    let sensors = Sensors { snr_db: Some(35.0), ..Sensors::default() };
    let scenario = Scenario { load, rate_hz: 50.0, duration_s: 120.0, seed, sensors, ..plain };
    let (road, chassis) = (curves(acceleration_mps2), ChassisSensors::default());
    let found = LogSimulation::on_road(vehicle, scenario, &road, &chassis).unwrap().rows();
    // Roll angle and inputs alone.
    let kept = |row: &LogRow| LogRow {
        time_s: row.time_s,
        speed_mps: row.speed_mps,
        steer_rad: row.steer_rad,
        yaw_rate_radps: row.yaw_rate_radps,
        roll_rad: row.roll_rad,
        trailer_mass_kg: load.trailer_mass_kg,
        ..LogRow::ABSENT
    };
    found.iter().map(kept).collect()
}

/// A calibration on an empty and an 18 t run with this acceleration.
fn calibrated(vehicle: &Vehicle, acceleration_mps2: f64) -> Calibration {
    let empty = vehicle.empty_load();
    let laden = Load { trailer_mass_kg: empty.trailer_mass_kg + 18e3, cg_height_m: 1.9 };
    let runs = [empty, laden].map(|load| rows(vehicle, load, acceleration_mps2, 1));
    let known = [
        KnownLog { log: "empty".to_owned(), load: KnownLoad::Empty },
        KnownLog { log: "laden".to_owned(), load: KnownLoad::exact(1.9, None) },
    ];
    calibrate(vehicle, CalibrateOptions::default(), &known, |log, estimator| {
        for row in &runs[usize::from(log.log == "laden")] {
            estimator.push(row).unwrap();
        }
        Ok::<(), VehicleError>(())
    })
    .unwrap()
}

fn estimate(design: &Design<f64>, vehicle: &Vehicle, rows: &[LogRow]) -> LogEstimate {
    let options = EstimateOptions::default().with_file(vehicle);
    let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
    for row in rows {
        estimator.push(row).unwrap();
    }
    estimator.finish()
}

/// After a calibration at a steady speed, no interval of a drive with such turns misses without the message, and a drive at a steady speed
/// has none. Runs with such turns are told in the statement of the calibration.
#[test]
fn a_speed_that_changes_in_turns_is_told() {
    for name in ["euro", "kraz", "air", "baseline", "baseline-tables"] {
        let mut vehicle = common::vehicle(&format!("{name}.toml"));
        vehicle.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
        let steady = calibrated(&vehicle, 0.0);
        let design = design_with(&vehicle, Variant::Complete, &steady.belief()).unwrap();
        let is_told = |calibration: &Calibration| {
            calibration.statement.iter().filter(|line| line.contains(TOLD)).count()
        };
        let [of_steady, of_unsteady] = [&steady, &calibrated(&vehicle, 0.9)].map(is_told);
        assert_eq!((of_steady, of_unsteady), (0, 2), "{name}");
        for acceleration_mps2 in [0.0, 0.3, 0.6, 0.9] {
            for (payload_kg, cg_height_m) in [(6e3, 1.7), (14e3, 2.0)] {
                let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
                let load = Load { trailer_mass_kg, cg_height_m };
                let found =
                    estimate(&design, &vehicle, &rows(&vehicle, load, acceleration_mps2, 2));
                let case = format!("{name} {acceleration_mps2} m/s², {payload_kg} kg");
                let [low, high] = found.height_ci95_m.unwrap();
                let error = found.height_m.unwrap() / cg_height_m - 1.0;
                let sd = found.height_sd_m.unwrap() / cg_height_m;
                println!("{case}: {:+.2} % ± {:.2} %", 100.0 * error, 100.0 * sd);
                let told = found.messages.iter().any(|message| message.contains(TOLD));
                let holds = low < cg_height_m && cg_height_m < high;
                assert!(holds || told, "{case}: {low} to {high}, {:?}", found.messages);
                assert!(!told || acceleration_mps2 > 0.0, "{case}: {:?}", found.messages);
            }
        }
    }
}
