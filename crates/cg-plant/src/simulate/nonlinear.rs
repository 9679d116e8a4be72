//! Runs the nonlinear plant through a scenario, steered by a steer history or by the driver.

use super::scenario::{Motion, Scenario};
use crate::maneuver::{Course, Histories};
use crate::plant::{Driver, DriverSettings, Path, PlantOptions, YawRollPlant};
use crate::rollover::maneuver::{GATE_START_M, LANE_WIDTH_M};
use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

/// The motions of the plant, sample by sample, and the time of a rollover, if one happened and is
/// allowed.
pub(super) struct Recorded {
    pub(super) motions: Vec<Motion>,
    pub(super) rolled_over_s: Option<f64>,
}

fn path(course: Course, scenario: &Scenario) -> Path {
    let start_m = scenario.start_s * scenario.speed_mps;
    match course {
        Course::Gate { gate_m } => Path::lane_change(start_m + GATE_START_M, gate_m, LANE_WIDTH_M),
        Course::Turn { angle_rad, radius_m } => {
            let radius_m = radius_m.copysign(angle_rad);
            Path::turn(start_m, radius_m, angle_rad)
        }
    }
}

pub(super) fn record(
    vehicle: &Vehicle,
    scenario: &Scenario,
    histories: &Histories,
    samples: u64,
) -> Result<Recorded, VehicleError> {
    let plant = YawRollPlant::new(vehicle, scenario.load, &PlantOptions::default())?;
    let mut run = plant.start(histories.speed_mps(0.0))?;
    let driver = |course| {
        Driver::new(&plant, path(course, scenario), scenario.speed_mps, DriverSettings::default())
    };
    let mut driver = scenario.course.map(driver).transpose()?;
    let mut recorded = Recorded { motions: Vec::new(), rolled_over_s: None };
    for k in 0..samples {
        if k > 0 {
            // The steer history is evaluated at each step of the plant, not interpolated between samples.
            #[allow(clippy::cast_precision_loss)]
            let time_s = k as f64 / scenario.rate_hz;
            let interval_s = time_s - run.time_s();
            let steps = (interval_s / plant.step_s()).ceil().max(1.0);
            let start_s = run.time_s();
            let mut done = 0.0;
            while done < steps {
                done += 1.0;
                let now_s = start_s + interval_s * done / steps;
                let steer_rad = match &mut driver {
                    Some(driver) => driver.steer_rad(&run),
                    None => histories.steer_rad(now_s),
                };
                run.push(steer_rad, histories.speed_mps(now_s), interval_s / steps);
            }
            if let Err(rolled) = run.upright() {
                if scenario.to_rollover {
                    recorded.rolled_over_s = Some(run.time_s());
                    break;
                }
                return Err(rolled);
            }
        }
        let sample = run.sample();
        recorded.motions.push(Motion {
            steer_rad: sample.steer_rad,
            speed_mps: sample.speed_mps,
            roll_rad: sample.trailer.roll_rad,
            lateral_acceleration_mps2: sample.trailer.lateral_acceleration_mps2,
            yaw_rate_radps: sample.trailer.yaw_rate_radps,
        });
    }
    Ok(recorded)
}
