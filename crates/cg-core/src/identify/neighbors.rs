//! Neighboring samples are averaged before the filters.
//!
//! A truck rolls within seconds, so a sample that is a hundredth of a second later says little that its
//! neighbors do not say. Input and roll angle are therefore replaced by their means over a few samples, at
//! the mean of their times. The mean is linear and the same for both, so the means obey the transfer
//! function of the signals. A row that is made of them has the weight of its samples. What the means do
//! not contain is how much the samples scatter about them. For the roll angle that is nearly all of a
//! sensor's white noise, so it is kept as a number.

use crate::math::real::Real;

/// Samples are averaged over this time. In the band of usual maneuvers (up to ω = 6 rad/s) the signals
/// scatter about their means by `(ω τ)²/12` = 0.5 % of their square in it, which is the information that is
/// lost. It is slightly below a round number, so that rounding does not decide which sample is the last.
const MEAN_S: f64 = 0.0396;

/// Samples that are averaged at most.
const MOST_SAMPLES: u32 = 8;

/// The samples since the last mean: sums of input and roll angle minus those of the first sample, and of the
/// times since it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Neighbors<T> {
    samples: u32,
    /// How many of them are to be used.
    used: u32,
    weight: T,
    elapsed_s: T,
    first: [T; 2],
    time_s: T,
    times: T,
    time_squares: T,
    inputs: T,
    rolls: T,
    roll_squares: T,
    products: T,
    /// Time from the last mean to the last sample in it; `None` before the first mean.
    late_s: Option<T>,
}

/// The mean of some samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mean<T> {
    pub(crate) input: T,
    pub(crate) roll: T,
    /// Time since the mean before it.
    pub(crate) interval_s: T,
    /// Time since the last sample of the mean before it.
    pub(crate) elapsed_s: T,
    pub(crate) samples: u32,
    /// The number of samples.
    pub(crate) weight: T,
    /// Whether most of its samples are to be used.
    pub(crate) is_used: bool,
    /// Sum of the squares of the roll angle.
    pub(crate) roll_squares: T,
    /// Sums of squares and products about the means: of the roll angle, of roll angle and time, of the time.
    scatter: [T; 3],
}

impl<T: Real> Neighbors<T> {
    pub(crate) const NONE: Self = Self {
        samples: 0,
        used: 0,
        weight: T::ZERO,
        elapsed_s: T::ZERO,
        first: [T::ZERO; 2],
        time_s: T::ZERO,
        times: T::ZERO,
        time_squares: T::ZERO,
        inputs: T::ZERO,
        rolls: T::ZERO,
        roll_squares: T::ZERO,
        products: T::ZERO,
        late_s: None,
    };

    /// Adds the next sample, `interval_s` after the previous one. Returns `true` if the mean is complete.
    #[inline]
    pub(crate) fn push(&mut self, input: T, roll: T, interval_s: T, is_used: bool) -> bool {
        if self.samples == 0 {
            self.first = [input, roll];
        } else {
            self.time_s += interval_s;
            let [first_input, first_roll] = self.first;
            let roll = roll - first_roll;
            self.inputs += input - first_input;
            self.rolls += roll;
            self.roll_squares += roll * roll;
            self.times += self.time_s;
            self.time_squares += self.time_s * self.time_s;
            self.products += roll * self.time_s;
        }
        self.samples += 1;
        self.used += u32::from(is_used);
        self.weight += T::one();
        self.elapsed_s += interval_s;
        self.elapsed_s >= T::of(MEAN_S) || self.samples >= MOST_SAMPLES
    }

    /// The mean of the samples, which are then forgotten. There must be one.
    pub(crate) fn take(&mut self) -> Mean<T> {
        let [first_input, first_roll] = self.first;
        let share = T::one() / self.weight;
        let (time_s, roll) = (self.times * share, self.rolls * share);
        let late_s = self.time_s - time_s;
        // Before the first mean the truck was at rest for any time.
        let before_s = self.late_s.unwrap_or(late_s);
        let mean = Mean {
            input: first_input + self.inputs * share,
            roll: first_roll + roll,
            interval_s: self.elapsed_s + (before_s - late_s),
            elapsed_s: self.elapsed_s,
            samples: self.samples,
            weight: self.weight,
            is_used: 2 * self.used >= self.samples,
            roll_squares: self.weight * first_roll * first_roll
                + (first_roll + first_roll) * self.rolls
                + self.roll_squares,
            scatter: [
                self.roll_squares - self.rolls * roll,
                self.products - self.times * roll,
                self.time_squares - self.times * time_s,
            ],
        };
        *self = Self { late_s: Some(late_s), ..Self::NONE };
        mean
    }

    /// The samples so far are not to be used.
    pub(crate) fn pass_over(&mut self) {
        self.used = 0;
    }
}

