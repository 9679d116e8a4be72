//! The front half of a trailer whose frame twists, eliminated from the equations of the roll plane.

use super::support::Held;
use crate::error::VehicleError;
use crate::load::Load;
use crate::twisting::{Part, Twisting};
use crate::vehicle::Vehicle;

/// A frame that twists, and the weight of the front half, which stands on the fifth wheel.
pub(super) struct Frame {
    stiffness_nm_per_rad: f64,
    front_n: f64,
}

/// Where the front half stands.
pub(super) struct Front {
    pub(super) alpha: f64,
    pub(super) roll_rad: f64,
    /// Roll angle of the rear half.
    pub(super) rear_rad: f64,
    /// Cosine of the articulation.
    pub(super) cos: f64,
    /// Moment of the fifth wheel, and its slope.
    pub(super) fifth_wheel: (f64, f64),
    /// Height of the c.g. above the fifth wheel.
    pub(super) above_m: f64,
    pub(super) compliance: f64,
}

impl Frame {
    /// The frame of a vehicle under a load; `None` if it is rigid.
    pub(super) fn of(vehicle: &Vehicle, load: Load) -> Result<Option<Self>, VehicleError> {
        let Some(twisting) = Twisting::of(vehicle) else { return Ok(None) };
        let sprung = vehicle.trailer_sprung_mass(load)?;
        let [front, _] = Part::halves(&sprung, vehicle.trailer.payload.length_m);
        let front_n = front.mass_kg * vehicle.gravity_mps2;
        Ok(Some(Self { stiffness_nm_per_rad: twisting.stiffness_nm_per_rad, front_n }))
    }

    /// Takes the front half out of the linearized equations of trailer and tractor (the derivatives with
    /// respect to `α` and `φ1`, and the residual). What is left for the trailer is the rear half, with
    /// the moment of the frame. Returns the Newton step of the front half's roll angle: per step of
    /// `α`, per step of `φ1`, and a constant part.
    pub(super) fn split(
        &self,
        at: &Front,
        trailer: &mut [f64; 3],
        tractor: &mut [f64; 3],
    ) -> [f64; 3] {
        let (fifth, fifth_slope) = at.fifth_wheel;
        let frame = self.stiffness_nm_per_rad / at.compliance;
        let frame_nm = frame * (at.roll_rad - at.rear_rad);
        let lifted_nm = self.front_n * at.above_m;
        let held_nm = at.cos * fifth + frame_nm;
        let lifted = Held { side_nm: lifted_nm, weight_nm: lifted_nm };
        let [by_alpha, _, moment_nm] = lifted.moment(at.alpha, at.rear_rad);
        trailer[0] -= by_alpha;
        trailer[1] -= at.cos * fifth_slope;
        trailer[2] -= moment_nm - held_nm;
        let [by_alpha, by_roll, moment_nm] = lifted.moment(at.alpha, at.roll_rad);
        let front = [by_alpha, at.cos * fifth_slope, moment_nm - held_nm];
        let stiffness = at.cos * at.cos * fifth_slope + frame - by_roll;
        let step = front.map(|by| by / stiffness);
        for k in 0..3 {
            trailer[k] += frame * step[k];
            tractor[k] += at.cos * fifth_slope * step[k];
        }
        step
    }
}
