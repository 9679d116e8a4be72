//! What the tables start from.

use cg_core::RatioLine;
use serde::Deserialize;

use super::printed::{Printed, thesis};
use cg_vehicle::error::VehicleError;
use cg_vehicle::linear::Laden;
use cg_vehicle::{LinearModel, Variant, Vehicle};

/// Meters per inch, the thesis's unit of height.
pub(super) const METERS_PER_INCH: f64 = 0.0254;

/// Options of [`table`](fn@super::table).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Draws of the noise in each cell of a Monte-Carlo table.
    pub runs: u32,
    /// Seed of the first draw.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { runs: 1000, seed: 1 }
    }
}

/// The data from which the tables are computed.
pub(super) struct Baseline {
    pub(super) vehicle: Vehicle,
    /// The model of appendix B at the reference load and speed.
    pub(super) as_printed: LinearModel,
    /// The same vehicle with all terms, and with tires that do not become softer in turns, as in the thesis.
    pub(super) complete: LinearModel,
    /// Eq. 5.17 as printed.
    pub(super) printed_line: RatioLine<f64>,
    pub(super) equation_5_17: Equation517,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Equation517 {
    pub(super) a0: Printed,
    pub(super) a1: Printed,
    pub(super) b0: Printed,
    pub(super) b1: Printed,
    pub(super) true_height_in: Printed,
}

impl Baseline {
    pub(super) fn new() -> Result<Self, VehicleError> {
        let text = include_str!("../../fixtures/vehicles/baseline.toml");
        let vehicle = Vehicle::parse(text, "fixtures/vehicles/baseline.toml")?;
        let model = |variant| {
            let laden = Laden::new(&vehicle, variant, vehicle.reference_load())?;
            LinearModel::of(&laden.with_tires_of_the_file(), vehicle.nominal_speed_mps)
        };
        let (as_printed, complete) = (model(Variant::AsPrinted)?, model(Variant::Complete)?);
        let line: Equation517 = thesis!("equation_5_17.toml")?;
        let printed_line = RatioLine {
            a0: line.a0.value,
            a1: line.a1.value,
            b0: line.b0.value,
            b1: line.b1.value,
        };
        Ok(Self { vehicle, as_printed, complete, printed_line, equation_5_17: line })
    }

    /// The height of the baseline's trailer, inches.
    pub(super) fn true_height_in(&self) -> f64 {
        self.equation_5_17.true_height_in.value
    }
}
