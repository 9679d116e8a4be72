//! Off-tracking: the distance of the trailer's last axle from the path of the steered axle.
//!
//! **Reference.** El-Gindy, Int. J. of Vehicle Design 1995: high speed, steady turn of 393 m at
//! 100 km/h, outward; low speed, turn of 90 degrees, inward.

use std::f64::consts::FRAC_PI_2;

use crate::plant::{Coordinate, YawRollPlant};
use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

/// Radius of the high-speed turn.
pub const HIGH_SPEED_RADIUS_M: f64 = 393.0;
/// Its speed: 100 km/h.
pub const HIGH_SPEED_MPS: f64 = 100.0 / 3.6;
/// Radius of the steered axle's path in the low-speed turn of 90 degrees.
pub const LOW_SPEED_RADIUS_M: f64 = 11.0;

/// Radius of the last axle's path minus that of the first axle in a steady turn of the nonlinear
/// plant: positive outward.
///
/// # Errors
/// If the vehicle cannot drive this turn.
pub fn high_speed_m(
    plant: &YawRollPlant,
    speed_mps: f64,
    radius_m: f64,
    yaw_rate_gain_per_s: f64,
) -> Result<f64, VehicleError> {
    let mut run = plant.start(speed_mps)?;
    let wanted_radps = speed_mps / radius_m;
    let mut steer_rad = wanted_radps / yaw_rate_gain_per_s;
    // The vehicle enters the turn in 4 s. Then the steer angle is corrected in proportion five times,
    // 4 s each. Yaw decays faster than 1/s, so the remaining error is e^-4 of the last correction.
    let mut from_rad = 0.0;
    for _ in 0..6 {
        for k in 1..=400 {
            let share = (f64::from(k) / 200.0).min(1.0);
            run.push(from_rad + share * (steer_rad - from_rad), speed_mps, 0.01);
        }
        run.upright()?;
        from_rad = steer_rad;
        steer_rad *= wanted_radps / run.state.get(Coordinate::TractorYawRate);
    }
    let value = |c| run.state.get(c);
    // The center of the turn, from the velocity (U, v) of the tractor's c.g.
    let yaw_radps = value(Coordinate::TractorYawRate);
    let (sin, cos) = libm::sincos(value(Coordinate::TractorYaw));
    let (along_m, left_m) =
        (-value(Coordinate::LateralVelocity) / yaw_radps, speed_mps / yaw_radps);
    let center = [
        value(Coordinate::PositionX) + cos * along_m - sin * left_m,
        value(Coordinate::PositionY) + sin * along_m + cos * left_m,
    ];
    let last = run.sample().axles().len().saturating_sub(1);
    let radius = |axle: usize| {
        let [x, y] = plant.axle_position_m(&run.state, axle);
        libm::hypot(x - center[0], y - center[1])
    };
    Ok(radius(last) - radius(0))
}

/// Greatest distance inward of the trailer's axles (their middle) from the path of the steered
/// axle in a turn of 90 degrees without slip. The axles of a unit that are not steered are replaced
/// by one in their middle.
///
/// ```text
///     every towed point follows its tractrix: it moves along the line to the point that pulls it
/// ```
///
/// # Errors
/// If the tractor has no steered or no other axle.
pub fn low_speed_m(vehicle: &Vehicle, radius_m: f64) -> Result<f64, VehicleError> {
    let mean = |places: Vec<f64>| {
        #[allow(clippy::cast_precision_loss)] // a few axles
        let n = places.len() as f64;
        (n > 0.0).then(|| places.iter().sum::<f64>() / n)
    };
    let tractor = &vehicle.tractor;
    let of = |steered: bool| {
        let axles = tractor.axle.iter().filter(|axle| axle.steered == steered);
        mean(axles.map(|axle| axle.ahead_of_cg_m).collect())
    };
    let trailer_m = mean(vehicle.trailer.axle.iter().map(|axle| axle.behind_hitch_m).collect());
    let (Some(front_m), Some(rear_m), Some(trailer_m)) = (of(true), of(false), trailer_m) else {
        return Err(VehicleError::Model(
            "low-speed off-tracking: the tractor needs a steered axle and one that is not".into(),
        ));
    };
    let (wheelbase_m, hitch_m) = (front_m - rear_m, -tractor.hitch_behind_cg_m - rear_m);
    let step_m = 0.01;
    let arc_m = radius_m * FRAC_PI_2;
    let mut rear = [-wheelbase_m, 0.0];
    let mut tail = [rear[0] + hitch_m - trailer_m, 0.0];
    let (mut traveled_m, mut inwards_m) = (0.0, 0.0_f64);
    while traveled_m < arc_m + trailer_m {
        traveled_m += step_m;
        let (sin, cos) = libm::sincos(traveled_m.min(arc_m) / radius_m);
        let beyond_m = (traveled_m - arc_m).max(0.0);
        let front = [radius_m * sin, radius_m * (1.0 - cos) + beyond_m];
        let ahead = pull(&mut rear, front, wheelbase_m);
        let hitch = [rear[0] + hitch_m * ahead[0], rear[1] + hitch_m * ahead[1]];
        pull(&mut tail, hitch, trailer_m);
        let off_m = match tail {
            [x, y] if x < 0.0 => y,
            [x, y] if y > radius_m => radius_m - x,
            [x, y] => radius_m - libm::hypot(x, y - radius_m),
        };
        inwards_m = inwards_m.max(off_m);
    }
    Ok(inwards_m)
}

/// Pulls a point to `length_m` behind another; returns the direction between them.
fn pull(point: &mut [f64; 2], by: [f64; 2], length_m: f64) -> [f64; 2] {
    let (dx, dy) = (by[0] - point[0], by[1] - point[1]);
    let distance_m = libm::hypot(dx, dy).max(f64::MIN_POSITIVE);
    let ahead = [dx / distance_m, dy / distance_m];
    *point = [by[0] - length_m * ahead[0], by[1] - length_m * ahead[1]];
    ahead
}
