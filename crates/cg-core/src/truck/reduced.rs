//! The reduced 5th-order compensated model, and the filters with its denominator.
//!
//! ```text
//!              A5 s⁵ + A4 s⁴ + A3 s³ + A2 s² + A1 s + A0
//!     G(s) =  ───────────────────────────────────────────       eq. 5.12
//!                s⁵ + B4 s⁴ + B3 s³ + B2 s² + B1 s + B0
//! ```
//!
//! One set of filters `sᵏ/B(s)`, k = 0…5, serves two purposes. Weighted with the numerator, the
//! filtered input is the expected roll angle. Applied to input and roll angle, the filters give the
//! regressors of [`FilteredArx`](crate::FilteredArx). Signals are interpolated linearly between
//! samples (first-order hold), and for such signals the discretization is exact.
//!
//! **Reference.** Franklin, Powell and Workman, *Digital Control of Dynamic Systems*,
//! 3rd ed., §6.3.2 (first-order hold); Garnier and Wang, *Identification of
//! Continuous-time Models from Sampled Data*, §1.3 (state-variable filters).

use nalgebra::{ArrayStorage, SMatrix, SVector};

use crate::math::real::Real;

/// The order of the reduced model.
pub const ORDER: usize = 5;

/// The reduced 5th-order compensated model (eq. 5.12) from the input to the trailer's roll angle.
///
/// ```
/// use cg_core::Reduced5;
///
/// // eq. 5.12 with this project's signs (left-hand turns and their roll are positive)
/// let model = Reduced5::<f64> {
///     numerator: [51.7785, 27.8430, 24.3105, -0.9015, 2.6063, -0.2554],
///     denominator: [61.2322, 83.2666, 57.4175, 22.6413, 5.8858],
///     speed_slope: [0.0; 5], // one speed
/// };
/// assert!((model.dc_gain() - 0.8456).abs() < 5e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reduced5<T> {
    /// `A0 … A5`, ascending powers of s (in 1/s); radians of roll per unit of input.
    pub numerator: [T; ORDER + 1],
    /// `B0 … B4`, ascending powers of s (in 1/s); the coefficient of s⁵ is one.
    pub denominator: [T; ORDER],
    /// Change of `A1 … A5` per unit of `U0/U − 1`, where `U` is the speed and `U0` that of the model.
    pub speed_slope: [T; ORDER],
}

impl<T: Real> Reduced5<T> {
    /// No model.
    pub(crate) const EMPTY: Self = Self {
        numerator: [T::ZERO; ORDER + 1],
        denominator: [T::ZERO; ORDER],
        speed_slope: [T::ZERO; ORDER],
    };

    /// The DC ratio `A0/B0`: steady-state roll angle per unit of input.
    pub fn dc_gain(&self) -> T {
        self.numerator[0] / self.denominator[0]
    }

    /// Interpolates every coefficient between `self` (`weight` 0) and `other` (`weight` 1).
    #[must_use]
    pub fn blend(&self, other: &Self, weight: T) -> Self {
        let mut blended = *self;
        let owns = blended.numerator.iter_mut().chain(&mut blended.denominator);
        let others = other.numerator.iter().chain(&other.denominator).chain(&other.speed_slope);
        for (own, other) in owns.chain(&mut blended.speed_slope).zip(others) {
            *own += (*other - *own) * weight;
        }
        blended
    }

    /// `B0^(1/5)`, rad/s: with time scaled by it, the coefficients are near one.
    pub fn time_scale_radps(&self) -> T {
        self.denominator[0].power(T::of(0.2))
    }

    /// The same model with a DC gain of one, for an input that is scaled to the expected roll angle.
    #[must_use]
    pub fn at_unit_gain(&self) -> Self {
        let (mut model, gain) = (*self, self.dc_gain());
        for coefficient in model.numerator.iter_mut().chain(&mut model.speed_slope) {
            *coefficient /= gain;
        }
        model
    }

