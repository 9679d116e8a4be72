//! The linear model: Tables 4.1 and 4.2.

use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::printed::{Printed, thesis};
use super::row::Row;
use cg_vehicle::error::VehicleError;
use cg_vehicle::system::TransferFunction;

/// Steer to trailer roll of the as-printed model.
pub(super) fn as_printed(base: &Baseline) -> Result<TransferFunction, VehicleError> {
    let model = &base.as_printed.state_space;
    model.to_trailer_roll().transfer_function()
}

/// Numerator and denominator in ascending powers, with the thesis's sign of steer.
pub(super) fn ascending(function: &TransferFunction) -> (Vec<f64>, Vec<f64>) {
    let numerator = function.numerator.iter().rev().map(|a| -a).collect();
    (numerator, function.denominator.iter().rev().copied().collect())
}

/// One row for each coefficient, `A0 …` and `B0 …`.
pub(super) fn polynomial_rows(
    table: &'static str,
    what: &str,
    printed: (&[Printed], &[Printed]),
    ours: (&[f64], &[f64]),
    note: &str,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for (letter, printed, ours) in [("A", printed.0, ours.0), ("B", printed.1, ours.1)] {
        for (k, (printed, ours)) in printed.iter().zip(ours).enumerate() {
            rows.push(Row::against(table, format!("{what}{letter}{k}"), printed, *ours, note));
        }
    }
    rows
}

pub(super) fn coefficients(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Table {
        numerator: Vec<Printed>,
        denominator: Vec<Printed>,
    }
    let printed: Table = thesis!("table_4_1.toml")?;
    let ours = ascending(&as_printed(base)?);
    let note = "from the vehicle file, as-printed model";
    let sides = (&printed.numerator[..], &printed.denominator[..]);
    Ok(polynomial_rows(table, "", sides, (&ours.0, &ours.1), note))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table42 {
    poles: Vec<Vec<Printed>>,
    zeros: Vec<Vec<Printed>>,
    gain: Printed,
}

/// The printed poles and zeros of the upper half plane.
pub(super) fn printed_roots() -> Result<Vec<(f64, f64)>, VehicleError> {
    let printed: Table42 = thesis!("table_4_2.toml")?;
    let part = |root: &[Printed], k: usize| root.get(k).map_or(0.0, |part| part.value);
    let all = printed.poles.iter().chain(&printed.zeros);
    Ok(all.map(|root| (part(root, 0), part(root, 1))).collect())
}

pub(super) fn roots(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table42 = thesis!("table_4_2.toml")?;
    let ours = as_printed(base)?;
    let mut rows = Vec::new();
    for (name, printed, ours) in
        [("pole", &printed.poles, &ours.poles), ("zero", &printed.zeros, &ours.zeros)]
    {
        for (k, root) in printed.iter().enumerate() {
            rows.extend(root_rows(table, &format!("{name} {}", k + 1), root, ours));
        }
    }
    // The thesis's steer is positive to the right.
    rows.push(Row::beside(table, "gain", &printed.gain, -ours.gain));
    Ok(rows)
}

/// Real and imaginary part of the root nearest to a printed one.
fn root_rows(
    table: &'static str,
    name: &str,
    printed: &[Printed],
    ours: &[(f64, f64)],
) -> Vec<Row> {
    let part = |k: usize| printed.get(k).map_or(0.0, |part| part.value);
    let size = libm::hypot(part(0), part(1));
    let far = |root: &&(f64, f64)| libm::hypot(root.0 - part(0), root.1 - part(1));
    let Some(nearest) = ours.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else {
        return Vec::new();
    };
    let note = "error relative to the modulus";
    let parts = [(", real part, rad/s", nearest.0), (", imaginary part, rad/s", nearest.1)];
    let names = if printed.len() == 1 { [", rad/s", ""] } else { [parts[0].0, parts[1].0] };
    let mut rows = Vec::new();
    for (k, printed) in printed.iter().enumerate().take(2) {
        let row = Row::beside(table, format!("{name}{}", names[k]), printed, parts[k].1);
        rows.push(row.relative_to(size).noted(note));
    }
    rows
}
