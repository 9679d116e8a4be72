//! What to simulate, and what is true of it.

use std::borrow::Cow;

use serde::Serialize;

use crate::maneuver::{Course, Histories, Maneuver};
use crate::plant::{PlantSample, check_payload_left};
use crate::road::Road;
use crate::sensors::{ChassisSensors, Sensors};
use cg_vehicle::error::VehicleError;
use cg_vehicle::limits;
use cg_vehicle::{Load, Variant, Vehicle};

/// Time after a driver's path in which the trailer settles.
const AFTER_S: f64 = 5.0;
/// Default of the greatest share by which the speed of a drive of the nonlinear plant changes.
const USUAL_SPEED_CHANGE: f64 = 0.3;

/// Interval of a track.
const TRACK_INTERVAL_S: f64 = 0.1;

/// The simulated model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Plant {
    /// The linear model in full.
    Linear,
    /// The reduced 5th-order models of roll; lateral acceleration and yaw rate stay steady-state.
    Reduced,
    /// The nonlinear yaw/roll plant.
    Nonlinear,
}

cg_core::words!(Plant {
    Linear => "linear", "The linear model in full";
    Reduced => "reduced", "The reduced 5th-order model";
    Nonlinear => "nonlinear", "The nonlinear yaw/roll plant, springs and tyres as the vehicle file has them";
});

/// Whether the payload is not where the vehicle file says.
fn is_moved(vehicle: &Vehicle, behind_hitch_m: f64) -> bool {
    (behind_hitch_m - vehicle.trailer.payload.behind_hitch_m).abs() > 0.0
}

/// The vehicle with the payload of this load at a distance behind the fifth wheel.
pub(super) fn with_payload_at(
    vehicle: &Vehicle,
    load: Load,
    behind_hitch_m: f64,
) -> Result<Cow<'_, Vehicle>, VehicleError> {
    let greatest_m = limits::GREATEST_PAYLOAD_BEHIND_HITCH_M;
    limits::positive("⟨payload_behind_hitch_m⟩", behind_hitch_m, greatest_m)?;
    if is_moved(vehicle, behind_hitch_m) {
        return vehicle.with_payload_at(load, behind_hitch_m).map(Cow::Owned);
    }
    Ok(Cow::Borrowed(vehicle))
}

/// What to simulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenario {
    /// The steer history.
    pub maneuver: Maneuver,
    /// The path that the preview driver follows instead of the steer history; nonlinear plant only.
    pub course: Option<Course>,
    /// Rate `a` of rounded steps (eq. 5.3), 1/s.
    pub step_rate_per_s: f64,
    /// Greatest share by which the speed of a [`Maneuver::Drive`] changes; not in the reduced plant.
    pub speed_change: f64,
    /// Whether the log may end where the vehicle rolls over; nonlinear plant only.
    pub to_rollover: bool,
    /// The simulated model.
    pub plant: Plant,
    /// Equations of the model.
    pub variant: Variant,
    /// The trailer's load.
    pub load: Load,
    /// Distance of the payload's c.g. behind the fifth wheel.
    pub payload_behind_hitch_m: f64,
    /// Distance of the payload's c.g. to the left of the middle. The linear models lean by it.
    pub payload_left_m: f64,
    /// Mean speed of the wind on the trailer's body; nonlinear plant only, and `[wind]` of the vehicle file describes the body.
    pub wind_mps: f64,
    /// Where the wind comes from: 0 from ahead, π/2 from the left at the start.
    pub wind_from_rad: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// Road-wheel amplitude; `None` for 0.17 g.
    pub steer_rad: Option<f64>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Straight driving before the maneuver.
    pub start_s: f64,
    /// Length of the log.
    pub duration_s: f64,
    /// The sensors and their errors.
    pub sensors: Sensors,
    /// Seed of sensors and drive.
    pub seed: u64,
}

impl Scenario {
    /// A maneuver of the linear model with the load and speed of the vehicle file: 20 s (a drive
    /// 300 s) at 100 Hz, 2 s straight, perfect sensors.
    pub fn of(vehicle: &Vehicle, maneuver: Maneuver) -> Self {
        Self {
            maneuver,
            course: None,
            step_rate_per_s: Histories::STEP_RATE_PER_S,
            speed_change: 0.0,
            to_rollover: false,
            plant: Plant::Linear,
            variant: Variant::Complete,
            load: vehicle.reference_load(),
            payload_behind_hitch_m: vehicle.trailer.payload.behind_hitch_m,
            payload_left_m: 0.0,
            wind_mps: 0.0,
            wind_from_rad: 0.0,
            speed_mps: vehicle.nominal_speed_mps,
            steer_rad: None,
            rate_hz: 100.0,
            start_s: 2.0,
            duration_s: if maneuver == Maneuver::Drive { 300.0 } else { 20.0 },
            sensors: Sensors::default(),
            seed: 1,
        }
    }

