//! `Plant`: the nonlinear plant, step by step.

use std::sync::{Mutex, MutexGuard, PoisonError};

use cg_logs::log::Signal;
use cg_plant::plant::{Driver, DriverMoment, DriverSettings, Ground, Moment, Path, Progress};
use cg_plant::simulate::{PlantInput, PlantRun, PlantStart};
use cg_vehicle::Load;
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{in_python, value_error, vehicle_error};
use crate::scenario::load;
use crate::signals::slice;
use crate::vehicle::Vehicle;

/// Steps between two checks for an interrupt by the user.
const STEPS_BETWEEN_LOOKS: usize = 1 << 12;
/// The traces of `Plant.drive`.
const TRACES: [&str; 4] = ["steer_rad", "speed_mps", "bank_rad", "grade_rad"];

/// The nonlinear plant of a loaded vehicle that drives, step by step.
///
/// It starts straight ahead in equilibrium at time zero, at the origin, along x. Its speed and its
/// steer angle are prescribed; a driver may steer instead. A copy (`copy.copy`, `copy.deepcopy`) or a pickle
/// goes on to the last bit as the original would; a pickle can be read by the version that wrote it.
///
/// Parameters
/// ----------
/// vehicle : Vehicle
///     The vehicle.
/// height_m : float, optional
///     Height of the trailer's sprung c.g. above ground at rest, m.
/// trailer_mass_kg, payload_kg : float, optional
///     Mass of the whole semitrailer or of the payload, kg. One of them may be given.
/// payload_behind_hitch_m : float, optional
///     Distance of the payload's c.g. behind the fifth wheel, m.
/// payload_left_m : float
///     Distance of the payload's c.g. to the left of the middle, m.
/// speed_mps : float, optional
///     Speed at the start, m/s.
/// bank_rad, grade_rad : float
///     Bank (left side higher) and grade (uphill) of the road at the start, rad.
/// path_m : sequence of (float, float), optional
///     Points x, y of a path, m, beginning at the origin. A driver who looks 1.5 s ahead steers along it
///     wherever no steer angle is given, at the speed of the start.
///
/// Raises
/// ------
/// ValueError
///     The vehicle cannot carry this load, or a number is out of range.
#[pyclass(frozen, module = "cgheight")]
pub(crate) struct Plant {
    state: Mutex<State>,
    source: Source,
}

/// What it was made of.
struct Source {
    vehicle: Py<Vehicle>,
    start: PlantStart,
    path_m: Option<Vec<[f64; 2]>>,
}

impl Source {
    fn state(&self, py: Python<'_>) -> PyResult<State> {
        let vehicle = &self.vehicle.get().inner;
        let run = py.detach(|| PlantRun::new(vehicle, &self.start)).map_err(vehicle_error)?;
        let driver = self.path_m.as_ref().map(|points_m| -> PyResult<Driver> {
            let path = path(points_m)?;
            run.driver(path, DriverSettings::default()).map_err(vehicle_error)
        });
        let driver = driver.transpose()?;
        Ok(State { run, driver })
    }

    fn clone_ref(&self, py: Python<'_>) -> Self {
        let Self { ref vehicle, start, ref path_m } = *self;
        Self { vehicle: vehicle.clone_ref(py), start, path_m: path_m.clone() }
    }
}

/// What changes with every step, and is pickled.
type Now = (Moment, Option<DriverMoment>);

#[derive(Clone)]
struct State {
    run: PlantRun,
    driver: Option<Driver>,
}

impl State {
    fn now(&self) -> Now {
        (self.run.simulation().moment(), self.driver.as_ref().map(Driver::moment))
    }

    fn go_on_from(&mut self, (moment, driving): &Now) -> PyResult<()> {
        self.run.go_on_from(moment).map_err(vehicle_error)?;
        match (&mut self.driver, driving) {
            (Some(driver), Some(driving)) => driver.go_on_from(driving).map_err(vehicle_error),
            (None, None) => Ok(()),
            _ => Err(damaged("it has a driver and no path, or a path and no driver")),
        }
    }

