//! Fusion of the heights of all maneuvers of a channel.

use crate::math::real::Real;
use crate::truck::ratio::Measured;

/// The height of the trailer's c.g. (sprung mass, above the ground, at rest).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height<T> {
    /// Height and its total standard deviation, meters.
    pub height_m: Measured<T>,
    /// The part of the standard deviation that decreases with more maneuvers, meters.
    pub random_sd_m: T,
    /// Number of maneuvers used.
    pub maneuvers: u32,
}

/// Inverse-variance mean of the maneuvers' heights.
///
/// Noise averages out. The uncertainty of compensation and model is common to all maneuvers and
/// does not. If the heights scatter more than their noise explains, the random part of the standard
/// deviation is multiplied by the Birge ratio `√(χ²/(n − 1))`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Fusion<T> {
    /// Sum of the inverse variances, 1/m².
    weight: T,
    /// Weighted mean of the heights, m.
    mean: T,
    /// `Σ w (h − mean)²`.
    scatter: T,
    /// Mean of the systematic standard deviations, m.
    systematic: T,
    /// Number of maneuvers.
    maneuvers: u32,
}

impl<T: Real> Default for Fusion<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Fusion<T> {
    /// A fusion without maneuvers.
    pub const fn new() -> Self {
        let zero = T::ZERO;
        Self { weight: zero, mean: zero, scatter: zero, systematic: zero, maneuvers: 0 }
    }

    /// Adds one maneuver: its height with the standard deviation due to noise, and the standard
    /// deviation due to compensation and model. Heights without a finite value and a positive
    /// standard deviation are ignored.
    pub fn push(&mut self, height_m: Measured<T>, systematic_sd_m: T) {
        let variance = height_m.sd * height_m.sd;
        if !(variance > T::zero()) || !variance.present() || !height_m.value.present() {
            return;
        }
        let weight = T::one() / variance;
        self.weight += weight;
        let share = weight / self.weight;
        let deviation = height_m.value - self.mean;
        self.mean += share * deviation;
        self.scatter += weight * deviation * (height_m.value - self.mean);
        self.systematic += share * (systematic_sd_m - self.systematic);
        self.maneuvers = self.maneuvers.saturating_add(1);
    }

    /// The same height as if all of its uncertainty were noise of its own.
    #[must_use]
    pub(crate) fn loosened(self) -> Self {
        let Some(height) = self.height() else { return self };
        let variance = height.height_m.sd * height.height_m.sd;
        Self { weight: T::one() / variance, scatter: T::zero(), systematic: T::zero(), ..self }
    }

    /// Whether every number is in its possible range. The limits are far beyond any truck. They are
    /// low enough that squares and quotients of two fusions remain finite in single precision.
    pub(crate) fn is_sound(&self) -> bool {
        let Self { weight, mean, scatter, systematic, maneuvers } = *self;
        let (greatest_m, greatest_weight) = (T::of(1e6), T::of(1e24));
        let counted = (maneuvers > 0) == (weight > T::zero() && mean > T::zero());
        let within = |x: T, greatest: T| x >= T::zero() && x <= greatest;
        let known = self.height().is_none_or(|height| within(height.height_m.sd, greatest_m));
        counted
            && known
            && within(weight, greatest_weight)
            && scatter.present()
            && scatter >= T::zero()
            && within(mean, greatest_m)
            && within(systematic, greatest_m)
    }

    /// The fused height; `None` before the first maneuver.
    pub fn height(&self) -> Option<Height<T>> {
        if self.maneuvers == 0 {
            return None;
        }
        let mut variance = T::one() / self.weight;
        if self.maneuvers > 1 {
            let freedom = T::of(f64::from(self.maneuvers - 1));
            variance *= (self.scatter / freedom).max(T::one());
        }
        let sd = (variance + self.systematic * self.systematic).root();
        Some(Height {
            height_m: Measured { value: self.mean, sd },
            random_sd_m: variance.root(),
            maneuvers: self.maneuvers,
        })
    }
}

