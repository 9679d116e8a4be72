//! Pairs of suspension roll and specific force on measured springs with friction (leaf springs, and air
//! springs under the trailer and the drive axles): drives of the nonlinear plant on banked roads with usual
//! sensors, as the vehicle file and calibrated on two flat drives. `CG_DRIVES=24` drives more on each road.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../../cg-vehicle/tests/common/mod.rs"]
mod common;

use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadKind};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::{design, design_with};
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use rayon::prelude::*;

/// Drives on each kind of road if the environment says nothing.
const DRIVES: u64 = 8;

/// A vehicle file, the greater height of its loads (with the air springs the truck rolls over at 2.1 m),
/// and the greatest root mean square of the errors of both pairs after a calibration, on all roads together.
type Case = (&'static str, f64, [f64; 2]);
/// Wanted are 1.5 % and 2.5 %. Where both axle groups have leaf springs, the friction is calculated to a
/// tenth only, and the tractor's suspension, which rolls by 2 to 7 mrad, is judged by its interval alone.
const CASES: [Case; 2] =
    [("baseline-tables.toml", 2.1, [0.025, 0.15]), ("air.toml", 1.85, [0.015, 0.04])];

fn laden(vehicle: &Vehicle, payload_kg: f64, cg_height_m: f64) -> Load {
    Load { trailer_mass_kg: vehicle.empty_trailer_mass_kg() + payload_kg, cg_height_m }
}

/// What the sensors of the chassis measure.
fn rows(vehicle: &Vehicle, load: Load, road: &Road, seed: u64) -> Vec<LogRow> {
    let scenario = Scenario {
        load,
        seed,
        rate_hz: 50.0,
        duration_s: road.usual_duration_s(),
        ..Scenario::of(vehicle, Maneuver::Drive)
    };
    let chassis = ChassisSensors::usual();
    let simulation = LogSimulation::on_road(vehicle, scenario, road, &chassis).unwrap();
    let measured = |row: &LogRow| LogRow {
        time_s: row.time_s,
        speed_mps: row.speed_mps,
        trailer_mass_kg: row.trailer_mass_kg,
        suspension_roll_rad: row.suspension_roll_rad,
        lateral_specific_force_mps2: row.lateral_specific_force_mps2,
        tractor_suspension_roll_rad: row.tractor_suspension_roll_rad,
        tractor_lateral_specific_force_mps2: row.tractor_lateral_specific_force_mps2,
        ..LogRow::ABSENT
    };
    simulation.rows().iter().map(measured).collect()
}

/// The design after a nearly empty and a loaded drive on flat roads.
fn calibrated(vehicle: &Vehicle, high_m: f64) -> Design<f64> {
    let known = [laden(vehicle, 2e3, 1.45), laden(vehicle, 22e3, high_m)];
    let logs = known.map(|load| KnownLog {
        log: format!("{} m", load.cg_height_m),
        load: KnownLoad::Laden { height_m: load.cg_height_m, trailer_mass_kg: None },
    });
    let road = Road::kind(RoadKind::Rural, 99).unwrap().flat();
    let drives = known.map(|load| rows(vehicle, load, &road, 99));
    // The sensors were calibrated on a flat road and are used on others.
    let mut flat = vehicle.clone();
    flat.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
    let found = calibrate(&flat, CalibrateOptions::default(), &logs, |log, estimator| {
        let place = logs.iter().position(|other| other.log == log.log).unwrap();
        for row in &drives[place] {
            estimator.push(row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(vehicle, Variant::Complete, &found.unwrap().belief()).unwrap()
}

/// The rows of all drives on a kind of road, with their loads: four payloads, each at two heights.
fn drives(vehicle: &Vehicle, high_m: f64, kind: RoadKind) -> Vec<(Load, Vec<LogRow>)> {
    let count = std::env::var("CG_DRIVES").map_or(DRIVES, |count| count.parse().unwrap());
    let drive = |seed: u64| {
        let payload_kg = [7.5e3, 12.5e3, 17.5e3, 25e3][usize::try_from(seed % 4).unwrap()];
        let load =
            laden(vehicle, payload_kg, if (seed / 4).is_multiple_of(2) { 1.6 } else { high_m });
        (load, rows(vehicle, load, &Road::kind(kind, seed).unwrap(), seed))
    };
    (0..count).into_par_iter().map(drive).collect()
}

/// Root mean square of the error and mean of the stated standard deviation of a pair, both relative to
/// the height. Every drive gives a height, and every interval holds it.
fn judged(
    vehicle: &Vehicle,
    design: &Design<f64>,
    pair: Channel,
    drives: &[(Load, Vec<LogRow>)],
) -> [f64; 2] {
    let options = EstimateOptions { channel: Some(pair), ..EstimateOptions::default() };
    let (mut square, mut stated) = (0.0, 0.0);
    for (load, rows) in drives {
        let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
        for row in rows {
            estimator.push(row).unwrap();
        }
        let found = estimator.finish();
        let ([low, high], truth_m) = (found.height_ci95_m.unwrap(), load.cg_height_m);
        assert!(std::env::var("CG_SHOW").is_ok() || low < truth_m && truth_m < high, "{pair} {load:?}: {low} {high}");
        square += (found.height_m.unwrap() / truth_m - 1.0).powi(2);
        if std::env::var("CG_SHOW").is_ok() { eprintln!("  {pair} m={:.0} h={truth_m} err={:+.1}% sd={:.1}%", load.trailer_mass_kg, 100.0*(found.height_m.unwrap()/truth_m-1.0), 100.0*found.height_sd_m.unwrap()/truth_m); }
        stated += found.height_sd_m.unwrap() / truth_m;
    }
    #[allow(clippy::cast_precision_loss)] // a few
    let n = drives.len() as f64;
    [(square / n).sqrt(), stated / n]
}

/// Friction makes springs stiffer in small motion than in the motion for which the model is linear. The
/// intervals have to contain that with either pair, and what a pair leaves must be within the standard
/// deviation that is stated: a mean of 24 squared errors above its stated value by half has a
/// probability of 4 % if the statement is true. The errors are less, because the interval also contains what
/// these drives do not have: road twist, and friction that changes from drive to drive.
#[test]
fn intervals_hold_on_measured_springs() {
    let roads = [RoadKind::Rural, RoadKind::Motorway, RoadKind::Roundabouts];
    println!("| vehicle | calibrated with | pair | road | RMSE | stated sd |");
    for (name, high_m, greatest) in CASES {
        let mut vehicle = common::vehicle(name);
        if let Ok(f) = std::env::var("CG_FR") { let f: f64 = f.parse().unwrap(); vehicle.spring = vehicle.spring.iter().map(|s| s.clone().with_friction(f)).collect(); }
        let vehicle = vehicle;
        let file = design(&vehicle, Variant::Complete).unwrap();
        let designs = [("file", &file), ("two flat drives", &calibrated(&vehicle, high_m))];
        let drives = roads.map(|kind| drives(&vehicle, high_m, kind));
        for (known, design) in designs {
            for (pair, greatest) in [Channel::Suspension, Channel::Tractor].iter().zip(greatest) {
                let (mut square, mut stated) = (0.0, 0.0);
                for (kind, drives) in roads.iter().zip(&drives) {
                    let [rms, sd] = judged(&vehicle, design, *pair, drives);
                    let (rms_percent, sd_percent) = (100.0 * rms, 100.0 * sd);
                    println!(
                        "| {name} | {known} | `{pair}` | {kind} | {rms_percent:.1} % | {sd_percent:.1} % |"
                    );
                    square += rms * rms / 3.0;
                    stated += sd * sd / 3.0;
                }
                assert!(square < 1.5 * stated, "{name} {known} {pair}: {square} {stated}");
                let wanted = known == "file" || square.sqrt() < greatest;
                assert!(wanted, "{name} {known} {pair}: {}", square.sqrt());
            }
        }
    }
}
