//! A nonlinear yaw/roll/pitch/bounce simulator of a tractor-semitrailer.
//!
//! It belongs to the class of the constant-velocity yaw/roll programs (Gillespie and MacAdam,
//! UMTRI-82-39; Winkler, Fancher and MacAdam, UMTRI-83-17), for any number of axles and large
//! angles.
//!
//! | file | contents |
//! |---|---|
//! | `setup` | parameters from the vehicle file and a load |
//! | `state` | the state vector |
//! | `body` | sprung masses: attitude, motion, equations of a unit |
//! | `axle` | two degrees of freedom on a sliding roll center, eliminated directly |
//! | `suspension` | springs: linear, or measured with friction; load equalization |
//! | `tyre` | radial spring, lateral force and aligning moment over slip and load |
//! | `hitch` | the fifth wheel: roll spring, separation, lash |
//! | `dynamics` | the equations of motion |
//! | `equilibrium` | straight driving by Newton's method |
//! | `integrate` | Adams-Bashforth-Moulton or Runge-Kutta; rollover |
//! | `linearise` | small motion about straight driving |
//! | `path`, `driver` | a path and MacAdam's preview driver along it |
//! | `sample` | outputs at an instant |
//!
//! Each sprung mass moves laterally, vertically, and in yaw, roll and pitch, at a prescribed forward
//! speed. Each axle moves in roll and bounce. The fifth wheel connects the units in every direction
//! and leaves yaw and pitch free. The road is flat, level or banked.
//!
//! # Example
//!
//! A step of 0.02 rad at 50 km/h:
//!
//! ```
//! use cg_vehicle::Vehicle;
//! use cg_plant::plant::{PlantOptions, YawRollPlant};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
//! let vehicle = Vehicle::load(file)?;
//! let plant = YawRollPlant::new(&vehicle, vehicle.reference_load(), &PlantOptions::default())?;
//! let mut run = plant.start(13.89)?;
//! for _ in 0..1000 {
//!     run.push(0.02, 13.89, 0.01);
//! }
//! let roll_deg = run.sample().trailer.roll_rad.to_degrees();
//! assert!((0.8..1.2).contains(&roll_deg), "{roll_deg}");
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

mod axle;
mod body;
mod driver;
mod dynamics;
#[cfg(test)]
mod energy;
mod equilibrium;
mod hitch;
mod integrate;
mod linearise;
mod options;
mod path;
mod sample;
mod setup;
mod state;
mod suspension;
mod tyre;
mod vector;

pub use driver::{Driver, DriverSettings};
pub use dynamics::Control;
pub use integrate::{Progress, Simulation};
pub use options::{Characteristics, PlantOptions};
pub use path::Path;
pub use sample::{AxleSample, PlantSample, UnitSample};
pub use state::{AxleCoordinate, Coordinate, MAX_AXLES, State};

use cg_vehicle::error::VehicleError;
use cg_vehicle::vehicle::{Load, Vehicle};
use dynamics::{Parameters, Probe};
use equilibrium::settle;
use integrate::Method;
use state::ROOM;

/// The simulator: one vehicle under one load on one road.
#[derive(Clone, Debug)]
pub struct YawRollPlant {
    parameters: Parameters,
    design: State,
    steered: Vec<bool>,
    step_s: f64,
    method: Method,
}

impl YawRollPlant {
    /// Prepares a vehicle under a load.
    ///
    /// # Errors
    /// [`VehicleError`] if the load is impossible, if there are too many axles or tires, or if the
    /// fastest mode of the vehicle is too fast for the step.
    pub fn new(
        vehicle: &Vehicle,
        load: Load,
        options: &PlantOptions,
    ) -> Result<Self, VehicleError> {
        let (parameters, design) = setup::parameters(vehicle, load, options)?;
        let steered = vehicle.axles().iter().map(|axle| axle.steered).collect();
        let (step_s, method) = (options.step_s, Method::RungeKutta);
        let mut plant = Self { parameters, design, steered, step_s, method };
        if options.design_load.is_some() {
            plant.lift_to(load.cg_height_m, vehicle.nominal_speed_mps)?;
        }
        plant.method = Method::for_mode(plant.fastest_radps(vehicle.nominal_speed_mps)?, step_s)?;
        Ok(plant)
    }

