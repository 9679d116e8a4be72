//! Whether inputs are sampled so seldom that lines between their values miss a part of the motion.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

/// Rows that are closer are close enough for every truck, µs: at 10 Hz, a lane change within three seconds is missed by 0.4 %.
const CLOSE_US: u64 = 110_000;
/// Share of the motion that is missed, above which the height can be wrong by as much: half of an interval of ±2 %, the best
/// there is.
const MUCH: f64 = 0.01;
/// Least number of rows beside two others.
const LEAST_ROWS: f64 = 10.0;

/// An input: where it is in a sample.
type Input = (Quantity, fn(&Sample<f64>) -> f64);

const INPUTS: [Input; 5] = [
    (Quantity::Steer, |sample| sample.steer_rad),
    (Quantity::LateralAcceleration, |sample| sample.lateral_acceleration_mps2),
    (Quantity::LateralSpecificForce, |sample| sample.lateral_specific_force_mps2),
    (Quantity::TractorLateralSpecificForce, |sample| sample.tractor_lateral_specific_force_mps2),
    (Quantity::YawRate, |sample| sample.yaw_rate_radps),
];

/// One input.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Motion {
    /// The time of the last cell.
    #[serde(default)]
    cell_us: Option<u64>,
    /// The last value, and the one before it.
    last: [Option<f64>; 2],
    /// Rows with two values before them; their sum, and that of their squares.
    rows: f64,
    sum: f64,
    square: f64,
    /// Sums of the squares of the change within one row, and within two.
    changes: [f64; 2],
}

impl Motion {
    /// The next value has no neighbor before it.
    fn interrupt(&mut self) {
        self.last = [None; 2];
    }

    fn push(&mut self, value: f64) {
        if !value.is_finite() {
            self.interrupt();
            return;
        }
        let before = self.last;
        self.last = [Some(value), before[0]];
        let [Some(last), Some(earlier)] = before else { return };
        self.rows += 1.0;
        self.sum += value;
        self.square += value * value;
        self.changes[0] += (value - last) * (value - last);
        self.changes[1] += (value - earlier) * (value - earlier);
    }

    /// The share of the motion that lines between the values miss, if it matters.
    ///
    /// Of a sine of ω rad/s, lines between values that are `Δ` apart leave `sinc²(ω Δ/2)`, so they miss `(ω Δ)²/12`.
    /// Its change within `Δ` has the mean square `(ω Δ)²` times its variance, and four times as much within `2 Δ`; white
    /// noise has the same in both. A third of their difference is thus that of the motion alone.
    fn missed(&self) -> Option<f64> {
        let variance = self.square - self.sum * self.sum / self.rows;
        let share = (self.changes[1] - self.changes[0]) / 36.0 / variance;
        (self.rows >= LEAST_ROWS && share > MUCH).then_some(share)
    }
}

/// Checks all inputs.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SeldomCheck {
    last_us: Option<u64>,
    /// Whether the last row was far enough from the one before.
    is_apart: bool,
    of_inputs: [Motion; INPUTS.len()],
}

impl SeldomCheck {
    /// Takes the next sample.
    pub(crate) fn push(&mut self, sample: &Sample<f64>) {
        let last_us = self.last_us.replace(sample.time_us);
        let is_close =
            last_us.is_none_or(|last_us| sample.time_us.saturating_sub(last_us) < CLOSE_US);
        if is_close {
            // Rows beside two gaps are no neighbors.
            if std::mem::take(&mut self.is_apart) {
                self.of_inputs.iter_mut().for_each(Motion::interrupt);
            }
            return;
        }
        self.is_apart = true;
        for (motion, (_, value)) in self.of_inputs.iter_mut().zip(INPUTS) {
            motion.push(value(sample));
        }
    }

    /// Takes a cell of a table in which each channel has times of its own.
    pub(crate) fn push_cell(&mut self, (quantity, value): (Quantity, f64), time_us: u64) {
        let motions = self.of_inputs.iter_mut().zip(INPUTS);
        for (motion, _) in motions.filter(|(_, (input, _))| *input == quantity) {
            let before_us = motion.cell_us.replace(time_us);
            if before_us.is_some_and(|us| time_us.saturating_sub(us) < CLOSE_US) {
                motion.interrupt();
            } else {
                motion.push(value);
            }
        }
    }

