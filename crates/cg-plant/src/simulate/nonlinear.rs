//! Runs the nonlinear plant through a scenario, steered by a steer history, by the driver on a path,
//! or by the driver on a road.

use super::on_road::RoadDriver;
use super::plant_run::{PlantInput, PlantRun};
use super::scenario::{Scenario, Track};
use super::weather::Weather;
use crate::maneuver::{Course, Histories};
use crate::plant::{Driver, DriverSettings, Ground, Path, PlantOptions, Simulation};
use crate::road::Road;
use crate::rollover::maneuver::{GATE_START_M, LANE_WIDTH_M};
use cg_logs::log::LogRow;
use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

/// The true rows of the plant, and the time of a rollover, if one happened and is allowed.
pub(super) struct Recorded {
    pub(super) rows: Vec<LogRow>,
    pub(super) track: Option<Track>,
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

/// Who steers.
enum Steering<'a> {
    /// A steer history, and the steer angle that keeps the truck straight in the wind.
    History(&'a Histories, f64),
    Path(Box<Driver>, f64),
    Road(Box<RoadDriver>),
}

impl Steering<'_> {
    /// What happens until a time, one step ahead.
    fn next(&mut self, run: &Simulation<'_>, until_s: f64, step_s: f64) -> PlantInput {
        let ground = Ground::default();
        match self {
            Self::History(histories, straight_rad) => PlantInput {
                steer_rad: *straight_rad + histories.steer_rad(until_s),
                speed_mps: histories.speed_mps(until_s),
                ground,
            },
            Self::Path(driver, speed_mps) => {
                PlantInput { steer_rad: driver.steer_rad(run), speed_mps: *speed_mps, ground }
            }
            Self::Road(driver) => driver.next(run, step_s),
        }
    }
}

/// A drive by a steer history, or along the course of the scenario.
pub(super) fn record(
    vehicle: &Vehicle,
    scenario: &Scenario,
    histories: &Histories,
    samples: u64,
) -> Result<Recorded, VehicleError> {
    let (payload_left_m, wind_mps) = (scenario.payload_left_m, Weather::new(scenario).mean_mps());
    let options = PlantOptions { wind_mps, payload_left_m, ..PlantOptions::default() };
    let run = PlantRun::of(vehicle, scenario.load, &options, histories.speed_mps(0.0))?;
    let plant = run.simulation().plant();
    let driver = |course| {
        Driver::new(plant, path(course, scenario), scenario.speed_mps, DriverSettings::default())
    };
    let mut steering = if let Some(course) = scenario.course {
        Steering::Path(Box::new(driver(course)?), scenario.speed_mps)
    } else {
        let held_rad = run.simulation().control().steer_rad;
        Steering::History(histories, if scenario.wind_mps > 0.0 { held_rad } else { 0.0 })
    };
    run_through(scenario, run.without_chassis(), &mut steering, samples)
}

/// A drive along a road that has a speed limit.
pub(super) fn record_on_road(
    vehicle: &Vehicle,
    scenario: &Scenario,
    road: &Road,
    samples: u64,
) -> Result<Recorded, VehicleError> {
    let driver = RoadDriver::new(vehicle, scenario.variant, scenario.load, road)?;
    let (speed_mps, Ground { bank_rad, grade_rad, .. }) = driver.start();
    let payload_left_m = scenario.payload_left_m;
    let wind_mps = Weather::new(scenario).mean_mps();
    let options =
        PlantOptions { bank_rad, grade_rad, wind_mps, payload_left_m, ..PlantOptions::default() };
    let run = PlantRun::of(vehicle, scenario.load, &options, speed_mps)?;
    run_through(scenario, run, &mut Steering::Road(Box::new(driver)), samples)
}

fn run_through(
    scenario: &Scenario,
    mut run: PlantRun,
    steering: &mut Steering<'_>,
    samples: u64,
) -> Result<Recorded, VehicleError> {
    let track = matches!(steering, Steering::Road(_)).then(Track::default);
    let mut weather = Weather::new(scenario);
    let mut recorded = Recorded { rows: Vec::new(), track, rolled_over_s: None };
    for k in 0..samples {
        #[allow(clippy::cast_precision_loss)]
        let time_s = k as f64 / scenario.rate_hz;
        if k > 0 {
            // The steer history is evaluated at each step of the plant, not interpolated between samples.
            let interval_s = time_s - run.simulation().time_s();
            run.blow(weather.next_mps(interval_s));
            run.drive(interval_s, |run, until_s, step_s| steering.next(run, until_s, step_s))?;
            if let Err(rolled) = run.simulation().upright() {
                if scenario.to_rollover {
                    recorded.rolled_over_s = Some(run.simulation().time_s());
                    break;
                }
                return Err(rolled);
            }
        }
        let sample = run.sample();
        recorded.rows.push(run.row(time_s, &sample));
        if let (Steering::Road(driver), Some(track)) = (&*steering, &mut recorded.track) {
            track.push(time_s, driver.distance_m(), &sample);
        }
    }
    Ok(recorded)
}
