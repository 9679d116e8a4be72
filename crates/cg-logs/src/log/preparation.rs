//! What some tables need before their rows are samples: channels of different rasters become rows with
//! all signals, and a roll rate becomes a roll angle.

use std::collections::VecDeque;

use super::beginning::{ROLLS, Rasters};
use super::frames::FrameRows;
use super::options::LogOptions;
use super::roll_rate::RollAngles;
use super::signal::{LogRow, Signal};
use crate::seldom::SeldomCheck;

/// Signals of a table that are none of frames and hold until they say something else.
const HELD: [Signal; 3] =
    [Signal::TrailerMassSd, Signal::YawRateOnTractor, Signal::LateralAccelerationOnTractor];

/// Rows of a table on their way to samples.
pub struct Preparation {
    rasters: Option<FrameRows>,
    /// Sees the cells before they are aligned.
    seldom: SeldomCheck,
    /// The time from which those of the rasters count, s: whole seconds at or before the first row.
    origin_s: f64,
    /// The last values of [`HELD`].
    held: [f64; HELD.len()],
    angles: Option<RollAngles>,
    /// Why a roll rate of the table is not used.
    rate_unused: Option<String>,
    /// The line of the row that was added last.
    line: u64,
    ready: VecDeque<(u64, LogRow)>,
}

impl Preparation {
    /// What a table with these signals and rasters needs; `None` if its rows are samples already and nothing
    /// has to be said about them.
    pub fn of(signals: &[Signal], rasters: &Rasters, options: &LogOptions) -> Option<Self> {
        let has = |signal: &Signal| signals.contains(signal);
        let rasters = rasters
            .differ()
            .then(|| FrameRows::new(options).with_speed_elsewhere(!has(&Signal::Speed)));
        // A tilt feels the lateral acceleration and is no angle to blend with.
        let other = ROLLS.into_iter().find(|roll| has(roll) && !is_angle(*roll));
        let other = other.filter(|_| !ROLLS.into_iter().any(|roll| has(&roll) && is_angle(roll)));
        let rate_unused = match other {
            _ if !has(&Signal::RollRate) => None,
            _ if rasters.is_some() => Some(
                "roll_rate is not used: it needs a table whose channels have common time stamps"
                    .to_owned(),
            ),
            Some(other) => Some(format!(
                "roll_rate is not used: it takes the place of the roll angle or refines roll or \
                 roll_to_gravity, and the log has {} instead; without that column, the roll angle is that of \
                 roll_rate",
                other.name()
            )),
            None => None,
        };
        let angles = (has(&Signal::RollRate) && rate_unused.is_none())
            .then(|| RollAngles::new(has(&Signal::Roll), has(&Signal::RollToGravity)));
        (rasters.is_some() || angles.is_some() || rate_unused.is_some()).then(|| Self {
            rasters,
            seldom: SeldomCheck::default(),
            origin_s: f64::NAN,
            held: [f64::NAN; HELD.len()],
            angles,
            rate_unused,
            line: 0,
            ready: VecDeque::new(),
        })
    }

    /// The signals of the prepared rows.
    pub fn signals(&self, signals: &[Signal]) -> Vec<Signal> {
        let mut all = signals.to_vec();
        let angle = all.iter().any(|signal| is_angle(*signal));
        if self.angles.is_some() && !angle {
            all.push(Signal::RollToGravity);
            all.sort_unstable();
        }
        all
    }

    /// Adds the next row, which stands in this line.
    pub fn push(&mut self, line: u64, row: LogRow) {
        self.line = line;
        if let Some(angles) = &mut self.angles {
            angles.push(line, row);
        } else if let Some(frames) = &mut self.rasters {
            if self.origin_s.is_nan() {
                self.origin_s = row.time_s.floor();
            }
            // The times of a table are whole microseconds at most, and increase.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let time_us = ((row.time_s - self.origin_s) * 1e6).round() as u64;
            frames.follow_lift_axle(row.lift_axle);
            for (held, signal) in self.held.iter_mut().zip(HELD) {
                *held = Some(row.get(signal)).filter(|value| *value >= 0.0).unwrap_or(*held);
            }
            for signal in Signal::ALL {
                let value = row.get(signal);
                if let Some(quantity) = signal.quantity().filter(|_| !value.is_nan()) {
                    frames.push_value(quantity, time_us, value);
                    self.seldom.push_cell((quantity, value), time_us);
                }
            }
            let known = (self.origin_s, self.held);
            let rows = std::iter::from_fn(|| frames.next_row());
            self.ready.extend(rows.map(|row| (line, of_table(row, known))));
        } else {
            self.ready.push_back((line, row));
        }
    }

    /// Ends the table.
    pub fn finish(&mut self) {
        let line = self.line;
        if let Some(angles) = &mut self.angles {
            angles.finish();
        } else if let Some(frames) = &mut self.rasters {
            let known = (self.origin_s, self.held);
            let rows = std::iter::from_fn(|| frames.rest());
            self.ready.extend(rows.map(|row| (line, of_table(row, known))));
        }
    }

    /// The next prepared row with its line.
    pub fn next_row(&mut self) -> Option<(u64, LogRow)> {
        let angles = self.angles.as_mut().and_then(RollAngles::next);
        angles.or_else(|| self.ready.pop_front())
    }

    /// What was found, as text for the user.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.angles.as_ref().map(RollAngles::remarks).unwrap_or_default();
        if self.rasters.is_some() {
            remarks.push(
                "the channels have time stamps of their own and were aligned to those of the roll angle"
                    .to_owned(),
            );
            remarks.extend(self.seldom.message());
        }
        remarks.extend(self.rate_unused.clone());
        remarks
    }
}

/// A row of a table, of which frames do not know from when its time counts and what it [holds](HELD).
fn of_table(row: LogRow, (origin_s, held): (f64, [f64; HELD.len()])) -> LogRow {
    let [trailer_mass_sd_kg, yaw_rate_on_tractor, lateral_acceleration_on_tractor] = held;
    LogRow {
        time_s: origin_s + row.time_s,
        trailer_mass_sd_kg,
        yaw_rate_on_tractor,
        lateral_acceleration_on_tractor,
        ..row
    }
}

fn is_angle(signal: Signal) -> bool {
    matches!(signal, Signal::Roll | Signal::RollToGravity)
}
