//! Monte-Carlo tables: the single draws of Tables 5.7 and 5.9 compared with many draws, and sections
//! 5.6.1–5.6.3 over input rate and noise.
//!
//! The height error of each draw is the difference between the height from its DC ratio (eq. 5.20) and
//! the height from the plant's own DC ratio.

use cg_core::truck::reduced::ORDER;
use cg_core::{Channel, RatioLine, Reduced5};
use serde::Deserialize;

use super::baseline::{Baseline, METERS_PER_INCH, Options};
use super::bound::{gain_sd_at_0_db, ratio_sd_at_0_db};
use super::compensated::printed_compensation;
use super::identified::{STEER_RAD, plant};
use super::monte_carlo::{Experiment, RATE_PER_S, ScorePercent, arx_ratio, filtered_ratio};
use super::printed::{Printed, thesis};
use super::row::Row;
use super::solved::{bias_percent, solved};
use cg_vehicle::error::VehicleError;
use cg_vehicle::reduction::{pade, reduce};
use cg_vehicle::system::Rational;

/// Signal-to-noise ratios of the thesis, dB.
const SNR_DB: [u32; 6] = [30, 25, 20, 15, 10, 5];

/// A plant under one input, and the conversion of its DC ratio to a height.
struct Setting {
    /// Description of the plant.
    plant: &'static str,
    experiment: Experiment,
    /// The model from which the project's identifier starts.
    nominal: Reduced5<f64>,
    line: RatioLine<f64>,
    compensation: f64,
    true_height: f64,
    /// Percent of height per percent of ratio.
    height_per_ratio: f64,
}

impl Setting {
    fn new(
        (plant, experiment): (&'static str, Experiment),
        nominal: Reduced5<f64>,
        (line, compensation): (RatioLine<f64>, f64),
        true_ratio: f64,
    ) -> Result<Self, VehicleError> {
        let true_height = solved(&line, true_ratio, compensation)?;
        let height_per_ratio = 1.0 / (true_height * line.relative_slope_at(true_height));
        Ok(Self { plant, experiment, nominal, line, compensation, true_height, height_per_ratio })
    }

    /// The plant of eq. 5.12 under a rounded step.
    fn equation_5_12(base: &Baseline, rate_per_s: u32) -> Result<Self, VehicleError> {
        let plant = plant()?;
        let experiment = Experiment::on_reduced(&plant, rate_per_s, STEER_RAD);
        let line = (base.printed_line, printed_compensation()?);
        Self::new(("eq. 5.12", experiment), plant, line, plant.dc_gain())
    }

    /// The complete linear model, in place of the Yaw/Roll program.
    fn complete(base: &Baseline) -> Result<Self, VehicleError> {
        let model = &base.complete.state_space;
        let ratio = model.steady(&model.trailer_roll, 0.0)?;
        let experiment = Experiment::on_linear(model, RATE_PER_S, STEER_RAD.abs());
        let nominal = reduce(model, &[])?.of_channels[Channel::Steer.index()];
        let line = (base.complete.ratio[0], 1.0);
        Self::new(("our complete linear model", experiment), nominal, line, ratio)
    }

    fn error_percent(&self, ratio: f64) -> Option<f64> {
        let height = solved(&self.line, ratio, self.compensation).ok()?;
        Some(bias_percent(height, self.true_height))
    }

    fn arx(&self, order: usize, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll| {
            self.error_percent(arx_ratio(order, &self.experiment.steer, roll)?)
        })
    }

    fn filtered(&self, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll| {
            self.error_percent(filtered_ratio(&self.nominal, &self.experiment.steer, roll)?)
        })
    }

    /// Converts a bound on the ratio at 0 dB to one on the height at another noise level, %.
    fn height_bound_percent(&self, ratio_sd_at_0_db: f64, snr_db: u32) -> f64 {
        let noise = 10f64.powf(-f64::from(snr_db) / 20.0);
        100.0 * self.height_per_ratio.abs() * ratio_sd_at_0_db * noise
    }
}

/// Bias and RMSE of one cell; a printed bias is one draw.
fn score_rows(
    table: &'static str,
    name: &str,
    draw: Option<&Printed>,
    score: &ScorePercent,
    (setting, options): (&Setting, &Options),
) -> Vec<Row> {
    let outliers = match score.outliers {
        none if none <= 0.0 => String::new(),
        some => format!("; without the {some:.1} % of draws with errors of more than 30 %"),
    };
    let draws = format!("{} draws on {}{outliers}", options.runs, setting.plant);
    let mut rows = Vec::new();
    if let Some(bias) = score.bias {
        let item = format!("{name} bias, %");
        rows.push(match draw {
            Some(draw) => {
                let note = format!("the thesis has one draw, ours is the mean of {draws}");
                Row::against(table, item, draw, bias, note).not_comparable()
            }
            None => Row::ours(table, item, bias, format!("not in the thesis; {draws}")),
        });
    }
    if let Some(rmse) = score.rmse {
        let note = format!("not in the thesis; {draws}");
        rows.push(Row::ours(table, format!("{name} RMSE, %"), rmse, note));
    }
    rows
}

/// One row for an experiment without noise, where all draws are equal.
fn noise_free_row(
    table: &'static str,
    name: &str,
    draw: Option<&Printed>,
    score: &ScorePercent,
    note: &str,
) -> Option<Row> {
    let (bias, item) = (score.bias?, format!("{name} error, %"));
    Some(match draw {
        Some(draw) => Row::against(table, item, draw, bias, note).not_comparable(),
        None => Row::ours(table, item, bias, note),
    })
}

