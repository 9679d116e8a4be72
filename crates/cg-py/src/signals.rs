//! Estimates and predictions from arrays.

use cg_core::truck::lags::RollLags;
use cg_core::{AlignSettings, Quantity, Settings};
use cg_logs::estimate::{EstimateOptions, LogEstimator, Prediction};
use cg_logs::learn::Learner;
use cg_logs::log::{LogRow, Plausibility, Position, Signal};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::limits;
use numpy::{PyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{in_python, value_error, vehicle_error};
use crate::options::{Options, up_to};
use crate::results;
use crate::vehicle::Vehicle;

/// Number of rows between two checks for an interrupt by the user.
pub(crate) const ROWS_BETWEEN_LOOKS: usize = 1 << 18;

/// A one-dimensional, contiguous array as a slice, without a copy.
pub(crate) fn slice<'a>(name: &str, array: &'a PyReadonlyArrayDyn<'_, f64>) -> PyResult<&'a [f64]> {
    if array.ndim() != 1 {
        let shape = array.shape();
        return Err(value_error(format!(
            "{name} has shape {shape:?}: it must be one-dimensional, one value for each row"
        )));
    }
    array.as_slice().map_err(|_| {
        value_error(format!("{name} is not contiguous: give np.ascontiguousarray({name})"))
    })
}

/// The column of [`LogRow::roll_gain_sd`], which only prepared tables have.
pub(crate) const ROLL_GAIN_SD: &str = "roll_gain_sd";

/// The columns of a log in memory: an optional slice for each of [`Signal::ALL`].
pub(crate) struct Columns<'a> {
    values: [Option<&'a [f64]>; Signal::COUNT],
    time_s: &'a [f64],
    roll_gain_sd: Option<&'a [f64]>,
}

impl<'a> Columns<'a> {
    fn new(values: &[Option<&'a [f64]>; Signal::COUNT]) -> PyResult<Self> {
        let time_s = values[Signal::Time as usize]
            .filter(|time_s| !time_s.is_empty())
            .ok_or_else(|| value_error("time_s is empty: an estimate needs at least one row"))?;
        for (signal, column) in Signal::ALL.iter().zip(values) {
            let Some(column) = column else { continue };
            if column.len() != time_s.len() {
                return Err(value_error(format!(
                    "{} has {} values and time_s has {}: they must have the same length",
                    signal.column(),
                    column.len(),
                    time_s.len()
                )));
            }
        }
        Ok(Self { values: *values, time_s, roll_gain_sd: None })
    }

    /// The signals that the log has.
    pub(crate) fn signals(&self) -> Vec<Signal> {
        Signal::ALL.into_iter().filter(|&signal| self.values[signal as usize].is_some()).collect()
    }

    /// The position of the lift axles at the end of the log, if it says one.
    fn lift_axle(&self) -> Option<LiftAxle> {
        let said = self.values[Signal::LiftAxle as usize]?;
        said.iter().rev().find_map(|&value| LiftAxle::of_value(value))
    }

    pub(crate) fn rows(&self) -> usize {
        self.time_s.len()
    }

    pub(crate) fn row(&self, index: usize) -> LogRow {
        self.with_gain(index, LogRow::from_values(self.values_of(index)))
    }

    /// The row with what [`prepare`](crate::prepare::prepare) knows of its roll angle.
    fn with_gain(&self, index: usize, row: LogRow) -> LogRow {
        let roll_gain_sd = self.roll_gain_sd.map_or(row.roll_gain_sd, |values| values[index]);
        LogRow { roll_gain_sd, ..row }
    }

    /// A row whose time and values are [in order](Self::check).
    pub(crate) fn checked(&self, index: usize) -> Result<LogRow, String> {
        let row = self.row(index);
        self.check(index, &row).map(|()| row)
    }

    fn values_of(&self, index: usize) -> [f64; Signal::COUNT] {
        self.values.map(|column| column.map_or(f64::NAN, |values| values[index]))
    }

    /// The quantities that the log has.
    pub(crate) fn quantities(&self) -> Vec<Quantity> {
        self.signals().into_iter().filter_map(Signal::quantity).collect()
    }

    /// A row whose time and values are [in order](Self::check), without values that the truck cannot have.
    pub(crate) fn believed(
        &self,
        index: usize,
        quantities: &[Quantity],
        plausibility: &mut Plausibility,
    ) -> Result<LogRow, String> {
        let mut values = self.values_of(index);
        self.check(index, &LogRow::from_values(values))?;
        plausibility.check(quantities, &mut values, || Position::Row(index as u64 + 1));
        Ok(self.with_gain(index, LogRow::from_values(values)))
    }

    /// Passes all rows to an estimator, and returns the remarks about their values.
    pub(crate) fn push_all(
        &self,
        py: Python<'_>,
        estimator: &mut LogEstimator,
        settings: AlignSettings<f64>,
    ) -> PyResult<Vec<String>> {
        let rows = self.rows();
        let mut plausibility = Plausibility::new(settings);
        for start in (0..rows).step_by(ROWS_BETWEEN_LOOKS) {
            let range = start..rows.min(start + ROWS_BETWEEN_LOOKS);
            py.detach(|| self.push_range(estimator, &mut plausibility, range))
                .map_err(value_error)?;
            py.check_signals()?;
        }
        Ok(plausibility.remarks())
    }

    fn push_range(
        &self,
        estimator: &mut LogEstimator,
        plausibility: &mut Plausibility,
        range: std::ops::Range<usize>,
    ) -> Result<(), String> {
        let quantities = self.quantities();
        for index in range {
            let row = self.believed(index, &quantities, plausibility)?;
            estimator
                .push(&row)
                .map_err(|error| format!("time_s[{index}] = {}: {error}", row.time_s))?;
        }
        Ok(())
    }

    /// Checks the time and the values of a row.
    fn check(&self, index: usize, row: &LogRow) -> Result<(), String> {
        if let Some(previous_s) = index.checked_sub(1).map(|before| self.time_s[before])
            && row.time_s <= previous_s
        {
            return Err(format!(
                "time_s[{index}] = {} does not come after time_s[{}] = {previous_s}: sort the \
                 rows by time, or remove the duplicate row",
                row.time_s,
                index - 1
            ));
        }
        check_row(row).map_err(|(name, fault)| format!("{name}[{index}]{fault}"))
    }
}

/// The first value of a row that is not valid: the name of its column, and what is wrong.
pub(crate) fn check_row(row: &LogRow) -> Result<(), (&'static str, String)> {
    if row.time_s.is_nan() {
        return Err((Signal::Time.column(), " is NaN: every row needs a time stamp".into()));
    }
    for signal in Signal::ALL {
        let value = row.get(signal);
        if value.is_infinite() {
            let fault = format!(" = {value} is not finite: use NaN where there is no value");
            return Err((signal.column(), fault));
        }
    }
    let sd_kg = row.trailer_mass_sd_kg;
    if sd_kg < 0.0 {
        let fault = format!(" = {sd_kg} is negative, which no standard deviation is");
        return Err((Signal::TrailerMassSd.column(), fault));
    }
    Ok(())
}

/// The signal that a keyword names.
pub(crate) fn signal(keyword: &str) -> PyResult<Signal> {
    Signal::of_column(keyword).ok_or_else(|| {
        let known = Signal::ALL.map(Signal::column).join(", ");
        PyTypeError::new_err(format!("{keyword} is not a signal; the signals are {known}"))
    })
}

pub(crate) type Borrowed<'py> = [Option<PyReadonlyArrayDyn<'py, f64>>; Signal::COUNT + 1];

/// The arrays of a dict whose keys are SI column names.
pub(crate) fn borrowed<'py>(signals: &Bound<'py, PyDict>) -> PyResult<Borrowed<'py>> {
    let mut arrays = [const { None }; Signal::COUNT + 1];
    for (name, value) in signals {
        let array = value.extract::<PyReadonlyArrayDyn<'py, f64>>()?;
        let place = match name.extract()? {
            ROLL_GAIN_SD => Signal::COUNT,
            name => signal(name)? as usize,
        };
        arrays[place] = Some(array);
    }
    Ok(arrays)
}

