//! The events on standard output, as JSON Lines.
//!
//! Each line has `event` and `time_s`, the time stamp of the frame or row that caused it (Unix
//! time, if the source has it).

use std::io;

use cg_core::{Channel, Combined, Design, Maneuver, Measured, Reject};
use cg_logs::estimate::{ManeuverEstimate, Method, Verdict, interval_95, threshold_g};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::scales::Scale;
use serde::Serialize;

/// A line of the output.
#[derive(Debug, Serialize)]
struct Line<'a> {
    time_s: f64,
    #[serde(flatten)]
    event: &'a Event<'a>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub(crate) enum Event<'a> {
    /// The program has started.
    Start {
        version: &'a str,
        vehicle: &'a str,
        source: &'a str,
        restored: bool,
        /// How the DC ratios are identified.
        method: Method,
        /// Address of the live page.
        #[serde(skip_serializing_if = "Option::is_none")]
        page: Option<&'a str>,
    },
    /// The driving state has changed: straight driving, a turn, or no signals.
    State { state: &'a str, missing: Vec<&'a str> },
    /// A maneuver has ended.
    Maneuver(Box<ManeuverLine>),
    /// The load has changed; the estimation of the height starts again.
    LoadChanged { message: &'a str },
    /// A trip with the empty trailer was learned or contradicts the earlier ones; at the start, how
    /// many trips are used.
    Learned { trips: usize, message: String },
    /// Periodic status.
    Status(Box<Status>),
    /// The warning level has changed.
    Warning { level: usize, margin_g: Option<f64> },
    /// A request for a lower speed has begun or, without a speed, ended.
    SpeedRequest { requested_speed_mps: Option<f64> },
    /// A message about the source, the state file or an output.
    Notice { subject: &'a str, message: String },
    /// The program ends.
    Stop { reason: &'a str, frames: u64, frames_lost: u64, latency_ms: Option<Latency> },
}

/// A maneuver and the height after it.
#[derive(Debug, Serialize)]
pub(crate) struct ManeuverLine {
    pub(crate) speed_mps: f64,
    pub(crate) steer: ManeuverEstimate,
    pub(crate) lateral_acceleration: ManeuverEstimate,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) suspension: Option<ManeuverEstimate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tractor: Option<ManeuverEstimate>,
    #[serde(flatten)]
    pub(crate) result: Result,
}

impl ManeuverLine {
    /// A maneuver with the height after it. Pairs of signals that the truck does not have are left out.
    /// `origin_s` is the time stamp of the estimator's time zero, s.
    pub(crate) fn new(maneuver: &Maneuver<f64>, result: Result, origin_s: f64) -> Self {
        let outcome = |channel: Channel| &maneuver.outcomes[channel.index()];
        let of = |channel| ManeuverEstimate::new(maneuver, outcome(channel), origin_s);
        let there =
            |channel| (outcome(channel).height_m != Err(Reject::Absent)).then(|| of(channel));
        Self {
            speed_mps: maneuver.speed_mps,
            steer: of(Channel::Steer),
            lateral_acceleration: of(Channel::LateralAcceleration),
            suspension: there(Channel::Suspension),
            tractor: there(Channel::Tractor),
            result,
        }
    }
}

/// Where the trailer mass comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MassSource {
    /// The vehicle file; the load has not been weighed.
    #[default]
    Nominal,
    /// The state file; the load was weighed before the restart.
    Kept,
    /// A signal of the truck.
    Signal,
    /// `--trailer-mass-kg`.
    Given,
}

