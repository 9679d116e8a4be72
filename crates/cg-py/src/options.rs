//! The options that every estimate shares.

use cg_core::identify::arx::SampledArx;
use cg_core::{Channel, Word};
use cg_logs::estimate::{ChannelChoice, EstimateOptions, Method, known_speed};
use cg_vehicle::{Vehicle, limits};
use pyo3::prelude::*;

use crate::error::{value_error, vehicle_error};

/// The options as Python passes them: a dict with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    #[pyo3(from_py_with = text)]
    method: String,
    #[pyo3(from_py_with = text)]
    channel: String,
    order: i64,
    #[pyo3(from_py_with = text)]
    model: String,
    speed_mps: Option<f64>,
    trailer_mass_kg: Option<f64>,
    trailer_mass_sd_kg: Option<f64>,
}

impl Options {
    /// Checks the options for a vehicle.
    pub(crate) fn checked(&self, vehicle: &Vehicle) -> PyResult<EstimateOptions> {
        let method: Method = word("method", &self.method)?;
        let channel = channel(&self.channel)?;
        let greatest = SampledArx::<f64>::GREATEST_ORDER;
        let order = usize::try_from(self.order)
            .ok()
            .filter(|order| (1..=greatest).contains(order))
            .ok_or_else(|| {
                value_error(format!("order is {}: it must be from 1 to {greatest}", self.order))
            })?;
        let options = EstimateOptions {
            variant: word("model", &self.model)?,
            method,
            order,
            channel,
            speed_mps: self.speed_mps,
            trailer_mass_kg: self.trailer_mass_kg,
            trailer_mass_sd_kg: not_negative("trailer_mass_kg", self.trailer_mass_sd_kg)?,
            ..EstimateOptions::default() // road and calibration are those of the vehicle
        };
        options.checked(vehicle).map_err(vehicle_error)
    }
}

/// A word as text; what is no text is shown by the message that it is no such [word].
pub(crate) fn text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.extract().or_else(|_| value.repr()?.extract())
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
pub(crate) fn not_negative(argument: &str, value: Option<f64>) -> PyResult<Option<f64>> {
    match value {
        Some(number) if !(number.is_finite() && number >= 0.0) => Err(value_error(format!(
            "the standard deviation of {argument} is {number}: it must be finite and not negative"
        ))),
        _ => Ok(value),
    }
}

/// Checks that an optional number is positive and not above its limit.
pub(crate) fn up_to(argument: &str, value: Option<f64>, greatest: f64) -> PyResult<Option<f64>> {
    let checked = value.map(|value| {
        limits::up_to(value, greatest)
            .map_err(|must| value_error(format!("{argument} is {value}: it {must}")))
    });
    checked.transpose()
}

/// Checks an optional speed of the truck.
pub(crate) fn speed(speed_mps: Option<f64>) -> PyResult<Option<f64>> {
    speed_mps.map(known_speed).transpose().map_err(vehicle_error)
}
