//! Classical ARX models by least squares.

use cg_core::{Answer, Arx, Fit, Unexcited};
use numpy::{PyArray1, PyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::value_error;
use crate::results;
use crate::signals::slice;

/// The largest number of coefficients.
const GREATEST: usize = 40;
/// Capacity of the small identifier.
const SMALL: usize = 16;
/// Capacity of the large identifier, which also holds the past input for large delays.
const LARGE: usize = 48;

/// Checked orders.
#[derive(Clone, Copy)]
struct Orders {
    na: usize,
    nb: usize,
    nk: usize,
}

impl Orders {
    fn checked(na: i64, nb: i64, nk: i64) -> PyResult<Self> {
        let order = |name: &str, value: i64, least: usize| {
            usize::try_from(value).ok().filter(|&order| order >= least).ok_or_else(|| {
                value_error(format!("{name} is {value}: it must be {least} or more"))
            })
        };
        let orders =
            Self { na: order("na", na, 0)?, nb: order("nb", nb, 1)?, nk: order("nk", nk, 0)? };
        if orders.na.saturating_add(orders.nb) > GREATEST {
            return Err(value_error(format!(
                "na + nb is {}: it must be {GREATEST} or less",
                orders.na.saturating_add(orders.nb)
            )));
        }
        if orders.nk.saturating_add(orders.nb) > LARGE + 1 {
            return Err(value_error(format!(
                "nk + nb is {}: it must be {} or less; shift u instead",
                orders.nk.saturating_add(orders.nb),
                LARGE + 1
            )));
        }
        Ok(orders)
    }

    fn count(self) -> usize {
        self.na + self.nb
    }

    /// The name of the regressor of a coefficient.
    fn regressor(self, unknown: usize) -> String {
        match unknown.checked_sub(self.na) {
            None => format!("y(t-{})", unknown + 1),
            Some(k) if k + self.nk == 0 => "u(t)".to_owned(),
            Some(k) => format!("u(t-{})", k + self.nk),
        }
    }

    fn explain(self, reason: Unexcited) -> String {
        match reason {
            Unexcited::TooFewRows { rows } => format!(
                "unexcited: {rows} rows for {} coefficients; give a longer log or lower orders",
                self.count()
            ),
            Unexcited::Direction { unknown } => format!(
                "unexcited: the regressor {} is a linear combination of the regressors before it; \
                 give data in which the input varies more, or lower orders",
                self.regressor(unknown)
            ),
            other => format!("unexcited: {other}"),
        }
    }
}

/// The result of the least-squares fit.
struct Fitted {
    fit: Fit<f64>,
    theta: Vec<f64>,
    covariance: Vec<Vec<f64>>,
}

/// Input and output of an experiment.
type Experiment<'a> = (&'a [f64], &'a [f64]);

fn fitted<const N: usize>(
    experiments: &[Experiment<'_>],
    orders: Orders,
) -> Result<Fitted, String> {
    let mut arx = Arx::<f64, N>::new(orders.na, orders.nb, orders.nk)
        .ok_or_else(|| "the orders are out of range".to_owned())?;
    for (u, y) in experiments {
        arx.restart();
        for (&input, &output) in u.iter().zip(*y) {
            arx.push(input, output, true);
        }
    }
    let fit = match arx.fit() {
        Answer::Ready(fit) => fit,
        Answer::Unexcited(reason) => return Err(orders.explain(reason)),
    };
    let n = orders.count();
    let determined = arx.coefficients().zip(arx.covariance());
    let (theta, covariance) = determined.ok_or_else(|| "the data determine no model".to_owned())?;
    Ok(Fitted {
        fit,
        theta: theta[..n].to_vec(),
        covariance: covariance[..n].iter().map(|row| row[..n].to_vec()).collect(),
    })
}

fn checked(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(value_error(format!(
            "{name}[{index}] is {}: an ARX model needs every value",
            values[index]
        ))),
    }
}

/// The experiments, of one length each and without absent values.
fn paired<'a>(
    u: &'a [PyReadonlyArrayDyn<'_, f64>],
    y: &'a [PyReadonlyArrayDyn<'_, f64>],
) -> PyResult<Vec<Experiment<'a>>> {
    if u.len() != y.len() {
        return Err(value_error(format!(
            "y has {} experiments and u has {}: give one of each for every experiment",
            y.len(),
            u.len()
        )));
    }
    let one = |k: usize| {
        let name =
            |letter: &str| if u.len() == 1 { letter.into() } else { format!("{letter}[{k}]") };
        let (input, output) = (slice(&name("u"), &u[k])?, slice(&name("y"), &y[k])?);
        if input.len() != output.len() {
            return Err(value_error(format!(
                "{} has {} values and {} has {}: they must have the same length",
                name("y"),
                output.len(),
                name("u"),
                input.len()
            )));
        }
        checked(&name("u"), input)?;
        checked(&name("y"), output)?;
        Ok((input, output))
    };
    (0..u.len()).map(one).collect()
}

/// Fit an ARX model to experiments: lists of 1-D contiguous float64 arrays.
#[pyfunction]
#[pyo3(signature = (u, y, na, nb, nk, ts, /))]
pub(crate) fn fit_arx<'py>(
    py: Python<'py>,
    u: Vec<PyReadonlyArrayDyn<'py, f64>>,
    y: Vec<PyReadonlyArrayDyn<'py, f64>>,
    na: i64,
    nb: i64,
    nk: i64,
    ts: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let experiments = paired(&u, &y)?;
    if !(ts.is_finite() && ts > 0.0) {
        return Err(value_error(format!("ts is {ts}: it must be positive and finite")));
    }
    let orders = Orders::checked(na, nb, nk)?;
    let small = orders.count() <= SMALL && orders.nk + orders.nb <= SMALL + 1;
    let data = experiments.as_slice();
    let fitted = py
        .detach(
            || if small { fitted::<SMALL>(data, orders) } else { fitted::<LARGE>(data, orders) },
        )
        .map_err(value_error)?;
    model(py, orders, ts, &fitted)
}

fn model<'py>(
    py: Python<'py>,
    orders: Orders,
    ts: f64,
    fitted: &Fitted,
) -> PyResult<Bound<'py, PyAny>> {
    let (past, input) = fitted.theta.split_at(orders.na);
    let a = [&[1.0], past].concat();
    let b = [&vec![0.0; orders.nk], input].concat();
    let fields = PyDict::new(py);
    fields.set_item("a", PyArray1::from_vec(py, a))?;
    fields.set_item("b", PyArray1::from_vec(py, b))?;
    fields.set_item("na", orders.na)?;
    fields.set_item("nb", orders.nb)?;
    fields.set_item("nk", orders.nk)?;
    fields.set_item("ts", ts)?;
    fields.set_item("covariance", PyArray2::from_vec2(py, &fitted.covariance)?)?;
    fields.set_item("noise_variance", fitted.fit.noise_sd_rad * fitted.fit.noise_sd_rad)?;
    fields.set_item("dc_gain", fitted.fit.ratio.value)?;
    fields.set_item("dc_gain_sd", fitted.fit.ratio.sd)?;
    fields.set_item("fit_percent", fitted.fit.fit_percent)?;
    fields.set_item("rows", fitted.fit.rows)?;
    results::make(py, "ArxModel", &fields)
}
