//! The unknowns of the filtered regression: their places, their equations, and what is found of them.

use crate::math::linalg::{Packed, Triangle};
use crate::math::real::Real;
use crate::truck::reduced::ORDER;

/// Unknowns of [`FilteredArx`](crate::FilteredArx): five denominator coefficients, the gain, five
/// numerator coefficients, the offset of the roll sensor and its drift.
pub const UNKNOWNS: usize = 2 * ORDER + 3;

/// Regressors: the unknowns, and last the bend, which is tested but not fitted.
pub(crate) const REGRESSORS: usize = UNKNOWNS + 1;

pub(crate) const GAIN: usize = ORDER;
pub(crate) const OFFSET: usize = 2 * ORDER + 1;
pub(crate) const DRIFT: usize = 2 * ORDER + 2;
pub(crate) const BEND: usize = 2 * ORDER + 3;

/// The equations of the rows, in half the memory of a square.
pub(crate) type Equations<T> = Triangle<T, REGRESSORS, HalfSquare<T>>;
pub(crate) type HalfSquare<T> = Packed<T, REGRESSORS, { REGRESSORS * (REGRESSORS + 1) / 2 }>;

/// What the rows and the prior give.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution<T: Real> {
    /// Deviations from the model.
    pub(crate) theta: [T; REGRESSORS],
    /// Standard deviation of the residual, row by row; the floor at least.
    pub(crate) noise_sd: T,
    /// The same of slow noise, which is what the answer's uncertainty follows.
    pub(crate) slow_sd: T,
    /// What noise of the input had taken from `δb_0` and from `γ`.
    pub(crate) input_shift: [T; 2],
    /// The equations that gave the deviations, prior included.
    pub(crate) triangle: Equations<T>,
}

impl<T: Real> Solution<T> {
    /// Before the rows have been asked.
    pub(crate) const NONE: Self = Self {
        theta: [T::ZERO; REGRESSORS],
        noise_sd: T::ZERO,
        slow_sd: T::ZERO,
        input_shift: [T::ZERO; 2],
        triangle: Triangle::new(),
    };
}