/// Checks the arrays, which must have what an estimate needs, and returns them as slices.
pub(crate) fn columns<'a>(arrays: &'a Borrowed<'_>) -> PyResult<Columns<'a>> {
    let columns = any_columns(arrays)?;
    match Signal::lacking(&columns.signals()) {
        [] => Ok(columns),
        [first, ..] if *first == Signal::Roll => {
            Err(value_error("roll_rad is missing: give roll_rad or tilt_rad"))
        }
        [first, ..] if *first == Signal::Steer => Err(value_error(
            "steer_rad is missing: give steer_rad, steering_wheel_rad, \
             lateral_acceleration_mps2 or yaw_rate_radps",
        )),
        [first, ..] => Err(value_error(format!("{} is missing", first.column()))),
    }
}

/// Checks the arrays, of which any may be absent but the time, and returns them as slices.
pub(crate) fn any_columns<'a>(arrays: &'a Borrowed<'_>) -> PyResult<Columns<'a>> {
    let mut values = [None; Signal::COUNT];
    for ((value, array), signal) in values.iter_mut().zip(arrays).zip(Signal::ALL) {
        *value = array.as_ref().map(|array| slice(signal.column(), array)).transpose()?;
    }
    let roll_gain_sd = arrays[Signal::COUNT].as_ref();
    let roll_gain_sd = roll_gain_sd.map(|array| slice(ROLL_GAIN_SD, array)).transpose()?;
    Ok(Columns { roll_gain_sd, ..Columns::new(&values)? })
}

