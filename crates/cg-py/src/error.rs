//! Exceptions: a missing file is `FileNotFoundError`, other trouble of the system `OSError`,
//! everything else `ValueError`. Messages are those of the library.

use std::io::{self, ErrorKind};

use cg_vehicle::VehicleError;
use cg_vehicle::log::{LogError, OptionError};
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyPermissionError, PyValueError};

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
        LogError::Open { source, .. } | LogError::Read { source, .. } => os_error(source, message),
        _ => value_error(message),
    }
}

pub(crate) fn option_error(error: OptionError) -> PyErr {
    value_error(error.to_string())
}

/// Options that messages of the library name as the command line does, and what they are here.
const KEYWORDS: [(&str, &str); 4] = [
    ("--speed-mps", "speed_mps"),
    ("--trailer-mass-kg", "trailer_mass_kg"),
    ("--model complete", "model=\"complete\""),
    ("--flip", "flip"),
];

/// A message of the library whose remedy is a Python keyword, not a command-line option.
pub(crate) fn in_python(message: &str) -> String {
    let mut text = message.to_owned();
    for (option, keyword) in KEYWORDS {
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
    out
}
