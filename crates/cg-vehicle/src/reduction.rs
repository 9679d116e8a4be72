//! Reduction of the linear model to order 5 (section 5.5).
//!
//! The source expands the transfer function into a continued fraction about s = 0 (Cauer's
//! second form, eqs. 5.9–5.11) and keeps `2n + 1` quotients. That truncation is the `[n/n]` Padé
//! approximant at s = 0, which is computed here directly from the Taylor coefficients.
//!
//! A Padé approximant of a stable model can be unstable. It is then not used: the five slowest
//! poles of the model take its place as denominator, and the numerator matches the first six
//! Taylor coefficients.
//!
//! **Reference.** Chen and Shieh, *A novel approach to linear model simplification*, Int. J.
//! Control 8 (1968); Baker and Graves-Morris, *Padé Approximants*, 2nd ed., §1.1.

use cg_core::Reduced5;
use cg_core::reduced::ORDER;
use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::response::StateSpace;

/// How a reduced model came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Padé approximant at s = 0.
    Pade,
    /// The model's own slowest poles, numerator matched at s = 0.
    SlowestPoles,
}

/// A rational function, ascending powers, `denominator[n] = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational {
    /// Numerator coefficients, ascending.
    pub numerator: Vec<f64>,
    /// Denominator coefficients, ascending, the last is one.
    pub denominator: Vec<f64>,
}

/// The `[n/n]` Padé approximant of a series `t0 + t1 s + …` with `2n + 1` terms or more; `None`
/// if it does not exist.
pub fn pade(series: &[f64], order: usize) -> Option<Rational> {
    if series.len() < 2 * order + 1 {
        return None;
    }
    // In the time scale in which the terms are of one size, or the system is ill-conditioned.
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
        #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)]
        let exponent = order as i32 - k as i32;
        *value = *value / leading * scale.powi(exponent);
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
    let scale = (series[0] / series[2 * order]).abs().powf(exponent);
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

/// The numerator over `denominator` that matches the series in its first terms.
fn matched_numerator(denominator: &[f64], series: &[f64]) -> Vec<f64> {
    (0..denominator.len()).map(|k| (0..=k).map(|j| denominator[j] * series[k - j]).sum()).collect()
}

/// The first terms of `numerator / denominator`, both series in s.
fn divided(numerator: &[f64], denominator: &[f64]) -> Vec<f64> {
    let mut quotient: Vec<f64> = Vec::with_capacity(numerator.len());
    for k in 0..numerator.len() {
        let known: f64 = (0..k).map(|j| quotient[j] * denominator[k - j]).sum();
        quotient.push((numerator[k] - known) / denominator[0]);
    }
    quotient
}

fn fixed(rational: &Rational) -> Reduced5<f64> {
    let mut reduced = Reduced5 { numerator: [0.0; ORDER + 1], denominator: [0.0; ORDER] };
    reduced.numerator.copy_from_slice(&rational.numerator);
    reduced.denominator.copy_from_slice(&rational.denominator[..ORDER]);
    reduced
}

/// Multiplies a polynomial in ascending powers by another.
fn times(polynomial: &mut Vec<f64>, factor: &[f64]) {
    let mut product = vec![0.0; polynomial.len() + factor.len() - 1];
    for (i, a) in polynomial.iter().enumerate() {
        for (j, b) in factor.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    *polynomial = product;
}

/// Denominator with the five slowest poles: pairs stay together, so where a sixth pole would
/// have to come along, its pair is replaced by one real pole of the same magnitude.
fn slowest_poles(poles: &[(f64, f64)]) -> Vec<f64> {
    let mut upper: Vec<(f64, f64)> = poles.iter().copied().filter(|pole| pole.1 >= 0.0).collect();
    upper.sort_by(|a, b| a.0.hypot(a.1).total_cmp(&b.0.hypot(b.1)));
    let mut denominator = vec![1.0];
    for (re, im) in upper {
        let degree = denominator.len() - 1;
        match ORDER - degree {
            0 => break,
            1 => times(&mut denominator, &[re.hypot(im), 1.0]),
            _ if im == 0.0 => times(&mut denominator, &[-re, 1.0]),
            _ => times(&mut denominator, &[re * re + im * im, -2.0 * re, 1.0]),
        }
    }
    denominator
}

/// Reduced models of order 5 of a vehicle model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedModels {
    /// Steer angle to trailer roll angle.
    pub steer: Reduced5<f64>,
    /// Lateral acceleration to trailer roll angle. The exact transfer function can be unstable
    /// (the lateral acceleration may have zeros in the right half plane), so this one has the
    /// denominator of the other and matches the first six Taylor coefficients.
    pub lateral_acceleration: Reduced5<f64>,
    /// How the first came about.
    pub method: Method,
}

/// Reduces a model.
///
/// # Errors
/// [`VehicleError::Model`] if the model itself is unstable.
pub fn reduce(model: &StateSpace) -> Result<ReducedModels, VehicleError> {
    let poles = model.poles()?;
    if let Some((re, im)) = poles.iter().find(|pole| pole.0 >= 0.0) {
        return Err(VehicleError::Model(format!(
            "the vehicle is unstable at this speed and load (pole {re:.3} {im:+.3}i rad/s)"
        )));
    }
    let terms = 2 * ORDER + 1;
    let roll = model.moments(&model.trailer_roll, 0.0, terms)?;
    let lateral = model.moments(&model.lateral_acceleration, model.lateral_feedthrough, terms)?;
    let approximant = pade(&roll, ORDER).map(|r| fixed(&r)).filter(Reduced5::is_stable);
    let (steer, method) = if let Some(steer) = approximant {
        (steer, Method::Pade)
    } else {
        let denominator = slowest_poles(&poles);
        let numerator = matched_numerator(&denominator, &roll);
        (fixed(&Rational { numerator, denominator }), Method::SlowestPoles)
    };
    let mut denominator = steer.denominator.to_vec();
    denominator.push(1.0);
    let numerator = matched_numerator(&denominator, &divided(&roll, &lateral));
    let lateral_acceleration = fixed(&Rational { numerator, denominator });
    Ok(ReducedModels { steer, lateral_acceleration, method })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rational_function_is_its_own_approximant() {
        // (2 + s) / ((s + 1)(s + 3))
        let (numerator, denominator) = ([2.0, 1.0, 0.0], [3.0, 4.0, 1.0]);
        let mut long = [0.0; 5];
        long[..3].copy_from_slice(&numerator);
        let mut padded = [0.0; 5];
        padded[..3].copy_from_slice(&denominator);
        let series = divided(&long, &padded);
        let found = pade(&series, 2).unwrap();
        for (a, b) in found.numerator.iter().zip(numerator) {
            assert!((a - b).abs() < 1e-12);
        }
        for (a, b) in found.denominator.iter().zip(denominator) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn the_slowest_poles_make_a_stable_denominator_of_degree_five() {
        for poles in [
            vec![(-1.0, 2.0), (-1.0, -2.0), (-3.0, 0.0), (-2.0, 4.0), (-2.0, -4.0), (-9.0, 0.0)],
            vec![(-1.0, 2.0), (-1.0, -2.0), (-2.0, 4.0), (-2.0, -4.0), (-5.0, 6.0), (-5.0, -6.0)],
        ] {
            let denominator = slowest_poles(&poles);
            assert_eq!(denominator.len(), ORDER + 1);
            let numerator = vec![1.0; ORDER + 1];
            assert!(fixed(&Rational { numerator, denominator }).is_stable());
        }
    }
}
