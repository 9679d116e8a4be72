//! The signal of the lift axles: what it says, and whether it still comes.

use cg_vehicle::lift::LiftAxle;
use serde::{Deserialize, Serialize};

/// Time for which the signal says another position before the axle has moved, s. The bellows of an axle take some seconds, and one
/// wrong value is no move.
const MOVES_S: f64 = 1.0;
/// Number of values from which on a signal has a cycle. It has stopped if none has come for this time, s, and for this many
/// cycles. One that comes less often is written when it changes, or once in a log.
const PERIODIC: u32 = 5;
const STOPPED_S: f64 = 10.0;
const STOPPED_CYCLES: f64 = 10.0;

/// What a signal of the lift axles has said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LiftSignal {
    position: Option<LiftAxle>,
    /// The position that it says next, and since when, s.
    next: Option<(LiftAxle, f64)>,
    /// Whether it has ever said down, and raised.
    has_said: [bool; 2],
    values: u32,
    first_s: f64,
    last_s: f64,
}

impl LiftSignal {
    /// Takes a value, NaN if there is none, at a time, s. The position that it says now. The first one counts `at_once`, or when it
    /// has been said for as long as any other.
    #[inline]
    pub fn push(&mut self, value: f64, now_s: f64, at_once: bool) -> Option<LiftAxle> {
        if value.is_nan() && self.next.is_none() {
            return self.position; // as in nearly all rows
        }
        self.hear(value, now_s, at_once)
    }

    fn hear(&mut self, value: f64, now_s: f64, at_once: bool) -> Option<LiftAxle> {
        match LiftAxle::of_value(value) {
            Some(said) => {
                self.count(now_s);
                match (self.position, self.next) {
                    (None, _) if at_once => self.take(said),
                    (Some(position), _) if position == said => self.next = None,
                    (_, Some((next, _))) if next == said => {}
                    _ => self.next = Some((said, now_s)),
                }
            }
            // An error is no confirmation.
            None if !value.is_nan() => self.next = None,
            None => {}
        }
        // It holds until something else is said.
        if let Some((next, since_s)) = self.next
            && now_s - since_s >= MOVES_S
        {
            self.take(next);
        }
        self.position
    }

    fn count(&mut self, now_s: f64) {
        if self.values == 0 {
            self.first_s = now_s;
        }
        self.values = self.values.saturating_add(1);
        self.last_s = now_s;
    }

    fn take(&mut self, position: LiftAxle) {
        (self.position, self.next) = (Some(position), None);
        self.has_said[usize::from(!position.is_down())] = true;
    }

    /// The position that it said last.
    pub fn position(&self) -> Option<LiftAxle> {
        self.position
    }

    /// Whether it has ever said this position.
    pub fn has_said(&self, position: LiftAxle) -> bool {
        self.has_said[usize::from(!position.is_down())]
    }

    /// Whether it came in a cycle and does not come any more.
    pub fn has_stopped(&self, now_s: f64) -> bool {
        let cycle_s = (self.last_s - self.first_s) / f64::from(self.values.max(2) - 1);
        let most_s = STOPPED_S.max(STOPPED_CYCLES * cycle_s);
        self.values >= PERIODIC && now_s - self.last_s > most_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOWN: Option<LiftAxle> = Some(LiftAxle::Down);
    const RAISED: Option<LiftAxle> = Some(LiftAxle::Raised);

    #[test]
    fn an_axle_moves_when_the_signal_says_so_for_a_second() {
        let mut signal = LiftSignal::default();
        let mut says = |value: f64, now_s: f64| signal.push(value, now_s, true);
        assert_eq!([says(f64::NAN, 0.0), says(2.0, 0.1), says(0.0, 0.2)], [None, None, DOWN]);
        // One wrong value.
        assert_eq!([says(1.0, 5.0), says(0.0, 5.1), says(0.0, 9.0)], [DOWN; 3]);
        assert_eq!([says(1.0, 10.0), says(1.0, 10.9), says(1.0, 11.0)], [DOWN, DOWN, RAISED]);
        // Written at the change only.
        assert_eq!(
            [says(0.0, 50.0), says(f64::NAN, 50.9), says(f64::NAN, 51.1)],
            [RAISED, RAISED, DOWN]
        );
        // An error is neither.
        assert_eq!([says(1.0, 60.0), says(3.0, 60.5), says(f64::NAN, 70.0)], [DOWN; 3]);
        assert!([LiftAxle::Down, LiftAxle::Raised].into_iter().all(|one| signal.has_said(one)));
        assert_eq!(signal.position(), DOWN);
    }

    #[test]
    fn a_first_value_counts_at_once_if_nothing_is_lost_by_it() {
        let mut signal = LiftSignal::default();
        assert_eq!([0.0, 0.5, 0.9].map(|now_s| signal.push(0.0, now_s, false)), [None; 3]);
        assert_eq!(
            [1.0, 1.9, 2.1].map(|now_s| signal.push(1.0, now_s, false)),
            [None, None, RAISED]
        );
        assert!(!signal.has_said(LiftAxle::Down));
    }

    #[test]
    fn a_signal_with_a_cycle_can_stop() {
        let (mut cyclic, mut once) = (LiftSignal::default(), LiftSignal::default());
        once.push(1.0, 0.0, true);
        for k in 0..10 {
            cyclic.push(1.0, f64::from(k), true);
        }
        assert!(!cyclic.has_stopped(18.9) && cyclic.has_stopped(19.1));
        assert!(!once.has_stopped(1e4) && !once.has_said(LiftAxle::Down));
        let mut slow = LiftSignal::default();
        for k in 0..10 {
            slow.push(0.0, 10.0 * f64::from(k), true);
        }
        assert!(!slow.has_stopped(189.0) && slow.has_stopped(191.0));
    }
}
