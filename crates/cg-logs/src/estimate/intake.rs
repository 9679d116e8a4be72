//! Processes the rows of a log.

use cg_core::Maneuver;
use cg_core::{AlignSettings, CHANNELS, Design, Measured, Sample, SampleError, Status};

use super::engine::Engine;
use super::options::EstimateOptions;
use super::signals::SignalCheck;
use crate::log::LogRow;
use cg_vehicle::Vehicle;
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;

/// Number of maneuvers of a log that are kept; further ones are only counted. A year of driving has
/// some thousands.
const MOST_MANEUVERS: usize = 10_000;

/// The DC ratios identified from a log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Identified {
    /// Mean speed of the maneuvers, m/s.
    pub speed_mps: f64,
    /// Trailer mass used, kg.
    pub trailer_mass_kg: f64,
    /// Whether the mass comes from the log or the options, and not from the vehicle file.
    pub trailer_mass_is_known: bool,
    /// DC ratios in the order of [`Channel::ALL`](cg_core::Channel::ALL), with the standard deviation due to noise.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Messages for the user.
    pub messages: Vec<String>,
}

/// Estimates the height from one log, row by row. Its memory grows only with the number of
/// maneuvers, up to ten thousand.
#[derive(Clone)]
pub struct LogEstimator {
    pub(super) design: Design<f64>,
    pub(super) options: EstimateOptions,
    pub(super) settings: AlignSettings<f64>,
    pub(super) engine: Engine,
    pub(super) origin_s: Option<f64>,
    pub(super) rows: u64,
    pub(super) absent_rows: u64,
    pub(super) seen: Seen,
    pub(super) trailer_mass_kg: f64,
    pub(super) check: SignalCheck,
    pub(super) maneuvers: Vec<Maneuver<f64>>,
    /// Number of maneuvers that are not kept.
    pub(super) more_maneuvers: u64,
}

/// Which optional signals the log contains.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "one flag per signal")]
pub(super) struct Seen {
    pub(super) speed: bool,
    pub(super) mass: bool,
    pub(super) unscaled_steering_wheel: bool,
    pub(super) unscaled_pressure: bool,
    pub(super) unscaled_level: bool,
}

impl LogEstimator {
    /// An estimator for logs of `vehicle`.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle gives no usable design.
    pub fn new(vehicle: &Vehicle, options: EstimateOptions) -> Result<Self, VehicleError> {
        let design = design(vehicle, options.variant)?;
        Ok(Self::from_design(&design, vehicle.align_settings(), options.on_roads_of(vehicle)))
    }

    /// An estimator with an existing design.
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

    /// Processes one row and returns the state of the estimator.
    ///
    /// # Errors
    /// [`SampleError`] if the time is not later than that of the previous row (at a resolution of 1
    /// µs).
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

    pub(super) fn keep(&mut self, closed: Option<&Maneuver<f64>>) {
        if self.maneuvers.len() < MOST_MANEUVERS {
            self.maneuvers.extend(closed);
        } else {
            self.more_maneuvers += u64::from(closed.is_some());
        }
    }

    pub(super) fn sample(&mut self, row: &LogRow) -> Sample<f64> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s);
        // Microseconds since the first row. The cast gives zero for a time before the first row,
        // which the estimator then refuses.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6).round() as u64;
        let mut sample = row.sample(time_us, &self.settings);
        self.seen.unscaled_steering_wheel |=
            sample.steer_rad.is_nan() && !row.steering_wheel_rad.is_nan();
        self.seen.unscaled_pressure |=
            sample.trailer_mass_kg.is_nan() && !row.trailer_suspension_pressure_pa.is_nan();
        self.seen.unscaled_level |= (sample.suspension_roll_rad.is_nan()
            && !row.level_left_m.is_nan())
            || (sample.tractor_suspension_roll_rad.is_nan() && !row.tractor_level_left_m.is_nan());
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
