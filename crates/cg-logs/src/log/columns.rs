//! Finds the columns to read from the names in a header.

use std::cmp::Reverse;

use super::error::{ColumnName, LogError, Place, shown};
use super::options::{ColumnMap, LogOptions};
use super::signal::Signal;
use cg_core::Unit;

/// A column to read.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Index of the column in the file, from zero.
    pub(super) index: usize,
    pub(super) signal: Signal,
    pub(super) times: f64,
    pub(super) per: f64,
}

/// Finds the columns to read, in the order of the file.
pub(super) fn resolve(
    place: &Place,
    names: &[Box<str>],
    options: &LogOptions,
) -> Result<Box<[Column]>, LogError> {
    let mut header = Header { place, names, columns: Vec::new(), claimed: Vec::new() };
    for map in &options.columns {
        header.claim(map)?;
    }
    for index in 0..names.len() {
        header.recognize(index)?;
    }
    header.refuse_bare_names()?;
    header.require(&[Signal::Time])?;
    header.require_channel()?;
    for &signal in &options.flip {
        header.check_flip(signal)?;
    }
    for column in &mut header.columns {
        if options.flip.contains(&column.signal) {
            column.times = -column.times;
        }
    }
    header.columns.sort_by_key(|column| column.index);
    Ok(header.columns.into())
}

/// The name of a column for messages.
pub(super) fn column_name(names: &[Box<str>], index: usize) -> ColumnName {
    ColumnName { number: index + 1, name: names.get(index).cloned().unwrap_or_default() }
}

struct Header<'a> {
    place: &'a Place,
    names: &'a [Box<str>],
    columns: Vec<Column>,
    /// Signals that an option assigns to a column. Columns with their standard names are ignored.
    claimed: Vec<Signal>,
}