    /// Drives on to these values of the traces; NaN remains as it is, and as steer angle is that of the
    /// driver.
    fn step(&mut self, wish: [f64; 4], interval_s: f64) -> Result<(), String> {
        let [steer_rad, speed_mps, bank_rad, grade_rad] = wish;
        let now = self.run.simulation().control();
        let or = |value: f64, present: f64| if value.is_nan() { present } else { value };
        let ground = Ground {
            bank_rad: or(bank_rad, now.ground.bank_rad),
            grade_rad: or(grade_rad, now.ground.grade_rad),
            ..now.ground
        };
        let done = if !steer_rad.is_nan() {
            let speed_mps = or(speed_mps, now.speed_mps);
            self.run.step(&PlantInput { steer_rad, speed_mps, ground }, interval_s)
        } else if let Some(driver) = &mut self.driver {
            if !speed_mps.is_nan() {
                return Err("the driver keeps the speed, but speed_mps is given: give steer_rad \
                            too, or no speed_mps"
                    .into());
            }
            self.run.follow(driver, ground, interval_s)
        } else {
            return Err(
                "steer_rad is absent, and there is no driver: give steer_rad here, or path_m \
                        when the plant is made"
                    .into(),
            );
        };
        done.map(|_| ()).map_err(|error| in_python(&error.to_string()))
    }

    /// The time and what perfect sensors show.
    fn signals(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let row = self.run.row(self.run.simulation().time_s(), &self.run.sample());
        let all = Signal::ALL.into_iter().map(move |signal| (signal.column(), row.get(signal)));
        all.filter(|(_, value)| !value.is_nan())
    }

    fn states(&self) -> Vec<(String, f64)> {
        let sample = self.run.sample();
        let names = sample.state_names().into_iter().map(|state| state.name);
        names.zip(sample.states()).collect()
    }

    /// Drives through the traces and writes a table with a column for each signal and state.
    fn drive(
        &mut self,
        traces: &[Option<&[f64]>; 4],
        steps: std::ops::Range<usize>,
        interval_s: f64,
        table: &mut [Vec<f64>],
    ) -> Result<(), String> {
        for k in steps {
            let wish = traces.map(|trace| trace.map_or(f64::NAN, |values| values[k]));
            self.step(wish, interval_s).map_err(|error| format!("step {k}: {error}"))?;
            let sample = self.run.sample();
            let signals = self.signals().map(|(_, value)| value);
            for (column, value) in table.iter_mut().zip(signals.chain(sample.states())) {
                column.push(value);
            }
        }
        Ok(())
    }
}

impl Plant {
    fn lock(&self, py: Python<'_>) -> MutexGuard<'_, State> {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Plant {
    #[new]
    #[pyo3(signature = (
        vehicle, *, height_m = None, trailer_mass_kg = None, payload_kg = None,
        payload_behind_hitch_m = None, payload_left_m = 0.0, speed_mps = None, bank_rad = 0.0,
        grade_rad = 0.0, path_m = None
    ))]
    #[allow(clippy::too_many_arguments)] // keywords
    fn new(
        py: Python<'_>,
        vehicle: &Bound<'_, Vehicle>,
        height_m: Option<f64>,
        trailer_mass_kg: Option<f64>,
        payload_kg: Option<f64>,
        payload_behind_hitch_m: Option<f64>,
        payload_left_m: f64,
        speed_mps: Option<f64>,
        bank_rad: f64,
        grade_rad: f64,
        path_m: Option<Vec<[f64; 2]>>,
    ) -> PyResult<Self> {
        let (handle, vehicle) = (vehicle.clone().unbind(), &vehicle.get().inner);
        let usual = PlantStart::of(vehicle);
        let start = PlantStart {
            load: load(vehicle, height_m, trailer_mass_kg, payload_kg)?,
            payload_behind_hitch_m: payload_behind_hitch_m.unwrap_or(usual.payload_behind_hitch_m),
            payload_left_m,
            speed_mps: speed_mps.unwrap_or(usual.speed_mps),
            bank_rad,
            grade_rad,
        };
        let source = Source { vehicle: handle, start, path_m };
        Ok(Self { state: Mutex::new(source.state(py)?), source })
    }

