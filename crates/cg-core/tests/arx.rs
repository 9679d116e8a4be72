//! Tests of the shift form: its orders, when rows are used, and how a log is downsampled.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;
use cg_core::identify::arx::{ArxOptions, SampledArx};
use cg_core::{Answer, Arx, FilteredArx, Fit, Identify, Prior, Unexcited};

/// Input and output of `y⁺ = 0.8 y + 0.5 u`, whose DC ratio is 2.5, in steady state at an input of
/// `origin` at first.
fn lag(rows: u32, origin: f64) -> impl Iterator<Item = (f64, f64)> {
    let (mut y, mut k) = (2.5 * origin, 0);
    core::iter::from_fn(move || {
        let u = origin + if k % 7 < 3 { 1.0 } else { -0.4 };
        let row = (u, y);
        y = 0.8 * y + 0.5 * u;
        k += 1;
        (k <= rows).then_some(row)
    })
}

fn ready(answer: Answer<f64>) -> Fit<f64> {
    let Answer::Ready(fit) = answer else { panic!("{answer:?}") };
    fit
}

#[test]
fn an_order_must_fit_in_its_room() {
    let fits = |na, nb, nk| Arx::<f64, 4>::new(na, nb, nk).is_some();
    assert!(fits(0, 1, 0) && fits(2, 2, 3) && fits(3, 1, 4) && fits(0, 4, 1));
    assert!(!fits(1, 0, 0)); // no input
    assert!(!fits(3, 2, 0) && !fits(0, 5, 0)); // too many unknowns
    assert!(!fits(1, 1, 5) && !fits(2, 2, 4)); // too many past inputs
    assert!(!fits(usize::MAX, 1, 0) && !fits(1, 1, usize::MAX));
    let with_constant = |na, nb| Arx::<f64, 4>::new(na, nb, 0).unwrap().with_constant().is_some();
    assert!(with_constant(2, 1) && !with_constant(2, 2));
}

/// The first row with all past samples is the one after the longest lag.
#[test]
fn rows_count_from_the_longest_lag_on() {
    // The output does not follow any model, so every order is excited.
    let restless = |k: u32| ((1.3 * f64::from(k)).sin(), (0.37 * f64::from(k * k)).sin());
    for (na, nb, nk, first) in [(1, 1, 1, 1), (3, 1, 1, 3), (1, 2, 3, 4), (0, 1, 0, 0)] {
        let mut arx = Arx::<f64, 5>::new(na, nb, nk).unwrap();
        for (u, y) in (0..12).map(restless) {
            arx.push(u, y, true);
        }
        assert_eq!(ready(arx.fit()).rows, 12 - first, "{na} {nb} {nk}");
        arx.restart();
        for (u, y) in (0..12).map(restless) {
            arx.push(u, y, false);
        }
        assert_eq!(ready(arx.fit()).rows, 12 - first);
    }
}

#[test]
fn as_many_rows_as_unknowns_are_too_few() {
    for (samples, rows) in [(3, 2), (4, 3)] {
        let mut arx = Arx::<f64, 2>::new(1, 1, 1).unwrap();
        for (u, y) in lag(samples, 0.0) {
            arx.push(u, y, true);
        }
        let few = Answer::Unexcited(Unexcited::TooFewRows { rows });
        assert_eq!(arx.fit() == few, rows <= 2, "{rows}");
    }
}

#[test]
fn a_restart_keeps_the_rows_and_forgets_the_past() {
    let mut arx = Arx::<f64, 2>::new(1, 1, 1).unwrap();
    for (u, y) in lag(20, 0.0) {
        arx.push(u, y, true);
    }
    arx.restart();
    // A jump of the output, which must not be part of a row.
    for (u, y) in lag(20, 5.0) {
        arx.push(u, y, true);
    }
    let fit = ready(arx.fit());
    assert!((fit.ratio.value - 2.5).abs() < 1e-10);
    assert_eq!(fit.rows, 38);
}

#[test]
fn a_constant_takes_an_offset() {
    let mut arx = Arx::<f64, 3>::new(1, 1, 1).unwrap().with_constant().unwrap();
    for (u, y) in lag(40, 0.0) {
        arx.push(u + 3.0, y - 20.0, true);
    }
    let [a, b, constant] = arx.coefficients().unwrap();
    // y + 20 = 0.8 (y⁻ + 20) + 0.5 (u⁻ − 3) for the shifted values: the constant is −4 − 1.5.
    for (found, known) in [(a, -0.8), (b, 0.5), (constant, -5.5)] {
        assert!((found - known).abs() < 1e-10, "{found} {known}");
    }
}

