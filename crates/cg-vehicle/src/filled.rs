//! Whether values were never measured: an export fills gaps with straight lines or held values, and so looks a sensor that is much
//! slower than the rows.
//!
//! A motion is never exactly straight and then bends within one row. Noise bends in every row, and a motion without noise bends
//! little by little; a row of simulated or recorded values may be straight to the last digit, but it has no kink at its end.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

/// Time from which on a straight run matters, µs: values of 5 Hz are near enough for most turns.
const LONG_US: u64 = 240_000;
/// Least number of rows in it.
const LEAST_ROWS: u32 = 5;
/// How far a value may be from the line before it: in changes within a row, for time stamps that are rounded, and in steps, for the
/// rounding of three values, of which more changes within a row say nothing. A kink is more than some of it.
const STRAIGHT: f64 = 0.02;
const STEPS: f64 = 1.5;
const ROUNDED: f64 = 0.15;
const KINK: f64 = 4.0;
/// How far it must be, in the root mean square of all changes within a row: lines that bend less miss little of the motion. This
/// does not hold for lines that are straight to this share of a change, which no sensor gives.
const TYPICAL: f64 = 0.3;
const EXACT: f64 = 0.005;
/// Changes within a row of a line, in steps, up to which a motion may be rounded to the same number of them in each row, and how
/// near it is to that number.
const FEW_STEPS: f64 = 3.5;
const WHOLE: f64 = 1e-3;
/// Least number of such runs that are held, as a coarse signal on a bump may be, and straight; and least share of the time that they
/// take.
const LEAST_RUNS: [f64; 2] = [4.0, 2.0];
const SHARE: f64 = 0.02;
/// Longest interval between two rows of a run, µs.
const GAP_US: u64 = 250_000;
/// After this many samples only the first ones of each block are judged: they say the same for less.
const ALL: u64 = 8192;
const BLOCK: u64 = 4096;
const OF_BLOCK: u64 = 256;
/// Differences that are less are none.
const SAME: f64 = 1e-9;
/// Speed from which on a truck does not stand, m/s.
const MOVING_MPS: f64 = 3.0;

/// A signal, and where it is in a sample.
type Place = (Quantity, fn(&Sample<f64>) -> f64);

const SIGNALS: [Place; 9] = [
    (Quantity::Steer, |sample| sample.steer_rad),
    (Quantity::Roll, |sample| sample.roll_rad),
    (Quantity::RollToGravity, |sample| sample.roll_to_gravity_rad),
    (Quantity::SuspensionRoll, |sample| sample.suspension_roll_rad),
    (Quantity::TractorSuspensionRoll, |sample| sample.tractor_suspension_roll_rad),
    (Quantity::LateralAcceleration, |sample| sample.lateral_acceleration_mps2),
    (Quantity::LateralSpecificForce, |sample| sample.lateral_specific_force_mps2),
    (Quantity::TractorLateralSpecificForce, |sample| sample.tractor_lateral_specific_force_mps2),
    (Quantity::YawRate, |sample| sample.yaw_rate_radps),
];

/// A straight run of values.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Line {
    /// Its first value.
    start: f64,
    start_us: u64,
    /// Its slope so far, 1/µs.
    slope: f64,
    /// Number of changes in it.
    rows: u32,
    /// How far its values are from it at most.
    rough: f64,
    /// Whether it began with a kink.
    begins: bool,
}

/// One signal.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Runs {
    last: Option<(f64, u64)>,
    line: Option<Line>,
    /// The least change that is not within a line; 0 if there is none.
    step: f64,
    /// Number of changes, and the sum of their squares.
    changes: f64,
    square: f64,
    /// Time of all rows, µs, and of long runs that are held or straight, and how many there are.
    all_us: f64,
    long_us: [f64; 2],
    long: [f64; 2],
}

#[allow(clippy::cast_precision_loss)] // microseconds of a drive
impl Runs {
    fn interrupt(&mut self) {
        (self.last, self.line) = (None, None);
    }

