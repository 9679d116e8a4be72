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
use crate::vehicle::Vehicle;

/// Damping of the frame divided by its stiffness: at the natural frequency of the frame (20 to 30
/// rad/s) about a tenth of the critical damping.
pub(crate) const DAMPING_S: f64 = 0.01;

/// The frame of a trailer that twists.
#[derive(Clone, Debug)]
pub(crate) struct Twisting {
    pub(crate) stiffness_nm_per_rad: f64,
    /// Share of the front half's roll in the roll angle that is measured.
    pub(crate) roll_share: f64,
    /// The same for the specific force.
    pub(crate) accelerometer_share: f64,
}

/// A part of the trailer's sprung mass that rolls as one body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) mass_kg: f64,
    pub(crate) cg_behind_hitch_m: f64,
    pub(crate) roll_inertia_kgm2: f64,
    pub(crate) yaw_inertia_kgm2: f64,
}

impl Part {
    /// The whole sprung mass or, on a bed of this length that twists, its halves, the front one first.
    /// Together they have its mass, c.g. and inertias.
    pub(crate) fn of(sprung: &SprungMass, twisting_bed_m: Option<f64>) -> Vec<Self> {
        let whole = Self {
            mass_kg: sprung.mass_kg,
            cg_behind_hitch_m: sprung.cg_behind_hitch_m,
            roll_inertia_kgm2: sprung.roll_inertia_kgm2,
            yaw_inertia_kgm2: sprung.yaw_inertia_kgm2,
        };
        let Some(bed_m) = twisting_bed_m else { return vec![whole] };
        let apart_m = 0.25 * bed_m;
        let of_places = sprung.mass_kg * apart_m * apart_m;
        let half = |along_m: f64| Self {
            mass_kg: 0.5 * whole.mass_kg,
            cg_behind_hitch_m: whole.cg_behind_hitch_m + along_m,
            roll_inertia_kgm2: 0.5 * whole.roll_inertia_kgm2,
            // A short load on a long bed is not spread over it.
            yaw_inertia_kgm2: 0.5 * (whole.yaw_inertia_kgm2 - of_places).max(0.0),
        };
        vec![half(-apart_m), half(apart_m)]
    }
}

impl Twisting {
    /// The frame of a vehicle; `None` if it is rigid.
    pub(crate) fn of(vehicle: &Vehicle) -> Option<Self> {
        let stiffness_nm_per_rad = vehicle.trailer.frame_torsional_stiffness_nm_per_rad?;
        let joint_m = vehicle.trailer.payload.behind_hitch_m;
        let share = |behind_hitch_m: f64| f64::from(u8::from(behind_hitch_m < joint_m));
        let (_, accelerometer_m) = vehicle.accelerometer_positions_m();
        let places = vehicle.sensors.roll.places_m();
        #[allow(clippy::cast_precision_loss)] // one or two places
        let roll_share =
            places.iter().map(|place| share(*place)).sum::<f64>() / places.len().max(1) as f64;
        Some(Self { stiffness_nm_per_rad, roll_share, accelerometer_share: share(accelerometer_m) })
    }
}
