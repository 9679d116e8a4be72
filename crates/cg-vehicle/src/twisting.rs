//! A semitrailer whose frame twists.
//!
//! Its sprung mass is two halves of the same mass, height and roll inertia, one on the fifth wheel and
//! one on the axles. They are joined by a torsion spring about the line at the height of the fifth
//! wheel, in the middle of the payload. Each half's c.g. is in the middle of its half of the bed.
//!
//! The height of the c.g. then stands in two rows of the steady-state equations, so the DC ratio is a
//! quotient of two parabolas. Over the possible heights it is very nearly a quotient of two lines (see
//! [`SteadyLines`](crate::linear::SteadyLines)).

use crate::load::SprungMass;
use crate::vehicle::{Trailer, Vehicle};

/// Damping of the frame divided by its stiffness: at the natural frequency of the frame (20 to 30
/// rad/s) about a tenth of the critical damping.
pub const DAMPING_S: f64 = 0.01;

/// The stiffness that a vehicle file gives for a rigid frame.
pub const RIGID_NM_PER_RAD: f64 = 1e10;
/// The stiffness from which on a frame is rigid. A usual one is so much softer that no calibration takes
/// it there.
const RIGID_FROM_NM_PER_RAD: f64 = 4e9;

/// Stiffness of a frame of which the vehicle file says nothing, and the standard deviation of its
/// logarithm. The effect on the roll angle is less than in proportion to the compliance, so the standard
/// deviation is so great that the effects of a rigid frame, of a box van (3e6 N m/rad), of a flatbed (6e5)
/// and of the softest usual frames (4e5) are all within 2.3 of it (test `twisting`).
const UNKNOWN_NM_PER_RAD: f64 = 2e6;
const UNKNOWN_SD: f64 = 1.2;

/// The frame of a trailer that twists.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Twisting {
    /// Moment of the frame per angle between its halves.
    pub stiffness_nm_per_rad: f64,
    /// Share of the front half's roll in the roll angle that is measured.
    pub roll_share: f64,
    /// The same for the specific force.
    pub accelerometer_share: f64,
}

/// A part of the trailer's sprung mass that rolls as one body.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Part {
    /// Mass.
    pub mass_kg: f64,
    /// Distance of the c.g. behind the fifth wheel.
    pub cg_behind_hitch_m: f64,
    /// Roll inertia about the c.g.
    pub roll_inertia_kgm2: f64,
    /// Yaw inertia about the c.g.
    pub yaw_inertia_kgm2: f64,
    /// Pitch inertia about the c.g.
    pub pitch_inertia_kgm2: f64,
}

impl Part {
    /// The whole sprung mass.
    pub fn whole(sprung: &SprungMass) -> Self {
        Self {
            mass_kg: sprung.mass_kg,
            cg_behind_hitch_m: sprung.cg_behind_hitch_m,
            roll_inertia_kgm2: sprung.roll_inertia_kgm2,
            yaw_inertia_kgm2: sprung.yaw_inertia_kgm2,
            pitch_inertia_kgm2: sprung.pitch_inertia_kgm2,
        }
    }

    /// The halves on a bed of this length, the front one first. Together they have the mass, c.g. and
    /// inertias of the whole.
    pub fn halves(sprung: &SprungMass, bed_m: f64) -> [Self; 2] {
        let whole = Self::whole(sprung);
        let apart_m = 0.25 * bed_m;
        let of_places = sprung.mass_kg * apart_m * apart_m;
        // A short load on a long bed is not spread over it.
        let own = |inertia_kgm2: f64| 0.5 * (inertia_kgm2 - of_places).max(0.0);
        let half = |along_m: f64| Self {
            mass_kg: 0.5 * whole.mass_kg,
            cg_behind_hitch_m: whole.cg_behind_hitch_m + along_m,
            roll_inertia_kgm2: 0.5 * whole.roll_inertia_kgm2,
            yaw_inertia_kgm2: own(whole.yaw_inertia_kgm2),
            pitch_inertia_kgm2: own(whole.pitch_inertia_kgm2),
        };
        [half(-apart_m), half(apart_m)]
    }
}

impl Trailer {
    /// Torsional stiffness of the frame: that of the file, or a usual one if it is not known; `None` if the
    /// frame is rigid.
    pub fn frame_nm_per_rad(&self) -> Option<f64> {
        let stiffness = self.frame_torsional_stiffness_nm_per_rad.unwrap_or(UNKNOWN_NM_PER_RAD);
        (stiffness < RIGID_FROM_NM_PER_RAD).then_some(stiffness)
    }

    /// Standard deviation of the logarithm of that stiffness, if `given` is that of one in the file.
    pub(crate) fn frame_sd(&self, given: f64) -> f64 {
        match (self.frame_torsional_stiffness_nm_per_rad, self.frame_nm_per_rad()) {
            (_, None) => 0.0, // a rigid frame stays rigid
            (None, _) => UNKNOWN_SD,
            _ => given,
        }
    }
}

impl Vehicle {
    /// The half of the trailer, 0 the front one and 1 the rear one, at a distance behind the fifth wheel: they meet in the
    /// middle of the payload.
    fn half_at(&self, behind_hitch_m: f64) -> usize {
        usize::from(behind_hitch_m >= self.trailer.payload.behind_hitch_m)
    }

    /// The halves of the first and the second roll sensor; `None` if the log does not have both separately.
    pub fn roll_halves(&self) -> Option<[usize; 2]> {
        let roll = &self.sensors.roll;
        let second_m = roll.second_share.and(roll.second_behind_hitch_m)?;
        Some([roll.behind_hitch_m.unwrap_or(f64::INFINITY), second_m].map(|m| self.half_at(m)))
    }
}

impl Twisting {
    /// The frame of a vehicle; `None` if it is rigid.
    pub fn of(vehicle: &Vehicle) -> Option<Self> {
        let stiffness_nm_per_rad = vehicle.trailer.frame_nm_per_rad()?;
        let share = |behind_hitch_m: f64| {
            let is_front = vehicle.half_at(behind_hitch_m) == 0;
            f64::from(u8::from(is_front))
        };
        let (_, accelerometer_m) = vehicle.accelerometer_positions_m();
        let places = vehicle.sensors.roll.places_m();
        let roll_share = places.map(|(place_m, weight)| weight * share(place_m)).sum();
        Some(Self { stiffness_nm_per_rad, roll_share, accelerometer_share: share(accelerometer_m) })
    }
}
