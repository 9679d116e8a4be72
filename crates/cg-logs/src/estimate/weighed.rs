//! Whether the trailer mass is that of the load on the trailer.

use serde::{Deserialize, Serialize};

/// A maneuver is weighed if a signal has given the mass within this time before it, µs. Scales on a bus do so every ten
/// seconds at least.
const FRESH_US: u64 = 120_000_000;

/// When signals gave the trailer mass, and whether the load changed since.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    first_us: Option<u64>,
    last_us: Option<u64>,
    of_another_load: bool,
}

impl Weighed {
    /// No signal has given a mass yet.
    pub const NEVER: Self = Self { first_us: None, last_us: None, of_another_load: false };

    /// After a restart, with a kept mass that may be of another load.
    pub fn kept(of_another_load: bool) -> Self {
        Self { of_another_load, ..Self::NEVER }
    }

    /// Takes the time of a mass by a signal, µs.
    pub fn weigh(&mut self, time_us: u64) {
        let first_us = self.first_us.or(Some(time_us));
        *self = Self { first_us, last_us: Some(time_us), of_another_load: false };
    }

    /// Whether the mass of a maneuver from `start_us` on, µs, is that of its load: a signal gave it before, and not long
    /// before, in which the trailer may have been loaded.
    pub fn covers(&self, start_us: u64) -> bool {
        let is_fresh = |last_us: u64| last_us.saturating_add(FRESH_US) >= start_us;
        !self.of_another_load
            && self.first_us.is_some_and(|first_us| first_us <= start_us)
            && self.last_us.is_some_and(is_fresh)
    }

    /// Takes a change of the load that a maneuver from `start_us` on, µs, has revealed. Returns whether
    /// the mass was weighed before it.
    pub fn change_load(&mut self, start_us: u64) -> bool {
        let outdated = self.last_us.is_none_or(|last_us| last_us < start_us);
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
        weighed.weigh(1_000_000);
        let times_us = [999_999, 1_000_000, 121_000_000, 121_000_001];
        assert_eq!(times_us.map(|us| weighed.covers(us)), [false, true, true, false]);
        assert!(!weighed.change_load(1_000_000));
        assert!(!weighed.is_of_another_load());
        assert!(weighed.change_load(1_000_001));
        assert!(weighed.is_of_another_load() && !weighed.covers(1_000_001));
        weighed.weigh(2_000_000);
        assert!(weighed.covers(1_000_001));
        assert!(!weighed.is_of_another_load());
        // After a restart.
        assert!(Weighed::kept(true).is_of_another_load());
        let mut resumed = Weighed::kept(false);
        assert!(resumed.change_load(0));
    }
}
