//! The filters with the denominator of the reduced model.
//!
//! One set of filters `sᵏ/B(s)`, k = 0…5, serves two purposes. Weighted with the numerator, the
//! filtered input is the expected roll angle. Applied to input and roll angle, the filters give the
//! regressors of [`FilteredArx`](crate::FilteredArx). Signals are interpolated linearly between
//! samples (first-order hold), and for such signals the discretization is exact.
//!
//! **Reference.** Franklin, Powell and Workman, *Digital Control of Dynamic Systems*,
//! 3rd ed., §6.3.2 (first-order hold); Garnier and Wang, *Identification of
//! Continuous-time Models from Sampled Data*, §1.3 (state-variable filters).

use core::array::from_fn;

use crate::math::real::Real;
use crate::truck::reduced::{ORDER, Reduced5};

/// The columns of a square matrix.
type Square<T> = [[T; ORDER]; ORDER];

// Loops over all entries, not inlined: one copy of each in the firmware image.

/// `matrix · vector`.
#[inline(never)]
fn times<T: Real>(matrix: &Square<T>, vector: &[T; ORDER]) -> [T; ORDER] {
    let mut sum = [T::zero(); ORDER];
    for (column, x) in matrix.iter().zip(vector) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += *entry * *x;
        }
    }
    sum
}

#[inline(never)]
fn product<T: Real>(a: &Square<T>, b: &Square<T>) -> Square<T> {
    let mut product = *b;
    for column in &mut product {
        *column = times(a, column);
    }
    product
}

/// Adds `Φ W Φᵀ` to a symmetric matrix `W`. Returns whether that changes it.
#[inline(never)]
fn double<T: Real>(covariance: &mut Square<T>, transition: &Square<T>) -> bool {
    let before = *covariance;
    for (j, column) in covariance.iter_mut().enumerate() {
        let row = from_fn(|k| transition[k][j]);
        add(column, &times(transition, &times(&before, &row)), T::one());
    }
    *covariance != before
}

/// Adds `factor` times some numbers to others.
#[inline(never)]
fn add<T: Real>(sums: &mut [T], others: &[T], factor: T) {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum += *other * factor;
    }
}

fn dot<T: Real>(a: &[T; ORDER], b: &[T; ORDER]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Number of doublings in the sum of the noise in the filters: 2¹² samples are 4 s at 1 kHz.
const DOUBLINGS: u32 = 12;

/// One step of the filters `sᵏ/B(s)` over a fixed sampling interval, exact for signals that are
/// linear between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepMatrices<T> {
    /// `exp(A h) − I`, stored without the identity to avoid rounding errors of short steps in
    /// `f32`.
    increment: Square<T>,
    held: [T; ORDER],
    ramp: [T; ORDER],
}

impl<T: Real> StepMatrices<T> {
    /// The step over an interval of zero.
    pub(crate) const STANDING: Self = Self {
        increment: [[T::ZERO; ORDER]; ORDER],
        held: [T::ZERO; ORDER],
        ramp: [T::ZERO; ORDER],
    };

    /// The step over an interval `step`, in the time unit of `model`.
    pub fn new(model: &Reduced5<T>, step: T) -> Self {
        let mut matrices = Self::STANDING;
        matrices.renew(model, step);
        matrices
    }

    /// Becomes that of another interval or model, without a copy on the stack.
    ///
    /// It is `exp(M) − I` by scaling, a 12-term Taylor series and `(I + F)² − I = 2F + F²`, with
    ///
    /// ```text
    ///     d/dt (x, u, u̇) with u̇ in units of one step:  M = step · ┌ A B 0 ┐ + ┌ 0 0 0 ┐
    ///                                                           │ 0 0 0 │   │ 0 0 1 │
    ///                                                           └ 0 0 0 ┘   └ 0 0 0 ┘
    /// ```
    ///
    /// Only its rows for x are computed.
    #[inline(never)]
    pub(crate) fn renew(&mut self, model: &Reduced5<T>, step: T) {
        let sizes = model.denominator.iter().fold(T::one(), |sum, b| sum + b.abs());
        let (mut norm, mut step, mut ramp) = (sizes * step.abs(), step, T::one());
        // ‖A‖ ≤ 1/4 leaves a remainder of 4⁻¹³/13! = 2e-18. The second condition also ends at infinity.
        while norm > T::of(0.25) && ramp > T::of(1e-12) {
            for half in [&mut norm, &mut step, &mut ramp] {
                *half *= T::of(0.5);
            }
        }
        // M^k/k!, from the identity on.
        let mut term = [[T::zero(); ORDER]; ORDER + 2];
        for k in 0..ORDER {
            term[k][k] = T::one();
        }
        let (mut sum, mut k) = ([[T::zero(); ORDER]; ORDER + 2], T::zero());
        for _ in 0..12 {
            k += T::one();
            times_companion(&mut term, &model.denominator, step / k, ramp / k);
            add(sum.as_flattened_mut(), term.as_flattened(), T::one());
        }
        while ramp < T::one() {
            let [a, b, c, d, e, held, _] = sum;
            let increment = [a, b, c, d, e];
            for column in &mut sum {
                let (before, square) = (*column, times(&increment, column));
                add(column, &before, T::one());
                add(column, &square, T::one());
            }
            add(&mut sum[ORDER + 1], &held, ramp); // the row of u in F is (0, 0, ramp)
            ramp += ramp;
        }
        let [a, b, c, d, e, held, ramp] = sum;
        *self = Self { increment: [a, b, c, d, e], held, ramp };
    }

