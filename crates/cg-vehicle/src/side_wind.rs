//! What a side wind does to the roll of a trailer.

use serde::{Deserialize, Serialize};

use crate::error::VehicleError;
use crate::lean::Lean;
use crate::load::Load;
use crate::vehicle::Vehicle;
use crate::wind::Wind;

/// What the usual wind does to the roll of a trailer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SideWind {
    /// Moment of the force about roll axis and road for each m/s of the truck if the wind blows across with its root mean square, N s.
    moment_ns: f64,
    /// Moment that holds the trailer against rolling, without that of its weight, N m/rad.
    stiffness_nm_per_rad: f64,
    /// Suspension roll over roll angle.
    of_suspension: f64,
    unsprung_kg: f64,
    roll_center_m: f64,
    gravity_mps2: f64,
    /// Whether the vehicle file says what the body and the wind are. Those of a box body are used otherwise.
    pub is_stated: bool,
}

impl SideWind {
    /// That of a vehicle, or `None` if its file says that there is no wind.
    ///
    /// The roll axis is taken at the roll centers of the trailer's axles.
    ///
    /// # Errors
    /// As [`Lean::of`].
    pub fn of(vehicle: &Vehicle) -> Result<Option<Self>, VehicleError> {
        let wind = vehicle.wind.unwrap_or(Wind::USUAL);
        if wind.speed_mps <= 0.0 {
            return Ok(None);
        }
        let lean = Lean::of(vehicle)?;
        let axles = &vehicle.trailer.axle;
        #[allow(clippy::cast_precision_loss)] // a handful
        let share = 1.0 / axles.len() as f64;
        let heights = axles.iter().map(|axle| axle.axle.roll_center_height_m);
        let roll_center_m: f64 = heights.map(|height_m| share * height_m).sum();
        let of_suspension = lean.suspension_rad_per_kgm / lean.rad_per_kgm;
        // The tires carry the force to the road, so their part of the roll is about it.
        let arm_m = wind.side_height_m - of_suspension * roll_center_m;
        let soft = Self {
            moment_ns: wind.n_per_m2ps2() * wind.speed_mps * arm_m,
            stiffness_nm_per_rad: vehicle.gravity_mps2 / lean.rad_per_kgm,
            of_suspension,
            unsprung_kg: vehicle.trailer_unsprung_mass_kg(),
            roll_center_m,
            gravity_mps2: vehicle.gravity_mps2,
            is_stated: vehicle.wind.is_some(),
        };
        let Load { trailer_mass_kg, cg_height_m } = vehicle.reference_load();
        let by_weight_nm = soft.weight_nm_per_rad([trailer_mass_kg, cg_height_m]);
        let stiffness_nm_per_rad = soft.stiffness_nm_per_rad + by_weight_nm;
        Ok(Some(Self { stiffness_nm_per_rad, ..soft }))
    }

    /// Moment of the weight of a trailer of a mass, kg, whose c.g. is at a height, m, when it rolls, N m/rad.
    fn weight_nm_per_rad(&self, [trailer_mass_kg, cg_height_m]: [f64; 2]) -> f64 {
        let arm_m = cg_height_m - self.roll_center_m;
        self.gravity_mps2 * (trailer_mass_kg - self.unsprung_kg) * arm_m
    }

    /// Roll angle, rad, over the speed of the truck, m/s, of a trailer of a mass, kg, whose c.g. is at a height, m, if the usual wind
    /// blows across its way.
    ///
    /// The air comes nearly from ahead, so that the force goes with the speed of the truck times that of the wind.
    pub fn roll_rad_per_mps(&self, load: [f64; 2]) -> f64 {
        self.moment_ns / (self.stiffness_nm_per_rad - self.weight_nm_per_rad(load))
    }

    /// The same of the suspension roll.
    pub fn suspension_rad_per_mps(&self, load: [f64; 2]) -> f64 {
        self.of_suspension * self.roll_rad_per_mps(load)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::{TruckKind, template};

    /// By hand: a moment of 100 N m for each m/s against 1 MN m/rad, of which 10 t that are 1 m above the roll axis take a tenth.
    #[test]
    fn the_weight_makes_the_trailer_softer() {
        let side = SideWind {
            moment_ns: 100.0,
            stiffness_nm_per_rad: 1e6,
            of_suspension: 0.5,
            unsprung_kg: 2000.0,
            roll_center_m: 0.4,
            gravity_mps2: 10.0,
            is_stated: true,
        };
        let found = side.roll_rad_per_mps([12e3, 1.4]);
        assert!((found - 100.0 / 0.9e6).abs() < 1e-12, "{found}");
        assert!((side.suspension_rad_per_mps([12e3, 1.4]) - 50.0 / 0.9e6).abs() < 1e-12);
    }

    /// The file's roll centers are at 0.7 m, and its reference load rolls as its lean says.
    #[test]
    fn the_side_of_a_file_that_says_nothing_is_that_of_a_box() {
        let text = template(TruckKind::FourByTwoThreeAxle);
        let mut vehicle = Vehicle::parse(&text, "truck").unwrap();
        let boxed = Wind::USUAL;
        vehicle.wind = Some(Wind { speed_mps: 0.0, ..boxed });
        assert!(SideWind::of(&vehicle).unwrap().is_none());
        vehicle.wind = Some(boxed);
        let side = SideWind::of(&vehicle).unwrap().unwrap();
        vehicle.wind = None;
        let assumed = SideWind::of(&vehicle).unwrap().unwrap();
        assert_eq!(assumed, SideWind { is_stated: false, ..side });
        let (load, lean) = (vehicle.reference_load(), Lean::of(&vehicle).unwrap());
        let of_suspension = lean.suspension_rad_per_kgm / lean.rad_per_kgm;
        let arm_m = 1.7 * of_suspension + 2.4 * (1.0 - of_suspension);
        let moment_ns = 3.0 * boxed.n_per_m2ps2() * arm_m;
        assert!((side.moment_ns / moment_ns - 1.0).abs() < 1e-12);
        let found = side.roll_rad_per_mps([load.trailer_mass_kg, load.cg_height_m]);
        let expected = moment_ns * lean.rad_per_kgm / vehicle.gravity_mps2;
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
    }
}
