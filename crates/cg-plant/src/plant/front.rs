//! The front half of a trailer whose frame twists.
//!
//! It has the fifth wheel, yaw and pitch in common with the rear half, which stands on the axles, and
//! rolls by an angle of its own about the same axis. A spring and a damper act between both roll angles.
//! With the rates `a` that it has in common and its own roll `r`, its equations are
//!
//! ```text
//!     ┌ A  c ┐ ┌ ȧ ┐   ┌ f ┐
//!     └ cᵀ m ┘ └ ṙ ┘ = └ g ┘        leaves (A − c cᵀ/m) ȧ = f − c g/m for the whole trailer
//! ```

use super::body::{Attitude, Equations, Motion, Sprung};
use super::state::{FRONT_ROLL, FRONT_ROLL_RATE, ROOM};

/// Index of the roll in the equations of a unit.
const ROLL: usize = 5;

/// Parameters of the front half.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub(super) half: Sprung,
    /// Share of its mass in the whole sprung mass.
    pub(super) mass_share: f64,
    /// Of the frame.
    pub(super) stiffness_nm_per_rad: f64,
    pub(super) damping_nms_per_rad: f64,
    /// Share of its roll in the roll angle that is measured, and in the specific force.
    pub(super) roll_share: f64,
    pub(super) accelerometer_share: f64,
}

impl Front {
    /// Its motion, from that of the rear half.
    #[inline]
    pub(super) fn motion(x: &[f64; ROOM], pitch_rad: f64, rear: &Motion) -> Motion {
        let [yaw, pitch, _] = rear.rates;
        Motion::new(
            Attitude::new(pitch_rad, x[FRONT_ROLL]),
            [yaw, pitch, x[FRONT_ROLL_RATE]],
            rear.velocity,
            rear.bias,
        )
    }

    /// Moment of the frame on the rear half.
    #[inline]
    pub(super) fn frame_nm(&self, twist_rad: f64, twist_rate: f64) -> f64 {
        self.stiffness_nm_per_rad * twist_rad + self.damping_nms_per_rad * twist_rate
    }

    /// Adds its equations to those of the rear half, without its own roll.
    #[inline]
    pub(super) fn eliminate(own: &Equations, trailer: &mut Equations) {
        let c = own.mass[ROLL];
        for i in 0..ROLL {
            let share = c[i] / c[ROLL];
            trailer.force[i] += own.force[i] - share * own.force[ROLL];
            for j in 0..=i {
                trailer.mass[i][j] += own.mass[i][j] - share * c[j];
            }
        }
    }

    /// What forces on it, its own roll moment among them, are for the whole trailer.
    #[inline]
    pub(super) fn pass_on(own: &Equations, force: &mut [f64; 6]) {
        let c = own.mass[ROLL];
        let moment_nm = std::mem::take(&mut force[ROLL]);
        for i in 0..ROLL {
            force[i] -= c[i] / c[ROLL] * moment_nm;
        }
    }

    /// Its accelerations, from its own roll moment and the accelerations of the rear half.
    #[inline]
    pub(super) fn accelerations(own: &Equations, roll_nm: f64, rear: &[f64; 6]) -> [f64; 6] {
        let c = own.mass[ROLL];
        let common: f64 = (0..ROLL).map(|i| c[i] * rear[i]).sum();
        let mut found = *rear;
        found[ROLL] = (roll_nm - common) / c[ROLL];
        found
    }
}
