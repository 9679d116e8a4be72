//! What is said of a height after a maneuver.

use std::io::{self, Write};

use cg_core::{Channel, Combined, Maneuver};

use super::Session;

impl<W: Write> Session<W> {
    /// Reports what the user should know, each once.
    pub(super) fn remark(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        self.report_lean()?;
        if let Some(message) = self.options.unplaced(&maneuver.outcomes) {
            self.options.roll_sensor_is_unplaced = false; // is told
            self.notice("roll_sensor", message)?;
        }
        Ok(())
    }

    /// Reports once for each load that the trailer leans in straight driving.
    fn report_lean(&mut self) -> io::Result<()> {
        let mass_kg = self.known.trailer_mass_kg;
        let found = self.leaning.and_then(|leaning| leaning.message(self.options.lean, mass_kg));
        let Some(message) = found else { return Ok(()) };
        self.leaning = None;
        self.notice("lean", &message)
    }

    /// The height of all channels; none can be right if a specific force is not one.
    pub(super) fn combined(&self) -> Option<Combined<f64>> {
        let wrong = self.wrong_force().map(|_| Combined::Impossible);
        wrong.or_else(|| self.estimator.combined())
    }

    /// What is wrong with a specific force from which there is a height.
    pub(super) fn wrong_force(&self) -> Option<String> {
        let is_used = |channel: Channel| self.estimator.height(channel).is_some();
        let gravity_mps2 = self.estimator.design().gravity_mps2;
        let found = self.forces.contradiction(gravity_mps2, is_used)?;
        Some(format!("inconsistent, so there is no height: {found}"))
    }
}
