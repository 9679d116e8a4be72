//! A truck whose frame twists, on the nonlinear plant: rollover threshold and coverage of the intervals.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../../cg-vehicle/tests/common/mod.rs"]
mod common;

use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_plant::rollover::{Ramp, RampEnd};
use cg_vehicle::equations::Equations;
use cg_vehicle::steady_turn::steady_turn_threshold_g;
use cg_vehicle::{Load, Variant, Vehicle};

/// Stiffness of the frame of a van and of a flatbed.
const FRAMES_NM_PER_RAD: [f64; 2] = [3e6, 6e5];

/// The second independent truck.
fn euro(frame_nm_per_rad: Option<f64>) -> Vehicle {
    let mut vehicle = common::vehicle("euro.toml");
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = frame_nm_per_rad;
    vehicle
}

fn laden(payload_kg: f64, cg_height_m: f64) -> Load {
    Load { trailer_mass_kg: 6318.0 + payload_kg, cg_height_m }
}

/// Rollover threshold of the plant in a slow ramp, if it rolls over rather than slides.
fn ramp_g(vehicle: &Vehicle, load: Load, speed_mps: f64) -> Option<f64> {
    let plant = YawRollPlant::new(vehicle, load, &PlantOptions::default()).unwrap();
    let model =
        Equations::new(vehicle, Variant::Complete, speed_mps, load).unwrap().state_space().unwrap();
    let gain = model.steady(&model.lateral_acceleration, model.lateral_feedthrough).unwrap();
    let ramp = Ramp::drive(&plant, speed_mps, gain, 0.01 * vehicle.gravity_mps2).unwrap();
    (ramp.end == RampEnd::RolledOver).then(|| ramp.greatest_mps2() / vehicle.gravity_mps2)
}

#[test]
fn the_threshold() {
    for (payload_kg, cg_height_m) in
        [(8e3, 2.2), (16e3, 1.7), (16e3, 2.3), (25e3, 2.0), (25e3, 2.5)]
    {
        for kmh in [50.0, 90.0] {
            let load = laden(payload_kg, cg_height_m);
            let of = |frame| {
                let v = euro(frame);
                (ramp_g(&v, load, kmh / 3.6), steady_turn_threshold_g(&v, load, kmh / 3.6).unwrap())
            };
            println!(
                "{payload_kg} {cg_height_m} {kmh}: rigid {:.4?} van {:.4?} flatbed {:.4?}",
                of(None),
                of(Some(FRAMES_NM_PER_RAD[0])),
                of(Some(FRAMES_NM_PER_RAD[1]))
            );
        }
    }
}
