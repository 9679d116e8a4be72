//! Signals of a DBC file that are mapped to quantities.
//!
//! ```text
//!     roll=TILT.Angle               unit and scale from the DBC file
//!     roll=TILT.Angle[deg]          unit given here because the DBC file has none
//!     roll=TILT.Angle[deg]*-1+0.3   sign reversed, then 0.3 deg added
//! ```

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use cg_core::signal::j1939::pgn_of;
use cg_core::{Dimension, Quantity};

use cg_vehicle::files;

use super::frame::Frame;
use crate::malformed::Malformed;

/// Rank of mapped signals. It is not greater than that of any J1939 signal.
pub(super) const RANK: u8 = 0;

/// Errors of DBC files and mappings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbcError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}; check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file is not a DBC file.
    #[error("{file}: not a DBC file: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// Position and reason.
        message: String,
    },
    /// A DBC file, and a build that cannot read it.
    #[error(
        "{file}: this program was built without the feature `dbc`; build it with that feature, or \
         record the signals as J1939's"
    )]
    LeftOut {
        /// The file.
        file: String,
    },
    /// The mapping does not fit the file.
    #[error("⟨signals {map}⟩: {message}")]
    Map {
        /// The mapping as given by the user.
        map: String,
        /// What is wrong and what to do.
        message: String,
    },
}

/// What a mapped signal measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mapped {
    /// A quantity of the estimator.
    Quantity(Quantity),
    /// The position of the trailer's lift axles.
    LiftAxle,
}

impl Mapped {
    /// The quantity, if it is one.
    pub fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Quantity(quantity) => Some(quantity),
            Self::LiftAxle => None,
        }
    }

    /// The dimension of its values.
    pub fn dimension(self) -> Dimension {
        self.quantity().map_or(Dimension::Position, Quantity::dimension)
    }
}

impl fmt::Display for Mapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.quantity().map_or(LIFT_AXLE, Quantity::name))
    }
}

const LIFT_AXLE: &str = "lift_axle";

/// A mapping as given by the user.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalMap {
    pub(super) measures: Mapped,
    /// Name of the message; `None` if the name of the signal is unique.
    pub(super) message: Option<String>,
    pub(super) signal: String,
    pub(super) unit: Option<String>,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) text: String,
}

/// The quantity with this name, as in the columns of a log.
pub(super) fn named(name: &str) -> Result<Quantity, Malformed> {
    name.parse().map_err(|error| format!("there is no quantity `{name}`: {error}").into())
}

const EXPECTED: &str = "expected QUANTITY=MESSAGE.SIGNAL, optionally followed by [unit], *factor \
                        and +offset, as in roll=TILT.Angle[deg]*-1+0.3";

impl FromStr for SignalMap {
    type Err = Malformed;

    fn from_str(text: &str) -> Result<Self, Malformed> {
        let (name, rest) = text.split_once('=').ok_or(EXPECTED)?;
        let measures = match name {
            LIFT_AXLE => Mapped::LiftAxle,
            _ => Mapped::Quantity(named(name)?),
        };
        let end = rest.find(['[', '*', '+']).unwrap_or(rest.len());
        let (path, mut tail) = rest.split_at(end);
        let (message, signal) = match path.split_once('.') {
            Some((message, signal)) => (Some(message.to_owned()), signal),
            None => (None, path),
        };
        if signal.is_empty() {
            return Err(EXPECTED.into());
        }
        let mut unit = None;
        if let Some(inner) = tail.strip_prefix('[') {
            let (inside, after) = inner.split_once(']').ok_or(EXPECTED)?;
            (unit, tail) = (Some(inside.to_owned()), after);
        }
        let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
        let (mut factor, mut offset) = (1.0, 0.0);
        if let Some(after) = tail.strip_prefix('*') {
            // The sign that begins the offset, not that of a number or of its exponent.
            let end = after
                .char_indices()
                .skip(1)
                .find(|&(i, c)| matches!(c, '+' | '-') && !after[..i].ends_with(['e', 'E']))
                .map_or(after.len(), |(i, _)| i);
            factor = number(&after[..end]).filter(|x| *x != 0.0).ok_or(EXPECTED)?;
            tail = &after[end..];
        }
        if !tail.is_empty() {
            offset = number(tail).filter(|_| tail.starts_with(['+', '-'])).ok_or(EXPECTED)?;
        }
        let text = text.to_owned();
        let signal = signal.to_owned();
        Ok(Self { measures, message, signal, unit, factor, offset, text })
    }
}

