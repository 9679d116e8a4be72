//! A scenario ready to run, and its log.

use std::convert::Infallible;

use super::models::Models;
use super::nonlinear::{Recorded, record, record_on_road};
use super::scenario::{Motion, Plant, RoadTruth, Scenario, Track, Truth};
use super::signals::Signals;
use crate::maneuver::Histories;
use crate::road::Road;
use crate::sensors::{ChassisSensors, Instruments};
use cg_logs::log::{LogRow, Signal};
use cg_vehicle::Vehicle;
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;

/// Lateral acceleration that the default steer amplitude gives, in g (the thesis stays below 0.2).
const DEFAULT_LATERAL_G: f64 = 0.17;
/// The same for a maneuver to rollover: more than trucks sustain.
const ROLLOVER_LATERAL_G: f64 = 1.2;

/// The source of the motions.
enum Source {
    /// Stored rows of the nonlinear plant, to avoid computing them twice.
    Recorded(Vec<LogRow>),
    /// Models that are fast enough to run each time.
    Models(Box<(Models, Histories)>),
}

/// A scenario ready to run.
pub struct LogSimulation {
    source: Source,
    scenario: Scenario,
    gravity_mps2: f64,
    steering_ratio: f64,
    signals: Signals,
    samples: u64,
    /// The truth of the log.
    pub truth: Truth,
    /// Where the vehicle was, if it drove on a road.
    pub track: Option<Track>,
}

impl LogSimulation {
    /// Prepares a scenario. If noise is requested, it is run once to determine the noise level.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle has no such load or model, or a number is invalid.
    pub fn new(vehicle: &Vehicle, scenario: Scenario) -> Result<Self, VehicleError> {
        scenario.check(vehicle)?;
        let vehicle = &*scenario.loaded(vehicle)?;
        let (histories, ratio) = histories(vehicle, &scenario)?;
        let samples = samples(&scenario);
        let mut truth = Truth::of(vehicle, &scenario, histories.amplitude_rad(), ratio);
        let source = match scenario.plant {
            Plant::Nonlinear => {
                let Recorded { rows, rolled_over_s, .. } =
                    record(vehicle, &scenario, &histories, samples)?;
                truth.rolled_over_s = rolled_over_s;
                if scenario.course.is_some() {
                    truth.steer_rad = greatest_steer_rad(&rows);
                }
                Source::Recorded(rows)
            }
            Plant::Linear | Plant::Reduced => {
                let models = Models::new(vehicle, &scenario, &histories, samples)?;
                Source::Models(Box::new((models, histories)))
            }
        };
        Self { source, truth, ..Self::empty(vehicle, scenario, samples, None) }.with_noise()
    }

    /// Drives the nonlinear plant along a road, with sensors of the chassis. The steer history,
    /// the course and the start time of the scenario are not used. Where the road has no speed
    /// limit, the limit is the speed of the scenario.
    ///
    /// # Errors
    /// As [`new`](Self::new); also if the road is too short, or if the vehicle rolls over.
    pub fn on_road(
        vehicle: &Vehicle,
        scenario: Scenario,
        road: &Road,
        chassis: &ChassisSensors,
    ) -> Result<Self, VehicleError> {
        let limited;
        let road = if road.has_speed() {
            road
        } else {
            limited = road.clone().limited_to(scenario.speed_mps);
            &limited
        };
        let (pace, [start_m, end_m]) = (road.pace(), road.ends_m());
        let whole_s = pace.time_s(start_m, end_m);
        let mut scenario = Scenario { plant: Plant::Nonlinear, start_s: 0.0, ..scenario };
        scenario.course = None;
        scenario.speed_change = 0.0;
        if scenario.sensors.inclinometer {
            return Err(VehicleError::Model(
                "⟨inclinometer⟩: a log of a drive on a road has the tilt already".to_owned(),
            ));
        }
        if scenario.duration_s > whole_s + 1.0 / scenario.rate_hz {
            return Err(VehicleError::Model(format!(
                "{}: the road ends after {whole_s:.1} s; reduce ⟨duration_s⟩",
                road.name()
            )));
        }
        scenario.check(vehicle)?;
        let vehicle = &*scenario.loaded(vehicle)?;
        chassis.check()?;
        let samples = samples(&scenario);
        let recorded = record_on_road(vehicle, &scenario, road, samples)?;
        let track = recorded.track.unwrap_or_default();
        let end_m = track.distance_m.last().copied().unwrap_or(start_m);
        scenario.speed_mps = (end_m - start_m) / scenario.duration_s;
        let (_, ratio) = histories(vehicle, &scenario)?;
        let steer_rad = greatest_steer_rad(&recorded.rows);
        let banks = || track.bank_rad.iter().copied();
        let truth = Truth {
            road: Some(RoadTruth {
                name: road.name().to_owned(),
                driven_m: end_m - start_m,
                bank_rad: [
                    banks().fold(f64::INFINITY, f64::min),
                    banks().fold(f64::NEG_INFINITY, f64::max),
                ],
                is_twisted: road.is_twisted(),
            }),
            chassis: Some(*chassis),
            rolled_over_s: recorded.rolled_over_s,
            ..Truth::of(vehicle, &scenario, steer_rad, ratio)
        };
        let source = Source::Recorded(recorded.rows);
        Self { source, truth, ..Self::empty(vehicle, scenario, samples, Some(track)) }.with_noise()
    }

