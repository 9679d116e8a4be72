//! Simulated logs: the sensor errors are measured in the written file, and the estimator runs on logs
//! of the nonlinear plant with one fault at a time.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::PI;
use std::path::Path;

use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator, Verdict};
use cg_logs::log::{LogOptions, LogReader, LogRow, LogWriter};
use cg_output::{Files, Kind};
use cg_plant::maneuver::{Course, Maneuver};
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::balance::static_balance;
use cg_vehicle::sensor_places::SuspensionPressure;
use cg_vehicle::{Load, Vehicle};

fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
    Vehicle::load(format!("{folder}/{name}.toml")).unwrap()
}

fn read(path: &Path) -> Vec<LogRow> {
    let mut reader = LogReader::open(path, &LogOptions::default()).unwrap();
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row().unwrap() {
        rows.push(row);
    }
    rows
}

/// The rows of a written log and the true rows.
fn written(vehicle: &Vehicle, scenario: Scenario) -> (Vec<LogRow>, Vec<LogRow>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let simulation = LogSimulation::new(vehicle, scenario).unwrap();
    let target = Files::new(false).writes("path", &path, Kind::Frames).unwrap();
    let mut writer = LogWriter::create(&target, &[], &scenario.sensors.columns()).unwrap();
    simulation.run(|row| writer.write_row(row)).unwrap();
    writer.finish().unwrap();
    let mut truth = Vec::new();
    simulation
        .run_true(|row| {
            truth.push(*row);
            Ok::<(), ()>(())
        })
        .unwrap();
    let rows = read(&path);
    assert_eq!(rows.len(), truth.len());
    (rows, truth)
}

fn sine(vehicle: &Vehicle, sensors: Sensors) -> (Vec<LogRow>, Vec<LogRow>) {
    written(vehicle, Scenario { sensors, ..Scenario::of(vehicle, Maneuver::Sine) })
}

fn differences(rows: &[LogRow], truth: &[LogRow], of: fn(&LogRow) -> f64) -> Vec<f64> {
    rows.iter().zip(truth).map(|(row, truth)| of(row) - of(truth)).collect()
}

fn roll(row: &LogRow) -> f64 {
    row.roll_rad
}

#[allow(clippy::cast_precision_loss)] // thousands of rows
fn mean_and_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}

#[test]
fn perfect_sensors_show_the_truth() {
    let (rows, truth) = sine(&vehicle("kraz"), Sensors::default());
    assert!(differences(&rows, &truth, roll).iter().all(|d| *d == 0.0));
    assert!(rows.iter().all(|row| row.tilt_rad.is_nan() && row.steering_wheel_rad.is_nan()));
}

