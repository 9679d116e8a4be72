//! What a study returns: panels of series in SI units, and the thesis's statements beside ours.

/// Unit of a quantity. Values are in SI; what is shown is the reader's choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A ratio.
    One,
    /// rad.
    Radian,
    /// rad/s.
    RadianPerSecond,
    /// m.
    Metre,
    /// m/s.
    MetrePerSecond,
    /// m/s².
    MetrePerSecondSquared,
    /// s.
    Second,
    /// dB.
    Decibel,
    /// kg.
    Kilogram,
    /// kg m².
    KilogramSquareMetre,
}

/// What stands on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// In a column's name, without unit: `peak_trailer_roll`.
    pub name: &'static str,
    /// Beside the axis, without unit.
    pub label: &'static str,
    /// Unit of the values.
    pub unit: Unit,
}

/// A response before and after a change (Figs. 2.5, 2.6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// What responds.
    pub name: &'static str,
    /// Its peak before.
    pub before: f64,
    /// Its peak after.
    pub after: f64,
    /// Unit of both.
    pub unit: Unit,
}

/// The independent side of a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// A quantity.
    Over(Quantity),
    /// One bar for each response; points count them from 0.
    Responses(Vec<Response>),
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it is called.
    pub name: String,
    /// `(x, y)`, SI; what rolled over has no point.
    pub points: Vec<[f64; 2]>,
    /// Series of one kind share it: the same maneuver, say.
    pub kind: usize,
    /// Beside the main one of its kind: the tractor beside the semitrailer, say.
    pub aside: bool,
}

impl Series {
    pub(super) fn new(name: impl Into<String>, kind: usize, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points, kind, aside: false }
    }

    pub(super) fn aside(mut self) -> Self {
        self.aside = true;
        self
    }

    /// The ordinates.
    pub fn values(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[1]).collect()
    }

    /// Rise over run from the first to the last point; not a number with fewer than two.
    pub fn slope(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(a), Some(b)) => (b[1] - a[1]) / (b[0] - a[0]),
            _ => f64::NAN,
        }
    }

    /// The ordinate at `x`, on straight lines between the points; not a number outside them.
    pub fn at(&self, x: f64) -> f64 {
        let within = |p: &&[[f64; 2]]| p[0][0] <= x && x <= p[1][0];
        self.points.windows(2).find(within).map_or(f64::NAN, |p| {
            p[0][1] + (x - p[0][0]) / (p[1][0] - p[0][0]) * (p[1][1] - p[0][1])
        })
    }
}

/// One set of axes with its series.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The thesis's figure: `2.26`; empty where it has none.
    pub figure: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// To the right, or the bars.
    pub x: Abscissa,
    /// Upwards, or along the bars.
    pub y: Quantity,
    /// The series.
    pub series: Vec<Series>,
}

/// A sentence of the thesis and what is found here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// Figure or section of the thesis.
    pub place: &'static str,
    /// What the thesis says.
    pub thesis: &'static str,
    /// What is found here, with its numbers.
    pub ours: String,
    /// Whether the one is the other.
    pub agrees: bool,
}

/// One study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Its name on the command line.
    pub name: &'static str,
    /// One sentence: what is seen.
    pub finding: String,
    /// Vehicle, load, maneuver, one line each; also what rolled over.
    pub scenario: Vec<String>,
    /// The figures.
    pub panels: Vec<Panel>,
    /// The thesis's statements beside ours.
    pub statements: Vec<Statement>,
}

impl Study {
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
