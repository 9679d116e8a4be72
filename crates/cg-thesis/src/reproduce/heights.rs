//! Heights from DC ratios: eq. 5.17, Tables 5.6, 5.7 and 5.11.

use cg_core::RatioLine;
use serde::Deserialize;

use super::baseline::{Baseline, METERS_PER_INCH, Options};
use super::compensated::printed_compensation;
use super::identified::{by_rate_ratio, noise_free_ratio};
use super::nonlinear::Known;
use super::printed::{Printed, thesis};
use super::row::Row;
use super::solved::{Heights, bias_percent, percent, solved};
use super::study::beside_draws;
use cg_vehicle::error::VehicleError;

#[allow(clippy::unnecessary_wraps)] // one signature for all tables
pub(super) fn ratio_line(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let (printed, ours) = (&base.equation_5_17, &base.as_printed.ratio[0]);
    let height_in = printed.true_height_in.value;
    let [a0, a1, b0, b1] = [&printed.a0, &printed.a1, &printed.b0, &printed.b1];
    let [a_at_height, b_at_height] = [at_height(a0, a1, height_in), at_height(b0, b1, height_in)];
    let note = "from the vehicle file, as-printed model; only the ratios of the four printed numbers \
                have a meaning";
    let mut rows = Vec::new();
    for (item, printed, ours) in [
        ("a1/a0, 1/in", quotient(a1, a0), ours.a1 / ours.a0 * METERS_PER_INCH),
        ("b1/b0, 1/in", quotient(b1, b0), ours.b1 / ours.b0 * METERS_PER_INCH),
        ("a0/b0", quotient(a0, b0), -ours.a0 / ours.b0),
        (
            "A0/B0 at 77.68 in",
            quotient(&a_at_height, &b_at_height),
            -ours.ratio_at(height_in * METERS_PER_INCH),
        ),
    ] {
        rows.push(Row::against(table, item, &printed, ours, note));
    }
    let complete = &base.complete.ratio[0];
    let height_m = height_in * METERS_PER_INCH;
    let note = "not in the thesis: with the fifth wheel's moment and inertias about the c.g.";
    rows.push(Row::ours(table, "A0/B0 at 77.68 in, complete", -complete.ratio_at(height_m), note));
    let sensitivity = |line: &RatioLine<f64>, h: f64| h * line.relative_slope_at(h);
    let note = "not in the thesis: percent of ratio per percent of height";
    let at_height = sensitivity(&base.printed_line, height_in);
    rows.push(Row::ours(table, "d ln R/d ln h at 77.68 in", at_height, note));
    Ok(rows)
}

/// A quotient of two printed numbers, whose rounding is the sum of their relative roundings.
fn quotient(a: &Printed, b: &Printed) -> Printed {
    let value = a.value / b.value;
    let relative = a.rounding / a.value.abs() + b.rounding / b.value.abs();
    Printed { value, rounding: relative * value.abs(), misprint: None }
}

/// `slope h + constant` of two printed numbers.
fn at_height(constant: &Printed, slope: &Printed, height: f64) -> Printed {
    Printed {
        value: slope.value * height + constant.value,
        rounding: slope.rounding * height + constant.rounding,
        misprint: None,
    }
}

const FROM_RATIO: &str = "from the printed four-digit ratio through eqs. 5.17 to 5.20";
const FROM_HEIGHT: &str = "from the printed height in inches";

/// Height in inches and meters, and bias, from a printed ratio.
fn height_rows(
    table: &'static str,
    base: &Baseline,
    name: &str,
    ratio: &Printed,
    [height_in, height_m, bias]: [&Printed; 3],
) -> Result<Vec<Row>, VehicleError> {
    // The thesis divides by eq. 5.19 as printed: 1.4894.
    let compensation = (printed_compensation()? * 1e4).round() / 1e4;
    let ours_in = solved(&base.printed_line, ratio.value, compensation)?;
    let in_m = height_in.value * METERS_PER_INCH;
    let off = bias_percent(height_in.value, base.true_height_in());
    Ok(vec![
        Row::beside(table, format!("{name}: h, in"), height_in, ours_in).noted(FROM_RATIO),
        Row::beside(table, format!("{name}: h, m"), height_m, in_m).noted(FROM_HEIGHT),
        percent(Row::beside(table, format!("{name}: bias, %"), bias, off)).noted(FROM_HEIGHT),
    ])
}

pub(super) fn by_rate(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Heights = thesis!("tables_5_5_5_6.toml")?;
    let compensation = printed_compensation()?;
    let mut rows = Vec::new();
    for row in &printed.row {
        let name = format!("a = {}", row.condition);
        let heights = [&row.height_in, &row.height_m, &row.bias_percent];
        rows.extend(height_rows(table, base, &name, &row.ratio, heights)?);
        let ratio = by_rate_ratio(row.condition)?;
        let ours_in = solved(&base.printed_line, ratio, compensation)?;
        let note = "identified here from noise-free data: eq. 5.12's own ratio at every rate";
        let item = format!("{name}: h identified here, in");
        rows.push(Row::against(table, item, &row.height_in, ours_in, note));
    }
    Ok(rows)
}

