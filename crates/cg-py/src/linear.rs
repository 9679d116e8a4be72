//! The linear model of a vehicle.

use cg_core::RatioLine;
use cg_core::truck::reduced::ORDER;
use cg_vehicle::VehicleError;
use cg_vehicle::compensated::{CompensatedModel, compensated_models};
use cg_vehicle::reduction::{Method, ReducedModels, reduce};
use cg_vehicle::response::NamedResponse;
use cg_vehicle::system::{Rational, TransferFunction};
use numpy::{Complex64, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error::vehicle_error;
use crate::options::{speed, word};
use crate::results::make;
use crate::scenario::load;
use crate::vehicle::Vehicle;

/// All results that are computed without the interpreter.
struct Computed {
    model: cg_vehicle::LinearModel,
    transfer: TransferFunction,
    reduced: ReducedModels,
    responses: Vec<(String, TransferFunction)>,
    compensated: Vec<CompensatedModel>,
}

/// Return the linear model of a vehicle from steer angle to trailer roll angle.
///
/// Parameters
/// ----------
/// vehicle : Vehicle
///     The vehicle; a calibrated one as the calibration says.
/// model : {"complete", "as-printed"}
///     The equations: with all terms, or with those printed in the thesis (corrected).
/// speed_mps : float, optional
///     Forward speed, m/s; the vehicle's nominal speed if absent.
/// height_m : float, optional
///     Height of the trailer's sprung c.g. above ground, m; the vehicle's reference if absent.
/// trailer_mass_kg : float, optional
///     Mass of the whole semitrailer as weighed, kg; the vehicle's reference if absent.
///
/// Returns
/// -------
/// LinearModel
///
/// Raises
/// ------
/// ValueError
///     The load is impossible, the vehicle rolls over or is unstable, the printed model is not
///     available at this load, or the calibration is for the other model.
#[pyfunction]
#[pyo3(signature = (
    vehicle, *, model = "complete", speed_mps = None, height_m = None, trailer_mass_kg = None
))]
pub(crate) fn linear_model<'py>(
    py: Python<'py>,
    vehicle: &Bound<'py, Vehicle>,
    model: &str,
    speed_mps: Option<f64>,
    height_m: Option<f64>,
    trailer_mass_kg: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let variant = word("model", model)?;
    let belief = vehicle.get().posterior(variant).map_err(vehicle_error)?;
    let file = &vehicle.get().inner;
    let calibrated = belief.as_ref().map(|belief| belief.applied_to(file));
    let vehicle = calibrated.as_ref().unwrap_or(file);
    let speed_mps = speed(speed_mps)?.unwrap_or(vehicle.nominal_speed_mps);
    let load = load(vehicle, height_m, trailer_mass_kg, None)?;
    let compute = || -> Result<Computed, VehicleError> {
        let model = cg_vehicle::LinearModel::new(vehicle, variant, speed_mps, load)?;
        let transfer = model.state_space.to_trailer_roll().transfer_function()?;
        let reduced = reduce(&model.state_space, &[])?;
        let compensated = match &belief {
            Some(belief) => compensated_models(file, variant, belief, (speed_mps, load))?,
            None => Vec::new(),
        };
        let space = &model.state_space;
        let all = space.responses().into_iter();
        let function =
            |one: NamedResponse| Ok((one.name.clone(), space.transfer_function_of(&one)?));
        let responses = all.map(function).collect::<Result<Vec<_>, VehicleError>>()?;
        Ok(Computed { model, transfer, reduced, responses, compensated })
    };
    let computed = py.detach(compute).map_err(vehicle_error)?;
    let fields = PyDict::new(py);
    fields.set_item("vehicle", &vehicle.name)?;
    fields.set_item("speed_mps", speed_mps)?;
    fields.set_item("height_m", load.cg_height_m)?;
    fields.set_item("trailer_mass_kg", load.trailer_mass_kg)?;
    set_transfer_function(&fields, computed.transfer)?;
    set_state_space(&fields, &computed.model)?;
    fields.set_item("ratio", ratio_line(py, &computed.model.ratio[0])?)?;
    fields.set_item("lateral_acceleration_ratio", ratio_line(py, &computed.model.ratio[1])?)?;
    fields.set_item("suspension_ratio", ratio_line(py, &computed.model.ratio[2])?)?;
    fields.set_item("tractor_ratio", ratio_line(py, &computed.model.ratio[3])?)?;
    fields.set_item("reduced", reduced_model(py, &computed.reduced)?)?;
    fields.set_item("responses", responses(py, computed.responses)?)?;
    let compensated = computed.compensated.iter().map(|one| compensated_model(py, one));
    let compensated = compensated.collect::<PyResult<Vec<_>>>()?;
    fields.set_item("compensated", PyTuple::new(py, compensated)?)?;
    fields.set_item("static_balance", static_balance(py, computed.model)?)?;
    make(py, "LinearModel", &fields)
}

