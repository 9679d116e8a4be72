//! Logs: from files and CAN frames to samples and back, and the height that a log tells.
//!
//! | module | what |
//! |---|---|
//! | [`output`] | what a call may write, and how it is written whole |
//! | [`place`] | places in logs, for messages |
//! | [`malformed`] | the error of options with a form of their own |
//! | [`can`] | candump logs, J1939 and DBC signals, samples of one clock |
//! | [`log`] | CSV, gzip, Parquet and candump logs in and out |
//! | [`estimate`] | the height of a log, with reasons and likely causes |
//! | [`state`] | what is learnt, as the text of a state file |
//! | [`calibrate`] | calibration from logs of known height |
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

pub mod output;
pub mod malformed;
pub mod state;
pub mod place;
pub mod can;
pub mod log;
pub mod estimate;
pub mod calibrate;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
