//! Calibration: from ratios identified at known height and mass to a belief about the truck.
//!
//! | module | what |
//! |---|---|
//! | [`mod@fit`] | ratios of the runs to the parameters of [`crate::belief`] |
//! | [`mod@file`] | the calibration file |
//!
//! From logs to ratios: `cg_logs::calibrate`.

pub mod fit;
pub mod file;

pub use file::Calibration;
pub use fit::{Fitted, Run, fit};
