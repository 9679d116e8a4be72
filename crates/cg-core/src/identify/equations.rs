//! The equations of the filtered regression, from its rows to a triangle, and their solution.

use crate::identify::long_run::LongRun;
use crate::identify::mean::{Mean, Scatter};
use crate::identify::pending::Pending;
use crate::identify::unknowns::{DRIFT, GAIN, HalfSquare, OFFSET, REGRESSORS, UNKNOWNS};
use crate::math::linalg::Triangle;
use crate::math::real::Real;

/// Share of the input that is not noise, at least. With less, the doubt makes the ratio unusable.
const LEAST_KNOWN: f64 = 0.25;

/// The triangle of the rows, stored in half the memory of a square array.
pub(crate) type Equations<T> = Triangle<T, REGRESSORS, HalfSquare<T>>;

/// Rows on their way into the triangle, several at a time, and what is kept of them beside it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, Pending<T, REGRESSORS, B>: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, Pending<T, REGRESSORS, B>: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Gathered<T: Real, const B: usize> {
    pub(crate) triangle: Equations<T>,
    scatter: Scatter<T>,
    pub(crate) long_run: LongRun<T, REGRESSORS, HalfSquare<T>>,
    pending: Pending<T, REGRESSORS, B>,
    /// The weight of the last row and its root, which costs as much as a tenth of a row.
    weight: [T; 2],
}

impl<T: Real, const B: usize> Gathered<T, B> {
    /// No rows.
    pub(crate) const NONE: Self = Self {
        triangle: Triangle::new(),
        scatter: Scatter::NONE,
        long_run: LongRun::new(),
        pending: Pending::new(),
        weight: [T::ZERO; 2],
    };

    /// Adds the row that was made of a mean, with the weight of its samples. `rise` is how much the expected
    /// roll angle has grown since the mean before.
    pub(crate) fn push(&mut self, row: [T; REGRESSORS], observation: T, mean: &Mean<T>, rise: T) {
        // A single sample has no neighbors, and the first row no interval.
        if mean.samples > 1 && mean.interval_s > T::zero() {
            self.scatter.push(mean.squares_about(rise / mean.interval_s), mean.weight);
        }
        self.long_run.push(&row, observation, [mean.weight, mean.elapsed_s]);
        if mean.weight != self.weight[0] {
            self.weight = [mean.weight, mean.weight.root()];
        }
        let [_, root] = self.weight;
        self.pending.push_into(&mut self.triangle, row.map(|x| x * root), observation * root);
    }

    /// Brings all rows into the triangle.
    pub(crate) fn settle(&mut self) {
        self.pending.fold_into(&mut self.triangle);
    }

    /// Multiplies the weight of all rows so far by `factor`, and lets the time of the drift begin again
    /// `clock` later.
    pub(crate) fn forget(&mut self, factor: T, clock: T) {
        self.settle();
        self.scatter.forget(factor);
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
        let hidden = self.scatter.freedom;
        let white = self.scatter.white_variance(squares / freedom(weight - hidden));
        [(squares + white * hidden) / freedom(weight), white]
    }
}

/// The solution of the rows together with the prior.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Corrects the bias that noise of the roll angle and of the input cause: `roll` and, per unit of the gain,
    /// `input` are that of `Σ φ e` with reversed sign.
    pub(crate) fn correct(&mut self, roll: &[T; REGRESSORS], input: &[T; REGRESSORS]) {
        let input = self.triangle.shift_for(input, UNKNOWNS);
        let roll = self.triangle.shift_for(roll, UNKNOWNS);
        // The residual contains the response of the corrected gain to the noise of the input, so
        // g = 1 + γ + roll + g input.
        let known = (T::one() - input[GAIN]).max(T::of(LEAST_KNOWN));
        let gain = (T::one() + self.theta[GAIN] + roll[GAIN]) / known;
        // A relative error of the noise's variance changes the correction by as much, and the gain in it.
        self.input_shift = [input[0], input[GAIN]].map(|shift| shift * gain / known);
        for (theta, (roll, input)) in self.theta.iter_mut().zip(roll.iter().zip(input)) {
            *theta += *roll + input * gain;
        }
    }
}
