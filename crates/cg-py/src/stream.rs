//! `Stream`: the estimator, row by row.

use std::sync::{Mutex, PoisonError};

use cg_core::{Quantity, Status};
use cg_logs::estimate::LogEstimator;
use cg_logs::learn::Learner;
use cg_logs::log::{LogRow, Plausibility, Position, Signal};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict};
use serde::{Deserialize, Serialize};

use crate::error::{value_error, vehicle_error};
use crate::options::Options;
use crate::results;
use crate::signals::{check_row, signal};
use crate::vehicle::Vehicle;

/// A roll angle from a rate is known only at the end of a turn.
const RATE_UNUSED: &str = "roll_rate is not used: the roll angle of a row depends on the rows after it; \
                           cgheight.estimate_log uses it";

/// Estimator that processes one row at a time; `cgheight.Estimator` sets its options.
#[pyclass(frozen, subclass, module = "cgheight._native")]
pub(crate) struct Stream {
    state: Mutex<State>,
    source: Source,
}

/// What it was made of.
struct Source {
    vehicle: Py<Vehicle>,
    options: Py<PyDict>,
    learned: Option<String>,
}

struct State {
    now: Now,
    /// What goes on from what the truck had learned.
    learner: Learner,
}

/// What changes with every row, and is pickled.
#[derive(Clone, Serialize, Deserialize)]
struct Now {
    estimator: LogEstimator,
    plausibility: Plausibility,
    rows: u64,
    previous_s: f64,
    has_roll_rate: bool,
}

impl State {
    fn push(&mut self, mut values: [f64; Signal::COUNT]) -> Result<&'static str, String> {
        let row = LogRow::from_values(values);
        check_row(&row).map_err(|(name, fault)| format!("{name}{fault}"))?;
        if row.time_s <= self.now.previous_s {
            return Err(format!(
                "time_s = {} does not come after {}, the time of the previous row",
                row.time_s, self.now.previous_s
            ));
        }
        let time_s = row.time_s;
        let now = &mut self.now;
        now.has_roll_rate |= row.roll_rate_radps.is_finite();
        values[Signal::RollRate as usize] = f64::NAN; // not used
        now.rows += 1;
        let position = Position::Row(now.rows);
        now.plausibility.check(&Quantity::ALL, &mut values, || position);
        let pushed = now.estimator.push(&LogRow::from_values(values));
        let status = pushed.map_err(|error| format!("time_s = {time_s}: {error}"))?;
        now.previous_s = time_s;
        Ok(match status {
            Status::Absent => "absent",
            Status::Straight => "straight",
            Status::Turning => "turning",
        })
    }
}

/// The arguments of `Stream`.
type Parts<'py> = (Py<Vehicle>, Bound<'py, PyDict>, Option<String>, Bound<'py, PyBytes>);

#[pymethods]
impl Stream {
    #[new]
    #[pyo3(signature = (vehicle, options, learned = None, state = None, /))]
    fn new(
        py: Python<'_>,
        vehicle: &Bound<'_, Vehicle>,
        options: &Bound<'_, PyDict>,
        learned: Option<&str>,
        state: Option<&[u8]>,
    ) -> PyResult<Self> {
        let source = Source {
            vehicle: vehicle.clone().unbind(),
            options: options.copy()?.unbind(),
            learned: learned.map(str::to_owned),
        };
        let vehicle = vehicle.get();
        let options = options.extract::<Options>()?.checked(&vehicle.inner)?;
        let variant = options.variant;
        let known = vehicle.learned(learned)?;
        if let Some(state) = state {
            let now = postcard::from_bytes(state).map_err(|error| {
                value_error(format!("the state of an estimator is damaged: {error}"))
            })?;
            let learner = Learner::new(&vehicle.file, variant, known);
            return Ok(Self { state: Mutex::new(State { now, learner }), source });
        }
        let now_s = known.newest_s().unwrap_or(0.0);
        let estimator = py.detach(|| {
            let learned = known.belief(&vehicle.file, variant, now_s)?;
            vehicle.estimator_of(learned.as_ref(), options)
        });
        let estimator = estimator.map_err(vehicle_error)?;
        let learner = Learner::new(&vehicle.file, variant, known);
        let settings = vehicle.inner.align_settings();
        let now = Now {
            estimator,
            plausibility: Plausibility::new(settings),
            rows: 0,
            previous_s: f64::NEG_INFINITY,
            has_roll_rate: false,
        };
        Ok(Self { state: Mutex::new(State { now, learner }), source })
    }

