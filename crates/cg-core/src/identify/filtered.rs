//! ARX least squares on filtered signals, the identifier used in production.

use crate::identify::equations::Solution;
use crate::identify::identifier::{Answer, Identify};
use crate::identify::mean::Mean;
pub use crate::identify::pending::{BLOCK, LONG_BLOCK};
use crate::identify::prior::Prior;
use crate::identify::regression::{Regression, Solving};
use crate::identify::roll_noise::RollNoise;
pub use crate::identify::unknowns::UNKNOWNS;
use crate::identify::unknowns::{BEND, BEND_RAD, DRIFT, DRIFT_S, GAIN, OFFSET, REGRESSORS};
use crate::math::real::Real;
use crate::truck::filters::{StateVariableFilter, StepMatrices};
use crate::truck::reduced::{ORDER, Reduced5};
#[cfg(feature = "serde")]
use serde::{Serialize, de::DeserializeOwned};

/// ARX on filtered signals, with a prior on the dynamics.
///
/// Let `y_k` and `u_k` be the roll angle and the input filtered by `sᵏ/B(s)`, and `G = A/B` the
/// reduced model. Each sample, or mean of neighboring samples, gives one row in the
/// *deviations* from that model,
///
/// ```text
///     y − G u = −Σ δb_k y_k  +  γ (G u)  +  Σ_{k≥1} δa_k u_k  +  c + d t  +  e
/// ```
///
/// where `γ` scales the whole response, `δa_k` and `δb_k` change its shape, and `c` and `d` are the
/// offset of the roll sensor and its drift. The deviations are small numbers, so `f32` is accurate
/// enough. The prior of each deviation is a row `δ = 0 ± sd`. The DC ratio is
/// `A0 (1 + γ) / (B0 + δb_0)`. Internally the unit of time is `B0^(−1/5)`. With `dynamics_sd = 0`
/// only `γ`, `c` and `d` are free.
///
/// One additional column, `(G u)³`, is stored but not fitted. Its coefficient shows whether the
/// measured roll angle is a nonlinear function of the expected one, for instance because the range
/// of the sensor ends.
///
/// `B` rows at a time are added to the equations: [`BLOCK`], or [`LONG_BLOCK`] where memory is plentiful.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilteredArx<T: Real, const B: usize = BLOCK> {
    #[cfg_attr(feature = "serde", serde(bound = "Regression<T, B>: Serialize + DeserializeOwned"))]
    regression: Regression<T, B>,
    /// That of its model, `U0/U − 1`.
    pace: T,
    /// Of the model's input over the one that is given, in scaled time.
    lead: T,
    scale_radps: T,
    interval_s: T,
    step: StepMatrices<T>,
    input: StateVariableFilter<T>,
    roll: StateVariableFilter<T>,
    started: bool,
    reference_rad: T,
    /// The response of the model to the input.
    expected_rad: T,
    /// Time since the origin of the drift, in units of [`DRIFT_S`].
    clock: T,
}

impl<T: Real> FilteredArx<T> {
    /// A new identifier for the reduced model `model`.
    pub fn new(model: &Reduced5<T>, prior: Prior<T>) -> Self {
        let mut identifier = Self::EMPTY;
        identifier.begin(model, false, prior);
        identifier
    }
}

impl<T: Real, const B: usize> FilteredArx<T, B> {
    fn begin(&mut self, model: &Reduced5<T>, lags: bool, prior: Prior<T>) {
        self.scale_radps = model.time_scale_radps();
        self.regression.model = model.in_scaled_time(self.scale_radps);
        (self.pace, self.lead) = (T::zero(), T::zero());
        self.regression.prior = prior;
        // The first interval determines the step of the filters.
        self.interval_s = T::zero();
        self.reference_rad = T::zero();
        self.regression.roll_noise = RollNoise::of(lags);
        self.clear();
        self.restart();
    }

    /// Computes the step of the filters for another interval.
    #[inline(never)]
    fn discretise(&mut self, interval_s: T) {
        self.interval_s = interval_s;
        self.step.renew(&self.regression.model, interval_s * self.scale_radps);
    }

    /// Advances the filters to a mean, and adds its row if it is to be used.
    #[inline(never)]
    fn take_mean(&mut self, mean: &Mean<T>) {
        let before_rad = self.expected_rad;
        if self.started {
            if (mean.interval_s - self.interval_s).abs() > self.interval_s * T::machine_epsilon() {
                self.discretise(mean.interval_s);
            }
            self.clock += mean.interval_s / T::of(DRIFT_S);
            self.input.push(&self.step, mean.input);
            self.roll.push(&self.step, mean.roll_rad);
        } else {
            self.started = true;
            self.input = StateVariableFilter::at_rest(&self.regression.model, mean.input);
            self.roll = StateVariableFilter::at_rest(&self.regression.model, T::zero());
        }
        let mut u = self.input.derivatives(&self.regression.model);
        // The sixth derivative is left out. Motions as fast as it matters for are not in turns.
        for k in 0..ORDER {
            u[k] += self.lead * u[k + 1];
        }
        self.expected_rad = self.regression.model.response(&u);
        if mean.is_used {
            self.add_row(&u, mean, before_rad);
        }
    }

