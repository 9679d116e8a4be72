//! Logs with known truth from the linear, the reduced or the nonlinear model.

use cg_core::reduced::Simulation as ReducedSimulation;
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, Normal};
use serde::Serialize;

use crate::error::VehicleError;
use crate::linear::{Equations, Variant};
use crate::log::LogRow;
use crate::maneuver::{Maneuver, SteerHistory};
use crate::plant::{PlantOptions, YawRollPlant};
use crate::reduction::reduce;
use crate::response::StateSpace;
use crate::vehicle::{Load, Vehicle};

/// Lateral acceleration that the default steer amplitude gives, in g (the source stays below 0.2).
const DEFAULT_LATERAL_G: f64 = 0.17;

/// What moves.
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
    /// What moves.
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
    /// White noise on the roll angle, below its mean square; `None` for none.
    pub snr_db: Option<f64>,
    /// Seed of noise and drive.
    pub seed: u64,
}

/// What is true of a simulated log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Name of the vehicle.
    pub vehicle: String,
    /// C.g. height of the trailer's sprung mass.
    pub height_m: f64,
    /// Mass of the whole semitrailer.
    pub trailer_mass_kg: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// Steer amplitude.
    pub steer_rad: f64,
    /// DC ratio of roll to steer of the linear model.
    pub ratio: f64,
    /// Standard deviation of the noise on the roll angle.
    pub noise_sd_rad: f64,
    /// Seed.
    pub seed: u64,
}

/// Roll angle, lateral acceleration and yaw rate of the trailer.
#[derive(Clone, Copy, Debug)]
struct Response {
    roll_rad: f64,
    lateral_acceleration_mps2: f64,
    yaw_rate_radps: f64,
}

/// A scenario ready to run.
pub struct LogSimulation {
    model: StateSpace,
    reduced: Option<cg_core::Reduced5<f64>>,
    /// What the nonlinear plant did: nothing of it is computed twice.
    recorded: Option<Vec<Response>>,
    history: SteerHistory,
    scenario: Scenario,
    lateral_gain: f64,
    yaw_gain: f64,
    samples: u64,
    /// What is true of the log.
    pub truth: Truth,
}

impl LogSimulation {
    /// Prepares a scenario; runs it once to measure the noise if there is to be any.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle has no such load or model, or a number makes no sense.
    pub fn new(vehicle: &Vehicle, scenario: Scenario) -> Result<Self, VehicleError> {
        for (name, value) in [
            ("--speed-mps", scenario.speed_mps),
            ("--rate-hz", scenario.rate_hz),
            ("--duration-s", scenario.duration_s),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(VehicleError::Model(format!("{name} {value} must be positive")));
            }
        }
        if !(scenario.start_s >= 0.0 && scenario.start_s < scenario.duration_s) {
            return Err(VehicleError::Model(format!(
                "--start-s {} must lie between 0 and --duration-s {}",
                scenario.start_s, scenario.duration_s
            )));
        }
        let model = Equations::new(vehicle, scenario.variant, scenario.speed_mps, scenario.load)?
            .state_space()?;
        let reduced = match scenario.plant {
            Plant::Linear | Plant::Nonlinear => None,
            Plant::Reduced => Some(reduce(&model)?.steer),
        };
        let lateral_gain = model.steady(&model.lateral_acceleration, model.lateral_feedthrough)?;
        let yaw_gain = model.steady(&model.trailer_yaw_rate, 0.0)?;
        let ratio = model.steady(&model.trailer_roll, 0.0)?;
        let steer_rad =
            scenario.steer_rad.unwrap_or(DEFAULT_LATERAL_G * vehicle.gravity_mps2 / lateral_gain);
        let history = SteerHistory::new(
            scenario.maneuver,
            steer_rad,
            scenario.start_s,
            scenario.duration_s,
            scenario.seed,
        );
        // Rounded to the nearest sample; the cast of a positive, checked number.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let samples = (scenario.duration_s * scenario.rate_hz).round() as u64 + 1;
        let truth = Truth {
            vehicle: vehicle.name.clone(),
            height_m: scenario.load.cg_height_m,
            trailer_mass_kg: scenario.load.trailer_mass_kg,
            speed_mps: scenario.speed_mps,
            steer_rad,
            ratio,
            noise_sd_rad: 0.0,
            seed: scenario.seed,
        };
        let recorded = match scenario.plant {
            Plant::Nonlinear => Some(record(vehicle, &scenario, &history, samples)?),
            Plant::Linear | Plant::Reduced => None,
        };
        let mut simulation = Self {
            model,
            reduced,
            recorded,
            history,
            scenario,
            lateral_gain,
            yaw_gain,
            samples,
            truth,
        };
        if let Some(snr_db) = scenario.snr_db {
            let mut square = 0.0;
            simulation.clean(|row| {
                square += row.roll_rad * row.roll_rad;
                Ok::<(), VehicleError>(())
            })?;
            #[allow(clippy::cast_precision_loss)]
            let mean_square = square / samples as f64;
            simulation.truth.noise_sd_rad = (mean_square * 10f64.powf(-snr_db / 10.0)).sqrt();
        }
        Ok(simulation)
    }

    /// Runs the scenario, a row at a time.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn run<E>(&self, mut write: impl FnMut(&LogRow) -> Result<(), E>) -> Result<(), E> {
        let mut rng = StdRng::seed_from_u64(self.scenario.seed);
        // A standard deviation that is finite and not negative always makes a distribution.
        let noise = Normal::new(0.0, self.truth.noise_sd_rad).ok();
        self.clean(|mut row| {
            row.roll_rad += noise.map_or(0.0, |noise| noise.sample(&mut rng));
            write(&row)
        })
    }

    fn clean<E>(&self, mut write: impl FnMut(LogRow) -> Result<(), E>) -> Result<(), E> {
        let mut recorded = self.recorded.iter().flatten();
        let mut model = self.recorded.is_none().then(|| Models::new(self));
        for k in 0..self.samples {
            #[allow(clippy::cast_precision_loss)]
            let time_s = k as f64 / self.scenario.rate_hz;
            let steer_rad = self.history.steer_rad(time_s);
            let response = match &mut model {
                Some(model) => Some(model.push(self, steer_rad, k > 0)),
                None => recorded.next().copied(),
            };
            let Some(response) = response else { break };
            write(LogRow {
                time_s,
                steer_rad,
                roll_rad: response.roll_rad,
                speed_mps: self.scenario.speed_mps,
                lateral_acceleration_mps2: response.lateral_acceleration_mps2,
                yaw_rate_radps: response.yaw_rate_radps,
                trailer_mass_kg: self.scenario.load.trailer_mass_kg,
                steering_wheel_rad: f64::NAN,
                tilt_rad: f64::NAN,
            })?;
        }
        Ok(())
    }
}

