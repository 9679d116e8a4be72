//! The fifth wheel's roll moment.
//!
//! Beyond the separation moment one side lifts. The moment is then constant until the lash is used
//! up and the kingpin locks.

use crate::vehicle::Hitch;

/// The fifth wheel in roll: a spring with separation and lash.
#[derive(Clone, Debug)]
pub struct FifthWheel {
    /// Roll stiffness, about the longitudinal axis.
    pub stiffness_nm_per_rad: f64,
    /// Roll damping, about the same axis.
    pub damping_nms_per_rad: f64,
    /// Moment at which the plates separate; infinite if they never do.
    pub separation_nm: f64,
    /// Free angle after the separation, until the kingpin locks.
    pub lash_rad: f64,
    /// Whether it tilts about an axis of the tractor, or of the trailer.
    pub tilts_on_tractor: bool,
}

impl FifthWheel {
    /// The fifth wheel of a vehicle file.
    pub fn of(hitch: &Hitch) -> Self {
        Self {
            stiffness_nm_per_rad: hitch.roll_stiffness_nm_per_rad,
            damping_nms_per_rad: hitch.roll_damping_nms_per_rad,
            separation_nm: hitch.separation_moment_nm.unwrap_or(f64::INFINITY),
            lash_rad: hitch.lash_rad,
            tilts_on_tractor: hitch.tilts_on_tractor.unwrap_or(true),
        }
    }

    /// Moment at a relative roll angle between the units.
    #[inline]
    pub fn moment_nm(&self, angle_rad: f64) -> f64 {
        let linear = self.stiffness_nm_per_rad * angle_rad;
        if linear.abs() <= self.separation_nm {
            return linear;
        }
        let beyond =
            (linear.abs() - self.separation_nm) / self.stiffness_nm_per_rad - self.lash_rad;
        (self.separation_nm + self.stiffness_nm_per_rad * beyond.max(0.0)).copysign(angle_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parted_plates_move_freely_until_the_kingpin_locks() {
        let hitch = FifthWheel {
            stiffness_nm_per_rad: 1e6,
            damping_nms_per_rad: 0.0,
            separation_nm: 5e4,
            lash_rad: 0.02,
            tilts_on_tractor: true,
        };
        for (angle, moment) in
            [(0.05, 5e4), (0.04, 4e4), (0.06, 5e4), (0.07, 5e4), (0.08, 6e4), (-0.08, -6e4)]
        {
            assert!((hitch.moment_nm(angle) - moment).abs() < 1e-6, "{angle}");
        }
    }
}