    /// Changes the numerator by a change of the pace `U0/U − 1`.
    pub fn change_pace(&mut self, change: T) {
        for (own, slope) in self.numerator.iter_mut().skip(1).zip(&self.speed_slope) {
            *own += *slope * change;
        }
    }

    /// The same model in the scaled time `τ = ω t`, where `ω` is `scale_radps`.
    #[must_use]
    pub fn in_scaled_time(&self, scale_radps: T) -> Self {
        let mut scaled = *self;
        let mut factor = T::one(); // ω^(k−5), from k = 5 down
        for k in (0..=ORDER).rev() {
            scaled.numerator[k] *= factor;
            if k < ORDER {
                scaled.denominator[k] *= factor;
            }
            if k > 0 {
                scaled.speed_slope[k - 1] *= factor;
            }
            factor /= scale_radps;
        }
        scaled
    }

    /// Whether the denominator is a stable polynomial (Routh's criterion) and every coefficient is
    /// finite. A model reduction can be unstable and must then not be used.
    pub fn is_stable(&self) -> bool {
        let [b0, b1, b2, b3, b4] = self.denominator;
        // Routh array of s⁵ + b4 s⁴ + b3 s³ + b2 s² + b1 s + b0
        let c1 = (b4 * b3 - b2) / b4;
        let c2 = (b4 * b1 - b0) / b4;
        let d1 = (c1 * b2 - b4 * c2) / c1;
        let e1 = (d1 * c2 - c1 * b0) / d1;
        // A sum is finite only if each of its terms is.
        let mut sum = c1 + d1 + e1;
        for a in self.numerator.iter().chain(&self.denominator).chain(&self.speed_slope) {
            sum += *a;
        }
        let zero = T::zero();
        sum.present() && b4 > zero && c1 > zero && d1 > zero && e1 > zero && b0 > zero
    }

    /// The output of the model for the filtered input: `Σ A_k (s^k/B) u`.
    pub fn response(&self, filtered: &[T; ORDER + 1]) -> T {
        let mut sum = T::zero();
        for k in 0..=ORDER {
            sum += self.numerator[k] * filtered[k];
        }
        sum
    }
}

/// A constant matrix of zeros.
const fn zeros<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::from_array_storage(ArrayStorage([[T::ZERO; R]; C]))
}

/// Number of doublings in the sum of the noise in the filters: 2¹² samples are 4 s at 1 kHz.
const DOUBLINGS: u32 = 12;

/// One step of the filters `sᵏ/B(s)` over a fixed sampling interval, exact for signals that are
/// linear between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepMatrices<T: Real> {
    /// `exp(A h) − I`, stored without the identity to avoid rounding errors of short steps in
    /// `f32`.
    increment: SMatrix<T, ORDER, ORDER>,
    held: SVector<T, ORDER>,
    ramp: SVector<T, ORDER>,
}

impl<T: Real> StepMatrices<T> {
    /// The step over an interval of zero.
    pub(crate) const STANDING: Self = Self { increment: zeros(), held: zeros(), ramp: zeros() };

    /// The step over an interval `step`, in the time unit of `model`.
    #[inline(never)]
    pub fn new(model: &Reduced5<T>, step: T) -> Self {
        // d/dt (x, u, u̇) with u̇ in units of one step:  M = step · ┌ A B 0 ┐ + ┌ 0 0 0 ┐
        //                                                         │ 0 0 0 │   │ 0 0 1 │
        //                                                         └ 0 0 0 ┘   └ 0 0 0 ┘
        let mut m = SMatrix::<T, 7, 7>::zeros();
        for k in 0..ORDER - 1 {
            m[(k, k + 1)] = step;
        }
        for k in 0..ORDER {
            m[(ORDER - 1, k)] = -model.denominator[k] * step;
        }
        m[(ORDER - 1, ORDER)] = step;
        m[(ORDER, ORDER + 1)] = T::one();
        let f = exponential_minus_identity(&m);
        Self {
            increment: SMatrix::from_fn(|i, j| f[(i, j)]),
            held: SVector::from_fn(|i, _| f[(i, ORDER)]),
            ramp: SVector::from_fn(|i, _| f[(i, ORDER + 1)]),
        }
    }
}

