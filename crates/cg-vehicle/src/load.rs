//! Loads of the trailer, and the one body that tare and payload make.

use crate::error::VehicleError;
use crate::vehicle::Vehicle;

/// A load of the trailer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass of the whole semitrailer as weighed (sprung mass and axles).
    pub trailer_mass_kg: f64,
    /// Height of its sprung c.g. above ground at rest.
    pub cg_height_m: f64,
}

/// The trailer's sprung mass under a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SprungMass {
    /// Mass.
    pub mass_kg: f64,
    /// The part of it that is payload.
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

impl Vehicle {
    /// Tare and payload as one body: the payload is the box that gives the load's mass and
    /// height; its own height follows from its c.g. (0.6–2.4 m).
    ///
    /// # Errors
    /// [`VehicleError::Load`] if the mass is below that of the empty trailer.
    pub fn trailer_sprung_mass(&self, load: Load) -> Result<SprungMass, VehicleError> {
        let (tare, bed) = (&self.trailer.tare, &self.trailer.payload);
        let mass_kg = load.trailer_mass_kg - self.trailer_unsprung_mass_kg();
        // Weighbridges and rounding: half a per cent below empty still counts as empty.
        if mass_kg < tare.sprung_mass_kg - 0.005 * load.trailer_mass_kg {
            return Err(VehicleError::Load {
                trailer_mass_kg: load.trailer_mass_kg,
                empty_mass_kg: self.empty_trailer_mass_kg(),
            });
        }
        let payload_kg = (mass_kg - tare.sprung_mass_kg).max(0.0);
        let share = payload_kg / (tare.sprung_mass_kg + payload_kg);
        let cg_behind_hitch_m =
            tare.cg_behind_hitch_m + share * (bed.behind_hitch_m - tare.cg_behind_hitch_m);
        // The payload's c.g. that gives the height; a small payload cannot be arbitrarily high.
        let above_tare_m = (load.cg_height_m - tare.cg_height_m) / share.max(0.2);
        let above_floor_m = tare.cg_height_m + above_tare_m - bed.floor_height_m;
        let box_height_m = (2.0 * above_floor_m).clamp(0.6, 2.4);
        let square = |x: f64| x * x;
        let reduced_mass_kg = tare.sprung_mass_kg * share;
        let along_m = bed.behind_hitch_m - tare.cg_behind_hitch_m;
        Ok(SprungMass {
            mass_kg,
            payload_kg,
            cg_behind_hitch_m,
            cg_height_m: load.cg_height_m,
            roll_inertia_kgm2: tare.roll_inertia_kgm2
                + payload_kg * (square(bed.width_m) + square(box_height_m)) / 12.0
                + reduced_mass_kg * square(above_tare_m),
            yaw_inertia_kgm2: tare.yaw_inertia_kgm2
                + payload_kg * (square(bed.width_m) + square(bed.length_m)) / 12.0
                + reduced_mass_kg * square(along_m),
            pitch_inertia_kgm2: tare.pitch_inertia_kgm2.unwrap_or(tare.yaw_inertia_kgm2)
                + payload_kg * (square(bed.length_m) + square(box_height_m)) / 12.0
                + reduced_mass_kg * (square(along_m) + square(above_tare_m)),
        })
    }
}
