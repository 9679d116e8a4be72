//! Options of an estimate.

use std::str::FromStr;

use cg_core::decide::settings::PUBLIC_BANK_SD_RAD;
use cg_core::{CHANNELS, Channel, Measured, Outcome, Quantity, Settings};
use cg_vehicle::assumptions::has_unplaced_roll_sensor;
use cg_vehicle::floor::Floor;
use cg_vehicle::lean::Lean;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::preparation::Prepares;
use cg_vehicle::scales::Scales;
use cg_vehicle::second_sensor::slopes;
use cg_vehicle::side_wind::SideWind;
use cg_vehicle::{Variant, Vehicle};
use serde::{Deserialize, Serialize};

use super::basis::Basis;

/// Greatest relative difference between the mass in a log and that of the empty trailer.
pub(crate) const EMPTY_SHARE: f64 = 0.03;

const GRAVITY: &str = "nothing in the log shows whether lateral_acceleration contains gravity, as that of an accelerometer on the \
                       body does while the body rolls: the height would be 9 to 18 % too low, which the interval does \
                       not contain; record the yaw rate, too, or calibrate with this sensor, empty and laden";

/// Standard deviation of the height of a trailer that is empty by its mass, m: goods of 3 % of it, whose c.g. is 1.3 m above its
/// own, raise it by two of them.
const EMPTY_SD_M: f64 = 0.02;

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE_95: f64 = 1.959_964;

/// The 95 % interval of a value.
pub fn interval_95(Measured { value, sd }: Measured<f64>) -> [f64; 2] {
    [value - QUANTILE_95 * sd, value + QUANTILE_95 * sd]
}

/// Method by which the DC ratio is identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// ARX on filtered signals with prior dynamics: the recommended method.
    #[default]
    Filtered,
    /// Classical ARX in shift form, as in the thesis.
    Arx,
    /// Nominal dynamics with a free gain. It has the smallest variance if the dynamics are right.
    Gain,
}

cg_core::words!(Method {
    Filtered => "filtered", "ARX on filtered signals with prior dynamics";
    Arx => "arx", "Classical ARX in shift form, as in the thesis";
    Gain => "gain", "Nominal dynamics; only the gain is identified";
});

/// The channel from which a height is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelChoice {
    /// All channels, combined.
    #[default]
    Auto,
    /// Only the roll angle by the steer angle.
    Steer,
    /// Only the roll angle by the lateral acceleration.
    LateralAcceleration,
    /// Only the suspension roll of the trailer by its specific force.
    Suspension,
    /// Only the suspension roll of the tractor by its specific force.
    Tractor,
}

cg_core::words!(ChannelChoice {
    Auto => "auto", "All, weighted by their uncertainty";
    Steer => "steer", "Roll angle by the steer angle";
    LateralAcceleration => "lateral-acceleration",
        "Roll angle by the lateral acceleration, or by yaw rate times speed";
    Suspension => "suspension", "Suspension roll of the trailer by its specific force";
    Tractor => "tractor", "Suspension roll of the tractor by its specific force", "tractor-suspension";
});

/// The roads of a log, by the standard deviation of their bank in curves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoadChoice {
    /// Standard deviation of the bank, rad.
    pub bank_sd_rad: f64,
}

/// Greatest standard deviation of the bank that is accepted, rad. No road is so steep.
const GREATEST_BANK_SD_RAD: f64 = 0.15;

impl RoadChoice {
    /// A flat test track.
    pub const FLAT: Self = Self { bank_sd_rad: 0.0 };

    /// The roads that the vehicle file states.
    pub fn of_vehicle(vehicle: &Vehicle) -> Option<Self> {
        vehicle.road.map(|road| Self { bank_sd_rad: road.bank_sd_rad })
    }
}

impl FromStr for RoadChoice {
    type Err = UnknownRoad;

    fn from_str(text: &str) -> Result<Self, UnknownRoad> {
        let bank_sd_rad = match text {
            "flat" => 0.0,
            "public" => PUBLIC_BANK_SD_RAD,
            number => number.parse().unwrap_or(f64::NAN),
        };
        if (0.0..=GREATEST_BANK_SD_RAD).contains(&bank_sd_rad) {
            Ok(Self { bank_sd_rad })
        } else {
            Err(UnknownRoad)
        }
    }
}

