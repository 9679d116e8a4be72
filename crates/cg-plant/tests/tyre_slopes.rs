//! Which slope of a tire's slip table the linear model wants, against the nonlinear plant.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::equations::Equations;
use cg_vehicle::linear::Laden;
use cg_vehicle::slip::USUAL_G;
use cg_vehicle::{Variant, Vehicle};

/// Lateral acceleration per steer angle in the steady turn of the linear model, with the tires of usual turns, those of
/// the file, and those of one turn.
fn linear(vehicle: &Vehicle, speed_mps: f64, lateral_g: f64) -> [f64; 3] {
    let laden = Laden::new(vehicle, Variant::Complete, vehicle.reference_load()).unwrap();
    let of_turn = laden.clone().in_turn(lateral_g).unwrap();
    [laden.clone(), laden.with_tires_of_the_file(), of_turn].map(|laden| {
        let model = Equations::of(&laden, speed_mps).unwrap().state_space().unwrap();
        model.lateral_gain().unwrap()
    })
}

/// The same of the plant at the end of a step to 0.17 g, and the lateral acceleration in g.
fn plant(vehicle: &Vehicle, speed_mps: f64) -> [f64; 2] {
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
    [last.lateral_acceleration_mps2 / last.steer_rad, g.abs()]
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

/// The secant at 0.15 g and the tires of usual turns are nearer to the plant than the slope at zero slip, by far; the
/// latter with either slope in the file, and those of this turn most of all.
#[test]
fn secants_and_tires_of_usual_turns_are_nearest_to_the_plant() {
    let vehicle = common::vehicle("kraz.toml");
    for speed_mps in [13.9, 20.0] {
        let [plant, lateral_g] = plant(&vehicle, speed_mps);
        let [[usual, zero, _], [usual_too, secant, of_turn]] = [0, 1].map(|which| {
            let gains = linear(&with_slope(&vehicle, which), speed_mps, lateral_g);
            gains.map(|gain| gain / plant - 1.0)
        });
        let percent = [zero, secant, usual, usual_too, of_turn];
        let percent = percent.map(|by| format!("{:+.2}", 100.0 * by)).join(", ");
        println!(
            "{speed_mps} m/s: zero slip, secant, usual turns with each, {lateral_g:.3} g: {percent} %"
        );
        // The slopes differ by 6 %, of which a truck that understeers feels a part. What is left to the
        // secant is what the tires lose in a turn because their load is not the static one.
        assert!(secant.abs() < 0.5 * zero.abs(), "{zero} {secant}");
        assert!(usual.abs() < 0.5 * zero.abs(), "{zero} {usual}");
        // What is left is the load transfer between the axles of a unit and the drag of the tires.
        assert!(of_turn.abs() < 0.2 * zero.abs(), "{zero} {of_turn}");
        // One factor for the axles of a group leaves them the shares that the file gives, which the two slopes
        // divide differently by less than a tenth of their difference.
        assert!((usual - usual_too).abs() < 0.1 * (zero - secant).abs(), "{usual} {usual_too}");
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
