//! The interface and the result of an identifier of the transfer function from an input to the roll
//! angle.
//!
//! There are two identifiers, both based on recursive least squares
//! ([`Triangle`](crate::math::linalg::Triangle)):
//!
//! * [`Arx`](crate::Arx): the classical shift form (eq. 5.1), for comparison with the thesis,
//!   MATLAB and Octave. Use it in `f64`, because its regressors are nearly collinear.
//! * [`FilteredArx`](crate::FilteredArx): the one used in production. Input and roll angle pass
//!   through the filters `sᵏ/B(s)` of the reduced model. The rows are therefore well conditioned
//!   (condition number 20–270 instead of 1e10 and more), and `f32` is sufficient.
//!
//! **Reference.** Ljung, *System Identification*, 2nd ed., §4.2 (ARX), §10.1 (QR);
//! Garnier and Wang, *Identification of Continuous-time Models from Sampled Data*, §1.3.

use core::fmt;

use crate::identify::mean::Mean;
use crate::math::real::Real;
use crate::truck::ratio::Measured;
use crate::truck::reduced::Reduced5;

/// The reason why the data do not determine a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Unexcited {
    /// There are fewer rows than unknowns.
    TooFewRows {
        /// Number of rows.
        rows: u32,
    },
    /// The input is nearly constant.
    Input,
    /// The input changes but does not determine the DC ratio. (For an [`Arx`](crate::Arx): the
    /// regressor with this index is a linear combination of those before it.)
    Direction {
        /// Index of the unknown that is not determined.
        unknown: usize,
    },
}

impl fmt::Display for Unexcited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewRows { rows: 0 } => f.write_str(
                "no row can be used: the lateral acceleration was too great or, for the steer angle, the speed was \
                 not steady",
            ),
            Self::TooFewRows { rows } => {
                write!(f, "only {rows} rows, fewer than the unknowns of the model")
            }
            Self::Input => f.write_str(
                "the input hardly changes: there is no turn to identify from (the first three seconds of a \
                 turn that begins with the log do not count)",
            ),
            Self::Direction { unknown } => {
                write!(f, "the input does not excite unknown {unknown} of the model")
            }
        }
    }
}

/// An identified model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fit<T> {
    /// The DC ratio `R_i = A0/B0`, radians of roll per unit of input, and its standard deviation.
    pub ratio: Measured<T>,
    /// Drift of the roll sensor's offset, radians per second. Zero if the identifier does not
    /// estimate it.
    pub drift_radps: Measured<T>,
    /// Nonlinearity of the measured roll angle: the cubic part at the greatest expected angle, as a
    /// share of that angle. It is negative if the range of the sensor ends below the roll angle,
    /// and positive for a dead band. Zero if the identifier does not estimate it.
    pub bend: Measured<T>,
    /// Standard deviation of the residual, radians (not below the noise floor). For a roll angle that
    /// passed the lags of its channel, it is that of the white noise of the sensor that would leave it.
    pub noise_sd_rad: T,
    /// Signal-to-noise ratio: mean square of the roll response divided by the noise variance, dB.
    pub snr_db: T,
    /// `100 (1 − ‖residual‖/‖roll − mean‖)`, %.
    pub fit_percent: T,
    /// Root mean square of the part of the roll angle that the reduced model does not explain at
    /// the identified gain, without noise, divided by the standard deviation of the roll angle.
    /// Zero if there is no model.
    pub misfit: T,
    /// Number of rows used.
    pub rows: u32,
}

/// The result of an identifier. Data that do not determine a model are a normal result, not an
/// error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Answer<T> {
    /// An identified model.
    Ready(Fit<T>),
    /// The data do not determine one.
    Unexcited(Unexcited),
}

/// Weighted sums over the rows, for means and variances.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Adds one sample.
    pub(crate) fn push(&mut self, input: T, roll: T) {
        self.weight += T::one();
        self.rows = self.rows.saturating_add(1);
        self.input += input;
        self.input_square += input * input;
        self.roll += roll;
        self.roll_square += roll * roll;
    }

    /// Adds the mean of some samples. What the input scatters about it counts as no motion.
    pub(crate) fn push_mean(&mut self, mean: &Mean<T>) {
        self.weight += mean.weight;
        self.rows = self.rows.saturating_add(mean.samples);
        let input = mean.input * mean.weight;
        self.input += input;
        self.input_square += input * mean.input;
        self.roll += mean.roll_rad * mean.weight;
        self.roll_square += mean.roll_squares();
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

    /// `(snr_db, fit_percent)` for a residual of variance `noise_variance`, `slower` times as much of
    /// which the sensor has before the lags. The signal is the roll angle minus `rest`.
    pub(crate) fn quality(&self, noise_variance: T, slower: T, rest: T) -> (T, T) {
        let mean_square = self.roll_square / self.weight
            - T::of(2.0) * rest * self.roll / self.weight
            + rest * rest;
        let signal = (mean_square - noise_variance).max(noise_variance * T::of(1e-6));
        let snr_db = T::of(10.0) * (signal / (noise_variance * slower)).decimal_log();
        let variance = self.roll_variance();
        let fit = if variance > T::zero() {
            T::of(100.0) * (T::one() - (noise_variance / variance).root())
        } else {
            T::zero()
        };
        (snr_db, fit)
    }
}

