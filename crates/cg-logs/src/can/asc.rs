//! A reader of logs in the format ASC, one frame at a time.
//!
//! ```text
//!     date Wed May 1 12:00:00.000 pm 2024
//!     base hex  timestamps absolute
//!        0.015991 1  18F0090Bx       Rx   d 8 7E 7D FF 00 7D 80 7D FF  Length = 0 BitCount = 64
//!        0.020000 CANFD   1 Rx  18F0090Bx  Name  1 0 d 12 7E 7D FF 00 7D 80 7D FF 00 00 00 00
//!        0.030000 1  ErrorFrame
//! ```
//!
//! Time stamps count from the start of the measurement. Lines of other events (statistics, comments,
//! trigger blocks) are passed over.

use std::io::{BufRead, Read};

use super::frame::{EXTENDED_MASK, Frame, ROOM};
use super::reader::{CandumpFault, LONGEST_LINE, MOST_BUSES};

/// Whether a log with this beginning is in the format ASC.
pub(crate) fn is_asc(head: &str) -> bool {
    let mut lines = head.lines();
    // A stream may have given its first line only. The header of a table has delimiters.
    let dated = |line: &str| line.starts_with("date ") && !line.contains([',', ';', '\t']);
    lines.clone().next().is_some_and(dated)
        || lines.any(|line| {
            let mut words = line.split_ascii_whitespace();
            words.next() == Some("base") && matches!(words.next(), Some("hex" | "dec"))
        })
}

/// Content of a line.
#[derive(Debug, PartialEq, Eq)]
enum Content<'a> {
    Frame {
        bus: &'a str,
        frame: Frame,
    },
    Error,
    /// A line of a frame that cannot be read.
    Malformed,
}

/// Reads a log in constant memory.
#[derive(Debug)]
pub struct AscReader<R> {
    input: R,
    line: Vec<u8>,
    number: u64,
    only: Option<String>,
    buses: Vec<String>,
    radix: u32,
    /// Sum of the time stamps so far, µs, if they are differences.
    sum_us: Option<u64>,
    frames: u64,
    error_frames: u64,
    malformed: u64,
    first_malformed: u64,
}

impl<R: BufRead> AscReader<R> {
    /// A reader at the beginning of a log. With `bus`, only frames of this bus (its number) are used.
    pub fn new(input: R, bus: Option<String>) -> Self {
        Self {
            input,
            line: Vec::new(),
            number: 0,
            only: bus,
            buses: Vec::new(),
            radix: 16,
            sum_us: None,
            frames: 0,
            error_frames: 0,
            malformed: 0,
            first_malformed: 0,
        }
    }

