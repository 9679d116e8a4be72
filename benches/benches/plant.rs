//! The nonlinear plant: one second of simulated time, so that 1 s divided by the time shown
//! is the ratio to real time on one core. There is no peer; the exact step of the linear model is
//! measured for comparison.
#![allow(missing_docs, clippy::unwrap_used)]

use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_vehicle::equations::Equations;
use cg_vehicle::{Variant, Vehicle};
use divan::Bencher;

const SPEED_MPS: f64 = 13.9;

fn main() {
    divan::main();
}

fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/vehicles");
    Vehicle::load(format!("{folder}/{name}.toml")).unwrap()
}

/// Five axles with linear or measured springs and tires; six axles.
#[divan::bench(args = ["baseline", "baseline-tables", "kraz"])]
fn simulated_second(bencher: Bencher, name: &str) {
    let vehicle = vehicle(name);
    let plant =
        YawRollPlant::new(&vehicle, vehicle.reference_load(), &PlantOptions::default()).unwrap();
    let start = plant.start(SPEED_MPS).unwrap();
    bencher.bench(|| {
        let mut run = start.clone();
        for _ in 0..100 {
            run.push(0.02, SPEED_MPS, 0.01);
        }
        run.sample()
    });
}

/// The linear model over the same second.
#[divan::bench(args = ["baseline", "kraz"])]
fn linear_second(bencher: Bencher, name: &str) {
    let vehicle = vehicle(name);
    let model =
        Equations::new(&vehicle, Variant::Complete, SPEED_MPS, vehicle.reference_load()).unwrap();
    let start = model.state_space().unwrap().simulation(1e-3);
    bencher.bench(|| {
        let mut run = start.clone();
        for _ in 0..1000 {
            run.push(0.02);
        }
        run.state
    });
}
