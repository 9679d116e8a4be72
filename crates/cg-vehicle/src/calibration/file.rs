//! The calibration file: the posterior with its covariance, the runs on which it is based, and a
//! statement of what the runs determined.

use std::collections::BTreeMap;
use std::path::Path;

use cg_core::Channel;
use serde::{Deserialize, Serialize};

use crate::belief::{Belief, Covariance, Deviations, PARAMETERS, Parameter};
use crate::calibration::entry::{Compensations, ParameterEntry, RatioUnit, RunEntry, ShapeEntry};
use crate::calibration::fit::{Fitted, Procedure};
use crate::calibration::judgment::Judgment;
use crate::calibration::part::{Part, changed, checksums};
use crate::calibration::possible;
use crate::calibration::ratios::Run;
use crate::calibration::shape::Shape;
use crate::calibration::statement::{of_shapes, statements};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::files::{self, Unsealed};
use crate::lift::Positions;
use crate::load::Load;
use crate::ratio_spread::log_ratios_of_file;
use crate::reduction::Shapes;
use crate::vehicle::Vehicle;

const FORMAT: &str = "cg-height calibration";
const VERSION: u32 = 1;
/// Start of the line with the checksum of all lines before it; a comment in TOML.
const CHECKSUM: &str = "# crc32 ";
/// Greatest relative difference between a model ratio in the file and that of the present equations.
const SAME_RATIO: f64 = 1e-6;

