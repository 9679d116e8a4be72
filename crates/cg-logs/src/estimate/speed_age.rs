//! Rows whose last speed is too old.
//!
//! Between the speeds of a log the last one holds, for as long as on a bus. After that, neither the steer angle nor the yaw rate
//! determines a lateral acceleration: both are left out, as on a bus, until a speed comes again.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

/// The last speed, and the rows without one.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct SpeedAge {
    last_us: Option<u64>,
    rows: u64,
    first_us: Option<u64>,
}

impl SpeedAge {
    /// Takes a sample, and leaves out of it what it does not determine without a speed.
    #[inline]
    pub fn push(&mut self, sample: &mut Sample<f64>) {
        if Quantity::Speed.plausible(sample.speed_mps) {
            self.last_us = Some(sample.time_us);
        } else if self.last_us.is_some() && !self.holds(sample.time_us) {
            self.leave_out(sample);
        }
    }

    /// Whether the last speed still holds at a time.
    #[inline]
    pub(super) fn holds(&self, time_us: u64) -> bool {
        let serves = |us: u64| time_us.saturating_sub(us) <= Quantity::Speed.serves_us();
        self.last_us.is_some_and(serves)
    }

    #[cold]
    fn leave_out(&mut self, sample: &mut Sample<f64>) {
        let others = [
            sample.lateral_acceleration_mps2,
            sample.lateral_specific_force_mps2,
            sample.tractor_lateral_specific_force_mps2,
        ];
        let has_other = others.iter().any(|value| value.is_finite());
        let needing = [sample.steer_rad, sample.yaw_rate_radps];
        // On a bus they are absent already.
        if !has_other || needing.iter().any(|value| value.is_finite()) {
            self.rows += 1;
            self.first_us.get_or_insert(sample.time_us);
        }
        (sample.steer_rad, sample.yaw_rate_radps) = (f64::NAN, f64::NAN);
    }

    /// The number of rows without a speed and the time of the first, µs, if it is a hundredth of all rows.
    pub(super) fn gaps(&self, rows: u64) -> Option<(u64, u64)> {
        self.first_us.filter(|_| 100 * self.rows >= rows).map(|first_us| (self.rows, first_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A speed holds for 2.5 s; then steer angle and yaw rate are absent, and a lateral acceleration stays.
    #[test]
    fn what_needs_a_speed_is_left_out_without_one() {
        let mut age = SpeedAge::default();
        for (time_us, speed_mps, is_left_out) in [
            (0, f64::NAN, false), // the speed of the vehicle file, until there is one
            (9_000_000, f64::NAN, false),
            (10_000_000, 15.0, false),
            (12_500_000, f64::NAN, false),
            (12_500_001, f64::NAN, true),
            (90_000_000, 80.0, true), // impossible
            (91_000_000, 15.0, false),
            (92_000_000, f64::NAN, false),
        ] {
            let mut sample = Sample {
                speed_mps,
                steer_rad: 0.01,
                yaw_rate_radps: 0.1,
                lateral_acceleration_mps2: 1.5,
                ..Sample::absent(time_us)
            };
            age.push(&mut sample);
            let absent = [sample.steer_rad, sample.yaw_rate_radps].map(f64::is_nan);
            assert_eq!(absent, [is_left_out; 2], "{time_us}");
            assert!(sample.lateral_acceleration_mps2.is_finite());
        }
        let mut forces = Sample { lateral_acceleration_mps2: 1.5, ..Sample::absent(99_000_000) };
        age.push(&mut forces); // needs none
        assert_eq!(age.gaps(200), Some((2, 12_500_001)));
        assert_eq!(age.gaps(201), None);
    }
}
