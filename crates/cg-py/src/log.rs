//! Log files and their column names.

use std::path::{Path, PathBuf};

use cg_logs::estimate::LogEstimator;
use cg_logs::log::{LogError, LogOptions, LogReader, LogRow, Signal};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{in_python, log_error, value_error, vehicle_error};
use crate::options::Options;
use crate::reading::{Reading, log_options};
use crate::results;
use crate::signals::ROWS_BETWEEN_LOOKS;
use crate::vehicle::Vehicle;

/// Estimate from a log file (CSV, CSV in gzip, parquet, candump).
#[pyfunction]
#[pyo3(signature = (vehicle, path, columns, flip, options, /))]
pub(crate) fn estimate_file<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    path: PathBuf,
    columns: Vec<String>,
    flip: Vec<String>,
    options: Options,
) -> PyResult<Bound<'py, PyAny>> {
    let vehicle = vehicle.get();
    let options = options.checked(&vehicle.inner)?;
    let log_options = log_options(&columns, &flip)?;
    let log_options = log_options.of_vehicle(&vehicle.file, vehicle.lift_axle, options.variant);
    let log_options = log_options.map_err(vehicle_error)?;
    let mut estimator = py.detach(|| vehicle.estimator(options)).map_err(vehicle_error)?;
    let mut reader = py.detach(|| LogReader::open(&path, &log_options)).map_err(log_error)?;
    while py.detach(|| push_some(&mut reader, &mut estimator, &path)).map_err(Refused::raise)? {
        py.check_signals()?;
    }
    let mut answer = py.detach(|| estimator.finish());
    answer.messages.extend(reader.remarks());
    results::estimate(py, &answer)
}

/// Read a log file (CSV, CSV in gzip, parquet) into a dict of SI column names to arrays, without
/// absent signals.
#[pyfunction]
#[pyo3(signature = (path, columns, flip, /))]
pub(crate) fn read_file(
    py: Python<'_>,
    path: PathBuf,
    columns: Vec<String>,
    flip: Vec<String>,
) -> PyResult<Bound<'_, PyDict>> {
    let (table, _) = read(py, &path, &log_options(&columns, &flip)?)?;
    table.into_dict(py)
}

/// Read a candump log: a dict of SI column names to arrays, and the remarks about it.
#[pyfunction]
#[pyo3(signature = (path, reading, /))]
pub(crate) fn read_frames(
    py: Python<'_>,
    path: PathBuf,
    reading: Reading,
) -> PyResult<(Bound<'_, PyDict>, Vec<String>)> {
    let (table, remarks) = read(py, &path, &reading.options()?)?;
    Ok((table.into_dict(py)?, remarks.iter().map(|remark| in_python(remark)).collect()))
}

/// Reads all rows of a file, and the remarks about it.
fn read(py: Python<'_>, path: &Path, options: &LogOptions) -> PyResult<(Table, Vec<String>)> {
    let mut reader = py.detach(|| LogReader::open(path, options)).map_err(log_error)?;
    let mut table = Table::of(&[]);
    let mut read_some = || -> Result<bool, LogError> {
        for _ in 0..ROWS_BETWEEN_LOOKS {
            if !reader.advance()? {
                return Ok(false);
            }
            if table.rows == 0 {
                table = Table::of(reader.signals()); // the first row may have said more than the header
            }
            table.push(|signal| reader.value(signal));
        }
        Ok(true)
    };
    while py.detach(&mut read_some).map_err(log_error)? {
        py.check_signals()?;
    }
    Ok((table, reader.remarks()))
}

/// The columns of rows, of one length; empty for absent signals.
struct Table {
    columns: Vec<(Signal, Vec<f64>)>,
    rows: usize,
}

impl Table {
    /// A table of rows with no other signals than these.
    fn of(signals: &[Signal]) -> Self {
        Self { columns: signals.iter().map(|signal| (*signal, Vec::new())).collect(), rows: 0 }
    }

    /// Adds a row by its values.
    fn push(&mut self, value: impl Fn(Signal) -> f64) {
        for (signal, column) in &mut self.columns {
            let value = value(*signal);
            if column.is_empty() {
                if value.is_nan() {
                    continue;
                }
                column.resize(self.rows, f64::NAN);
            }
            column.push(value);
        }
        self.rows += 1;
    }

    /// A dict of SI column names to arrays.
    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let table = PyDict::new(py);
        for (signal, column) in self.columns {
            if !column.is_empty() {
                table.set_item(signal.column(), PyArray1::from_vec(py, column))?;
            }
        }
        Ok(table)
    }
}

