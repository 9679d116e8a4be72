//! Transfer functions identified from the response of eq. 5.12: Tables 5.4, 5.5 and 5.8.
//!
//! All signs are those of the thesis (ratios are negative).

use cg_core::Reduced5;
use cg_core::truck::reduced::ORDER;
use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::compensated::printed_5_12;
use super::continuous::{UNKNOWNS, to_continuous};
use super::monte_carlo::{Experiment, INTERVAL_S, RATE_PER_S, arx, arx_ratio, filtered};
use super::printed::{Printed, fixed, thesis, values};
use super::row::Row;
use super::solved::Heights;
use super::transfer::polynomial_rows;
use cg_vehicle::error::VehicleError;
use cg_vehicle::system::Rational;

/// Road-wheel amplitude of the experiments on eq. 5.12, to the left in ISO 8855. The models are linear,
/// so it only determines the size of the noise relative to the sensor's floor.
pub(super) const STEER_RAD: f64 = -0.05;

/// Eq. 5.12 as printed.
pub(super) fn plant() -> Result<Reduced5<f64>, VehicleError> {
    let printed = printed_5_12()?;
    Ok(Reduced5 {
        numerator: fixed(&printed.numerator)?,
        denominator: fixed(&printed.denominator)?,
        speed_slope: [0.0; 5],
    })
}

fn not_identified() -> VehicleError {
    VehicleError::Model("the response of eq. 5.12 does not determine an ARX model".to_owned())
}

/// DC ratio of an ARX model of order 5 from noise-free data.
pub(super) fn by_rate_ratio(rate_per_s: u32) -> Result<f64, VehicleError> {
    let experiment = Experiment::on_reduced(&plant()?, rate_per_s, STEER_RAD);
    arx_ratio(ORDER, &experiment.steer, &experiment.roll).ok_or_else(not_identified)
}

