//! Table 5.10: softer or stiffer springs of the drive and trailer axles.

use serde::Deserialize;

use super::baseline::{Baseline, METERS_PER_INCH, Options};
use super::compensated::printed_compensation;
use super::nonlinear::{Known, with_springs};
use super::printed::{Printed, thesis};
use super::row::Row;
use super::solved::{bias_percent, percent, solved};
use cg_vehicle::error::VehicleError;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table510 {
    #[serde(rename = "remark")]
    _remark: String,
    row: Vec<Springs>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Springs {
    stiffness_percent: i32,
    baseline: Estimate,
    numerator: Vec<Printed>,
    denominator: Vec<Printed>,
    updated: Estimate,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Estimate {
    height_in: Printed,
    height_m: Printed,
    bias_percent: Printed,
}

pub(super) fn table(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table510 = thesis!("table_5_10.toml")?;
    let known = Known::new(base)?;
    let mut rows = Vec::new();
    for springs in &printed.row {
        rows.extend(from_print(table, base, springs)?);
        rows.extend(own(table, &known, springs)?);
    }
    Ok(rows)
}

fn name(percent: i32) -> String {
    if percent == 0 { "0 %".to_owned() } else { format!("{percent:+} %") }
}

/// The same with this project's nonlinear plant, whose springs are scaled: before and after a
/// calibration on another log of the same truck, by the thesis's procedure and by ours.
fn own(
    table: &'static str,
    known: &Known<'_>,
    springs: &Springs,
) -> Result<Vec<Row>, VehicleError> {
    let name = name(springs.stiffness_percent);
    let truck = with_springs(&known.vehicle, 1.0 + f64::from(springs.stiffness_percent) / 100.0);
    let (log, height_m) = (known.log(&truck, known.height_m())?, known.height_m());
    let before = known.calibrated(&known.vehicle)?.errors_percent(&log, height_m)?;
    let calibrated = known.calibrated(&truck)?;
    let function = calibrated.function.clone();
    let after = calibrated.errors_percent(&log, height_m)?;
    let item = |what: &str| format!("{name}: own plant, {what}");
    let plant = "nonlinear plant with scaled measured springs of drive and trailer axles; rounded step of \
                 0.19 g, noise-free; calibrated on one of 0.15 g and another rate";
    let mut rows = Vec::new();
    for (what, printed, [thesis, ours]) in [
        ("baseline", &springs.baseline.bias_percent, before),
        ("updated", &springs.updated.bias_percent, after),
    ] {
        let value = printed.corrected_value();
        let printed = Printed { value, misprint: None, ..printed.clone() };
        let item_of = |by: &str| item(&format!("bias, {what} {by}, %"));
        rows.push(percent(Row::against(table, item_of("F(s), ARX"), &printed, thesis, plant)));
        let note = "not in the thesis: complete model, R_c from the same log, filtered identifier";
        rows.push(Row::ours(table, item_of("R_c, filtered"), ours, note));
    }
    let sides = [("b", &springs.numerator, &function.function.numerator)].into_iter().chain([(
        "a",
        &springs.denominator,
        &function.function.denominator,
    )]);
    for (letter, printed, ours) in sides {
        for (k, (printed, ours)) in printed.iter().zip(ours).enumerate() {
            let item = item(&format!("F(s) {letter}{k}"));
            rows.push(Row::against(table, item, printed, *ours, plant));
        }
    }
    Ok(rows)
}

/// Both heights belong to one measured ratio `R_i`. The height with the baseline's compensation gives
/// `R_i`, and `R_i` with the DC gain of the updated compensation gives the other height.
fn from_print(
    table: &'static str,
    base: &Baseline,
    springs: &Springs,
) -> Result<Vec<Row>, VehicleError> {
    let line = &base.printed_line;
    let name = name(springs.stiffness_percent);
    let (baseline, updated) = (&springs.baseline, &springs.updated);
    let ratio = printed_compensation()? * line.ratio_at(baseline.height_in.value);
    let compensation = match (springs.numerator.first(), springs.denominator.first()) {
        (Some(numerator), Some(denominator)) => numerator.value / denominator.value,
        _ => return Err(VehicleError::Model("Table 5.10: an empty F(s)".to_owned())),
    };
    let height_in = solved(line, ratio, compensation)?;
    let note = "not printed: from the height with the baseline's compensation, eqs. 5.17 to 5.20";
    let mut rows = vec![
        Row::ours(table, format!("{name}: R_i"), ratio, note),
        Row::ours(
            table,
            format!("{name}: updated R_c"),
            compensation,
            "not printed: from the printed coefficients",
        ),
    ];
    let note = "from R_i with the updated R_c";
    let item = format!("{name}: h, updated R_c, in");
    rows.push(Row::beside(table, item, &updated.height_in, height_in).noted(note));
    for (what, estimate) in [("baseline", baseline), ("updated", updated)] {
        let note = "from the printed height in inches";
        let height_m = estimate.height_in.value * METERS_PER_INCH;
        let bias = bias_percent(estimate.height_in.value, base.true_height_in());
        let item = format!("{name}: h, {what} R_c, m");
        rows.push(Row::beside(table, item, &estimate.height_m, height_m).noted(note));
        let item = format!("{name}: bias, {what} R_c, %");
        rows.push(percent(Row::beside(table, item, &estimate.bias_percent, bias)));
    }
    Ok(rows)
}
