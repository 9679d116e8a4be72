//! Values that the truck cannot have: they count as absent, and are counted.

use cg_core::{AlignSettings, Quantity};
use serde::{Deserialize, Serialize};

use super::signal::Signal;
use crate::can::Tally;
use crate::place::Position;

/// Replaces values that a truck cannot have by NaN, and counts them for the messages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plausibility {
    settings: AlignSettings<f64>,
    /// Values of each quantity that are believed without a further look. It is empty if a mass follows from them, and
    /// contains NaN nowhere.
    usual: [[f64; 2]; Quantity::COUNT],
    tally: Tally,
}

impl Plausibility {
    /// For a truck with these sensor settings.
    pub fn new(settings: AlignSettings<f64>) -> Self {
        let usual = Quantity::ALL.map(|quantity| {
            let [least, greatest] = quantity.limits().map(f64::from);
            match (quantity, settings.mass_range_kg) {
                (Quantity::TrailerMass, Some([least_kg, greatest_kg])) => {
                    [least.max(least_kg), greatest.min(greatest_kg)]
                }
                _ if settings.mass_kg(quantity, 0.0).is_nan() => [least, greatest],
                _ => [f64::INFINITY, f64::NEG_INFINITY],
            }
        });
        Self { settings, usual, tally: Tally::default() }
    }

    /// Checks the values of a row, in the order of [`Signal::ALL`], of which only these quantities may be
    /// present. The position of the row is that in messages.
    #[inline]
    pub fn check(
        &mut self,
        quantities: &[Quantity],
        values: &mut [f64; Signal::COUNT],
        position: impl Fn() -> Position,
    ) {
        for &quantity in quantities {
            let value = &mut values[Signal::from(quantity) as usize];
            let [least, greatest] = self.usual[quantity.index()];
            if *value >= least && *value <= greatest {
                continue;
            }
            if !value.is_nan() && !self.settings.believes(quantity, *value) {
                self.drop(quantity, value, position());
            }
        }
    }

    #[cold]
    fn drop(&mut self, quantity: Quantity, value: &mut f64, position: Position) {
        self.tally.implausible(quantity, *value, Some(position));
        *value = f64::NAN;
    }

    /// Findings since the last call, each as signal and sentence.
    pub fn news(&mut self) -> Vec<(&'static str, String)> {
        self.tally.news(&self.settings)
    }

    /// All findings so far, as text for the user.
    pub fn remarks(&self) -> Vec<String> {
        self.tally.remarks(&self.settings)
    }

    /// Number of values so far that the truck cannot have.
    pub fn values(&self) -> u64 {
        self.tally.implausible_values()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is usual is a shortcut only.
    #[test]
    fn a_row_is_judged_as_each_value_is_by_itself() {
        let ranges = [None, Some([6e3, 40e3]), Some([-1.0, 1e9])];
        let lines = [None, Some([3000.0, 0.05])];
        for (mass_range_kg, line) in
            ranges.into_iter().flat_map(|one| lines.map(|line| (one, line)))
        {
            let settings = AlignSettings {
                mass_range_kg,
                mass_of_axle_load: line,
                mass_of_suspension_pressure: line,
                mass_of_drive_pressure: line,
                ..AlignSettings::NONE
            };
            for quantity in Quantity::ALL {
                let limits = quantity.limits().map(f64::from);
                let edges = [limits, [6e3, 40e3]].concat();
                let near = edges.into_iter().flat_map(|x| [x.next_down(), x, x.next_up()]);
                for value in near.chain([0.0, 1e5, 3e5, f64::NAN, f64::INFINITY]) {
                    let mut values = [f64::NAN; Signal::COUNT];
                    values[Signal::from(quantity) as usize] = value;
                    Plausibility::new(settings)
                        .check(&[quantity], &mut values, || Position::Row(1));
                    let is_kept = !values[Signal::from(quantity) as usize].is_nan();
                    assert_eq!(is_kept, settings.believes(quantity, value), "{quantity:?} {value}");
                }
            }
        }
    }

    #[test]
    fn impossible_values_are_absent_and_told_with_their_row() {
        let mut plausibility = Plausibility::new(AlignSettings::NONE);
        let mut values = [f64::NAN; Signal::COUNT];
        for (number, speed_mps) in [(1, 12.0), (2, 79.97), (3, 81.0), (4, f64::NAN)] {
            values[Signal::Speed as usize] = speed_mps;
            plausibility
                .check(&[Quantity::Speed, Quantity::Roll], &mut values, || Position::Row(number));
            assert_eq!(values[Signal::Speed as usize].is_nan(), number > 1);
        }
        assert_eq!(plausibility.values(), 2);
        assert_eq!(
            plausibility.remarks(),
            [
                "speed: row 2: speed_mps 79.97 is impossible (possible: -20 to 60); such values count as \
                 absent; check the sensor and the unit (2 in all)"
            ]
        );
        assert_eq!((plausibility.news().len(), plausibility.news().len()), (1, 0));
    }
}
