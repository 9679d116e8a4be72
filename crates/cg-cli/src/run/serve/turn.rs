//! The roll angle over the lateral acceleration of the last maneuver, and the line that the model expects.

use std::collections::VecDeque;
use std::io;

use cg_core::{Channel, Design, Maneuver, Sample, Signals};
use serde::Serialize;

use super::super::events::Result as Known;

/// Time between two points, µs.
const STEP_US: u64 = 100_000;
/// Number of points: a minute, and a maneuver ends after forty seconds.
const POINTS: usize = 600;
/// The channels whose input is an acceleration, in the order of preference.
const CHANNELS: [Channel; 3] =
    [Channel::LateralAcceleration, Channel::Suspension, Channel::Tractor];

/// The signals of the last minute.
#[derive(Debug, Default)]
pub(super) struct Recent {
    points: VecDeque<(u64, Signals<f64>)>,
}

/// The last maneuver. The names of the fields are the keys of the event.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Turn {
    start_s: f64,
    end_s: f64,
    /// The channel whose signals these are.
    channel: String,
    /// Whether the roll angle is relative to gravity and thus contains the bank of the road.
    to_gravity: bool,
    /// Lateral acceleration, or specific force, m/s².
    lateral_acceleration_mps2: Vec<f64>,
    roll_rad: Vec<f64>,
    /// Roll angle per lateral acceleration at the height, and at the ends of its interval, rad per m/s².
    ratio: Option<f64>,
    ratio_ci95: Option<[f64; 2]>,
    /// Roll angle on the line of that ratio without lateral acceleration, rad: the line passes through the mean of
    /// the points, because a sensor may have an offset.
    roll_offset_rad: Option<f64>,
}

#[derive(Serialize)]
struct Line<'a> {
    time_s: f64,
    event: &'static str,
    #[serde(flatten)]
    turn: &'a Turn,
}

impl Recent {
    /// Adds the signals of a sample at a speed.
    pub(super) fn push(&mut self, sample: &Sample<f64>, speed_mps: f64, gravity_mps2: f64) {
        let time_us = sample.time_us;
        let last_us = self.points.back().map(|(time_us, _)| *time_us);
        if last_us.is_some_and(|last_us| time_us < last_us.saturating_add(STEP_US)) {
            return;
        }
        if self.points.len() == POINTS {
            self.points.pop_front();
        }
        self.points.push_back((time_us, Signals::of(&sample.checked(), speed_mps, gravity_mps2)));
    }

    /// The points of a channel in a maneuver.
    fn of(&self, channel: Channel, maneuver: &Maneuver<f64>) -> [Vec<f64>; 2] {
        let within = maneuver.start_us..=maneuver.end_us;
        let points = self.points.iter().filter(|(time_us, _)| within.contains(time_us));
        let round = |value: f64, per_unit: f64| (value * per_unit).round() / per_unit;
        let pair = |signals: &Signals<f64>| {
            let (input, output) =
                (signals.input(channel.input()), signals.output(channel.output()));
            (input.is_finite() && output.is_finite())
                .then(|| (round(input, 1e4), round(output, 1e5)))
        };
        let (inputs, outputs) = points.filter_map(|(_, signals)| pair(signals)).unzip();
        [inputs, outputs]
    }

    /// The maneuver with the result after it; `None` if no lateral acceleration was measured with a roll angle.
    /// `origin_s` is the time stamp of the estimator's time zero, s.
    pub(super) fn turn(
        &self,
        design: &Design<f64>,
        maneuver: &Maneuver<f64>,
        known: &Known,
        origin_s: f64,
    ) -> Option<Turn> {
        let measured = CHANNELS.map(|channel| (channel, self.of(channel, maneuver)));
        let mut present = measured.into_iter().filter(|(_, [inputs, _])| inputs.len() > 1);
        let first = present.next()?;
        let has_height = |channel: Channel| maneuver.outcomes[channel.index()].height_m.is_ok();
        let (channel, [inputs, outputs]) = if has_height(first.0) {
            first
        } else {
            present.find(|(channel, _)| has_height(*channel)).unwrap_or(first)
        };
        let line = design.line(channel, maneuver.speed_mps, maneuver.trailer_mass_kg);
        let ratio_at =
            |height_m: f64| line.map(|line| line.ratio_at(height_m) * design.compensation(channel));
        let ratio = known.height_m.and_then(ratio_at);
        let ends = known.height_ci95_m.map(|ends| ends.map(ratio_at));
        let ratio_ci95 = ends.and_then(|[low, high]| Some([low?, high?]));
        let roll_offset_rad = ratio.map(|ratio| mean(&outputs) - ratio * mean(&inputs));
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds = |time_us: u64| origin_s + time_us as f64 * 1e-6;
        Some(Turn {
            start_s: seconds(maneuver.start_us),
            end_s: seconds(maneuver.end_us),
            channel: channel.to_string(),
            to_gravity: maneuver.to_gravity && channel.feels_bank(),
            lateral_acceleration_mps2: inputs,
            roll_rad: outputs,
            ratio,
            ratio_ci95,
            roll_offset_rad,
        })
    }
}

#[allow(clippy::cast_precision_loss)] // some hundred values
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl Turn {
    /// The event.
    pub(super) fn line(&self, time_s: f64) -> io::Result<String> {
        Ok(serde_json::to_string(&Line { time_s, event: "turn", turn: self })?)
    }
}