impl<T: Real> Mean<T> {
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
        // This form of the comparison also serves without means (0/0), as at 25 samples a second.
        if within < variance { within.max(T::zero()) } else { variance }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;

    /// The means of samples that follow each other by these intervals; their input is the time.
    fn means(intervals_s: &[f64], roll: impl Fn(usize, f64) -> f64) -> Vec<Mean<f64>> {
        let (mut neighbors, mut means, mut time_s) = (Neighbors::NONE, Vec::new(), 0.0);
        for (k, interval_s) in intervals_s.iter().enumerate() {
            time_s += interval_s;
            if neighbors.push(time_s, roll(k, time_s), *interval_s, true) {
                means.push(neighbors.take());
            }
        }
        means
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn a_mean_is_complete_after_four_hundredths_of_a_second_or_eight_samples() {
        for (interval_s, each) in
            [(0.1, 1_u8), (0.04, 1), (0.03, 2), (0.02, 2), (0.01, 4), (0.001, 8)]
        {
            let means = means(&[interval_s; 8], |_, _| 0.0);
            assert_eq!(means.len(), 8 / usize::from(each));
            for mean in means {
                assert_eq!(mean.samples, u32::from(each));
                close(mean.weight, each.into());
                close(mean.elapsed_s, f64::from(each) * interval_s);
                close(mean.interval_s, mean.elapsed_s);
            }
        }
    }

    /// At 25 samples a second and less, nothing is changed.
    #[test]
    fn a_single_sample_is_its_own_mean_to_the_last_bit() {
        for interval_s in [0.04, 0.1_f64] {
            let mut neighbors = Neighbors::NONE;
            for k in 0..9 {
                let (input, roll) = (0.1 * f64::from(k), 0.7 - 0.3 * f64::from(k));
                assert!(neighbors.push(input, roll, interval_s, k != 3));
                let mean = neighbors.take();
                let found =
                    [mean.input, mean.roll, mean.interval_s, mean.elapsed_s, mean.roll_squares];
                let known = [input, roll, interval_s, interval_s, roll * roll];
                assert_eq!(found.map(f64::to_bits), known.map(f64::to_bits));
                assert_eq!((mean.is_used, mean.squares_about(0.3).to_bits()), (k != 3, 0));
            }
        }
    }

    /// The mean of the times of its samples is where a mean stands, whatever their intervals: of a line it
    /// is the line there, and nothing scatters.
    #[test]
    fn a_mean_stands_at_the_mean_of_the_times() {
        let intervals_s = [0.01, 0.013, 0.02, 0.004, 0.02, 0.03, 0.011, 0.012, 0.013, 0.014];
        let found = means(&intervals_s, |_, time_s| 0.5 - 2.0 * time_s);
        assert!(found.windows(2).any(|two| two[0].samples != two[1].samples));
        for two in found.windows(2) {
            close(two[1].interval_s, two[1].input - two[0].input);
        }
        for mean in found {
            close(mean.roll, 0.5 - 2.0 * mean.input);
            close(mean.squares_about(-2.0), 0.0);
            assert!(mean.squares_about(0.0) > 1e-6);
        }
    }

    /// By hand: of ±0.1 nothing is left in means of two or four samples, so all of it is scatter, 0.01 each.
    /// One of two degrees of freedom remains in pairs, three of four in fours.
    #[test]
    fn what_the_means_do_not_contain_is_scatter() {
        for (interval_s, white) in [(0.02, 0.02), (0.01, 0.04 / 3.0)] {
            let noise = |k, time_s| 3.0 + 0.5 * time_s + if k % 2 == 0 { 0.1 } else { -0.1 };
            let mut scatter = Scatter::NONE;
            for mean in means(&[interval_s; 400], noise) {
                // A motion of 0.5 per second, of which the noise takes a part for itself.
                let motion = mean.squares_about(0.5);
                close(motion, 0.01 * mean.weight);
                close(
                    mean.roll_squares,
                    mean.roll * mean.roll * mean.weight + mean.squares_about(0.0),
                );
                scatter.push(motion, mean.weight);
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

    #[test]
    fn a_mean_counts_if_at_least_half_of_its_samples_do() {
        for (used, counts) in [(0, false), (1, false), (2, true), (4, true)] {
            let mut neighbors = Neighbors::NONE;
            for k in 0..4 {
                neighbors.push(0.0, 0.0, 0.01, k < used);
            }
            assert_eq!(neighbors.take().is_used, counts, "{used}");
        }
        let mut cleared = Neighbors::NONE;
        for _ in 0..3 {
            cleared.push(0.0, 0.0, 0.01, true);
        }
        cleared.pass_over();
        assert!(cleared.push(0.0, 0.0, 0.01, true) && !cleared.take().is_used);
    }
}
