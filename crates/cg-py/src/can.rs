//! `decode_j1939`: the signals of a CAN frame, by the table of `cg_core::j1939`.

use cg_core::j1939::{
    FRONT_AXLE_SPEED, LATERAL_ACCELERATION, ROLL, ROLL_FINE, SPEED, STEERING_WHEEL_ANGLE, Signal,
    TRAILER_AXLE_LOAD, TRAILER_MASS, YAW_RATE, pgn_of,
};
use cg_vehicle::log::Signal as Column;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What each J1939 signal is in a log, the better source of a signal first. SSI's roll angle comes
/// from an accelerometer inclinometer, SSI2's from a roll sensor.
const SIGNALS: [(Signal, Column); 9] = [
    (STEERING_WHEEL_ANGLE, Column::SteeringWheel),
    (YAW_RATE, Column::YawRate),
    (LATERAL_ACCELERATION, Column::LateralAcceleration),
    (ROLL_FINE, Column::Roll),
    (ROLL, Column::Tilt),
    (SPEED, Column::Speed),
    (FRONT_AXLE_SPEED, Column::Speed),
    (TRAILER_MASS, Column::TrailerMass),
    (TRAILER_AXLE_LOAD, Column::TrailerMass),
];

/// The signals in a frame with a 29-bit identifier: a dict from SI column names to values; empty
/// where the group is not one of ours or nothing in it is available.
#[pyfunction]
#[pyo3(signature = (identifier, data, /))]
pub(crate) fn decode_j1939<'py>(
    py: Python<'py>,
    identifier: u32,
    data: &[u8],
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    let pgn = pgn_of(identifier);
    for (signal, column) in SIGNALS.iter().filter(|(signal, _)| signal.pgn == pgn) {
        if let Some(value) = signal.decode::<f64>(data) {
            values.set_item(column.column(), value)?;
        }
    }
    Ok(values)
}
