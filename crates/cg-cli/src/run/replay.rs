//! Replay of recorded drives: candump logs and CSV, as fast as possible or in real time.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use cg_core::Quantity;
use cg_logs::can::{CandumpReader, Clock};
use cg_logs::estimate::SpeedAge;
use cg_logs::log::{FrameText, LogError, LogOptions, LogReader, LogRow, Signal};
use cg_vehicle::scales::Scale;

use super::args::RunArgs;
use super::frames::Frames;
use super::pace::too_slow;
use super::presence::Presence;
use super::session::Session;
use super::signals::Stop;
use super::stall::{Pauses, Stalling};

/// Pause that is not waited for, µs: a truck that is parked, or a clock that is set after a start without one.
const PAUSE_US: u64 = 600_000_000;

/// Waits until as much time has passed as between the time stamps of a file. What comes through a pipe in real time has its own pace,
/// whatever its time stamps say, and is late if nothing comes.
struct Pace<'a> {
    /// When the drive began, after the last long pause, the stream time of that, and the last one, µs.
    began: Option<(Instant, u64, u64)>,
    realtime: bool,
    of_pipe: bool,
    stop: &'a Stop,
    /// When the last one was due, or came.
    passed: Instant,
    pauses: Pauses,
}

impl<'a> Pace<'a> {
    fn new(realtime: bool, of_pipe: bool, stop: &'a Stop) -> Self {
        let (passed, pauses) = (Instant::now(), Pauses::default());
        Self { began: None, realtime, of_pipe, stop, passed, pauses }
    }

    /// Time in which nothing has come.
    fn silence(&self) -> Duration {
        self.passed.elapsed()
    }

    /// Waits for the time of this stream time, or until the program is asked to stop.
    fn wait(&mut self, stream_us: u64) {
        if !self.realtime {
            return;
        }
        if !self.of_pipe {
            self.wait_until_due(stream_us);
        }
        self.passed = Instant::now();
        self.pauses.tell();
    }

    fn wait_until_due(&mut self, stream_us: u64) {
        let same = |began: &(Instant, u64, u64)| stream_us.saturating_sub(began.2) < PAUSE_US;
        let now = || (Instant::now(), stream_us, stream_us);
        let (began, first_us, _) = self.began.filter(same).unwrap_or_else(now);
        self.began = Some((began, first_us, stream_us));
        let due = Duration::from_micros(stream_us.saturating_sub(first_us));
        if let Some(rest) = due.checked_sub(began.elapsed()) {
            self.stop.wait_at_most(rest);
        }
    }
}

/// The text of a log.
type Text = Box<dyn Read + Send>;

/// A recorded drive. A file is opened before anything is written, so that one that cannot be read leaves nothing. What
/// comes in through a pipe may take long to begin, and is opened when it is replayed.
pub(crate) enum Recording<'a> {
    /// Lines of candump, plain or gzip.
    Frames(&'a Path, Option<Text>),
    /// A CSV log.
    Rows(&'a Path, Option<Box<LogReader>>),
}

impl<'a> Recording<'a> {
    /// The recording that the arguments name, if they name one.
    pub(crate) fn open(
        arguments: &'a RunArgs,
        options: &LogOptions,
    ) -> anyhow::Result<Option<Self>> {
        Ok(match (&arguments.candump, &arguments.csv) {
            (Some(path), _) if is_pipe(path) => Some(Self::Frames(path, None)),
            (Some(path), _) => Some(Self::Frames(path, Some(lines(path, Box::new(open(path)?))?))),
            (_, Some(path)) if is_pipe(path) => Some(Self::Rows(path, None)),
            (_, Some(path)) => {
                Some(Self::Rows(path, Some(rows(path, LogReader::open(path, options)?)?)))
            }
            (None, None) => None,
        })
    }
}

fn is_pipe(path: &Path) -> bool {
    is_standard_input(path)
        || path.metadata().is_ok_and(|about| !about.is_file() && !about.is_dir())
}

fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn name(path: &Path) -> String {
    if is_standard_input(path) { "standard input".to_owned() } else { path.display().to_string() }
}

fn open(path: &Path) -> anyhow::Result<File> {
    let file = File::open(path).with_context(|| format!("{}: cannot be read", name(path)))?;
    if file.metadata().is_ok_and(|about| about.is_dir()) {
        bail!("{}: is a folder; give the file of one drive", name(path));
    }
    Ok(file)
}

/// The stream of a pipe or of standard input.
fn piped(path: &Path, pace: &Pace<'_>) -> anyhow::Result<Text> {
    let file = path.to_owned();
    let open = move || -> io::Result<Text> {
        if is_standard_input(&file) {
            Ok(Box::new(io::stdin()))
        } else {
            Ok(Box::new(File::open(file)?))
        }
    };
    let stream = Stalling::new(open, (&pace.pauses, pace.stop));
    Ok(Box::new(stream.with_context(|| format!("{}: cannot be read", name(path)))?))
}

/// What was read; nothing if the program was asked to stop, because reading then fails.
fn unless_stopped<T, E>(read: Result<T, E>, stop: &Stop) -> Result<Option<T>, E> {
    match read {
        Err(_) if stop.is_requested() => Ok(None),
        read => read.map(Some),
    }
}

/// The lines of a candump log.
fn lines(path: &Path, stream: Text) -> anyhow::Result<Text> {
    let name = name(path);
    match FrameText::of(&name, stream)? {
        FrameText::Candump(text) => Ok(text),
        FrameText::Rows => {
            bail!("{name}: the log contains rows; give it with --csv instead of --candump")
        }
        FrameText::Asc | _ => bail!(
            "{name}: the log is in the format ASC, which cg run does not read; cg estimate reads it"
        ),
    }
}

/// The reader of a CSV log, which has read the header.
fn rows(path: &Path, reader: LogReader) -> anyhow::Result<Box<LogReader>> {
    if reader.is_of_frames() {
        bail!(
            "{}: the log contains CAN frames; give it with --candump instead of --csv",
            name(path)
        );
    }
    Ok(Box::new(reader))
}

/// The reader of rows that come in through a pipe.
fn piped_rows(
    path: &Path,
    options: &LogOptions,
    pace: &Pace<'_>,
) -> anyhow::Result<Option<Box<LogReader>>> {
    let reader = LogReader::from_reader(&name(path), piped(path, pace)?, options);
    unless_stopped(reader, pace.stop)?.map(|reader| rows(path, reader)).transpose()
}

/// Replays a candump log. Invalid lines are skipped, counted and reported once.
pub(crate) fn candump<W: Write>(
    (path, opened): (&Path, Option<Text>),
    bus: Option<String>,
    realtime: bool,
    frames: &mut Frames,
    session: &mut Session<W>,
    stop: &Stop,
) -> anyhow::Result<&'static str> {
    let (name, mut pace) = (name(path), Pace::new(realtime, is_pipe(path), stop));
    let text = opened.map_or_else(|| lines(path, piped(path, &pace)?), Ok);
    let Some(text) = unless_stopped(text, stop)? else { return Ok("signal") };
    let mut reader = CandumpReader::new(BufReader::new(text), bus);
    loop {
        if stop.is_requested() {
            return Ok("signal");
        }
        let read = match unless_stopped(reader.next_frame(), stop) {
            Err(fault) if fault.is_pause() => {
                frames.stall(pace.silence(), session)?;
                continue;
            }
            read => read.with_context(|| name.clone())?,
        };
        let Some(frame) = read else { return Ok("signal") };
        session.counters.malformed = reader.malformed();
        session.counters.error_frames = reader.error_frames();
        for message in reader.news() {
            session.notice("source", &format!("{name}, {message}"))?;
        }
        let Some(frame) = frame else { break };
        let stream_us = frames.take(&frame, None, session)?;
        pace.wait(stream_us);
    }
    frames.flush(session)?;
    Ok("end of log")
}

