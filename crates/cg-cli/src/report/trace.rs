//! Signals of a log for the report, with a bounded number of points.

use cg_logs::log::LogRow;
use serde::Serialize;

/// Signals of a log, downsampled while it is read.
///
/// Each point is the mean of a block of rows. When the space is full, neighboring blocks are merged
/// and the blocks become twice as long.
#[derive(Clone, Debug)]
pub(crate) struct Trace {
    points: Vec<Block>,
    room: usize,
    rows_per_block: u32,
    open: Block,
}

/// Sums over the rows of a block; absent values are not included.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    rows: u32,
    sums: [f64; SIGNALS],
    counts: [u32; SIGNALS],
}

/// Number of signals: time, steer angle (or steering wheel), lateral acceleration, roll (or tilt).
const SIGNALS: usize = 4;

impl Block {
    fn add(&mut self, values: [f64; SIGNALS]) {
        self.rows += 1;
        for (k, value) in values.into_iter().enumerate() {
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
pub(super) struct Signals {
    time_s: Vec<Option<f64>>,
    steer_rad: Vec<Option<f64>>,
    lateral_acceleration_mps2: Vec<Option<f64>>,
    roll_rad: Vec<Option<f64>>,
}

impl Trace {
    /// A trace with space for this number of points, at least two.
    pub(crate) fn new(room: usize) -> Self {
        let room = room.max(2);
        let points = Vec::with_capacity(room);
        Self { points, room, rows_per_block: 1, open: Block::default() }
    }

    /// Adds a row.
    pub(crate) fn push(&mut self, row: &LogRow) {
        let or = |first: f64, second: f64| if first.is_nan() { second } else { first };
        self.open.add([
            row.time_s,
            or(row.steer_rad, row.steering_wheel_rad),
            or(row.lateral_acceleration_mps2, row.yaw_rate_radps * row.speed_mps),
            [row.roll_to_gravity_rad, row.tilt_rad, row.suspension_roll_rad]
                .into_iter()
                .fold(row.roll_rad, or),
        ]);
        if self.open.rows < self.rows_per_block {
            return;
        }
        self.points.push(std::mem::take(&mut self.open));
        if self.points.len() == self.room {
            self.halve();
        }
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
    pub(super) fn signals(&self) -> Signals {
        let rounded = |signal: usize, per_unit: f64| {
            let blocks = self.points.iter().chain((self.open.rows > 0).then_some(&self.open));
            let round = |value: f64| (value * per_unit).round() / per_unit;
            let means: Vec<_> = blocks.map(|block| block.mean(signal).map(round)).collect();
            if means.iter().all(Option::is_none) { Vec::new() } else { means }
        };
        Signals {
            time_s: rounded(0, 1e2),
            steer_rad: rounded(1, 1e5),
            lateral_acceleration_mps2: rounded(2, 1e3),
            roll_rad: rounded(3, 1e5),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_log_takes_no_more_room_than_a_short_one_and_keeps_its_mean() {
        let mut trace = Trace::new(100);
        for k in 0..1_000_003 {
            let time_s = 0.01 * f64::from(k);
            trace.push(&LogRow { time_s, roll_rad: f64::from(k % 2), ..LogRow::ABSENT });
        }
        let signals = trace.signals();
        assert!((50..=100).contains(&signals.time_s.len()), "{}", signals.time_s.len());
        assert!(signals.time_s.windows(2).all(|pair| pair[0] < pair[1]));
        // Every block except the last one contains as many zeros as ones.
        let (_, whole) = signals.roll_rad.split_last().unwrap();
        assert!(whole.iter().all(|mean| *mean == Some(0.5)));
        assert!(signals.steer_rad.is_empty());
    }

    #[test]
    fn a_short_log_stays_as_it_is() {
        let mut trace = Trace::new(100);
        for k in 0..3 {
            let roll_rad = if k == 1 { f64::NAN } else { 0.25 };
            trace.push(&LogRow { time_s: f64::from(k), roll_rad, ..LogRow::ABSENT });
        }
        let signals = trace.signals();
        assert_eq!(signals.time_s, [Some(0.0), Some(1.0), Some(2.0)]);
        assert_eq!(signals.roll_rad, [Some(0.25), None, Some(0.25)]);
    }
}
