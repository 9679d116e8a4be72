//! `reproduce_tables`: the tables of the thesis, recomputed.

use cg_thesis::reproduce::{Options, Row, table, tables};
use cg_vehicle::VehicleError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::vehicle_error;

/// Recompute one table of the thesis, or all: a dict of columns.
#[pyfunction]
#[pyo3(signature = (name, runs, seed, /))]
pub(crate) fn reproduce_tables(
    py: Python<'_>,
    name: Option<String>,
    runs: u32,
    seed: u64,
) -> PyResult<Bound<'_, PyDict>> {
    let options = Options { runs, seed };
    let names: Vec<&str> = name.as_deref().map_or_else(|| tables().to_vec(), |name| vec![name]);
    let mut rows: Vec<Row> = Vec::new();
    for name in names {
        let compute = || -> Result<Vec<Row>, VehicleError> { table(name, &options) };
        rows.extend(py.detach(compute).map_err(vehicle_error)?);
        py.check_signals()?;
    }
    let columns = PyDict::new(py);
    let nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    columns.set_item("table", rows.iter().map(|row| row.table).collect::<Vec<_>>())?;
    columns.set_item("item", rows.iter().map(|row| row.item.as_str()).collect::<Vec<_>>())?;
    columns.set_item("thesis", rows.iter().map(|row| nan(row.thesis)).collect::<Vec<_>>())?;
    columns.set_item("ours", rows.iter().map(|row| nan(row.ours)).collect::<Vec<_>>())?;
    let errors: Vec<f64> = rows.iter().map(|row| nan(row.relative_error)).collect();
    columns.set_item("relative_error", errors)?;
    columns.set_item("criterion", rows.iter().map(|row| nan(row.criterion)).collect::<Vec<_>>())?;
    let reasons: Vec<&str> = rows.iter().map(|row| row.criterion_reason.unwrap_or("")).collect();
    columns.set_item("criterion_reason", reasons)?;
    let verdicts: Vec<String> = rows.iter().map(|row| row.verdict.to_string()).collect();
    columns.set_item("verdict", verdicts)?;
    columns.set_item("same_digits", rows.iter().map(Row::agrees).collect::<Vec<_>>())?;
    let notes: Vec<&str> = rows.iter().map(|row| row.note.as_deref().unwrap_or("")).collect();
    columns.set_item("note", notes)?;
    Ok(columns)
}
