//! The end of a maneuver, and the maneuvers of a log that are kept.

use cg_core::Maneuver;

use super::intake::LogEstimator;
use super::kept::{Ended, Kept};

/// Number of maneuvers of a log that are kept; further ones are only counted. A year of driving has
/// some thousands.
const MOST_MANEUVERS: usize = 10_000;

impl LogEstimator {
    /// Ends the log and returns its maneuvers since the lift axles have moved.
    pub fn maneuvers(mut self) -> impl Iterator<Item = (Maneuver<f64>, Ended)> {
        self.end();
        let origin_s = self.origin_s.unwrap_or(0.0);
        let before = self.lift.moved().map_or(0, |(_, maneuvers)| maneuvers);
        let all = self.maneuvers.into_iter().zip(self.kept).skip(before);
        all.map(move |(maneuver, Kept { is_weighed, gust })| {
            #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
            let time_s = origin_s + maneuver.end_us as f64 * 1e-6;
            (maneuver, Ended { time_s, is_weighed, gust })
        })
    }

    pub(super) fn keep(&mut self, closed: Option<&Maneuver<f64>>) {
        let Some(maneuver) = closed else { return };
        self.lift.turn(self.time_s(maneuver.end_us));
        let engine = (&mut self.engine, &self.options);
        let is_first_of_load = self.stop.close(maneuver, engine);
        self.sensors.close(is_first_of_load);
        self.unheard.push(maneuver);
        self.strong.close(maneuver, is_first_of_load);
        self.rated.close(maneuver, is_first_of_load);
        self.windward.close(maneuver, is_first_of_load);
        self.left_out.close(maneuver, &self.engine, is_first_of_load);
        if is_first_of_load {
            let before_kg = self.maneuvers.last().map_or(f64::NAN, |one| one.trailer_mass_kg);
            self.first_of_load = self.maneuvers.len();
            if self.seen.mass_kg.is_some() {
                let masses_kg = [before_kg, maneuver.trailer_mass_kg];
                self.seen.weighed.change_load(maneuver.start_us, masses_kg);
            }
        }
        if self.maneuvers.len() >= MOST_MANEUVERS {
            self.more_maneuvers += 1;
            return;
        }
        let is_of_log = self.options.trailer_mass_kg.is_none();
        let is_weighed = is_of_log && self.seen.weighed.covers(maneuver.start_us);
        self.kept.push(Kept { is_weighed, gust: self.windward.last() });
        self.maneuvers.push(*maneuver);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{maneuver, plain};

    #[test]
    fn maneuvers_beyond_the_limit_are_counted() {
        let mut log = plain();
        let one = maneuver();
        log.maneuvers = vec![one; MOST_MANEUVERS - 1];
        for (closed, kept, more) in [
            (None, MOST_MANEUVERS - 1, 0),
            (Some(&one), MOST_MANEUVERS, 0),
            (Some(&one), MOST_MANEUVERS, 1),
            (Some(&one), MOST_MANEUVERS, 2),
            (None, MOST_MANEUVERS, 2),
        ] {
            log.keep(closed);
            assert_eq!((log.maneuvers.len(), log.more_maneuvers), (kept, more));
        }
    }
}