    /// Drive on for a time.
    ///
    /// Parameters
    /// ----------
    /// steer_rad : float or None
    ///     Mean road-wheel angle at the end of the step, rad, positive to the left; it is reached
    ///     linearly. None or NaN: the driver steers.
    /// interval_s : float
    ///     Length of the step, s. The plant divides it into steps of at most 2 ms.
    /// speed_mps, bank_rad, grade_rad : float, optional
    ///     Speed (m/s), bank and grade (rad) at the end of the step; without them they remain.
    ///
    /// Returns
    /// -------
    /// dict
    ///     What perfect sensors show at the end, by the names in `cgheight.SIGNALS`, so that
    ///     ``estimator.push(**plant.step(…))`` estimates the height.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A number is out of range, or nobody steers. The plant does not move then.
    #[pyo3(signature = (steer_rad, interval_s, *, speed_mps = None, bank_rad = None, grade_rad = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        steer_rad: Option<f64>,
        interval_s: f64,
        speed_mps: Option<f64>,
        bank_rad: Option<f64>,
        grade_rad: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wish = [steer_rad, speed_mps, bank_rad, grade_rad];
        let mut state = self.lock(py);
        state.step(wish.map(|value| value.unwrap_or(f64::NAN)), interval_s).map_err(value_error)?;
        dict(py, state.signals())
    }

    /// Drive on through traces of your own: a `step` for each element.
    ///
    /// Parameters
    /// ----------
    /// steer_rad : array, shape (n,)
    ///     Mean road-wheel angle at the end of each step, rad. Where it is NaN, the driver steers.
    /// interval_s : float
    ///     Length of each step, s.
    /// speed_mps, bank_rad, grade_rad : array, shape (n,), optional
    ///     Speed (m/s), bank and grade (rad) at the end of each step. NaN leaves them as they are.
    ///
    /// Returns
    /// -------
    /// dict
    ///     An array for each signal and each true state, with the values at the end of each step.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As for `step`, with the number of the step, or an array has another length. The plant is
    ///     then where it was.
    #[pyo3(signature = (steer_rad, interval_s, *, speed_mps = None, bank_rad = None, grade_rad = None))]
    fn drive<'py>(
        &self,
        py: Python<'py>,
        steer_rad: Bound<'py, PyAny>,
        interval_s: f64,
        speed_mps: Option<Bound<'py, PyAny>>,
        bank_rad: Option<Bound<'py, PyAny>>,
        grade_rad: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let arrays = arrays(py, [Some(steer_rad), speed_mps, bank_rad, grade_rad])?;
        let traces = slices(&arrays)?;
        let count = traces[0].map_or(0, <[f64]>::len);
        let mut state = self.lock(py);
        let mut trial = state.clone();
        let names: Vec<String> = state.signals().map(|(name, _)| name.to_owned()).collect();
        let names = names.into_iter().chain(state.states().into_iter().map(|(name, _)| name));
        let names: Vec<String> = names.collect();
        let mut table = vec![Vec::with_capacity(count); names.len()];
        for first in (0..count).step_by(STEPS_BETWEEN_LOOKS) {
            let steps = first..count.min(first + STEPS_BETWEEN_LOOKS);
            py.detach(|| trial.drive(&traces, steps, interval_s, &mut table))
                .map_err(value_error)?;
            py.check_signals()?;
        }
        *state = trial;
        let result = PyDict::new(py);
        for (name, values) in names.into_iter().zip(table) {
            result.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(result)
    }

    /// What perfect sensors show now, with the time, by the names in `cgheight.SIGNALS`.
    #[getter]
    fn signals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, self.lock(py).signals())
    }

    /// The true states now: a dict of names with units to values. Axles count from one.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        dict(py, self.lock(py).states())
    }

    /// Time since the start, s.
    #[getter]
    fn time_s(&self, py: Python<'_>) -> f64 {
        self.lock(py).run.simulation().time_s()
    }

    /// Whether a unit has rolled beyond 0.6 rad. The vehicle then does not move any more.
    #[getter]
    fn rolled_over(&self, py: Python<'_>) -> bool {
        self.lock(py).run.simulation().progress() != Progress::Running
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self { state: Mutex::new(self.lock(py).clone()), source: self.source.clone_ref(py) }
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: Bound<'_, PyAny>) -> Self {
        self.__copy__(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Restored<'py>)> {
        let restore = py.import("cgheight._native")?.getattr("restore_plant")?;
        let now = self.lock(py).now();
        let bytes = postcard::to_stdvec(&now).map_err(|error| value_error(error.to_string()))?;
        let Source { vehicle, start, path_m } = self.source.clone_ref(py);
        let PlantStart {
            load,
            payload_behind_hitch_m,
            payload_left_m,
            speed_mps,
            bank_rad,
            grade_rad,
        } = start;
        let start = [
            load.trailer_mass_kg,
            load.cg_height_m,
            payload_behind_hitch_m,
            payload_left_m,
            speed_mps,
            bank_rad,
            grade_rad,
        ];
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Ok((restore, (version, vehicle, start, path_m, PyBytes::new(py, &bytes))))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let state = self.lock(py);
        let run = state.run.simulation();
        let upright = if run.progress() == Progress::Running { "" } else { ", rolled over" };
        format!("Plant({:.3} s, {:.2} m/s{upright})", run.time_s(), run.control().speed_mps)
    }
}

