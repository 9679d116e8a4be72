//! SI to the units of the source's figures: for columns and axes only.

use cg_thesis::study::{Quantity, Unit};

/// How a quantity is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shown {
    /// At the end of a column's name.
    pub(crate) suffix: &'static str,
    /// Beside an axis.
    pub(crate) symbol: &'static str,
    /// Shown value over SI value.
    pub(crate) factor: f64,
}

/// Standard gravity.
const GRAVITY_MPS2: f64 = 9.806_65;

/// How a unit is shown.
pub(crate) fn shown(unit: Unit) -> Shown {
    let degrees = 180.0 / std::f64::consts::PI;
    let (suffix, symbol, factor) = match unit {
        Unit::One => ("percent", "%", 100.0),
        Unit::Radian => ("deg", "°", degrees),
        Unit::RadianPerSecond => ("degps", "°/s", degrees),
        Unit::Metre => ("m", "m", 1.0),
        Unit::MetrePerSecond => ("kmh", "km/h", 3.6),
        Unit::MetrePerSecondSquared => ("g", "g", 1.0 / GRAVITY_MPS2),
        Unit::Second => ("s", "s", 1.0),
        Unit::Decibel => ("db", "dB", 1.0),
        Unit::Kilogram => ("t", "t", 1e-3),
        Unit::KilogramSquareMetre => ("kgm2", "kg m²", 1.0),
    };
    Shown { suffix, symbol, factor }
}

/// A column's name.
pub(crate) fn column(quantity: Quantity) -> String {
    format!("{}_{}", quantity.name, shown(quantity.unit).suffix)
}

/// The words beside an axis.
pub(crate) fn axis(quantity: Quantity) -> String {
    format!("{} ({})", quantity.label, shown(quantity.unit).symbol)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_its_unit_and_an_axis_its_symbol() {
        let speed = Quantity { name: "speed", label: "Speed", unit: Unit::MetrePerSecond };
        assert_eq!((column(speed).as_str(), axis(speed).as_str()), ("speed_kmh", "Speed (km/h)"));
        assert!((13.888_888_888_9 * shown(speed.unit).factor - 50.0).abs() < 1e-9);
    }
}
