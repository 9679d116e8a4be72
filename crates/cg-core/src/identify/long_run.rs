//! The long-run variance of a residual, which accounts for slow noise.
//!
//! Least squares assumes that the errors of the rows are independent. Errors due to a rough road,
//! or to dynamics that differ from the model, last for many rows. Correlated residuals carry less
//! information than their number suggests. For a DC ratio the residual's *long-run* variance is
//! decisive. It is computed from sums of the residual over blocks of 1.5 s instead of single rows,
//! and divided by the variance σ² of single rows:
//!
//! ```text
//!     Σ_b (Σ_{rows of b} e)²/m_b / (blocks − effective unknowns)  /  σ²
//! ```
//!
//! The sums of the regressors over each block are stored in a separate triangle. The sums of the
//! residual are then available for any value of the unknowns.
//!
//! **Reference.** Newey and West, *Econometrica* 55 (1987) 703; batch means: Law, *Simulation
//! Modeling and Analysis*, §9.5.

use crate::math::linalg::{Rows, Triangle};
use crate::math::real::Real;

/// Length of a block: several times the settling time of a trailer's roll motion. It is slightly
/// below a round number, so that rounding does not decide which row is the last of a block.
const BLOCK_S: f64 = 1.4996;

/// White noise of the sensor is assumed for this many additional blocks, because the result of a few blocks alone
/// would vary too much.
const BELIEVED_BLOCKS: f64 = 4.0;

/// Sums of rows over blocks of time.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; N]: serde::Serialize, R: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; N]: serde::Deserialize<'de>, R: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct LongRun<T, const N: usize, R = [[T; N]; N]> {
    /// The block so far: sums of regressors and observations, the number of rows and their time, s.
    regressors: [T; N],
    observation: T,
    rows: T,
    elapsed_s: T,
    blocks: T,
    triangle: Triangle<T, N, R>,
}

impl<T: Real, const N: usize, R: Rows<T>> LongRun<T, N, R> {
    pub(crate) const fn new() -> Self {
        Self {
            regressors: [T::ZERO; N],
            observation: T::ZERO,
            rows: T::ZERO,
            elapsed_s: T::ZERO,
            blocks: T::ZERO,
            triangle: Triangle::new(),
        }
    }

    /// Adds the mean of some rows: their number, and the time that they represent, s.
    pub(crate) fn push(&mut self, regressors: &[T; N], observation: T, [rows, elapsed_s]: [T; 2]) {
        for (sum, mean) in self.regressors.iter_mut().zip(regressors) {
            *sum += *mean * rows;
        }
        self.observation += observation * rows;
        self.rows += rows;
        self.elapsed_s += elapsed_s;
        if self.elapsed_s >= T::of(BLOCK_S) {
            let scale = T::one() / self.rows.root();
            self.triangle.push(self.regressors.map(|sum| sum * scale), self.observation * scale);
            self.blocks += T::one();
            self.regressors = [T::zero(); N];
            (self.observation, self.rows, self.elapsed_s) = (T::zero(), T::zero(), T::zero());
        }
    }

    /// Subtracts `times` the regressor `from` from the regressor `column`, in all rows so far.
    pub(crate) fn shift(&mut self, column: usize, from: usize, times: T) {
        self.triangle.shift(column, from, times);
        if let Some(&other) = self.regressors.get(from)
            && let Some(sum) = self.regressors.get_mut(column)
        {
            *sum -= times * other;
        }
    }

    /// Multiplies the weight of all blocks so far by `factor`.
    pub(crate) fn forget(&mut self, factor: T) {
        self.triangle.scale(factor.root());
        self.blocks *= factor;
    }

