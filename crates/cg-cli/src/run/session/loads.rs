//! The load whose height is known: that of before a restart, and whether it is still on the trailer.

use std::io::{self, Write};

use cg_core::{HeightError, Maneuver, Reject, Sample, Settings};
use cg_logs::estimate::{
    Engine, LeftOut, SinceStop, StrongTurns, Weighed, Windward, is_other_load,
};

use super::Session;
use crate::run::events::{MassSource, Result as Known};
use crate::run::state::Found;

impl<W: Write> Session<W> {
    /// Restores the memory that was saved before a restart. Returns whether there was one.
    pub(crate) fn restore(&mut self) -> io::Result<bool> {
        match self.outputs.load() {
            Some(Ok(Found::State(state))) => {
                if !self.resume(state.lift_axle) {
                    let message = format!(
                        "its heights are those with the lift axle {} and are not used",
                        state.lift_axle
                    );
                    return self.notice("state", &message).map(|()| false);
                }
                let memory = state.memory(self.trips_in_use);
                let restored = Engine::restored(self.estimator.design(), &self.options, &memory);
                let Some(estimator) = restored else { return Ok(false) };
                self.estimator = estimator;
                (self.load_since_s, self.weighing.scale) = (state.load_since_s, state.scale);
                self.weighing.weighed = Weighed::kept(state.mass_is_of_another_load);
                self.strong = StrongTurns::kept(state.strength);
                self.windward = Windward::kept(state.gusts);
                self.left_out = LeftOut::new(&self.estimator);
                self.stop = SinceStop::restarted(&self.estimator);
                // The nominal mass means that the load was not weighed.
                let nominal_kg = self.estimator.design().nominal_trailer_mass_kg;
                let weighed = (memory.trailer_mass_kg - nominal_kg).abs() > 1e-6 * nominal_kg;
                if weighed && self.mass_source == MassSource::Nominal {
                    self.mass_source = MassSource::Kept;
                }
                self.turn_kg = memory.load_mass_kg.unwrap_or(memory.trailer_mass_kg);
                self.update(self.turn_kg);
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

    /// Shows no height of a load that is not on the trailer any more: of one before a restart (with the first mass of a
    /// signal), or of one that was never weighed, at once, otherwise after the time within which a mass varies in a turn. The
    /// next maneuver of the new load shows the same to the estimator, which then discards its heights.
    pub(super) fn unload(&mut self, sample: &Sample<f64>, is_first: bool) -> io::Result<()> {
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

    /// Hides the height of a load that was weighed before a restart, or some minutes ago, if a turn says that another one is on
    /// the trailer: at the old mass its height is impossible. The next turn with a possible height shows it again.
    pub(super) fn doubt_kept_mass(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let impossible_m = maneuver.outcomes.iter().find_map(|one| match one.height_m {
            Err(Reject::Height(HeightError::OutOfRange { height_m })) => Some(height_m),
            _ => None,
        });
        let is_possible = maneuver.outcomes.iter().any(|one| one.height_m.is_ok());
        let was_doubted = self.kept_mass_is_doubted;
        let is_old = match self.mass_source {
            MassSource::Kept => true,
            MassSource::Signal => !self.weighing.weighed.covers(maneuver.start_us),
            _ => false,
        };
        match impossible_m {
            _ if is_possible || !is_old => {
                self.kept_mass_is_doubted = false;
            }
            Some(height_m) if !was_doubted => {
                self.kept_mass_is_doubted = true;
                let mass_kg = self.known.trailer_mass_kg;
                let message = format!(
                    "a turn gives a height of {height_m:.2} m, which no load has at the trailer mass of {mass_kg:.0} kg that was \
                     known before, and no signal has given another one: the trailer was loaded or unloaded, so the height of the \
                     load before is not shown; give --trailer-mass-kg or a signal of the mass"
                );
                return self.notice("load", &message);
            }
            _ => {}
        }
        Ok(())
    }

    /// The mass of a load whose height is hidden, if the trailer still has another one, kg.
    pub(super) fn hidden_mass_kg(&mut self) -> Option<f64> {
        if self.kept_mass_is_doubted {
            return Some(self.known.trailer_mass_kg);
        }
        let mass_kg = self.trailer_mass_kg.or(self.weighed_kg)?;
        self.hidden_kg = self.hidden_kg.filter(|hidden_kg| is_other_load(mass_kg, *hidden_kg));
        self.hidden_kg.map(|_| mass_kg)
    }
}
