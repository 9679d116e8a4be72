//! A study as a page: its main finding on top, panels, and the scenario below.
//!
//! The page is one column, so that its text is still legible when it is printed 85 mm wide. Series
//! differ in color and in the shape of their markers, secondary ones are dashed with open markers:
//! they can be distinguished without color.

use std::ops::Range;

use cg_output::kind::STUDY_COMMENT;
use cg_thesis::study::{Abscissa, Panel, Quantity, Response, Series, Study};
use plotters::chart::MeshStyle;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axes::{Places, TICKS, numbers, places, range};
use crate::units::{axis, display_unit};

/// Units of the drawing per pixel of the page. The backend draws in whole units.
const PX: i32 = 10;
/// Width of the page, its margin, heights of a plot and of a line of a legend, all in pixels.
const WIDE: i32 = 480;
const MARGIN: i32 = 12;
const PLOT: i32 = 280;
const LEGEND_LINE: i32 = 21;
/// Heights of a bar with the space around it, of the title of a panel, of the numbers and the label
/// below its axes, and of the gap below it; space to the right of it; all in pixels.
const BAR: i32 = 22;
const PANEL_TITLE: i32 = 28;
const BELOW: i32 = 44;
const GAP: i32 = 16;
const RIGHT: i32 = 10;
/// Sizes of the fonts.
const TITLE: i32 = 17;
const TEXT: i32 = 13;
/// Distance of series with intervals from the true place of their points, as a share of the width.
const BESIDE: f64 = 0.009;
/// Number of points above which a series is drawn as a curve with few markers.
const DOTS: usize = 40;

const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GRID: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
/// Colors that color-blind people can distinguish (Okabe and Ito), each with its marker: a regular
/// polygon, given by its number of corners and the turn of the first one.
const KINDS: [(RGBColor, u8, f64); 6] = [
    (RGBColor(0x00, 0x72, 0xb2), 24, 0.0),
    (RGBColor(0xd5, 0x5e, 0x00), 4, 0.125),
    (RGBColor(0x00, 0x9e, 0x73), 3, 0.0),
    (RGBColor(0xcc, 0x79, 0xa7), 4, 0.0),
    (RGBColor(0xe6, 0x9f, 0x00), 3, 0.5),
    (RGBColor(0x56, 0xb4, 0xe9), 6, 0.0),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Places, RangedCoordf64>>;
type Point = (i32, i32);

/// The whole page as SVG.
pub(super) fn svg(study: &Study) -> anyhow::Result<String> {
    let title = wrap(&format!("{}.", study.finding), &font(TITLE, true));
    let notes = wrap(&format!("{}.", study.scenario.join("; ")), &font(TEXT, false));
    let title_high = count(&title) * (TITLE + 5) + 8;
    let panels_high: i32 = study.panels.iter().map(height).sum();
    let high = 2 * MARGIN + title_high + panels_high + count(&notes) * (TEXT + 4);
    let size = [WIDE, high].map(|length| (PX * length).unsigned_abs());
    let mut text = String::new();
    {
        let page = SVGBackend::with_string(&mut text, size.into()).into_drawing_area();
        page.fill(&WHITE)?;
        let edge = PX * MARGIN;
        let (head, mut rest) =
            page.margin(edge, edge, edge, edge).split_vertically(PX * title_high);
        paragraph(&head, title, TITLE + 5, &font(TITLE, true))?;
        for panel in &study.panels {
            let (part, below) = rest.split_vertically(PX * height(panel));
            draw(&part, panel)?;
            rest = below;
        }
        paragraph(&rest, notes, TEXT + 4, &font(TEXT, false))?;
        page.present()?;
    }
    // The page is shown at its proper size; the view box keeps the finer units.
    let drawn = format!("<svg width=\"{}\" height=\"{}\"", size[0], size[1]);
    let shown = format!("<svg width=\"{WIDE}\" height=\"{high}\"");
    let head = format!(">\n<!-- {STUDY_COMMENT} {} -->\n", study.name);
    Ok(text.replacen(&drawn, &shown, 1).replacen(">\n", &head, 1))
}

fn count<T>(items: &[T]) -> i32 {
    i32::try_from(items.len()).unwrap_or(i32::MAX)
}

/// A font of this size in pixels; the backend divides every size by 1.24.
fn font(size: i32, bold: bool) -> TextStyle<'static> {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    let font = ("Helvetica, Arial, sans-serif", 1.24 * f64::from(PX * size)).into_font();
    font.style(style).color(&INK)
}

