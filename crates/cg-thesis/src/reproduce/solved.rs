//! Heights from DC ratios, and the printed tables of both.

use cg_core::truck::ratio::solve_height;
use cg_core::{Measured, RatioLine};
use serde::Deserialize;

use super::printed::Printed;
use super::row::Row;
use cg_vehicle::error::VehicleError;

/// The height that follows from a ratio (eq. 5.20), in the unit of the line.
pub(super) fn solved(
    line: &RatioLine<f64>,
    ratio: f64,
    compensation: f64,
) -> Result<f64, VehicleError> {
    let exact = Measured::exact;
    let found = solve_height(line, exact(ratio), exact(compensation), 0.0);
    Ok(found.map_err(|error| VehicleError::Model(error.to_string()))?.value)
}

/// Error of a height in %.
pub(super) fn bias_percent(height: f64, true_height: f64) -> f64 {
    100.0 * (height / true_height - 1.0)
}

/// A row whose unit is percent: its difference is in percentage points, not relative.
pub(super) fn percent(row: Row) -> Row {
    row.relative_to(100.0).noted("difference in percentage points")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Original {
    pub(super) a0: Printed,
    pub(super) b0: Printed,
    pub(super) ratio: Printed,
    pub(super) height_in: Option<Printed>,
    pub(super) height_m: Option<Printed>,
    pub(super) bias_percent: Option<Printed>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Identified {
    #[serde(alias = "rate_per_s", alias = "snr_db")]
    pub(super) condition: u32,
    pub(super) a0: Printed,
    pub(super) b0: Printed,
    pub(super) ratio: Printed,
    pub(super) height_in: Printed,
    pub(super) height_m: Printed,
    pub(super) bias_percent: Printed,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Heights {
    pub(super) original: Original,
    pub(super) row: Vec<Identified>,
}
