//! `cg estimate`: heights from logs, in parallel, with memory that does not depend on their length.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use cg_core::SampleError;
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator, Verdict};
use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_logs::report::{self, Entry, Trace};
use cg_output::{Draft, Files, Kind, Target};
use cg_vehicle::scales::Scale;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::answer::Answer;
use crate::args::ColumnArgs;
use crate::can::CanArgs;
use crate::cli::EstimateArgs;
use crate::flags;
use crate::outcome::{Outcome, error_message, print_error, unless_closed};
use crate::sink;
use crate::truth::Truth;

/// Number of rows between two updates of the progress bar.
const ROWS_PER_TICK: u32 = 8192;

pub(crate) fn run(arguments: &EstimateArgs, files: Files) -> anyhow::Result<Outcome> {
    let logs = matched(&arguments.logs)?;
    let target = report_target(arguments, &logs, files)?;
    let vehicle = arguments.truck.load()?;
    let (belief, basis) = arguments.truck.belief(&vehicle)?;
    let present = arguments.truck.lift.of(&vehicle)?;
    let options = EstimateOptions {
        variant: arguments.truck.model,
        method: arguments.method.method,
        order: arguments.method.order()?,
        channel: arguments.channel.into(),
        speed_mps: arguments.speed_mps,
        trailer_mass_kg: arguments.trailer_mass_kg,
        trailer_mass_sd_kg: arguments.trailer_mass_sd_kg,
        lift_axle: arguments.truck.lift.lift_axle,
        road: arguments.road.of(&vehicle),
        basis,
        ..EstimateOptions::default()
    }
    .checked(&present)
    .context("--trailer-mass-kg")?; // the speed was checked with the arguments
    let truth = arguments.truth.as_deref().map(|path| Truth::load(path, &logs)).transpose()?;
    if logs.iter().filter(|log| log.as_os_str() == "-").count() > 1 {
        return Err(anyhow!("standard input (-) can be read only once"));
    }
    let estimator = LogEstimator::of_truck(&vehicle, &belief, options)?;
    let truck = (&vehicle, arguments.truck.lift, arguments.truck.model);
    let log_options = arguments.frames.log_options(&arguments.columns, truck)?;
    let progress = progress_bar(&logs);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.jobs).build()?;
    let room = target.as_ref().map(|_| report::room(logs.len()));
    let results: Vec<anyhow::Result<Estimated>> = pool.install(|| {
        logs.par_iter()
            .map(|log| estimate_log(log, &log_options, estimator.clone(), room, &progress))
            .collect()
    });
    progress.finish_and_clear();
    // What a log is that cannot be read is not known.
    let kinds = results.iter().map(|result| result.as_ref().ok().map(|one| one.is_of_frames));
    if let Some(kinds) = kinds.collect::<Option<Vec<bool>>>() {
        refuse_unused((&arguments.columns, &arguments.frames), &log_options, &kinds)?;
    }

    let Batch { answers, unreadable, outcome } = gathered(&logs, results, truth.as_ref());
    let page = match &target {
        Some(target) => {
            let page = page(arguments, &vehicle.name, &answers, &unreadable)?;
            // It may be written to standard output (`/dev/stdout`).
            unless_closed(target.write(&page).map_err(Into::into))?.flatten()
        }
        None => None,
    };
    let printed = sink::write(arguments.format, &answers);
    unless_closed(printed.context("standard output: cannot be written"))?;
    page.map_or(Ok(()), Draft::publish)?;
    Ok(outcome)
}

/// The report of all logs.
fn page(
    arguments: &EstimateArgs,
    vehicle: &str,
    answers: &[Answer],
    unreadable: &[(String, String)],
) -> serde_json::Result<String> {
    let calibration = arguments.truck.calibration.as_ref().map(|path| path.display().to_string());
    let read = answers
        .iter()
        .map(|one| Entry::new(&one.log, &one.estimate, one.known_m, one.trace.as_ref()));
    let unread = unreadable.iter().map(|(log, reason)| Ok(Entry::unreadable(log, reason)));
    let entries = read.chain(unread).collect::<serde_json::Result<Vec<_>>>()?;
    report::page(vehicle, calibration.as_deref(), &entries)
}

/// The given logs, with the files that match a pattern (`'logs/*.csv'`, which shells on Windows and
/// programs do not expand) in its place, sorted.
fn matched(logs: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::with_capacity(logs.len());
    for log in logs {
        let text = log.to_string_lossy();
        if !text.contains(['*', '?', '[']) || log.exists() {
            all.push(log.clone());
            continue;
        }
        let matches = glob::glob(&text).with_context(|| format!("{text}: not a pattern"))?;
        let before = all.len();
        for path in matches {
            all.push(path.with_context(|| format!("{text}: cannot be read"))?);
        }
        if all.len() == before {
            return Err(anyhow!("{text}: no file matches this pattern; check the path"));
        }
    }
    Ok(all)
}

