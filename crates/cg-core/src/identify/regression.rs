//! The regression of one maneuver: its rows, what is known before them, and the solution of both, in stages.

use crate::identify::equations::{Equations, Gathered, Solution};
use crate::identify::identifier::{Answer, Fit, Moments, Unexcited};
use crate::identify::input_noise::InputNoise;
use crate::identify::mean::Mean;
use crate::identify::prior::Prior;
use crate::identify::roll_noise::{RollNoise, usual};
use crate::identify::unknowns::{BEND_RAD, DRIFT, DRIFT_S, GAIN, OFFSET, REGRESSORS, UNKNOWNS};
use crate::math::real::Real;
use crate::truck::ratio::Measured;
use crate::truck::reduced::{ORDER, Reduced5};
#[cfg(feature = "serde")]
use serde::{Serialize, de::DeserializeOwned};

const UNKNOWNS_F64: f64 = 13.0;

/// The weight of the prior depends on the noise, and the noise on the solution. Three rounds are sufficient,
/// because the residual hardly depends on the prior.
const ROUNDS: u32 = 3;

/// Which share of the motion of the roll angle the best model of fifth order leaves, as an error of the same shape and not as
/// noise. It counts where the ratio is extrapolated, that is where such an error makes one of the ratio that is more than
/// [`EXTRAPOLATED`] times as great: it keeps the dynamics near those of the truck where a drive shows them at one frequency only,
/// and makes the ratio uncertain there. Steps have a factor of 1 to 4, lane changes of 3, pieces of S-curves of 20 to 170, in which
/// a third of all intervals miss without this (test `s_curves` of cg-thesis, on whose trucks it was chosen).
const MODEL_SHARE: f64 = 0.003;
const EXTRAPOLATED: f64 = 10.0;

/// The correction for noise of the input takes the dynamics for those of the model, from which they differ
/// by 20 % as a rule; it is uncertain by as much.
const DYNAMICS_DOUBT: f64 = 0.2;

/// The ratio is corrected for a drift if the drift is greater than a third of a degree per minute
/// and significant (the probability that chance exceeds it is 0.1 %).
const LEAST_DRIFT_RADPS: f64 = 1e-4;
const SURE: f64 = 3.29;

/// The rows of a maneuver and what is known beside them.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Regression<T: Real, const B: usize> {
    /// In scaled time, at the present pace.
    pub(crate) model: Reduced5<T>,
    pub(crate) prior: Prior<T>,
    #[cfg_attr(feature = "serde", serde(bound = "Gathered<T, B>: Serialize + DeserializeOwned"))]
    rows: Gathered<T, B>,
    pub(crate) moments: Moments<T>,
    /// Greatest expected roll angle.
    greatest_rad: T,
    pub(crate) roll_noise: RollNoise<T>,
    pub(crate) input_noise: InputNoise<T>,
}

/// A solution on its way: what its stages leave for the next one.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solving<T: Real> {
    /// Rounds that are done, after the beginning.
    rounds: Option<u32>,
    /// The bias of the rows' products per unit variance of the noise of the input.
    products: [T; ORDER + 1],
    /// Variance of the noise of the input, and of what passes the model, for a gain of one.
    from_input: [T; 2],
    /// Number of unknowns that are determined from the rows: slow noise hides in each as many rows as it lasts.
    hidden: T,
    /// Variance of the white noise of the roll angle.
    of_roll: T,
    pub(crate) solution: Solution<T>,
}

impl<T: Real> Solving<T> {
    /// Before the first stage.
    pub(crate) const NOT_BEGUN: Self = Self {
        rounds: None,
        products: [T::ZERO; ORDER + 1],
        from_input: [T::ZERO; 2],
        hidden: T::ZERO,
        of_roll: T::ZERO,
        solution: Solution::NONE,
    };

    /// Whether no stage has been done.
    pub(crate) fn is_new(&self) -> bool {
        self.rounds.is_none()
    }
}