/// An identifier of the DC ratio, as used by the estimator.
///
/// [`make_for`](Self::make_for) initializes the identifier in place, which avoids a second copy on
/// the stack.
pub trait Identify<T: Real>: Copy {
    /// Settings of this identifier.
    type Options: Copy;
    /// What the stages of a solution leave for the next one.
    type Work: Copy;

    /// The work before the first stage.
    const NOT_BEGUN: Self::Work;

    /// An identifier without a model and without rows.
    const EMPTY: Self;
    /// How many samples may be averaged to one row.
    const MOST_TOGETHER: u32;

    /// Deletes all rows and samples and starts again with the reduced model of a channel. `lags` says
    /// whether the roll angle passes [`RollLags`](crate::truck::lags::RollLags), which make its noise
    /// slow.
    fn make_for(&mut self, model: &Reduced5<T>, lags: bool, options: Self::Options);
    /// A new identifier for a reduced model of the roll angle without lags.
    fn for_model(model: &Reduced5<T>, options: Self::Options) -> Self {
        let mut identifier = Self::EMPTY;
        identifier.make_for(model, false, options);
        identifier
    }
    /// Adds the next row, which is the mean of some samples.
    fn push_mean(&mut self, mean: &Mean<T>);
    /// Adds the next sample, `interval_s` after the previous one, as a row of its own. It is used for the fit only
    /// if `use_row` is true.
    fn push(&mut self, input: T, roll_rad: T, interval_s: T, use_row: bool) {
        self.push_mean(&Mean::single(input, roll_rad, interval_s, use_row));
    }
    /// Spectral density of the noise of the input, rad² s: the variance of a sample times the time
    /// between two. Zero if the identifier does not measure it.
    fn input_noise_rad2_s(&self) -> T {
        T::ZERO
    }
    /// Sets the speed from the next sample on: `pace` is `U0/U − 1`, where `U0` is the speed of the
    /// reduced model; and the [lead](crate::PathLead) of the model's input over the one that is given, s. An
    /// identifier without prior dynamics does not need them.
    fn at_speed(&mut self, _pace: T, _lead_s: T) {}
    /// The roll angle that the reduced model gives for the input so far, radians.
    fn expected_roll_rad(&self) -> T;
    /// Deletes the rows but keeps the past samples.
    fn clear(&mut self);
    /// Deletes the past samples but keeps the rows: the next sample is a new start.
    fn restart(&mut self);
    /// Multiplies the weight of all rows so far by `factor`.
    fn forget(&mut self, factor: T);
    /// Does the next stage of the solution for all rows so far, including rows that wait in a buffer; the last one returns
    /// the result. Before that, rows may neither be added nor be deleted, and the speed may not change, but samples without a
    /// row are taken.
    fn fit_stage(&mut self, work: &mut Self::Work) -> Option<Answer<T>>;
    /// The result for all rows so far, by all stages at once.
    fn fit(&mut self) -> Answer<T> {
        let mut work = Self::NOT_BEGUN;
        loop {
            if let Some(answer) = self.fit_stage(&mut work) {
                return answer;
            }
        }
    }
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
        // Newer rows have more weight: the weights are 3/16 and 1.
        moments.push(6.0, 8.0);
        let share = 16.0 / 19.0;
        let mean = 3.0 + 3.0 * share;
        let square = (35.0 / 3.0) * (1.0 - share) + 36.0 * share;
        assert!((moments.input_variance() - (square - mean * mean)).abs() < 1e-12);
        let mean = 5.0 + 3.0 * share;
        let square = (101.0 / 3.0) * (1.0 - share) + 64.0 * share;
        assert!((moments.roll_variance() - (square - mean * mean)).abs() < 1e-12);
    }

    /// About a rest angle of 1 the mean square is (1 + 9 + 64)/3 = 74/3.
    #[test]
    fn quality_is_the_signal_about_its_rest_over_the_noise() {
        let (snr_db, fit_percent) = moments().quality(2.0 / 3.0, 1.0, 1.0);
        assert!((snr_db - 10.0 * 36.0_f64.log10()).abs() < 1e-9); // (74/3 − 2/3)/(2/3)
        assert!((fit_percent - 100.0 * (1.0 - (2.0_f64 / 26.0).sqrt())).abs() < 1e-9);
        // A signal that is much smaller than the noise gives at least −60 dB.
        let (snr_db, _) = moments().quality(1e3, 1.0, 1.0);
        assert!((snr_db + 60.0).abs() < 1e-9);
        let mut still = Moments::new();
        still.push(1.0, 0.0);
        assert!(still.quality(1.0, 1.0, 0.0).1 == 0.0);
    }
}