    /// Adds the row of a mean. `u` is the filtered input, `before_rad` the roll angle expected at the mean before.
    fn add_row(&mut self, u: &[T; ORDER + 1], mean: &Mean<T>, before_rad: T) {
        let y = self.roll.derivatives(&self.regression.model);
        let nominal = self.expected_rad;
        let mut row = [T::zero(); REGRESSORS];
        row[GAIN] = nominal;
        if self.regression.prior.dynamics_sd > T::zero() {
            for k in 0..ORDER {
                row[k] = -y[k];
                row[GAIN + 1 + k] = u[k + 1];
            }
        }
        if self.regression.prior.offset_sd_rad > T::zero() {
            row[OFFSET] = T::one();
            if self.regression.prior.drift_sd_radps > T::zero() {
                row[DRIFT] = self.clock;
            }
        }
        let bent = nominal / T::of(BEND_RAD);
        row[BEND] = nominal * bent * bent;
        self.regression.push(row, mean, [before_rad, nominal], self.step.newest_share());
    }

    /// Standard deviation of the expected roll angle over the rows, radians.
    pub fn excitation_rad(&self) -> T {
        self.regression.excitation_rad()
    }

    /// Covariance of the deviations in scaled time, in the order of the type's documentation;
    /// `None` if the data do not determine them.
    pub fn covariance(&self) -> Option<[[T; REGRESSORS]; REGRESSORS]> {
        let solution = self.settled()?;
        let mut covariance = solution.triangle.covariance(UNKNOWNS);
        for entry in covariance.iter_mut().flatten() {
            *entry *= solution.slow_sd * solution.slow_sd;
        }
        Some(covariance)
    }

    /// The solution including the rows in the buffer, without changing `self`.
    fn settled(&self) -> Option<Solution<T>> {
        let (mut regression, mut work) = (self.regression, Solving::NOT_BEGUN);
        regression.begin(&mut work, self.noise_products()).ok()?;
        regression.solution(work)
    }

    /// A mean has the noise of a sample divided by the number of samples that come in its time.
    fn noise_products(&self) -> [T; ORDER + 1] {
        let Regression { model, moments, roll_noise, .. } = &self.regression;
        let share = roll_noise.interval_s(moments.weight) / self.interval_s;
        self.step.noise_products(model).map(|product| product * share)
    }

    /// The identified transfer function (time in seconds); `None` if the data do not determine one.
    pub fn model(&self) -> Option<Reduced5<T>> {
        let theta = self.settled()?.theta;
        let mut model = self.regression.model;
        for k in 0..ORDER {
            model.denominator[k] += theta[k];
        }
        let gain = T::one() + theta[GAIN];
        for k in 0..=ORDER {
            model.numerator[k] *= gain;
            if k > 0 {
                model.numerator[k] += theta[GAIN + k];
            }
        }
        Some(model.in_scaled_time(T::one() / self.scale_radps))
    }
}

impl<T: Real, const B: usize> Identify<T> for FilteredArx<T, B> {
    type Options = Prior<T>;
    type Work = Solving<T>;

    const MOST_TOGETHER: u32 = 8;
    const NOT_BEGUN: Solving<T> = Solving::NOT_BEGUN;
    const EMPTY: Self = Self {
        regression: Regression::EMPTY,
        pace: T::ZERO,
        lead: T::ZERO,
        scale_radps: T::ZERO,
        interval_s: T::ZERO,
        step: StepMatrices::STANDING,
        input: StateVariableFilter::EMPTY,
        roll: StateVariableFilter::EMPTY,
        started: false,
        reference_rad: T::ZERO,
        expected_rad: T::ZERO,
        clock: T::ZERO,
    };

    /// The input from the estimator is the expected roll angle, so the model is scaled to unit
    /// gain.
    fn make_for(&mut self, model: &Reduced5<T>, lags: bool, prior: Prior<T>) {
        self.begin(&model.at_unit_gain(), lags, prior);
    }

    fn push_mean(&mut self, mean: &Mean<T>) {
        // A large constant would cost digits in f32, so the first roll angle is subtracted if an offset is fitted.
        if !self.started && self.regression.prior.offset_sd_rad > T::zero() {
            self.reference_rad = mean.roll_rad;
        }
        if mean.is_used {
            self.regression.input_noise.push(mean.input, mean.weight, mean.elapsed_s);
        } else {
            self.regression.input_noise.interrupt();
        }
        self.take_mean(&Mean { roll_rad: mean.roll_rad - self.reference_rad, ..*mean });
    }

    fn input_noise_rad2_s(&self) -> T {
        let Regression { moments, roll_noise, input_noise, .. } = &self.regression;
        input_noise.variance() * roll_noise.interval_s(moments.weight)
    }

    fn at_speed(&mut self, pace: T, lead_s: T) {
        self.lead = lead_s * self.scale_radps;
        let change = pace - self.pace;
        // The numerator is exact to a hundredth of its slope, and does not gather rounding errors.
        if change.abs() > T::of(0.01) {
            self.regression.model.change_pace(change);
            self.pace = pace;
        }
    }

    fn expected_roll_rad(&self) -> T {
        self.expected_rad
    }

    fn clear(&mut self) {
        self.regression.clear();
        self.clock = T::zero();
    }

    /// The next sample is assumed to be in steady state.
    fn restart(&mut self) {
        self.started = false;
    }

    /// Exponential forgetting. The time of the drift starts again from zero, because a large number would cost digits in
    /// `f32`.
    fn forget(&mut self, factor: T) {
        self.regression.forget(factor, self.clock);
        self.clock = T::zero();
    }

    fn fit_stage(&mut self, work: &mut Solving<T>) -> Option<Answer<T>> {
        if work.is_new() {
            let begun = self.regression.begin(work, self.noise_products());
            return begun.err().map(Answer::Unexcited);
        }
        self.regression.advance(work)
    }
}