/// The result for the present load.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Result {
    pub(crate) status: Verdict,
    pub(crate) height_m: Option<f64>,
    pub(crate) height_sd_m: Option<f64>,
    pub(crate) height_ci95_m: Option<[f64; 2]>,
    pub(crate) channel: Option<String>,
    pub(crate) maneuvers: u32,
    pub(crate) trailer_mass_kg: f64,
    pub(crate) trailer_mass_source: MassSource,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) trailer_mass_scale: Option<Scale>,
    pub(crate) trailer_mass_sd_kg: f64,
    /// Where the lift axles are, of a trailer that has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lift_axle: Option<LiftAxle>,
    pub(crate) static_rollover_threshold_g: Option<f64>,
    pub(crate) static_rollover_threshold_ci95_g: Option<[f64; 2]>,
    /// Share of the variance of the height that the unknown bank of the road makes.
    pub(crate) road_share: Option<f64>,
    #[serde(skip)]
    pub(crate) measured_m: Option<Measured<f64>>,
    /// How far the load may stand beside the middle, because the trailer leans; zero if it does not.
    #[serde(skip)]
    pub(crate) beside_m: f64,
    #[serde(skip)]
    pub(crate) threshold_g: Option<Measured<f64>>,
}

impl Result {
    /// The result from the fused height, if there is one. [`at_speed`](Self::at_speed) sets the
    /// threshold.
    pub(crate) fn new(
        combined: Option<Combined<f64>>,
        channel: Option<Channel>,
        (trailer_mass_kg, trailer_mass_source): (f64, MassSource),
    ) -> Self {
        let status = match combined {
            None => Verdict::Rejected,
            Some(Combined::Contradictory { .. } | Combined::Impossible) => Verdict::Inconsistent,
            Some(_) => Verdict::Ok,
        };
        let nothing = Self { status, trailer_mass_kg, trailer_mass_source, ..Self::default() };
        let Some(height) = combined.and_then(|all| all.height()) else { return nothing };
        let Measured { value, sd } = height.height_m;
        Self {
            height_m: Some(value),
            height_sd_m: Some(sd),
            height_ci95_m: Some(interval_95(height.height_m)),
            channel: Some(channel.map_or("combined".to_owned(), |channel| channel.to_string())),
            maneuvers: height.maneuvers,
            measured_m: Some(height.height_m),
            ..nothing
        }
    }

    /// Adds a standard deviation to that of the height, m.
    pub(crate) fn add_sd(&mut self, sd_m: f64) {
        let Some(measured) = &mut self.measured_m else { return };
        measured.sd = libm::hypot(measured.sd, sd_m);
        self.height_sd_m = Some(measured.sd);
        self.height_ci95_m = Some(interval_95(*measured));
    }

    /// Sets the rollover threshold in a turn at this speed.
    pub(crate) fn at_speed(&mut self, design: &Design<f64>, speed_mps: f64) {
        let turn = [self.trailer_mass_kg, speed_mps];
        self.threshold_g =
            self.measured_m.and_then(|height_m| threshold_g(design, height_m, turn, self.beside_m));
        self.static_rollover_threshold_g = self.threshold_g.map(|threshold| threshold.value);
        self.static_rollover_threshold_ci95_g = self.threshold_g.map(interval_95);
    }

    /// The threshold minus the absolute lateral acceleration, g.
    pub(crate) fn margin_g(&self, lateral_g: Option<f64>) -> Option<f64> {
        Some(self.static_rollover_threshold_g? - lateral_g?.abs())
    }
}

/// The periodic status.
#[derive(Debug, Serialize)]
pub(crate) struct Status {
    pub(crate) state: &'static str,
    /// Signals that have arrived and are not missing.
    pub(crate) present: Vec<&'static str>,
    pub(crate) missing: Vec<&'static str>,
    #[serde(flatten)]
    pub(crate) result: Result,
    pub(crate) load_since_s: Option<f64>,
    /// Whether no turn has given a height since the start, so that the one there is may be that of another load.
    pub(crate) height_restored: bool,
    pub(crate) lateral_acceleration_g: Option<f64>,
    pub(crate) margin_g: Option<f64>,
    pub(crate) warning_level: usize,
    /// Whether speeds are requested at all.
    #[serde(skip)]
    pub(crate) requests_speed: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) requested_speed_mps: Option<f64>,
    pub(crate) samples: u64,
    #[serde(flatten)]
    pub(crate) counters: Counters,
}

