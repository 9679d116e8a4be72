//! The compensation function `F(s)` from calibration runs: found where there is one, and not where there is
//! noise alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Channel;
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::shape::{INTERVAL_S, Shape, ShapeRun, Stretch, shapes};
use cg_vehicle::compensated::compensated_models;
use cg_vehicle::design::models_at;
use cg_vehicle::reduction::quality::rounded_step;
use cg_vehicle::system::Rational;
use cg_vehicle::{Load, Variant, Vehicle};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, StandardNormal};

const LOADS: [(f64, f64); 3] = [(8_684.0, 1.33), (18_684.0, 1.7), (28_684.0, 1.9)];

/// The roll angle follows with a lead at 3 rad/s and a lag at 4 rad/s.
fn known() -> Rational {
    Rational { numerator: vec![4.0, 4.0 / 3.0], denominator: vec![4.0, 1.0] }
}

/// A rounded step from the steer angle to the roll angle of the reduced model times `function`, with an
/// offset, a factor, and white noise as a share of the roll angle.
fn run(vehicle: &Vehicle, k: usize, function: &Rational, noise: f64) -> ShapeRun {
    let (trailer_mass_kg, cg_height_m) = LOADS[k];
    let load = Load { trailer_mass_kg, cg_height_m };
    let models = models_at(vehicle, Variant::Complete, load).unwrap();
    let reduced = models.of_channels[Channel::Steer.index()];
    let denominator = reduced.denominator.into_iter().chain([1.0]).collect();
    let model = Rational { numerator: reduced.numerator.to_vec(), denominator };
    let input: Vec<f64> =
        (0..300).map(|k| 0.03 * rounded_step(f64::from(k) * INTERVAL_S - 2.0, 2.0)).collect();
    let roll_rad = model.system().then(&function.system()).response(&input, INTERVAL_S);
    let most_rad = roll_rad.iter().fold(0.0_f64, |most, angle| most.max(angle.abs()));
    let mut source = StdRng::seed_from_u64(k as u64);
    let measured_rad = roll_rad.iter().map(|angle| {
        let normal: f64 = StandardNormal.sample(&mut source);
        1.03 * angle + 0.01 + noise * most_rad * normal
    });
    let stretch =
        Stretch { measured_rad: measured_rad.collect(), used: vec![true; input.len()], input };
    let mut channels: [Vec<Stretch>; 4] = Default::default();
    channels[Channel::Steer.index()].push(stretch);
    ShapeRun { load, speed_mps: vehicle.nominal_speed_mps, channels }
}

fn found(vehicle: &Vehicle, runs: usize, function: &Rational, noise: f64) -> Shape {
    let runs: Vec<_> = (0..runs).map(|k| run(vehicle, k, function, noise)).collect();
    let mut all = shapes(vehicle, Variant::Complete, &Belief::prior(vehicle), &runs).unwrap();
    assert_eq!(all.len(), 1, "only the channel that the runs have");
    all.remove(0)
}

#[test]
fn a_known_function_comes_back_from_three_loads() {
    let vehicle = common::vehicle("kraz.toml");
    let shape = found(&vehicle, 3, &known(), 0.0);
    assert_eq!((shape.channel, shape.order()), (Channel::Steer, 1), "{:?}", shape.left_out);
    let function = shape.function.unwrap();
    // The interpolation of the filtered signals between samples leaves (3 rad/s · 0.05 s)²/12 = 2e-3.
    for (own, known) in function.numerator.iter().zip(known().numerator) {
        assert!((own / known - 1.0).abs() < 0.01, "{function:?}");
    }
    assert!((function.dc_gain() - 1.0).abs() < 1e-9);
    // In noise of 1 % it is found too: of a step of 13 s, it changes 4 %.
    let noisy = found(&vehicle, 3, &known(), 0.01);
    assert_eq!(noisy.order(), 1, "{:?}", noisy.left_out);
}

#[test]
fn noise_and_two_runs_give_order_0() {
    let vehicle = common::vehicle("kraz.toml");
    let one = Rational { numerator: vec![1.0], denominator: vec![1.0] };
    for (runs, function, noise) in [(3, &one, 0.0), (3, &one, 0.03), (2, &known(), 0.0)] {
        let shape = found(&vehicle, runs, function, noise);
        assert_eq!(shape.order(), 0, "{runs} runs, noise {noise}: {:?}", shape.left_out);
        assert_eq!(shape.left_out.len(), if runs > 2 { 4 } else { 1 });
    }
}

/// On board the product is of order 5: stable, exact at s = 0, and near the product.
#[test]
fn the_product_is_reduced_to_order_five() {
    for (file, greatest) in [("kraz.toml", 0.01), ("euro.toml", 0.01), ("baseline.toml", 0.02)] {
        let vehicle = common::vehicle(file);
        let mut belief = Belief::prior(&vehicle);
        belief.shapes = std::array::from_fn(|_| Some(known()));
        let at = (vehicle.nominal_speed_mps, vehicle.reference_load());
        for model in compensated_models(&vehicle, Variant::Complete, &belief, at).unwrap() {
            assert_eq!(model.product.denominator.len(), 7);
            assert_eq!(model.reduced.denominator.len(), 6);
            assert!(model.reduced.system().is_stable().unwrap());
            assert!((model.reduced.dc_gain() - 1.0).abs() < 1e-9);
            let (change, error) = (model.change, model.reduction_error);
            println!("{file} {}: change {change:.4}, reduction {error:.4}", model.channel);
            assert!(error < greatest && error < 0.5 * change, "{file} {}", model.channel);
        }
        // Without functions, the models are those of the prior.
        let models = models_at(&vehicle, Variant::Complete, vehicle.reference_load()).unwrap();
        assert_eq!(models.compensated(&Default::default()).unwrap(), models);
    }
}
