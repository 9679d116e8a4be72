//! One log in, one answer out: the glue that the command line and Python share.

mod answer;
mod diagnosis;
mod engine;
mod finish;
mod messages;
mod prediction;
mod signals;

use cg_core::Maneuver;
use cg_core::{AlignSettings, Channel, Design, Measured, Sample, SampleError, Status};
use serde::Serialize;

pub use answer::{ChannelEstimate, LogEstimate, ManeuverEstimate, Verdict};
use engine::Engine;
pub use prediction::Prediction;
use signals::SignalCheck;

use crate::log::LogRow;
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Variant, Vehicle};

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE_95: f64 = 1.959_964;

/// Maneuvers that are kept of one log; more are counted only. A year on the road has some thousands.
const MOST_MANEUVERS: usize = 10_000;

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

/// Estimates one log, row by row. Memory grows with the number of maneuvers only, up to that of
/// ten thousand.
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
    check: SignalCheck,
    maneuvers: Vec<Maneuver<f64>>,
    /// Maneuvers beyond those that are kept.
    more_maneuvers: u64,
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
            check: SignalCheck::default(),
            maneuvers: Vec::new(),
            more_maneuvers: 0,
        }
    }

    /// Takes in one row; what it shows.
    ///
    /// # Errors
    /// [`SampleError`] if its time does not follow the row before (to a microsecond).
    pub fn push(&mut self, row: &LogRow) -> Result<Status, SampleError> {
        let sample = self.sample(row);
        let step = self.engine.push(&sample)?;
        self.check.push(&sample);
        self.rows += 1;
        if step.status == Status::Absent {
            self.absent_rows += 1;
        }
        self.keep(step.closed.as_ref());
        Ok(step.status)
    }

    fn keep(&mut self, closed: Option<&Maneuver<f64>>) {
        if self.maneuvers.len() < MOST_MANEUVERS {
            self.maneuvers.extend(closed);
        } else {
            self.more_maneuvers += u64::from(closed.is_some());
        }
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
}
