//! Conversion from SI to the units of the thesis's figures, for columns and axes only.

use cg_core::Dimension;
use cg_core::signal::unit::{DEG, DEGPS, G, KMH, TONNE};
use cg_thesis::study::{Quantity, Unit};

/// How a unit is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DisplayUnit {
    /// Suffix of a column's name.
    pub(crate) suffix: &'static str,
    /// Symbol in the label of an axis.
    pub(crate) symbol: &'static str,
    /// Displayed value divided by SI value.
    pub(crate) factor: f64,
}

/// How a unit is shown. Some units occur only in figures and are not in the table of units.
pub(crate) fn display_unit(unit: Unit) -> DisplayUnit {
    let own = |suffix, symbol, factor| DisplayUnit { suffix, symbol, factor };
    let listed = |unit: cg_core::Unit| own(unit.suffix, unit.spellings[0], unit.per / unit.times);
    match unit {
        Unit::One => own("percent", "%", 100.0),
        Unit::PerSecond => own("per_s", "1/s", 1.0),
        Unit::Radian => listed(DEG),
        Unit::RadianPerSecond => listed(DEGPS),
        Unit::Meter => own("m", "m", 1.0),
        Unit::MeterPerSecond => listed(KMH),
        Unit::MeterPerSecondSquared => listed(G),
        Unit::Second => listed(Dimension::Time.si()),
        Unit::Month => own("months", "months", 1.0),
        Unit::Decibel => own("db", "dB", 1.0),
        Unit::Kilogram => listed(TONNE),
        Unit::KilogramSquareMeter => own("kgm2", "kg m²", 1.0),
    }
}

/// The name of a column.
pub(crate) fn column(quantity: Quantity) -> String {
    format!("{}_{}", quantity.name, display_unit(quantity.unit).suffix)
}

/// The label of an axis.
#[cfg(feature = "plots")]
pub(crate) fn axis(quantity: Quantity) -> String {
    format!("{} ({})", quantity.label, display_unit(quantity.unit).symbol)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_its_unit_and_an_axis_its_symbol() {
        let speed = Quantity { name: "speed", label: "Speed", unit: Unit::MeterPerSecond };
        assert_eq!(column(speed), "speed_kmh");
        #[cfg(feature = "plots")]
        assert_eq!(axis(speed), "Speed (km/h)");
        assert!((13.888_888_888_9 * display_unit(speed.unit).factor - 50.0).abs() < 1e-9);
    }
}
