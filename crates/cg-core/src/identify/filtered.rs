//! ARX least squares on filtered signals: the production identifier.

use crate::identify::identifier::{Answer, Fit, Identify, Moments, Unexcited};
use crate::identify::input_noise::InputNoise;
use crate::identify::long_run::LongRun;
use crate::identify::pending::{BLOCK, Pending};
use crate::identify::prior::Prior;
pub use crate::identify::unknowns::UNKNOWNS;
use crate::identify::unknowns::{
    BEND, DRIFT, Equations, GAIN, HalfSquare, OFFSET, REGRESSORS, Solution,
};
use crate::math::linalg::Triangle;
use crate::math::real::Real;
use crate::truck::ratio::Measured;
use crate::truck::reduced::{ORDER, Reduced5, StateVariableFilter, StepMatrices};

/// [`UNKNOWNS`] as a number.
const UNKNOWNS_F64: f64 = 13.0;

/// Doubt in the correction for a noisy input, as a share of it: the noise is measured to 15 % in
/// 20 s, and what is of second order is a third of the first where the noise is as strong as an
/// accelerometer's on a rough engine (0.3 m/s² at 100 Hz).
const INPUT_DOUBT: f64 = 0.35;

/// Unit of time of the drift, so that its regressor is of the size of the others.
const DRIFT_S: f64 = 10.0;
/// A drift is taken out of the ratio if it is greater than a third of a degree a minute, and than chance
/// explains once in a thousand.
const LEAST_DRIFT_RADPS: f64 = 1e-4;
const SURE: f64 = 3.29;
/// Unit of the roll angle in the bend's regressor, for the same reason.
const BEND_RAD: f64 = 0.05;
/// Weight of rows that hold the dynamics at the model's. The rows' own weight is the roll angle times
/// the root of their number, 3 or so.
const HELD: f64 = 1e3;

/// ARX on filtered signals, with prior knowledge of the dynamics.
///
/// With `y_k`, `u_k` the roll and the input filtered by `sᵏ/B(s)` and `G = A/B` the reduced
/// model, each sample gives one row in the *deviations* from that model,
///
/// ```text
///     y − G u = −Σ δb_k y_k  +  γ (G u)  +  Σ_{k≥1} δa_k u_k  +  c + d t  +  e
/// ```
///
/// where `γ` scales the whole response and `δa_k`, `δb_k` change its shape; `c` and `d` are the offset
/// of the roll sensor and its drift. The deviations are
/// small numbers, which is what keeps `f32` accurate, and the prior on each is a row
/// `δ = 0 ± sd`. The DC ratio is `A0 (1 + γ) / (B0 + δb_0)`. Time runs in units of
/// `B0^(−1/5)` inside. With `dynamics_sd = 0` only `γ` (and the offset `c`, its drift `d`) are free.
///
/// One more column, `(G u)³`, is carried but not fitted: whether it would explain something tells a
/// roll angle that is bent over the expected one, as by the end of a sensor's range.
#[derive(Clone, Copy, Debug)]
pub struct FilteredArx<T: Real> {
    model: Reduced5<T>, // in scaled time
    scale_radps: T,
    prior: Prior<T>,
    interval_s: T,
    step: StepMatrices<T>,
    input: StateVariableFilter<T>,
    roll: StateVariableFilter<T>,
    started: bool,
    triangle: Equations<T>,
    pending: Pending<T, REGRESSORS>,
    long_run: LongRun<T, REGRESSORS, HalfSquare<T>>,
    moments: Moments<T>,
    reference_rad: T,
    /// Time since the origin of the drift, in units of [`DRIFT_S`].
    clock: T,
    /// The greatest roll angle that the model expected, up or down.
    greatest_rad: T,
    newest_share: [T; ORDER],
    input_noise: InputNoise<T>,
    /// What unit noise on the input leaves in the rows' products, and the interval it is for.
    noise_products: [T; ORDER + 1],
    products_interval_s: T,
}

