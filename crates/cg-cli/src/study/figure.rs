//! A study as a page: its main finding on top, panels, and the scenario below.

use cg_logs::output::kind::STUDY_COMMENT;
use cg_thesis::study::{Abscissa, Panel, Response, Series, Study};
use plotters::style::RGBColor;

use super::axes::{Axes, Room, Scale};
use super::canvas::{Anchor, Canvas, FAINT, INK, PAPER, Words, width};
use crate::units::{axis, shown};

const TITLE: f64 = 19.0;
const PANEL_TITLE: f64 = 14.0;
const LEGEND: f64 = 13.0;
const NOTE: f64 = 11.0;
const MARGIN: f64 = 24.0;
/// Height of a panel with titles and axes.
const PANEL_HIGH: f64 = 400.0;
/// Height of the part below the axes: numbers, label, and space.
const BELOW: f64 = 68.0;
/// Number of points above which a series is drawn as a curve without dots.
const DOTS: usize = 40;

/// Colors that color-blind people can distinguish (Okabe and Ito).
const COLORS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
];

fn color(kind: usize) -> RGBColor {
    COLORS[kind % COLORS.len()]
}

/// A part of the page.
#[derive(Clone, Copy, Debug)]
struct Part {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

/// The whole page as SVG.
pub(super) fn svg(study: &Study) -> anyhow::Result<String> {
    let wide = if study.panels.len() == 1 { 860.0 } else { 1180.0 };
    let inner = wide - 2.0 * MARGIN;
    let bold = Words { bold: true, ..Words::of(TITLE, Anchor::Left) };
    let faint = Words { color: FAINT, ..Words::of(NOTE, Anchor::Left) };
    let title = wrap(&format!("{}.", study.finding), bold, inner);
    let notes = wrap(&format!("{}.", study.scenario.join("; ")), faint, inner);
    #[allow(clippy::cast_precision_loss)] // lines of a page
    let [title_high, notes_high] =
        [1.3 * TITLE * title.len() as f64, 1.4 * NOTE * notes.len() as f64];
    let panel_high = if study.panels.len() == 1 { 1.2 * PANEL_HIGH } else { PANEL_HIGH };
    let rows = rows(&study.panels);
    #[allow(clippy::cast_precision_loss)]
    let panels_high = panel_high * rows.len() as f64;
    let high = MARGIN + title_high + 10.0 + panels_high + notes_high + MARGIN;
    let made = format!("{STUDY_COMMENT} {}", study.name);
    Canvas::page([wide, high], &made, |canvas| {
        paragraph(canvas, &title, MARGIN, bold)?;
        let mut top = MARGIN + title_high + 10.0;
        for row in rows {
            #[allow(clippy::cast_precision_loss)]
            let own = inner / row.len() as f64;
            let mut left = MARGIN;
            for panel in row {
                let part = Part { left, top, right: left + own, bottom: top + panel_high };
                draw(canvas, panel, part)?;
                left += own;
            }
            top += panel_high;
        }
        paragraph(canvas, &notes, top, faint)
    })
}

/// Rows of two panels; if their number is odd, the first panel has its own row.
fn rows(panels: &[Panel]) -> Vec<&[Panel]> {
    let (first, rest) = panels.split_at(panels.len() % 2);
    let alone = (!first.is_empty()).then_some(first);
    alone.into_iter().chain(rest.chunks(2)).collect()
}

/// Draws lines of text below the position `top`.
fn paragraph(canvas: &Canvas<'_>, lines: &[String], top: f64, words: Words) -> anyhow::Result<()> {
    let mut y = top + 0.65 * words.size;
    for line in lines {
        canvas.words(line, [MARGIN, y], words)?;
        y += 1.35 * words.size;
    }
    Ok(())
}

/// Breaks a text between words. A percent sign stays with its number.
fn wrap(text: &str, words: Words, wide: f64) -> Vec<String> {
    let text = text.replace(" %", "\u{a0}%");
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), words) <= wide => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn draw(canvas: &Canvas<'_>, panel: &Panel, part: Part) -> anyhow::Result<()> {
    let title = match panel.figure {
        "" => panel.title.to_owned(),
        figure => format!("Fig. {}: {}", figure.replace('-', "–"), panel.title),
    };
    let words = Words { bold: true, ..Words::of(PANEL_TITLE, Anchor::Left) };
    canvas.words(&title, [part.left, part.top + 14.0], words)?;
    let top = part.top + 34.0;
    match &panel.x {
        Abscissa::Over(quantity) => {
            let inner = Part { top: legend(canvas, panel, part, top)?, ..part };
            curves(canvas, panel, &axis(*quantity), shown(quantity.unit).factor, inner)
        }
        Abscissa::Responses(responses) => bars(canvas, panel, responses, Part { top, ..part }),
    }
}

/// Draws the names of the series in rows below the panel's title; returns where the axes may begin.
fn legend(canvas: &Canvas<'_>, panel: &Panel, part: Part, top: f64) -> anyhow::Result<f64> {
    if panel.series.len() < 2 {
        return Ok(top + 4.0);
    }
    let first = part.left + 68.0;
    let (mut x, mut y) = (first, top + 6.0);
    for series in &panel.series {
        let own = 34.0 + width(&series.name, Words::of(LEGEND, Anchor::Left)) + 12.0;
        if x > first && x + own > part.right {
            (x, y) = (first, y + 20.0);
        }
        stroke(canvas, series, &[[x, y], [x + 28.0, y]])?;
        if dotted(series) {
            canvas.dot([x + 14.0, y], color(series.kind), series.aside)?;
        }
        canvas.words(&series.name, [x + 34.0, y], Words::of(LEGEND, Anchor::Left))?;
        x += own;
    }
    Ok(y + 20.0)
}

