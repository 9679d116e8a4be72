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
use cg_vehicle::calibration::Calibration;
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

/// The calibration of a vehicle file with a run of the empty truck, and one of each load.
fn calibration(
    vehicle: &Vehicle,
    laden: &[Load],
    run: impl Fn(Load) -> Vec<LogRow>,
) -> Calibration {
    let empty = Load {
        trailer_mass_kg: vehicle.empty_trailer_mass_kg(),
        cg_height_m: vehicle.trailer.tare.cg_height_m,
    };
    let known =
        laden.iter().map(|load| KnownLoad::exact(load.cg_height_m, Some(load.trailer_mass_kg)));
    let logs: Vec<_> = std::iter::once(KnownLoad::Empty)
        .chain(known)
        .enumerate()
        .map(|(k, load)| KnownLog { log: k.to_string(), load })
        .collect();
    let runs: Vec<_> = std::iter::once(empty).chain(laden.iter().copied()).map(run).collect();
    let options = CalibrateOptions::default();
    let found = calibrate(vehicle, options, &logs, |log, estimator| {
        let place: usize = log.log.parse().unwrap();
        for row in &runs[place] {
            estimator.push(row).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    found.unwrap()
}

/// The design of a vehicle file after two steps of the truck itself.
fn calibrated(vehicle: &Vehicle, truck: &Vehicle, laden: Load) -> Design<f64> {
    let found = calibration(vehicle, &[laden], |load| step(truck, load));
    assert!(!found.statement.iter().any(|line| line.contains("so tight")), "{:?}", found.statement);
    design_with(vehicle, Variant::Complete, &found.belief()).unwrap()
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
    let (mut heights, mut missed) = (0, 0);
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
                    missed += usize::from(!(low < cg_height_m && cg_height_m < high));
                }
            }
        }
    }
    // Ten loads, four turns, five cases each. Others have a message, most often that the roll angle of a steady turn stood still.
    println!("{heights} of 200, {missed} miss");
    assert!(heights >= 160, "{heights}");
    // Of 160 intervals of 95 %, eight may. The one that does is the tractor's in a turn of 15 m, by 0.3 % of the height.
    assert!(missed <= 2, "{missed}");
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

/// A calibration in tight turns counts for less: 5 % of later intervals may miss. Without the articulation in the weight of its
/// runs, 21 of 149 do. A turn of 20 m is told.
#[test]
fn later_intervals_hold_after_a_calibration_in_tight_turns() {
    let (mut heights, mut missed) = (0, 0);
    for name in ["kraz", "euro", "air", "baseline", "baseline-tables"] {
        let mut vehicle = common::vehicle(&format!("{name}.toml"));
        vehicle.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
        let reference = vehicle.reference_load();
        let empty_kg = vehicle.empty_trailer_mass_kg();
        let load = |(share, cg_height_m): (f64, f64)| {
            let trailer_mass_kg = empty_kg + share * (reference.trailer_mass_kg - empty_kg);
            Load { trailer_mass_kg, cg_height_m }
        };
        for radius_m in [20.0, 27.0] {
            let run = |load| rows(&vehicle, load, &turn(radius_m));
            let laden = [(0.5, 2.2), (1.0, 1.8)].map(load);
            let found = calibration(&vehicle, &laden, run);
            let is_told = found.statement.iter().any(|line| line.contains("so tight"));
            assert!(is_told || radius_m > 20.0, "{name}: {:?}", found.statement);
            let design = design_with(&vehicle, Variant::Complete, &found.belief()).unwrap();
            for (share, cg_height_m) in [(0.4, 1.7), (0.7, 2.2), (1.0, 1.9)] {
                let measured = step(&vehicle, load((share, cg_height_m)));
                for channel in Channel::ALL.map(Some).into_iter().chain([None]) {
                    let options = EstimateOptions { channel, ..EstimateOptions::default() };
                    let settings = vehicle.align_settings();
                    let mut estimator = LogEstimator::from_design(&design, settings, options);
                    for row in &measured {
                        estimator.push(row).unwrap();
                    }
                    let [low, high] = estimator.finish().height_ci95_m.unwrap();
                    heights += 1;
                    if !(low..high).contains(&cg_height_m) {
                        missed += 1;
                        println!(
                            "{name} {radius_m} m {share} {cg_height_m} m {channel:?}: {low:.3} to {high:.3} m"
                        );
                    }
                }
            }
        }
    }
    println!("{missed} of {heights}");
    assert!(heights == 150 && missed * 20 <= heights, "{missed}");
}

/// The ratio of a run is as uncertain as its articulation says, besides what it is without: for a trailer without a length,
/// which does not articulate. This rest is 3 %, and may change by a tenth with the height: by a third of the square of what
/// articulation adds, 2.5 %. The curvature is that at the greatest lateral acceleration, a few percent above the mean, and the
/// standard deviation grows with at most its fourth power.
#[test]
fn a_run_in_tight_turns_counts_for_as_much_as_its_articulation_says() {
    let vehicle = common::vehicle("euro.toml");
    let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
    let radius_m = 20.0;
    let rows = rows(&vehicle, vehicle.reference_load(), &turn(radius_m));
    for channel in [Channel::Suspension, Channel::Tractor] {
        let sd = |trailer_wheelbase_m: f64| {
            let mut design = design;
            design.trailer_wheelbase_m = trailer_wheelbase_m;
            let settings = vehicle.align_settings();
            let mut estimator =
                LogEstimator::from_design(&design, settings, EstimateOptions::default());
            for row in &rows {
                estimator.push(row).unwrap();
            }
            let ratio = estimator.identified().ratio[channel.index()].unwrap();
            ratio.sd / ratio.value
        };
        let (with, without) = (sd(design.trailer_wheelbase_m), sd(0.0));
        let found = (with * with - without * without).sqrt();
        let expected = design.articulated_sd(channel, 1.0 / radius_m, false);
        println!("{channel}: {found:.4}, {expected:.4}; without {without:.4}");
        assert!((0.8 * expected..1.3 * expected).contains(&found), "{channel}: {found} {expected}");
    }
}

/// What turns make of the ratios of a calibration has one sign, so that it counts once for all of its runs: a third run adds its
/// variance once more to each. The bounds are those of the test of one run.
#[test]
fn more_runs_in_tight_turns_do_not_say_more() {
    let vehicle = common::vehicle("euro.toml");
    let reference = vehicle.reference_load();
    let half = Load {
        trailer_mass_kg: f64::midpoint(vehicle.empty_trailer_mass_kg(), reference.trailer_mass_kg),
        ..reference
    };
    let of_tractor = |laden: &[Load]| {
        let found = calibration(&vehicle, laden, |load| rows(&vehicle, load, &turn(20.0)));
        let is_tractor = |name: &str| name == Channel::Tractor.to_string();
        let channel = found.run[0].channel.iter().find(|one| is_tractor(&one.name)).unwrap();
        channel.ratio_sd / channel.ratio
    };
    let (two, three) = (of_tractor(&[reference]), of_tractor(&[half, reference]));
    let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
    let expected = design.articulated_sd(Channel::Tractor, 1.0 / 20.0, false);
    let added = (three * three - two * two).max(0.0).sqrt();
    println!("{two:.4} {three:.4}: {added:.4}, {expected:.4}");
    assert!((0.8 * expected..1.3 * expected).contains(&added), "{added} {expected}");
}
