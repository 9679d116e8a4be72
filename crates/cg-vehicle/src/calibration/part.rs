//! What a calibration is for, and on which parts of the vehicle file it depends.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::belief::Parameter;
use crate::error::VehicleError;
use crate::files::checksum;
use crate::sensor_places::SensorPlaces;
use crate::uncertainty::{USUAL_PAYLOAD_BESIDE_SD_M, Uncertainty};
use crate::vehicle::Vehicle;

/// What a calibration is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Part {
    /// Tractor and trailer together.
    #[default]
    Vehicle,
    /// The tractor behind which other trailers drive; theirs is what the vehicle file says.
    Tractor,
}

cg_core::words!(Part {
    Vehicle => "vehicle", "tractor and trailer together";
    Tractor => "tractor", "the tractor alone, for any trailer behind it";
});

impl Part {
    /// Whether the calibration keeps what it found for a parameter. Parameters that tractor and trailer
    /// share (tires, roll centers) are not of the tractor alone.
    pub(super) const fn keeps(self, parameter: Parameter) -> bool {
        match self {
            Self::Vehicle => true,
            Self::Tractor => matches!(
                parameter,
                Parameter::TractorRollStiffness
                    | Parameter::TractorCgHeight
                    | Parameter::FifthWheelStiffness
                    | Parameter::SteeredCorneringStiffness
                    | Parameter::DriveCorneringStiffness
                    | Parameter::SteeringGain
                    | Parameter::TractorSpecificForceGain
                    | Parameter::TractorSuspensionRollGain
                    | Parameter::TractorSpringFriction
            ),
        }
    }
}

/// Checksums of the parts of a vehicle file on which a calibration depends, by their keys. Comments,
/// name, limits of the height, nominal speed, roads and the exactness of masses do not change it. `[uncertainty]` does: the
/// posterior contains it. The tractor alone depends on what the file says about it and the fifth wheel.
pub(super) fn checksums(
    vehicle: &Vehicle,
    part: Part,
) -> Result<BTreeMap<String, String>, VehicleError> {
    let mut sums = BTreeMap::new();
    let mut add = |key: &str, sum: String| drop(sums.insert(key.to_owned(), sum));
    add("steering_ratio", sum(vehicle.steering_ratio)?);
    add("hitch", sum(vehicle.hitch)?);
    add("tractor", sum(&vehicle.tractor)?);
    if part == Part::Tractor {
        let axles = || vehicle.tractor.axle.iter().map(|axle| &axle.axle);
        let tyres = vehicle.tyre.iter().filter(|tyre| axles().any(|axle| axle.tyre == tyre.name));
        let springs = vehicle
            .spring
            .iter()
            .filter(|spring| axles().any(|axle| axle.spring.as_ref() == Some(&spring.name)));
        add("tyre", sum(tyres.collect::<Vec<_>>())?);
        add("spring", sum(springs.collect::<Vec<_>>())?);
        add("sensors.tractor_accelerometer", sum(vehicle.sensors.tractor_accelerometer)?);
        add("sensors.tractor_level", sum(vehicle.sensors.tractor_level)?);
    } else {
        add("gravity_mps2", sum(vehicle.gravity_mps2)?);
        // No ratio depends on how far loads stand beside the middle.
        let payload_beside_sd_m = USUAL_PAYLOAD_BESIDE_SD_M;
        add("uncertainty", sum(Uncertainty { payload_beside_sd_m, ..vehicle.uncertainty })?);
        // A lift axle that is down is like any other, and of runs with it raised the ratios are compared.
        let mut trailer = vehicle.trailer.clone();
        trailer.axle.iter_mut().for_each(|axle| axle.lift_m = None);
        add("trailer", sum(&trailer)?);
        add("tyre", sum(&vehicle.tyre)?);
        add("spring", sum(&vehicle.spring)?);
        add("sensors", sum(SensorPlaces { mass: None, ..vehicle.sensors })?);
        add("as_printed", sum(&vehicle.as_printed)?);
    }
    Ok(sums)
}

/// One checksum of all parts of a vehicle file on which a calibration depends.
///
/// # Errors
/// The file cannot be written as TOML. This would be a bug.
pub fn vehicle_crc32(vehicle: &Vehicle) -> Result<u32, VehicleError> {
    let sums = checksums(vehicle, Part::Vehicle)?;
    Ok(checksum(&sums.into_values().collect::<String>()))
}

/// What a file means that does not have keys of later versions.
const LATER: [&str; 3] =
    ["spring_friction_sd = 0.3", "cornering_over_load_sd = 0.04", "payload_beside_sd_m = 0.05"];

/// Checksum of the TOML of a value. Optional keys that the value does not have are not in it, and neither is
/// [what the absence of a key means](LATER), so keys that a later version adds do not change it.
fn sum(value: impl Serialize) -> Result<String, VehicleError> {
    /// TOML needs a table around it.
    #[derive(Serialize)]
    struct Named<T> {
        value: T,
    }
    let text = toml::to_string(&Named { value })
        .map_err(|error| VehicleError::Model(format!("vehicle file: {error}")))?;
    let early = text.split_inclusive('\n').filter(|line| !LATER.contains(&line.trim_end()));
    Ok(format!("{:08x}", checksum(&early.collect::<String>())))
}

/// The keys of the parts that differ, as text; empty if there are none.
pub(super) fn changed(then: &BTreeMap<String, String>, now: &BTreeMap<String, String>) -> String {
    let keys: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let differs = |key: &&String| then.get(*key) != now.get(*key);
    keys.into_iter().filter(differs).map(String::as_str).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::{TruckKind, template};

    /// A file that says of a later key what its absence means has the calibrations of one that is silent.
    #[test]
    fn later_keys_are_in_no_checksum() {
        let text =
            template(TruckKind::FourByTwoThreeAxle).replace("\ncornering_over_load_sd", "\n#");
        let vehicle = Vehicle::parse(&text, "truck").unwrap();
        let written = toml::to_string(&vehicle.uncertainty).unwrap();
        for later in LATER {
            assert!(written.lines().any(|line| line == later), "{later} is not in {written}");
        }
        let mut other = vehicle.clone();
        other.uncertainty.spring_friction_sd = 0.2;
        let sums = [&vehicle, &other].map(|one| checksums(one, Part::Vehicle).unwrap());
        let without: String = written
            .split_inclusive('\n')
            .filter(|line| !LATER.contains(&line.trim_end()))
            .collect();
        let early = checksum(&format!("[value]\n{without}"));
        assert_eq!(sums[0]["uncertainty"], format!("{early:08x}"));
        assert_eq!(changed(&sums[0], &sums[1]), "uncertainty");
        let mut beside = vehicle;
        beside.uncertainty.payload_beside_sd_m = 0.1;
        assert_eq!(changed(&sums[0], &checksums(&beside, Part::Vehicle).unwrap()), "");
    }
}
