//! Calibration: estimates the uncertain parameters of a truck from ratios identified at known
//! height and mass.
//!
//! | module | contents |
//! |---|---|
//! | [`mod@fit`] | estimation of the parameters of [`crate::belief`] from the ratios of the runs |
//! | [`mod@file`] | the calibration file |
//!
//! `cg_logs::calibrate` identifies the ratios from logs.

pub mod fit;
pub mod file;

pub use file::Calibration;
pub use fit::{Fitted, Run, fit};
