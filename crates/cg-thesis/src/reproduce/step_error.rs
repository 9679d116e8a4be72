//! Errors of the reductions (Table 5.3) in the thesis's measure, also for other reduction methods.
//!
//! The thesis prints neither input nor measure. A mean square over ten seconds of the rounded step of
//! rate 1 gives the printed pattern, and no other rate does. The steer amplitude is the one that gives
//! the error printed for order 0; the other five errors then follow.

use super::baseline::Baseline;
use super::printed::Printed;
use super::row::Row;
use cg_vehicle::error::VehicleError;
use cg_vehicle::reduction::quality::{StepInput, h_infinity, step_error_degree2};
use cg_vehicle::reduction::{Keep, balanced, fitted, pade};
use cg_vehicle::system::{Rational, System};

/// One order more than in the thesis, to show its effect.
const GREATEST_ORDER: usize = 6;

/// Rows for reductions of the as-printed model with `compensation`, with the printed errors of orders
/// 0, 1, ….
pub(super) fn rows(
    table: &'static str,
    base: &Baseline,
    compensation: &Rational,
    printed: &[&Printed],
) -> Result<Vec<Row>, VehicleError> {
    let whole = base.as_printed.state_space.to_trailer_roll().then(&compensation.system());
    let moments = whole.moments(2 * GREATEST_ORDER + 1)?;
    let approximant = |order| {
        pade(&moments, order).map(|reduced| reduced.system()).ok_or_else(|| {
            VehicleError::Model(format!("the Padé approximant of order {order} does not exist"))
        })
    };
    let unit = StepInput { amplitude_rad: 1f64.to_radians(), rate_per_s: 1.0, duration_s: 10.0 };
    let first = printed.first().map_or(f64::NAN, |printed| printed.value);
    let amplitude_degrees = (first / step_error_degree2(&whole, &approximant(0)?, &unit)).sqrt();
    let input = StepInput { amplitude_rad: amplitude_degrees * unit.amplitude_rad, ..unit };
    let error = |reduced: &System| step_error_degree2(&whole, reduced, &input);

    let measure = "mean square over 10 s of the rounded step of rate 1; the steer amplitude is not \
                   printed and chosen such that order 0 agrees";
    let mut rows = Vec::new();
    for (order, printed) in printed.iter().enumerate() {
        let item = format!("order {order}: squared error, degree²");
        rows.push(Row::beside(table, item, printed, error(&approximant(order)?)).noted(measure));
    }
    let note = "not printed: follows from the squared error of order 0";
    rows.push(Row::ours(table, "steer amplitude, degrees", amplitude_degrees, note));
    let fits = fitted(&whole, GREATEST_ORDER, &input.samples(), StepInput::INTERVAL_S)?;
    for (order, fit) in (1..).zip(&fits) {
        let (residualised, _) = balanced(&whole, order, Keep::SteadyState)?;
        let (truncated, _) = balanced(&whole, order, Keep::HighFrequency)?;
        for (method, reduced) in [
            ("Padé", approximant(order)?),
            ("balanced truncation", truncated),
            ("balanced residualization", residualised),
            ("fitted", fit.system()),
        ] {
            rows.extend(other(
                table,
                &format!("order {order}, {method}"),
                &whole,
                &reduced,
                error,
            )?);
        }
    }
    Ok(rows)
}

/// Squared and H∞ error of one reduction.
fn other(
    table: &'static str,
    name: &str,
    whole: &System,
    reduced: &System,
    error: impl Fn(&System) -> f64,
) -> Result<Vec<Row>, VehicleError> {
    if !reduced.is_stable()? {
        let note = "unstable: reported, never used; 1 means unstable";
        return Ok(vec![Row::ours(table, format!("{name}: unstable"), 1.0, note)]);
    }
    let norm = h_infinity(&whole.minus(reduced))?;
    Ok(vec![
        Row::ours(table, format!("{name}: error, degree²"), error(reduced), "same input"),
        Row::ours(table, format!("{name}: H-infinity error"), norm, "rad of roll per rad of steer"),
    ])
}
