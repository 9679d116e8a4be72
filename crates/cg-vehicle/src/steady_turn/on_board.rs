//! The rollover threshold in a steady turn, at one speed and as the estimator on board has it.

use cg_core::truck::rollover::{HEIGHTS, TURN_MPS};
use cg_core::{Measured, Rollover, ThresholdLine};

use super::half_track::rollover;
use super::roll_plane::RollPlane;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The thresholds of a load in turns of [`TURN_MPS`] at several heights, in units of gravity.
/// `compliance` scales every roll angle: the compensation `R_c` of a calibration.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub(crate) fn threshold_line(
    vehicle: &Vehicle,
    load: Load,
    compliance: f64,
    height_m: [f64; HEIGHTS],
) -> Result<ThresholdLine<f64>, VehicleError> {
    let mut line = ThresholdLine { threshold_g: [[0.0; HEIGHTS]; 2] };
    for (threshold_g, speed_mps) in line.threshold_g.iter_mut().zip(TURN_MPS) {
        let plane = RollPlane::new(vehicle, load, speed_mps, compliance)?;
        *threshold_g = height_m.map(|height_m| plane.threshold_g(height_m));
    }
    Ok(line)
}

/// Static stability factor and threshold of a load in a steady turn at a speed as the estimator on
/// board has them of a known height, with the vehicle file's numbers, nothing calibrated: between the
/// thresholds at 40 and at 90 km/h.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn on_board(
    vehicle: &Vehicle,
    load: Load,
    speed_mps: f64,
) -> Result<Rollover<f64>, VehicleError> {
    // On board the effective track is that of the vehicle file's reference load.
    let design = rollover(vehicle, vehicle.reference_load())?;
    let line = threshold_line(vehicle, load, 1.0, [load.cg_height_m; HEIGHTS])?;
    let height = Measured::exact(load.cg_height_m);
    let span_m = [vehicle.height.least_m, vehicle.height.greatest_m];
    Ok(design.at(height, load.trailer_mass_kg, &line.at_speed(speed_mps), span_m))
}

/// The greatest lateral acceleration of the trailer that the vehicle sustains in a steady turn at a
/// speed, in units of gravity: beyond it, it tips.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn steady_turn_threshold_g(
    vehicle: &Vehicle,
    load: Load,
    speed_mps: f64,
) -> Result<f64, VehicleError> {
    Ok(RollPlane::new(vehicle, load, speed_mps, 1.0)?.threshold_g(load.cg_height_m))
}
