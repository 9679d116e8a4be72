//! What no vehicle on a road exceeds: numbers beyond are slips of the unit or of the keyboard.

use crate::error::VehicleError;

/// C.g. height of a trailer's sprung mass.
pub const GREATEST_HEIGHT_M: f64 = 6.0;
/// Mass of a whole semitrailer, also of its payload: heavy haulage.
pub const GREATEST_TRAILER_MASS_KG: f64 = 200e3;
/// Forward speed.
pub const GREATEST_SPEED_MPS: f64 = 60.0;
/// Mean road-wheel steer angle.
pub const GREATEST_STEER_RAD: f64 = 1.0;
/// Rate of a rounded step.
pub const GREATEST_STEP_RATE_PER_S: f64 = 100.0;
/// Samples per second.
pub const GREATEST_RATE_HZ: f64 = 10_000.0;
/// Length of a log: a day.
pub const GREATEST_DURATION_S: f64 = 86_400.0;
/// Rows of a simulated log.
pub const GREATEST_ROWS: f64 = 1e7;

/// Whether a number lies above zero and at most at its limit.
///
/// # Errors
/// [`VehicleError::Model`] with name, value and limit.
pub fn positive(name: &str, value: f64, greatest: f64) -> Result<(), VehicleError> {
    if value > 0.0 && value <= greatest {
        return Ok(());
    }
    Err(VehicleError::Model(format!("{name} {value} must be positive and at most {greatest}")))
}
