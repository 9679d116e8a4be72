//! Neighboring rows of a regression are added up before they reach the triangle.
//!
//! A truck rolls within seconds, so a row that is a hundredth of a second later says little that its
//! neighbors do not say. `m` rows are replaced by their sum divided by `√m`, which has the weight of
//! `m` rows. What the sums do not contain is how much the rows scatter about their mean. For the
//! residual that is nearly all of a sensor's white noise, so it is kept as a number.

use crate::math::real::Real;

/// Rows are added up over this time. The regressors have passed a lag of fifth order, and in the band of
/// usual maneuvers (up to ω = 6 rad/s) they scatter about their mean by `(ω τ)²/12` = 0.5 % of their
/// square in it, which is the information that is lost. It is slightly below a round number, so that
/// rounding does not decide which row is the last.
const SUM_S: f64 = 0.0396;

/// Rows that are added up at most.
const MOST_ROWS: u8 = 8;

/// The rows since the last sum, and how much the observations so far scatter within their sums.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; N]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; N]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Neighbors<T, const N: usize> {
    sum: Sum<T, N>,
    first: T,
    /// Sum and sum of squares of the observations minus the first one.
    deviations: [T; 2],
    /// Sum of squares of the observations about the means of their sums.
    scatter: T,
    /// Number of rows minus number of sums.
    pub(crate) hidden: T,
}

/// The sum of some rows.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; N]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; N]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Sum<T, const N: usize> {
    pub(crate) regressors: [T; N],
    pub(crate) observation: T,
    pub(crate) rows: T,
    pub(crate) elapsed_s: T,
}

impl<T: Real, const N: usize> Sum<T, N> {
    pub(crate) const EMPTY: Self =
        Self { regressors: [T::ZERO; N], observation: T::ZERO, rows: T::ZERO, elapsed_s: T::ZERO };

    /// Adds another sum to this one.
    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, value) in self.regressors.iter_mut().zip(&other.regressors) {
            *sum += *value;
        }
        self.observation += other.observation;
        self.rows += other.rows;
        self.elapsed_s += other.elapsed_s;
    }

    /// The row with the weight of all rows in the sum.
    pub(crate) fn row(&self) -> ([T; N], T) {
        let scale = T::one() / self.rows.root();
        (self.regressors.map(|sum| sum * scale), self.observation * scale)
    }
}

impl<T: Real, const N: usize> Neighbors<T, N> {
    pub(crate) const fn new() -> Self {
        let zero = T::ZERO;
        Self { sum: Sum::EMPTY, first: zero, deviations: [zero; 2], scatter: zero, hidden: zero }
    }

    /// Adds a row that represents the time `elapsed_s`. Returns whether the sum is complete.
    pub(crate) fn push(&mut self, regressors: [T; N], observation: T, elapsed_s: T) -> bool {
        if self.sum.rows == T::zero() {
            self.first = observation;
        }
        let deviation = observation - self.first;
        self.deviations[0] += deviation;
        self.deviations[1] += deviation * deviation;
        self.sum.add(&Sum { regressors, observation, rows: T::one(), elapsed_s });
        self.sum.elapsed_s >= T::of(SUM_S) || self.sum.rows >= T::of(f64::from(MOST_ROWS))
    }

    /// The rows since the last sum as a new one; `None` if there are none.
    pub(crate) fn take(&mut self) -> Option<Sum<T, N>> {
        let sum = self.sum;
        if sum.rows == T::zero() {
            return None;
        }
        let [deviation, squares] = self.deviations;
        self.scatter += squares - deviation * deviation / sum.rows;
        self.hidden += sum.rows - T::one();
        (self.sum, self.deviations) = (Sum::EMPTY, [T::zero(); 2]);
        Some(sum)
    }

    /// Multiplies the weight of all sums so far by `factor`.
    pub(crate) fn forget(&mut self, factor: T) {
        self.scatter *= factor;
        self.hidden *= factor;
    }

    /// The variance of the white noise in single rows: that within the sums, which is also that of the
    /// rows made of the sums, of which `variance` is known. Motion that a model explains is in the first
    /// alone, slow errors of a model in the second alone.
    pub(crate) fn white_variance(&self, variance: T) -> T {
        let within = self.scatter / self.hidden;
        // This form of the comparison also serves without sums (0/0), as at 25 samples a second.
        if within < variance { within.max(T::zero()) } else { variance }
    }
}

/// The number of rows in a sum at a constant interval.
pub(crate) fn rows_at<T: Real>(interval_s: T) -> u8 {
    let mut elapsed_s = T::zero();
    for rows in 1..MOST_ROWS {
        elapsed_s += interval_s;
        if elapsed_s >= T::of(SUM_S) {
            return rows;
        }
    }
    MOST_ROWS
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;

    /// Rows (1, t) with the observation `law(k, t)`.
    fn rows(
        count: u32,
        interval_s: f64,
        law: impl Fn(u32, f64) -> f64,
    ) -> (Neighbors<f64, 2>, Vec<Sum<f64, 2>>) {
        let (mut neighbors, mut sums) = (Neighbors::new(), Vec::new());
        for k in 0..count {
            let t = f64::from(k) * interval_s;
            if neighbors.push([1.0, t], law(k, t), interval_s) {
                sums.extend(neighbors.take());
            }
        }
        (neighbors, sums)
    }

    #[test]
    fn sums_end_after_four_hundredths_of_a_second_or_eight_rows() {
        for (interval_s, rows_each) in [(0.1, 1), (0.04, 1), (0.02, 2), (0.01, 4), (0.001, 8)] {
            let (_, sums) = rows(8, interval_s, |_, _| 0.0);
            assert_eq!(sums.len(), 8 / usize::from(rows_each));
            assert!(sums.iter().all(|sum| (sum.rows - f64::from(rows_each)).abs() < 1e-12));
            assert_eq!(rows_at(interval_s), rows_each);
        }
    }

    /// By hand: of ±0.1 nothing is left in sums of two or four rows, so all of it is scatter, 0.01 per row.
    /// One of two degrees of freedom remains in pairs, three of four in fours.
    #[test]
    fn what_the_sums_do_not_contain_is_scatter() {
        for (interval_s, white) in [(0.02, 0.02), (0.01, 0.04 / 3.0)] {
            let noise = |k, _| 3.0 + if k % 2 == 0 { 0.1 } else { -0.1 };
            let (mut neighbors, _) = rows(400, interval_s, noise);
            for _ in 0..2 {
                assert!((neighbors.white_variance(9.0) - white).abs() < 1e-12);
                neighbors.forget(0.5);
            }
            assert!((neighbors.white_variance(1e-3) - 1e-3).abs() < 1e-15);
        }
        let (single, _) = rows(80, 0.1, |k, _| f64::from(k));
        assert!((single.white_variance(0.7) - 0.7).abs() < 1e-15);
    }

    #[test]
    fn rows_that_wait_become_a_sum_of_their_own_weight() {
        let (mut neighbors, sums) = rows(6, 0.01, |_, t| 3.0 + t);
        assert_eq!(sums.len(), 1);
        let (row, observation) = neighbors.take().unwrap().row();
        let root = 2.0_f64.sqrt();
        assert!((row[0] - root).abs() < 1e-12 && (row[1] - 0.09 / root).abs() < 1e-12);
        assert!((observation - 6.09 / root).abs() < 1e-12);
        assert!(neighbors.take().is_none());
    }
}
