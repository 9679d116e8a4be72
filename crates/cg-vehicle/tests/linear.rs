//! Tests of properties that the linear model has for any vehicle. `reproduce.rs` in cg-thesis tests
//! the thesis's numbers.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_core::{Input, Output};
use cg_vehicle::equations::Equations;
use cg_vehicle::linear::{SteadyLines, ratio_line};
use cg_vehicle::system::System;
use cg_vehicle::{Load, Variant, Vehicle};

fn baseline() -> Vehicle {
    Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml"))
        .unwrap()
}

/// Every pair of every vehicle of the fixtures: the straight lines beside the solved steady state.
#[test]
fn the_ratio_line_of_every_pair_is_the_dc_ratio_of_the_model() {
    for name in ["baseline", "kraz", "euro", "air"] {
        let file = format!("{}/../../fixtures/vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let vehicle = Vehicle::load(file).unwrap();
        let reference = vehicle.reference_load();
        let steady = SteadyLines::new(&vehicle, Variant::Complete, 17.0, reference).unwrap();
        for k in 0..20 {
            let cg_height_m = 1.0 + 0.1 * f64::from(k);
            let load = Load { cg_height_m, ..reference };
            let at = SteadyLines::new(&vehicle, Variant::Complete, 17.0, load).unwrap();
            let model = Equations::new(&vehicle, Variant::Complete, 17.0, load)
                .unwrap()
                .state_space()
                .unwrap();
            for output in Output::ALL {
                for input in Input::ALL {
                    let line = steady.line(output, input).ratio_at(cg_height_m);
                    // The same steady state, solved at this height.
                    let solved = at.line(output, input).ratio_at(cg_height_m);
                    assert!((line / solved - 1.0).abs() < 1e-12, "{name} {output:?} {input:?}");
                    // The value at s = 0 of the dynamic model, whose state matrix has a condition
                    // number of 1e5 or more.
                    let dc = |system: System| system.moments(1).unwrap()[0];
                    let input_dc = model.to_input(input).map_or(1.0, dc);
                    let ratio = dc(model.to_output(output)) / input_dc;
                    assert!((line / ratio - 1.0).abs() < 1e-9, "{name} {output:?} {input:?}");
                }
            }
        }
    }
}

/// The specific force is the lateral acceleration and gravity's part in the rolled body, so
/// `S/f = (S/a_y)/(1 + g R/a_y)`, and the same for the tractor. A bank changes neither side. The tractor's roll
/// angle is taken from the dynamic model, whose state matrix has a condition number of 1e5 or more.
#[test]
fn the_specific_force_contains_the_roll_times_gravity() {
    for name in ["baseline", "kraz", "euro"] {
        let file = format!("{}/../../fixtures/vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let vehicle = Vehicle::load(file).unwrap();
        for k in 0..20 {
            let cg_height_m = 1.0 + 0.1 * f64::from(k);
            let load = Load { cg_height_m, ..vehicle.reference_load() };
            let steady = SteadyLines::new(&vehicle, Variant::Complete, 17.0, load).unwrap();
            let ratio = |output, input| steady.line(output, input).ratio_at(cg_height_m);
            let shares = |suspension, force, roll: f64, most: f64| {
                let lateral = ratio(suspension, Input::LateralAcceleration);
                let expected = lateral / (1.0 + vehicle.gravity_mps2 * roll);
                let found = ratio(suspension, force) / expected - 1.0;
                assert!(found.abs() < most, "{name} {cg_height_m} {suspension:?}: {found}");
            };
            let trailer = ratio(Output::Roll, Input::LateralAcceleration);
            shares(Output::SuspensionRoll, Input::SpecificForce, trailer, 1e-12);
            let model = Equations::new(&vehicle, Variant::Complete, 17.0, load)
                .unwrap()
                .state_space()
                .unwrap();
            let steady_of = |row, feedthrough| model.steady(row, feedthrough).unwrap();
            let tractor = steady_of(&model.tractor_roll, 0.0)
                / steady_of(&model.lateral_acceleration, model.lateral_feedthrough);
            let (output, input) = (Output::TractorSuspensionRoll, Input::TractorSpecificForce);
            shares(output, input, tractor, 1e-9);
        }
    }
}

#[test]
fn the_ratio_is_exactly_linear_over_linear_in_height() {
    let vehicle = baseline();
    for variant in [Variant::Complete, Variant::AsPrinted] {
        let lines = ratio_line(&vehicle, variant, 17.0, vehicle.reference_load()).unwrap();
        for cg_height_m in [1.2, 1.7, 2.7] {
            let load = Load { cg_height_m, ..vehicle.reference_load() };
            let model =
                Equations::new(&vehicle, variant, 17.0, load).unwrap().state_space().unwrap();
            let roll = model.steady(&model.trailer_roll, 0.0).unwrap();
            let lateral = model.lateral_gain().unwrap();
            // Rounding of two 10 × 10 solutions with condition numbers near 1e5.
            assert!((lines[0].ratio_at(cg_height_m) / roll - 1.0).abs() < 1e-9);
            assert!((lines[1].ratio_at(cg_height_m) / (roll / lateral) - 1.0).abs() < 1e-9);
        }
    }
}
