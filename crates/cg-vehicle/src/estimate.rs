//! One log in, one answer out: the glue that the command line and Python share.

use cg_core::arx::{ArxOptions, SampledArx};
use cg_core::estimator::{Maneuver, Outcome};
use cg_core::{
    Channel, Design, Estimator, FilteredArx, Prior, Rollover, Sample, SampleError, Settings, Step,
};
use serde::Serialize;

use crate::design::design;
use crate::error::VehicleError;
use crate::linear::Variant;
use crate::log::LogRow;
use crate::vehicle::Vehicle;

/// Two-sided 95 % quantile of the normal distribution.
const QUANTILE_95: f64 = 1.959_964;

/// Interval of the classical ARX (the source's 0.05 s): faster logs are thinned out.
const ARX_INTERVAL_S: f64 = 0.05;

/// How the DC ratio is identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// ARX on filtered signals with prior dynamics: the production method.
    #[default]
    Filtered,
    /// Classical shift-form ARX, as in the source.
    Arx,
    /// Nominal dynamics, only the gain is free: least variance, if the dynamics are right.
    Gain,
}

/// What to estimate with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateOptions {
    /// Equations of the vehicle model.
    pub variant: Variant,
    /// Identification.
    pub method: Method,
    /// Order of the classical ARX.
    pub order: usize,
    /// The channel to use; `None` takes the one that knows the height best.
    pub channel: Option<Channel>,
    /// Speed, whatever the log says.
    pub speed_mps: Option<f64>,
    /// Trailer mass, whatever the log says.
    pub trailer_mass_kg: Option<f64>,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self {
            variant: Variant::Complete,
            method: Method::Filtered,
            order: 5,
            channel: None,
            speed_mps: None,
            trailer_mass_kg: None,
        }
    }
}

/// Whether a log (or a maneuver) gave a height.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It did.
    Ok,
    /// It did not; the reason stands beside.
    Rejected,
}

/// The answer for one log. Field names are the keys of the JSON output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogEstimate {
    /// Whether there is a height.
    pub status: Verdict,
    /// C.g. height of the trailer's sprung mass above ground at rest.
    pub height_m: Option<f64>,
    /// Its standard deviation, model uncertainty included.
    pub height_sd_m: Option<f64>,
    /// Its 95 % interval.
    pub height_ci95_m: Option<[f64; 2]>,
    /// DC ratio, rad of roll per rad of steer or per m/s², at `speed_mps`.
    pub ratio: Option<f64>,
    /// Its standard deviation from noise.
    pub ratio_sd: Option<f64>,
    /// Identification used.
    pub method: Method,
    /// Channel used: `steer` or `lateral-acceleration`.
    pub channel: Option<String>,
    /// Mean speed of the maneuvers.
    pub speed_mps: Option<f64>,
    /// Trailer mass taken.
    pub trailer_mass_kg: f64,
    /// Signal to noise of the best maneuver, dB.
    pub snr_db: Option<f64>,
    /// Fit of the best maneuver, %.
    pub fit_percent: Option<f64>,
    /// Lateral acceleration of wheel lift, in g.
    pub static_rollover_threshold_g: Option<f64>,
    /// Every maneuver, in the channel used.
    pub maneuvers: Vec<ManeuverEstimate>,
    /// What a reader should know.
    pub messages: Vec<String>,
}

/// One maneuver.
#[derive(Clone, Debug, PartialEq, Serialize)]
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

/// The estimator of the chosen method.
#[derive(Clone)]
enum Engine {
    Filtered(Box<Estimator<f64, FilteredArx<f64>>>),
    Arx(Box<Estimator<f64, SampledArx<f64>>>),
}

impl Engine {
    fn new(design: &Design<f64>, options: &EstimateOptions) -> Self {
        let settings = Settings::truck();
        let standard = Prior::standard();
        match options.method {
            Method::Filtered => {
                Self::Filtered(Box::new(Estimator::new(design, settings, standard)))
            }
            Method::Gain => {
                let fixed = Prior { dynamics_sd: 0.0, ..standard };
                Self::Filtered(Box::new(Estimator::new(design, settings, fixed)))
            }
            Method::Arx => {
                let arx = ArxOptions { order: options.order, interval_s: ARX_INTERVAL_S };
                Self::Arx(Box::new(Estimator::new(design, settings, arx)))
            }
        }
    }

    fn push(&mut self, sample: &Sample<f64>) -> Result<Step<f64>, SampleError> {
        match self {
            Self::Filtered(estimator) => estimator.push(sample),
            Self::Arx(estimator) => estimator.push(sample),
        }
    }

    fn finish(&mut self) -> Option<Maneuver<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.finish(),
            Self::Arx(estimator) => estimator.finish(),
        }
    }

    fn height(&self, channel: Channel) -> Option<cg_core::Height<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.height(channel),
            Self::Arx(estimator) => estimator.height(channel),
        }
    }

    fn best_channel(&self) -> Option<Channel> {
        match self {
            Self::Filtered(estimator) => estimator.best_channel(),
            Self::Arx(estimator) => estimator.best_channel(),
        }
    }
}

