//! What the estimator on board says of a height, with the vehicle file's numbers, nothing
//! calibrated.

use cg_core::Rollover;
use cg_core::{Measured, ThresholdLine};

use super::RollPlane;
use crate::design::rollover;
use crate::error::VehicleError;
use crate::vehicle::{Load, Vehicle};

/// Static stability factor and threshold of a load.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn on_board(vehicle: &Vehicle, load: Load, speed_mps: f64) -> Result<Rollover<f64>, VehicleError> {
    // On board the effective track is that of the vehicle file's reference load.
    let design = rollover(vehicle, vehicle.reference_load())?;
    let threshold_g = RollPlane::new(vehicle, load, speed_mps, 1.0)?.threshold_g(load.cg_height_m);
    let line = ThresholdLine { threshold_g: [threshold_g; _] };
    let height = Measured::exact(load.cg_height_m);
    let span_m = [vehicle.height.least_m, vehicle.height.greatest_m];
    Ok(design.at(height, load.trailer_mass_kg, &line, span_m))
}