impl Header<'_> {
    fn find(&self, signal: Signal) -> Option<&Column> {
        self.columns.iter().find(|column| column.signal == signal)
    }

    fn name(&self, index: usize) -> ColumnName {
        column_name(self.names, index)
    }

    fn add(&mut self, index: usize, signal: Signal, unit: Unit) -> Result<(), LogError> {
        if let Some(first) = self.find(signal) {
            let (first, second) = (self.name(first.index), self.name(index));
            return Err(LogError::DuplicateSignal {
                place: self.place.clone(),
                signal,
                first,
                second,
            });
        }
        self.columns.push(Column { index, signal, times: unit.times, per: unit.per });
        Ok(())
    }

    /// Uses a column because an option names it.
    fn claim(&mut self, map: &ColumnMap) -> Result<(), LogError> {
        let named = |wanted: &str| {
            let mut all = (0..self.names.len()).filter(|&index| *self.names[index] == *wanted);
            all.next().map(|first| (first, all.next()))
        };
        let Some((index, twin)) = named(map.name()).or_else(|| named(map.written())) else {
            let wanted = format!("⟨columns {}={}⟩", map.signal(), shown(map.name(), 80));
            return Err(self.missing(&wanted, &[(map.signal(), map.name())]));
        };
        let other = self.columns.iter().find(|column| column.index == index);
        if let Some(other) = other.filter(|other| other.signal != map.signal()) {
            return Err(LogError::SharedColumn {
                place: self.place.clone(),
                column: self.name(index),
                first: other.signal,
                second: map.signal(),
            });
        }
        self.add(index, map.signal(), map.factor())?;
        self.claimed.push(map.signal());
        twin.map_or(Ok(()), |twin| self.add(twin, map.signal(), map.factor()))
    }

    /// Uses a column because it has the standard name of a signal.
    fn recognize(&mut self, index: usize) -> Result<(), LogError> {
        let Some((stem, suffix)) = self.names[index].rsplit_once('_') else { return Ok(()) };
        let Ok(signal) = stem.parse::<Signal>() else { return Ok(()) };
        let taken = self.columns.iter().any(|column| column.index == index);
        if taken || self.claimed.contains(&signal) {
            return Ok(());
        }
        match signal.unit(suffix) {
            Some(unit) => self.add(index, signal, unit),
            None => Err(self.unknown_unit(index, signal)),
        }
    }

    /// Refuses a column with a signal name but no unit, such as `speed`, which would otherwise be
    /// ignored without a message.
    fn refuse_bare_names(&self) -> Result<(), LogError> {
        for (index, name) in self.names.iter().enumerate() {
            let Ok(signal) = name.parse::<Signal>() else { continue };
            let taken = self.columns.iter().any(|column| column.index == index);
            if !taken && self.find(signal).is_none() {
                return Err(self.unknown_unit(index, signal));
            }
        }
        Ok(())
    }

    fn unknown_unit(&self, index: usize, signal: Signal) -> LogError {
        LogError::UnknownUnit {
            place: self.place.clone(),
            column: self.name(index),
            signal,
            accepted: signal.unit_names().into(),
        }
    }

    fn require(&self, signals: &[Signal]) -> Result<(), LogError> {
        if signals.iter().any(|&signal| self.find(signal).is_some()) {
            return Ok(());
        }
        let wanted: Vec<_> = signals.iter().map(|signal| signal.column()).collect();
        let near: Vec<_> = signals.iter().flat_map(|&s| [(s, s.name()), (s, s.column())]).collect();
        Err(self.missing(&wanted.join(" or "), &near))
    }

    /// Requires a roll angle and an input that belong together.
    fn require_channel(&self) -> Result<(), LogError> {
        let present: Vec<Signal> = self.columns.iter().map(|column| column.signal).collect();
        let lacking = Signal::lacking(&present);
        if lacking.is_empty() { Ok(()) } else { self.require(lacking) }
    }

    fn missing(&self, wanted: &str, near: &[(Signal, &str)]) -> LogError {
        let remedy = if let Some((index, signal)) = self.nearest(near) {
            let (name, unit) = (shown(&self.names[index], 80), signal.usual_unit());
            format!("if `{name}` is meant: ⟨columns {signal}={name}[{unit}]⟩")
        } else {
            let signal = near[0].0;
            format!("give its column with ⟨columns {signal}=NAME[{}]⟩", signal.usual_unit())
        };
        let found: Vec<_> = self.names.iter().map(|name| shown(name, 40)).collect();
        LogError::MissingColumn {
            place: self.place.clone(),
            wanted: wanted.into(),
            found: shown(&found.join(", "), 600).into(),
            remedy: remedy.into(),
        }
    }

    fn check_flip(&self, signal: Signal) -> Result<(), LogError> {
        let reason = if !signal.is_directed() {
            "it has no direction"
        } else if self.find(signal).is_none() {
            "the log has no such signal"
        } else {
            return Ok(());
        };
        Err(LogError::Flip { place: self.place.clone(), signal, reason })
    }

    /// The unused column whose name is most similar to one of these names, and the signal of that
    /// name.
    fn nearest(&self, wanted: &[(Signal, &str)]) -> Option<(usize, Signal)> {
        let mut best: Option<(_, usize, Signal)> = None;
        for (index, name) in self.names.iter().enumerate() {
            if self.columns.iter().any(|column| column.index == index) {
                continue;
            }
            for &(signal, word) in wanted {
                let Some(far) = distance(&plain(name), &plain(word)) else { continue };
                let score = (far, Reverse(word.len()));
                if best.is_none_or(|(least, ..)| score < least) {
                    best = Some((score, index, signal));
                }
            }
        }
        best.map(|(_, index, signal)| (index, signal))
    }
}

/// Letters and digits of a name in lower case.
fn plain(name: &str) -> String {
    name.chars().take(64).filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The distance between two names if they are similar: the Levenshtein distance, or the maximum
/// number of edits plus one if one name contains the other.
fn distance(name: &str, word: &str) -> Option<usize> {
    const EDITS: usize = 2;
    let edits = strsim::levenshtein(name, word);
    let (short, long) = if name.len() < word.len() { (name, word) } else { (word, name) };
    let letters = short.chars().count();
    if edits <= EDITS && 2 * edits < letters {
        Some(edits)
    } else if letters > 2 && long.contains(short) {
        Some(EDITS + 1)
    } else {
        None
    }
}
