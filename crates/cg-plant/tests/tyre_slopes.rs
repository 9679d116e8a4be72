//! Which slope of a tire's slip table the linear model wants, against the nonlinear plant.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../../cg-vehicle/tests/common/mod.rs"]
mod common;

use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::equations::Equations;
use cg_vehicle::slip::USUAL_G;
use cg_vehicle::{Variant, Vehicle};

/// Lateral acceleration per steer angle in the steady turn of the linear model.
fn linear(vehicle: &Vehicle, speed_mps: f64) -> f64 {
    let load = vehicle.reference_load();
    let model =
        Equations::new(vehicle, Variant::Complete, speed_mps, load).unwrap().state_space().unwrap();
    model.lateral_gain().unwrap()
}

/// The same of the plant at the end of a step to 0.17 g.
fn plant(vehicle: &Vehicle, speed_mps: f64) -> f64 {
    let scenario = Scenario {
        plant: Plant::Nonlinear,
        load: vehicle.reference_load(),
        rate_hz: 20.0,
        duration_s: 17.0,
        speed_mps,
        ..Scenario::of(vehicle, Maneuver::RoundedStep)
    };
    let rows = LogSimulation::new(vehicle, scenario).unwrap().rows();
    let last = rows.last().unwrap();
    let g = last.lateral_acceleration_mps2 / vehicle.gravity_mps2;
    assert!((0.12..0.18).contains(&g.abs()), "{g} g");
    last.lateral_acceleration_mps2 / last.steer_rad
}

/// The vehicle whose tires have one of the two slopes of their tables.
fn with_slope(vehicle: &Vehicle, which: usize) -> Vehicle {
    let mut vehicle = vehicle.clone();
    for tyre in &mut vehicle.tyre {
        let table = tyre.lateral_force.as_ref().unwrap();
        let slope = |load_n: &f64| table.slopes_n_per_rad(*load_n, USUAL_G).unwrap()[which];
        tyre.cornering_stiffness_n_per_rad = tyre.load_n.iter().map(slope).collect();
    }
    vehicle
}

/// The secant at 0.15 g is nearer to the plant than the slope at zero slip, by far.
#[test]
fn the_secant_is_nearest_to_the_plant() {
    let vehicle = common::vehicle("kraz.toml");
    for speed_mps in [13.9, 20.0] {
        let plant = plant(&vehicle, speed_mps);
        let [zero, secant] =
            [0, 1].map(|which| linear(&with_slope(&vehicle, which), speed_mps) / plant - 1.0);
        let file = linear(&vehicle, speed_mps) / plant - 1.0;
        println!(
            "{speed_mps} m/s: zero slip {:+.1} %, secant {:+.1} %, file {:+.1} %",
            100.0 * zero,
            100.0 * secant,
            100.0 * file
        );
        // The slopes differ by 6 %, of which a truck that understeers feels a part. What is left to the
        // secant is what the tires lose in a turn because their load is not the static one.
        assert!(secant.abs() < 0.5 * zero.abs(), "{zero} {secant}");
    }
}

/// A file may leave the list out: it then has the secants of its table.
#[test]
fn an_absent_cornering_stiffness_is_computed_from_the_table() {
    let text = std::fs::read_to_string(common::fixtures().join("vehicles/kraz.toml")).unwrap();
    let without: String = text
        .lines()
        .filter(|line| !line.starts_with("cornering_stiffness_n_per_rad"))
        .flat_map(|line| [line, "\n"])
        .collect();
    let found = Vehicle::parse(&without, "kraz").unwrap();
    assert_eq!(found, with_slope(&common::vehicle("kraz.toml"), 1));
    // Without a table there is nothing to compute it from.
    let euro = std::fs::read_to_string(common::fixtures().join("vehicles/euro.toml")).unwrap();
    let without = euro.replace("cornering_stiffness_n_per_rad", "#");
    let error = Vehicle::parse(&without, "euro").unwrap_err().to_string();
    assert!(error.contains("tyre[0].cornering_stiffness_n_per_rad"), "{error}");
}
