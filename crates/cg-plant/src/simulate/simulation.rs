//! A scenario ready to run, and its log.

use super::models::Models;
use super::nonlinear::{Recorded, record};
use super::scenario::{Motion, Plant, Scenario, Truth};
use crate::maneuver::Histories;
use crate::sensors::Instruments;
use cg_logs::log::LogRow;
use cg_vehicle::Vehicle;
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;

/// Lateral acceleration that the default steer amplitude gives, in g (the thesis stays below 0.2).
const DEFAULT_LATERAL_G: f64 = 0.17;
/// The same for a maneuver to rollover: more than trucks sustain.
const ROLLOVER_LATERAL_G: f64 = 1.2;

/// The source of the motions.
enum Source {
    /// Stored motions of the nonlinear plant, to avoid computing them twice.
    Recorded(Vec<Motion>),
    /// Models that are fast enough to run each time.
    Models(Box<Models>),
}

/// A scenario ready to run.
pub struct LogSimulation {
    source: Source,
    histories: Histories,
    scenario: Scenario,
    gravity_mps2: f64,
    steering_ratio: f64,
    samples: u64,
    /// The truth of the log.
    pub truth: Truth,
}

impl LogSimulation {
    /// Prepares a scenario. If noise is requested, it is run once to determine the noise level.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle has no such load or model, or a number is invalid.
    pub fn new(vehicle: &Vehicle, scenario: Scenario) -> Result<Self, VehicleError> {
        scenario.check(vehicle)?;
        let (histories, ratio) = histories(vehicle, &scenario)?;
        // Rounded to the nearest sample; the cast number is positive and checked.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let samples = (scenario.duration_s * scenario.rate_hz).round() as u64 + 1;
        let mut truth = Truth {
            vehicle: vehicle.name.clone(),
            height_m: scenario.load.cg_height_m,
            trailer_mass_kg: scenario.load.trailer_mass_kg,
            speed_mps: scenario.speed_mps,
            steer_rad: histories.amplitude_rad(),
            ratio,
            noise_sd_rad: 0.0,
            sensors: scenario.sensors,
            rolled_over_s: None,
            seed: scenario.seed,
        };
        let source = match scenario.plant {
            Plant::Nonlinear => {
                let Recorded { motions, rolled_over_s } =
                    record(vehicle, &scenario, &histories, samples)?;
                truth.rolled_over_s = rolled_over_s;
                if scenario.course.is_some() {
                    let greater = |most: f64, motion: &Motion| most.max(motion.steer_rad.abs());
                    truth.steer_rad = motions.iter().fold(0.0, greater);
                }
                Source::Recorded(motions)
            }
            Plant::Linear | Plant::Reduced => {
                Source::Models(Box::new(Models::new(vehicle, &scenario, &histories, samples)?))
            }
        };
        let (gravity_mps2, steering_ratio) =
            (vehicle.gravity_mps2, vehicle.steering_ratio.unwrap_or(1.0));
        let mut simulation =
            Self { source, histories, scenario, gravity_mps2, steering_ratio, samples, truth };
        if let Some(snr_db) = scenario.sensors.snr_db {
            let (mut square, mut rows) = (0.0, 0.0);
            simulation.run_true(|row| {
                square += row.roll_rad * row.roll_rad;
                rows += 1.0;
                Ok::<(), VehicleError>(())
            })?;
            simulation.truth.noise_sd_rad = (square / rows * 10f64.powf(-snr_db / 10.0)).sqrt();
        }
        Ok(simulation)
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
        self.run_true(|row| write(&instruments.measure(row)))
    }

    /// Runs the scenario row by row, with the true values.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn run_true<E>(&self, mut write: impl FnMut(&LogRow) -> Result<(), E>) -> Result<(), E> {
        let trailer_mass_kg = self.scenario.load.trailer_mass_kg;
        let mut write = |time_s: f64, motion: Motion| {
            write(&LogRow {
                time_s,
                steer_rad: motion.steer_rad,
                roll_rad: motion.roll_rad,
                speed_mps: motion.speed_mps,
                lateral_acceleration_mps2: motion.lateral_acceleration_mps2,
                yaw_rate_radps: motion.yaw_rate_radps,
                trailer_mass_kg,
                ..LogRow::ABSENT
            })
        };
        match &self.source {
            Source::Models(models) => models.run(&self.histories, self.samples, write),
            Source::Recorded(motions) => {
                for (k, motion) in motions.iter().enumerate() {
                    #[allow(clippy::cast_precision_loss)]
                    write(k as f64 / self.scenario.rate_hz, *motion)?;
                }
                Ok(())
            }
        }
    }
}

/// Steer and speed over time, and the DC ratio of roll to steer of the linear model.
fn histories(vehicle: &Vehicle, scenario: &Scenario) -> Result<(Histories, f64), VehicleError> {
    let model = |speed_mps: f64| {
        Equations::new(vehicle, scenario.variant, speed_mps, scenario.load)?.state_space()
    };
    let lateral_gain = |speed_mps: f64| -> Result<f64, VehicleError> {
        let model = model(speed_mps)?;
        model.steady(&model.lateral_acceleration, model.lateral_feedthrough)
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
