//! Accuracy of the estimates and coverage of their intervals: one maneuver repeated many times on
//! simulated logs (section 5.3.2).

use cg_core::{Channel, Design};
use rand::SeedableRng;
use rand::rngs::StdRng;

use cg_logs::estimate::{
    EstimateOptions, LogEstimate, LogEstimator, Method, QUANTILE_95, RoadChoice,
};
use cg_logs::log::LogRow;
use cg_plant::random::standard_normal;
use cg_plant::sensors::Instruments;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::belief::{Belief, Deviations, Parameter, adjusted, log_gain};
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Variant, Vehicle};

/// Step of the height for the differences of the bound: 1 mm of 2 m leaves a second-order error of 1e-7.
const BOUND_STEP_M: f64 = 1e-3;

/// The simulated truck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truck {
    /// The truck of the vehicle file; noise is the only error.
    OfTheFile,
    /// A different truck in each run, drawn from the uncertainty in the vehicle file.
    Drawn,
}

cg_core::words!(Truck {
    OfTheFile => "of-the-file", "The vehicle file's: nothing but noise is wrong";
    Drawn => "drawn", "Another one each time, drawn from what the file says of its own uncertainty";
});

/// A repeated simulation and estimation.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Maneuver, load and sensors.
    pub scenario: Scenario,
    /// The simulated truck.
    pub truck: Truck,
    /// The channel; `None` combines both.
    pub channel: Option<Channel>,
    /// Identification method.
    pub method: Method,
    /// Number of runs.
    pub runs: u32,
    /// Seed of the first run.
    pub seed: u64,
}

/// Errors of the estimates, relative to the true height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Score {
    /// Number of runs with a height.
    pub answered: u32,
    /// Mean error.
    pub bias: f64,
    /// Root mean square of the error.
    pub rmse: f64,
    /// Mean of the stated standard deviation.
    pub stated_sd: f64,
    /// Share of the runs whose 95 % interval holds the truth.
    pub coverage: f64,
    /// Cramér-Rao bound of the standard deviation if everything is known except the height and a
    /// constant offset. Valid for white noise only.
    pub bound: f64,
}

/// A drawn truck. The driver's inputs are those of the truck in the file.
struct Drawn {
    deviations: Deviations,
    /// Relative error of each channel's ratio that the equations leave out.
    residual: [f64; 2],
    /// Distance of its payload behind the place in the file.
    payload_behind_m: f64,
}

impl Drawn {
    fn new(belief: &Belief, place_sd_m: f64, truck: Truck, source: &mut StdRng) -> Self {
        let mut normal = || standard_normal(source);
        if truck == Truck::OfTheFile {
            let deviations = Deviations::zeros();
            return Self { deviations, residual: [0.0; 2], payload_behind_m: 0.0 };
        }
        // The logs have no sensors of suspension roll and specific force.
        let standard =
            Deviations::from_fn(
                |k, _| if k <= Parameter::Compensation as usize { normal() } else { 0.0 },
            );
        // The prior is uncorrelated.
        let sd = Deviations::from_fn(|k, _| belief.covariance[(k, k)].sqrt());
        Self {
            deviations: belief.mean + sd.component_mul(&standard),
            residual: [belief.residual_sd * normal(), belief.residual_sd * normal()],
            payload_behind_m: if place_sd_m > 0.0 { place_sd_m * normal() } else { 0.0 },
        }
    }

    /// The row with the gains of this truck's sensors, before other sensor errors. The gains multiply the
    /// ratio of roll to measured input.
    fn with_sensor_gains(&self, row: &LogRow) -> LogRow {
        let by = |channel: Channel| {
            libm::exp(log_gain(&self.deviations, channel) + self.residual[channel.index()])
        };
        let (steer, lateral) = (by(Channel::Steer), by(Channel::LateralAcceleration));
        LogRow {
            steer_rad: row.steer_rad / steer,
            lateral_acceleration_mps2: row.lateral_acceleration_mps2 / lateral,
            yaw_rate_radps: row.yaw_rate_radps / lateral,
            ..*row
        }
    }
}

impl Experiment {
    /// An experiment with this scenario and the truck of the file, both channels combined, 1000 runs.
    pub fn of(scenario: Scenario) -> Self {
        Self {
            scenario,
            truck: Truck::OfTheFile,
            channel: None,
            method: Method::Filtered,
            runs: 1000,
            seed: 1,
        }
    }