/// The error for a text that describes no road.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected flat, public, or the standard deviation of the bank in rad, from 0 to {GREATEST_BANK_SD_RAD}"
)]
pub struct UnknownRoad;

impl From<ChannelChoice> for Option<Channel> {
    fn from(choice: ChannelChoice) -> Self {
        match choice {
            ChannelChoice::Auto => None,
            ChannelChoice::Steer => Some(Channel::Steer),
            ChannelChoice::LateralAcceleration => Some(Channel::LateralAcceleration),
            ChannelChoice::Suspension => Some(Channel::Suspension),
            ChannelChoice::Tractor => Some(Channel::Tractor),
        }
    }
}

/// Greatest usual height. The middle of a box that is filled to a roof at 4 m above a floor at 1.2
/// m is at 2.6 m, and the trailer's own mass is below.
const USUAL_HEIGHT_M: f64 = 2.5;

/// Options of an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimateOptions {
    /// Equations of the vehicle model.
    pub variant: Variant,
    /// Method of identification.
    pub method: Method,
    /// Order of the classical ARX.
    pub order: usize,
    /// The channel to use; `None` combines all, weighted by their uncertainty.
    pub channel: Option<Channel>,
    /// Speed in m/s that replaces the one in the log.
    pub speed_mps: Option<f64>,
    /// Trailer mass in kg that replaces the one in the log.
    pub trailer_mass_kg: Option<f64>,
    /// Standard deviation of the trailer mass, kg. `None`: that of its scale; without any mass, the
    /// trailer may have any load.
    pub trailer_mass_sd_kg: Option<f64>,
    /// Position of the lift axles that replaces that in the log.
    #[serde(default)]
    pub lift_axle: Option<LiftAxle>,
    /// How exact the sources of the trailer mass are.
    pub scales: Scales,
    /// The roads of the log. `None`: roll angles relative to gravity are taken as measured on
    /// public roads, roll angles relative to the road as measured on a flat test track.
    pub road: Option<RoadChoice>,
    /// What the messages say of the calibration. `None` without one.
    pub basis: Option<Basis>,
    /// The lean of a trailer whose load stands beside the middle.
    pub lean: Option<Lean>,
    /// The side of the trailer's body, and the wind on it. `None`: it is in no interval.
    #[serde(default)]
    pub side_wind: Option<SideWind>,
    /// What is done to samples before they are used; `None`: nothing.
    #[serde(default)]
    pub prepares: Option<Prepares>,
    /// Whether the place of the roll sensor matters and is not in the vehicle file.
    pub roll_sensor_is_unplaced: bool,
    /// The floor on which a load stands, if it is known.
    pub floor: Option<Floor>,
    /// Least and greatest roll angle of a second roll sensor over that of the first, if they are known.
    pub second_roll_slopes: Option<[f64; 2]>,
}

impl EstimateOptions {
    /// The same options with what follows from the vehicle: its scales, its lean, whether its roll sensor
    /// has a place, how two of them differ, the floor, and the roads of its file if no others are given.
    #[must_use]
    pub fn with_file(self, vehicle: &Vehicle) -> Self {
        let road = self.road.or_else(|| RoadChoice::of_vehicle(vehicle));
        // A vehicle without equations has no design either, and its error is that of the design.
        let lean = Lean::of(vehicle).ok();
        let roll_sensor_is_unplaced = has_unplaced_roll_sensor(vehicle);
        let (scales, floor) = (Scales::of(vehicle), Some(Floor::of(vehicle)));
        let second_roll_slopes = slopes(vehicle).unwrap_or_default();
        let side_wind = SideWind::of(vehicle).unwrap_or_default();
        Self {
            scales,
            road,
            lean,
            side_wind,
            prepares: Prepares::of(vehicle),
            roll_sensor_is_unplaced,
            floor,
            second_roll_slopes,
            ..self
        }
    }

