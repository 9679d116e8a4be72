//! `decode_j1939`: the signals of a CAN frame, by the table of `cg_core::j1939`.

use cg_core::j1939;
use cg_vehicle::log::Signal;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The signals in a frame with a 29-bit identifier: a dict from SI column names to (value, rank),
/// the least rank being the preferred source of a signal; empty where the group is not one of ours
/// or nothing in it is available.
#[pyfunction]
#[pyo3(signature = (identifier, data, /))]
pub(crate) fn decode_j1939<'py>(
    py: Python<'py>,
    identifier: u32,
    data: &[u8],
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    let mut result = Ok(());
    j1939::decode(identifier, data, |quantity, rank, value: f64| {
        if result.is_ok() {
            result = values.set_item(Signal::from(quantity).column(), (value, rank));
        }
    });
    result.map(|()| values)
}
