//! How the speed changes in turns, and before them.

use serde::{Deserialize, Serialize};

/// Time between samples after which filters begin anew, s.
pub(super) const GAP_S: f64 = 1.0;
/// Time constant of both filters of the speed from which the acceleration follows, s: an error of one step of 1 km/h is 0.1 m/s².
const SPEED_S: f64 = 1.0;
/// Time constant with which the square of the acceleration is forgotten, s.
const RECENT_S: f64 = 10.0;

/// The speed since the last maneuver. Means over it are weighted with the square of the lateral acceleration.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct SpeedChange {
    /// The time of the last speed, and the speed, and the same after one and after two filters.
    last: Option<(u64, f64)>,
    slow_mps: [f64; 2],
    /// Mean square of the acceleration in the last seconds.
    recent_square: f64,
    /// Weighted sums of time, of the change of speed, of the acceleration and its square, and of the recent acceleration.
    weighted_s: f64,
    changes_mps: f64,
    accelerations: f64,
    squares: f64,
    recent: f64,
    /// Whether the last lateral acceleration was yaw rate times speed.
    pub(super) by_yaw_rate: bool,
}

/// The acceleration along the road in a maneuver, m/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(clippy::struct_field_names)] // the unit stands in the names
pub(super) struct InTurns {
    /// Its mean, negative if the truck braked.
    pub(super) mean_mps2: f64,
    /// Its standard deviation.
    pub(super) sd_mps2: f64,
    /// The mean of its root mean square in the last seconds, also of the straight driving before.
    pub(super) recent_mps2: f64,
}

impl SpeedChange {
    /// Takes a speed and the lateral acceleration at that time.
    pub(super) fn push(&mut self, (time_us, speed_mps): (u64, f64), lateral_mps2: f64) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds_since = |past_us: u64| time_us.saturating_sub(past_us) as f64 * 1e-6;
        let last = self.last.replace((time_us, speed_mps));
        let last = last.map(|(past_us, past_mps)| (seconds_since(past_us), past_mps));
        let Some((passed_s, past_mps)) = last.filter(|(passed_s, _)| *passed_s <= GAP_S) else {
            (self.slow_mps, self.recent_square) = ([speed_mps; 2], 0.0);
            return;
        };
        if lateral_mps2.is_finite() {
            let share = passed_s / (SPEED_S + passed_s);
            let [once_mps, twice_mps] = &mut self.slow_mps;
            *once_mps += share * (speed_mps - *once_mps);
            *twice_mps += share * (*once_mps - *twice_mps);
            let acceleration_mps2 = (*once_mps - *twice_mps) / SPEED_S;
            let square = acceleration_mps2 * acceleration_mps2;
            let share = passed_s / (RECENT_S + passed_s);
            self.recent_square += share * (square - self.recent_square);
            let weight = lateral_mps2 * lateral_mps2;
            self.changes_mps += weight * (speed_mps - past_mps);
            let weight_s = weight * passed_s;
            self.weighted_s += weight_s;
            self.accelerations += weight_s * acceleration_mps2;
            self.squares += weight_s * square;
            self.recent += weight_s * self.recent_square.sqrt();
        }
    }

    /// Takes the end of a maneuver; zero without a lateral acceleration or a speed.
    pub(super) fn take(&mut self) -> InTurns {
        let Self { weighted_s, changes_mps, accelerations, squares, recent, .. } = *self;
        for sum in [
            &mut self.weighted_s,
            &mut self.changes_mps,
            &mut self.accelerations,
            &mut self.squares,
            &mut self.recent,
        ] {
            *sum = 0.0;
        }
        if !(weighted_s > 0.0) {
            return InTurns::default();
        }
        let [mean_mps2, filtered_mps2, square, recent_mps2] =
            [changes_mps, accelerations, squares, recent].map(|sum| sum / weighted_s);
        let sd_mps2 = (square - filtered_mps2 * filtered_mps2).max(0.0).sqrt();
        InTurns { mean_mps2, sd_mps2, recent_mps2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thirty seconds, of which the last twelve are a turn, with this acceleration.
    fn driven(step: usize, acceleration_mps2: impl Fn(f64) -> f64) -> InTurns {
        let mut speed = SpeedChange::default();
        let mut speed_mps = 20.0;
        for k in (0..1500_u32).step_by(step) {
            let time_s = f64::from(k) / 50.0;
            #[allow(clippy::cast_precision_loss)] // dozens
            let passed_s = step as f64 / 50.0;
            speed_mps += passed_s * acceleration_mps2(time_s);
            let lateral_mps2 = if time_s < 18.0 { 0.0 } else { 1.0 };
            speed.push((u64::from(k) * 20_000, speed_mps), lateral_mps2);
        }
        let found = speed.take();
        assert_eq!(speed.take(), InTurns::default(), "each maneuver begins anew");
        found
    }

    /// A turn that loses 6 m/s in 12 seconds. The speed of the straight driving before it does not count, nor does a gap.
    #[test]
    fn the_mean_is_that_of_the_turn() {
        let braking = |gain: f64| {
            move |time_s: f64| match time_s {
                0.0..10.0 => -1.0,
                20.0..26.0 => -gain,
                _ => 0.0,
            }
        };
        assert!((driven(1, braking(1.0)).mean_mps2 + 0.5).abs() < 0.003);
        assert!((driven(1, braking(-1.0)).mean_mps2 - 0.5).abs() < 0.003);
        assert_eq!(driven(60, braking(1.0)), InTurns::default());
    }

    /// Braking into a turn and accelerating out of it has a mean of zero. Of 0.6 m/s² in two thirds of the time, the standard deviation is
    /// 0.49, and after two filters of 1 s, integrated numerically, 0.332.
    #[test]
    fn braking_in_and_accelerating_out_is_no_steady_speed() {
        let found = driven(1, |time_s| match time_s {
            18.0..22.0 => -0.6,
            26.0.. => 0.6,
            _ => 0.0,
        });
        assert!(
            found.mean_mps2.abs() < 0.003 && (found.sd_mps2 - 0.332).abs() < 0.005,
            "{found:?}"
        );
    }

    /// 0.6 m/s² for six seconds before the turn are `0.6 √(1 − e^(−0.6))` = 0.40 at its beginning, of which `(1 − e^(−0.6))/0.6` = 0.75
    /// are left in the mean of 12 s, less what the filters are late. What they leave in the turn is `0.6 (1 + t) e^(−t)`, with a mean
    /// of 0.1 m/s², a mean square of 0.0375 and so a standard deviation of 0.166.
    #[test]
    fn what_was_before_the_turn_is_remembered() {
        let found = driven(1, |time_s| if (12.0..18.0).contains(&time_s) { -0.6 } else { 0.0 });
        assert!(
            (found.recent_mps2 - 0.30).abs() < 0.03 && (found.sd_mps2 - 0.166).abs() < 0.005,
            "{found:?}"
        );
        assert_eq!(driven(1, |_| 0.0), InTurns::default());
    }
}
