//! The options that every estimate shares.

use cg_core::Channel;
use cg_core::identify::arx::SampledArx;
use cg_logs::estimate::{EstimateOptions, Method};
use cg_vehicle::Variant;
use pyo3::prelude::*;

use crate::error::value_error;

/// The options as Python hands them over: a dict with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    method: String,
    channel: String,
    order: i64,
    model: String,
    speed_mps: Option<f64>,
    trailer_mass_kg: Option<f64>,
}

impl Options {
    /// The options checked.
    pub(crate) fn checked(&self) -> PyResult<EstimateOptions> {
        let method = method(&self.method)?;
        let channel = channel(&self.channel)?;
        let greatest = SampledArx::<f64>::GREATEST_ORDER;
        let order = usize::try_from(self.order)
            .ok()
            .filter(|order| (1..=greatest).contains(order))
            .ok_or_else(|| {
                value_error(format!("order is {}: it must be from 1 to {greatest}", self.order))
            })?;
        Ok(EstimateOptions {
            variant: variant(&self.model)?,
            method,
            order,
            channel,
            speed_mps: positive("speed_mps", self.speed_mps)?,
            trailer_mass_kg: positive("trailer_mass_kg", self.trailer_mass_kg)?,
        })
    }
}

/// The identification that `method` names.
pub(crate) fn method(method: &str) -> PyResult<Method> {
    match method {
        "filtered" => Ok(Method::Filtered),
        "arx" => Ok(Method::Arx),
        "gain" => Ok(Method::Gain),
        other => Err(unknown("method", other, "\"filtered\", \"arx\" or \"gain\"")),
    }
}

/// The channel that `channel` names; `None` for both.
pub(crate) fn channel(channel: &str) -> PyResult<Option<Channel>> {
    match channel {
        "auto" => Ok(None),
        "steer" => Ok(Some(Channel::Steer)),
        "lateral-acceleration" => Ok(Some(Channel::LateralAcceleration)),
        other => {
            let known = "\"auto\", \"steer\" or \"lateral-acceleration\"";
            Err(unknown("channel", other, known))
        }
    }
}

/// The equations that `model` names.
pub(crate) fn variant(model: &str) -> PyResult<Variant> {
    match model {
        "complete" => Ok(Variant::Complete),
        "as-printed" => Ok(Variant::AsPrinted),
        other => Err(unknown("model", other, "\"complete\" or \"as-printed\"")),
    }
}

pub(crate) fn unknown(argument: &str, value: &str, known: &str) -> PyErr {
    value_error(format!("{argument} is {value:?}: it must be {known}"))
}

/// A number that must be positive if it is there.
pub(crate) fn positive(argument: &str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(number) if !(number.is_finite() && number > 0.0) => {
            Err(value_error(format!("{argument} is {number}: it must be positive and finite")))
        }
        _ => Ok(value),
    }
}
