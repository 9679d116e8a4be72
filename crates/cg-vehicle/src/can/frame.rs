//! A frame and its text form.
//!
//! ```text
//!     (1700000000.123456) can0 18F0090B#7E7DFF007D807DFF
//! ```
//!
//! as `candump -L` and `candump -l` write it: seconds with 6 (or, with `-N`, 9) decimals, `##` and
//! a flag digit for CAN FD, `#R` for a remote frame, at the end perhaps `R` or `T`.

use std::fmt;

/// Bit of an identifier that marks an error frame in a log.
const ERROR_FLAG: u32 = 0x2000_0000;
const EXTENDED_MASK: u32 = 0x1FFF_FFFF;
/// The greatest payload, that of CAN FD.
const ROOM: usize = 64;

/// A data frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time stamp of its reception, µs; mostly Unix time.
    pub time_us: u64,
    /// The identifier, 11 or 29 bits.
    pub identifier: u32,
    /// Whether it has 29 bits.
    pub extended: bool,
    data: [u8; ROOM],
    length: u8,
}

/// What is wrong with a line of a candump log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandumpError {
    /// No `(seconds.fraction)` at its beginning.
    Time,
    /// No interface name after the time.
    Interface,
    /// No `#` after an identifier of 3 or 8 hexadecimal digits.
    Identifier,
    /// The data are no pairs of hexadecimal digits, or too many.
    Data,
}

impl fmt::Display for CandumpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Time => {
                "a line of a candump log begins with a time stamp like (1700000000.123456)"
            }
            Self::Interface => "the interface's name is missing after the time stamp",
            Self::Identifier => {
                "expected an identifier of 3 or 8 hexadecimal digits and a #, as in 18F0090B#"
            }
            Self::Data => "the data must be pairs of hexadecimal digits, 8 at most (CAN FD: 64)",
        })
    }
}

impl std::error::Error for CandumpError {}

impl Frame {
    /// A data frame; `None` if there are more than 64 bytes.
    pub fn new(time_us: u64, identifier: u32, extended: bool, bytes: &[u8]) -> Option<Self> {
        let mut data = [0; ROOM];
        data.get_mut(..bytes.len())?.copy_from_slice(bytes);
        let length = u8::try_from(bytes.len()).ok()?;
        Some(Self { time_us, identifier, extended, data, length })
    }

    /// Its payload.
    pub fn data(&self) -> &[u8] {
        // The length was checked against the room.
        self.data.get(..usize::from(self.length)).unwrap_or_default()
    }

    /// Reads a line of a candump log, without its line feed; `None` for error and remote frames and
    /// for blank lines.
    ///
    /// # Errors
    /// [`CandumpError`] says which part of the line is wrong.
    pub fn from_candump(line: &str) -> Result<Option<Self>, CandumpError> {
        let line = line.trim();
        if line.is_empty() {
            return Ok(None);
        }
        let (time, rest) = line
            .strip_prefix('(')
            .and_then(|rest| rest.split_once(')'))
            .ok_or(CandumpError::Time)?;
        let time_us = microseconds(time).ok_or(CandumpError::Time)?;
        let mut words = rest.split_ascii_whitespace();
        words.next().ok_or(CandumpError::Interface)?;
        let frame = words.next().ok_or(CandumpError::Identifier)?;
        let (identifier, payload) = frame.split_once('#').ok_or(CandumpError::Identifier)?;
        let extended = match identifier.len() {
            3 => false,
            8 => true,
            _ => return Err(CandumpError::Identifier),
        };
        let identifier = hexadecimal(identifier).ok_or(CandumpError::Identifier)?;
        if payload.starts_with('R') || (extended && identifier & ERROR_FLAG != 0) {
            return Ok(None);
        }
        let (digits, most) = match payload.strip_prefix('#') {
            Some(fd) => (fd.get(1..).ok_or(CandumpError::Data)?, ROOM),
            None => (payload, 8),
        };
        let mut data = [0; ROOM];
        let mut length = 0;
        for pair in digits.as_bytes().chunks(2).filter(|pair| *pair != b".") {
            let text = std::str::from_utf8(pair).map_err(|_| CandumpError::Data)?;
            let byte = (text.len() == 2).then(|| hexadecimal(text)).flatten();
            let place = data[..most].get_mut(length).ok_or(CandumpError::Data)?;
            *place = byte.and_then(|b| u8::try_from(b).ok()).ok_or(CandumpError::Data)?;
            length += 1;
        }
        let identifier = identifier & EXTENDED_MASK;
        Ok(Self::new(time_us, identifier, extended, &data[..length]))
    }
}

