//! Offline models of a tractor-semitrailer: its vehicle file, its linear model, the reduction of
//! this model, and the design for the estimator.
//!
//! | module | contents | reference |
//! |---|---|---|
//! | [`hint`] | the options that messages recommend | – |
//! | [`finding`], [`error`] | findings and errors about a vehicle file or a model | – |
//! | [`files`], [`limits`] | reading of small files up to a size limit; limits that no road vehicle exceeds | – |
//! | [`load`], [`vehicle`] | loads of the trailer, the vehicle file | ch. 2 |
//! | [`balance`] | axle and fifth-wheel loads | eqs. 2.1–2.6 |
//! | [`scales`] | sources of the trailer mass, and how exact they are | – |
//! | [`check`] | reads a vehicle file and checks whether its numbers are plausible | – |
//! | [`guide`] | templates, JSON schema and documentation of the vehicle file | – |
//! | [`friction`] | friction of measured springs in the roll angle of each channel | Tables 2.3–2.8 |
//! | [`tables`], [`characteristics`] | measured springs and tires in the file, and their evaluation | Tables 2.3–2.9 |
//! | [`slip`] | the cornering stiffness of a tire with a slip table | – |
//! | [`lift`] | the vehicle with its lift axles raised | – |
//! | [`twisting`] | a semitrailer whose frame twists | – |
//! | [`assumptions`] | what a vehicle file says that no measurement contradicts | – |
//! | [`floor`] | a load's c.g. is above the floor on which it stands | – |
//! | [`matrix`] | eigenvalues and exponential of a matrix | – |
//! | [`system`], [`response`] | linear systems, transfer functions, poles, zeros, time histories | eqs. 4.61, 4.62 |
//! | [`equations`], [`linear`] | equations of motion (also of a frame that twists), analytic DC ratio | ch. 3, 4, eq. 5.17 |
//! | [`wind`], [`side_wind`] | the side of the trailer's body, and what a side wind does to its roll | – |
//! | [`road_twist`] | what a bank that changes along the truck does to its pairs | – |
//! | [`trailer_path`] | the path of the trailer from the yaw rate of the tractor | – |
//! | [`filled`] | values that an export has filled in | – |
//! | [`preparation`] | what is done to samples before they are used: spikes, the tractor's path, road twist | – |
//! | [`lean`] | the roll angle of a trailer whose load stands beside the middle | – |
//! | [`reduction`] | the reduced 5th-order model and its error | section 5.5 |
//! | [`compensation`] | the compensation F(s) between two responses | section 5.4 |
//! | [`belief`] | uncertain parameters of a truck | eq. 5.19 |
//! | [`influence`] | the uncertain parameters that matter most for the height | – |
//! | [`second_sensor`] | two roll sensors on a frame that twists | – |
//! | [`steady_turn`] | the rollover threshold, axle by axle | section 1.2 |
//! | [`design`] | the constants for `cg_core` | – |
//! | [`calibration`] | estimation of the uncertain parameters and of the shapes F(s) from runs | eqs. 5.4, 5.19 |
//! | [`compensated`] | F(s) of a calibration, its product with the model, and the product reduced to order 5 | eqs. 5.3–5.12 |
//! | [`emit`] | the design as JSON, Rust or C for firmware | – |
//!
//! Axes and signs are those of [`cg_core::signal::sample`] (ISO 8855). The references are to the
//! thesis (F. Yang, Concordia University, 2005).
//!
//! # Example
//!
//! The height that follows from a DC ratio of roll angle to steer angle, at 50 km/h:
//!
//! ```
//! use cg_core::Channel;
//! use cg_vehicle::{Variant, Vehicle, design::design};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
//! let vehicle = Vehicle::load(file)?;
//! let design = design(&vehicle, Variant::Complete)?;
//! let line = design.line(Channel::Steer, 13.889, 30_000.0).unwrap();
//! let ratio = line.ratio_at(2.0);
//! assert!(line.ratio_at(2.1) > ratio && ratio > 0.0);
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod hint;
pub mod finding;
pub mod error;
pub mod files;
pub mod limits;
pub mod tables;
pub mod load;
pub mod sensor_places;
pub mod wind;
mod uncertainty;
pub mod vehicle;
pub mod balance;
pub mod scales;
pub mod slip;
pub mod check;
pub mod characteristics;
pub mod guide;
mod measured_springs;
mod leveled;
pub mod twisting;
pub mod assumptions;
pub mod floor;
pub mod matrix;
pub mod system;
mod output_error;
pub mod response;
mod cornering;
pub mod equations;
pub mod lift;
mod as_printed;
mod assembly;
pub mod linear;
pub mod lean;
pub mod side_wind;
pub mod road_twist;
pub mod trailer_path;
mod twist_correction;
pub mod filled;
mod spikes;
pub mod preparation;
pub mod friction;
mod articulation;
pub mod reduction;
pub mod compensation;
pub mod belief;
mod ratio_spread;
pub mod influence;
pub mod second_sensor;
pub mod steady_turn;
pub mod design;
pub mod calibration;
pub mod compensated;
pub mod emit;

pub use equations::Variant;
pub use error::VehicleError;
pub use linear::LinearModel;
pub use load::Load;
pub use vehicle::Vehicle;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
