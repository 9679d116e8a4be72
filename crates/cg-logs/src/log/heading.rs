//! What the header of a log says about a column: its name and the unit of its values.

use cg_core::Unit;

use super::signal::Signal;

/// What a file says about the values of a column, beside the name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stated {
    /// Nothing, or something that is not a unit.
    Nothing,
    /// The unit, in a row below the names or in brackets after the name.
    Unit(Box<str>),
    /// Two units, which are not the same: one in brackets after the name, and one in the row below.
    Units([Box<str>; 2]),
    /// The values are points in time, or durations, that are read as seconds.
    Clock,
}

/// A column of a header.
#[derive(Clone, Debug)]
pub(super) struct Heading {
    pub(super) name: Box<str>,
    pub(super) stated: Stated,
}

impl Heading {
    /// A column with this name, whose unit may follow it in brackets: `Roll [deg]`, `Speed (km/h)`.
    pub(super) fn new(name: &str) -> Self {
        let stated = bracketed(name).map_or(Stated::Nothing, |(_, unit)| Stated::Unit(unit.into()));
        Self { name: name.into(), stated }
    }

    /// The name without a unit in brackets.
    pub(super) fn bare(&self) -> &str {
        bracketed(&self.name).map_or(&self.name, |(bare, _)| bare)
    }

    /// Takes the unit from a row of units, if the cell contains one.
    pub(super) fn take_unit(&mut self, cell: &str) {
        let Some(unit) = unit_of(cell) else { return };
        self.stated = match std::mem::replace(&mut self.stated, Stated::Nothing) {
            Stated::Unit(before) if *before != *unit => Stated::Units([before, unit.into()]),
            _ => Stated::Unit(unit.into()),
        };
    }

    /// The unit that the file gives for this signal: stated, or as the suffix of the name.
    pub(super) fn unit(&self, signal: Signal) -> Option<Unit> {
        match &self.stated {
            Stated::Unit(text) => signal.spelled(text),
            Stated::Units([first, second]) => {
                signal.spelled(first).filter(|unit| signal.spelled(second) == Some(*unit))
            }
            Stated::Clock => (signal == Signal::Time).then(|| signal.si()),
            Stated::Nothing => {
                self.name.rsplit_once('_').and_then(|(_, suffix)| signal.unit(suffix))
            }
        }
    }

    /// Whether the file gives a unit that this signal cannot have.
    pub(super) fn contradicts(&self, signal: Signal) -> bool {
        let suffix = self.name.rsplit_once('_').map(|(_, suffix)| suffix);
        match &self.stated {
            Stated::Unit(text) => signal.spelled(text).is_none(),
            Stated::Units(_) => self.unit(signal).is_none(),
            Stated::Clock => signal != Signal::Time,
            Stated::Nothing => suffix.is_some_and(|suffix| {
                signal.unit(suffix).is_none() && Signal::any_has_unit(suffix)
            }),
        }
    }
}

/// The name and the unit of `Roll [deg]` or `Speed (km/h)`; `None` if no unit is in brackets.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    let (rest, open) = match name.strip_suffix(']') {
        Some(rest) => (rest, '['),
        None => (name.strip_suffix(')')?, '('),
    };
    let (bare, unit) = rest.rsplit_once(open)?;
    Some((bare.trim(), unit_of(unit)?)).filter(|(bare, _)| !bare.is_empty())
}

/// The unit in a cell of a row of units, with or without brackets; `None` if it is not one.
fn unit_of(cell: &str) -> Option<&str> {
    let cell = cell.trim();
    let inside = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    let unit = inside('[', ']').or_else(|| inside('(', ')')).unwrap_or(cell).trim();
    Signal::any_spells(unit).then_some(unit)
}

/// Whether the cells of a record are units and not values: none is a number, and one is a unit.
pub(super) fn are_units<'a>(mut cells: impl Iterator<Item = &'a str> + Clone) -> bool {
    const LONGEST: usize = 24;
    let short = |cell: &str| cell.len() <= LONGEST && cell.parse::<f64>().is_err();
    cells.clone().all(short) && cells.any(|cell| unit_of(cell).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_in_brackets_is_stated_and_other_brackets_belong_to_the_name() {
        for (name, bare, unit) in [
            ("Roll [deg]", "Roll", Some("deg")),
            ("Speed (km/h)", "Speed", Some("km/h")),
            ("Time[ms]", "Time", Some("ms")),
            ("Roll (filtered)", "Roll (filtered)", None),
            ("[deg]", "[deg]", None),
            ("roll_deg", "roll_deg", None),
        ] {
            let heading = Heading::new(name);
            let stated = unit.map_or(Stated::Nothing, |unit| Stated::Unit(unit.into()));
            assert_eq!((heading.bare(), &heading.stated), (bare, &stated), "{name}");
        }
    }

    #[test]
    fn a_row_of_units_has_a_unit_and_no_number() {
        for (cells, expected) in [
            (&["s", "[deg]", "-", ""][..], true),
            (&["(km/h)", "note"], true),
            (&["0", "deg"], false),
            (&["a", "b"], false),
            (&["NaN", "s"], false),
        ] {
            assert_eq!(are_units(cells.iter().copied()), expected, "{cells:?}");
        }
    }
}