/// Approximate width of a text in units of the drawing.
fn width(text: &str, style: &TextStyle<'_>) -> i32 {
    // The size of the font is that before the backend's division.
    style.font.box_size(text).map_or(0, |(wide, _)| wide.cast_signed() * 100 / 124)
}

/// Breaks a text between words. A number stays with the word behind it, such as its unit.
fn wrap(text: &str, style: &TextStyle<'_>) -> Vec<String> {
    let is_number = |word: &str, _: &str| word.ends_with(|c: char| c.is_ascii_digit());
    let words = joined(text.split(' '), is_number);
    let fits = |line: &str, word: &str| {
        width(&format!("{line} {word}"), style) <= PX * (WIDE - 2 * MARGIN)
    };
    joined(words.iter().map(String::as_str), fits)
}

/// Joins each word to the one before it, by a space, if both belong together.
fn joined<'a>(
    words: impl Iterator<Item = &'a str>,
    belongs: impl Fn(&str, &str) -> bool,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if belongs(line, word) => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn paragraph(
    area: &Area<'_>,
    lines: Vec<String>,
    line_high: i32,
    style: &TextStyle<'_>,
) -> anyhow::Result<()> {
    for (k, line) in (0..).zip(lines) {
        area.draw(&Text::new(line, (0, PX * line_high * k), style.clone()))?;
    }
    Ok(())
}

/// Height of a panel in pixels.
fn height(panel: &Panel) -> i32 {
    match &panel.x {
        Abscissa::Over(_) => PANEL_TITLE + legend_height(panel) + PLOT,
        Abscissa::Responses(responses) => PANEL_TITLE + count(responses) * BAR + BELOW + GAP,
    }
}

fn draw(area: &Area<'_>, panel: &Panel) -> anyhow::Result<()> {
    let title = match panel.figure {
        "" => panel.title.to_owned(),
        figure => format!("Fig. {}: {}", figure.replace('-', "–"), panel.title),
    };
    let (head, rest) = area.split_vertically(PX * PANEL_TITLE);
    head.draw(&Text::new(title, (0, 6 * PX), font(TEXT + 1, true)))?;
    match &panel.x {
        Abscissa::Over(quantity) => {
            let (names, plot) = rest.split_vertically(PX * legend_height(panel));
            legend(&names, panel)?;
            curves(&plot, panel, *quantity)
        }
        Abscissa::Responses(responses) => bars(&rest, panel, responses),
    }
}

/// Number of columns of a legend: two, if all names are short.
fn columns(panel: &Panel) -> usize {
    let half = PX * (WIDE / 2 - 60);
    if panel.series.iter().all(|s| width(&s.name, &font(TEXT, false)) < half) { 2 } else { 1 }
}

/// Height of a legend in pixels. A single series has none.
fn legend_height(panel: &Panel) -> i32 {
    let rows: Vec<_> = panel.series.chunks(columns(panel)).collect();
    if panel.series.len() < 2 { 0 } else { LEGEND_LINE * count(&rows) }
}

/// How a series is drawn.
#[derive(Clone, Copy)]
struct Look {
    color: RGBColor,
    corners: u8,
    turn: f64,
    aside: bool,
    apart: bool,
}

impl Look {
    fn of(series: &Series) -> Self {
        let (color, corners, turn) = KINDS[series.kind % KINDS.len()];
        // The thesis's values are open markers in the color of the text.
        let color = if series.printed { INK } else { color };
        let aside = series.aside || series.printed;
        Self { color, corners, turn, aside, apart: series.apart }
    }

    fn line(self) -> ShapeStyle {
        self.color.stroke_width((PX * 2).unsigned_abs())
    }

    /// The length of a dash; a solid line is a single one.
    fn dash(self) -> i32 {
        if self.aside { 6 * PX } else { i32::MAX }
    }

