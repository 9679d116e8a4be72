//! Vehicles from the fixtures.
#![allow(dead_code, clippy::unwrap_used)] // each test file uses its part

use std::path::PathBuf;

use cg_vehicle::Vehicle;

pub(crate) fn fixtures() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures"))
}

pub(crate) fn vehicle(name: &str) -> Vehicle {
    Vehicle::load(fixtures().join("vehicles").join(name)).unwrap()
}

/// Tires whose force is in proportion to slip and load, so that they are the same in every turn.
pub(crate) fn tires_alike_in_all_turns(vehicle: &mut Vehicle) {
    for tyre in &mut vehicle.tyre {
        tyre.lateral_force = None;
        let usual_n = 25e3;
        let per_load = tyre.stiffness_at(usual_n).0 / usual_n;
        tyre.cornering_stiffness_n_per_rad =
            tyre.load_n.iter().map(|load_n| per_load * load_n).collect();
    }
}

/// A rigid truck: springs, tires and fifth wheel are very stiff, and single tires are at 1 m.
pub(crate) fn rigid_truck() -> Vehicle {
    let mut vehicle = vehicle("baseline.toml");
    for tyre in &mut vehicle.tyre {
        tyre.vertical_stiffness_n_per_m = 4e7;
    }
    let axles = vehicle.tractor.axle.iter_mut().map(|a| &mut a.axle);
    for axle in axles.chain(vehicle.trailer.axle.iter_mut().map(|a| &mut a.axle)) {
        axle.spring_stiffness_n_per_m = 4e7;
        axle.roll_damping_nms_per_rad = 1e5;
        axle.tyre_positions_m = vec![1.0];
    }
    vehicle.hitch.roll_stiffness_nm_per_rad = 1e8;
    vehicle
}

pub(crate) fn rms(errors: &[f64]) -> f64 {
    #[allow(clippy::cast_precision_loss)] // a few logs
    let n = errors.len() as f64;
    (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt()
}

pub(crate) fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, e| e.abs().max(most))
}
