//! The options that every estimate shares.

use cg_core::identify::arx::SampledArx;
use cg_core::{Channel, Word};
use cg_logs::estimate::{ChannelChoice, EstimateOptions, Method};
use pyo3::prelude::*;

use crate::error::value_error;

/// The options as Python passes them: a dict with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    method: String,
    channel: String,
    order: i64,
    model: String,
    speed_mps: Option<f64>,
    trailer_mass_kg: Option<f64>,
    trailer_mass_sd_kg: Option<f64>,
}

impl Options {
    /// Checks the options.
    pub(crate) fn checked(&self) -> PyResult<EstimateOptions> {
        let method: Method = word("method", &self.method)?;
        let channel = channel(&self.channel)?;
        let greatest = SampledArx::<f64>::GREATEST_ORDER;
        let order = usize::try_from(self.order)
            .ok()
            .filter(|order| (1..=greatest).contains(order))
            .ok_or_else(|| {
                value_error(format!("order is {}: it must be from 1 to {greatest}", self.order))
            })?;
        Ok(EstimateOptions {
            variant: word("model", &self.model)?,
            method,
            order,
            channel,
            speed_mps: positive("speed_mps", self.speed_mps)?,
            trailer_mass_kg: positive("trailer_mass_kg", self.trailer_mass_kg)?,
            trailer_mass_sd_kg: not_negative("trailer_mass_kg", self.trailer_mass_sd_kg)?,
            ..EstimateOptions::default() // road and calibration are those of the vehicle
        })
    }
}

/// The value that a word names.
pub(crate) fn word<T: Word>(keyword: &str, text: &str) -> PyResult<T> {
    T::of_word(text).map_err(|_| {
        let words: Vec<String> =
            T::WORDS.iter().map(|(_, word, _)| format!("\"{word}\"")).collect();
        let known = match words.split_last() {
            Some((last, before)) if !before.is_empty() => {
                format!("{} or {last}", before.join(", "))
            }
            _ => words.concat(),
        };
        value_error(format!("{keyword} is {text:?}: it must be {known}"))
    })
}

/// The channel that a word names; `None` for both.
pub(crate) fn channel(text: &str) -> PyResult<Option<Channel>> {
    word::<ChannelChoice>("channel", text).map(Into::into)
}

/// Checks that an optional standard deviation is one.
fn not_negative(argument: &str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(number) if !(number.is_finite() && number >= 0.0) => Err(value_error(format!(
            "the standard deviation of {argument} is {number}: it must be finite and not negative"
        ))),
        _ => Ok(value),
    }
}

/// Checks that an optional number is positive.
pub(crate) fn positive(argument: &str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(number) if !(number.is_finite() && number > 0.0) => {
            Err(value_error(format!("{argument} is {number}: it must be positive and finite")))
        }
        _ => Ok(value),
    }
}
