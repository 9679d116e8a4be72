//! Speed and trailer mass that are known and replace those of a log: what they may be.

use cg_core::{Design, Settings};
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

/// Share of the empty trailer's mass down to which a scale is believed to have weighed it: two standard deviations of an EBS, and
/// some more.
const LEAST_EMPTY: f64 = 0.9;

/// The trailer mass of a signal, kg, which is at least that of the empty trailer: a scale that shows a little less is wrong by as
/// much.
pub fn weighed_mass(design: &Design<f64>, mass_kg: f64) -> f64 {
    let least_kg = design.trailer_mass_kg[0];
    if (LEAST_EMPTY * least_kg..least_kg).contains(&mass_kg) { least_kg } else { mass_kg }
}

/// Whether a trailer mass is that of another load before, and not a new measurement: two loads differ by more than a
/// thousandth.
pub fn is_held(mass_kg: f64, before_kg: f64) -> bool {
    (mass_kg / before_kg - 1.0).abs() < 1e-3
}

/// Whether a trailer of a mass, kg, has another load than one of the second mass, as for the estimator.
pub fn is_other_load(mass_kg: f64, known_kg: f64) -> bool {
    (mass_kg - known_kg).abs() > Settings::<f64>::truck().mass_change * known_kg
}

/// That a log has another mass, kg, than the one that was given for it.
pub(crate) fn mass_contradiction(given_kg: f64, logged_kg: f64) -> Option<String> {
    is_other_load(given_kg, logged_kg).then(|| {
        format!(
            "the trailer mass that was given is used, {given_kg:.0} kg, but the log has {logged_kg:.0} kg in its last \
             turn: one of them is wrong"
        )
    })
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
    fn a_scale_that_shows_a_little_less_has_weighed_the_empty_trailer() {
        let vehicle = kraz();
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        let empty_kg = vehicle.empty_trailer_mass_kg();
        for (share, expected) in [(0.97, None), (0.905, None), (0.88, Some(0.88)), (1.3, Some(1.3))]
        {
            let found_kg = weighed_mass(&design, share * empty_kg);
            let in_design = design.line(cg_core::Channel::Steer, 15.0, found_kg).is_some();
            assert_eq!(in_design, share > 0.9, "{share}");
            if let Some(expected) = expected {
                assert!((found_kg / empty_kg - expected).abs() < 1e-12);
            }
            assert!(found_kg <= 1.3 * empty_kg);
        }
        assert!(weighed_mass(&design, f64::NAN).is_nan());
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
