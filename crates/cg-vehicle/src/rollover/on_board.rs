//! The rollover threshold in a steady turn, at one speed and as the estimator on board has it.

use cg_core::Rollover;
use cg_core::{Measured, ThresholdLine};

use super::RollPlane;
use crate::design::rollover;
use crate::error::VehicleError;
use crate::vehicle::{Load, Vehicle};

/// The speeds over which the threshold on board is the least: 40 and 90 km/h. A tighter turn at
/// the same lateral acceleration articulates the vehicle more and sets the axles of a group further
/// apart in slip, which most vehicles withstand less and some a little more; in between the threshold
/// is between both.
const TURN_MPS: [f64; 2] = [40.0 / 3.6, 90.0 / 3.6];

/// The thresholds on board of a load at several heights, in units of gravity. `compliance` scales
/// every roll angle: the compensation `R_c` of a calibration.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub(crate) fn thresholds_g<const N: usize>(
    vehicle: &Vehicle,
    load: Load,
    compliance: f64,
    height_m: [f64; N],
) -> Result<[f64; N], VehicleError> {
    let mut least_g = [f64::INFINITY; N];
    for speed_mps in TURN_MPS {
        let plane = RollPlane::new(vehicle, load, speed_mps, compliance)?;
        for (least_g, height_m) in least_g.iter_mut().zip(height_m) {
            *least_g = least_g.min(plane.threshold_g(height_m));
        }
    }
    Ok(least_g)
}

/// Static stability factor and threshold of a load as the estimator on board has them of a known
/// height, with the vehicle file's numbers, nothing calibrated: the least threshold in steady turns
/// of 40 to 90 km/h.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn on_board(vehicle: &Vehicle, load: Load) -> Result<Rollover<f64>, VehicleError> {
    // On board the effective track is that of the vehicle file's reference load.
    let design = rollover(vehicle, vehicle.reference_load())?;
    let [threshold_g] = thresholds_g(vehicle, load, 1.0, [load.cg_height_m])?;
    let line = ThresholdLine { threshold_g: [threshold_g; _] };
    let height = Measured::exact(load.cg_height_m);
    let span_m = [vehicle.height.least_m, vehicle.height.greatest_m];
    Ok(design.at(height, load.trailer_mass_kg, &line, span_m))
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
