//! Lines in the text formats of candump.
//!
//! ```text
//!     (1700000000.123456) can0 18F0090B#7E7DFF007D807DFF                    -L, -l
//!      (1700000000.123456)  can0  18F0090B   [8]  7E 7D FF 00 7D 80 7D FF   -ta
//!      (000.010021)  can0  18F0090B   [8]  7E 7D FF 00 7D 80 7D FF          -td, -tz
//!      (2023-11-14 22:13:20.123456)  can0  123   [2]  00 11                 -tA
//!      can0  18F0090B   [8]  7E 7D FF 00 7D 80 7D FF                       no time, not usable
//! ```
//!
//! Seconds have 6 decimals, or 9 with `-N`. The compact form has `##` and a flag digit for CAN FD,
//! `#R` for a remote frame, and possibly `R` or `T` at the end. The plain form has direction and
//! flags after the interface (`-x`), and at the end the bytes as text (`-a`), `remote request` or
//! `ERRORFRAME`.

use std::fmt;

use super::frame::{EXTENDED_MASK, Frame, ROOM};

/// Bit that marks an error frame in the identifier.
const ERROR_FLAG: u32 = 0x2000_0000;

/// A line with a time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<'a> {
    /// Time stamp, µs.
    pub time_us: u64,
    /// Name of the interface that received the frame.
    pub interface: &'a str,
    /// Whether the line has the plain form, whose time stamps may be relative.
    pub plain: bool,
    /// Content of the line.
    pub content: Content,
}

/// Content of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// A data frame.
    Data(Frame),
    /// An error frame, which reports an error on the bus.
    Error,
    /// A remote frame, which contains no data.
    Remote,
}

/// The reason why a line of a candump log cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CandumpError {
    /// There is no `(seconds.fraction)` at the beginning.
    Time,
    /// The line is a frame in the plain form without a time stamp.
    NoTime,
    /// There is no interface name after the time.
    Interface,
    /// There is no identifier of 3 or 8 hexadecimal digits before a `#` or a length in brackets.
    Identifier,
    /// The data are not pairs of hexadecimal digits, or their number is wrong.
    Data,
}

impl fmt::Display for CandumpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Time => {
                "a line of a candump log begins with a time stamp like (1700000000.123456)"
            }
            Self::NoTime => {
                "the frame has no time stamp, which an estimate needs; record the log with \
                 `candump -L can0` (or `candump -ta can0`)"
            }
            Self::Interface => "the name of the interface is missing after the time stamp",
            Self::Identifier => {
                "expected an identifier of 3 or 8 hexadecimal digits and a # or a length, as in \
                 18F0090B# or 18F0090B [8]"
            }
            Self::Data => {
                "the data must be pairs of hexadecimal digits, as many as the length states, at \
                 most 8 (CAN FD: 64)"
            }
        })
    }
}

impl std::error::Error for CandumpError {}

/// Reads a line of a candump log; `None` if the line is blank or explains an error frame (`-e`).
///
/// # Errors
/// [`CandumpError`] with the part of the line that is wrong.
pub fn parse(line: &str) -> Result<Option<Line<'_>>, CandumpError> {
    if line.trim().is_empty() || line.starts_with('\t') {
        return Ok(None);
    }
    let line = line.trim();
    let Some(rest) = line.strip_prefix('(') else {
        let frame = plain(0, line.split_ascii_whitespace().skip(1));
        return Err(if frame.is_ok() { CandumpError::NoTime } else { CandumpError::Time });
    };
    let (time, rest) = rest.split_once(')').ok_or(CandumpError::Time)?;
    let time_us = microseconds(time).or_else(|| date_us(time)).ok_or(CandumpError::Time)?;
    let mut words = rest.split_ascii_whitespace();
    let interface = words.next().ok_or(CandumpError::Interface)?;
    let first = words.clone().next().ok_or(CandumpError::Identifier)?;
    let (content, plain) = match first.split_once('#') {
        Some((identifier, payload)) => (compact(time_us, identifier, payload)?, false),
        None => (plain(time_us, words)?, true),
    };
    Ok(Some(Line { time_us, interface, plain, content }))
}