/// A log at 100 Hz of a 20 Hz model whose values are held in between. Every fifth sample is used
/// even if time stamps are rounded, and the origin does not matter.
#[test]
fn a_fast_log_is_thinned_out() {
    for (jitter_s, origin) in [(0.0, 0.0), (2e-5, 4.0)] {
        let options = ArxOptions { order: 1, interval_s: 0.05 };
        let mut sampled = SampledArx::<f64>::for_model(&common::EQ_5_12, options);
        for (u, y) in lag(60, origin) {
            for _ in 0..5 {
                sampled.push(u, y, 0.01 - jitter_s, true);
            }
        }
        let fit = ready(sampled.fit());
        assert!((fit.ratio.value - 2.5).abs() < 1e-9, "{fit:?}");
        assert_eq!(fit.rows, 59);
        // Half the weight of the past rows does not change the result, because there is no noise.
        sampled.forget(0.5);
        assert!((ready(sampled.fit()).ratio.value - 2.5).abs() < 1e-9);
        sampled.clear();
        assert_eq!(sampled.fit(), Answer::Unexcited(Unexcited::TooFewRows { rows: 0 }));
    }
}

#[test]
fn an_order_beyond_the_room_is_the_greatest_that_fits() {
    for (order, unknowns) in [(0, 3), (1, 3), (10, 21), (50, 21)] {
        let options = ArxOptions { order, interval_s: 0.01 };
        let mut sampled = SampledArx::<f64>::for_model(&common::EQ_5_12, options);
        let mut rows = 0;
        for (u, y) in common::rounded_step_response(200, 0.05, 3.0) {
            sampled.push(u, y, 0.01, true);
            match sampled.fit() {
                Answer::Unexcited(Unexcited::TooFewRows { rows: so_far }) => rows = so_far,
                _ => break,
            }
        }
        assert_eq!(rows, unknowns, "{order}");
    }
}

/// The expected roll angle is the response of the reduced model to a step, both at the interval of
/// the identification and for a log that is four times as slow. The other identifier gives the same
/// response for a log at 1 kHz.
#[test]
fn the_expected_roll_is_the_models_whatever_the_logs_pace() {
    let model = common::EQ_5_12;
    let gain = model.dc_gain();
    let mut fine = <FilteredArx<_>>::for_model(&model, Prior::standard());
    fine.push(0.0, 0.0, 0.0, false);
    for _ in 0..800 {
        fine.push(1.0, 0.0, 1e-3, false);
    }
    let known = fine.expected_roll_rad();
    // During the rise, far from an extremum, so that a delay of one step would show.
    assert!((known - 1.0).abs() > 0.1 && gain.abs() > 0.0, "{known}");
    for (pace_s, steps) in [(0.01, 80), (0.04, 20)] {
        let options = ArxOptions { order: 5, interval_s: 0.01 };
        let mut arx = SampledArx::for_model(&model, options);
        arx.push(0.0, 0.0, 0.0, false);
        for _ in 0..steps {
            arx.push(1.0, 0.0, pace_s, false);
        }
        // The tolerance is half a step of 10 ms at a rate of about 1/s, and the ramp to the first
        // sample.
        let found = arx.expected_roll_rad();
        assert!((found - known).abs() < 0.02, "{pace_s}: {found} {known}");
    }
}

/// By hand: the rows (0, 1), (−1, 0), (−2, 2) and (−2, 1) with 1, 2, 2 and 3 have the normal equations 9 a − 6 b = −12 and
/// −6 a + 6 b = 8. They are fewer than a block.
#[test]
fn a_few_rows_have_the_answer_of_the_normal_equations() {
    let mut arx = Arx::<f64, 10>::new(1, 1, 0).unwrap();
    for (u, y) in [(0.0, 0.0), (1.0, 1.0), (0.0, 2.0), (2.0, 2.0), (1.0, 3.0)] {
        arx.push(u, y, true);
    }
    let [a, b, rest @ ..] = arx.coefficients().unwrap();
    assert!((a + 4.0 / 3.0).abs() < 1e-14 && b.abs() < 1e-14, "{a} {b}");
    assert!(rest.iter().all(|unused| unused.abs() < 1e-14));
}
