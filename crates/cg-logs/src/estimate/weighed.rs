//! Whether the trailer mass is that of the load on the trailer.

use serde::{Deserialize, Serialize};

use super::known::is_other_load;
use super::options::EMPTY_SHARE;
use crate::can::MASS_SERVES_US;

/// A mass that came less than this before a turn is that of the load in it, µs: nobody loads a truck and drives off so fast, and
/// scales on a bus send every ten seconds.
const NO_STOP_US: u64 = 30_000_000;

/// Time constant of the mean of masses, s. Noise averages out in a turn; what is left differs from turn to turn.
const MEAN_S: f64 = 5.0;

/// When signals gave the trailer mass, how steady it is, and whether the load changed since.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    first_us: Option<u64>,
    last_us: Option<u64>,
    of_another_load: bool,
    /// Whether it is too small even for the empty trailer, so that it teaches nothing.
    is_light: bool,
    /// The mass of the last seconds, kg.
    recent_kg: f64,
    /// Time over which it is known, s, its mean, kg, and the integral of the squares of its deviations, kg² s.
    seconds: f64,
    mean_kg: f64,
    squares: f64,
    /// When the mass became that of another load, µs, and what it was before, kg.
    before: Option<(u64, f64)>,
}

impl Weighed {
    /// No signal has given a mass yet.
    pub const NEVER: Self = Self {
        first_us: None,
        last_us: None,
        of_another_load: false,
        is_light: false,
        recent_kg: f64::NAN,
        seconds: 0.0,
        mean_kg: 0.0,
        squares: 0.0,
        before: None,
    };

    /// After a restart, with a kept mass that may be of another load.
    pub fn kept(of_another_load: bool) -> Self {
        Self { of_another_load, ..Self::NEVER }
    }

    /// Takes a mass by a signal, kg, the one that is [used](super::weighed_mass) instead, and its time, µs.
    pub fn weigh(&mut self, time_us: u64, [mass_kg, used_kg]: [f64; 2]) {
        self.is_light = mass_kg < (1.0 - EMPTY_SHARE) * used_kg;
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let interval_s =
            self.last_us.map_or(0.0, |last_us| time_us.saturating_sub(last_us) as f64 * 1e-6);
        self.first_us = self.first_us.or(Some(time_us));
        (self.last_us, self.of_another_load) = (Some(time_us), false);
        let is_near = !self.recent_kg.is_nan() && !is_other_load(mass_kg, self.recent_kg);
        if !is_near {
            if !self.recent_kg.is_nan() {
                self.before = Some((time_us, self.recent_kg));
            }
            (self.recent_kg, self.seconds, self.mean_kg, self.squares) =
                (mass_kg, 0.0, mass_kg, 0.0);
        }
        self.recent_kg += (mass_kg - self.recent_kg) * interval_s / (MEAN_S + interval_s);
        let interval_s = interval_s.min(MEAN_S);
        if is_near && interval_s > 0.0 {
            self.seconds += interval_s;
            let before_kg = self.recent_kg - self.mean_kg;
            self.mean_kg += before_kg * interval_s / self.seconds;
            self.squares += before_kg * (self.recent_kg - self.mean_kg) * interval_s;
        }
    }

    /// When the first mass came, µs.
    pub fn since_us(&self) -> Option<u64> {
        self.first_us
    }

    /// The mass at a time, µs, that of the present load or of the one before, kg.
    pub fn mass_at_kg(&self, time_us: u64) -> Option<f64> {
        match self.before {
            _ if self.first_us.is_none_or(|first_us| time_us < first_us) => None,
            Some((since_us, before_kg)) if time_us < since_us => Some(before_kg),
            _ => Some(self.recent_kg),
        }
    }

    /// Standard deviation of the mass of this load from one time to another, kg: a scale that wanders is not more exact.
    pub fn scatter_kg(&self) -> f64 {
        if self.seconds > MEAN_S { (self.squares / self.seconds).sqrt() } else { 0.0 }
    }

    /// Whether the mass of a maneuver from `start_us` on, µs, is that of its load: a signal gave it before, and not long
    /// before, in which the trailer may have been loaded, and it is one that this trailer can have.
    pub fn covers(&self, start_us: u64) -> bool {
        !self.is_light && !self.is_old(start_us)
    }

    /// Whether no signal gave a mass before a maneuver from `start_us` on, µs, or only long before it or of another load.
    pub fn is_old(&self, start_us: u64) -> bool {
        let is_fresh = |last_us: u64| last_us.saturating_add(MASS_SERVES_US) >= start_us;
        self.of_another_load
            || self.first_us.is_none_or(|first_us| first_us > start_us)
            || !self.last_us.is_some_and(is_fresh)
    }

    /// Takes a change of the load that a maneuver from `start_us` on, µs, has revealed. Returns whether
    /// the mass was weighed before it.
    pub fn change_load(&mut self, start_us: u64) -> bool {
        let is_old = |last_us: u64| last_us.saturating_add(NO_STOP_US) < start_us;
        let outdated = self.last_us.is_none_or(is_old);
        self.of_another_load |= outdated;
        outdated
    }

    /// Whether the last mass was weighed before the load changed.
    pub fn is_of_another_load(&self) -> bool {
        self.of_another_load
    }
}

impl Default for Weighed {
    fn default() -> Self {
        Self::NEVER
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_counts_until_the_load_changes_without_a_new_one() {
        let mut weighed = Weighed::NEVER;
        assert!(!weighed.covers(1_000_000));
        weighed.weigh(1_000_000, [20e3; 2]);
        let times_us = [999_999, 1_000_000, 121_000_000, 121_000_001];
        assert_eq!(times_us.map(|us| weighed.covers(us)), [false, true, true, false]);
        assert!(!weighed.change_load(31_000_000));
        assert!(!weighed.is_of_another_load());
        assert!(weighed.change_load(31_000_001));
        assert!(weighed.is_of_another_load() && !weighed.covers(1_000_001));
        weighed.weigh(2_000_000, [20e3; 2]);
        assert!(weighed.covers(1_000_001));
        assert!(!weighed.is_of_another_load());
        // After a restart.
        assert!(Weighed::kept(true).is_of_another_load());
        let mut resumed = Weighed::kept(false);
        assert!(resumed.change_load(0));
    }

    /// At 10 Hz, a sine of 100 s, of which the mean over 5 s has 0.95. Noise hardly counts, and another load
    /// begins again.
    #[test]
    fn a_mass_that_wanders_is_no_more_exact_than_that() {
        let after = |mass_kg: fn(f64) -> f64, samples: u32| {
            let mut weighed = Weighed::NEVER;
            for k in 0..samples {
                weighed.weigh(u64::from(k) * 100_000, [mass_kg(f64::from(k)); 2]);
            }
            weighed
        };
        let wanders = |k: f64| 20e3 + 600.0 * (k * std::f64::consts::TAU / 1000.0).sin();
        let found = after(wanders, 4000).scatter_kg();
        let exact = 600.0 / 2.0_f64.sqrt() / 0.314_f64.hypot(1.0);
        assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
        // One of two values by turns is noise that the mean takes away nearly in full.
        let noisy = after(|k| 20e3 + if k % 2.0 < 1.0 { 600.0 } else { -600.0 }, 4000);
        assert!(noisy.scatter_kg() < 0.1 * 600.0);
        assert!(after(|_| 20e3, 4000).scatter_kg() < 1e-6);
        assert!(after(|k| if k < 2000.0 { 20e3 } else { 30e3 }, 4000).scatter_kg() < 1e-6);
    }
}
