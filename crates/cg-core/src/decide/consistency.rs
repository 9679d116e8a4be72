//! Detects roll angles that cannot be true.
//!
//! If a sensor is at the end of its range, is stuck, or has a dead band, its value is constant
//! except for a little noise while the truck continues to roll. The value of a sensor with a coarse
//! resolution is also constant, but only between two of its steps.

use crate::decide::signals::seconds;
use crate::math::real::Real;

/// The roll angle counts as constant while it changes by less than this share of the expected
/// motion. It is a seventh of the longest permitted standstill. During such a standstill, a roll
/// angle that is merely late changes by a third.
const CONSTANT_SHARE: f64 = 0.02;
/// Time constant of a first-order lag of the input, similar to that of the roll motion of trailers.
const LAG_S: f64 = 0.5;
/// Number of its own smallest steps during which the value of a coarse sensor may be constant.
const CONSTANT_STEPS: f64 = 3.0;
/// Greatest difference of the expected angles due to noise of the input, in standard deviations of
/// the noise after the lag. In a minute there are about a hundred independent values; their range is five
/// standard deviations and hardly ever above seven. The model passes up to three times the
/// variance (a resonance at 4 rad/s with a damping ratio of 0.3), so both views have 1.4 times as much.
const NOISE_RANGE: f64 = 10.0;
/// Rows that are kept for a model that is late: those of 0.3 s, or of 0.25 s at 20 Hz, the densest that are not means of several.
const PAST: usize = 5;

/// The reason why the roll angle of a maneuver is rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Inconsistency<T> {
    /// The reduced model does not explain the roll angle at the identified gain.
    Misfit {
        /// Root mean square of the unexplained part, divided by the standard deviation of the roll
        /// angle.
        share: T,
    },
    /// The roll angle falls behind the expected one as it grows, because the sensor reaches the end
    /// of its range.
    Bent {
        /// The part by which the greatest roll angle is too small, as a share of it.
        share: T,
    },
    /// The roll angle was constant while the truck must have rolled further.
    Standstill {
        /// The constant roll angle, radians.
        roll_rad: T,
    },
}

/// Compares the roll angle during a maneuver with two expected roll angles: the response of the
/// reduced model to the input, and the input after a first-order lag.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RollSensorCheck<T> {
    time_us: u64,
    lagged_rad: T,
    /// The roll angles and the lagged inputs of the rows before this one, the newest first.
    past_rad: [[T; 2]; PAST],
    /// Least and greatest values since the roll angle has been constant: of the roll angle and of
    /// both expected angles. The mean of both expected ranges is used, because a wrong model
    /// overshoots where the truck does not, and the lag is late where a motion ends.
    constant_range_rad: [T; 2],
    expected_ranges_rad: [[T; 2]; 2],
    /// Least and greatest lagged input of the whole maneuver.
    input_range_rad: [T; 2],
    /// The greatest motion that was expected while the roll angle was constant, and that roll
    /// angle.
    standstill_motion_rad: T,
    standstill_roll_rad: T,
    least_step_rad: T,
}

/// The range with this value; an absent one begins with it.
fn extended<T: Real>([low, high]: [T; 2], x: T) -> [T; 2] {
    [if x >= low { low } else { x }, if x <= high { high } else { x }]
}

/// What a row shows of a roll angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown<T> {
    pub(crate) time_us: u64,
    pub(crate) roll_rad: T,
    /// The smallest difference between successive values of the sensor that is not zero; `None` if there is none.
    pub(crate) step_rad: Option<T>,
    /// The roll angle expected by the input, and by the reduced model.
    pub(crate) input_rad: T,
    pub(crate) model_rad: T,
    /// By how much the latter is late, because the model has lags.
    pub(crate) late_s: T,
}

impl<T: Real> RollSensorCheck<T> {
    /// The check before the first row of a maneuver.
    pub(crate) fn new() -> Self {
        Self {
            time_us: 0,
            lagged_rad: T::absent(),
            past_rad: [[T::absent(); 2]; PAST],
            constant_range_rad: [T::absent(); 2],
            expected_ranges_rad: [[T::absent(); 2]; 2],
            input_range_rad: [T::absent(); 2],
            standstill_motion_rad: T::zero(),
            standstill_roll_rad: T::absent(),
            least_step_rad: T::one() / T::zero(),
        }
    }

