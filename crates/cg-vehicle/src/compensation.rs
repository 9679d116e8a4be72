//! Compensation functions (section 5.4): the F(s) that transforms one response into another.
//!
//! The thesis applies a rounded step to its model and to the vehicle. With the model's roll angle
//! as input and the vehicle's as output it identifies
//!
//! ```text
//!     F(s) = (b_n sⁿ + … + b_0) / (sⁿ + a_(n−1) s^(n−1) + … + a_0),     G_c = F G
//! ```
//!
//! Here the coefficients are determined by least squares on signals filtered by `sᵏ/E(s)`. `E` is a
//! multiple pole at first and then the last denominator found (poles that become unstable are
//! mirrored). From the best of these results, and from the function of the order below, the
//! simulated response itself is fitted. A higher order is therefore never worse. In the thesis it
//! can be, because its shift-form ARX has no such last step.
//!
//! **Reference.** Steiglitz and `McBride`, IEEE Trans. Autom. Control 10 (1965); Garnier and Wang,
//! *Identification of Continuous-time Models from Sampled Data*, §1.3.

use nalgebra::DMatrix;

use crate::error::VehicleError;
use crate::output_error::{filtered, raised, refine};
use crate::reduction::quality::mean_square_degree2;
use crate::system::{Rational, polynomial};

/// The greatest order.
pub const GREATEST_ORDER: usize = 6;
/// Number of filtering rounds, each of which is one least-squares problem.
const ROUNDS: usize = 30;
/// Pole of the first filter: the bandwidth of a truck's roll motion.
const FIRST_POLE_RADPS: f64 = 3.0;
/// Singular values below this share of the greatest one carry no information.
const RANK: f64 = 1e-12;

/// An identified compensation function.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Compensation {
    /// Its order.
    pub order: usize,
    /// The stable function `F(s)`.
    pub function: Rational,
    /// `R_c = F(0)` (eq. 5.19).
    pub dc_gain: f64,
    /// Mean square of the difference between the compensated and the measured response (both given
    /// in radians), degree².
    pub squared_error_degree2: f64,
}

/// Identifies F(s) of a given order from a model's response to the measured one. Both responses
/// start from rest and are given in radians, `interval_s` apart.
///
/// # Errors
/// [`VehicleError::Model`] if the order is not 1 to 6, the lengths differ, there are fewer than ten
/// samples per coefficient, a sample is not a number, or a response is always zero.
pub fn identify(
    model: &[f64],
    measured: &[f64],
    interval_s: f64,
    order: usize,
) -> Result<Compensation, VehicleError> {
    check(model, measured, interval_s, order)?;
    let mut found = one_more(model, measured, interval_s, None)?;
    while found.order < order {
        found = one_more(model, measured, interval_s, Some(&found))?;
    }
    Ok(found)
}

/// The function of the order above `lower`; without `lower`, that of order 1.
fn one_more(
    model: &[f64],
    measured: &[f64],
    interval_s: f64,
    lower: Option<&Compensation>,
) -> Result<Compensation, VehicleError> {
    let order = lower.map_or(1, |lower| lower.order + 1);
    let mut filter = polynomial(&vec![(-FIRST_POLE_RADPS, 0.0); order], 1.0);
    filter.reverse();
    let mut best: Option<(Rational, f64)> = None;
    for _ in 0..ROUNDS {
        let function = round(model, measured, interval_s, &filter)?;
        let response = function.system().response(model, interval_s);
        let error = mean_square_degree2(&response, measured);
        if error.is_finite() && best.as_ref().is_none_or(|(_, least)| error < *least) {
            best = Some((function.clone(), error));
        }
        if function.denominator == filter {
            break;
        }
        filter = function.denominator;
    }
    let mut starts: Vec<Rational> = best.into_iter().map(|(function, _)| function).collect();
    starts.extend(lower.map(|lower| raised(&lower.function, FIRST_POLE_RADPS)));
    let mut fitted: Option<(Rational, f64)> = None;
    for start in &starts {
        let (function, left) = refine(start, model, measured, interval_s, None)?;
        if left.is_finite() && fitted.as_ref().is_none_or(|(_, least)| left < *least) {
            fitted = Some((function, left));
        }
    }
    let (function, _) = fitted.ok_or_else(|| {
        VehicleError::Model(format!("no compensation function of order {order} fits"))
    })?;
    let response = function.system().response(model, interval_s);
    Ok(Compensation {
        order,
        dc_gain: function.dc_gain(),
        squared_error_degree2: mean_square_degree2(&response, measured),
        function,
    })
}

fn check(
    model: &[f64],
    measured: &[f64],
    interval_s: f64,
    order: usize,
) -> Result<(), VehicleError> {
    let fault = |text: String| Err(VehicleError::Model(format!("compensation: {text}")));
    if !(1..=GREATEST_ORDER).contains(&order) {
        return fault(format!("order {order} must lie between 1 and {GREATEST_ORDER}"));
    }
    if !(interval_s.is_finite() && interval_s > 0.0) {
        return fault(format!("the interval {interval_s} s must be positive"));
    }
    if model.len() != measured.len() {
        return fault(format!("the responses have {} and {} samples", model.len(), measured.len()));
    }
    if model.len() < 10 * (2 * order + 1) {
        return fault(format!("{} samples are too few for order {order}", model.len()));
    }
    if !model.iter().chain(measured).all(|value| value.is_finite()) {
        return fault("a sample is not a number".to_owned());
    }
    if model.iter().all(|&value| value == 0.0) || measured.iter().all(|&value| value == 0.0) {
        return fault("a response that is always zero contains no information".to_owned());
    }
    Ok(())
}

