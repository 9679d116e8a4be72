//! What the estimator on board says of a height: [`cg_core::rollover`] with the vehicle file's
//! numbers, nothing calibrated.

use cg_core::{Measured, Rollover};

use crate::design::rollover;
use crate::error::VehicleError;
use crate::linear::{Variant, ratio_line};
use crate::vehicle::{Load, Vehicle};

/// Static stability factor and threshold of a load at a speed.
///
/// # Errors
/// [`VehicleError`] if the load is impossible or the linear model has no steady turn.
pub fn closed_form(
    vehicle: &Vehicle,
    load: Load,
    speed_mps: f64,
) -> Result<Rollover<f64>, VehicleError> {
    // On board the effective track is that of the vehicle file's reference load.
    let design = rollover(vehicle, vehicle.reference_load())?;
    let [_, lateral] = ratio_line(vehicle, Variant::Complete, speed_mps, load)?;
    let height = Measured::exact(load.cg_height_m);
    Ok(design.at(height, load.trailer_mass_kg, &lateral, 1.0, vehicle.gravity_mps2))
}
