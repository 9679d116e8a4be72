//! Transfer functions identified from the response of eq. 5.12: Tables 5.4, 5.5 and 5.8.
//!
//! All signs are those of the thesis (ratios are negative).

use cg_core::Reduced5;
use cg_core::truck::reduced::ORDER;
use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::compensated::printed_5_12;
use super::continuous::{UNKNOWNS, to_continuous};
use super::monte_carlo::{
    Experiment, INTERVAL_S, RATE_PER_S, arx, arx_ratio, filtered, off_by_a_fifth,
};
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

/// Each printed function is one draw of an unknown noise. Beside it stands the thesis's ARX on many draws
/// of white noise, and below it this project's identifier on the same draws.
pub(super) fn by_noise(
    table: &'static str,
    _: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Functions = thesis!("table_5_8.toml")?;
    let ratios: Heights = thesis!("table_5_7.toml")?;
    let experiment = Experiment::on_reduced(&plant()?, RATE_PER_S, STEER_RAD);
    let mut rows = Vec::new();
    for (function, ratio) in printed.function.iter().zip(&ratios.row) {
        let name = format!("{} dB: ", function.condition);
        let from_print = function.numerator[0].value / function.denominator[0].value;
        let row = Row::beside(table, format!("{name}A0/B0"), &ratio.ratio, from_print);
        rows.push(row.noted("from the printed coefficients"));
        let draws = Draws::new(&experiment, f64::from(function.condition), options)?;
        rows.extend(draws.rows(table, &name, function));
    }
    Ok(rows)
}

/// The criterion of a coefficient from one draw of noise.
const DRAW: &str = "95 % of single draws of the same ARX: its 2.5 and 97.5 % quantiles";

/// A range that is so many times as wide as a number says nothing about it.
const EMPTY: f64 = 10.0;
const UNDETERMINED: &str = "cannot be compared because a smooth step in noise does not determine it: single \
                            draws reach over more than ten times the printed number";

/// Many identifications at one noise level.
struct Draws {
    runs: u32,
    /// The thesis's ARX. A draw whose poles have no real transfer function is left out.
    arx: Vec<Reduced5<f64>>,
    /// The project's identifier, without an offset, from dynamics that are wrong by 20 %.
    filtered: Vec<Reduced5<f64>>,
}

impl Draws {
    fn new(experiment: &Experiment, snr_db: f64, options: &Options) -> Result<Self, VehicleError> {
        let plant = plant()?;
        let mut draws = Self { runs: options.runs, arx: Vec::new(), filtered: Vec::new() };
        for run in 0..options.runs {
            let seed = options.seed.wrapping_add(u64::from(run));
            let roll = experiment.drawn(Some(snr_db), seed);
            let nominal = off_by_a_fifth(&plant, seed);
            draws.filtered.extend(filtered(&nominal, &experiment.steer, &roll).model());
            let sampled = arx::<UNKNOWNS>(&experiment.steer, &roll);
            draws.arx.extend(sampled.and_then(|one| to_continuous(&one, INTERVAL_S)));
        }
        if draws.arx.is_empty() || draws.filtered.is_empty() {
            return Err(not_identified());
        }
        Ok(draws)
    }

    /// The printed coefficients beside the medians of both.
    fn rows(&self, table: &'static str, name: &str, printed: &Function) -> Vec<Row> {
        let runs = self.runs;
        let left_out = runs as usize - self.arx.len();
        let arx_note = format!(
            "the thesis has one draw, ours is the median of {runs} draws of the thesis's ARX; without \
             the {left_out} whose poles have no real transfer function"
        );
        let own_note = format!(
            "not in the thesis: the median of {runs} draws of this project's filtered identifier, which \
             starts from dynamics that are wrong by 20 %"
        );
        let mut rows = Vec::new();
        let mut own = Vec::new();
        for (letter, printed, of) in [
            ("A", &printed.numerator, (|model, k| model.numerator[k]) as Coefficient),
            ("B", &printed.denominator, |model, k| model.denominator[k]),
        ] {
            for (k, printed) in printed.iter().enumerate() {
                let drawn = Drawn::of(&self.arx, |model| of(model, k));
                let item = format!("{name}{letter}{k}, the thesis's ARX");
                let row = Row::against(table, item, printed, drawn.median, &arx_note);
                let (row, reach) = (row.not_comparable(), drawn.reach(printed.value));
                rows.push(if reach > EMPTY * printed.value.abs() {
                    row.undetermined(UNDETERMINED)
                } else {
                    row.within(reach, DRAW)
                });
                let median = Drawn::of(&self.filtered, |model| of(model, k)).median;
                let item = format!("{name}{letter}{k}, filtered");
                own.push(Row::ours(table, item, median, &own_note));
            }
        }
        rows.append(&mut own);
        rows
    }
}

/// A coefficient of a model by its power of s.
type Coefficient = fn(&Reduced5<f64>, usize) -> f64;

/// The distribution of one coefficient over draws.
struct Drawn {
    median: f64,
    /// The 2.5 and 97.5 % quantiles.
    ends: [f64; 2],
}

impl Drawn {
    fn of(models: &[Reduced5<f64>], value: impl Fn(&Reduced5<f64>) -> f64) -> Self {
        let mut values: Vec<f64> = models.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let quantile = |thousandths: usize| values[(values.len() - 1) * thousandths / 1000];
        Self { median: quantile(500), ends: [quantile(25), quantile(975)] }
    }

    /// Distance from the median to the quantile on the side of a value.
    fn reach(&self, value: f64) -> f64 {
        (self.ends[usize::from(value > self.median)] - self.median).abs()
    }
}