    /// Whether it has a row.
    pub(crate) fn has_begun(&self) -> bool {
        self.lagged_rad.present()
    }

    /// Adds the next row.
    pub(crate) fn push(&mut self, shown: &Shown<T>) {
        let Shown { time_us, roll_rad, step_rad, input_rad, model_rad, late_s } = *shown;
        let begins = !self.has_begun();
        if begins {
            (self.time_us, self.lagged_rad) = (time_us, input_rad);
        }
        let interval_s: T = seconds(time_us.saturating_sub(self.time_us));
        self.time_us = time_us;
        self.lagged_rad += (input_rad - self.lagged_rad) * interval_s / (T::of(LAG_S) + interval_s);
        if let Some(step_rad) = step_rad
            && step_rad < self.least_step_rad
            && !begins
        {
            self.least_step_rad = step_rad;
        }
        // Where the roll angle turns round, one that is expected later would go on, as if the sensor stood still.
        let [roll_rad, lagged_rad] =
            self.when_late([roll_rad, self.lagged_rad], interval_s, late_s);
        let expected_rad = [lagged_rad, model_rad];
        self.input_range_rad = extended(self.input_range_rad, self.lagged_rad);
        if !roll_rad.present() {
            return;
        }
        self.constant_range_rad = extended(self.constant_range_rad, roll_rad);
        if self.constant_range_rad[1] - self.constant_range_rad[0]
            > T::of(CONSTANT_SHARE) * (self.input_range_rad[1] - self.input_range_rad[0])
        {
            (self.constant_range_rad, self.expected_ranges_rad) =
                ([roll_rad; 2], expected_rad.map(|angle_rad| [angle_rad; 2]));
        }
        let mut motion_rad = T::zero();
        for (range, angle_rad) in self.expected_ranges_rad.iter_mut().zip(expected_rad) {
            *range = extended(*range, angle_rad);
            motion_rad += T::of(0.5) * (range[1] - range[0]);
        }
        if motion_rad > self.standstill_motion_rad {
            (self.standstill_motion_rad, self.standstill_roll_rad) = (motion_rad, roll_rad);
        }
    }

    /// Returns the angles of the row that is `late_s` before this one, to half a row, and keeps those of this one. They are absent if
    /// that is before the first.
    fn when_late(&mut self, now_rad: [T; 2], interval_s: T, late_s: T) -> [T; 2] {
        let (mut then_rad, mut moved_rad) = (now_rad, now_rad);
        let mut passed_s = T::of(0.5) * interval_s;
        for past_rad in &mut self.past_rad {
            core::mem::swap(past_rad, &mut moved_rad);
            if passed_s < late_s {
                then_rad = moved_rad;
            }
            passed_s += interval_s;
        }
        then_rad
    }

    /// The standard deviation of the mean roll angle due to the steps of a coarse sensor, as a
    /// share of the expected motion. `noise_sd_rad` is the standard deviation of the noise, steps
    /// included.
    ///
    /// While the roll angle is constant, its error can be up to half a step. If the noise is as
    /// large as a step, the measured angle varies over many steps and its mean is correct. The
    /// error then decreases as `exp(−2π² σ²/q²)`; here the slower `(1 + 2π² σ²/q²)⁻²` is used.
    pub(crate) fn step_share(&self, noise_sd_rad: T) -> T {
        let step = self.least_step_rad;
        let motion = self.input_range_rad[1] - self.input_range_rad[0];
        // This form of the condition returns zero if the roll angle or the expected angle never
        // changed.
        if !step.present() || !(motion > T::zero()) {
            return T::zero();
        }
        let twelfth = step * step / T::of(12.0);
        let dither = (noise_sd_rad * noise_sd_rad - twelfth).max(T::zero()) / (step * step);
        let carried =
            T::one() + T::of(2.0 * core::f64::consts::PI * core::f64::consts::PI) * dither;
        twelfth.root() / (carried * carried) / motion
    }

