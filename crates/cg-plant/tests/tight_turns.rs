//! Turns of a yard: 15 to 36 m of radius at 4.5 m/s on the nonlinear plant, flat road, no noise, after a
//! calibration at 50 km/h on an empty and a laden step.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadPoint};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

const SPEED_MPS: f64 = 4.5;

/// A straight, a turn that is entered and left within 10 m, and a straight.
fn turn(radius_m: f64) -> Road {
    let places_m = [(0.0, 0.0), (20.0, 0.0), (30.0, 1.0), (110.0, 1.0), (120.0, 0.0), (200.0, 0.0)];
    let points = places_m.map(|(distance_m, share)| RoadPoint {
        distance_m,
        curvature_per_m: share / radius_m,
        bank_rad: 0.0,
        grade_rad: 0.0,
        speed_mps: SPEED_MPS,
    });
    Road::new("yard", points.to_vec()).unwrap()
}

fn rows(vehicle: &Vehicle, load: Load, road: &Road) -> Vec<LogRow> {
    let scenario = Scenario {
        load,
        rate_hz: 50.0,
        duration_s: 38.0,
        ..Scenario::of(vehicle, Maneuver::Drive)
    };
    LogSimulation::on_road(vehicle, scenario, road, &ChassisSensors::default()).unwrap().rows()
}

/// A turn of 130 m at 50 km/h.
fn step(vehicle: &Vehicle, load: Load) -> Vec<LogRow> {
    let places_m = [(0.0, 0.0), (40.0, 0.0), (70.0, 1.0), (270.0, 1.0), (300.0, 0.0), (600.0, 0.0)];
    let points = places_m.map(|(distance_m, share)| RoadPoint {
        distance_m,
        curvature_per_m: share / 130.0,
        bank_rad: 0.0,
        grade_rad: 0.0,
        speed_mps: 50.0 / 3.6,
    });
    rows(vehicle, load, &Road::new("step", points.to_vec()).unwrap())
}

