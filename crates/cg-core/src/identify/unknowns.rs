//! The unknowns of the filtered regression: their indices and their storage.

use crate::math::linalg::Packed;
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

/// Unit of the roll angle in the regressor of the bend, chosen for the same reason.
pub(crate) const BEND_RAD: f64 = 0.05;

/// Half of a square array, which stores a triangle of equations.
pub(crate) type HalfSquare<T> = Packed<T, REGRESSORS, { REGRESSORS * (REGRESSORS + 1) / 2 }>;
