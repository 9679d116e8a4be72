//! `cg simulate`: writes simulated logs with known truth.

use std::path::Path;

use anyhow::{Context, anyhow, bail};
use cg_logs::log::{CandumpWriter, LogRow, LogWriter, Signal};
use cg_output::{Draft, Files, Kind, Target};
use cg_plant::maneuver::{Course, Histories, Maneuver};
use cg_plant::road::{Road, RoadKind};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::Vehicle;
use cg_vehicle::lift::LiftAxle;

use crate::cli::SimulateArgs;
use crate::outcome::{Outcome, print_error};
use crate::truck;

fn course(arguments: &SimulateArgs) -> anyhow::Result<Option<Course>> {
    let turn = arguments.turn_deg.is_some() || arguments.radius_m.is_some();
    match (arguments.maneuver, turn, arguments.gate_m) {
        (_, false, None) => Ok(None),
        (Some(Maneuver::SteadyTurn), true, None) => Ok(Some(Course::Turn {
            angle_rad: arguments.turn_deg.unwrap_or(90.0).to_radians(),
            radius_m: arguments.radius_m.unwrap_or(100.0),
        })),
        (Some(Maneuver::LaneChange), false, Some(gate_m)) => Ok(Some(Course::Gate { gate_m })),
        _ => Err(anyhow!(
            "--turn-deg and --radius-m are for --maneuver steady-turn, --gate-m for lane-change"
        )),
    }
}

/// Refuses options that a maneuver does not use.
fn refuse_unused(arguments: &SimulateArgs, course: Option<Course>) -> anyhow::Result<()> {
    let of_steps = [Some(Maneuver::RoundedStep), Some(Maneuver::SteadyTurn)];
    let has_steps = course.is_none() && of_steps.contains(&arguments.maneuver);
    if arguments.step_rate.is_some() && !has_steps {
        bail!(
            "--step-rate is for --maneuver rounded-step, and for steady-turn without a driver (--turn-deg, --radius-m); \
             remove it"
        );
    }
    if arguments.steer_rad.is_some() && course.is_some() {
        bail!(
            "--steer-rad: a driver on a path (--turn-deg, --radius-m, --gate-m) steers as the path needs it; remove it"
        );
    }
    Ok(())
}

/// The road, if one is asked for.
fn road(arguments: &SimulateArgs) -> anyhow::Result<Option<Road>> {
    let Some(name) = &arguments.road else { return Ok(None) };
    let road = Road::named(name, arguments.seed).context("--road")?;
    let road = if arguments.road_twist { road.twisted() } else { road };
    Ok(Some(match arguments.speed_mps {
        Some(speed_mps) => road.limited_to(speed_mps),
        None => road,
    }))
}

/// The simulated vehicle. Only the nonlinear one drives along a road.
fn plant(arguments: &SimulateArgs) -> anyhow::Result<Plant> {
    match (arguments.plant, &arguments.road) {
        (Some(plant), Some(_)) if plant != Plant::Nonlinear => Err(anyhow!(
            "--plant {plant}: only the nonlinear plant drives along --road; leave --plant out"
        )),
        (plant, Some(_)) => Ok(plant.unwrap_or(Plant::Nonlinear)),
        (plant, None) => Ok(plant.unwrap_or(Plant::Linear)),
    }
}

fn scenario(arguments: &SimulateArgs, vehicle: &Vehicle) -> anyhow::Result<Scenario> {
    let usual = Scenario::of(vehicle, arguments.maneuver.unwrap_or(Maneuver::Drive));
    let course = course(arguments)?;
    refuse_unused(arguments, course)?;
    let scenario = Scenario {
        course,
        step_rate_per_s: arguments.step_rate.unwrap_or(Histories::STEP_RATE_PER_S),
        to_rollover: arguments.to_rollover,
        plant: plant(arguments)?,
        variant: arguments.model,
        load: arguments.load.load(vehicle),
        payload_behind_hitch_m: arguments
            .payload_behind_hitch_m
            .unwrap_or(usual.payload_behind_hitch_m),
        payload_left_m: arguments.payload_left_m,
        wind_mps: arguments.wind_mps,
        wind_from_rad: arguments.wind_from_rad,
        speed_mps: arguments.speed_mps.unwrap_or(usual.speed_mps),
        steer_rad: arguments.steer_rad,
        rate_hz: arguments.rate_hz,
        start_s: arguments.start_s,
        sensors: (&arguments.sensors).into(),
        seed: arguments.seed,
        ..usual
    };
    Ok(Scenario {
        speed_change: arguments.speed_change.unwrap_or_else(|| scenario.usual_speed_change()),
        duration_s: arguments.duration_s.unwrap_or_else(|| scenario.usual_duration_s()),
        ..scenario
    })
}

