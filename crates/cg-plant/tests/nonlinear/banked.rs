//! Steady turns on a banked road: what a bank does to each pair of signals.
//!
//! With `w = a_y + g β`, suspension roll `s = S w` and specific force `f = (1 + g R) w` keep their ratio;
//! roll to gravity is `R w + β`.

use cg_plant::plant::{PlantOptions, PlantSample, YawRollPlant};

use super::{KMH, linear, vehicle};

/// A steady turn to the left on a constant bank: linear springs and tires, large angles.
fn steady(name: &str, bank_rad: f64, steer_rad: f64) -> PlantSample {
    let vehicle = vehicle(name);
    let options = PlantOptions { bank_rad, ..linear() };
    let plant = YawRollPlant::new(&vehicle, vehicle.reference_load(), &options).unwrap();
    let mut run = plant.start(60.0 * KMH).unwrap();
    for _ in 0..4000 {
        run.push(steer_rad, 60.0 * KMH, 0.01);
    }
    let before = run.sample();
    run.push(steer_rad, 60.0 * KMH, 0.1);
    let sample = run.sample();
    // Steady: a lag of half a second between two signals is less than 0.05 %.
    let moved = sample.trailer.roll_rad / before.trailer.roll_rad - 1.0;
    assert!(moved.abs() < 1e-4, "{moved:e}");
    sample
}

/// The ratio of suspension roll to specific force of tractor and trailer.
fn pairs(sample: &PlantSample) -> [f64; 2] {
    [sample.tractor, sample.trailer].map(|unit| unit.suspension_roll_rad / unit.specific_force_mps2)
}

/// The bank-free pairs change by less than 1 % on a bank of 3 %, and by less than 0.1 % on one of
/// 0.2 %; on the same roads roll per lateral acceleration changes by 20 times as much.
#[test]
fn a_bank_does_not_change_suspension_roll_per_specific_force() {
    for name in ["baseline", "kraz"] {
        let flat = steady(name, 0.0, 0.025);
        for (bank_rad, tolerance) in [(0.03, 1e-2), (-0.03, 1e-2), (0.002, 1e-3), (-0.002, 1e-3)] {
            let banked = steady(name, bank_rad, 0.025);
            assert!((banked.bank_rad - bank_rad).abs() < 1e-15);
            for (unit, (a, b)) in pairs(&flat).iter().zip(pairs(&banked)).enumerate() {
                let change = b / a - 1.0;
                println!("{name}, bank {bank_rad}, unit {unit}: {:+.4} %", 100.0 * change);
                assert!(change.abs() < tolerance, "{name} {bank_rad} {unit} {change}");
            }
            let by_acceleration = |sample: &PlantSample| {
                sample.trailer.roll_rad / sample.trailer.lateral_acceleration_mps2
            };
            let change = by_acceleration(&banked) / by_acceleration(&flat) - 1.0;
            assert!(change.abs() > 10.0 * tolerance, "{name} {bank_rad} {change}");
        }
    }
}

/// The other ratios change by the amount of the theory: `g β/a_y` (roll, suspension roll),
/// `(1 + g R)/(g R) · g β/a_y` (roll to gravity), both per lateral acceleration; roll to gravity per
/// specific force by `β/(R w)`.
#[test]
fn a_bank_changes_the_other_ratios_as_the_theory_says() {
    let g = super::G;
    let flat = steady("baseline", 0.0, 0.025).trailer;
    let r = flat.roll_rad / flat.lateral_acceleration_mps2;
    for bank_rad in [0.007, -0.007] {
        let banked = steady("baseline", bank_rad, 0.025).trailer;
        let a_y = banked.lateral_acceleration_mps2;
        let share = g * bank_rad / a_y;
        let change = |of: fn(&cg_plant::plant::UnitSample) -> f64| of(&banked) / of(&flat) - 1.0;
        for (what, found, theory) in [
            ("roll", change(|u| u.roll_rad / u.lateral_acceleration_mps2), share),
            (
                "suspension roll",
                change(|u| u.suspension_roll_rad / u.lateral_acceleration_mps2),
                share,
            ),
            (
                "roll to gravity",
                change(|u| u.roll_to_gravity_rad / u.lateral_acceleration_mps2),
                (1.0 + g * r) / (g * r) * share,
            ),
            (
                "roll to gravity per specific force",
                change(|u| u.roll_to_gravity_rad / u.specific_force_mps2),
                bank_rad / (r * (a_y + g * bank_rad)),
            ),
        ] {
            println!("{what}, bank {bank_rad}: {found:+.4}, theory {theory:+.4}");
            // Terms of second order: the articulation turns the bank, angles are not small.
            assert!((found / theory - 1.0).abs() < 0.01, "{what} {bank_rad}: {found} {theory}");
        }
    }
}

/// In a steady turn the specific force is `a_y + g (φ + β)` up to terms of third order.
#[test]
fn the_specific_force_is_acceleration_and_gravity_along_the_body() {
    for (bank_rad, steer_rad) in [(0.0, 0.025), (0.03, 0.025), (-0.03, 0.025), (0.03, -0.02)] {
        let sample = steady("kraz", bank_rad, steer_rad);
        for unit in [sample.tractor, sample.trailer] {
            let tilted_rad = unit.roll_rad + bank_rad;
            assert!((unit.roll_to_gravity_rad - tilted_rad).abs() < 2e-4, "{unit:?}");
            let first = unit.lateral_acceleration_mps2 + super::G * tilted_rad;
            let second = first.abs() * (tilted_rad.abs() + sample.articulation_rad.abs()).powi(2);
            let error = unit.specific_force_mps2 - first;
            println!("bank {bank_rad}: {first:.4} m/s², {error:+.5}");
            assert!(error.abs() < second + 1e-4, "{error} {second}");
        }
    }
}
