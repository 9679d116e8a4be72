//! The mass of the trailer and where it comes from.

use std::io::{self, Write};

use cg_core::{Maneuver, Sample};
use cg_logs::estimate::{is_held, weighed_mass};

use super::Session;
use crate::run::doubted::DoubtedMass;
use crate::run::events::MassSource;

/// A part of the load that changes by this share of the mass counts anew.
const PART_STEP: f64 = 0.005;

impl<W: Write> Session<W> {
    /// Sets the mass of the sample, and reports its source.
    pub(super) fn weigh(&mut self, sample: &mut Sample<f64>) -> io::Result<()> {
        let mut is_new = false;
        let is_first = if let Some(mass_kg) = self.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
            self.samples == 1
        } else if sample.trailer_mass_kg.is_nan() {
            self.unweighed_us.get_or_insert(sample.time_us);
            // A scale that sends once has told of another load, too.
            let held_kg = self.weighed_kg.filter(|_| self.other_mass_us.is_some());
            return held_kg.map_or(Ok(()), |trailer_mass_kg| {
                self.unload(&Sample { trailer_mass_kg, ..*sample }, false)
            });
        } else {
            let signal_kg = sample.trailer_mass_kg;
            sample.trailer_mass_kg = weighed_mass(self.estimator.design(), signal_kg);
            let masses_kg = [signal_kg, sample.trailer_mass_kg];
            is_new = self.weighing.weigh(sample.time_us, masses_kg, sample.speed_mps);
            self.weighed_kg.replace(sample.trailer_mass_kg).is_none()
        };
        self.unload(sample, is_first)?;
        if is_new {
            self.unload_part();
        }
        if is_new && self.doubted.was_old {
            self.doubted = DoubtedMass::default();
        }
        if self.trailer_mass_kg.is_none() && self.mass_source != MassSource::Signal {
            self.mass_source = MassSource::Signal;
            if self.nominal_mass_reported {
                let message = format!(
                    "a signal gives a trailer mass of {:.0} kg, which is used from now on",
                    sample.trailer_mass_kg
                );
                return self.notice("mass", &message);
            }
        }
        Ok(())
    }

    /// Makes the interval wider by a part of the load that came or went since the last turn with a height, and that is too small to
    /// hide it.
    fn unload_part(&mut self) {
        let part_kg = self.weighing.weighed.part_kg(self.height_kg);
        if (part_kg - self.part_kg).abs() > PART_STEP * self.height_kg {
            self.part_kg = part_kg;
            self.update(self.known.trailer_mass_kg);
        }
    }

    /// Standard deviation of the height, m, because of that part, whose c.g. may be anywhere in the range of heights.
    pub(super) fn part_sd_m(&self) -> f64 {
        let design = self.estimator.design();
        let range_m = design.greatest_height_m - design.least_height_m;
        self.part_kg / self.known.trailer_mass_kg * range_m / 12.0_f64.sqrt()
    }

    /// Says that the mass is that of the load before a turn with another load.
    pub(super) fn doubt_held_mass(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let (mass_kg, before_kg) = (maneuver.trailer_mass_kg, self.turn_kg);
        let masses_kg = [before_kg, mass_kg];
        let outdated = self.weighing.unload(maneuver.start_us, masses_kg, self.mass_source);
        if let Some(message) = outdated {
            self.notice("mass", message)
        } else if self.mass_source != MassSource::Nominal && is_held(mass_kg, before_kg) {
            let message = format!(
                "a turn shows another load, but the trailer mass is still {mass_kg:.0} kg: if the trailer was not weighed \
                 again, the height is wrong; give --trailer-mass-kg of this load or a signal of the mass"
            );
            self.notice("mass", &message)
        } else {
            Ok(())
        }
    }

    /// Reports once that the vehicle file's mass is used as that of the trailer.
    pub(super) fn report_nominal_mass(&mut self) -> io::Result<()> {
        let nominal = self.mass_source == MassSource::Nominal && self.unweighed_us.is_some();
        if !nominal || std::mem::replace(&mut self.nominal_mass_reported, true) {
            return Ok(());
        }
        let nominal_kg = self.estimator.design().nominal_trailer_mass_kg;
        let message = format!(
            "no signal gives the trailer mass: {nominal_kg:.0} kg from the vehicle file is used; a \
             wrong mass gives a wrong height, so give --trailer-mass-kg or a signal of the mass"
        );
        self.notice("mass", &message)
    }
}