fn set_transfer_function(fields: &Bound<'_, PyDict>, transfer: TransferFunction) -> PyResult<()> {
    let py = fields.py();
    let complex = |roots: &[(f64, f64)]| {
        PyArray1::from_iter(py, roots.iter().map(|&(re, im)| Complex64::new(re, im)))
    };
    fields.set_item("poles", complex(&transfer.poles))?;
    fields.set_item("zeros", complex(&transfer.zeros))?;
    fields.set_item("numerator", PyArray1::from_vec(py, transfer.numerator))?;
    fields.set_item("denominator", PyArray1::from_vec(py, transfer.denominator))?;
    fields.set_item("gain", transfer.gain)?;
    fields.set_item("dc_gain", transfer.dc_gain)
}

/// The transfer functions to all responses, by name.
fn responses(py: Python<'_>, all: Vec<(String, TransferFunction)>) -> PyResult<Bound<'_, PyDict>> {
    let class = py.import("cgheight")?.getattr("TransferFunction")?;
    let named = PyDict::new(py);
    for (name, function) in all {
        let [numerator, denominator] =
            [function.numerator, function.denominator].map(|list| PyArray1::from_vec(py, list));
        named.set_item(name, class.call_method1("from_polynomials", (numerator, denominator))?)?;
    }
    Ok(named)
}

fn set_state_space(fields: &Bound<'_, PyDict>, model: &cg_vehicle::LinearModel) -> PyResult<()> {
    let (py, space) = (fields.py(), &model.state_space);
    let n = space.a.nrows();
    let a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| space.a[(i, j)]).collect()).collect();
    let b: Vec<Vec<f64>> = space.b.iter().map(|&entry| vec![entry]).collect();
    let c: Vec<f64> = space.trailer_roll.iter().copied().collect();
    fields.set_item("A", PyArray2::from_vec2(py, &a)?)?;
    fields.set_item("B", PyArray2::from_vec2(py, &b)?)?;
    fields.set_item("C", PyArray2::from_vec2(py, &[c])?)?;
    fields.set_item("D", PyArray2::from_vec2(py, &[vec![0.0]])?)
}

fn ratio_line<'py>(py: Python<'py>, line: &RatioLine<f64>) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("a0", line.a0)?;
    fields.set_item("a1", line.a1)?;
    fields.set_item("b0", line.b0)?;
    fields.set_item("b1", line.b1)?;
    make(py, "RatioLine", &fields)
}

fn reduced_model<'py>(py: Python<'py>, models: &ReducedModels) -> PyResult<Bound<'py, PyAny>> {
    let steer = &models.of_channels[cg_core::Channel::Steer.index()];
    let numerator = steer.numerator.iter().rev().copied().collect();
    let denominator = std::iter::once(1.0).chain(steer.denominator.iter().rev().copied()).collect();
    let method = match models.method {
        Method::Pade => "pade",
        Method::SlowestPoles => "slowest-poles",
    };
    let fields = PyDict::new(py);
    fields.set_item("order", ORDER)?;
    fields.set_item("method", method)?;
    fields.set_item("numerator", PyArray1::from_vec(py, numerator))?;
    fields.set_item("denominator", PyArray1::from_vec(py, denominator))?;
    make(py, "ReducedModel", &fields)
}

fn compensated_model<'py>(
    py: Python<'py>,
    model: &CompensatedModel,
) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("cgheight")?.getattr("TransferFunction")?;
    let transfer = |one: &Rational| {
        let [numerator, denominator] = [&one.numerator, &one.denominator]
            .map(|list| PyArray1::from_iter(py, list.iter().rev().copied()));
        class.call_method1("from_polynomials", (numerator, denominator))
    };
    let fields = PyDict::new(py);
    fields.set_item("channel", model.channel.to_string())?;
    fields.set_item("order", model.function.denominator.len() - 1)?;
    fields.set_item("function", transfer(&model.function)?)?;
    fields.set_item("product", transfer(&model.product)?)?;
    fields.set_item("reduced", transfer(&model.reduced)?)?;
    fields.set_item("change", model.change)?;
    fields.set_item("reduction_error", model.reduction_error)?;
    make(py, "CompensatedModel", &fields)
}

fn static_balance(py: Python<'_>, model: cg_vehicle::LinearModel) -> PyResult<Bound<'_, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("axle_load_n", PyArray1::from_vec(py, model.balance.axle_load_n))?;
    fields.set_item("hitch_load_n", model.balance.hitch_load_n)?;
    fields.set_item("residual_nm", model.balance.residual_nm)?;
    make(py, "StaticBalance", &fields)
}
