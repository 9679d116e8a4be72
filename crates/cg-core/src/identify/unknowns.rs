//! The unknowns of the filtered regression: their indices, the equations and the solution.

use crate::math::linalg::{Packed, Triangle};
use crate::math::real::Real;
use crate::truck::reduced::ORDER;

/// Number of unknowns of [`FilteredArx`](crate::FilteredArx): five denominator coefficients, the
/// gain, five numerator coefficients, the offset of the roll sensor and its drift.
pub const UNKNOWNS: usize = 2 * ORDER + 3;

/// Number of regressors: those of the unknowns, and the bend as the last one, which is tested but
/// not fitted.
pub(crate) const REGRESSORS: usize = UNKNOWNS + 1;

pub(crate) const GAIN: usize = ORDER;
pub(crate) const OFFSET: usize = 2 * ORDER + 1;
pub(crate) const DRIFT: usize = 2 * ORDER + 2;
pub(crate) const BEND: usize = 2 * ORDER + 3;

/// Unit of time of the drift, s, chosen so that its regressor is of the size of the others.
pub(crate) const DRIFT_S: f64 = 10.0;

/// The triangle of the rows, stored in half the memory of a square array.
pub(crate) type Equations<T> = Triangle<T, REGRESSORS, HalfSquare<T>>;
pub(crate) type HalfSquare<T> = Packed<T, REGRESSORS, { REGRESSORS * (REGRESSORS + 1) / 2 }>;

/// The solution of the rows together with the prior.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution<T: Real> {
    /// Deviations from the reduced model.
    pub(crate) theta: [T; REGRESSORS],
    /// Standard deviation of the residual of single rows, after the lags; not below the noise floor that
    /// is left of the sensor's.
    pub(crate) noise_sd: T,
    /// The same from the long-run variance, which determines the uncertainty of the solution.
    pub(crate) slow_sd: T,
    /// Correction of the bias of `δb_0` and `γ` that noise of the input causes.
    pub(crate) input_shift: [T; 2],
    /// The equations of the solution, including the prior rows.
    pub(crate) triangle: Equations<T>,
}

impl<T: Real> Solution<T> {
    /// An empty solution.
    pub(crate) const NONE: Self = Self {
        theta: [T::ZERO; REGRESSORS],
        noise_sd: T::ZERO,
        slow_sd: T::ZERO,
        input_shift: [T::ZERO; 2],
        triangle: Triangle::new(),
    };
}
