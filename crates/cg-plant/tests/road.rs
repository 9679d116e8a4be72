//! Roads with bank: the roads themselves, drives along them, and what sensors show of them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::HashSet;

use cg_logs::log::{LogRow, Signal};
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadKind, RoadPoint};
use cg_plant::sensors::{ChassisSensors, Sensors};
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::sensor_places::{LevelSensors, SuspensionPressure};
use cg_vehicle::{Vehicle, VehicleError};

const KINDS: [RoadKind; 3] = [RoadKind::Rural, RoadKind::Motorway, RoadKind::Roundabouts];

fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
    Vehicle::load(format!("{folder}/{name}.toml")).unwrap()
}

fn scenario(vehicle: &Vehicle, duration_s: f64) -> Scenario {
    Scenario { duration_s, rate_hz: 50.0, ..Scenario::of(vehicle, Maneuver::Drive) }
}

fn rows(simulation: &LogSimulation) -> [Vec<LogRow>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    let mut keep = |k: usize, row: &LogRow| {
        found[k].push(*row);
        Ok::<(), VehicleError>(())
    };
    simulation.run_true(|row| keep(0, row)).unwrap();
    simulation.run(|row| keep(1, row)).unwrap();
    found
}

/// 24 seeds give 24 roads of each kind. They turn to both sides, the lateral acceleration at the
/// limits stays below 2 m/s², and the drive ends before the road.
#[test]
fn usual_roads_differ_and_are_drivable() {
    for kind in KINDS {
        let mut seen = HashSet::new();
        for seed in 0..24 {
            let road = Road::kind(kind, seed).unwrap();
            let pace = road.pace();
            assert!(seen.insert(format!("{:?}", road.points())), "{kind} {seed}");
            let [start_m, end_m] = road.ends_m();
            let usual_s = if kind == RoadKind::Rural { 150.0 } else { 120.0 };
            assert!((road.usual_duration_s() - usual_s).abs() < 1e-9, "{kind} {seed}");
            assert!(pace.time_s(start_m, end_m) >= usual_s);
            let (mut left, mut right) = (0.0_f64, 0.0_f64);
            for point in road.points() {
                let speed_mps = pace.speed_mps(point.distance_m);
                assert!(speed_mps <= point.speed_mps * (1.0 + 1e-9), "{kind} {seed} {point:?}");
                let lateral_mps2 = point.curvature_per_m * speed_mps * speed_mps;
                left = left.max(lateral_mps2);
                right = right.max(-lateral_mps2);
                assert!(point.bank_rad.abs() <= 0.06 + 1e-12);
            }
            // The widest curve: 1500 m at 85 km/h is 0.37 m/s².
            let both = [left, right];
            assert!(both.iter().all(|side| (0.3..2.0).contains(side)), "{kind} {seed} {both:?}");
        }
    }
}

/// The bank: superelevation leans into the curve (negative to the left), a roundabout's outward; both
/// by the rule of the kind.
#[test]
fn curves_are_banked_by_the_rule_of_their_kind() {
    let rule = |kind: RoadKind, radius_m: f64| match kind {
        RoadKind::Rural => (0.06 * 120.0 / radius_m).clamp(0.02, 0.06),
        RoadKind::Motorway => (0.05 * 400.0 / radius_m).clamp(0.02, 0.05),
        _ => -0.02,
    };
    for kind in KINDS {
        let road = Road::kind(kind, 5).unwrap();
        let mut steady = 0;
        // Ten meters of constant curvature and bank are the middle of a curve.
        for around in road.points().windows(21) {
            let [a, b] = [around[0], around[20]];
            let same = (a.curvature_per_m - b.curvature_per_m).abs() < 1e-12;
            if !same || around[10].curvature_per_m.abs() < 1e-4 {
                continue;
            }
            steady += 1;
            let curvature = around[10].curvature_per_m;
            let bank_rad = -rule(kind, 1.0 / curvature.abs()) * curvature.signum();
            assert!((around[10].bank_rad - bank_rad).abs() < 1e-9, "{kind} {:?}", around[10]);
        }
        assert!(steady > 100, "{kind} {steady}");
        let first = road.points()[0];
        assert!(first.curvature_per_m == 0.0 && (first.bank_rad - 0.02).abs() < 1e-12);
    }
}