    /// Return what makes the same estimator again: the arguments of `Stream`.
    #[pyo3(name = "_parts")]
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let now = {
            let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
            state.now.clone()
        };
        let bytes = postcard::to_stdvec(&now).map_err(|error| value_error(error.to_string()))?;
        let Source { vehicle, options, learned } = &self.source;
        let options = options.bind(py).copy()?;
        Ok((vehicle.clone_ref(py), options, learned.clone(), PyBytes::new(py, &bytes)))
    }

    /// Process one row. Absent signals are None or NaN.
    ///
    /// Parameters
    /// ----------
    /// time_s : float
    ///     Time stamp from any origin, s; must increase.
    /// steer_rad : float
    ///     Mean road-wheel angle, rad, positive to the left.
    /// roll_rad : float
    ///     Roll angle of the trailer's sprung mass relative to the road, rad, positive if the right
    ///     side is down.
    /// **signals : float
    ///     The other signals of `cgheight.SIGNALS`: ``speed_mps``, ``lateral_acceleration_mps2``, ….
    ///
    /// Returns
    /// -------
    /// str
    ///     The state at this row: "absent" (no roll angle or no input), "straight" or "turning".
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The time is NaN or does not increase, a value is infinite, or the standard deviation of
    ///     the mass is negative. The row is ignored.
    /// TypeError
    ///     There is no such signal.
    #[pyo3(signature = (time_s, steer_rad = None, roll_rad = None, **signals))]
    fn push(
        &self,
        py: Python<'_>,
        time_s: f64,
        steer_rad: Option<f64>,
        roll_rad: Option<f64>,
        signals: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<&'static str> {
        let mut values = [f64::NAN; Signal::COUNT];
        values[Signal::Time as usize] = time_s;
        let absent = f64::NAN;
        values[Signal::Steer as usize] = steer_rad.unwrap_or(absent);
        values[Signal::Roll as usize] = roll_rad.unwrap_or(absent);
        for (name, value) in signals.into_iter().flatten() {
            let value: Option<f64> = value.extract()?;
            values[signal(name.extract()?)? as usize] = value.unwrap_or(absent);
        }
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.push(values).map_err(value_error)
    }

    /// Return what the truck has learned, as if the log ended here; more rows may follow.
    ///
    /// Returns
    /// -------
    /// str
    ///     JSON text for `learned` of the next `Estimator`: the trips with the empty trailer so far,
    ///     with this one if a mass in the rows says that the trailer is empty.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The trip cannot be learned.
    fn learned(&self, py: Python<'_>) -> PyResult<String> {
        let (log, mut learner) = {
            let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
            (state.now.estimator.clone(), state.learner.clone())
        };
        let design = *log.design();
        py.detach(|| learner.log(log)).map_err(vehicle_error)?;
        let vehicle = self.source.vehicle.get();
        learner.learned(&design).text_of(&vehicle.file).map_err(vehicle_error)
    }

    /// Return the estimate so far, as if the log ended here; more rows may follow.
    ///
    /// Returns
    /// -------
    /// Estimate
    ///     Its status is "rejected" until a maneuver has given a height.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let so_far = {
            let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
            state.now.clone()
        };
        let mut answer = py.detach(|| so_far.estimator.finish());
        if so_far.has_roll_rate {
            answer.messages.push(RATE_UNUSED.to_owned());
        }
        answer.messages.extend(so_far.plausibility.remarks());
        results::estimate(py, &answer)
    }
}