    /// The input of which most is missed, if it matters.
    pub(crate) fn message(&self) -> Option<String> {
        let found = self.of_inputs.iter().zip(INPUTS);
        let found = found.filter_map(|(motion, (input, _))| Some((motion.missed()?, input)));
        let (share, input) = found.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!(
            "{} changes so fast that its rows miss {:.0} % of its motion: the height can be wrong by as much and more, \
             which the interval does not contain; record ten or more rows per second",
            input.name(),
            100.0 * share
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lane change within three seconds after ten of straight driving, sampled every `step_us` with noise of this share.
    fn check(step_us: usize, noise: f64) -> SeldomCheck {
        let mut check = SeldomCheck::default();
        for (k, time_us) in (0_u32..).zip((0..20_000_000_u32).step_by(step_us)) {
            let time_s = f64::from(time_us) * 1e-6;
            let phase = std::f64::consts::TAU * (time_s - 10.0) / 3.0;
            let motion = if (10.0..13.0).contains(&time_s) { phase.sin() } else { 0.0 };
            let white = if k.wrapping_mul(2_654_435_761) >> 31 == 0 { noise } else { -noise };
            check.push(&Sample {
                steer_rad: 0.02 * (motion + white),
                ..Sample::absent(u64::from(time_us))
            });
        }
        check
    }

    #[test]
    fn a_lane_change_of_a_few_rows_is_told() {
        for (step_us, noise) in
            [(500_000, 0.0), (400_000, 0.0), (300_000, 0.0), (200_000, 0.0), (500_000, 0.1)]
        {
            let found = check(step_us, noise);
            let told = found.message().unwrap();
            assert!(told.starts_with("steer changes so fast"), "{told}");
        }
        // By hand: 0, 0, s, s, 0, −s, −s, 0, 0 with s² = 0.75 has the squares 4 s², within one row the changes 4 s², and
        // within two 10 s².
        let shown = check(500_000, 0.0).of_inputs[0].missed().unwrap();
        assert!((shown - 6.0 / 36.0 / 4.0).abs() < 1e-9, "{shown}");
    }

    /// The same whether an input comes in rows or in cells between those of others.
    #[test]
    fn cells_that_come_seldom_are_told_as_rows_are() {
        for (step_us, is_told) in
            [(500_000, true), (200_000, true), (100_000, false), (20_000, false)]
        {
            let mut cells = SeldomCheck::default();
            for time_us in (0..20_000_000_u32).step_by(20_000) {
                let time_s = f64::from(time_us) * 1e-6;
                let phase = std::f64::consts::TAU * (time_s - 10.0) / 3.0;
                let motion = if (10.0..13.0).contains(&time_s) { phase.sin() } else { 0.0 };
                if time_us % step_us == 0 {
                    cells.push_cell((Quantity::Steer, 0.02 * motion), u64::from(time_us));
                }
                cells.push_cell((Quantity::Roll, 0.03 * motion), u64::from(time_us));
            }
            assert_eq!(cells.message().is_some(), is_told, "{step_us}");
        }
    }

    #[test]
    fn enough_rows_and_noise_are_not_told() {
        for (step_us, noise) in
            [(125_000, 0.0), (125_000, 0.3), (100_000, 0.0), (100_000, 0.3), (10_000, 0.0)]
        {
            assert_eq!(check(step_us, noise).message(), None, "{step_us} {noise}");
        }
        // Rows beside gaps of half a motion of 3 s are no neighbors, in a log of 100 Hz with a gap in each 0.8 s.
        let mut gaps = SeldomCheck::default();
        for time_us in
            (0..60_000_000_u32).step_by(10_000).filter(|time_us| time_us % 800_000 > 200_000)
        {
            let phase = f64::from(time_us) * 1e-6 * std::f64::consts::TAU / 3.0;
            let sample = Sample::absent(u64::from(time_us));
            gaps.push(&Sample { steer_rad: 0.02 * phase.sin(), ..sample });
        }
        assert_eq!(gaps.message(), None);
    }
}
