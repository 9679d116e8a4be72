//! Rollover measures of a vehicle under a load (the source, section 1.2).
//!
//! | file | what | from |
//! |---|---|---|
//! | `roll_plane` | rollover threshold in a steady turn, axle by axle | static equilibrium |
//! | `turn` | its lateral forces and articulation | steady yaw plane |
//! | `support` | its springs and tyres | vehicle file |
//! | `on_board` | threshold at a speed; static stability factor and threshold as on board | `cg_core::rollover` |
//! | `ramp` | static rollover threshold, wheel lift, load transfer | nonlinear plant |
//! | `transfer` | load transfer ratio, roll safety factor | an instant of it |
//! | `time` | time to rollover, predicted and simulated | ramp |
//! | `maneuver` | peaks in a lane change and in a sine: rearward amplification | nonlinear plant |
//! | `small` | rearward amplification over frequency, yaw modes | linear model |
//! | `decay` | yaw damping from a pulse of steer | nonlinear plant |
//! | `offtracking` | high speed, low speed | nonlinear plant, geometry |
//! | `measure` | all of it with units and a sentence each | – |
//!
//! # Example
//!
//! ```
//! use cg_vehicle::Vehicle;
//! use cg_vehicle::rollover::on_board;
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
//! let vehicle = Vehicle::load(file)?;
//! let measures = on_board(&vehicle, vehicle.reference_load(), 20.0)?;
//! let threshold_g = measures.static_rollover_threshold_g.value;
//! assert!(threshold_g < measures.static_stability_factor_g && threshold_g > 0.3);
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

pub mod decay;
pub mod maneuver;
mod measure;
mod on_board;
pub mod offtracking;
mod ramp;
mod roll_plane;
pub mod small;
mod support;
mod time;
mod transfer;
mod turn;

pub use measure::{Measure, RolloverMeasures, RolloverOptions, measures};
pub(crate) use on_board::threshold_line;
pub use on_board::{on_board, steady_turn_threshold_g};
pub use ramp::{Ramp, RampEnd, RampPoint};
use roll_plane::RollPlane;
pub use time::{TimeToRollover, time_to_rollover_s};
pub use transfer::Transfer;

/// Standard gravity: what "g" means in measures, whatever the vehicle file's own is.
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;