/// Replays a CSV log. Invalid rows are skipped, counted and reported once.
pub(crate) fn csv<W: Write>(
    (path, opened): (&Path, Option<Box<LogReader>>),
    realtime: bool,
    options: &LogOptions,
    presence: &mut Presence,
    session: &mut Session<W>,
    stop: &Stop,
) -> anyhow::Result<&'static str> {
    let mut pace = Pace::new(realtime, is_pipe(path), stop);
    let opened =
        opened.map_or_else(|| piped_rows(path, options, &pace), |reader| Ok(Some(reader)))?;
    let Some(reader) = opened else { return Ok("signal") };
    let mut reader = reader.over_bad_rows();
    let (mut clock, mut speed_age) = (Clock::default(), SpeedAge::default());
    loop {
        if stop.is_requested() {
            return Ok("signal");
        }
        let read = match unless_stopped(next_row(&mut reader, session), stop) {
            Err(error) if error.downcast_ref().is_some_and(LogError::is_pause) => {
                session.stall(pace.silence(), |now_us| presence.missing(now_us))?;
                continue;
            }
            read => read?,
        };
        let Some(read) = read else { return Ok("signal") };
        let Some(row) = read else { break };
        // The reader ensures that there is a time; microseconds since 1970 fit.
        #[allow(clippy::cast_possible_truncation)]
        let stamp_us = (row.time_s * 1e6).round() as i64;
        // The clock compares time stamps; their origin does not matter.
        let instant = clock.stream(stamp_us.abs_diff(i64::MIN), None);
        session.at(row.time_s, instant)?;
        session.counters.frames += 1;
        session.counters.values_implausible = reader.implausible_values();
        for (signal, message) in reader.news() {
            session.notice(signal, &message)?;
        }
        for quantity in Quantity::ALL {
            if !row.get(Signal::from(quantity)).is_nan()
                && let Some(step_s) = presence.received(quantity, instant.stream_us)
            {
                session.notice(Signal::from(quantity).name(), &too_slow(step_s))?;
            }
        }
        session.follow_lift_axle(row.lift_axle)?;
        if let Some((quantity, _)) = row.weighed(&session.settings) {
            session.weighing.scale = Scale::in_log(quantity);
        }
        if row.trailer_mass_sd_kg >= 0.0 {
            session.weighing.logged_sd_kg = Some(row.trailer_mass_sd_kg);
        }
        session.sensors.level(|level| row.get(Signal::from(level)));
        session.rated.push(&row);
        session.preparation.hear(row.yaw_rate_on_tractor, row.lateral_acceleration_on_tractor);
        let mut sample = row.sample(instant.stream_us, &session.settings);
        speed_age.push(&mut sample);
        session.push(sample)?;
        session.seen = presence.seen;
        session.tilts = presence.tilts();
        session.missing(presence.missing(instant.stream_us))?;
        for (signal, message) in presence.unscaled(instant.stream_us) {
            session.notice(signal, message)?;
        }
        session.run_periodic(realtime)?;
        pace.wait(instant.stream_us);
    }
    Ok("end of log")
}

/// The next valid row.
fn next_row<W: Write>(
    reader: &mut LogReader,
    session: &mut Session<W>,
) -> anyhow::Result<Option<LogRow>> {
    loop {
        match reader.next_row() {
            Ok(row) => return Ok(row),
            Err(error) if error.is_of_a_row() => {
                session.counters.malformed += 1;
                if session.counters.malformed == 1 {
                    let message = format!("{error}; invalid rows are skipped and counted");
                    session.notice("source", &message)?;
                }
            }
            Err(error) => return Err(error.into()),
        }
    }
}
