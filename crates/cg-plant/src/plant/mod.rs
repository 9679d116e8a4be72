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
//! | `ground` | the road under the vehicle |
//! | `body` | sprung masses: attitude, motion, equations of a unit |
//! | `front` | the front half of a trailer whose frame twists |
//! | `axle` | two degrees of freedom on a sliding roll center, eliminated directly |
//! | `suspension` | springs: linear, or measured with friction; load equalization |
//! | `tyre` | radial spring, lateral force and aligning moment over slip and load |
//! | `hitch` | the fifth wheel: roll spring, separation, lash |
//! | `joint` | both units as one, carried by the fifth wheel |
//! | `dynamics` | the equations of motion |
//! | `equilibrium` | straight driving by Newton's method |
//! | `integrate` | Adams-Bashforth-Moulton or Runge-Kutta; rollover |
//! | `linearize` | small motion about straight driving |
//! | `path`, `driver` | a path and MacAdam's preview driver along it |
//! | `sample` | outputs at an instant |
//!
//! Each sprung mass moves laterally, vertically, and in yaw, roll and pitch, at a prescribed forward
//! speed. A trailer whose frame twists has two halves that roll by different angles. Each axle moves in roll and bounce. The fifth wheel connects the units in every direction
//! and leaves yaw and pitch free. The road has a bank and a grade, and
//! each axle may stand on a bank of its own.
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

mod options;
mod path;
mod state;
mod vector;
mod ground;
mod suspension;
#[cfg(test)]
mod energy;
mod body;
mod front;
mod hitch;
mod joint;
mod tyre;
mod axle;
mod dynamics;
mod equilibrium;
mod sample;
mod setup;
mod method;
mod yaw_roll;
mod integrate;
mod driver;
mod linearize;

pub use driver::{Driver, DriverMoment, DriverSettings};
pub use dynamics::Control;
pub use ground::Ground;
pub use integrate::{Moment, Progress, Simulation};
pub use options::{Characteristics, PlantOptions};
pub use path::Path;
pub use sample::{AxleSample, PlantSample, UnitSample};
pub(crate) use setup::check_payload_left;
pub use state::{AxleCoordinate, Coordinate, MAX_AXLES, State};
pub use yaw_roll::YawRollPlant;
