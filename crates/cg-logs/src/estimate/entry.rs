//! A turn of which a log has neither the straight before it nor the one after it.
//!
//! The filters of the regression then begin in a state that the truck is not in, and as the roll angle hardly changes within the turn,
//! what is left of it after three seconds counts for much.

use cg_core::Status;
use serde::{Deserialize, Serialize};

/// Time before a turn after which the filters have forgotten the state in which they began, µs: two seconds of straight driving, in
/// which the roll motion decays by `e^(−1.2 · 2)`, and one in which the lateral acceleration grows to what counts as a turn.
const STRAIGHT_US: u64 = 3_000_000;

/// The first turn.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Entry {
    first_us: Option<u64>,
    turn_us: Option<u64>,
    is_straight_again: bool,
}

impl Entry {
    /// Takes the next sample.
    pub(super) fn push(&mut self, time_us: u64, status: Status) {
        self.first_us.get_or_insert(time_us);
        match status {
            Status::Turning => _ = self.turn_us.get_or_insert(time_us),
            Status::Straight => self.is_straight_again = self.turn_us.is_some(),
            Status::Absent => {}
        }
    }

    /// That the log has no straight driving, or too little.
    pub(super) fn message(&self) -> Option<String> {
        let before_us = self.turn_us?.saturating_sub(self.first_us?);
        if before_us >= STRAIGHT_US || self.is_straight_again {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // at most three seconds
        let before_s = before_us as f64 * 1e-6;
        Some(format!(
            "the log begins {before_s:.1} s before a turn and ends in it: the height can be too low by 10 %, which the interval does \
             not contain; let a log begin three seconds before its first turn, or end on a straight"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_without_a_straight_is_told() {
        use Status::{Absent, Straight, Turning};
        for (drive, expected) in [
            (vec![(0, Straight), (2_900_000, Turning), (9_000_000, Turning)], Some("begins 2.9 s")),
            (vec![(5_000_000, Turning), (9_000_000, Absent)], Some("begins 0.0 s")),
            (vec![(6_000_000, Straight), (9_000_000, Turning)], None),
            (vec![(0, Turning), (9_000_000, Straight)], None),
            (vec![(0, Turning), (9_000_000, Straight), (19_000_000, Turning)], None),
            (vec![(0, Straight)], None),
            (vec![], None),
        ] {
            let mut entry = Entry::default();
            for (time_us, status) in &drive {
                entry.push(*time_us, *status);
            }
            let message = entry.message();
            let told = message.as_deref();
            assert_eq!(told.is_some(), expected.is_some(), "{drive:?}: {told:?}");
            assert!(told.is_none_or(|told| told.contains(expected.unwrap())), "{told:?}");
        }
    }
}
