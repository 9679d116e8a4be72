//! Takes in the samples of a log.

use cg_core::Maneuver;
use cg_core::{AlignSettings, Design, Measured, Sample, SampleError, Status};

use super::engine::Engine;
use super::options::EstimateOptions;
use super::signals::SignalCheck;
use crate::log::LogRow;
use cg_vehicle::Vehicle;
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;

/// Maneuvers that are kept of one log; more are counted only. A year on the road has some thousands.
const MOST_MANEUVERS: usize = 10_000;

/// What a log says of the DC ratios.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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
    /// Maneuvers beyond those that are kept.
    pub(super) more_maneuvers: u64,
}

/// Which optional signals the log has had.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "one for each thing to tell")]
pub(super) struct Seen {
    pub(super) speed: bool,
    pub(super) mass: bool,
    pub(super) unscaled_steering_wheel: bool,
    pub(super) unscaled_pressure: bool,
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

    pub(super) fn keep(&mut self, closed: Option<&Maneuver<f64>>) {
        if self.maneuvers.len() < MOST_MANEUVERS {
            self.maneuvers.extend(closed);
        } else {
            self.more_maneuvers += u64::from(closed.is_some());
        }
    }

    pub(super) fn sample(&mut self, row: &LogRow) -> Sample<f64> {
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
