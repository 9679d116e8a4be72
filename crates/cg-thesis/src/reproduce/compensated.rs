//! Compensation and reduction of the transfer function: Tables 5.1–5.3, eqs. 5.12 and 5.19.
//!
//! The compensated transfer function is the recomputed as-printed one (Table 4.1) times the printed
//! F(s) of order 3. Its reductions are `[n/n]` Padé approximants, divided by the last quotient of the
//! continued fraction
//!
//! ```text
//!     T(s) = 1/(H1 + s/(H2 + s/(H3 + … + s/H(2n+1))))
//! ```
//!
//! like the printed ones. Eqs. 5.9–5.11 stop after `2n` quotients and give other models.

use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::nonlinear::Known;
use super::printed::{Printed, thesis, values};
use super::row::Row;
use super::step_error;
use super::transfer::{as_printed, ascending, polynomial_rows};
use cg_vehicle::error::VehicleError;
use cg_vehicle::reduction::pade;
use cg_vehicle::system::{Rational, System, multiplied};

/// Order of the compensation function that the thesis uses further on.
const ORDER: usize = 3;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table51 {
    compensation: Printed,
    function: Vec<Function>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Function {
    numerator: Vec<Printed>,
    denominator: Vec<Printed>,
    square_error_degree2: Printed,
}

impl Function {
    /// `F(0)`.
    fn dc_gain(&self) -> f64 {
        self.numerator[0].value / self.denominator[0].value
    }

    /// In ascending powers, with the leading coefficient of the denominator (one).
    fn rational(&self) -> Rational {
        let mut denominator = values(&self.denominator);
        denominator.push(1.0);
        Rational { numerator: values(&self.numerator), denominator }
    }
}

fn table_5_1() -> Result<Table51, VehicleError> {
    let table: Table51 = thesis!("table_5_1.toml")?;
    let whole =
        |f: &Function| f.denominator.len() + 1 == f.numerator.len() && f.numerator.len() > 1;
    if table.function.len() < ORDER || !table.function.iter().all(whole) {
        return Err(VehicleError::Model("fixtures/thesis/table_5_1.toml: order 1 to 6".to_owned()));
    }
    Ok(table)
}

/// The compensation `R_c` of eq. 5.19, unrounded.
pub(super) fn printed_compensation() -> Result<f64, VehicleError> {
    Ok(table_5_1()?.function[ORDER - 1].dc_gain())
}

pub(super) fn functions(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let own = Known::new(base)?.functions()?;
    let note = "identified between our as-printed model and our nonlinear plant with measured springs \
                and tires, rounded step of 0.15 g";
    let mut rows = Vec::new();
    for ((i, function), own) in table_5_1()?.function.iter().enumerate().zip(&own) {
        let order = i + 1;
        let sides = (&function.numerator[..], &function.denominator[..]);
        let ours = (&own.function.numerator[..], &own.function.denominator[..]);
        rows.extend(polynomial_rows(table, &format!("order {order}: "), sides, ours, note));
        let item = format!("order {order}: squared error, degree²");
        let printed = &function.square_error_degree2;
        rows.push(Row::against(table, item, printed, own.squared_error_degree2, note));
        // Only order 3 has a printed one (eq. 5.19).
        let printed = "from the printed coefficients";
        let item = format!("order {order}: F(0), printed");
        rows.push(Row::ours(table, item, function.dc_gain(), printed));
        rows.push(Row::ours(table, format!("order {order}: F(0), identified"), own.dc_gain, note));
    }
    let line = |model: &cg_vehicle::LinearModel| model.ratio[0];
    let height_m = base.vehicle.trailer.reference_cg_height_m;
    let needed =
        line(&base.complete).ratio_at(height_m) / line(&base.as_printed).ratio_at(height_m);
    let note = "effect of the fifth wheel's moment, which appendix B leaves out, on the same vehicle: \
                most of F(0)";
    rows.push(Row::ours(table, "DC gain, complete model divided by as printed", needed, note));
    Ok(rows)
}

pub(super) fn equation_5_19(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed = table_5_1()?;
    let ours = printed.function[ORDER - 1].dc_gain();
    let note = "DC gain of the printed F(s) of order 3";
    Ok(vec![Row::beside(table, "R_c", &printed.compensation, ours).noted(note)])
}

pub(super) fn product(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Table52 {
        numerator: Vec<Printed>,
        denominator: Vec<Printed>,
    }
    let printed: Table52 = thesis!("table_5_2.toml")?;
    let compensation = table_5_1()?.function[ORDER - 1].rational();
    let (numerator, denominator) = ascending(&as_printed(base)?);
    let numerator = multiplied(&numerator, &compensation.numerator);
    let denominator = multiplied(&denominator, &compensation.denominator);
    let note = "our as-printed transfer function times the printed F(s) of order 3";
    let sides = (&printed.numerator[..], &printed.denominator[..]);
    Ok(polynomial_rows(table, "", sides, (&numerator, &denominator), note))
}

/// The first terms of the compensated transfer function as a series in s, with the thesis's sign.
fn compensated_series(base: &Baseline, terms: usize) -> Result<Vec<f64>, VehicleError> {
    let model = &base.as_printed.state_space;
    let roll = model.to_trailer_roll().moments(terms)?;
    let compensation = table_5_1()?.function[ORDER - 1].rational();
    // F as a series: f_k d_0 = n_k − Σ f_j d_(k−j)
    let mut series: Vec<f64> = Vec::with_capacity(terms);
    for k in 0..terms {
        let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        let known: f64 = (0..k).map(|j| series[j] * at(&compensation.denominator, k - j)).sum();
        series.push((at(&compensation.numerator, k) - known) / compensation.denominator[0]);
    }
    let product = |k: usize| -(0..=k).map(|j| series[j] * roll[k - j]).sum::<f64>();
    Ok((0..terms).map(product).collect())
}

/// `H1 … H(2n+1)` of a rational function of order n, by Euclid's algorithm from the low end:
/// `T = P/Q`, `H1 = Q(0)/P(0)`, then the same for `T' = P/((Q − H1 P)/s)`.
fn quotients(rational: &Rational) -> Vec<f64> {
    let (mut p, mut q) = (rational.numerator.clone(), rational.denominator.clone());
    let count = 2 * rational.denominator.len() - 1;
    let mut quotients = Vec::with_capacity(count);
    for _ in 0..count {
        let h = q[0] / p[0];
        quotients.push(h);
        for k in 0..q.len() {
            q[k] -= h * p.get(k).copied().unwrap_or(0.0);
        }
        q.remove(0);
        if q.is_empty() {
            break;
        }
        std::mem::swap(&mut p, &mut q);
        p.truncate(q.len().max(1));
    }
    quotients
}

/// The reduction of order `order`, scaled as in the thesis: both polynomials are divided by
/// `±H(2n+1)`, so that the numerator at s = 0 is `±H2 H3 … H(2n)`.
fn reduction(base: &Baseline, order: usize) -> Result<Rational, VehicleError> {
    let series = compensated_series(base, 2 * order + 1)?;
    if order == 0 {
        return Ok(Rational { numerator: vec![series[0]], denominator: vec![1.0] });
    }
    let reduced = pade(&series, order).ok_or_else(|| {
        VehicleError::Model(format!("the Padé approximant of order {order} does not exist"))
    })?;
    let product: f64 = quotients(&reduced)[1..2 * order].iter().product();
    // The printed denominators are positive, whatever the sign of H(2n+1).
    let scale = (product / reduced.numerator[0]).abs();
    let scaled = |list: &[f64]| list.iter().map(|value| value * scale).collect();
    Ok(Rational {
        numerator: scaled(&reduced.numerator),
        denominator: scaled(&reduced.denominator),
    })
}

/// The compensated transfer function in ISO 8855 signs, and its reductions of order 0 to 5 with the
/// thesis's sign.
pub(super) fn reductions_of(base: &Baseline) -> Result<(System, Vec<Rational>), VehicleError> {
    let compensation = table_5_1()?.function[ORDER - 1].rational();
    let whole = base.as_printed.state_space.to_trailer_roll().then(&compensation.system());
    let reduced = (0..=5).map(|order| reduction(base, order)).collect::<Result<_, _>>()?;
    Ok((whole, reduced))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table53 {
    function: Vec<Function>,
    equation_5_12: Equation512,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Equation512 {
    pub(super) numerator: Vec<Printed>,
    pub(super) denominator: Vec<Printed>,
}

const REDUCED: &str =
    "reduced from our as-printed transfer function times the printed F(s) of order 3";

pub(super) fn reductions(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table53 = thesis!("table_5_3.toml")?;
    let orders = 0..printed.function.len();
    let reductions: Vec<Rational> = orders.map(|n| reduction(base, n)).collect::<Result<_, _>>()?;
    let mut rows = Vec::new();
    for (order, function) in printed.function.iter().enumerate() {
        let ours = &reductions[order];
        let sides = (&function.numerator[..], &function.denominator[..]);
        let name = format!("order {order}: ");
        let ours = (&ours.numerator[..], &ours.denominator[..]);
        rows.extend(polynomial_rows(table, &name, sides, ours, REDUCED));
    }
    let compensation = table_5_1()?.function[ORDER - 1].rational();
    let errors: Vec<&Printed> = printed.function.iter().map(|f| &f.square_error_degree2).collect();
    rows.extend(step_error::rows(table, base, &compensation, &errors)?);
    Ok(rows)
}

pub(super) fn equation_5_12(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed = printed_5_12()?;
    let series = compensated_series(base, 11)?;
    let ours = pade(&series, 5).ok_or_else(|| {
        VehicleError::Model("the Padé approximant of order 5 does not exist".to_owned())
    })?;
    let sides = (&printed.numerator[..], &printed.denominator[..]);
    Ok(polynomial_rows(table, "", sides, (&ours.numerator, &ours.denominator), REDUCED))
}

/// Eq. 5.12 as printed.
pub(super) fn printed_5_12() -> Result<Equation512, VehicleError> {
    let printed: Table53 = thesis!("table_5_3.toml")?;
    Ok(printed.equation_5_12)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quotients_of_a_known_fraction_come_back() {
        // 1/(1 + s/(2 + s/3)) = (6 + s)/(6 + 4 s), with or without division by its last quotient 3.
        let rational = Rational { numerator: vec![6.0, 1.0], denominator: vec![6.0, 4.0] };
        let found = quotients(&rational);
        for (ours, known) in found.iter().zip([1.0, 2.0, 3.0]) {
            assert!((ours - known).abs() < 1e-14, "{found:?}");
        }
        assert_eq!(found.len(), 3);
    }
}
