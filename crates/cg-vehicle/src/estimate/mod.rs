//! One log in, one answer out: the glue that the command line and Python share.

mod answer;
mod engine;
mod prediction;

use cg_core::estimator::Maneuver;
use cg_core::{AlignSettings, Channel, Design, Measured, Sample, SampleError, Status};
use serde::Serialize;

pub use answer::{LogEstimate, ManeuverEstimate, Verdict};
use engine::Engine;
pub use prediction::Prediction;

use crate::design::design;
use crate::error::VehicleError;
use crate::linear::Variant;
use crate::log::LogRow;
use crate::vehicle::Vehicle;

/// Two-sided 95 % quantile of the normal distribution.
pub(crate) const QUANTILE_95: f64 = 1.959_964;

/// What [`LogEstimate::channel`] says when both went in.
const COMBINED: &str = "combined";

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
    /// The channel to use; `None` combines both, each with the weight of what it knows.
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

/// What a log says of the DC ratios.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// Mean speed of the maneuvers.
    pub speed_mps: f64,
    /// Trailer mass taken.
    pub trailer_mass_kg: f64,
    /// Whether log or options gave it (or else the vehicle file).
    pub trailer_mass_is_known: bool,
    /// DC ratios in the order of [`Channel::ALL`], with the standard deviation from noise.
    pub ratio: [Option<Measured<f64>>; 2],
    /// What a reader should know.
    pub messages: Vec<String>,
}

/// Estimates one log, row by row. Memory grows with the number of maneuvers only.
#[derive(Clone)]
pub struct LogEstimator {
    design: Design<f64>,
    options: EstimateOptions,
    settings: AlignSettings<f64>,
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
#[allow(clippy::struct_excessive_bools, reason = "one for each thing to tell")]
struct Seen {
    speed: bool,
    mass: bool,
    unscaled_steering_wheel: bool,
    unscaled_pressure: bool,
}

impl LogEstimator {
    /// An estimator for logs of `vehicle`.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle makes no usable design.
    pub fn new(vehicle: &Vehicle, options: EstimateOptions) -> Result<Self, VehicleError> {
        Ok(Self::from_design(&design(vehicle, options.variant)?, vehicle.align_settings(), options))
    }

    /// The same from a design that is computed already.
    pub fn from_design(
        design: &Design<f64>,
        settings: AlignSettings<f64>,
        options: EstimateOptions,
    ) -> Self {
        Self {
            engine: Engine::new(design, &options),
            design: *design,
            options,
            settings,
            origin_s: None,
            rows: 0,
            absent_rows: 0,
            seen: Seen::default(),
            trailer_mass_kg: options.trailer_mass_kg.unwrap_or(design.nominal_trailer_mass_kg),
            greatest_mps2: 0.0,
            maneuvers: Vec::new(),
        }
    }

    /// Takes in one row; what it shows.
    ///
    /// # Errors
    /// [`SampleError`] if its time does not follow the row before (to a microsecond).
    pub fn push(&mut self, row: &LogRow) -> Result<Status, SampleError> {
        let sample = self.sample(row);
        let step = self.engine.push(&sample)?;
        self.rows += 1;
        if step.status == Status::Absent {
            self.absent_rows += 1;
        }
        if row.lateral_acceleration_mps2.abs() > self.greatest_mps2 {
            self.greatest_mps2 = row.lateral_acceleration_mps2.abs();
        }
        self.maneuvers.extend(step.closed);
        Ok(step.status)
    }

