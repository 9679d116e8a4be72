//! The calibration file: the posterior with its covariance, the runs behind it, and in words
//! what they could and could not determine.

use std::path::Path;

use cg_core::Channel;
use serde::{Deserialize, Serialize};

use crate::belief::{Belief, Covariance, Deviations, PARAMETERS, Parameter, log_ratios};
use crate::calibration::fit::{Fitted, Procedure, Run};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::files;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// Share of the prior variance that the runs must remove for a parameter to count as determined.
const DETERMINED: f64 = 0.5;
/// Below this share the runs say next to nothing of it.
const UNDETERMINED: f64 = 0.1;
/// How the line with the checksum of all before it begins; to TOML it is a comment.
const CHECKSUM: &str = "# crc32 ";
/// Greatest relative difference between a model ratio in the file and the vehicle's now.
const SAME_RATIO: f64 = 1e-6;

/// A calibration of one vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Calibration {
    /// Name of the vehicle.
    pub vehicle: String,
    /// Equations of the vehicle model.
    pub model: Variant,
    /// When it was made.
    #[serde(default)]
    pub date: String,
    /// How.
    pub procedure: Procedure,
    /// What the runs could and could not determine.
    pub statement: Vec<String>,
    /// Relative standard deviation of what no calibration removes.
    pub residual_sd: f64,
    /// Misfit of the runs and shift of the parameters, each squared over its variance; about
    /// the number of ratios if the vehicle file's `[uncertainty]` is true.
    pub chi_square: f64,
    /// `R_c` of each channel, sensor gain included.
    pub compensation: Compensations,
    /// Covariance of the parameters' deviations: logarithms of factors, metres.
    pub covariance: Vec<Vec<f64>>,
    /// The parameters, in the order of the covariance.
    pub parameter: Vec<ParameterEntry>,
    /// The runs.
    pub run: Vec<RunEntry>,
}

/// `R_c` of each channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compensations {
    /// Roll per steer angle.
    pub steer: f64,
    /// Roll per lateral acceleration.
    pub lateral_acceleration: f64,
}

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterEntry {
    /// Which.
    pub name: Parameter,
    /// `factor` on the vehicle file's value, or `m` added to it.
    pub unit: Unit,
    /// Its value.
    pub value: f64,
    /// Standard deviation (of a factor: relative).
    pub sd: f64,
    /// The same before calibration.
    pub prior_sd: f64,
    /// Share of the prior variance that the runs removed.
    pub determined: f64,
}

/// Unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// A factor on the vehicle file's value.
    Factor,
    /// Metres added to it.
    M,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunEntry {
    /// Its log.
    pub log: String,
    /// Known height.
    pub height_m: f64,
    /// Trailer mass.
    pub trailer_mass_kg: f64,
    /// Mean speed of its turns.
    pub speed_mps: f64,
    /// What each channel said.
    pub channel: Vec<ChannelEntry>,
}

/// One ratio of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelEntry {
    /// `steer` or `lateral-acceleration`.
    pub name: String,
    /// Identified DC ratio, rad per rad or rad per m/s².
    pub ratio: f64,
    /// Its standard deviation from noise.
    pub ratio_sd: f64,
    /// The ratio of the vehicle file as it is.
    pub model_ratio: f64,
    /// Identified over model ratio less one, before calibration, %.
    pub before_percent: f64,
    /// The same after it.
    pub after_percent: f64,
}

impl Calibration {
    /// Puts a fit into words and numbers; `date` is left to the caller.
    ///
    /// # Errors
    /// As [`crate::linear::ratio_line`].
    pub fn new(
        vehicle: &Vehicle,
        variant: Variant,
        runs: &[Run],
        fitted: &Fitted,
    ) -> Result<Self, VehicleError> {
        let prior = Belief::prior(vehicle);
        let belief = &fitted.belief;
        let parameter = Parameter::ALL.map(|name| entry(name, &prior, belief)).to_vec();
        Ok(Self {
            vehicle: vehicle.name.clone(),
            model: variant,
            date: String::new(),
            procedure: fitted.procedure,
            statement: statement(vehicle, variant, runs, fitted, &parameter)?,
            residual_sd: belief.residual_sd,
            chi_square: fitted.chi_square,
            compensation: Compensations {
                steer: belief.gain(Channel::Steer),
                lateral_acceleration: belief.gain(Channel::LateralAcceleration),
            },
            covariance: (0..PARAMETERS)
                .map(|i| (0..PARAMETERS).map(|j| belief.covariance[(i, j)]).collect())
                .collect(),
            parameter,
            run: runs.iter().enumerate().map(|(i, run)| run_entry(i, run, fitted)).collect(),
        })
    }