/// The linear and the reduced model in time.
struct Models {
    linear: crate::system::Simulation,
    reduced: Option<ReducedSimulation<f64>>,
}

impl Models {
    fn new(simulation: &LogSimulation) -> Self {
        let interval_s = 1.0 / simulation.scenario.rate_hz;
        Self {
            linear: simulation.model.simulation(interval_s),
            reduced: simulation
                .reduced
                .map(|model| ReducedSimulation::new(&model, interval_s, 0.0)),
        }
    }

    /// Advances one interval unless this is the first sample.
    fn push(&mut self, simulation: &LogSimulation, steer_rad: f64, advance: bool) -> Response {
        if let Some(reduced) = &mut self.reduced {
            return Response {
                roll_rad: if advance { reduced.push(steer_rad) } else { 0.0 },
                lateral_acceleration_mps2: simulation.lateral_gain * steer_rad,
                yaw_rate_radps: simulation.yaw_gain * steer_rad,
            };
        }
        if advance {
            self.linear.push(steer_rad);
        }
        let (model, state) = (&simulation.model, &self.linear.state);
        Response {
            roll_rad: model.trailer_roll.dot(state),
            lateral_acceleration_mps2: model.lateral_acceleration.dot(state)
                + model.lateral_feedthrough * steer_rad,
            yaw_rate_radps: model.trailer_yaw_rate.dot(state),
        }
    }
}

/// Drives the nonlinear plant through the scenario.
fn record(
    vehicle: &Vehicle,
    scenario: &Scenario,
    history: &SteerHistory,
    samples: u64,
) -> Result<Vec<Response>, VehicleError> {
    let plant = YawRollPlant::new(vehicle, scenario.load, &PlantOptions::default())?;
    let mut run = plant.start(scenario.speed_mps)?;
    let mut recorded = Vec::new();
    for k in 0..samples {
        if k > 0 {
            // Steps of the plant, not straight lines between samples, follow the history.
            #[allow(clippy::cast_precision_loss)]
            let time_s = k as f64 / scenario.rate_hz;
            let interval_s = time_s - run.time_s();
            let steps = (interval_s / plant.step_s()).ceil().max(1.0);
            let start_s = run.time_s();
            let mut done = 0.0;
            while done < steps {
                done += 1.0;
                let steer_rad = history.steer_rad(start_s + interval_s * done / steps);
                run.push(steer_rad, scenario.speed_mps, interval_s / steps);
            }
            run.upright()?;
        }
        let trailer = run.sample().trailer;
        recorded.push(Response {
            roll_rad: trailer.roll_rad,
            lateral_acceleration_mps2: trailer.lateral_acceleration_mps2,
            yaw_rate_radps: trailer.yaw_rate_radps,
        });
    }
    Ok(recorded)
}
