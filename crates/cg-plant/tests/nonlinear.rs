//! The nonlinear plant: statics, symmetry, convergence, the linear model as its limit, figures of the
//! thesis and of other publications. (The test of the energy is in `plant::energy`.)
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod banked;
mod convergence;
mod linear;
mod moment;
mod published;
mod source;
mod statics;
mod uneven;

use cg_plant::plant::{Characteristics, PlantOptions, PlantSample, Simulation, YawRollPlant};
use cg_vehicle::reduction::quality::rounded_step;
use cg_vehicle::{Load, Vehicle};

const KMH: f64 = 1.0 / 3.6;
const G: f64 = 9.806_65;

fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
    Vehicle::load(format!("{folder}/{name}.toml")).unwrap()
}

/// The second independent truck with the frame of a flatbed, and a roll sensor at the fifth wheel.
fn flatbed() -> Vehicle {
    let mut vehicle = vehicle("euro");
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = Some(6e5);
    vehicle.sensors.roll.behind_hitch_m = Some(0.5);
    vehicle
}

fn plant(vehicle: &Vehicle) -> YawRollPlant {
    YawRollPlant::new(vehicle, vehicle.reference_load(), &PlantOptions::default()).unwrap()
}

fn linear() -> PlantOptions {
    PlantOptions {
        springs: Characteristics::Linear,
        tyres: Characteristics::Linear,
        ..PlantOptions::default()
    }
}

/// The reference load with its c.g. at another height.
fn at_height(vehicle: &Vehicle, cg_height_m: f64) -> Load {
    Load { cg_height_m, ..vehicle.reference_load() }
}

/// Rounded step (rate 3 1/s) of this amplitude, sampled every 10 ms.
fn rounded(
    run: &mut Simulation<'_>,
    steer_rad: f64,
    speed_mps: f64,
    duration_s: f64,
) -> Vec<PlantSample> {
    let mut samples = vec![run.sample()];
    while run.time_s() < duration_s - 1e-9 {
        for _ in 0..10 {
            let time_s = run.time_s() + 1e-3;
            run.push(steer_rad * rounded_step(time_s, 3.0), speed_mps, 1e-3);
        }
        samples.push(run.sample());
    }
    samples
}

fn peak(samples: &[PlantSample], of: impl Fn(&PlantSample) -> f64) -> f64 {
    samples.iter().map(|s| of(s).abs()).fold(0.0, f64::max)
}
