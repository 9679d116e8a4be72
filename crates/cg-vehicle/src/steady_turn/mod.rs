//! The rollover threshold in a steady turn, axle by axle.
//!
//! | file | contents | based on |
//! |---|---|---|
//! | `roll_plane` | balance of moments at a roll angle, with wheels that lift | static equilibrium |
//! | `path` | the threshold: the greatest lateral acceleration of all roll angles | roll plane, yaw plane |
//! | `yaw_plane` | lateral forces in the turn and the articulation | steady yaw plane |
//! | `suspension` | axles that share springs, eliminated from the roll plane | springs and tires |
//! | `support` | springs and tires in the roll plane | vehicle file |
//! | `frame` | the front half of a trailer whose frame twists | [`twisting`](crate::twisting) |
//! | `half_track` | half track and unsprung mass for the static stability factor, the tightest turn | vehicle file, yaw plane |
//! | `at_rest` | side-pull and tilt-table ratio | the same balance without a curve |
//! | `on_board` | threshold at a speed; static stability factor and threshold as on board | `cg_core::truck::rollover` |
//!
//! # Example
//!
//! ```
//! use cg_vehicle::Vehicle;
//! use cg_vehicle::steady_turn::on_board;
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
//! let vehicle = Vehicle::load(file)?;
//! let measures = on_board(&vehicle, vehicle.reference_load(), 20.0)?;
//! let threshold_g = measures.static_rollover_threshold_g.value;
//! assert!(threshold_g < measures.static_stability_factor_g && threshold_g > 0.3);
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

mod support;
mod yaw_plane;
mod frame;
mod point;
mod suspension;
mod roll_plane;
mod path;
mod half_track;
mod at_rest;
mod on_board;

pub use at_rest::{side_pull_ratio, tilt_table_ratio};
pub(crate) use half_track::rollover;
pub(crate) use on_board::thresholds_g;
pub use on_board::{on_board, steady_turn_threshold_g};
