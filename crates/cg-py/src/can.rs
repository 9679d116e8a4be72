//! CAN frames from Python to rows and estimates, with the decoder and the aligner of `cg run`.

use std::sync::{Mutex, PoisonError};

use cg_logs::can::{CandumpFault, Frame};
use cg_logs::estimate::LogEstimator;
use cg_logs::log::{FrameRows, LogRow};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;

use crate::error::{in_python, value_error, vehicle_error};
use crate::log::table;
use crate::options::Options;
use crate::reading::Reading;
use crate::results;
use crate::vehicle::Vehicle;

/// Converts a time stamp in seconds to microseconds, the unit of frames.
fn microseconds(time_s: f64) -> PyResult<u64> {
    if !time_s.is_finite() {
        return Err(value_error(format!(
            "the time stamp of a frame is {time_s}: it must be finite"
        )));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative, days at most
    Ok((time_s.max(0.0) * 1e6).round() as u64)
}

fn frame(place: (f64, u8), identifier: u32, extended: bool, data: &[u8]) -> PyResult<Frame> {
    let (time_s, bus) = place;
    let mut frame = Frame::new(microseconds(time_s)?, identifier, extended, data)
        .ok_or_else(|| value_error(format!("a frame has {} bytes: the limit is 64", data.len())))?;
    frame.bus = bus;
    Ok(frame)
}

/// Refuse a bus that the log of this name does not have; return the remark on several buses of which all are used.
#[pyfunction]
#[pyo3(signature = (name, only, buses, /))]
pub(crate) fn several_buses(
    name: &str,
    only: Option<String>,
    buses: Vec<String>,
) -> PyResult<Option<String>> {
    CandumpFault::check_bus(only.as_ref(), &buses)
        .map_err(|fault| value_error(in_python(&format!("{name}: {fault}"))))?;
    let all = only.is_none() && buses.len() > 1;
    Ok(all.then(|| in_python(&CandumpFault::several_buses(&buses))))
}

/// Converts frames to the rows of a log, independently of the file format.
#[pyclass(frozen, module = "cgheight._native")]
pub(crate) struct FrameTable {
    state: Mutex<TableState>,
}

struct TableState {
    frames: FrameRows,
    rows: Vec<LogRow>,
    counts: (u64, u64),
}

#[pymethods]
impl FrameTable {
    #[new]
    #[pyo3(signature = (reading, /))]
    fn new(reading: Reading) -> PyResult<Self> {
        let frames = FrameRows::new(&reading.options()?);
        let state = TableState { frames, rows: Vec::new(), counts: (0, 0) };
        Ok(Self { state: Mutex::new(state) })
    }

    /// Add a frame. `place` is its time in seconds and the number of its bus, below 32.
    #[pyo3(signature = (place, identifier, extended, data, /))]
    fn push(
        &self,
        py: Python<'_>,
        place: (f64, u8),
        identifier: u32,
        extended: bool,
        data: &[u8],
    ) -> PyResult<()> {
        let frame = frame(place, identifier, extended, data)?;
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let TableState { frames, rows, counts, .. } = &mut *state;
        counts.0 += 1;
        counts.1 += u64::from(frames.push(&frame));
        rows.extend(std::iter::from_fn(|| frames.next_row()));
        Ok(())
    }

    /// End the log and return a dict of SI column names to arrays, without absent signals.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let TableState { frames, rows, .. } = &mut *state;
        rows.extend(std::iter::from_fn(|| frames.rest()));
        table(py, rows)
    }

    /// Number of frames received, and of frames with a value that is used.
    #[getter]
    fn frames(&self, py: Python<'_>) -> (u64, u64) {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner).counts
    }

    /// Return the remarks about doubtful values and frames so far, as text for the user.
    fn remarks(&self, py: Python<'_>) -> Vec<String> {
        let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.frames.remarks().iter().map(|remark| in_python(remark)).collect()
    }
}

/// Estimator that processes one CAN frame at a time.
#[pyclass(frozen, module = "cgheight._native")]
pub(crate) struct FrameStream {
    state: Mutex<StreamState>,
}

#[derive(Clone)]
struct StreamState {
    frames: FrameRows,
    estimator: LogEstimator,
    turning: bool,
    counts: (u64, u64, u64),
}

impl StreamState {
    /// Processes a row and returns whether it ends a turn.
    fn row(&mut self, row: &LogRow) -> bool {
        // Time never decreases here. A row at the same time as the previous one is ignored.
        self.estimator.weighed_by(self.frames.scale());
        let Ok(status) = self.estimator.push(row) else { return false };
        self.counts.2 += 1;
        let turning = status == cg_core::Status::Turning;
        std::mem::replace(&mut self.turning, turning) && !turning
    }

    fn finish(&mut self) {
        while let Some(row) = self.frames.rest() {
            self.row(&row);
        }
    }
}

#[pymethods]
impl FrameStream {
    #[new]
    #[pyo3(signature = (vehicle, reading, options, /))]
    fn new(
        py: Python<'_>,
        vehicle: &Bound<'_, Vehicle>,
        reading: Reading,
        options: Options,
    ) -> PyResult<Self> {
        let vehicle = vehicle.get();
        let options = options.checked(&vehicle.inner)?;
        let reading =
            reading.options()?.of_vehicle(&vehicle.file, vehicle.lift_axle, options.variant);
        let reading = reading.map_err(vehicle_error)?;
        let state = StreamState {
            frames: FrameRows::new(&reading),
            estimator: py.detach(|| vehicle.estimator(options)).map_err(vehicle_error)?,
            turning: false,
            counts: (0, 0, 0),
        };
        Ok(Self { state: Mutex::new(state) })
    }

    /// Process a frame and return whether a turn has ended. `place` is the time of the frame in
    /// seconds and the number of its bus, below 32.
    #[pyo3(signature = (place, identifier, extended, data, /))]
    fn push(
        &self,
        py: Python<'_>,
        place: (f64, u8),
        identifier: u32,
        extended: bool,
        data: &[u8],
    ) -> PyResult<bool> {
        let frame = frame(place, identifier, extended, data)?;
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.counts.0 += 1;
        let used = state.frames.push(&frame);
        state.counts.1 += u64::from(used);
        let mut ended = false;
        while let Some(row) = state.frames.next_row() {
            ended |= state.row(&row);
        }
        Ok(ended)
    }

    /// End the log, process the rows that still wait for other signals, and return the row count.
    fn finish(&self, py: Python<'_>) -> u64 {
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.finish();
        state.counts.2
    }

    /// Return the remarks about doubtful values and frames so far, as text for the user.
    fn remarks(&self, py: Python<'_>) -> Vec<String> {
        let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.frames.remarks().iter().map(|remark| in_python(remark)).collect()
    }

    /// Return the estimate so far, as if the log ended here; more frames may follow.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut so_far =
            self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner).clone();
        let answer = py.detach(|| {
            so_far.finish();
            let mut answer = so_far.estimator.finish();
            answer.messages.extend(so_far.frames.remarks());
            answer
        });
        results::estimate(py, &answer)
    }

    /// Number of frames received, of frames with a value that is used, and of rows.
    #[getter]
    fn counts(&self, py: Python<'_>) -> (u64, u64, u64) {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner).counts
    }
}
