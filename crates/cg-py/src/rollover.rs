//! Rollover measures of a loaded vehicle.

use cg_plant::rollover::{Curve, RolloverOptions, measures};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::vehicle_error;
use crate::options::{speed, up_to};
use crate::scenario::load;
use crate::vehicle::Vehicle;

/// Return all rollover measures of a loaded vehicle, as ``cg rollover`` prints them.
///
/// The calibration of a vehicle is not used.
///
/// Parameters
/// ----------
/// vehicle : Vehicle
///     The vehicle.
/// speed_mps : float, optional
///     Forward speed, m/s; the vehicle's nominal speed if absent. Measures that are defined at a certain
///     speed keep it.
/// height_m : float, optional
///     Height of the trailer's sprung c.g. above ground, m; the vehicle's reference if absent.
/// trailer_mass_kg : float, optional
///     Mass of the whole semitrailer, kg; the vehicle's reference if absent.
/// radius_m : float, optional
///     Radius of a level curve, m: also gives the speed at which it keeps a margin.
/// share : float
///     Share of the lower bound of the rollover threshold that the curve may use.
/// height_sd_m : float
///     Standard deviation of the height, m, for that bound.
///
/// Returns
/// -------
/// dict of str to float or None
///     The measures by name, with the unit at its end; None if there is none. Names and formulas are those
///     of docs/plant.md.
///
/// Raises
/// ------
/// ValueError
///     The load is impossible, the vehicle cannot drive straight, or a number is impossible.
#[pyfunction]
#[pyo3(signature = (
    vehicle, *, speed_mps = None, height_m = None, trailer_mass_kg = None, radius_m = None, share = 0.6,
    height_sd_m = 0.0
))]
#[allow(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn rollover_measures<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    speed_mps: Option<f64>,
    height_m: Option<f64>,
    trailer_mass_kg: Option<f64>,
    radius_m: Option<f64>,
    share: f64,
    height_sd_m: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let vehicle = &vehicle.get().inner;
    let load = load(vehicle, height_m, trailer_mass_kg, None)?;
    let radius_m = up_to("radius_m", radius_m, f64::MAX)?;
    let curve = radius_m.map(|radius_m| Curve { radius_m, share, height_sd_m });
    let defaults = RolloverOptions::of(vehicle);
    let speed_mps = speed(speed_mps)?.unwrap_or(defaults.speed_mps);
    let options = RolloverOptions { speed_mps, curve, ..defaults };
    let all = py.detach(|| measures(vehicle, load, &options)).map_err(vehicle_error)?;
    let fields = PyDict::new(py);
    for measure in all.measures {
        fields.set_item(measure.name, measure.value)?;
    }
    Ok(fields)
}
