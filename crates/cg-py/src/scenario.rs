//! Scenarios as Python passes them: the dataclasses of `cgheight._scenario`.

use cg_plant::maneuver::{Course, Maneuver};
use cg_plant::sensors::Sensors;
use cg_plant::simulate::Scenario;
use cg_vehicle::{Load, Vehicle};
use pyo3::prelude::*;

use crate::error::value_error;
use crate::options::word;

/// `cgheight.Scenario`.
#[derive(FromPyObject)]
pub(crate) struct Request {
    maneuver: String,
    plant: String,
    model: String,
    height_m: Option<f64>,
    trailer_mass_kg: Option<f64>,
    payload_kg: Option<f64>,
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

impl Request {
    /// The scenario for a vehicle. Absent values are those of the vehicle, or the defaults.
    pub(crate) fn scenario(&self, vehicle: &Vehicle) -> PyResult<Scenario> {
        let usual = Scenario::of(vehicle, word("maneuver", &self.maneuver)?);
        let scenario = Scenario {
            course: self.course(usual.maneuver)?,
            step_rate_per_s: self.step_rate_per_s.unwrap_or(usual.step_rate_per_s),
            to_rollover: self.to_rollover,
            plant: word("plant", &self.plant)?,
            variant: word("model", &self.model)?,
            load: self.load(vehicle)?,
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

    fn load(&self, vehicle: &Vehicle) -> PyResult<Load> {
        if self.trailer_mass_kg.is_some() && self.payload_kg.is_some() {
            return Err(value_error("trailer_mass_kg and payload_kg are both given: give one"));
        }
        let reference = vehicle.reference_load();
        let payload = self.payload_kg.map(|payload| vehicle.empty_trailer_mass_kg() + payload);
        Ok(Load {
            trailer_mass_kg: self.trailer_mass_kg.or(payload).unwrap_or(reference.trailer_mass_kg),
            cg_height_m: self.height_m.unwrap_or(reference.cg_height_m),
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