/// A scale under the trailer's axles gives the same mass as a scale under the whole trailer: the balance
/// is linear, so they differ by rounding only. The payload is not that of the vehicle file.
#[test]
fn axle_load_or_suspension_pressure_stand_in_for_the_mass() {
    let vehicle = vehicle("kraz");
    let trailer_mass_kg = vehicle.reference_load().trailer_mass_kg - 4000.0;
    let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
    let hitch_kg = static_balance(&vehicle, load).unwrap().hitch_load_n / vehicle.gravity_mps2;
    let scenario = Scenario { load, ..Scenario::of(&vehicle, Maneuver::Sine) };
    let (rows, _) = written(&vehicle, scenario);
    let estimate = |vehicle: &Vehicle, weigh: &dyn Fn(&mut LogRow)| {
        let mut estimator = LogEstimator::new(vehicle, EstimateOptions::default()).unwrap();
        for row in &rows {
            let mut row = *row;
            weigh(&mut row);
            estimator.push(&row).unwrap();
        }
        estimator.finish()
    };
    let weighed = estimate(&vehicle, &|_| {});
    let by_axles = estimate(&vehicle, &|row| {
        row.trailer_axle_load_kg = row.trailer_mass_kg - hitch_kg;
        row.trailer_mass_kg = f64::NAN;
    });
    // The column of the mass is exact, and these scales are not.
    assert!(weighed.messages.is_empty(), "{:?}", weighed.messages);
    let says_only = |estimate: &LogEstimate, scale: &str| {
        let of_the_scale = format!("the trailer mass of {trailer_mass_kg:.0} kg is from {scale};");
        assert_eq!(estimate.messages.len(), 1, "{:?}", estimate.messages);
        assert!(estimate.messages[0].starts_with(&of_the_scale), "{:?}", estimate.messages);
        assert!(estimate.height_sd_m > weighed.height_sd_m);
    };
    says_only(&by_axles, "the load of the trailer's axles");
    assert!((by_axles.trailer_mass_kg / trailer_mass_kg - 1.0).abs() < 1e-9);
    let (expected, height_m) = (weighed.height_m.unwrap(), by_axles.height_m.unwrap());
    assert!((height_m / expected - 1.0).abs() < 1e-6, "{height_m} {expected}");
    // A gauge that shows 1.3 bar at 5 t and 5.3 bar at 25 t, with and without its calibration.
    let gauged = |row: &mut LogRow| {
        row.trailer_suspension_pressure_pa = 3e4 + 20.0 * (row.trailer_mass_kg - hitch_kg);
        row.trailer_mass_kg = f64::NAN;
    };
    let unscaled = estimate(&vehicle, &gauged);
    assert!(unscaled.messages.iter().any(|message| message.contains("suspension_pressure")));
    assert!((unscaled.trailer_mass_kg - vehicle.reference_load().trailer_mass_kg).abs() < 1e-9);
    let mut scaled = vehicle.clone();
    let (gauge_pa, axle_load_kg) = ([1.3e5, 5.3e5], [5e3, 25e3]);
    scaled.trailer.suspension_pressure = Some(SuspensionPressure { gauge_pa, axle_load_kg });
    let by_pressure = estimate(&scaled, &gauged);
    says_only(&by_pressure, "the pressure in the trailer's air suspension");
    assert!((by_pressure.height_m.unwrap() / expected - 1.0).abs() < 1e-6);
    let unweighed = estimate(&vehicle, &|row| row.trailer_mass_kg = f64::NAN).height_m.unwrap();
    assert!((unweighed / expected - 1.0).abs() > 1e-2, "{unweighed} {expected}");
}

#[test]
fn noise_has_its_signal_to_noise_ratio() {
    let (rows, truth) =
        sine(&vehicle("kraz"), Sensors { snr_db: Some(20.0), ..Sensors::default() });
    let (mean, sd) = mean_and_sd(&differences(&rows, &truth, roll));
    let (_, signal) = (0.0, mean_and_sd(&truth.iter().map(roll).collect::<Vec<_>>()));
    let square = signal.0.powi(2) + signal.1.powi(2);
    let snr_db = 10.0 * (square / (sd * sd)).log10();
    // From 2001 rows the sd is known to 1/√4000 (0.14 dB at one sigma), the mean to sd/√2001.
    assert!((snr_db - 20.0).abs() < 0.5, "{snr_db}");
    assert!(mean.abs() < 4.0 * sd / 44.0, "{mean}");
}

#[test]
fn offsets_are_added_and_nothing_else() {
    let sensors = Sensors { roll_offset_rad: 0.01, steer_offset_rad: -0.002, ..Sensors::default() };
    let (rows, truth) = sine(&vehicle("kraz"), sensors);
    assert!(differences(&rows, &truth, roll).iter().all(|d| (d - 0.01).abs() < 1e-15));
    let steer = differences(&rows, &truth, |row| row.steer_rad);
    assert!(steer.iter().all(|d| (d + 0.002).abs() < 1e-15));
}

#[test]
fn quantized_angles_are_whole_steps_within_half_a_step() {
    let step_rad = 0.05 * PI / 180.0;
    let sensors = Sensors { quantisation_rad: step_rad, ..Sensors::default() };
    let (rows, truth) = sine(&vehicle("kraz"), sensors);
    for (row, truth) in rows.iter().zip(&truth) {
        let steps = row.roll_rad / step_rad;
        assert!((steps - steps.round()).abs() < 1e-9);
        assert!((row.roll_rad - truth.roll_rad).abs() < 0.5 * step_rad + 1e-15);
    }
}

