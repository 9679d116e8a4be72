//! The tables of a calibration file: parameters, runs with their ratios, and `R_c`.

use cg_core::Channel;
use cg_core::truck::channel::Input;
use serde::{Deserialize, Serialize};

use crate::belief::{Belief, Parameter};
use crate::calibration::fit::Fitted;
use crate::calibration::ratios::Run;
use crate::calibration::shape::Shape;
use crate::lift::LiftAxle;
use crate::system::Rational;

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterEntry {
    /// The parameter.
    pub name: Parameter,
    /// `factor` to multiply the value of the vehicle file with, or `m` to add to it.
    pub unit: Unit,
    /// Value of the factor or of the shift.
    pub value: f64,
    /// Standard deviation (relative for a factor).
    pub sd: f64,
    /// Standard deviation before the calibration.
    pub prior_sd: f64,
    /// Share of the prior variance that the runs removed.
    pub determined: f64,
}

impl ParameterEntry {
    /// The entry of a parameter; `prior` is what was known before.
    pub(super) fn new(name: Parameter, prior: &Belief, belief: &Belief) -> Self {
        let k = name as usize;
        let (before, after) = (prior.covariance[(k, k)], belief.covariance[(k, k)]);
        let unit = Unit::of(name);
        let value = match unit {
            Unit::Factor => libm::exp(belief.mean[k]),
            Unit::M => belief.mean[k],
        };
        let determined = if before > 0.0 { 1.0 - after / before } else { 0.0 };
        Self { name, unit, value, sd: after.sqrt(), prior_sd: before.sqrt(), determined }
    }

    /// The deviation from the vehicle file: the logarithm of a factor, or meters.
    pub fn deviation(&self) -> f64 {
        if self.name.is_factor() { libm::log(self.value) } else { self.value }
    }
}

/// Unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// A factor of the value in the vehicle file.
    Factor,
    /// A shift of the value in the vehicle file, in meters.
    M,
}

impl Unit {
    /// The unit of a parameter.
    pub fn of(name: Parameter) -> Self {
        if name.is_factor() { Self::Factor } else { Self::M }
    }
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
    /// Height of the sprung c.g.
    pub height_m: f64,
    /// Standard deviation with which it was known; 0 is exact.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub known_height_sd_m: f64,
    /// Standard deviation of a height that was not known but found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_sd_m: Option<f64>,
    /// Trailer mass.
    pub trailer_mass_kg: f64,
    /// Its standard deviation; 0 is exact.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub trailer_mass_sd_kg: f64,
    /// Where the lift axles were.
    #[serde(default, skip_serializing_if = "LiftAxle::is_down")]
    pub lift_axle: LiftAxle,
    /// Mean speed of its turns, m/s.
    pub speed_mps: f64,
    /// Lateral acceleration of its turns, g; absent if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_g: Option<f64>,
    /// Results of the channels.
    pub channel: Vec<ChannelEntry>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// One identified ratio of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelEntry {
    /// `steer`, `lateral-acceleration`, `suspension` or `tractor`.
    pub name: String,
    /// Unit of the three ratios.
    pub unit: RatioUnit,
    /// Identified DC ratio.
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

impl RunEntry {
    pub(super) fn new(index: usize, run: &Run, fitted: &Fitted) -> Self {
        let percent = |log: f64| 100.0 * libm::expm1(log);
        let channel = fitted
            .residuals
            .iter()
            .filter(|residual| residual.run == index)
            .filter_map(|residual| {
                let ratio = run.ratio[residual.channel.index()]?;
                Some(ChannelEntry {
                    name: residual.channel.to_string(),
                    unit: RatioUnit::of(residual.channel),
                    ratio: ratio.value,
                    ratio_sd: ratio.sd,
                    model_ratio: ratio.value * libm::exp(-residual.before),
                    before_percent: percent(residual.before),
                    after_percent: percent(residual.after),
                })
            })
            .collect();
        Self {
            log: run.log.clone(),
            height_m: run.load.cg_height_m,
            known_height_sd_m: if run.height_is_known() { run.height_sd_m } else { 0.0 },
            height_sd_m: fitted.heights[index].map(|found| found.sd),
            trailer_mass_kg: run.load.trailer_mass_kg,
            trailer_mass_sd_kg: run.trailer_mass_sd_kg,
            lift_axle: run.lift_axle,
            speed_mps: run.speed_mps,
            turn_g: run.turn_g,
            channel,
        }
    }
}

/// Unit of a DC ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RatioUnit {
    /// Roll angle per steer angle.
    RadPerRad,
    /// Roll angle per acceleration.
    RadPerMps2,
}

impl RatioUnit {
    /// The unit of the ratio of a channel.
    pub fn of(channel: Channel) -> Self {
        match channel.input() {
            Input::Steer => Self::RadPerRad,
            Input::LateralAcceleration | Input::SpecificForce | Input::TractorSpecificForce => {
                Self::RadPerMps2
            }
        }
    }
}

/// The compensation function `F(s)` of a channel, with `F(0) = 1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShapeEntry {
    /// Name of the channel.
    pub name: String,
    /// Its order; 0 if no function makes every run better.
    pub order: usize,
    /// Coefficients in descending powers of s.
    pub numerator: Vec<f64>,
    /// Coefficients in descending powers of s; the first is one.
    pub denominator: Vec<f64>,
    /// Number of runs.
    pub runs: usize,
    /// What the model leaves of the roll angle of a run, rms in %.
    pub before_percent: f64,
    /// What it leaves with the function of the other runs.
    pub after_percent: f64,
}

impl ShapeEntry {
    pub(super) fn new(shape: &Shape) -> Self {
        let rms_percent = |order: usize| {
            let all = &shape.left_out[order];
            #[allow(clippy::cast_precision_loss)] // runs
            let count = all.len() as f64;
            100.0 * (all.iter().map(|share| share * share).sum::<f64>() / count).sqrt()
        };
        let descending = |ascending: &[f64]| ascending.iter().rev().copied().collect();
        let (numerator, denominator) = match &shape.function {
            Some(function) => (descending(&function.numerator), descending(&function.denominator)),
            None => (vec![1.0], vec![1.0]),
        };
        Self {
            name: shape.channel.to_string(),
            order: shape.order(),
            numerator,
            denominator,
            runs: shape.left_out[0].len(),
            before_percent: rms_percent(0),
            after_percent: rms_percent(shape.order()),
        }
    }

    /// The channel and its function; `None` if the order is 0 or there is no such channel.
    pub(super) fn function(&self) -> Option<(Channel, Rational)> {
        let ascending = |descending: &[f64]| descending.iter().rev().copied().collect();
        let (numerator, denominator) = (ascending(&self.numerator), ascending(&self.denominator));
        let channel = self.name.parse().ok()?;
        (self.order > 0).then_some((channel, Rational { numerator, denominator }))
    }
}