impl<T: Real> FilteredArx<T> {
    /// An empty identifier around `model`.
    pub fn new(model: &Reduced5<T>, prior: Prior<T>) -> Self {
        let mut identifier = Self::EMPTY;
        identifier.begin(model, prior);
        identifier
    }

    fn begin(&mut self, model: &Reduced5<T>, prior: Prior<T>) {
        self.scale_radps = model.time_scale_radps();
        self.model = model.in_scaled_time(self.scale_radps);
        self.prior = prior;
        // No interval yet: the first one makes the step.
        (self.interval_s, self.products_interval_s) = (T::zero(), T::zero());
        self.reference_rad = T::zero();
        self.restart();
    }

    /// Makes the filters' step for another interval.
    #[inline(never)]
    fn discretise(&mut self, interval_s: T) {
        self.interval_s = interval_s;
        self.step = StepMatrices::new(&self.model, interval_s * self.scale_radps);
        // Noise need not be known to better than time stamps jitter.
        let change = (interval_s - self.products_interval_s).abs();
        if change > self.products_interval_s * T::of(0.25) {
            self.products_interval_s = interval_s;
            self.noise_products = self.step.noise_products(&self.model);
        }
    }

    fn take_row(&mut self, input: T, roll: T, interval_s: T) {
        let u = self.input.derivatives(&self.model);
        let y = self.roll.derivatives(&self.model);
        let nominal = self.model.response(&u);
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
        self.greatest_rad = self.greatest_rad.max(nominal.abs());
        for (sum, share) in self.newest_share.iter_mut().zip(self.step.newest_share()) {
            *sum += share;
        }
        self.pending.push(row, roll - nominal);
        self.long_run.push(&row, roll - nominal, interval_s);
        if self.pending.rows == BLOCK {
            self.pending.fold_into(&mut self.triangle);
        }
        self.moments.push(input, roll);
        self.input_noise.push(input, interval_s);
    }

    /// Standard deviation of the expected roll angle over the rows, radians: how much the
    /// input moves the vehicle.
    pub fn excitation_rad(&self) -> T {
        self.moments.input_variance().root() * self.model.dc_gain().abs()
    }

    /// Adds the prior rows for a residual of standard deviation `noise_sd`; with the dynamics held
    /// at the model's, if `held` says so.
    #[inline(never)]
    fn add_prior(&self, triangle: &mut Equations<T>, noise_sd: T, held: bool) {
        for k in 0..UNKNOWNS {
            if let Some(weight) = self.prior_weight(k, noise_sd) {
                let mut row = [T::zero(); REGRESSORS];
                row[k] = if held && k < OFFSET { T::of(HELD) } else { weight };
                triangle.push(row, T::zero());
            }
        }
    }

    /// Weight of the prior row of unknown `k`; the gain has none.
    fn prior_weight(&self, k: usize, noise_sd: T) -> Option<T> {
        let size =
            |coefficients: &[T], k: usize| coefficients.get(k).copied().unwrap_or(T::zero()).abs();
        let sd = match k {
            GAIN => return None,
            OFFSET => self.prior.offset_sd_rad,
            DRIFT => self.prior.drift_sd_radps * T::of(DRIFT_S),
            _ if k < ORDER => self.prior.dynamics_sd * size(&self.model.denominator, k),
            // A numerator coefficient that happens to be small is not known better.
            _ => {
                let least = self.model.dc_gain().abs() * T::of(0.2);
                self.prior.dynamics_sd * size(&self.model.numerator, k - GAIN).max(least)
            }
        };
        // A fixed unknown has a zero column: any weight keeps it at zero, a great one without doubt.
        Some(if sd > T::zero() { noise_sd / sd } else { T::of(HELD) })
    }

