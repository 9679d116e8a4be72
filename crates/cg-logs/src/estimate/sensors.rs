//! What the sensors of a drive cannot be, from their signals alone.

use cg_core::{Channel, Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::forces::ForceCheck;
use super::levels::LevelCheck;
use super::values::ValueCheck;

/// Checks specific forces, levels and the values of all signals of a drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct SensorCheck {
    forces: ForceCheck,
    levels: LevelCheck,
    values: ValueCheck,
    coarse_is_told: bool,
}

impl SensorCheck {
    /// Takes the next sample.
    pub fn push(&mut self, sample: &Sample<f64>, gravity_mps2: f64) {
        self.forces.push(sample, gravity_mps2);
        self.values.push(sample);
    }

    /// Takes the levels at one time, m; NaN without a value.
    pub fn level(&mut self, level_m: impl Fn(Quantity) -> f64) {
        self.levels.push(level_m);
    }

    /// Ends a maneuver.
    pub fn close(&mut self) {
        self.levels.close();
    }

    /// What is wrong with a specific force of a channel that is used.
    pub fn wrong_force(
        &self,
        gravity_mps2: f64,
        is_used: impl Fn(Channel) -> bool,
    ) -> Option<String> {
        self.forces.contradiction(gravity_mps2, is_used)
    }

    /// The level sensor that stands still, or the signal with zeros for missing samples.
    pub fn dead(&self) -> Option<String> {
        self.levels.contradiction().or_else(|| self.values.missing())
    }

    /// The signal whose steps are as large as its motion.
    pub fn coarse(&self) -> Option<String> {
        self.values.coarse()
    }

    /// The same, once.
    pub fn news(&mut self) -> Option<String> {
        let found = self.values.coarse().filter(|_| !self.coarse_is_told)?;
        self.coarse_is_told = true;
        Some(found)
    }
}
