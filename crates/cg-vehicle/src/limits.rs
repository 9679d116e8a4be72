//! Limits that no road vehicle exceeds. Larger numbers are errors of the unit or of typing.

use crate::error::VehicleError;

/// Height of the c.g. of a trailer's sprung mass.
pub const GREATEST_HEIGHT_M: f64 = 6.0;
/// Mass of a whole semitrailer or of its payload, including heavy haulage.
pub const GREATEST_TRAILER_MASS_KG: f64 = 200e3;
/// Distance of a payload's c.g. behind the fifth wheel.
pub const GREATEST_PAYLOAD_BEHIND_HITCH_M: f64 = 20.0;
/// Greatest speed of a wind: a storm, in which no box body drives.
pub const GREATEST_WIND_MPS: f64 = 30.0;
/// Forward speed.
pub const GREATEST_SPEED_MPS: f64 = 60.0;
/// Mean steer angle of the road wheels.
pub const GREATEST_STEER_RAD: f64 = 1.0;
/// Rate `a` of a rounded step (eq. 5.3).
pub const GREATEST_STEP_RATE_PER_S: f64 = 100.0;
/// Number of samples per second.
pub const GREATEST_RATE_HZ: f64 = 10_000.0;
/// Duration of a log: one day.
pub const GREATEST_DURATION_S: f64 = 86_400.0;
/// Number of rows of a simulated log.
pub const GREATEST_ROWS: f64 = 1e7;

/// A number that is positive and not above its limit.
///
/// # Errors
/// What it must be: "must be positive" or "must be at most 60".
pub fn up_to(value: f64, greatest: f64) -> Result<f64, String> {
    if !(value > 0.0) {
        Err("must be positive".to_owned())
    } else if value > greatest {
        Err(format!("must be at most {greatest}"))
    } else {
        Ok(value)
    }
}

/// Checks that a number is positive and not above its limit.
///
/// # Errors
/// [`VehicleError::Model`] with the name, the value and the limit.
pub fn positive(name: &str, value: f64, greatest: f64) -> Result<(), VehicleError> {
    up_to(value, greatest).map(|_| ()).map_err(|_| {
        VehicleError::Model(format!("{name} {value} must be positive and at most {greatest}"))
    })
}