fn simulation(arguments: &SimulateArgs, vehicle: &Vehicle) -> anyhow::Result<LogSimulation> {
    let scenario = scenario(arguments, vehicle)?;
    let chassis = ChassisSensors::from(&arguments.chassis);
    let Some(road) = road(arguments)? else {
        if chassis != ChassisSensors::default() || arguments.road_twist {
            return Err(anyhow!(
                "--road-twist, --level-…, --accelerometer-…, --tilt-… and --mounting-rad are for --road"
            ));
        }
        return Ok(LogSimulation::new(vehicle, scenario)?);
    };
    let duration_s = arguments.duration_s.unwrap_or_else(|| scenario.usual_duration_on_s(&road));
    let scenario = Scenario { duration_s, ..scenario };
    Ok(LogSimulation::on_road(vehicle, scenario, &road, &chassis)?)
}

pub(crate) fn run(arguments: &SimulateArgs, files: Files) -> anyhow::Result<Outcome> {
    let mut files = files.reads("--vehicle", &arguments.vehicle);
    if let Some(name) = arguments.road.as_deref().filter(|name| RoadKind::of_name(name).is_none()) {
        files = files.reads("--road", name);
    }
    files = files.prints()?;
    let output = match arguments.output.as_path() {
        path if path.as_os_str() == "-" => None,
        path => {
            check_name(path)?;
            let kind = if is_candump(path) { Kind::Frames } else { Kind::Log };
            Some(files.writes("--output", path, kind)?)
        }
    };
    let truth_target =
        arguments.truth.as_deref().map(|path| files.writes("--truth", path, Kind::Truth));
    let truth_target = truth_target.transpose()?;
    let file = truck::load(&arguments.vehicle)?;
    let mut vehicle = arguments.lift.of(&file)?;
    if is_candump(&arguments.output) {
        vehicle.sensors = vehicle.sensors.on_bus();
    }
    let simulation = simulation(arguments, &vehicle)?;
    let position = file.has_lift_axle().then(|| arguments.lift.lift_axle.unwrap_or_default());
    let mut columns = simulation.columns();
    columns.extend(position.map(|_| Signal::LiftAxle));
    let mut truth = serde_json::to_value(&simulation.truth)?;
    let comments: Vec<String> = truth
        .as_object()
        .into_iter()
        .flatten()
        .map(|(key, value)| format!("truth {key} = {value}"))
        .collect();
    if let Some(track) = &simulation.track {
        truth["track"] = serde_json::to_value(track)?;
    }
    // The truth is written to the disk before the log is begun. If this fails, there is no log
    // either.
    let draft = match &truth_target {
        Some(target) => target.write(&serde_json::to_string_pretty(&truth)?)?,
        None => None,
    };
    match &output {
        Some(target) if is_candump(target.path()) => {
            write_candump(&simulation, &vehicle, target)?;
        }
        target => {
            let lift_axle = position.map_or(f64::NAN, LiftAxle::value);
            write_csv((&simulation, lift_axle), target.as_ref(), &comments, &columns)?;
        }
    }
    draft.map_or(Ok(()), Draft::publish)?;
    Ok(Outcome::Done)
}

fn write_csv(
    (simulation, lift_axle): (&LogSimulation, f64),
    target: Option<&Target>,
    comments: &[String],
    columns: &[Signal],
) -> anyhow::Result<()> {
    let mut writer = if let Some(target) = target {
        LogWriter::create(target, comments, columns)?
    } else {
        let stream = Box::new(std::io::stdout());
        LogWriter::from_writer("standard output", stream, comments, columns)?
    };
    simulation.run(|row| writer.write_row(&LogRow { lift_axle, ..*row }))?;
    Ok(writer.finish()?)
}

fn is_candump(output: &Path) -> bool {
    output.extension().is_some_and(|extension| extension == "log")
}

/// J1939 has only the steering-wheel angle, so without a steering ratio no steer angle is sent.
fn write_candump(
    simulation: &LogSimulation,
    vehicle: &Vehicle,
    target: &Target,
) -> anyhow::Result<()> {
    let output = target.path();
    let mut writer = CandumpWriter::create(target, vehicle.steering_ratio.unwrap_or(f64::NAN))?;
    simulation.run(|row| writer.write_row(row))?;
    let lost = writer.out_of_range();
    writer.finish()?;
    if vehicle.steering_ratio.is_none() {
        print_error(&anyhow!(
            "{}: the log has no steering angle, because J1939 has only the steering-wheel angle \
             and the vehicle file has no steering_ratio",
            output.display()
        ));
    }
    if lost > 0 {
        print_error(&anyhow!(
            "{}: {lost} values are outside the range of their J1939 signal and were written as \
             \"not available\"",
            output.display()
        ));
    }
    Ok(())
}

fn check_name(path: &Path) -> anyhow::Result<()> {
    let name = path.to_string_lossy();
    if name.ends_with(".csv") || name.ends_with(".csv.gz") || is_candump(path) {
        Ok(())
    } else {
        Err(anyhow!(
            "{name}: the name of a log ends in .csv, .csv.gz or .log (CAN frames); change --output"
        ))
    }
}
