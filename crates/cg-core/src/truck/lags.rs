//! The two lags of a channel whose input is an acceleration.

use crate::math::real::Real;
use crate::truck::channel::ROLL_LAG_S;

/// Time over which noise is averaged.
const NOISE_S: f64 = 1.0;

/// A roll angle after one and after two lags of [`ROLL_LAG_S`].
///
/// Between two values the angle is a line, as the signals of the regression's filters are, so that both miss the same where it
/// is none.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RollLags<T> {
    /// The angle itself, and after one and two lags.
    angles_rad: [T; 3],
}

impl<T: Real> RollLags<T> {
    /// The lags after a long rest at this angle.
    pub const fn at_rest(roll_rad: T) -> Self {
        Self { angles_rad: [roll_rad; 3] }
    }

    /// Advances to the next angle, `interval_s` after the previous one; returns it after both lags.
    pub fn push(&mut self, roll_rad: T, interval_s: T) -> T {
        // By hand, for e^(−x) = (12 − 6x + x²)/(12 + 6x + x²), a Padé approximant that is wrong by 4e-5 at 80 ms.
        let x = interval_s * T::of(1.0 / ROLL_LAG_S);
        let (twelve, six_x, square) = (T::of(12.0), T::of(6.0) * x, x * x);
        let below = T::one() / (twelve + six_x + square);
        let (left, passed) = ((twelve - six_x + square) * below, twelve * x * below);
        let [before, once, twice] = self.angles_rad;
        let rise = (roll_rad - before) * below;
        let next_once = once + (before - once) * passed + rise * (six_x + square);
        let by_once = x * left * (once - before);
        let next_twice = twice + (before - twice) * passed + by_once + rise * (square + square);
        self.angles_rad = [roll_rad, next_once, next_twice];
        next_twice
    }
}

/// White noise of a roll angle, from how far each angle is from the line through the two before it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LateNoise<T> {
    rate_radps: T,
    variance_rad2: T,
}

impl<T: Real> LateNoise<T> {
    pub(crate) const NONE: Self = Self { rate_radps: T::ZERO, variance_rad2: T::ZERO };

    /// Takes a change of the roll angle within `interval_s`; returns the standard deviation of the noise that
    /// is left after both lags, radians.
    ///
    /// At equal intervals `Δ`, white noise is in the distance from the line with the weights 1, −2 and 1. The lags
    /// leave `Δ/(4 T)` of its variance. A sine of ω rad/s adds `(ω Δ)²/√12` of its amplitude: at 80 ms that of an
    /// ordinary lane change (2 rad/s) is 0.7 %, of which the lags leave a third.
    pub(crate) fn push(&mut self, change_rad: T, interval_s: T) -> T {
        // This form of the comparison gives none for NaN.
        if !(interval_s > T::zero()) {
            return T::zero();
        }
        let rate_radps = change_rad / interval_s;
        let off_rad = change_rad - self.rate_radps * interval_s;
        self.rate_radps = rate_radps;
        let share = (interval_s * T::of(1.0 / NOISE_S)).min(T::one());
        self.variance_rad2 += (off_rad * off_rad * T::of(1.0 / 6.0) - self.variance_rad2) * share;
        (self.variance_rad2 * interval_s * T::of(0.25 / ROLL_LAG_S)).root()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::white::white;

    /// White noise of one milliradian, through the lags.
    #[test]
    fn noise_after_the_lags_is_found_before_them() {
        let (mut lags, mut noise) = (RollLags::at_rest(0.0), LateNoise::NONE);
        let (mut before_rad, mut square, mut found) = (0.0, 0.0, 0.0);
        let samples = 40_000_u32;
        for k in 0..samples {
            let roll_rad = 1e-3 * white(k);
            found += noise.push(roll_rad - before_rad, 0.04).powi(2) / f64::from(samples);
            square += lags.push(roll_rad, 0.04).powi(2) / f64::from(samples);
            before_rad = roll_rad;
        }
        // Neighboring distances from the line have the correlations −2/3 and 1/6, so a variance from 40 000 of them has
        // a standard deviation of √(2 (1 + 2 (4/9 + 1/36))/40 000) = 1.0 %; that of noise that lasts 4 T, one of
        // √(2 · 4 T/1600 s) = 2.7 %. Three of each.
        assert!((found / 1e-6 / (0.04 / 4.0 / ROLL_LAG_S) - 1.0).abs() < 0.03, "{found}");
        assert!((square / found - 1.0).abs() < 0.08, "{square} {found}");
    }

    /// A lane change of 2 rad/s, and no time at all.
    #[test]
    fn motion_is_hardly_noise() {
        let mut noise = LateNoise::NONE;
        let mut most = 0.0_f64;
        for k in 0..500 {
            let sine = |k: i32| (f64::from(k) * 0.08).sin();
            let found = noise.push(sine(k) - sine(k - 1), 0.04);
            most = if k > 100 { most.max(found) } else { 0.0 };
        }
        // (ω Δ)² cos/√6 of the amplitude, whose mean square over a second is 0.5 to 0.75.
        let left = (0.04_f64 / 4.0 / ROLL_LAG_S).sqrt();
        assert!(most > 0.0018 * left && most < 0.0023 * left, "{most}");
        assert!(noise.push(1.0, 0.0) == 0.0 && noise.push(1.0, f64::NAN) == 0.0);
    }

    /// A sine of 2 rad/s after two lags of `T`: its amplitude is `1/(1 + (2 T)²)`, and it is late by twice
    /// the angle whose tangent is `2 T`. A line between two values misses a twelfth of the
    /// square of the angle between them: 0.3 % at 10 Hz.
    #[test]
    fn the_lags_are_those_of_the_model() {
        for (rate_hz, tolerance) in [(10_u32, 3.4e-3), (100, 3.4e-5)] {
            let mut lags = RollLags::at_rest(0.0_f64);
            let mut worst = 0.0_f64;
            for k in 1..20 * rate_hz {
                let time_s = f64::from(k) / f64::from(rate_hz);
                let found = lags.push((2.0 * time_s).sin(), 1.0 / f64::from(rate_hz));
                let tangent = 2.0 * ROLL_LAG_S;
                let late = 2.0 * tangent.atan();
                let expected = (2.0 * time_s - late).sin() / (1.0 + tangent * tangent);
                // The start has decayed after five seconds.
                if time_s > 5.0 {
                    worst = worst.max((found - expected).abs());
                }
            }
            assert!(worst < tolerance, "{rate_hz}: {worst}");
        }
    }

    /// Of a line nothing is missed, whatever the intervals: after a time `t` it is late by `2 T − (t + 2 T) e^(−t/T)`.
    #[test]
    fn a_line_is_exact() {
        let mut lags = RollLags::at_rest(0.0_f64);
        let (mut time_s, mut worst) = (0.0, 0.0_f64);
        for interval_s in [0.04, 0.01, 0.1, 0.05, 0.04, 0.02, 0.1, 0.08] {
            time_s += interval_s;
            let found = lags.push(time_s, interval_s);
            let twice_s = 2.0 * ROLL_LAG_S;
            let decayed = libm::exp(-time_s / ROLL_LAG_S);
            worst = worst.max((found - (time_s - twice_s + (time_s + twice_s) * decayed)).abs());
        }
        // The approximant is wrong by x⁵/720 in an interval of x T, in two of 0.1 s by 3.7e-4 of a difference below 0.25.
        assert!(worst < 9e-5, "{worst}");
    }
}