/// A whole number of hexadecimal digits (`from_str_radix` alone would take a sign).
fn hexadecimal(text: &str) -> Option<u32> {
    text.bytes().all(|byte| byte.is_ascii_hexdigit()).then(|| u32::from_str_radix(text, 16).ok())?
}

fn microseconds(text: &str) -> Option<u64> {
    let (seconds, fraction) = text.split_once('.')?;
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !digits(seconds) || !digits(fraction) || !(6..=9).contains(&fraction.len()) {
        return None;
    }
    let micros: u64 = fraction.get(..6)?.parse().ok()?;
    seconds.parse::<u64>().ok()?.checked_mul(1_000_000)?.checked_add(micros)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(line: &str) -> Result<Option<Frame>, CandumpError> {
        Frame::from_candump(line)
    }

    #[test]
    fn all_forms_of_a_line_are_read() {
        let frame = read("(1436509052.249713) vcan0 18F0090B#0011FF").unwrap().unwrap();
        assert_eq!(frame.time_us, 1_436_509_052_249_713);
        assert_eq!((frame.identifier, frame.extended), (0x18F0_090B, true));
        assert_eq!(frame.data(), [0x00, 0x11, 0xFF]);
        let nano = read("(1436509052.249713999) can1 123# R\r").unwrap().unwrap();
        assert_eq!((nano.time_us, nano.identifier), (1_436_509_052_249_713, 0x123));
        assert_eq!((nano.extended, nano.data()), (false, &[][..]));
        let fd = read("(0.000000) can0 18FF1234##1112233445566778899AABB").unwrap().unwrap();
        assert_eq!(fd.data().len(), 11);
        assert_eq!(fd.data()[0], 0x11);
    }

    #[test]
    fn what_is_no_data_frame_is_passed_over() {
        for line in ["", "  ", "(1.000000) can0 123#R", "(1.000000) can0 20000004#0008000000000000"]
        {
            assert_eq!(read(line), Ok(None), "{line}");
        }
    }

    #[test]
    fn a_bad_line_says_what_is_wrong() {
        for (line, error) in [
            ("1.0 can0 123#00", CandumpError::Time),
            ("(1.5) can0 123#00", CandumpError::Time),
            ("(-1.500000) can0 123#00", CandumpError::Time),
            ("(1.500000)", CandumpError::Interface),
            ("(1.500000) can0", CandumpError::Identifier),
            ("(1.500000) can0 1234#00", CandumpError::Identifier),
            ("(1.500000) can0 +12#00", CandumpError::Identifier),
            ("(1.500000) can0 123#0", CandumpError::Data),
            ("(1.500000) can0 123#0G", CandumpError::Data),
            ("(1.500000) can0 123#001122334455667788", CandumpError::Data),
        ] {
            assert_eq!(read(line), Err(error), "{line}");
        }
    }

    proptest! {
        #[test]
        fn a_written_frame_is_read_back(
            time_us in 0_u64..4_000_000_000_000_000,
            identifier in 0_u32..=EXTENDED_MASK,
            data in prop::collection::vec(any::<u8>(), 0..=8),
        ) {
            let digits = data.iter().fold(String::new(), |text, byte| format!("{text}{byte:02X}"));
            let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
            let line = format!("({seconds}.{micros:06}) can0 {identifier:08X}#{digits}");
            let frame = Frame::new(time_us, identifier, true, &data);
            prop_assert_eq!(read(&line), Ok(frame));
        }

        #[test]
        fn any_text_is_read_or_refused(line in "\\PC{0,80}") {
            let _ = read(&line);
        }
    }
}
