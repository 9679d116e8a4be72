//! Places and gains of the sensors of a vehicle, and its roads: optional parts of the vehicle file.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

/// Places of sensors on tractor and trailer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct SensorPlaces {
    /// The sensor of the trailer's roll angle; only a frame that twists needs its place.
    #[serde(default)]
    pub roll: RollSensor,
    /// The lateral accelerometer or inclinometer on the trailer's frame.
    #[serde(default)]
    pub accelerometer: TrailerAccelerometer,
    /// Level sensors on the left and the right side of the trailer's axles.
    #[serde(default)]
    pub level: Option<LevelSensors>,
    /// The lateral accelerometer or inclinometer on the tractor's frame.
    #[serde(default)]
    pub tractor_accelerometer: TractorAccelerometer,
    /// Level sensors on the left and the right side of the tractor's drive axles.
    #[serde(default)]
    pub tractor_level: Option<LevelSensors>,
    /// Calibration of the pressure in the air suspension of the tractor's drive axles; without it
    /// that pressure is not used. The load is that of the drive axles on the road.
    #[serde(default)]
    pub drive_pressure: Option<SuspensionPressure>,
    /// The sensor of the yaw rate; without it, where it is follows from the log or the bus.
    #[serde(default)]
    pub yaw_rate: Option<YawRateSensor>,
    /// How exact the sources of the trailer mass are; without it they are as exact as usual.
    #[serde(default)]
    pub mass: Option<MassUncertainty>,
}

impl SensorPlaces {
    /// Whether the sensor of the yaw rate is on the tractor, if the vehicle file says it.
    pub fn yaw_rate_on_tractor(&self) -> Option<bool> {
        self.yaw_rate.map(|sensor| sensor.on_tractor)
    }

    /// The same on a bus, which has the yaw rate of the tractor, unless the vehicle file says whose it is.
    #[must_use]
    pub fn on_bus(self) -> Self {
        if self.yaw_rate.is_some() { self } else { self.with_tractor_yaw() }
    }

    /// The same with the yaw rate of the tractor.
    #[must_use]
    pub fn with_tractor_yaw(self) -> Self {
        Self { yaw_rate: Some(YawRateSensor { on_tractor: true }), ..self }
    }
}

/// Standard deviations of the trailer mass, for each source of it. Those of sensors are relative to the
/// load that the sensor measures.
///
/// The usual one of axle scales follows from a test of three of them in service for half a year: 38 % of
/// the axles within 2 %, which are 4 % for a normal distribution (TRRL Research Report 103, 1987).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct MassUncertainty {
    /// Of a mass that is given, or in a log's column of the trailer mass; 0 is exact.
    #[serde(default)]
    pub weighed_sd_kg: f64,
    /// Of the trailer's weight on the bus (VW).
    #[serde(default = "usual_vehicle_weight_sd")]
    pub vehicle_weight_sd: f64,
    /// Of the load of the trailer's axles (EBS22).
    #[serde(default = "usual_axle_load_sd")]
    pub axle_load_sd: f64,
    /// Of a load of axles that follows from the pressure in their air suspension.
    #[serde(default = "usual_pressure_sd")]
    pub pressure_sd: f64,
}

impl Default for MassUncertainty {
    fn default() -> Self {
        Self {
            weighed_sd_kg: 0.0,
            vehicle_weight_sd: usual_vehicle_weight_sd(),
            axle_load_sd: usual_axle_load_sd(),
            pressure_sd: usual_pressure_sd(),
        }
    }
}

fn usual_vehicle_weight_sd() -> f64 {
    0.05
}

fn usual_axle_load_sd() -> f64 {
    0.04
}

fn usual_pressure_sd() -> f64 {
    0.05
}

