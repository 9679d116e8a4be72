//! Whether a sensor comes to the end of its range: its values then stay at exactly the same one, which none exceeds.

use serde::{Deserialize, Serialize};

/// Values that differ by less than this are the same: what is left of steps after a change of units.
const SAME: f64 = 1e-9;
/// Least number of values at the end that are the same as the one before. Noise makes a few.
const LEAST: f64 = 20.0;
/// Least share of such values in those at the end, and their greatest share in the other values of its sign. With noise of a third of a
/// step, half of all values repeat the one before; at the greatest value, from which most of them return, fewer.
const AT_END: f64 = 0.7;
const ELSEWHERE: f64 = 0.5;
/// Least mean size of the steps to the end, in the smallest steps of the signal. What comes to rest by itself arrives with one of these.
const ABRUPT: f64 = 1.5;
/// Least share of the other values at which the signal bends, and least second difference there in its smallest steps, of which
/// rounding makes two. A turn that somebody gives to a simulation may be a straight line, and stay at its end; only so many arrivals at
/// exactly the same value are no choice.
const BENDS: f64 = 0.25;
const BENT: f64 = 2.5;
const ARRIVALS: f64 = 3.0;
/// Share of the values beyond half of the end that are at the end, below which it does not matter: where a tenth of the motion is lost
/// there, a ratio is wrong by 0.2 %.
const MATTERS: f64 = 0.02;
const HALF: f64 = 0.5;

/// The greatest value so far of a signal, or of its negative.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct End {
    value: Option<f64>,
    /// Values there, and those of them that are the same as the one before.
    rows: f64,
    repeats: f64,
    /// The same of the other values of its sign.
    others: f64,
    others_repeat: f64,
    /// The number of these beyond half of it.
    beyond_half: f64,
    /// The number of all values of its sign at which the signal bends, and the last change.
    bends: f64,
    before: Option<f64>,
    /// Sum and number of the steps to it.
    steps: f64,
    arrivals: f64,
}

impl End {
    fn push(&mut self, value: f64, change: Option<f64>, step: f64) {
        let before = std::mem::replace(&mut self.before, change);
        if value <= 0.0 {
            return;
        }
        let end = self.value.unwrap_or(0.0);
        if value > end + SAME {
            // What was the end until now is one of the others.
            *self = Self {
                value: Some(value),
                others: self.others + self.rows,
                others_repeat: self.others_repeat + self.repeats,
                bends: self.bends,
                before: self.before,
                ..Self::default()
            };
        }
        let end = end.max(value);
        let repeats = f64::from(u8::from(change.is_some_and(|change| change.abs() <= SAME)));
        let bend = change.zip(before).map(|(change, before)| (change - before).abs());
        self.bends += f64::from(u8::from(bend.is_some_and(|bend| bend > BENT * step)));
        if value >= end - SAME {
            self.rows += 1.0;
            self.repeats += repeats;
            if let Some(change) = change.filter(|change| *change > SAME) {
                self.steps += change;
                self.arrivals += 1.0;
            }
        } else {
            self.others += 1.0;
            self.others_repeat += repeats;
            self.beyond_half += f64::from(u8::from(value > HALF * end));
        }
    }

    /// The value, and the share of the values beyond half of it that are there, of a signal with this smallest step.
    fn share(&self, step: f64) -> Option<(f64, f64)> {
        let share = self.rows / (self.rows + self.beyond_half);
        let stays = self.repeats >= LEAST && self.repeats >= AT_END * self.rows;
        let moves = self.others > LEAST && self.others_repeat < ELSEWHERE * self.others;
        let is_abrupt = self.steps > ABRUPT * step * self.arrivals;
        let is_chosen = self.arrivals < ARRIVALS && self.bends < BENDS * self.others;
        let value = self.value?;
        (stays && moves && is_abrupt && !is_chosen && share > MATTERS).then_some((value, share))
    }
}

/// Both ends of the values of a signal.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct RangeEnd {
    last: Option<f64>,
    ends: [End; 2],
}

impl RangeEnd {
    /// The next value has no neighbor before it.
    pub(super) fn interrupt(&mut self) {
        self.last = None;
    }

    /// Takes the next value of a signal with this smallest step so far.
    pub(super) fn push(&mut self, value: f64, step: f64) {
        let change = self.last.replace(value).map(|last| value - last);
        let [greatest, smallest] = &mut self.ends;
        greatest.push(value, change, step);
        smallest.push(-value, change.map(|change| -change), step);
    }