    /// Returns the standstill if the roll angle was constant for more than `share` of the expected
    /// motion, and for more than noise of the input, of this spectral density, can imitate.
    pub(crate) fn standstill(&self, share: T, input_noise_rad2_s: T) -> Option<Inconsistency<T>> {
        let noise_rad = (input_noise_rad2_s / T::of(2.0 * LAG_S)).root();
        let usual = share * (self.input_range_rad[1] - self.input_range_rad[0])
            + T::of(NOISE_RANGE) * noise_rad;
        let long = self.standstill_motion_rad > usual
            && !(self.standstill_motion_rad <= T::of(CONSTANT_STEPS) * self.least_step_rad);
        // A sensor whose value never changed has no step.
        let hangs = self.standstill_motion_rad > usual && !self.least_step_rad.present();
        (long || hangs).then_some(Inconsistency::Standstill { roll_rad: self.standstill_roll_rad })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A check that sees every value of a sensor.
    struct Watch {
        check: RollSensorCheck<f64>,
        before_rad: f64,
        late_s: f64,
    }

    impl Watch {
        fn new(time_us: u64, roll_rad: f64, input_rad: f64, model_rad: f64) -> Self {
            let late_s = 0.0;
            let first = Shown { time_us, roll_rad, step_rad: None, input_rad, model_rad, late_s };
            let mut check = RollSensorCheck::new();
            check.push(&first);
            Self { check, before_rad: roll_rad, late_s }
        }

        fn push(&mut self, time_us: u64, roll_rad: f64, input_rad: f64, model_rad: f64) {
            let step_rad = Some((roll_rad - self.before_rad).abs()).filter(|step| *step > 0.0);
            self.before_rad = roll_rad;
            let late_s = self.late_s;
            self.check.push(&Shown { time_us, roll_rad, step_rad, input_rad, model_rad, late_s });
        }

        fn standstill(&self, share: f64, noise_rad2_s: f64) -> Option<Inconsistency<f64>> {
            self.check.standstill(share, noise_rad2_s)
        }

        fn step_share(&self, noise_sd_rad: f64) -> f64 {
            self.check.step_share(noise_sd_rad)
        }
    }

    /// A turn to 2.5 degrees in 5 s, measured by a sensor with this characteristic.
    fn shown(sensor: impl Fn(f64) -> f64) -> Option<Inconsistency<f64>> {
        let mut check = Watch::new(0, sensor(0.0), 0.0, 0.0);
        for k in 1..=1000_u32 {
            let expected = 2.5 * (f64::from(k) / 500.0).min(1.0);
            check.push(10_000 * u64::from(k), sensor(1.1 * expected), expected, expected);
        }
        check.standstill(0.15, 0.0)
    }

    #[test]
    fn fine_and_coarse_sensors_are_believed() {
        assert_eq!(shown(|roll| roll), None);
        for step in [0.05, 0.2, 0.5] {
            assert_eq!(shown(|roll| (roll / step).round() * step), None, "{step}");
        }
    }

    /// A lane change of three seconds after another, 2.1 rad/s, at 20 Hz. The lag of the input is 0.8 rad, from which it is ahead by
    /// 0.2, and the model is late by 0.4 s, 0.84 rad. Where the roll angle turns round, within 2 % for 0.47 rad, both still move
    /// by a fifth of the motion in the mean.
    #[test]
    fn a_roll_angle_that_turns_round_does_not_stand_still() {
        let after = |late_s: f64, sensor: &dyn Fn(f64) -> f64| {
            let mut check = Watch { late_s, ..Watch::new(0, sensor(0.0), 0.0, 0.0) };
            for k in 1..=400_u32 {
                let at = |ahead_rad: f64| (2.1 * 0.05 * f64::from(k) + ahead_rad).sin();
                check.push(50_000 * u64::from(k), sensor(at(0.0)), at(0.2), at(-0.84));
            }
            check.standstill(0.15, 0.0)
        };
        assert_eq!(after(0.4, &|roll| roll), None);
        assert!(after(0.0, &|roll| roll).is_some());
        for sensor in
            [|roll: f64| roll.clamp(-0.6, 0.6), |roll: f64| roll - roll.clamp(-0.25, 0.25)]
        {
            assert!(after(0.4, &sensor).is_some());
        }
    }

    /// Time stamps so far apart that the lag has no effect.
    fn slow(k: u32) -> u64 {
        4_000_000_000 * u64::from(k)
    }

    /// Steps of 0.5 in a motion of 2.5 give 0.5/√12/2.5, unless noise moves the angle over several
    /// steps.
    #[test]
    fn coarse_steps_are_counted_unless_noise_carries_the_angle_over_them() {
        let mut check = Watch::new(0, 0.0, 0.0, 0.0);
        for k in 1..=50_u32 {
            let expected = f64::from(k) * 0.05;
            check.push(slow(k), (f64::from(k) * 0.1).round() * 0.5, expected, expected);
        }
        let (steps, motion) = (
            0.5 / 12.0_f64.sqrt(),
            check.check.input_range_rad[1] - check.check.input_range_rad[0],
        );
        assert!((motion - 2.5).abs() < 0.001);
        assert!((check.step_share(steps) - steps / motion).abs() < 1e-12);
        assert!(check.step_share(0.5_f64.hypot(steps)) < 0.003 * steps);
        assert!(check.step_share(0.0) > 0.0);
        assert!(Watch::new(0, 0.0, 0.0, 0.0).step_share(0.1) == 0.0);
    }

    #[test]
    fn the_end_of_a_range_and_a_hanging_sensor_are_seen() {
        assert_eq!(shown(|roll| roll.min(1.0)), Some(Inconsistency::Standstill { roll_rad: 1.0 }));
        let coarse = shown(|roll| ((roll / 0.1).round() * 0.1).min(1.5));
        assert!(matches!(coarse, Some(Inconsistency::Standstill { .. })));
        assert_eq!(shown(|_| 0.3), Some(Inconsistency::Standstill { roll_rad: 0.3 }));
        // The end of a range with a little noise added, and a dead band.
        let noise = |roll: f64| 0.01 * (1e4 * roll).sin();
        for limit in [1.0, 1.7] {
            let noisy = shown(|roll| roll.min(limit) + noise(roll));
            assert!(matches!(noisy, Some(Inconsistency::Standstill { .. })), "{limit}");
        }
        let dead = shown(|roll| (roll - 0.9).max(0.0));
        assert!(matches!(dead, Some(Inconsistency::Standstill { .. })));
        assert_eq!(shown(|roll| roll + noise(roll)), None);
    }

    /// The angle is constant during a share of the expected motion and follows it otherwise.
    #[test]
    fn a_seventh_of_the_motion_is_the_longest_standstill() {
        // Before and after, the angle also counts as constant within 2 % of the motion.
        for (share, hangs) in [(0.10, false), (0.16, true)] {
            let mut check = Watch::new(0, -1.0, -1.0, -1.0);
            for k in 1..=2000_u32 {
                let expected = f64::from(k) / 1000.0 - 1.0;
                let stands = expected > 0.3 && expected <= 0.3 + 2.0 * share;
                check.push(slow(k), if stands { 0.3 } else { expected }, expected, expected);
            }
            match check.standstill(0.15, 0.0) {
                Some(Inconsistency::Standstill { roll_rad }) => {
                    assert!(hangs && (roll_rad - 0.3).abs() < 0.04, "{share}: {roll_rad}");
                }
                found => assert!(!hangs && found.is_none(), "{share}: {found:?}"),
            }
        }
    }

    /// Steps of a tenth in a motion from 0 to 1. The angle is constant for 0.1 between two steps,
    /// and for 0.4 if three steps are left out.
    #[test]
    fn three_steps_are_the_longest_standstill_of_a_coarse_sensor() {
        for (left_out, hangs) in [(1, false), (3, true)] {
            let mut check = Watch::new(0, 0.0, 0.0, 0.0);
            for k in 1..=1000_u32 {
                let place = k / 100;
                let shown = if place > 4 && place <= 4 + left_out { 4 } else { place };
                let expected = f64::from(k) / 1000.0;
                check.push(slow(k), 0.1 * f64::from(shown), expected, expected);
            }
            assert_eq!(check.standstill(0.15, 0.0).is_some(), hangs, "{left_out}");
        }
    }

    /// The noise is √(σ² − q²/12) in addition to that of the steps. With σ² = q²/12 + q²/(2π²) it
    /// reduces the effect of the steps to a quarter.
    #[test]
    fn noise_of_a_step_carries_by_the_law_that_is_written_there() {
        let mut check = Watch::new(0, 0.0, -1.0, -1.0);
        for k in 1..=8_u32 {
            let expected = f64::from(k) / 4.0 - 1.0;
            check.push(slow(k), 0.25 * f64::from(k), expected, expected);
        }
        let q = 0.25_f64;
        let sd = q * (1.0 / 12.0 + 1.0 / (2.0 * core::f64::consts::PI.powi(2))).sqrt();
        let expected = q / 12.0_f64.sqrt() / 2.0 / 4.0;
        // The lag reduces the motion by 1.2e-4.
        assert!((check.step_share(sd) / expected - 1.0).abs() < 1e-3);
    }
}
