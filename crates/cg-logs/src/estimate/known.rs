//! Speed and trailer mass that are known and replace those of a log: what they may be.

use cg_vehicle::limits::{self, up_to};
use cg_vehicle::{LinearModel, Load, Variant, Vehicle, VehicleError};

use super::options::EstimateOptions;

/// A speed in m/s that is possible for a truck.
///
/// # Errors
/// [`VehicleError::Model`] if it is not positive, or above
/// [`GREATEST_SPEED_MPS`](limits::GREATEST_SPEED_MPS).
pub fn known_speed(speed_mps: f64) -> Result<f64, VehicleError> {
    possible("speed_mps", speed_mps, limits::GREATEST_SPEED_MPS)
}

/// A mass of the whole semitrailer in kg that is possible for this vehicle.
///
/// # Errors
/// [`VehicleError::Model`] if it is not positive, or above
/// [`GREATEST_TRAILER_MASS_KG`](limits::GREATEST_TRAILER_MASS_KG); [`VehicleError::Load`] if it is below
/// that of the empty trailer.
pub fn known_mass(vehicle: &Vehicle, trailer_mass_kg: f64) -> Result<f64, VehicleError> {
    possible("trailer_mass_kg", trailer_mass_kg, limits::GREATEST_TRAILER_MASS_KG)?;
    vehicle.trailer_sprung_mass(Load { trailer_mass_kg, ..vehicle.reference_load() })?;
    Ok(trailer_mass_kg)
}

fn possible(name: &str, value: f64, greatest: f64) -> Result<f64, VehicleError> {
    up_to(value, greatest)
        .map_err(|must| VehicleError::Model(format!("{name} is {value}: it {must}")))
}

impl EstimateOptions {
    /// The same options, if the vehicle can have their speed and their trailer mass.
    ///
    /// # Errors
    /// As [`known_speed`] and [`known_mass`]; and [`VehicleError::AsPrinted`] if the printed model is not
    /// known for this mass.
    pub fn checked(self, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        self.speed_mps.map(known_speed).transpose()?;
        let Some(mass_kg) = self.trailer_mass_kg else { return Ok(self) };
        let trailer_mass_kg = known_mass(vehicle, mass_kg)?;
        if self.variant == Variant::AsPrinted {
            let speed_mps = self.speed_mps.unwrap_or(vehicle.nominal_speed_mps);
            let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
            LinearModel::new(vehicle, self.variant, speed_mps, load)?;
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kraz() -> Vehicle {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        Vehicle::load(file).unwrap()
    }

    #[test]
    fn what_no_truck_can_have_is_refused() {
        let vehicle = kraz();
        assert!(known_speed(60.0).is_ok() && known_mass(&vehicle, 200e3).is_ok());
        // Half a percent below empty still counts as empty.
        assert!(known_mass(&vehicle, 0.997 * vehicle.empty_trailer_mass_kg()).is_ok());
        for (speed_mps, mass_kg, message) in [
            (Some(60.1), None, "speed_mps is 60.1: it must be at most 60"),
            (Some(f64::NAN), None, "speed_mps is NaN: it must be positive"),
            (Some(0.0), Some(20e3), "speed_mps is 0: it must be positive"),
            (None, Some(281_390.0), "trailer_mass_kg is 281390: it must be at most 200000"),
            (None, Some(-1.0), "trailer_mass_kg is -1: it must be positive"),
            (None, Some(29.0), "29 kg is below the empty trailer's 8684 kg"),
        ] {
            let options = EstimateOptions {
                speed_mps,
                trailer_mass_kg: mass_kg,
                ..EstimateOptions::default()
            };
            let error = options.checked(&vehicle).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
