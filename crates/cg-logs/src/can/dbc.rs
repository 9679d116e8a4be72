//! Signals of a DBC file, mapped to what they measure.
//!
//! ```text
//!     roll=TILT.Angle               unit and scale as the DBC file says
//!     roll=TILT.Angle[deg]          unit named, where the DBC file has none
//!     roll=TILT.Angle[deg]*-1+0.3   turned round, and moved by 0.3 deg
//! ```

use std::fmt;
use std::path::Path;
use std::str::FromStr;

#[cfg(feature = "dbc")]
use can_dbc::{ByteOrder, Dbc, MessageId, MultiplexIndicator, ValueType};
use cg_core::Quantity;
use cg_core::signal::j1939::pgn_of;

use cg_vehicle::files;

use super::frame::Frame;
use crate::malformed::Malformed;

/// Rank of a mapped signal: before every J1939 signal that measures the same.
pub(super) const RANK: u8 = 0;

/// What is wrong with a DBC file or a mapping.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbcError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// The file is no DBC file.
    #[error("{file}: not a DBC file: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// Where and why.
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
        /// The mapping as given.
        map: String,
        /// What to do.
        message: String,
    },
}

/// A mapping as given by the user.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalMap {
    quantity: Quantity,
    /// `None` where the signal's name is enough.
    message: Option<String>,
    signal: String,
    unit: Option<String>,
    factor: f64,
    offset: f64,
    text: String,
}

/// A signal and its message.
type Place<'a> = (&'a can_dbc::Message, &'a can_dbc::Signal);

/// Where the mapped signal stands.
fn place<'a>(file: &str, dbc: &'a Dbc, map: &SignalMap) -> Result<Place<'a>, String> {
    let is_asked = |name: &str| map.message.as_deref().is_none_or(|asked| asked == name);
    let messages: Vec<_> = dbc.messages.iter().filter(|m| is_asked(&m.name)).collect();
    if messages.is_empty() {
        let names = dbc.messages.iter().map(|message| message.name.clone());
        let asked = map.message.as_deref().unwrap_or_default();
        return Err(format!("{file} has no message `{asked}`, only {}", listed(names)));
    }
    let all = messages.iter().flat_map(|m| m.signals.iter().map(move |signal| (*m, signal)));
    let names = |places: Vec<Place>| {
        listed(places.into_iter().map(|(m, signal)| format!("{}.{}", m.name, signal.name)))
    };
    let found: Vec<Place> = all.clone().filter(|(_, s)| s.name == map.signal).collect();
    match found.as_slice() {
        [one] => Ok(*one),
        [] => {
            let known = names(all.collect());
            Err(format!("{file} has no signal `{}`, only {known}", map.signal))
        }
        _ => {
            let known = names(found);
            Err(format!("{} is in several messages: give one of {known}", map.signal))
        }
    }
}

/// Names in a message, so many that it can be read.
fn listed(names: impl Iterator<Item = String>) -> String {
    let mut names: Vec<String> = names.collect();
    let more = names.len().saturating_sub(MOST_LISTED);
    names.truncate(MOST_LISTED);
    if more > 0 {
        names.push(format!("and {more} more"));
    }
    names.join(", ")
}

/// The quantity of this name, as in the columns of a log.
pub(super) fn named(name: &str) -> Result<Quantity, Malformed> {
    name.parse().map_err(|error| format!("there is no quantity `{name}`: {error}").into())
}

/// Names that a message lists.
const MOST_LISTED: usize = 20;

const EXPECTED: &str = "expected QUANTITY=MESSAGE.SIGNAL, optionally followed by [unit], *factor \
                        and +offset, as in roll=TILT.Angle[deg]*-1+0.3";

impl FromStr for SignalMap {
    type Err = Malformed;

    fn from_str(text: &str) -> Result<Self, Malformed> {
        let (name, rest) = text.split_once('=').ok_or(EXPECTED)?;
        let quantity = named(name)?;
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
            // The sign of the offset, not that of a number or of its exponent.
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
        Ok(Self { quantity, message, signal, unit, factor, offset, text })
    }
}

