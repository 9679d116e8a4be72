//! Leaves out single angles that are far from the one before and do not stay: a frame with a wrong bit, a sensor that restarts.
//!
//! One roll angle of 0.3 rad among two thousand makes a height 5 % wrong.

use cg_core::Sample;
use serde::{Deserialize, Serialize};

/// Change from row to row beyond which an angle must stay to be taken, rad, and what a truck adds to it per second. The noise of
/// a roll sensor is a tenth of it, and a truck that rolls over has 0.6 rad/s.
const FAR_RAD: f64 = 0.12;
const RATE_RADPS: f64 = 1.0;
/// How long they must stay, µs.
const STAYS_US: u64 = 200_000;
/// Time without a value after which any is taken, s.
const GAP_S: f64 = 0.5;

/// Number of angles that are looked at.
const ANGLES: usize = 5;

/// Where they are in a sample.
#[inline]
fn angles(sample: &mut Sample<f64>) -> [&mut f64; ANGLES] {
    let Sample {
        steer_rad,
        roll_rad,
        roll_to_gravity_rad,
        suspension_roll_rad,
        tractor_suspension_roll_rad,
        ..
    } = sample;
    [steer_rad, roll_rad, roll_to_gravity_rad, suspension_roll_rad, tractor_suspension_roll_rad]
}

/// What is known of an angle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Angle {
    /// Time and value of the last one that was taken; NaN if there is none.
    taken_us: u64,
    taken_rad: f64,
    /// When others came after it that were left out, and the last of them.
    left_out: Option<(u64, f64)>,
}

impl Default for Angle {
    fn default() -> Self {
        Self { taken_us: 0, taken_rad: f64::NAN, left_out: None }
    }
}

impl Angle {
    /// Whether a value is to be taken. Nearly all are.
    #[inline]
    fn takes(&mut self, time_us: u64, value_rad: f64) -> bool {
        let is_near = (value_rad - self.taken_rad).abs() <= FAR_RAD;
        let is_taken = is_near || self.takes_far(time_us, value_rad);
        if is_taken {
            *self = Self { taken_us: time_us, taken_rad: value_rad, left_out: None };
        }
        is_taken
    }

    /// Whether one that is far from the last one, or the first, is to be taken.
    #[cold]
    fn takes_far(&mut self, time_us: u64, value_rad: f64) -> bool {
        #[allow(clippy::cast_precision_loss)] // less than a second, or any long time
        let since_s = |then_us: u64| time_us.saturating_sub(then_us) as f64 * 1e-6;
        let passed_s = since_s(self.taken_us);
        let can_be = self.taken_rad.is_nan()
            || passed_s > GAP_S
            || (value_rad - self.taken_rad).abs() <= RATE_RADPS.mul_add(passed_s, FAR_RAD);
        let near_left_out =
            self.left_out.filter(|(_, rad)| (value_rad - rad).abs() <= FAR_RAD).map(|(us, _)| us);
        let stays = near_left_out.is_some_and(|us| time_us >= us + STAYS_US);
        self.left_out = Some((near_left_out.unwrap_or(time_us), value_rad));
        can_be || stays
    }
}

/// Leaves out the spikes of a drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Spikes {
    angles: [Angle; ANGLES],
    /// How many angles were left out.
    pub(crate) count: u32,
}

impl Spikes {
    /// Makes a spike absent.
    pub(crate) fn leave_out(&mut self, sample: &mut Sample<f64>) {
        let time_us = sample.time_us;
        for (angle, value_rad) in self.angles.iter_mut().zip(angles(sample)) {
            if value_rad.is_finite() && !angle.takes(time_us, *value_rad) {
                *value_rad = f64::NAN;
                self.count = self.count.saturating_add(1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The roll angles that are taken of these, 20 ms apart.
    fn taken(rolls_rad: &[f64]) -> (Vec<bool>, u32) {
        let mut spikes = Spikes::default();
        let take = |(k, roll_rad): (usize, &f64)| {
            let mut sample = Sample::absent(20_000 * u64::try_from(k).unwrap());
            (sample.roll_rad, sample.suspension_roll_rad) = (*roll_rad, 0.01);
            spikes.leave_out(&mut sample);
            assert!(!sample.suspension_roll_rad.is_nan() && sample.steer_rad.is_nan());
            !sample.roll_rad.is_nan()
        };
        let taken = rolls_rad.iter().enumerate().map(take).collect();
        (taken, spikes.count)
    }

    #[test]
    fn a_value_that_does_not_stay_is_left_out() {
        // One, two to different sides, and one that returns to what was.
        let (all, count) = taken(&[0.01, 0.02, 0.3, 0.02, 0.3, -0.4, 0.01, 0.0]);
        assert_eq!(all, [true, true, false, true, false, false, true, true]);
        assert_eq!(count, 3);
    }

    /// A truck that rolls over, a sensor that is reset, noise, and values after a gap.
    #[test]
    fn what_stays_or_can_be_is_taken() {
        let over: Vec<f64> = (0..50).map(|k| 0.6 * 0.02 * f64::from(k)).collect();
        assert_eq!(taken(&over).1, 0);
        // For 0.2 s are ten intervals.
        let (all, count) = taken(&[&[0.0, 0.01], &[0.6; 12][..]].concat());
        assert_eq!((&all[10..], count), (&[false, false, true, true][..], 10));
        let noise: Vec<f64> = (0..50).map(|k| if k % 2 == 0 { 0.05 } else { -0.05 }).collect();
        assert_eq!(taken(&noise).1, 0);
        let gap: Vec<f64> =
            (0..30).map(|k| if k == 0 || k == 29 { 0.3 } else { f64::NAN }).collect();
        assert_eq!(taken(&gap).1, 0);
        let turned = [&gap[..29], &[-0.3]].concat();
        assert_eq!(taken(&turned).1, 0);
    }
}
