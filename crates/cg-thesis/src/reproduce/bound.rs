//! The Cramér-Rao bound: the best accuracy of the height that an unbiased estimator can have.
//!
//! White noise of variance σ² on the output makes the Fisher information of the output-error
//! model's parameters θ = (A0 … An, B0 … B(n−1))
//!
//! ```text
//!     F = Σ s sᵀ / σ²,    s(t) = ∂y(t)/∂θ
//! ```
//!
//! and the variance of the DC ratio is at least `gᵀ F⁻¹ g`, `g = ∂(A0/B0)/∂θ`. Sensitivities are
//! central differences of the simulated response. With `S = Q R` (rows s, columns scaled to
//! length one) it is `σ² |R⁻ᵀ g|²`, which never squares the condition number.
//!
//! **Reference.** Ljung, *System Identification*, 2nd ed., §7.4; Söderström and Stoica, *System
//! Identification*, §B.4.

use cg_core::Reduced5;
use cg_core::truck::reduced::ORDER;
use nalgebra::{DMatrix, DVector};

use super::monte_carlo::{Experiment, SAMPLES};
use cg_vehicle::error::VehicleError;
use cg_vehicle::system::Rational;

/// Relative step of the central differences: a compromise between its square and rounding errors.
const STEP: f64 = 1e-5;

/// Poles that are canceled by zeros, rad/s, in a model of lower order that is written with order 5.
const CANCELLED_RADPS: [f64; ORDER] = [2.0, 3.0, 4.0, 5.0, 6.0];

/// A model of order `n ≤ 5`, written with order 5.
pub(super) fn embedded(model: &Rational) -> Option<Reduced5<f64>> {
    let order = model.denominator.len().checked_sub(1)?;
    let (mut numerator, mut denominator) = (model.numerator.clone(), model.denominator.clone());
    numerator.resize(order + 1, 0.0);
    for pole in CANCELLED_RADPS.iter().take(ORDER.checked_sub(order)?) {
        for polynomial in [&mut numerator, &mut denominator] {
            polynomial.push(0.0);
            for k in (0..polynomial.len()).rev() {
                let lower = if k > 0 { polynomial[k - 1] } else { 0.0 };
                polynomial[k] = lower + pole * polynomial[k];
            }
        }
    }
    let mut reduced = Reduced5 {
        numerator: [0.0; ORDER + 1],
        denominator: [0.0; ORDER],
        speed_slope: [0.0; ORDER],
    };
    reduced.numerator.copy_from_slice(&numerator);
    reduced.denominator.copy_from_slice(&denominator[..ORDER]);
    Some(reduced)
}

/// The least relative standard deviation of the DC ratio of `model` if the noise is as strong as the
/// signal (0 dB); at S dB it is `10^(−S/20)` times that.
///
/// # Errors
/// If the experiment does not determine the parameters.
pub(super) fn ratio_sd_at_0_db(model: &Rational, rate_per_s: u32) -> Result<f64, VehicleError> {
    let undetermined = || VehicleError::Model("the Fisher information is singular".to_owned());
    let order = model.denominator.len() - 1;
    let response = |model: &Rational| {
        let reduced = embedded(model).ok_or_else(undetermined)?;
        Ok::<_, VehicleError>(Experiment::on_reduced(&reduced, rate_per_s, 1.0))
    };
    let parameters = 2 * order + 1;
    let mut sensitivity = DMatrix::zeros(SAMPLES, parameters);
    let mut gradient = DVector::zeros(parameters);
    let ratio = model.numerator[0] / model.denominator[0];
    for k in 0..parameters {
        // Relative changes of the parameters, which have similar magnitudes.
        let moved = |change: f64| {
            let mut moved = model.clone();
            let place = match k.checked_sub(order + 1) {
                None => &mut moved.numerator[k],
                Some(k) => &mut moved.denominator[k],
            };
            *place *= 1.0 + change;
            response(&moved)
        };
        let (above, below) = (moved(STEP)?, moved(-STEP)?);
        for (i, (above, below)) in above.roll.iter().zip(&below.roll).enumerate() {
            sensitivity[(i, k)] = (above - below) / (2.0 * STEP);
        }
        if k == 0 {
            gradient[k] = ratio;
        } else if k == order + 1 {
            gradient[k] = -ratio;
        }
    }
    for (k, mut column) in sensitivity.column_iter_mut().enumerate() {
        let length = column.norm();
        column /= length;
        gradient[k] /= length;
    }
    let r = sensitivity.qr().r();
    let whitened = r.transpose().solve_lower_triangular(&gradient).ok_or_else(undetermined)?;
    let noise_sd = response(model)?.mean_square().sqrt();
    let sd = whitened.norm() * noise_sd / ratio.abs();
    if sd.is_finite() { Ok(sd) } else { Err(undetermined()) }
}

/// The same if only the gain is unknown: its relative variance is `σ²/Σ y²`.
pub(super) fn gain_sd_at_0_db() -> f64 {
    #[allow(clippy::cast_precision_loss)]
    let n = SAMPLES as f64;
    1.0 / n.sqrt()
}
