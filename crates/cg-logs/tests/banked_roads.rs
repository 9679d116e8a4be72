//! An independent multibody truck on banked roads (`fixtures/roads`): the pairs of suspension roll
//! and specific force beside the roll angle relative to gravity.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use std::path::PathBuf;

use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator, Verdict};
use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_vehicle::design::design_with;
use cg_vehicle::{Variant, Vehicle, VehicleError};

/// Loads of the logs: empty, and 16 t with the sprung c.g. at 1.709 m at rest.
const EMPTY: (f64, f64) = (1.274_83, 6_318.23);
const LADEN: (f64, f64) = (1.708_59, 22_318.23);

const ROADS: [&str; 3] = ["B_rural_p16_h170", "C_motorway_p16_h170", "D_roundabout_p16_h170"];

fn fixture(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(path)
}

fn truck() -> Vehicle {
    Vehicle::load(fixture("vehicles/euro.toml")).unwrap()
}

fn rows(log: &str) -> Vec<LogRow> {
    let path = fixture(&format!("roads/{log}.csv.gz"));
    let reader = LogReader::open(&path, &LogOptions::default()).unwrap();
    reader.map(Result::unwrap).collect()
}

fn known(log: &str, (height_m, mass_kg): (f64, f64)) -> KnownLog {
    format!("{log}={height_m},{mass_kg}").parse().unwrap()
}

