//! The road under the vehicle.

use super::state::MAX_AXLES;
use super::vector::{Vector, sin_cos};
use serde::{Deserialize, Serialize};

/// Bank and grade of the road under the vehicle. The plane of the road carries the coordinates, so
/// gravity is tilted in them; an axle may stand on a bank of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// Bank, left side higher positive.
    pub bank_rad: f64,
    /// Grade, uphill positive.
    pub grade_rad: f64,
    /// Bank under each axle minus `bank_rad` (road twist), tractor first.
    pub twist_rad: [f64; MAX_AXLES],
}

impl Ground {
    /// The road at a share of the way to another one.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let line = |a: f64, b: f64| a + share * (b - a);
        let mut twist_rad = self.twist_rad;
        for (twist, other) in twist_rad.iter_mut().zip(other.twist_rad) {
            *twist = line(*twist, other);
        }
        Self {
            bank_rad: line(self.bank_rad, other.bank_rad),
            grade_rad: line(self.grade_rad, other.grade_rad),
            twist_rad,
        }
    }

    /// Gravity in the yaw frames of tractor and trailer. The bank tilts it about their mean heading. The
    /// grade is that of the way: each unit climbs along its own heading. `turn_rad` is the trailer's yaw
    /// minus the tractor's.
    #[inline]
    pub(super) fn gravity(&self, gravity_mps2: f64, turn_rad: f64) -> [Vector; 2] {
        if self.bank_rad == 0.0 && self.grade_rad == 0.0 {
            return [[0.0, 0.0, -gravity_mps2]; 2];
        }
        let (uphill, level) = sin_cos(self.grade_rad);
        let (side, down) = sin_cos(self.bank_rad);
        let (sin, cos) = sin_cos(0.5 * turn_rad);
        let back = gravity_mps2 * uphill;
        let (side, down) = (gravity_mps2 * level * side, -gravity_mps2 * level * down);
        [[side * sin - back, -side * cos, down], [-side * sin - back, -side * cos, down]]
    }
}
