//! The linear model: Tables 4.1 and 4.2, appendix C.

use nalgebra::DVector;
use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::printed::{Printed, thesis};
use super::row::Row;
use cg_vehicle::error::VehicleError;
use cg_vehicle::response::StateSpace;
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

pub(super) fn roots(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Table {
        poles: Vec<Vec<Printed>>,
        zeros: Vec<Vec<Printed>>,
        gain: Printed,
    }
    let printed: Table = thesis!("table_4_2.toml")?;
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
    let size = part(0).hypot(part(1));
    let far = |root: &&(f64, f64)| (root.0 - part(0)).hypot(root.1 - part(1));
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

/// The figures of appendix C are curves without numbers. The rows are the steady-state values of both
/// models per radian of steer.
pub(super) fn steady_values(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let note = "figures C.1 to C.10 are curves without numbers; ours are their steady-state values, in \
                ISO 8855 signs";
    let mut rows = Vec::new();
    let models = [("as printed", &base.as_printed), ("complete", &base.complete)];
    for (what, unit, row) in responses(&base.complete.state_space) {
        for (name, model) in models {
            let ours = model.state_space.steady(&row, 0.0)?;
            rows.push(Row::ours(table, format!("{what}, {unit}, {name}"), ours, note));
        }
    }
    for (name, model) in models {
        let slowest = model
            .state_space
            .to_trailer_roll()
            .poles()?
            .first()
            .map_or(f64::NAN, |pole| -1.0 / pole.0);
        let note = "time constant of the slowest poles, with which the curves settle";
        rows.push(Row::ours(table, format!("slowest decay, s, {name}"), slowest, note));
    }
    let model = &base.complete.state_space;
    let lateral = model.steady(&model.lateral_acceleration, model.lateral_feedthrough)?;
    let steer_deg = (0.2 * base.vehicle.gravity_mps2 / lateral).to_degrees();
    let note = "section 5.7 uses nearly 0.2 g and does not print the steer angle";
    rows.push(Row::ours(table, "road-wheel steer for 0.2 g, degrees, complete", steer_deg, note));
    Ok(rows)
}

/// Name with figure number, unit, and row of each response.
fn responses(model: &StateSpace) -> Vec<(String, &'static str, DVector<f64>)> {
    let named = |name: &str, unit, row: &DVector<f64>| (name.to_owned(), unit, row.clone());
    let mut responses = vec![
        named("C.1 tractor lateral velocity", "m/s per rad", &model.tractor_lateral_velocity),
        named("C.2 tractor yaw rate", "1/s", &model.tractor_yaw_rate),
        named("C.3 tractor roll", "rad/rad", &model.tractor_roll),
        named("C.4 trailer yaw rate", "1/s", &model.trailer_yaw_rate),
        named("C.5 trailer roll", "rad/rad", &model.trailer_roll),
    ];
    for (i, row) in model.axle_roll.iter().enumerate() {
        responses.push(named(&format!("C.{} axle {} roll", 6 + i, i + 1), "rad/rad", row));
    }
    responses
}