const BOUND: &str = "least standard deviation of an unbiased estimator (Cramér-Rao)";
const BOUND_GAIN: &str = "the same if everything except the gain is known";

/// Table 5.7: each printed draw compared with many draws, at a rate that the thesis does not print.
pub(super) fn beside_draws(
    table: &'static str,
    base: &Baseline,
    options: &Options,
    draws: &[(u32, &Printed)],
) -> Result<Vec<Row>, VehicleError> {
    let setting = Setting::equation_5_12(base, RATE_PER_S)?;
    let bound = ratio_sd_at_0_db(&rational(&plant()?), RATE_PER_S)?;
    let mut rows = Vec::new();
    for &(snr_db, draw) in draws {
        let name = |what: &str| format!("{snr_db} dB: {what}");
        let arx = setting.arx(ORDER, Some(snr_db), options);
        rows.extend(score_rows(table, &name("ARX"), Some(draw), &arx, (&setting, options)));
        let filtered = setting.filtered(Some(snr_db), options);
        rows.extend(score_rows(table, &name("filtered"), None, &filtered, (&setting, options)));
        let full = setting.height_bound_percent(bound, snr_db);
        rows.push(Row::ours(table, name("bound, %"), full, BOUND));
        let gain = setting.height_bound_percent(gain_sd_at_0_db(), snr_db);
        rows.push(Row::ours(table, name("bound, gain only, %"), gain, BOUND_GAIN));
    }
    Ok(rows)
}

fn rational(model: &Reduced5<f64>) -> Rational {
    let mut denominator = model.denominator.to_vec();
    denominator.push(1.0);
    Rational { numerator: model.numerator.to_vec(), denominator }
}

/// Sections 5.6.1–5.6.3: rate 1–6, all noises.
pub(super) fn by_rate(
    table: &'static str,
    base: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let plant = rational(&plant()?);
    let mut rows = Vec::new();
    for rate_per_s in 1..=6 {
        let setting = Setting::equation_5_12(base, rate_per_s)?;
        let bound = ratio_sd_at_0_db(&plant, rate_per_s)?;
        let name = format!("a = {rate_per_s}, no noise:");
        let note = "exact data, exact model: rounding only";
        let clean = setting.arx(ORDER, None, options);
        rows.extend(noise_free_row(table, &format!("{name} ARX"), None, &clean, note));
        for snr_db in SNR_DB {
            let name = |what: &str| format!("a = {rate_per_s}, {snr_db} dB: {what}");
            let arx = setting.arx(ORDER, Some(snr_db), options);
            rows.extend(score_rows(table, &name("ARX"), None, &arx, (&setting, options)));
            let filtered = setting.filtered(Some(snr_db), options);
            rows.extend(score_rows(table, &name("filtered"), None, &filtered, (&setting, options)));
            let full = setting.height_bound_percent(bound, snr_db);
            rows.push(Row::ours(table, name("bound, %"), full, BOUND));
        }
    }
    Ok(rows)
}

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

/// Table 5.9: order 1–5, all noises. The bound of order n is that of the plant's own reduction
/// to that order.
pub(super) fn by_order(
    table: &'static str,
    base: &Baseline,
    options: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: Table59 = thesis!("table_5_9.toml")?;
    let setting = Setting::complete(base)?;
    let model = &base.complete.state_space;
    let mut rows = Vec::new();
    for (i, column) in printed.order.iter().enumerate() {
        let order = i + 1;
        let name = format!("order {order}, no noise: ARX");
        let note = "the plant is our complete linear model instead of the Yaw/Roll program";
        let clean = setting.arx(order, None, options);
        rows.extend(noise_free_row(table, &name, column.bias_percent.first(), &clean, note));
        let moments = model.to_trailer_roll().moments(2 * order + 1)?;
        let bound = pade(&moments, order)
            .filter(|reduced| super::bound::embedded(reduced).is_some_and(|m| m.is_stable()))
            .map(|reduced| ratio_sd_at_0_db(&reduced, RATE_PER_S))
            .transpose()?;
        for (snr_db, draw) in printed.snr_db.iter().zip(column.bias_percent.iter().skip(1)) {
            let name = |what: &str| format!("order {order}, {snr_db} dB: {what}");
            let arx = setting.arx(order, Some(*snr_db), options);
            rows.extend(score_rows(table, &name("ARX"), Some(draw), &arx, (&setting, options)));
            if let Some(bound) = bound {
                let full = setting.height_bound_percent(bound, *snr_db);
                rows.push(Row::ours(table, name("bound, %"), full, BOUND));
            }
        }
    }
    for &snr_db in &printed.snr_db {
        let filtered = setting.filtered(Some(snr_db), options);
        let name = format!("any order, {snr_db} dB: filtered");
        rows.extend(score_rows(table, &name, None, &filtered, (&setting, options)));
        let gain = setting.height_bound_percent(gain_sd_at_0_db(), snr_db);
        let item = format!("any order, {snr_db} dB: bound, gain only, %");
        rows.push(Row::ours(table, item, gain, BOUND_GAIN));
    }
    rows.extend(printed_biases(table, base, &printed));
    Ok(rows)
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
