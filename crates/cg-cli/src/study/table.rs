//! The table of a study: one row for each point, with figure, series and the two quantities of the
//! point, with the ends of its interval if it has one. The columns of other panels are empty.

use anyhow::Context;
use cg_output::kind::STUDY_COMMENT;
use cg_thesis::study::{Abscissa, Panel, Quantity, Series, Study};

use crate::units::{column, display_unit};

/// Columns of panels with bars for responses.
const RESPONSE: [&str; 4] = ["response", "before", "after", "unit"];

/// The CSV file: the scenario as comments, then the points.
pub(super) fn csv(study: &Study) -> anyhow::Result<String> {
    let columns = columns(study);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&columns)?;
    for panel in &study.panels {
        for series in &panel.series {
            for row in rows(series) {
                let cells = cells(panel, row);
                let cell = |column: &String| {
                    let own = [("figure", panel.figure), ("series", series.name.as_str())];
                    let own = own.iter().find(|(name, _)| name == column);
                    own.map(|(_, text)| (*text).to_owned()).or_else(|| {
                        let found = cells.iter().find(|(name, _)| name == column);
                        found.map(|(_, text)| text.clone())
                    })
                };
                let row = columns.iter().map(|column| cell(column).unwrap_or_default());
                writer.write_record(row)?;
            }
        }
    }
    let rows = String::from_utf8(writer.into_inner().context("the table is not complete")?)?;
    let made = format!("{STUDY_COMMENT} {}", study.name);
    let lines = [&made, &study.finding].into_iter().chain(&study.scenario);
    // A line break in a vehicle's name would end the comment.
    let lines = lines.map(|line| line.replace(char::is_control, " "));
    let comments: String =
        lines.flat_map(|line| ["# ".to_owned(), line, "\n".to_owned()]).collect();
    Ok(comments + &rows)
}

/// A point of a series with its interval; a point without a height has neither.
type Row = (f64, Option<f64>, Option<[f64; 2]>);

fn rows(series: &Series) -> impl Iterator<Item = Row> {
    let intervals = series.intervals.iter().copied().map(Some).chain(std::iter::repeat(None));
    let given = series.points.iter().zip(intervals).map(|([x, y], ends)| (*x, Some(*y), ends));
    given.chain(series.unanswered.iter().map(|x| (*x, None, None)))
}

/// The columns of an interval of a quantity.
fn ends(quantity: Quantity) -> [String; 2] {
    ["low", "high"]
        .map(|end| format!("{}_{end}_{}", quantity.name, display_unit(quantity.unit).suffix))
}

/// The columns of all quantities, each once.
fn columns(study: &Study) -> Vec<String> {
    let mut columns = vec!["figure".to_owned(), "series".to_owned()];
    for panel in &study.panels {
        let x = match &panel.x {
            Abscissa::Over(quantity) => vec![column(*quantity)],
            Abscissa::Responses(_) => RESPONSE.map(str::to_owned).to_vec(),
        };
        let has_intervals = panel.series.iter().any(|series| !series.intervals.is_empty());
        let ends = has_intervals.then(|| ends(panel.y)).into_iter().flatten();
        for name in x.into_iter().chain([column(panel.y)]).chain(ends) {
            if !columns.contains(&name) {
                columns.push(name);
            }
        }
    }
    columns
}

/// The cells of a point with their columns.
fn cells(panel: &Panel, (x, y, interval): Row) -> Vec<(String, String)> {
    let number = |value: f64| format!("{value:.6}");
    let mut cells = match &panel.x {
        Abscissa::Over(quantity) => {
            vec![(column(*quantity), number(x * display_unit(quantity.unit).factor))]
        }
        Abscissa::Responses(responses) => {
            // The x value of a point is the index of a response.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let response = responses.get(x as usize);
            let texts = response.map(|response| {
                let unit = display_unit(response.unit);
                let [before, after] =
                    [response.before, response.after].map(|value| number(value * unit.factor));
                [response.name.to_owned(), before, after, unit.suffix.to_owned()]
            });
            let names = RESPONSE.map(str::to_owned);
            texts.map_or_else(Vec::new, |texts| names.into_iter().zip(texts).collect())
        }
    };
    let shown_y = |value: f64| number(value * display_unit(panel.y.unit).factor);
    cells.extend(y.map(|y| (column(panel.y), shown_y(y))));
    cells.extend(
        interval
            .into_iter()
            .flat_map(|interval| ends(panel.y).into_iter().zip(interval.map(shown_y))),
    );
    cells
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use cg_thesis::study::study;

    /// A study with two series: two measurements and a place without one, and a curve.
    pub(crate) fn measured() -> Study {
        let mut study = study("height", None).unwrap();
        study.panels.truncate(1);
        let [measured, curve] = study.panels[0].series.first_chunk_mut().unwrap();
        measured.name = "1, measured".to_owned();
        measured.points = vec![[1.8, 0.04], [1.9, 0.05]];
        measured.intervals = vec![[0.03, 0.06], [-0.04, 0.07]];
        measured.unanswered = vec![2.0];
        curve.name = "curve".to_owned();
        curve.points = vec![[1.8, 0.045]];
        study.panels[0].series.truncate(2);
        study
    }

    /// Each point has its interval, in the unit of the point; where there is no height, its place stands alone.
    #[test]
    fn a_table_has_intervals_and_places_without_a_height() {
        let table = csv(&measured()).unwrap();
        let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with("# ")).collect();
        // Degrees of 0.04, 0.03, 0.06, 0.05, −0.04, 0.07 and 0.045 rad.
        let wanted = [
            "figure,series,cg_height_m,peak_roll_deg,peak_roll_low_deg,peak_roll_high_deg",
            "2.26,\"1, measured\",1.800000,2.291831,1.718873,3.437747",
            "2.26,\"1, measured\",1.900000,2.864789,-2.291831,4.010705",
            "2.26,\"1, measured\",2.000000,,,",
            "2.26,curve,1.800000,2.578310,,",
        ];
        assert_eq!(rows, wanted);
    }
}
