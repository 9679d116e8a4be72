//! ARX least squares on filtered signals, the identifier used in production.

use crate::identify::equations::{Equations, Gathered, Solution};
use crate::identify::identifier::{Answer, Fit, Identify, Moments, Unexcited};
use crate::identify::input_noise::InputNoise;
use crate::identify::mean::Mean;
pub use crate::identify::pending::{BLOCK, LONG_BLOCK};
use crate::identify::prior::Prior;
use crate::identify::roll_noise::RollNoise;
pub use crate::identify::unknowns::UNKNOWNS;
use crate::identify::unknowns::{BEND, DRIFT, DRIFT_S, GAIN, OFFSET, REGRESSORS};
use crate::math::real::Real;
use crate::truck::filters::{StateVariableFilter, StepMatrices};
use crate::truck::ratio::Measured;
use crate::truck::reduced::{ORDER, Reduced5};
#[cfg(feature = "serde")]
use serde::{Serialize, de::DeserializeOwned};

const UNKNOWNS_F64: f64 = 13.0;

/// The correction for noise of the input takes the dynamics for those of the model, from which they differ
/// by 20 % as a rule; it is uncertain by as much.
const DYNAMICS_DOUBT: f64 = 0.2;

/// The ratio is corrected for a drift if the drift is greater than a third of a degree per minute
/// and significant (the probability that chance exceeds it is 0.1 %).
const LEAST_DRIFT_RADPS: f64 = 1e-4;
const SURE: f64 = 3.29;
/// Unit of the roll angle in the regressor of the bend, chosen for the same reason.
const BEND_RAD: f64 = 0.05;

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
    model: Reduced5<T>, // in scaled time, at the pace `U0/U − 1`
    pace: T,
    scale_radps: T,
    prior: Prior<T>,
    interval_s: T,
    step: StepMatrices<T>,
    input: StateVariableFilter<T>,
    roll: StateVariableFilter<T>,
    started: bool,
    #[cfg_attr(feature = "serde", serde(bound = "Gathered<T, B>: Serialize + DeserializeOwned"))]
    rows: Gathered<T, B>,
    moments: Moments<T>,
    reference_rad: T,
    /// The response of the model to the input.
    expected_rad: T,
    /// Time since the origin of the drift, in units of [`DRIFT_S`].
    clock: T,
    greatest_rad: T, // expected
    roll_noise: RollNoise<T>,
    input_noise: InputNoise<T>,
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
        self.model = model.in_scaled_time(self.scale_radps);
        self.pace = T::zero();
        self.prior = prior;
        // The first interval determines the step of the filters.
        self.interval_s = T::zero();
        self.reference_rad = T::zero();
        self.roll_noise = RollNoise::of(lags);
        self.restart();
    }

    /// Computes the step of the filters for another interval.
    #[inline(never)]
    fn discretise(&mut self, interval_s: T) {
        self.interval_s = interval_s;
        self.step = StepMatrices::new(&self.model, interval_s * self.scale_radps);
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
            self.input = StateVariableFilter::at_rest(&self.model, mean.input);
            self.roll = StateVariableFilter::at_rest(&self.model, T::zero());
        }
        let u = self.input.derivatives(&self.model);
        self.expected_rad = self.model.response(&u);
        if mean.is_used {
            self.add_row(&u, mean, before_rad);
        }
    }

    /// Adds the row of a mean. `u` is the filtered input, `before_rad` the roll angle expected at the mean before.
    fn add_row(&mut self, u: &[T; ORDER + 1], mean: &Mean<T>, before_rad: T) {
        let y = self.roll.derivatives(&self.model);
        let nominal = self.expected_rad;
        let mut row = [T::zero(); REGRESSORS];
        row[GAIN] = nominal;
        if self.prior.dynamics_sd > T::zero() {
            for k in 0..ORDER {
                row[k] = -y[k];
                row[GAIN + 1 + k] = u[k + 1];
            }
        }
        if self.prior.offset_sd_rad > T::zero() {
            row[OFFSET] = T::one();
            if self.prior.drift_sd_radps > T::zero() {
                row[DRIFT] = self.clock;
            }
        }
        let bent = nominal / T::of(BEND_RAD);
        row[BEND] = nominal * bent * bent;
        if nominal.abs() > self.greatest_rad {
            self.greatest_rad = nominal.abs();
        }
        self.roll_noise.add_row(self.step.newest_share(), mean.elapsed_s);
        self.moments.push_mean(mean);
        self.rows.push(row, mean.roll_rad - nominal, mean, nominal - before_rad);
    }

    /// Standard deviation of the expected roll angle over the rows, radians.
    pub fn excitation_rad(&self) -> T {
        self.moments.input_variance().root() * self.model.dc_gain().abs()
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
        let (mut settled, mut solution) = (*self, Solution::NONE);
        settled.rows.settle();
        settled.solve(&self.noise_products(), &mut solution).ok()?;
        Some(solution)
    }

    #[inline(never)]
    fn answer(&self, products: &[T; ORDER + 1]) -> Answer<T> {
        let mut solution = Solution::NONE;
        if let Err(reason) = self.solve(products, &mut solution) {
            return Answer::Unexcited(reason);
        }
        let fit = self.describe(&solution);
        Answer::Ready(Fit { misfit: self.misfit(&mut solution), ..fit })
    }

    /// A mean has the noise of a sample divided by the number of samples that come in its time.
    fn noise_products(&self) -> [T; ORDER + 1] {
        let share = self.roll_noise.interval_s(self.moments.weight) / self.interval_s;
        self.step.noise_products(&self.model).map(|product| product * share)
    }

    /// Solves the rows in the triangle together with the prior. `products` are the bias of the rows'
    /// products per unit variance of the input noise.
    #[inline(never)]
    fn solve(&self, products: &[T; ORDER + 1], answer: &mut Solution<T>) -> Result<(), Unexcited> {
        let slower = self.roll_noise.inflation(self.moments.weight);
        let from_input = self.input_noise.passed(&self.model, products);
        let floor = self.prior.noise_floor_rad / slower.root();
        let Moments { rows, weight, .. } = self.moments;
        if (rows as usize) < UNKNOWNS {
            return Err(Unexcited::TooFewRows { rows });
        }
        // This form of the comparison also rejects NaN.
        if !(self.excitation_rad() > self.prior.noise_floor_rad) {
            return Err(Unexcited::Input);
        }
        // Slow noise hides in each unknown as many rows as it lasts.
        let mut hidden = T::of(UNKNOWNS_F64);
        // The weight of the prior depends on the noise, and the noise on the solution. Three
        // iterations are sufficient, because the residual hardly depends on the prior.
        let data = &self.rows.triangle;
        let mut of_roll = T::zero();
        answer.slow_sd = self.prior.noise_floor_rad;
        for round in 0..3 {
            answer.triangle = *data;
            self.prior.add_to(&mut answer.triangle, &self.model, answer.slow_sd, false);
            answer.theta = answer
                .triangle
                .solve(UNKNOWNS)
                .map_err(|unknown| Unexcited::Direction { unknown })?;
            let [residual, white] = self.rows.variances(&answer.theta, weight, hidden);
            answer.noise_sd = residual.root().max(floor);
            // The first solution is that of a prior with hardly any weight.
            let [ratio, _] = self.ratio(&answer.theta);
            let gain = if round == 0 { T::one() } else { ratio / self.model.dc_gain() };
            let heard = from_input.map(|variance| variance * gain * gain);
            of_roll = white.min((residual - heard[1]).max(T::zero()));
            let effective = self.effective(&answer.triangle, answer.slow_sd);
            hidden = T::of(UNKNOWNS_F64).max(effective * slower);
            let variance = answer.noise_sd * answer.noise_sd;
            let usual = self.roll_noise.usual(slower, variance, heard);
            let inflation = self.rows.long_run.inflation(&answer.theta, effective, variance, usual);
            answer.slow_sd = answer.noise_sd * inflation.root();
        }
        self.correct(answer, of_roll, from_input, products);
        Ok(())
    }

    /// Corrects the bias that noise of the roll angle and of the input cause.
    #[inline(never)]
    fn correct(
        &self,
        answer: &mut Solution<T>,
        roll_variance: T,
        from_input: [T; 2],
        products: &[T; ORDER + 1],
    ) {
        let (roll, input) = self.pulls(roll_variance, from_input, products);
        answer.correct(&roll, &input);
    }

    /// The DC ratio and its change with `γ`: `A0 (1 + γ)/(B0 + δb_0)` and `A0/(B0 + δb_0)`.
    fn ratio(&self, theta: &[T; REGRESSORS]) -> [T; 2] {
        let gain = self.model.numerator[0] / (self.model.denominator[0] + theta[0]);
        [gain * (T::one() + theta[GAIN]), gain]
    }

    /// The bias of `Σ φ e` due to noise in the regressors, with reversed sign and for the model's
    /// dynamics: for noise of the roll angle, and for noise of the input per unit of the gain.
    ///
    /// White roll noise of variance σ² is contained in `−y_k` with the weight that the newest
    /// sample has in it, which gives the bias −σ² Σ weight (little after lags, and left out). White
    /// noise of variance v² on the input is contained in `G u` and `u_k`, and in e as `−G v`. It
    /// gives the bias −v² times the mean of `u_k · G u` per row.
    fn pulls(
        &self,
        roll_variance: T,
        [input_variance, passed]: [T; 2],
        products: &[T; ORDER + 1],
    ) -> ([T; REGRESSORS], [T; REGRESSORS]) {
        let (mut roll, mut input) = ([T::zero(); REGRESSORS], [T::zero(); REGRESSORS]);
        let rows = self.moments.weight * input_variance;
        input[GAIN] = self.moments.weight * passed;
        if self.prior.dynamics_sd > T::zero() {
            for k in 0..ORDER {
                roll[k] = self.roll_noise.sum[k] * roll_variance;
                input[GAIN + 1 + k] = rows * products[k + 1];
            }
        }
        (roll, input)
    }

    /// Number of unknowns that are determined by the data and not by the prior: `Σ 1 − w² (RᵀR)⁻¹`.
    #[inline(never)]
    fn effective(&self, triangle: &Equations<T>, noise_sd: T) -> T {
        let mut effective = T::zero();
        for k in 0..UNKNOWNS {
            let mut gradient = [T::zero(); REGRESSORS];
            gradient[k] = self.prior.weight(&self.model, k, noise_sd).unwrap_or(T::zero());
            effective += T::one() - triangle.variance_of(&gradient, UNKNOWNS);
        }
        effective
    }

    /// The fit without its misfit.
    #[inline(never)]
    fn describe(&self, solution: &Solution<T>) -> Fit<T> {
        let Solution { theta, noise_sd, slow_sd, input_shift, triangle } = solution;
        let [ratio, gain] = self.ratio(theta);
        let denominator = self.model.denominator[0] + theta[0];
        let mut gradient = [T::zero(); REGRESSORS];
        gradient[0] = -ratio / denominator;
        gradient[GAIN] = gain;
        // A constant sensor error appears in the equation multiplied by (B0 + δb_0)/B0.
        let rest = theta[OFFSET] / denominator;
        let per_second = self.model.denominator[0] / denominator / T::of(DRIFT_S);
        // The column of (RᵀR)⁻¹ for the drift: the covariance of the ratio with the drift.
        let mut unit = [T::zero(); REGRESSORS];
        unit[DRIFT] = T::one();
        let along = triangle.shift_for(&unit, UNKNOWNS);
        let covariance = gradient[0] * along[0] + gradient[GAIN] * along[GAIN];
        let drift_radps = Measured {
            value: theta[DRIFT] * per_second,
            sd: *slow_sd * along[DRIFT].root() * per_second,
        };
        let mut variance = *slow_sd * *slow_sd * triangle.variance_of(&gradient, UNKNOWNS);
        // The effect of the drift on the ratio. A small drift is more likely due to slow dynamics;
        // the ratio is then not corrected, and the effect is added to its uncertainty.
        let taken = covariance / along[DRIFT] * theta[DRIFT];
        let drifts = drift_radps.value.abs() > T::of(LEAST_DRIFT_RADPS)
            && drift_radps.value.abs() > T::of(SURE) * drift_radps.sd;
        let ratio = if drifts {
            ratio
        } else {
            variance +=
                taken * taken - *slow_sd * *slow_sd * covariance * covariance / along[DRIFT];
            ratio - taken
        };
        let corrected = gradient[0] * input_shift[0] + gradient[GAIN] * input_shift[1];
        let doubts =
            [self.input_noise.doubt(), T::of(DYNAMICS_DOUBT)].map(|doubt| doubt * corrected);
        let ratio_sd = doubts.iter().fold(variance, |sum, doubt| sum + *doubt * *doubt).root();
        // As noise of the sensor, before the lags.
        let slower = self.roll_noise.inflation(self.moments.weight);
        let (snr_db, fit_percent) = self.moments.quality(*noise_sd * *noise_sd, slower, rest);
        Fit {
            ratio: Measured { value: ratio, sd: ratio_sd },
            drift_radps,
            bend: self.bend(solution),
            noise_sd_rad: solution.noise_sd * slower.root(),
            snr_db,
            fit_percent,
            misfit: T::zero(),
            rows: self.moments.rows,
        }
    }

    /// The cubic part of the roll angle at the greatest expected angle, as a share of that angle.
    fn bend(&self, solution: &Solution<T>) -> Measured<T> {
        let Some((value, sd)) = solution.triangle.last_of(REGRESSORS) else {
            return Measured::exact(T::zero());
        };
        let greatest = self.greatest_rad / T::of(BEND_RAD);
        let share = greatest * greatest / (T::one() + solution.theta[GAIN]);
        // This form of the condition gives no bend if the expected roll angle is always zero (0/0).
        if value.present() && sd.present() {
            Measured { value: value * share, sd: (sd * share).abs() * solution.slow_sd }
        } else {
            Measured::exact(T::zero())
        }
    }

    /// The part of the roll angle that the nominal dynamics with the best gain, offset and drift do
    /// not explain, but the identified dynamics do, without noise: its root mean square divided by
    /// the standard deviation of the roll angle. Overwrites the triangle of `solution`.
    #[inline(never)]
    fn misfit(&self, solution: &mut Solution<T>) -> T {
        let data = &self.rows.triangle;
        solution.triangle = *data;
        self.prior.add_to(&mut solution.triangle, &self.model, solution.slow_sd, true);
        let Ok(nominal) = solution.triangle.solve(UNKNOWNS) else { return T::zero() };
        let more = data.sum_of_squares_at(&nominal) - data.sum_of_squares_at(&solution.theta);
        // Each unknown explains some noise by chance: five standard deviations of it at most.
        let noise = T::of(25.0 * UNKNOWNS_F64) * solution.slow_sd * solution.slow_sd;
        let more = more - noise;
        (more.max(T::zero()) / self.moments.weight / self.moments.roll_variance()).root()
    }

    /// The identified transfer function (time in seconds); `None` if the data do not determine one.
    pub fn model(&self) -> Option<Reduced5<T>> {
        let theta = self.settled()?.theta;
        let mut model = self.model;
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

    const MOST_TOGETHER: u32 = 8;
    const EMPTY: Self = Self {
        model: Reduced5::EMPTY,
        pace: T::ZERO,
        scale_radps: T::ZERO,
        prior: Prior {
            dynamics_sd: T::ZERO,
            noise_floor_rad: T::ZERO,
            offset_sd_rad: T::ZERO,
            drift_sd_radps: T::ZERO,
        },
        interval_s: T::ZERO,
        step: StepMatrices::STANDING,
        input: StateVariableFilter::EMPTY,
        roll: StateVariableFilter::EMPTY,
        started: false,
        rows: Gathered::NONE,
        moments: Moments::new(),
        reference_rad: T::ZERO,
        expected_rad: T::ZERO,
        clock: T::ZERO,
        greatest_rad: T::ZERO,
        roll_noise: RollNoise::NONE,
        input_noise: InputNoise::new(),
    };

    /// The input from the estimator is the expected roll angle, so the model is scaled to unit
    /// gain.
    fn make_for(&mut self, model: &Reduced5<T>, lags: bool, prior: Prior<T>) {
        self.begin(&model.at_unit_gain(), lags, prior);
    }

    fn push_mean(&mut self, mean: &Mean<T>) {
        // A large constant would cost digits in f32, so the first roll angle is subtracted if an offset is fitted.
        if !self.started && self.prior.offset_sd_rad > T::zero() {
            self.reference_rad = mean.roll_rad;
        }
        if mean.is_used {
            self.input_noise.push(mean.input, mean.weight, mean.elapsed_s);
        } else {
            self.input_noise.interrupt();
        }
        self.take_mean(&Mean { roll_rad: mean.roll_rad - self.reference_rad, ..*mean });
    }

    fn input_noise_rad2_s(&self) -> T {
        self.input_noise.variance() * self.roll_noise.interval_s(self.moments.weight)
    }

    fn at_pace(&mut self, pace: T) {
        let change = pace - self.pace;
        // The numerator is exact to a hundredth of its slope, and does not gather rounding errors.
        if change.abs() > T::of(0.01) {
            self.model.change_pace(change);
            self.pace = pace;
        }
    }

    fn expected_roll_rad(&self) -> T {
        self.expected_rad
    }

    /// Deletes the rows but not the states of the filters.
    fn clear(&mut self) {
        self.rows = Gathered::NONE;
        self.moments = Moments::new();
        self.roll_noise.clear();
        self.input_noise = InputNoise::new();
        (self.clock, self.greatest_rad) = (T::zero(), T::zero());
    }

    /// Also resets the filters: the next sample is assumed to be in steady state.
    fn restart(&mut self) {
        self.started = false;
        self.clear();
    }

    /// Exponential forgetting: multiplies the weight of all rows so far by `factor`.
    fn forget(&mut self, factor: T) {
        // The time of the drift starts again from zero, because a large number would cost digits in
        // f32.
        self.rows.forget(factor, self.clock);
        self.clock = T::zero();
        self.input_noise.forget(factor);
        self.moments.scale(factor);
        self.roll_noise.scale(factor);
    }

    fn fit(&mut self) -> Answer<T> {
        self.rows.settle();
        // Before the solution, because both need much of the stack.
        self.answer(&self.noise_products())
    }
}
