//! `cg simulate`: logs with known truth.

use std::path::Path;

use anyhow::anyhow;
use cg_vehicle::Vehicle;
use cg_vehicle::log::{LogWriter, Signal};
use cg_vehicle::maneuver::Maneuver;
use cg_vehicle::simulate::{LogSimulation, Scenario};

use crate::Outcome;
use crate::cli::SimulateArgs;
use crate::draft::Draft;

const COLUMNS: [Signal; 7] = [
    Signal::Time,
    Signal::Steer,
    Signal::Roll,
    Signal::Speed,
    Signal::LateralAcceleration,
    Signal::YawRate,
    Signal::TrailerMass,
];

pub(crate) fn run(arguments: &SimulateArgs) -> anyhow::Result<Outcome> {
    let vehicle = Vehicle::load(&arguments.vehicle)?;
    let maneuver: Maneuver = arguments.maneuver.into();
    let usual_s = if maneuver == Maneuver::Drive { 300.0 } else { 20.0 };
    let simulation = LogSimulation::new(
        &vehicle,
        Scenario {
            maneuver,
            plant: arguments.plant.into(),
            variant: arguments.model.into(),
            load: arguments.load.load(&vehicle),
            speed_mps: arguments.speed_mps.unwrap_or(vehicle.nominal_speed_mps),
            steer_rad: arguments.steer_rad,
            rate_hz: arguments.rate_hz,
            start_s: arguments.start_s,
            duration_s: arguments.duration_s.unwrap_or(usual_s),
            snr_db: arguments.snr_db,
            seed: arguments.seed,
        },
    )?;
    let truth = serde_json::to_value(&simulation.truth)?;
    let comments: Vec<String> = truth
        .as_object()
        .into_iter()
        .flatten()
        .map(|(key, value)| format!("truth {key} = {value}"))
        .collect();
    // The truth is on the disk before the log is begun: if it cannot be, there is no log either.
    let draft = match &arguments.truth {
        Some(path) if *path == arguments.output => {
            return Err(anyhow!("{}: given to --output and to --truth", path.display()));
        }
        Some(path) => Some(Draft::write(path, "--truth", &serde_json::to_string_pretty(&truth)?)?),
        None => None,
    };
    let mut writer = if arguments.output.as_os_str() == "-" {
        LogWriter::from_writer("standard output", Box::new(std::io::stdout()), &comments, &COLUMNS)?
    } else {
        check_name(&arguments.output)?;
        LogWriter::create(&arguments.output, &comments, &COLUMNS)?
    };
    simulation.run(|row| writer.write_row(row))?;
    writer.finish()?;
    draft.map_or(Ok(()), Draft::publish)?;
    Ok(Outcome::Done)
}

fn check_name(path: &Path) -> anyhow::Result<()> {
    let name = path.to_string_lossy();
    if name.ends_with(".csv") || name.ends_with(".csv.gz") {
        Ok(())
    } else {
        Err(anyhow!("{name}: a log ends in .csv or .csv.gz; give --output such a name"))
    }
}
