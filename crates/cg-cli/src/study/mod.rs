//! `cg study`: the studies of the thesis's chapter 2, each as a CSV file and a figure.
//!
//! | file | what |
//! |---|---|
//! | `table` | the CSV file |
//! | `axes` | what the axes cover, and their ticks |
//! | `figure` | the panels on a page, drawn with `plotters` |

#[cfg(feature = "plots")]
mod axes;
#[cfg_attr(not(feature = "plots"), path = "no_figure.rs")]
mod figure;
mod table;

use std::io::Write;
use std::path::Path;

use anyhow::{Context, anyhow, ensure};
use cg_logs::log::LogReader;
use cg_output::{Draft, Files, Kind, Target};
use cg_thesis::study::{Recorded, Statement, Study, replay, studies, study};
use cg_thesis::verdict::{Criterion, Verdict};
use cg_vehicle::Vehicle;
use cg_vehicle::calibration::Calibration;
use comfy_table::presets::NOTHING;
use comfy_table::{ContentArrangement, Table};

use crate::calibrate::refuse_standard_input;
use crate::cli::StudyArgs;
use crate::outcome::Outcome;
use crate::truck;

/// The study that reads logs.
const REPLAY: &str = "replay";

/// The reason why a build without `plots` has no studies.
const LEFT_OUT: &str = "this program was built without the feature `plots`, which draws the figures of a study; \
                        build it with that feature";

/// Width of the printed summary in characters.
const WIDTH: u16 = 150;

pub(crate) fn run(arguments: &StudyArgs, files: Files) -> anyhow::Result<Outcome> {
    let Some(name) = &arguments.name else { return list() };
    // Before a study is computed, not after it.
    ensure!(cfg!(feature = "plots"), LEFT_OUT);
    let folder = &arguments.output;
    refuse_standard_input(&arguments.run)?;
    let targets = targets(arguments, name, files)?;
    let vehicle = arguments.vehicle.as_deref().map(truck::load).transpose()?;
    let study = match (name.as_str(), vehicle) {
        (REPLAY, Some(vehicle)) => replayed(arguments, &vehicle)?,
        (REPLAY, None) => {
            return Err(anyhow!("replay: give the file of the recorded vehicle with --vehicle"));
        }
        _ if reads_logs(arguments) => {
            return Err(anyhow!(
                "--run, --calibration, --column and --flip are for the study `{REPLAY}` only"
            ));
        }
        (name, vehicle) => study(name, vehicle.as_ref())?,
    };
    write(&[(&study, &targets)], folder)?;
    let study = (&study, arguments.vehicle.is_none());
    print(&mut std::io::stdout().lock(), study, &targets)
        .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

/// Whether there are options for recorded logs.
fn reads_logs(arguments: &StudyArgs) -> bool {
    let StudyArgs { run, calibration, columns, .. } = arguments;
    !run.is_empty() || calibration.is_some() || columns.is_given()
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
        if !known.load.is_exact() {
            return Err(anyhow!(
                "replay: {}: a drive is simulated at a height; give it, without ? and ±",
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
    let mut files = files.prints()?;
    both("--output", &arguments.output, name, &mut files)
}

/// Table and figure of one study in the folder of an option.
fn both(flag: &str, folder: &Path, name: &str, files: &mut Files) -> anyhow::Result<[Target; 2]> {
    if folder.exists() && !folder.is_dir() {
        return Err(anyhow!("{}: is a file; give a folder with {flag}", folder.display()));
    }
    let path = |end| folder.join(format!("{name}.{end}"));
    Ok([
        files.writes(flag, &path("csv"), Kind::Table)?,
        files.writes(flag, &path("svg"), Kind::Figure)?,
    ])
}

/// Writes the figures of `cg reproduce`, each with its table, all or none; returns the names of the figures. Their files
/// are checked before `compute` is called.
pub(crate) fn write_all(
    names: impl Iterator<Item = &'static str>,
    folder: &Path,
    files: Files,
    compute: impl FnOnce() -> anyhow::Result<Vec<Study>>,
) -> anyhow::Result<Vec<String>> {
    ensure!(cfg!(feature = "plots"), LEFT_OUT);
    let mut files = files.prints()?;
    let targets = names.map(|name| both("--figures", folder, name, &mut files));
    let targets = targets.collect::<anyhow::Result<Vec<_>>>()?;
    let studies = compute()?;
    write(&studies.iter().zip(&targets).collect::<Vec<_>>(), folder)?;
    Ok(targets.iter().map(|[_, figure]| figure.path().display().to_string()).collect())
}

/// Writes all files or none.
fn write(studies: &[(&Study, &[Target; 2])], folder: &Path) -> anyhow::Result<()> {
    let text = |(study, targets)| Ok((table::csv(study)?, figure::svg(study)?, targets));
    let texts = studies.iter().copied().map(text).collect::<anyhow::Result<Vec<_>>>()?;
    if !folder.exists() {
        std::fs::create_dir(folder).with_context(|| {
            format!("{}: cannot be created; give another folder", folder.display())
        })?;
    }
    let mut drafts = Vec::with_capacity(2 * texts.len());
    for (table, figure, [first, second]) in texts {
        drafts.extend([first.write(&table)?, second.write(&figure)?]);
    }
    Draft::publish_all(drafts.into_iter().flatten())?;
    Ok(())
}

/// The range in which a result is the thesis's, with its reason.
fn criterion(statement: &Statement) -> String {
    let Criterion { least, greatest, reason, .. } = statement.criterion;
    let unit = statement.unit;
    let space = if unit.starts_with('°') { "" } else { " " };
    format!("{} to {}{space}{unit}: {reason}", number(least), number(greatest))
}

/// A number with as many of three decimals as it needs.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').replace('-', "−")
}

/// The verdict on a statement; why it differs is known of the vehicles of the thesis.
fn verdict(statement: &Statement, is_of_thesis: bool) -> String {
    let (found, measured) = (statement.verdict(), number(statement.measured));
    if found == Verdict::Same || !is_of_thesis {
        return format!("{found}: {measured}");
    }
    format!("{found}: {measured}, because {}", statement.because)
}

/// The last component of a path.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Prints the finding, and each statement of the thesis next to the computed result.
fn print(
    out: &mut impl Write,
    (study, is_of_thesis): (&Study, bool),
    files: &[Target; 2],
) -> std::io::Result<()> {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table.set_header(["", "thesis", "ours", "the same if", "verdict"]);
    for statement in &study.statements {
        let range = criterion(statement);
        let verdict = verdict(statement, is_of_thesis);
        table.add_row([statement.place, statement.thesis, &statement.ours, &range, &verdict]);
    }
    writeln!(out, "{}.", study.finding)?;
    for line in &study.scenario {
        writeln!(out, "  {line}")?;
    }
    if !study.statements.is_empty() {
        writeln!(out, "{}", table.trim_fmt())?;
    }
    let [table, figure] = files.each_ref().map(|file| file.path().display());
    writeln!(out, "written: {table}, {figure}")
}