    fn empty(vehicle: &Vehicle, scenario: Scenario, samples: u64, track: Option<Track>) -> Self {
        Self {
            source: Source::Recorded(Vec::new()),
            scenario,
            gravity_mps2: vehicle.gravity_mps2,
            steering_ratio: vehicle.steering_ratio.unwrap_or(1.0),
            signals: Signals::new(vehicle, scenario.load.trailer_mass_kg, track.is_some()),
            samples,
            truth: Truth::of(vehicle, &scenario, 0.0, 0.0),
            track,
        }
    }

    /// With the standard deviation of the noise that its signal-to-noise ratio requires.
    fn with_noise(mut self) -> Result<Self, VehicleError> {
        if let Some(snr_db) = self.scenario.sensors.snr_db {
            let (mut square, mut rows) = (0.0, 0.0);
            self.run_true(|row| {
                square += row.roll_rad * row.roll_rad;
                rows += 1.0;
                Ok::<(), VehicleError>(())
            })?;
            self.truth.noise_sd_rad = (square / rows * libm::pow(10.0, -snr_db / 10.0)).sqrt();
        }
        Ok(self)
    }

    /// The columns of the log: those of its sensors; of the pressures only what the vehicle has.
    pub fn columns(&self) -> Vec<Signal> {
        let mut columns = self.scenario.sensors.columns().to_vec();
        // Inclinometers have a tilt instead of a roll angle.
        let roll = columns.iter().position(|signal| *signal == Signal::Roll);
        if let Some(roll) = roll.filter(|_| self.signals.has_two_rolls()) {
            columns.insert(roll + 1, Signal::SecondRoll);
        }
        if self.truth.chassis.is_some() {
            columns.extend(ChassisSensors::COLUMNS);
        }
        if !self.signals.has_drive_pressure() {
            columns.retain(|signal| {
                !matches!(signal, Signal::DrivePressureLeft | Signal::DrivePressureRight)
            });
        }
        columns
    }

    /// Runs the scenario row by row, as measured by its sensors.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn run<E>(&self, mut write: impl FnMut(&LogRow) -> Result<(), E>) -> Result<(), E> {
        let mut instruments = Instruments::new(
            &self.scenario.sensors,
            self.truth.noise_sd_rad,
            self.gravity_mps2,
            self.steering_ratio,
            self.scenario.seed,
        );
        if let Some(chassis) = &self.truth.chassis {
            let roll_per_difference = self.signals.roll_per_difference;
            instruments =
                instruments.with_chassis(chassis, roll_per_difference, self.scenario.seed);
        }
        self.run_true(|row| write(&instruments.measure(row)))
    }

    /// All rows of [`run`](Self::run).
    pub fn rows(&self) -> Vec<LogRow> {
        let mut rows = Vec::new();
        let Ok(()) = self.run(|row| {
            rows.push(*row);
            Ok::<(), Infallible>(())
        });
        rows
    }

    /// Runs the scenario row by row, with the true values.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn run_true<E>(&self, mut write: impl FnMut(&LogRow) -> Result<(), E>) -> Result<(), E> {
        let trailer_mass_kg = self.scenario.load.trailer_mass_kg;
        let write_motion = |time_s: f64, motion: Motion| {
            let [roll_rad, second_roll_rad] =
                self.signals.rolls_rad(motion.roll_rad, motion.halves_roll_rad);
            write(&LogRow {
                time_s,
                steer_rad: motion.steer_rad,
                roll_rad,
                second_roll_rad,
                speed_mps: motion.speed_mps,
                lateral_acceleration_mps2: motion.lateral_acceleration_mps2,
                yaw_rate_radps: motion.yaw_rate_radps,
                trailer_mass_kg,
                ..LogRow::ABSENT
            })
        };
        match &self.source {
            Source::Models(models) => models.0.run(&models.1, self.samples, write_motion),
            Source::Recorded(rows) => rows.iter().try_for_each(write),
        }
    }
}

/// The number of samples, rounded.
fn samples(scenario: &Scenario) -> u64 {
    // The cast number is positive and checked.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let intervals = (scenario.duration_s * scenario.rate_hz).round() as u64;
    intervals + 1
}

fn greatest_steer_rad(rows: &[LogRow]) -> f64 {
    rows.iter().map(|row| row.steer_rad.abs()).fold(0.0, f64::max)
}

/// Steer and speed over time, and the DC ratio of roll to steer of the linear model.
fn histories(vehicle: &Vehicle, scenario: &Scenario) -> Result<(Histories, f64), VehicleError> {
    let model = |speed_mps: f64| {
        Equations::new(vehicle, scenario.variant, speed_mps, scenario.load)?.state_space()
    };
    let lateral_gain = |speed_mps: f64| -> Result<f64, VehicleError> {
        let model = model(speed_mps)?;
        model.lateral_gain()
    };
    let gain = lateral_gain(scenario.speed_mps)?;
    let usual_g = if scenario.to_rollover { ROLLOVER_LATERAL_G } else { DEFAULT_LATERAL_G };
    let amplitude_rad = scenario.steer_rad.unwrap_or(usual_g * vehicle.gravity_mps2 / gain);
    let mut histories = Histories::new(
        scenario.maneuver,
        amplitude_rad,
        scenario.speed_mps,
        (scenario.start_s, scenario.duration_s),
        scenario.seed,
    )
    .with_step_rate(scenario.step_rate_per_s);
    if scenario.speed_change > 0.0 {
        histories =
            histories.with_speed_change(scenario.speed_change, scenario.seed, |speed_mps| {
                Ok::<_, VehicleError>(gain / lateral_gain(speed_mps)?)
            })?;
    }
    let model = model(scenario.speed_mps)?;
    Ok((histories, model.steady(&model.trailer_roll, 0.0)?))
}
