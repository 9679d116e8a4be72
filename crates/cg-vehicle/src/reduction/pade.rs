//! The reduction of the thesis: Padé approximants at s = 0.
//!
//! Cauer's second continued fraction, truncated after `2n + 1` quotients, is the `[n/n]`
//! approximant.
//!
//! **Reference.** Chen and Shieh, *A novel approach to linear model simplification*, Int. J.
//! Control 8 (1968); Baker and Graves-Morris, *Padé Approximants*, 2nd ed., §1.1.

use nalgebra::{DMatrix, DVector};

use crate::system::{Rational, matched_numerator};

/// The `[n/n]` Padé approximant of a series `t0 + t1 s + …` with at least `2n + 1` terms; `None` if
/// it does not exist.
pub fn pade(series: &[f64], order: usize) -> Option<Rational> {
    if series.len() < 2 * order + 1 {
        return None;
    }
    if order == 0 {
        return Some(Rational { numerator: vec![series[0]], denominator: vec![1.0] });
    }
    // Time is scaled so that the terms are of similar size; otherwise the system is
    // ill-conditioned.
    let scale = time_scale(series, order);
    let mut power = 1.0;
    let t: Vec<f64> = series
        .iter()
        .map(|term| {
            let scaled = term * power;
            power *= scale;
            scaled
        })
        .collect();
    // Denominator 1 + q1 s + … + qn sⁿ:  Σ_j q_j t_(k−j) = 0,  k = n+1 … 2n
    let system = DMatrix::from_fn(order, order, |i, j| t[order + i - j]);
    let rhs = DVector::from_fn(order, |i, _| -t[order + 1 + i]);
    let q = system.lu().solve(&rhs)?;
    let mut denominator = vec![1.0];
    denominator.extend(q.iter());
    let leading = denominator[order];
    for (k, value) in denominator.iter_mut().enumerate() {
        // s^k in scaled time is (s/scale)^k in seconds.
        #[allow(clippy::cast_precision_loss)] // at most a dozen
        let exponent = order as f64 - k as f64;
        *value = *value / leading * libm::pow(scale, exponent);
    }
    let numerator = matched_numerator(&denominator, series);
    numerator
        .iter()
        .chain(&denominator)
        .all(|x| x.is_finite())
        .then_some(Rational { numerator, denominator })
}

fn time_scale(series: &[f64], order: usize) -> f64 {
    #[allow(clippy::cast_precision_loss)]
    let exponent = 1.0 / (2 * order).max(1) as f64;
    let scale = libm::pow((series[0] / series[2 * order]).abs(), exponent);
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rational_function_is_its_own_approximant() {
        // (2 + s) / ((s + 1)(s + 3))
        let (numerator, denominator) = ([2.0, 1.0, 0.0], [3.0, 4.0, 1.0]);
        let known = Rational { numerator: numerator.to_vec(), denominator: denominator.to_vec() };
        let series = known.system().moments(5).unwrap();
        let found = pade(&series, 2).unwrap();
        for (a, b) in found.numerator.iter().zip(numerator) {
            assert!((a - b).abs() < 1e-12);
        }
        for (a, b) in found.denominator.iter().zip(denominator) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