    /// The long-run variance divided by `variance`, the variance of single residuals, for the
    /// unknowns `theta`. `effective` is the number of unknowns that the data determine. The result
    /// is at least `usual`, that of white noise of the roll angle (after the lags of the channel) and of the input.
    pub(crate) fn inflation(&self, theta: &[T; N], effective: T, variance: T, usual: T) -> T {
        let believed = T::of(BELIEVED_BLOCKS);
        let variance = variance * usual;
        let sum = self.triangle.sum_of_squares_at(theta) + believed * variance;
        let freedom = (self.blocks - effective).max(T::zero()) + believed;
        let excess = sum / (freedom * variance) - T::one();
        // The excess is shrunk if it is below twice its standard deviation for white noise (here
        // squared).
        let scatter = T::of(8.0) / freedom;
        let shrunk = excess * excess * excess / (excess * excess + scatter);
        // This form of the comparison gives one for a residual of zero (0/0).
        usual * if shrunk > T::zero() { T::one() + shrunk } else { T::one() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A single row, and the hundredth of a second that it represents.
    const ROW: [f64; 2] = [1.0, 0.01];

    /// Inflation for a residual around a constant, 100 rows per second for one minute.
    fn inflation(error: impl Fn(u32) -> f64) -> f64 {
        let mut run = LongRun::<f64, 1>::new();
        let mut squares = 0.0;
        for k in 0..6000 {
            run.push(&[1.0], 2.0 + error(k), ROW);
            squares += error(k) * error(k);
        }
        run.inflation(&[2.0], 1.0, squares / 6000.0, 1.0)
    }

    #[test]
    fn noise_that_lasts_counts_for_what_it_is() {
        // The sign changes from row to row: the sums vanish.
        assert!((inflation(|k| if k % 2 == 0 { 1.0 } else { -1.0 }) - 1.0).abs() < 1e-12);
        // The sign changes from block to block (150 rows): each block counts as one row. There are
        // 40 blocks, with the assumed ones 43.
        let slow = inflation(|k| if (k / 150) % 2 == 0 { 1.0 } else { -1.0 });
        assert!((slow / 150.0 - 40.0 / 43.0).abs() < 0.05, "{slow}");
    }

    /// Calculated by hand: six blocks of 150 rows with e = ±1 each; forgetting halves the weight of
    /// two.
    #[test]
    fn the_inflation_is_that_of_the_blocks_by_hand() {
        let mut run = LongRun::<f64, 1>::new();
        let block = |run: &mut LongRun<f64, 1>, error: f64| {
            for _ in 0..150 {
                run.push(&[1.0], 2.0 + error, ROW);
            }
        };
        let law = |sum: f64, freedom: f64, variance: f64| {
            let excess = sum / (freedom * variance) - 1.0;
            1.0 + excess.powi(3) / (excess * excess + 8.0 / freedom)
        };
        block(&mut run, 1.0);
        block(&mut run, -1.0);
        // (150)²/150 per block, and four assumed blocks of white noise.
        let found = run.inflation(&[2.0], 1.0, 0.5, 1.0);
        assert!((found - law(300.0 + 4.0 * 0.5, 5.0, 0.5)).abs() < 1e-9, "{found}");
        run.forget(0.5);
        for error in [1.0, -1.0, 1.0, -1.0] {
            block(&mut run, error);
        }
        let found = run.inflation(&[2.0], 1.5, 2.0, 1.0);
        assert!((found - law(150.0 + 600.0 + 8.0, 5.0 - 1.5 + 4.0, 2.0)).abs() < 1e-9, "{found}");
        // With more unknowns than blocks, only the assumed blocks count.
        let found = run.inflation(&[2.0], 9.0, 2.0, 1.0);
        assert!((found - law(758.0, 4.0, 2.0)).abs() < 1e-9, "{found}");
        // Sums below what noise leaves after the lags: the usual inflation.
        for usual in [1.0, 60.0] {
            assert!((run.inflation(&[2.0], 1.0, 1e4, usual) - usual).abs() < 1e-12);
        }
    }

    /// Shifting the origin of time changes the closed blocks and the block that is not yet closed.
    #[test]
    fn a_shifted_clock_is_as_if_it_had_begun_later() {
        let (mut late, mut soon) = (LongRun::<f64, 2>::new(), LongRun::<f64, 2>::new());
        for k in 0..400 {
            let t = f64::from(k) * 0.01;
            late.push(&[1.0, t], (3.0 * t).sin(), ROW);
            soon.push(&[1.0, t - 2.5], (3.0 * t).sin(), ROW);
        }
        late.shift(1, 0, 2.5);
        for k in 400..600 {
            let t = f64::from(k) * 0.01;
            late.push(&[1.0, t - 2.5], (3.0 * t).sin(), ROW);
            soon.push(&[1.0, t - 2.5], (3.0 * t).sin(), ROW);
        }
        let [late, soon] = [late, soon].map(|run| run.inflation(&[0.3, -0.7], 2.0, 0.1, 1.0));
        assert!((late / soon - 1.0).abs() < 1e-12 && late > 1.1, "{late} {soon}");
    }
}
