//! The offline half: vehicle files, the linear model of a tractor-semitrailer, its reduction,
//! the design that the estimator runs on, log files and simulated logs.
//!
//! | module | what | source |
//! |---|---|---|
//! | [`vehicle`] | the vehicle file | ch. 2 |
//! | [`check`] | whether its numbers can be | – |
//! | [`files`] | small files, read with a limit | – |
//! | [`tables`] | measured springs and tyres in it | Tables 2.3–2.9 |
//! | [`balance`] | axle and fifth-wheel loads | eqs. 2.1–2.6 |
//! | [`linear`] | equations of motion, analytic DC ratio | ch. 3, 4, eq. 5.17 |
//! | [`response`] | transfer functions, poles, zeros, time histories | eqs. 4.61, 4.62 |
//! | [`system`], [`reduction`] | linear systems; the reduced 5th-order model and its error | section 5.5 |
//! | [`compensation`] | F(s) between two responses | section 5.4 |
//! | [`belief`], [`calibration`] | what is not known of a truck, and what runs say of it | eq. 5.19 |
//! | [`design`] | the constants for `cg_core` | – |
//! | [`emit`] | the same as JSON, Rust or C, for firmware | – |
//! | [`plant`] | nonlinear yaw/roll/pitch/bounce simulator | ch. 2, UMTRI |
//! | [`rollover`] | rollover measures of a vehicle and load | section 1.2 |
//! | [`maneuver`], [`sensors`], [`simulate`] | steer and speed histories, sensors, logs with known truth | section 5.3 |
//! | [`study`] | the nonlinear plant over maneuver, load and vehicle | sections 2.5–2.7 |
//! | [`log`] | log files in and out | – |
//! | [`state`] | what is learnt, as a text | – |
//! | [`output`] | what a call may write, and how it is written whole | – |
//! | [`accuracy`] | Monte-Carlo: errors and intervals | section 5.3.2 |
//! | [`reproduce`] | the source's tables beside ours | all of it |
//!
//! Axes and signs are those of [`cg_core::sample`] (ISO 8855).

pub mod error;
pub mod output;
pub mod check;
pub mod files;
pub mod tables;
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
pub mod maneuver;
pub mod reduction;
pub mod can;
pub mod compensation;
pub mod design;
pub mod emit;
pub mod plant;
pub mod limits;
pub mod rollover;
pub mod sensors;
pub mod simulate;
pub mod study;
pub mod log;
pub mod state;
pub mod estimate;
pub mod accuracy;
pub mod reproduce;

pub use error::VehicleError;
pub use linear::{LinearModel, Variant};
pub use vehicle::{Load, Vehicle};