/// Counters of the source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Counters {
    /// Frames or rows received.
    pub(crate) frames: u64,
    /// Frames dropped by the kernel.
    pub(crate) frames_lost: u64,
    /// Values ignored because another device sends the same quantity.
    pub(crate) values_of_other_sources: u64,
    /// Lines or frames that are not valid.
    pub(crate) malformed: u64,
    /// Error frames on the bus.
    pub(crate) error_frames: u64,
    /// Values that the truck cannot have; they count as absent.
    pub(crate) values_implausible: u64,
    /// Roll angles that their sensor reports as degraded; they are used.
    pub(crate) values_degraded: u64,
    /// Roll angles that their sensor reports as wrong; they count as absent.
    pub(crate) values_in_error: u64,
}

/// Delay from the time stamp of a frame to the end of its processing, ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Latency {
    pub(crate) p50: f64,
    pub(crate) p99: f64,
    pub(crate) greatest: f64,
}

/// An event as a line with its end.
pub(crate) fn line(time_s: f64, event: &Event<'_>) -> io::Result<String> {
    Ok(serde_json::to_string(&Line { time_s, event })? + "\n")
}

#[cfg(test)]
mod tests {
    use cg_core::Height;

    use super::*;

    const SOURCE: (f64, MassSource) = (20e3, MassSource::Signal);

    fn height(value: f64, sd: f64) -> Height<f64> {
        Height { height_m: Measured { value, sd }, random_sd_m: 0.5 * sd, maneuvers: 3 }
    }

    #[test]
    fn a_height_is_a_result_and_a_contradiction_is_not() {
        let good = height(2.0, 0.1);
        for (combined, status, has_height) in [
            (None, Verdict::Rejected, false),
            (Some(Combined::Agreed(good)), Verdict::Ok, true),
            (
                Some(Combined::Doubtful { height: good, chi_square: 9.0, freedom: 1 }),
                Verdict::Ok,
                true,
            ),
            (
                Some(Combined::Contradictory { chi_square: 50.0, freedom: 1 }),
                Verdict::Inconsistent,
                false,
            ),
            (Some(Combined::Impossible), Verdict::Inconsistent, false),
        ] {
            let result = Result::new(combined, None, SOURCE);
            assert_eq!(result.status, status);
            assert_eq!(result.height_m.is_some(), has_height);
            assert_eq!(result.channel.is_some(), has_height);
            assert_eq!((result.trailer_mass_kg, result.trailer_mass_source), SOURCE);
        }
    }

    #[test]
    fn a_result_has_its_interval_and_its_channel() {
        let result = Result::new(Some(Combined::Agreed(height(2.0, 0.1))), None, SOURCE);
        let [low, high] = result.height_ci95_m.unwrap();
        assert!((low - 1.804_003_6).abs() < 1e-9 && (high - 2.195_996_4).abs() < 1e-9);
        assert_eq!((result.height_m, result.height_sd_m), (Some(2.0), Some(0.1)));
        assert_eq!((result.channel.as_deref(), result.maneuvers), (Some("combined"), 3));
        let steer = Some(Channel::Steer);
        let result = Result::new(Some(Combined::Agreed(height(2.0, 0.1))), steer, SOURCE);
        assert_eq!(result.channel.as_deref(), Some("steer"));
    }

    #[test]
    fn the_margin_is_what_is_left_of_the_threshold() {
        let with = |limit| Result { static_rollover_threshold_g: limit, ..Result::default() };
        for lateral_g in [0.1, -0.1] {
            let margin_g = with(Some(0.4)).margin_g(Some(lateral_g)).unwrap();
            assert!((margin_g - 0.3).abs() < 1e-12);
        }
        assert_eq!(with(Some(0.4)).margin_g(None), None);
        assert_eq!(with(None).margin_g(Some(0.1)), None);
    }

    #[test]
    fn a_line_is_an_object_with_its_time_and_an_end() {
        let event = Event::Notice { subject: "trial", message: "text".to_owned() };
        let text = line(1.5, &event).unwrap();
        let line = r#"{"time_s":1.5,"event":"notice","subject":"trial","message":"text"}"#;
        assert_eq!(text, format!("{line}\n"));
    }
}
