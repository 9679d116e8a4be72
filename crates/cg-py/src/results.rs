//! Conversion of results to the dataclasses of the package.

use cg_core::Word;
use cg_logs::estimate::{ChannelEstimate, LogEstimate, ManeuverEstimate, Verdict};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::error::in_python;

/// Creates an object of a dataclass of the package.
pub(crate) fn make<'py>(
    py: Python<'py>,
    class: &str,
    fields: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("cgheight")?.getattr(class)?.call((), Some(fields))
}

fn verdict(status: Verdict) -> &'static str {
    match status {
        Verdict::Ok => "ok",
        Verdict::Rejected => "rejected",
        Verdict::Inconsistent => "inconsistent",
    }
}

fn maneuver<'py>(py: Python<'py>, maneuver: &ManeuverEstimate) -> PyResult<Bound<'py, PyAny>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let fields = PyDict::new(py);
    fields.set_item("start_s", maneuver.start_s)?;
    fields.set_item("end_s", maneuver.end_s)?;
    fields.set_item("height_m", maneuver.height_m)?;
    fields.set_item("height_sd_m", maneuver.height_sd_m)?;
    fields.set_item("ratio", maneuver.ratio)?;
    fields.set_item("ratio_sd", maneuver.ratio_sd)?;
    fields.set_item("snr_db", maneuver.snr_db)?;
    fields.set_item("status", verdict(maneuver.status))?;
    fields.set_item("reason", maneuver.reason.as_deref())?;
    CLASS.import(py, "cgheight._results", "Maneuver")?.call((), Some(&fields))
}

fn alone<'py>(py: Python<'py>, alone: &ChannelEstimate) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("channel", &alone.channel)?;
    fields.set_item("height_m", alone.height_m)?;
    fields.set_item("height_sd_m", alone.height_sd_m)?;
    fields.set_item("status", verdict(alone.status))?;
    fields.set_item("reason", alone.reason.as_deref())?;
    make(py, "ChannelEstimate", &fields)
}

/// Creates an `Estimate`.
pub(crate) fn estimate<'py>(py: Python<'py>, answer: &LogEstimate) -> PyResult<Bound<'py, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("status", verdict(answer.status))?;
    fields.set_item("height_m", answer.height_m)?;
    fields.set_item("height_sd_m", answer.height_sd_m)?;
    fields.set_item("height_ci95_m", answer.height_ci95_m.map(|[low, high]| (low, high)))?;
    fields.set_item("ratio", answer.ratio)?;
    fields.set_item("ratio_sd", answer.ratio_sd)?;
    fields.set_item("method", answer.method.word())?;
    fields.set_item("channel", answer.channel.as_deref())?;
    fields.set_item("speed_mps", answer.speed_mps)?;
    fields.set_item("trailer_mass_kg", answer.trailer_mass_kg)?;
    fields.set_item("lift_axle", answer.lift_axle.map(Word::word))?;
    fields.set_item("snr_db", answer.snr_db)?;
    fields.set_item("fit_percent", answer.fit_percent)?;
    fields.set_item("static_rollover_threshold_g", answer.static_rollover_threshold_g)?;
    let ends = answer.static_rollover_threshold_ci95_g.map(|[low, high]| (low, high));
    fields.set_item("static_rollover_threshold_ci95_g", ends)?;
    fields.set_item("road_share", answer.road_share)?;
    let channels: Vec<_> =
        answer.channels.iter().map(|one| alone(py, one)).collect::<PyResult<_>>()?;
    fields.set_item("channels", PyTuple::new(py, channels)?)?;
    let maneuvers: Vec<_> =
        answer.maneuvers.iter().map(|one| maneuver(py, one)).collect::<PyResult<_>>()?;
    fields.set_item("maneuvers", PyTuple::new(py, maneuvers)?)?;
    let messages = answer.messages.iter().map(|message| in_python(message));
    fields.set_item("messages", PyTuple::new(py, messages.collect::<Vec<_>>())?)?;
    make(py, "Estimate", &fields)
}
