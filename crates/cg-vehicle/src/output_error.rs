//! Fits a rational function to a response, which is the last step of compensation and reduction.
//!
//! The mean square of `y − (B/A) u` is minimized over the coefficients by the Levenberg-Marquardt
//! method. The sensitivities are filtered signals:
//!
//! ```text
//!     ŷ = B/A u,     ∂ŷ/∂b_k = sᵏ/A u,     ∂ŷ/∂a_k = −sᵏ/A ŷ
//! ```
//!
//! **Reference.** Ljung, *System Identification*, 2nd ed., §10.2 (output-error gradients);
//! Nocedal and Wright, *Numerical Optimization*, 2nd ed., §10.3.

use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::system::{Rational, Simulation, multiplied};

/// Greatest number of steps; a few dozen are usually enough.
const STEPS: usize = 200;
/// Relative improvement below which the iteration ends.
const SETTLED: f64 = 1e-9;
/// Initial damping, and the damping at which the iteration gives up.
const DAMPING: (f64, f64) = (1e-3, 1e12);

/// The signal filtered by `sᵏ/E(s)`, k = 0 … n, one column each. `filter` contains `E` in ascending
/// powers, with a leading coefficient of one.
pub(crate) fn filtered(signal: &[f64], interval_s: f64, filter: &[f64]) -> DMatrix<f64> {
    let n = filter.len() - 1;
    let system = Rational { numerator: vec![1.0], denominator: filter.to_vec() }.system();
    let mut simulation = Simulation::new(&system.a, &system.b, interval_s);
    let mut columns = DMatrix::zeros(signal.len(), n + 1);
    for (i, &value) in signal.iter().enumerate() {
        if i == 0 {
            simulation.start(value);
        } else {
            simulation.push(value);
        }
        let mut highest = value;
        for k in 0..n {
            columns[(i, k)] = simulation.state[k];
            highest -= filter[k] * simulation.state[k];
        }
        columns[(i, n)] = highest;
    }
    columns
}

/// The function near `start` that best turns `input` into `output`, from rest, and the remaining
/// sum of squares. If `steady` is given, it is the fixed value at s = 0.
///
/// # Errors
/// If the eigenvalues do not converge.
pub(crate) fn refine(
    start: &Rational,
    input: &[f64],
    output: &[f64],
    interval_s: f64,
    steady: Option<f64>,
) -> Result<(Rational, f64), VehicleError> {
    let residual = |function: &Rational| -> DVector<f64> {
        let response = function.system().response(input, interval_s);
        DVector::from_iterator(output.len(), output.iter().zip(response).map(|(y, r)| y - r))
    };
    let mut best = start.clone();
    if let Some(steady) = steady {
        best.numerator[0] = steady * best.denominator[0];
    }
    // Samples contain no information on poles beyond half the sampling rate, and a fit would move
    // them towards infinity.
    let limit = fastest_pole(&best)?.max(std::f64::consts::PI / interval_s);
    let allowed = |candidate: &Rational| fastest_pole(candidate).map(|fastest| fastest <= limit);
    let slopes = |function: &Rational| sensitivities(function, input, interval_s, steady);
    levenberg_marquardt(best, steady, residual, slopes, allowed)
}

/// The function near `best` whose `residual` is the least among those that are `allowed`, and the
/// remaining sum of squares. `slopes` are those of the response, in the order of [`sensitivities`].
///
/// # Errors
/// Those of `allowed`.
pub(crate) fn levenberg_marquardt(
    mut best: Rational,
    steady: Option<f64>,
    residual: impl Fn(&Rational) -> DVector<f64>,
    slopes: impl Fn(&Rational) -> DMatrix<f64>,
    allowed: impl Fn(&Rational) -> Result<bool, VehicleError>,
) -> Result<(Rational, f64), VehicleError> {
    let mut error = residual(&best);
    let mut damping = DAMPING.0;
    for _ in 0..STEPS {
        let jacobian = slopes(&best);
        let mut normal = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * &error;
        let before = error.norm_squared();
        for k in 0..normal.nrows() {
            normal[(k, k)] *= 1.0 + damping;
        }
        let Some(step) = normal.cholesky().map(|cholesky| cholesky.solve(&gradient)) else {
            damping *= 10.0;
            continue;
        };
        let candidate = moved(&best, &step, steady);
        if allowed(&candidate)? {
            let left = residual(&candidate);
            if left.norm_squared() < before {
                let gain = 1.0 - left.norm_squared() / before;
                (best, error) = (candidate, left);
                damping = (damping * 0.3).max(1e-15);
                if gain < SETTLED {
                    break;
                }
                continue;
            }
        }
        damping *= 10.0;
        if damping > DAMPING.1 {
            break;
        }
    }
    let left = error.norm_squared();
    Ok((best, left))
}

/// The same function with its order increased by one: a pole and a zero that cancel.
pub(crate) fn raised(function: &Rational, pole_radps: f64) -> Rational {
    let times = |list: &[f64]| multiplied(list, &[pole_radps, 1.0]);
    Rational { numerator: times(&function.numerator), denominator: times(&function.denominator) }
}

/// The magnitude of the fastest pole; infinity if a pole is unstable.
pub(crate) fn fastest_pole(function: &Rational) -> Result<f64, VehicleError> {
    let poles = function.system().poles()?;
    if poles.iter().any(|pole| !(pole.0 < 0.0)) {
        return Ok(f64::INFINITY);
    }
    Ok(poles.iter().map(|(re, im)| libm::hypot(*re, *im)).fold(0.0, f64::max))
}

/// Columns: the denominator without its leading coefficient, then the numerator (without its
/// constant if the steady-state value is given).
pub(crate) fn sensitivities(
    function: &Rational,
    input: &[f64],
    interval_s: f64,
    steady: Option<f64>,
) -> DMatrix<f64> {
    let n = function.denominator.len() - 1;
    let response = function.system().response(input, interval_s);
    let y = filtered(&response, interval_s, &function.denominator);
    let u = filtered(input, interval_s, &function.denominator);
    let first = usize::from(steady.is_some());
    DMatrix::from_fn(input.len(), 2 * n + 1 - first, |i, j| {
        if j < n {
            let own = -y[(i, j)];
            // b0 is proportional to a0.
            if j == 0 { own + steady.unwrap_or(0.0) * u[(i, 0)] } else { own }
        } else {
            u[(i, j - n + first)]
        }
    })
}

fn moved(function: &Rational, step: &DVector<f64>, steady: Option<f64>) -> Rational {
    let n = function.denominator.len() - 1;
    let first = usize::from(steady.is_some());
    let mut moved = function.clone();
    moved.numerator.resize(n + 1, 0.0);
    for k in 0..n {
        moved.denominator[k] += step[k];
    }
    for k in first..=n {
        moved.numerator[k] += step[n + k - first];
    }
    if let Some(steady) = steady {
        moved.numerator[0] = steady * moved.denominator[0];
    }
    moved
}
