//! `cgheight._native`: the compiled module of the Python package `cgheight`.
//!
//! | file | what it gives to Python |
//! |---|---|
//! | `vehicle` | `Vehicle`, `restore_vehicle` |
//! | `change` | values of Python for keys of a vehicle file |
//! | `options` | the options that every estimate shares |
//! | `reading` | how logs and frames are read |
//! | `signals` | `estimate_arrays`, `learn_arrays`, `predict_roll`: estimates, learning and predictions from arrays |
//! | `log` | `estimate_file`, `read_file`, `read_frames`, `resolve_columns`, `signals`: log files and their column names |
//! | `prepare` | `prepare`: channels of different rasters, and roll angles from a roll rate |
//! | `calibrate` | `calibrate_files`: calibration from logs and from trips with the empty trailer |
//! | `stream` | `Stream`: the estimator, row by row |
//! | `scenario`, `simulate` | `simulate_log`, `score_accuracy`: logs with known truth |
//! | `plant` | `Plant`: the nonlinear plant, step by step; `restore_plant` |
//! | `write` | `write_file`, `copy_file`, `may_write`: writing of log files |
//! | `report` | `trace_arrays`, `write_report`, `may_write_report`: the report of many logs |
//! | `can` | `FrameTable`, `FrameStream`, `several_buses`: rows and estimates from CAN frames |
//! | `reproduce` | `reproduce_tables`: the tables of the thesis, recomputed |
//! | `results` | results as the dataclasses of `cgheight._results` |
//! | `arx`, `linear` | `fit_arx`, `linear_model` |
//! | `rollover` | `rollover_measures` |
//! | `error` | exceptions |
//!
//! Arrays are read in place, and loops run detached from the interpreter so that other Python
//! threads can run. Each loop regularly checks whether the user has interrupted it. Lists, other
//! number types and data frames are converted to arrays in Python.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// PyO3 takes arguments by value, and doc comments become docstrings in numpydoc's form.
#![allow(clippy::needless_pass_by_value, clippy::doc_markdown)]

mod error;
mod options;
mod change;
mod vehicle;
mod results;
mod reading;
mod signals;
mod log;
mod prepare;
mod stream;
mod calibrate;
mod arx;
mod linear;
mod scenario;
mod plant;
mod simulate;
mod write;
mod can;
mod report;
mod reproduce;
mod rollover;

/// The compiled module of cgheight.
#[pyo3::pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use crate::arx::fit_arx;
    #[pymodule_export]
    use crate::calibrate::calibrate_files;
    #[pymodule_export]
    use crate::can::{FrameStream, FrameTable, several_buses};
    #[pymodule_export]
    use crate::linear::linear_model;
    #[pymodule_export]
    use crate::log::{estimate_file, read_file, read_frames, resolve_columns, signals};
    #[pymodule_export]
    use crate::plant::{Plant, restore_plant};
    #[pymodule_export]
    use crate::prepare::{channel_factor, prepare};
    #[pymodule_export]
    use crate::report::{may_write_report, trace_arrays, write_report};
    #[pymodule_export]
    use crate::reproduce::reproduce_tables;
    #[pymodule_export]
    use crate::rollover::rollover_measures;
    #[pymodule_export]
    use crate::signals::{after_lags, estimate_arrays, learn_arrays, predict_roll};
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

    /// Loads the interface of NumPy now: the first array would load it, and panic if Ctrl-C was pressed before.
    #[pymodule_init]
    #[allow(clippy::unnecessary_wraps)] // PyO3 wants a result
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        numpy::PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }
}
