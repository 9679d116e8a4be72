//! Arguments that are numbers, and their limits.

use cg_core::identify::arx::SampledArx;
use cg_plant::sensors;
use cg_vehicle::limits::{self, up_to};

/// The least speed, m/s, for which there is a linear model: it divides by the speed.
const LEAST_SPEED_MPS: f64 = 1e-3;

pub(crate) fn number(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
        .ok_or_else(|| "expected a number".to_owned())
}

fn at_most(value: f64, greatest: f64) -> Result<f64, String> {
    if value <= greatest { Ok(value) } else { Err(format!("must be at most {greatest}")) }
}

pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| {
        if value >= 0.0 { Ok(value) } else { Err("must not be negative".to_owned()) }
    })
}

/// A number between these limits, both included.
fn within(text: &str, least: f64, greatest: f64) -> Result<f64, String> {
    number(text).and_then(|value| {
        if (least..=greatest).contains(&value) {
            Ok(value)
        } else {
            Err(format!("must lie between {least} and {greatest}"))
        }
    })
}

pub(crate) fn decibels(text: &str) -> Result<f64, String> {
    within(text, -sensors::GREATEST_SNR_DB, sensors::GREATEST_SNR_DB)
}

pub(crate) fn height_m(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_HEIGHT_M)
}

pub(crate) fn trailer_mass_kg(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_TRAILER_MASS_KG)
}

pub(crate) fn payload_kg(text: &str) -> Result<f64, String> {
    at_most(not_negative(text)?, limits::GREATEST_TRAILER_MASS_KG)
}

pub(crate) fn payload_behind_hitch_m(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_PAYLOAD_BEHIND_HITCH_M)
}

pub(crate) fn speed_mps(text: &str) -> Result<f64, String> {
    let speed_mps = up_to(number(text)?, limits::GREATEST_SPEED_MPS)?;
    if speed_mps >= LEAST_SPEED_MPS {
        Ok(speed_mps)
    } else {
        Err(format!("must be at least {LEAST_SPEED_MPS}"))
    }
}

pub(crate) fn steer_rad(text: &str) -> Result<f64, String> {
    within(text, -limits::GREATEST_STEER_RAD, limits::GREATEST_STEER_RAD)
}

pub(crate) fn rate_hz(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_RATE_HZ)
}

pub(crate) fn duration_s(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_DURATION_S)
}

/// A positive number up to 1 g.
pub(crate) fn lateral_g(text: &str) -> Result<f64, String> {
    up_to(number(text)?, 1.0)
}

pub(crate) fn gate_m(text: &str) -> Result<f64, String> {
    within(text, 1.0, 1000.0)
}

pub(crate) fn step_rate(text: &str) -> Result<f64, String> {
    up_to(number(text)?, limits::GREATEST_STEP_RATE_PER_S)
}

pub(crate) fn speed_change(text: &str) -> Result<f64, String> {
    within(text, 0.0, 0.5)
}

/// An angle of at least one degree in either direction, because a turn has a side.
pub(crate) fn turn_deg(text: &str) -> Result<f64, String> {
    within(text, -360.0, 360.0).and_then(|value| {
        if value.abs() >= 1.0 {
            Ok(value)
        } else {
            Err("must be at least 1 or at most -1".to_owned())
        }
    })
}

pub(crate) fn radius_m(text: &str) -> Result<f64, String> {
    within(text, 10.0, 10_000.0)
}

pub(crate) fn offset_rad(text: &str) -> Result<f64, String> {
    within(text, -sensors::GREATEST_OFFSET_RAD, sensors::GREATEST_OFFSET_RAD)
}

pub(crate) fn quantisation_rad(text: &str) -> Result<f64, String> {
    within(text, 0.0, sensors::GREATEST_QUANTISATION_RAD)
}

pub(crate) fn delay_s(text: &str) -> Result<f64, String> {
    within(text, 0.0, sensors::GREATEST_DELAY_S)
}

/// The upper limit depends on the sampling rate; the library checks it.
pub(crate) fn jitter_s(text: &str) -> Result<f64, String> {
    not_negative(text)
}

pub(crate) fn share(text: &str) -> Result<f64, String> {
    within(text, 0.0, sensors::GREATEST_DROP_OUT)
}

/// The order of a classical ARX.
pub(crate) fn order(text: &str) -> Result<usize, String> {
    let greatest = SampledArx::<f64>::GREATEST_ORDER;
    match text.parse() {
        Ok(order) if (1..=greatest).contains(&order) => Ok(order),
        _ => Err(format!("expected a whole number from 1 to {greatest}")),
    }
}

pub(crate) fn share_of_threshold(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(share),
        _ => Err("expected a share of the threshold above 0 and up to 1".to_owned()),
    }
}