/// Estimates one log, row by row. Memory grows with the number of maneuvers only.
#[derive(Clone)]
pub struct LogEstimator {
    design: Design<f64>,
    options: EstimateOptions,
    steering_ratio: Option<f64>,
    engine: Engine,
    origin_s: Option<f64>,
    rows: u64,
    absent_rows: u64,
    seen: Seen,
    trailer_mass_kg: f64,
    greatest_mps2: f64,
    maneuvers: Vec<Maneuver<f64>>,
}

/// Which optional signals the log has had.
#[derive(Clone, Copy, Default)]
struct Seen {
    speed: bool,
    mass: bool,
    unscaled_steering_wheel: bool,
}

impl LogEstimator {
    /// An estimator for logs of `vehicle`.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle makes no usable design.
    pub fn new(vehicle: &Vehicle, options: EstimateOptions) -> Result<Self, VehicleError> {
        Ok(Self::from_design(&design(vehicle, options.variant)?, vehicle.steering_ratio, options))
    }

    /// The same from a design that is computed already.
    pub fn from_design(
        design: &Design<f64>,
        steering_ratio: Option<f64>,
        options: EstimateOptions,
    ) -> Self {
        Self {
            engine: Engine::new(design, &options),
            design: *design,
            options,
            steering_ratio,
            origin_s: None,
            rows: 0,
            absent_rows: 0,
            seen: Seen::default(),
            trailer_mass_kg: options.trailer_mass_kg.unwrap_or(design.nominal_trailer_mass_kg),
            greatest_mps2: 0.0,
            maneuvers: Vec::new(),
        }
    }

    /// Takes in one row.
    ///
    /// # Errors
    /// [`SampleError`] if its time does not follow the row before (to a microsecond).
    pub fn push(&mut self, row: &LogRow) -> Result<(), SampleError> {
        let sample = self.sample(row);
        let step = self.engine.push(&sample)?;
        self.rows += 1;
        if step.status == cg_core::Status::Absent {
            self.absent_rows += 1;
        }
        if row.lateral_acceleration_mps2.abs() > self.greatest_mps2 {
            self.greatest_mps2 = row.lateral_acceleration_mps2.abs();
        }
        self.maneuvers.extend(step.closed);
        Ok(())
    }

