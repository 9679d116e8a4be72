//! Pieces of a drive through regular S-curves, which show a truck at one frequency only, so that how much it rolls in a steady turn
//! follows from its dynamics. The nonlinear plant, trucks as in their files, calibrated on an empty and a laden step.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::drawn_trucks::{laden, steps};
use cg_core::{AlignSettings, Design};
use cg_logs::calibrate::{CalibrateOptions, Calibrator};
use cg_logs::estimate::{EstimateOptions, LogEstimator, QUANTILE_95};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadPoint};
use cg_plant::sensors::{ChassisSensors, Sensors};
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use rayon::prelude::*;

const TRUCKS: [&str; 4] = ["kraz.toml", "euro.toml", "air.toml", "baseline.toml"];
const WAVELENGTHS_M: [f64; 3] = [80.0, 140.0, 220.0];
/// Straight road before the first curve, m.
const STRAIGHT_M: f64 = 100.0;
const LATERAL_MPS2: f64 = 1.5;
/// From where to where the pieces are, s; the last one is the whole drive.
const PIECES_S: [[f64; 2]; 3] = [[21.0, 51.0], [27.0, 57.0], [0.0, 60.0]];

/// The only input of a log.
#[derive(Clone, Copy, Debug)]
enum Input {
    Steer,
    YawRate,
    LateralAcceleration,
}

const INPUTS: [Input; 3] = [Input::Steer, Input::YawRate, Input::LateralAcceleration];

impl Input {
    /// A row with it and the roll angle relative to the road.
    fn alone(self, row: &LogRow) -> LogRow {
        let LogRow { time_s, roll_rad, speed_mps, trailer_mass_kg, .. } = *row;
        let bare = LogRow { time_s, roll_rad, speed_mps, trailer_mass_kg, ..LogRow::ABSENT };
        match self {
            Self::Steer => LogRow { steer_rad: row.steer_rad, ..bare },
            Self::YawRate => LogRow { yaw_rate_radps: row.yaw_rate_radps, ..bare },
            Self::LateralAcceleration => {
                LogRow { lateral_acceleration_mps2: row.lateral_acceleration_mps2, ..bare }
            }
        }
    }
}

fn s_curves(wavelength_m: f64, speed_mps: f64) -> Road {
    let greatest_per_m = LATERAL_MPS2 / (speed_mps * speed_mps);
    let point = |k: u32| {
        let distance_m = 2.0 * f64::from(k);
        let angle = std::f64::consts::TAU * (distance_m - STRAIGHT_M) / wavelength_m;
        let curvature_per_m = if angle > 0.0 { greatest_per_m * angle.sin() } else { 0.0 };
        RoadPoint { distance_m, curvature_per_m, bank_rad: 0.0, grade_rad: 0.0, speed_mps }
    };
    Road::new("S-curves", (0..600).map(point).collect()).unwrap()
}

fn scenario(vehicle: &Vehicle, load: Load, maneuver: Maneuver, snr_db: f64) -> Scenario {
    let sensors = Sensors { snr_db: Some(snr_db), ..Sensors::default() };
    let usual = Scenario::of(vehicle, maneuver);
    Scenario { load, plant: Plant::Nonlinear, rate_hz: 50.0, sensors, ..usual }
}

fn calibrated(vehicle: &Vehicle) -> Design<f64> {
    let known = steps(vehicle);
    let calibrator = Calibrator::new(vehicle, CalibrateOptions::default(), &known).unwrap();
    let found = calibrator.calibrate(&[], |log, estimator| {
        let is_empty = log.log == "empty";
        let (payload_kg, height_m) = if is_empty { (0.0, 0.0) } else { (20e3, 2.1) };
        let load = laden(vehicle, payload_kg, height_m);
        let step = scenario(vehicle, load, Maneuver::RoundedStep, 35.0);
        for row in LogSimulation::new(vehicle, step).unwrap().rows() {
            estimator.push(&row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(vehicle, Variant::Complete, &found.unwrap().belief()).unwrap()
}

/// Relative error and standard deviation of the height from each input in each piece; `None` without a height.
type Found = [[Option<[f64; 2]>; PIECES_S.len()]; INPUTS.len()];

fn found(vehicle: &Vehicle, design: &Design<f64>, wavelength_m: f64) -> Found {
    let load = laden(vehicle, 14e3, 1.9);
    let road = s_curves(wavelength_m, vehicle.nominal_speed_mps);
    let drive = Scenario { duration_s: 60.0, ..scenario(vehicle, load, Maneuver::Drive, 30.0) };
    let simulation =
        LogSimulation::on_road(vehicle, drive, &road, &ChassisSensors::default()).unwrap();
    let rows = simulation.rows();
    INPUTS.map(|input| {
        PIECES_S.map(|[from_s, to_s]| {
            let options = EstimateOptions::default().with_file(vehicle);
            let mut estimator = LogEstimator::from_design(design, AlignSettings::NONE, options);
            for row in rows.iter().filter(|row| (from_s..to_s).contains(&row.time_s)) {
                estimator.push(&input.alone(row)).unwrap();
            }
            let found = estimator.finish();
            Some([found.height_m? / load.cg_height_m - 1.0, found.height_sd_m? / load.cg_height_m])
        })
    })
}

/// Without the share of the model's error and the lead of the trailer's lateral acceleration over its yaw rate, 23 of 70 intervals of
/// pieces miss (8 of the steer angle, 13 of the yaw rate), and heights from the yaw rate are 3.8 % rms in whole drives. Of 24
/// intervals of 95 %, 1.2 miss, with a standard deviation of 1.1; three of them.
#[test]
fn intervals_of_pieces_of_s_curves_hold() {
    let trucks = TRUCKS.map(common::vehicle);
    let cases: Vec<_> = trucks
        .par_iter()
        .flat_map_iter(|vehicle| {
            let design = calibrated(vehicle);
            WAVELENGTHS_M.map(move |wavelength_m| found(vehicle, &design, wavelength_m))
        })
        .collect();
    for (k, input) in INPUTS.iter().enumerate() {
        let of = |pieces: std::ops::Range<usize>| -> Vec<[f64; 2]> {
            cases
                .iter()
                .flat_map(|case| case[k][pieces.clone()].iter().flatten().copied())
                .collect()
        };
        for (what, found) in [("pieces", of(0..2)), ("whole drives", of(2..3))] {
            #[allow(clippy::cast_precision_loss)] // dozens
            let rms = |index: usize| {
                let sum = found.iter().map(|one| one[index].powi(2)).sum::<f64>();
                100.0 * (sum / found.len() as f64).sqrt()
            };
            let name = format!("{input:?}, {what}");
            let missed = found.iter().filter(|[error, sd]| error.abs() > QUANTILE_95 * sd).count();
            println!(
                "{name}: {} heights, {missed} miss, {:.1} % rms, {:.1} % stated",
                found.len(),
                rms(0),
                rms(1)
            );
            assert!(found.len() >= if what == "pieces" { 20 } else { 12 }, "{name}");
            assert!(missed <= 4, "{name}: {missed}");
            // A drive that begins on the straight shows the gain itself; nothing is extrapolated.
            assert!(what == "pieces" || (missed == 0 && rms(0) < 1.0 && rms(1) < 2.0), "{name}");
        }
    }
}