/// Estimate from a dict of SI column names to 1-D contiguous float64 arrays.
#[pyfunction]
#[pyo3(signature = (vehicle, signals, options, /))]
pub(crate) fn estimate_arrays<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    signals: &Bound<'py, PyDict>,
    options: Options,
) -> PyResult<Bound<'py, PyAny>> {
    let vehicle = vehicle.get();
    let options = options.checked(&vehicle.inner)?;
    let (estimator, remarks) = driven(py, vehicle, signals, options)?;
    let mut answer = py.detach(|| estimator.finish());
    answer.messages.extend(remarks);
    results::estimate(py, &answer)
}

/// Return what a truck learns from a log of it: JSON text, and a message for each trip.
#[pyfunction]
#[pyo3(signature = (vehicle, signals, /))]
pub(crate) fn learn_arrays(
    py: Python<'_>,
    vehicle: &Bound<'_, Vehicle>,
    signals: &Bound<'_, PyDict>,
) -> PyResult<(String, Vec<String>)> {
    let options = EstimateOptions::default();
    let vehicle = vehicle.get();
    let (log, _) = driven(py, vehicle, signals, options)?;
    let design = *log.design();
    let doubt = log.lift_doubt().map(in_python);
    let mut learner = Learner::new(&vehicle.file, options.variant, vehicle.learned(None)?);
    let taken = py.detach(|| learner.log(log)).map_err(vehicle_error)?;
    let text = learner.learned(&design).text_of(&vehicle.file).map_err(vehicle_error)?;
    Ok((text, taken.iter().map(ToString::to_string).chain(doubt).collect()))
}

/// The estimator at the end of a log, and the remarks about its values.
fn driven(
    py: Python<'_>,
    vehicle: &Vehicle,
    signals: &Bound<'_, PyDict>,
    options: EstimateOptions,
) -> PyResult<(LogEstimator, Vec<String>)> {
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let mut estimator = py.detach(|| vehicle.estimator(options)).map_err(vehicle_error)?;
    let settings = vehicle.inner.align_settings();
    let remarks = columns.push_all(py, &mut estimator, settings)?;
    Ok((estimator, remarks))
}

/// Predict the roll angle for a height with the model: an array, one value for each row.
#[pyfunction]
#[pyo3(signature = (vehicle, signals, channel, height_m, options, /))]
pub(crate) fn predict_roll<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    signals: &Bound<'py, PyDict>,
    channel: &str,
    height_m: f64,
    options: Options,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let options = options.checked(&vehicle.get().inner)?;
    up_to("height_m", Some(height_m), limits::GREATEST_HEIGHT_M)?;
    let channel = crate::options::channel(channel)?
        .ok_or_else(|| value_error("channel is \"auto\": a prediction needs one channel"))?;
    let arrays = borrowed(signals)?;
    let columns = columns(&arrays)?;
    let position = columns.lift_axle();
    let vehicle = vehicle.get();
    let truck = py.detach(|| vehicle.at(position, options.variant)).map_err(vehicle_error)?;
    let (settings, design) = (truck.0.align_settings(), truck.1);
    let mut prediction = Prediction::new(design, settings, options, channel, height_m);
    let predict = || -> Result<Vec<f64>, String> {
        (0..columns.time_s.len())
            .map(|index| {
                let row = columns.checked(index)?;
                prediction.push(&row).map_err(|error| format!("time_s[{index}]: {error}"))
            })
            .collect()
    };
    let roll_rad = py.detach(predict).map_err(value_error)?;
    Ok(PyArray1::from_vec(py, roll_rad))
}

/// The roll angle after the lags of a channel whose input is an acceleration, as the estimator uses it.
/// They start again after a gap; an absent angle stays absent.
#[pyfunction]
#[pyo3(signature = (time_s, roll_rad, /))]
#[allow(clippy::needless_pass_by_value)] // as arguments of Python arrive
pub(crate) fn after_lags<'py>(
    py: Python<'py>,
    time_s: PyReadonlyArrayDyn<'py, f64>,
    roll_rad: PyReadonlyArrayDyn<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (times_s, angles_rad) = (slice("time_s", &time_s)?, slice("roll_rad", &roll_rad)?);
    #[allow(clippy::cast_precision_loss)] // half a second
    let gap_s = Settings::<f64>::truck().gap_us as f64 * 1e-6;
    let mut running: Option<(f64, RollLags<f64>)> = None;
    let late: Vec<f64> = std::iter::zip(times_s, angles_rad)
        .map(|(&time_s, &roll_rad)| {
            if roll_rad.is_nan() {
                return roll_rad;
            }
            let known = running.filter(|(last_s, _)| time_s - last_s <= gap_s);
            let (last_s, mut lags) = known.unwrap_or((time_s, RollLags::at_rest(roll_rad)));
            let late_rad = lags.push(roll_rad, time_s - last_s);
            running = Some((time_s, lags));
            late_rad
        })
        .collect();
    Ok(PyArray1::from_vec(py, late))
}
