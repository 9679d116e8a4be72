//! The calibration file: the posterior with its covariance, the runs on which it is based, and a
//! statement of what the runs determined.

use std::path::Path;

use cg_core::Channel;
use serde::{Deserialize, Serialize};

use crate::belief::{Belief, Covariance, Deviations, PARAMETERS, Parameter, log_ratios};
use crate::calibration::entry::ParameterEntry;
use crate::calibration::fit::{Fitted, Procedure, Run};
use crate::calibration::judgment::Judgment;
use crate::calibration::part::{Part, tractor};
use crate::calibration::statement::statements;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::files;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// Start of the line with the checksum of all lines before it; a comment in TOML.
const CHECKSUM: &str = "# crc32 ";
/// Greatest relative difference between a model ratio in the file and that of the present vehicle
/// file.
const SAME_RATIO: f64 = 1e-6;

/// A calibration of one vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Calibration {
    /// Name of the vehicle.
    pub vehicle: String,
    /// What it is for.
    #[serde(default)]
    pub part: Part,
    /// For the tractor alone: checksum of its data in the vehicle file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tractor: Option<String>,
    /// Version of the equations of the vehicle model.
    pub model: Variant,
    /// Date of the calibration.
    #[serde(default)]
    pub date: String,
    /// The method.
    pub procedure: Procedure,
    /// Text lines on what the runs could and could not determine.
    pub statement: Vec<String>,
    /// Text lines on where the runs and the vehicle file contradict each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contradiction: Vec<String>,
    /// Relative standard deviation of the model error that no calibration removes.
    pub residual_sd: f64,
    /// Sum of the squared residuals and squared parameter changes, each divided by its variance. It
    /// is about the number of ratios if the vehicle file's `[uncertainty]` is correct.
    pub chi_square: f64,
    /// `R_c` of each channel, including the gain of its sensor.
    pub compensation: Compensations,
    /// Covariance of the deviations of the parameters (logarithms of factors, or meters).
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
    /// For roll per steer angle.
    pub steer: f64,
    /// For roll per lateral acceleration.
    pub lateral_acceleration: f64,
    /// For the suspension roll per specific force of the trailer.
    #[serde(default = "one")]
    pub suspension: f64,
    /// For the suspension roll per specific force of the tractor.
    #[serde(default = "one")]
    pub tractor: f64,
}

fn one() -> f64 {
    1.0
}

impl Compensations {
    pub(super) fn of(belief: &Belief) -> Self {
        Self {
            steer: belief.gain(Channel::Steer),
            lateral_acceleration: belief.gain(Channel::LateralAcceleration),
            suspension: belief.gain(Channel::Suspension),
            tractor: belief.gain(Channel::Tractor),
        }
    }
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunEntry {
    /// Name of its log.
    pub log: String,
    /// Known height of the sprung c.g.
    pub height_m: f64,
    /// Trailer mass.
    pub trailer_mass_kg: f64,
    /// Mean speed of its turns, m/s.
    pub speed_mps: f64,
    /// Results of the channels.
    pub channel: Vec<ChannelEntry>,
}

/// One identified ratio of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelEntry {
    /// `steer` or `lateral-acceleration`.
    pub name: String,
    /// Identified DC ratio, rad per rad or rad per m/s².
    pub ratio: f64,
    /// Its standard deviation due to noise.
    pub ratio_sd: f64,
    /// The ratio of the model with the vehicle file, without calibration.
    pub model_ratio: f64,
    /// Identified ratio divided by the model's, minus one, before calibration, %.
    pub before_percent: f64,
    /// The same after calibration.
    pub after_percent: f64,
}

