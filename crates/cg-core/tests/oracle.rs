//! The identifiers compared with independent results: nalgebra's SVD, the matrix exponential of eq.
//! 5.12, and double against single precision.
#![allow(clippy::cast_precision_loss)]
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;
use crate::common::{EQ_5_12, narrow, rounded_step_response, with_noise};
use cg_core::{Answer, Arx, FilteredArx, Identify, Prior, Reduced5};
use nalgebra::{Complex, DMatrix, DVector, SMatrix};

const NO_PRIOR: Prior<f64> = Prior {
    dynamics_sd: f64::INFINITY,
    noise_floor_rad: 1e-9,
    offset_sd_rad: 0.0,
    drift_sd_radps: 0.0,
};

/// `(steer, roll)` of eq. 5.12 for a steer angle that is a sum of three sines and never settles.
fn lively(n: usize, interval_s: f64) -> Vec<(f64, f64)> {
    let steer = |k: usize| {
        let t = interval_s * k as f64;
        0.03 * ((1.3 * t).sin() + (3.7 * t).sin() + (8.1 * t).sin())
    };
    let mut plant = cg_core::truck::simulation::Simulation::new(&EQ_5_12, interval_s, 0.0);
    (0..n).map(|k| (steer(k), if k == 0 { 0.0 } else { plant.push(steer(k)) })).collect()
}

/// Characteristic polynomial of exp(A Ts), highest power first: its roots are `exp(λ Ts)`.
fn discrete_denominator(model: &Reduced5<f64>, interval_s: f64) -> Vec<f64> {
    let mut a = SMatrix::<f64, 5, 5>::zeros();
    for k in 0..4 {
        a[(k, k + 1)] = 1.0;
    }
    for k in 0..5 {
        a[(4, k)] = -model.denominator[k];
    }
    let mut coefficients = vec![Complex::new(1.0, 0.0)];
    for pole in a.complex_eigenvalues().iter() {
        let (sin, cos) = (pole.im * interval_s).sin_cos();
        let root = Complex::new(cos, sin) * (pole.re * interval_s).exp();
        coefficients.push(Complex::new(0.0, 0.0));
        for k in (1..coefficients.len()).rev() {
            let lower = coefficients[k - 1];
            coefficients[k] -= root * lower;
        }
    }
    coefficients.iter().map(|c| c.re).collect()
}

#[test]
fn shift_form_arx_recovers_equation_5_12() {
    // With linear interpolation between samples, the sampled eq. 5.12 is exactly an ARX [5 6 0].
    let mut arx = Arx::<f64, 11>::new(5, 6, 0).unwrap();
    for (u, y) in lively(400, 0.05) {
        arx.push(u, y, true);
    }
    let found = arx.coefficients().unwrap();
    let expected = discrete_denominator(&EQ_5_12, 0.05);
    for k in 0..5 {
        // Condition number near 1e7 times ε of the data.
        assert!(
            (found[k] - expected[k + 1]).abs() < 1e-6,
            "a{}: {} {}",
            k + 1,
            found[k],
            expected[k + 1]
        );
    }
    let Answer::Ready(fit) = arx.fit() else { panic!("excited") };
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < 1e-7);
}

#[test]
fn filtered_arx_recovers_every_coefficient_of_equation_5_12_through_other_filters() {
    // The filters are those of another truck, which is slower and better damped.
    let other = Reduced5 {
        numerator: [30.0, 20.0, 15.0, 1.0, 2.0, 0.1],
        denominator: [32.0, 80.0, 80.0, 40.0, 10.0], // (s + 2)^5
        speed_slope: [0.0; 5],
    };
    // In eight times the time, so that each sample is its own mean.
    let mut identifier = FilteredArx::new(&other.in_scaled_time(8.0), NO_PRIOR);
    for (u, y) in lively(8000, 0.005) {
        identifier.push(u, y, 8.0 * 0.005, true);
    }
    let found = identifier.model().unwrap().in_scaled_time(1.0 / 8.0);
    let pairs = found
        .numerator
        .iter()
        .zip(&EQ_5_12.numerator)
        .chain(found.denominator.iter().zip(&EQ_5_12.denominator));
    for (ours, theirs) in pairs {
        // The roll angle of eq. 5.12 is not linear between samples. Its curvature causes an error
        // of (ω h)²/12 of each signal at the fastest sine, ω = 8.1 rad/s, and as much for the fast
        // mode of the model itself, relative to the largest coefficient.
        let curvature = 2.0 * (8.1_f64 * 0.005).powi(2) / 12.0;
        println!("{ours:.4} {theirs:.4}");
        assert!((ours - theirs).abs() < curvature * 83.3, "{ours} {theirs}");
    }
    let Answer::Ready(fit) = identifier.fit() else { panic!("excited") };
    println!("DC ratio off by {:.2e}", fit.ratio.value / EQ_5_12.dc_gain() - 1.0);
    // Linear interpolation does not change the DC gain.
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < 1e-9);
}