    /// Moves the trailer's c.g. in its body so that it rests at this height.
    fn lift_to(&mut self, height_m: f64, speed_mps: f64) -> Result<(), VehicleError> {
        for _ in 0..5 {
            let state = settle(&self.parameters, &self.design, speed_mps)?.state;
            self.parameters.trailer.cg[2] += height_m - self.trailer_cg_height_m(&state);
        }
        Ok(())
    }

    /// Height of the trailer's sprung c.g. above the road in a state.
    pub fn trailer_cg_height_m(&self, state: &State) -> f64 {
        let attitude = |pitch, roll| body::Attitude::new(state.get(pitch), state.get(roll));
        let tractor = attitude(Coordinate::TractorPitch, Coordinate::TractorRoll);
        let trailer = attitude(Coordinate::TrailerPitch, Coordinate::TrailerRoll);
        state.get(Coordinate::TractorHeight)
            + tractor.outward(self.parameters.hitch_arm)[2]
            + trailer.outward(self.parameters.trailer.cg)[2]
    }

    /// Position of an axle's center, seen from above, along and to the left of the first heading.
    pub fn axle_position_m(&self, state: &State, axle: usize) -> [f64; 2] {
        let position = [state.get(Coordinate::PositionX), state.get(Coordinate::PositionY)];
        let Some(seen) = self.parameters.axles.get(axle) else { return position };
        let attitude = |pitch, roll| body::Attitude::new(state.get(pitch), state.get(roll));
        let turned = |from: [f64; 2], by: vector::Vector, yaw: Coordinate| {
            let (sin, cos) = state.get(yaw).sin_cos();
            [from[0] + cos * by[0] - sin * by[1], from[1] + sin * by[0] + cos * by[1]]
        };
        let tractor = attitude(Coordinate::TractorPitch, Coordinate::TractorRoll);
        // From the roll center down the axle's own vertical.
        let down_m = state.axle(axle, AxleCoordinate::Rise);
        let aside_m = down_m * state.axle(axle, AxleCoordinate::Roll).sin();
        let center = |attitude: &body::Attitude| {
            let [x, y, z] = attitude.outward(seen.roll_center);
            [x, y + aside_m, z]
        };
        if !seen.on_trailer {
            return turned(position, center(&tractor), Coordinate::TractorYaw);
        }
        let trailer = attitude(Coordinate::TrailerPitch, Coordinate::TrailerRoll);
        let arm = tractor.outward(self.parameters.hitch_arm);
        let hitch = turned(position, arm, Coordinate::TractorYaw);
        turned(hitch, center(&trailer), Coordinate::TrailerYaw)
    }

    /// A run that starts from straight driving at a speed. On a banked road its first steer angle is
    /// the one that keeps the vehicle straight.
    ///
    /// # Errors
    /// If the vehicle cannot drive straight there.
    pub fn start(&self, speed_mps: f64) -> Result<Simulation<'_>, VehicleError> {
        if !(speed_mps.is_finite() && speed_mps > 0.0) {
            return Err(VehicleError::Model(format!("speed {speed_mps} m/s must be positive")));
        }
        let rest = settle(&self.parameters, &self.design, speed_mps)?;
        let control = Control { steer_rad: rest.steer_rad, speed_mps, acceleration_mps2: 0.0 };
        Ok(Simulation::new(self, &rest.state, control))
    }

    /// The outputs at a state under given inputs.
    pub fn sample(&self, state: &State, control: &Control) -> PlantSample {
        let mut probe = Probe::default();
        self.parameters.rates(&state.x, control, &mut [0.0; ROOM], &mut probe);
        let lateral_mps2 = self.parameters.lateral_mps2(&probe);
        PlantSample::new(state, control, (&probe, lateral_mps2), &self.steered)
    }

    /// Step of the integration.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }
}