impl fmt::Display for SignalMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A signal of a DBC file with what it measures.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MappedSignal {
    /// What it measures.
    pub measures: Mapped,
    pub(super) identifier: u32,
    pub(super) extended: bool,
    pub(super) start_bit: u16,
    pub(super) bits: u8,
    pub(super) big_endian: bool,
    pub(super) signed: bool,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) range: Option<(f64, f64)>,
    /// Factor and offset that convert from the unit of the DBC file to SI: value times factor plus
    /// offset.
    pub(super) to_si: (f64, f64),
}

impl MappedSignal {
    /// Finds the mapped signals in a DBC file.
    ///
    /// # Errors
    /// [`DbcError`] if the file cannot be read or lacks a signal, or a unit is unknown.
    pub fn load(path: &Path, maps: &[SignalMap]) -> Result<Vec<Self>, DbcError> {
        let file = path.display().to_string();
        let bytes = files::read(path, files::TABLE_BYTES)
            .map_err(|source| DbcError::Read { file: file.clone(), source })?;
        // DBC files usually use the Windows-1252 code page. Names and units are ASCII.
        let text: String = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => error.into_bytes().iter().map(|&byte| char::from(byte)).collect(),
        };
        Self::parse(&file, &text, maps)
    }

    /// The same in a build that cannot read DBC files.
    ///
    /// # Errors
    /// [`DbcError::LeftOut`], always.
    #[cfg(not(feature = "dbc"))]
    pub fn parse(file: &str, _: &str, _: &[SignalMap]) -> Result<Vec<Self>, DbcError> {
        Err(DbcError::LeftOut { file: file.to_owned() })
    }

    /// Whether a frame contains the signal. Broadcast J1939 groups match with any priority and
    /// source address.
    pub(super) fn is_of(&self, frame: &Frame) -> bool {
        let group = |identifier: u32| (identifier >> 16 & 0xFF >= 240).then(|| pgn_of(identifier));
        self.extended == frame.extended
            && (self.identifier == frame.identifier
                || (self.extended
                    && group(self.identifier).is_some()
                    && group(self.identifier) == group(frame.identifier)))
    }

    /// Whether its field begins at this bit, its lowest one.
    pub(super) fn begins_at(&self, bit: u16) -> bool {
        !self.big_endian && self.start_bit == bit
    }

    /// Identifier, whether it has 29 bits, and mask for a kernel filter that passes its frames.
    pub(super) fn filter(&self) -> (u32, bool, bool) {
        (self.identifier, self.extended, self.extended && self.identifier >> 16 & 0xFF >= 240)
    }

    /// The value in SI units; `None` if the frame is too short, or if the value is not available or
    /// outside the range in the DBC file.
    pub fn decode(&self, frame: &Frame) -> Option<f64> {
        let raw = self.raw(frame.data())?;
        let all = u64::MAX >> (64 - self.bits);
        // In J1939, values whose highest byte is above 0xFA are not available, nor those with all bits set. One bit has no
        // value to spare for this.
        let reserved = self.bits >= 8 && raw >> (self.bits - 8) > 0xFA;
        let is_absent = self.bits > 1 && raw == all;
        if self.extended && !self.signed && (is_absent || reserved) {
            return None;
        }
        #[allow(clippy::cast_precision_loss, clippy::cast_possible_wrap)]
        let number = if self.signed && raw >> (self.bits - 1) == 1 {
            (raw | !all) as i64 as f64
        } else {
            raw as f64
        };
        let value = number * self.factor + self.offset;
        if self.range.is_some_and(|(least, greatest)| value < least || value > greatest) {
            return None;
        }
        Some(value * self.to_si.0 + self.to_si.1)
    }

    /// The bits of the field. Little-endian fields are counted from their lowest bit upwards,
    /// big-endian fields from their highest bit downwards through the bytes.
    fn raw(&self, data: &[u8]) -> Option<u64> {
        let bit = |place: usize| Some(u64::from(data.get(place / 8)? >> (place % 8) & 1));
        let mut raw = 0;
        let mut place = usize::from(self.start_bit);
        for k in 0..self.bits {
            if self.big_endian {
                raw = raw << 1 | bit(place)?;
                place = if place % 8 == 0 { place + 15 } else { place - 1 };
            } else {
                raw |= bit(place)? << k;
                place += 1;
            }
        }
        Some(raw)
    }
}
