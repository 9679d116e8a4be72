//! Tests that a design agrees with the models from which it is computed.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use cg_core::truck::ratio::solve_height;
use cg_core::{CHANNELS, Channel, Design, Measured};
use cg_vehicle::belief::Belief;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Load, Variant, Vehicle};

/// Three points in each interval of an axis.
fn between(axis: &[f64]) -> Vec<f64> {
    let within = |pair: &[f64]| [0.25, 0.5, 0.75].map(|x| pair[0] + x * (pair[1] - pair[0]));
    axis.windows(2).flat_map(within).collect()
}

/// Relative errors of the heights that a design gives for the exact ratios of the model.
fn errors(vehicle: &Vehicle, design: &Design<f64>) -> Vec<f64> {
    let believed = Belief::prior(vehicle).applied_to(vehicle);
    let mut errors = Vec::new();
    for speed_mps in between(&design.speed_mps) {
        for trailer_mass_kg in between(&design.trailer_mass_kg) {
            let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
            let model = ratio_line(&believed, Variant::Complete, speed_mps, load).unwrap();
            for (channel, height_m) in Channel::ALL.into_iter().flat_map(|channel| {
                [vehicle.height.least_m, 1.7, 2.2].map(|height_m| (channel, height_m))
            }) {
                let ratio = Measured::exact(model[channel.index()].ratio_at(height_m));
                let line = design.line(channel, speed_mps, trailer_mass_kg).unwrap();
                let found = solve_height(&line, ratio, Measured::exact(1.0), 0.0).unwrap();
                // An empty trailer hardly changes the tractor's roll, so for the tractor the ratio
                // is compared, whose uncertainty is enlarged in the same way.
                errors.push(if channel == Channel::Tractor {
                    line.ratio_at(height_m) / ratio.value - 1.0
                } else {
                    found.value / height_m - 1.0
                });
            }
        }
    }
    errors
}

/// A calibration has an uncertainty of at least 1 %. Added to it in quadrature, an error of 0.2 %
/// increases the standard deviation by 2 %; this is allowed as the rms error. An error of 0.7 %
/// increases it by a quarter; this is allowed in the worst case, an empty trailer at 28 m/s or at
/// walking speed.
#[test]
fn between_its_nodes_a_design_keeps_the_heights_of_the_model() {
    for name in ["baseline.toml", "baseline-tables.toml", "air.toml", "kraz.toml"] {
        let vehicle = common::vehicle(name);
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        let errors = errors(&vehicle, &design);
        let (rms, worst) = (common::rms(&errors), common::largest(&errors));
        println!("{name}: {:.3} % rms, {:.2} % at worst", 100.0 * rms, 100.0 * worst);
        assert!(rms < 2e-3 && worst < 7e-3, "{name}: {rms} {worst}");
    }
}

/// Covariance of the ratios at the reference load.
fn covariance(vehicle: &Vehicle) -> [[f64; CHANNELS]; CHANNELS] {
    let (speed_mps, load) = (vehicle.nominal_speed_mps, vehicle.reference_load());
    Belief::prior(vehicle).ratio_covariance(vehicle, Variant::Complete, speed_mps, load).unwrap()
}

/// A spring with twice the friction makes the suspension rolls twice as uncertain by it; the roll of
/// the body keeps its uncertainty.
#[test]
fn the_friction_of_springs_makes_suspension_rolls_uncertain() {
    let usual = common::vehicle("baseline-tables.toml");
    let (mut without, mut double) = (usual.clone(), usual.clone());
    for (vehicle, factor) in [(&mut without, 0.0), (&mut double, 2.0)] {
        for spring in &mut vehicle.spring {
            for (up, down) in spring.compression_n.iter_mut().zip(&mut spring.extension_n) {
                let (middle, half) = (0.5 * (*up + *down), 0.5 * (*up - *down));
                (*up, *down) = (middle + factor * half, middle - factor * half);
            }
        }
    }
    let [none, usual, double] = [&without, &usual, &double].map(covariance);
    for channel in Channel::ALL {
        let k = channel.index();
        let added = usual[k][k] - none[k][k];
        if channel.feels_bank() {
            assert!(added.abs() < 1e-15, "{channel}: {added}");
        } else {
            assert!(added.sqrt() > 0.05, "{channel}: {added}");
            assert!(((double[k][k] - none[k][k]) / added - 4.0).abs() < 1e-6, "{channel}");
        }
    }
}
