//! Exceptions: a missing file is `FileNotFoundError`, other trouble of the system `OSError`,
//! a file that is not ours `FileExistsError`, everything else `ValueError`. Messages are those of the library.

use std::ffi::CString;
use std::io::{self, ErrorKind};

use cg_logs::log::{LogError, OptionError};
use cg_logs::output::OutputError;
use cg_vehicle::VehicleError;
use pyo3::exceptions::{
    PyFileExistsError, PyFileNotFoundError, PyOSError, PyPermissionError, PyUserWarning,
    PyValueError,
};
use pyo3::prelude::*;

/// `ValueError` with a message.
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

/// `warnings.warn`, at the place of the caller.
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
        OutputError::Foreign { .. } | OutputError::Protected { .. } => {
            PyFileExistsError::new_err(message)
        }
        _ => value_error(message),
    }
}

pub(crate) fn option_error(error: OptionError) -> PyErr {
    value_error(error.to_string())
}

/// Options with a value that messages of the library name as the command line does.
const WITH_VALUE: [(&str, &str); 4] = [
    ("--force", "force=True"),
    ("--model complete", "model=\"complete\""),
    ("--maneuver drive", "maneuver=\"drive\""),
    ("--plant nonlinear", "plant=\"nonlinear\""),
];

/// A message of the library whose remedy is a Python keyword, not a command-line option.
pub(crate) fn in_python(message: &str) -> String {
    let mut text =
        message.replace("--turn-deg", "--turn-rad").replace("--step-rate", "--step-rate-per-s");
    for (option, keyword) in WITH_VALUE {
        text = text.replace(option, keyword);
    }
    let mut parts = text.split("--column ");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        // 'roll=Roll rate[deg]' with quotes, roll=Roll[deg] without
        let (map, rest) = match part.strip_prefix('\'') {
            Some(quoted) => quoted.split_once('\'').unwrap_or((quoted, "")),
            None => part.split_at(part.find([' ', ';', ',', ')']).unwrap_or(part.len())),
        };
        let (signal, name) = map.split_once('=').unwrap_or((map, ""));
        out.extend(["columns={\"", signal, "\": \"", name, "\"}", rest]);
    }
    keywords(&out)
}

/// `--speed-mps` as `speed_mps`, wherever it stands.
fn keywords(text: &str) -> String {
    let mut parts = text.split("--");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(part.len());
        let (name, rest) = part.split_at(end);
        out.extend([&name.replace('-', "_"), rest]);
    }
    out
}