    /// The next data frame; `None` at the end.
    ///
    /// # Errors
    /// [`CandumpFault`]. Reading ends after an error.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, CandumpFault> {
        loop {
            self.line.clear();
            let read = self.input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.line);
            let line = self.number + 1;
            if read.map_err(|source| CandumpFault::Read { line, source })? == 0 {
                return self.complete().map(|()| None);
            }
            self.number = line;
            let bytes = std::mem::take(&mut self.line);
            let frame = self.take(&String::from_utf8_lossy(&bytes));
            self.line = bytes;
            if frame.is_some() {
                self.frames += 1;
                return Ok(frame);
            }
        }
    }

    fn take(&mut self, line: &str) -> Option<Frame> {
        let mut words = line.split_ascii_whitespace();
        let first = words.next()?;
        if first == "base" {
            self.radix = if words.next() == Some("dec") { 10 } else { 16 };
            let relative = words.eq(["timestamps", "relative"]);
            self.sum_us = relative.then_some(0);
            return None;
        }
        let stamp_us = microseconds(first)?;
        let time_us = match &mut self.sum_us {
            Some(sum_us) => {
                *sum_us = sum_us.saturating_add(stamp_us);
                *sum_us
            }
            None => stamp_us,
        };
        match event(time_us, words, self.radix)? {
            Content::Frame { bus, mut frame } => {
                frame.bus = self.bus(bus);
                self.only.as_ref().is_none_or(|only| only == bus).then_some(frame)
            }
            Content::Error => {
                self.error_frames += 1;
                None
            }
            Content::Malformed => {
                self.malformed += 1;
                if self.malformed == 1 {
                    self.first_malformed = self.number;
                }
                None
            }
        }
    }

    fn bus(&mut self, name: &str) -> u8 {
        let known = self.buses.iter().position(|bus| bus == name);
        let place = known.unwrap_or_else(|| {
            if self.buses.len() < MOST_BUSES {
                self.buses.push(name.to_owned());
            }
            self.buses.len() - 1
        });
        u8::try_from(place).unwrap_or(u8::MAX)
    }

    fn complete(&self) -> Result<(), CandumpFault> {
        CandumpFault::check_bus(self.only.as_ref(), &self.buses)
    }

    /// Number of data frames delivered.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The line that was read last, from one.
    pub fn line(&self) -> u64 {
        self.number
    }

    /// All findings with their counts.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.malformed > 0 {
            let (line, count) = (self.first_malformed, self.malformed);
            remarks.push(format!("line {line}: skipped: not a whole frame ({count} in all)"));
        }
        if self.error_frames > 0 {
            remarks.push(format!("{} error frames report errors on the bus", self.error_frames));
        }
        if self.buses.len() > 1 && self.only.is_none() {
            remarks.push(CandumpFault::several_buses(&self.buses));
        }
        remarks
    }
}

/// Reads the words after the time stamp; `None` if they are another event.
fn event<'a>(
    time_us: u64,
    mut words: impl Iterator<Item = &'a str> + Clone,
    radix: u32,
) -> Option<Content<'a>> {
    let first = words.next()?;
    if first == "CANFD" {
        return flexible(time_us, words, radix);
    }
    if !first.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let word = words.next()?;
    if word == "ErrorFrame" {
        return Some(Content::Error);
    }
    let (identifier, extended) = identified(word, radix)?;
    if !matches!(words.next()?, "Rx" | "Tx" | "TxRq") || words.next()? != "d" {
        return None; // a remote frame contains no data
    }
    let length = words.next().and_then(|word| usize::from_str_radix(word, radix).ok());
    Some(framed(time_us, (first, identifier, extended), length, words, radix))
}

/// The words after `CANFD`: bus, direction, identifier, perhaps a name, two flags, code and length.
fn flexible<'a>(
    time_us: u64,
    mut words: impl Iterator<Item = &'a str> + Clone,
    radix: u32,
) -> Option<Content<'a>> {
    let bus = words.next()?;
    let direction = words.next()?;
    if direction == "ErrorFrame" {
        return Some(Content::Error);
    }
    let (identifier, extended) = identified(words.next()?, radix)?;
    let flag = |word: &str| matches!(word, "0" | "1");
    if !words.clone().next().is_some_and(flag) {
        words.next()?;
    }
    let flags = words.next().is_some_and(flag) && words.next().is_some_and(flag);
    words.next()?;
    let length = words.next().and_then(|word| word.parse().ok()).filter(|_| flags);
    Some(framed(time_us, (bus, identifier, extended), length, words, radix))
}

fn framed<'a>(
    time_us: u64,
    (bus, identifier, extended): (&'a str, u32, bool),
    length: Option<usize>,
    words: impl Iterator<Item = &'a str>,
    radix: u32,
) -> Content<'a> {
    let Some(length) = length.filter(|length| *length <= ROOM) else { return Content::Malformed };
    let byte = |word: &str| u8::from_str_radix(word, radix).ok();
    let data: Option<Vec<u8>> = words.take(length).map(byte).collect();
    let whole = data.filter(|data| data.len() == length);
    let frame = whole.and_then(|data| Frame::new(time_us, identifier, extended, &data));
    frame.map_or(Content::Malformed, |frame| Content::Frame { bus, frame })
}