    fn push(&mut self, value: f64, time_us: u64) {
        if !value.is_finite() {
            if self.last.is_some() {
                self.interrupt();
            }
            return;
        }
        let Some((last, last_us)) = self.last.replace((value, time_us)) else { return };
        let interval_us = time_us.saturating_sub(last_us);
        if interval_us > GAP_US {
            self.line = None;
            return;
        }
        let (change, of_row_us) = (value - last, interval_us as f64);
        self.all_us += of_row_us;
        self.changes += 1.0;
        self.square += change * change;
        let begins = match &mut self.line {
            Some(line) => {
                let of_run_us = time_us.saturating_sub(line.start_us) as f64;
                let off = (value - line.start - line.slope * of_run_us).abs();
                let of_row = line.slope.abs() * of_row_us;
                let straight = STRAIGHT * of_row + (STEPS * self.step).min(ROUNDED * of_row);
                if off <= straight.max(SAME) {
                    line.rows += 1;
                    line.rough = line.rough.max(off);
                    line.slope = (value - line.start) / of_run_us;
                    return;
                }
                // Rounding makes jumps of one step.
                let least = if of_row > SAME { KINK * straight } else { STEPS * self.step };
                let is_exact = line.rough < EXACT * of_row;
                let is_typical = || off * off * self.changes > TYPICAL * TYPICAL * self.square;
                let (is_kink, line) = (off > least && (is_exact || is_typical()), *line);
                if is_kink {
                    self.end(&line, last_us);
                }
                // A change within a line is as small as its slope.
                let single = (last - line.start).abs();
                if line.rows == 1 && single > SAME && !(self.step > 0.0 && self.step <= single) {
                    self.step = single;
                }
                // A value that is held begins with a jump, and not at the end of a motion.
                is_kink && (line.rows == 1 || change.abs() > SAME)
            }
            None => false,
        };
        let (start, start_us, slope) = (last, last_us, change / of_row_us);
        self.line = Some(Line { start, start_us, slope, rows: 1, rough: 0.0, begins });
    }

    /// Counts a run that ends with a kink.
    fn end(&mut self, line: &Line, end_us: u64) {
        let time_us = end_us.saturating_sub(line.start_us);
        if !(line.begins && line.rows >= LEAST_ROWS && time_us >= LONG_US) {
            return;
        }
        let change = line.slope.abs() * time_us as f64;
        let is_line = change > SAME;
        let steps = change / self.step / f64::from(line.rows);
        let is_rounded = steps < FEW_STEPS && (steps - steps.round()).abs() < WHOLE;
        if !(is_line && is_rounded) {
            self.long[usize::from(is_line)] += 1.0;
            self.long_us[usize::from(is_line)] += time_us as f64;
        }
    }

    /// The share of the time in long runs, held or straight, and how long they are, s, if it matters.
    fn share(&self, is_line: usize) -> Option<(f64, f64)> {
        let (runs, time_us) = (self.long[is_line], self.long_us[is_line]);
        let share = time_us / self.all_us;
        (runs >= LEAST_RUNS[is_line] && share > SHARE).then(|| (share, time_us / runs * 1e-6))
    }
}

/// Checks all signals.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct FilledCheck {
    samples: u64,
    of_signals: [Runs; SIGNALS.len()],
}

impl FilledCheck {
    /// Takes the next sample.
    pub fn push(&mut self, sample: &Sample<f64>) {
        let of_block = self.samples % BLOCK;
        let is_later = self.samples >= ALL;
        self.samples += 1;
        if is_later && of_block >= OF_BLOCK {
            return;
        }
        let begins = is_later && of_block == 0;
        let stands = sample.speed_mps < MOVING_MPS;
        for (runs, (_, value)) in self.of_signals.iter_mut().zip(SIGNALS) {
            if begins || stands {
                runs.interrupt();
            }
            if !stands {
                runs.push(value(sample), sample.time_us);
            }
        }
    }