    /// The marker around the origin: its area and its outline.
    fn marker(self) -> (Polygon<Point>, PathElement<Point>) {
        // Polygons with few corners need a greater radius to look as large as a circle.
        let radius = f64::from(PX) * if self.corners > 6 { 3.6 } else { 4.6 };
        #[allow(clippy::cast_possible_truncation)] // some dozens
        let corner = |k: u8| {
            let turns = self.turn + f64::from(k) / f64::from(self.corners);
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turns);
            ((radius * sin).round() as i32, (-radius * cos).round() as i32)
        };
        let corners: Vec<Point> = (0..=self.corners).map(corner).collect();
        let fill = if self.aside { WHITE } else { self.color };
        (Polygon::new(corners.clone(), fill), PathElement::new(corners, self.line()))
    }
}

/// Draws the names of the series row by row above the plot, where no curve is.
fn legend(area: &Area<'_>, panel: &Panel) -> anyhow::Result<()> {
    if panel.series.len() < 2 {
        return Ok(());
    }
    let columns = columns(panel);
    for (column, part) in area.split_evenly((1, columns)).iter().enumerate() {
        let mut names = ChartBuilder::on(part).build_cartesian_2d(0.0..1.0, 0.0..1.0)?;
        for series in panel.series.iter().skip(column).step_by(columns) {
            let look = Look::of(series);
            let named = names.draw_series(None::<PathElement<(f64, f64)>>)?.label(&series.name);
            named.legend(move |at| {
                let ends = [(0, 0), (32 * PX, 0)].into_iter();
                let ends = ends.take(if look.apart { 0 } else { 2 });
                let line = DashedPathElement::new(ends, look.dash(), 4 * PX, look.line());
                let (fill, outline) = look.marker();
                let center = EmptyElement::at((16 * PX, 0)) + fill + outline;
                EmptyElement::at(at) + line + center
            });
        }
        let labels = &mut names.configure_series_labels();
        labels.position(SeriesLabelPosition::UpperLeft).legend_area_size(40 * PX).margin(0);
        labels.label_font(font(TEXT, false)).draw()?;
    }
    Ok(())
}

/// Fonts and lines of axes, and the number of their ticks.
fn plain<X: Ranged, Y: Ranged, D: DrawingBackend>(axes: &mut MeshStyle<'_, '_, X, Y, D>) {
    axes.label_style(font(TEXT, false))
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(PX.unsigned_abs()))
        .axis_style(INK.stroke_width(PX.unsigned_abs()))
        .set_all_tick_mark_size(4 * PX)
        .x_labels(TICKS)
        .y_labels(TICKS);
}

fn curves(area: &Area<'_>, panel: &Panel, over: Quantity) -> anyhow::Result<()> {
    let factors = [display_unit(over.unit).factor, display_unit(panel.y.unit).factor];
    let [x, y] = ranges(panel, factors);
    let (x_numbers, y_numbers) = (numbers(&x), numbers(&y));
    let mut chart = ChartBuilder::on(area)
        .margin_right(PX * RIGHT)
        .margin_top(PX * 8)
        .margin_bottom(PX * GAP)
        .x_label_area_size(PX * BELOW)
        .y_label_area_size(PX * 64)
        .build_cartesian_2d(places(panel, factors[0], x), y)?;
    let mut axes = chart.configure_mesh();
    plain(&mut axes);
    axes.x_label_formatter(&x_numbers)
        .y_label_formatter(&y_numbers)
        .x_desc(axis(over))
        .y_desc(axis(panel.y))
        .draw()?;
    for (k, series) in (0..).zip(&panel.series) {
        if has_intervals(series) {
            let aside = f64::from(2 * k + 1 - count(&panel.series)) * BESIDE;
            with_intervals(&mut chart, series, factors, aside)?;
        } else {
            curve(&mut chart, series, factors)?;
        }
    }
    Ok(())
}

/// Whether the series consists of measurements with intervals and not of a curve.
fn has_intervals(series: &Series) -> bool {
    !(series.intervals.is_empty() && series.unanswered.is_empty())
}

fn is_dense(series: &Series) -> bool {
    series.points.len() > DOTS
}

