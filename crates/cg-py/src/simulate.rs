//! `simulate_log` simulates a log with known truth; `score_accuracy` scores estimates of many logs.

use cg_logs::log::Signal;
use cg_thesis::accuracy::{Experiment, Truck};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{value_error, vehicle_error};
use crate::options::{self, word};
use crate::scenario::Request;
use crate::vehicle::Vehicle;

/// A simulated log: a dict of columns, the truth as JSON, and a dict of the places on the road.
type Simulated<'py> = (Bound<'py, PyDict>, String, Option<Bound<'py, PyDict>>);

/// Simulate a log: a dict of columns, the truth as JSON, and on a road a dict of the places. The yaw rate is where the
/// vehicle has its sensor, `on_bus` on the tractor if it does not say.
#[pyfunction]
#[pyo3(signature = (vehicle, request, /, *, on_bus = false))]
pub(crate) fn simulate_log<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    request: Request,
    on_bus: bool,
) -> PyResult<Simulated<'py>> {
    let mut simulated = vehicle.get().inner.clone();
    if on_bus {
        simulated.sensors = simulated.sensors.on_bus();
    }
    let simulation = request.simulation(py, &simulated)?;
    let rows = py.detach(|| simulation.rows());
    py.check_signals()?; // Ctrl-C during the simulation
    let truth =
        serde_json::to_string(&simulation.truth).map_err(|error| value_error(error.to_string()))?;
    let table = PyDict::new(py);
    for signal in simulation.columns() {
        let values = PyArray1::from_iter(py, rows.iter().map(|row| row.get(signal)));
        table.set_item(signal.column(), values)?;
    }
    if vehicle.get().file.has_lift_axle() {
        let position = vehicle.get().lift_axle.unwrap_or_default().value();
        let values = PyArray1::from_iter(py, rows.iter().map(|_| position));
        table.set_item(Signal::LiftAxle.column(), values)?;
    }
    let track = simulation.track.map(|track| -> PyResult<_> {
        let places = PyDict::new(py);
        places.set_item("time_s", PyArray1::from_vec(py, track.time_s))?;
        places.set_item("distance_m", PyArray1::from_vec(py, track.distance_m))?;
        places.set_item("bank_rad", PyArray1::from_vec(py, track.bank_rad))?;
        let tractor_yaw = PyArray1::from_vec(py, track.tractor_yaw_rate_radps);
        places.set_item("tractor_yaw_rate_radps", tractor_yaw)?;
        Ok(places)
    });
    Ok((table, truth, track.transpose()?))
}

/// Estimate the same scenario `runs` times with new noise, and score the heights.
///
/// Returns a dict; lengths are relative to the true height.
#[pyfunction]
#[pyo3(signature = (vehicle, request, truck, channel, method, runs, /))]
pub(crate) fn score_accuracy<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    request: Request,
    truck: &str,
    channel: &str,
    method: &str,
    runs: u32,
) -> PyResult<Bound<'py, PyDict>> {
    let vehicle = &vehicle.get().inner;
    if request.is_on_road() {
        return Err(value_error("road: the accuracy is mapped with a maneuver; give one instead"));
    }
    let scenario = request.scenario(vehicle)?;
    let truck: Truck = word("truck", truck)?;
    if runs == 0 {
        return Err(value_error("runs is 0: it must be 1 or more"));
    }
    let experiment = Experiment {
        truck,
        channel: options::channel(channel)?,
        method: word("method", method)?,
        runs,
        seed: scenario.seed,
        ..Experiment::of(scenario)
    };
    let score = py.detach(|| experiment.score(vehicle)).map_err(vehicle_error)?;
    let fields = PyDict::new(py);
    fields.set_item("answered", score.answered)?;
    fields.set_item("bias", score.bias)?;
    fields.set_item("rmse", score.rmse)?;
    fields.set_item("stated_sd", score.stated_sd)?;
    fields.set_item("coverage", score.coverage)?;
    fields.set_item("bound", score.bound)?;
    Ok(fields)
}
