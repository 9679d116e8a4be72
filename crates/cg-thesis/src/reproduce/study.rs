//! Monte-Carlo tables on eq. 5.12: the single draws of Table 5.7 compared with many draws, and sections
//! 5.6.1–5.6.3 over input rate and noise.
//!
//! The height error of each draw is the difference between the height from its DC ratio (eq. 5.20) and
//! the height from the plant's own DC ratio.

use cg_core::truck::reduced::ORDER;
use cg_core::{RatioLine, Reduced5};

use super::baseline::{Baseline, Options};
use super::bound::{gain_sd_at_0_db, ratio_sd_at_0_db};
use super::compensated::printed_compensation;
use super::identified::{STEER_RAD, plant};
use super::monte_carlo::{
    Experiment, INTERVAL_S, RATE_PER_S, ScorePercent, arx_ratio, filtered_ratio, off_by_a_fifth,
    standard_ratio,
};
use super::printed::Printed;
use super::row::Row;
use super::solved::{bias_percent, solved};
use cg_vehicle::error::VehicleError;
use cg_vehicle::system::Rational;

/// Signal-to-noise ratios of the thesis, dB.
const SNR_DB: [u32; 6] = [30, 25, 20, 15, 10, 5];

/// A plant under one input, and the conversion of its DC ratio to a height.
struct Setting {
    interval_s: f64,
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
    /// The plant of eq. 5.12 under a rounded step.
    fn equation_5_12(base: &Baseline, rate_per_s: u32) -> Result<Self, VehicleError> {
        Self::sampled(base, rate_per_s, INTERVAL_S)
    }

    /// The same at another sampling interval.
    fn sampled(base: &Baseline, rate_per_s: u32, interval_s: f64) -> Result<Self, VehicleError> {
        let nominal = plant()?;
        let experiment = Experiment::sampled(&nominal, rate_per_s, STEER_RAD, interval_s);
        let (line, compensation) = (base.printed_line, printed_compensation()?);
        let true_height = solved(&line, nominal.dc_gain(), compensation)?;
        let height_per_ratio = 1.0 / (true_height * line.relative_slope_at(true_height));
        Ok(Self {
            interval_s,
            experiment,
            nominal,
            line,
            compensation,
            true_height,
            height_per_ratio,
        })
    }

    fn error_percent(&self, ratio: f64) -> Option<f64> {
        let height = solved(&self.line, ratio, self.compensation).ok()?;
        Some(bias_percent(height, self.true_height))
    }

    fn arx(&self, order: usize, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll, _| {
            self.error_percent(arx_ratio(order, &self.experiment.steer, roll)?)
        })
    }

    fn filtered(&self, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll, _| {
            self.error_percent(filtered_ratio(&self.nominal, &self.experiment.steer, roll)?)
        })
    }

    /// The identifier as it is on board, around dynamics that are wrong by 20 %.
    fn as_on_board(&self, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll, seed| {
            let nominal = off_by_a_fifth(&self.nominal, seed);
            let steer = &self.experiment.steer;
            self.error_percent(standard_ratio(&nominal, steer, roll, self.interval_s)?)
        })
    }

    /// The same without an offset, which ARX does not have either.
    fn off_by_a_fifth(&self, snr_db: Option<u32>, options: &Options) -> ScorePercent {
        self.experiment.score(snr_db.map(f64::from), options, |roll, seed| {
            let nominal = off_by_a_fifth(&self.nominal, seed);
            self.error_percent(filtered_ratio(&nominal, &self.experiment.steer, roll)?)
        })
    }

    /// Converts a bound on the ratio at 0 dB to one on the height at another noise level, %.
    fn height_bound_percent(&self, ratio_sd_at_0_db: f64, snr_db: u32) -> f64 {
        let noise = libm::pow(10.0, -f64::from(snr_db) / 20.0);
        100.0 * self.height_per_ratio.abs() * ratio_sd_at_0_db * noise
    }
}

/// Bias and RMSE of one cell; a printed bias is one draw.
pub(super) fn score_rows(
    table: &'static str,
    name: &str,
    draw: Option<&Printed>,
    score: &ScorePercent,
    (plant, options): (&str, &Options),
) -> Vec<Row> {
    let outliers = match score.outliers {
        none if none <= 0.0 => String::new(),
        some => format!("; without the {some:.1} % of draws with errors of more than 30 %"),
    };
    let draws = format!("{} draws on {plant}{outliers}", options.runs);
    let mut rows = Vec::new();
    if let Some(bias) = score.bias {
        let item = format!("{name} bias, %");
        rows.push(match draw {
            Some(draw) => {
                let note = format!("the thesis has one draw, ours is the mean of {draws}");
                let row = Row::against(table, item, draw, bias, note).not_comparable();
                row.within(2.0 * score.scatter, DRAW)
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

/// The criterion of a single draw.
const DRAW: &str = "95 % of single draws: two standard deviations of one";
/// The plant of Table 5.7.
const REDUCED: &str = "eq. 5.12";

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
        rows.extend(score_rows(table, &name("ARX"), Some(draw), &arx, (REDUCED, options)));
        let filtered = setting.filtered(Some(snr_db), options);
        rows.extend(score_rows(table, &name("filtered"), None, &filtered, (REDUCED, options)));
        let wrong = setting.off_by_a_fifth(Some(snr_db), options);
        let item = name("filtered, dynamics 20 % off,");
        rows.extend(score_rows(table, &item, None, &wrong, (REDUCED, options)));
        let on_board = setting.as_on_board(Some(snr_db), options);
        let item = name("filtered, dynamics 20 % off, free offset,");
        rows.extend(score_rows(table, &item, None, &on_board, (REDUCED, options)));
        let full = setting.height_bound_percent(bound, snr_db);
        rows.push(Row::ours(table, name("bound, %"), full, BOUND));
        let gain = setting.height_bound_percent(gain_sd_at_0_db(), snr_db);
        rows.push(Row::ours(table, name("bound, gain only, %"), gain, BOUND_GAIN));
    }
    for rate_hz in [20.0, 50.0, 100.0] {
        let setting = Setting::sampled(base, RATE_PER_S, 1.0 / rate_hz)?;
        let (arx, on_board) =
            (setting.arx(ORDER, Some(20), options), setting.as_on_board(Some(20), options));
        for (what, score) in [("ARX", arx), ("filtered, dynamics 20 % off, free offset,", on_board)]
        {
            let name = format!("sampled at {rate_hz} Hz, 20 dB: {what}");
            rows.extend(score_rows(table, &name, None, &score, (REDUCED, options)));
        }
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
        rows.extend(
            clean.bias.map(|bias| Row::ours(table, format!("{name} ARX error, %"), bias, note)),
        );
        for snr_db in SNR_DB {
            let name = |what: &str| format!("a = {rate_per_s}, {snr_db} dB: {what}");
            let arx = setting.arx(ORDER, Some(snr_db), options);
            rows.extend(score_rows(table, &name("ARX"), None, &arx, (REDUCED, options)));
            let filtered = setting.filtered(Some(snr_db), options);
            rows.extend(score_rows(table, &name("filtered"), None, &filtered, (REDUCED, options)));
            let full = setting.height_bound_percent(bound, snr_db);
            rows.push(Row::ours(table, name("bound, %"), full, BOUND));
        }
    }
    Ok(rows)
}
