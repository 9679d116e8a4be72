//! The load whose height is known: that of before a restart, and whether it is still on the trailer.

use std::io::{self, Write};

use cg_core::{HeightError, Maneuver, Memory, Reject, Sample, Settings};
use cg_logs::estimate::{
    Engine, LeftOut, SinceStop, StrongTurns, Unheard, Weighed, Windward, is_other_load,
};

use super::{SAVE_US, Session};
use crate::run::doubted::DoubtedMass;
use crate::run::events::{MassSource, Result as Known};
use crate::run::state::{Found, SavedLoad};

/// Share of the mass that a part of the load is: less moves a c.g. by millimeters.
const PART: f64 = 0.01;

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
                if state.is_of_flatter_roads(&self.options) {
                    let message = "its heights are those of flatter roads than --road or the vehicle file says now, and are not used";
                    return self.notice("state", message).map(|()| false);
                }
                let memory = state.memory(self.trips_in_use);
                let restored = Engine::restored(self.estimator.design(), &self.options, &memory);
                let Some(estimator) = restored else { return Ok(false) };
                self.estimator = estimator;
                (self.load_since_s, self.weighing.scale) = (state.load_since_s, state.scale);
                self.weighing.kept_sd_kg = state.mass_sd_kg;
                self.wrong_before = state.wrong_signal;
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
                self.height_kg = self.turn_kg;
                self.kept_beside_m = state.beside_sd_m;
                self.part_kg = state.part_kg.max(self.part_since_kg(memory.trailer_mass_kg));
                self.hide_again(&memory, state.height_is_doubted);
                self.update(self.turn_kg);
                self.unheard = Unheard::kept(self.has_height());
                self.tell_hidden().map(|()| true)
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

    /// Writes the state file.
    pub(super) fn save(&mut self) -> io::Result<()> {
        self.next.save_us = self.now_us + SAVE_US;
        let memory = self.estimator.memory();
        let saved_s = self.time_s(self.now_us);
        let design = self.estimator.design();
        let learned = self.learning.as_ref().map(|learning| learning.learned(design));
        let load = SavedLoad {
            since_s: self.load_since_s,
            lift_axle: self.lift.position(),
            strength: self.strength(),
            gusts: self.windward.of_load(),
            bank_sds_rad: Some(self.options.bank_sds_rad()),
            beside_sd_m: self.beside_sd_m(),
            part_kg: self.part_kg,
            trips_in_use: self.trips_in_use,
            wrong_signal: self.wrong_text(),
            height_is_doubted: self.doubted.hides,
            ..self.weighing.saved(self.mass_source)
        };
        match self.outputs.save(&memory, saved_s, load, learned.unwrap_or_default()) {
            Some(message) => self.notice("state", &message),
            None => Ok(()),
        }
    }

    /// The part of the load that came or went since the turns before a restart, kg, by the last mass, or that which is given now.
    /// More than a part is another load, whose height is hidden.
    fn part_since_kg(&self, last_kg: f64) -> f64 {
        let mass_kg = self.trailer_mass_kg.unwrap_or(last_kg);
        let change_kg = (mass_kg - self.turn_kg).abs();
        let is_part = change_kg > PART * self.turn_kg && !is_other_load(mass_kg, self.turn_kg);
        if is_part { change_kg } else { 0.0 }
    }

    /// Hides a height that was hidden before a restart: that of another mass than the last one, or one that turns contradicted.
    fn hide_again(&mut self, memory: &Memory<f64>, is_doubted: bool) {
        let mass_kg = memory.trailer_mass_kg;
        self.hidden_kg = memory.load_mass_kg.filter(|load_kg| is_other_load(mass_kg, *load_kg));
        if self.hidden_kg.is_some() {
            self.weighed_kg = Some(mass_kg);
        }
        // A signal may go on to give the mass of the load before: the same mass does not show the height again.
        self.doubted = DoubtedMass { hides: is_doubted, was_old: false, is_high: None };
        self.known.trailer_mass_kg = mass_kg;
    }

    fn tell_hidden(&mut self) -> io::Result<()> {
        if self.hidden_mass_kg().is_none() || self.combined().is_none() {
            return Ok(());
        }
        let message = "the height that was known before the restart is that of another load than the one on the trailer, and \
                       is not shown; the next turn gives that of the present load";
        self.notice("load", message)
    }

    /// Shows no height of a load that is not on the trailer any more: of one before a restart (with the first mass of a
    /// signal), or of one that was never weighed, at once, otherwise after the time within which a mass varies in a turn. The
    /// next maneuver of the new load shows the same to the estimator, which then discards its heights.
    pub(super) fn unload(&mut self, sample: &Sample<f64>, is_first: bool) -> io::Result<()> {
        let (mass_kg, known_kg) = (sample.trailer_mass_kg, self.known.trailer_mass_kg);
        let is_other = is_other_load(mass_kg, known_kg);
        if self.doubted.hides && is_other {
            self.hidden_kg = Some(known_kg); // the turns were right
        }
        if is_other {
            self.doubted = DoubtedMass::default();
        }
        if let Some(hidden_kg) = self.hidden_kg {
            if !is_other_load(mass_kg, hidden_kg) {
                self.update(hidden_kg); // the load is back
            }
            return Ok(());
        }
        let settings = Settings::<f64>::truck();
        if self.known.height_m.is_none() || !is_other {
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
        self.next.save_us = 0; // a power cut must not show it again
        self.known = Known::new(None, None, (mass_kg, self.mass_source));
        let message = format!(
            "the trailer mass is {mass_kg:.0} kg and was {known_kg:.0} kg: the height of the load before it is no longer \
             shown; the next turn gives that of the present load"
        );
        self.notice("load", &message)
    }

    /// Hides the height if a turn says that another load is on the trailer: at the mass that is known its height is impossible.
    /// One turn says it of a load that was weighed before a restart, or some minutes ago; two in a row say it of any, because a
    /// signal may still give the mass of before. The next turn with a possible height shows it again.
    pub(super) fn doubt_mass(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let impossible_m = maneuver.outcomes.iter().find_map(|one| match one.height_m {
            Err(Reject::Height(HeightError::OutOfRange { height_m })) => Some(height_m),
            _ => None,
        });
        if maneuver.outcomes.iter().any(|one| one.height_m.is_ok()) {
            self.doubted = DoubtedMass::default();
            return Ok(());
        }
        let Some(height_m) = impossible_m else { return Ok(()) };
        let is_high = height_m > self.estimator.design().reference_height_m;
        let is_again = self.doubted.is_high.replace(is_high) == Some(is_high);
        let is_old = match self.mass_source {
            MassSource::Kept => true,
            MassSource::Signal => self.weighing.weighed.is_old(maneuver.start_us),
            _ => false,
        };
        let shows = self.known.height_m.is_some();
        if self.doubted.hides || !(is_old || is_again && shows) {
            return Ok(());
        }
        (self.doubted.hides, self.doubted.was_old) = (true, is_old);
        self.next.save_us = 0;
        let mass_kg = maneuver.trailer_mass_kg;
        let message = if is_old {
            format!(
                "a turn gives a height of {height_m:.2} m, which no load has at the trailer mass of {mass_kg:.0} kg that was \
                 known before, and no signal has given another one: the trailer was loaded or unloaded, so the height of the \
                 load before is not shown; give --trailer-mass-kg or a signal of the mass"
            )
        } else {
            format!(
                "two turns in a row give a height that no load has at the trailer mass of {mass_kg:.0} kg, now {height_m:.2} m: the \
                 trailer was loaded or unloaded, and the mass stayed that of before, or a sensor is wrong; the height so far is \
                 not shown until a turn gives a possible one"
            )
        };
        self.notice("load", &message)
    }

    /// The present mass of the trailer, kg: given, weighed, or else that of the estimator.
    pub(super) fn present_mass_kg(&self) -> f64 {
        let mass_kg = self.trailer_mass_kg.or(self.weighed_kg);
        mass_kg.unwrap_or_else(|| self.estimator.memory().trailer_mass_kg)
    }

    /// The mass of a load whose height is hidden, if the trailer still has another one, kg.
    pub(super) fn hidden_mass_kg(&mut self) -> Option<f64> {
        if self.doubted.hides {
            return Some(self.known.trailer_mass_kg);
        }
        let mass_kg = self.trailer_mass_kg.or(self.weighed_kg)?;
        self.hidden_kg = self.hidden_kg.filter(|hidden_kg| is_other_load(mass_kg, *hidden_kg));
        self.hidden_kg.map(|_| mass_kg)
    }
}
