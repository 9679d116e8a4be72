//! The noise of the roll angle in the regressors.
//!
//! White noise of the sensor is slow noise after the two lags of a channel: after two lags of `T` its
//! correlation over a time `t` is `(1 + t/T) e^(−t/T)`.

use crate::identify::long_run::BLOCK_S;
use crate::math::real::Real;
use crate::truck::channel::ROLL_LAG_S;
use crate::truck::reduced::{ORDER, Reduced5, StepMatrices};

/// The correlation of the noise of the roll angle with itself after the filters `sᵏ/B`, k = 0…4,
/// summed over the rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RollNoise<T> {
    pub(crate) sum: [T; ORDER],
    /// What a row adds if the roll angle passes the lags. Without them it is the weight of the newest
    /// sample in the filtered signal.
    lagged: Option<[T; ORDER]>,
}

impl<T: Real> RollNoise<T> {
    pub(crate) const NONE: Self = Self { sum: [T::ZERO; ORDER], lagged: None };

    /// The noise of a roll angle with or without lags, for a model in time scaled by `scale_radps`.
    pub(crate) fn of(lags: bool, model: &Reduced5<T>, scale_radps: T) -> Self {
        Self { lagged: lags.then(|| filtered_share(model, scale_radps)), ..Self::NONE }
    }

    pub(crate) fn add_row(&mut self, step: &StepMatrices<T>) {
        let shares = self.lagged.unwrap_or_else(|| step.newest_share());
        for (sum, share) in self.sum.iter_mut().zip(shares) {
            *sum += share;
        }
    }

    pub(crate) fn scale(&mut self, factor: T) {
        for sum in &mut self.sum {
            *sum *= factor;
        }
    }

    /// The long-run variance of the noise divided by its variance, if the sensor's noise is white.
    pub(crate) fn inflation(&self, interval_s: T) -> T {
        self.lagged.map_or(T::one(), |_| inflation(interval_s))
    }

    /// The long-run variance of a residual divided by its `variance`: a part of it is the response to
    /// the noise of the input, which is slow too. At s = 0 the model has a gain of one, so the long-run
    /// variance of that part is the variance of the input's noise. Without lags it is one.
    pub(crate) fn usual(&self, inflation: T, variance: T, [input, passed]: [T; 2]) -> T {
        let of_roll = (variance - passed).max(T::zero()) * inflation;
        let usual = (of_roll + input) / variance;
        if self.lagged.is_some() && usual > T::one() { usual } else { T::one() }
    }
}

/// The long-run variance of white noise after the lags, divided by its variance: the sum over a block
/// of length `L` has the variance of `4 T (1 − 3 T/(2 L))` seconds of equal errors.
fn inflation<T: Real>(interval_s: T) -> T {
    const SECONDS: f64 = 4.0 * ROLL_LAG_S * (1.0 - 1.5 * ROLL_LAG_S / BLOCK_S);
    (T::of(SECONDS) / interval_s).max(T::one())
}

/// The correlation of the noise with itself after the filters `sᵏ/B`, k = 0…4, for a model in time
/// scaled by `scale_radps`: `∫ g(t) (1 + t/T) e^(−t/T) dt` over the impulse response `g`, which is
/// `G(a) − a G'(a)` with the transfer function `G = sᵏ/B` and `a = 1/T`.
#[inline(never)]
fn filtered_share<T: Real>(model: &Reduced5<T>, scale_radps: T) -> [T; ORDER] {
    let a = T::one() / (T::of(ROLL_LAG_S) * scale_radps);
    // B and a B'
    let (mut value, mut slope, mut power) = (T::zero(), T::zero(), T::one());
    let mut degree = T::zero();
    for b in model.denominator.into_iter().chain([T::one()]) {
        value += b * power;
        slope += b * power * degree;
        power *= a;
        degree += T::one();
    }
    let (mut shares, mut power, mut degree) = ([T::zero(); ORDER], T::one(), T::zero());
    for share in &mut shares {
        *share = power / value * (T::one() - degree + slope / value);
        power *= a;
        degree += T::one();
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For `B = (s + c)⁵` the impulse response of `1/B` is `t⁴ e^(−ct)/24`, and the integral is
    /// `p⁻⁵ + 5 p⁻⁶/T` with `p = c + 1/T`. That of `s/B` is the derivative, which partial integration
    /// moves to the correlation: `∫ t⁴ e^(−pt) t/(24 T²) dt = 5 p⁻⁶/T²`.
    #[test]
    fn the_share_is_the_integral_by_hand() {
        let c = 3.0_f64;
        let denominator = [c.powi(5), 5.0 * c.powi(4), 10.0 * c.powi(3), 10.0 * c.powi(2), 5.0 * c];
        let model = Reduced5 { denominator, ..Reduced5::EMPTY };
        let found = filtered_share(&model, 1.0);
        let p = c + 1.0 / ROLL_LAG_S;
        let expected = [
            p.powi(-5) + 5.0 * p.powi(-6) / ROLL_LAG_S,
            5.0 * p.powi(-6) / (ROLL_LAG_S * ROLL_LAG_S),
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// Numbers from a multiplicative congruential generator, twice through the trapezoidal lag.
    #[test]
    fn the_inflation_is_that_of_block_sums() {
        let (interval_s, mut state) = (0.01_f64, 1_u64);
        let share = 0.5 * interval_s / (ROLL_LAG_S + 0.5 * interval_s);
        let [mut before, mut once, mut twice] = [0.0; 3];
        let (mut square, mut block, mut blocks) = (0.0, 0.0, 0.0);
        let rows = 600_000_u32;
        for k in 0..rows {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let noise =
                f64::from(u32::try_from(state >> 33).unwrap()) / f64::from(1_u32 << 31) - 0.5;
            let next = once + (before + noise - 2.0 * once) * share;
            twice += (once + next - 2.0 * twice) * share;
            (before, once) = (noise, next);
            square += twice * twice / f64::from(rows);
            block += twice;
            if k % 150 == 149 {
                blocks += block * block / 150.0 / f64::from(rows / 150);
                block = 0.0;
            }
        }
        // 4000 blocks: their mean square has a standard deviation of √(2/4000) = 2.2 %, here three
        // of them.
        assert!((blocks / square / inflation(interval_s) - 1.0).abs() < 0.067);
    }
}
