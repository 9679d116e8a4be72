//! Tests of properties that the linear model has for any vehicle. `reproduce.rs` in cg-thesis tests
//! the thesis's numbers.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_vehicle::equations::Equations;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Load, Variant, Vehicle};

fn baseline() -> Vehicle {
    Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml"))
        .unwrap()
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
            let lateral =
                model.steady(&model.lateral_acceleration, model.lateral_feedthrough).unwrap();
            // Rounding of two 10 × 10 solutions with condition numbers near 1e5.
            assert!((lines[0].ratio_at(cg_height_m) / roll - 1.0).abs() < 1e-9);
            assert!((lines[1].ratio_at(cg_height_m) / (roll / lateral) - 1.0).abs() < 1e-9);
        }
    }
}
