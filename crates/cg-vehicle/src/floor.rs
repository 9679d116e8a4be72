//! The floor of the trailer: a load's c.g. is above it.

use serde::{Deserialize, Serialize};

use crate::balance::{LEAST_SHARE, payload_above_tare_m};
use crate::vehicle::Vehicle;

/// The floor, and what the c.g. of a payload follows from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Floor {
    /// Height of the floor.
    pub height_m: f64,
    unsprung_kg: f64,
    tare_kg: f64,
    tare_height_m: f64,
}

impl Floor {
    /// The floor of a vehicle.
    pub fn of(vehicle: &Vehicle) -> Self {
        let (tare, bed) = (&vehicle.trailer.tare, &vehicle.trailer.payload);
        Self {
            height_m: bed.floor_height_m,
            unsprung_kg: vehicle.trailer_unsprung_mass_kg(),
            tare_kg: tare.sprung_mass_kg,
            tare_height_m: tare.cg_height_m,
        }
    }

    /// Height of the payload's own c.g., m, if this is the height of the sprung c.g. of tare and payload;
    /// `None` for an empty or nearly empty trailer.
    pub fn payload_height_m(&self, trailer_mass_kg: f64, cg_height_m: f64) -> Option<f64> {
        let sprung_kg = trailer_mass_kg - self.unsprung_kg;
        let share = 1.0 - self.tare_kg / sprung_kg;
        let above_tare_m = payload_above_tare_m(cg_height_m - self.tare_height_m, share);
        (share >= LEAST_SHARE).then_some(self.tare_height_m + above_tare_m)
    }

    /// Height of the sprung c.g., m, of a trailer of this mass, if it differs from that of the empty one by this share at most.
    pub fn empty_height_m(&self, trailer_mass_kg: f64, share: f64) -> Option<f64> {
        let empty_kg = self.unsprung_kg + self.tare_kg;
        ((trailer_mass_kg / empty_kg - 1.0).abs() <= share).then_some(self.tare_height_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_payload_is_what_lifts_the_whole() {
        let floor = Floor { height_m: 1.25, unsprung_kg: 2e3, tare_kg: 4e3, tare_height_m: 1.2 };
        // 12 t at 2.0 m and 4 t at 1.2 m are 16 t at 1.8 m.
        let payload_m = floor.payload_height_m(18e3, 1.8).unwrap();
        assert!((payload_m - 2.0).abs() < 1e-12, "{payload_m}");
        assert!(floor.payload_height_m(6.9e3, 1.3).is_none());
        assert!(floor.payload_height_m(6e3, 1.3).is_none());
        let empty_m =
            [5.8e3, 5.85e3, 6.15e3, 6.2e3, f64::NAN].map(|kg| floor.empty_height_m(kg, 0.03));
        assert_eq!(empty_m, [None, Some(1.2), Some(1.2), None, None]);
    }
}
