//! The result for one log, as it is printed.

use cg_core::{Maneuver, Outcome};
use cg_vehicle::lift::LiftAxle;
use serde::Serialize;

use super::options::Method;

/// Whether a log or a maneuver gave a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// There is a height.
    Ok,
    /// There is no height; the reason is given with it.
    #[default]
    Rejected,
    /// There is no combined height because channels or sensors contradict each other. The result
    /// contains the heights of the channels.
    Inconsistent,
}

/// The result for one log. The names of the fields are the keys of the JSON output.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LogEstimate {
    /// Whether there is a height.
    pub status: Verdict,
    /// Height of the c.g. of the trailer's sprung mass above the ground at rest, m.
    pub height_m: Option<f64>,
    /// Standard deviation of the height, m, with the uncertainty of the model.
    pub height_sd_m: Option<f64>,
    /// The part of the standard deviation that is due to noise and decreases with more turns, m. It
    /// is not part of the output.
    #[serde(skip)]
    pub height_random_sd_m: Option<f64>,
    /// 95 % interval of the height, m.
    pub height_ci95_m: Option<[f64; 2]>,
    /// DC ratio, rad of roll per rad of steer or per m/s², at `speed_mps`.
    pub ratio: Option<f64>,
    /// Standard deviation of the ratio due to noise.
    pub ratio_sd: Option<f64>,
    /// Method of identification.
    pub method: Method,
    /// Channel used: `steer`, `lateral-acceleration` or `combined`. Ratio, fit and maneuvers of a
    /// combined result are those of the channel with the smaller uncertainty.
    pub channel: Option<String>,
    /// Mean speed of the maneuvers, m/s.
    pub speed_mps: Option<f64>,
    /// Trailer mass used, kg.
    pub trailer_mass_kg: f64,
    /// Where the lift axles were, of a trailer that has any.
    pub lift_axle: Option<LiftAxle>,
    /// Signal-to-noise ratio of the best maneuver, dB.
    pub snr_db: Option<f64>,
    /// Fit of the best maneuver, %.
    pub fit_percent: Option<f64>,
    /// Lateral acceleration above which the vehicle rolls over in a steady turn, g.
    pub static_rollover_threshold_g: Option<f64>,
    /// 95 % interval of this threshold in a turn to one side, g: the height, the model of the threshold, and the place
    /// of the payload beside the middle.
    pub static_rollover_threshold_ci95_g: Option<[f64; 2]>,
    /// Share of the variance of the height that the unknown bank of the road makes, from 0 to 1.
    pub road_share: Option<f64>,
    /// The result of each channel alone.
    pub channels: Vec<ChannelEstimate>,
    /// All maneuvers of the channel used; of a log with more than ten thousand, only the first
    /// ones.
    pub maneuvers: Vec<ManeuverEstimate>,
    /// Messages for the user.
    pub messages: Vec<String>,
}

/// The result of one channel for a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChannelEstimate {
    /// `steer` or `lateral-acceleration`.
    pub channel: String,
    /// Height, m.
    pub height_m: Option<f64>,
    /// Standard deviation of the height, m, with the uncertainty of the model.
    pub height_sd_m: Option<f64>,
    /// Whether there is a height.
    pub status: Verdict,
    /// The reason if there is no height.
    pub reason: Option<String>,
}

/// The result of one maneuver.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ManeuverEstimate {
    /// First time stamp used, s, as in the log.
    pub start_s: f64,
    /// Last time stamp used, s, as in the log.
    pub end_s: f64,
    /// Height, m.
    pub height_m: Option<f64>,
    /// Standard deviation of the height due to noise, m.
    pub height_sd_m: Option<f64>,
    /// DC ratio, rad of roll per rad of steer or per m/s².
    pub ratio: Option<f64>,
    /// Standard deviation of the ratio due to noise.
    pub ratio_sd: Option<f64>,
    /// Signal-to-noise ratio, dB.
    pub snr_db: Option<f64>,
    /// Whether there is a height.
    pub status: Verdict,
    /// The reason if there is no height.
    pub reason: Option<String>,
}

impl ManeuverEstimate {
    /// The result of one channel for a maneuver. `origin_s` is the time stamp of the estimator's
    /// time zero, s.
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
