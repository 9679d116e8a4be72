//! Loads of the trailer, and the sprung mass of tare and payload together.

use crate::error::VehicleError;
use crate::limits::{GREATEST_HEIGHT_M, GREATEST_TRAILER_MASS_KG, positive};

/// A load of the trailer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass of the whole semitrailer as weighed (sprung mass and axles).
    pub trailer_mass_kg: f64,
    /// Height of its sprung c.g. above ground at rest.
    pub cg_height_m: f64,
}

impl Load {
    /// Checks that a load is possible on the road.
    ///
    /// # Errors
    /// [`VehicleError::Model`] with the number and its limit.
    pub fn check(&self) -> Result<(), VehicleError> {
        positive("c.g. height (m)", self.cg_height_m, GREATEST_HEIGHT_M)?;
        positive("trailer mass (kg)", self.trailer_mass_kg, GREATEST_TRAILER_MASS_KG)
    }
}

/// The trailer's sprung mass under a load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SprungMass {
    /// Total sprung mass.
    pub mass_kg: f64,
    /// Mass of the payload, which is a part of it.
    pub payload_kg: f64,
    /// Distance of the c.g. behind the fifth wheel.
    pub cg_behind_hitch_m: f64,
    /// Height of the c.g.
    pub cg_height_m: f64,
    /// Roll inertia about the c.g.
    pub roll_inertia_kgm2: f64,
    /// Yaw inertia about the c.g.
    pub yaw_inertia_kgm2: f64,
    /// Pitch inertia about the c.g.
    pub pitch_inertia_kgm2: f64,
}
