//! The best model of an order: fitted to the response itself.

use crate::error::VehicleError;
use crate::output_error::refine;
use crate::reduction::{Keep, balanced, pade};
use crate::system::{Rational, System};

/// The stable model of this order whose response to `samples` is nearest in mean square to that
/// of the system, with the same value at s = 0. Started from balanced residualisation and from the
/// Padé approximant where that is stable; the better end counts.
///
/// # Errors
/// As [`balanced`].
pub fn fitted(
    system: &System,
    order: usize,
    samples: &[f64],
    interval_s: f64,
) -> Result<Rational, VehicleError> {
    let response = system.response(samples, interval_s);
    let moments = system.moments(2 * order + 1)?;
    let mut starts = vec![balanced(system, order, Keep::SteadyState)?.0.rational()?];
    if let Some(start) = pade(&moments, order)
        && start.system().is_stable()?
    {
        starts.push(start);
    }
    let mut best: Option<(Rational, f64)> = None;
    for start in &starts {
        let (model, left) = refine(start, samples, &response, interval_s, Some(moments[0]))?;
        if best.as_ref().is_none_or(|(_, least)| left < *least) {
            best = Some((model, left));
        }
    }
    let none = || VehicleError::Model(format!("no model of order {order} fits"));
    best.map(|(model, _)| model).ok_or_else(none)
}
