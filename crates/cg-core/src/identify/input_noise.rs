//! How noisy the input is, at the frequencies that count.

use crate::math::real::Real;

/// Rows are averaged over this time: what is faster (vibration, quantisation) does not count. A
/// little less than a round number, so that rounding does not decide which row is the last.
const MEAN_S: f64 = 0.0996;

/// White noise beneath a signal, from second differences of its means over tenths of a second,
/// one apart: `E[Δ²v Δ²v⁻] = −4 σ²/m` for means of `m` rows, while motion slower than 1.6 Hz makes
/// that product positive. So neither motion nor vibration is taken for noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputNoise<T> {
    sum: T,
    rows: T,
    elapsed_s: T,
    /// The newest two means and the newest second difference.
    means: Option<[T; 2]>,
    difference: Option<T>,
    products: T,
    count: T,
}

impl<T: Real> InputNoise<T> {
    pub(crate) const fn new() -> Self {
        let zero = T::ZERO;
        Self {
            sum: zero,
            rows: zero,
            elapsed_s: zero,
            means: None,
            difference: None,
            products: zero,
            count: zero,
        }
    }

    /// Takes in the next row, `interval_s` after the one before.
    pub(crate) fn push(&mut self, input: T, interval_s: T) {
        self.sum += input;
        self.rows += T::one();
        self.elapsed_s += interval_s;
        if self.elapsed_s >= T::of(MEAN_S) {
            self.close();
        }
    }

    fn close(&mut self) {
        let mean = self.sum / self.rows;
        let [last, first] = self.means.unwrap_or([mean; 2]);
        let difference = mean - last - (last - first);
        if let Some(before) = self.difference {
            self.products += difference * before * self.rows;
            self.count += T::one();
        }
        self.difference = Some(difference);
        self.means = Some([mean, last]);
        (self.sum, self.rows, self.elapsed_s) = (T::zero(), T::zero(), T::zero());
    }

    /// Multiplies the weight of all rows so far by `factor`.
    pub(crate) fn forget(&mut self, factor: T) {
        self.products *= factor;
        self.count *= factor;
    }

    /// Variance of the noise, row by row; zero where there is none to see.
    pub(crate) fn variance(&self) -> T {
        let variance = -self.products / (T::of(4.0) * self.count);
        // Written so that no rows (0/0) give zero.
        if variance > T::zero() { variance } else { T::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of this standard deviation on a swing of 0.5 Hz, at 100 Hz for 100 s.
    fn measured_sd(noise: impl Fn(u32) -> f64) -> f64 {
        let mut found = InputNoise::<f64>::new();
        for k in 0..10_000 {
            let time_s = f64::from(k) * 0.01;
            found.push((3.0 * time_s).sin() + noise(k), 0.01);
        }
        found.variance().root()
    }

    /// Uniform, white: a multiplicative hash of the place.
    fn white(k: u32) -> f64 {
        let mixed = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        f64::from(u32::try_from(mixed >> 32).unwrap()) / f64::from(u32::MAX) - 0.5
    }

    #[test]
    fn white_noise_is_measured_beneath_the_motion() {
        // Uniform over ±0.5: variance 1/12. 1000 means scatter by some 7 % of it.
        let sd = measured_sd(white);
        assert!((sd - (1.0_f64 / 12.0).sqrt()).abs() < 0.03, "{sd}");
    }

    #[test]
    fn motion_and_vibration_are_no_noise() {
        assert!(measured_sd(|_| 0.0) == 0.0);
        // From row to row up and down: nothing of it is slow.
        let vibration = measured_sd(|k| if k % 2 == 0 { 0.5 } else { -0.5 });
        assert!(vibration < 0.01, "{vibration}");
    }

    /// Ten rows of each value: means 0, 0, 4, 0, 0. Second differences 0, 0, 4, −8, 4: products
    /// of neighbours 0, 0, −32, −32, ten rows each, over four times their number.
    #[test]
    fn the_variance_is_that_of_the_means_by_hand() {
        let mut found = InputNoise::<f64>::new();
        assert!(found.variance() == 0.0);
        for value in [0.0, 0.0, 4.0, 0.0, 0.0] {
            for _ in 0..10 {
                found.push(value, 0.01);
            }
        }
        assert!((found.variance() - 640.0 / 16.0).abs() < 1e-9);
        // Forgetting leaves the mean as it is, and new rows count for more.
        found.forget(0.25);
        assert!((found.variance() - 640.0 / 16.0).abs() < 1e-9);
        for _ in 0..10 {
            found.push(0.0, 0.01);
        }
        // The next second difference is 0: nothing joins the 160 of the products, one the count of 1.
        assert!((found.variance() - 160.0 / 8.0).abs() < 1e-9);
    }
}
