//! The variables of an FMU.

use cg_core::Quantity;

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Constant after the initialization.
    Parameter,
    /// Set before each step.
    Input,
    /// Computed.
    Output,
}

/// An enumeration, whose items count from one.
#[derive(Debug, PartialEq, Eq)]
pub struct Enumeration {
    /// Its name.
    pub name: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    /// Name and meaning of each item.
    pub items: &'static [(&'static str, &'static str)],
}

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// A number with this unit, empty for a ratio.
    Float64(&'static str),
    /// A count.
    Int64,
    /// An item of an enumeration.
    Enumeration(&'static Enumeration),
    /// True or false.
    Boolean,
}

/// A variable. Values of every type are kept as a number: an item by its place, a truth value as 0 or 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name with the SI unit.
    pub name: String,
    /// Meaning, one line.
    pub description: String,
    /// Role.
    pub causality: Causality,
    /// Type.
    pub kind: Type,
    /// Value before the initialization; NaN means absent.
    pub start: f64,
}

impl Variable {
    pub(crate) fn new(
        (name, description): (impl Into<String>, impl Into<String>),
        causality: Causality,
        kind: Type,
        start: f64,
    ) -> Self {
        let (name, description) = (name.into(), description.into());
        Self { name, description, causality, kind, start }
    }

    /// A parameter with its unit.
    pub(crate) fn parameter(text: (&str, &str), unit: &'static str, start: f64) -> Self {
        Self::new(text, Causality::Parameter, Type::Float64(unit), start)
    }

    /// An input with its unit.
    pub(crate) fn input(text: (&str, &str), unit: &'static str, start: f64) -> Self {
        Self::new(text, Causality::Input, Type::Float64(unit), start)
    }

    /// An output.
    pub(crate) fn output(text: (impl Into<String>, impl Into<String>), kind: Type) -> Self {
        Self::new(text, Causality::Output, kind, f64::NAN)
    }
}

/// A unit as it is declared in a model description: its symbol, and its exponents of base units.
pub(crate) const UNITS: &[(&str, &[(&str, i8)])] = &[
    ("s", &[("s", 1)]),
    ("m", &[("m", 1)]),
    ("kg", &[("kg", 1)]),
    ("rad", &[("rad", 1)]),
    ("rad/s", &[("rad", 1), ("s", -1)]),
    ("m/s", &[("m", 1), ("s", -1)]),
    ("m/s2", &[("m", 1), ("s", -2)]),
    ("Pa", &[("kg", 1), ("m", -1), ("s", -2)]),
    ("N", &[("kg", 1), ("m", 1), ("s", -2)]),
    ("N.m", &[("kg", 1), ("m", 2), ("s", -2)]),
];

/// The symbol of the SI unit of a quantity: its first spelling in ASCII.
pub(crate) fn unit_of(quantity: Quantity) -> &'static str {
    let spellings = quantity.dimension().si().spellings;
    spellings.iter().find(|spelling| spelling.is_ascii()).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_every_quantity_is_declared() {
        for quantity in Quantity::ALL {
            let unit = unit_of(quantity);
            assert!(UNITS.iter().any(|(symbol, _)| *symbol == unit), "{quantity}: {unit:?}");
        }
    }
}