fn compact(time_us: u64, identifier: &str, payload: &str) -> Result<Content, CandumpError> {
    let (identifier, extended) = identified(identifier)?;
    if extended && identifier & ERROR_FLAG != 0 {
        return Ok(Content::Error);
    }
    if payload.starts_with('R') {
        return Ok(Content::Remote);
    }
    let (digits, most) = match payload.strip_prefix('#') {
        Some(fd) => (fd.get(1..).ok_or(CandumpError::Data)?, ROOM),
        None => (payload, 8),
    };
    let pairs = digits.as_bytes().chunks(2).filter(|pair| *pair != b".");
    let (data, length) = bytes(pairs, most)?;
    framed(time_us, identifier, extended, &data[..length])
}

/// Reads the words after the interface: `RX - -  18F0090B   [8]  7E 7D FF 00 7D 80 7D FF
/// '~}..}.}.'`. The words before the identifier and after the bytes are ignored.
fn plain<'a>(
    time_us: u64,
    mut words: impl Iterator<Item = &'a str> + Clone,
) -> Result<Content, CandumpError> {
    let mut word = words.next().ok_or(CandumpError::Identifier)?;
    if matches!(word, "RX" | "TX") {
        word = words.nth(2).ok_or(CandumpError::Identifier)?;
    }
    let (identifier, extended) = identified(word)?;
    let length = words
        .next()
        .and_then(|word| word.strip_prefix('[')?.strip_suffix(']')?.parse::<usize>().ok())
        .ok_or(CandumpError::Identifier)?;
    if extended && identifier & ERROR_FLAG != 0 {
        return Ok(Content::Error);
    }
    if words.clone().next() == Some("remote") {
        return Ok(Content::Remote);
    }
    let (data, found) = bytes(words.map(str::as_bytes).take(length), ROOM)?;
    if found != length {
        return Err(CandumpError::Data);
    }
    framed(time_us, identifier, extended, &data[..length])
}

fn framed(
    time_us: u64,
    identifier: u32,
    extended: bool,
    data: &[u8],
) -> Result<Content, CandumpError> {
    let frame = Frame::new(time_us, identifier & EXTENDED_MASK, extended, data);
    frame.map(Content::Data).ok_or(CandumpError::Data)
}

/// Reads an identifier; also returns whether it has 29 bits.
fn identified(digits: &str) -> Result<(u32, bool), CandumpError> {
    let extended = match digits.len() {
        3 => false,
        8 => true,
        _ => return Err(CandumpError::Identifier),
    };
    Ok((hexadecimal(digits).ok_or(CandumpError::Identifier)?, extended))
}

fn bytes<'a>(
    pairs: impl Iterator<Item = &'a [u8]>,
    most: usize,
) -> Result<([u8; ROOM], usize), CandumpError> {
    let mut data = [0; ROOM];
    let mut length = 0;
    for pair in pairs {
        let text = std::str::from_utf8(pair).map_err(|_| CandumpError::Data)?;
        let byte = (text.len() == 2).then(|| hexadecimal(text)).flatten();
        let place = data[..most].get_mut(length).ok_or(CandumpError::Data)?;
        *place = byte.and_then(|b| u8::try_from(b).ok()).ok_or(CandumpError::Data)?;
        length += 1;
    }
    Ok((data, length))
}

/// Reads a hexadecimal number without a sign; `from_str_radix` alone would accept a sign.
fn hexadecimal(text: &str) -> Option<u32> {
    text.bytes().all(|byte| byte.is_ascii_hexdigit()).then(|| u32::from_str_radix(text, 16).ok())?
}

/// Reads a decimal number without a sign.
fn decimal(text: &str) -> Option<u64> {
    (!text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit()))
        .then(|| text.parse().ok())?
}

