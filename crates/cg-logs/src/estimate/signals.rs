//! Whether the signals of a log fit each other and the clock, whatever the roll angle says.
//!
//! Lateral acceleration and yaw rate times speed are the same thing measured twice. Where a log has
//! both, a wrong sign, unit or gain of either shows without any model of the truck.

use cg_core::Sample;

/// Time constant of the filter before the comparison: noise out, turns kept.
const FILTER_S: f64 = 0.5;
/// Speed below which yaw rate says little.
const LEAST_MPS: f64 = 3.0;
/// Standard deviation of yaw rate times speed, m/s², without which there is nothing to compare.
const EXCITED_MPS2: f64 = 0.3;
/// Rows that a comparison needs.
const LEAST_ROWS: f64 = 100.0;
/// The slope may differ from one by this share: the gains of two good sensors, and side slip.
const TOLERANCE: f64 = 0.15;
/// How near a slope must be to that of a known fault to name it.
const NEAR: f64 = 0.1;
/// The longest interval between two rows that the estimator bridges.
const GAP_S: f64 = 0.5;

/// Running means of products of two signals.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    mean: [f64; 2],
    /// Sums of squares of the first, of products, of squares of the second, about the means.
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

    /// Slope of the second over the first.
    fn slope(&self) -> f64 {
        self.sums[1] / self.sums[0]
    }
}

/// Watches the samples of one log.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SignalCheck {
    last_us: Option<u64>,
    /// Yaw rate times speed, lateral acceleration and roll, filtered.
    smooth: Option<[f64; 3]>,
    rows: f64,
    /// Over yaw rate times speed: lateral acceleration, and roll.
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
        // Written so that NaN is left out too; a log without a roll sensor has its tilt instead.
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

    /// What is wrong between lateral acceleration and yaw rate times speed, if anything is.
    pub(super) fn contradiction(&self, gravity_mps2: f64) -> Option<String> {
        let spread_mps2 = (self.lateral.sums[0] / self.rows).sqrt();
        let enough = self.rows >= LEAST_ROWS && spread_mps2 > EXCITED_MPS2;
        // A lateral acceleration in g or hardly there excites nothing of its own: no matter.
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
            "the lateral acceleration is that of an accelerometer fixed to the body, which feels \
             gravity as the body rolls (leave its column out, so that yaw rate and speed serve \
             instead)"
        } else {
            "the gain of one of them is wrong"
        };
        Some(format!(
            "the lateral acceleration is {slope:.2} times yaw rate times speed, which it should \
             equal: {cause}"
        ))
    }

    /// What is to be said of the clock.
    pub(super) fn clock(&self) -> Option<String> {
        if self.gaps == 0 {
            return None;
        }
        let Self { gaps, all_rows, longest_gap_s, .. } = self;
        Some(if gaps * 2 > *all_rows {
            format!(
                "most rows are more than {GAP_S} s apart (up to {longest_gap_s:.1} s): ten rows a \
                 second or more are needed; is the time in seconds?"
            )
        } else {
            format!(
                "{gaps} holes of more than {GAP_S} s between rows (the longest {longest_gap_s:.1} \
                 s): each ends a maneuver"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Swings of the lateral acceleration at 15 m/s as two sensors show them.
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
