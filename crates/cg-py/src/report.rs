//! The report of many logs, as `cg estimate --report` writes it.

use std::path::PathBuf;

use cg_logs::report::{Entry, Trace, page, room};
use cg_output::{Draft, Files, Kind, Target};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{output_error, value_error, vehicle_error};
use crate::options::Options;
use crate::signals::{borrowed, columns};
use crate::vehicle::Vehicle;

/// The page that is written: its path, and the files that the call reads.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Request<'py> {
    path: PathBuf,
    logs: Vec<PathBuf>,
    calibration: Option<PathBuf>,
    vehicle: Bound<'py, Vehicle>,
    force: bool,
}

impl Request<'_> {
    /// Checks that the page may be written, and returns its file.
    fn target(&self) -> PyResult<Target> {
        let mut files = Files::new(self.force)
            .reads_some("vehicle", Some(self.vehicle.get().path()))
            .reads_some("calibration", self.calibration.as_deref());
        for log in &self.logs {
            files = files.reads("logs", log);
        }
        files.writes("path", &self.path, Kind::Report).map_err(output_error)
    }
}

/// Raise an error if the report may not be written; called before the work begins.
#[pyfunction]
#[pyo3(signature = (request, /))]
pub(crate) fn may_write_report(request: Request<'_>) -> PyResult<()> {
    request.target().map(|_| ())
}

/// Return the signals of a log as JSON text, with as many points as a report of that many logs has
/// for each.
#[pyfunction]
#[pyo3(signature = (vehicle, signals, options, logs, /))]
pub(crate) fn trace_arrays(
    py: Python<'_>,
    vehicle: &Bound<'_, Vehicle>,
    signals: &Bound<'_, PyDict>,
    options: Options,
    logs: usize,
) -> PyResult<String> {
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let vehicle = vehicle.get();
    let options = options.checked(&vehicle.inner)?;
    let mut estimator = py.detach(|| vehicle.estimator(options)).map_err(vehicle_error)?;
    let text = py.detach(|| {
        let mut trace = Trace::new(room(logs));
        for index in 0..columns.rows() {
            let row = columns.row(index);
            trace.push(row.time_s, &estimator.signals(&row));
        }
        trace.to_json()
    });
    text.map_err(|error| value_error(error.to_string()))
}

/// Write the report: for each log its name, its result as JSON text or nothing if it could not be
/// read, its height if it is known, and its signals as JSON text or the reason.
#[pyfunction]
#[pyo3(signature = (request, vehicle, calibration, logs, /))]
pub(crate) fn write_report(
    py: Python<'_>,
    request: Request<'_>,
    vehicle: &str,
    calibration: Option<&str>,
    logs: Vec<(String, Option<String>, Option<f64>, String)>,
) -> PyResult<()> {
    let target = request.target()?;
    let entry = |(log, estimate, known_m, text): &(String, Option<String>, Option<f64>, String)| {
        estimate.as_ref().map_or_else(
            || Ok(Entry::unreadable(log, text)),
            |estimate| Entry::from_json(log, estimate, *known_m, Some(text)),
        )
    };
    let text = py.detach(|| {
        let entries: Vec<_> = logs.iter().map(entry).collect::<Result<_, _>>()?;
        page(vehicle, calibration, &entries)
    });
    let text = text.map_err(|error| value_error(error.to_string()))?;
    let draft = py.detach(|| target.write(&text)).map_err(output_error)?;
    let publish = || draft.map_or(Ok(()), Draft::publish);
    py.detach(publish).map_err(|error| output_error(target.failed(error)))
}
