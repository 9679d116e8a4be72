//! Whether the trailer mass is that of the load on the trailer.

use serde::{Deserialize, Serialize};

/// When a signal last gave the trailer mass, and whether the load changed since.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    last_us: Option<u64>,
    of_another_load: bool,
}

impl Weighed {
    /// No signal has given a mass yet.
    pub const NEVER: Self = Self { last_us: None, of_another_load: false };

    /// After a restart, with a kept mass that may be of another load.
    pub fn kept(of_another_load: bool) -> Self {
        Self { of_another_load, ..Self::NEVER }
    }

    /// Takes the time of a mass by a signal, µs.
    pub fn weigh(&mut self, time_us: u64) {
        *self = Self { last_us: Some(time_us), of_another_load: false };
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
        weighed.weigh(1_000_000);
        assert!(!weighed.change_load(1_000_000));
        assert!(!weighed.is_of_another_load());
        assert!(weighed.change_load(1_000_001));
        assert!(weighed.is_of_another_load());
        weighed.weigh(2_000_000);
        assert!(!weighed.is_of_another_load());
        // After a restart.
        assert!(Weighed::kept(true).is_of_another_load());
        let mut resumed = Weighed::kept(false);
        assert!(resumed.change_load(0));
    }
}
