//! The equations of the filtered regression, from its rows to a triangle, and their solution.

use crate::identify::long_run::LongRun;
use crate::identify::neighbors::Neighbors;
use crate::identify::pending::Pending;
use crate::identify::unknowns::{DRIFT, HalfSquare, OFFSET, REGRESSORS};
use crate::math::linalg::Triangle;
use crate::math::real::Real;

/// The triangle of the rows, stored in half the memory of a square array.
pub(crate) type Equations<T> = Triangle<T, REGRESSORS, HalfSquare<T>>;

/// Rows on their way into the triangle, and what is kept of them beside it: neighboring rows are added
/// up, and the sums are reduced several at a time.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gathered<T: Real> {
    pub(crate) triangle: Equations<T>,
    pub(crate) neighbors: Neighbors<T, REGRESSORS>,
    pub(crate) long_run: LongRun<T, REGRESSORS, HalfSquare<T>>,
    pending: Pending<T, REGRESSORS>,
}

impl<T: Real> Gathered<T> {
    /// No rows.
    pub(crate) const NONE: Self = Self {
        triangle: Triangle::new(),
        neighbors: Neighbors::new(),
        long_run: LongRun::new(),
        pending: Pending::new(),
    };

    /// Adds a row that represents the time `interval_s`.
    pub(crate) fn push(&mut self, row: [T; REGRESSORS], observation: T, interval_s: T) {
        if self.neighbors.push(row, observation, interval_s) {
            self.add_up();
        }
    }

    fn add_up(&mut self) {
        let Some(sum) = self.neighbors.take() else { return };
        self.long_run.push(&sum);
        let (row, observation) = sum.row();
        self.pending.push_into(&mut self.triangle, row, observation);
    }

    /// Brings all rows into the triangle.
    pub(crate) fn settle(&mut self) {
        self.add_up();
        self.pending.fold_into(&mut self.triangle);
    }

    /// Multiplies the weight of all rows so far by `factor`, and lets the time of the drift begin again
    /// `clock` later.
    pub(crate) fn forget(&mut self, factor: T, clock: T) {
        self.settle();
        self.neighbors.forget(factor);
        self.triangle.shift(DRIFT, OFFSET, clock);
        self.long_run.shift(DRIFT, OFFSET, clock);
        self.triangle.scale(factor.root());
        self.long_run.forget(factor);
    }

    /// The variance of the residual of single rows at `theta`, and that of the white noise in it.
    /// `weight` is that of all rows, `unknowns` the number that is determined from them.
    pub(crate) fn variances(&self, theta: &[T; REGRESSORS], weight: T, unknowns: T) -> [T; 2] {
        let freedom = |rows: T| (rows - unknowns).max(rows * T::of(0.25));
        let squares = self.triangle.sum_of_squares_at(theta);
        let hidden = self.neighbors.hidden;
        let white = self.neighbors.white_variance(squares / freedom(weight - hidden));
        [(squares + white * hidden) / freedom(weight), white]
    }
}

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
