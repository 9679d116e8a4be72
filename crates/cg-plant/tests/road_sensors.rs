//! The pairs of an independent truck on banked roads (`fixtures/roads`), each calibrated on flat steps through
//! the same sensors: perfect ones, and usual ones whose accelerometers are mounted one degree askew.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, Calibrator, KnownLog};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_plant::sensors::{ChassisSensors, Instruments, Sensors};
use cg_vehicle::design::{design, design_with};
use cg_vehicle::{Variant, Vehicle, VehicleError};

const PAIRS: [Channel; 2] = [Channel::Suspension, Channel::Tractor];
/// Height and mass of the loads: empty, and 16 t.
const EMPTY: (f64, f64) = (1.274_83, 6_318.23);
const LADEN: (f64, f64) = (1.708_59, 22_318.23);
const DRIVES: [(&str, (f64, f64)); 4] = [
    ("B_rural_p16_h170", LADEN),
    ("B_rural_p00", EMPTY),
    ("C_motorway_p16_h170", LADEN),
    ("D_roundabout_p16_h170", LADEN),
];
/// Distances of the level sensors of trailer and tractor.
const SPREADS_M: [f64; 2] = [1.0, 0.9];

/// What the sensors of a pair show of a log; without a seed they are perfect.
fn rows(log: &str, seed: Option<u64>) -> Vec<LogRow> {
    let path = format!("{}/../../fixtures/roads/{log}.csv.gz", env!("CARGO_MANIFEST_DIR"));
    let truth = LogReader::open(path.as_ref(), &LogOptions::default()).unwrap().map(Result::unwrap);
    let usual = ChassisSensors { mounting_rad: 1_f64.to_radians(), ..ChassisSensors::usual() };
    let instruments = |seed| {
        let [trailer, tractor] = SPREADS_M.map(f64::recip);
        Instruments::new(&Sensors::default(), 0.0, 9.81, 1.0, seed).with_chassis(
            &usual,
            [trailer, tractor],
            seed,
        )
    };
    let mut instruments = seed.map(instruments);
    let levels = |roll_rad: f64, k: usize| {
        let half_m = 0.5 * SPREADS_M[k] * roll_rad;
        [half_m, -half_m]
    };
    let shown = |row: LogRow| {
        let [level_left_m, level_right_m] = levels(row.suspension_roll_rad, 0);
        let [tractor_level_left_m, tractor_level_right_m] =
            levels(row.tractor_suspension_roll_rad, 1);
        let row = LogRow {
            level_left_m,
            level_right_m,
            tractor_level_left_m,
            tractor_level_right_m,
            ..row
        };
        let row = instruments.as_mut().map_or(row, |instruments| instruments.measure(&row));
        LogRow {
            steer_rad: f64::NAN,
            roll_rad: f64::NAN,
            roll_to_gravity_rad: f64::NAN,
            tilt_rad: f64::NAN,
            ..row
        }
    };
    truth.map(shown).collect()
}

/// The design after a calibration on steps.
fn calibrated(truck: &Vehicle, calibrator: &Calibrator<'_>, seed: Option<u64>) -> Design<f64> {
    let found = calibrator.calibrate(&[], |known, estimator| {
        for row in rows(&known.log, seed) {
            estimator.push(&row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(truck, Variant::Complete, &found.unwrap().belief()).unwrap()
}

/// Relative error of the height of a pair. The 95 % interval must contain the truth.
fn error(
    design: &Design<f64>,
    truck: &Vehicle,
    pair: Channel,
    (rows, (truth_m, mass_kg)): (&[LogRow], (f64, f64)),
    case: &str,
) -> f64 {
    let options = EstimateOptions {
        channel: Some(pair),
        trailer_mass_kg: Some(mass_kg),
        ..EstimateOptions::default()
    }
    .with_file(truck);
    let mut estimator = LogEstimator::from_design(design, truck.align_settings(), options);
    for row in rows {
        estimator.push(row).unwrap();
    }
    let found = estimator.finish();
    let [low, high] = found.height_ci95_m.unwrap();
    let error = found.height_m.unwrap() / truth_m - 1.0;
    println!("| {case} | {:+.2} % | {low:.2} to {high:.2} m |", 100.0 * error);
    assert!(low < truth_m && truth_m < high, "{case}: {low} to {high}");
    error
}

/// Root mean squares of the errors of each pair, in roundabouts and on other roads, after a calibration on these steps.
fn errors(runs: &[(&str, (f64, f64))], seeds: &[Option<u64>], case: &str) -> [[f64; 2]; 2] {
    let truck = common::vehicle("euro.toml");
    let mut flat = truck.clone();
    flat.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
    let known = |&(log, (height_m, mass_kg)): &(&str, (f64, f64))| -> KnownLog {
        format!("{log}={height_m},{mass_kg}").parse().unwrap()
    };
    let logs: Vec<KnownLog> = runs.iter().map(known).collect();
    let calibrator = Calibrator::new(&flat, CalibrateOptions::default(), &logs).unwrap();
    let mut errors: [[Vec<f64>; 2]; 2] = Default::default();
    for &seed in seeds {
        let design = if logs.is_empty() {
            design(&truck, Variant::Complete).unwrap()
        } else {
            calibrated(&truck, &calibrator, seed)
        };
        for (log, load) in DRIVES {
            let rows = rows(log, seed.map(|seed| seed + 10));
            for (k, pair) in PAIRS.into_iter().enumerate() {
                let case = format!("{case} | {pair} | {log}");
                let error = error(&design, &truck, pair, (&rows, load), &case);
                errors[usize::from(!log.starts_with('D'))][k].push(error);
            }
        }
    }
    errors.map(|pairs| pairs.map(|of_pair| common::rms(&of_pair)))
}

const STEPS: [(&str, (f64, f64)); 2] = [("A_step_p00", EMPTY), ("A_step_p16_h170", LADEN)];
const SEEDS: std::ops::RangeInclusive<u64> = 1..=12;

/// Calibrated on both steps, 1 % is wanted of the trailer's pair (roundabouts 3 %) and 2 % of the tractor's
/// (5 %).
#[test]
fn with_perfect_sensors() {
    errors(&[], &[None], "perfect, nothing");
    let [roundabouts, roads] = errors(&STEPS, &[None], "perfect, two steps");
    assert!(roads[0] <= 0.01 && roads[1] <= 0.02, "{roads:?}");
    assert!(roundabouts[0] <= 0.03 && roundabouts[1] <= 0.05, "{roundabouts:?}");
    let [roundabouts, roads] = errors(&STEPS[..1], &[None], "perfect, empty step");
    for [trailer, tractor] in [roundabouts, roads] {
        assert!(trailer <= 0.02 && tractor <= 0.03, "{trailer} {tractor}");
    }
}

/// The same with usual sensors, of which twelve sets are drawn: 1.5 % and 2.5 % are wanted, and 2 % and 3 % after the empty
/// step alone.
#[test]
fn with_usual_sensors() {
    let seeds: Vec<_> = SEEDS.map(Some).collect();
    let [roundabouts, roads] = errors(&STEPS, &seeds, "usual, two steps");
    assert!(roads[0] <= 0.015 && roads[1] <= 0.025, "{roads:?}");
    assert!(roundabouts[0] <= 0.03 && roundabouts[1] <= 0.05, "{roundabouts:?}");
    let [roundabouts, roads] = errors(&STEPS[..1], &seeds, "usual, empty step");
    for [trailer, tractor] in [roundabouts, roads] {
        assert!(trailer <= 0.02 && tractor <= 0.03, "{trailer} {tractor}");
    }
}
