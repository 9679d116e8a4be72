//! `cg calibrate`: a calibration file from logs with known height.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use cg_logs::calibrate::{CalibrateOptions, Calibrator, KnownLog};
use cg_logs::state::runs_of;
use cg_output::{Draft, Files, Kind};
use cg_vehicle::VehicleError;
use cg_vehicle::calibration::{Calibration, ParameterEntry, RunEntry, Unit};
use cg_vehicle::sensor_places::Road;
use chrono::{SecondsFormat, Utc};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use indicatif::ProgressBar;

use crate::cli::CalibrateArgs;
use crate::estimate::{feed, refuse_unused};
use crate::outcome::{Outcome, print_error};
use crate::truck;

/// Errors of reading logs and errors of the model.
struct Failure(anyhow::Error);

impl From<VehicleError> for Failure {
    fn from(error: VehicleError) -> Self {
        Self(error.into())
    }
}

pub(crate) fn run(arguments: &CalibrateArgs, files: Files) -> anyhow::Result<Outcome> {
    let mut vehicle = truck::load(&arguments.vehicle)?;
    vehicle.road = arguments.road.of(&vehicle).map(|road| Road { bank_sd_rad: road.bank_sd_rad });
    check_output(&arguments.output)?;
    refuse_standard_input(&arguments.run)?;
    let logs = &arguments.run;
    let force = files.replaces_foreign();
    let mut files = files
        .reads("--vehicle", &arguments.vehicle)
        .reads_some("--dbc", arguments.frames.dbc.as_deref());
    for known in logs {
        files = files.reads("--run", Path::new(&known.log));
    }
    for state in &arguments.from_state {
        files = files.reads("--from-state", state);
    }
    let target = files.prints()?.writes("--output", &arguments.output, Kind::Calibration)?;
    let truck = (&vehicle, arguments.lift, arguments.model);
    let options = arguments.frames.log_options(&arguments.columns, truck)?;
    let progress = ProgressBar::hidden();
    let &CalibrateArgs { model: variant, method, procedure, part, channel, .. } = arguments;
    let lift_axle = arguments.lift.lift_axle;
    let channel = channel.into();
    let how = CalibrateOptions { variant, method, channel, procedure, part, lift_axle, force };
    let trips = runs_of(&contents(&arguments.from_state)?, &vehicle, variant)?;
    let mut are_of_frames = BTreeMap::new();
    let calibrated = Calibrator::new(&vehicle, how, logs)?.calibrate(&trips, |known, estimator| {
        let take = |row: &_, scale| {
            estimator.weighed_by(scale);
            estimator.push(row).map(|_| ())
        };
        let (remarks, is_of_frames) =
            feed(Path::new(&known.log), &options, &progress, take).map_err(Failure)?;
        // Each log is read twice.
        if are_of_frames.insert(known.log.clone(), is_of_frames).is_none() {
            for remark in remarks {
                print_error(&anyhow!("{}: {remark}", known.log));
            }
        }
        Ok(())
    });
    let mut calibration = calibrated.map_err(|failure: Failure| failure.0)?;
    let kinds: Vec<bool> = are_of_frames.into_values().collect();
    refuse_unused((&arguments.columns, &arguments.frames), &options, &kinds)?;
    calibration.date = Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true);
    target.write(&calibration.to_toml()?)?.map_or(Ok(()), Draft::publish)?;
    report(&calibration, &arguments.output).context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

/// Names and contents of state files.
fn contents(paths: &[PathBuf]) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let content = |path: &PathBuf| {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).with_context(|| format!("{name}: cannot be read"))?;
        Ok((name, bytes))
    };
    paths.iter().map(content).collect()
}

/// Standard input can be read only once, but a calibration reads each log twice.
pub(crate) fn refuse_standard_input(logs: &[KnownLog]) -> anyhow::Result<()> {
    if logs.iter().any(|known| known.log == "-") {
        return Err(anyhow!("--run -: standard input cannot be read twice; give a file"));
    }
    Ok(())
}

fn check_output(output: &Path) -> anyhow::Result<()> {
    if output.extension().is_some_and(|extension| extension == "toml") {
        Ok(())
    } else {
        Err(anyhow!(
            "{}: the name of a calibration ends in .toml; change --output",
            output.display()
        ))
    }
}

fn report(calibration: &Calibration, output: &Path) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    let mut parameters = table(&["parameter", "value", "before", "determined"]);
    for entry in &calibration.parameter {
        let before = match entry.unit {
            Unit::Factor => format!("± {:.0} %", 100.0 * entry.prior_sd),
            Unit::M => format!("± {:.3} m", entry.prior_sd),
        };
        parameters.add_row(vec![
            entry.name.words().to_owned(),
            value(entry),
            before,
            format!("{:.0} %", 100.0 * entry.determined.max(0.0)),
        ]);
    }
    let mut runs =
        table(&["run", "height", "mass", "speed", "channel", "ratio", "before", "after"]);
    for run in &calibration.run {
        for entry in &run.channel {
            runs.add_row(vec![
                run.log.clone(),
                height(run),
                mass(run),
                format!("{:.1} m/s", run.speed_mps),
                entry.name.clone(),
                format!("{:.5}", entry.ratio),
                format!("{:+.1} %", entry.before_percent),
                format!("{:+.1} %", entry.after_percent),
            ]);
        }
    }
    for table in [&mut parameters, &mut runs] {
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        writeln!(out, "{}\n", table.trim_fmt())?;
    }
    for sentence in calibration.statement.iter().chain(&calibration.contradiction) {
        writeln!(out, " {sentence}")?;
    }
    let compensation = &calibration.compensation;
    writeln!(
        out,
        "\n R_c: steer {:.4}, lateral acceleration {:.4}\n written to {}",
        compensation.steer,
        compensation.lateral_acceleration,
        output.display()
    )?;
    Ok(())
}

fn height(run: &RunEntry) -> String {
    match run.height_sd_m.unwrap_or(run.known_height_sd_m) {
        0.0 => format!("{:.3} m", run.height_m),
        sd_m => format!("{:.3} ± {sd_m:.3} m", run.height_m),
    }
}

fn mass(run: &RunEntry) -> String {
    match run.trailer_mass_sd_kg {
        0.0 => format!("{:.0} kg", run.trailer_mass_kg),
        sd_kg => format!("{:.0} ± {sd_kg:.0} kg", run.trailer_mass_kg),
    }
}

fn value(entry: &ParameterEntry) -> String {
    match entry.unit {
        Unit::Factor => format!("× {:.3} ± {:.1} %", entry.value, 100.0 * entry.sd),
        Unit::M => format!("{:+.3} ± {:.3} m", entry.value, entry.sd),
    }
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_header(header.to_vec());
    table
}
