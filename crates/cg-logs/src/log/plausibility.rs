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
    tally: Tally,
}

impl Plausibility {
    /// For a truck with these sensor settings.
    pub fn new(settings: AlignSettings<f64>) -> Self {
        Self { settings, tally: Tally::default() }
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

    #[test]
    fn impossible_values_are_absent_and_told_with_their_row() {
        let mut plausibility = Plausibility::new(AlignSettings::NONE);
        let mut values = [f64::NAN; Signal::COUNT];
        for (row, speed_mps) in [(1, 12.0), (2, 79.97), (3, 81.0), (4, f64::NAN)] {
            values[Signal::Speed as usize] = speed_mps;
            plausibility
                .check(&[Quantity::Speed, Quantity::Roll], &mut values, || Position::Row(row));
            assert_eq!(values[Signal::Speed as usize].is_nan(), row > 1);
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