    fn sample(&mut self, row: &LogRow) -> Sample<f64> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s);
        // Microseconds since the first row; the cast saturates at zero for a step back in time,
        // which the estimator then refuses.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6).round() as u64;
        let mut sample = row.sample(time_us, &self.settings);
        self.seen.unscaled_steering_wheel |=
            sample.steer_rad.is_nan() && !row.steering_wheel_rad.is_nan();
        self.seen.unscaled_pressure |=
            sample.trailer_mass_kg.is_nan() && !row.trailer_suspension_pressure_pa.is_nan();
        self.seen.speed |= sample.speed_mps.is_finite();
        self.seen.mass |= sample.trailer_mass_kg.is_finite();
        if let Some(speed_mps) = self.options.speed_mps {
            sample.speed_mps = speed_mps;
        }
        if let Some(mass_kg) = self.options.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
        } else if sample.trailer_mass_kg.is_finite() {
            self.trailer_mass_kg = sample.trailer_mass_kg;
        }
        sample
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
        let fused = match self.options.channel {
            Some(channel) => self.engine.height(channel),
            None => self.engine.combined_height(),
        };
        let mut estimate = self.unanswered(shown, channel);
        if self.options.channel.is_none() && self.is_combined() {
            estimate.channel = Some(COMBINED.to_owned());
        }
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
        estimate.height_random_sd_m = Some(fused.random_sd_m);
        estimate.height_ci95_m = Some([height - QUANTILE_95 * sd, height + QUANTILE_95 * sd]);
        let fit = outcome(&best).fit;
        estimate.snr_db = fit.map(|fit| fit.snr_db);
        estimate.fit_percent = fit.map(|fit| fit.fit_percent);
        self.describe(&mut estimate, shown, &fused, &best);
        estimate
    }

    /// Whether both channels have a height.
    fn is_combined(&self) -> bool {
        Channel::ALL.iter().all(|&channel| self.engine.height(channel).is_some())
    }

    /// Ratio, speed and rollover threshold of the fused height.
    fn describe(
        &self,
        estimate: &mut LogEstimate,
        channel: Channel,
        fused: &cg_core::Height<f64>,
        best: &Maneuver<f64>,
    ) {
        estimate.speed_mps = self.mean_speed_mps(&[channel]);
        let Some(speed_mps) = estimate.speed_mps else { return };
        if let Some(ratio) = self.ratio_of(channel, fused, speed_mps, best.trailer_mass_kg) {
            estimate.ratio = Some(ratio.value);
            estimate.ratio_sd = Some(ratio.sd);
        }
        estimate.static_rollover_threshold_g = self
            .design
            .rollover(fused.height_m, best.trailer_mass_kg)
            .map(|rollover| rollover.static_rollover_threshold_g.value);
    }

    /// Mean speed of the maneuvers that gave a height in one of these channels.
    fn mean_speed_mps(&self, channels: &[Channel]) -> Option<f64> {
        let speeds: Vec<f64> = self
            .maneuvers
            .iter()
            .filter(|maneuver| {
                channels.iter().any(|channel| maneuver.outcomes[channel.index()].height_m.is_ok())
            })
            .map(|maneuver| maneuver.speed_mps)
            .collect();
        #[allow(clippy::cast_precision_loss)] // a count
        let n = speeds.len() as f64;
        (n > 0.0).then(|| speeds.iter().sum::<f64>() / n)
    }

    /// The DC ratio that a height means, with the standard deviation that noise gives it.
    fn ratio_of(
        &self,
        channel: Channel,
        height: &cg_core::Height<f64>,
        speed_mps: f64,
        trailer_mass_kg: f64,
    ) -> Option<Measured<f64>> {
        let line = self.design.line(channel, speed_mps, trailer_mass_kg)?;
        let compensation = self.design.channels[channel.index()].compensation;
        let h = height.height_m.value;
        let slope = (line.ratio_at(h + 0.01) - line.ratio_at(h - 0.01)) / 0.02;
        let sd = (compensation * slope * height.random_sd_m).abs();
        Some(Measured { value: compensation * line.ratio_at(h), sd })
    }

    /// Ends the log: what it says of the DC ratios, whatever the height behind them. Both are
    /// fused over the maneuvers, at the mean speed and trailer mass that stand beside.
    pub fn identified(mut self) -> Identified {
        self.maneuvers.extend(self.engine.finish());
        let mut identified = Identified {
            speed_mps: self.mean_speed_mps(&Channel::ALL).unwrap_or(f64::NAN),
            trailer_mass_kg: self.trailer_mass_kg,
            trailer_mass_is_known: self.seen.mass || self.options.trailer_mass_kg.is_some(),
            ratio: [None; 2],
            messages: self.messages(),
        };
        for channel in Channel::ALL {
            let Some(height) = self.engine.height(channel) else {
                identified.messages.push(format!("{channel} channel: {}", self.rejection(channel)));
                continue;
            };
            // Heights do not depend on speed: both ratios can be told at one.
            identified.ratio[channel.index()] =
                self.ratio_of(channel, &height, identified.speed_mps, self.trailer_mass_kg);
        }
        identified
    }

    fn unanswered(&self, shown: Channel, channel: Option<Channel>) -> LogEstimate {
        let origin_s = self.origin_s.unwrap_or(0.0);
        LogEstimate {
            status: Verdict::Rejected,
            height_m: None,
            height_sd_m: None,
            height_random_sd_m: None,
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
                    ManeuverEstimate::new(maneuver, &maneuver.outcomes[shown.index()], origin_s)
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
        if self.seen.unscaled_pressure && !self.seen.mass {
            messages.push(
                "the log has the suspension pressure but the vehicle file no \
                 trailer.suspension_pressure: mass not taken from it"
                    .to_owned(),
            );
        }
        if let Some(since_us) = self.engine.load_since_us() {
            #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
            let since_s = self.origin_s.unwrap_or(0.0) + since_us as f64 * 1e-6;
            messages.push(format!(
                "the load changed before {since_s:.0} s: the height is that of the last load"
            ));
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