    /// Covariance of the deviations (scaled time; see the type's documentation for their order).
    pub fn covariance(&self) -> Option<[[T; REGRESSORS]; REGRESSORS]> {
        let solution = self.settled()?;
        let mut covariance = solution.triangle.covariance(UNKNOWNS);
        for entry in covariance.iter_mut().flatten() {
            *entry *= solution.slow_sd * solution.slow_sd;
        }
        Some(covariance)
    }

    /// The solution with what waits taken in; `self` stays as it is.
    fn settled(&self) -> Option<Solution<T>> {
        let (mut settled, mut solution) = (*self, Solution::NONE);
        settled.pending.fold_into(&mut settled.triangle);
        settled.solve(&mut solution).ok()?;
        Some(solution)
    }

    /// From the rows in the triangle.
    #[inline(never)]
    fn solve(&self, answer: &mut Solution<T>) -> Result<(), Unexcited> {
        let floor = self.prior.noise_floor_rad;
        let rows = self.moments.rows;
        if (rows as usize) < UNKNOWNS {
            return Err(Unexcited::TooFewRows { rows });
        }
        // Written so that NaN fails too.
        if !(self.excitation_rad() > floor) {
            return Err(Unexcited::Input);
        }
        let freedom = (self.moments.weight - T::of(UNKNOWNS_F64)).max(T::one());
        // The prior's weight depends on the noise and the noise on the answer: three rounds
        // settle it, since the residual hardly depends on the prior.
        let data = &self.triangle;
        let mut residual_sd = floor;
        answer.slow_sd = floor;
        for _ in 0..3 {
            answer.triangle = *data;
            self.add_prior(&mut answer.triangle, answer.slow_sd, false);
            answer.theta = answer
                .triangle
                .solve(UNKNOWNS)
                .map_err(|unknown| Unexcited::Direction { unknown })?;
            residual_sd = (data.sum_of_squares_at(&answer.theta) / freedom).root();
            answer.noise_sd = residual_sd.max(floor);
            let effective = self.effective(&answer.triangle, answer.slow_sd);
            let variance = answer.noise_sd * answer.noise_sd;
            let inflation = self.long_run.inflation(&answer.theta, effective, variance);
            answer.slow_sd = answer.noise_sd * inflation.root();
        }
        let (roll, input) = self.pulls(residual_sd * residual_sd);
        let input = answer.triangle.shift_for(&input, UNKNOWNS);
        answer.input_shift = [input[0], input[GAIN]];
        let roll = answer.triangle.shift_for(&roll, UNKNOWNS);
        for (theta, (roll, input)) in answer.theta.iter_mut().zip(roll.iter().zip(input)) {
            *theta += *roll + input;
        }
        Ok(())
    }

    /// What noise of the roll angle and of the input takes from `Σ φ e`, because it sits in the
    /// regressors as well, to first order.
    ///
    /// White roll noise of variance σ² is in `−y_k` with the share that the newest sample has in
    /// it and pulls by −σ² Σ share. White noise of variance v² on the input is in `G u` and `u_k`,
    /// and in e as `−G v`, and pulls by −v² times the mean of `u_k · G u` a row.
    fn pulls(&self, residual_variance: T) -> ([T; REGRESSORS], [T; REGRESSORS]) {
        let input_variance = self.input_noise.variance();
        let mut gain = T::zero();
        for (a, product) in self.model.numerator.iter().zip(self.noise_products) {
            gain += *a * product;
        }
        let (mut roll, mut input) = ([T::zero(); REGRESSORS], [T::zero(); REGRESSORS]);
        let rows = self.moments.weight * input_variance;
        input[GAIN] = rows * gain;
        if self.prior.dynamics_sd > T::zero() {
            let roll_variance = (residual_variance - gain * input_variance).max(T::zero());
            for k in 0..ORDER {
                roll[k] = self.newest_share[k] * roll_variance;
                input[GAIN + 1 + k] = rows * self.noise_products[k + 1];
            }
        }
        (roll, input)
    }

