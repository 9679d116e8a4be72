//! Finds the columns to read from the names in a header.

use std::cmp::Reverse;

use super::error::{ColumnName, LogError, Place, shown};
use super::heading::{Heading, Stated};
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
    /// Whether the cells are points in time.
    pub(super) clock: bool,
}

/// Finds the columns to read, in the order of the file.
pub(super) fn resolve(
    place: &Place,
    names: &[Heading],
    options: &LogOptions,
) -> Result<Box<[Column]>, LogError> {
    let mut header = Header { place, names, columns: Vec::new(), claimed: Vec::new() };
    for map in &options.columns {
        header.claim(map)?;
    }
    for index in 0..names.len() {
        header.recognize(index)?;
    }
    header.recognize_clock()?;
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
pub(super) fn column_name(names: &[Heading], index: usize) -> ColumnName {
    let name = names.get(index).map(|heading| heading.name.clone()).unwrap_or_default();
    ColumnName { number: index + 1, name }
}

struct Header<'a> {
    place: &'a Place,
    names: &'a [Heading],
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
        let clock = self.names[index].stated == Stated::Clock;
        if clock && signal != Signal::Time {
            let (place, column) = (self.place.clone(), self.name(index));
            return Err(LogError::NotNumeric { place, column, kind: "points in time".into() });
        }
        self.columns.push(Column { index, signal, times: unit.times, per: unit.per, clock });
        Ok(())
    }

    /// Uses a column because an option names it.
    fn claim(&mut self, map: &ColumnMap) -> Result<(), LogError> {
        let all = |is: &dyn Fn(&Heading) -> bool| {
            let mut all = (0..self.names.len()).filter(|&index| is(&self.names[index]));
            all.next().map(|first| (first, all.next()))
        };
        let named = |wanted: &str| all(&|heading| *heading.name == *wanted);
        let bare = || all(&|heading| heading.bare() == map.name());
        let found = named(map.name()).or_else(|| named(map.written())).or_else(bare);
        let Some((index, twin)) = found else {
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
        let heading = &self.names[index];
        let unit = match heading.unit(map.signal()) {
            _ if heading.stated == Stated::Clock => map.signal().si(),
            Some(unit) if !map.unit_is_given() => unit,
            None if !map.unit_is_given() && heading.contradicts(map.signal()) => {
                return Err(self.unknown_unit(index, map.signal()));
            }
            _ => map.factor(),
        };
        self.add(index, map.signal(), unit)?;
        self.claimed.push(map.signal());
        twin.map_or(Ok(()), |twin| self.add(twin, map.signal(), unit))
    }

    /// Uses a column because it has the standard name of a signal and a unit: `roll_deg`, or `Roll`
    /// with a unit in brackets or in the row below.
    fn recognize(&mut self, index: usize) -> Result<(), LogError> {
        let heading = &self.names[index];
        // The end of `roll_rate` is no unit of `roll`.
        let whole = heading.bare().parse::<Signal>().is_ok();
        let suffixed = heading.name.rsplit_once('_').filter(|_| !whole);
        let suffixed = suffixed.and_then(|(stem, suffix)| {
            let signal = stem.parse::<Signal>().ok()?;
            Some((signal, signal.unit(suffix), true))
        });
        let stated = || {
            let is = |signal: &Signal| plain(heading.bare()) == plain(signal.name());
            let signal = Signal::ALL.into_iter().find(is)?;
            let unit = Some(heading).filter(|h| h.stated != Stated::Nothing)?.unit(signal);
            Some((signal, unit, heading.bare().parse::<Signal>().is_ok()))
        };
        let Some((signal, unit, standard)) = suffixed.or_else(stated) else { return Ok(()) };
        let taken = self.columns.iter().any(|column| column.index == index);
        if taken || self.claimed.contains(&signal) {
            return Ok(());
        }
        let clock = heading.stated == Stated::Clock && signal == Signal::Time;
        let is_clear = !matches!(heading.stated, Stated::Units(_));
        match unit {
            // It is read as seconds, whatever its name says.
            Some(_) if clock => self.add(index, signal, signal.si()),
            Some(unit) if self.agrees(index, signal, unit) => self.add(index, signal, unit),
            None if !standard && is_clear => Ok(()),
            _ => Err(self.unknown_unit(index, signal)),
        }
    }

    /// Whether the unit in the name and the one beside it are the same, if there are both.
    fn agrees(&self, index: usize, signal: Signal, unit: Unit) -> bool {
        match &self.names[index].stated {
            Stated::Unit(text) => signal.spelled(text) == Some(unit),
            Stated::Units(both) => both.iter().all(|text| signal.spelled(text) == Some(unit)),
            Stated::Nothing | Stated::Clock => true,
        }
    }

    /// Uses the only column of points in time as the time, whatever its name, if no other is the time.
    fn recognize_clock(&mut self) -> Result<(), LogError> {
        let is = |&index: &usize| self.names[index].stated == Stated::Clock;
        let mut clocks = (0..self.names.len()).filter(is);
        match (clocks.next(), clocks.next()) {
            (Some(only), None) if self.find(Signal::Time).is_none() => {
                self.add(only, Signal::Time, Signal::Time.si())
            }
            _ => Ok(()),
        }
    }

    /// Refuses a column with a signal name but no unit, such as `speed`, or with an unknown one, such as `YawRate [1/s]`, which
    /// would otherwise be ignored without a message.
    fn refuse_bare_names(&self) -> Result<(), LogError> {
        for (index, heading) in self.names.iter().enumerate() {
            // What stands in square brackets is a unit, though an unknown one.
            let in_brackets = heading.name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
            let name = plain(in_brackets.map_or(heading.bare(), |(name, _)| name));
            let Some(signal) = Signal::ALL.into_iter().find(|signal| plain(signal.name()) == name)
            else {
                continue;
            };
            let is_meant = heading.bare().parse::<Signal>().is_ok()
                || in_brackets.is_some()
                || matches!(heading.stated, Stated::Unit(_) | Stated::Units(_));
            let taken = self.columns.iter().any(|column| column.index == index);
            if is_meant && !taken && self.find(signal).is_none() {
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
            let heading = &self.names[index];
            let unit = heading.unit(signal).map_or(signal.usual_unit(), |unit| unit.suffix);
            let (name, bare) = (shown(&heading.name, 80), shown(heading.bare(), 80));
            format!("if `{name}` is meant: ⟨columns {signal}={bare}[{unit}]⟩")
        } else {
            let signal = near[0].0;
            format!("give its column with ⟨columns {signal}=NAME[{}]⟩", signal.usual_unit())
        };
        // Whoever exports measurements often writes about them first.
        let later = "; if the header is a later line, put # before the lines above it";
        let remedy = remedy + if self.columns.is_empty() { later } else { "" };
        let found: Vec<_> = self.names.iter().map(|h| shown(&h.name, 40)).collect();
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
        for (index, heading) in self.names.iter().enumerate() {
            if self.columns.iter().any(|column| column.index == index) {
                continue;
            }
            let name = plain(heading.bare());
            for &(signal, word) in wanted {
                // A rate is not an angle.
                let other = name.contains("rate") && !word.contains("rate");
                if other || heading.contradicts(signal) {
                    continue;
                }
                let Some(far) = distance(&name, &plain(word)) else { continue };
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
