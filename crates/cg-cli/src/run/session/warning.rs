//! The rollover warning and the requested speed, sample by sample.

use std::io::{self, Write};

use cg_core::Sample;
use cg_logs::estimate::felt_mps2;
use cg_logs::log::Signal;

use super::Session;
use crate::run::events::Event;

impl<W: Write> Session<W> {
    pub(super) fn warn(&mut self, sample: &Sample<f64>) -> io::Result<()> {
        let design = self.estimator.design();
        let mass_kg = self.trailer_mass_kg.unwrap_or(self.estimator.memory().trailer_mass_kg);
        let is_judged = self.sensors.push(sample, design);
        let load = [mass_kg, self.known.height_m.unwrap_or(design.reference_height_m)];
        let lateral_mps2 = felt_mps2(design, sample, self.speed_mps, load);
        // Without a speed, the last one is used.
        if sample.speed_mps.is_finite() {
            self.speed_mps = sample.speed_mps;
            self.known.at_speed(self.estimator.design(), self.speed_mps);
        }
        if is_judged {
            self.wrong_before.take_if(|_| self.sensors.is_known());
            self.judge_signals()?;
        }
        self.follow(sample.time_us, lateral_mps2)
    }

    /// Follows the warning and the requested speed by a lateral acceleration, NaN without a signal.
    pub(super) fn follow(&mut self, time_us: u64, lateral_mps2: f64) -> io::Result<()> {
        let design = self.estimator.design();
        let threshold_g = self.known.threshold_g;
        let level = self.warner.push(time_us, lateral_mps2, threshold_g, design.gravity_mps2);
        if let Some(level) = level {
            let margin_g = self.known.margin_g(self.lateral_g());
            self.write_event(&Event::Warning { level, margin_g })?;
        }
        // A request needs the present speed.
        let is_present = !self.missing.contains(&Signal::Speed.name());
        let speed_mps = if is_present { self.speed_mps } else { f64::NAN };
        let motion = [speed_mps, self.warner.lateral_mps2().unwrap_or(f64::NAN)];
        let Some(request) = &mut self.request else { return Ok(()) };
        if request.update(self.estimator.design(), &self.known, motion) {
            let requested_speed_mps = request.speed_mps;
            return self.write_event(&Event::SpeedRequest { requested_speed_mps });
        }
        Ok(())
    }

    pub(super) fn lateral_g(&self) -> Option<f64> {
        Some(self.warner.lateral_mps2()? / self.estimator.design().gravity_mps2)
    }
}
