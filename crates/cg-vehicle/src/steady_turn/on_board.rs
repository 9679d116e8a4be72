//! The rollover threshold in a steady turn, at one speed and as the estimator on board computes it.

use cg_core::truck::rollover::{HEIGHTS, TURN_MPS};
use cg_core::{Measured, Rollover, ThresholdLine};

use super::half_track::rollover;
use super::roll_plane::RollPlane;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The thresholds of a load, in g, in turns at [`TURN_MPS`] and at several heights. Every roll
/// angle is multiplied by `compliance`, the compensation `R_c` of a calibration.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub(crate) fn thresholds_g<const N: usize>(
    vehicle: &Vehicle,
    load: Load,
    compliance: f64,
    height_m: [f64; N],
) -> Result<[[f64; N]; 2], VehicleError> {
    let vehicle = &*vehicle.with_springs_at(load)?;
    let mut found_g = [[0.0; N]; 2];
    let mut plane = RollPlane::new(vehicle, load, TURN_MPS[0], compliance)?;
    for (threshold_g, speed_mps) in found_g.iter_mut().zip(TURN_MPS) {
        plane = plane.at_speed(speed_mps)?;
        *threshold_g = height_m.map(|height_m| plane.threshold_g(height_m));
    }
    Ok(found_g)
}

/// The static stability factor and the threshold of a load in a steady turn at a speed, as the
/// estimator on board computes them for a known height. They are based on the vehicle file without
/// calibration, and the threshold follows from those at 40 and 90 km/h.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn on_board(
    vehicle: &Vehicle,
    load: Load,
    speed_mps: f64,
) -> Result<Rollover<f64>, VehicleError> {
    // The estimator on board uses the effective track at the reference load of the vehicle file.
    let design = rollover(vehicle, vehicle.reference_load())?;
    let found_g = thresholds_g(vehicle, load, 1.0, [load.cg_height_m])?;
    let line = ThresholdLine { threshold_g: found_g.map(|[threshold_g]| [threshold_g; HEIGHTS]) };
    let height = Measured::exact(load.cg_height_m);
    let span_m = [vehicle.height.least_m, vehicle.height.greatest_m];
    let threshold_g = line.at_speed(speed_mps, design.tightest_turn_g);
    Ok(design.at(height, load.trailer_mass_kg, &threshold_g, span_m))
}

/// The rollover threshold: the greatest lateral acceleration of the trailer, in g, that the vehicle
/// sustains in a steady turn at a speed. Beyond it, the vehicle tips.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn steady_turn_threshold_g(
    vehicle: &Vehicle,
    load: Load,
    speed_mps: f64,
) -> Result<f64, VehicleError> {
    let vehicle = &*vehicle.with_springs_at(load)?;
    Ok(RollPlane::new(vehicle, load, speed_mps, 1.0)?.threshold_g(load.cg_height_m))
}