    fn sample(&mut self, row: &LogRow) -> Sample<f64> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s);
        let steer_rad = if row.steer_rad.is_nan() && !row.steering_wheel_rad.is_nan() {
            self.seen.unscaled_steering_wheel |= self.steering_ratio.is_none();
            row.steering_wheel_rad / self.steering_ratio.unwrap_or(f64::NAN)
        } else {
            row.steer_rad
        };
        self.seen.speed |= row.speed_mps.is_finite();
        if row.trailer_mass_kg.is_finite() {
            self.seen.mass = true;
            if self.options.trailer_mass_kg.is_none() {
                self.trailer_mass_kg = row.trailer_mass_kg;
            }
        }
        // Microseconds since the first row; the cast saturates at zero for a step back in time,
        // which the estimator then refuses.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6).round() as u64;
        Sample {
            time_us,
            steer_rad,
            roll_rad: row.roll_rad,
            tilt_rad: row.tilt_rad,
            speed_mps: self.options.speed_mps.unwrap_or(row.speed_mps),
            lateral_acceleration_mps2: row.lateral_acceleration_mps2,
            yaw_rate_radps: row.yaw_rate_radps,
            trailer_mass_kg: self.options.trailer_mass_kg.unwrap_or(row.trailer_mass_kg),
        }
    }

    /// Ends the log.
    pub fn finish(mut self) -> LogEstimate {
        self.maneuvers.extend(self.engine.finish());
        let channel = self.options.channel.or_else(|| self.engine.best_channel());
        let shown = channel.unwrap_or(Channel::LateralAcceleration);
        let outcome = |maneuver: &Maneuver<f64>| maneuver.outcomes[shown.index()];
        let best = self
            .maneuvers
            .iter()
            .filter_map(|maneuver| Some((maneuver, outcome(maneuver).height_m.ok()?.sd)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(maneuver, _)| *maneuver);
        let fused = channel.and_then(|channel| self.engine.height(channel));
        let mut estimate = self.unanswered(shown, channel);
        estimate.messages = self.messages();
        let (Some(best), Some(fused)) = (best, fused) else {
            let reason = self.rejection(shown);
            estimate.messages.insert(0, reason);
            return estimate;
        };
        let (height, sd) = (fused.height_m.value, fused.height_m.sd);
        estimate.status = Verdict::Ok;
        estimate.height_m = Some(height);
        estimate.height_sd_m = Some(sd);
        estimate.height_ci95_m = Some([height - QUANTILE_95 * sd, height + QUANTILE_95 * sd]);
        let fit = outcome(&best).fit;
        estimate.snr_db = fit.map(|fit| fit.snr_db);
        estimate.fit_percent = fit.map(|fit| fit.fit_percent);
        self.describe(&mut estimate, shown, &fused, &best);
        estimate
    }

    /// Ratio, speed and rollover threshold of the fused height.
    fn describe(
        &self,
        estimate: &mut LogEstimate,
        channel: Channel,
        fused: &cg_core::Height<f64>,
        best: &Maneuver<f64>,
    ) {
        let good: Vec<_> = self
            .maneuvers
            .iter()
            .filter(|maneuver| maneuver.outcomes[channel.index()].height_m.is_ok())
            .collect();
        #[allow(clippy::cast_precision_loss)] // a count
        let speed_mps = good.iter().map(|m| m.speed_mps).sum::<f64>() / good.len() as f64;
        estimate.speed_mps = Some(speed_mps);
        let (h, random) = (fused.height_m.value, fused.random_sd_m);
        let line = |channel| self.design.line(channel, speed_mps, best.trailer_mass_kg);
        if let Some(line) = line(channel) {
            let compensation = self.design.channels[channel.index()].compensation.value;
            let slope = (line.ratio_at(h + 0.01) - line.ratio_at(h - 0.01)) / 0.02;
            estimate.ratio = Some(compensation * line.ratio_at(h));
            estimate.ratio_sd = Some((compensation * slope * random).abs());
        }
        if let Some(line) = line(Channel::LateralAcceleration) {
            let compensation =
                self.design.channels[Channel::LateralAcceleration.index()].compensation.value;
            let rollover: Rollover<f64> = self.design.rollover.at(
                fused.height_m,
                best.trailer_mass_kg,
                &line,
                compensation,
                self.design.gravity_mps2,
            );
            estimate.static_rollover_threshold_g = Some(rollover.static_rollover_threshold_g.value);
        }
    }

    fn unanswered(&self, shown: Channel, channel: Option<Channel>) -> LogEstimate {
        let origin_s = self.origin_s.unwrap_or(0.0);
        LogEstimate {
            status: Verdict::Rejected,
            height_m: None,
            height_sd_m: None,
            height_ci95_m: None,
            ratio: None,
            ratio_sd: None,
            method: self.options.method,
            channel: channel.map(|channel| channel.to_string()),
            speed_mps: None,
            trailer_mass_kg: self.trailer_mass_kg,
            snr_db: None,
            fit_percent: None,
            static_rollover_threshold_g: None,
            maneuvers: self
                .maneuvers
                .iter()
                .map(|maneuver| {
                    describe_maneuver(maneuver, &maneuver.outcomes[shown.index()], origin_s)
                })
                .collect(),
            messages: Vec::new(),
        }
    }

    /// Why there is no height.
    fn rejection(&self, shown: Channel) -> String {
        if self.rows == self.absent_rows {
            return "rejected: no row has a roll angle and an input".to_owned();
        }
        let reasons: Vec<String> = self
            .maneuvers
            .iter()
            .filter_map(|maneuver| maneuver.outcomes[shown.index()].height_m.err())
            .map(|reason| reason.to_string())
            .collect();
        match reasons.last() {
            None => "rejected: unexcited, the log holds no turn (0.5 m/s² of lateral \
                     acceleration or more): drive a curve"
                .to_owned(),
            Some(last) => format!("rejected: {last}"),
        }
    }

    fn messages(&self) -> Vec<String> {
        let mut messages = Vec::new();
        if !self.seen.speed && self.options.speed_mps.is_none() {
            messages.push(format!(
                "no speed in the log: {:.2} m/s of the vehicle file taken; give --speed-mps",
                self.design.nominal_speed_mps
            ));
        }
        if !self.seen.mass && self.options.trailer_mass_kg.is_none() {
            messages.push(format!(
                "no trailer mass in the log: {:.0} kg of the vehicle file taken; give \
                 --trailer-mass-kg (mass and height are confounded)",
                self.design.nominal_trailer_mass_kg
            ));
        }
        if self.seen.unscaled_steering_wheel {
            messages.push(
                "the log has the steering-wheel angle but the vehicle file no steering_ratio: \
                 steer channel not used"
                    .to_owned(),
            );
        }
        if self.absent_rows > 0 {
            messages.push(format!(
                "{} of {} rows have no roll angle or no input and were left out",
                self.absent_rows, self.rows
            ));
        }
        messages
    }
}

fn describe_maneuver(
    maneuver: &Maneuver<f64>,
    outcome: &Outcome<f64>,
    origin_s: f64,
) -> ManeuverEstimate {
    #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
    let seconds = |time_us: u64| origin_s + time_us as f64 * 1e-6;
    ManeuverEstimate {
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