    /// The size of the value at which the signal ends, and the share of its large values that are there, if it matters. The
    /// smallest step of the signal is given.
    pub(super) fn share(&self, step: f64) -> Option<(f64, f64)> {
        let found = self.ends.iter().filter_map(|end| end.share(step));
        found.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Turns to both sides of unequal size with straight driving between them, as a sensor shows them.
    fn check(noise: f64, step: f64, mut sensor: impl FnMut(f64, u32) -> f64) -> RangeEnd {
        let mut source = StdRng::seed_from_u64(1);
        let mut check = RangeEnd::default();
        for k in 0..6000_u32 {
            let white: f64 = StandardNormal.sample(&mut source);
            let phase = f64::from(k) / 50.0 * std::f64::consts::TAU / 20.0;
            let size = 1.0 + 0.2 * f64::from(k / 500 % 5);
            let turn = if k / 500 % 2 == 0 { 0.0 } else { size * (2.0 * phase).sin() };
            check.push(sensor(turn + noise * white, k), step);
        }
        check
    }

    fn rounded(step: f64) -> impl Fn(f64) -> f64 {
        move |value| (value / step).round() * step
    }

    /// The turns are 1.2 and 1.6 (and so on) high.
    #[test]
    fn a_signal_that_is_cut_off_is_found() {
        for noise in [0.001, 0.03, 0.1] {
            for limit in [0.6, 1.0, 1.3] {
                let (end, share) =
                    check(noise, 1e-9, |value, _| value.clamp(-limit, limit)).share(1e-9).unwrap();
                assert!((end - limit).abs() < 1e-12 && share > 0.05, "{noise} {limit}: {share}");
            }
            // To one side alone, and in steps.
            let step = 0.005;
            let found = check(noise, step, |value, _| rounded(step)(value.max(-1.0))).share(step);
            assert!(found.is_some_and(|(end, _)| (end - 1.0).abs() < 1e-9), "{noise}");
        }
    }

    #[test]
    fn a_signal_within_its_range_is_not() {
        for noise in [0.0, 0.001, 0.01, 0.03, 0.1] {
            assert_eq!(check(noise, 1e-9, |value, _| value).share(1e-9), None, "{noise}");
            for step in [0.01, 0.05, 0.2, 0.5] {
                let found = check(noise, step, |value, _| rounded(step)(value)).share(step);
                assert_eq!(found, None, "{noise} in steps of {step}");
                let mut held = 0.0;
                let hold = |value: f64, k: u32| {
                    held = if k.is_multiple_of(5) { rounded(step)(value) } else { held };
                    held
                };
                assert_eq!(
                    check(noise, step, hold).share(step),
                    None,
                    "{noise} held in steps of {step}"
                );
            }
            // A sensor at 1 Hz in a log at 50 Hz.
            let mut held = 0.0;
            let hold = |value: f64, k: u32| {
                held = if k.is_multiple_of(50) { value } else { held };
                held
            };
            assert_eq!(check(noise, 1e-9, hold).share(1e-9), None, "{noise} held for a second");
            // A range that only a few values reach.
            assert_eq!(check(noise, 1e-9, |value, _| value.min(1.79)).share(1e-9), None, "{noise}");
        }
    }

    /// Twice to the same lateral acceleration, which a simulation without noise is given.
    #[test]
    fn a_turn_that_is_held_is_not_at_an_end() {
        for noise in [0.0, 0.01] {
            let mut check = RangeEnd::default();
            let mut source = StdRng::seed_from_u64(1);
            for k in 0..3000_u32 {
                let white: f64 = StandardNormal.sample(&mut source);
                let turn = f64::from(k % 1500) / 250.0;
                check.push((turn + noise * white).min(1.0), 1e-9);
            }
            assert_eq!(check.share(1e-9).is_some(), noise > 0.0);
        }
    }

    /// A steady turn at the end of the range, of which only the noise is cut off: half of its values are there, and half of these follow
    /// another one. The mean loses 0.4 of the noise, 1.2 % of the turn.
    #[test]
    fn noise_that_is_cut_off_is_not_told() {
        let mut source = StdRng::seed_from_u64(1);
        let mut check = RangeEnd::default();
        for k in 0..3000_u32 {
            let white: f64 = StandardNormal.sample(&mut source);
            let turn = (f64::from(k) / 100.0).min(1.0);
            check.push((turn + 0.03 * white).min(1.0), 1e-9);
        }
        assert!(check.ends[0].repeats > LEAST);
        assert_eq!(check.share(1e-9), None);
    }

    /// A slow sensor whose values are held everywhere, and come to the same greatest one several times.
    #[test]
    fn values_that_are_held_everywhere_are_not_at_an_end() {
        let mut check = RangeEnd::default();
        for k in 0..600_u32 {
            check.push(if k / 30 % 2 == 0 { 0.5 } else { 1.0 }, 0.1);
        }
        let [greatest, _] = check.ends;
        assert!(greatest.repeats > LEAST && greatest.arrivals > ARRIVALS);
        assert_eq!(check.share(0.1), None);
    }

    /// A turn without noise that comes to rest at its greatest value, in a log with six decimals.
    #[test]
    fn what_comes_to_rest_by_itself_is_not_at_an_end() {
        let mut check = RangeEnd::default();
        for k in 0..3000_u32 {
            let time_s = f64::from(k) * 0.02;
            check.push(rounded(1e-6)(1.0 - (-time_s).exp()), 1e-6);
        }
        assert!(check.ends[0].repeats > LEAST);
        assert_eq!(check.share(1e-6), None);
    }
}
