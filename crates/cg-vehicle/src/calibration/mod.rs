//! Calibration: estimates the uncertain parameters of a truck from ratios identified at known
//! height and mass.
//!
//! | module | contents |
//! |---|---|
//! | `judgment` | whether the runs are possible for the vehicle file |
//! | `ratios` | the runs, and what their ratios leave unexplained |
//! | `heights` | runs of unknown height |
//! | `walk` | the changes of a truck in service |
//! | [`mod@fit`] | estimation of the parameters of [`crate::belief`] from the ratios of the runs |
//! | `shape_fit`, [`shape`] | the compensation function `F(s)` of each channel, and its order |
//! | `part` | what a calibration is for, and the parts of the vehicle file on which it depends |
//! | `entry` | the tables of the file: parameters, runs |
//! | `possible` | the numbers that it can have |
//! | `advice` | what another run would tell |
//! | `statement` | what the runs could and could not determine |
//! | [`mod@file`] | the calibration file |
//!
//! `cg_logs::calibrate` identifies the ratios from logs.

mod judgment;
mod ratios;
mod heights;
mod walk;
pub mod fit;
mod shape_fit;
pub mod shape;
mod part;
mod entry;
mod possible;
mod advice;
mod statement;
pub mod file;

pub use entry::{
    ChannelEntry, Compensations, ParameterEntry, RatioUnit, RunEntry, ShapeEntry, Unit,
};
pub use file::Calibration;
pub use fit::{Fitted, Prior, Procedure, fit, fit_from};
pub use judgment::Judgment;
pub use part::{Part, vehicle_crc32};
pub use ratios::{Misfit, Residual, Run, misfits};
