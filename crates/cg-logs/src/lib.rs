//! Log files and CAN frames: reading, writing, height estimation and calibration from logs.
//!
//! | module | what |
//! |---|---|
//! | [`place`] | positions in logs for messages |
//! | [`malformed`] | the error for options that do not have their form |
//! | [`unscaled`](mod@unscaled) | signals that mean nothing without a number of the vehicle file |
//! | [`can`] | candump logs, J1939 and DBC signals, samples with a continuous time |
//! | [`log`] | reading and writing of CSV, gzip, Parquet and candump logs |
//! | [`estimate`] | the height of a log, with messages and likely causes of contradictions |
//! | [`web`] | what the pages of the report and of `cg run --serve` have in common |
//! | [`report`] | the report of many logs: an HTML page |
//! | [`calibrate`] | calibration from logs with a known height |
//! | [`learn`] | calibration in service, from trips with the empty trailer |
//! | [`state`] | the text of a state file, which keeps the estimator's memory over a restart |
//!
//! # Example
//!
//! ```
//! use cg_logs::estimate::{EstimateOptions, LogEstimator};
//! use cg_logs::log::{LogOptions, LogReader};
//! use cg_vehicle::Vehicle;
//!
//! let fixtures = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");
//! let vehicle = Vehicle::load(format!("{fixtures}/vehicles/kraz.toml"))?;
//! let log = format!("{fixtures}/logs/A_p20_h190_v50_L.csv");
//! let mut estimator = LogEstimator::new(&vehicle, EstimateOptions::default())?;
//! for row in LogReader::open(log.as_ref(), &LogOptions::default())? {
//!     estimator.push(&row?)?;
//! }
//! let height_m = estimator.finish().height_m.unwrap();
//! assert!((height_m / 1.9 - 1.0).abs() < 0.1, "{height_m}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod malformed;
pub mod place;
pub mod unscaled;
pub mod lift_signal;
pub mod can;
mod seldom;
pub mod log;
pub mod estimate;
pub mod web;
pub mod report;
mod known;
mod same_drive;
pub mod calibrate;
mod learned;
pub mod learn;
pub mod state;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