/// A ramp of the bank from 100 m to 110 m on a straight road arrives when the place 5 m behind the
/// front axle is there. At constant speed the front axle is at speed times time.
#[test]
fn the_bank_arrives_at_its_distance() {
    let text =
        "distance_m,curvature_per_m,bank_rad\n0,0,0.01\n100,0,0.01\n110,0,0.03\n400,0,0.03\n";
    let road = Road::parse("ramp.csv", text).unwrap();
    let vehicle = vehicle("baseline");
    let scenario = Scenario { speed_mps: 12.5, ..scenario(&vehicle, 20.0) };
    let simulation =
        LogSimulation::on_road(&vehicle, scenario, &road, &ChassisSensors::default()).unwrap();
    let [rows, _] = rows(&simulation);
    for row in &rows {
        let at_m = 12.5 * row.time_s - 5.0;
        let bank_rad = 0.01 + 0.02 * ((at_m - 100.0) / 10.0).clamp(0.0, 1.0);
        // Articulation of less than a hundredth, squared.
        let shown_rad = row.roll_to_gravity_rad - row.roll_rad;
        assert!((shown_rad - bank_rad).abs() < 1e-5, "{} s: {shown_rad} {bank_rad}", row.time_s);
        assert!((row.speed_mps - 12.5).abs() < 1e-9);
    }
    let track = simulation.track.as_ref().unwrap();
    assert_eq!((track.time_s.len(), track.time_s[30]), (201, 3.0));
    assert!((track.distance_m[30] - 37.5).abs() < 1e-9);
    let truth = simulation.truth.road.as_ref().unwrap();
    assert_eq!(truth.name, "ramp.csv");
    assert!((truth.bank_rad[0] - 0.01).abs() < 1e-12 && (truth.bank_rad[1] - 0.03).abs() < 1e-12);
    // It is a straight drive: crab and roll steer leave a lateral acceleration for a moment only.
    let last = rows[rows.len() - 1];
    assert!(last.lateral_acceleration_mps2.abs() < 0.02, "{last:?}");
    assert!(last.roll_rad > 0.0);
}