    /// How many unknowns the data decided, not the prior: `Σ 1 − w² (RᵀR)⁻¹`.
    #[inline(never)]
    fn effective(&self, triangle: &Equations<T>, noise_sd: T) -> T {
        let mut effective = T::zero();
        for k in 0..UNKNOWNS {
            let mut gradient = [T::zero(); REGRESSORS];
            gradient[k] = self.prior_weight(k, noise_sd).unwrap_or(T::zero());
            effective += T::one() - triangle.variance_of(&gradient, UNKNOWNS);
        }
        effective
    }

    #[inline(never)]
    fn describe(&self, solution: &mut Solution<T>) -> Fit<T> {
        let Solution { theta, noise_sd, slow_sd, input_shift, triangle } = solution;
        // R = A0 (1 + γ) / (B0 + δb_0)
        let denominator = self.model.denominator[0] + theta[0];
        let gain = self.model.numerator[0] / denominator;
        let ratio = gain * (T::one() + theta[GAIN]);
        let mut gradient = [T::zero(); REGRESSORS];
        gradient[0] = -ratio / denominator;
        gradient[GAIN] = gain;
        // The filtered sensor error is B0 + δb_0 over B0 of the sensor's own.
        let rest = theta[OFFSET] / denominator;
        let per_second = self.model.denominator[0] / denominator / T::of(DRIFT_S);
        // (RᵀR)⁻¹ of the drift: how the ratio moves with it.
        let mut unit = [T::zero(); REGRESSORS];
        unit[DRIFT] = T::one();
        let along = triangle.shift_for(&unit, UNKNOWNS);
        let covariance = gradient[0] * along[0] + gradient[GAIN] * along[GAIN];
        let drift_radps = Measured {
            value: theta[DRIFT] * per_second,
            sd: *slow_sd * along[DRIFT].root() * per_second,
        };
        let mut variance = *slow_sd * *slow_sd * triangle.variance_of(&gradient, UNKNOWNS);
        // What the drift takes from the ratio. A small one is more likely slow dynamics: left out, it
        // is doubt.
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
        let doubt =
            T::of(INPUT_DOUBT) * (gradient[0] * input_shift[0] + gradient[GAIN] * input_shift[1]);
        let ratio_sd = (variance + doubt * doubt).root();
        let (snr_db, fit_percent) = self.moments.quality(*noise_sd * *noise_sd, rest);
        Fit {
            ratio: Measured { value: ratio, sd: ratio_sd },
            drift_radps,
            bend: self.bend(solution),
            noise_sd_rad: solution.noise_sd,
            snr_db,
            fit_percent,
            misfit: self.misfit(solution),
            rows: self.moments.rows,
        }
    }

    /// What a cubic in the expected roll angle would add at its greatest value, as a share of it.
    fn bend(&self, solution: &Solution<T>) -> Measured<T> {
        let Some((value, sd)) = solution.triangle.last_of(REGRESSORS) else {
            return Measured::exact(T::zero());
        };
        let greatest = self.greatest_rad / T::of(BEND_RAD);
        let share = greatest * greatest / (T::one() + solution.theta[GAIN]);
        // Written so that an expected roll that never moved (0/0) has no bend.
        if value.present() && sd.present() {
            Measured { value: value * share, sd: (sd * share).abs() * solution.slow_sd }
        } else {
            Measured::exact(T::zero())
        }
    }

    /// What the nominal dynamics at the best gain, offset and drift leave over of the roll, beyond
    /// what the identified ones do and noise explains: root mean square, over that of the roll about
    /// its mean. The equations of the solution are lost.
    #[inline(never)]
    fn misfit(&self, solution: &mut Solution<T>) -> T {
        let data = &self.triangle;
        solution.triangle = *data;
        self.add_prior(&mut solution.triangle, solution.slow_sd, true);
        let Ok(nominal) = solution.triangle.solve(UNKNOWNS) else { return T::zero() };
        let more = data.sum_of_squares_at(&nominal) - data.sum_of_squares_at(&solution.theta);
        // Each unknown explains some noise: by chance up to five standard deviations of it.
        let noise = T::of(25.0 * UNKNOWNS_F64) * solution.slow_sd * solution.slow_sd;
        let more = more - noise;
        (more.max(T::zero()) / self.moments.weight / self.moments.roll_variance()).root()
    }

