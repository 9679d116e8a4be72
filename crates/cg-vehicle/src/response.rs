//! Responses of the linear model: transfer functions, steady-state values and time histories.

use cg_core::{Input, Output};
use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::system::{Simulation, System, TransferFunction};

/// State-space form `ẋ = A x + b δ`, with the responses as rows on `x`.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// `A`.
    pub a: DMatrix<f64>,
    /// `b`, per radian of road-wheel steer angle.
    pub b: DVector<f64>,
    /// Roll angle of the trailer's sprung mass, rad: of two roll sensors, the sum with their shares.
    pub trailer_roll: DVector<f64>,
    /// Roll angle of the front and of the rear half of the trailer, rad; the same if its frame is rigid.
    pub halves_roll: [DVector<f64>; 2],
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

    /// Lateral acceleration of the trailer's sprung c.g. in a steady turn, m/s² per radian of steer angle.
    ///
    /// # Errors
    /// As [`steady`](Self::steady).
    pub fn lateral_gain(&self) -> Result<f64, VehicleError> {
        self.steady(&self.lateral_acceleration, self.lateral_feedthrough)
    }

    /// A simulation that starts from rest and is exact for steer angles that are linear between
    /// samples.
    pub fn simulation(&self, interval_s: f64) -> Simulation {
        Simulation::new(&self.a, &self.b, interval_s)
    }
}

/// A response of the linear model to the steer angle, with its name.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NamedResponse {
    /// Its name, such as `tractor yaw angle`.
    pub name: String,
    /// Its unit per radian of road-wheel angle.
    pub unit: &'static str,
    /// The row on the state: the response, or its rate.
    pub row: DVector<f64>,
    /// Whether the row is the rate of the response: a yaw angle is no state of the model.
    pub integrated: bool,
}

impl StateSpace {
    /// The responses of the thesis's ten degrees of freedom (appendix C): lateral velocity, yaw and roll
    /// angle of the tractor, yaw and roll angle of the trailer, roll angle of each axle.
    pub fn responses(&self) -> Vec<NamedResponse> {
        let angle = |name: String, row: &DVector<f64>, integrated| NamedResponse {
            name,
            unit: "rad",
            row: row.clone(),
            integrated,
        };
        let mut all = vec![
            NamedResponse {
                name: "tractor lateral velocity".to_owned(),
                unit: "m/s",
                row: self.tractor_lateral_velocity.clone(),
                integrated: false,
            },
            angle("tractor yaw angle".to_owned(), &self.tractor_yaw_rate, true),
            angle("tractor roll angle".to_owned(), &self.tractor_roll, false),
            angle("trailer yaw angle".to_owned(), &self.trailer_yaw_rate, true),
            angle("trailer roll angle".to_owned(), &self.trailer_roll, false),
        ];
        let axles = self.axle_roll.iter().enumerate();
        all.extend(axles.map(|(i, row)| angle(format!("axle {} roll angle", i + 1), row, false)));
        all
    }

    /// The transfer function from the steer angle to a response. That of a yaw angle has a pole at zero
    /// and an infinite DC gain.
    ///
    /// # Errors
    /// As [`System::transfer_function`].
    pub fn transfer_function_of(
        &self,
        response: &NamedResponse,
    ) -> Result<TransferFunction, VehicleError> {
        let mut function = self.to(&response.row, 0.0).transfer_function()?;
        if response.integrated {
            function.denominator.push(0.0);
            function.poles.insert(0, (0.0, 0.0));
            function.dc_gain = f64::INFINITY.copysign(function.dc_gain);
        }
        Ok(function)
    }

    /// The response to a sampled steer angle, from rest; a yaw angle by the trapezoidal rule.
    pub fn history(
        &self,
        response: &NamedResponse,
        steer_rad: &[f64],
        interval_s: f64,
    ) -> Vec<f64> {
        let mut values = self.to(&response.row, 0.0).response(steer_rad, interval_s);
        if response.integrated {
            let (mut angle, mut last) = (0.0, 0.0);
            for value in &mut values {
                angle += 0.5 * interval_s * (last + *value);
                last = std::mem::replace(value, angle);
            }
        }
        values
    }
}