    /// Standard deviations of the bank of the roads, rad, that a roll angle relative to gravity contains, and one relative to the
    /// road.
    pub fn bank_sds_rad(&self) -> [f64; 2] {
        let usual = Settings::<f64>::truck();
        let unknown = [usual.bank_sd_rad, usual.bank_sd_to_road_rad];
        self.road.map_or(unknown, |road| [road.bank_sd_rad; 2])
    }

    /// Whether the road may be twisted: unless it is flat.
    pub fn may_twist(&self) -> bool {
        self.road.is_none_or(|road| road.bank_sd_rad > 0.0)
    }

    /// What is said of a maneuver with these outcomes if the place of the roll sensor is missing.
    pub fn unplaced(&self, outcomes: &[Outcome<f64>; CHANNELS]) -> Option<&'static str> {
        let is_used =
            |channel: &Channel| channel.feels_bank() && outcomes[channel.index()].height_m.is_ok();
        (self.roll_sensor_is_unplaced && Channel::ALL.iter().any(is_used)).then_some(
            "the vehicle file does not say where the roll sensor is, so it counts as over the axles; on a \
             frame that twists, one further forward gives a wrong height, which the interval may miss: give \
             sensors.roll.behind_hitch_m",
        )
    }

    /// That nothing shows whether the lateral acceleration contains gravity, if these quantities have come. A calibration
    /// with the same sensor would contain what it does.
    pub fn unconfirmed(&self, has: impl Fn(Quantity) -> bool) -> Option<&'static str> {
        let is_alone = has(Quantity::LateralAcceleration) && !has(Quantity::YawRate);
        (is_alone && self.basis.is_none()).then_some(GRAVITY)
    }

    /// That a height, m, is unusual for a load, or that a load that makes a trailer of this mass, kg, would lie below the floor.
    pub fn unlike_load(&self, trailer_mass_kg: f64, height_m: f64) -> Vec<String> {
        let unusual = (height_m > USUAL_HEIGHT_M).then(|| {
            format!(
                "a height of {height_m:.2} m is unusual for a load (usually below {USUAL_HEIGHT_M} m); check the gain of the roll \
                 sensor, the trailer mass, and whether roll_rad is relative to the road (a bank makes a roll angle relative to \
                 gravity too great: roll_to_gravity_rad)"
            )
        });
        let sunk = self.floor.and_then(|floor| {
            let payload_m = floor.payload_height_m(trailer_mass_kg, height_m)?;
            (payload_m < floor.height_m).then(|| {
                format!(
                    "the load's own c.g. would be {payload_m:.2} m high, below the floor at {:.2} m on which it stands: the trailer \
                     mass is too great, or a sensor shows too little roll",
                    floor.height_m
                )
            })
        });
        unusual.into_iter().chain(sunk).collect()
    }

    /// That a trailer that is empty by its known mass, kg, has another height than that in the vehicle file.
    pub fn unlike_empty(&self, mass_kg: f64, height: Measured<f64>) -> Option<String> {
        let empty_m = self.floor?.empty_height_m(mass_kg, EMPTY_SHARE)?;
        let sd_m = libm::hypot(height.sd, EMPTY_SD_M);
        let [low_m, high_m] = interval_95(height);
        let differs = (height.value - empty_m).abs() > QUANTILE_95 * sd_m;
        differs.then(|| {
            format!(
                "by its mass the trailer is empty, with its c.g. at {empty_m:.2} m as the vehicle file says, but the turns \
                 say {:.2} m ({low_m:.2} to {high_m:.2} m): an axle is lifted, trailer or springs are others than in the file, or the gain of a \
                 sensor is wrong; heights of loads are then wrong, too",
                height.value
            )
        })
    }
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self {
            variant: Variant::Complete,
            method: Method::Filtered,
            order: 5,
            channel: None,
            speed_mps: None,
            trailer_mass_kg: None,
            trailer_mass_sd_kg: None,
            lift_axle: None,
            scales: Scales::EXACT,
            road: None,
            basis: None,
            lean: None,
            side_wind: None,
            prepares: None,
            roll_sensor_is_unplaced: false,
            floor: None,
            second_roll_slopes: None,
        }
    }
}
