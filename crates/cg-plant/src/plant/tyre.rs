//! Tires: radial spring in the wheel's plane, lateral force and aligning moment over slip and load.
//!
//! ```text
//!     F_z = max(0, K (R0 − l))/cos φu        l = height of the tire's center over cos φu
//!     α   = atan(v_y / v_x) − steer          at the point of contact
//!     F_y = −F(α, F_z),  M_z = +M(α, F_z)
//! ```
//!
//! The cosine makes the vertical force exactly conservative. All tires of an axle have the same
//! lateral velocity on the road. Their slip angles differ only because of the yaw rate, so only that
//! difference is computed for each tire.

use super::vector::{sin_cos, small_atan};
use cg_vehicle::characteristics::Grip;

/// The slip is computed with at least this speed.
pub(super) const LEAST_SPEED_MPS: f64 = 0.3;
/// Tires of one side.
pub(super) const PER_SIDE: usize = 2;

/// The tires of one axle.
#[derive(Clone, Debug)]
pub(super) struct Tyres {
    /// Index of the [`Grip`].
    pub(super) kind: usize,
    /// Distances from the middle, one side.
    pub(super) positions_m: [f64; PER_SIDE],
    pub(super) per_side: usize,
    pub(super) stiffness_n_per_m: f64,
    pub(super) damping_ns_per_m: f64,
    /// Sum over all tires of the axle.
    pub(super) overturning_nm_per_rad: f64,
    pub(super) unloaded_radius_m: f64,
    pub(super) relaxation_length_m: f64,
}

/// Motion of an axle's center over the road.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hub {
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) roll_rad: f64,
    pub(super) roll_rate: f64,
    pub(super) yaw_rate: f64,
    pub(super) height_m: f64,
    pub(super) velocity: [f64; 3],
    pub(super) steer_rad: f64,
    /// State of the lagged slip angle.
    pub(super) lagged_slip_rad: f64,
}

/// Action of the road on an axle: force at its center, roll and yaw moment about it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    pub(super) force: [f64; 3],
    pub(super) roll_nm: f64,
    pub(super) yaw_nm: f64,
    /// Vertical load of each side.
    pub(super) left_n: f64,
    pub(super) right_n: f64,
    /// Slip angle at the middle of the axle, without lag, and its relaxation.
    pub(super) slip_rad: f64,
    pub(super) slip_rate: f64,
    pub(super) lateral_n: f64,
}

/// Sums over the tires of one side: load, lateral force, roll and yaw moment.
type Side = [f64; 4];

/// What all tires of an axle have in common.
struct Rolling {
    tan: f64,
    inverse_cos: f64,
    /// Velocities over the road at the middle of the axle.
    forward: f64,
    lateral: f64,
    acting_rad: f64,
    sin_steer: f64,
    row: usize,
}

impl Tyres {
    #[inline]
    pub(super) fn contact(&self, kinds: &[Grip], hub: &Hub) -> Contact {
        let kind = &kinds[self.kind];
        let inverse_cos = 1.0 / hub.cos;
        let tan = hub.sin * inverse_cos;
        let forward = (hub.velocity[0] - hub.yaw_rate * hub.height_m * tan).max(LEAST_SPEED_MPS);
        let lateral = hub.velocity[1] + hub.roll_rate * hub.height_m;
        let slip_rad = libm::atan(lateral / forward) - hub.steer_rad;
        let lags = self.relaxation_length_m > 0.0;
        let acting_rad = if lags { hub.lagged_slip_rad } else { slip_rad };
        let (sin_steer, cos_steer) = sin_cos(hub.steer_rad);
        let row = kind.row(acting_rad);
        let rolling = Rolling { tan, inverse_cos, forward, lateral, acting_rad, sin_steer, row };
        let [first, second] = self.positions_m;
        let [left, right] = if self.per_side == PER_SIDE {
            let [a, b, c, d] = self.tyres(kind, hub, &rolling, [first, second, -first, -second]);
            [sum(a, b), sum(c, d)]
        } else {
            self.tyres(kind, hub, &rolling, [first, -first])
        };
        let lateral_n = left[1] + right[1];
        let side_n = cos_steer * lateral_n;
        let slip_rate = if lags {
            forward / self.relaxation_length_m * (slip_rad - hub.lagged_slip_rad)
        } else {
            0.0
        };
        Contact {
            force: [-sin_steer * lateral_n, side_n, left[0] + right[0]],
            // The point of contact is straight below the center by its height.
            roll_nm: left[2] + right[2] + hub.height_m * side_n
                - self.overturning_nm_per_rad * hub.roll_rad,
            yaw_nm: left[3] + right[3],
            left_n: left[0],
            right_n: right[0],
            slip_rad,
            slip_rate,
            lateral_n,
        }
    }

    /// Load, lateral force, roll and yaw moment of the tires at these positions.
    #[inline]
    fn tyres<const N: usize>(
        &self,
        kind: &Grip,
        hub: &Hub,
        rolling: &Rolling,
        position_m: [f64; N],
    ) -> [Side; N] {
        let Rolling { tan, inverse_cos, forward, lateral, .. } = *rolling;
        let middle = hub.height_m * tan;
        // Deflection and lever arm are linear in the position, and so is the speed that the yaw rate
        // adds to each tire.
        let (squeezed, tilt) =
            (self.unloaded_radius_m - hub.height_m * inverse_cos, hub.sin * inverse_cos);
        let (drift, turning) = (hub.yaw_rate * inverse_cos, lateral * hub.yaw_rate * inverse_cos);
        let square = forward * forward + lateral * lateral;
        let (mut pushes, mut arms, mut slips) = ([0.0; N], [0.0; N], [0.0; N]);
        for k in 0..N {
            let y = position_m[k];
            pushes[k] = self.stiffness_n_per_m * (squeezed - y * tilt);
            arms[k] = y * inverse_cos + middle;
            let over = (square - forward * drift * y).max(LEAST_SPEED_MPS * LEAST_SPEED_MPS);
            slips[k] = turning * y / over;
        }
        if self.damping_ns_per_m > 0.0 {
            for k in 0..N {
                let rate = hub.velocity[2] + hub.roll_rate * hub.cos * position_m[k];
                let center = hub.height_m + position_m[k] * hub.sin;
                let shortening = (rate + center * tan * hub.roll_rate) * inverse_cos;
                // A damper cannot hold a wheel that has left the road.
                if pushes[k] > 0.0 {
                    pushes[k] -= self.damping_ns_per_m * shortening;
                }
            }
        }
        let mut found = [[0.0; 4]; N];
        for k in 0..N {
            let (load_n, arm) = (pushes[k] * inverse_cos, arms[k]);
            if load_n > 0.0 {
                let slip_rad = rolling.acting_rad + small_atan(slips[k]);
                let (side_n, moment_nm) = kind.near(slip_rad, load_n, rolling.row);
                let turning = moment_nm + arm * rolling.sin_steer * side_n;
                found[k] = [load_n, side_n, load_n * arm, turning];
            }
        }
        found
    }
}

#[inline]
fn sum(a: Side, b: Side) -> Side {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}
