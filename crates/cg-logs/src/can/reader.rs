//! A reader of candump logs, one frame at a time.

use std::collections::VecDeque;
use std::io::{self, BufRead, Read};
use std::time::Duration;

use super::candump::{CandumpError, Content, Line, parse};
use super::frame::Frame;

/// Maximum length of a line. Lines of candump are shorter (CAN FD in the plain form: 300 bytes).
pub(super) const LONGEST_LINE: u64 = 4096;
/// Number of frames without time stamps after which the log counts as one without time stamps.
const PATIENCE: u64 = 10;
/// Number of frames from which it is decided whether time stamps are differences.
const LOOK: usize = 100;
/// Time stamps below this one (12 January 1970) are not Unix time.
const RELATIVE_US: u64 = 1_000_000_000_000;
/// Maximum number of interfaces whose names are stored.
pub(super) const MOST_BUSES: usize = 32;

/// The reason why a candump log cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CandumpFault {
    /// The log cannot be read.
    #[error("line {line}: cannot be read ({source}); check the path, the disk or the connection")]
    Read {
        /// The line.
        line: u64,
        /// The error of the system.
        source: io::Error,
    },
    /// The frames have no time stamps.
    #[error("line {line}: {}", CandumpError::NoTime)]
    NoTime {
        /// The line of the first frame.
        line: u64,
    },
    /// All time stamps are the same.
    #[error(
        "the time stamps of all {frames} frames are {time_s} s; record them with their times (`candump -L` or \
         `candump -ta`)"
    )]
    Standing {
        /// Number of frames with time stamps.
        frames: u64,
        /// The time stamp, s.
        time_s: f64,
    },
    /// The requested bus is not in the log.
    #[error(
        "no frame of the bus `{wanted}`; the buses in the log are {found}; give one of them with ⟨bus⟩"
    )]
    NoBus {
        /// The requested name.
        wanted: String,
        /// The names in the log.
        found: String,
    },
}

impl CandumpFault {
    /// Whether nothing has come for now, as a stream says with [`io::ErrorKind::WouldBlock`]: reading can go on later, and nothing is
    /// lost.
    pub fn is_pause(&self) -> bool {
        matches!(self, Self::Read { source, .. } if source.kind() == io::ErrorKind::WouldBlock)
    }

    /// Refuses a bus that is not in the log.
    ///
    /// # Errors
    /// [`NoBus`](Self::NoBus).
    pub fn check_bus(only: Option<&String>, buses: &[String]) -> Result<(), Self> {
        match only {
            Some(wanted) if !buses.contains(wanted) => {
                let found = if buses.is_empty() { "none".to_owned() } else { buses.join(", ") };
                Err(Self::NoBus { wanted: wanted.clone(), found })
            }
            _ => Ok(()),
        }
    }

    /// The remark for a log of several buses of which all are used.
    pub fn several_buses(buses: &[String]) -> String {
        format!(
            "the log has frames of the buses {}; each signal is taken from the bus on which it appears \
             first; ⟨bus NAME⟩ selects one bus",
            buses.join(", ")
        )
    }
}

/// Meaning of the time stamps.
#[derive(Clone, Copy, Debug)]
enum Stamps {
    /// Not known yet; some frames must be read first.
    Unknown,
    /// Points in time.
    Times,
    /// Time since the previous frame (`candump -td`), with the sum so far, µs.
    Differences(u64),
}

/// A frame that waits until the meaning of the time stamps is known.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    time_us: u64,
    frame: Option<Frame>,
}

/// Reads a candump log in constant memory. Lines that are not valid are skipped and counted.
#[derive(Debug)]
pub struct CandumpReader<R> {
    input: R,
    line: Vec<u8>,
    number: u64,
    /// The only bus that is used; `None` uses all buses.
    only: Option<String>,
    buses: Vec<String>,
    stamps: Stamps,
    ahead: VecDeque<Waiting>,
    ended: bool,
    /// Number of lines with a time stamp, the first time stamp, µs, and whether another one has followed.
    stamped: u64,
    first_us: u64,
    advances: bool,
    /// Number of frames of the buses in use.
    frames: u64,
    without_time: u64,
    malformed: u64,
    error_frames: u64,
    first_malformed: Option<(u64, CandumpError)>,
    first_error: Option<u64>,
    fresh: [bool; 3],
}