/// One least-squares problem on signals filtered by `sᵏ/E(s)`; unstable poles are mirrored.
fn round(
    model: &[f64],
    measured: &[f64],
    interval_s: f64,
    filter: &[f64],
) -> Result<Rational, VehicleError> {
    let n = filter.len() - 1;
    let (u, y) = (filtered(model, interval_s, filter), filtered(measured, interval_s, filter));
    // sⁿ y/E = −Σ a_k s^k y/E + Σ b_k s^k u/E
    let mut rows =
        DMatrix::from_fn(
            model.len(),
            2 * n + 1,
            |i, j| if j < n { -y[(i, j)] } else { u[(i, j - n)] },
        );
    let rhs = y.column(n).into_owned();
    // The columns are scaled to equal size, because the derivatives of a fast filter are large
    // numbers.
    let scale: Vec<f64> = rows.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, scale) in rows.column_iter_mut().zip(&scale) {
        column /= *scale;
    }
    let svd = rows.svd(true, true);
    let tolerance = RANK * svd.singular_values.max();
    let theta = svd
        .solve(&rhs, tolerance)
        .map_err(|error| VehicleError::Model(format!("compensation: {error}")))?;
    let coefficient = |k: usize| theta[k] / scale[k];
    let mut denominator: Vec<f64> = (0..n).map(coefficient).collect();
    denominator.push(1.0);
    let numerator = (n..=2 * n).map(coefficient).collect();
    mirrored(Rational { numerator, denominator })
}

/// The same function with its unstable poles in the left half plane.
fn mirrored(function: Rational) -> Result<Rational, VehicleError> {
    let poles = function.system().poles()?;
    if poles.iter().all(|pole| pole.0 < 0.0) {
        return Ok(function);
    }
    // A pole on the imaginary axis is moved to the left, because the filter would not decay
    // otherwise.
    let mirror = |(re, im): &(f64, f64)| (-re.abs().max(1e-3), *im);
    let mirrored: Vec<(f64, f64)> = poles.iter().map(mirror).collect();
    let mut denominator = polynomial(&mirrored, 1.0);
    denominator.reverse();
    Ok(Rational { numerator: function.numerator, denominator })
}

/// The functions of all orders between the same two responses (Table 5.1).
///
/// # Errors
/// As [`identify`].
pub fn validity_table(
    model: &[f64],
    measured: &[f64],
    interval_s: f64,
) -> Result<Vec<Compensation>, VehicleError> {
    check(model, measured, interval_s, GREATEST_ORDER)?;
    let mut table: Vec<Compensation> = Vec::with_capacity(GREATEST_ORDER);
    while table.len() < GREATEST_ORDER {
        table.push(one_more(model, measured, interval_s, table.last())?);
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduction::quality::StepInput;

    const INPUT: StepInput = StepInput { amplitude_rad: 0.04, rate_per_s: 2.0, duration_s: 10.0 };

    /// Order 3 of Table 5.1 is identified correctly from a response and its transformation by it.
    #[test]
    fn a_known_function_comes_back() {
        let known = Rational {
            numerator: vec![29.55, 24.28, 16.5, 1.356],
            denominator: vec![19.84, 10.87, 3.201, 1.0],
        };
        let model = INPUT.samples();
        let measured = known.system().response(&model, StepInput::INTERVAL_S);
        let found = identify(&model, &measured, StepInput::INTERVAL_S, 3).unwrap();
        // The filters interpolate the responses linearly between samples. The error is (0.01 s)²
        // times a curvature of a few 1/s².
        for (ours, known) in found.function.numerator.iter().zip(&known.numerator) {
            assert!((ours / known - 1.0).abs() < 1e-3, "{found:?}");
        }
        assert!((found.dc_gain / known.dc_gain() - 1.0).abs() < 1e-5, "{found:?}");
        // A higher order brings no improvement, but also no harm.
        let more = identify(&model, &measured, StepInput::INTERVAL_S, 5).unwrap();
        assert!(more.function.system().is_stable().unwrap());
        assert!((more.dc_gain / known.dc_gain() - 1.0).abs() < 1e-4, "{more:?}");
    }

    #[test]
    fn what_cannot_be_identified_is_refused() {
        let model = INPUT.samples();
        let refuse = |model: &[f64], measured: &[f64], order| {
            identify(model, measured, 0.01, order).unwrap_err().to_string()
        };
        assert!(refuse(&model, &model, 7).contains("between 1 and 6"));
        assert!(refuse(&model, &model[1..], 3).contains("1001 and 1000 samples"));
        assert!(refuse(&model[..20], &model[..20], 1).contains("too few"));
        assert!(refuse(&vec![0.0; 500], &model[..500], 1).contains("always zero"));
        assert!(refuse(&vec![f64::NAN; 500], &model[..500], 1).contains("not a number"));
    }
}
