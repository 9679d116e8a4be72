//! Tests of the reduction of the thesis's compensated transfer function, and of the compensation of
//! the printed model towards the complete one.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;
use cg_vehicle::compensation::validity_table;
use cg_vehicle::reduction::quality::{StepInput, h_infinity, step_error_degree2};
use cg_vehicle::reduction::{Keep, balanced, fitted, pade};
use cg_vehicle::system::{Rational, System};
use cg_vehicle::{LinearModel, Variant};

/// The thesis's squared errors of orders 0 to 5 (Table 5.3).
const PRINTED_DEGREE2: [f64; 6] = [0.0334, 9.7715e-4, 9.7995e-4, 9.3233e-4, 7.2353e-4, 6.9315e-5];

fn steer_to_roll(variant: Variant) -> System {
    let vehicle = common::vehicle("baseline.toml");
    let (speed_mps, load) = (vehicle.nominal_speed_mps, vehicle.reference_load());
    LinearModel::new(&vehicle, variant, speed_mps, load).unwrap().state_space.to_trailer_roll()
}

/// The printed model in series with F(s) of order 3.
fn compensated() -> System {
    let f = Rational {
        numerator: vec![29.55, 24.28, 16.5, 1.356],
        denominator: vec![19.84, 10.87, 3.201, 1.0],
    };
    steer_to_roll(Variant::AsPrinted).then(&f.system())
}

/// The thesis's input. Its six errors agree with a rate a = 1 and a duration of ten seconds. The
/// amplitude is not printed and follows from the error of order 0.
fn printed_input(whole: &System) -> StepInput {
    let unit = StepInput { amplitude_rad: 1.0, rate_per_s: 1.0, duration_s: 10.0 };
    let constant =
        Rational { numerator: vec![whole.moments(1).unwrap()[0]], denominator: vec![1.0] };
    let error = step_error_degree2(whole, &constant.system(), &unit);
    StepInput { amplitude_rad: (PRINTED_DEGREE2[0] / error).sqrt(), ..unit }
}

#[test]
fn the_errors_of_table_5_3_come_out_in_the_sources_measure() {
    let whole = compensated();
    let input = printed_input(&whole);
    let moments = whole.moments(11).unwrap();
    println!("amplitude {:.3} degrees", input.amplitude_rad.to_degrees());
    for (order, printed) in PRINTED_DEGREE2.into_iter().enumerate() {
        let reduced = pade(&moments, order).unwrap().system();
        let error = step_error_degree2(&whole, &reduced, &input);
        let norm = h_infinity(&whole.minus(&reduced)).unwrap();
        println!("order {order}: {error:.4e}, printed {printed:.4e}, H-infinity {norm:.3}");
        // F(s) and the error of order 0 are printed with three digits (the latter within 1.5e-3).
        // Eq. 5.12 therefore varies by up to 0.3 % of a coefficient, and the difference of two
        // responses by ten times as much.
        assert!((error / printed - 1.0).abs() < 0.03, "order {order}: {error}");
    }
}

/// No model of order 5 can be ten times better than the thesis's 6.93e-5 degree². The least
/// possible error for this input is 1.43e-5, which was found by variable projection from forty
/// random starts. Order 6 is fifty times better, and balanced residualization is eight times better
/// in H∞.
#[test]
fn the_best_models_of_order_five_and_six() {
    let whole = compensated();
    let input = printed_input(&whole);
    let printed = PRINTED_DEGREE2[5];
    let fits = fitted(&whole, 6, &input.samples(), StepInput::INTERVAL_S).unwrap();
    let error = |order: usize| {
        let best = fits[order - 1].system();
        assert!(best.is_stable().unwrap());
        let steady = best.moments(1).unwrap()[0] / whole.moments(1).unwrap()[0];
        assert!((steady - 1.0).abs() < 1e-12, "{steady}");
        step_error_degree2(&whole, &best, &input)
    };
    let (five, six) = (error(5), error(6));
    println!("order 5: {five:.3e} degree², order 6: {six:.3e} degree²");
    // With the exact DC gain, the error is 6 % above the least possible one.
    assert!(five < 1.6e-5 && five > 1.43e-5, "{five:e}");
    assert!(six < printed / 10.0, "{six:e}");

    let norm = |reduced: &System| h_infinity(&whole.minus(reduced)).unwrap();
    let source = pade(&whole.moments(11).unwrap(), 5).unwrap().system();
    let (residualised, sigma) = balanced(&whole, 5, Keep::SteadyState).unwrap();
    let (truncated, _) = balanced(&whole, 5, Keep::HighFrequency).unwrap();
    println!(
        "order 5, H-infinity: Padé {:.3}, truncated {:.3}, residualized {:.3}",
        norm(&source),
        norm(&truncated),
        norm(&residualised)
    );
    let bound = 2.0 * sigma[5..].iter().sum::<f64>();
    assert!(norm(&residualised) <= bound && norm(&truncated) <= bound);
    assert!(norm(&residualised) < norm(&source) / 5.0);
    assert!(step_error_degree2(&whole, &residualised, &input) < printed);
}

/// An unstable approximant is detected, and the model that replaces it is stable.
#[test]
fn unstable_approximants_are_seen() {
    let whole = compensated();
    let moments = whole.moments(15).unwrap();
    let stable = |order| pade(&moments, order).unwrap().system().is_stable().unwrap();
    assert!(stable(5) && !stable(6) && !stable(7));
    let unstable = pade(&moments, 6).unwrap().system();
    assert!(h_infinity(&whole.minus(&unstable)).is_err());
    for order in 1..=12 {
        let (reduced, _) = balanced(&whole, order, Keep::SteadyState).unwrap();
        assert!(reduced.is_stable().unwrap(), "order {order}");
    }
}

/// Table 5.1 with the complete model instead of the vehicle: orders 1 to 6, each at least as good
/// as the one below.
#[test]
fn compensation_functions_of_order_one_to_six() {
    let input = StepInput { amplitude_rad: 0.05, rate_per_s: 2.0, duration_s: 10.0 };
    let samples = input.samples();
    let respond = |variant| steer_to_roll(variant).response(&samples, StepInput::INTERVAL_S);
    let (model, vehicle) = (respond(Variant::AsPrinted), respond(Variant::Complete));
    let table = validity_table(&model, &vehicle, StepInput::INTERVAL_S).unwrap();
    let steady = |variant| steer_to_roll(variant).moments(1).unwrap()[0];
    let expected = steady(Variant::Complete) / steady(Variant::AsPrinted);
    let mut least = f64::INFINITY;
    for found in &table {
        println!(
            "order {}: {:.3e} degree², F(0) = {:.4} (exact {expected:.4}), {:?}",
            found.order, found.squared_error_degree2, found.dc_gain, found.function
        );
        assert!(found.function.system().is_stable().unwrap());
        // The function of the order below is one of the starts; the iteration ends at 1e-9.
        assert!(found.squared_error_degree2 <= least * (1.0 + 1e-8), "order {}", found.order);
        least = found.squared_error_degree2;
    }
    // Ten seconds after the step, the response has settled within e^(−1.26·9) = 1e-5.
    let last = &table[5];
    assert!((last.dc_gain / expected - 1.0).abs() < 1e-3, "{} {expected}", last.dc_gain);
}