    /// Weight of the newest sample in the signal filtered by `sᵏ/B(s)`, k = 0…4.
    pub fn newest_share(&self) -> &[T; ORDER] {
        &self.ramp
    }

    /// The expected products `E[u_k · G u]` of the filtered signals `u_k = sᵏ/B(s) u`, k = 0…5,
    /// with the response `G u = A/B u`, for white noise `u` of unit variance.
    ///
    /// They are sums over time of the products that one single sample leaves. From the one after it on,
    /// `x⁺ = Φ x`, and `Σ x xᵀ` is computed by doubling.
    #[inline(never)]
    pub fn noise_products(&self, model: &Reduced5<T>) -> [T; ORDER + 1] {
        // The sample itself, and the one after it, at which the signal is zero again.
        let first = StateVariableFilter { state: self.ramp, input: T::one() };
        let derivatives = first.derivatives(model);
        let mut products = [T::zero(); ORDER + 1];
        add(&mut products, &derivatives, model.response(&derivatives));
        let mut state = times(&self.increment, &self.ramp);
        add(&mut state, &self.held, T::one());
        let mut transition = self.increment;
        for k in 0..ORDER {
            transition[k][k] += T::one();
        }
        let mut covariance = [[T::zero(); ORDER]; ORDER];
        for (column, scale) in covariance.iter_mut().zip(state) {
            add(column, &state, scale);
        }
        for _ in 0..DOUBLINGS {
            if !double(&mut covariance, &transition) {
                break; // what follows is smaller still
            }
            transition = product(&transition, &transition);
        }
        // Without an input, G u = c·x.
        let through = model.numerator[ORDER];
        let c = from_fn(|k| model.numerator[k] - model.denominator[k] * through);
        let states = times(&covariance, &c);
        add(&mut products, &states, T::one());
        products[ORDER] -= dot(&model.denominator, &states);
        products
    }
}

/// Multiplies the rows for x of a matrix, given by columns, by M (see [`StepMatrices::new`]), in which A is
/// the companion matrix of the denominator.
fn times_companion<T: Real>(
    columns: &mut [[T; ORDER]; ORDER + 2],
    denominator: &[T; ORDER],
    step: T,
    ramp: T,
) {
    let [states @ .., last, of_input, of_ramp] = columns;
    *of_ramp = of_input.map(|entry| entry * ramp);
    *of_input = last.map(|entry| entry * step);
    let driven = *of_input;
    // Column k is column k − 1 times the step, minus B_k times the last one.
    let mut before = [T::zero(); ORDER];
    for (column, b) in states.iter_mut().chain([last]).zip(denominator) {
        let shifted = before;
        before = column.map(|entry| entry * step);
        *column = shifted;
        add(column, &driven, -*b);
    }
}

/// The states of the filters `sᵏ/B(s)`, k = 0…5, for one signal.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StateVariableFilter<T> {
    state: [T; ORDER],
    input: T,
}

impl<T: Real> StateVariableFilter<T> {
    /// Filters with all states zero.
    pub(crate) const EMPTY: Self = Self { state: [T::ZERO; ORDER], input: T::ZERO };

    /// Filters in steady state at the constant signal `input`.
    pub fn at_rest(model: &Reduced5<T>, input: T) -> Self {
        let mut state = [T::zero(); ORDER];
        state[0] = input / model.denominator[0];
        Self { state, input }
    }

    /// Advances to the next sample of the signal.
    #[inline]
    pub fn push(&mut self, step: &StepMatrices<T>, input: T) {
        // Added to the state at once, because small numbers lose digits beside it.
        let jump = input - self.input;
        let mut change = [T::zero(); ORDER];
        for (column, x) in step.increment.iter().zip(self.state) {
            for (change, entry) in change.iter_mut().zip(column) {
                *change += *entry * x;
            }
        }
        for i in 0..ORDER {
            self.state[i] += change[i] + step.held[i] * self.input + step.ramp[i] * jump;
        }
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
    use crate::truck::reduced::tests::five_lags;
    use crate::truck::simulation::Simulation;

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

    /// White noise is a sequence of independent samples, so the expected product is the sum over
    /// time of the products that one single sample leaves.
    #[test]
    fn the_products_of_noise_are_those_of_its_single_samples() {
        let model = Reduced5 { numerator: [120.0, 20.0, 30.0, 4.0, 5.0, 0.3], ..five_lags() };
        let step = StepMatrices::new(&model, 0.05);
        let mut filter = StateVariableFilter::at_rest(&model, 0.0);
        let mut products = [0.0; ORDER + 1];
        for k in 0..1000 {
            filter.push(&step, if k == 0 { 1.0 } else { 0.0 });
            let derivatives = filter.derivatives(&model);
            let response = model.response(&derivatives);
            for (product, derivative) in products.iter_mut().zip(&derivatives) {
                *product += derivative * response;
            }
            if k == 0 {
                assert!(step.newest_share()[..] == derivatives[..ORDER]);
            }
        }
        for (product, sum) in step.noise_products(&model).into_iter().zip(products) {
            // After 50 s the slowest lag of 1 s has decayed; what remains is rounding of sums of
            // order one.
            assert!((product - sum).abs() < 1e-12 * products[ORDER].abs(), "{product} {sum}");
        }
    }
}
