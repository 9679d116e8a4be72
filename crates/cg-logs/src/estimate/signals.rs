//! Checks of a log that do not use the roll angle: agreement of the signals, and gaps in time.
//!
//! Lateral acceleration and yaw rate times speed measure the same quantity. If a log has both, a
//! wrong sign, unit or gain of one of them is visible without any model of the truck.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::pair::Pair;

/// Time constant of the filter before the comparison. It removes noise and keeps turns.
const FILTER_S: f64 = 0.5;
/// Speed below which the yaw rate is not used, m/s.
const LEAST_MPS: f64 = 3.0;
/// Least radius of a turn, m: in a tighter one the trailer stands at an angle to the tractor, whose yaw rate times speed is
/// then not its lateral acceleration.
pub(super) const LEAST_RADIUS_M: f64 = 30.0;
/// Minimum standard deviation of yaw rate times speed for a comparison, m/s².
const EXCITED_MPS2: f64 = 0.3;
/// Minimum number of rows for a comparison.
const LEAST_ROWS: f64 = 100.0;
/// Tolerance of the slope around one: the gains of two good sensors, and side slip.
const TOLERANCE: f64 = 0.15;
/// What is added to it for the square of the frequency of the motion, s²/rad². The side slip of a truck that moves fast changes,
/// which is a part of its lateral acceleration: a sixth of it in a lane change of 3 s at 80 km/h (2 rad/s).
const FAST_S2: f64 = 0.05;
/// By how much a lateral acceleration must be too great to be told as one that may also measure gravity: two standard deviations of
/// the gains of two good sensors, 3 % each; and how near it must be to what gravity adds, as a share of that.
const FELT: f64 = 0.085;
const LIKELY: f64 = 0.35;
/// Least interval between two rows that are compared: what is faster says nothing more, s.
const STEP_S: f64 = 0.0396;
/// Relative difference within which a slope is attributed to a known fault.
const NEAR: f64 = 0.1;
/// Longest interval between two rows that the estimator accepts, s.
const GAP_S: f64 = 0.5;
/// Time of compared rows after which what was seen before counts for half, s.
const REMEMBERED_S: f64 = 3600.0;

/// Whether a turn is too tight by yaw rate times speed and by lateral acceleration, m/s²: a wrong unit makes one of them alone so.
pub(super) fn is_tight(speed_mps: f64, [turn, lateral]: &[f64; 2]) -> bool {
    let least_mps2 = speed_mps * speed_mps / LEAST_RADIUS_M;
    turn.abs() > least_mps2 && lateral.abs() > least_mps2
}

