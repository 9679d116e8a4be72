//! Whether the roll angle can be what the sensor says.
//!
//! A sensor at the end of its range, one that hangs, or one that says nothing of small angles shows
//! the same number, but for a little noise, while the truck rolls on. A coarse one does so too, but
//! only from one of its steps to the next.

use crate::decide::condition::seconds;
use crate::math::real::Real;

/// Share of the expected motion within which the roll angle counts as standing: a seventh of what it
/// may stand for, where a roll angle that follows late still moves by a third.
const STILL: f64 = 0.02;
/// Time constant of a first-order lag of the input, about that of rolling trailers.
const LAG_S: f64 = 0.5;
/// How many of its own least steps a coarse sensor may stand still for.
const STEPS: f64 = 3.0;

/// Why a maneuver cannot be believed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Inconsistency<T> {
    /// The reduced model, at the identified gain, misses the roll angle.
    Misfit {
        /// Root mean square of what it misses, over that of the roll about its mean.
        share: T,
    },
    /// The roll angle falls behind the expected one as it grows: the sensor comes to the end of its
    /// range.
    Bent {
        /// What the bend takes from the roll angle at its greatest, as a share.
        share: T,
    },
    /// The roll angle stood still while the truck must have rolled on.
    Standstill {
        /// Where it stood, radians.
        roll_rad: T,
    },
}

/// Watches the rows of a maneuver: the roll angle beside two views of what it must be, the reduced
/// model's answer to the input and the input through a first-order lag.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watch<T> {
    time_us: u64,
    roll_rad: T,
    lagged_rad: T,
    /// Since the roll angle has stood: its own least and greatest, and those of both views. A model
    /// that is wrong overshoots where the truck does not, a lag is behind where the motion ends: the
    /// mean of both ways counts.
    stood: [T; 2],
    standing: [[T; 2]; 2],
    /// Least and greatest of the lagged input over the whole maneuver.
    all: [T; 2],
    /// The longest way that was expected while the roll angle stood still, and where.
    still_rad: T,
    still_at_rad: T,
    least_step_rad: T,
}

fn with<T: Real>([low, high]: [T; 2], x: T) -> [T; 2] {
    [low.min(x), high.max(x)]
}

impl<T: Real> Watch<T> {
    /// From the first row on.
    pub(crate) fn new(time_us: u64, roll_rad: T, input_rad: T, model_rad: T) -> Self {
        Self {
            time_us,
            roll_rad,
            lagged_rad: input_rad,
            stood: [roll_rad; 2],
            standing: [[input_rad; 2], [model_rad; 2]],
            all: [input_rad; 2],
            still_rad: T::zero(),
            still_at_rad: roll_rad,
            least_step_rad: T::one() / T::zero(),
        }
    }

    /// Takes in the next row.
    pub(crate) fn push(&mut self, time_us: u64, roll_rad: T, input_rad: T, model_rad: T) {
        let interval_s: T = seconds(time_us.saturating_sub(self.time_us));
        self.time_us = time_us;
        self.lagged_rad += (input_rad - self.lagged_rad) * interval_s / (T::of(LAG_S) + interval_s);
        let step_rad = (roll_rad - self.roll_rad).abs();
        self.roll_rad = roll_rad;
        if step_rad > T::zero() {
            self.least_step_rad = self.least_step_rad.min(step_rad);
        }
        let views = [self.lagged_rad, model_rad];
        self.all = with(self.all, self.lagged_rad);
        self.stood = with(self.stood, roll_rad);
        if self.stood[1] - self.stood[0] > T::of(STILL) * (self.all[1] - self.all[0]) {
            (self.stood, self.standing) = ([roll_rad; 2], views.map(|view| [view; 2]));
        }
        let mut way_rad = T::zero();
        for (range, view) in self.standing.iter_mut().zip(views) {
            *range = with(*range, view);
            way_rad += T::of(0.5) * (range[1] - range[0]);
        }
        if way_rad > self.still_rad {
            (self.still_rad, self.still_at_rad) = (way_rad, roll_rad);
        }
    }

    /// Standard deviation that the steps of a coarse sensor leave in its mean, as a share of the
    /// expected motion, beside noise of `noise_sd_rad` (steps included).
    ///
    /// Where the roll angle rests, half a step either way cannot be told. Noise that is as great as a
    /// step carries the angle over many of them, and their mean is right again: the error falls as
    /// `exp(−2π² σ²/q²)`, here as the slower `(1 + 2π² σ²/q²)⁻²`.
    pub(crate) fn step_share(&self, noise_sd_rad: T) -> T {
        let step = self.least_step_rad;
        let motion = self.all[1] - self.all[0];
        // Written so that an angle that never moved, or nothing expected, has no steps.
        if !step.present() || !(motion > T::zero()) {
            return T::zero();
        }
        let twelfth = step * step / T::of(12.0);
        let dither = (noise_sd_rad * noise_sd_rad - twelfth).max(T::zero()) / (step * step);
        let carried =
            T::one() + T::of(2.0 * core::f64::consts::PI * core::f64::consts::PI) * dither;
        twelfth.root() / (carried * carried) / motion
    }