/// What both axes cover.
fn ranges(panel: &Panel, factors: [f64; 2]) -> [Range<f64>; 2] {
    let all = || panel.series.iter().flat_map(|series| scaled(&series.points, factors));
    let ends = panel.series.iter().flat_map(|series| series.intervals.iter().flatten());
    let ends: Vec<f64> = ends.map(|end| end * factors[1]).collect();
    let values = || all().map(|p| p.1).chain(ends.iter().copied());
    let tight = range(values(), 0.0);
    // A few peak values for comparison are drawn from zero, like bars.
    let few = panel.series.iter().all(|series| series.points.len() <= 3);
    let zero = few || (0.0..tight.end / 3.0).contains(&tight.start);
    let y = range(values().chain(zero.then_some(0.0)), 0.07);
    let unanswered = panel.series.iter().flat_map(|series| &series.unanswered);
    let places = all().map(|p| p.0).chain(unanswered.map(|x| x * factors[0]));
    let x_space = if panel.series.iter().any(is_dense) { 0.0 } else { 0.05 };
    let mut x = range(places, x_space);
    if panel.series.iter().any(has_intervals) {
        // An interval beside a point at zero needs space to its left.
        x.start -= x_space * x.end;
    }
    [x, y]
}

/// Points in the units of the axes.
fn scaled(points: &[[f64; 2]], factors: [f64; 2]) -> Vec<(f64, f64)> {
    points.iter().map(|p| (p[0] * factors[0], p[1] * factors[1])).collect()
}

fn curve(chart: &mut Chart<'_>, series: &Series, factors: [f64; 2]) -> anyhow::Result<()> {
    let (look, points) = (Look::of(series), scaled(&series.points, factors));
    // A curve has eight markers, those of other kinds elsewhere.
    let step = if is_dense(series) { points.len() / 8 } else { 1 };
    let first = step * (1 + 2 * (series.kind % KINDS.len())) / (2 * KINDS.len());
    let marked: Vec<_> = points.iter().copied().skip(first).step_by(step).collect();
    // A thousandth of the curve is finer than print.
    let fine: Vec<_> = points.iter().copied().step_by(1 + points.len() / 1000).collect();
    if !look.apart {
        chart.draw_series(DashedLineSeries::new(fine, look.dash(), 4 * PX, look.line()))?;
    }
    markers(chart, look, marked)
}

fn markers(chart: &mut Chart<'_>, look: Look, points: Vec<(f64, f64)>) -> anyhow::Result<()> {
    chart.draw_series(points.into_iter().map(|at| {
        let (fill, outline) = look.marker();
        EmptyElement::at(at) + fill + outline
    }))?;
    Ok(())
}

/// Draws measurements with their intervals, aside by a share of the width, so that those of several
/// series do not hide each other. A cross above the axis marks where there is no height.
fn with_intervals(
    chart: &mut Chart<'_>,
    series: &Series,
    factors: [f64; 2],
    aside: f64,
) -> anyhow::Result<()> {
    let (look, x, y) = (Look::of(series), chart.x_range(), chart.y_range());
    let beside = |place: f64| place + aside * (x.end - x.start);
    let points: Vec<_> =
        scaled(&series.points, factors).into_iter().map(|(x, y)| (beside(x), y)).collect();
    let thin = look.color.stroke_width((PX * 3 / 2).unsigned_abs());
    chart.draw_series(points.iter().zip(&series.intervals).map(|(&(x, y), ends)| {
        let [low, high] = ends.map(|end| end * factors[1]);
        ErrorBar::new_vertical(x, low, y, high, thin, (6 * PX).unsigned_abs())
    }))?;
    markers(chart, look, points)?;
    let places = series.unanswered.iter().map(|x| (beside(x * factors[0]), y.start));
    let cross = |at| EmptyElement::at(at) + Cross::new((0, -9 * PX), 4 * PX, look.line());
    chart.draw_series(places.map(cross))?;
    Ok(())
}

