//! Checks that samples are frequent enough to represent a motion.

use cg_core::{Quantity, Sample};

/// Greatest interval between samples of the same motion, µs. The estimator ends a maneuver at a
/// longer one.
const GREATEST_US: u64 = 500_000;
/// At longer intervals a signal is not slow but intermittent, µs.
const PAUSE_US: u64 = 10_000_000;
/// Number of consecutive long intervals that make a signal slow.
const SLOW_STEPS: u32 = 3;

/// The rate of a signal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cadence {
    last_us: Option<u64>,
    slow_steps: u32,
    /// Whether the last value came too late after the previous one.
    pub(crate) late: bool,
    reported: bool,
}

impl Cadence {
    /// Adds a value. Returns the interval in seconds if the signal is too slow, this lasts for some
    /// values, and it has not been reported.
    pub(crate) fn push(&mut self, now_us: u64) -> Option<f64> {
        let step_us = self.last_us.replace(now_us).map(|last_us| now_us.saturating_sub(last_us));
        self.late = step_us.is_some_and(|step_us| step_us > GREATEST_US);
        match step_us {
            Some(step_us) if (GREATEST_US + 1..PAUSE_US).contains(&step_us) => self.slow_steps += 1,
            _ => self.slow_steps = 0,
        }
        if self.slow_steps < SLOW_STEPS || std::mem::replace(&mut self.reported, true) {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // seconds
        step_us.map(|step_us| step_us as f64 * 1e-6)
    }
}

/// The message about a signal that is too slow.
pub(crate) fn too_slow(step_s: f64) -> String {
    format!(
        "one value every {step_s:.2} s is too slow to be used: at least two per second are needed, \
         ten or more are better; increase the rate of the sensor or the logger"
    )
}

/// Passes on only samples that are close to another sample.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    cadence: Cadence,
    /// A sample after a pause. It is used if another sample follows soon.
    lone: Option<Sample<f64>>,
}

impl Pace {
    /// Adds a sample. Returns the samples that can be used now, and the interval in seconds if it
    /// is to be reported.
    pub(crate) fn push(&mut self, sample: Sample<f64>) -> ([Option<Sample<f64>>; 2], Option<f64>) {
        let first = self.cadence.last_us.is_none();
        let slow_step_s = self.cadence.push(sample.time_us);
        if first || self.cadence.late {
            self.lone = Some(sample);
            ([None, None], slow_step_s)
        } else {
            ([self.lone.take(), Some(sample)], slow_step_s)
        }
    }
}

/// The quantities that determine the motion of the truck at an instant. All others change slowly.
pub(crate) const MOTION: [Quantity; 17] = [
    Quantity::Steer,
    Quantity::SteeringWheel,
    Quantity::Roll,
    Quantity::RollToGravity,
    Quantity::Tilt,
    Quantity::AxleTilt,
    Quantity::SuspensionRoll,
    Quantity::LevelLeft,
    Quantity::LevelRight,
    Quantity::LateralAcceleration,
    Quantity::LateralSpecificForce,
    Quantity::TractorSuspensionRoll,
    Quantity::TractorLateralSpecificForce,
    Quantity::TractorTilt,
    Quantity::TractorLevelLeft,
    Quantity::TractorLevelRight,
    Quantity::YawRate,
];

/// The signal whose values became this sample: the first of the aligner's order that is present.
pub(crate) fn pacing(sample: &Sample<f64>) -> &'static str {
    let signals = [
        (sample.roll_rad, Quantity::Roll),
        (sample.roll_to_gravity_rad, Quantity::RollToGravity),
        (sample.tilt_rad, Quantity::Tilt),
        (sample.suspension_roll_rad, Quantity::SuspensionRoll),
    ];
    let present = signals.into_iter().find(|(value, _)| value.is_finite());
    present.map_or(Quantity::TractorSuspensionRoll, |(_, quantity)| quantity).name()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_one_a_second_never_pass_and_are_told_once() {
        let mut pace = Pace::default();
        let mut reported = Vec::new();
        for second in 0..100 {
            let (passed, slow) = pace.push(Sample::absent(1_000_000 * (second + 1)));
            assert_eq!(passed, [None, None]);
            reported.extend(slow);
        }
        assert_eq!(reported, [1.0]);
    }

    #[test]
    fn after_a_pause_the_first_sample_waits_for_the_second() {
        let mut pace = Pace::default();
        let mut passed = Vec::new();
        for us in [10_000, 20_000, 30_000, 5_000_000, 60_000_000, 60_010_000] {
            let (samples, slow_step_s) = pace.push(Sample::absent(us));
            assert_eq!(slow_step_s, None);
            passed.extend(samples.into_iter().flatten().map(|sample| sample.time_us));
        }
        assert_eq!(passed, [10_000, 20_000, 30_000, 60_000_000, 60_010_000]);
    }

    /// Three consecutive intervals of more than half a second and less than ten seconds.
    #[test]
    fn a_signal_is_slow_after_three_long_intervals() {
        let reported = |steps_us: &[u64]| {
            let mut cadence = Cadence::default();
            let mut now_us = 5;
            let mut reported = vec![cadence.push(now_us)];
            for step_us in steps_us {
                now_us += step_us;
                reported.push(cadence.push(now_us));
            }
            reported.into_iter().flatten().collect::<Vec<f64>>()
        };
        let nothing: [f64; 0] = [];
        assert_eq!(reported(&[700_000; 2]), nothing);
        assert_eq!(reported(&[700_000; 3]), [0.7]);
        assert_eq!(reported(&[700_000, 700_000, 2_000_000, 900_000]), [2.0]);
        assert_eq!(reported(&[700_000, 700_000, 100_000, 700_000, 700_000]), nothing);
        assert_eq!(reported(&[10_000_000; 5]), nothing);
        assert_eq!(reported(&[499_999; 5]), nothing);
    }

    #[test]
    fn a_value_is_late_after_more_than_half_a_second() {
        let mut cadence = Cadence::default();
        for (now_us, late) in [
            (1_000_000, false),
            (1_500_000, false),
            (2_000_001, true),
            (2_100_000, false),
            (20_000_000, true),
            (19_000_000, false),
        ] {
            cadence.push(now_us);
            assert_eq!(cadence.late, late, "{now_us}");
        }
    }

    #[test]
    fn the_first_sample_waits_for_the_second() {
        let mut pace = Pace::default();
        let mut passed = |us| pace.push(Sample::absent(us)).0.map(|one| one.map(|one| one.time_us));
        assert_eq!(passed(1_000_000), [None, None]);
        assert_eq!(passed(1_500_000), [Some(1_000_000), Some(1_500_000)]);
        assert_eq!(passed(2_000_000), [None, Some(2_000_000)]);
    }

    #[test]
    fn the_message_names_the_interval() {
        assert!(too_slow(0.7).starts_with("one value every 0.70 s is too slow"));
    }
}
