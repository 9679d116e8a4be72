//! Logs with two loads, one after the other: the answer is that of the last one.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::{Load, Vehicle};

/// A drive with a load at a speed, from a time on.
fn drive(
    vehicle: &Vehicle,
    (payload_kg, cg_height_m): (f64, f64),
    speed_mps: f64,
    from_s: f64,
) -> Vec<LogRow> {
    let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
    let scenario = Scenario {
        load: Load { trailer_mass_kg, cg_height_m },
        speed_mps,
        rate_hz: 20.0,
        duration_s: 60.0,
        ..Scenario::of(vehicle, Maneuver::Drive)
    };
    let rows = LogSimulation::new(vehicle, scenario).unwrap().rows();
    rows.into_iter().map(|row| LogRow { time_s: row.time_s + from_s, ..row }).collect()
}

fn estimator(vehicle: &Vehicle, drives: &[&[LogRow]]) -> LogEstimator {
    let options = EstimateOptions::default().with_file(vehicle);
    let mut estimator = LogEstimator::new(vehicle, options).unwrap();
    for row in drives.iter().copied().flatten() {
        estimator.push(row).unwrap();
    }
    estimator
}

/// Threshold, ratio and speed are those of the last load, and that its ratios differ from those of the load before is
/// not taken for a bank of the road.
#[test]
fn the_answer_is_that_of_the_last_load() {
    let vehicle = common::vehicle("kraz.toml");
    let light = drive(&vehicle, (4e3, 1.6), 20.0, 0.0);
    let heavy = drive(&vehicle, (20e3, 1.9), 13.0, 2000.0);
    let alone = estimator(&vehicle, &[&heavy]).finish();
    let both = estimator(&vehicle, &[&light, &heavy]).finish();
    let same = |value: fn(&LogEstimate) -> Option<f64>| {
        let [both, alone] = [&both, &alone].map(|one| value(one).unwrap());
        // The first turn of the second drive can begin in the gap.
        assert!((both / alone - 1.0).abs() < 0.01, "{both} {alone}");
    };
    same(|one| one.height_m);
    same(|one| one.height_sd_m);
    same(|one| one.ratio);
    same(|one| one.speed_mps);
    same(|one| one.static_rollover_threshold_g);
    same(|one| one.static_rollover_threshold_ci95_g.map(|[low, _]| low));
    let banked = both.messages.iter().find(|text| text.contains("banked"));
    assert_eq!(banked, None);
}

/// A truck learns from its empty trailer. One that was weighed empty two hours ago may be laden now.
#[test]
fn a_mass_of_long_ago_weighs_no_maneuver() {
    let vehicle = common::vehicle("kraz.toml");
    let empty = drive(&vehicle, (0.0, vehicle.trailer.tare.cg_height_m), 15.0, 0.0);
    let mut unweighed = drive(&vehicle, (20e3, 1.9), 15.0, 7200.0);
    for row in &mut unweighed {
        row.trailer_mass_kg = f64::NAN;
    }
    let maneuvers = estimator(&vehicle, &[&empty, &unweighed]).maneuvers();
    let (mut weighed, mut others) = (0, 0);
    for (_, ended) in maneuvers {
        assert_eq!(ended.is_weighed, ended.time_s < 7000.0, "{ended:?}");
        *if ended.is_weighed { &mut weighed } else { &mut others } += 1;
    }
    assert!(weighed > 1 && others > 1, "{weighed} {others}");
}
