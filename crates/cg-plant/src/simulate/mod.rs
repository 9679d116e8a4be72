//! Logs with known truth from the linear, the reduced or the nonlinear model.
//!
//! | file | contents |
//! |---|---|
//! | `models` | the linear and the reduced model in time |
//! | `nonlinear` | the nonlinear plant, steered by a steer history or by the driver |

mod models;
mod nonlinear;

use serde::Serialize;

use crate::maneuver::{Course, Histories, Maneuver};
use crate::sensors::{Instruments, Sensors};
use cg_logs::log::LogRow;
use cg_vehicle::error::VehicleError;
use cg_vehicle::limits;
use cg_vehicle::linear::{Equations, Variant};
use cg_vehicle::vehicle::{Load, Vehicle};
use models::Models;
use nonlinear::{Recorded, record};

/// Lateral acceleration that the default steer amplitude gives, in g (the thesis stays below 0.2).
const DEFAULT_LATERAL_G: f64 = 0.17;
/// The same for a maneuver to rollover: more than trucks sustain.
const ROLLOVER_LATERAL_G: f64 = 1.2;

/// Time after a driver's path in which the trailer settles.
const AFTER_S: f64 = 5.0;
/// Default of the greatest share by which the speed of a drive of the nonlinear plant changes.
const USUAL_SPEED_CHANGE: f64 = 0.3;

/// The simulated model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The linear model in full.
    Linear,
    /// The reduced 5th-order models of roll; lateral acceleration and yaw rate stay steady-state.
    Reduced,
    /// The nonlinear yaw/roll plant.
    Nonlinear,
}

/// What to simulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenario {
    /// The steer history.
    pub maneuver: Maneuver,
    /// The path that the preview driver follows instead of the steer history; nonlinear plant only.
    pub course: Option<Course>,
    /// Rate `a` of rounded steps (eq. 5.3), 1/s.
    pub step_rate_per_s: f64,
    /// Greatest share by which the speed of a [`Maneuver::Drive`] changes; not in the reduced plant.
    pub speed_change: f64,
    /// Whether the log may end where the vehicle rolls over; nonlinear plant only.
    pub to_rollover: bool,
    /// The simulated model.
    pub plant: Plant,
    /// Equations of the model.
    pub variant: Variant,
    /// The trailer's load.
    pub load: Load,
    /// Forward speed.
    pub speed_mps: f64,
    /// Road-wheel amplitude; `None` for 0.17 g.
    pub steer_rad: Option<f64>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Straight driving before the maneuver.
    pub start_s: f64,
    /// Length of the log.
    pub duration_s: f64,
    /// The sensors and their errors.
    pub sensors: Sensors,
    /// Seed of sensors and drive.
    pub seed: u64,
}

impl Scenario {
    /// A maneuver of the linear model with the load and speed of the vehicle file: 20 s (a drive
    /// 300 s) at 100 Hz, 2 s straight, perfect sensors.
    pub fn of(vehicle: &Vehicle, maneuver: Maneuver) -> Self {
        Self {
            maneuver,
            course: None,
            step_rate_per_s: Histories::STEP_RATE_PER_S,
            speed_change: 0.0,
            to_rollover: false,
            plant: Plant::Linear,
            variant: Variant::Complete,
            load: vehicle.reference_load(),
            speed_mps: vehicle.nominal_speed_mps,
            steer_rad: None,
            rate_hz: 100.0,
            start_s: 2.0,
            duration_s: if maneuver == Maneuver::Drive { 300.0 } else { 20.0 },
            sensors: Sensors::default(),
            seed: 1,
        }
    }

    /// The default length: as long as a driver's path takes, otherwise the present one.
    pub fn usual_duration_s(&self) -> f64 {
        self.course.map_or(self.duration_s, |course| {
            self.start_s + course.length_m() / self.speed_mps + AFTER_S
        })
    }

    /// The default speed change: some in a drive of the nonlinear plant, otherwise none.
    pub fn usual_speed_change(&self) -> f64 {
        let changes = self.maneuver == Maneuver::Drive && self.plant == Plant::Nonlinear;
        if changes { USUAL_SPEED_CHANGE } else { 0.0 }
    }

    fn check(&self, vehicle: &Vehicle) -> Result<(), VehicleError> {
        let refuse = |text: String| Err(VehicleError::Model(text));
        limits::load(self.load)?;
        limits::positive("--speed-mps", self.speed_mps, limits::GREATEST_SPEED_MPS)?;
        limits::positive("--rate-hz", self.rate_hz, limits::GREATEST_RATE_HZ)?;
        limits::positive("--duration-s", self.duration_s, limits::GREATEST_DURATION_S)?;
        limits::positive("--step-rate", self.step_rate_per_s, limits::GREATEST_STEP_RATE_PER_S)?;
        if self.duration_s * self.rate_hz > limits::GREATEST_ROWS {
            return refuse(format!(
                "--duration-s {} at --rate-hz {} makes more than {:e} rows: reduce one of them",
                self.duration_s,
                self.rate_hz,
                limits::GREATEST_ROWS
            ));
        }
        if !(self.start_s >= 0.0 && self.start_s < self.duration_s) {
            return refuse(format!(
                "--start-s {} must lie between 0 and --duration-s {}",
                self.start_s, self.duration_s
            ));
        }
        if self.plant != Plant::Nonlinear && (self.course.is_some() || self.to_rollover) {
            return refuse(
                "a path to follow (--turn-deg, --radius-m, --gate-m) and --to-rollover need \
                 --plant nonlinear"
                    .into(),
            );
        }
        if !(0.0..=0.5).contains(&self.speed_change) {
            return refuse(format!(
                "--speed-change {} must lie between 0 and 0.5",
                self.speed_change
            ));
        }
        let changes = self.speed_change > 0.0;
        if changes && (self.maneuver != Maneuver::Drive || self.plant == Plant::Reduced) {
            return refuse(
                "--speed-change is for --maneuver drive, with --plant linear or nonlinear".into(),
            );
        }
        if self.sensors.steering_wheel && vehicle.steering_ratio.is_none() {
            return refuse(
                "--steering-wheel: the vehicle file has no steering_ratio; add one".into(),
            );
        }
        self.sensors.check(self.rate_hz)
    }
}

/// The truth of a simulated log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Name of the vehicle.
    pub vehicle: String,
    /// C.g. height of the trailer's sprung mass.
    pub height_m: f64,
    /// Mass of the whole semitrailer.
    pub trailer_mass_kg: f64,
    /// Forward speed (of a drive: the speed about which it varies).
    pub speed_mps: f64,
    /// Steer amplitude (of a driver: the greatest).
    pub steer_rad: f64,
    /// DC ratio of roll to steer of the linear model.
    pub ratio: f64,
    /// Standard deviation of the noise on the roll angle.
    pub noise_sd_rad: f64,
    /// Everything else that the sensors added.
    #[serde(flatten)]
    pub sensors: Sensors,
    /// Time of the rollover, if there was one.
    pub rolled_over_s: Option<f64>,
    /// Seed.
    pub seed: u64,
}

/// The vehicle at a sample.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    steer_rad: f64,
    speed_mps: f64,
    roll_rad: f64,
    lateral_acceleration_mps2: f64,
    yaw_rate_radps: f64,
}

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
