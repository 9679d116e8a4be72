//! What a key of the vehicle file is: its meaning, unit, and the values that it can have.

use crate::finding::{plain, span};

/// A table of the vehicle file, and the same table wherever it stands.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Where it stands: `""` is the top, `[i]` any entry of a list of tables.
    pub paths: &'static [&'static str],
    /// Whether a file without it is refused.
    pub required: bool,
    /// What it is.
    pub meaning: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// A key of the vehicle file.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it means, in one line.
    pub meaning: &'static str,
    /// Whether a file without it is refused.
    pub required: bool,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// What stands there.
    pub kind: Kind,
}

/// What stands at a key.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Kind {
    /// One line of text.
    Text,
    /// `true` or `false`.
    Flag,
    /// A whole number from 0.
    Whole,
    /// A number.
    Number(Range),
    /// A list of numbers.
    Numbers(Range),
    /// A list of lists of numbers.
    Rows(Range),
}

/// The values that a number can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Beyond it a value is an error: no road vehicle has it.
    pub possible: [f64; 2],
    /// Beyond it a value is a warning.
    pub usual: [f64; 2],
    /// One more value that is usual, and what it stands for.
    pub also: Option<(f64, &'static str)>,
}

impl Range {
    /// Whether a value is no error.
    pub fn is_possible(&self, value: f64) -> bool {
        (self.possible[0]..=self.possible[1]).contains(&value)
    }

    /// Whether a value is no warning.
    pub fn is_usual(&self, value: f64) -> bool {
        (self.usual[0]..=self.usual[1]).contains(&value) || self.is_also(value)
    }

    fn is_also(&self, value: f64) -> bool {
        self.also.is_some_and(|(also, _)| value.total_cmp(&also).is_eq())
    }

    /// Distance from the middle of the usual range in half its width, so that its ends are at 1;
    /// of logarithms where the range is positive.
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
        let half = 0.5 * (high / low).ln();
        (((value / low).ln() - half) / half).abs()
    }

    /// The usual values in words: `0.5 to 1.5 m`.
    pub fn usual_in(&self, unit: &str) -> String {
        let text = span(self.usual, unit);
        match self.also {
            Some((value, meaning)) => format!("{text}, or {} ({meaning})", plain(value)),
            None => text,
        }
    }
}

/// A number that has to be there.
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

/// A key without numbers.
pub(super) const fn other(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, meaning, required: true, unit: "", kind }
}

impl Key {
    /// The range of its numbers, if it has any.
    pub const fn range(&self) -> Option<Range> {
        match self.kind {
            Kind::Number(range) | Kind::Numbers(range) | Kind::Rows(range) => Some(range),
            Kind::Text | Kind::Flag | Kind::Whole => None,
        }
    }

    pub(super) const fn optional(self) -> Self {
        Self { required: false, ..self }
    }

    /// One more usual value.
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