/// Checks the samples of one log.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct SignalCheck {
    last_us: Option<u64>,
    /// The last row that was compared.
    taken_us: Option<u64>,
    /// Yaw rate times speed, lateral acceleration and roll, filtered.
    smooth: Option<[f64; 3]>,
    rows: f64,
    seconds: f64,
    /// Compared rows in turns, and rows in turns that are too tight.
    turning_rows: f64,
    tight_rows: f64,
    /// Sum of the squares of the rate of yaw rate times speed, filtered.
    rates: f64,
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
        let since_s =
            |past_us: Option<u64>| Some(sample.time_us.saturating_sub(past_us?) as f64 * 1e-6);
        let gap_s = since_s(self.last_us.replace(sample.time_us)).unwrap_or(0.0);
        if gap_s > GAP_S {
            self.gaps += 1;
            self.longest_gap_s = self.longest_gap_s.max(gap_s);
            self.smooth = None;
        }
        let interval_s = since_s(self.taken_us);
        if interval_s.is_some_and(|interval_s| interval_s < STEP_S) {
            return;
        }
        self.taken_us = Some(sample.time_us);
        let interval_s = interval_s.unwrap_or(0.0);
        // A log without a roll sensor uses its tilt.
        let of = |quantity: Quantity, x: f64| if quantity.plausible(x) { x } else { f64::NAN };
        let speed_mps = of(Quantity::Speed, sample.speed_mps);
        let found = [
            of(Quantity::YawRate, sample.yaw_rate_radps) * speed_mps,
            of(Quantity::LateralAcceleration, sample.lateral_acceleration_mps2),
            of(Quantity::Roll, sample.roll_rad),
        ];
        // This form of the condition also excludes NaN.
        if is_tight(speed_mps, &[found[0], found[1]]) {
            self.tight_rows += 1.0;
            return;
        }
        if !(speed_mps > LEAST_MPS) || found[..2].iter().any(|x| x.is_nan()) {
            return;
        }
        let share = interval_s / (FILTER_S + interval_s);
        let smooth = self.smooth.get_or_insert(found);
        let [before, ..] = *smooth;
        for (smooth, found) in smooth.iter_mut().zip(found) {
            if found.is_finite() {
                *smooth += (found - *smooth) * share;
            }
        }
        let [turn, lateral, roll] = *smooth;
        let rate = (turn - before) / interval_s.max(STEP_S);
        self.rates += rate * rate;
        self.turning_rows += f64::from(u8::from(turn.abs() > EXCITED_MPS2));
        self.rows += 1.0;
        self.seconds += interval_s.min(GAP_S);
        self.lateral.push(self.rows, [turn, lateral]);
        if roll.is_finite() {
            self.roll.push(self.rows, [turn, roll]);
        }
        if self.seconds > REMEMBERED_S {
            (self.rows, self.seconds) = (0.5 * self.rows, 0.5 * self.seconds);
            self.rates *= 0.5;
            self.lateral.forget_half();
            self.roll.forget_half();
        }
    }

    /// Time of the compared rows, s.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Whether the rows are enough for a comparison.
    fn is_enough(&self) -> bool {
        let spread_mps2 = (self.lateral.square() / self.rows).sqrt();
        let enough = self.rows >= LEAST_ROWS && spread_mps2 > EXCITED_MPS2;
        // The beginning and the end of a tight turn alone have lags.
        enough && self.turning_rows > self.tight_rows
    }

    /// How far the slope of two good sensors can be from one.
    fn tolerance(&self) -> f64 {
        TOLERANCE + FAST_S2 * self.rates / self.lateral.square()
    }

    /// Whether the lateral acceleration is that of yaw rate and speed, and nearer to it than one that also measures gravity
    /// would be.
    pub(super) fn confirms_lateral(&self, gravity_mps2: f64) -> bool {
        let off = (self.lateral.slope() - 1.0).abs();
        self.is_enough() && off < TOLERANCE && 2.0 * off < gravity_mps2 * self.roll.slope().abs()
    }

    /// That the lateral acceleration may be one that also measures gravity: it is as much too great as that, and the gains of two good
    /// sensors could hardly explain it.
    pub(super) fn may_feel_gravity(&self, gravity_mps2: f64) -> Option<String> {
        let (slope, by_gravity) = (self.lateral.slope(), gravity_mps2 * self.roll.slope());
        let off = slope - 1.0;
        let is_great = self.is_enough() && off > FELT + self.tolerance() - TOLERANCE;
        // A contradiction names its cause itself.
        let may_feel = is_great && self.wrong_gain().is_none();
        (may_feel && (off - by_gravity).abs() < LIKELY * by_gravity).then(|| {
            format!(
                "the lateral acceleration is {slope:.2} times the product of yaw rate and speed, and one that also measures gravity \
                 when the body rolls would be {:.2} times it: if it comes from an accelerometer fixed to the body, remove its \
                 column, so that yaw rate and speed are used instead",
                1.0 + by_gravity
            )
        })
    }

    /// The lateral acceleration over yaw rate times speed, if the gains of two good sensors cannot explain it.
    fn wrong_gain(&self) -> Option<f64> {
        // Only yaw rate times speed must vary enough. A lateral acceleration in g, or one that is
        // nearly zero, is compared too.
        let slope = Some(self.lateral.gain()).filter(|_| self.is_enough());
        slope.filter(|slope| !((slope - 1.0).abs() <= self.tolerance()))
    }

    /// The contradiction between lateral acceleration and yaw rate times speed, if there is one.
    pub(super) fn contradiction(&self, gravity_mps2: f64) -> Option<String> {
        let slope = self.wrong_gain()?;
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
    fn weaving(lateral: impl Fn(f64) -> f64, yaw_gain: f64, roll: f64) -> SignalCheck {
        let mut check = SignalCheck::default();
        for k in 0..4000_u64 {
            #[allow(clippy::cast_precision_loss)]
            let true_mps2 = (k as f64 * 0.01 * 0.5).sin();
            let mut sample = Sample::absent(k * 10_000);
            sample.speed_mps = 15.0;
            sample.yaw_rate_radps = yaw_gain * true_mps2 / 15.0;
            sample.lateral_acceleration_mps2 = lateral(true_mps2);
            sample.roll_rad = roll * true_mps2;
            check.push(&sample);
        }
        check
    }

    fn checked(lateral: impl Fn(f64) -> f64, yaw_gain: f64) -> Option<String> {
        weaving(lateral, yaw_gain, 0.03).contradiction(9.81)
    }

    /// A truck that rolls by 0.013 rad for each m/s² has 13 % of gravity in a body-fixed accelerometer, which is within the
    /// tolerance of gains.
    #[test]
    fn a_yaw_rate_confirms_the_lateral_acceleration() {
        let confirmed =
            |lateral: fn(f64) -> f64| weaving(lateral, 1.0, 0.013).confirms_lateral(9.81);
        assert!(confirmed(|a| a) && confirmed(|a| 1.04 * a + 0.1));
        assert!(!confirmed(|a| a * (1.0 + 9.81 * 0.013)) && !confirmed(|a| -a));
        assert!(!weaving(|a| a, 0.05, 0.013).confirms_lateral(9.81));
    }

    /// Of a light trailer gravity is as much as gains of two standard deviations, and is told; of one that hardly rolls, or of gains that
    /// are not near it, it is not.
    #[test]
    fn a_lateral_acceleration_that_may_feel_gravity_is_told() {
        let told = |gain: f64, roll: f64| {
            let check = weaving(|a| gain * a, 1.0, roll);
            assert_eq!(check.contradiction(9.81), None, "{gain} {roll}");
            check.may_feel_gravity(9.81)
        };
        let message = told(1.13, 0.013).unwrap();
        assert!(message.contains("1.13 times the product") && message.contains("be 1.13 times it"));
        assert!(told(1.1, 0.013).is_some() && told(1.14, 0.011).is_some());
        for (gain, roll) in
            [(1.0, 0.013), (1.08, 0.009), (1.12, 0.03), (1.14, 0.008), (0.88, 0.013)]
        {
            assert_eq!(told(gain, roll), None, "{gain} {roll}");
        }
        // Of more gravity the contradiction says it.
        assert_eq!(weaving(|a| 1.29 * a, 1.0, 0.03).may_feel_gravity(9.81), None);
    }

    #[test]
    fn two_good_sensors_agree_whatever_their_offsets() {
        assert_eq!(checked(|a| a, 1.0), None);
        assert_eq!(checked(|a| 1.05 * a + 0.4, 0.97), None);
    }

    #[test]
    fn each_fault_is_named() {
        let named = |message: Option<String>, word: &str| {
            let message = message.unwrap();
            assert!(message.contains(word), "{message}");
        };
        named(checked(|a| -a, 1.0), "reversed");
        named(checked(|a| a / 9.81, 1.0), "in g");
        named(checked(|a| a, 1_f64.to_degrees()), "degrees per second");
        named(checked(|a| a, 3.6), "km/h");
        named(checked(|a| a * (1.0 + 9.81 * 0.03), 1.0), "gravity");
        named(checked(|a| 0.6 * a, 1.0), "gain");
    }

    /// A lane change, in which a fifth of the lateral acceleration is missing, and a slow turn, in which that is a fault.
    #[test]
    fn a_fast_motion_has_side_slip() {
        let told = |rate: f64| {
            let mut check = SignalCheck::default();
            for k in 0..2000_u64 {
                #[allow(clippy::cast_precision_loss)]
                let turn_mps2 = (k as f64 * 0.01 * rate).sin();
                let mut sample = sample(k * 10_000, turn_mps2);
                sample.lateral_acceleration_mps2 *= 0.8;
                check.push(&sample);
            }
            check.contradiction(9.81)
        };
        assert_eq!(told(2.0), None);
        assert!(told(0.5).unwrap().contains("0.80 times"));
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

    /// Slope 2.5 by hand: means 2 and 4, sums of squares 8 and of products 20.
    #[test]
    fn a_slope_is_that_of_the_least_squares_line() {
        let mut pair = Pair::default();
        for (rows, point) in [(1.0, [0.0, 0.0]), (2.0, [2.0, 2.0]), (3.0, [4.0, 10.0])] {
            pair.push(rows, point);
        }
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        near(pair.mean[0], 2.0);
        near(pair.mean[1], 4.0);
        near(pair.sums[0], 8.0);
        near(pair.sums[1], 20.0);
        near(pair.slope(), 2.5);
    }

    /// A sample at 20 m/s with this lateral acceleration by both sensors.
    fn sample(time_us: u64, lateral_mps2: f64) -> Sample<f64> {
        let mut sample = Sample::absent(time_us);
        (sample.speed_mps, sample.yaw_rate_radps) = (20.0, lateral_mps2 / 20.0);
        sample.lateral_acceleration_mps2 = lateral_mps2;
        sample.roll_rad = 0.1 * lateral_mps2;
        sample
    }

    /// After an interval of 0.5 s the share is 1/2, after 0.25 s 1/3; a longer interval starts
    /// again.
    #[test]
    fn the_filter_answers_a_step_by_its_time_constant() {
        let mut check = SignalCheck::default();
        for (time_us, found, smooth) in
            [(0, 0.0, 0.0), (500_000, 3.0, 1.5), (750_000, 3.0, 2.0), (1_250_001, 6.0, 6.0)]
        {
            check.push(&sample(time_us, found));
            let [turn, lateral, roll] = check.smooth.unwrap();
            for (value, expected) in [(turn, smooth), (lateral, smooth), (roll, 0.1 * smooth)] {
                assert!((value - expected).abs() < 1e-12, "{time_us} µs: {value}");
            }
        }
        assert!((check.rows - 4.0).abs() < 1e-12);
        assert!((check.lateral.mean[1] - 9.5 / 4.0).abs() < 1e-12);
    }

    #[test]
    fn slow_or_incomplete_rows_are_not_compared() {
        let compared = |change: fn(&mut Sample<f64>)| {
            let mut check = SignalCheck::default();
            let mut sample = sample(0, 1.0);
            change(&mut sample);
            check.push(&sample);
            (check.rows > 0.0, check.roll.mean[1] > 0.0)
        };
        assert_eq!(compared(|_| ()), (true, true));
        assert_eq!(compared(|sample| sample.speed_mps = 3.01), (true, true));
        assert_eq!(compared(|sample| sample.speed_mps = 3.0), (false, false));
        assert_eq!(compared(|sample| sample.speed_mps = f64::NAN), (false, false));
        assert_eq!(compared(|sample| sample.yaw_rate_radps = f64::NAN), (false, false));
        assert_eq!(compared(|sample| sample.lateral_acceleration_mps2 = 31.0), (false, false));
        assert_eq!(compared(|sample| sample.roll_rad = f64::NAN), (true, false));
    }

    /// What is said about a log with these statistics; the roll angle is 0.03 rad per m/s².
    fn gain_message(rows: f64, sd_mps2: f64, slope: f64) -> Option<String> {
        let square = rows * sd_mps2 * sd_mps2;
        let pair = |slope: f64| Pair {
            mean: [0.0; 2],
            sums: [square, slope * square, slope * slope * square],
        };
        let (turning_rows, lateral, roll) = (rows, pair(slope), pair(0.03));
        SignalCheck { rows, turning_rows, lateral, roll, ..SignalCheck::default() }
            .contradiction(9.81)
    }

    #[test]
    fn few_rows_or_weak_turns_are_not_judged() {
        assert!(gain_message(100.0, 0.31, 2.0).is_some());
        assert!(gain_message(99.0, 0.31, 2.0).is_none());
        assert!(gain_message(100.0, 0.29, 2.0).is_none());
        assert!(gain_message(1000.0, 0.29, 2.0).is_none());
    }

    #[test]
    fn gains_within_fifteen_percent_are_good() {
        for (slope, good) in [(0.84, false), (0.86, true), (1.14, true), (1.16, false)] {
            assert_eq!(gain_message(1000.0, 1.0, slope).is_none(), good, "{slope}");
        }
    }

    #[test]
    fn a_slope_near_that_of_a_known_fault_names_it() {
        let known = [
            (-1.0, "reversed"),
            (1.0 / 9.81, "in g"),
            (std::f64::consts::PI / 180.0, "degrees per second"),
            (1.0 / 3.6, "km/h"),
            (1.0 + 9.81 * 0.03, "fixed to the body"),
        ];
        for (slope, words) in known {
            for (factor, named) in [(0.89, false), (0.91, true), (1.09, true), (1.11, false)] {
                let message = gain_message(1000.0, 1.0, slope * factor).unwrap();
                assert!(message.contains(&format!(" {:.2} times", slope * factor)), "{message}");
                assert_eq!(message.contains(words), named, "{message}");
                assert_eq!(message.contains("the gain of one"), !named, "{message}");
            }
        }
    }

    /// What is said about the time of a log with `gaps` intervals of 0.7 s, one of 2 s and `close`
    /// of 0.5 s.
    fn clock(gaps: u64, close: u64) -> Option<String> {
        let mut check = SignalCheck::default();
        let mut time_us = 0;
        check.push(&Sample::absent(time_us));
        let mut steps = vec![2_000_000; usize::from(gaps > 0)];
        for (count, step_us) in [(gaps.saturating_sub(1), 700_000), (close, 500_000)] {
            steps.extend((0..count).map(|_| step_us));
        }
        for step_us in steps {
            time_us += step_us;
            check.push(&Sample::absent(time_us));
        }
        check.clock()
    }

    #[test]
    fn gaps_are_most_rows_from_more_than_half() {
        assert_eq!(clock(0, 5), None);
        let some = clock(3, 2).unwrap();
        assert!(some.starts_with("3 gaps of more than 0.5 s") && some.contains("is 2.0 s"));
        let most = clock(4, 2).unwrap();
        assert!(most.starts_with("most rows") && most.contains("up to 2.0 s"), "{most}");
    }
}