impl Calibration {
    /// The calibration file of a fit; the caller sets `date`.
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
        let parameter =
            Parameter::ALL.map(|name| ParameterEntry::new(name, &prior, belief)).to_vec();
        let [statement, contradiction] = statements(vehicle, variant, runs, fitted, &parameter)?;
        Ok(Self {
            vehicle: vehicle.name.clone(),
            part: Part::Vehicle,
            tractor: None,
            model: variant,
            date: String::new(),
            procedure: fitted.procedure,
            statement,
            contradiction,
            residual_sd: belief.residual_sd,
            chi_square: fitted.chi_square,
            compensation: Compensations::of(belief),
            covariance: (0..PARAMETERS)
                .map(|i| (0..PARAMETERS).map(|j| belief.covariance[(i, j)]).collect())
                .collect(),
            parameter,
            run: runs.iter().enumerate().map(|(i, run)| run_entry(i, run, fitted)).collect(),
        })
    }

    /// Reads a calibration file and checks that it belongs to the present version of this vehicle.
    ///
    /// # Errors
    /// [`VehicleError`] with the file, the position and the reason.
    pub fn load(path: impl AsRef<Path>, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let text = files::read_text(path, files::VEHICLE_BYTES)
            .map_err(|source| VehicleError::Read { file: file.clone(), source })?;
        Self::parse(&text, &file, vehicle)
    }

    /// Checks the text of a calibration of `vehicle`; `file` is its name in messages. The last line
    /// must contain the checksum of all lines before it, so an edited or truncated file is refused.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, file: &str, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let mut calibration: Self =
            toml::from_str(text).map_err(|source| VehicleError::syntax(file, &source))?;
        let prior = Belief::prior(vehicle);
        calibration.add_new_parameters(&prior);
        calibration
            .check(vehicle)
            .and_then(|()| check_sum(text))
            .map_err(|reason| VehicleError::Model(format!("{file}: {reason}")))?;
        calibration.take_prior(&prior);
        Ok(calibration)
    }

    /// The text of the calibration file.
    ///
    /// # Errors
    /// If a number cannot be written, which would be a program error.
    pub fn to_toml(&self) -> Result<String, VehicleError> {
        let text = toml::to_string(self)
            .map_err(|error| VehicleError::Model(format!("calibration: {error}")))?;
        let text = format!(
            "# Calibration of the vehicle \"{}\" (cg calibrate). The vehicle file is not changed by it.\n\
             # The last line holds the checksum of all before it: do not edit.\n{text}",
            // A line break in a name would end the comment.
            self.vehicle.replace(char::is_control, " ")
        );
        Ok(format!("{text}{CHECKSUM}{:08x}\n", files::checksum(&text)))
    }

    /// Whether its runs are possible for the vehicle file.
    pub fn judgment(&self) -> Judgment {
        match self.procedure {
            // One factor for each ratio explains everything.
            Procedure::Compensation => Judgment::Sound,
            Procedure::MaximumAPosteriori => {
                Judgment::of(self.chi_square, self.run.iter().map(|run| run.channel.len()).sum())
            }
        }
    }

    /// The posterior distribution of the parameters. If the runs contradict the vehicle file, all
    /// standard deviations are multiplied by the Birge ratio.
    pub fn belief(&self) -> Belief {
        let mut mean = Deviations::zeros();
        for entry in &self.parameter {
            mean[entry.name as usize] = entry.deviation();
        }
        let birge = self.judgment().birge();
        let covariance = Covariance::from_fn(|i, j| birge * birge * self.covariance[i][j]);
        Belief { mean, covariance, residual_sd: birge * self.residual_sd }
    }

    /// The same calibration for the tractor alone: it holds with any trailer.
    #[must_use]
    pub fn of_tractor(mut self, vehicle: &Vehicle) -> Self {
        self.part = Part::Tractor;
        self.tractor = Some(tractor(vehicle));
        self.take_prior(&Belief::prior(vehicle));
        self.compensation = Compensations::of(&self.belief());
        self.statement.push(
            "of the tractor alone: the trailer, and what it shares with the tractor (tires, roll \
             centers), is as in the vehicle file"
                .to_owned(),
        );
        self
    }

    /// Replaces what is not of the calibrated part by the prior. The parameters that remain keep
    /// their joint uncertainty.
    fn take_prior(&mut self, prior: &Belief) {
        for entry in &mut self.parameter {
            let k = entry.name as usize;
            if self.part.keeps(entry.name) {
                continue;
            }
            *entry = ParameterEntry::new(entry.name, prior, prior);
            for j in 0..self.covariance.len() {
                self.covariance[j][k] = 0.0;
                self.covariance[k][j] = 0.0;
            }
            self.covariance[k][k] = prior.covariance[(k, k)];
        }
    }

    /// Adds the parameters that did not exist when the calibration was made: it did not change them.
    fn add_new_parameters(&mut self, prior: &Belief) {
        let known = self.parameter.len();
        if self.covariance.len() != known || self.covariance.iter().any(|row| row.len() != known) {
            return; // damaged; the check tells it
        }
        for &name in Parameter::ALL.iter().skip(known) {
            let k = name as usize;
            self.parameter.push(ParameterEntry::new(name, prior, prior));
            self.covariance.iter_mut().for_each(|row| row.push(0.0));
            let mut row = vec![0.0; k + 1];
            row[k] = prior.covariance[(k, k)];
            self.covariance.push(row);
        }
    }

    fn check(&self, vehicle: &Vehicle) -> Result<(), String> {
        if self.part == Part::Vehicle && self.vehicle != vehicle.name {
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
                 run cg calibrate again"
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
        match self.part {
            Part::Vehicle => self.check_model(vehicle),
            Part::Tractor if self.tractor == Some(tractor(vehicle)) => Ok(()),
            Part::Tractor => Err(
                "this calibration belongs to another tractor: [tractor], its tires and springs, or \
                 [hitch] differ from those of the vehicle file with which it was made"
                    .to_owned(),
            ),
        }
    }

    /// Detects a change of the vehicle file since the calibration by its model ratios.
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
                         is {now:.6} instead of {:.6}); run cg calibrate again",
                        entry.model_ratio
                    ));
                }
            }
        }
        Ok(())
    }
}

/// Whether the text is unchanged since it was written.
fn check_sum(text: &str) -> Result<(), String> {
    let text = text.trim_ascii_end();
    let (content, last) = text.rsplit_once('\n').unwrap_or(("", text));
    let (content, stated) = match last.strip_prefix(CHECKSUM) {
        Some(stated) => (content, Some(stated)),
        None => (text, None),
    };
    let now = files::checksum(content);
    let what = match stated {
        Some(stated) if u32::from_str_radix(stated, 16) == Ok(now) => return Ok(()),
        Some(_) => "was edited or damaged since it was made: its checksum is wrong",
        None => "was edited, cut short or made by an older version: it has no checksum",
    };
    Err(format!(
        "the calibration {what}; run cg calibrate again, or make \"{CHECKSUM}{now:08x}\" its last \
         line if you have checked every number in it"
    ))
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