    /// Reads a calibration file and checks that it belongs to this vehicle as it is now.
    ///
    /// # Errors
    /// [`VehicleError`] naming file, place and reason.
    pub fn load(path: impl AsRef<Path>, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let text = files::read_text(path, files::VEHICLE_BYTES)
            .map_err(|source| VehicleError::Read { file: file.clone(), source })?;
        Self::parse(&text, &file, vehicle)
    }

    /// Checks the text of a calibration of `vehicle`; `file` is its name in messages. Its last line
    /// must hold the checksum of all before it: a calibration that was edited or cut short is none.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, file: &str, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let calibration: Self =
            toml::from_str(text).map_err(|source| VehicleError::syntax(file, &source))?;
        calibration
            .check(vehicle)
            .and_then(|()| check_sum(text))
            .map_err(|reason| VehicleError::Model(format!("{file}: {reason}")))?;
        Ok(calibration)
    }

    /// As the text of a file.
    ///
    /// # Errors
    /// If a number cannot be written, which is a bug.
    pub fn to_toml(&self) -> Result<String, VehicleError> {
        let text = toml::to_string(self)
            .map_err(|error| VehicleError::Model(format!("calibration: {error}")))?;
        let text = format!(
            "# Calibration of the vehicle \"{}\" (cg calibrate). The vehicle file is not changed by it.\n\
             # The last line holds the checksum of all before it: do not edit.\n{text}",
            // A line break in a name would end the comment.
            self.vehicle.replace(char::is_control, " ")
        );
        Ok(format!("{text}{CHECKSUM}{:08x}\n", checksum(&text)))
    }

    /// The belief that it stands for.
    pub fn belief(&self) -> Belief {
        let mut mean = Deviations::zeros();
        for entry in &self.parameter {
            let value = if entry.name.is_factor() { entry.value.ln() } else { entry.value };
            mean[entry.name as usize] = value;
        }
        let covariance = Covariance::from_fn(|i, j| self.covariance[i][j]);
        Belief { mean, covariance, residual_sd: self.residual_sd }
    }

    fn check(&self, vehicle: &Vehicle) -> Result<(), String> {
        if self.vehicle != vehicle.name {
            return Err(format!(
                "this calibration belongs to the vehicle \"{}\", not to \"{}\"",
                self.vehicle, vehicle.name
            ));
        }
        let complete = self.parameter.len() == PARAMETERS
            && self.parameter.iter().zip(Parameter::ALL).all(|(entry, name)| entry.name == name)
            && self.covariance.len() == PARAMETERS
            && self.covariance.iter().all(|row| row.len() == PARAMETERS);
        if !complete {
            return Err(format!(
                "needs all {PARAMETERS} parameters in their order and a covariance of that size; \
                 make it anew with cg calibrate"
            ));
        }
        for entry in &self.parameter {
            let positive = !entry.name.is_factor() || entry.value > 0.0;
            if !(entry.value.is_finite() && positive) {
                return Err(format!("{} = {} is impossible", entry.name.words(), entry.value));
            }
        }
        let scale = Covariance::from_diagonal_element(1e-12);
        let belief = self.belief();
        let symmetric = (belief.covariance - belief.covariance.transpose()).amax() <= 1e-12;
        if !(symmetric && (belief.covariance + scale).cholesky().is_some()) {
            return Err("the covariance is not symmetric and positive".to_owned());
        }
        if !(0.0..=1.0).contains(&self.residual_sd) {
            return Err(format!("residual_sd = {} must lie between 0 and 1", self.residual_sd));
        }
        self.check_model(vehicle)
    }

    /// A vehicle file that was changed since makes another model.
    fn check_model(&self, vehicle: &Vehicle) -> Result<(), String> {
        for run in &self.run {
            let load = Load { trailer_mass_kg: run.trailer_mass_kg, cg_height_m: run.height_m };
            let (logs, _) =
                log_ratios(vehicle, self.model, run.speed_mps, load, &Deviations::zeros())
                    .map_err(|error| error.to_string())?;
            for entry in &run.channel {
                let channel = Channel::ALL.into_iter().find(|c| c.to_string() == entry.name);
                let Some(channel) = channel else {
                    return Err(format!("run {}: unknown channel \"{}\"", run.log, entry.name));
                };
                let now = logs[channel.index()].exp();
                if !((now / entry.model_ratio - 1.0).abs() <= SAME_RATIO) {
                    return Err(format!(
                        "the vehicle file has changed since this calibration (its {channel} ratio \
                         is {now:.6} in place of {:.6}); run cg calibrate again",
                        entry.model_ratio
                    ));
                }
            }
        }
        Ok(())
    }
}

/// CRC-32 of a text; line ends of another system and empty lines at its end make no difference.
fn checksum(text: &str) -> u32 {
    crc32fast::hash(text.trim_ascii_end().replace("\r\n", "\n").as_bytes())
}