/// Places of the sensors of the trailer's roll angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RollSensor {
    /// Distance behind the fifth wheel; if absent, the sensor is over the axles.
    #[serde(default)]
    pub behind_hitch_m: Option<f64>,
    /// The same of a second sensor.
    #[serde(default)]
    pub second_behind_hitch_m: Option<f64>,
    /// Share of the second sensor in the roll angle, if it has a column of its own in the log; if absent,
    /// the log has the mean of both (see [`crate::second_sensor`]).
    #[serde(default)]
    pub second_share: Option<f64>,
}

impl RollSensor {
    /// Whether the log has the mean of two sensors as one roll angle.
    pub fn is_mean_of_two(&self) -> bool {
        self.second_behind_hitch_m.is_some() && self.second_share.is_none()
    }

    /// Distances of the sensors behind the fifth wheel, infinite over the axles, with their shares in the
    /// roll angle.
    pub(crate) fn places_m(&self) -> impl Iterator<Item = (f64, f64)> {
        let first_m = self.behind_hitch_m.unwrap_or(f64::INFINITY);
        let second = self.second_behind_hitch_m.map(|m| (m, self.second_share.unwrap_or(0.5)));
        let others: f64 = second.iter().map(|(_, share)| share).sum();
        std::iter::once((first_m, 1.0 - others)).chain(second)
    }
}

/// The sensor of the yaw rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct YawRateSensor {
    /// Whether it is on the tractor.
    pub on_tractor: bool,
}

/// Place of the accelerometer on the trailer.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TrailerAccelerometer {
    /// Distance behind the fifth wheel; if absent, the middle of the axles.
    #[serde(default)]
    pub behind_hitch_m: Option<f64>,
    /// Height.
    #[serde(default = "frame_height")]
    pub height_m: f64,
}

/// Place of the accelerometer on the tractor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TractorAccelerometer {
    /// Distance ahead of the sprung c.g.; if absent, the middle of the drive axles.
    #[serde(default)]
    pub ahead_of_cg_m: Option<f64>,
    /// Height.
    #[serde(default = "frame_height")]
    pub height_m: f64,
}

/// A pair of level sensors, or the mean of several pairs.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LevelSensors {
    /// Lateral distance between the left and the right sensor.
    pub spread_m: f64,
    /// True change of the level divided by the measured one.
    #[serde(default = "one")]
    pub gain: f64,
}

impl LevelSensors {
    /// Suspension roll angle per difference of the levels, rad/m.
    pub fn roll_per_difference(&self) -> f64 {
        self.gain / self.spread_m
    }
}

/// The roads on which a vehicle drives.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Road {
    /// Standard deviation of their bank in curves: 0 on a flat test track, 0.02 on public roads.
    pub bank_sd_rad: f64,
}

impl Default for TrailerAccelerometer {
    fn default() -> Self {
        Self { behind_hitch_m: None, height_m: frame_height() }
    }
}

impl Default for TractorAccelerometer {
    fn default() -> Self {
        Self { ahead_of_cg_m: None, height_m: frame_height() }
    }
}

fn frame_height() -> f64 {
    1.0
}

fn one() -> f64 {
    1.0
}

/// Two readings of a gauge on an air suspension, for instance empty and laden on a
/// weighbridge. The load of the axles is linear in the pressure (area of the bellows, lever of the
/// arms).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SuspensionPressure {
    /// Gauge pressure (above atmospheric), mean of both sides.
    #[serde(deserialize_with = "two")]
    pub gauge_pa: [f64; 2],
    /// Load of the axles on the road.
    #[serde(deserialize_with = "two")]
    pub axle_load_kg: [f64; 2],
}

/// Two numbers and no more, of which an array would take the first ones.
fn two<'de, D: Deserializer<'de>>(source: D) -> Result<[f64; 2], D::Error> {
    let numbers = Vec::<f64>::deserialize(source)?;
    <[f64; 2]>::try_from(numbers).map_err(|numbers| {
        D::Error::custom(format!(
            "{} numbers: a line needs two readings, so give the two that are farthest apart",
            numbers.len()
        ))
    })
}