/// Every fault of a road file is reported with file, line and column.
#[test]
fn faults_of_a_road_file_have_their_place() {
    let head = "# a road\ndistance_m, curvature_per_m, bank_rad, speed_mps\n0,0,0.02,20\n";
    for (text, expected) in [
        (format!("{head}10,abc,0,20\n"), "r.csv: line 4, column 2 `curvature_per_m`: `abc` is not"),
        (
            format!("{head}0,0,0,20\n"),
            "line 4, column 1 `distance_m`: the distance 0 must be greater",
        ),
        (
            format!("{head}9,0.5,0,20\n"),
            "line 4, column 2 `curvature_per_m`: the curvature (1/m) 0.5",
        ),
        (format!("{head}9,0,2.0,20\n"), "line 4, column 3 `bank_rad`: the bank (rad) 2 must lie"),
        (format!("{head}9,0,NaN,20\n"), "line 4, column 3 `bank_rad`: the bank (rad) NaN"),
        (format!("{head}9,0,0,-3\n"), "line 4, column 4 `speed_mps`: the speed -3 m/s"),
        (format!("{head}9,0,0\n"), "line: 4"),
        (head.to_owned(), "r.csv: a road has at least two points"),
        ("distance_m,bank_rad\n0,0\n".to_owned(), "line 1: no column `curvature_per_m`"),
        ("distance_m,bank_deg\n0,0\n".to_owned(), "line 1: `bank_deg` is not a column"),
        (
            "distance_m,distance_m\n0,0\n".to_owned(),
            "line 1: the column `distance_m` is there twice",
        ),
    ] {
        let error = Road::parse("r.csv", &text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
    let error = Road::load("no/such/road.csv").unwrap_err().to_string();
    assert!(error.contains("no/such/road.csv"), "{error}");
}

/// A road that is too short for the drive is refused.
#[test]
fn a_drive_does_not_go_beyond_its_road() {
    let text = "distance_m,curvature_per_m,bank_rad,speed_mps\n0,0,0,10\n100,0,0,10\n";
    let road = Road::parse("short.csv", text).unwrap();
    assert!((road.usual_duration_s() - 10.0).abs() < 1e-9);
    let vehicle = vehicle("baseline");
    let error = LogSimulation::on_road(
        &vehicle,
        scenario(&vehicle, 12.0),
        &road,
        &ChassisSensors::default(),
    );
    let error = error.err().unwrap().to_string();
    assert!(error.contains("short.csv: the road ends after 10.0 s"), "{error}");
}

/// Drives on each kind of road complete in the linear range, keep the speed limit, and turn as much as
/// the road does.
#[test]
fn drives_complete_and_follow_the_road() {
    let vehicle = vehicle("kraz");
    for kind in KINDS {
        let road = Road::kind(kind, 1).unwrap();
        let scenario = scenario(&vehicle, road.usual_duration_s());
        let simulation =
            LogSimulation::on_road(&vehicle, scenario, &road, &ChassisSensors::default()).unwrap();
        let [rows, _] = rows(&simulation);
        let peak =
            |of: fn(&LogRow) -> f64| rows.iter().map(|row| of(row).abs()).fold(0.0, f64::max);
        let lateral_mps2 = peak(|row| row.lateral_acceleration_mps2);
        println!("{kind}: peak {lateral_mps2:.2} m/s², roll {:.4} rad", peak(|row| row.roll_rad));
        assert!((1.0..2.5).contains(&lateral_mps2), "{kind} {lateral_mps2}");
        let turned_rad: f64 = rows.iter().map(|row| row.yaw_rate_radps).sum::<f64>() / 50.0;
        let track = simulation.track.as_ref().unwrap();
        let mut between = f64::NAN;
        for (k, distance_m) in track.distance_m.iter().enumerate() {
            let row = &rows[5 * k];
            assert!(
                row.speed_mps <= road.at(*distance_m).speed_mps * (1.0 + 1e-6),
                "{kind} {row:?}"
            );
            between = road.heading_rad(*distance_m) - road.heading_rad(0.0);
        }
        // The trailer is up to 15 m behind the front axle, in a roundabout half a radian.
        assert!((turned_rad - between).abs() < 0.6, "{kind} {turned_rad} {between}");
        let columns = simulation.columns();
        assert!(columns.contains(&Signal::TractorLevelLeft));
        assert!(!columns.contains(&Signal::DrivePressureLeft));
        assert_eq!(simulation.truth.road.as_ref().unwrap().name, kind.to_string());
    }
}

/// The flat road has the curves of the rural one of its seed, and nothing else.
#[test]
fn a_flat_road_is_a_rural_one_without_bank_and_grade() {
    let [flat, rural] = [RoadKind::Flat, RoadKind::Rural].map(|kind| Road::kind(kind, 5).unwrap());
    assert_eq!(flat.points().len(), rural.points().len());
    assert!(rural.points().iter().any(|point| point.bank_rad != 0.0 && point.grade_rad != 0.0));
    for (flat, rural) in flat.points().iter().zip(rural.points()) {
        let expected = RoadPoint { bank_rad: 0.0, grade_rad: 0.0, ..*rural };
        assert_eq!(*flat, expected);
    }
}

/// Perfect levels give the suspension roll, tilts the specific force, at the spread of the vehicle
/// file; the mean bellows pressure at rest is that of the drive axles' static load.
#[test]
fn levels_tilts_and_pressures_show_the_state() {
    let mut vehicle = vehicle("baseline");
    vehicle.sensors.level = Some(LevelSensors { spread_m: 0.8, gain: 1.1 });
    vehicle.sensors.drive_pressure =
        Some(SuspensionPressure { gauge_pa: [1e5, 5e5], axle_load_kg: [5000.0, 20_000.0] });
    let road = Road::kind(RoadKind::Rural, 2).unwrap();
    let simulation = LogSimulation::on_road(
        &vehicle,
        scenario(&vehicle, 20.0),
        &road,
        &ChassisSensors::default(),
    )
    .unwrap();
    let [rows, shown] = rows(&simulation);
    assert!(simulation.columns().contains(&Signal::DrivePressureLeft));
    let balance = cg_vehicle::balance::static_balance(&vehicle, vehicle.reference_load()).unwrap();
    let drive_kg: f64 = vehicle
        .axles()
        .iter()
        .zip(&balance.axle_load_n)
        .filter(|(axle, _)| !axle.on_trailer && !axle.steered)
        .map(|(_, load_n)| load_n / vehicle.gravity_mps2)
        .sum();
    let pressure_pa = 1e5 + 4e5 * (drive_kg - 5000.0) / 15_000.0;
    let mean_pa = 0.5 * (rows[0].drive_pressure_left_pa + rows[0].drive_pressure_right_pa);
    // The crown of 2 % takes 0.02 % of the weight.
    assert!((mean_pa / pressure_pa - 1.0).abs() < 1e-3, "{mean_pa} {pressure_pa}");
    for (row, shown) in rows.iter().zip(&shown) {
        assert_eq!(row.suspension_roll_rad.to_bits(), shown.suspension_roll_rad.to_bits());
        let roll_rad = 1.1 / 0.8 * (row.level_left_m - row.level_right_m);
        assert!((roll_rad - row.suspension_roll_rad).abs() < 1e-12);
        let tractor_rad = row.tractor_level_left_m - row.tractor_level_right_m;
        assert!((tractor_rad - row.tractor_suspension_roll_rad).abs() < 1e-12);
        let difference_rad = row.tilt_rad - row.axle_tilt_rad;
        assert!((difference_rad - row.suspension_roll_rad).abs() < 1e-12);
        assert!(
            (vehicle.gravity_mps2 * row.tilt_rad - row.lateral_specific_force_mps2).abs() < 1e-9
        );
    }
    let peak = rows.iter().map(|row| row.suspension_roll_rad.abs()).fold(0.0, f64::max);
    assert!(peak > 0.005, "{peak}");
}

/// Errors of the chassis' sensors have their size, and the suspension roll is that of the measured
/// levels. The signals of the other sensors keep their noise.
#[test]
fn errors_of_the_chassis_sensors_have_their_size() {
    let vehicle = vehicle("baseline");
    let chassis = ChassisSensors {
        level_offset_m: 0.002,
        level_noise_m: 0.0005,
        level_quantisation_m: 0.001,
        accelerometer_offset_mps2: 0.05,
        accelerometer_noise_mps2: 0.1,
        tilt_noise_rad: 0.003,
        mounting_rad: 0.017,
        ..ChassisSensors::default()
    };
    let sensors = Sensors { snr_db: Some(20.0), steer_noise_rad: 0.001, ..Sensors::default() };
    let drive = Scenario { sensors, rate_hz: 100.0, ..scenario(&vehicle, 40.0) };
    let road = Road::kind(RoadKind::Rural, 3).unwrap();
    let [truth, shown] = rows(&LogSimulation::on_road(&vehicle, drive, &road, &chassis).unwrap());
    let [_, before] =
        rows(&LogSimulation::on_road(&vehicle, drive, &road, &ChassisSensors::default()).unwrap());
    let errors = |of: fn(&LogRow) -> f64| -> (f64, f64) {
        let all: Vec<f64> = truth.iter().zip(&shown).map(|(a, b)| of(b) - of(a)).collect();
        #[allow(clippy::cast_precision_loss)] // 4001
        let n = all.len() as f64;
        let mean = all.iter().sum::<f64>() / n;
        (mean, (all.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt())
    };
    // Rounding adds the variance of a uniform distribution; 4001 values know a deviation to 1.1 %.
    let level_sd = (0.0005_f64.powi(2) + 0.001_f64.powi(2) / 12.0).sqrt();
    for (of, mean, sd) in [
        ((|row| row.level_left_m) as fn(&LogRow) -> f64, 0.002, level_sd),
        (|row| row.tractor_level_right_m, 0.0, level_sd),
        (|row| row.suspension_roll_rad, 0.002, level_sd * 2.0_f64.sqrt()),
        (|row| row.lateral_specific_force_mps2, 0.05 + vehicle.gravity_mps2 * 0.017_f64.sin(), 0.1),
        (|row| row.tilt_rad, 0.017, 0.003),
        (|row| row.axle_tilt_rad, 0.0, 0.003),
    ] {
        let found = errors(of);
        assert!((found.1 / sd - 1.0).abs() < 0.06, "{found:?} {mean} {sd}");
        assert!(
            (found.0 - mean).abs() < 4.0 * sd / 4001.0_f64.sqrt() + 1e-9,
            "{found:?} {mean} {sd}"
        );
    }
    for (shown, before) in shown.iter().zip(&before) {
        assert_eq!(shown.roll_rad.to_bits(), before.roll_rad.to_bits());
        assert_eq!(shown.steer_rad.to_bits(), before.steer_rad.to_bits());
        assert_eq!(shown.roll_to_gravity_rad.to_bits(), before.roll_to_gravity_rad.to_bits());
        let steps = shown.level_left_m / 0.001;
        assert!((steps - steps.round()).abs() < 1e-6);
        let levels_rad = shown.level_left_m - shown.level_right_m;
        assert!((shown.suspension_roll_rad - levels_rad).abs() < 1e-12);
    }
}

/// The bank of a straight road changes from −1 % to +1 % within 10 m. Without twist the whole truck
/// stands on one bank, so both suspensions roll to the same side, together. With twist the tractor
/// arrives first: its suspension and the trailer's roll against each other, and when both have passed
/// they are where they are without twist. The grade is in the log's truth only.
#[test]
fn axles_stand_on_the_bank_of_their_own_place() {
    let text = "distance_m,curvature_per_m,bank_rad,grade_rad\n0,0,-0.01,0.03\n\
                100,0,-0.01,0.03\n110,0,0.01,-0.02\n400,0,0.01,-0.02\n";
    let road = Road::parse("ramp.csv", text).unwrap();
    let vehicle = vehicle("kraz");
    let drive = |road: &Road| {
        let scenario = Scenario { speed_mps: 10.0, ..scenario(&vehicle, 16.0) };
        let none = ChassisSensors::default();
        let simulation = LogSimulation::on_road(&vehicle, scenario, road, &none).unwrap();
        assert_eq!(simulation.truth.road.as_ref().unwrap().is_twisted, road.is_twisted());
        rows(&simulation)[0].clone()
    };
    let (whole, twisted) = (drive(&road), drive(&road.clone().twisted()));
    let apart = |rows: &[LogRow]| {
        let rolls =
            rows.iter().map(|row| row.suspension_roll_rad - row.tractor_suspension_roll_rad);
        rolls.fold([0.0_f64; 2], |[low, high], roll| [low.min(roll), high.max(roll)])
    };
    let ([low, high], [low_twisted, high_twisted]) = (apart(&whole), apart(&twisted));
    assert!(low > -1.5e-3 && high < 1.5e-3, "{low} {high}");
    // The tractor's side is up first: its suspension rolls to the right, the trailer's holds it.
    assert!(low_twisted.min(-high_twisted) < -4e-3, "{low_twisted} {high_twisted}");
    let (a, b) = (whole.last().unwrap(), twisted.last().unwrap());
    assert!((a.suspension_roll_rad - b.suspension_roll_rad).abs() < 1e-4, "{a:?} {b:?}");
    assert!((a.tractor_suspension_roll_rad - b.tractor_suspension_roll_rad).abs() < 1e-4);
    let wrong = Road::parse("r.csv", &text.replace(",0.03\n100", ",0.9\n100")).unwrap_err();
    assert!(wrong.to_string().contains("column 4 `grade_rad`"), "{wrong}");
}
