//! The result of a study: panels of series in SI units, and the statements of the thesis with the
//! results found here.

use crate::verdict::{Criterion, Verdict};

/// SI unit of a quantity. The user of the data may convert it for display.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A ratio.
    One,
    /// 1/s, of poles and zeros.
    PerSecond,
    /// rad.
    Radian,
    /// rad/s.
    RadianPerSecond,
    /// m.
    Meter,
    /// m/s.
    MeterPerSecond,
    /// m/s².
    MeterPerSecondSquared,
    /// s.
    Second,
    /// Months, in studies of years.
    Month,
    /// dB.
    Decibel,
    /// kg.
    Kilogram,
    /// kg m².
    KilogramSquareMeter,
}

/// The quantity on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name for a column, without unit: `peak_trailer_roll`.
    pub name: &'static str,
    /// Label of the axis, without unit.
    pub label: &'static str,
    /// Unit of the values.
    pub unit: Unit,
}

/// A response before and after a change (Figs. 2.5, 2.6).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Response {
    /// Name of the response.
    pub name: &'static str,
    /// Its peak before.
    pub before: f64,
    /// Its peak after.
    pub after: f64,
    /// Unit of both.
    pub unit: Unit,
}

/// The independent axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// A quantity.
    Over(Quantity),
    /// One bar for each response; points count them from 0.
    Responses(Vec<Response>),
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Series {
    /// Name.
    pub name: String,
    /// `(x, y)` in SI units; a rollover has no point.
    pub points: Vec<[f64; 2]>,
    /// The 95 % interval of each point's `y`; empty if the series has none.
    pub intervals: Vec<[f64; 2]>,
    /// The `x` at which the program gives no height.
    pub unanswered: Vec<f64>,
    /// Index that related series share, for example of the same maneuver.
    pub kind: usize,
    /// Whether this is a secondary series of its kind, for example the tractor next to the semitrailer.
    pub aside: bool,
    /// Whether these are values that the thesis prints.
    pub printed: bool,
    /// Whether its points are not joined by a line.
    pub apart: bool,
}

impl Series {
    pub(crate) fn new(name: impl Into<String>, kind: usize, points: Vec<[f64; 2]>) -> Self {
        let (intervals, unanswered) = (Vec::new(), Vec::new());
        Self {
            name: name.into(),
            points,
            intervals,
            unanswered,
            kind,
            aside: false,
            printed: false,
            apart: false,
        }
    }

    /// Values that the thesis prints.
    pub(crate) fn printed(self) -> Self {
        Self { printed: true, ..self.apart() }
    }

    /// A slope that the thesis prints, from the first of these points to below the last.
    pub(crate) fn printed_slope(&self, name: &str, slope: f64) -> Option<Self> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let end = [last[0], first[1] + slope * (last[0] - first[0])];
        Some(Self::new(name, self.kind, vec![*first, end]).printed())
    }

    /// Points without a line.
    pub(crate) fn apart(self) -> Self {
        Self { apart: true, ..self }
    }

    pub(crate) fn aside(mut self) -> Self {
        self.aside = true;
        self
    }

    /// The ordinates.
    pub fn values(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[1]).collect()
    }

    /// Slope from the first to the last point; NaN with fewer than two points.
    pub fn slope(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(a), Some(b)) => (b[1] - a[1]) / (b[0] - a[0]),
            _ => f64::NAN,
        }
    }

    /// The ordinate at `x`, interpolated linearly between the points; NaN outside them.
    pub fn at(&self, x: f64) -> f64 {
        let within = |p: &&[[f64; 2]]| p[0][0] <= x && x <= p[1][0];
        self.points.windows(2).find(within).map_or(f64::NAN, |p| {
            p[0][1] + (x - p[0][0]) / (p[1][0] - p[0][0]) * (p[1][1] - p[0][1])
        })
    }
}

/// One set of axes with its series.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Panel {
    /// Figure of the thesis, for example `2.26`; empty if there is none.
    pub figure: &'static str,
    /// Title.
    pub title: &'static str,
    /// Horizontal axis, or the bars.
    pub x: Abscissa,
    /// Vertical axis, or the length of the bars.
    pub y: Quantity,
    /// The series.
    pub series: Vec<Series>,
}

/// What the figures say about the thesis's own values in them.
pub(crate) fn legend_of_printed(panels: &[Panel]) -> &'static str {
    if panels.iter().flat_map(|panel| &panel.series).any(|series| series.printed) {
        "open markers without a line: what the thesis prints"
    } else {
        "the thesis prints no values of these curves"
    }
}

/// A statement of the thesis and the result found here.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Statement {
    /// Figure or section of the thesis.
    pub place: &'static str,
    /// The statement of the thesis.
    pub thesis: &'static str,
    /// The result found here, with numbers.
    pub ours: String,
    /// The number on which the verdict depends, in `unit`.
    pub measured: f64,
    /// Its unit and meaning.
    pub unit: &'static str,
    /// The range in which it is the thesis's.
    pub criterion: Criterion,
    /// Why it is not, if it is not.
    pub because: &'static str,
}

impl Statement {
    /// Whether the result is that of the thesis.
    pub fn verdict(&self) -> Verdict {
        self.criterion.judge(self.measured)
    }
}

/// One study.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Study {
    /// Its name on the command line.
    pub name: &'static str,
    /// The main result in one sentence.
    pub finding: String,
    /// Vehicle, load, maneuver and rollovers, one line each.
    pub scenario: Vec<String>,
    /// The figures.
    pub panels: Vec<Panel>,
    /// The statements of the thesis with the results found here.
    pub statements: Vec<Statement>,
}

impl Study {
    /// The statements about a figure, such as `2.26`.
    pub fn about<'a>(&'a self, figure: &'a str) -> impl Iterator<Item = &'a Statement> {
        let of = move |s: &&Statement| s.place.strip_prefix("Fig. ") == Some(figure);
        self.statements.iter().filter(of)
    }

    /// A series of a figure.
    pub fn series(&self, figure: &str, name: &str) -> Option<&Series> {
        let panels = self.panels.iter().filter(|panel| panel.figure == figure);
        panels.flat_map(|panel| &panel.series).find(|series| series.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_straight_between_its_points() {
        let series = Series::new("line", 0, vec![[1.0, 2.0], [2.0, 4.0], [4.0, 5.0]]);
        assert!((series.at(1.5) - 3.0).abs() < 1e-15 && (series.at(4.0) - 5.0).abs() < 1e-15);
        assert!(series.at(0.5).is_nan() && series.at(4.5).is_nan());
        assert!((series.slope() - 1.0).abs() < 1e-15);
        assert!(Series::new("none", 0, Vec::new()).slope().is_nan());
    }
}
