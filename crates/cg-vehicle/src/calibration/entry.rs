//! A parameter in a calibration file.

use serde::{Deserialize, Serialize};

use crate::belief::{Belief, Parameter};

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
        let (unit, value) = if name.is_factor() {
            (Unit::Factor, belief.mean[k].exp())
        } else {
            (Unit::M, belief.mean[k])
        };
        let determined = if before > 0.0 { 1.0 - after / before } else { 0.0 };
        Self { name, unit, value, sd: after.sqrt(), prior_sd: before.sqrt(), determined }
    }

    /// The deviation from the vehicle file: the logarithm of a factor, or meters.
    pub fn deviation(&self) -> f64 {
        if self.name.is_factor() { self.value.ln() } else { self.value }
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
