//! The noise of the roll angle in the regressors.
//!
//! White noise of the sensor is slow noise after the two lags of a channel: after two lags of `T` its
//! correlation over a time `t` is `(1 + t/T) e^(−t/T)`.

use crate::math::real::Real;
use crate::truck::channel::ROLL_LAG_S;
use crate::truck::reduced::ORDER;

/// The noise of the roll angle in the rows.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RollNoise<T> {
    /// The weight of the newest mean in the signal filtered by `sᵏ/B`, k = 0…4, summed over the means;
    /// zero with lags. A mean has the noise of a sample divided by the number of samples, and the weight of
    /// that number.
    pub(crate) sum: [T; ORDER],
    /// The time of the rows, s.
    seconds: T,
    /// Whether the roll angle passes the lags.
    lags: bool,
}

impl<T: Real> RollNoise<T> {
    pub(crate) const NONE: Self = Self { sum: [T::ZERO; ORDER], seconds: T::ZERO, lags: false };

    /// The noise of a roll angle with or without lags.
    pub(crate) fn of(lags: bool) -> Self {
        Self { lags, ..Self::NONE }
    }

    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        *self = Self::of(self.lags);
    }

    /// Adds the row of a mean. `share` is the [weight of the newest one](crate::truck::filters::StepMatrices::newest_share).
    pub(crate) fn add_row(&mut self, share: &[T; ORDER], interval_s: T) {
        self.seconds += interval_s;
        if !self.lags {
            for (sum, share) in self.sum.iter_mut().zip(share) {
                *sum += *share;
            }
        }
    }

    pub(crate) fn scale(&mut self, factor: T) {
        for sum in self.sum.iter_mut().chain([&mut self.seconds]) {
            *sum *= factor;
        }
    }

    /// The time between two samples, whose weight is `samples`; zero if there are none.
    pub(crate) fn interval_s(&self, samples: T) -> T {
        if samples > T::zero() { self.seconds / samples } else { T::zero() }
    }

    /// The long-run variance of the noise divided by its variance, if the sensor's noise is white.
    /// `rows` is their weight.
    pub(crate) fn inflation(&self, rows: T) -> T {
        if self.lags { inflation(self.interval_s(rows)) } else { T::one() }
    }
}

/// The long-run variance of a residual divided by its `variance`: a part of it is the response to
/// the noise of the input, which is slow too. At s = 0 the model has a gain of one, so the long-run
/// variance of that part is the variance of the input's noise. It is at least one.
pub(crate) fn usual<T: Real>(inflation: T, variance: T, [input, passed]: [T; 2]) -> T {
    let of_roll = (variance - passed).max(T::zero()) * inflation;
    let usual = (of_roll + input) / variance;
    // This form of the comparison gives one for a residual of zero (0/0).
    if usual > T::one() { usual } else { T::one() }
}

/// The long-run variance of white noise after the lags, divided by its variance: the noise counts as
/// `4 T` seconds of equal errors.
fn inflation<T: Real>(interval_s: T) -> T {
    (T::of(4.0 * ROLL_LAG_S) / interval_s).max(T::one())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::white::white;
    use crate::truck::lags::RollLags;

    /// Noise of the input with a variance of 3, of which the model passes 0.25, beside 0.75 of the roll
    /// angle, which is as slow as the lags make it.
    #[test]
    fn noise_of_the_input_is_slow() {
        for (inflation, variance, heard, expected) in [
            (2.0_f64, 1.0, [3.0, 0.25], 0.75 * 2.0 + 3.0),
            (1.0, 1.0, [3.0, 0.25], 0.75 + 3.0),
            (1.0, 1.0, [0.0; 2], 1.0),
            (1.0, 0.0, [0.0; 2], 1.0),
        ] {
            assert!((usual(inflation, variance, heard) - expected).abs() < 1e-15);
        }
    }

    /// White noise through the lags.
    #[test]
    fn the_inflation_is_that_of_block_sums() {
        let interval_s = 0.01_f64;
        let mut lags = RollLags::at_rest(0.0);
        let (mut square, mut block, mut blocks) = (0.0, 0.0, 0.0);
        let rows = 600_000_u32;
        for k in 0..rows {
            let late = lags.push(white(k), interval_s);
            square += late * late / f64::from(rows);
            block += late;
            if k % 150 == 149 {
                blocks += block * block / 150.0 / f64::from(rows / 150);
                block = 0.0;
            }
        }
        // Of a block of length L, its ends take 3 T/(2 L). 4000 blocks: their mean square has a standard
        // deviation of √(2/4000) = 2.2 %, here three of them.
        let expected = inflation(interval_s) * (1.0 - ROLL_LAG_S);
        assert!((blocks / square / expected - 1.0).abs() < 0.067);
    }
}
