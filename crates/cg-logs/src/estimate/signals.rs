//! Checks of a log that do not use the roll angle: agreement of the signals, and gaps in time.
//!
//! Lateral acceleration and yaw rate times speed measure the same quantity. If a log has both, a
//! wrong sign, unit or gain of one of them is visible without any model of the truck.

use cg_core::Sample;

/// Time constant of the filter before the comparison. It removes noise and keeps turns.
const FILTER_S: f64 = 0.5;
/// Speed below which the yaw rate is not used, m/s.
const LEAST_MPS: f64 = 3.0;
/// Minimum standard deviation of yaw rate times speed for a comparison, m/s².
const EXCITED_MPS2: f64 = 0.3;
/// Minimum number of rows for a comparison.
const LEAST_ROWS: f64 = 100.0;
/// Tolerance of the slope around one: the gains of two good sensors, and side slip.
const TOLERANCE: f64 = 0.15;
/// Relative difference within which a slope is attributed to a known fault.
const NEAR: f64 = 0.1;
/// Longest interval between two rows that the estimator accepts, s.
const GAP_S: f64 = 0.5;

/// Running means and sums of products of two signals.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    mean: [f64; 2],
    /// Sums of the squares of the first signal, of the products, and of the squares of the second
    /// signal, about the means.
    sums: [f64; 3],
}

impl Pair {
    fn push(&mut self, rows: f64, [x, y]: [f64; 2]) {
        let before = [x - self.mean[0], y - self.mean[1]];
        self.mean[0] += before[0] / rows;
        self.mean[1] += before[1] / rows;
        let after = [x - self.mean[0], y - self.mean[1]];
        self.sums[0] += before[0] * after[0];
        self.sums[1] += before[0] * after[1];
        self.sums[2] += before[1] * after[1];
    }

    /// Slope of the second signal with respect to the first.
    fn slope(&self) -> f64 {
        self.sums[1] / self.sums[0]
    }
}

/// Checks the samples of one log.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SignalCheck {
    last_us: Option<u64>,
    /// Yaw rate times speed, lateral acceleration and roll, filtered.
    smooth: Option<[f64; 3]>,
    rows: f64,
    /// Lateral acceleration, and roll, as functions of yaw rate times speed.
    lateral: Pair,
    roll: Pair,
    all_rows: u64,
    gaps: u64,
    longest_gap_s: f64,
}

impl SignalCheck {
    pub(super) fn push(&mut self, sample: &Sample<f64>) {
        self.all_rows += 1;
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let interval_s = self
            .last_us
            .map_or(0.0, |last_us| sample.time_us.saturating_sub(last_us) as f64 * 1e-6);
        self.last_us = Some(sample.time_us);
        if interval_s > GAP_S {
            self.gaps += 1;
            self.longest_gap_s = self.longest_gap_s.max(interval_s);
            self.smooth = None;
        }
        let sample = sample.checked();
        let turn_mps2 = sample.yaw_rate_radps * sample.speed_mps;
        let found = [turn_mps2, sample.lateral_acceleration_mps2, sample.roll_rad];
        // This form of the condition also excludes NaN. A log without a roll sensor uses its tilt.
        if !(sample.speed_mps > LEAST_MPS) || found[..2].iter().any(|x| x.is_nan()) {
            return;
        }
        let share = interval_s / (FILTER_S + interval_s);
        let smooth = self.smooth.get_or_insert(found);
        for (smooth, found) in smooth.iter_mut().zip(found) {
            if found.is_finite() {
                *smooth += (found - *smooth) * share;
            }
        }
        let [turn, lateral, roll] = *smooth;
        self.rows += 1.0;
        self.lateral.push(self.rows, [turn, lateral]);
        if roll.is_finite() {
            self.roll.push(self.rows, [turn, roll]);
        }
    }