#[test]
fn a_late_sensor_shows_what_was() {
    let sensors = Sensors { delay_s: 0.123, ..Sensors::default() };
    let (rows, truth) = sine(&vehicle("kraz"), sensors);
    for (k, row) in rows.iter().enumerate().skip(13) {
        // 12.3 intervals ago: between two rows.
        let expected = 0.7 * truth[k - 12].roll_rad + 0.3 * truth[k - 13].roll_rad;
        assert!((row.roll_rad - expected).abs() < 1e-12, "{k}");
    }
}

#[test]
fn an_inclinometer_feels_lateral_acceleration() {
    let vehicle = vehicle("kraz");
    let (rows, truth) = sine(&vehicle, Sensors { inclinometer: true, ..Sensors::default() });
    for (row, truth) in rows.iter().zip(&truth) {
        let felt = truth.roll_rad + truth.lateral_acceleration_mps2 / vehicle.gravity_mps2;
        assert!((row.tilt_rad - felt).abs() < 1e-15 && row.roll_rad.is_nan());
    }
}

#[test]
fn time_stamps_lie_beside_the_sample_and_increase() {
    let (rows, truth) = sine(&vehicle("kraz"), Sensors { jitter_s: 0.004, ..Sensors::default() });
    let (mean, sd) = mean_and_sd(&differences(&rows, &truth, |row| row.time_s));
    // Uniform distribution: 0.004/√3, estimated from 2001 rows to 2 %.
    assert!((sd / (0.004 / 3f64.sqrt()) - 1.0).abs() < 0.06, "{sd}");
    assert!(mean.abs() < 4.0 * sd / 44.0, "{mean}");
    assert!(rows.windows(2).all(|pair| pair[1].time_s > pair[0].time_s));
}

#[test]
fn lost_rows_are_empty_and_as_many_as_asked() {
    let (rows, truth) = sine(&vehicle("kraz"), Sensors { drop_out: 0.2, ..Sensors::default() });
    #[allow(clippy::cast_precision_loss)]
    let lost = rows.iter().filter(|r| r.roll_rad.is_nan()).count() as f64 / rows.len() as f64;
    // Binomial distribution: √(0.2 · 0.8/2001) = 0.009.
    assert!((lost - 0.2).abs() < 0.036, "{lost}");
    let kept = rows.iter().zip(&truth).filter(|(row, _)| !row.roll_rad.is_nan());
    assert!(kept.clone().all(|(row, truth)| row.roll_rad.to_bits() == truth.roll_rad.to_bits()));
    assert!(rows.iter().all(|row| !row.steer_rad.is_nan()));
}

#[test]
fn the_steering_wheel_turns_by_the_ratio() {
    let mut vehicle = vehicle("kraz");
    let sensors = Sensors { steering_wheel: true, ..Sensors::default() };
    let scenario = Scenario { sensors, ..Scenario::of(&vehicle, Maneuver::Sine) };
    let refused = LogSimulation::new(&vehicle, scenario).err().unwrap().to_string();
    assert!(refused.contains("no steering_ratio"), "{refused}");
    vehicle.steering_ratio = Some(20.0);
    let (rows, truth) = written(&vehicle, scenario);
    for (row, truth) in rows.iter().zip(&truth) {
        assert!((row.steering_wheel_rad - 20.0 * truth.steer_rad).abs() < 1e-14);
        assert!(row.steer_rad.is_nan());
    }
}

#[test]
fn nonsense_is_refused_with_its_limits() {
    let vehicle = vehicle("kraz");
    let usual = Scenario::of(&vehicle, Maneuver::Sine);
    let perfect = Sensors::default();
    for (scenario, part) in [
        (Scenario { speed_mps: 1e300, ..usual }, "at most 60"),
        (Scenario { rate_hz: 1e7, ..usual }, "at most 10000"),
        (Scenario { rate_hz: 1e4, duration_s: 86e3, ..usual }, "more than 1e7 rows"),
        (Scenario { speed_change: 0.3, ..usual }, "⟨maneuver drive⟩"),
        (Scenario { to_rollover: true, ..usual }, "⟨plant nonlinear⟩"),
        (Scenario { sensors: Sensors { jitter_s: 0.005, ..perfect }, ..usual }, "0.0049"),
        (Scenario { sensors: Sensors { delay_s: -1.0, ..perfect }, ..usual }, "between 0 and 2"),
        (Scenario { sensors: Sensors { drop_out: 1.0, ..perfect }, ..usual }, "0.95"),
    ] {
        let refused = LogSimulation::new(&vehicle, scenario).err().unwrap().to_string();
        assert!(refused.contains(part), "no {part} in {refused}");
    }
}

