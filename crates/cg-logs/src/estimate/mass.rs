//! Trailer mass and speed in the turns of a log: what gave the height, and not what the log ends with.

use cg_core::{Maneuver, Quantity, Word};
use cg_vehicle::scales::Scale;

use super::intake::LogEstimator;
use super::known::{is_held, is_other_load, mass_contradiction};

impl LogEstimator {
    /// The maneuvers of the last load that tell anything of it.
    fn turns(&self) -> impl Iterator<Item = &Maneuver<f64>> {
        let tells = |one: &&Maneuver<f64>| {
            one.outcomes.iter().any(|outcome| outcome.height_m.is_ok() || outcome.fit.is_some())
        };
        self.of_load().iter().filter(tells)
    }

    /// The trailer mass that was used in the turns of the last load, kg; without a turn the last one of the log.
    pub(super) fn turns_mass_kg(&self) -> f64 {
        let (sum_kg, turns) =
            self.turns().fold((0.0, 0.0), |(sum, n), one| (sum + one.trailer_mass_kg, n + 1.0));
        if turns > 0.0 { sum_kg / turns } else { self.trailer_mass_kg }
    }

    /// Whether the mass in a turn of the last load is a known one, and not that of the vehicle file because none has come before
    /// its end. Without a turn: whether there is one at all.
    pub(super) fn is_mass_known(&self) -> bool {
        let since_us = self.seen.weighed.since_us();
        self.options.trailer_mass_kg.is_some() || self.has_come(since_us)
    }

    /// The same for the speed.
    pub(super) fn is_speed_known(&self) -> bool {
        self.options.speed_mps.is_some() || self.has_come(self.seen.speed_since_us)
    }

    /// Whether a signal has come before the end of a turn of the last load, or at all if there is none.
    fn has_come(&self, since_us: Option<u64>) -> bool {
        let is_later = |since_us: u64| self.turns().all(|one| one.end_us < since_us);
        since_us.is_some_and(|since_us| self.turns().next().is_none() || !is_later(since_us))
    }

    /// The mass that the log had in the last turn, kg.
    pub(super) fn logged_kg(&self) -> Option<f64> {
        let last_us = self.turns().last().map_or(u64::MAX, |one| one.end_us);
        self.seen.weighed.mass_at_kg(last_us)
    }

    /// The scale of the trailer mass, if there is a mass in the turns.
    pub(super) fn scale(&self) -> Option<Scale> {
        let scale = self.options.trailer_mass_kg.map_or(self.seen.scale, |_| Some(Scale::Weighed));
        scale.filter(|_| self.is_mass_known())
    }

    /// Standard deviation of a trailer mass, kg.
    pub(super) fn mass_sd_kg(&self, mass_kg: f64) -> f64 {
        let is_of_log = self.options.trailer_mass_kg.is_none();
        let logged_kg = self.seen.mass_sd_kg.filter(|_| is_of_log && self.is_mass_known());
        match (self.scale(), self.options.trailer_mass_sd_kg.or(logged_kg)) {
            _ if self.is_of_another_load() => self.design.any_load_sd_kg(),
            (_, Some(sd_kg)) => sd_kg,
            (Some(scale), None) => {
                let scatter_kg = if is_of_log { self.seen.weighed.scatter_kg() } else { 0.0 };
                libm::hypot(self.options.scales.sd_kg(scale, mass_kg), scatter_kg)
            }
            (None, None) => self.design.any_load_sd_kg(),
        }
    }

    /// Whether the mass in the log ends before the last load begins.
    pub(super) fn is_of_another_load(&self) -> bool {
        self.options.trailer_mass_kg.is_none() && self.seen.weighed.is_of_another_load()
    }

    /// What is said of speed and mass.
    pub(super) fn turns_messages(&self) -> Vec<String> {
        let when = |signal: &str, comes: bool| {
            if comes {
                format!("the {signal} in the log begins after the last turn")
            } else {
                format!("no {signal} in the log")
            }
        };
        let mut messages = Vec::new();
        messages.extend(self.unknown_speeds(&when("speed", self.seen.speed_since_us.is_some())));
        if !self.is_mass_known() {
            messages.push(format!(
                "{}: {:.0} kg from the vehicle file is used, and the interval contains any load; give \
                 ⟨trailer_mass_kg⟩",
                when("trailer mass", self.seen.mass_kg.is_some()),
                self.turns_mass_kg()
            ));
        }
        let masses = self.options.trailer_mass_kg.zip(self.logged_kg());
        messages.extend(masses.and_then(|(given, logged)| mass_contradiction(given, logged)));
        messages.extend(self.reloaded());
        messages.extend(self.weighed());
        messages
    }

