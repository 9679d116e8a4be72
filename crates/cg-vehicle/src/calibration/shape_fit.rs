//! Fits a compensation function with `F(0) = 1` to the responses of several logs at once.
//!
//! The constant factor and the offset of each stretch are eliminated from residuals and slopes; the rest is
//! the Levenberg-Marquardt method of [`crate::output_error`].
//!
//! **Reference.** Golub and Pereyra, *SIAM Journal on Numerical Analysis* 10 (1973), with the simplification of
//! Kaufman, *BIT* 15 (1975).

use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::output_error::{levenberg_marquardt, raised, sensitivities};
use crate::system::Rational;

/// The greatest order.
pub const GREATEST_ORDER: usize = 3;
/// Interval of the responses. Trailers roll at less than 2 Hz.
pub const INTERVAL_S: f64 = 0.05;
/// Least and greatest magnitude of poles and zeros. Slower ones would follow slow noise of the roll angle
/// and errors of the DC ratio, and faster ones change nothing in the band of usual maneuvers.
const ROOTS_RADPS: [f64; 2] = [1.0, 30.0];
/// Pairs of a pole and a zero, rad/s, with which the fits start.
const STARTS_RADPS: [[f64; 2]; 2] = [[3.0, 4.0], [4.0, 3.0]];
/// Least magnitude of the roots of a function that counts. A root at the lower limit is not one of the
/// truck: the fit would like it even slower.
const SLOWEST_RADPS: f64 = 1.1 * ROOTS_RADPS[0];

/// The roll angle of the model in a stretch of a log, beside the measured one.
pub(super) struct Response {
    model_rad: Vec<f64>,
    /// Without its mean; zero in the rows that are not used.
    measured_rad: DVector<f64>,
    used: Vec<bool>,
    rows: f64,
}

impl Response {
    pub(super) fn new(model_rad: Vec<f64>, measured_rad: &[f64], used: &[bool]) -> Self {
        #[allow(clippy::cast_precision_loss)] // rows of a log
        let rows = used.iter().filter(|&&used| used).count().max(1) as f64;
        let measured = DVector::from_column_slice(measured_rad);
        let mut response =
            Self { model_rad, measured_rad: DVector::zeros(0), used: used.to_vec(), rows };
        response.measured_rad = response.deviation(measured);
        response
    }

    /// A signal without its mean in the rows that are used, and zero in the others.
    fn deviation(&self, mut signal: DVector<f64>) -> DVector<f64> {
        let used = || self.used.iter();
        let sum: f64 = signal.iter().zip(used()).filter(|(_, used)| **used).map(|(v, _)| v).sum();
        let mean = sum / self.rows;
        for (value, used) in signal.iter_mut().zip(used()) {
            *value = if *used { *value - mean } else { 0.0 };
        }
        signal
    }

    /// The compensated roll angle without its mean, and the factor with which it explains most of the
    /// measured one.
    fn explained(&self, function: &Rational) -> (DVector<f64>, f64) {
        let response = function.system().response(&self.model_rad, INTERVAL_S);
        let response = self.deviation(DVector::from_vec(response));
        let gain = response.dot(&self.measured_rad) / power(&response);
        (response, gain)
    }

    fn residual(&self, function: &Rational) -> DVector<f64> {
        let (response, gain) = self.explained(function);
        &self.measured_rad - response * gain
    }

    /// Derivatives of the explained roll angle that neither factor nor offset makes.
    fn slopes(&self, function: &Rational) -> DMatrix<f64> {
        let (response, gain) = self.explained(function);
        let mut slopes = sensitivities(function, &self.model_rad, INTERVAL_S, Some(1.0));
        for mut column in slopes.column_iter_mut() {
            let deviation = self.deviation(column.clone_owned());
            let share = deviation.dot(&response) / power(&response);
            column.copy_from(&((deviation - &response * share) * gain));
        }
        slopes
    }
}

fn power(signal: &DVector<f64>) -> f64 {
    signal.norm_squared().max(f64::MIN_POSITIVE)
}

