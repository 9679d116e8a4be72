//! What the axes of a figure cover, and where their ticks are.

use std::ops::Range;

use cg_thesis::study::Panel;
use plotters::coord::ranged1d::{BoldPoints, DefaultFormatting, KeyPointHint};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// Greatest number of ticks of an axis.
pub(super) const TICKS: usize = 7;
/// Number of conditions up to which each has its own tick.
const FEW: usize = 3;

/// A horizontal axis with its ticks.
pub(super) struct Places {
    range: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Ranged for Places {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.range.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.range()
    }
}

/// The values of an axis and some space around them. It covers at least one percent of the values,
/// so that a small change is drawn small, and it does not become negative with the space.
pub(super) fn range(values: impl Iterator<Item = f64>, space: f64) -> Range<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (least, most) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if least > most {
        return 0.0..1.0;
    }
    let span = (most - least).max(0.01 * least.abs().max(most.abs())).max(1e-9);
    let pad = (space * span).max(0.5 * (span - (most - least)));
    let low = least - pad;
    (if least >= 0.0 { low.max(0.0) } else { low })..most + pad
}

/// Writes the numbers at the ticks of an axis with as many decimals as they need.
pub(super) fn numbers(range: &Range<f64>) -> impl Fn(&f64) -> String + use<> {
    let ticks = RangedCoordf64::from(range.clone()).key_points(BoldPoints(TICKS));
    let whole = |value: f64| (value - value.round()).abs() < 1e-6;
    let exact = |d: &u8| ticks.iter().all(|tick| whole(tick * libm::pow(10.0, f64::from(*d))));
    let decimals = usize::from((0..6).find(exact).unwrap_or(6));
    // The sum avoids a negative zero.
    move |value| format!("{:.decimals$}", (value * 1e9).round() / 1e9 + 0.0).replace('-', "−")
}

/// The ticks below a plot: those of the conditions that were run, if they are few.
pub(super) fn places(panel: &Panel, factor: f64, x: Range<f64>) -> Places {
    let range = RangedCoordf64::from(x);
    let mut run: Vec<f64> = Vec::new();
    for point in panel.series.iter().flat_map(|series| &series.points) {
        let place = point[0] * factor;
        if !run.iter().any(|known| (known - place).abs() < 1e-9) {
            run.push(place);
        }
        if run.len() > FEW {
            let ticks = range.key_points(BoldPoints(TICKS));
            return Places { range, ticks };
        }
    }
    Places { range, ticks: run }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_holds_all_values_and_space_that_does_not_cross_zero() {
        let axis = range([2.0, 4.0, f64::NAN].into_iter(), 0.05);
        assert!((axis.start - 1.9).abs() < 1e-12 && (axis.end - 4.1).abs() < 1e-12, "{axis:?}");
        assert_eq!(range([0.0, 1.0].into_iter(), 0.05), 0.0..1.05);
    }

    #[test]
    fn a_constant_and_nothing_at_all_have_axes_too() {
        for values in [vec![2.63, 2.63], vec![-2.63], vec![0.0, 0.0], vec![f64::NAN], vec![]] {
            let axis = range(values.iter().copied(), 0.05);
            assert!(axis.start < axis.end, "{values:?}: {axis:?}");
            assert!(values.iter().all(|v| v.is_nan() || axis.contains(v)), "{axis:?}");
        }
    }

    #[test]
    fn numbers_have_the_decimals_of_the_ticks_and_zero_has_no_minus() {
        let number = numbers(&(-0.5..0.5));
        assert_eq!([-0.2, -1e-17, 0.4].map(|v| number(&v)), ["−0.2", "0.0", "0.4"]);
        assert_eq!(numbers(&(0.0..60.0))(&20.0), "20");
        assert_eq!(numbers(&(0.0..0.2))(&0.1), "0.10");
    }
}