    /// The default length: as long as a driver's path takes, otherwise the present one.
    pub fn usual_duration_s(&self) -> f64 {
        self.course.map_or(self.duration_s, |course| {
            self.start_s + course.length_m() / self.speed_mps + AFTER_S
        })
    }

    /// The default length of a drive on a road.
    pub fn usual_duration_on_s(&self, road: &Road) -> f64 {
        if road.has_speed() {
            road.usual_duration_s()
        } else {
            road.clone().limited_to(self.speed_mps).usual_duration_s()
        }
    }

    /// The default speed change: some in a drive of the nonlinear plant, otherwise none.
    pub fn usual_speed_change(&self) -> f64 {
        let changes = self.maneuver == Maneuver::Drive && self.plant == Plant::Nonlinear;
        if changes { USUAL_SPEED_CHANGE } else { 0.0 }
    }

    /// The vehicle with the payload where it is.
    pub(super) fn loaded<'a>(
        &self,
        vehicle: &'a Vehicle,
    ) -> Result<Cow<'a, Vehicle>, VehicleError> {
        with_payload_at(vehicle, self.load, self.payload_behind_hitch_m)
    }

    fn check_place(&self, vehicle: &Vehicle) -> Result<(), VehicleError> {
        let refuse = |text: String| Err(VehicleError::Model(text));
        let is_printed = self.variant == Variant::AsPrinted && self.plant != Plant::Nonlinear;
        if is_printed && is_moved(vehicle, self.payload_behind_hitch_m) {
            return refuse("⟨payload_behind_hitch_m⟩ needs ⟨model complete⟩".into());
        }
        if is_printed && !(self.payload_left_m.abs() <= 0.0) {
            return refuse("⟨payload_left_m⟩ needs ⟨model complete⟩".into());
        }
        check_payload_left(vehicle, self.payload_left_m)
    }

    fn check_wind(&self, vehicle: &Vehicle) -> Result<(), VehicleError> {
        let refuse = |text: String| Err(VehicleError::Model(text));
        if !((0.0..=limits::GREATEST_WIND_MPS).contains(&self.wind_mps)
            && self.wind_from_rad.is_finite())
        {
            return refuse(format!(
                "⟨wind_mps⟩ {} must lie between 0 and {}, and ⟨wind_from_rad⟩ must be a number",
                self.wind_mps,
                limits::GREATEST_WIND_MPS
            ));
        }
        if self.wind_mps > 0.0 && self.plant != Plant::Nonlinear {
            return refuse("⟨wind_mps⟩ needs ⟨plant nonlinear⟩".into());
        }
        if self.wind_mps > 0.0 && vehicle.wind.is_none() {
            return refuse(
                "⟨wind_mps⟩: the vehicle file has no [wind], which says how large the side of the body is; add it".into(),
            );
        }
        Ok(())
    }

    fn check_steer(&self) -> Result<(), VehicleError> {
        let greatest_rad = limits::GREATEST_STEER_RAD;
        match self.steer_rad {
            Some(steer_rad) if !(steer_rad.abs() <= greatest_rad) => {
                Err(VehicleError::Model(format!(
                    "⟨steer_rad⟩ {steer_rad} must lie between {} and {greatest_rad}",
                    -greatest_rad
                )))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn check(&self, vehicle: &Vehicle) -> Result<(), VehicleError> {
        let refuse = |text: String| Err(VehicleError::Model(text));
        self.load.check()?;
        self.check_place(vehicle)?;
        self.check_steer()?;
        self.check_wind(vehicle)?;
        limits::positive("⟨speed_mps⟩", self.speed_mps, limits::GREATEST_SPEED_MPS)?;
        limits::positive("⟨rate_hz⟩", self.rate_hz, limits::GREATEST_RATE_HZ)?;
        limits::positive("⟨duration_s⟩", self.duration_s, limits::GREATEST_DURATION_S)?;
        limits::positive(
            "⟨step_rate_per_s⟩",
            self.step_rate_per_s,
            limits::GREATEST_STEP_RATE_PER_S,
        )?;
        if self.duration_s * self.rate_hz > limits::GREATEST_ROWS {
            return refuse(format!(
                "⟨duration_s⟩ {} at ⟨rate_hz⟩ {} makes more than {:e} rows: reduce one of them",
                self.duration_s,
                self.rate_hz,
                limits::GREATEST_ROWS
            ));
        }
        if !(self.start_s >= 0.0 && self.start_s < self.duration_s) {
            return refuse(format!(
                "⟨start_s⟩ {} must lie between 0 and ⟨duration_s⟩ {}",
                self.start_s, self.duration_s
            ));
        }
        if self.plant != Plant::Nonlinear && (self.course.is_some() || self.to_rollover) {
            return refuse(
                "a path to follow (⟨turn_rad⟩, ⟨radius_m⟩, ⟨gate_m⟩) and ⟨to_rollover⟩ need \
                 ⟨plant nonlinear⟩"
                    .into(),
            );
        }
        if !(0.0..=0.5).contains(&self.speed_change) {
            return refuse(format!(
                "⟨speed_change⟩ {} must lie between 0 and 0.5",
                self.speed_change
            ));
        }
        let changes = self.speed_change > 0.0;
        if changes && (self.maneuver != Maneuver::Drive || self.plant == Plant::Reduced) {
            return refuse(
                "⟨speed_change⟩ is for ⟨maneuver drive⟩, with ⟨plant linear⟩ or nonlinear".into(),
            );
        }
        if self.sensors.steering_wheel && vehicle.steering_ratio.is_none() {
            return refuse(
                "⟨steering_wheel⟩: the vehicle file has no steering_ratio; add one".into(),
            );
        }
        self.sensors.check(self.rate_hz)
    }
}

/// The truth of a simulated log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Truth {
    /// Name of the vehicle.
    pub vehicle: String,
    /// C.g. height of the trailer's sprung mass.
    pub height_m: f64,
    /// Mass of the whole semitrailer.
    pub trailer_mass_kg: f64,
    /// Distance of the payload's c.g. behind the fifth wheel.
    pub payload_behind_hitch_m: f64,
    /// Distance of the payload's c.g. to the left of the middle.
    pub payload_left_m: f64,
    /// Mean speed of the wind.
    pub wind_mps: f64,
    /// Where it comes from, to the first direction of travel.
    pub wind_from_rad: f64,
    /// Forward speed (of a drive: the speed about which it varies).
    pub speed_mps: f64,
    /// Steer amplitude (of a driver: the greatest).
    pub steer_rad: f64,
    /// DC ratio of roll to steer of the linear model.
    pub ratio: f64,
    /// Standard deviation of the noise on the roll angle.
    pub noise_sd_rad: f64,
    /// Everything else that the sensors added.
    #[serde(flatten)]
    pub sensors: Sensors,
    /// The road, if it is not flat and straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub road: Option<RoadTruth>,
    /// What the sensors of the chassis added.
    #[serde(flatten)]
    pub chassis: Option<ChassisSensors>,
    /// Time of the rollover, if there was one.
    pub rolled_over_s: Option<f64>,
    /// Seed.
    pub seed: u64,
}

impl Truth {
    /// Without noise, road and rollover. The vehicle is that of [`Scenario::loaded`].
    pub(super) fn of(vehicle: &Vehicle, scenario: &Scenario, steer_rad: f64, ratio: f64) -> Self {
        Self {
            vehicle: vehicle.name.clone(),
            height_m: scenario.load.cg_height_m,
            trailer_mass_kg: scenario.load.trailer_mass_kg,
            payload_behind_hitch_m: vehicle.trailer.payload.behind_hitch_m,
            payload_left_m: scenario.payload_left_m,
            wind_mps: scenario.wind_mps,
            wind_from_rad: scenario.wind_from_rad,
            speed_mps: scenario.speed_mps,
            steer_rad,
            ratio,
            noise_sd_rad: 0.0,
            sensors: scenario.sensors,
            road: None,
            chassis: None,
            rolled_over_s: None,
            seed: scenario.seed,
        }
    }
}

/// The road of a simulated log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RoadTruth {
    /// Its kind, or the name of its file.
    pub name: String,
    /// Distance driven.
    pub driven_m: f64,
    /// The least and the greatest bank on the way, left side higher positive.
    pub bank_rad: [f64; 2],
    /// Whether every axle stood on the bank of its own place.
    pub is_twisted: bool,
}

