//! `cgheight._native`: the compiled half of the Python package `cgheight`.
//!
//! | file | what Python sees |
//! |---|---|
//! | `vehicle` | `Vehicle`, `restore_vehicle` |
//! | `options` | the options that every estimate shares |
//! | `reading` | how logs and frames are read |
//! | `signals` | `estimate_arrays`, `predict_roll`: arrays in, answer or roll angle out |
//! | `log` | `estimate_file`, `read_file`, `read_frames`, `resolve_columns`, `signals`: logs and the names of their columns |
//! | `calibrate` | `calibrate_files`: logs of known height to a calibration file |
//! | `stream` | `Stream`: row by row |
//! | `scenario`, `simulate` | `simulate_log`, `score_accuracy`: logs with known truth |
//! | `write` | `write_file`, `copy_file`, `may_write`: arrays to a log file, if it may be written |
//! | `can` | `FrameTable`, `FrameStream`: CAN frames to rows, and to an estimate |
//! | `reproduce` | `reproduce_tables`: the source's tables beside ours |
//! | `results` | answers as the dataclasses of `cgheight._results` |
//! | `arx`, `linear` | `fit_arx`, `linear_model` |
//! | `error` | exceptions |
//!
//! Arrays are read in place and loops run detached from the interpreter, so other Python
//! threads go on; every now and then a loop looks whether it was interrupted. What is
//! convenient (lists, other number types, data frames) is made into arrays in Python.
// PyO3 takes arguments by value, and doc comments become docstrings in numpydoc's form.
#![allow(clippy::needless_pass_by_value, clippy::doc_markdown)]

mod error;
mod vehicle;
mod options;
mod results;
mod reading;
mod signals;
mod log;
mod stream;
mod calibrate;
mod arx;
mod linear;
mod scenario;
mod simulate;
mod write;
mod can;
mod reproduce;

/// The compiled half of cgheight.
#[pyo3::pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use crate::arx::fit_arx;
    #[pymodule_export]
    use crate::calibrate::calibrate_files;
    #[pymodule_export]
    use crate::can::{FrameStream, FrameTable};
    #[pymodule_export]
    use crate::linear::linear_model;
    #[pymodule_export]
    use crate::log::{estimate_file, read_file, read_frames, resolve_columns, signals};
    #[pymodule_export]
    use crate::reproduce::reproduce_tables;
    #[pymodule_export]
    use crate::signals::{estimate_arrays, predict_roll};
    #[pymodule_export]
    use crate::simulate::{score_accuracy, simulate_log};
    #[pymodule_export]
    use crate::stream::Stream;
    #[pymodule_export]
    use crate::vehicle::{Vehicle, restore_vehicle};
    #[pymodule_export]
    use crate::write::{copy_file, may_write, write_file};

    /// The version of the package.
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // its name in Python
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