    /// That the speed is not known, in all turns or in some.
    fn unknown_speeds(&self, when: &str) -> Option<String> {
        let since_us = self.seen.speed_since_us;
        if since_us.is_none() && self.rows == self.absent_rows {
            return Some(format!(
                "{when}: a steer angle or a yaw rate on a bus is only used with a speed on the bus"
            ));
        }
        if self.options.speed_mps.is_some() {
            return None;
        }
        if let Some((rows, first_us)) = self.seen.speed_age.gaps(self.rows) {
            return Some(format!(
                "{rows} of {} rows, the first at {:.0} s, have no speed, nor have the {} ms before them: their steer angles and \
                 yaw rates are not used",
                self.rows,
                self.time_s(first_us),
                Quantity::Speed.serves_us() / 1000
            ));
        }
        let used = format!(
            "{:.2} m/s from the vehicle file is used, and the interval does not contain how far the truck's speed was from it; \
             give ⟨speed_mps⟩",
            self.design.nominal_speed_mps
        );
        if !self.is_speed_known() {
            return Some(format!("{when}: {used}"));
        }
        let since_us = since_us?;
        self.maneuvers.iter().any(|one| one.end_us < since_us).then(|| {
            format!(
                "the speed in the log begins at {:.0} s: in turns before it {used}",
                self.time_s(since_us)
            )
        })
    }

    /// That the trailer has another mass since the last turn.
    fn reloaded(&self) -> Option<String> {
        let logged_kg = self.seen.mass_kg?;
        let turns_kg = match self.options.trailer_mass_kg {
            None => self.turns().last()?.trailer_mass_kg,
            Some(_) => self.logged_kg()?,
        };
        (self.is_mass_known() && is_other_load(logged_kg, turns_kg)).then(|| {
            format!(
                "the trailer mass is {logged_kg:.0} kg at the end of the log and was {turns_kg:.0} kg in the last turn: \
                 the height is that of the load before, and no turn has shown that of the present one"
            )
        })
    }

    /// The end of the maneuver that revealed another load, s.
    pub(super) fn load_since_s(&self) -> Option<f64> {
        if self.became_known() { None } else { Some(self.time_s(self.stop.load_since_us()?)) }
    }

    /// Whether the maneuvers before are those of another load only because no signal had given a mass then.
    fn became_known(&self) -> bool {
        let before = self.first_of_load.checked_sub(1).and_then(|last| self.maneuvers.get(last));
        let (Some(before), Some(first)) = (before, self.of_load().first()) else { return false };
        let had_none = self.seen.weighed.since_us().is_some_and(|us| before.start_us < us);
        let is_of_log = self.options.trailer_mass_kg.is_none();
        is_of_log && had_none && is_other_load(first.trailer_mass_kg, before.trailer_mass_kg)
    }

    /// That the load has changed, or that its mass became known.
    pub(super) fn changed(&self) -> Option<String> {
        if self.became_known() {
            let since_s = self.time_s(self.seen.weighed.since_us()?);
            return Some(format!(
                "the turns before {since_s:.0} s, without a trailer mass, are left out"
            ));
        }
        let since_s = self.load_since_s()?;
        let since_us = self.of_load().first().map_or(0, |one| one.start_us);
        let before = self.maneuvers.iter().rev().find(|one| one.end_us < since_us);
        let stays = |before: &Maneuver<f64>| is_held(self.turns_mass_kg(), before.trailer_mass_kg);
        let doubt = if before.is_some_and(stays) && self.is_mass_known() {
            "; the trailer mass is the same as before, so give ⟨trailer_mass_kg⟩ if the trailer was not weighed again"
        } else {
            ""
        };
        Some(format!(
            "the load changed before {since_s:.0} s: the height is that of the last load{doubt}"
        ))
    }

    /// Where the trailer mass comes from, if it is not exact.
    fn weighed(&self) -> Option<String> {
        let (scale, mass_kg) = (self.scale()?, self.turns_mass_kg());
        if self.is_of_another_load() {
            return Some(format!(
                "the load changed, and no trailer mass in the log is of the last load: {mass_kg:.0} kg of \
                 the one before is used, and the interval contains any load; give ⟨trailer_mass_kg⟩"
            ));
        }
        let sd_kg = self.mass_sd_kg(mass_kg);
        (sd_kg >= 0.5).then(|| {
            format!(
                "the trailer mass of {mass_kg:.0} kg is from {}; its standard deviation of {sd_kg:.0} kg \
                 is part of the interval",
                scale.meaning()
            )
        })
    }
}
