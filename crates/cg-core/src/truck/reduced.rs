//! The reduced 5th-order compensated model.
//!
//! ```text
//!              A5 s⁵ + A4 s⁴ + A3 s³ + A2 s² + A1 s + A0
//!     G(s) =  ───────────────────────────────────────────       eq. 5.12
//!                s⁵ + B4 s⁴ + B3 s³ + B2 s² + B1 s + B0
//! ```

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
        let target = self.denominator[0];
        // Newton's method falls to the root from above, until rounding ends it.
        let mut root = target.max(T::one()).root();
        loop {
            let square = root * root;
            let next = root - (root - target / (square * square)) * T::of(0.2);
            if !(next < root) {
                return root;
            }
            root = next;
        }
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// 120 / ((s + 1)(s + 2)(s + 3)(s + 4)(s + 5)): unit DC gain and known responses.
    pub(in crate::truck) fn five_lags() -> Reduced5<f64> {
        Reduced5 {
            numerator: [120.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            denominator: [120.0, 274.0, 225.0, 85.0, 15.0],
            speed_slope: [0.0; ORDER],
        }
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