/// Where the vehicle was on the road, about ten times a second.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Track {
    /// Time of the log.
    pub time_s: Vec<f64>,
    /// Distance of the front axle along the road.
    pub distance_m: Vec<f64>,
    /// Bank of the road under the vehicle, left side higher positive.
    pub bank_rad: Vec<f64>,
    /// Yaw rate of the tractor, which a log does not have.
    pub tractor_yaw_rate_radps: Vec<f64>,
}

impl Track {
    pub(super) fn push(&mut self, time_s: f64, distance_m: f64, sample: &PlantSample) {
        if self.time_s.last().is_none_or(|last_s| time_s - last_s > TRACK_INTERVAL_S - 1e-9) {
            self.time_s.push(time_s);
            self.distance_m.push(distance_m);
            self.bank_rad.push(sample.bank_rad);
            self.tractor_yaw_rate_radps.push(sample.tractor.yaw_rate_radps);
        }
    }
}

/// The vehicle at a sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    pub(super) steer_rad: f64,
    pub(super) speed_mps: f64,
    pub(super) roll_rad: f64,
    /// Those of the front and the rear half of the trailer.
    pub(super) halves_roll_rad: [f64; 2],
    pub(super) lateral_acceleration_mps2: f64,
    pub(super) yaw_rate_radps: f64,
}
