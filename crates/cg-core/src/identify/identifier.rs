//! Identification of the input-to-roll transfer function by ARX least squares.
//!
//! Two regressors on one kernel ([`Triangle`](crate::math::linalg::Triangle)):
//!
//! * [`Arx`](crate::Arx): the classical shift form (eq. 5.1), for parity with the source, MATLAB
//!   and Octave. Use it in `f64`: its regressors are nearly collinear.
//! * [`FilteredArx`](crate::FilteredArx): the production form. Input and roll pass through the filters
//!   `sᵏ/B(s)` of the reduced model, which makes the rows well conditioned (20–270
//!   against 1e10 and more), so that `f32` suffices.
//!
//! **Reference.** Ljung, *System Identification*, 2nd ed., §4.2 (ARX), §10.1 (QR);
//! Garnier and Wang, *Identification of Continuous-time Models from Sampled Data*, §1.3.

use core::fmt;

use crate::math::real::Real;
use crate::truck::ratio::Measured;
use crate::truck::reduced::Reduced5;

/// What cannot be told from the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unexcited {
    /// Fewer rows than unknowns.
    TooFewRows {
        /// Rows seen.
        rows: u32,
    },
    /// The input hardly moved.
    Input,
    /// The input moved, but the DC ratio stays undetermined (for an [`Arx`](crate::Arx): the
    /// regressor with this index is a combination of the ones before it).
    Direction {
        /// Index of the undetermined unknown.
        unknown: usize,
    },
}

impl fmt::Display for Unexcited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewRows { rows } => write!(f, "only {rows} rows: fewer than unknowns"),
            Self::Input => write!(f, "the input hardly moves: no turn to learn from"),
            Self::Direction { unknown } => {
                write!(f, "the input does not excite unknown {unknown} of the model")
            }
        }
    }
}

/// An identified model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<T> {
    /// The DC ratio `R_i = A0/B0`, radians of roll per unit of input, and its standard deviation.
    pub ratio: Measured<T>,
    /// Drift of the roll sensor's offset, radians per second. Zero where it is not identified.
    pub drift_radps: Measured<T>,
    /// By how much the roll angle bends over the expected one, as a share of it at the greatest
    /// expected angle: negative at the end of a sensor's range, positive for a dead band. Zero where
    /// it is not identified.
    pub bend: Measured<T>,
    /// Standard deviation of the residual, radians (not below the noise floor).
    pub noise_sd_rad: T,
    /// Mean square of the roll response over the noise, dB.
    pub snr_db: T,
    /// `100 (1 − ‖residual‖/‖roll − mean‖)`, %.
    pub fit_percent: T,
    /// By how much the reduced model, at the identified gain, misses the roll angle: root mean
    /// square over that of the roll about its mean, noise apart. Zero where there is no model.
    pub misfit: T,
    /// Rows used.
    pub rows: u32,
}

/// The identifier's answer: a state of the world, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer<T> {
    /// An identified model.
    Ready(Fit<T>),
    /// The data do not determine one.
    Unexcited(Unexcited),
}

/// Sums over the rows for the mean squares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<T> {
    pub(crate) weight: T,
    pub(crate) rows: u32,
    input: T,
    input_square: T,
    roll: T,
    roll_square: T,
}

impl<T: Real> Moments<T> {
    pub(crate) const fn new() -> Self {
        let zero = T::ZERO;
        Self {
            weight: zero,
            rows: 0,
            input: zero,
            input_square: zero,
            roll: zero,
            roll_square: zero,
        }
    }

    pub(crate) fn push(&mut self, input: T, roll: T) {
        self.weight += T::one();
        self.rows = self.rows.saturating_add(1);
        self.input += input;
        self.input_square += input * input;
        self.roll += roll;
        self.roll_square += roll * roll;
    }

    pub(crate) fn scale(&mut self, factor: T) {
        self.weight *= factor;
        self.input *= factor;
        self.input_square *= factor;
        self.roll *= factor;
        self.roll_square *= factor;
    }

    pub(crate) fn input_variance(&self) -> T {
        let mean = self.input / self.weight;
        (self.input_square / self.weight - mean * mean).max(T::zero())
    }

    pub(crate) fn roll_variance(&self) -> T {
        let mean = self.roll / self.weight;
        (self.roll_square / self.weight - mean * mean).max(T::zero())
    }

