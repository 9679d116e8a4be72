//! Table 5.9: heights by order of the ARX model and noise, on the log of the nonlinear plant.

use serde::Deserialize;

use super::baseline::{Baseline, METERS_PER_INCH, Options};
use super::monte_carlo::{Experiment, ScorePercent};
use super::nonlinear::{Known, Procedures};
use super::printed::{Printed, thesis};
use super::row::Row;
use super::solved::bias_percent;
use super::study::score_rows;
use cg_vehicle::error::VehicleError;

/// The plant, in words.
const PLANT: &str =
    "our nonlinear plant with measured springs and tires, calibrated on another log";
/// The criterion without noise, %.
const FLOOR: (f64, &str) = (0.2, "0.2 points: the error of the thesis's own 0 % row in Table 5.10");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table59 {
    snr_db: Vec<u32>,
    order: Vec<Order>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Order {
    height_in: Vec<Printed>,
    height_m: Vec<Printed>,
    bias_percent: Vec<Printed>,
}

/// Order 1–5, all noises, and the project's own procedure on the same draws.
pub(super) fn by_order(
    table: &'static str,
    base: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table59 = thesis!("table_5_9.toml")?;
    let known = Known::new(base)?;
    let log = known.log(&known.vehicle, known.height_m())?;
    let procedures = known.calibrated(&known.vehicle)?;
    let cell = Cell { log: &log, procedures: &procedures, options };
    let mut rows = Vec::new();
    for (i, column) in printed.order.iter().enumerate() {
        let order = i + 1;
        let clean = cell.thesis(order, None);
        if let (Some(bias), Some(draw)) = (clean.bias, column.bias_percent.first()) {
            let item = format!("order {order}, no noise: ARX error, %");
            let row = Row::against(table, item, draw, bias, PLANT).not_comparable();
            rows.push(row.within(FLOOR.0, FLOOR.1));
        }
        for (&snr_db, draw) in printed.snr_db.iter().zip(column.bias_percent.iter().skip(1)) {
            let name = format!("order {order}, {snr_db} dB: ARX");
            let score = cell.thesis(order, Some(snr_db));
            rows.extend(score_rows(table, &name, Some(draw), &score, (PLANT, options)));
        }
    }
    let clean = cell.ours(None).bias;
    let item = "any order, no noise: filtered error, %";
    rows.extend(
        clean.map(|bias| Row::ours(table, item, bias, format!("not in the thesis; {PLANT}"))),
    );
    for &snr_db in &printed.snr_db {
        let name = format!("any order, {snr_db} dB: filtered");
        rows.extend(score_rows(table, &name, None, &cell.ours(Some(snr_db)), (PLANT, options)));
    }
    rows.extend(printed_biases(table, base, &printed));
    Ok(rows)
}

/// The cells of the table.
struct Cell<'a> {
    log: &'a Experiment,
    procedures: &'a Procedures,
    options: &'a Options,
}

impl Cell<'_> {
    fn thesis(&self, order: usize, snr_db: Option<u32>) -> ScorePercent {
        self.log.score(snr_db.map(f64::from), self.options, |roll, _| {
            self.procedures.thesis_percent(order, &self.log.steer, roll)
        })
    }

    fn ours(&self, snr_db: Option<u32>) -> ScorePercent {
        self.log.score(snr_db.map(f64::from), self.options, |roll, _| {
            self.procedures.ours_percent(&self.log.steer, roll)
        })
    }
}

/// Checks the printed biases and meters against the printed heights.
fn printed_biases(table: &'static str, base: &Baseline, printed: &Table59) -> Vec<Row> {
    let (mut biases, mut meters) = (0.0_f64, 0.0_f64);
    for order in &printed.order {
        for ((height_in, height_m), bias) in
            order.height_in.iter().zip(&order.height_m).zip(&order.bias_percent)
        {
            let ours = bias_percent(height_in.value, base.true_height_in());
            biases = biases.max((ours - bias.value).abs());
            let ours_m = height_in.value * METERS_PER_INCH;
            meters = meters.max((ours_m - height_m.value).abs());
        }
    }
    let note =
        "between the 35 printed values and those computed from the printed heights: rounding only";
    vec![
        Row::ours(table, "greatest difference of a bias, %", biases, note),
        Row::ours(table, "greatest difference of a height, m", meters, note),
    ]
}
