//! A truck on paper: its file, the linear model of a tractor-semitrailer, its reduction and the design
//! that the estimator runs on.
//!
//! | module | what | source |
//! |---|---|---|
//! | [`vehicle`], [`load`] | the vehicle file, loads of the trailer | ch. 2 |
//! | [`check`] | whether its numbers are plausible | – |
//! | [`files`] | small files, read with a limit | – |
//! | [`tables`], [`characteristics`] | measured springs and tyres in it, and their evaluation | Tables 2.3–2.9 |
//! | [`balance`] | axle and fifth-wheel loads | eqs. 2.1–2.6 |
//! | [`linear`] | equations of motion, analytic DC ratio | ch. 3, 4, eq. 5.17 |
//! | [`response`] | transfer functions, poles, zeros, time histories | eqs. 4.61, 4.62 |
//! | [`system`], [`reduction`] | linear systems; the reduced 5th-order model and its error | section 5.5 |
//! | [`compensation`] | F(s) between two responses | section 5.4 |
//! | [`belief`], [`calibration`] | what is not known of a truck, and what runs say of it | eq. 5.19 |
//! | [`steady_turn`] | the rollover threshold, axle by axle | section 1.2 |
//! | [`design`] | the constants for `cg_core` | – |
//! | [`emit`] | the same as JSON, Rust or C, for firmware | – |
//! | [`limits`] | what no vehicle on a road exceeds | – |
//!
//! Axes and signs are those of [`cg_core::sample`] (ISO 8855).
//!
//! # Example
//!
//! The height that a DC ratio of roll over steer means, at 50 km/h:
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

pub mod error;
pub mod check;
pub mod files;
pub mod tables;
pub mod characteristics;
pub mod load;
pub mod vehicle;
pub mod balance;
pub mod system;
mod output_error;
pub mod response;
mod as_printed;
pub mod linear;
pub mod belief;
pub mod calibration;
pub mod reduction;
pub mod compensation;
pub mod steady_turn;
pub mod design;
pub mod emit;
pub mod limits;

pub use error::VehicleError;
pub use linear::{LinearModel, Variant};
pub use vehicle::{Load, Vehicle};

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
