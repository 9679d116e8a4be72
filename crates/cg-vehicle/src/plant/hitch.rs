//! The fifth wheel: carries every force, free in yaw and pitch, a spring in roll.
//!
//! The angle of the plates is that of the trailer's vertical seen along the tractor,
//! `φ5 = atan2(−e_y1·k_2, e_z·k_2)` (eq. 3.22), less the tractor's roll. Beyond the separation
//! moment one side lifts: the moment stays until the lash is used up and the kingpin locks.

use super::body::Attitude;
use super::vector::Vector;

/// Parameters of the fifth wheel.
#[derive(Clone, Debug)]
pub(crate) struct Hitch {
    pub(super) stiffness_nm_per_rad: f64,
    pub(super) damping_nms_per_rad: f64,
    /// Infinite where the plates never part.
    pub(super) separation_nm: f64,
    pub(super) lash_rad: f64,
}

/// What the fifth wheel's roll moment does to the rates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coupling {
    /// On the trailer, restoring.
    pub(super) moment_nm: f64,
    /// Generalised moments on the tractor's yaw, pitch, roll.
    pub(super) tractor: [f64; 3],
    /// The same of the trailer.
    pub(super) trailer: [f64; 3],
}

impl Hitch {
    /// That of a vehicle file.
    pub(crate) fn of(hitch: &crate::vehicle::Hitch) -> Self {
        Self {
            stiffness_nm_per_rad: hitch.roll_stiffness_nm_per_rad,
            damping_nms_per_rad: hitch.roll_damping_nms_per_rad,
            separation_nm: hitch.separation_moment_nm.unwrap_or(f64::INFINITY),
            lash_rad: hitch.lash_rad,
        }
    }

    /// Moment at a relative roll angle.
    #[inline]
    pub(crate) fn moment_nm(&self, angle_rad: f64) -> f64 {
        let linear = self.stiffness_nm_per_rad * angle_rad;
        if linear.abs() <= self.separation_nm {
            return linear;
        }
        let beyond =
            (linear.abs() - self.separation_nm) / self.stiffness_nm_per_rad - self.lash_rad;
        (self.separation_nm + self.stiffness_nm_per_rad * beyond.max(0.0)).copysign(angle_rad)
    }

    /// `turn` is sine and cosine of the trailer's yaw less the tractor's.
    #[inline]
    pub(super) fn couple(
        &self,
        tractor_roll_rad: f64,
        tractor_rates: [f64; 3],
        trailer: &Attitude,
        trailer_rates: [f64; 3],
        (sin, cos): (f64, f64),
    ) -> Coupling {
        let k = vertical(trailer);
        // The tractor's axes in the trailer's yaw frame: e_x1 = (cos, −sin, 0), e_y1 = (sin, cos, 0).
        let across = |v: Vector| sin * v[0] + cos * v[1];
        let (n, c) = (-across(k), k[2]);
        let scale = 1.0 / (n * n + c * c);
        let angle_rad = (n / c).atan() - tractor_roll_rad;
        // Derivatives of the angle by each rate: of k by turning about e_z, e_y, b.
        let turned = [
            [-k[1], k[0], 0.0],
            [k[2], 0.0, -k[0]],
            [
                -trailer.sin_pitch * trailer.sin_roll,
                -trailer.cos_roll,
                -trailer.cos_pitch * trailer.sin_roll,
            ],
        ];
        let by_trailer = turned.map(|dk| (c * -across(dk) - n * dk[2]) * scale);
        let by_tractor = [c * (cos * k[0] - sin * k[1]) * scale, 0.0, -1.0];
        let mut moment_nm = self.moment_nm(angle_rad);
        if self.damping_nms_per_rad > 0.0 {
            let rate: f64 = (0..3)
                .map(|j| by_tractor[j] * tractor_rates[j] + by_trailer[j] * trailer_rates[j])
                .sum();
            moment_nm += self.damping_nms_per_rad * rate;
        }
        Coupling {
            moment_nm,
            tractor: by_tractor.map(|by| -moment_nm * by),
            trailer: by_trailer.map(|by| -moment_nm * by),
        }
    }
}

/// The trailer's own vertical in its yaw frame.
#[inline]
fn vertical(a: &Attitude) -> Vector {
    [a.sin_pitch * a.cos_roll, -a.sin_roll, a.cos_pitch * a.cos_roll]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parted_plates_move_freely_until_the_kingpin_locks() {
        let hitch = Hitch {
            stiffness_nm_per_rad: 1e6,
            damping_nms_per_rad: 0.0,
            separation_nm: 5e4,
            lash_rad: 0.02,
        };
        for (angle, moment) in
            [(0.05, 5e4), (0.04, 4e4), (0.06, 5e4), (0.07, 5e4), (0.08, 6e4), (-0.08, -6e4)]
        {
            assert!((hitch.moment_nm(angle) - moment).abs() < 1e-6, "{angle}");
        }
    }
}
