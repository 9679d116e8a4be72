//! Results on the bus: one frame of Proprietary B (`fixtures/can/cg_height.dbc`).

use cg_core::j1939::{
    CG_HEIGHT, CG_HEIGHT_SD, CG_MANEUVERS, CG_MARGIN, CG_STATUS, CG_THRESHOLD, CG_WARNING_LEVEL,
    NOT_AVAILABLE,
};

use super::events::Status;

/// Time between two frames, µs.
pub(crate) const CYCLE_US: u64 = 100_000;

/// Identifier and data of the frame that says this.
pub(crate) fn frame(status: &Status, source: u8) -> (u32, [u8; 8]) {
    let mut data = NOT_AVAILABLE;
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let code = match (status.result.height_m, status.missing.is_empty()) {
        (None, true) => 0.0,
        (Some(_), true) => 1.0,
        (Some(_), false) => 2.0,
        (None, false) => 3.0,
    };
    #[allow(clippy::cast_precision_loss)] // a few levels
    let level = status.warning_level as f64;
    for (signal, value) in [
        (CG_HEIGHT, known(status.result.height_m)),
        // A greater one is the greatest that fits, not unknown.
        (CG_HEIGHT_SD, known(status.result.height_sd_m).min(1.25)),
        (CG_THRESHOLD, known(status.result.static_rollover_threshold_g).min(1.25)),
        (CG_MARGIN, known(status.margin_g).clamp(-1.25, 1.25)),
        (CG_WARNING_LEVEL, level),
        (CG_STATUS, code),
        (CG_MANEUVERS, f64::from(status.result.maneuvers.min(250))),
    ] {
        signal.encode(value, &mut data);
    }
    (CG_HEIGHT.identifier(source), data)
}