/// A left turn of 90 degrees on 100 m gives `U²/R`, a right turn the same to the other side. The
/// driver follows the circle within half a meter (`plant::source`), which is half a percent.
#[test]
fn the_driver_turns_to_both_sides() {
    let vehicle = vehicle("baseline-tables");
    for side in [1.0, -1.0] {
        let course = Some(Course::Turn { angle_rad: side * PI / 2.0, radius_m: 100.0 });
        let usual = Scenario::of(&vehicle, Maneuver::SteadyTurn);
        let scenario = Scenario { plant: Plant::Nonlinear, course, duration_s: 12.0, ..usual };
        let (rows, _) = written(&vehicle, scenario);
        let held = rows.iter().filter(|row| (9.0..11.0).contains(&row.time_s));
        let (mean, _) = mean_and_sd(&held.map(|r| r.lateral_acceleration_mps2).collect::<Vec<_>>());
        let expected = side * vehicle.nominal_speed_mps.powi(2) / 100.0;
        println!("{mean:.3} m/s², expected {expected:.3}");
        assert!((mean / expected - 1.0).abs() < 0.03, "{mean} {expected}");
    }
}

#[test]
fn a_ramp_goes_to_rollover_and_says_when() {
    let vehicle = vehicle("baseline-tables");
    let usual = Scenario::of(&vehicle, Maneuver::Ramp);
    let scenario = Scenario { plant: Plant::Nonlinear, to_rollover: true, ..usual };
    let simulation = LogSimulation::new(&vehicle, scenario).unwrap();
    let over_s = simulation.truth.rolled_over_s.unwrap();
    let mut last_s = 0.0;
    let mut greatest_mps2 = 0.0_f64;
    simulation
        .run(|row| {
            last_s = row.time_s;
            greatest_mps2 = greatest_mps2.max(row.lateral_acceleration_mps2);
            Ok::<(), ()>(())
        })
        .unwrap();
    println!("over at {over_s:.2} s, greatest {greatest_mps2:.2} m/s²");
    assert!(last_s < over_s && over_s - last_s < 0.011);
    // This is faster than the quasi-static ramp (0.37 g, `rollover`), so the value is a little higher.
    assert!((0.34..0.45).contains(&(greatest_mps2 / 9.806_65)), "{greatest_mps2}");
}

