//! Scenarios as Python passes them: the dataclasses of `cgheight._scenario`.

use std::path::PathBuf;

use cg_plant::maneuver::{Course, Maneuver};
use cg_plant::road::Road;
use cg_plant::sensors::{ChassisSensors, Sensors};
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::{Load, Vehicle, VehicleError, limits};
use pyo3::prelude::*;

use crate::error::{value_error, vehicle_error};
use crate::options::{text, up_to, word};

/// `cgheight.Scenario`.
#[derive(FromPyObject)]
pub(crate) struct Request {
    #[pyo3(from_py_with = text_if_given)]
    maneuver: Option<String>,
    road: Option<PathBuf>,
    road_twist: bool,
    chassis: ChassisRequest,
    #[pyo3(from_py_with = text)]
    plant: String,
    #[pyo3(from_py_with = text)]
    model: String,
    height_m: Option<f64>,
    trailer_mass_kg: Option<f64>,
    payload_kg: Option<f64>,
    payload_behind_hitch_m: Option<f64>,
    payload_left_m: f64,
    wind_mps: f64,
    wind_from_rad: f64,
    speed_mps: Option<f64>,
    steer_rad: Option<f64>,
    rate_hz: f64,
    start_s: f64,
    duration_s: Option<f64>,
    step_rate_per_s: Option<f64>,
    turn_rad: Option<f64>,
    radius_m: Option<f64>,
    gate_m: Option<f64>,
    speed_change: Option<f64>,
    to_rollover: bool,
    sensors: SensorRequest,
    seed: u64,
}

/// `cgheight.Sensors`.
#[derive(FromPyObject)]
struct SensorRequest {
    snr_db: Option<f64>,
    noise_lag_s: f64,
    steer_noise_rad: f64,
    lateral_noise_mps2: f64,
    steer_play_rad: f64,
    roll_limit_rad: Option<f64>,
    roll_offset_rad: f64,
    steer_offset_rad: f64,
    quantisation_rad: f64,
    delay_s: f64,
    inclinometer: bool,
    jitter_s: f64,
    drop_out: f64,
    steering_wheel: bool,
}

/// `cgheight.ChassisSensors`.
#[derive(FromPyObject)]
struct ChassisRequest {
    level_offset_m: f64,
    level_noise_m: f64,
    level_quantisation_m: f64,
    accelerometer_offset_mps2: f64,
    accelerometer_noise_mps2: f64,
    accelerometer_quantisation_mps2: f64,
    tilt_offset_rad: f64,
    tilt_noise_rad: f64,
    tilt_quantisation_rad: f64,
    mounting_rad: f64,
}

fn text_if_given(value: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    if value.is_none() { Ok(None) } else { text(value).map(Some) }
}

impl Request {
    /// Whether it is a drive on a road.
    pub(crate) fn is_on_road(&self) -> bool {
        self.road.is_some()
    }

    /// Simulates the scenario.
    pub(crate) fn simulation(&self, py: Python<'_>, vehicle: &Vehicle) -> PyResult<LogSimulation> {
        let scenario = self.scenario(vehicle)?;
        let Some(name) = &self.road else {
            return py.detach(|| LogSimulation::new(vehicle, scenario)).map_err(vehicle_error);
        };
        let chassis = self.chassis.sensors();
        let run = || -> Result<LogSimulation, VehicleError> {
            let road = Road::named(name, self.seed)?;
            let road = if self.road_twist { road.twisted() } else { road };
            let road = match self.speed_mps {
                Some(speed_mps) => road.limited_to(speed_mps),
                None => road,
            };
            let usual_s = scenario.usual_duration_on_s(&road);
            let duration_s = self.duration_s.unwrap_or(usual_s);
            LogSimulation::on_road(vehicle, Scenario { duration_s, ..scenario }, &road, &chassis)
        };
        py.detach(run).map_err(vehicle_error)
    }