/// The design of a vehicle file after two steps of the truck itself.
fn calibrated(vehicle: &Vehicle, truck: &Vehicle, laden: Load) -> Design<f64> {
    let empty = Load {
        trailer_mass_kg: vehicle.empty_trailer_mass_kg(),
        cg_height_m: vehicle.trailer.tare.cg_height_m,
    };
    let runs = [empty, laden].map(|load| step(truck, load));
    let logs = [
        KnownLog { log: "0".to_owned(), load: KnownLoad::Empty },
        KnownLog { log: "1".to_owned(), load: KnownLoad::exact(laden.cg_height_m, None) },
    ];
    let options = CalibrateOptions::default();
    let found = calibrate(vehicle, options, &logs, |log, estimator| {
        for row in &runs[usize::from(log.log == "1")] {
            estimator.push(row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(vehicle, Variant::Complete, &found.unwrap().belief()).unwrap()
}

/// The rows with the lateral acceleration of the yaw rate.
fn by_yaw_rate(rows: &[LogRow]) -> Vec<LogRow> {
    let without = |row: &LogRow| LogRow { lateral_acceleration_mps2: f64::NAN, ..*row };
    rows.iter().map(without).collect()
}

/// The trailer stands at up to half a radian to the tractor. Every height is within its interval, in every
/// channel. In the turns of 15 m the tractor's pair gives none, and elsewhere a few cases may not.
#[test]
fn intervals_hold_in_turns_of_a_yard() {
    let mut heights = 0;
    println!(
        "| truck, axis of the tractor, in its file | load | radius | channel | error | stated sd |"
    );
    // The axis of the fifth wheel in the plant, and whether the file knows it.
    for (name, on_tractor, known) in [
        ("kraz", true, false),
        ("kraz", false, false),
        ("euro", true, true),
        ("euro", false, true),
        ("air", true, true),
    ] {
        let mut plant = common::vehicle(&format!("{name}.toml"));
        plant.hitch.tilts_on_tractor = Some(on_tractor);
        let mut vehicle = plant.clone();
        vehicle.hitch.tilts_on_tractor = known.then_some(on_tractor);
        vehicle.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
        let reference = vehicle.reference_load();
        let design = calibrated(&vehicle, &plant, reference);
        for (share, cg_height_m) in [(0.6, 1.7), (1.0, 2.0)] {
            let empty_kg = vehicle.empty_trailer_mass_kg();
            let payload_kg = share * (reference.trailer_mass_kg - empty_kg);
            let load = Load { trailer_mass_kg: empty_kg + payload_kg, cg_height_m };
            for radius_m in [15.0, 20.0, 30.0, 36.0] {
                let measured = rows(&plant, load, &turn(radius_m));
                let by_yaw_rate = by_yaw_rate(&measured);
                let cases = Channel::ALL.map(|channel| (channel, &measured));
                let cases = cases.into_iter().chain([(Channel::LateralAcceleration, &by_yaw_rate)]);
                for (k, (channel, rows)) in cases.enumerate() {
                    let options =
                        EstimateOptions { channel: Some(channel), ..EstimateOptions::default() };
                    let settings = vehicle.align_settings();
                    let mut estimator = LogEstimator::from_design(&design, settings, options);
                    for row in rows {
                        estimator.push(row).unwrap();
                    }
                    let found = estimator.finish();
                    let case = format!(
                        "{name} {on_tractor} {known} {payload_kg:.0} kg {radius_m} m {channel} {k}"
                    );
                    let Some(height_m) = found.height_m else {
                        println!("{case}: {:?}", found.messages);
                        continue;
                    };
                    heights += 1;
                    let error = height_m / cg_height_m - 1.0;
                    let sd = found.height_sd_m.unwrap() / cg_height_m;
                    println!("| {case} | {:+.1} % | {:.1} % |", 100.0 * error, 100.0 * sd);
                    let [low, high] = found.height_ci95_m.unwrap();
                    assert!(low < cg_height_m && cg_height_m < high, "{case}: {low} to {high}");
                }
            }
        }
    }
    // Ten loads, four turns, five cases each. Others have a message, most often that the roll angle of a steady turn stood still.
    println!("{heights} of 200");
    assert!(heights >= 160, "{heights}");
}

/// Roundabouts to both sides, one after the other, each entered and left within most of its radius.
fn roundabouts(radius_m: f64) -> Road {
    let shares = [(0.8, 1.0), (3.1, 1.0), (0.8, 0.0), (2.5, 0.0)];
    let mut points = Vec::new();
    let mut distance_m = 0.0;
    let mut add = |length_m: f64, curvature_per_m: f64| {
        distance_m += length_m;
        let speed_mps = 6.0;
        points.push(RoadPoint {
            distance_m,
            curvature_per_m,
            bank_rad: 0.0,
            grade_rad: 0.0,
            speed_mps,
        });
    };
    add(0.0, 0.0);
    add(40.0, 0.0);
    for side in [1.0, -1.0, 1.0, -1.0] {
        for (length, share) in shares {
            add(length * radius_m, side * share / radius_m);
        }
    }
    Road::new("roundabouts", points).unwrap()
}

/// A compensated accelerometer in roundabouts, where the circle of the trailer is smaller than that of the tractor by as much as
/// gravity would make its force greater. Correct forces have no such message.
#[test]
fn a_specific_force_without_gravity_gives_no_height_in_roundabouts() {
    for name in ["euro", "kraz", "air"] {
        let vehicle = common::vehicle(&format!("{name}.toml"));
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        let load = vehicle.reference_load();
        for radius_m in [18.0, 22.0, 30.0] {
            let scenario = Scenario { duration_s: 80.0, ..Scenario::of(&vehicle, Maneuver::Drive) };
            let scenario = Scenario { load, rate_hz: 50.0, ..scenario };
            let (road, sensors) = (roundabouts(radius_m), ChassisSensors::default());
            let rows = LogSimulation::on_road(&vehicle, scenario, &road, &sensors).unwrap().rows();
            for compensated in [false, true] {
                let mut estimator = LogEstimator::from_design(
                    &design,
                    vehicle.align_settings(),
                    EstimateOptions::default(),
                );
                for row in &rows {
                    let force_mps2 = if compensated {
                        row.lateral_acceleration_mps2
                    } else {
                        row.lateral_specific_force_mps2
                    };
                    let pair = LogRow {
                        time_s: row.time_s,
                        speed_mps: row.speed_mps,
                        yaw_rate_radps: row.yaw_rate_radps,
                        suspension_roll_rad: row.suspension_roll_rad,
                        lateral_specific_force_mps2: force_mps2,
                        ..LogRow::ABSENT
                    };
                    estimator.push(&pair).unwrap();
                }
                let found = estimator.finish();
                let told = found.messages.join("; ");
                let case = format!("{name} {radius_m} m, {compensated}: {told}");
                let is_told = told.contains("does not contain the gravity");
                assert_eq!(
                    (is_told, found.height_m.is_none()),
                    (compensated, compensated),
                    "{case}"
                );
            }
        }
    }
}