#[test]
fn shift_form_arx_agrees_with_singular_values() {
    let data = with_noise(&lively(300, 0.05), 20.0, 7);
    let (na, nb, nk) = (3, 2, 1);
    let mut arx = Arx::<f64, 8>::new(na, nb, nk).unwrap();
    for (u, y) in &data {
        arx.push(*u, *y, true);
    }
    let first = na.max(nb + nk - 1);
    let rows = data.len() - first;
    let phi = DMatrix::from_fn(rows, na + nb, |i, j| {
        let t = i + first;
        if j < na { -data[t - 1 - j].1 } else { data[t - nk - (j - na)].0 }
    });
    let y = DVector::from_fn(rows, |i, _| data[i + first].1);
    let svd = phi.clone().svd(true, true);
    let theta = svd.solve(&y, 0.0).unwrap();
    let variance = (&y - &phi * &theta).norm_squared() / (rows - na - nb) as f64;
    let covariance = (phi.transpose() * &phi).try_inverse().unwrap() * variance;
    let ours = (arx.coefficients().unwrap(), arx.covariance().unwrap());
    for i in 0..na + nb {
        // A condition number below 1e4, squared by the normal equations of the reference: 1e8 ε.
        assert!((ours.0[i] - theta[i]).abs() < 1e-10 * theta.norm());
        for j in 0..na + nb {
            assert!((ours.1[i][j] - covariance[(i, j)]).abs() < 1e-7 * covariance.norm());
        }
    }
}

/// The complete chain of filters and rotations in single precision.
#[test]
fn single_precision_gives_the_same_height() {
    for (interval_s, n) in [(0.001, 10_001), (0.01, 1001), (0.05, 201), (0.1, 101)] {
        for snr_db in [20.0, 200.0] {
            let data = with_noise(&rounded_step_response(n, interval_s, 3.0), snr_db, 3);
            for dynamics_sd in [0.0, 0.2] {
                let wide = Prior { dynamics_sd, ..Prior::<f64>::standard() };
                let mut witness = FilteredArx::new(&EQ_5_12, wide);
                let model = Reduced5 {
                    numerator: EQ_5_12.numerator.map(narrow),
                    denominator: EQ_5_12.denominator.map(narrow),
                    speed_slope: [0.0; 5],
                };
                let slim = Prior { dynamics_sd: narrow(dynamics_sd), ..Prior::<f32>::standard() };
                let mut product = FilteredArx::new(&model, slim);
                // Both use the values in single precision, as from the sensors.
                let slim: Vec<_> = data.iter().map(|&(u, y)| (narrow(u), narrow(y))).collect();
                let wide: Vec<_> =
                    slim.iter().map(|&(u, y)| (f64::from(u), f64::from(y))).collect();
                for mean in common::means(&wide, interval_s) {
                    witness.push_mean(&mean);
                }
                for mean in common::means(&slim, interval_s) {
                    product.push_mean(&mean);
                }
                let (Answer::Ready(a), Answer::Ready(b)) = (witness.fit(), product.fit()) else {
                    panic!("excited")
                };
                let height = |ratio: f64| common::height_in(cg_core::Measured::exact(ratio)).value;
                let difference = height(f64::from(b.ratio.value)) / height(a.ratio.value) - 1.0;
                println!("{interval_s} s, {snr_db} dB, prior {dynamics_sd}: {difference:+.1e}");
                assert!(difference.abs() <= 2e-5);
            }
        }
    }
}