/// Converts rows to a dict of SI column names to arrays, without absent signals.
pub(crate) fn table<'py>(py: Python<'py>, rows: &[LogRow]) -> PyResult<Bound<'py, PyDict>> {
    let mut table = Table::of(&Signal::ALL);
    for row in rows {
        table.push(|signal| row.get(signal));
    }
    table.into_dict(py)
}

/// Return the signals of logs: a dict of SI column names to their meanings.
#[pyfunction]
#[pyo3(signature = ())]
pub(crate) fn signals(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let table = PyDict::new(py);
    for signal in Signal::ALL {
        table.set_item(signal.column(), signal.meaning())?;
    }
    Ok(table)
}

/// The reason why a log was not read to its end.
pub(crate) enum Refused {
    Log(LogError),
    Sample(String),
}

impl Refused {
    pub(crate) fn raise(self) -> PyErr {
        match self {
            Self::Log(error) => log_error(error),
            Self::Sample(message) => value_error(message),
        }
    }
}

/// Reads and processes the next rows. Returns `false` at the end of the log.
pub(crate) fn push_some(
    reader: &mut LogReader,
    estimator: &mut LogEstimator,
    path: &Path,
) -> Result<bool, Refused> {
    for _ in 0..ROWS_BETWEEN_LOOKS {
        if !reader.advance().map_err(Refused::Log)? {
            return Ok(false);
        }
        estimator.weighed_by(reader.scale());
        estimator.push(&reader.row()).map_err(|error| {
            Refused::Sample(format!("{}, line {}: {error}", path.display(), reader.line()))
        })?;
    }
    Ok(true)
}

/// Find the columns of a log among the column names of a table.
///
/// `units` has the unit of each column, or nothing if it is not known, and "clock" for points in time.
/// Returns a dict of SI column names to (index of the column, factor to SI with sign).
#[pyfunction]
#[pyo3(signature = (names, units, columns, flip, /))]
pub(crate) fn resolve_columns(
    py: Python<'_>,
    names: Vec<String>,
    units: Vec<String>,
    columns: Vec<String>,
    flip: Vec<String>,
) -> PyResult<Bound<'_, PyDict>> {
    let options = log_options(&columns, &flip)?;
    // The log reader applies the rules for names and units to a log with these column names and
    // two rows. The first row is one in every column, so that it becomes the factor to SI; the
    // second row contains the number of each column.
    let found = probe(&names, &units, &options).map_err(log_error)?;
    let result = PyDict::new(py);
    if let Some((first, second)) = found {
        for signal in Signal::ALL {
            let (factor, value) = (first.get(signal), second.get(signal));
            if !factor.is_nan() {
                // Exact up to rounding. Columns are numbered from two, so that time increases.
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let index = (value / factor).round() as usize - 2;
                result.set_item(signal.column(), (index, factor))?;
            }
        }
    }
    Ok(result)
}

fn probe(
    names: &[String],
    units: &[String],
    options: &LogOptions,
) -> Result<Option<(LogRow, LogRow)>, LogError> {
    let quoted =
        |text: &String| format!("\"{}\"", text.replace('"', "\"\"").replace(['\r', '\n'], " "));
    let is_clock = |column: usize| units.get(column).is_some_and(|unit| unit == "clock");
    let number = |(column, number): (usize, usize)| {
        if is_clock(column) {
            format!("{:02}:{:02}:{:02}", number / 3600, number / 60 % 60, number % 60)
        } else {
            number.to_string()
        }
    };
    let row = |numbers: &mut dyn Iterator<Item = usize>| {
        numbers.enumerate().map(number).collect::<Vec<_>>().join(",")
    };
    let mut lines = vec![names.iter().map(quoted).collect::<Vec<_>>().join(",")];
    let stated = |column: usize| units.get(column).filter(|_| !is_clock(column));
    if (0..names.len()).any(|column| stated(column).is_some_and(|unit| !unit.is_empty())) {
        let unit = |column| stated(column).map(quoted).unwrap_or_default();
        lines.push((0..names.len()).map(unit).collect::<Vec<_>>().join(","));
    }
    lines.push(row(&mut names.iter().map(|_| 1)));
    lines.push(row(&mut (2..names.len() + 2)));
    let stream = Box::new(std::io::Cursor::new((lines.join("\n") + "\n").into_bytes()));
    // A row of units may be an error of the first row only.
    let mut reader = LogReader::from_reader("the table", stream, options)?;
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row()? {
        rows.push(row);
    }
    Ok((rows.len() == 2).then(|| (rows[0], rows[1])))
}
