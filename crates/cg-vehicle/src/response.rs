//! Responses of the linear model: transfer functions, steady-state values and time histories.

use cg_core::{Input, Output};
use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::system::{Simulation, System};

/// State-space form `ẋ = A x + b δ`, with the responses as rows on `x`.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// `A`.
    pub a: DMatrix<f64>,
    /// `b`, per radian of road-wheel steer angle.
    pub b: DVector<f64>,
    /// Roll angle of the trailer's sprung mass, rad.
    pub trailer_roll: DVector<f64>,
    /// Roll angle of the tractor's sprung mass, rad.
    pub tractor_roll: DVector<f64>,
    /// Yaw rate of the trailer, rad/s.
    pub trailer_yaw_rate: DVector<f64>,
    /// Yaw rate of the tractor, rad/s.
    pub tractor_yaw_rate: DVector<f64>,
    /// Yaw angle of the tractor minus that of the trailer, rad.
    pub articulation: DVector<f64>,
    /// Lateral velocity of the tractor's sprung c.g., m/s.
    pub tractor_lateral_velocity: DVector<f64>,
    /// Roll angle of each axle, rad, tractor first.
    pub axle_roll: Vec<DVector<f64>>,
    /// Lateral acceleration of the trailer's sprung c.g., m/s².
    pub lateral_acceleration: DVector<f64>,
    /// The part of the lateral acceleration that follows the steer angle without delay, m/s² per
    /// rad.
    pub lateral_feedthrough: f64,
    /// Roll angle between body and axles of the tractor (drive axles) and of the trailer, rad.
    pub suspension_roll: [DVector<f64>; 2],
    /// Specific force at the accelerometer of the tractor and of the trailer, m/s², and its part
    /// that follows the steer angle without delay, m/s² per rad.
    pub specific_force: [(DVector<f64>, f64); 2],
}

impl StateSpace {
    /// The system from the steer angle to one response, given as a row on `x` and its feedthrough.
    pub fn to(&self, row: &DVector<f64>, feedthrough: f64) -> System {
        System { a: self.a.clone(), b: self.b.clone(), c: row.clone(), d: feedthrough }
    }

    /// The system from the steer angle to the trailer's roll angle.
    pub fn to_trailer_roll(&self) -> System {
        self.to(&self.trailer_roll, 0.0)
    }

    /// The roll angle that a channel explains, as a row on `x`.
    pub fn output_row(&self, output: Output) -> &DVector<f64> {
        match output {
            Output::Roll => &self.trailer_roll,
            Output::TractorSuspensionRoll => &self.suspension_roll[0],
            Output::SuspensionRoll => &self.suspension_roll[1],
        }
    }

    /// The input of a channel as a row on `x` and its feedthrough; `None` for the steer angle.
    pub fn input_row(&self, input: Input) -> Option<(&DVector<f64>, f64)> {
        let force = |unit: usize| (&self.specific_force[unit].0, self.specific_force[unit].1);
        match input {
            Input::Steer => None,
            Input::LateralAcceleration => {
                Some((&self.lateral_acceleration, self.lateral_feedthrough))
            }
            Input::TractorSpecificForce => Some(force(0)),
            Input::SpecificForce => Some(force(1)),
        }
    }

    /// The system from the steer angle to the roll angle that a channel explains.
    pub fn to_output(&self, output: Output) -> System {
        self.to(self.output_row(output), 0.0)
    }

    /// The system from the steer angle to the input of a channel; `None` for the steer angle.
    pub fn to_input(&self, input: Input) -> Option<System> {
        self.input_row(input).map(|(row, feedthrough)| self.to(row, feedthrough))
    }

    /// The system from the steer angle to the lateral acceleration of the trailer's sprung c.g.
    pub fn to_lateral_acceleration(&self) -> System {
        self.to(&self.lateral_acceleration, self.lateral_feedthrough)
    }

    /// The steady-state value of a response per radian of steer angle.
    ///
    /// # Errors
    /// If the model has a pole at zero.
    pub fn steady(&self, row: &DVector<f64>, feedthrough: f64) -> Result<f64, VehicleError> {
        Ok(self.to(row, feedthrough).moments(1)?[0])
    }

    /// A simulation that starts from rest and is exact for steer angles that are linear between
    /// samples.
    pub fn simulation(&self, interval_s: f64) -> Simulation {
        Simulation::new(&self.a, &self.b, interval_s)
    }
}
