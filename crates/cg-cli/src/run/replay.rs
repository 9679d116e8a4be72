//! Recorded drives: candump logs and CSV, as fast as possible or in real time.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Context;
use cg_core::AlignSettings;
use cg_vehicle::can::Frame;
use cg_vehicle::log::{LogOptions, LogReader};

use super::clock::Clock;
use super::frames::Frames;
use super::session::Session;
use super::signals::Stop;

/// A line of a candump log is shorter (CAN FD: 200 bytes).
const LONGEST_LINE: u64 = 4096;

/// Waits until as much time has passed as between the time stamps.
struct Pace {
    began: Option<(Instant, u64)>,
    realtime: bool,
}

impl Pace {
    fn wait(&mut self, stream_us: u64) {
        if !self.realtime {
            return;
        }
        let (began, first_us) = *self.began.get_or_insert((Instant::now(), stream_us));
        let due = Duration::from_micros(stream_us.saturating_sub(first_us));
        if let Some(rest) = due.checked_sub(began.elapsed()) {
            std::thread::sleep(rest);
        }
    }
}

fn open(path: &Path) -> anyhow::Result<(String, Box<dyn Read + Send>)> {
    if path.as_os_str() == "-" {
        return Ok(("standard input".to_owned(), Box::new(io::stdin())));
    }
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("{name}: cannot be read"))?;
    Ok((name, Box::new(file)))
}

/// Replays a candump log. A line that is none is counted and told once; all the rest counts.
pub(crate) fn candump<W: Write>(
    path: &Path,
    realtime: bool,
    frames: &mut Frames,
    session: &mut Session<W>,
    stop: &Stop,
) -> anyhow::Result<&'static str> {
    let (name, input) = open(path)?;
    let mut input = BufReader::new(input);
    let mut pace = Pace { began: None, realtime };
    let mut line = Vec::new();
    for number in 1_u64.. {
        if stop.asked() {
            return Ok("signal");
        }
        line.clear();
        let read = input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line);
        if read.with_context(|| format!("{name}, line {number}: cannot be read"))? == 0 {
            break;
        }
        let text = String::from_utf8_lossy(&line);
        match Frame::from_candump(&text) {
            Ok(Some(frame)) => {
                let stream_us = frames.take(&frame, None, session)?;
                pace.wait(stream_us);
            }
            Ok(None) => {}
            Err(error) => {
                session.counters.malformed += 1;
                if session.counters.malformed == 1 {
                    session.notice("source", format!("{name}, line {number}: {error}"))?;
                }
            }
        }
    }
    frames.flush(session)?;
    Ok("end of log")
}

/// Replays a CSV log.
pub(crate) fn csv<W: Write>(
    path: &Path,
    realtime: bool,
    options: &LogOptions,
    (mut clock, settings): (Clock, AlignSettings<f64>),
    session: &mut Session<W>,
    stop: &Stop,
) -> anyhow::Result<&'static str> {
    let (name, input) = open(path)?;
    let mut reader = if path.as_os_str() == "-" {
        LogReader::from_reader(&name, input, options)?
    } else {
        LogReader::open(path, options)?
    };
    let mut pace = Pace { began: None, realtime };
    while let Some(row) = reader.next_row()? {
        if stop.asked() {
            return Ok("signal");
        }
        // The reader lets time only go forward; microseconds since 1970 fit.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let raw_us = (row.time_s.max(0.0) * 1e6).round() as u64;
        let stream_us = clock.stream(raw_us, None).stream_us;
        session.tick(row.time_s, stream_us);
        session.counters.frames += 1;
        session.push(row.sample(stream_us, &settings))?;
        session.due(realtime)?;
        pace.wait(stream_us);
    }
    Ok("end of log")
}
