//! Signals of a log for the report, with a bounded number of points.

use cg_core::{Input, Output};
use serde::Serialize;

/// Signals of a log, downsampled while it is read.
///
/// Each point is the mean of a block of rows. When the space is full, neighboring blocks are merged
/// and the blocks become twice as long.
#[derive(Clone, Debug)]
pub struct Trace {
    points: Vec<Block>,
    room: usize,
    rows_per_block: u32,
    open: Block,
    to_gravity: bool,
}

/// Sums over the rows of a block; absent values are not included.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    rows: u32,
    sums: [f64; SIGNALS],
    counts: [u32; SIGNALS],
}

/// The signals behind the time: the roll angles and inputs of all channels.
const OUTPUTS: [Output; 3] = [Output::Roll, Output::SuspensionRoll, Output::TractorSuspensionRoll];
const INPUTS: [Input; 4] =
    [Input::Steer, Input::LateralAcceleration, Input::SpecificForce, Input::TractorSpecificForce];
const SIGNALS: usize = 1 + OUTPUTS.len() + INPUTS.len();

impl Block {
    fn add(&mut self, values: impl Iterator<Item = f64>) {
        self.rows += 1;
        for (k, value) in values.enumerate() {
            if value.is_finite() {
                self.sums[k] += value;
                self.counts[k] += 1;
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        self.rows += other.rows;
        for k in 0..SIGNALS {
            self.sums[k] += other.sums[k];
            self.counts[k] += other.counts[k];
        }
    }

    fn mean(&self, signal: usize) -> Option<f64> {
        (self.counts[signal] > 0).then(|| self.sums[signal] / f64::from(self.counts[signal]))
    }
}

/// The points of a trace by signal; the names contain the units.
#[derive(Debug, Serialize)]
struct Signals {
    time_s: Vec<Option<f64>>,
    roll_rad: Vec<Option<f64>>,
    suspension_roll_rad: Vec<Option<f64>>,
    tractor_suspension_roll_rad: Vec<Option<f64>>,
    steer_rad: Vec<Option<f64>>,
    lateral_acceleration_mps2: Vec<Option<f64>>,
    lateral_specific_force_mps2: Vec<Option<f64>>,
    tractor_lateral_specific_force_mps2: Vec<Option<f64>>,
    /// Whether `roll_rad` is relative to gravity.
    to_gravity: bool,
}

impl Trace {
    /// A trace with space for this number of points, at least two.
    #[must_use]
    pub fn new(room: usize) -> Self {
        let room = room.max(2);
        let points = Vec::with_capacity(room);
        Self { points, room, rows_per_block: 1, open: Block::default(), to_gravity: false }
    }

    /// Adds the signals of a row.
    pub fn push(&mut self, time_s: f64, signals: &cg_core::Signals<f64>) {
        let outputs = OUTPUTS.into_iter().map(|output| signals.output(output));
        let inputs = INPUTS.into_iter().map(|input| signals.input(input));
        self.open.add(std::iter::once(time_s).chain(outputs).chain(inputs));
        self.to_gravity |= signals.to_gravity();
        if self.open.rows < self.rows_per_block {
            return;
        }
        self.points.push(std::mem::take(&mut self.open));
        if self.points.len() == self.room {
            self.halve();
        }
    }

    /// The points as a JSON object of lists, whose names contain the units.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(&self.signals())
    }

    fn halve(&mut self) {
        let halves = self.points.chunks(2).map(|pair| {
            let mut block = pair[0];
            if let Some(second) = pair.get(1) {
                block.merge(second);
            }
            block
        });
        self.points = halves.collect();
        self.rows_per_block *= 2;
    }

    /// The points to show, rounded to the resolution of a plot; signals that the log does not have
    /// are empty.
    fn signals(&self) -> Signals {
        let rounded = |signal: usize, per_unit: f64| {
            let blocks = self.points.iter().chain((self.open.rows > 0).then_some(&self.open));
            let round = |value: f64| (value * per_unit).round() / per_unit;
            let means: Vec<_> = blocks.map(|block| block.mean(signal).map(round)).collect();
            if means.iter().all(Option::is_none) { Vec::new() } else { means }
        };
        Signals {
            time_s: rounded(0, 1e2),
            roll_rad: rounded(1, 1e5),
            suspension_roll_rad: rounded(2, 1e5),
            tractor_suspension_roll_rad: rounded(3, 1e5),
            steer_rad: rounded(4, 1e5),
            lateral_acceleration_mps2: rounded(5, 1e3),
            lateral_specific_force_mps2: rounded(6, 1e3),
            tractor_lateral_specific_force_mps2: rounded(7, 1e3),
            to_gravity: self.to_gravity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_core::{Sample, Signals};

    fn roll(roll_rad: f64) -> Signals<f64> {
        Signals::of(&Sample { roll_rad, ..Sample::absent(0) }, f64::NAN, 9.81)
    }

    #[test]
    fn a_long_log_takes_no_more_room_than_a_short_one_and_keeps_its_mean() {
        let mut trace = Trace::new(100);
        for k in 0..1_000_003 {
            trace.push(0.01 * f64::from(k), &roll(f64::from(k % 2)));
        }
        let signals = trace.signals();
        assert!((50..=100).contains(&signals.time_s.len()), "{}", signals.time_s.len());
        assert!(signals.time_s.windows(2).all(|pair| pair[0] < pair[1]));
        // Every block except the last one contains as many zeros as ones.
        let (_, whole) = signals.roll_rad.split_last().unwrap();
        assert!(whole.iter().all(|mean| *mean == Some(0.5)));
        assert!(signals.steer_rad.is_empty() && !signals.to_gravity);
    }

    #[test]
    fn a_short_log_stays_as_it_is() {
        let mut trace = Trace::new(100);
        for k in 0..3 {
            trace.push(f64::from(k), &roll(if k == 1 { f64::NAN } else { 0.25 }));
        }
        let signals = trace.signals();
        assert_eq!(signals.time_s, [Some(0.0), Some(1.0), Some(2.0)]);
        assert_eq!(signals.roll_rad, [Some(0.25), None, Some(0.25)]);
    }

    #[test]
    fn every_signal_keeps_its_place() {
        let sample = Sample {
            roll_to_gravity_rad: 0.1,
            suspension_roll_rad: 0.2,
            tractor_suspension_roll_rad: 0.3,
            steer_rad: 0.4,
            lateral_acceleration_mps2: 0.5,
            lateral_specific_force_mps2: 0.6,
            tractor_lateral_specific_force_mps2: 0.7,
            ..Sample::absent(0)
        };
        let mut trace = Trace::new(2);
        trace.push(0.0, &Signals::of(&sample, f64::NAN, 9.81));
        let page = trace.to_json().unwrap();
        assert_eq!(
            page,
            r#"{"time_s":[0.0],"roll_rad":[0.1],"suspension_roll_rad":[0.2],"#.to_owned()
                + r#""tractor_suspension_roll_rad":[0.3],"steer_rad":[0.4],"#
                + r#""lateral_acceleration_mps2":[0.5],"lateral_specific_force_mps2":[0.6],"#
                + r#""tractor_lateral_specific_force_mps2":[0.7],"to_gravity":true}"#
        );
    }
}