/// Draws one bar for each response, with its change and its values at the end.
fn bars(area: &Area<'_>, panel: &Panel, responses: &[Response]) -> anyhow::Result<()> {
    let factor = display_unit(panel.y.unit).factor;
    let changes = panel.series.iter().flat_map(Series::values).map(|change| change * factor);
    let all = range(changes.clone().chain([0.0]), 0.0);
    // More than half of the width is for the values next to the longest bar.
    let x = 1.1 * all.start..(2.4 * all.end).max(-all.start);
    let x_numbers = numbers(&x);
    // The first response is on top: the rows are 0, -1, -2 from there.
    let last = 1 - count(responses);
    let rows = (last..0).into_segmented();
    let name = |row: &SegmentValue<i32>| match row {
        SegmentValue::CenterOf(row) => {
            responses.get(row.unsigned_abs() as usize).map_or("", |response| response.name).into()
        }
        SegmentValue::Exact(_) | SegmentValue::Last => String::new(),
    };
    let mut chart = ChartBuilder::on(area)
        .margin_right(PX * RIGHT)
        .margin_bottom(PX * GAP)
        .x_label_area_size(PX * BELOW)
        .y_label_area_size(PX * 200)
        .build_cartesian_2d(x, rows)?;
    let mut axes = chart.configure_mesh();
    plain(&mut axes);
    axes.disable_mesh()
        .axis_style(GRID.stroke_width(PX.unsigned_abs()))
        .y_labels(responses.len())
        .x_label_formatter(&x_numbers)
        .y_label_formatter(&name)
        .x_desc(axis(panel.y))
        .draw()?;
    let space = (3 * PX).unsigned_abs();
    let text = font(TEXT - 1, false).pos(Pos::new(HPos::Left, VPos::Center));
    for ((response, change), row) in responses.iter().zip(changes).zip((last..1).rev()) {
        let ends = [(0.0, SegmentValue::Exact(row)), (change, SegmentValue::Exact(row + 1))];
        let mut bar = Rectangle::new(ends, KINDS[0].0.filled());
        bar.set_margin(space, space, 0, 0);
        chart.draw_series([bar])?;
        let end = (change.max(0.0), SegmentValue::CenterOf(row));
        let values = Text::new(values(response), (6 * PX, 0), text.clone());
        chart.draw_series([EmptyElement::at(end) + values])?;
    }
    let zero = [(0.0, SegmentValue::Exact(last)), (0.0, SegmentValue::Last)];
    chart.draw_series([PathElement::new(zero, INK.stroke_width(PX.unsigned_abs()))])?;
    Ok(())
}

/// The text at a bar, such as `+21.8 % (2.63 → 3.20°)`.
fn values(response: &Response) -> String {
    let unit = display_unit(response.unit);
    let [before, after] = [response.before, response.after].map(|v| v * unit.factor);
    let change = 100.0 * (response.after / response.before - 1.0);
    let decimals = if unit.symbol == "g" { 3 } else { 2 };
    let space = if unit.symbol.starts_with('°') { "" } else { " " };
    let text =
        format!("{change:+.1} % ({before:.decimals$} → {after:.decimals$}{space}{})", unit.symbol);
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::measured;
    use super::*;

    /// A measurement adds the three strokes of its interval, a missing one the two of its cross.
    #[test]
    fn a_figure_has_bars_for_intervals_and_crosses_without_a_height() {
        let strokes = |study: &Study| {
            let color = KINDS[study.panels[0].series[0].kind].0;
            let stroke = format!("stroke=\"#{:02X}{:02X}{:02X}\"", color.0, color.1, color.2);
            let svg = svg(study).unwrap();
            svg.lines().filter(|line| line.starts_with("<line ") && line.contains(&stroke)).count()
        };
        let mut study = measured();
        assert_eq!(strokes(&study), 2 * 3 + 2);
        study.panels[0].series[0].unanswered.clear();
        assert_eq!(strokes(&study), 2 * 3);
    }

    #[test]
    fn kinds_of_series_differ_without_color() {
        for (i, (_, corners, turn)) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|(_, c, t)| (c, t) != (corners, turn)), "kind {i}");
        }
    }

    /// A number and a long word behind it begin a line of their own if they do not fit.
    #[test]
    fn no_line_is_wider_than_the_figure() {
        let style = font(TEXT, false);
        for filler in 1..40 {
            let text = format!("{} 35 drives, 0 intervals miss the true one", "x ".repeat(filler));
            let lines = wrap(&text, &style);
            assert!(lines.iter().all(|line| width(line, &style) <= PX * (WIDE - 2 * MARGIN)));
            assert!(lines.iter().all(|line| !line.ends_with(|c: char| c.is_ascii_digit())));
            assert_eq!(lines.join(" "), text);
        }
    }
}