impl<T: Real, const B: usize> Regression<T, B> {
    pub(crate) const EMPTY: Self = Self {
        model: Reduced5::EMPTY,
        prior: Prior::NONE,
        rows: Gathered::NONE,
        moments: Moments::new(),
        greatest_rad: T::ZERO,
        roll_noise: RollNoise::NONE,
        input_noise: InputNoise::new(),
    };

    /// Deletes the rows.
    pub(crate) fn clear(&mut self) {
        self.rows = Gathered::NONE;
        self.moments = Moments::new();
        self.roll_noise.clear();
        self.input_noise = InputNoise::new();
        self.greatest_rad = T::zero();
    }

    /// Multiplies the weight of all rows so far by `factor`, and lets the time of the drift begin again `clock` later.
    pub(crate) fn forget(&mut self, factor: T, clock: T) {
        self.rows.forget(factor, clock);
        self.input_noise.forget(factor);
        self.moments.scale(factor);
        self.roll_noise.scale(factor);
    }

    /// Adds the row of a mean. The angles are those that the model expects at the mean and at the one before,
    /// `newest_share` is the [weight of the newest one](crate::truck::filters::StepMatrices::newest_share).
    pub(crate) fn push(
        &mut self,
        row: [T; REGRESSORS],
        mean: &Mean<T>,
        [before_rad, expected_rad]: [T; 2],
        newest_share: &[T; ORDER],
    ) {
        if expected_rad.abs() > self.greatest_rad {
            self.greatest_rad = expected_rad.abs();
        }
        self.roll_noise.add_row(newest_share, mean.elapsed_s);
        self.moments.push_mean(mean);
        self.rows.push(row, mean.roll_rad - expected_rad, mean, expected_rad - before_rad);
    }

    /// Standard deviation of the expected roll angle over the rows, radians.
    pub(crate) fn excitation_rad(&self) -> T {
        self.moments.input_variance().root() * self.model.dc_gain().abs()
    }

    /// Begins to solve the rows together with the prior. `products` are the bias of the rows' products per unit
    /// variance of the input noise. Until the solution is done, neither rows nor model may change.
    ///
    /// # Errors
    /// [`Unexcited`] if the rows are too few or do not move.
    pub(crate) fn begin(
        &mut self,
        work: &mut Solving<T>,
        products: [T; ORDER + 1],
    ) -> Result<(), Unexcited> {
        self.rows.settle();
        let rows = self.moments.rows;
        if (rows as usize) < UNKNOWNS {
            return Err(Unexcited::TooFewRows { rows });
        }
        // This form of the comparison also rejects NaN.
        if !(self.excitation_rad() > self.prior.noise_floor_rad) {
            return Err(Unexcited::Input);
        }
        work.from_input = self.input_noise.passed(&self.model, &products);
        work.products = products;
        work.hidden = T::of(UNKNOWNS_F64);
        work.solution.slow_sd = self.prior.noise_floor_rad;
        work.rounds = Some(0);
        Ok(())
    }

    /// The next stage after [`begin`](Self::begin): a round of the solution, or what follows from the last one.
    pub(crate) fn advance(&self, work: &mut Solving<T>) -> Option<Answer<T>> {
        let rounds = work.rounds.unwrap_or(0);
        if rounds < ROUNDS {
            work.rounds = Some(rounds + 1);
            return self.round(work, rounds == 0).err().map(Answer::Unexcited);
        }
        self.correct(work);
        let fit = self.describe(&work.solution);
        Some(Answer::Ready(Fit { misfit: self.misfit(&mut work.solution), ..fit }))
    }

    /// The solution of all rounds, corrected.
    pub(crate) fn solution(&self, mut work: Solving<T>) -> Option<Solution<T>> {
        for round in 0..ROUNDS {
            self.round(&mut work, round == 0).ok()?;
        }
        self.correct(&mut work);
        Some(work.solution)
    }

