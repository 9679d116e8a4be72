//! Whether the pressures of both sides of the drive axle belong together: the trailer mass follows from their mean.

use cg_core::Quantity;
use serde::{Deserialize, Serialize};

/// Greatest difference of the means of both sides, over their mean. On bellows that are 0.9 m apart, a load that stands 0.135 m
/// beside the middle, which is more than 2.5 of the usual standard deviations, makes as much. A sensor that shows half of its
/// pressure makes 0.67, and one that shows none 2.
const UNEQUAL: f64 = 0.6;
/// Least mean pressure, Pa: at smaller ones the valves do not level the body.
const LEAST_PA: f64 = 0.5e5;
/// Least number of values: some seconds on a bus that sends ten a second.
const LEAST_VALUES: f64 = 100.0;
const PA_PER_BAR: f64 = 1e5;

/// The sums of both sides.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct PressureCheck {
    values: f64,
    sums_pa: [f64; 2],
}

impl PressureCheck {
    /// Takes the pressures at one time, Pa; NaN without a value.
    #[inline]
    pub(super) fn push(&mut self, pressure_pa: impl Fn(Quantity) -> f64) {
        let left_pa = pressure_pa(Quantity::DrivePressureLeft);
        let right_pa = pressure_pa(Quantity::DrivePressureRight);
        if left_pa.is_finite() && right_pa.is_finite() {
            self.values += 1.0;
            self.sums_pa[0] += left_pa;
            self.sums_pa[1] += right_pa;
        }
    }

    /// That they do not.
    pub(super) fn message(&self) -> Option<String> {
        let [left_pa, right_pa] = self.sums_pa.map(|sum_pa| sum_pa / self.values);
        let mean_pa = f64::midpoint(left_pa, right_pa);
        let is_unequal = self.values >= LEAST_VALUES
            && mean_pa > LEAST_PA
            && (left_pa - right_pa).abs() > UNEQUAL * mean_pa;
        is_unequal.then(|| {
            format!(
                "the pressures of the left and the right drive bellows are {:.1} and {:.1} bar in the mean: one of the sensors is \
                 wrong, or the load stands far beside the middle; a trailer mass that follows from them is wrong, too",
                left_pa / PA_PER_BAR,
                right_pa / PA_PER_BAR
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of this many values, in bar.
    fn told(values: u32, bar: [f64; 2]) -> Option<String> {
        let mut check = PressureCheck::default();
        for _ in 0..values {
            check.push(|quantity| match quantity {
                Quantity::DrivePressureLeft => 1e5 * bar[0],
                Quantity::DrivePressureRight => 1e5 * bar[1],
                _ => f64::NAN,
            });
        }
        check.message()
    }

    #[test]
    fn pressures_that_differ_by_more_than_the_place_of_a_load_are_told() {
        let begin = "the pressures of the left and the right drive bellows are 4.0 and 2.0 bar";
        assert!(told(100, [4.0, 2.0]).is_some_and(|text| text.starts_with(begin)));
        for (values, bar, is_told) in [
            (99, [4.0, 2.0], false),
            (100, [2.0, 4.0], true),
            (100, [4.0, 0.0], true),
            (100, [4.0, 2.2], false),
            (100, [0.6, 0.1], false), // an empty trailer
            (100, [4.0, f64::NAN], false),
        ] {
            assert_eq!(told(values, bar).is_some(), is_told, "{values} {bar:?}");
        }
    }
}
