//! A simulated truck for tests: a nonlinear simulator with driver, maneuvers and sensors, simulated
//! logs with known truth, and rollover measures.
//!
//! | module | contents | reference |
//! |---|---|---|
//! | [`plant`] | nonlinear yaw/roll/pitch/bounce simulator and driver | ch. 2, UMTRI |
//! | [`random`] | noise of sensors | – |
//! | [`road`] | curvature, bank and speed limit over the distance | – |
//! | [`maneuver`] | steer and speed histories | section 5.3 |
//! | [`sensors`] | sensor errors added to the truth | section 5.3 |
//! | [`simulate`] | logs with known truth | section 5.3 |
//! | [`rollover`] | rollover measures of a vehicle and load | section 1.2 |
//! | [`residual`] | what the equations of a vehicle leave out | – |
//!
//! # Example
//!
//! See [`plant`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod random;
pub mod maneuver;
pub mod road;
pub mod plant;
pub mod sensors;
pub mod rollover;
pub mod simulate;
pub mod residual;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