    /// Where the roll angle stood still for more than `share` of the expected motion, if it did.
    pub(crate) fn standstill(&self, share: T) -> Option<Inconsistency<T>> {
        let usual = share * (self.all[1] - self.all[0]);
        let long =
            self.still_rad > usual && !(self.still_rad <= T::of(STEPS) * self.least_step_rad);
        // A sensor that never moved has no step.
        let hangs = self.still_rad > usual && !self.least_step_rad.present();
        (long || hangs).then_some(Inconsistency::Standstill { roll_rad: self.still_at_rad })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn to 2.5 degrees in 5 s, as a sensor shows it.
    fn shown(sensor: impl Fn(f64) -> f64) -> Option<Inconsistency<f64>> {
        let mut watch = Watch::new(0, sensor(0.0), 0.0, 0.0);
        for k in 1..=1000_u32 {
            let expected = 2.5 * (f64::from(k) / 500.0).min(1.0);
            watch.push(10_000 * u64::from(k), sensor(1.1 * expected), expected, expected);
        }
        watch.standstill(0.15)
    }

    #[test]
    fn fine_and_coarse_sensors_are_believed() {
        assert_eq!(shown(|roll| roll), None);
        for step in [0.05, 0.2, 0.5] {
            assert_eq!(shown(|roll| (roll / step).round() * step), None, "{step}");
        }
    }

    /// Rows so far apart that the lag does not count.
    fn slow(k: u32) -> u64 {
        4_000_000_000 * u64::from(k)
    }

    /// Steps of 0.5 in a motion of 2.5: 0.5/√12/2.5, unless noise carries the angle over them.
    #[test]
    fn coarse_steps_are_counted_unless_noise_carries_the_angle_over_them() {
        let mut watch = Watch::new(0, 0.0, 0.0, 0.0);
        for k in 1..=50_u32 {
            let expected = f64::from(k) * 0.05;
            watch.push(slow(k), (f64::from(k) * 0.1).round() * 0.5, expected, expected);
        }
        let (steps, motion) = (0.5 / 12.0_f64.sqrt(), watch.all[1] - watch.all[0]);
        assert!((motion - 2.5).abs() < 0.001);
        assert!((watch.step_share(steps) - steps / motion).abs() < 1e-12);
        assert!(watch.step_share(0.5_f64.hypot(steps)) < 0.003 * steps);
        assert!(watch.step_share(0.0) > 0.0);
        assert!(Watch::new(0, 0.0, 0.0, 0.0).step_share(0.1) == 0.0);
    }

    #[test]
    fn the_end_of_a_range_and_a_hanging_sensor_are_seen() {
        assert_eq!(shown(|roll| roll.min(1.0)), Some(Inconsistency::Standstill { roll_rad: 1.0 }));
        let coarse = shown(|roll| ((roll / 0.1).round() * 0.1).min(1.5));
        assert!(matches!(coarse, Some(Inconsistency::Standstill { .. })));
        assert_eq!(shown(|_| 0.3), Some(Inconsistency::Standstill { roll_rad: 0.3 }));
        // The same with a little noise on top, and a dead band.
        let noise = |roll: f64| 0.01 * (1e4 * roll).sin();
        for limit in [1.0, 1.7] {
            let noisy = shown(|roll| roll.min(limit) + noise(roll));
            assert!(matches!(noisy, Some(Inconsistency::Standstill { .. })), "{limit}");
        }
        let dead = shown(|roll| (roll - 0.9).max(0.0));
        assert!(matches!(dead, Some(Inconsistency::Standstill { .. })));
        assert_eq!(shown(|roll| roll + noise(roll)), None);
    }

    /// An angle that stands while a share of the expected motion goes by, then follows it.
    #[test]
    fn a_seventh_of_the_motion_is_the_longest_standstill() {
        // Within 2 % of the motion it still counts as standing, before and after.
        for (share, hangs) in [(0.10, false), (0.16, true)] {
            let mut watch = Watch::new(0, -1.0, -1.0, -1.0);
            for k in 1..=2000_u32 {
                let expected = f64::from(k) / 1000.0 - 1.0;
                let stands = expected > 0.3 && expected <= 0.3 + 2.0 * share;
                watch.push(slow(k), if stands { 0.3 } else { expected }, expected, expected);
            }
            match watch.standstill(0.15) {
                Some(Inconsistency::Standstill { roll_rad }) => {
                    assert!(hangs && (roll_rad - 0.3).abs() < 0.04, "{share}: {roll_rad}");
                }
                found => assert!(!hangs && found.is_none(), "{share}: {found:?}"),
            }
        }
    }

    /// Steps of a tenth of a motion from 0 to 1: between two of them go 0.1, and 0.4 where three are
    /// left out.
    #[test]
    fn three_steps_are_the_longest_standstill_of_a_coarse_sensor() {
        for (left_out, hangs) in [(1, false), (3, true)] {
            let mut watch = Watch::new(0, 0.0, 0.0, 0.0);
            for k in 1..=1000_u32 {
                let place = k / 100;
                let shown = if place > 4 && place <= 4 + left_out { 4 } else { place };
                let expected = f64::from(k) / 1000.0;
                watch.push(slow(k), 0.1 * f64::from(shown), expected, expected);
            }
            assert_eq!(watch.standstill(0.15).is_some(), hangs, "{left_out}");
        }
    }

    /// √(σ² − q²/12) beside the steps' own noise: with σ² = q²/12 + q²/(2π²) they count a quarter.
    #[test]
    fn noise_of_a_step_carries_by_the_law_that_is_written_there() {
        let mut watch = Watch::new(0, 0.0, -1.0, -1.0);
        for k in 1..=8_u32 {
            let expected = f64::from(k) / 4.0 - 1.0;
            watch.push(slow(k), 0.25 * f64::from(k), expected, expected);
        }
        let q = 0.25_f64;
        let sd = q * (1.0 / 12.0 + 1.0 / (2.0 * core::f64::consts::PI.powi(2))).sqrt();
        let expected = q / 12.0_f64.sqrt() / 2.0 / 4.0;
        // The lag leaves 1.2e-4 of the way out.
        assert!((watch.step_share(sd) / expected - 1.0).abs() < 1e-3);
    }
}
