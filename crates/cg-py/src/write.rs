//! `write_file` and `copy_file` write a log file; `may_write` checks whether it may be written.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use cg_logs::log::{CandumpWriter, LogError, LogWriter, Signal};
use cg_output::kind::LOG_COMMENT;
use cg_output::{Draft, Files, Kind, Target};
use cg_plant::road::RoadKind;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{log_error, output_error, value_error};
use crate::signals::{Columns, borrowed, columns};
use crate::vehicle::Vehicle;

/// The file that a log is written to: its path, the keyword that gave it, and the other files of
/// the call.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Request<'py> {
    keyword: String,
    path: PathBuf,
    /// The log that is read, if it is a file.
    log: Option<PathBuf>,
    /// The road of a simulated log: a kind or a file.
    road: Option<PathBuf>,
    vehicle: Option<Bound<'py, Vehicle>>,
    force: bool,
}

impl Request<'_> {
    /// Checks that the file may be written, and returns it.
    fn target(&self) -> PyResult<Target> {
        let name = self.path.to_string_lossy();
        let ends = |ends: &[&str]| ends.iter().any(|end| name.to_lowercase().ends_with(end));
        let kind = if ends(&[".csv", ".csv.gz"]) {
            Kind::Log
        } else if ends(&[".asc", ".blf", ".log", ".mf4", ".trc"]) {
            Kind::Frames
        } else {
            return Err(value_error(format!(
                "{name}: the name of a log ends in .csv or .csv.gz (tables), or in .log, .asc, \
                 .blf, .mf4 or .trc (CAN frames); change it"
            )));
        };
        let vehicle = self.vehicle.as_ref().map(|vehicle| vehicle.get().path());
        let road = self.road.as_deref().filter(|name| RoadKind::of_name(name).is_none());
        Files::new(self.force)
            .reads_some("log", self.log.as_deref())
            .reads_some("road", road)
            .reads_some("vehicle", vehicle)
            .writes(&self.keyword, &self.path, kind)
            .map_err(output_error)
    }
}

/// Raise an error if the log may not be written; called before the work begins.
#[pyfunction]
#[pyo3(signature = (request, /))]
pub(crate) fn may_write(request: Request<'_>) -> PyResult<()> {
    request.target().map(|_| ())
}

/// Copy a file to the path of the request, where it appears only when it is complete.
#[pyfunction]
#[pyo3(signature = (source, request, /))]
pub(crate) fn copy_file(py: Python<'_>, source: PathBuf, request: Request<'_>) -> PyResult<()> {
    let target = request.target()?;
    let copy = || -> io::Result<()> {
        let (draft, mut file) = target.open()?;
        io::copy(&mut File::open(&source)?, &mut file)?;
        draft.map_or(Ok(()), Draft::publish)
    };
    py.detach(copy).map_err(|error| output_error(target.failed(error)))
}

/// Write arrays to a log: .csv, .csv.gz, or .log (J1939 frames; the vehicle's steering ratio
/// converts road-wheel angles to steering-wheel angles). Returns the number of values that are
/// outside the range of their J1939 signal, and the columns that have none.
#[pyfunction]
#[pyo3(signature = (request, signals, comments, /))]
pub(crate) fn write_file(
    py: Python<'_>,
    request: Request<'_>,
    signals: &Bound<'_, PyDict>,
    mut comments: Vec<String>,
) -> PyResult<(u64, Vec<&'static str>)> {
    let target = request.target()?;
    let ratio = request.vehicle.as_ref().and_then(|vehicle| vehicle.get().inner.steering_ratio);
    if comments.is_empty() {
        // This comment marks the file as written by this project.
        comments.push(LOG_COMMENT.to_owned());
    }
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let there: Vec<Signal> = Signal::ALL
        .into_iter()
        .zip(&arrays)
        .filter_map(|(signal, array)| array.is_some().then_some(signal))
        .collect();
    py.detach(|| {
        if is_candump(target.path()) {
            write_candump(&target, &columns, ratio.unwrap_or(f64::NAN), &there)
        } else {
            write_csv(&target, &columns, &comments, &there)
        }
    })
    .map_err(log_error)
}

fn is_candump(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("log"))
}

fn write_csv(
    target: &Target,
    columns: &Columns<'_>,
    comments: &[String],
    there: &[Signal],
) -> Result<(u64, Vec<&'static str>), LogError> {
    let mut writer = LogWriter::create(target, comments, there)?;
    (0..columns.rows()).try_for_each(|index| writer.write_row(&columns.row(index)))?;
    writer.finish()?;
    Ok((0, Vec::new()))
}

fn write_candump(
    target: &Target,
    columns: &Columns<'_>,
    steering_ratio: f64,
    there: &[Signal],
) -> Result<(u64, Vec<&'static str>), LogError> {
    let mut writer = CandumpWriter::create(target, steering_ratio)?;
    (0..columns.rows()).try_for_each(|index| writer.write_row(&columns.row(index)))?;
    let lost = writer.out_of_range();
    // A lateral acceleration is that of the yaw rate.
    let is_served = |signal: &Signal| {
        *signal == Signal::LateralAcceleration && there.contains(&Signal::YawRate)
    };
    let unsent = there.iter().filter(|signal| !writer.writes(**signal) && !is_served(signal));
    let unsent = unsent.map(|signal| signal.column()).collect();
    writer.finish()?;
    Ok((lost, unsent))
}
