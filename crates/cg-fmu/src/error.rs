//! The error of this crate.

use cg_vehicle::{VehicleError, hint};

/// What went wrong, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FmuError(String);

impl FmuError {
    /// An error of a call that breaks the rules of FMI, with this message.
    pub fn call(message: impl Into<String>) -> Self {
        Self::new(message)
    }

    /// An error with this message.
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

/// A message that begins with the name of a number of the plant begins with that of the variable.
impl From<VehicleError> for FmuError {
    fn from(error: VehicleError) -> Self {
        let message = hint::told(&error.to_string(), |name, _| name.to_owned());
        let Some((name, problem)) = message.split_once(' ') else { return Self(message) };
        let variable = match name {
            "steer_rad" => "steer_demand_rad",
            "speed_mps" => "speed_demand_mps",
            "interval_s" => "the communication step size",
            _ => return Self(message),
        };
        Self(format!("{variable} {problem}"))
    }
}
