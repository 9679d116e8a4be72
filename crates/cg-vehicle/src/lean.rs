//! The roll angle at which a trailer stands whose load is beside the middle.
//!
//! The estimator takes a constant lean for an offset of the roll sensor, and with linear springs that does
//! no harm. Springs and fifth wheels with play are another matter: a turn away from the heavy side brings
//! the play into use at a lateral acceleration at which it would not with a load in the middle.

use crate::equations::{Equations, Variant, q, w};
use crate::error::VehicleError;
use crate::linear::NO_STEADY_TURN;
use crate::vehicle::Vehicle;

/// The lean of a trailer whose springs or fifth wheel have play.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Lean {
    /// Roll angle per moment of the load about the middle, rad/(kg m).
    pub rad_per_kgm: f64,
    /// Payload of the reference load, kg.
    pub reference_payload_kg: f64,
    /// Mass of the empty trailer, kg.
    pub empty_kg: f64,
    /// Whether the springs have play, and not the fifth wheel alone.
    pub of_springs: bool,
}

impl Lean {
    /// The lean of a vehicle; `None` if nothing has play.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(vehicle: &Vehicle) -> Result<Option<Self>, VehicleError> {
        let hitch = &vehicle.hitch;
        let slack = |n: &f64| *n <= 0.0;
        let springs = vehicle.axles().iter().any(|placed| {
            vehicle
                .spring_of(placed.axle)
                .is_some_and(|spring| spring.extension_n.iter().any(slack))
        });
        if !springs && hitch.separation_moment_nm.is_none() && hitch.lash_rad <= 0.0 {
            return Ok(None);
        }
        let load = vehicle.reference_load();
        let equations =
            Equations::new(vehicle, Variant::Complete, vehicle.nominal_speed_mps, load)?;
        let empty_kg = vehicle.empty_trailer_mass_kg();
        Ok(Some(Self {
            rad_per_kgm: vehicle.gravity_mps2 * equations.roll_per_moment()?,
            reference_payload_kg: load.trailer_mass_kg - empty_kg,
            empty_kg,
            of_springs: springs,
        }))
    }

    /// The lean with this roll angle per moment (rad/(kg m)), reference payload and empty mass (kg).
    pub fn from_parts(
        [rad_per_kgm, reference_payload_kg, empty_kg]: [f64; 3],
        of_springs: bool,
    ) -> Self {
        Self { rad_per_kgm, reference_payload_kg, empty_kg, of_springs }
    }

    /// Distance of a load from the middle at which the trailer leans by an angle.
    pub fn beside_m(&self, lean_rad: f64, trailer_mass_kg: f64) -> f64 {
        lean_rad / (self.rad_per_kgm * (trailer_mass_kg - self.empty_kg))
    }
}

impl Equations {
    /// Roll angle at the sensor of the trailer per moment on its sprung mass, rad/(N m), of a standing vehicle.
    fn roll_per_moment(&self) -> Result<f64, VehicleError> {
        let stiffness = self.stiffness_with_hitch();
        let n = stiffness.ncols() - q::ROLL_1;
        let rolls = stiffness.view((w::ROLL_1, q::ROLL_1), (n, n)).clone_owned();
        let (front, _) = self.on_hitch();
        let mut moment = nalgebra::DVector::zeros(n);
        for body in [front, w::ROLL_2] {
            moment[body - w::ROLL_1] += 0.5;
        }
        let none = || VehicleError::Model(NO_STEADY_TURN.to_owned());
        let angles = rolls.lu().solve(&moment).ok_or_else(none)?;
        let row = self.trailer_roll(|twisting| twisting.roll_share);
        Ok(row.rows(q::ROLL_1, n).dot(&angles))
    }
}
