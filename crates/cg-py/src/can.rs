//! `decode_j1939`: the signals of a CAN frame, by the table of `cg_core::signal::j1939`.

use cg_core::signal::j1939::{self, Compensation};
use cg_logs::log::Signal;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::value_error;

/// The words of `cg run --roll-compensated`.
fn compensation(word: &str) -> PyResult<Compensation> {
    match word {
        "bit" => Ok(Compensation::Bits),
        "inverted-bit" => Ok(Compensation::InvertedBits),
        "yes" => Ok(Compensation::On),
        "no" => Ok(Compensation::Off),
        _ => Err(value_error(format!(
            "roll_compensated is \"{}\": it must be \"bit\", \"inverted-bit\", \"yes\" or \"no\"",
            word.escape_debug()
        ))),
    }
}

/// The signals in a frame with a 29-bit identifier: a dict from SI column names to (value, rank),
/// the least rank being the preferred source of a signal; empty where the group is not one of ours
/// or nothing in it is available. `roll_compensated` says whether the angle of a slope sensor is
/// roll or tilt.
#[pyfunction]
#[pyo3(signature = (identifier, data, roll_compensated = "bit", /))]
pub(crate) fn decode_j1939<'py>(
    py: Python<'py>,
    identifier: u32,
    data: &[u8],
    roll_compensated: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    let mut result = Ok(());
    let rule = compensation(roll_compensated)?;
    j1939::decode(identifier, data, rule, |quantity, rank, value: f64| {
        if result.is_ok() {
            result = values.set_item(Signal::from(quantity).column(), (value, rank));
        }
    });
    result.map(|()| values)
}
