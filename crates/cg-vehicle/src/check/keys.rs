//! A key of the vehicle file: its meaning, its unit, and the values that it can have.

use crate::finding::{plain, span};

/// A table of the vehicle file, which can occur at several places.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Its paths in the file: `""` is the top level, `[i]` any entry of a list of tables.
    pub paths: &'static [&'static str],
    /// Whether the table must be present.
    pub required: bool,
    /// Its meaning, in one line.
    pub meaning: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// A key of the vehicle file.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Key {
    /// Its name in the file.
    pub name: &'static str,
    /// Its meaning, in one line.
    pub meaning: &'static str,
    /// Whether the key must be present.
    pub required: bool,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// Type and range of its value.
    pub kind: Kind,
}

/// Type of the value of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Kind {
    /// One line of text.
    Text,
    /// `true` or `false`.
    Flag,
    /// A whole number, zero or positive.
    Whole,
    /// A number.
    Number(Range),
    /// A list of numbers.
    Numbers(Range),
    /// A list of lists of numbers.
    Rows(Range),
}

/// The possible and the usual values of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// A value outside this range is an error, because no road vehicle has it.
    pub possible: [f64; 2],
    /// A value outside this range gives a warning.
    pub usual: [f64; 2],
    /// One more usual value, and its meaning.
    pub also: Option<(f64, &'static str)>,
}

impl Range {
    /// Whether a value is possible, so that it is not an error.
    pub fn is_possible(&self, value: f64) -> bool {
        (self.possible[0]..=self.possible[1]).contains(&value)
    }

    /// Whether a value is usual, so that it gives no warning.
    pub fn is_usual(&self, value: f64) -> bool {
        (self.usual[0]..=self.usual[1]).contains(&value) || self.is_also(value)
    }

    fn is_also(&self, value: f64) -> bool {
        self.also.is_some_and(|(also, _)| value.total_cmp(&also).is_eq())
    }

    /// Distance from the middle of the usual range divided by half its width, so that it is 1 at
    /// both ends. For positive ranges it is the distance of the logarithms.
    pub fn distance(&self, value: f64) -> f64 {
        if self.is_also(value) {
            return 0.0;
        }
        let [low, high] = self.usual;
        if low <= 0.0 {
            let half = 0.5 * (high - low);
            return ((value - low - half) / half).abs();
        }
        if !(value > 0.0) {
            return f64::INFINITY;
        }
        let half = 0.5 * libm::log(high / low);
        ((libm::log(value / low) - half) / half).abs()
    }

    /// The usual values as text: `0.5 to 1.5 m`.
    pub fn usual_in(&self, unit: &str) -> String {
        let text = span(self.usual, unit);
        match self.also {
            Some((value, meaning)) => format!("{text}, or {} ({meaning})", plain(value)),
            None => text,
        }
    }
}

/// A number that must be present.
pub(super) const fn number(
    name: &'static str,
    unit: &'static str,
    usual: [f64; 2],
    possible: [f64; 2],
    meaning: &'static str,
) -> Key {
    let kind = Kind::Number(Range { possible, usual, also: None });
    Key { name, meaning, required: true, unit, kind }
}

/// A required key without numbers.
pub(super) const fn other(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, meaning, required: true, unit: "", kind }
}

impl Key {
    /// The range of its numbers; `None` for a key without numbers.
    pub const fn range(&self) -> Option<Range> {
        match self.kind {
            Kind::Number(range) | Kind::Numbers(range) | Kind::Rows(range) => Some(range),
            Kind::Text | Kind::Flag | Kind::Whole => None,
        }
    }

    pub(super) const fn optional(self) -> Self {
        Self { required: false, ..self }
    }

    /// Adds one more usual value.
    pub(super) const fn or(self, value: f64, meaning: &'static str) -> Self {
        let also = Some((value, meaning));
        let kind = match self.kind {
            Kind::Number(range) => Kind::Number(Range { also, ..range }),
            Kind::Numbers(range) => Kind::Numbers(Range { also, ..range }),
            Kind::Rows(range) => Kind::Rows(Range { also, ..range }),
            kind => kind,
        };
        Self { kind, ..self }
    }

    pub(super) const fn list(self) -> Self {
        match self.kind {
            Kind::Number(range) => Self { kind: Kind::Numbers(range), ..self },
            _ => self,
        }
    }

    pub(super) const fn rows(self) -> Self {
        match self.kind {
            Kind::Number(range) => Self { kind: Kind::Rows(range), ..self },
            _ => self,
        }
    }
}