impl<T: Real> Height<T> {
    /// The part of the standard deviation that does not decrease with more maneuvers.
    pub(crate) fn systematic_sd_m(&self) -> T {
        let total = self.height_m.sd * self.height_m.sd;
        (total - self.random_sd_m * self.random_sd_m).max(T::zero()).root()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All numbers are finite, but the height would not be.
    #[test]
    fn a_fusion_without_a_finite_height_is_not_sound() {
        let good = Fusion { weight: 4e4, mean: 1.7, scatter: 0.0, systematic: 0.2, maneuvers: 2 };
        assert!(good.is_sound() && Fusion::<f64>::new().is_sound());
        for wrong in [
            Fusion { weight: 1e-320, ..good },
            Fusion { weight: 1e300, ..good },
            Fusion { mean: 1e300, ..good },
            Fusion { systematic: 1e200, ..good },
            Fusion { weight: 1e-6, scatter: 1e308, ..good },
        ] {
            assert!(!wrong.is_sound(), "{wrong:?}");
        }
    }

    #[test]
    fn noise_averages_out_and_the_systematic_part_stays() {
        let mut fusion = Fusion::<f64>::default();
        for value in [1.99, 2.01, 2.0, 2.0] {
            fusion.push(Measured { value, sd: 0.02 }, 0.03);
        }
        let height = fusion.height().unwrap();
        assert!((height.height_m.value - 2.0).abs() < 1e-12);
        assert!((height.random_sd_m - 0.01).abs() < 1e-12);
        assert!((height.height_m.sd - 0.001_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn scatter_beyond_the_noise_widens_the_interval() {
        let mut fusion = Fusion::<f64>::default();
        fusion.push(Measured { value: 1.9, sd: 0.01 }, 0.0);
        fusion.push(Measured { value: 2.1, sd: 0.01 }, 0.0);
        // χ² = 2 (0.1/0.01)² = 200, one degree of freedom: √(0.01²/2 · 200) = 0.1
        assert!((fusion.height().unwrap().random_sd_m - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_height_without_a_number_is_left_out() {
        let mut fusion = Fusion::<f64>::default();
        fusion.push(Measured { value: f64::NAN, sd: 0.1 }, 0.0);
        fusion.push(Measured { value: 2.0, sd: 0.0 }, 0.0);
        assert_eq!(fusion.height(), None);
    }

    #[test]
    fn maneuvers_count_by_their_inverse_variance() {
        let mut fusion = Fusion::<f64>::default();
        fusion.push(Measured { value: 2.0, sd: 0.02 }, 0.03);
        fusion.push(Measured { value: 2.02, sd: 0.04 }, 0.08);
        let height = fusion.height().unwrap();
        // Weights 4 : 1. The scatter 0.02²/(0.02² + 0.04²) = 0.2 is not more than noise explains.
        assert!((height.height_m.value - 2.004).abs() < 1e-12);
        assert!((height.random_sd_m - 0.02 / 1.25_f64.sqrt()).abs() < 1e-12);
        let systematic: f64 = (4.0 * 0.03 + 0.08) / 5.0;
        let total = (0.02_f64.powi(2) / 1.25 + systematic.powi(2)).sqrt();
        assert!((height.height_m.sd - total).abs() < 1e-12);
        assert_eq!(height.maneuvers, 2);
        for wrong in [f64::NAN, f64::INFINITY, -0.0] {
            fusion.push(Measured { value: 2.0, sd: wrong }, 0.0);
        }
        assert_eq!(fusion.height(), Some(height));
    }

    /// Three heights at ±0.03 and 0 with a standard deviation of 0.01: χ² = 18 with two degrees of
    /// freedom.
    #[test]
    fn scatter_counts_per_degree_of_freedom() {
        let mut fusion = Fusion::<f64>::default();
        for value in [1.97, 2.03, 2.0] {
            fusion.push(Measured { value, sd: 0.01 }, 0.0);
        }
        assert!((fusion.height().unwrap().random_sd_m - 0.01 * 3.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_fusion_is_sound_if_every_number_can_be() {
        let empty = Fusion::<f64>::new();
        let mut good = empty;
        good.push(Measured { value: 2.0, sd: 0.02 }, 0.03);
        assert!(empty.is_sound() && good.is_sound());
        let changes: [fn(&mut Fusion<f64>); 11] = [
            |f| f.weight = 0.0,
            |f| f.weight = f64::NAN,
            |f| f.weight = f64::INFINITY,
            |f| f.mean = 0.0,
            |f| f.mean = -1.0,
            |f| f.scatter = -1e-9,
            |f| f.scatter = f64::NAN,
            |f| f.systematic = -1e-9,
            |f| f.systematic = f64::INFINITY,
            |f| f.maneuvers = 0,
            |f| f.mean = f64::INFINITY,
        ];
        for (k, change) in changes.into_iter().enumerate() {
            let mut changed = good;
            change(&mut changed);
            assert!(!changed.is_sound(), "{k}");
        }
        assert!(!Fusion { maneuvers: 1, ..empty }.is_sound());
    }
}
