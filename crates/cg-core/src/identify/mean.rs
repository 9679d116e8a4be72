//! The mean of some neighboring samples of a channel, which gives one row of the regression.
//!
//! A truck rolls within seconds, so a sample that is a hundredth of a second later says little that its
//! neighbors do not say. Input and roll angle are therefore replaced by their means over a few samples, at
//! the mean of their times. The mean is linear and the same for both, so the means obey the transfer
//! function of the signals. A row that is made of them has the weight of its samples. What the means do
//! not contain is how much the samples scatter about them. For the roll angle that is nearly all of a
//! sensor's white noise, so it is kept as a number.

use crate::math::real::Real;

/// The mean of some samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean<T> {
    /// The input, rad or m/s².
    pub input: T,
    /// The roll angle, rad.
    pub roll_rad: T,
    /// Time since the mean before it, from middle to middle, s.
    pub interval_s: T,
    /// Time since the last sample of the mean before it, s.
    pub elapsed_s: T,
    /// The number of samples.
    pub samples: u32,
    /// The same as a number of the type of the signals.
    pub weight: T,
    /// Whether its row is used for the fit.
    pub is_used: bool,
    /// Sums of squares and products about the means: of the roll angle (rad²), of roll angle and time (rad s), and of
    /// the time (s²). Zero if the scatter says nothing about the noise of single samples.
    pub scatter: [T; 3],
}

impl<T: Real> Mean<T> {
    /// A single sample, `interval_s` after the previous one.
    pub const fn single(input: T, roll_rad: T, interval_s: T, is_used: bool) -> Self {
        Self {
            input,
            roll_rad,
            interval_s,
            elapsed_s: interval_s,
            samples: 1,
            weight: T::ONE,
            is_used,
            scatter: [T::ZERO; 3],
        }
    }

    /// Sum of the squares of the roll angles of the samples.
    pub(crate) fn roll_squares(&self) -> T {
        self.weight * self.roll_rad * self.roll_rad + self.scatter[0]
    }

    /// Sum of the squares of the roll angle about a line of this slope through the mean, per second.
    pub(crate) fn squares_about(&self, slope: T) -> T {
        let [rolls, products, times] = self.scatter;
        rolls - slope * (products + products - slope * times)
    }
}

/// How much samples scatter about their means.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Scatter<T> {
    squares: T,
    /// Number of samples minus number of means.
    pub(crate) freedom: T,
}

impl<T: Real> Scatter<T> {
    pub(crate) const NONE: Self = Self { squares: T::ZERO, freedom: T::ZERO };

    /// Adds the squares of a mean of this many samples.
    pub(crate) fn push(&mut self, squares: T, samples: T) {
        self.squares += squares;
        self.freedom += samples - T::one();
    }

    /// Multiplies the weight of all samples so far by `factor`.
    pub(crate) fn forget(&mut self, factor: T) {
        self.squares *= factor;
        self.freedom *= factor;
    }

    /// The variance of the white noise in single samples: that about the means, which is also that of the
    /// rows made of them, of which `variance` is known. Motion that a model explains is in the first alone,
    /// slow errors of a model in the second alone.
    pub(crate) fn white_variance(&self, variance: T) -> T {
        let within = self.squares / self.freedom;
        // This form of the comparison also serves without means (0/0), as at 20 samples a second.
        if within < variance { within.max(T::zero()) } else { variance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    /// By hand: 3, 5 and 10 at −1, 0 and 1 s have the mean 6, the squares 26, the products 7 and the times 2.
    #[test]
    fn squares_are_those_about_a_line() {
        let single = Mean::single(0.0, 6.0, 1.0, true);
        let mean = Mean { samples: 3, weight: 3.0, scatter: [26.0, 7.0, 2.0], ..single };
        close(mean.roll_squares(), 9.0 + 25.0 + 100.0);
        close(mean.squares_about(0.0), 26.0);
        close(mean.squares_about(2.0), 1.0 + 1.0 + 4.0);
        close(single.squares_about(2.0), 0.0);
        close(single.roll_squares(), 36.0);
    }

    /// By hand: of ±0.1 nothing is left in means of two or four samples, so all of it is scatter, 0.01 each.
    /// One of two degrees of freedom remains in pairs, three of four in fours.
    #[test]
    fn what_the_means_do_not_contain_is_scatter() {
        for (samples, white) in [(2.0, 0.02), (4.0, 0.04 / 3.0)] {
            let mut scatter = Scatter::NONE;
            for _ in 0..100 {
                scatter.push(0.01 * samples, samples);
            }
            for _ in 0..2 {
                close(scatter.white_variance(9.0), white);
                scatter.forget(0.5);
            }
            close(scatter.white_variance(1e-3), 1e-3);
        }
        let mut single = Scatter::NONE;
        single.push(0.0, 1.0);
        close(single.white_variance(0.7), 0.7);
    }
}
