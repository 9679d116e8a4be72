//! The noise of the input in the frequency range of the roll motion.

use crate::math::real::Real;
use crate::truck::reduced::{ORDER, Reduced5};

/// Rows are averaged over this time to suppress faster noise (vibration, quantization). It is
/// slightly below that of a mean of neighboring samples, so that rounding does not decide which row is the last.
const MEAN_S: f64 = 0.0796;

/// Estimates the variance of white noise in a signal from second differences of its means over
/// somewhat less than a tenth of a second. Products of consecutive second differences have the mean
/// `E[Δ²v Δ²v⁻] = −4 σ²/m` for means of `m` rows, whereas motion slower than 2 Hz makes them
/// positive. Neither motion nor vibration is therefore mistaken for noise.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InputNoise<T> {
    sum: T,
    rows: T,
    elapsed_s: T,
    /// The last two means, and below the last second difference.
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

    /// Adds the mean of the next `samples`, the last of which comes `elapsed_s` after the previous one.
    pub(crate) fn push(&mut self, input: T, samples: T, elapsed_s: T) {
        self.sum += input * samples;
        self.rows += samples;
        self.elapsed_s += elapsed_s;
        if self.elapsed_s >= T::of(MEAN_S) {
            self.close();
        }
    }

    /// The next row does not follow the last one: what the signal does between them is motion.
    pub(crate) fn interrupt(&mut self) {
        *self = Self { products: self.products, count: self.count, ..Self::new() };
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

    /// Variance of the noise of single rows; zero if no noise is found.
    pub(crate) fn variance(&self) -> T {
        let variance = -self.products / (T::of(4.0) * self.count);
        // This form of the comparison gives zero if there are no rows (0/0).
        if variance > T::zero() { variance } else { T::zero() }
    }

    /// Relative standard deviation of the variance: `√(6.125/n)` from `n` products, 16 % after 20 s. Second
    /// differences of white noise have the covariances 6, −4 and 1 (of its variance), whence that of two products
    /// `k` apart is `r_k² + r_{k+1} r_{k−1}`, and the sum of all of them is 98, divided by 4².
    pub(crate) fn doubt(&self) -> T {
        if self.count > T::zero() { (T::of(6.125) / self.count).root() } else { T::zero() }
    }

    /// The variance of the noise, and that of the response of a model to it. `products` are the expected
    /// products of the filtered noise with this response, for noise of unit variance.
    pub(crate) fn passed(&self, model: &Reduced5<T>, products: &[T; ORDER + 1]) -> [T; 2] {
        let variance = self.variance();
        let mut gain = T::zero();
        for (a, product) in model.numerator.iter().zip(products) {
            gain += *a * *product;
        }
        [variance, gain * variance]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::white::white;

    /// The standard deviation found for noise added to a 0.5 Hz oscillation, at 100 Hz for 100 s.
    fn measured_sd(noise: impl Fn(u32) -> f64) -> f64 {
        let mut found = InputNoise::<f64>::new();
        for k in 0..10_000 {
            let time_s = f64::from(k) * 0.01;
            found.push((3.0 * time_s).sin() + noise(k), 1.0, 0.01);
        }
        found.variance().root()
    }

    #[test]
    fn white_noise_is_measured_beneath_the_motion() {
        // With 1250 means the error of the variance is some 7 %, here three of them.
        let sd = measured_sd(white);
        assert!((sd - 1.0).abs() < 0.105, "{sd}");
    }

    /// The standard deviation of 400 estimates from 20 s each, which is itself known to 1/√800 = 3.5 %, within three
    /// times that. The products at the ends have fewer neighbors, which is 2 % in 250 means.
    #[test]
    fn the_doubt_is_the_scatter_of_the_variance() {
        let [mut sum, mut squares, mut doubt] = [0.0; 3];
        for draw in 0..400 {
            let mut found = InputNoise::<f64>::new();
            for k in 0..2000 {
                found.push(white(2000 * draw + k), 1.0, 0.01);
            }
            let variance = found.variance();
            sum += variance / 400.0;
            squares += variance * variance / 400.0;
            doubt = found.doubt();
        }
        let scatter = (squares - sum * sum).root();
        assert!((sum - 1.0).abs() < 3.0 * doubt / 20.0, "{sum}");
        assert!((scatter / doubt - 1.0).abs() < 0.105 + 0.02, "{scatter} {doubt}");
    }

    /// A turn of which only the straight driving before it and the end are seen.
    #[test]
    fn what_happens_in_a_hole_is_no_noise() {
        let mut found = InputNoise::<f64>::new();
        for k in 0..100_u32 {
            if k % 20 == 0 {
                found.interrupt();
            }
            found.push(if k / 20 % 2 == 0 { 0.0 } else { 1.0 }, 1.0, 0.05);
        }
        assert!(found.variance() == 0.0);
    }

    #[test]
    fn motion_and_vibration_are_no_noise() {
        assert!(measured_sd(|_| 0.0) == 0.0);
        // The sign changes from row to row, so there is no slow part.
        let vibration = measured_sd(|k| if k % 2 == 0 { 0.5 } else { -0.5 });
        assert!(vibration < 0.01, "{vibration}");
    }

    /// Eight rows of each value: means 0, 0, 4, 0, 0. The second differences are 0, 0, 4, −8, 4. The
    /// products of neighbors are 0, 0, −32, −32, with eight rows each; their sum is divided by four
    /// times their number.
    #[test]
    fn the_variance_is_that_of_the_means_by_hand() {
        let mut found = InputNoise::<f64>::new();
        assert!(found.variance() == 0.0);
        for value in [0.0, 0.0, 4.0, 0.0, 0.0] {
            for _ in 0..8 {
                found.push(value, 1.0, 0.01);
            }
        }
        assert!((found.variance() - 512.0 / 16.0).abs() < 1e-9);
        // Forgetting does not change the estimate, and new rows have more weight.
        found.forget(0.25);
        assert!((found.variance() - 512.0 / 16.0).abs() < 1e-9);
        for _ in 0..8 {
            found.push(0.0, 1.0, 0.01);
        }
        // The next second difference is 0: it adds nothing to the 128 of the products and one to
        // the count of 1.
        assert!((found.variance() - 128.0 / 8.0).abs() < 1e-9);
    }
}
