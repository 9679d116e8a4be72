//! A calibration of the tractor alone, for any trailer behind it.

use serde::{Deserialize, Serialize};

use crate::belief::Parameter;
use crate::files::checksum;
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
            ),
        }
    }
}

/// Checksum of everything in a vehicle file that describes the tractor and the fifth wheel.
pub(super) fn tractor(vehicle: &Vehicle) -> String {
    let axles = || vehicle.tractor.axle.iter().map(|axle| &axle.axle);
    let tyres = vehicle.tyre.iter().filter(|tyre| axles().any(|axle| axle.tyre == tyre.name));
    let springs = vehicle
        .spring
        .iter()
        .filter(|spring| axles().any(|axle| axle.spring.as_ref() == Some(&spring.name)));
    let text = format!(
        "{:?}{:?}{:?}{:?}",
        vehicle.tractor,
        vehicle.hitch,
        tyres.collect::<Vec<_>>(),
        springs.collect::<Vec<_>>()
    );
    format!("{:08x}", checksum(&text))
}
