//! `cg study`: the studies of the thesis's chapter 2, each as a CSV file and a figure.
//!
//! | file | what |
//! |---|---|
//! | `table` | the CSV file |
//! | `figure` | the panels on a page, drawn with `plotters` |

#[cfg_attr(not(feature = "plots"), path = "no_figure.rs")]
mod figure;
mod table;

use std::io::Write;
use std::path::Path;

use anyhow::{Context, anyhow, ensure};
use cg_logs::log::LogReader;
use cg_logs::output::{Draft, Files, Kind, Target};
use cg_thesis::study::{Recorded, Study, replay, studies, study};
use cg_vehicle::Vehicle;
use cg_vehicle::calibration::Calibration;
use comfy_table::presets::NOTHING;
use comfy_table::{ContentArrangement, Table};

use crate::calibrate::refuse_standard_input;
use crate::cli::StudyArgs;
use crate::estimate::file_name;
use crate::outcome::Outcome;
use crate::truck;

/// The study that reads logs.
const REPLAY: &str = "replay";

/// The reason why a build without `plots` has no studies.
const LEFT_OUT: &str = "this program was built without the feature `plots`, which draws the figures of a study; \
                        build it with that feature";

/// Width of the printed summary in characters.
const WIDTH: u16 = 120;

pub(crate) fn run(arguments: &StudyArgs, files: Files) -> anyhow::Result<Outcome> {
    let Some(name) = &arguments.name else { return list() };
    // Before a study is computed, not after it.
    ensure!(cfg!(feature = "plots"), LEFT_OUT);
    let folder = &arguments.output;
    if folder.exists() && !folder.is_dir() {
        return Err(anyhow!("{}: is a file; give a folder with --output", folder.display()));
    }
    refuse_standard_input(&arguments.run)?;
    let targets = targets(arguments, name, files)?;
    let vehicle = arguments.vehicle.as_deref().map(truck::load).transpose()?;
    let study = match (name.as_str(), vehicle) {
        (REPLAY, Some(vehicle)) => replayed(arguments, &vehicle)?,
        (REPLAY, None) => {
            return Err(anyhow!("replay: give the file of the recorded vehicle with --vehicle"));
        }
        _ if !arguments.run.is_empty() || arguments.calibration.is_some() => {
            return Err(anyhow!("--run and --calibration are for the study `{REPLAY}` only"));
        }
        (name, vehicle) => study(name, vehicle.as_ref())?,
    };
    let files = write(&study, folder, &targets)?;
    print(&mut std::io::stdout().lock(), &study, &files)
        .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

/// The study of recorded logs that are simulated again.
fn replayed(arguments: &StudyArgs, vehicle: &Vehicle) -> anyhow::Result<Study> {
    if arguments.run.is_empty() {
        return Err(anyhow!("replay: give at least one --run LOG=HEIGHT_M[,TRAILER_MASS_KG]"));
    }
    let options = arguments.columns.options();
    let calibration = arguments.calibration.as_ref().map(|path| Calibration::load(path, vehicle));
    let mut logs = Vec::with_capacity(arguments.run.len());
    for run in &arguments.run {
        let known = run.clone();
        if !known.load.height_is_known() {
            return Err(anyhow!(
                "replay: {}: a drive is simulated at a height; give it",
                known.log
            ));
        }
        let rows = LogReader::open(Path::new(&known.log), &options)?.collect::<Result<_, _>>()?;
        logs.push(Recorded { known, rows });
    }
    for log in &mut logs {
        log.known.log = file_name(Path::new(&log.known.log));
    }
    Ok(replay(vehicle, calibration.transpose()?.as_ref(), &logs)?)
}

fn list() -> anyhow::Result<Outcome> {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    for listed in studies() {
        table.add_row([listed.name, listed.about, listed.figures]);
    }
    table.add_row([
        REPLAY,
        "Recorded logs (--run), simulated again and compared with the recording.",
        "",
    ]);
    writeln!(std::io::stdout().lock(), "{}", table.trim_fmt())
        .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

/// The files of the table and the figure.
fn targets(arguments: &StudyArgs, name: &str, files: Files) -> anyhow::Result<[Target; 2]> {
    let mut files = files
        .reads_some("--vehicle", arguments.vehicle.as_deref())
        .reads_some("--calibration", arguments.calibration.as_deref());
    for run in &arguments.run {
        files = files.reads("--run", Path::new(&run.log));
    }
    let path = |end| arguments.output.join(format!("{name}.{end}"));
    Ok([
        files.writes("--output", &path("csv"), Kind::Table)?,
        files.writes("--output", &path("svg"), Kind::Figure)?,
    ])
}

/// Writes both files or none; returns their names.
fn write(study: &Study, folder: &Path, targets: &[Target; 2]) -> anyhow::Result<[String; 2]> {
    let (table, figure) = (table::csv(study)?, figure::svg(study)?);
    if !folder.exists() {
        std::fs::create_dir(folder).with_context(|| {
            format!("{}: cannot be created; give another folder", folder.display())
        })?;
    }
    let drafts = [targets[0].write(&table)?, targets[1].write(&figure)?];
    Draft::publish_all(drafts.into_iter().flatten())?;
    Ok(targets.each_ref().map(|target| target.path().display().to_string()))
}

/// Prints the finding, and each statement of the thesis next to the computed result.
fn print(out: &mut impl Write, study: &Study, files: &[String; 2]) -> std::io::Result<()> {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table.set_header(["", "thesis", "ours", "agrees"]);
    for statement in &study.statements {
        let agrees = if statement.agrees { "yes" } else { "no" };
        table.add_row([statement.place, statement.thesis, &statement.ours, agrees]);
    }
    writeln!(out, "{}.", study.finding)?;
    for line in &study.scenario {
        writeln!(out, "  {line}")?;
    }
    if !study.statements.is_empty() {
        writeln!(out, "{}", table.trim_fmt())?;
    }
    writeln!(out, "written: {}, {}", files[0], files[1])
}
