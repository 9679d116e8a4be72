//! Neighboring samples are averaged before everything that is decided or identified from them.
//!
//! Only what single samples show is taken from them first: how much the roll angle scatters about its mean, which is the
//! white noise of its sensor, and its smallest step. See [`Mean`](crate::identify::mean::Mean) for the reasons.

use crate::decide::signals::{Averaged, seconds};
use crate::math::real::Real;

/// The mean of some samples in which the same signals are present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Together<T, S> {
    /// Time of the last sample, µs.
    pub last_us: u64,
    /// The mean.
    pub mean: S,
    /// What it is the mean of.
    pub of: Samples<T>,
}

/// The samples of a mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Samples<T> {
    /// Time of the first one, µs.
    pub first_us: u64,
    /// The mean of their times, µs.
    pub middle_us: u64,
    /// Their number, also as a number of the type of the signals.
    pub number: u32,
    pub(crate) weight: T,
    /// Of the trailer's roll angle, as in [`Mean::scatter`](crate::identify::mean::Mean::scatter).
    pub(crate) scatter: [T; 3],
    /// Smallest difference between two successive roll angles of the trailer that is not zero, if there is one.
    pub(crate) step_rad: Option<T>,
}

#[cfg(test)]
impl<T: Real> Samples<T> {
    /// A single sample.
    pub(crate) fn single(time_us: u64) -> Self {
        Self {
            first_us: time_us,
            middle_us: time_us,
            number: 1,
            weight: T::ONE,
            scatter: [T::ZERO; 3],
            step_rad: None,
        }
    }
}

/// What a mean has at most.
#[derive(Clone, Copy, Debug)]
pub struct Most {
    /// Number of samples.
    pub samples: u32,
    /// Their time, µs.
    pub mean_us: u32,
}

/// The samples since the last mean.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Neighbors<T, S> {
    first_us: u64,
    last_us: u64,
    /// Time between the last two samples, and since the last sample of the mean before; any time before the first mean.
    interval_us: u32,
    elapsed_us: u32,
    samples: u32,
    weight: T,
    /// Sums. The times are those since the first sample.
    sum: S,
    times_us: u32,
    times: T,
    time_squares: T,
    /// The roll angle of the first sample and of the last one that had any, and sums of differences to the first.
    first_rad: T,
    last_rad: Option<T>,
    rolls: T,
    roll_squares: T,
    products: T,
    step_rad: Option<T>,
}

impl<T: Real, S: Averaged<T>> Neighbors<T, S> {
    /// No samples yet.
    pub const NONE: Self = Self {
        first_us: 0,
        last_us: 0,
        interval_us: 0,
        elapsed_us: u32::MAX,
        samples: 0,
        weight: T::ZERO,
        sum: S::NONE,
        times_us: 0,
        times: T::ZERO,
        time_squares: T::ZERO,
        first_rad: T::ZERO,
        last_rad: None,
        rolls: T::ZERO,
        roll_squares: T::ZERO,
        products: T::ZERO,
        step_rad: None,
    };

    /// Whether the mean ends before the next sample: that has other signals, or comes much later.
    #[inline]
    pub fn ends_before(&self, time_us: u64, next: &S, most: Most) -> bool {
        self.ends_by(time_us, most)
            || self.samples > 0 && (!next.has_kinds_of(&self.sum) || self.is_complete(most))
    }

    /// Whether the mean ends before any sample at this time or later, because that comes much later.
    #[inline]
    pub fn ends_by(&self, time_us: u64, most: Most) -> bool {
        self.samples > 0 && self.until_us(time_us) >= most.mean_us / 2
    }

    /// Whether no sample is to be added. The first sample of a drive is a mean of its own.
    #[inline]
    pub fn is_complete(&self, most: Most) -> bool {
        // One that comes as late after the last one as that after the one before it would be beyond the time of a mean.
        let next_us = self.elapsed_us.saturating_add(self.interval_us);
        self.samples >= most.samples || next_us > most.mean_us
    }

    /// Time from the last sample to another one.
    fn until_us(&self, time_us: u64) -> u32 {
        u32::try_from(time_us.saturating_sub(self.last_us)).unwrap_or(u32::MAX)
    }

