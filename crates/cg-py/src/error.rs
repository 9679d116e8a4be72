//! Exceptions. A missing file is a `FileNotFoundError`, other system errors are an `OSError`,
//! a file that must not be replaced is a `FileExistsError`, everything else is a `ValueError`. The
//! messages are those of the library, with options written as keywords.

use std::ffi::CString;
use std::io::{self, ErrorKind};

use cg_logs::can::DbcError;
use cg_logs::log::{LogError, OptionError};
use cg_output::OutputError;
use cg_vehicle::{VehicleError, hint};
use pyo3::exceptions::{
    PyFileExistsError, PyFileNotFoundError, PyOSError, PyPermissionError, PyUserWarning,
    PyValueError,
};
use pyo3::prelude::*;

/// A `ValueError` with a message.
pub(crate) fn value_error(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}

pub(crate) fn os_error(source: &io::Error, message: String) -> PyErr {
    match source.kind() {
        ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
        ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
        _ => PyOSError::new_err(message),
    }
}

/// `warnings.warn` for the line of the caller.
pub(crate) fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = CString::new(message.replace('\0', " "))?;
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)
}

pub(crate) fn vehicle_error(error: VehicleError) -> PyErr {
    let message = in_python(&error.to_string());
    match &error {
        VehicleError::Read { source, .. } => os_error(source, message),
        _ => value_error(message),
    }
}

pub(crate) fn log_error(error: LogError) -> PyErr {
    let message = in_python(&error.to_string());
    match &error {
        LogError::Open { source, .. }
        | LogError::Read { source, .. }
        | LogError::Write { source, .. } => os_error(source, message),
        _ => value_error(message),
    }
}

pub(crate) fn output_error(error: OutputError) -> PyErr {
    let message = in_python(&error.to_string());
    match &error {
        OutputError::Write { source, .. } => os_error(source, message),
        OutputError::Foreign { .. }
        | OutputError::Exists { .. }
        | OutputError::Protected { .. } => PyFileExistsError::new_err(message),
        _ => value_error(message),
    }
}

pub(crate) fn option_error(error: OptionError) -> PyErr {
    value_error(format!("columns: {error}"))
}

pub(crate) fn dbc_error(error: DbcError) -> PyErr {
    let message = in_python(&error.to_string());
    match &error {
        DbcError::Read { source, .. } => os_error(source, message),
        _ => value_error(message),
    }
}

/// A message of the library, with options written as Python keywords.
pub(crate) fn in_python(message: &str) -> String {
    hint::told(message, |name, value| match (name, value.split_once('=')) {
        ("force", _) => "force=True".to_owned(),
        ("lift_axle", _) => "vehicle.with_lift_axle".to_owned(),
        ("road", _) => format!("vehicle.on_road(\"{value}\")"),
        (_, None) if value.is_empty() => name.to_owned(),
        ("columns" | "signals", Some((signal, what))) => {
            format!("{name}={{\"{signal}\": \"{what}\"}}")
        }
        _ => format!("{name}=\"{value}\""),
    })
}