fn microseconds(text: &str) -> Option<u64> {
    let (seconds, fraction) = text.split_once('.')?;
    if !(6..=9).contains(&fraction.len()) {
        return None;
    }
    decimal(fraction)?;
    let micros = decimal(fraction.get(..6)?)?;
    decimal(seconds)?.checked_mul(1_000_000)?.checked_add(micros)
}

/// Reads `2023-11-14 22:13:20.123456`. The log does not contain the time zone, so UTC is assumed.
fn date_us(text: &str) -> Option<u64> {
    let (date, time) = text.split_once(' ')?;
    let mut date = date.splitn(3, '-').map(decimal);
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let mut time = time.splitn(3, ':');
    let (hour, minute) = (decimal(time.next()?)?, decimal(time.next()?)?);
    let second_us = microseconds(time.next()?)?;
    if !(1970..=9999).contains(&year) || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // The last second of a day may be a leap second.
    if hour > 23 || minute > 59 || second_us >= 61_000_000 {
        return None;
    }
    // Number of days since 1970 in years that begin in March (Gregorian calendar).
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1;
    // From 1 March of the year 0 to 1 January 1970.
    let days = days.checked_sub(719_468)?;
    Some(((days * 24 + hour) * 60 + minute) * 60_000_000 + second_us)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Reads a line with a frame; returns the frame and its bus.
    fn read(line: &str) -> (Frame, &str) {
        match parse(line) {
            Ok(Some(Line { content: Content::Data(frame), interface, .. })) => (frame, interface),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn all_forms_of_a_compact_line_are_read() {
        let (frame, bus) = read("(1436509052.249713) vcan0 18F0090B#0011FF");
        assert_eq!((frame.time_us, bus), (1_436_509_052_249_713, "vcan0"));
        assert_eq!((frame.identifier, frame.extended), (0x18F0_090B, true));
        assert_eq!(frame.data(), [0x00, 0x11, 0xFF]);
        let (nano, _) = read("(1436509052.249713999) can1 123# R\r");
        assert_eq!((nano.time_us, nano.identifier), (1_436_509_052_249_713, 0x123));
        assert_eq!((nano.extended, nano.data()), (false, &[][..]));
        let (fd, _) = read("(0.000000) can0 18FF1234##1112233445566778899AABB");
        assert_eq!(fd.data().len(), 11);
        assert_eq!(fd.data()[0], 0x11);
    }

    /// Lines as candump's `sprint_long_canframe` writes them with various flags.
    #[test]
    fn all_forms_of_a_plain_line_are_read() {
        for (line, time_us) in [
            (
                " (1436509052.249713)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF",
                1_436_509_052_249_713,
            ),
            (
                " (1436509052.249713123)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF",
                1_436_509_052_249_713,
            ),
            (" (000.010021)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF\r\n", 10_021),
            (
                " (2015-07-10 06:17:32.249713)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF",
                1_436_509_052_249_713,
            ),
            (
                " (2016-02-29 00:00:00.000000)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF",
                1_456_704_000_000_000,
            ),
            (" (000.010021)  can1  RX - -  18F11031   [8]  00 11 22 33 44 55 66 FF", 10_021),
            (" (000.010021)  can1  18F11031   [8]  00 11 22 33 44 55 66 FF   '..\"3DUf.'", 10_021),
        ] {
            let (frame, bus) = read(line);
            assert_eq!((frame.time_us, bus), (time_us, "can1"), "{line}");
            assert_eq!((frame.identifier, frame.extended), (0x18F1_1031, true), "{line}");
            assert_eq!(frame.data(), [0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0xFF], "{line}");
        }
        let (short, _) = read(" (000.000000)  can0  123   [0] ");
        assert_eq!((short.identifier, short.extended, short.data()), (0x123, false, &[][..]));
        let (fd, _) = read(" (000.000000)  can0  123  [12]  00 11 22 33 44 55 66 77 88 99 AA BB");
        assert_eq!(fd.data().len(), 12);
    }

    #[test]
    fn error_frames_are_told_apart_and_what_is_no_frame_is_passed_over() {
        for (line, expected) in [
            ("(1.000000) can0 20000004#0008000000000000", Content::Error),
            (
                " (000.000000)  can0  20000004   [8]  00 08 00 00 00 00 00 00   ERRORFRAME",
                Content::Error,
            ),
            ("(1.000000) can0 123#R", Content::Remote),
            ("(1.000000) can0 123#R8", Content::Remote),
            (" (000.000000)  can0  123   [8]  remote request", Content::Remote),
        ] {
            let found = parse(line).unwrap().unwrap();
            assert_eq!((found.content, found.interface), (expected, "can0"), "{line}");
        }
        for line in ["", "  \r\n", "\tcontroller-problem{rx-error-warning}"] {
            assert_eq!(parse(line), Ok(None), "{line}");
        }
    }

    #[test]
    fn a_bad_line_says_what_is_wrong() {
        for (line, error) in [
            ("1.0 can0 123#00", CandumpError::Time),
            ("(1.5) can0 123#00", CandumpError::Time),
            ("(-1.500000) can0 123#00", CandumpError::Time),
            ("(+1.500000) can0 123#00", CandumpError::Time),
            ("(2015-13-10 06:17:32.249713) can0 123#00", CandumpError::Time),
            ("(2015-07-10 24:17:32.249713) can0 123#00", CandumpError::Time),
            ("(2015-07-10 06:60:32.249713) can0 123#00", CandumpError::Time),
            ("(2015-07-10 06:17:61.000000) can0 123#00", CandumpError::Time),
            // This input once caused an overflow.
            ("(2015-07-10 9999999999999999999:17:32.249713) can0 123#00", CandumpError::Time),
            ("(2015-07-10 06:17:18446744073709.551615) can0 123#00", CandumpError::Time),
            ("time_s,roll_rad", CandumpError::Time),
            ("  can1  18F11031   [8]  00 11 22 33 44 55 66 77", CandumpError::NoTime),
            ("  can1  123   [8]  remote request", CandumpError::NoTime),
            ("(1.500000)", CandumpError::Interface),
            ("(1.500000) can0", CandumpError::Identifier),
            ("(1.500000) can0 1234#00", CandumpError::Identifier),
            ("(1.500000) can0 +12#00", CandumpError::Identifier),
            ("(1.500000) can0 123 00 11", CandumpError::Identifier),
            ("(1.500000) can0 123 [x] 00 11", CandumpError::Identifier),
            ("(1.500000) can0 123#0", CandumpError::Data),
            ("(1.500000) can0 123#0G", CandumpError::Data),
            ("(1.500000) can0 123#001122334455667788", CandumpError::Data),
            ("(1.500000) can0 123 [3] 00 11", CandumpError::Data),
            ("(1.500000) can0 123 [2] 00 1", CandumpError::Data),
            ("(1.500000) can0 123 [99] 00 11", CandumpError::Data),
        ] {
            assert_eq!(parse(line), Err(error), "{line}");
        }
    }

    proptest! {
        #[test]
        fn a_written_frame_is_read_back(
            time_us in 0_u64..4_000_000_000_000_000,
            identifier in 0_u32..=EXTENDED_MASK,
            data in prop::collection::vec(any::<u8>(), 0..=8),
        ) {
            let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
            let pairs: Vec<String> = data.iter().map(|byte| format!("{byte:02X}")).collect();
            let length = data.len();
            for line in [
                format!("({seconds}.{micros:06}) can0 {identifier:08X}#{}", pairs.concat()),
                format!(
                    " ({seconds:03}.{micros:06})  can0  {identifier:08X}   [{length}]  {}",
                    pairs.join(" ")
                ),
            ] {
                let frame = Frame::new(time_us, identifier, true, &data).unwrap();
                let line = parse(&line).unwrap().unwrap();
                prop_assert_eq!(line.interface, "can0");
                prop_assert_eq!((line.content, line.time_us), (Content::Data(frame), time_us));
            }
        }

        #[test]
        fn any_text_is_read_or_refused(line in "\\PC{0,80}") {
            let _ = parse(&line);
        }
    }
}
