//! `prepare`: tables whose rows are no samples yet.

use cg_logs::log::{LogOptions, LogRow, Preparation};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{in_python, value_error};
use crate::log::table;
use crate::signals::{borrowed, columns};

/// What a table needs before its rows are samples: channels of different rasters are aligned, and a roll
/// rate becomes a roll angle. Returns the table and remarks about it, or nothing if its rows are samples.
#[pyfunction]
#[pyo3(signature = (signals, /))]
pub(crate) fn prepare<'py>(
    py: Python<'py>,
    signals: &Bound<'py, PyDict>,
) -> PyResult<Option<(Bound<'py, PyDict>, Vec<String>)>> {
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let beginning: Vec<LogRow> =
        (0..columns.rows().min(Preparation::LOOK)).map(|index| columns.row(index)).collect();
    let options = LogOptions::default();
    let Some(mut preparation) = Preparation::of(&columns.signals(), &beginning, &options) else {
        return Ok(None);
    };
    let prepare = || -> Result<Vec<LogRow>, String> {
        for index in 0..columns.rows() {
            let row = columns.row(index);
            columns.check(index, &row)?;
            preparation.push(index as u64, row);
        }
        preparation.finish();
        Ok(std::iter::from_fn(|| preparation.next_row()).map(|(_, row)| row).collect())
    };
    let rows = py.detach(prepare).map_err(value_error)?;
    let remarks = preparation.remarks().iter().map(|remark| in_python(remark)).collect();
    Ok(Some((table(py, &rows)?, remarks)))
}