impl fmt::Display for SignalMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A signal of a DBC file and what it measures.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MappedSignal {
    /// What it measures.
    pub quantity: Quantity,
    identifier: u32,
    extended: bool,
    start_bit: u16,
    bits: u8,
    big_endian: bool,
    signed: bool,
    factor: f64,
    offset: f64,
    range: Option<(f64, f64)>,
    /// From the DBC file's unit to SI: value times factor plus offset.
    to_si: (f64, f64),
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
        // DBC files are in Windows' Western code page as a rule; names and units of interest are ASCII.
        let text: String = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => error.into_bytes().iter().map(|&byte| char::from(byte)).collect(),
        };
        Self::parse(&file, &text, maps)
    }

    /// The same from the text of a DBC file.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    #[cfg(feature = "dbc")]
    pub fn parse(file: &str, text: &str, maps: &[SignalMap]) -> Result<Vec<Self>, DbcError> {
        let dbc = Dbc::try_from(text).map_err(|error| DbcError::Syntax {
            file: file.to_owned(),
            message: error.to_string(),
        })?;
        maps.iter().map(|map| Self::find(file, &dbc, map)).collect()
    }

    /// The same in a build that cannot read DBC files.
    ///
    /// # Errors
    /// [`DbcError::LeftOut`], always.
    #[cfg(not(feature = "dbc"))]
    pub fn parse(file: &str, _: &str, _: &[SignalMap]) -> Result<Vec<Self>, DbcError> {
        Err(DbcError::LeftOut { file: file.to_owned() })
    }

    #[cfg(feature = "dbc")]
    fn find(file: &str, dbc: &Dbc, map: &SignalMap) -> Result<Self, DbcError> {
        let fail = |message: String| DbcError::Map { map: map.text.clone(), message };
        let (message, signal) = place(file, dbc, map).map_err(fail)?;
        if !matches!(
            signal.multiplexer_indicator,
            MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor
        ) {
            return Err(fail("multiplexed signals are not supported".to_owned()));
        }
        let (Ok(start_bit), Ok(bits @ 1..=64)) =
            (u16::try_from(signal.start_bit), u8::try_from(signal.size))
        else {
            return Err(fail(format!("a signal of {} bits cannot be read", signal.size)));
        };
        let unit = map.unit.as_deref().unwrap_or(&signal.unit);
        let dimension = map.quantity.dimension();
        let to_si = dimension.spelled(unit).map(|unit| unit.times / unit.per).ok_or_else(|| {
            let known = dimension.units().iter().flat_map(|unit| unit.spellings);
            fail(format!(
                "unit \"{unit}\" is not one of {}; name it: {}={}.{}[{}]",
                known.copied().collect::<Vec<_>>().join(", "),
                map.quantity,
                message.name,
                map.signal,
                dimension.si().suffix,
            ))
        })?;
        let (least, greatest) = (signal.min.to_string(), signal.max.to_string());
        let range = least
            .parse()
            .ok()
            .zip(greatest.parse().ok())
            .filter(|(least, greatest): &(f64, f64)| least < greatest);
        let (identifier, extended) = match message.id {
            MessageId::Standard(id) => (u32::from(id), false),
            MessageId::Extended(id) => (id & 0x1FFF_FFFF, true),
        };
        Ok(Self {
            quantity: map.quantity,
            identifier,
            extended,
            start_bit,
            bits,
            big_endian: signal.byte_order == ByteOrder::BigEndian,
            signed: signal.value_type == ValueType::Signed,
            factor: signal.factor,
            offset: signal.offset,
            range,
            to_si: (map.factor * to_si, map.offset * to_si),
        })
    }

    /// Whether a frame is that of the signal. J1939 groups that go to all match whatever their
    /// priority and source are.
    pub(super) fn is_of(&self, frame: &Frame) -> bool {
        let group = |identifier: u32| (identifier >> 16 & 0xFF >= 240).then(|| pgn_of(identifier));
        self.extended == frame.extended
            && (self.identifier == frame.identifier
                || (self.extended
                    && group(self.identifier).is_some()
                    && group(self.identifier) == group(frame.identifier)))
    }

    /// The identifier and mask that a kernel filter needs to let its frames pass.
    pub(super) fn filter(&self) -> (u32, bool, bool) {
        (self.identifier, self.extended, self.extended && self.identifier >> 16 & 0xFF >= 240)
    }

    /// The value in SI units; `None` if the frame is too short, or the value is not available or
    /// outside the DBC file's range.
    pub fn decode(&self, frame: &Frame) -> Option<f64> {
        let raw = self.raw(frame.data())?;
        let all = u64::MAX >> (64 - self.bits);
        // J1939: above 0xFA in its highest byte there is no value.
        let reserved = self.bits >= 8 && raw >> (self.bits - 8) > 0xFA;
        if self.extended && !self.signed && (raw == all || reserved) {
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

    /// The field's bits. Little-endian fields are counted from their lowest bit upwards,
    /// big-endian ones from their highest bit downwards through the bytes.
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
