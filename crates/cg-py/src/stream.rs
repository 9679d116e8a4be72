//! Row by row.

use std::sync::{Mutex, PoisonError};

use cg_core::Status;
use cg_logs::estimate::LogEstimator;
use cg_logs::log::LogRow;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

use crate::error::{value_error, vehicle_error};
use crate::options::Options;
use crate::results;
use crate::signals::check_row;
use crate::vehicle::Vehicle;

/// The estimator, one row at a time. `cgheight.Estimator` gives it its options.
#[pyclass(frozen, subclass, module = "cgheight._native")]
pub(crate) struct Stream {
    state: Mutex<State>,
}

struct State {
    estimator: LogEstimator,
    previous_s: f64,
}

impl State {
    fn push(&mut self, row: &LogRow) -> Result<&'static str, String> {
        check_row(row).map_err(|(name, value)| match value {
            None => format!("{name} is NaN: every row needs its time"),
            Some(value) => format!("{name} = {value} is not finite: use NaN for no value"),
        })?;
        if row.time_s <= self.previous_s {
            return Err(format!(
                "time_s = {} does not come after {}, the time of the row before",
                row.time_s, self.previous_s
            ));
        }
        let time_s = row.time_s;
        let status =
            self.estimator.push(row).map_err(|error| format!("time_s = {time_s}: {error}"))?;
        self.previous_s = time_s;
        Ok(match status {
            Status::Absent => "absent",
            Status::Straight => "straight",
            Status::Turning => "turning",
        })
    }
}

#[pymethods]
impl Stream {
    #[new]
    #[pyo3(signature = (vehicle, options, /))]
    fn new(py: Python<'_>, vehicle: &Bound<'_, Vehicle>, options: Options) -> PyResult<Self> {
        let options = options.checked()?;
        let vehicle = vehicle.get();
        let design = py.detach(|| vehicle.design(options.variant)).map_err(vehicle_error)?;
        let settings = vehicle.inner.align_settings();
        let estimator = LogEstimator::from_design(design, settings, options);
        let state = State { estimator, previous_s: f64::NEG_INFINITY };
        Ok(Self { state: Mutex::new(state) })
    }

    /// Take in one row. Signals that are absent stay NaN.
    ///
    /// Parameters
    /// ----------
    /// time_s : float
    ///     Time stamp from any origin, s; must increase.
    /// steer_rad : float
    ///     Mean road-wheel angle, rad, positive to the left.
    /// roll_rad : float
    ///     Roll angle of the trailer's sprung mass to the road, rad, positive right side down.
    /// speed_mps : float
    ///     Forward speed, m/s.
    /// lateral_acceleration_mps2 : float
    ///     Lateral acceleration of the trailer, m/s², positive to the left.
    /// yaw_rate_radps : float
    ///     Yaw rate of the trailer, rad/s, positive to the left.
    /// trailer_mass_kg : float
    ///     Mass of the whole semitrailer as weighed, kg.
    /// steering_wheel_rad : float
    ///     Steering-wheel angle, rad, used where steer_rad is NaN.
    /// tilt_rad : float
    ///     What an accelerometer inclinometer shows, rad, used where roll_rad is NaN.
    /// trailer_axle_load_kg : float
    ///     Load of the trailer's axles on the road, kg, used where trailer_mass_kg is NaN.
    /// trailer_suspension_pressure_pa : float
    ///     Pressure in the trailer's air suspension, Pa, used where both are NaN.
    ///
    /// Returns
    /// -------
    /// str
    ///     What this row shows: "absent" (no roll angle or no input), "straight" or "turning".
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Time is NaN or does not increase, or a value is infinite. The row is not taken in.
    #[pyo3(signature = (
        time_s, steer_rad = f64::NAN, roll_rad = f64::NAN, *, speed_mps = f64::NAN,
        lateral_acceleration_mps2 = f64::NAN, yaw_rate_radps = f64::NAN,
        trailer_mass_kg = f64::NAN, steering_wheel_rad = f64::NAN, tilt_rad = f64::NAN,
        trailer_axle_load_kg = f64::NAN, trailer_suspension_pressure_pa = f64::NAN
    ))]
    #[allow(clippy::too_many_arguments)] // a row is that wide
    fn push(
        &self,
        py: Python<'_>,
        time_s: f64,
        steer_rad: f64,
        roll_rad: f64,
        speed_mps: f64,
        lateral_acceleration_mps2: f64,
        yaw_rate_radps: f64,
        trailer_mass_kg: f64,
        steering_wheel_rad: f64,
        tilt_rad: f64,
        trailer_axle_load_kg: f64,
        trailer_suspension_pressure_pa: f64,
    ) -> PyResult<&'static str> {
        let row = LogRow {
            time_s,
            steer_rad,
            steering_wheel_rad,
            roll_rad,
            tilt_rad,
            speed_mps,
            lateral_acceleration_mps2,
            yaw_rate_radps,
            trailer_mass_kg,
            trailer_axle_load_kg,
            trailer_suspension_pressure_pa,
        };
        let mut state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        state.push(&row).map_err(value_error)
    }

    /// The answer so far, as if the log ended here; more rows may follow.
    ///
    /// Returns
    /// -------
    /// Estimate
    ///     With status "rejected" as long as no maneuver gave a height.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let so_far = {
            let state = self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
            state.estimator.clone()
        };
        let answer = py.detach(|| so_far.finish());
        results::estimate(py, &answer)
    }
}
