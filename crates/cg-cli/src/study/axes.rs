//! Ranges, ticks and grid of a panel.

use super::canvas::{Anchor, Canvas, GRID, INK, Words};

/// Font sizes of the numbers at the ticks and of the label of an axis.
const TICK: f64 = 12.0;
const LABEL: f64 = 13.0;

/// One axis with values from `least` to `most` and its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    least: f64,
    most: f64,
    step: f64,
}

/// The space between an axis's ends and its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Room {
    /// No space, for time histories.
    None,
    /// Some space on both sides.
    Around,
    /// Space up to the next tick.
    ToTicks,
}

impl Scale {
    /// An axis that shows all of `values` with about `ticks` ticks.
    pub(super) fn over(values: impl Iterator<Item = f64> + Clone, ticks: f64, room: Room) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (mut least, mut most) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        if least > most {
            (least, most) = (0.0, 1.0);
        }
        // The axis covers at least one percent of the values, so that a small change is drawn
        // small.
        let short = 0.01 * most.abs().max(1e-9) - (most - least);
        if short > 0.0 {
            (least, most) = (least - 0.5 * short, most + 0.5 * short);
        }
        let step = nice((most - least) / ticks);
        match room {
            Room::None => {}
            Room::Around => {
                let pad = 0.05 * (most - least);
                (least, most) = (least - pad, most + pad);
            }
            Room::ToTicks => {
                let touching = 0.15 * step;
                // A value slightly below zero counts as zero.
                let zero = least >= -0.02 * most;
                least = ((least - touching) / step).floor() * step;
                most = ((most + touching) / step).ceil() * step;
                if zero {
                    least = least.max(0.0);
                }
            }
        }
        Self { least, most, step }
    }

    /// An axis with these ends.
    pub(super) fn between(least: f64, most: f64, ticks: f64) -> Self {
        Self { least, most, step: nice((most - least) / ticks) }
    }

    /// The position of a value on the axis, from 0 to 1.
    fn share(&self, value: f64) -> f64 {
        (value - self.least) / (self.most - self.least)
    }

    /// The values at the ticks.
    fn ticks(&self) -> Vec<f64> {
        let first = (self.least / self.step - 1e-6).ceil();
        let count = (self.most / self.step + 1e-6).floor() - first;
        // There are about a dozen ticks; the number is negative if there is no space for one.
        #[allow(clippy::cast_possible_truncation)]
        let count = count as i32;
        (0..=count).map(|k| (first + f64::from(k)) * self.step).collect()
    }

    /// The number at a tick, with the decimals of the step.
    fn number(&self, value: f64) -> String {
        let decimals = (0..6_u8)
            .find(|d| {
                let scaled = self.step * 10f64.powi(i32::from(*d));
                (scaled - scaled.round()).abs() < 1e-6 * scaled
            })
            .unwrap_or(6);
        // This avoids a negative zero.
        let value = if value.abs() < 1e-9 * self.step { 0.0 } else { value };
        format!("{value:.*}", usize::from(decimals)).replace('-', "−")
    }
}

/// The next greater number of 1, 2, 2.5, 5 times a power of ten.
fn nice(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let times = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|times| times * power >= step * 0.999);
    times.unwrap_or(10.0) * power
}

/// A rectangle of the page with a horizontal and a vertical axis.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Axes {
    /// The position of a point on the page.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.left + self.x.share(x) * (self.right - self.left),
            self.bottom - self.y.share(y) * (self.bottom - self.top),
        ]
    }

    /// Draws grid lines, numbers and label of the horizontal axis.
    pub(super) fn draw_x(&self, canvas: &Canvas<'_>, label: &str) -> anyhow::Result<()> {
        for value in self.x.ticks() {
            let x = self.place([value, 0.0])[0];
            canvas.line(&[[x, self.top], [x, self.bottom]], GRID, 0.8)?;
            let words = Words::of(TICK, Anchor::Middle);
            canvas.words(&self.x.number(value), [x, self.bottom + 14.0], words)?;
        }
        let middle = [0.5 * (self.left + self.right), self.bottom + 36.0];
        canvas.words(label, middle, Words::of(LABEL, Anchor::Middle))
    }

    /// Draws grid lines, numbers and label of the vertical axis.
    pub(super) fn draw_y(&self, canvas: &Canvas<'_>, label: &str) -> anyhow::Result<()> {
        for value in self.y.ticks() {
            let y = self.place([0.0, value])[1];
            canvas.line(&[[self.left, y], [self.right, y]], GRID, 0.8)?;
            let words = Words::of(TICK, Anchor::Right);
            canvas.words(&self.y.number(value), [self.left - 8.0, y], words)?;
        }
        let middle = [self.left - 52.0, 0.5 * (self.top + self.bottom)];
        canvas.words(label, middle, Words { upright: true, ..Words::of(LABEL, Anchor::Middle) })
    }

    /// Draws the left and the lower edge.
    pub(super) fn frame(&self, canvas: &Canvas<'_>) -> anyhow::Result<()> {
        let corner = [self.left, self.bottom];
        canvas.line(&[[self.left, self.top], corner, [self.right, self.bottom]], INK, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_hold_all_values() {
        let scale = Scale::over([2.28, 3.92].into_iter(), 6.0, Room::ToTicks);
        let ticks = scale.ticks();
        assert!(ticks[0] <= 2.28 && 3.92 <= ticks[ticks.len() - 1], "{ticks:?}");
        let numbers: Vec<String> = ticks.iter().map(|t| scale.number(*t)).collect();
        assert_eq!(numbers[..2], ["2.0", "2.5"]);
    }

    #[test]
    fn a_constant_and_nothing_at_all_have_axes_too() {
        for values in [vec![2.63, 2.63], vec![0.0, 0.0], vec![f64::NAN], vec![]] {
            let scale = Scale::over(values.iter().copied(), 5.0, Room::ToTicks);
            assert!(scale.least < scale.most && !scale.ticks().is_empty(), "{scale:?}");
        }
    }

    #[test]
    fn negative_numbers_have_a_minus_and_zero_has_none() {
        let scale = Scale::between(-0.5, 0.5, 4.0);
        assert_eq!(scale.number(-0.25), "−0.25");
        assert_eq!(scale.number(-1e-17), "0.00");
    }
}