impl<T: Real> StepMatrices<T> {
    /// Weight of the newest sample in the signal filtered by `sᵏ/B(s)`, k = 0…4. Of sums over several
    /// samples, it is the mean product of both sums, the samples' and the filtered signal's, for
    /// independent samples of unit variance.
    pub fn newest_share(&self, samples: u8) -> [T; ORDER] {
        let (mut filter, mut sum) = (StateVariableFilter::EMPTY, SVector::<T, ORDER>::zeros());
        for _ in 0..samples {
            filter.push(self, T::one());
            sum += filter.state;
        }
        (sum / T::of(f64::from(samples) * f64::from(samples))).into()
    }

    /// The expected products `E[u_k · G u]` of the filtered signals `u_k = sᵏ/B(s) u`, k = 0…5,
    /// with the response `G u = A/B u`, for white noise `u` of unit variance.
    ///
    /// With `x⁺ = Φ x + Γ0 v + Γ1 v⁺`, the covariance of the states is `W + Γ1 Γ1ᵀ`, where
    /// `W = Σ Φⁱ b bᵀ Φⁱᵀ` and `b = Φ Γ1 + Γ0`. The sum is computed by doubling.
    #[inline(never)]
    pub fn noise_products(&self, model: &Reduced5<T>) -> [T; ORDER + 1] {
        let ramp = self.ramp;
        let mut transition = self.increment + SMatrix::identity();
        let drive = transition * ramp + self.held - ramp;
        let mut covariance = drive * drive.transpose();
        for _ in 0..DOUBLINGS {
            covariance += product(&product(&transition, &covariance), &transition.transpose());
            transition = product(&transition, &transition);
        }
        covariance += ramp * ramp.transpose();
        // G u = c·x + a5 v
        let through = model.numerator[ORDER];
        let denominator = SVector::from(model.denominator);
        let c = SVector::<T, ORDER>::from_fn(|k, _| model.numerator[k]) - denominator * through;
        let states = covariance * c + ramp * through;
        let mut products = [T::zero(); ORDER + 1];
        for (product, state) in products.iter_mut().zip(states.iter()) {
            *product = *state;
        }
        products[ORDER] = c.dot(&ramp) + through - denominator.dot(&states);
        products
    }
}

/// `a b`, not inlined: one copy in the firmware image.
#[inline(never)]
fn product<T: Real, const N: usize>(
    a: &SMatrix<T, N, N>,
    b: &SMatrix<T, N, N>,
) -> SMatrix<T, N, N> {
    a * b
}

// Loops over all entries: one copy of each in the firmware image, not unrolled.

#[inline(never)]
fn scale<T: Real>(entries: &mut [T], factor: T) {
    for entry in entries {
        *entry *= factor;
    }
}

#[inline(never)]
fn divide<T: Real>(entries: &mut [T], divisor: T) {
    for entry in entries {
        *entry /= divisor;
    }
}

#[inline(never)]
fn add<T: Real>(entries: &mut [T], others: &[T]) {
    for (entry, other) in entries.iter_mut().zip(others) {
        *entry += *other;
    }
}

/// `exp(M) − I` by scaling, a 12-term Taylor series and `(I + F)² − I = 2F + F²`.
fn exponential_minus_identity<T: Real>(m: &SMatrix<T, 7, 7>) -> SMatrix<T, 7, 7> {
    let mut largest = T::zero();
    for i in 0..7 {
        let mut sum = T::zero();
        for j in 0..7 {
            sum += m[(i, j)].abs();
        }
        largest = largest.max(sum);
    }
    let mut scaled = *m;
    let mut squarings = 0;
    // ‖M‖ ≤ 1/4 leaves a remainder of 4⁻¹³/13! = 2e-18.
    while largest > T::of(0.25) && squarings < 40 {
        largest *= T::of(0.5);
        scale(scaled.as_mut_slice(), T::of(0.5));
        squarings += 1;
    }
    let mut term = scaled;
    let mut f = scaled;
    for k in 2..=12 {
        term = product(&term, &scaled);
        divide(term.as_mut_slice(), T::of(f64::from(k)));
        add(f.as_mut_slice(), term.as_slice());
    }
    for _ in 0..squarings {
        let square = product(&f, &f);
        scale(f.as_mut_slice(), T::of(2.0));
        add(f.as_mut_slice(), square.as_slice());
    }
    f
}