    /// The contradiction between lateral acceleration and yaw rate times speed, if there is one.
    pub(super) fn contradiction(&self, gravity_mps2: f64) -> Option<String> {
        let spread_mps2 = (self.lateral.sums[0] / self.rows).sqrt();
        let enough = self.rows >= LEAST_ROWS && spread_mps2 > EXCITED_MPS2;
        // Only yaw rate times speed must vary enough. A lateral acceleration in g, or one that is
        // nearly zero, is compared too.
        if !enough {
            return None;
        }
        let slope = self.lateral.slope();
        if (slope - 1.0).abs() <= TOLERANCE {
            return None;
        }
        let body = 1.0 + gravity_mps2 * self.roll.slope();
        let degree = 1_f64.to_radians();
        let near = |known: f64| (slope / known - 1.0).abs() < NEAR;
        let cause = if near(-1.0) {
            "one of the two is reversed (⟨flip lateral_acceleration⟩ or ⟨flip yaw_rate⟩)"
        } else if near(1.0 / gravity_mps2) {
            "the lateral acceleration is in g (⟨columns lateral_acceleration=NAME[g]⟩)"
        } else if near(degree) {
            "the yaw rate is in degrees per second (⟨columns yaw_rate=NAME[degps]⟩)"
        } else if near(1.0 / 3.6) {
            "the speed is in km/h (⟨columns speed=NAME[kmh]⟩)"
        } else if near(body) {
            "the lateral acceleration comes from an accelerometer fixed to the body, which also \
             measures gravity when the body rolls (remove its column, so that yaw rate and speed \
             are used instead)"
        } else {
            "the gain of one of them is wrong"
        };
        Some(format!(
            "the lateral acceleration is {slope:.2} times the product of yaw rate and speed, but \
             should be equal to it: {cause}"
        ))
    }

    /// A message on the intervals between rows.
    pub(super) fn clock(&self) -> Option<String> {
        if self.gaps == 0 {
            return None;
        }
        let Self { gaps, all_rows, longest_gap_s, .. } = self;
        Some(if gaps * 2 > *all_rows {
            format!(
                "most rows are more than {GAP_S} s apart (up to {longest_gap_s:.1} s): at least ten \
                 rows per second are needed; check that the time is in seconds"
            )
        } else {
            format!(
                "{gaps} gaps of more than {GAP_S} s between rows (the longest is \
                 {longest_gap_s:.1} s): each gap ends a maneuver"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lateral acceleration of a weaving truck at 15 m/s as two sensors measure it.
    fn checked(lateral: impl Fn(f64) -> f64, yaw_gain: f64) -> Option<String> {
        let mut check = SignalCheck::default();
        for k in 0..4000_u64 {
            #[allow(clippy::cast_precision_loss)]
            let true_mps2 = (k as f64 * 0.01 * 0.5).sin();
            let mut sample = Sample::absent(k * 10_000);
            sample.speed_mps = 15.0;
            sample.yaw_rate_radps = yaw_gain * true_mps2 / 15.0;
            sample.lateral_acceleration_mps2 = lateral(true_mps2);
            sample.roll_rad = 0.03 * true_mps2;
            check.push(&sample);
        }
        check.contradiction(9.81)
    }

    #[test]
    fn two_good_sensors_agree_whatever_their_offsets() {
        assert_eq!(checked(|a| a, 1.0), None);
        assert_eq!(checked(|a| 1.05 * a + 0.4, 0.97), None);
    }

    #[test]
    fn each_fault_is_named() {
        let named = |told: Option<String>, word: &str| {
            let told = told.unwrap();
            assert!(told.contains(word), "{told}");
        };
        named(checked(|a| -a, 1.0), "reversed");
        named(checked(|a| a / 9.81, 1.0), "in g");
        named(checked(|a| a, 1_f64.to_degrees()), "degrees per second");
        named(checked(|a| a, 3.6), "km/h");
        named(checked(|a| a * (1.0 + 9.81 * 0.03), 1.0), "gravity");
        named(checked(|a| 0.6 * a, 1.0), "gain");
    }

    #[test]
    fn without_a_turn_nothing_is_said() {
        assert_eq!(checked(|_| 0.5, 0.05), None);
    }

    #[test]
    fn rows_too_far_apart_are_told() {
        let mut check = SignalCheck::default();
        for k in 0..100_u64 {
            check.push(&Sample::absent(k * 1_000_000));
        }
        assert!(check.clock().unwrap().contains("most rows are more than 0.5 s apart"));
    }
}
