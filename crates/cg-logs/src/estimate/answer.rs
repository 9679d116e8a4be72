//! The answer for one log, as it is printed.

use cg_core::{Maneuver, Outcome};
use serde::Serialize;

use super::options::Method;

/// Whether a log (or a maneuver) gave a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It did.
    Ok,
    /// It did not; the reason stands beside.
    #[default]
    Rejected,
    /// Channels or sensors contradict each other: no height, those of the channels stand beside.
    Inconsistent,
}

/// The answer for one log. Field names are the keys of the JSON output.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LogEstimate {
    /// Whether there is a height.
    pub status: Verdict,
    /// C.g. height of the trailer's sprung mass above ground at rest.
    pub height_m: Option<f64>,
    /// Its standard deviation, model uncertainty included.
    pub height_sd_m: Option<f64>,
    /// The part of it that noise explains and that more turns would reduce; not in the output.
    #[serde(skip)]
    pub height_random_sd_m: Option<f64>,
    /// Its 95 % interval.
    pub height_ci95_m: Option<[f64; 2]>,
    /// DC ratio, rad of roll per rad of steer or per m/s², at `speed_mps`.
    pub ratio: Option<f64>,
    /// Its standard deviation from noise.
    pub ratio_sd: Option<f64>,
    /// Identification used.
    pub method: Method,
    /// Channel used: `steer`, `lateral-acceleration` or `combined`. Ratio, fit and maneuvers of a
    /// combined answer are those of the channel that knows more.
    pub channel: Option<String>,
    /// Mean speed of the maneuvers.
    pub speed_mps: Option<f64>,
    /// Trailer mass taken.
    pub trailer_mass_kg: f64,
    /// Signal to noise of the best maneuver, dB.
    pub snr_db: Option<f64>,
    /// Fit of the best maneuver, %.
    pub fit_percent: Option<f64>,
    /// Lateral acceleration beyond which the vehicle tips in a steady turn, in g.
    pub static_rollover_threshold_g: Option<f64>,
    /// What each channel says alone.
    pub channels: Vec<ChannelEstimate>,
    /// Every maneuver, in the channel used; of a log with more than ten thousand the first ones.
    pub maneuvers: Vec<ManeuverEstimate>,
    /// What a reader should know.
    pub messages: Vec<String>,
}

/// What one channel says of a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChannelEstimate {
    /// `steer` or `lateral-acceleration`.
    pub channel: String,
    /// Height.
    pub height_m: Option<f64>,
    /// Its standard deviation, model uncertainty included.
    pub height_sd_m: Option<f64>,
    /// Whether there is a height.
    pub status: Verdict,
    /// Why not.
    pub reason: Option<String>,
}

/// One maneuver.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ManeuverEstimate {
    /// First time stamp used, as in the log.
    pub start_s: f64,
    /// Last time stamp used.
    pub end_s: f64,
    /// Height.
    pub height_m: Option<f64>,
    /// Its standard deviation from noise.
    pub height_sd_m: Option<f64>,
    /// DC ratio.
    pub ratio: Option<f64>,
    /// Its standard deviation from noise.
    pub ratio_sd: Option<f64>,
    /// Signal to noise, dB.
    pub snr_db: Option<f64>,
    /// Whether there is a height.
    pub status: Verdict,
    /// Why not.
    pub reason: Option<String>,
}

impl ManeuverEstimate {
    /// From what one channel says of a maneuver; `origin_s` is the time stamp of the estimator's zero.
    pub fn new(maneuver: &Maneuver<f64>, outcome: &Outcome<f64>, origin_s: f64) -> Self {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds = |time_us: u64| origin_s + time_us as f64 * 1e-6;
        Self {
            start_s: seconds(maneuver.start_us),
            end_s: seconds(maneuver.end_us),
            height_m: outcome.height_m.ok().map(|height| height.value),
            height_sd_m: outcome.height_m.ok().map(|height| height.sd),
            ratio: outcome.fit.map(|fit| fit.ratio.value),
            ratio_sd: outcome.fit.map(|fit| fit.ratio.sd),
            snr_db: outcome.fit.map(|fit| fit.snr_db),
            status: if outcome.height_m.is_ok() { Verdict::Ok } else { Verdict::Rejected },
            reason: outcome.height_m.err().map(|reason| reason.to_string()),
        }
    }
}