/// Reads an identifier; also returns whether it has 29 bits, which an `x` says.
fn identified(word: &str, radix: u32) -> Option<(u32, bool)> {
    let digits = word.strip_suffix(['x', 'X']);
    let identifier = u32::from_str_radix(digits.unwrap_or(word), radix).ok()?;
    Some((identifier & EXTENDED_MASK, digits.is_some()))
}

fn microseconds(word: &str) -> Option<u64> {
    let seconds: f64 = word.parse().ok()?;
    let valid = (0.0..1e12).contains(&seconds) && word.as_bytes()[0].is_ascii_digit();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // within the range above
    valid.then(|| (seconds * 1e6).round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str, bus: Option<&str>) -> (Vec<Frame>, Vec<String>) {
        let mut reader = AscReader::new(text.as_bytes(), bus.map(str::to_owned));
        let frames = std::iter::from_fn(|| reader.next_frame().unwrap()).collect();
        (frames, reader.remarks())
    }

    const HEAD: &str = "date Wed May 1 12:00:00.000 pm 2024\nbase hex  timestamps absolute\n\
                        internal events logged\n// version 13.0.0\n\
                        Begin Triggerblock Wed May 1 12:00:00.000 pm 2024\n\
                        0.000000 Start of measurement\n";

    #[test]
    fn frames_of_all_kinds_are_read_and_other_events_passed_over() {
        let text = format!(
            "{HEAD}   0.015991 1  18F0090Bx       Rx   d 8 7E 7D FF 00 7D 80 7D FF  Length = 0\n\
             0.016 2  123             Tx   d 2 00 11\n 0.02 1  ErrorFrame\n\
             0.021 1  123             Rx   r\n 0.022 1  Statistic: D 0 R 0 XD 1 XR 0 E 0\n\
             0.03 CANFD   1 Rx  18F0090Bx  Name  1 0 9 12 01 02 03 04 05 06 07 08 09 0A 0B 0C 9 8\n\
             0.04 CANFD   1 Rx  123  1 0 1 1 0F\n 0.05 1  123 Rx d 3 00 11\nEnd TriggerBlock\n"
        );
        assert!(is_asc(&text) && !is_asc("time_s,roll_rad\n"));
        let (found, remarks) = frames(&text, None);
        let seen: Vec<_> = found
            .iter()
            .map(|f| (f.time_us, f.identifier, f.extended, f.bus, f.data().len()))
            .collect();
        assert_eq!(
            seen,
            [
                (15_991, 0x18F0_090B, true, 0, 8),
                (16_000, 0x123, false, 1, 2),
                (30_000, 0x18F0_090B, true, 0, 12),
                (40_000, 0x123, false, 0, 1),
            ]
        );
        assert_eq!(found[0].data()[..2], [0x7E, 0x7D]);
        assert_eq!(found[2].data()[11], 0x0C);
        assert!(remarks[0].contains("line 14: skipped") && remarks[1].contains("1 error frame"));
        assert!(remarks[2].contains("buses 1, 2"), "{remarks:?}");
        assert_eq!(frames(&text, Some("2")).0.len(), 1);
        let mut reader = AscReader::new(text.as_bytes(), Some("7".into()));
        assert!(matches!(reader.next_frame(), Err(CandumpFault::NoBus { .. })));
    }

    #[test]
    fn decimal_numbers_and_differences_of_time_are_read() {
        let text =
            "base dec  timestamps relative\n0.5 1  418384139x Rx d 2 16 255\n0.25 1 291 Rx d 1 7\n";
        let (found, _) = frames(text, None);
        assert_eq!(found[0].data(), [16, 255]);
        assert_eq!((found[0].identifier, found[0].extended), (0x18F0_090B, true));
        assert_eq!((found[1].time_us, found[1].identifier), (750_000, 0x123));
    }
}
