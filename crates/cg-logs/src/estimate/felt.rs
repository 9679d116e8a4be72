//! The lateral acceleration that the truck feels, and the specific force that follows from other sensors.

use cg_core::{Channel, Design, Input, Sample, Signals};

/// The lateral acceleration in the plane of the road: with the part of gravity that a bank adds, if a
/// sensor of the trailer shows it (`f = a_y + g φ_g = a_e + g φ`, `φ = R a_e`), m/s². An accelerometer or an
/// inclinometer shows `f`; a roll angle relative to gravity gives it with the lateral acceleration of the
/// path. The load is its mass, kg, and its height, m.
pub fn felt_mps2(
    design: &Design<f64>,
    sample: &Sample<f64>,
    speed_mps: f64,
    load: [f64; 2],
) -> f64 {
    let gravity_mps2 = design.gravity_mps2;
    let signals = Signals::of(sample, sample.speed_mps, gravity_mps2);
    let path_mps2 = signals.input(Input::LateralAcceleration);
    let by_roll = 1.0 + force_by_roll(design, speed_mps, load);
    let banked = |force_mps2: f64| force_mps2 / by_roll;
    let by_roll_mps2 = path_mps2 + gravity_mps2 * sample.roll_to_gravity_rad;
    let forces_mps2 = [signals.input(Input::SpecificForce), by_roll_mps2];
    if let Some(force_mps2) = forces_mps2.into_iter().find(|force| force.is_finite()) {
        return banked(force_mps2);
    }
    // The tractor leads the trailer and rolls less, so the greater of both is taken.
    let tractor = banked(signals.input(Input::TractorSpecificForce));
    if path_mps2.is_finite() && !(tractor.abs() > path_mps2.abs()) { path_mps2 } else { tractor }
}

/// The part of gravity in a specific force over the lateral acceleration that the truck feels, `g R`. The load is its mass,
/// kg, and its height, m.
pub(super) fn force_by_roll(
    design: &Design<f64>,
    speed_mps: f64,
    [mass_kg, height_m]: [f64; 2],
) -> f64 {
    let line = design.line(Channel::LateralAcceleration, speed_mps, mass_kg);
    line.map_or(0.0, |line| {
        design.gravity_mps2
            * line.ratio_at(height_m)
            * design.compensation(Channel::LateralAcceleration)
    })
}

/// The lateral acceleration of the path, m/s², that follows from the steer angle at the speed of a sample, by the ratios of a usual
/// load; NaN if either is absent. Tires that are not linear make it too great in strong turns.
pub(super) fn path_by_steer_mps2(sample: &Sample<f64>, design: &Design<f64>) -> f64 {
    if !(sample.steer_rad.is_finite() && sample.speed_mps.is_finite()) {
        return f64::NAN;
    }
    let mass_kg = design.nominal_trailer_mass_kg;
    let [steer, lateral] = [Channel::Steer, Channel::LateralAcceleration].map(|channel| {
        let line = design.line(channel, sample.speed_mps, mass_kg);
        line.map_or(f64::NAN, |line| line.ratio_at(design.reference_height_m))
    });
    sample.steer_rad * steer / lateral
}

/// Adds an absent specific force of the trailer that a suspension roll needs, `f = a_y + g φ_g`, if the sample
/// has a roll angle relative to gravity and the acceleration of the path. (The core has no room for this on a
/// chip.)
#[inline]
pub fn add_force(sample: &mut Sample<f64>, gravity_mps2: f64) {
    let is_needed = sample.suspension_roll_rad.is_finite()
        && sample.lateral_specific_force_mps2.is_nan()
        && sample.tilt_rad.is_nan();
    if is_needed {
        let measured_mps2 = sample.lateral_acceleration_mps2;
        let turn_mps2 = sample.yaw_rate_radps * sample.speed_mps;
        let path_mps2 = if measured_mps2.is_nan() { turn_mps2 } else { measured_mps2 };
        sample.lateral_specific_force_mps2 = path_mps2 + gravity_mps2 * sample.roll_to_gravity_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, SPEED_MPS, design};

    const GRAVITY_MPS2: f64 = 9.81;
    /// Roll angle at 2 m by [`design`], rad per m/s².
    const ROLL: f64 = 0.04;

    fn felt(change: impl Fn(&mut Sample<f64>)) -> f64 {
        let mut sample = Sample::absent(0);
        sample.speed_mps = SPEED_MPS;
        change(&mut sample);
        felt_mps2(&design(), &sample, SPEED_MPS, [MASS_KG, 2.0])
    }

    /// A curve of 2 m/s² on a bank: every sensor of the trailer gives `a_y + g β`, also with others beside.
    #[test]
    fn a_bank_counts_with_every_sensor_that_feels_it() {
        let path_mps2 = 2.0;
        for bank_rad in [0.0, 0.06, -0.06] {
            let expected_mps2 = path_mps2 + GRAVITY_MPS2 * bank_rad;
            let to_gravity_rad = ROLL * expected_mps2 + bank_rad;
            let force_mps2 = path_mps2 + GRAVITY_MPS2 * to_gravity_rad;
            let path = |sample: &mut Sample<f64>| sample.yaw_rate_radps = path_mps2 / SPEED_MPS;
            for found in [
                felt(|sample| sample.lateral_specific_force_mps2 = force_mps2),
                felt(|sample| sample.tilt_rad = force_mps2 / GRAVITY_MPS2),
                felt(|sample| {
                    path(sample);
                    sample.tilt_rad = force_mps2 / GRAVITY_MPS2;
                }),
                felt(|sample| {
                    path(sample);
                    sample.roll_to_gravity_rad = to_gravity_rad;
                }),
                felt(|sample| sample.tractor_tilt_rad = force_mps2 / GRAVITY_MPS2),
            ] {
                assert!((found - expected_mps2).abs() < 1e-12, "{bank_rad}: {found}");
            }
        }
        assert!(felt(|_| ()).is_nan());
    }

    /// Beside the path, a sensor of the tractor can only add to what is felt.
    #[test]
    fn the_tractor_never_makes_a_curve_weaker() {
        let found = |force_mps2: f64| {
            felt(|sample| {
                sample.lateral_acceleration_mps2 = 2.0;
                sample.tractor_lateral_specific_force_mps2 = force_mps2;
            })
        };
        let both = 1.0 + GRAVITY_MPS2 * ROLL;
        assert!((found(1.5 * both) - 2.0).abs() < 1e-12);
        assert!((found(2.5 * both) - 2.5).abs() < 1e-12);
    }
}
