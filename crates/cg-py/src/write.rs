//! `write_file`: arrays to a log file.

use std::path::{Path, PathBuf};

use cg_vehicle::log::{CandumpWriter, LogError, LogWriter, Signal};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{log_error, value_error};
use crate::signals::{Columns, borrowed, columns};

/// Write arrays to a log: .csv, .csv.gz, or .log (J1939 frames; the steering ratio makes
/// steering-wheel angles of road-wheel angles). Returns how many values no J1939 signal can hold.
#[pyfunction]
#[pyo3(signature = (path, signals, comments, steering_ratio, /))]
pub(crate) fn write_file(
    py: Python<'_>,
    path: PathBuf,
    signals: &Bound<'_, PyDict>,
    comments: Vec<String>,
    steering_ratio: Option<f64>,
) -> PyResult<u64> {
    let name = path.to_string_lossy();
    let is_candump = path.extension().is_some_and(|extension| extension == "log");
    if !(is_candump || name.ends_with(".csv") || name.ends_with(".csv.gz")) {
        return Err(value_error(format!(
            "{name}: a log ends in .csv, .csv.gz or .log (CAN frames); give it such a name"
        )));
    }
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let there: Vec<Signal> = Signal::ALL
        .into_iter()
        .zip(&arrays)
        .filter_map(|(signal, array)| array.is_some().then_some(signal))
        .collect();
    py.detach(|| {
        if is_candump {
            write_candump(&path, &columns, steering_ratio.unwrap_or(f64::NAN))
        } else {
            write_csv(&path, &columns, &comments, &there)
        }
    })
    .map_err(log_error)
}

fn write_csv(
    path: &Path,
    columns: &Columns<'_>,
    comments: &[String],
    there: &[Signal],
) -> Result<u64, LogError> {
    let mut writer = LogWriter::create(path, comments, there)?;
    (0..columns.rows()).try_for_each(|index| writer.write_row(&columns.row(index)))?;
    writer.finish()?;
    Ok(0)
}

fn write_candump(path: &Path, columns: &Columns<'_>, steering_ratio: f64) -> Result<u64, LogError> {
    let mut writer = CandumpWriter::create(path, steering_ratio)?;
    (0..columns.rows()).try_for_each(|index| writer.write_row(&columns.row(index)))?;
    let lost = writer.out_of_range();
    writer.finish()?;
    Ok(lost)
}
