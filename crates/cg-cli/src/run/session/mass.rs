//! The mass of the trailer: where it comes from, and whether it is that of the load whose height is known; the load before a
//! restart.

use std::io::{self, Write};

use cg_core::{HeightError, Maneuver, Reject, Sample, Settings};
use cg_logs::estimate::{Engine, LeftOut, SinceStop, StrongTurns, Weighed, weighed_mass};

use super::Session;
use crate::run::events::{MassSource, Result as Known};
use crate::run::state::Found;

impl<W: Write> Session<W> {
    /// Restores the memory that was saved before a restart. Returns whether there was one.
    pub(crate) fn restore(&mut self) -> io::Result<bool> {
        match self.outputs.load() {
            Some(Ok(Found::State(state))) => {
                let memory = state.memory(self.trips_in_use);
                let restored = Engine::restored(self.estimator.design(), &self.options, &memory);
                let Some(estimator) = restored else { return Ok(false) };
                self.estimator = estimator;
                (self.load_since_s, self.weighing.scale) = (state.load_since_s, state.scale);
                self.weighing.weighed = Weighed::kept(state.mass_is_of_another_load);
                self.strong = StrongTurns::kept(state.strength);
                self.left_out = LeftOut::new(&self.estimator);
                self.stop = SinceStop::restarted(&self.estimator);
                // The nominal mass means that the load was not weighed.
                let nominal_kg = self.estimator.design().nominal_trailer_mass_kg;
                let weighed = (memory.trailer_mass_kg - nominal_kg).abs() > 1e-6 * nominal_kg;
                if weighed && self.mass_source == MassSource::Nominal {
                    self.mass_source = MassSource::Kept;
                }
                self.update(memory.load_mass_kg.unwrap_or(memory.trailer_mass_kg));
                Ok(true)
            }
            Some(Ok(Found::PutAside(path, reason))) => {
                let message = format!("not used and renamed to {}: {reason}", path.display());
                self.notice("state", &message).map(|()| false)
            }
            Some(Err(error)) => {
                self.notice("state", &format!("cannot be read: {error}")).map(|()| false)
            }
            Some(Ok(Found::Nothing)) | None => Ok(false),
        }
    }

    /// Sets the mass of the sample, and reports its source.
    pub(super) fn weigh(&mut self, sample: &mut Sample<f64>) -> io::Result<()> {
        let is_first = if let Some(mass_kg) = self.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
            self.samples == 1
        } else if sample.trailer_mass_kg.is_nan() {
            self.unweighed_us.get_or_insert(sample.time_us);
            return Ok(());
        } else {
            let signal_kg = sample.trailer_mass_kg;
            sample.trailer_mass_kg = weighed_mass(self.estimator.design(), signal_kg);
            self.weighing.weighed.weigh(sample.time_us, [signal_kg, sample.trailer_mass_kg]);
            self.weighed_kg.replace(sample.trailer_mass_kg).is_none()
        };
        self.unload(sample, is_first)?;
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

    /// Shows no height of a load that is not on the trailer any more: of one before a restart (with the first mass of a
    /// signal), or of one that was never weighed, at once, otherwise after the time within which a mass varies in a turn. The
    /// next maneuver of the new load shows the same to the estimator, which then discards its heights.
    fn unload(&mut self, sample: &Sample<f64>, is_first: bool) -> io::Result<()> {
        let (mass_kg, known_kg) = (sample.trailer_mass_kg, self.known.trailer_mass_kg);
        if std::mem::take(&mut self.kept_mass_is_doubted) && is_other_load(mass_kg, known_kg) {
            self.hidden_kg = Some(known_kg); // the turns were right
        }
        if let Some(hidden_kg) = self.hidden_kg {
            if !is_other_load(mass_kg, hidden_kg) {
                self.update(hidden_kg); // the load is back
            }
            return Ok(());
        }
        let settings = Settings::<f64>::truck();
        if self.known.height_m.is_none() || !is_other_load(mass_kg, known_kg) {
            self.other_mass_us = None;
            return Ok(());
        }
        let since_us = *self.other_mass_us.get_or_insert(sample.time_us);
        let lasts = sample.time_us.saturating_sub(since_us) >= settings.weighing_us;
        let was_weighed = self.mass_source != MassSource::Nominal;
        if !lasts && !is_first && was_weighed {
            return Ok(());
        }
        self.hidden_kg = Some(known_kg);
        self.known = Known::new(None, None, (mass_kg, self.mass_source));
        let message = format!(
            "the trailer mass is {mass_kg:.0} kg and was {known_kg:.0} kg: the height of the load before it is no longer \
             shown; the next turn gives that of the present load"
        );
        self.notice("load", &message)
    }

    /// Hides the height of a load that was weighed before a restart if a turn says that another one is on the trailer: at the
    /// old mass its height is impossible. The next turn with a possible height shows it again.
    pub(super) fn doubt_kept_mass(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let impossible_m = maneuver.outcomes.iter().find_map(|one| match one.height_m {
            Err(Reject::Height(HeightError::OutOfRange { height_m })) => Some(height_m),
            _ => None,
        });
        let is_possible = maneuver.outcomes.iter().any(|one| one.height_m.is_ok());
        let was_doubted = self.kept_mass_is_doubted;
        match impossible_m {
            _ if is_possible || self.mass_source != MassSource::Kept => {
                self.kept_mass_is_doubted = false;
            }
            Some(height_m) if !was_doubted => {
                self.kept_mass_is_doubted = true;
                let mass_kg = self.known.trailer_mass_kg;
                let message = format!(
                    "a turn gives a height of {height_m:.2} m, which no load has at the trailer mass of {mass_kg:.0} kg from \
                     before the restart, and no signal has given another one: the trailer was loaded or unloaded, so the height \
                     of the load before is not shown; give --trailer-mass-kg or a signal of the mass"
                );
                return self.notice("load", &message);
            }
            _ => {}
        }
        Ok(())
    }

    /// The mass of a load whose height is hidden, if the trailer still has another one, kg.
    pub(super) fn hidden_mass_kg(&mut self) -> Option<f64> {
        if self.kept_mass_is_doubted && self.weighed_kg.is_none() {
            return Some(self.known.trailer_mass_kg);
        }
        let mass_kg = self.trailer_mass_kg.or(self.weighed_kg)?;
        self.hidden_kg = self.hidden_kg.filter(|hidden_kg| is_other_load(mass_kg, *hidden_kg));
        self.hidden_kg.map(|_| mass_kg)
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

/// Whether a trailer of this mass has another load than one of the second mass.
fn is_other_load(mass_kg: f64, known_kg: f64) -> bool {
    (mass_kg - known_kg).abs() > Settings::<f64>::truck().mass_change * known_kg
}