/// Whether the text is as it was written.
fn check_sum(text: &str) -> Result<(), String> {
    let text = text.trim_ascii_end();
    let (content, last) = text.rsplit_once('\n').unwrap_or(("", text));
    let (content, told) = match last.strip_prefix(CHECKSUM) {
        Some(told) => (content, Some(told)),
        None => (text, None),
    };
    let now = checksum(content);
    let what = match told {
        Some(told) if u32::from_str_radix(told, 16) == Ok(now) => return Ok(()),
        Some(_) => "was edited or damaged since it was made: its checksum is wrong",
        None => "was edited, cut short or made by an older version: it has no checksum",
    };
    Err(format!(
        "the calibration {what}; run cg calibrate again, or make \"{CHECKSUM}{now:08x}\" its last \
         line if you stand by every number in it"
    ))
}

fn entry(name: Parameter, prior: &Belief, belief: &Belief) -> ParameterEntry {
    let k = name as usize;
    let (before, after) = (prior.covariance[(k, k)], belief.covariance[(k, k)]);
    let (unit, value) = if name.is_factor() {
        (Unit::Factor, belief.mean[k].exp())
    } else {
        (Unit::M, belief.mean[k])
    };
    let determined = if before > 0.0 { 1.0 - after / before } else { 0.0 };
    ParameterEntry { name, unit, value, sd: after.sqrt(), prior_sd: before.sqrt(), determined }
}

fn run_entry(index: usize, run: &Run, fitted: &Fitted) -> RunEntry {
    let percent = |log: f64| 100.0 * log.exp_m1();
    let channel = fitted
        .residuals
        .iter()
        .filter(|residual| residual.run == index)
        .filter_map(|residual| {
            let ratio = run.ratio[residual.channel.index()]?;
            Some(ChannelEntry {
                name: residual.channel.to_string(),
                ratio: ratio.value,
                ratio_sd: ratio.sd,
                model_ratio: ratio.value * (-residual.before).exp(),
                before_percent: percent(residual.before),
                after_percent: percent(residual.after),
            })
        })
        .collect();
    RunEntry {
        log: run.log.clone(),
        height_m: run.load.cg_height_m,
        trailer_mass_kg: run.load.trailer_mass_kg,
        speed_mps: run.speed_mps,
        channel,
    }
}

fn what_was_determined(parameter: &[ParameterEntry]) -> Vec<String> {
    let named = |title: &str, wanted: &dyn Fn(f64) -> bool| {
        let words: Vec<&str> = parameter
            .iter()
            .filter(|entry| entry.prior_sd > 0.0 && wanted(entry.determined))
            .map(|entry| entry.name.words())
            .collect();
        let list = if words.is_empty() { "none".to_owned() } else { words.join(", ") };
        format!("{title}: {list}")
    };
    vec![
        named("determined", &|share| share >= DETERMINED),
        named("partly determined", &|share| (UNDETERMINED..DETERMINED).contains(&share)),
        named("not determined by these runs", &|share| share < UNDETERMINED),
        "single parameters are known less well than the ratios that they make together:".to_owned(),
    ]
}

/// What the data could and could not determine.
fn statement(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &[Run],
    fitted: &Fitted,
    parameter: &[ParameterEntry],
) -> Result<Vec<String>, VehicleError> {
    let mut statement = match fitted.procedure {
        Procedure::Compensation => vec![
            "one run: the compensation of each channel is fixed, no parameter of the truck; the \
             further speed and load are from the run's, the more of the vehicle file's uncertainty \
             comes back"
                .to_owned(),
        ],
        Procedure::MaximumAPosteriori => what_was_determined(parameter),
    };
    let prior = Belief::prior(vehicle);
    for run in runs {
        let sd = |belief: &Belief| -> Result<[f64; 2], VehicleError> {
            let c = belief.ratio_covariance(vehicle, variant, run.speed_mps, run.load)?;
            Ok([100.0 * c[0][0].sqrt(), 100.0 * c[1][1].sqrt()])
        };
        let (before, after) = (sd(&prior)?, sd(&fitted.belief)?);
        statement.push(format!(
            "{:.1} t at {:.1} m/s: steer ratio to {:.1} % (was {:.1}), lateral-acceleration ratio \
             to {:.1} % (was {:.1})",
            run.load.trailer_mass_kg / 1e3,
            run.speed_mps,
            after[0],
            before[0],
            after[1],
            before[1],
        ));
    }
    if fitted.chi_square > fitted.chi_square_limit() {
        statement.push(format!(
            "the runs contradict the vehicle file more than its [uncertainty] allows (chi-square \
             {:.1} for {} ratios): check heights, masses and units, or raise residual_sd",
            fitted.chi_square,
            fitted.residuals.len()
        ));
    }
    Ok(statement)
}