    /// The identified transfer function (time in seconds), if the data determine one.
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

impl<T: Real> Identify<T> for FilteredArx<T> {
    type Options = Prior<T>;

    const EMPTY: Self = Self {
        model: Reduced5 { numerator: [T::ZERO; ORDER + 1], denominator: [T::ZERO; ORDER] },
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
        triangle: Triangle::new(),
        pending: Pending::new(),
        long_run: LongRun::new(),
        moments: Moments::new(),
        reference_rad: T::ZERO,
        clock: T::ZERO,
        greatest_rad: T::ZERO,
        newest_share: [T::ZERO; ORDER],
        input_noise: InputNoise::new(),
        noise_products: [T::ZERO; ORDER + 1],
        products_interval_s: T::ZERO,
    };

    /// The estimator's input is the expected roll angle, so the model is taken at unit gain.
    fn make_for(&mut self, model: &Reduced5<T>, prior: Prior<T>) {
        self.begin(&model.at_unit_gain(), prior);
    }

    /// Advances the filters to the next sample, `interval_s` after the one before, and takes
    /// its row in if `use_row` says so.
    fn push(&mut self, input: T, roll_rad: T, interval_s: T, use_row: bool) {
        if self.started {
            if (interval_s - self.interval_s).abs() > self.interval_s * T::machine_epsilon() {
                self.discretise(interval_s);
            }
            self.clock += interval_s / T::of(DRIFT_S);
            self.input.push(&self.step, input);
            self.roll.push(&self.step, roll_rad - self.reference_rad);
        } else {
            self.started = true;
            // Roll from its first value on: a large constant would cost digits in f32. Without
            // an offset regressor it must not move, though.
            if self.prior.offset_sd_rad > T::zero() {
                self.reference_rad = roll_rad;
            }
            self.input = StateVariableFilter::at_rest(&self.model, input);
            self.roll = StateVariableFilter::at_rest(&self.model, T::zero());
        }
        if use_row {
            self.take_row(input, roll_rad - self.reference_rad, interval_s);
        }
    }

    fn expected_roll_rad(&self) -> T {
        self.model.response(&self.input.derivatives(&self.model))
    }

    /// Forgets the rows, keeps the filters running.
    fn clear(&mut self) {
        self.triangle = Triangle::new();
        self.pending = Pending::new();
        self.long_run = LongRun::new();
        self.moments = Moments::new();
        self.newest_share = [T::zero(); ORDER];
        self.input_noise = InputNoise::new();
        (self.clock, self.greatest_rad) = (T::zero(), T::zero());
    }

    /// Forgets the filters too: the next sample is taken as a state of rest.
    fn restart(&mut self) {
        self.started = false;
        self.clear();
    }

    /// Multiplies the weight of all rows so far by `factor` (forgetting).
    fn forget(&mut self, factor: T) {
        self.pending.fold_into(&mut self.triangle);
        // The drift counts from now on: a large number would cost digits in f32.
        self.triangle.shift(DRIFT, OFFSET, self.clock);
        self.long_run.shift(DRIFT, OFFSET, self.clock);
        self.clock = T::zero();
        self.triangle.scale(factor.root());
        self.long_run.forget(factor);
        self.input_noise.forget(factor);
        self.moments.scale(factor);
        for sum in &mut self.newest_share {
            *sum *= factor;
        }
    }

    #[inline(never)]
    fn fit(&mut self) -> Answer<T> {
        self.pending.fold_into(&mut self.triangle);
        let mut solution = Solution::NONE;
        match self.solve(&mut solution) {
            Ok(()) => Answer::Ready(self.describe(&mut solution)),
            Err(reason) => Answer::Unexcited(reason),
        }
    }
}
