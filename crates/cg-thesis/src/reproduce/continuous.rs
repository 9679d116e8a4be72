//! Conversion of a sampled ARX model of order 5 to its transfer function in s.
//!
//! Poles are mapped by `z = e^(sT)`. The numerator is the one whose response to linear interpolation
//! between samples equals that of the model: each `sᵏ/B(s)` is simulated with one unit sample, which
//! gives its part of the sampled numerator, and the weights of the six parts are solved for.

use cg_core::Reduced5;
use cg_core::truck::reduced::ORDER;
use cg_core::truck::simulation::Simulation;
use cg_vehicle::matrix::eigenvalues;
use nalgebra::{Complex, DMatrix, SMatrix, SVector};

/// Unknowns of an ARX model `[5 6 0]`.
pub(super) const UNKNOWNS: usize = 2 * ORDER + 1;

/// The transfer function of `a1 … a5, b0 … b5`, or `None` if no real one has these poles (one
/// of them is zero, or real and negative).
pub(super) fn to_continuous(
    coefficients: &[f64; UNKNOWNS],
    interval_s: f64,
) -> Option<Reduced5<f64>> {
    let (past, inputs) = coefficients.split_at(ORDER);
    let companion = DMatrix::from_fn(ORDER, ORDER, |i, j| match i {
        0 => -past[j],
        _ if j + 1 == i => 1.0,
        _ => 0.0,
    });
    let mut denominator = vec![Complex::new(1.0, 0.0)]; // ascending
    for (re, im) in eigenvalues(&companion).ok()? {
        if re <= 0.0 && im.abs() <= 1e-9 * re.abs() {
            return None;
        }
        let s = Complex::new(libm::log(libm::hypot(re, im)), libm::atan2(im, re)) / interval_s;
        denominator.push(Complex::new(0.0, 0.0));
        for k in (0..denominator.len()).rev() {
            let lower = if k > 0 { denominator[k - 1] } else { Complex::new(0.0, 0.0) };
            denominator[k] = lower - s * denominator[k];
        }
    }
    let mut model = Reduced5 {
        numerator: [0.0; ORDER + 1],
        denominator: [0.0; ORDER],
        speed_slope: [0.0; ORDER],
    };
    for (ours, value) in model.denominator.iter_mut().zip(&denominator) {
        *ours = value.re;
    }
    let mut shares = SMatrix::<f64, 6, 6>::zeros();
    for k in 0..=ORDER {
        model.numerator = [0.0; ORDER + 1];
        model.numerator[k] = 1.0;
        shares.set_column(k, &sampled_numerator(&model, past, interval_s));
    }
    let weights = shares.lu().solve(&SVector::<f64, 6>::from_column_slice(inputs))?;
    model.numerator.copy_from_slice(weights.as_slice());
    let finite = model.numerator.iter().chain(&model.denominator).all(|x| x.is_finite());
    finite.then_some(model)
}

/// `b0 … b5` of a transfer function whose sampled denominator is known: the response to one
/// unit sample times that denominator.
fn sampled_numerator(model: &Reduced5<f64>, past: &[f64], interval_s: f64) -> SVector<f64, 6> {
    let mut simulation = Simulation::new(model, interval_s, 0.0);
    let mut response = [0.0; ORDER + 1];
    for (k, y) in response.iter_mut().enumerate() {
        *y = simulation.push(if k == 0 { 1.0 } else { 0.0 });
    }
    SVector::from_fn(|j, _| {
        let delayed: f64 = (1..=j).map(|i| past[i - 1] * response[j - i]).sum();
        response[j] + delayed
    })
}