impl<R: BufRead> CandumpReader<R> {
    /// A reader at the beginning of a log. With `bus`, only frames of this bus are used.
    pub fn new(input: R, bus: Option<String>) -> Self {
        Self {
            input,
            line: Vec::new(),
            number: 0,
            only: bus,
            buses: Vec::new(),
            stamps: Stamps::Unknown,
            ahead: VecDeque::new(),
            ended: false,
            stamped: 0,
            first_us: 0,
            advances: false,
            frames: 0,
            without_time: 0,
            malformed: 0,
            error_frames: 0,
            first_malformed: None,
            first_error: None,
            fresh: [false; 3],
        }
    }

    /// The next data frame; `None` at the end.
    ///
    /// # Errors
    /// [`CandumpFault`]. Reading ends after an error, except after a [pause](CandumpFault::is_pause).
    pub fn next_frame(&mut self) -> Result<Option<Frame>, CandumpFault> {
        loop {
            if !matches!(self.stamps, Stamps::Unknown)
                && let Some(waiting) = self.ahead.pop_front()
            {
                if let Some(frame) = self.timed(waiting) {
                    self.frames += 1;
                    return Ok(Some(frame));
                }
            } else if self.ended {
                return Ok(None);
            } else {
                self.read_line()?;
            }
        }
    }