/// Speed, sides and smoothness of a drive, in both plants; in the linear plant the models change with
/// the speed.
#[test]
fn a_drive_varies_its_speed_and_turns_to_both_sides() {
    let vehicle = vehicle("kraz");
    for plant in [Plant::Linear, Plant::Nonlinear] {
        let usual = Scenario::of(&vehicle, Maneuver::Drive);
        let scenario =
            Scenario { plant, speed_change: 0.3, duration_s: 120.0, rate_hz: 50.0, ..usual };
        let (rows, _) = written(&vehicle, scenario);
        let of = |get: fn(&LogRow) -> f64| {
            let values = rows.iter().map(get);
            (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
        };
        let (slow, fast) = of(|row| row.speed_mps);
        let (right, left) = of(|row| row.lateral_acceleration_mps2);
        println!("{plant:?}: {slow:.1} to {fast:.1} m/s, {right:.2} to {left:.2} m/s²");
        assert!(fast - slow > 2.0 && slow > 0.69 * 13.8 && fast < 1.31 * 13.9);
        assert!(right < -0.6 && left > 0.6 && left < 2.5 && right > -2.5);
        let jumps = rows.windows(2).map(|pair| (pair[1].roll_rad - pair[0].roll_rad).abs());
        // At 0.17 g the roll angle changes by 0.04 rad within half a second: 0.002 rad in 0.02 s, times two.
        assert!(jumps.fold(0.0, f64::max) < 4e-3);
    }
}

/// Single faults on logs of the nonlinear plant.
fn faults() -> Vec<(&'static str, Sensors)> {
    let perfect = Sensors::default();
    vec![
        ("perfect", perfect),
        ("noise of 20 dB", Sensors { snr_db: Some(20.0), ..perfect }),
        ("roll offset of 0.5 degrees", Sensors { roll_offset_rad: 0.0087, ..perfect }),
        ("steer offset of 0.25 degrees", Sensors { steer_offset_rad: 0.0044, ..perfect }),
        ("quantisation of 0.05 degrees", Sensors { quantisation_rad: 0.000_87, ..perfect }),
        ("delay of 0.1 s", Sensors { delay_s: 0.1, ..perfect }),
        ("inclinometer", Sensors { inclinometer: true, ..perfect }),
        ("jitter of 4 ms", Sensors { jitter_s: 0.004, ..perfect }),
        ("20 % lost", Sensors { drop_out: 0.2, ..perfect }),
    ]
}

/// The height stays inside its own 95 % interval or the log is rejected with a reason.
fn within_its_interval(name: &str, scenario: Scenario) -> Vec<String> {
    let vehicle = vehicle(name);
    let fresh = LogEstimator::new(&vehicle, EstimateOptions::default()).unwrap();
    let mut wrong = Vec::new();
    for (fault, sensors) in faults() {
        let simulation = LogSimulation::new(&vehicle, Scenario { sensors, ..scenario }).unwrap();
        let mut estimator = fresh.clone();
        simulation.run(|row| estimator.push(row).map(drop)).unwrap();
        let estimate = estimator.finish();
        let known_m = simulation.truth.height_m;
        let what = format!("{name}, {:?}, {fault}", scenario.maneuver);
        let (Verdict::Ok, Some(height_m), Some([low, high])) =
            (estimate.status, estimate.height_m, estimate.height_ci95_m)
        else {
            println!("{what}: rejected, {:?}", estimate.messages);
            assert!(!estimate.messages.is_empty(), "{what}: rejected without a reason");
            continue;
        };
        let error = 100.0 * (height_m / known_m - 1.0);
        let found = format!("{what}: {error:+.2} %, {low:.3} to {high:.3} m, true {known_m:.3} m");
        println!("{found}");
        if !(low..=high).contains(&known_m) {
            wrong.push(found);
        }
    }
    wrong
}

fn nonlinear(name: &str, maneuver: Maneuver) -> Scenario {
    Scenario { plant: Plant::Nonlinear, ..Scenario::of(&vehicle(name), maneuver) }
}

#[test]
fn heights_of_steady_turns_stay_inside_their_intervals() {
    for name in ["kraz", "baseline", "baseline-tables"] {
        let wrong = within_its_interval(name, nonlinear(name, Maneuver::SteadyTurn));
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}

#[test]
fn heights_of_drives_stay_inside_their_intervals() {
    for name in ["kraz", "baseline-tables"] {
        let scenario = nonlinear(name, Maneuver::Drive);
        let scenario = Scenario { speed_change: 0.3, duration_s: 120.0, ..scenario };
        let wrong = within_its_interval(name, scenario);
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}

/// Short maneuvers of the driver, as in the thesis (section 2.6).
#[test]
fn heights_of_drivers_maneuvers_stay_inside_their_intervals() {
    let turn = Course::Turn { angle_rad: PI / 2.0, radius_m: 100.0 };
    for name in ["kraz", "baseline-tables"] {
        for (maneuver, course, duration_s) in [
            (Maneuver::SteadyTurn, turn, 18.0),
            (Maneuver::LaneChange, Course::Gate { gate_m: 30.0 }, 10.0),
        ] {
            let course = Some(course);
            let scenario = Scenario { course, duration_s, ..nonlinear(name, maneuver) };
            let wrong = within_its_interval(name, scenario);
            assert!(wrong.is_empty(), "{wrong:#?}");
        }
    }
}