    /// Runs the experiment; `take` receives the estimate of each run, in order.
    ///
    /// # Errors
    /// If the vehicle cannot be simulated in this scenario.
    pub fn run(
        &self,
        vehicle: &Vehicle,
        design: &Design<f64>,
        mut take: impl FnMut(&LogEstimate),
    ) -> Result<(), VehicleError> {
        let belief = Belief::prior(vehicle);
        let place_sd_m = match self.scenario.variant {
            Variant::Complete => vehicle.uncertainty.payload_place_sd_m,
            Variant::AsPrinted => 0.0, // known for one load only
        };
        let nominal = LogSimulation::new(vehicle, self.scenario)?;
        let scenario = Scenario { steer_rad: Some(nominal.truth.steer_rad), ..self.scenario };
        let options = EstimateOptions {
            channel: self.channel,
            method: self.method,
            variant: scenario.variant,
            road: Some(RoadChoice::FLAT), // that of the plant
            ..EstimateOptions::default()
        };
        let fresh = LogEstimator::from_design(design, vehicle.align_settings(), options);
        let mut source = StdRng::seed_from_u64(self.seed);
        let mut rows = true_rows(&nominal);
        for run in 0..self.runs {
            let drawn = Drawn::new(&belief, place_sd_m, self.truck, &mut source);
            if self.truck == Truck::Drawn {
                let other = adjusted(vehicle, &drawn.deviations);
                let mut scenario = scenario;
                scenario.payload_behind_hitch_m += drawn.payload_behind_m;
                rows = true_rows(&LogSimulation::new(&other, scenario)?);
            }
            let mut instruments = Instruments::new(
                &scenario.sensors,
                nominal.truth.noise_sd_rad,
                vehicle.gravity_mps2,
                vehicle.steering_ratio.unwrap_or(1.0),
                self.seed.wrapping_add(u64::from(run)),
            );
            let mut estimator = fresh.clone();
            for row in &rows {
                estimator
                    .push(&instruments.measure(&drawn.with_sensor_gains(row)))
                    .map_err(|error| VehicleError::Model(error.to_string()))?;
            }
            take(&estimator.finish());
        }
        Ok(())
    }

    /// Runs the experiment and scores the heights. With the truck of the file, the score is for the
    /// part of the interval that noise causes; with drawn trucks for the whole interval.
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn score(&self, vehicle: &Vehicle) -> Result<Score, VehicleError> {
        self.score_with(vehicle, &design(vehicle, self.scenario.variant)?)
    }

    /// The same with an existing design of the vehicle, for many experiments with it.
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn score_with(
        &self,
        vehicle: &Vehicle,
        design: &Design<f64>,
    ) -> Result<Score, VehicleError> {
        let truth_m = self.scenario.load.cg_height_m;
        let (mut sum, mut square, mut stated, mut covered) = (0.0, 0.0, 0.0, 0.0);
        let mut answered = 0;
        self.run(vehicle, design, |estimate| {
            let (Some(height_m), Some(whole_sd_m)) = (estimate.height_m, estimate.height_sd_m)
            else {
                return;
            };
            let sd_m = match self.truck {
                Truck::OfTheFile => estimate.height_random_sd_m.unwrap_or(whole_sd_m),
                Truck::Drawn => whole_sd_m,
            };
            let error_m = height_m - truth_m;
            answered += 1;
            sum += error_m;
            square += error_m * error_m;
            stated += sd_m;
            covered += f64::from(u8::from(error_m.abs() <= QUANTILE_95 * sd_m));
        })?;
        let n = f64::from(answered);
        Ok(Score {
            answered,
            bias: sum / n / truth_m,
            rmse: (square / n).sqrt() / truth_m,
            stated_sd: stated / n / truth_m,
            coverage: covered / n,
            bound: self.bound_m(vehicle)? / truth_m,
        })
    }

    /// The bound `σ/|s⊥|`, where `s = ∂φ/∂h` at a given steer angle and `s⊥` is its part that no constant
    /// offset explains.
    fn bound_m(&self, vehicle: &Vehicle) -> Result<f64, VehicleError> {
        let nominal = LogSimulation::new(vehicle, self.scenario)?;
        let at = |shift_m: f64| -> Result<Vec<LogRow>, VehicleError> {
            let mut scenario = self.scenario;
            scenario.steer_rad = Some(nominal.truth.steer_rad);
            scenario.load.cg_height_m += shift_m;
            Ok(true_rows(&LogSimulation::new(vehicle, scenario)?))
        };
        let (above, below) = (at(BOUND_STEP_M)?, at(-BOUND_STEP_M)?);
        let slopes: Vec<f64> = above
            .iter()
            .zip(&below)
            .map(|(a, b)| (a.roll_rad - b.roll_rad) / (2.0 * BOUND_STEP_M))
            .collect();
        #[allow(clippy::cast_precision_loss)] // thousands of rows
        let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
        let length = slopes.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>().sqrt();
        Ok(nominal.truth.noise_sd_rad / length)
    }
}

fn true_rows(simulation: &LogSimulation) -> Vec<LogRow> {
    let mut rows = Vec::new();
    let keep = |row: &LogRow| {
        rows.push(*row);
        Ok::<(), std::convert::Infallible>(())
    };
    let Ok(()) = simulation.run_true(keep);
    rows
}