/// The states of the filters `sᵏ/B(s)`, k = 0…5, for one signal.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StateVariableFilter<T: Real> {
    state: SVector<T, ORDER>,
    input: T,
}

impl<T: Real> StateVariableFilter<T> {
    /// Filters with all states zero.
    pub(crate) const EMPTY: Self = Self { state: zeros(), input: T::ZERO };

    /// Filters in steady state at the constant signal `input`.
    pub fn at_rest(model: &Reduced5<T>, input: T) -> Self {
        let mut state = SVector::zeros();
        state[0] = input / model.denominator[0];
        Self { state, input }
    }

    /// Advances to the next sample of the signal.
    #[inline]
    pub fn push(&mut self, step: &StepMatrices<T>, input: T) {
        let change =
            step.increment * self.state + step.held * self.input + step.ramp * (input - self.input);
        self.state += change;
        self.input = input;
    }

    /// The signal filtered by `sᵏ/B(s)`, k = 0…5.
    #[inline]
    pub fn derivatives(&self, model: &Reduced5<T>) -> [T; ORDER + 1] {
        let mut out = [T::zero(); ORDER + 1];
        let mut highest = self.input;
        for k in 0..ORDER {
            out[k] = self.state[k];
            highest -= model.denominator[k] * self.state[k];
        }
        out[ORDER] = highest;
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truck::simulation::Simulation;

    /// 120 / ((s + 1)(s + 2)(s + 3)(s + 4)(s + 5)): unit DC gain and known responses.
    fn five_lags() -> Reduced5<f64> {
        Reduced5 {
            numerator: [120.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            denominator: [120.0, 274.0, 225.0, 85.0, 15.0],
            speed_slope: [0.0; ORDER],
        }
    }

    #[test]
    fn the_ramp_response_is_exact_whatever_the_interval() {
        // Partial fractions of 120/(s² Π(s+k)): t − Σ 1/k + Σ c_k e^(−kt),
        // c_k = 120/(k² Π_{j≠k}(j − k)).
        let c = [5.0, -5.0, 10.0 / 3.0, -1.25, 0.2];
        let exact = |t: f64| {
            let lag: f64 = (1..=5).map(|k| 1.0 / f64::from(k)).sum();
            let decay: f64 = c
                .iter()
                .zip([1.0, 2.0, 3.0, 4.0, 5.0])
                .map(|(c, k): (_, f64)| c * (-k * t).exp())
                .sum();
            t - lag + decay
        };
        for interval in [0.001, 0.05, 0.5] {
            let mut simulation = Simulation::new(&five_lags(), interval, 0.0);
            let mut t = 0.0;
            while t < 2.0 {
                t += interval;
                let roll = simulation.push(t);
                // Rounding only: 2000 steps of ε on values of order one.
                assert!((roll - exact(t)).abs() < 2e-12, "{interval} {t}: {roll} {}", exact(t));
            }
        }
    }

    #[test]
    fn at_rest_stays_at_rest() {
        let mut simulation = Simulation::new(&five_lags(), 0.01, 3.0);
        for _ in 0..1000 {
            simulation.push(3.0);
        }
        assert!((simulation.roll_rad() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn routh_tells_stable_from_unstable() {
        assert!(five_lags().is_stable());
        let mut unstable = five_lags(); // (s + 1)(s + 2)(s + 3)(s² − s + 9)
        unstable.denominator = [54.0, 93.0, 49.0, 14.0, 5.0];
        assert!(!unstable.is_stable());
        unstable.denominator[0] = -1.0;
        assert!(!unstable.is_stable());
    }

    /// White noise is a sequence of independent samples, so the expected product is the sum over
    /// time of the products that one single sample leaves.
    #[test]
    fn the_products_of_noise_are_those_of_its_single_samples() {
        let model = Reduced5 { numerator: [120.0, 20.0, 30.0, 4.0, 5.0, 0.3], ..five_lags() };
        let step = StepMatrices::new(&model, 0.05);
        let mut filter = StateVariableFilter::at_rest(&model, 0.0);
        let mut sums = [0.0; ORDER + 1];
        for k in 0..1000 {
            filter.push(&step, if k == 0 { 1.0 } else { 0.0 });
            let derivatives = filter.derivatives(&model);
            if k == 0 {
                assert_eq!(step.newest_share(1)[..], derivatives[..ORDER]);
            }
            let response = model.response(&derivatives);
            for (sum, derivative) in sums.iter_mut().zip(derivatives) {
                *sum += derivative * response;
            }
        }
        for (product, sum) in step.noise_products(&model).into_iter().zip(sums) {
            // After 50 s the slowest lag of 1 s has decayed; what remains is rounding of sums of
            // order one.
            assert!((product - sum).abs() < 1e-12 * sums[ORDER].abs(), "{product} {sum}");
        }
    }

    #[test]
    fn scaled_time_leaves_the_roll_angle_and_its_scale_is_the_fifth_root() {
        let model = five_lags();
        let scale = model.time_scale_radps();
        assert!((scale.powi(5) - 120.0).abs() < 1e-10);
        let scaled = model.in_scaled_time(scale);
        assert!((scaled.denominator[0] - 1.0).abs() < 1e-14);
        assert!((scaled.denominator[4] - 15.0 / scale).abs() < 1e-14);
        assert!((scaled.numerator[0] - 1.0).abs() < 1e-14);
        let full = Reduced5 { numerator: [1.0; 6], ..model }.in_scaled_time(2.0);
        for (found, known) in full.numerator.into_iter().zip([32.0, 16.0, 8.0, 4.0, 2.0, 1.0_f64]) {
            assert!((found * known - 1.0).abs() < 1e-15);
        }
    }

    /// Each row of Routh's array separately: coefficients at which its first element vanishes or
    /// changes its sign.
    #[test]
    fn every_row_of_routh_counts() {
        // (s + 1)^5, then (s + 1)(s + 2)(s + 3)(s² + 9), which has an undamped oscillation.
        for (denominator, stable) in [
            ([1.0, 5.0, 10.0, 10.0, 5.0], true),
            ([54.0, 99.0, 60.0, 20.0, 6.0], false),
            ([-1.0, 5.0, 10.0, 10.0, 5.0], false),
            ([0.0, 5.0, 10.0, 10.0, 5.0], false),
            ([1.0, 5.0, 10.0, 10.0, -5.0], false),
            ([1.0, 5.0, 60.0, 10.0, 5.0], false),
            ([1.0, 5.0, f64::NAN, 10.0, 5.0], false),
        ] {
            let model = Reduced5 { denominator, ..five_lags() };
            assert_eq!(model.is_stable(), stable, "{denominator:?}");
        }
        // (s + 1)(s + 2)(s + 3)(s² + 2 d s + 9): stable for every damping d > 0.
        for damping in [0.01, -0.01] {
            let d = 2.0 * damping;
            let denominator = [54.0, 99.0 + 6.0 * d, 60.0 + 11.0 * d, 20.0 + 6.0 * d, 6.0 + d];
            let model = Reduced5 { denominator, ..five_lags() };
            assert_eq!(model.is_stable(), damping > 0.0);
        }
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut model = five_lags();
            model.numerator[5] = wrong;
            assert!(!model.is_stable());
        }
    }
}