    /// The signal of which most is filled in, if there is one.
    pub fn message(&self) -> Option<String> {
        let found = self.of_signals.iter().zip(SIGNALS).flat_map(|(runs, (signal, _))| {
            // A driver or a robot may turn the steering wheel at one speed, and stop.
            let kinds = if signal == Quantity::Steer { 0..1 } else { 0..2 };
            kinds.filter_map(move |kind| Some((runs.share(kind)?, kind, signal)))
        });
        let ((share, long_s), kind, signal) = found.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
        let how = [
            "stays at one value and then jumps",
            "changes along a straight line and then bends at once",
        ][kind];
        Some(format!(
            "{} {how} in {:.0} % of the driving, for {long_s:.1} s each: these values are not measured, but filled in by an \
             export or held from a slow sensor, so that the height can be wrong by 10 % and more, which the interval does not contain; \
             record the values as they come, and leave the cells between them empty",
            signal.name(),
            100.0 * share
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random, uniform, with a standard deviation of one.
    fn white(k: u32) -> f64 {
        let mixed = k.wrapping_mul(2_654_435_761) ^ 0x9e37_79b9;
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(2_246_822_519);
        (f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) - 0.5) * 12.0_f64.sqrt()
    }

    /// Turns of ten seconds for a minute at 50 Hz with this noise, as `export` makes them of all values.
    fn check(noise: f64, export: impl Fn(&[f64]) -> Vec<f64>) -> FilledCheck {
        let value = |k: u32| {
            let phase = f64::from(k) * 0.02 * std::f64::consts::TAU / 10.0;
            phase.sin().powi(3) + noise * white(k)
        };
        let measured: Vec<f64> = (0..3000).map(value).collect();
        let mut check = FilledCheck::default();
        for (time_us, lateral_acceleration_mps2) in (0..).step_by(20_000).zip(export(&measured)) {
            check.push(&Sample { lateral_acceleration_mps2, ..Sample::absent(time_us) });
        }
        check
    }

    /// Of every so many values, as lines between them or held.
    fn every(rows: usize, is_line: bool) -> impl Fn(&[f64]) -> Vec<f64> {
        move |measured| {
            let of = |k: usize| {
                let at = k - k % rows;
                let (before, after) = (measured[at], measured[(at + rows).min(2999)]);
                #[allow(clippy::cast_precision_loss)]
                let share = (k - at) as f64 / rows as f64;
                if is_line { before + share * (after - before) } else { before }
            };
            (0..measured.len()).map(of).collect()
        }
    }

    fn rounded(step: f64, values: Vec<f64>) -> Vec<f64> {
        values.into_iter().map(|value| (value / step).round() * step).collect()
    }

    #[test]
    fn values_of_two_hertz_are_told_and_those_of_ten_are_not() {
        for noise in [0.0, 0.03] {
            for (is_line, how) in [(true, "along a straight line"), (false, "stays at one value")] {
                let told = check(noise, every(25, is_line)).message().unwrap();
                assert!(told.contains(how), "{told}");
                let fine = check(noise, |all| rounded(1e-3, every(25, is_line)(all))).message();
                assert!(fine.is_some_and(|told| told.contains(how)), "{noise} {is_line}");
                assert_eq!(check(noise, every(5, is_line)).message(), None, "{noise} {is_line}");
            }
        }
    }

    /// One second of every seven is lost and filled: eight in a minute, without the one at the beginning.
    #[test]
    fn gaps_that_are_filled_with_lines_are_told() {
        let filled = |measured: &[f64]| {
            let lines = every(50, true)(measured);
            let value = |k: usize| if k % 350 < 50 { lines[k] } else { measured[k] };
            (0..measured.len()).map(value).collect()
        };
        let check = check(0.03, filled);
        let told = check.message().unwrap();
        assert!(told.starts_with("lateral_acceleration changes along"), "{told}");
        // Where the noise at an end happens to be small, there is no kink.
        let (share, long_s) = check.of_signals[5].share(1).unwrap();
        let runs = (share * 60.0).round();
        assert!((6.0..=8.0).contains(&runs) && (long_s - 1.0).abs() < 0.03, "{share} {long_s}");
    }

    #[test]
    fn measured_and_rounded_values_are_none() {
        for noise in [0.0, 1e-3, 0.03] {
            assert_eq!(check(noise, <[f64]>::to_vec).message(), None, "{noise}");
            for step in [1e-4, 1e-2, 0.1, 0.3] {
                let found = check(noise, |all| rounded(step, all.to_vec())).message();
                assert_eq!(found, None, "{noise} {step}");
            }
        }
    }

    /// A robot turns the wheel at one speed and holds it, again and again.
    #[test]
    fn a_steer_angle_may_be_straight() {
        let told = |steers: bool| {
            let mut check = FilledCheck::default();
            for k in 0..3000_u32 {
                // Each time at another speed.
                let turned = (k % 400).min(399 - k % 400).clamp(50, 100) - 50;
                let value = 1e-3 * f64::from(turned * (k / 400 + 1));
                let mut sample = Sample::absent(u64::from(k) * 20_000);
                let place = if steers { &mut sample.steer_rad } else { &mut sample.yaw_rate_radps };
                *place = value;
                check.push(&sample);
            }
            check.message()
        };
        assert_eq!(told(true), None);
        assert!(told(false).unwrap().starts_with("yaw_rate changes along"));
    }
}