    /// Adds the next sample.
    pub fn add(&mut self, time_us: u64, next: &S) {
        let roll_rad = next.roll_rad();
        if self.samples == 0 {
            (self.first_us, self.first_rad) = (time_us, roll_rad);
            self.sum = *next;
        } else {
            let since_us = time_us.saturating_sub(self.first_us);
            let (time_s, more_rad) = (seconds::<T>(since_us), roll_rad - self.first_rad);
            self.sum.add(next);
            self.times_us = self.times_us.saturating_add(u32::try_from(since_us).unwrap_or(0));
            self.times += time_s;
            self.time_squares += time_s * time_s;
            self.rolls += more_rad;
            self.roll_squares += more_rad * more_rad;
            self.products += more_rad * time_s;
        }
        if roll_rad.present() {
            let before_rad = self.last_rad.replace(roll_rad).unwrap_or(roll_rad);
            let step_rad = (roll_rad - before_rad).abs();
            if step_rad > T::ZERO && self.step_rad.is_none_or(|least_rad| step_rad < least_rad) {
                self.step_rad = Some(step_rad);
            }
        }
        self.interval_us = self.until_us(time_us);
        self.elapsed_us = self.elapsed_us.saturating_add(self.interval_us);
        self.last_us = time_us;
        self.samples += 1;
        self.weight += T::ONE;
    }

