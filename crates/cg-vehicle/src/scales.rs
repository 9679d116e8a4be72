//! The sources of the trailer mass, and how exact they are.

use cg_core::Quantity;
use serde::{Deserialize, Serialize};

use crate::sensor_places::MassUncertainty;
use crate::vehicle::Vehicle;

/// A source of the trailer mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Scale {
    /// A weighbridge.
    Weighed,
    /// The weight of the trailer on the bus.
    VehicleWeight,
    /// The load of the trailer's axles.
    AxleLoad,
    /// The pressure in the trailer's air suspension.
    SuspensionPressure,
    /// The pressure in the air suspension of the tractor's drive axles.
    DrivePressure,
}

cg_core::words!(Scale {
    Weighed => "weighed", "a weighbridge";
    VehicleWeight => "vehicle-weight", "the trailer's weight on the bus";
    AxleLoad => "axle-load", "the load of the trailer's axles";
    SuspensionPressure => "suspension-pressure", "the pressure in the trailer's air suspension";
    DrivePressure => "drive-pressure", "the pressure in the tractor's air suspension";
});

impl Scale {
    /// The scale from whose column in a log the mass follows; `None` if none follows.
    pub fn in_log(quantity: Quantity) -> Option<Self> {
        match quantity {
            Quantity::TrailerMass => Some(Self::Weighed),
            Quantity::TrailerAxleLoad => Some(Self::AxleLoad),
            Quantity::TrailerSuspensionPressure => Some(Self::SuspensionPressure),
            Quantity::DrivePressureLeft | Quantity::DrivePressureRight => Some(Self::DrivePressure),
            _ => None,
        }
    }

    /// The same for a signal on the bus, where a device tells the mass.
    pub fn on_bus(quantity: Quantity) -> Option<Self> {
        match quantity {
            Quantity::TrailerMass => Some(Self::VehicleWeight),
            other => Self::in_log(other),
        }
    }
}

/// How exact the scales of a vehicle are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    sd: MassUncertainty,
    /// Trailer mass at which the trailer's axles and the drive axles would carry nothing, kg; a scale's
    /// error is in proportion to what the axles carry.
    unloaded_kg: [f64; 2],
}

impl Scales {
    /// Scales without an error.
    pub const EXACT: Self = Self {
        sd: MassUncertainty {
            weighed_sd_kg: 0.0,
            vehicle_weight_sd: 0.0,
            axle_load_sd: 0.0,
            pressure_sd: 0.0,
        },
        unloaded_kg: [0.0; 2],
    };

    /// The scales of a vehicle.
    pub fn of(vehicle: &Vehicle) -> Self {
        // Without a balance there is no mass from these loads.
        let unloaded_kg = [vehicle.mass_of_axle_load(), vehicle.mass_of_drive_load()]
            .map(|line| line.map_or(0.0, |[at_zero_kg, _]| at_zero_kg));
        Self { sd: vehicle.sensors.mass.unwrap_or_default(), unloaded_kg }
    }

    /// Standard deviation of a mass from this scale, kg.
    pub fn sd_kg(&self, scale: Scale, mass_kg: f64) -> f64 {
        let [axles_kg, drive_kg] = self.unloaded_kg.map(|unloaded_kg| mass_kg - unloaded_kg);
        match scale {
            Scale::Weighed => self.sd.weighed_sd_kg,
            Scale::VehicleWeight => self.sd.vehicle_weight_sd * mass_kg,
            Scale::AxleLoad => self.sd.axle_load_sd * axles_kg,
            Scale::SuspensionPressure => self.sd.pressure_sd * axles_kg,
            Scale::DrivePressure => self.sd.pressure_sd * drive_kg,
        }
    }
}
