//! The sources of the trailer mass, and how exact they are.

use cg_core::Quantity;
use serde::{Deserialize, Serialize};

use crate::error::VehicleError;
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

    /// Standard deviation of a mass that the trailer itself tells on the bus, kg, unless its vehicle file says otherwise; `None`
    /// for other scales, whose values remain in a log beside the mass.
    pub fn usual_sd_kg(self, mass_kg: f64) -> Option<f64> {
        let sd = MassUncertainty::default().vehicle_weight_sd;
        (self == Self::VehicleWeight).then_some(sd * mass_kg)
    }
}

/// How exact the scales of a vehicle are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    sd: MassUncertainty,
    axles: AxleMass,
    drive_axles: AxleMass,
}

/// How the trailer mass follows from a load of axles on the road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct AxleMass {
    /// Trailer mass at which the axles would carry nothing, kg; a scale's error is in proportion to what
    /// they carry.
    unloaded_kg: f64,
    /// Error of the mass if the payload stands by its standard deviation behind the place in the file: that
    /// without a mass, kg, and what each kg of trailer mass adds.
    elsewhere: [f64; 2],
}

impl AxleMass {
    const EXACT: Self = Self { unloaded_kg: 0.0, elsewhere: [0.0; 2] };

    /// Of this [line](Vehicle::mass_of_axle_load) of the mass over the load of the axles.
    fn of(vehicle: &Vehicle, line: impl Fn(&Vehicle) -> Result<[f64; 2], VehicleError>) -> Self {
        // Without a balance there is no mass from these loads.
        let Ok([unloaded_kg, slope]) = line(vehicle) else { return Self::EXACT };
        let error = |by_m: f64| {
            let mut moved = vehicle.clone();
            moved.trailer.payload.behind_hitch_m += by_m;
            let [at_zero_kg, true_slope] = line(&moved).unwrap_or([unloaded_kg, slope]);
            let factor = slope / true_slope;
            [unloaded_kg - factor * at_zero_kg, factor - 1.0]
        };
        let sd_m = vehicle.uncertainty.payload_place_sd_m;
        let (behind, before) = (error(sd_m), error(-sd_m));
        let elsewhere = std::array::from_fn(|k| 0.5 * (behind[k] - before[k]));
        Self { unloaded_kg, elsewhere }
    }

    /// Standard deviation of a mass, if the scale's own is this share of its load, kg.
    fn sd_kg(&self, scale_sd: f64, mass_kg: f64) -> f64 {
        let [at_zero_kg, per_kg] = self.elsewhere;
        libm::hypot(scale_sd * (mass_kg - self.unloaded_kg), at_zero_kg + per_kg * mass_kg)
    }
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
        axles: AxleMass::EXACT,
        drive_axles: AxleMass::EXACT,
    };

    /// The scales of a vehicle.
    pub fn of(vehicle: &Vehicle) -> Self {
        Self {
            sd: vehicle.sensors.mass.unwrap_or_default(),
            axles: AxleMass::of(vehicle, Vehicle::mass_of_axle_load),
            drive_axles: AxleMass::of(vehicle, Vehicle::mass_of_drive_load),
        }
    }

    /// Standard deviation of a mass from this scale, kg. That of a load of axles includes the place of the
    /// payload (`uncertainty.payload_place_sd_m`), from which the share of these axles follows.
    pub fn sd_kg(&self, scale: Scale, mass_kg: f64) -> f64 {
        match scale {
            Scale::Weighed => self.sd.weighed_sd_kg,
            Scale::VehicleWeight => self.sd.vehicle_weight_sd * mass_kg,
            Scale::AxleLoad => self.axles.sd_kg(self.sd.axle_load_sd, mass_kg),
            Scale::SuspensionPressure => self.axles.sd_kg(self.sd.pressure_sd, mass_kg),
            Scale::DrivePressure => self.drive_axles.sd_kg(self.sd.pressure_sd, mass_kg),
        }
    }
}
