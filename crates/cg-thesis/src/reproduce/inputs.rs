//! The inputs that Tables 2.1 to 2.8 and appendix A print, beside those of the vehicle files.

use serde::Deserialize;
use toml::Value;

use super::baseline::{Baseline, Options};
use super::printed::{Printed, thesis};
use super::row::Row;
use cg_vehicle::error::VehicleError;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Inputs {
    value: Vec<Input>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    table: String,
    item: String,
    printed: Printed,
    /// Keys and indices, joined by dots.
    path: String,
    /// The unit of the file in that of the thesis.
    times: f64,
}

pub(super) fn table(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let inputs: Inputs = thesis!("inputs.toml")?;
    let leaf = parsed(
        include_str!("../../fixtures/vehicles/baseline-printed.toml"),
        "fixtures/vehicles/baseline-printed.toml",
    )?;
    let air = parsed(
        include_str!("../../fixtures/vehicles/air-printed.toml"),
        "fixtures/vehicles/air-printed.toml",
    )?;
    let row = |input: &Input| {
        let is_air = matches!(input.table.as_str(), "2.7" | "2.8");
        let (file, name) =
            if is_air { (&air, "air-printed.toml") } else { (&leaf, "baseline-printed.toml") };
        let found = number(file, &input.path).ok_or_else(|| {
            VehicleError::Model(format!("fixtures/vehicles/{name} has no number {}", input.path))
        })?;
        let item = format!("Table {}: {}", input.table, input.item);
        let row = Row::beside(table, item, &input.printed, found * input.times);
        Ok(row.noted(format!("from fixtures/vehicles/{name}")))
    };
    inputs.value.iter().map(row).collect()
}

fn parsed(text: &str, name: &str) -> Result<Value, VehicleError> {
    toml::from_str(text).map_err(|source| VehicleError::syntax(name, &source))
}

/// The number at a path such as `spring.0.compression_n.3`.
fn number(file: &Value, path: &str) -> Option<f64> {
    let step = |at: &'_ Value, key: &str| match (key.parse::<usize>(), at) {
        (Ok(index), Value::Array(list)) => list.get(index).cloned(),
        _ => at.get(key).cloned(),
    };
    let found = path.split('.').try_fold(file.clone(), |at, key| step(&at, key))?;
    found.as_float()
}
