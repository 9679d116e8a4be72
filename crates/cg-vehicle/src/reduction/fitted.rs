//! The best model of an order, fitted to the response itself.

use crate::error::VehicleError;
use crate::output_error::{raised, refine};
use crate::reduction::balanced::{Keep, balanced};
use crate::reduction::pade::pade;
use crate::system::{Rational, System};

/// For each order from 1 to `greatest_order`, the stable model whose response to `samples` is
/// closest to that of the system in the mean square, with the same value at s = 0.
///
/// The fit starts from balanced residualization, from the Padé approximant if it is stable, and
/// from the model of the order below. The best result is returned.
///
/// # Errors
/// As [`balanced()`].
pub fn fitted(
    system: &System,
    greatest_order: usize,
    samples: &[f64],
    interval_s: f64,
) -> Result<Vec<Rational>, VehicleError> {
    let response = system.response(samples, interval_s);
    let moments = system.moments(2 * greatest_order + 1)?;
    let mut found: Vec<Rational> = Vec::with_capacity(greatest_order);
    for order in 1..=greatest_order {
        let lower = found.last();
        found.push(one_order(system, (&moments, order, lower), samples, &response, interval_s)?);
    }
    Ok(found)
}

fn one_order(
    system: &System,
    (moments, order, lower): (&[f64], usize, Option<&Rational>),
    samples: &[f64],
    response: &[f64],
    interval_s: f64,
) -> Result<Rational, VehicleError> {
    let mut starts = vec![balanced(system, order, Keep::SteadyState)?.0.rational()?];
    if let Some(start) = pade(moments, order)
        && start.system().is_stable()?
    {
        starts.push(start);
    }
    if let Some(lower) = lower {
        let n = lower.denominator.len() - 1;
        // An additional pole of medium speed.
        #[allow(clippy::cast_precision_loss)] // an order
        let pole_radps = 2.0 * libm::pow(lower.denominator[0].abs(), 1.0 / n as f64);
        starts.push(raised(lower, pole_radps));
    }
    let mut best: Option<(Rational, f64)> = None;
    for start in &starts {
        let (model, left) = refine(start, samples, response, interval_s, Some(moments[0]))?;
        if best.as_ref().is_none_or(|(_, least)| left < *least) {
            best = Some((model, left));
        }
    }
    let none = || VehicleError::Model(format!("no model of order {order} fits"));
    best.map(|(model, _)| model).ok_or_else(none)
}
