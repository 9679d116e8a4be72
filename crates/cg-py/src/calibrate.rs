//! `calibrate_files`: calibration from logs and from trips with the empty trailer.

use std::path::{Path, PathBuf};

use cg_core::{AlignSettings, Measured};
use cg_logs::calibrate::{CalibrateOptions, Calibrator, KnownLoad, KnownLog, KnownMass};
use cg_logs::estimate::{ChannelChoice, LogEstimator};
use cg_logs::log::{LogOptions, LogReader};
use cg_logs::state::runs_of;
use cg_output::{Draft, Files, Kind};
use cg_vehicle::VehicleError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{log_error, os_error, output_error, vehicle_error};
use crate::log::{Refused, push_some};
use crate::options::{not_negative, text, word};
use crate::reading::log_options;
use crate::signals::{borrowed, columns};
use crate::vehicle::Vehicle;

/// An exception that `calibrate` passes through.
struct Failure(PyErr);

impl From<VehicleError> for Failure {
    fn from(error: VehicleError) -> Self {
        Self(vehicle_error(error))
    }
}

/// The keywords of `cgheight.calibrate`, and the date.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Request {
    #[pyo3(from_py_with = text)]
    model: String,
    #[pyo3(from_py_with = text)]
    method: String,
    #[pyo3(from_py_with = text)]
    channel: String,
    #[pyo3(from_py_with = text)]
    procedure: String,
    #[pyo3(from_py_with = text)]
    part: String,
    columns: Vec<String>,
    flip: Vec<String>,
    date: String,
    force: bool,
}

/// The rows of a run: a file, or a dict of SI column names to arrays.
#[derive(FromPyObject)]
pub(crate) enum Source {
    Table(Py<PyDict>),
    File(PathBuf),
}

/// A number and its standard deviation, if it has one.
type Given = (f64, Option<f64>);

/// A run: the name of its log, whether it is the empty trailer, the height and the mass if they are
/// known.
type GivenRun = (String, bool, Option<Given>, Option<Given>);

fn known((log, is_empty, height_m, mass): GivenRun) -> PyResult<KnownLog> {
    let trailer_mass = match mass {
        Some((kg, sd_kg)) => Some(KnownMass { kg, sd_kg: not_negative("trailer_mass_kg", sd_kg)? }),
        None => None,
    };
    let load = match height_m {
        _ if is_empty => KnownLoad::Empty,
        Some((value, sd_m)) => {
            let sd = not_negative("height_m", sd_m)?.unwrap_or(0.0);
            KnownLoad::Laden { height_m: Measured { value, sd }, trailer_mass }
        }
        None => KnownLoad::UnknownHeight { trailer_mass },
    };
    Ok(KnownLog { log, load })
}

/// Names and contents of states: files, or texts with a name of their own.
fn contents(states: Vec<(String, Option<String>)>) -> PyResult<Vec<(String, Vec<u8>)>> {
    let content = |(name, text): (String, Option<String>)| {
        let bytes = match text {
            Some(text) => text.into_bytes(),
            None => std::fs::read(&name)
                .map_err(|error| os_error(&error, format!("{name}: cannot be read: {error}")))?,
        };
        Ok((name, bytes))
    };
    states.into_iter().map(content).collect()
}

/// Calibrate with log files and states, and write the calibration file.
#[pyfunction]
#[pyo3(signature = (vehicle, runs, states, output, request, /))]
pub(crate) fn calibrate_files(
    py: Python<'_>,
    vehicle: &Bound<'_, Vehicle>,
    runs: Vec<(GivenRun, Source)>,
    states: Vec<(String, Option<String>)>,
    output: PathBuf,
    request: Request,
) -> PyResult<()> {
    let variant = word("model", &request.model)?;
    let options = log_options(&request.columns, &request.flip)?;
    let options = options.of_vehicle(&vehicle.get().file, vehicle.get().lift_axle, variant);
    let options = options.map_err(vehicle_error)?;
    let how = CalibrateOptions {
        variant,
        method: word("method", &request.method)?,
        channel: word::<ChannelChoice>("channel", &request.channel)?.into(),
        procedure: word("procedure", &request.procedure)?,
        part: word("part", &request.part)?,
        lift_axle: vehicle.get().lift_axle,
        force: request.force,
    };
    let mut files = Files::new(request.force).reads("vehicle", vehicle.get().path());
    for ((log, ..), _) in &runs {
        files = files.reads("runs", Path::new(log));
    }
    for (name, _) in states.iter().filter(|(_, text)| text.is_none()) {
        files = files.reads("from_state", Path::new(name));
    }
    let target = files.writes("output", &output, Kind::Calibration).map_err(output_error)?;
    let vehicle = &vehicle.get().file;
    let (runs, sources): (Vec<GivenRun>, Vec<Source>) = runs.into_iter().unzip();
    let logs = runs.into_iter().map(known).collect::<PyResult<Vec<KnownLog>>>()?;
    let source_of = |known: &KnownLog| {
        let place = logs.iter().position(|log| log.log == known.log);
        place.and_then(|place| sources.get(place))
    };
    let settings = vehicle.align_settings();
    let trips = runs_of(&contents(states)?, vehicle, how.variant).map_err(vehicle_error)?;
    let calibrator = Calibrator::new(vehicle, how, &logs).map_err(vehicle_error)?;
    let calibrated = calibrator.calibrate(&trips, |known, estimator| {
        let fed = match source_of(known) {
            Some(Source::File(path)) => feed_file(py, path, &options, estimator),
            Some(Source::Table(table)) => feed_table(py, table, estimator, settings),
            None => Ok(()),
        };
        fed.map_err(Failure)
    });
    let mut calibration = calibrated.map_err(|Failure(error)| error)?;
    calibration.date = request.date;
    let text = calibration.to_toml().map_err(vehicle_error)?;
    let draft = target.write(&text).map_err(output_error)?;
    draft.map_or(Ok(()), Draft::publish).map_err(|error| output_error(target.failed(error)))
}

fn feed_file(
    py: Python<'_>,
    path: &Path,
    options: &LogOptions,
    estimator: &mut LogEstimator,
) -> PyResult<()> {
    let mut reader = py.detach(|| LogReader::open(path, options)).map_err(log_error)?;
    while py.detach(|| push_some(&mut reader, estimator, path)).map_err(Refused::raise)? {
        py.check_signals()?;
    }
    Ok(())
}

fn feed_table(
    py: Python<'_>,
    table: &Py<PyDict>,
    estimator: &mut LogEstimator,
    settings: AlignSettings<f64>,
) -> PyResult<()> {
    let arrays = borrowed(table.bind(py))?;
    columns(&arrays)?.push_all(py, estimator, settings).map(|_| ())
}
