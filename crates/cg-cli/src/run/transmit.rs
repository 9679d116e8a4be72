//! Results on the CAN bus as Proprietary B frames (`fixtures/can/cg_height.dbc`).

use cg_core::signal::j1939::{
    CG_HEIGHT, CG_HEIGHT_SD, CG_MANEUVERS, CG_MARGIN, CG_REQUESTED_SPEED, CG_STATUS, CG_THRESHOLD,
    CG_WARNING_LEVEL, NOT_AVAILABLE,
};

use super::events::Status;

/// Time between two frames, µs.
pub(crate) const CYCLE_US: u64 = 100_000;

/// Identifier and data of the frame with this status.
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
        // A standard deviation above the range of the signal is sent as the greatest value, not as
        // unknown.
        (CG_HEIGHT_SD, known(status.result.height_sd_m.map(|sd| sd.min(1.25)))),
        (
            CG_THRESHOLD,
            known(status.result.static_rollover_threshold_g.map(|limit| limit.min(1.25))),
        ),
        (CG_MARGIN, known(status.margin_g.map(|margin| margin.clamp(-1.25, 1.25)))),
        (CG_WARNING_LEVEL, level),
        (CG_STATUS, code),
        (CG_MANEUVERS, f64::from(status.result.maneuvers.min(250))),
    ] {
        signal.encode(value, &mut data);
    }
    (CG_HEIGHT.identifier(source), data)
}

/// Identifier and data of the frame with the requested speed, which is not available without a request.
pub(crate) fn request(status: &Status, source: u8) -> (u32, [u8; 8]) {
    let mut data = NOT_AVAILABLE;
    CG_REQUESTED_SPEED.encode(status.requested_speed_mps.unwrap_or(f64::NAN), &mut data);
    (CG_REQUESTED_SPEED.identifier(source), data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::events::{Counters, Result};

    fn status(result: Result, margin_g: Option<f64>) -> Status {
        Status {
            state: "straight",
            present: Vec::new(),
            missing: Vec::new(),
            result,
            load_since_s: None,
            height_restored: false,
            lateral_acceleration_g: None,
            margin_g,
            warning_level: 0,
            requests_speed: false,
            requested_speed_mps: None,
            samples: 0,
            counters: Counters::default(),
        }
    }

    #[test]
    fn what_is_not_known_is_not_available() {
        let (identifier, data) = frame(&status(Result::default(), None), 0xD0);
        assert_eq!(identifier, 0x18FF_10D0);
        assert_eq!(data, [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0]);
    }

    /// 15 m/s are 54 km/h, 256 bits each.
    #[test]
    fn a_request_is_a_speed_or_not_available() {
        let asked = |requested_speed_mps| {
            request(&Status { requested_speed_mps, ..status(Result::default(), None) }, 0xD0)
        };
        let (identifier, data) = asked(None);
        assert_eq!((identifier, data), (0x18FF_11D0, [0xFF; 8]));
        let (_, data) = asked(Some(15.0));
        assert_eq!(
            (u16::from_le_bytes([data[0], data[1]]), data[2..].to_vec()),
            (54 * 256, vec![0xFF; 6])
        );
    }

    #[test]
    fn the_status_says_whether_a_signal_is_missing() {
        let known = Result { height_m: Some(1.9), ..Result::default() };
        for (result, missing, code) in [
            (Result::default(), vec![], 0),
            (known.clone(), vec![], 1),
            (known, vec!["roll"], 2),
            (Result::default(), vec!["roll"], 3),
        ] {
            let (_, data) = frame(&Status { missing, ..status(result, None) }, 0xD0);
            assert_eq!(data[6], code);
        }
    }

    #[test]
    fn values_that_do_not_fit_are_the_nearest_that_do() {
        let result = Result {
            height_m: Some(1.9),
            height_sd_m: Some(3.0),
            static_rollover_threshold_g: Some(2.0),
            maneuvers: 1000,
            ..Result::default()
        };
        let (_, data) = frame(&status(result, Some(-7.0)), 0xD0);
        assert_eq!(data, [0x6C, 0x07, 250, 250, 0, 0, 1, 250]);
    }
}