/// Power of the measured roll angles of a log.
fn measured_power(log: &[Response]) -> f64 {
    log.iter().map(|one| one.measured_rad.norm_squared()).sum::<f64>().max(f64::MIN_POSITIVE)
}

/// What a function leaves of the roll angles of a log: the share of their power.
pub(super) fn left(function: &Rational, log: &[Response]) -> f64 {
    let left: f64 = log.iter().map(|one| one.residual(function).norm_squared()).sum();
    left / measured_power(log)
}

/// The function of order 0.
pub(super) fn none() -> Rational {
    Rational { numerator: vec![1.0], denominator: vec![1.0] }
}

/// Whether poles and zeros of a function are stable and within the band of a truck's motion, and
/// `F(0) = 1`.
pub(super) fn is_possible(function: &Rational) -> Result<bool, VehicleError> {
    has_roots_within(function, ROOTS_RADPS)
}

/// Whether a function counts.
pub(super) fn is_of_the_truck(function: &Rational) -> Result<bool, VehicleError> {
    has_roots_within(function, [SLOWEST_RADPS, ROOTS_RADPS[1]])
}

fn has_roots_within(
    function: &Rational,
    [least, greatest]: [f64; 2],
) -> Result<bool, VehicleError> {
    let inside =
        |(re, im): &(f64, f64)| *re < 0.0 && (least..=greatest).contains(&libm::hypot(*re, *im));
    for coefficients in [&function.numerator, &function.denominator] {
        let leading = coefficients.last().copied().unwrap_or(0.0);
        let denominator: Vec<f64> = coefficients.iter().map(|c| c / leading).collect();
        if !denominator.iter().all(|c| c.is_finite()) {
            return Ok(false);
        }
        let roots = Rational { numerator: vec![1.0], denominator }.system().poles()?;
        if !roots.iter().all(inside) {
            return Ok(false);
        }
    }
    Ok((function.dc_gain() - 1.0).abs() < 1e-9)
}

/// The functions of the orders 1 to [`GREATEST_ORDER`] that explain all logs best; each log has the same
/// weight.
pub(super) fn fitted(logs: &[&[Response]]) -> Result<Vec<Rational>, VehicleError> {
    let weighted = |log: &'_ &[Response]| measured_power(log).sqrt().recip();
    let parts: Vec<(&Response, f64)> =
        logs.iter().flat_map(|log| log.iter().map(|one| (one, weighted(log)))).collect();
    let rows: usize = parts.iter().map(|(one, _)| one.used.len()).sum();
    let residual = |function: &Rational| {
        let mut all = DVector::zeros(rows);
        let mut first = 0;
        for (one, weight) in &parts {
            let part = one.residual(function) * *weight;
            all.rows_mut(first, part.len()).copy_from(&part);
            first += part.len();
        }
        all
    };
    let slopes = |function: &Rational| {
        let mut all = DMatrix::zeros(rows, 2 * (function.denominator.len() - 1));
        let mut first = 0;
        for (one, weight) in &parts {
            let part = one.slopes(function) * *weight;
            all.rows_mut(first, part.nrows()).copy_from(&part);
            first += part.nrows();
        }
        all
    };
    let mut functions: Vec<Rational> = Vec::new();
    while functions.len() < GREATEST_ORDER {
        let lower = functions.last().cloned().unwrap_or_else(none);
        let mut best: Option<(Rational, f64)> = None;
        for [pole_radps, zero_radps] in STARTS_RADPS {
            let zero = raised(&lower, zero_radps).numerator;
            let numerator = zero.into_iter().map(|c| c * pole_radps / zero_radps).collect();
            let start = Rational { numerator, ..raised(&lower, pole_radps) };
            let (function, left) =
                levenberg_marquardt(start, Some(1.0), residual, slopes, is_possible)?;
            if best.as_ref().is_none_or(|(_, least)| left < *least) {
                best = Some((function, left));
            }
        }
        functions.extend(best.map(|(function, _)| function));
    }
    Ok(functions)
}