    /// The mean of the samples so far, of which there must be one.
    pub fn take(&mut self) -> Together<T, S> {
        let share = T::ONE / self.weight;
        let (time_s, roll_rad) = (self.times * share, self.rolls * share);
        let middle_us = self.times_us.checked_div(self.samples).unwrap_or(0);
        let mean = Together {
            last_us: self.last_us,
            mean: self.sum.scaled(share),
            of: Samples {
                first_us: self.first_us,
                middle_us: self.first_us.saturating_add(u64::from(middle_us)),
                number: self.samples,
                weight: self.weight,
                scatter: [
                    self.roll_squares - self.rolls * roll_rad,
                    self.products - self.times * roll_rad,
                    self.time_squares - self.times * time_s,
                ],
                step_rad: self.step_rad,
            },
        };
        let Self { last_us, last_rad, .. } = *self;
        *self = Self { last_us, elapsed_us: 0, last_rad, ..Self::NONE };
        mean
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::decide::signals::{Seen, Signals};
    use crate::signal::sample::Sample;
    use crate::truck::channel::{Input, Output};

    /// The signals of a sample with this roll angle and steer angle.
    fn seen(roll_rad: f64, steer_rad: f64) -> Seen<f64> {
        let sample = Sample { steer_rad, roll_rad, ..Sample::absent(0) };
        Seen { signals: Signals::of(&sample, 10.0, 9.81), speed_mps: 10.0 + steer_rad }
    }

    /// Adds a sample as the estimator does.
    fn push(
        neighbors: &mut Neighbors<f64, Seen<f64>>,
        (time_us, next): (u64, &Seen<f64>),
        samples: u32,
    ) -> Option<Together<f64, Seen<f64>>> {
        let most = Most { samples, mean_us: 80_400 };
        let before = neighbors.ends_before(time_us, next, most).then(|| neighbors.take());
        neighbors.add(time_us, next);
        before.or_else(|| neighbors.is_complete(most).then(|| neighbors.take()))
    }

    /// The means of samples at these times; their steer angle is the time in seconds.
    fn means(
        times_us: &[u64],
        many: u32,
        roll: impl Fn(usize, f64) -> f64,
    ) -> Vec<Together<f64, Seen<f64>>> {
        let mut neighbors = Neighbors::NONE;
        let push = |(k, time_us): (usize, &u64)| {
            let time_s = seconds(*time_us);
            push(&mut neighbors, (*time_us, &seen(roll(k, time_s), time_s)), many)
        };
        times_us.iter().enumerate().filter_map(push).collect()
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    fn regular(interval_us: u64, samples: u64) -> Vec<u64> {
        (1..=samples).map(|k| k * interval_us).collect()
    }

    #[test]
    fn a_mean_is_complete_after_eight_hundredths_of_a_second_or_eight_samples() {
        for (interval_us, each) in [
            (100_000, 1_u8),
            (50_000, 1),
            (40_000, 2),
            (25_000, 3),
            (20_000, 4),
            (10_000, 8),
            (1000, 8),
        ] {
            // The first sample is alone.
            let found = means(&regular(interval_us, 25), 8, |_, _| 0.0);
            assert_eq!(found.len(), 1 + 24 / usize::from(each));
            for (mean, k) in found[1..].iter().zip(0..) {
                let each = u64::from(each);
                assert_eq!(u64::from(mean.of.number), each);
                assert_eq!(mean.of.first_us, (2 + k * each) * interval_us);
                assert_eq!(mean.last_us, (1 + (k + 1) * each) * interval_us);
                assert_eq!(2 * mean.of.middle_us, mean.of.first_us + mean.last_us);
                close(mean.of.weight, f64::from(mean.of.number));
            }
        }
        assert_eq!(means(&regular(1000, 17), 1, |_, _| 0.0).len(), 17);
    }

    /// At 20 samples a second and less, nothing is changed.
    #[test]
    fn a_single_sample_is_its_own_mean_to_the_last_bit() {
        let times_us = regular(50_000, 9);
        let found = means(&times_us, 8, |k, _| if k < 4 { 0.7 } else { 0.1 });
        assert_eq!(found.len(), 9);
        for (k, (mean, time_us)) in found.iter().zip(&times_us).enumerate() {
            let mut alone = Neighbors::NONE;
            alone.add(*time_us, &seen(if k < 4 { 0.7 } else { 0.1 }, seconds(*time_us)));
            let alone = alone.take();
            let step_rad = (k == 4).then_some(0.7 - 0.1);
            // As text, in which numbers are exact and NaN is NaN.
            let expected =
                std::format!("{:?}", Together { of: Samples { step_rad, ..alone.of }, ..alone });
            assert_eq!(std::format!("{mean:?}"), expected);
            assert!(mean.of.scatter.iter().all(|sum| sum.abs() <= 0.0));
        }
    }

    /// The mean of the times of its samples is where a mean stands, whatever their intervals: of a line it
    /// is the line there, and about the line nothing scatters.
    #[test]
    fn a_mean_stands_at_the_mean_of_the_times() {
        let intervals_us = [10, 14, 20, 4, 20, 30, 10, 12, 13, 14].map(|ms| 3000 * ms / 3);
        let times_us: Vec<u64> = intervals_us
            .iter()
            .scan(0, |time_us, interval_us| {
                *time_us += interval_us;
                Some(*time_us)
            })
            .collect();
        let found = means(&times_us, 8, |_, time_s| 0.5 - 2.0 * time_s);
        assert!(found.windows(2).any(|two| two[0].of.number != two[1].of.number));
        for mean in found {
            let [steer, roll] =
                [mean.mean.signals.input(Input::Steer), mean.mean.signals.output(Output::Roll)];
            close(roll, 0.5 - 2.0 * steer);
            close(mean.mean.speed_mps, 10.0 + steer);
            // The time is a whole number of microseconds.
            assert!((seconds::<f64>(mean.of.middle_us) - steer).abs() < 1e-6);
            let [rolls, products, times] = mean.of.scatter;
            close(rolls + 4.0 * products + 4.0 * times, 0.0);
            assert!(mean.of.number == 1 || rolls > 1e-5);
        }
    }

    /// By hand: 3, 5 and 10 at 0, 10 and 20 ms.
    #[test]
    fn scatter_and_step_are_those_of_the_samples() {
        let rolls = [9.0, 3.0, 5.0, 10.0, 10.0];
        let found = means(&regular(10_000, 5), 3, |k, _| rolls[k]);
        let [three] = found[1..] else { unreachable!() };
        let [squares, products, times] = three.of.scatter;
        close(squares, 9.0 + 1.0 + 16.0);
        close(products, 0.07);
        close(times, 2e-4);
        assert_eq!(three.of.step_rad, Some(2.0));
    }

    /// A sample in which other signals are present, or that comes late, is in no mean with those before it.
    #[test]
    fn what_differs_is_apart() {
        let mut neighbors = Neighbors::NONE;
        let mut numbers = Vec::new();
        for (time_us, roll_rad) in [
            (0, 0.1),
            (10_000, 0.1),
            (20_000, f64::NAN),
            (30_000, f64::NAN),
            (40_000, 0.1),
            (50_000, 0.1),
            (100_000, 0.1),
            (110_000, 0.1),
        ] {
            let mean = push(&mut neighbors, (time_us, &seen(roll_rad, 0.0)), 8);
            numbers.extend(mean.map(|mean| (time_us, mean.last_us, mean.of.number)));
        }
        let expected = [
            (0, 0, 1),
            (20_000, 10_000, 1),
            (40_000, 30_000, 2),
            (100_000, 50_000, 2),
            (110_000, 100_000, 1),
        ];
        assert_eq!(numbers, expected);
        assert_eq!(neighbors.take().last_us, 110_000);
    }
}