    /// `(snr_db, fit_percent)` for a residual of variance `noise_variance`; the signal is
    /// the roll about `rest`.
    pub(crate) fn quality(&self, noise_variance: T, rest: T) -> (T, T) {
        let mean_square = self.roll_square / self.weight
            - T::of(2.0) * rest * self.roll / self.weight
            + rest * rest;
        let signal = (mean_square - noise_variance).max(noise_variance * T::of(1e-6));
        let snr_db = T::of(10.0) * (signal / noise_variance).decimal_log();
        let variance = self.roll_variance();
        let fit = if variance > T::zero() {
            T::of(100.0) * (T::one() - (noise_variance / variance).root())
        } else {
            T::zero()
        };
        (snr_db, fit)
    }
}

/// An identifier of the DC ratio, as the estimator uses it.
///
/// It is made for a model where it lies: on its way there it would need the stack twice.
pub trait Identify<T: Real>: Copy {
    /// Settings of this identifier.
    type Options: Copy;

    /// Without a model, and without an answer.
    const EMPTY: Self;

    /// Forgets everything and begins anew around the reduced model of a channel.
    fn make_for(&mut self, model: &Reduced5<T>, options: Self::Options);
    /// An empty identifier around the reduced model of a channel.
    fn for_model(model: &Reduced5<T>, options: Self::Options) -> Self {
        let mut identifier = Self::EMPTY;
        identifier.make_for(model, options);
        identifier
    }
    /// Takes in the next sample, `interval_s` after the one before; its row counts only if
    /// `use_row` says so.
    fn push(&mut self, input: T, roll_rad: T, interval_s: T, use_row: bool);
    /// The roll angle that the channel's reduced model makes of the input up to now, radians.
    fn expected_roll_rad(&self) -> T;
    /// Forgets the rows, keeps the memory of past samples.
    fn clear(&mut self);
    /// Forgets everything: the next sample is a new beginning.
    fn restart(&mut self);
    /// Multiplies the weight of all rows so far by `factor`.
    fn forget(&mut self, factor: T);
    /// The answer for all rows so far. Takes in what waits for more rows first.
    fn fit(&mut self) -> Answer<T>;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows (1, 2), (3, 4), (5, 9): means 3 and 5, variances 8/3 and 26/3.
    fn moments() -> Moments<f64> {
        let mut moments = Moments::new();
        for (input, roll) in [(1.0, 2.0), (3.0, 4.0), (5.0, 9.0)] {
            moments.push(input, roll);
        }
        moments
    }

    #[test]
    fn variances_are_about_the_mean_and_forgetting_leaves_them() {
        let mut moments = moments();
        assert_eq!((moments.rows, moments.weight.round()), (3, 3.0));
        for _ in 0..2 {
            assert!((moments.input_variance() - 8.0 / 3.0).abs() < 1e-12);
            assert!((moments.roll_variance() - 26.0 / 3.0).abs() < 1e-12);
            moments.scale(0.25);
        }
        assert!((moments.weight - 3.0 / 16.0).abs() < 1e-15);
        // What comes after counts for more: weights 3/16 and 1.
        moments.push(6.0, 8.0);
        let share = 16.0 / 19.0;
        let mean = 3.0 + 3.0 * share;
        let square = (35.0 / 3.0) * (1.0 - share) + 36.0 * share;
        assert!((moments.input_variance() - (square - mean * mean)).abs() < 1e-12);
        let mean = 5.0 + 3.0 * share;
        let square = (101.0 / 3.0) * (1.0 - share) + 64.0 * share;
        assert!((moments.roll_variance() - (square - mean * mean)).abs() < 1e-12);
    }

    /// About a rest of 1 the mean square is (1 + 9 + 64)/3 = 74/3.
    #[test]
    fn quality_is_the_signal_about_its_rest_over_the_noise() {
        let (snr_db, fit_percent) = moments().quality(2.0 / 3.0, 1.0);
        assert!((snr_db - 10.0 * 36.0_f64.log10()).abs() < 1e-9); // (74/3 − 2/3)/(2/3)
        assert!((fit_percent - 100.0 * (1.0 - (2.0_f64 / 26.0).sqrt())).abs() < 1e-9);
        // Noise without a signal is 60 dB above it at the most.
        let (snr_db, _) = moments().quality(1e3, 1.0);
        assert!((snr_db + 60.0).abs() < 1e-9);
        let mut still = Moments::new();
        still.push(1.0, 0.0);
        assert!(still.quality(1.0, 0.0).1 == 0.0);
    }
}