/// The same at the default rate.
pub(super) fn noise_free_ratio() -> Result<f64, VehicleError> {
    by_rate_ratio(RATE_PER_S)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Functions {
    #[serde(default, rename = "remark")]
    _remark: Option<String>,
    function: Vec<Function>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Function {
    #[serde(alias = "rate_per_s", alias = "snr_db")]
    condition: u32,
    numerator: Vec<Printed>,
    denominator: Vec<Printed>,
}

/// A printed function, the function from whose response it was identified, and the rate of the step.
pub(super) struct PrintedResponse {
    pub(super) function: Rational,
    pub(super) original: Rational,
    pub(super) rate_per_s: u32,
}

/// The printed functions of Tables 5.4 and 5.8 with their titles.
pub(super) fn printed_responses() -> Result<Vec<(&'static str, PrintedResponse)>, VehicleError> {
    const TITLES: [&str; 12] = [
        "Table 5.4, a = 1",
        "Table 5.4, a = 2",
        "Table 5.4, a = 3",
        "Table 5.4, a = 4",
        "Table 5.4, a = 5",
        "Table 5.4, a = 6",
        "Table 5.8, 30 dB",
        "Table 5.8, 25 dB",
        "Table 5.8, 20 dB",
        "Table 5.8, 15 dB",
        "Table 5.8, 10 dB",
        "Table 5.8, 5 dB",
    ];
    let monic = |numerator: &[f64], denominator: &[f64]| {
        let mut denominator = denominator.to_vec();
        denominator.resize(ORDER, 0.0);
        denominator.push(1.0);
        Rational { numerator: numerator.to_vec(), denominator }
    };
    let plant = plant()?;
    let [by_rate, by_noise]: [Functions; 2] =
        [thesis!("table_5_4.toml")?, thesis!("table_5_8.toml")?];
    let rated = by_rate.function.iter().map(|one| (one, one.condition));
    let noisy = by_noise.function.iter().map(|one| (one, RATE_PER_S));
    let responses = rated.chain(noisy).map(|(one, rate_per_s)| PrintedResponse {
        function: monic(&values(&one.numerator), &values(&one.denominator)),
        original: monic(&plant.numerator, &plant.denominator),
        rate_per_s,
    });
    Ok(TITLES.into_iter().zip(responses).collect())
}

pub(super) fn by_rate(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Functions = thesis!("table_5_4.toml")?;
    let note = "cannot be reproduced: noise-free data return eq. 5.12 itself, whatever the rate";
    let plant = plant()?;
    let mut rows = Vec::new();
    for function in &printed.function {
        let experiment = Experiment::on_reduced(&plant, function.condition, STEER_RAD);
        let ours = arx::<UNKNOWNS>(&experiment.steer, &experiment.roll)
            .and_then(|coefficients| to_continuous(&coefficients, INTERVAL_S))
            .ok_or_else(not_identified)?;
        let name = format!("a = {}: ", function.condition);
        let sides = (&function.numerator[..], &function.denominator[..]);
        rows.extend(polynomial_rows(
            table,
            &name,
            sides,
            (&ours.numerator, &ours.denominator),
            note,
        ));
    }
    Ok(rows)
}

pub(super) fn ratios(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Heights = thesis!("tables_5_5_5_6.toml")?;
    let original = &printed.original;
    let note = "from the printed coefficients";
    let ours = original.a0.value / original.b0.value;
    let mut rows = vec![Row::beside(table, "eq. 5.12: A0/B0", &original.ratio, ours).noted(note)];
    for row in &printed.row {
        let name = format!("a = {}: A0/B0", row.condition);
        let ours = row.a0.value / row.b0.value;
        rows.push(Row::beside(table, name.clone(), &row.ratio, ours).noted(note));
        let note = "identified here from noise-free data: eq. 5.12's own ratio at every rate";
        let ours = by_rate_ratio(row.condition)?;
        rows.push(Row::against(table, format!("{name} identified here"), &row.ratio, ours, note));
    }
    Ok(rows)
}

/// Each printed function is one draw of an unknown noise. The recomputed ones are medians of many draws:
/// of the project's identifier, which stays near eq. 5.12, and of the thesis's ARX for the sum of the
/// poles, which the noise makes very large.
pub(super) fn by_noise(
    table: &'static str,
    _: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Functions = thesis!("table_5_8.toml")?;
    let ratios: Heights = thesis!("table_5_7.toml")?;
    let experiment = Experiment::on_reduced(&plant()?, RATE_PER_S, STEER_RAD);
    let unknown = "one draw of an unknown noise, cannot be reproduced";
    let runs = options.runs;
    let mut rows = Vec::new();
    for (function, ratio) in printed.function.iter().zip(&ratios.row) {
        let name = format!("{} dB: ", function.condition);
        let from_print = function.numerator[0].value / function.denominator[0].value;
        let row = Row::beside(table, format!("{name}A0/B0"), &ratio.ratio, from_print);
        rows.push(row.noted("from the printed coefficients"));
        let draws = Draws::new(&experiment, f64::from(function.condition), options)?;
        let note = format!("{unknown}; ours is the median of {runs} draws, filtered identifier");
        let sides = (&function.numerator[..], &function.denominator[..]);
        let ours = draws.median_model();
        let ours = (&ours.numerator[..], &ours.denominator[..]);
        rows.extend(polynomial_rows(table, &name, sides, ours, &note));
        if let (Some(sum), Some(printed)) = (draws.median_pole_sum(), function.denominator.last()) {
            let note = format!("{unknown}; ours is the median of {runs} draws, the thesis's ARX");
            rows.push(Row::against(table, format!("{name}B4 by ARX"), printed, sum, note));
        }
    }
    Ok(rows)
}

/// Many identifications at one noise level.
struct Draws {
    models: Vec<Reduced5<f64>>,
    pole_sums: Vec<f64>,
}

impl Draws {
    fn new(experiment: &Experiment, snr_db: f64, options: &Options) -> Result<Self, VehicleError> {
        let plant = plant()?;
        let mut draws = Self { models: Vec::new(), pole_sums: Vec::new() };
        for run in 0..options.runs {
            let roll = experiment.drawn(Some(snr_db), options.seed.wrapping_add(u64::from(run)));
            draws.models.extend(filtered(&plant, &experiment.steer, &roll).model());
            // A draw whose poles have no real transfer function is left out.
            let sampled = arx::<UNKNOWNS>(&experiment.steer, &roll);
            let continuous = sampled.and_then(|sampled| to_continuous(&sampled, INTERVAL_S));
            draws.pole_sums.extend(continuous.map(|model| model.denominator[ORDER - 1]));
        }
        if draws.models.is_empty() { Err(not_identified()) } else { Ok(draws) }
    }

    fn median_pole_sum(&self) -> Option<f64> {
        median(self.pole_sums.clone())
    }

    /// The median of each coefficient.
    fn median_model(&self) -> Reduced5<f64> {
        let middle = |at: &dyn Fn(&Reduced5<f64>) -> f64| {
            median(self.models.iter().map(at).collect()).unwrap_or(f64::NAN)
        };
        Reduced5 {
            numerator: std::array::from_fn(|k| middle(&|model| model.numerator[k])),
            denominator: std::array::from_fn(|k| middle(&|model| model.denominator[k])),
            speed_slope: [0.0; 5],
        }
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