/// The file of the report, if one is written.
fn report_target(
    arguments: &EstimateArgs,
    logs: &[PathBuf],
    files: Files,
) -> anyhow::Result<Option<Target>> {
    let mut files = arguments
        .truck
        .read(files)
        .reads_some("--truth", arguments.truth.as_deref())
        .reads_some("--dbc", arguments.frames.dbc.as_deref());
    for log in logs {
        files = files.reads("LOG", log);
    }
    files = files.prints()?;
    let target =
        arguments.report.as_deref().map(|path| files.writes("--report", path, Kind::Report));
    Ok(target.transpose()?)
}

/// The results of all logs.
struct Batch {
    answers: Vec<Answer>,
    /// Logs that could not be read, with the reason.
    unreadable: Vec<(String, String)>,
    outcome: Outcome,
}

/// Collects the results with the known heights, and reports errors.
fn gathered(
    logs: &[PathBuf],
    results: Vec<anyhow::Result<Estimated>>,
    truth: Option<&Truth>,
) -> Batch {
    let mut batch = Batch {
        answers: Vec::with_capacity(results.len()),
        unreadable: Vec::new(),
        outcome: Outcome::Done,
    };
    for (log, result) in logs.iter().zip(results) {
        let name = log.display().to_string();
        match result {
            Ok(Estimated { estimate, trace, .. }) => {
                if estimate.status != Verdict::Ok {
                    batch.outcome = batch.outcome.max(Outcome::NoAnswer);
                }
                let known_m = truth.and_then(|truth| truth.height_m(log));
                batch.answers.push(Answer { log: name, estimate, known_m, trace });
            }
            Err(error) => {
                batch.unreadable.push((name, error_message(&error)));
                print_error(&error);
                batch.outcome = Outcome::Unreadable;
            }
        }
    }
    batch
}

/// The result for a log.
struct Estimated {
    estimate: LogEstimate,
    /// Its signals, if they fit into memory.
    trace: Option<Trace>,
    is_of_frames: bool,
}

/// Refuses options that none of the logs can use, which are of frames or not.
pub(crate) fn refuse_unused(
    (columns, frames): (&ColumnArgs, &CanArgs),
    options: &LogOptions,
    are_of_frames: &[bool],
) -> anyhow::Result<()> {
    if !are_of_frames.contains(&true) {
        frames.refuse("no log has any; remove it, or give a log of frames")?;
    } else if !are_of_frames.contains(&false) {
        columns.refuse_for_frames(options)?;
    }
    Ok(())
}

fn estimate_log(
    log: &Path,
    options: &LogOptions,
    mut estimator: LogEstimator,
    room: Option<usize>,
    progress: &ProgressBar,
) -> anyhow::Result<Estimated> {
    let mut trace = room.map(Trace::new);
    let (remarks, is_of_frames) = feed(log, options, progress, |row, scale| {
        estimator.weighed_by(scale);
        estimator.push(row)?;
        if let Some(trace) = &mut trace {
            trace.push(row.time_s, &estimator.signals(row));
        }
        Ok(())
    })?;
    let mut estimate = estimator.finish();
    estimate.messages.extend(remarks);
    for message in &mut estimate.messages {
        *message = flags::with_flags(message);
    }
    Ok(Estimated { estimate, trace, is_of_frames })
}

/// Passes the rows of a log to `take`, with the scale of frames. Returns the messages of the reader, and whether the log has
/// frames.
pub(crate) fn feed(
    log: &Path,
    options: &LogOptions,
    progress: &ProgressBar,
    mut take: impl FnMut(&LogRow, Option<Scale>) -> Result<(), SampleError>,
) -> anyhow::Result<(Vec<String>, bool)> {
    let name = if log.as_os_str() == "-" { "standard input".into() } else { log.to_string_lossy() };
    let mut reader = if log.as_os_str() == "-" {
        LogReader::from_reader(&name, Box::new(std::io::stdin()), options)?
    } else {
        LogReader::open(log, options)?
    };
    let mut seen = 0;
    let mut rows = 0;
    while reader.advance()? {
        take(&reader.row(), reader.scale()).with_context(|| {
            let line = reader.line();
            format!(
                "{name}, line {line}: time stamps must be at least a microsecond apart (if they are days, as in \
                 spreadsheets: --column time=NAME[d])"
            )
        })?;
        rows += 1;
        if rows % ROWS_PER_TICK == 0 {
            progress.inc(reader.bytes_read() - seen);
            seen = reader.bytes_read();
        }
    }
    progress.inc(reader.bytes_read() - seen);
    Ok((reader.remarks(), reader.is_of_frames()))
}

/// A progress bar over the bytes of all logs, shown only on a terminal.
fn progress_bar(logs: &[PathBuf]) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bytes = logs.iter().filter_map(|log| Some(log.metadata().ok()?.len())).sum();
    let style = ProgressStyle::with_template("{bar:40} {bytes}/{total_bytes} {eta}");
    ProgressBar::new(bytes).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