    /// Solves the rows with a prior whose weight follows from the noise of the round before.
    #[inline(never)]
    fn round(&self, work: &mut Solving<T>, is_first: bool) -> Result<(), Unexcited> {
        let Moments { weight, .. } = self.moments;
        let slower = self.roll_noise.inflation(weight);
        let floor = self.prior.noise_floor_rad / slower.root();
        let answer = &mut work.solution;
        answer.triangle = self.rows.triangle;
        self.prior.add_to(&mut answer.triangle, &self.model, answer.slow_sd, false);
        answer.theta =
            answer.triangle.solve(UNKNOWNS).map_err(|unknown| Unexcited::Direction { unknown })?;
        let [residual, white] = self.rows.variances(&answer.theta, weight, work.hidden);
        answer.noise_sd = residual.root().max(floor);
        // The first solution is that of a prior with hardly any weight.
        let (ratio, gradient) = self.ratio(&answer.theta);
        let gain = if is_first { T::one() } else { ratio / self.model.dc_gain() };
        let heard = work.from_input.map(|variance| variance * gain * gain);
        work.of_roll = white.min((residual - heard[1]).max(T::zero()));
        let effective = self.effective(&answer.triangle, answer.slow_sd);
        work.hidden = T::of(UNKNOWNS_F64).max(effective * slower);
        let variance = answer.noise_sd * answer.noise_sd;
        let usual = usual(slower, variance, heard);
        let inflation = self.rows.long_run.inflation(&answer.theta, effective, variance, usual);
        let motion = self.moments.roll_variance() * weight;
        let spread = motion * answer.triangle.variance_of(&gradient, UNKNOWNS);
        let limit = T::of(EXTRAPOLATED * EXTRAPOLATED) * ratio * ratio;
        let counts = spread * spread / (spread * spread + limit * limit);
        // A constant roll angle has neither (0/0).
        let model = (T::of(MODEL_SHARE * MODEL_SHARE) * motion * counts).max(T::zero());
        answer.slow_sd = (variance * inflation + model).root();
        Ok(())
    }

    /// Corrects the bias that noise of the roll angle and of the input cause.
    #[inline(never)]
    fn correct(&self, work: &mut Solving<T>) {
        let (roll, input) = self.pulls(work);
        work.solution.correct(&roll, &input);
    }

    /// The DC ratio and its change with `γ`: `A0 (1 + γ)/(B0 + δb_0)` and `A0/(B0 + δb_0)`.
    #[inline(never)]
    fn ratio(&self, theta: &[T; REGRESSORS]) -> (T, [T; REGRESSORS]) {
        let denominator = self.model.denominator[0] + theta[0];
        let gain = self.model.numerator[0] / denominator;
        let ratio = gain * (T::one() + theta[GAIN]);
        let mut slope = [T::zero(); REGRESSORS];
        (slope[0], slope[GAIN]) = (-ratio / denominator, gain);
        (ratio, slope)
    }

    /// The bias of `Σ φ e` due to noise in the regressors, with reversed sign and for the model's
    /// dynamics: for noise of the roll angle, and for noise of the input per unit of the gain.
    ///
    /// White roll noise of variance σ² is contained in `−y_k` with the weight that the newest
    /// sample has in it, which gives the bias −σ² Σ weight (little after lags, and left out). White
    /// noise of variance v² on the input is contained in `G u` and `u_k`, and in e as `−G v`. It
    /// gives the bias −v² times the mean of `u_k · G u` per row.
    fn pulls(&self, work: &Solving<T>) -> ([T; REGRESSORS], [T; REGRESSORS]) {
        let Solving { of_roll, from_input: [input_variance, passed], products, .. } = *work;
        let (mut roll, mut input) = ([T::zero(); REGRESSORS], [T::zero(); REGRESSORS]);
        let rows = self.moments.weight * input_variance;
        input[GAIN] = self.moments.weight * passed;
        if self.prior.dynamics_sd > T::zero() {
            for k in 0..ORDER {
                roll[k] = self.roll_noise.sum[k] * of_roll;
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
        let (ratio, gradient) = self.ratio(theta);
        let denominator = self.model.denominator[0] + theta[0];
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
}