/// A calibration of one vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Calibration {
    format: String,
    version: u32,
    /// Name of the vehicle.
    pub vehicle: String,
    /// What it is for.
    #[serde(default)]
    pub part: Part,
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
    /// Checksums of the parts of the vehicle file on which the calibration depends.
    pub vehicle_crc32: BTreeMap<String, String>,
    /// `R_c` of each channel, including the gain of its sensor.
    pub compensation: Compensations,
    /// Covariance of the deviations of the parameters (logarithms of factors, or meters).
    pub covariance: Vec<Vec<f64>>,
    /// The parameters, in the order of the covariance.
    pub parameter: Vec<ParameterEntry>,
    /// The runs.
    pub run: Vec<RunEntry>,
    /// The compensation functions `F(s)` of the channels that at least one run has; without an entry, the
    /// order is 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shape: Vec<ShapeEntry>,
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
        let runs = &fitted.placed(runs);
        let parameter =
            Parameter::ALL.map(|name| ParameterEntry::new(name, &prior, belief)).to_vec();
        let [statement, contradiction] = statements(vehicle, variant, runs, fitted, &parameter)?;
        let calibration = Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            vehicle: vehicle.name.clone(),
            part: Part::Vehicle,
            vehicle_crc32: checksums(vehicle, Part::Vehicle)?,
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
            run: runs.iter().enumerate().map(|(i, run)| RunEntry::new(i, run, fitted)).collect(),
            shape: Vec::new(),
        };
        calibration.check_numbers().map_err(|reason| {
            VehicleError::Model(format!("no calibration is made: {reason}; check the units"))
        })?;
        Ok(calibration)
    }

    /// Adds the shapes of the responses, and a statement on them.
    pub fn add_shapes(&mut self, shapes: &[Shape]) {
        self.shape = shapes.iter().map(ShapeEntry::new).collect();
        self.statement.extend(of_shapes(&self.shape));
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
        let syntax = |source| syntax(text, file, &source);
        let refused = |reason: String| VehicleError::Model(format!("{file}: {reason}"));
        toml::from_str(text)
            .map_err(syntax)
            .and_then(|head: Head| head.check().map_err(refused))?;
        let mut calibration: Self = toml::from_str(text).map_err(syntax)?;
        let prior = Belief::prior(vehicle);
        calibration.add_new_parameters(&prior);
        calibration
            .check_vehicle(vehicle)
            .and_then(|()| {
                let again = |reason| format!("{reason}; run cg calibrate again");
                calibration.check_numbers().map_err(again)
            })
            .and_then(|()| calibration.check_model(vehicle))
            .and_then(|()| check_sum(text))
            .map_err(refused)?;
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
        Ok(files::sealed(&text, CHECKSUM))
    }

    /// Whether its runs are possible for the vehicle file.
    pub fn judgment(&self) -> Judgment {
        match self.procedure {
            // One factor for each ratio explains everything.
            Procedure::Compensation => Judgment::Sound,
            Procedure::MaximumAPosteriori => {
                let told = |run: &RunEntry| {
                    run.channel.len().saturating_sub(usize::from(run.height_sd_m.is_some()))
                };
                Judgment::of(self.chi_square, self.run.iter().map(told).sum())
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
        let mut shapes = Shapes::default();
        for (channel, function) in self.shape.iter().filter_map(ShapeEntry::function) {
            shapes[channel.index()] = Some(function);
        }
        Belief { mean, covariance, residual_sd: birge * self.residual_sd, shapes }
    }

    /// The same calibration for the tractor alone: it holds with any trailer.
    ///
    /// # Errors
    /// As [`Self::to_toml`].
    pub fn of_tractor(mut self, vehicle: &Vehicle) -> Result<Self, VehicleError> {
        self.part = Part::Tractor;
        self.vehicle_crc32 = checksums(vehicle, Part::Tractor)?;
        self.take_prior(&Belief::prior(vehicle));
        self.compensation = Compensations::of(&self.belief());
        self.statement.push(
            "of the tractor alone: the trailer, and what it shares with the tractor (tires, roll \
             centers), is as in the vehicle file"
                .to_owned(),
        );
        Ok(self)
    }

    /// Replaces what is not of the calibrated part by the prior. The parameters that remain keep
    /// their joint uncertainty.
    fn take_prior(&mut self, prior: &Belief) {
        if self.part != Part::Vehicle {
            self.shape.clear();
        }
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

    /// Whether the calibration was made for this vehicle, as its file is now.
    fn check_vehicle(&self, vehicle: &Vehicle) -> Result<(), String> {
        if self.part == Part::Vehicle && self.vehicle != vehicle.name {
            return Err(format!(
                "this calibration belongs to the vehicle \"{}\", not to \"{}\"",
                self.vehicle, vehicle.name
            ));
        }
        let now = checksums(vehicle, self.part).map_err(|error| error.to_string())?;
        let changed = changed(&self.vehicle_crc32, &now);
        match self.part {
            _ if changed.is_empty() => Ok(()),
            Part::Vehicle => Err(format!(
                "the vehicle file has changed since this calibration ({changed}); run cg calibrate \
                 again"
            )),
            Part::Tractor => Err(format!(
                "this calibration belongs to another tractor: the vehicle file with which it was made \
                 has other data ({changed})"
            )),
        }
    }

    /// Whether all numbers are possible.
    fn check_numbers(&self) -> Result<(), String> {
        possible::parameters(&self.parameter, &self.covariance)?;
        possible::compensations(&self.compensation)?;
        possible::misfit(self.residual_sd, self.chi_square)?;
        self.run.iter().try_for_each(possible::run)?;
        possible::shapes(&self.shape)
    }

    /// Whether the equations of the model still give the ratios on which the calibration is based.
    fn check_model(&self, vehicle: &Vehicle) -> Result<(), String> {
        if self.part != Part::Vehicle {
            return Ok(()); // the trailer may be another one
        }
        let positions = Positions::of(vehicle).map_err(|error| error.to_string())?;
        for run in &self.run {
            let vehicle = positions.at(run.lift_axle).map_err(|error| error.to_string())?;
            let load = Load { trailer_mass_kg: run.trailer_mass_kg, cg_height_m: run.height_m };
            let logs = log_ratios_of_file(vehicle, self.model, (run.speed_mps, run.turn_g), load)
                .map_err(|error| error.to_string())?;
            for entry in &run.channel {
                let channel: Channel =
                    entry.name.parse().map_err(|error| format!("run {}: {error}", run.log))?;
                if entry.unit != RatioUnit::of(channel) {
                    return Err(format!(
                        "run {}: the unit of its {channel} ratio is wrong",
                        run.log
                    ));
                }
                let now = libm::exp(logs[channel.index()]);
                if !((now / entry.model_ratio - 1.0).abs() <= SAME_RATIO) {
                    return Err(format!(
                        "the equations have changed since this calibration (the {channel} ratio is \
                         {now:.6} instead of {:.6}); run cg calibrate again",
                        entry.model_ratio
                    ));
                }
            }
        }
        Ok(())
    }
}

/// The first keys of a file, which every version has.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    version: Option<u64>,
}

impl Head {
    /// Whether this program can read the file.
    fn check(&self) -> Result<(), String> {
        match self.version {
            _ if self.format.as_deref() != Some(FORMAT) => Err(format!(
                "it has no format = \"{FORMAT}\": it is another kind of file, or a calibration by an \
                 older version of cg; run cg calibrate again"
            )),
            Some(version) if version == u64::from(VERSION) => Ok(()),
            Some(version) => Err(format!(
                "it is a calibration of version {version}, but this program reads version {VERSION}; \
                 use the cg that made it, or run cg calibrate again"
            )),
            None => Err("it is a calibration without a version; run cg calibrate again".to_owned()),
        }
    }
}

/// The error for a text that is not a calibration in TOML. Of one that is cut off, it says so.
fn syntax(text: &str, file: &str, source: &toml::de::Error) -> VehicleError {
    match files::unsealed(text, CHECKSUM) {
        Err(reason) if text.contains(FORMAT) => VehicleError::Model(format!(
            "{file}: the calibration is incomplete or was changed since it was made: {reason}, and {}; copy \
             the whole file again, or run cg calibrate again",
            source.message().trim_end()
        )),
        _ => VehicleError::syntax(file, source),
    }
}

/// Whether the text is unchanged since it was written.
fn check_sum(text: &str) -> Result<(), String> {
    let (what, now) = match files::unsealed(text, CHECKSUM) {
        Ok(_) => return Ok(()),
        Err(Unsealed::Wrong { now }) => {
            ("was edited or damaged since it was made: its checksum is wrong", now)
        }
        Err(Unsealed::Absent { now }) => ("was edited or cut short: it has no checksum", now),
    };
    Err(format!(
        "the calibration {what}; run cg calibrate again, or make \"{CHECKSUM}{now:08x}\" its last \
         line if you have checked every number in it"
    ))
}
