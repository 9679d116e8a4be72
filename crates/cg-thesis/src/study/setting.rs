//! What a study starts from, and what several studies say.

use cg_vehicle::Vehicle;

use super::data::{Quantity, Unit};
use super::drive::Drive;

/// Input of a study.
pub(super) struct Setting {
    pub(super) name: &'static str,
    pub(super) vehicle: Vehicle,
}

pub(super) const PEAK_ROLL: Quantity =
    Quantity { name: "peak_roll", label: "Peak roll angle of the semitrailer", unit: Unit::Radian };
pub(super) const PEAK_LATERAL: Quantity = Quantity {
    name: "peak_lateral_acceleration",
    label: "Peak lateral acceleration",
    unit: Unit::MeterPerSecondSquared,
};

/// Lines with vehicle, load and maneuver.
pub(super) fn scenario(setting: &Setting, drive: &Drive) -> Vec<String> {
    vec![
        format!("vehicle: {}", setting.vehicle.name),
        format!(
            "semitrailer of {:.0} kg, sprung c.g. at {:.3} m unless stated otherwise",
            drive.load.trailer_mass_kg, drive.load.cg_height_m
        ),
        drive.description(),
    ]
}

/// Slope of an angle over meters, in degrees.
pub(super) fn per_meter_deg(slope_rad_per_m: f64) -> f64 {
    slope_rad_per_m.to_degrees()
}
