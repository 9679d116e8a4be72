//! A road from a CSV file with the columns `distance_m`, `curvature_per_m`, `bank_rad` and, if there
//! is a speed limit or a grade, `speed_mps` and `grade_rad`, in any order. Lines that begin with `#` are
//! comments.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::table::{Road, RoadPoint, falling};
use cg_vehicle::error::VehicleError;
use cg_vehicle::files::{TABLE_BYTES, read_text};

/// The columns; the first three are necessary.
const COLUMNS: [&str; 5] = ["distance_m", "curvature_per_m", "bank_rad", "speed_mps", "grade_rad"];

impl Road {
    /// Reads a road from a CSV file.
    ///
    /// # Errors
    /// [`VehicleError`] with file, line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, VehicleError> {
        let file = path.as_ref().display().to_string();
        let text = read_text(path, TABLE_BYTES)
            .map_err(|source| VehicleError::Read { file: file.clone(), source })?;
        Self::parse(&file, &text)
    }

    /// The same from text; `file` is its name in messages.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(file: &str, text: &str) -> Result<Self, VehicleError> {
        let refuse = |message: String| VehicleError::Model(format!("{file}: {message}"));
        let mut reader =
            ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| refuse(error.to_string()))?.clone();
        let places = places(&header).map_err(refuse)?;
        let mut points: Vec<RoadPoint> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| refuse(error.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let at = |column: usize, text: String| {
                let number = places[column].map_or(0, |place| place + 1);
                refuse(format!("line {line}, column {number} `{}`: {text}", COLUMNS[column]))
            };
            let mut values = [0.0, 0.0, 0.0, f64::INFINITY, 0.0];
            for (column, value) in values.iter_mut().enumerate() {
                let Some(cell) = places[column].and_then(|place| record.get(place)) else {
                    continue;
                };
                *value =
                    cell.parse().map_err(|_| at(column, format!("`{cell}` is not a number")))?;
            }
            let [distance_m, curvature_per_m, bank_rad, speed_mps, grade_rad] = values;
            let point = RoadPoint { distance_m, curvature_per_m, bank_rad, grade_rad, speed_mps };
            if let Some((column, text)) = point.fault() {
                return Err(at(column, text));
            }
            if let Some(before) = points.last().filter(|before| before.distance_m >= distance_m) {
                return Err(at(0, falling(distance_m, before.distance_m)));
            }
            points.push(point);
        }
        Self::new(file, points)
    }
}

/// The place of each column in the header.
fn places(header: &StringRecord) -> Result<[Option<usize>; 5], String> {
    let expected = "the columns of a road are distance_m, curvature_per_m, bank_rad and, if there \
                    are limits or grades, speed_mps and grade_rad";
    let mut places = [None; 5];
    for (place, name) in header.iter().enumerate() {
        match COLUMNS.iter().position(|column| *column == name) {
            Some(column) if places[column].is_none() => places[column] = Some(place),
            Some(_) => return Err(format!("line 1: the column `{name}` is there twice")),
            None => return Err(format!("line 1: `{name}` is not a column of a road; {expected}")),
        }
    }
    match places[..3].iter().position(Option::is_none) {
        None => Ok(places),
        Some(absent) => Err(format!("line 1: no column `{}`; {expected}", COLUMNS[absent])),
    }
}