/// The arguments of [`restore_plant`].
type Restored<'py> = (String, Py<Vehicle>, [f64; 7], Option<Vec<[f64; 2]>>, Bound<'py, PyBytes>);

/// Return a plant in the state in which it was pickled: the version that wrote it, the vehicle, load and start, the path
/// and the state.
#[pyfunction]
#[pyo3(signature = (version, vehicle, start, path_m, state, /))]
pub(crate) fn restore_plant(
    py: Python<'_>,
    version: &str,
    vehicle: Py<Vehicle>,
    start: [f64; 7],
    path_m: Option<Vec<[f64; 2]>>,
    state: &[u8],
) -> PyResult<Plant> {
    if version != env!("CARGO_PKG_VERSION") {
        return Err(value_error(format!(
            "this Plant was pickled by cgheight {version}, and this is {}, whose state is another one: drive \
             a new Plant",
            env!("CARGO_PKG_VERSION")
        )));
    }
    let [trailer_mass_kg, cg_height_m, start @ ..] = start;
    let [payload_behind_hitch_m, payload_left_m, speed_mps, bank_rad, grade_rad] = start;
    let load = Load { trailer_mass_kg, cg_height_m };
    let start =
        PlantStart { load, payload_behind_hitch_m, payload_left_m, speed_mps, bank_rad, grade_rad };
    let now: Now = postcard::from_bytes(state).map_err(|error| damaged(&error.to_string()))?;
    let source = Source { vehicle, start, path_m };
    let mut state = source.state(py)?;
    state.go_on_from(&now)?;
    Ok(Plant { state: Mutex::new(state), source })
}

fn damaged(reason: &str) -> PyErr {
    value_error(format!("the state of a plant is damaged: {reason}"))
}

/// The path through points, which must lead somewhere.
fn path(points_m: &[[f64; 2]]) -> PyResult<Path> {
    let length_m: f64 = points_m
        .windows(2)
        .map(|two| libm::hypot(two[1][0] - two[0][0], two[1][1] - two[0][1]))
        .sum();
    if !(length_m.is_finite() && length_m >= 10.0) {
        return Err(value_error(format!(
            "path_m has {} points and a length of {length_m} m: it must be finite and at least 10 m long",
            points_m.len()
        )));
    }
    Ok(Path::through(points_m))
}

/// The traces as contiguous arrays.
fn arrays<'py>(
    py: Python<'py>,
    values: [Option<Bound<'py, PyAny>>; 4],
) -> PyResult<Vec<Option<PyReadonlyArrayDyn<'py, f64>>>> {
    let column = py.import("cgheight._arrays")?.getattr("column")?;
    let convert = |(name, values): (&str, Option<Bound<'py, PyAny>>)| {
        let array = values.map(|values| -> PyResult<_> {
            column.call1((name, values))?.extract::<PyReadonlyArrayDyn<'py, f64>>()
        });
        array.transpose()
    };
    TRACES.into_iter().zip(values).map(convert).collect()
}

/// The traces as slices of one length.
fn slices<'a>(
    arrays: &'a [Option<PyReadonlyArrayDyn<'_, f64>>],
) -> PyResult<[Option<&'a [f64]>; 4]> {
    let mut traces = [None; 4];
    for ((trace, array), name) in traces.iter_mut().zip(arrays).zip(TRACES) {
        *trace = array.as_ref().map(|array| slice(name, array)).transpose()?;
    }
    let count = traces[0].map_or(0, <[f64]>::len);
    for (trace, name) in traces.iter().zip(TRACES) {
        if let Some(values) = trace.filter(|values| values.len() != count) {
            return Err(value_error(format!(
                "{name} has {} values and steer_rad has {count}: they must have the same length",
                values.len()
            )));
        }
    }
    Ok(traces)
}

fn dict<N: AsRef<str>>(
    py: Python<'_>,
    values: impl IntoIterator<Item = (N, f64)>,
) -> PyResult<Bound<'_, PyDict>> {
    let fields = PyDict::new(py);
    for (name, value) in values {
        fields.set_item(name.as_ref(), value)?;
    }
    Ok(fields)
}