fn dotted(series: &Series) -> bool {
    series.points.len() <= DOTS
}

fn stroke(canvas: &Canvas<'_>, series: &Series, points: &[[f64; 2]]) -> anyhow::Result<()> {
    if series.aside {
        canvas.dashes(points, color(series.kind), 1.6)
    } else {
        canvas.line(points, color(series.kind), 2.0)
    }
}

fn curves(
    canvas: &Canvas<'_>,
    panel: &Panel,
    x_label: &str,
    x_factor: f64,
    part: Part,
) -> anyhow::Result<()> {
    let y_factor = shown(panel.y.unit).factor;
    let all = || panel.series.iter().flat_map(|series| series.points.iter().copied());
    let curve = panel.series.iter().any(|series| !dotted(series));
    let room = if curve { Room::None } else { Room::Around };
    // A few peak values for comparison are drawn from zero, like bars.
    let few = panel.series.iter().all(|series| series.points.len() <= 3);
    let zero = few.then_some([0.0, 0.0]);
    let axes = Axes {
        left: part.left + 68.0,
        top: part.top,
        right: part.right - 16.0,
        bottom: part.bottom - BELOW,
        x: Scale::over(all().map(|p| p[0] * x_factor), 7.0, room),
        y: Scale::over(all().chain(zero).map(|p| p[1] * y_factor), 6.0, Room::ToTicks),
    };
    axes.draw_x(canvas, x_label)?;
    axes.draw_y(canvas, &axis(panel.y))?;
    for series in &panel.series {
        let places: Vec<[f64; 2]> =
            series.points.iter().map(|p| axes.place([p[0] * x_factor, p[1] * y_factor])).collect();
        stroke(canvas, series, &thinned(&places))?;
        if dotted(series) {
            for place in &places {
                canvas.dot(*place, color(series.kind), series.aside)?;
            }
        }
    }
    axes.frame(canvas)
}

/// Removes points that are within 1.5 pixels of the previous one.
fn thinned(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for place in places {
        let near = kept.last().is_some_and(|k| (k[0] - place[0]).hypot(k[1] - place[1]) < 1.5);
        if !near {
            kept.push(*place);
        }
    }
    kept.extend(places.last().copied());
    kept
}

/// Draws one bar for each response, with its change and its values at the end.
fn bars(
    canvas: &Canvas<'_>,
    panel: &Panel,
    responses: &[Response],
    part: Part,
) -> anyhow::Result<()> {
    let factor = shown(panel.y.unit).factor;
    let changes = panel.series.iter().flat_map(Series::values);
    let (least, most) =
        changes.fold((0.0_f64, 0.0_f64), |(a, b), y| (a.min(y * factor), b.max(y * factor)));
    #[allow(clippy::cast_precision_loss)] // a dozen
    let rows = responses.len() as f64;
    let axes = Axes {
        left: part.left + 220.0,
        top: part.top,
        right: part.right - 16.0,
        bottom: part.bottom - BELOW,
        // A third of the width is for the values next to the longest bar.
        x: Scale::between(1.1 * least, 1.5 * most, 8.0),
        y: Scale::between(rows, 0.0, 1.0),
    };
    axes.draw_x(canvas, &axis(panel.y))?;
    for point in panel.series.iter().flat_map(|series| &series.points) {
        // The x value of a point is the index of a response.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let Some(response) = responses.get(point[0] as usize) else { continue };
        let middle = point[0] + 0.5;
        let change = point[1] * factor;
        let corners = [[0.0, middle - 0.32], [change, middle + 0.32]].map(|p| axes.place(p));
        let corners = [
            [corners[0][0].min(corners[1][0]), corners[0][1].min(corners[1][1])],
            [corners[0][0].max(corners[1][0]), corners[0][1].max(corners[1][1])],
        ];
        canvas.bar(corners, color(0))?;
        let [_, y] = axes.place([0.0, middle]);
        let name = [axes.left - 10.0, y];
        canvas.words(response.name, name, Words::of(LEGEND, Anchor::Right))?;
        let (text, words) = (values(response), Words::of(12.0, Anchor::Left));
        let start = corners[1][0].max(axes.place([0.0, 0.0])[0]) + 8.0;
        // No grid line crosses the numbers.
        let end = start + 0.85 * width(&text, words);
        canvas.bar([[start - 4.0, y - 8.0], [end, y + 8.0]], PAPER)?;
        canvas.words(&text, [start, y], words)?;
    }
    let zero = [axes.place([0.0, 0.0])[0], axes.top];
    canvas.line(&[zero, [zero[0], axes.bottom]], INK, 1.0)
}

/// The text at a bar, such as `+21.8 % (2.63 → 3.20°)`.
fn values(response: &Response) -> String {
    let shown = shown(response.unit);
    let [before, after] = [response.before, response.after].map(|v| v * shown.factor);
    let change = 100.0 * (response.after / response.before - 1.0);
    let decimals = if shown.symbol == "g" { 3 } else { 2 };
    let space = if shown.symbol.starts_with('°') { "" } else { " " };
    let text =
        format!("{change:+.1} % ({before:.decimals$} → {after:.decimals$}{space}{})", shown.symbol);
    text.replace('-', "−")
}