/// The design after a calibration with steps on a flat road.
fn calibrated(runs: &[KnownLog]) -> Design<f64> {
    let truck = truck();
    let calibration = calibrate(&truck, CalibrateOptions::default(), runs, |known, estimator| {
        for row in rows(&known.log) {
            estimator.push(&row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(&truck, Variant::Complete, &calibration.unwrap().belief()).unwrap()
}

fn estimate(
    design: &Design<f64>,
    rows: &[LogRow],
    channel: Option<Channel>,
    mass_kg: f64,
) -> LogEstimate {
    let options =
        EstimateOptions { channel, trailer_mass_kg: Some(mass_kg), ..EstimateOptions::default() };
    let mut estimator = LogEstimator::from_design(design, truck().align_settings(), options);
    for row in rows {
        estimator.push(row).unwrap();
    }
    estimator.finish()
}

/// Relative error of the height. The 95 % interval must contain the truth.
fn error(estimate: &LogEstimate, truth_m: f64, case: &str) -> f64 {
    let height_m = estimate.height_m.unwrap_or_else(|| panic!("{case}: {:?}", estimate.messages));
    let [low, high] = estimate.height_ci95_m.unwrap();
    let error = height_m / truth_m - 1.0;
    println!("{case:48} {height_m:.3} m, {low:.3} to {high:.3}: {:+.2} %", 100.0 * error);
    assert!((low..=high).contains(&truth_m), "{case}: {low} to {high}");
    error
}

/// The greatest error that is wanted of the pair of the trailer and of that of the tractor.
fn limits(log: &str) -> [f64; 2] {
    if log.starts_with('D') { [0.03, 0.05] } else { [0.01, 0.02] }
}

#[test]
fn calibrated_on_flat_steps_both_pairs_hold_on_banked_roads() {
    let design = calibrated(&[known("A_step_p00", EMPTY), known("A_step_p16_h170", LADEN)]);
    for log in ROADS {
        let rows = rows(log);
        for (channel, limit) in [Channel::Suspension, Channel::Tractor].into_iter().zip(limits(log))
        {
            let found = estimate(&design, &rows, Some(channel), LADEN.1);
            let case = format!("{log} {channel}");
            assert!(error(&found, LADEN.0, &case).abs() <= limit, "{case}");
        }
    }
}

/// The empty run alone: 2 % is wanted of the trailer's pair, 3 % of the tractor's.
#[test]
fn calibrated_on_the_empty_step_alone() {
    let design = calibrated(&[known("A_step_p00", EMPTY)]);
    let mut squares = [0.0; 2];
    for log in ROADS {
        let rows = rows(log);
        for (sum, channel) in squares.iter_mut().zip([Channel::Suspension, Channel::Tractor]) {
            let found = estimate(&design, &rows, Some(channel), LADEN.1);
            *sum += error(&found, LADEN.0, &format!("{log} {channel}, empty run")).powi(2) / 3.0;
        }
    }
    let [suspension, tractor] = squares.map(f64::sqrt);
    assert!(suspension <= 0.02 && tractor <= 0.03, "{suspension} {tractor}");
}

/// Nothing fitted: the data sheet alone. The steps' static gains differ from it by 0.8 %.
#[test]
fn without_calibration_the_height_is_within_two_percent() {
    let design =
        design_with(&truck(), Variant::Complete, &cg_vehicle::belief::Belief::prior(&truck()))
            .unwrap();
    for log in ROADS {
        let found = estimate(&design, &rows(log), None, LADEN.1);
        assert_eq!(found.channel.as_deref(), Some("combined"));
        assert!(error(&found, LADEN.0, log).abs() <= 0.02);
    }
}

/// A roll angle relative to gravity gives no height on these roads, or an interval that contains the
/// truth, and the reason is the road. Nobody is told that a sensor is wrong.
#[test]
fn a_roll_angle_to_gravity_is_refused_or_its_interval_holds() {
    let design = calibrated(&[known("A_step_p00", EMPTY), known("A_step_p16_h170", LADEN)]);
    for (log, load) in ROADS.map(|log| (log, LADEN)).into_iter().chain([("B_rural_p00", EMPTY)]) {
        let to_gravity: Vec<LogRow> = rows(log)
            .into_iter()
            .map(|row| LogRow {
                time_s: row.time_s,
                steer_rad: row.steer_rad,
                speed_mps: row.speed_mps,
                lateral_acceleration_mps2: row.lateral_acceleration_mps2,
                roll_to_gravity_rad: row.roll_to_gravity_rad,
                ..LogRow::ABSENT
            })
            .collect();
        let found = estimate(&design, &to_gravity, None, load.1);
        if found.height_m.is_some() {
            error(&found, load.0, &format!("{log}, roll to gravity"));
        }
        let told = found.messages.join("; ");
        assert!(told.contains("bank of the road") && told.contains("⟨road flat⟩"), "{log}: {told}");
        assert!(!told.contains("likely cause"), "{log}: {told}");
    }
}

/// Yaw rate times speed is what a compensated accelerometer shows. Such a force gives a narrow interval
/// that misses the truth, unless it is found.
#[test]
fn a_specific_force_without_gravity_gives_no_height() {
    let design = calibrated(&[known("A_step_p00", EMPTY), known("A_step_p16_h170", LADEN)]);
    for log in ROADS {
        let compensated: Vec<LogRow> = rows(log)
            .into_iter()
            .map(|row| LogRow {
                time_s: row.time_s,
                speed_mps: row.speed_mps,
                yaw_rate_radps: row.yaw_rate_radps,
                tractor_suspension_roll_rad: row.tractor_suspension_roll_rad,
                tractor_lateral_specific_force_mps2: row.yaw_rate_radps * row.speed_mps,
                ..LogRow::ABSENT
            })
            .collect();
        for channel in [None, Some(Channel::Tractor)] {
            let found = estimate(&design, &compensated, channel, LADEN.1);
            let told = found.messages.join("; ");
            assert_eq!(
                (found.status, found.height_m),
                (Verdict::Inconsistent, None),
                "{log}: {told}"
            );
            assert!(told.contains("the specific force of the tractor"), "{log}: {told}");
            assert!(told.contains("⟨vdc2 acceleration⟩"), "{log}: {told}");
        }
        let without_yaw_rate: Vec<LogRow> =
            compensated.into_iter().map(|row| LogRow { yaw_rate_radps: f64::NAN, ..row }).collect();
        let found = estimate(&design, &without_yaw_rate, None, LADEN.1);
        assert!(!found.messages.join("; ").contains("vdc2"), "{:?}", found.messages);
    }
}

/// Two inertial sensors, on the frame and on an axle, or one and the suspension roll: with a yaw rate or a
/// lateral acceleration they are the trailer's pair. That acceleration is not at the place of the accelerometer
/// of the calibration but at the c.g., so as little is wanted as of the tractor's pair.
#[test]
fn roll_angles_to_gravity_of_frame_and_axle_are_a_pair() {
    let design = calibrated(&[known("A_step_p00", EMPTY), known("A_step_p16_h170", LADEN)]);
    for log in ROADS {
        let rows = rows(log);
        let kept = |change: fn(&LogRow) -> LogRow| {
            let changed: Vec<LogRow> = rows
                .iter()
                .map(|row| LogRow {
                    time_s: row.time_s,
                    speed_mps: row.speed_mps,
                    roll_to_gravity_rad: row.roll_to_gravity_rad,
                    ..change(row)
                })
                .collect();
            estimate(&design, &changed, None, LADEN.1)
        };
        let sets: [fn(&LogRow) -> LogRow; 3] = [
            |row| LogRow {
                axle_roll_to_gravity_rad: row.roll_to_gravity_rad - row.suspension_roll_rad,
                yaw_rate_radps: row.yaw_rate_radps,
                ..LogRow::ABSENT
            },
            |row| LogRow {
                axle_roll_to_gravity_rad: row.roll_to_gravity_rad - row.suspension_roll_rad,
                lateral_acceleration_mps2: row.lateral_acceleration_mps2,
                ..LogRow::ABSENT
            },
            |row| LogRow {
                suspension_roll_rad: row.suspension_roll_rad,
                yaw_rate_radps: row.yaw_rate_radps,
                ..LogRow::ABSENT
            },
        ];
        for (k, set) in sets.into_iter().enumerate() {
            let found = kept(set);
            assert_eq!(found.channel.as_deref(), Some("suspension"), "{:?}", found.messages);
            let [_, limit] = limits(log);
            assert!(error(&found, LADEN.0, &format!("{log}, set {k}")).abs() <= limit, "{log} {k}");
        }
    }
}

/// A roll angle relative to gravity that is named as one relative to the road, and one relative to a banked
/// road that counts as flat: the curves contradict each other, and nobody is told to reverse a sensor. Levels
/// that are swapped are named.
#[test]
fn a_bank_is_no_fault_of_a_sensor() {
    let design = calibrated(&[known("A_step_p00", EMPTY), known("A_step_p16_h170", LADEN)]);
    let told = |log: &str, change: fn(&LogRow) -> LogRow| {
        let changed = |row: LogRow| LogRow {
            time_s: row.time_s,
            speed_mps: row.speed_mps,
            yaw_rate_radps: row.yaw_rate_radps,
            ..change(&row)
        };
        let rows: Vec<LogRow> = rows(log).into_iter().map(changed).collect();
        estimate(&design, &rows, None, LADEN.1).messages.join("; ")
    };
    for log in ROADS {
        let named_wrong =
            told(log, |row| LogRow { roll_rad: row.roll_to_gravity_rad, ..LogRow::ABSENT });
        assert!(named_wrong.contains("likely cause: the road is banked"), "{log}: {named_wrong}");
        assert!(named_wrong.contains("from curve to curve"), "{log}: {named_wrong}");
        assert!(!named_wrong.contains("flip") && !named_wrong.contains("absent"), "{named_wrong}");
        let swapped = told(log, |row| LogRow {
            suspension_roll_rad: -row.suspension_roll_rad,
            lateral_specific_force_mps2: row.lateral_specific_force_mps2,
            ..LogRow::ABSENT
        });
        assert!(swapped.contains("left and right level are swapped"), "{log}: {swapped}");
    }
    // The adverse bank of roundabouts is always the same.
    for log in &ROADS[..2] {
        let to_road = told(log, |row| LogRow { roll_rad: row.roll_rad, ..LogRow::ABSENT });
        assert!(to_road.contains("likely cause: the road is banked"), "{log}: {to_road}");
    }
}
