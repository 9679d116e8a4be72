//! Drives of the nonlinear plant with one fault at a time, of a sensor, a sign, a unit, the clock or
//! the file: no interval misses the truth without a message that names what is wrong.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Design;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator, Verdict};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::design::{design, design_with};
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

/// The effect of a fault on a row; the first argument is the index of the row in the log.
type Damage = fn(usize, &mut LogRow);

/// A fault, and words of which one must be in a message if the interval misses the truth.
struct Fault {
    name: &'static str,
    damage: Damage,
    named: &'static [&'static str],
}

const fn fault(name: &'static str, named: &'static [&'static str], damage: Damage) -> Fault {
    Fault { name, damage, named }
}

/// White noise, uniform over ±1: a multiplicative hash of the index.
fn white(k: usize) -> f64 {
    let mixed = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    f64::from(u32::try_from(mixed >> 32).unwrap()) / f64::from(u32::MAX) * 2.0 - 1.0
}

const SENSOR: &[&str] = &["inconsistent", "left out", "likely cause"];

fn faults() -> Vec<Fault> {
    let mut all = wrong_signals();
    all.extend(broken_sensors());
    all
}

/// A sign, a unit, a gain or a column is wrong.
fn wrong_signals() -> Vec<Fault> {
    vec![
        fault("roll reversed", &["⟨flip roll⟩"], |_, row| row.roll_rad *= -1.0),
        fault("steer reversed", &["⟨flip steer⟩"], |_, row| row.steer_rad *= -1.0),
        fault("lateral acceleration reversed", &["⟨flip lateral_acceleration⟩"], |_, row| {
            row.lateral_acceleration_mps2 *= -1.0;
        }),
        fault("roll twice", &["left out", "gain of the roll sensor"], |_, row| row.roll_rad *= 2.0),
        fault("roll in degrees", SENSOR, |_, row| row.roll_rad = row.roll_rad.to_degrees()),
        fault("steering wheel", &["steering_wheel_rad"], |_, row| row.steer_rad *= 20.0),
        fault("steer in degrees", SENSOR, |_, row| row.steer_rad = row.steer_rad.to_degrees()),
        fault("lateral acceleration in g", &["in g"], |_, row| {
            row.lateral_acceleration_mps2 /= 9.81;
        }),
        fault("body-fixed accelerometer", &["gravity"], |_, row| {
            row.lateral_acceleration_mps2 += 9.81 * row.roll_rad.sin();
        }),
        fault("the same without yaw rate", &["gravity"], |_, row| {
            row.lateral_acceleration_mps2 += 9.81 * row.roll_rad.sin();
            row.yaw_rate_radps = f64::NAN;
        }),
        fault("steer 1.3 times", SENSOR, |_, row| row.steer_rad *= 1.3),
        fault("lateral acceleration 1.2 times", SENSOR, |_, row| {
            row.lateral_acceleration_mps2 *= 1.2;
        }),
        fault("inclinometer for roll", SENSOR, |_, row| {
            row.roll_rad += row.lateral_acceleration_mps2 / 9.81;
        }),
    ]
}

/// A sensor, the clock or the file is faulty.
fn broken_sensors() -> Vec<Fault> {
    vec![
        fault("roll ends at 1 degree", SENSOR, |k, row| {
            row.roll_rad = row.roll_rad.clamp(-0.0175, 0.0175) + 1e-4 * white(k);
        }),
        fault("lateral acceleration alone ends at 1 m/s²", &["cut off"], |_, row| {
            (row.steer_rad, row.yaw_rate_radps) = (f64::NAN, f64::NAN);
            row.lateral_acceleration_mps2 = row.lateral_acceleration_mps2.clamp(-1.0, 1.0);
        }),
        fault("dead band of 0.5 degrees", SENSOR, |k, row| {
            let beyond = (row.roll_rad.abs() - 0.0087).max(0.0);
            row.roll_rad = beyond.copysign(row.roll_rad) + 1e-4 * white(k);
        }),
        fault("roll drifts a degree a minute", &["drift"], |_, row| {
            row.roll_rad += 2.9e-4 * row.time_s;
        }),
        fault("roll hangs for 20 s", SENSOR, |k, row| {
            if k % 4000 > 2000 {
                row.roll_rad = 0.01;
            }
        }),
        fault("roll in steps of 1 degree", SENSOR, |_, row| {
            row.roll_rad = (row.roll_rad / 0.0175).round() * 0.0175;
        }),
        fault("time in milliseconds", &["seconds"], |_, row| row.time_s *= 1e3),
        fault("speed in km/h", SENSOR, |_, row| row.speed_mps *= 3.6),
        fault("yaw rate in degrees", &["degrees per second"], |_, row| {
            row.yaw_rate_radps = row.yaw_rate_radps.to_degrees();
        }),
        fault("roll and yaw rate swapped", SENSOR, |_, row| {
            std::mem::swap(&mut row.roll_rad, &mut row.yaw_rate_radps);
        }),
        fault("one cell of 1e308", SENSOR, |k, row| {
            if k == 1500 {
                row.roll_rad = 1e308;
            }
        }),
        fault("no speed for the first second", SENSOR, |k, row| {
            if k < 100 {
                (row.speed_mps, row.lateral_acceleration_mps2) = (f64::INFINITY, f64::NAN);
            }
        }),
        fault("speed hangs", SENSOR, |_, row| row.speed_mps = 13.9),
    ]
}

/// A vehicle with its design, and drives with noise of 30 dB on the roll angle.
struct Subject {
    name: String,
    vehicle: Vehicle,
    design: Design<f64>,
    drives: Vec<(f64, Vec<LogRow>)>,
}

fn scenario(vehicle: &Vehicle, maneuver: Maneuver, payload_kg: f64, height_m: f64) -> Scenario {
    let tare = vehicle.empty_trailer_mass_kg();
    let load = Load { trailer_mass_kg: tare + payload_kg, cg_height_m: height_m };
    let sensors = Sensors { snr_db: Some(30.0), ..Sensors::default() };
    let plain = Scenario::of(vehicle, maneuver);
    Scenario { plant: Plant::Nonlinear, load, sensors, ..plain }
}

fn rows(vehicle: &Vehicle, scenario: Scenario) -> Vec<LogRow> {
    LogSimulation::new(vehicle, scenario).unwrap().rows()
}

fn subjects(name: &str) -> [Subject; 2] {
    let vehicle = common::vehicle(name);
    let drives: Vec<(f64, Vec<LogRow>)> = [(6e3, 1.6, 1), (14e3, 1.75, 2), (20e3, 1.95, 3)]
        .into_iter()
        .map(|(payload_kg, height_m, seed)| {
            let plain = scenario(&vehicle, Maneuver::Drive, payload_kg, height_m);
            let drive = Scenario { duration_s: 120.0, speed_change: 0.2, seed, ..plain };
            (height_m, rows(&vehicle, drive))
        })
        .collect();
    let runs = [(0.0, 1.4, "light"), (18e3, 1.9, "heavy")].map(|(payload_kg, height_m, log)| {
        let step = scenario(&vehicle, Maneuver::RoundedStep, payload_kg, height_m);
        let load = KnownLoad::exact(height_m, None);
        let known = KnownLog { log: log.to_owned(), load };
        (known, rows(&vehicle, step))
    });
    let logs: Vec<KnownLog> = runs.iter().map(|(known, _)| known.clone()).collect();
    let calibration =
        calibrate::<VehicleError>(&vehicle, CalibrateOptions::default(), &logs, |log, intake| {
            let (_, rows) = runs.iter().find(|(known, _)| known == log).unwrap();
            for row in rows {
                intake.push(row).unwrap();
            }
            Ok(())
        })
        .unwrap();
    let plain = design(&vehicle, Variant::Complete).unwrap();
    let known = design_with(&vehicle, Variant::Complete, &calibration.belief()).unwrap();
    [("", &plain), (", calibrated", &known)].map(|(how, design)| Subject {
        name: format!("{name}{how}"),
        vehicle: vehicle.clone(),
        design: *design,
        drives: drives.clone(),
    })
}

impl Subject {
    fn estimate(&self, rows: &[LogRow], damage: Damage) -> LogEstimate {
        let settings = self.vehicle.align_settings();
        let options = EstimateOptions::default();
        let mut estimator = LogEstimator::from_design(&self.design, settings, options);
        for (k, row) in rows.iter().enumerate() {
            let mut row = *row;
            damage(k, &mut row);
            estimator.push(&row).unwrap();
        }
        estimator.finish()
    }
}

fn holds(answer: &LogEstimate, true_m: f64) -> Option<bool> {
    answer.height_ci95_m.map(|[low, high]| low <= true_m && true_m <= high)
}

#[test]
fn no_fault_gives_a_wrong_height_without_a_word() {
    let mut wrong = Vec::new();
    for name in ["kraz.toml", "baseline.toml"] {
        for subject in subjects(name) {
            for (k, (true_m, rows)) in subject.drives.iter().enumerate() {
                let good = subject.estimate(rows, |_, _| ());
                println!("{}, drive {k}: {:?} for {true_m}", subject.name, good.height_ci95_m);
                if good.status != Verdict::Ok || holds(&good, *true_m) != Some(true) {
                    wrong.push(format!("{}, drive {k}: {good:?}", subject.name));
                }
            }
            for (k, fault) in faults().iter().enumerate() {
                let (true_m, rows) = &subject.drives[k % subject.drives.len()];
                let answer = subject.estimate(rows, fault.damage);
                let told = format!(
                    "{}, {}: {:?} {:?} for {true_m}; {}",
                    subject.name,
                    fault.name,
                    answer.status,
                    answer.height_ci95_m,
                    answer.messages.join(" | ")
                );
                println!("{told}");
                let named = fault
                    .named
                    .iter()
                    .any(|word| answer.messages.iter().any(|message| message.contains(word)));
                let misses = holds(&answer, *true_m) == Some(false);
                let silent = answer.status != Verdict::Ok && answer.messages.is_empty();
                if (misses && !named) || silent {
                    wrong.push(told);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong\n{}", wrong.len(), wrong.join("\n"));
}