    /// The scenario for a vehicle, without its road. Absent values are those of the vehicle, or the
    /// defaults.
    pub(crate) fn scenario(&self, vehicle: &Vehicle) -> PyResult<Scenario> {
        let maneuver = match &self.maneuver {
            Some(maneuver) => word("maneuver", maneuver)?,
            None => Maneuver::Drive,
        };
        let usual = Scenario::of(vehicle, maneuver);
        let scenario = Scenario {
            course: self.course(usual.maneuver)?,
            step_rate_per_s: self.step_rate_per_s.unwrap_or(usual.step_rate_per_s),
            to_rollover: self.to_rollover,
            plant: word("plant", &self.plant)?,
            variant: word("model", &self.model)?,
            load: load(vehicle, self.height_m, self.trailer_mass_kg, self.payload_kg)?,
            payload_behind_hitch_m: self
                .payload_behind_hitch_m
                .unwrap_or(usual.payload_behind_hitch_m),
            payload_left_m: self.payload_left_m,
            wind_mps: self.wind_mps,
            wind_from_rad: self.wind_from_rad,
            speed_mps: self.speed_mps.unwrap_or(usual.speed_mps),
            steer_rad: self.steer_rad,
            rate_hz: self.rate_hz,
            start_s: self.start_s,
            sensors: self.sensors.sensors(),
            seed: self.seed,
            ..usual
        };
        Ok(Scenario {
            speed_change: self.speed_change.unwrap_or_else(|| scenario.usual_speed_change()),
            duration_s: self.duration_s.unwrap_or_else(|| scenario.usual_duration_s()),
            ..scenario
        })
    }

    fn course(&self, maneuver: Maneuver) -> PyResult<Option<Course>> {
        let turn = self.turn_rad.is_some() || self.radius_m.is_some();
        match (maneuver, turn, self.gate_m) {
            (_, false, None) => Ok(None),
            (Maneuver::SteadyTurn, true, None) => Ok(Some(Course::Turn {
                angle_rad: self.turn_rad.unwrap_or(std::f64::consts::FRAC_PI_2),
                radius_m: self.radius_m.unwrap_or(100.0),
            })),
            (Maneuver::LaneChange, false, Some(gate_m)) => Ok(Some(Course::Gate { gate_m })),
            _ => Err(value_error(
                "turn_rad and radius_m are for maneuver \"steady-turn\", gate_m for \"lane-change\"",
            )),
        }
    }
}

/// The load that the keywords of these names say; absent values are those of the vehicle.
pub(crate) fn load(
    vehicle: &Vehicle,
    height_m: Option<f64>,
    trailer_mass_kg: Option<f64>,
    payload_kg: Option<f64>,
) -> PyResult<Load> {
    if trailer_mass_kg.is_some() && payload_kg.is_some() {
        return Err(value_error("trailer_mass_kg and payload_kg are both given: give one"));
    }
    let greatest_kg = limits::GREATEST_TRAILER_MASS_KG;
    let trailer_mass_kg = up_to("trailer_mass_kg", trailer_mass_kg, greatest_kg)?;
    let height_m = up_to("height_m", height_m, limits::GREATEST_HEIGHT_M)?;
    if let Some(payload_kg) = payload_kg.filter(|payload_kg| !(*payload_kg >= 0.0)) {
        return Err(value_error(format!("payload_kg is {payload_kg}: it must be zero or more")));
    }
    let payload = payload_kg.map(|payload| vehicle.empty_trailer_mass_kg() + payload);
    Ok(vehicle.load_of(trailer_mass_kg.or(payload), height_m))
}

impl ChassisRequest {
    fn sensors(&self) -> ChassisSensors {
        ChassisSensors {
            level_offset_m: self.level_offset_m,
            level_noise_m: self.level_noise_m,
            level_quantisation_m: self.level_quantisation_m,
            accelerometer_offset_mps2: self.accelerometer_offset_mps2,
            accelerometer_noise_mps2: self.accelerometer_noise_mps2,
            accelerometer_quantisation_mps2: self.accelerometer_quantisation_mps2,
            tilt_offset_rad: self.tilt_offset_rad,
            tilt_noise_rad: self.tilt_noise_rad,
            tilt_quantisation_rad: self.tilt_quantisation_rad,
            mounting_rad: self.mounting_rad,
        }
    }
}

impl SensorRequest {
    fn sensors(&self) -> Sensors {
        Sensors {
            snr_db: self.snr_db,
            noise_lag_s: self.noise_lag_s,
            steer_noise_rad: self.steer_noise_rad,
            lateral_noise_mps2: self.lateral_noise_mps2,
            steer_play_rad: self.steer_play_rad,
            roll_limit_rad: self.roll_limit_rad,
            roll_offset_rad: self.roll_offset_rad,
            steer_offset_rad: self.steer_offset_rad,
            quantisation_rad: self.quantisation_rad,
            delay_s: self.delay_s,
            inclinometer: self.inclinometer,
            jitter_s: self.jitter_s,
            drop_out: self.drop_out,
            steering_wheel: self.steering_wheel,
        }
    }
}