pub(super) fn by_noise(
    table: &'static str,
    base: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Heights = thesis!("table_5_7.toml")?;
    let original = &printed.original;
    let mut rows = Vec::new();
    if let (Some(height_in), Some(height_m), Some(bias)) =
        (&original.height_in, &original.height_m, &original.bias_percent)
    {
        let heights = [height_in, height_m, bias];
        rows.extend(height_rows(table, base, "no noise", &original.ratio, heights)?);
        let ours_in = solved(&base.printed_line, noise_free_ratio()?, printed_compensation()?)?;
        let note = "identified here from noise-free data";
        rows.push(Row::against(table, "no noise: h identified here, in", height_in, ours_in, note));
    }
    for row in &printed.row {
        let name = format!("{} dB", row.condition);
        let heights = [&row.height_in, &row.height_m, &row.bias_percent];
        rows.extend(height_rows(table, base, &name, &row.ratio, heights)?);
    }
    let draws: Vec<_> = printed.row.iter().map(|row| (row.condition, &row.bias_percent)).collect();
    rows.extend(beside_draws(table, base, options, &draws)?);
    Ok(rows)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table511 {
    row: Vec<OtherHeight>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OtherHeight {
    true_m: Printed,
    estimated_m: Printed,
    bias_percent: Printed,
}

/// The same heights on this project's nonlinear plant, by both procedures, which are calibrated on another
/// log at 1.973 m.
fn own_heights(
    table: &'static str,
    base: &Baseline,
    printed: &Table511,
) -> Result<Vec<Row>, VehicleError> {
    let known = Known::new(base)?;
    let plant = "nonlinear plant with measured springs and tires; rounded step of 0.19 g, noise-free; \
                 calibrated at 1.973 m on one of 0.15 g and another rate";
    let mut rows = Vec::new();
    for row in &printed.row {
        let true_m = row.true_m.corrected_value();
        let log = known.log(&known.vehicle, true_m)?;
        let [thesis, ours] = known.calibrated(&known.vehicle)?.errors_percent(&log, true_m)?;
        let item = |what: &str| format!("true {true_m:.3} m: own plant, bias, {what}, %");
        let thesis = Row::against(table, item("F(s) and ARX"), &row.bias_percent, thesis, plant);
        rows.push(percent(thesis));
        let note = "not in the thesis: complete model, R_c from the same log, filtered identifier";
        rows.push(Row::ours(table, item("complete and filtered"), ours, note));
    }
    Ok(rows)
}

/// The gains of the Yaw/Roll program follow from the printed heights. Both models of this project then
/// estimate the heights from these gains, each with its compensation fixed at 1.973 m.
pub(super) fn over_range(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table511 = thesis!("table_5_11.toml")?;
    let compensation = printed_compensation()?;
    let gain = |estimated_m: f64| {
        -compensation * base.printed_line.ratio_at(estimated_m / METERS_PER_INCH)
    };
    let calibration_m = base.vehicle.trailer.reference_cg_height_m;
    let calibrated = printed
        .row
        .iter()
        .find(|row| (row.true_m.corrected_value() - calibration_m).abs() < 1e-3)
        .ok_or_else(|| VehicleError::Model("Table 5.11 has no row at 1.973 m".to_owned()))?;
    let at_m = calibrated.true_m.corrected_value();
    let [as_printed, complete] = [&base.as_printed, &base.complete].map(|model| model.ratio[0]);
    let [for_printed, for_complete] = [as_printed, complete]
        .map(|line| gain(calibrated.estimated_m.corrected_value()) / line.ratio_at(at_m));
    let note = "R_c that the complete model needs at 1.973 m: nearly one";
    let mut rows = vec![
        Row::ours(table, "R_c, as printed", for_printed, "eq. 5.19 has 1.4894"),
        Row::ours(table, "R_c, complete", for_complete, note),
    ];
    for row in &printed.row {
        let true_m = row.true_m.corrected_value();
        let gain = gain(row.estimated_m.corrected_value());
        let name = format!("true {true_m:.3} m");
        let note = "from the printed estimated height through eqs. 5.17 to 5.20; ISO 8855";
        rows.push(Row::ours(table, format!("{name}: Yaw/Roll gain"), gain, note));
        for (model, line) in [("as printed", &as_printed), ("complete", &complete)] {
            let item = format!("{name}: gain, {model}");
            rows.push(Row::ours(table, item, line.ratio_at(true_m), "from the vehicle file"));
        }
        let found_m = solved(&as_printed, gain, for_printed)?;
        let found =
            Row::beside(table, format!("{name}: h, as printed, m"), &row.estimated_m, found_m);
        rows.push(found.noted("our as-printed model on the Yaw/Roll gain"));
        let bias = bias_percent(found_m, true_m);
        let item = format!("{name}: bias, as printed, %");
        rows.push(percent(Row::beside(table, item, &row.bias_percent, bias)));
        let found_m = solved(&complete, gain, for_complete)?;
        let item = format!("{name}: h, complete, m");
        rows.push(
            Row::beside(table, item, &row.true_m, found_m).noted("compared with the true height"),
        );
    }
    rows.extend(own_heights(table, base, &printed)?);
    Ok(rows)
}