    /// Reads a line. At the end of the log, returns an error if something required was missing.
    fn read_line(&mut self) -> Result<(), CandumpFault> {
        let read = self.input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.line);
        let line = self.number + 1;
        let bytes = read.map_err(|source| CandumpFault::Read { line, source })?;
        if bytes == 0 && self.line.is_empty() {
            self.ended = true;
            self.decide();
            return self.complete();
        }
        self.number = line;
        let mut bytes = std::mem::take(&mut self.line);
        match parse(&String::from_utf8_lossy(&bytes)) {
            Ok(Some(line)) => self.take(&line),
            Ok(None) => {}
            Err(error) => self.pass_over(error)?,
        }
        bytes.clear();
        self.line = bytes;
        Ok(())
    }

    fn take(&mut self, line: &Line<'_>) {
        if self.stamped == 0 {
            self.first_us = line.time_us;
        }
        self.stamped += 1;
        self.advances |= line.time_us != self.first_us;
        let bus = self.bus(line.interface);
        let listened = self.only.as_ref().is_none_or(|only| only == line.interface);
        if listened && line.content == Content::Error {
            self.error_frames += 1;
            if self.first_error.is_none() {
                (self.first_error, self.fresh[1]) = (Some(self.number), true);
            }
        }
        let frame = match line.content {
            Content::Data(mut frame) if listened => {
                frame.bus = bus;
                Some(frame)
            }
            _ => None,
        };
        self.ahead.push_back(Waiting { time_us: line.time_us, frame });
        if matches!(self.stamps, Stamps::Unknown) {
            if !line.plain || line.time_us >= RELATIVE_US {
                self.stamps = Stamps::Times;
            } else if self.ahead.len() >= LOOK {
                self.decide();
            }
        }
    }

    fn pass_over(&mut self, error: CandumpError) -> Result<(), CandumpFault> {
        self.malformed += 1;
        if self.first_malformed.is_none() {
            (self.first_malformed, self.fresh[0]) = (Some((self.number, error)), true);
        }
        self.without_time += u64::from(error == CandumpError::NoTime);
        if self.stamped == 0 && self.without_time >= PATIENCE { self.untimed() } else { Ok(()) }
    }

    fn untimed(&mut self) -> Result<(), CandumpFault> {
        self.ended = true;
        let line = self.first_malformed.map_or(self.number, |(line, _)| line);
        Err(CandumpFault::NoTime { line })
    }

    fn complete(&mut self) -> Result<(), CandumpFault> {
        if self.stamped == 0 && self.without_time > 0 {
            return self.untimed();
        }
        // Differences that are all the same are frames at equal intervals.
        let steps = matches!(self.stamps, Stamps::Differences(_)) && self.first_us > 0;
        if self.stamped >= PATIENCE && !self.advances && !steps {
            let time_s = Duration::from_micros(self.first_us).as_secs_f64();
            return Err(CandumpFault::Standing { frames: self.stamped, time_s });
        }
        CandumpFault::check_bus(self.only.as_ref(), &self.buses)
    }

    /// Decides whether time stamps are times or differences. Times increase, while differences vary
    /// or are constant.
    fn decide(&mut self) {
        let times = || self.ahead.iter().map(|waiting| waiting.time_us);
        let backward = times().zip(times().skip(1)).filter(|(before, after)| after < before);
        let steps = self.ahead.len().saturating_sub(1);
        // Frames from two queues may be out of order, but hardly one in five.
        let jumping = 5 * backward.count() > steps;
        // The first difference is zero, or the time since a frame before the log.
        let standing = steps > 1 && times().skip(1).max() == times().nth(1);
        self.stamps = if jumping || standing { Stamps::Differences(0) } else { Stamps::Times };
    }

    fn timed(&mut self, Waiting { time_us, frame }: Waiting) -> Option<Frame> {
        let time_us = match &mut self.stamps {
            Stamps::Differences(sum_us) => {
                *sum_us = sum_us.saturating_add(time_us);
                *sum_us
            }
            Stamps::Unknown | Stamps::Times => time_us,
        };
        frame.map(|mut frame| {
            frame.time_us = time_us;
            frame
        })
    }

    fn bus(&mut self, name: &str) -> u8 {
        let known = self.buses.iter().position(|bus| bus == name);
        let place = known.unwrap_or_else(|| {
            if self.buses.len() < MOST_BUSES {
                self.buses.push(name.to_owned());
                self.fresh[2] |= self.buses.len() == 2 && self.only.is_none();
            }
            self.buses.len() - 1
        });
        u8::try_from(place).unwrap_or(u8::MAX)
    }

    /// Number of data frames delivered.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The line that was read last, from one.
    pub fn line(&self) -> u64 {
        self.number
    }

    /// Number of lines that are not valid.
    pub fn malformed(&self) -> u64 {
        self.malformed
    }

    /// Number of error frames on the buses in use.
    pub fn error_frames(&self) -> u64 {
        self.error_frames
    }

    /// The findings that occurred for the first time since the last call.
    pub fn news(&mut self) -> Vec<String> {
        if self.fresh == [false; 3] {
            return Vec::new();
        }
        let fresh = std::mem::take(&mut self.fresh);
        self.sentences()
            .into_iter()
            .zip(fresh)
            .filter_map(|(s, fresh)| s.filter(|_| fresh))
            .collect()
    }

    /// All findings with their counts.
    pub fn remarks(&self) -> Vec<String> {
        let counts = [self.malformed, self.error_frames, 0];
        let counted = |(sentence, count): (Option<String>, u64)| {
            sentence.map(|s| if count > 1 { format!("{s} ({count} such lines in all)") } else { s })
        };
        self.sentences().into_iter().zip(counts).filter_map(counted).collect()
    }

    fn sentences(&self) -> [Option<String>; 3] {
        [
            self.first_malformed.map(|(line, error)| format!("line {line}: skipped: {error}")),
            self.first_error
                .map(|line| format!("line {line}: an error frame reports an error on the bus")),
            (self.buses.len() > 1 && self.only.is_none())
                .then(|| CandumpFault::several_buses(&self.buses)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reader(text: &str, bus: Option<&str>) -> CandumpReader<io::Cursor<String>> {
        CandumpReader::new(io::Cursor::new(text.to_owned()), bus.map(str::to_owned))
    }

    fn times_us(text: &str) -> Vec<u64> {
        let mut reader = reader(text, None);
        std::iter::from_fn(|| reader.next_frame().unwrap()).map(|frame| frame.time_us).collect()
    }

    /// The same drive with the time stamps of `-ta`, `-tz` and `-td` gives the same times except
    /// for the origin.
    #[test]
    fn times_and_differences_are_told_apart() {
        // One frame every 10 ms with jitter, and sometimes three frames at once.
        let times: Vec<u64> =
            (0..300_u64).map(|k| 10_000 * (k - k % 3) + k * k * 37 % 900).collect();
        let mut sorted = times;
        sorted.sort_unstable();
        let text = |stamps: &[u64]| -> String {
            let line = |us: &u64| {
                format!(" ({:03}.{:06})  can0  123   [1]  00\n", us / 1_000_000, us % 1_000_000)
            };
            stamps.iter().map(line).collect()
        };
        let zero: Vec<u64> = sorted.iter().map(|us| us - sorted[0]).collect();
        let absolute: Vec<u64> = zero.iter().map(|us| us + 1_700_000_000_000_000).collect();
        let mut differences = vec![0];
        differences.extend(zero.windows(2).map(|pair| pair[1] - pair[0]));
        assert_eq!(times_us(&text(&absolute)), absolute);
        assert_eq!(times_us(&text(&zero)), zero);
        assert_eq!(times_us(&text(&differences)), zero);
        // Exactly periodic frames, few frames, one frame.
        assert_eq!(times_us(&text(&[0, 5, 5, 5])), [0, 5, 10, 15]);
        assert_eq!(times_us(&text(&[0, 5, 10, 15])), [0, 5, 10, 15]);
        assert_eq!(times_us(&text(&[7])), [7]);
    }

    /// The compact form never contains differences, so frames with equal time stamps remain
    /// unchanged.
    #[test]
    fn compact_time_stamps_are_times() {
        assert_eq!(times_us("(1.000000) can0 123#\n(1.000000) can0 124#\n"), [1_000_000; 2]);
    }

    #[test]
    fn a_log_without_time_stamps_says_which_flag_mends_it() {
        let line = "  can1  18F11031   [8]  00 11 22 33 44 55 66 77\n";
        for count in [1, 9, 5000] {
            let mut reader = reader(&line.repeat(count), None);
            let error = reader.next_frame().unwrap_err().to_string();
            assert!(error.starts_with("line 1: ") && error.contains("candump -L"), "{error}");
            assert!(reader.next_frame().unwrap().is_none());
            assert!(reader.line() <= PATIENCE);
        }
        // In a log with time stamps, one such line is an invalid line.
        let text = format!("{line}(1.000000) can0 123#00\n");
        let mut reader = reader(&text, None);
        assert!(reader.next_frame().unwrap().is_some());
        assert_eq!(reader.malformed(), 1);
    }

    /// In either form of candump; differences may all be the same.
    #[test]
    fn a_clock_that_stands_still_is_an_error() {
        let end = |line: &str| {
            let mut reader = reader(&line.repeat(10), None);
            loop {
                match reader.next_frame() {
                    Ok(Some(_)) => {}
                    Ok(None) => return None,
                    Err(error) => return Some(error.to_string()),
                }
            }
        };
        for (line, time) in [
            ("(0.000000) can0 123#00\n", "all 10 frames are 0 s"),
            ("(1700000000.500000) can0 123#00\n", "are 1700000000.5 s"),
            (" (000.000000)  can0  123   [1]  00\n", "are 0 s"),
        ] {
            let error = end(line).unwrap();
            assert!(error.contains(time) && error.contains("candump -L"), "{error}");
        }
        assert_eq!(end(" (000.010000)  can0  123   [1]  00\n"), None);
    }

    const TWO: &str = "(1.000000) can0 123#00\n(1.100000) can1 123#01\n\
                       (1.200000) can1 20000080#0000000000000000\ngarbage\n\
                       (1.300000) can0 123#02\n(1.400000) can1 20000080#0000000000000000\n";

    #[test]
    fn a_log_of_two_buses_can_be_narrowed_to_one() {
        let seen = |bus: Option<&str>| -> (Vec<(u8, u8)>, Vec<String>, u64) {
            let mut reader = reader(TWO, bus);
            let frames: Vec<_> = std::iter::from_fn(|| reader.next_frame().unwrap())
                .map(|frame| (frame.bus, frame.data()[0]))
                .collect();
            (frames, reader.news(), reader.error_frames())
        };
        let (frames, news, errors) = seen(None);
        assert_eq!(frames, [(0, 0), (1, 1), (0, 2)]);
        assert_eq!(errors, 2);
        assert!(news[0].starts_with("line 4: skipped") && news[1].starts_with("line 3: an error"));
        assert!(news[2].contains("can0, can1") && news[2].contains("⟨bus"), "{news:?}");
        let (frames, news, errors) = seen(Some("can0"));
        assert_eq!((frames, errors, news.len()), (vec![(0, 0), (0, 2)], 0, 1));
        let (frames, _, errors) = seen(Some("can1"));
        assert_eq!((frames, errors), (vec![(1, 1)], 2));
    }

    #[test]
    fn news_come_once_and_remarks_are_counted() {
        let mut reader = reader(TWO, None);
        while reader.next_frame().unwrap().is_some() {}
        assert_eq!(reader.news().len(), 3);
        assert!(reader.news().is_empty());
        assert!(reader.remarks()[1].ends_with("(2 such lines in all)"));
    }

    #[test]
    fn a_bus_that_is_not_there_is_an_error_with_those_there_are() {
        let mut reader = reader(TWO, Some("can7"));
        let error = reader.next_frame().unwrap_err().to_string();
        assert!(error.contains("`can7`") && error.contains("can0, can1"), "{error}");
    }
}
