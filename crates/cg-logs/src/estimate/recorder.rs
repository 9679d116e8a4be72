//! Inputs and roll angles of a log, from which a calibration learns the shapes of the responses.

use cg_core::decide::condition::Row;
use cg_core::truck::lags::RollLags;
use cg_core::{CHANNELS, Channel, Conditioner, Design, Sample, SampleError};
use cg_vehicle::Load;
use cg_vehicle::calibration::shape::{INTERVAL_S, ShapeRun, Stretch};

/// A longer gap between two rows ends a stretch, µs.
const GAP_US: u64 = 500_000;
/// Rows before the first turn of a log, and from it on, that are kept: five seconds and half a minute.
const KEPT: [usize; 2] = [100, 600];
/// Rows at the start of a stretch in which the noise of the first row decays: a second.
const START: usize = 20;
/// Greatest relative difference from the speed of the run at which its model is valid.
const SAME_SPEED: f64 = 0.1;

/// Records all channels of a log.
#[derive(Clone)]
pub(crate) struct Recorder {
    conditioner: Conditioner<f64>,
    channels: [Recording; CHANNELS],
}

/// Records one channel of a log.
#[derive(Clone)]
struct Recording {
    channel: Channel,
    last: Option<Last>,
    stretches: Vec<Vec<Kept>>,
    /// Rows from the first turn on.
    since_turn: usize,
}

/// The last row.
#[derive(Clone)]
struct Last {
    time_us: u64,
    /// Both signals pass these lags, so that the rows between those that are kept count too.
    smooth: [RollLags<f64>; 2],
    /// The lags of the channel.
    roll: RollLags<f64>,
    /// Input and roll angle.
    signals: [f64; 2],
    /// Time since the last row that was kept, s.
    since_s: f64,
}

/// A row that is kept.
#[derive(Clone, Copy)]
struct Kept {
    signals: [f64; 2],
    /// Zero if the model is not valid.
    speed_mps: f64,
}

impl Recorder {
    pub(crate) fn new(design: &Design<f64>) -> Self {
        let recording =
            |channel| Recording { channel, last: None, stretches: Vec::new(), since_turn: 0 };
        Self { conditioner: Conditioner::new(design), channels: Channel::ALL.map(recording) }
    }

    pub(crate) fn push(
        &mut self,
        design: &Design<f64>,
        sample: &Sample<f64>,
    ) -> Result<(), SampleError> {
        if let Some(row) = self.conditioner.push(design, sample)? {
            self.channels.iter_mut().for_each(|one| one.push(&row));
        }
        Ok(())
    }

    /// The rows of a run with this load and mean speed; those at other speeds are not used.
    pub(crate) fn finish(self, load: Load, speed_mps: f64) -> ShapeRun {
        let is_used = |kept: &Kept| (kept.speed_mps / speed_mps - 1.0).abs() <= SAME_SPEED;
        let channels = self.channels.map(|one| {
            let stretch = |rows: Vec<Kept>| Stretch {
                input: rows.iter().map(|kept| kept.signals[0]).collect(),
                measured_rad: rows.iter().map(|kept| kept.signals[1]).collect(),
                used: rows.iter().enumerate().map(|(k, row)| k >= START && is_used(row)).collect(),
            };
            one.stretches.into_iter().map(stretch).collect()
        });
        ShapeRun { load, speed_mps, channels }
    }
}

impl Recording {
    fn push(&mut self, row: &Row<f64>) {
        let place = self.channel.index();
        let signals = [row.expected_rad[place], row.measured_rad[place]];
        if signals.iter().any(|signal| signal.is_nan()) || self.since_turn >= KEPT[1] {
            return;
        }
        let continues = |last: &Last| row.time_us - last.time_us <= GAP_US;
        let mut last = self.last.take().filter(continues).unwrap_or_else(|| {
            if self.since_turn == 0 {
                self.stretches.clear(); // straight driving
            }
            self.stretches.push(Vec::new());
            let at_rest = RollLags::at_rest;
            let smooth = signals.map(at_rest);
            let time_us = row.time_us;
            Last { time_us, smooth, roll: at_rest(signals[1]), signals, since_s: INTERVAL_S }
        });
        #[allow(clippy::cast_precision_loss)] // at most a gap
        let interval_s = (row.time_us - last.time_us) as f64 * 1e-6;
        let mut next = signals;
        if interval_s > 0.0 {
            if self.channel.lags_roll() {
                next[1] = last.roll.push(next[1], interval_s);
            }
            for (signal, lags) in next.iter_mut().zip(&mut last.smooth) {
                *signal = lags.push(*signal, interval_s);
            }
        }
        let speed_mps = if row.usable[place] { row.speed_mps } else { 0.0 };
        last.since_s += interval_s;
        while last.since_s >= INTERVAL_S {
            last.since_s -= INTERVAL_S;
            // Linear between the last row and this one.
            let share = if interval_s > 0.0 { 1.0 - last.since_s / interval_s } else { 1.0 };
            let between = |k: usize| last.signals[k] + share * (next[k] - last.signals[k]);
            self.keep(Kept { signals: [between(0), between(1)], speed_mps }, row.turning);
        }
        self.last = Some(Last { time_us: row.time_us, signals: next, ..last });
    }

    fn keep(&mut self, kept: Kept, turning: bool) {
        let Some(rows) = self.stretches.last_mut() else { return };
        rows.push(kept);
        if turning || self.since_turn > 0 {
            self.since_turn += 1;
        } else if rows.len() > KEPT[0] {
            // Straight driving so far.
            rows.remove(0);
        }
    }
}
