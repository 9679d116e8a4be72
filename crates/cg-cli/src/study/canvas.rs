//! Lines, circles and text on an SVG page, in pixels.

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};

/// Scale of the drawing. The backend uses whole pixels, and a larger drawing gives smooth curves.
const FINE: f64 = 8.0;
/// Factor by which the backend shrinks every font.
const FONT: f64 = 1.24;
const FAMILY: &str = "Helvetica, Arial, sans-serif";
/// Upper estimate of the mean letter width divided by the font size, for sans-serif fonts; then for
/// bold ones.
const LETTER: f64 = 0.6;
const BOLD: f64 = 0.66;

pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
pub(super) const FAINT: RGBColor = RGBColor(0x70, 0x70, 0x70);
pub(super) const GRID: RGBColor = RGBColor(0xe2, 0xe2, 0xe2);
pub(super) const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);

/// The part of a text that is placed at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

/// Style of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words {
    pub(super) size: f64,
    pub(super) color: RGBColor,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
    /// Whether the text is rotated and read from bottom to top.
    pub(super) upright: bool,
}

impl Words {
    pub(super) const fn of(size: f64, anchor: Anchor) -> Self {
        Self { size, color: INK, anchor, bold: false, upright: false }
    }
}

/// Approximate width of a text.
pub(super) fn width(text: &str, words: Words) -> f64 {
    #[allow(clippy::cast_precision_loss)] // a line of it
    let letters = text.chars().count() as f64;
    letters * words.size * if words.bold { BOLD } else { LETTER }
}

/// A page.
pub(super) struct Canvas<'a>(DrawingArea<SVGBackend<'a>, Shift>);

#[allow(clippy::cast_possible_truncation)] // some thousand pixels
fn fine(value: f64) -> i32 {
    (FINE * value).round() as i32
}

fn pixel([x, y]: [f64; 2]) -> (i32, i32) {
    (fine(x), fine(y))
}

impl Canvas<'_> {
    /// The SVG text of a page of this size, drawn by `draw`, with a comment at its beginning.
    pub(super) fn page(
        size: [f64; 2],
        comment: &str,
        draw: impl FnOnce(&Canvas<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<String> {
        let mut text = String::new();
        let [wide, high] = size.map(|length| fine(length).unsigned_abs());
        {
            let area = SVGBackend::with_string(&mut text, (wide, high)).into_drawing_area();
            area.fill(&PAPER)?;
            let canvas = Canvas(area);
            draw(&canvas)?;
            canvas.0.present()?;
        }
        // The page is shown at its proper size; the view box keeps the finer pixels.
        let drawn = format!("<svg width=\"{wide}\" height=\"{high}\"");
        let shown = format!("<svg width=\"{:.0}\" height=\"{:.0}\"", size[0], size[1]);
        let head = format!(">\n<!-- {comment} -->\n");
        Ok(text.replacen(&drawn, &shown, 1).replacen(">\n", &head, 1))
    }

    pub(super) fn line(
        &self,
        points: &[[f64; 2]],
        color: RGBColor,
        wide: f64,
    ) -> anyhow::Result<()> {
        let style = ShapeStyle::from(&color).stroke_width(fine(wide).unsigned_abs());
        let points: Vec<_> = points.iter().copied().map(pixel).collect();
        Ok(self.0.draw(&PathElement::new(points, style))?)
    }

    /// Draws dashes of 6 with gaps of 4 along the points.
    pub(super) fn dashes(
        &self,
        points: &[[f64; 2]],
        color: RGBColor,
        wide: f64,
    ) -> anyhow::Result<()> {
        for dash in dashes(points, 6.0, 4.0) {
            self.line(&dash, color, wide)?;
        }
        Ok(())
    }

    /// Draws a dot, or a ring if `open`.
    pub(super) fn dot(&self, at: [f64; 2], color: RGBColor, open: bool) -> anyhow::Result<()> {
        self.0.draw(&Circle::new(pixel(at), fine(3.6), color.filled()))?;
        if open {
            self.0.draw(&Circle::new(pixel(at), fine(2.0), PAPER.filled()))?;
        }
        Ok(())
    }

    pub(super) fn bar(&self, corners: [[f64; 2]; 2], color: RGBColor) -> anyhow::Result<()> {
        Ok(self.0.draw(&Rectangle::new(corners.map(pixel), color.filled()))?)
    }

    /// Draws a line of text; its middle is at the height of `at`.
    pub(super) fn words(&self, text: &str, at: [f64; 2], words: Words) -> anyhow::Result<()> {
        let anchor = match words.anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let mut font = (FAMILY, FINE * FONT * words.size).into_font();
        if words.bold {
            font = font.style(plotters::style::FontStyle::Bold);
        }
        if words.upright {
            font = font.transform(FontTransform::Rotate270);
        }
        let style = TextStyle::from(font).color(&words.color).pos(Pos::new(anchor, VPos::Center));
        Ok(self.0.draw(&Text::new(text.to_owned(), pixel(at), style))?)
    }
}

/// The pieces of a path that a dashed line draws.
fn dashes(points: &[[f64; 2]], dash: f64, gap: f64) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![points.iter().take(1).copied().collect()];
    let (mut drawing, mut left) = (true, dash);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let share = done / length;
            let at = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            if drawing {
                pieces.last_mut().into_iter().for_each(|piece| piece.push(at));
            } else {
                pieces.push(vec![at]);
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length - done;
        if drawing {
            pieces.last_mut().into_iter().for_each(|piece| piece.push(to));
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_and_gaps_follow_the_path_round_its_corners() {
        let pieces = dashes(&[[0.0, 0.0], [8.0, 0.0], [8.0, 12.0]], 6.0, 4.0);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0], [[0.0, 0.0], [6.0, 0.0]]);
        assert_eq!(pieces[1], [[8.0, 2.0], [8.0, 8.0]]);
    }
}
