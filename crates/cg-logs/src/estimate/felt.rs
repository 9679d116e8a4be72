//! The lateral acceleration that the truck feels.

use cg_core::{Channel, Design, Sample};

/// The lateral acceleration in the plane of the road: with the part of gravity that a bank adds, if an
/// accelerometer shows it (`f = a_e + g φ`, `φ = R a_e`), m/s². The load is its mass, kg, and its
/// height, m.
pub fn felt_mps2(
    design: &Design<f64>,
    sample: &Sample<f64>,
    speed_mps: f64,
    [mass_kg, height_m]: [f64; 2],
) -> f64 {
    let path_mps2 = if sample.lateral_acceleration_mps2.is_nan() {
        sample.yaw_rate_radps * sample.speed_mps
    } else {
        sample.lateral_acceleration_mps2
    };
    let line = design.line(Channel::LateralAcceleration, speed_mps, mass_kg);
    let roll = line.map_or(0.0, |line| {
        line.ratio_at(height_m) * design.compensation(Channel::LateralAcceleration)
    });
    let banked = |force_mps2: f64| force_mps2 / (1.0 + design.gravity_mps2 * roll);
    let trailer = banked(sample.lateral_specific_force_mps2);
    if trailer.is_finite() {
        return trailer;
    }
    // The tractor leads the trailer and rolls less, so the greater of both is taken.
    let tractor = banked(sample.tractor_lateral_specific_force_mps2);
    if path_mps2.is_finite() && !(tractor.abs() > path_mps2.abs()) { path_mps2 } else { tractor }
}
