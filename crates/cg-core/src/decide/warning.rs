//! Rollover warning: the share of the rollover threshold that the present turn uses, in levels with
//! hysteresis.

use crate::decide::signals::seconds;
use crate::math::real::Real;
use crate::truck::ratio::Measured;

/// The greatest number of warning levels.
pub const LEVELS: usize = 8;

/// Time constant of the filter of the lateral acceleration, so that a bump does not cause a
/// warning.
const FILTER_S: f64 = 0.2;
/// Greatest gap in the lateral acceleration; after a longer one, the filter starts again.
const SILENT_US: u64 = 1_000_000;
/// Time for which a share must be lower before the level falls. A trailer that tips pulls less to the side: in the last 0.3 s before it
/// lies, the lateral acceleration falls (nonlinear plant, 46 ramps).
const HOLD_US: u64 = 1_000_000;
/// One-sided 95 % bound of the threshold, in standard deviations.
const BOUND: f64 = 1.645;
/// Lower limit of the bound, as a share of the threshold. Without it, a height with a wide interval
/// would cause a warning in every turn.
const LEAST_SHARE: f64 = 0.5;

/// The reason why warning levels are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LevelError {
    /// There are more than [`LEVELS`] levels.
    TooMany,
    /// A level or the hysteresis is negative or not finite.
    NotAShare,
}

impl core::fmt::Display for LevelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooMany => write!(f, "there can be at most {LEVELS} warning levels"),
            Self::NotAShare => {
                f.write_str("warning levels and their hysteresis are shares of the threshold and must be finite and not negative")
            }
        }
    }
}

impl core::error::Error for LevelError {}

/// Computes a warning level from the lateral acceleration, sample by sample.
#[derive(Clone, Debug)]
pub struct Warner<T> {
    /// In increasing order; unused levels are infinite.
    levels: [T; LEVELS],
    hysteresis: T,
    level: usize,
    /// NaN before the first lateral acceleration.
    smooth_mps2: T,
    last_us: u64,
    /// The last time at which the share was not lower than that of the level.
    reached_us: u64,
}

impl<T: Real> Warner<T> {
    /// `levels` are shares of the lower bound of the threshold, in any order. A level ends when the
    /// share has been `hysteresis` below it for a second.
    ///
    /// # Errors
    ///
    /// [`LevelError`] for more than [`LEVELS`] levels, or for one that is negative or not finite.
    pub fn new(levels: &[T], hysteresis: T) -> Result<Self, LevelError> {
        let infinity = T::one() / T::ZERO;
        let mut sorted = [infinity; LEVELS];
        let used = sorted.get_mut(..levels.len()).ok_or(LevelError::TooMany)?;
        used.copy_from_slice(levels);
        let is_share = |share: &T| share.present() && *share >= T::ZERO;
        if !levels.iter().chain([&hysteresis]).all(is_share) {
            return Err(LevelError::NotAShare);
        }
        sorted.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal));
        Ok(Self {
            levels: sorted,
            hysteresis,
            level: 0,
            smooth_mps2: T::absent(),
            last_us: 0,
            reached_us: 0,
        })
    }

    /// The present level: 0 means no warning, 1 is the lowest level.
    pub fn level(&self) -> usize {
        self.level
    }

    /// The filtered lateral acceleration in m/s²; `None` without a signal.
    pub fn lateral_mps2(&self) -> Option<T> {
        self.smooth_mps2.present().then_some(self.smooth_mps2)
    }

    /// The lateral acceleration, in g, that is used as the threshold: its one-sided 95 % lower
    /// bound, but at least half the threshold.
    pub fn bound_g(threshold_g: Measured<T>) -> T {
        let bound = threshold_g.value - T::of(BOUND) * threshold_g.sd;
        bound.max(T::of(LEAST_SHARE) * threshold_g.value)
    }

    /// Adds a lateral acceleration in m/s² (NaN: no signal) and returns the new level if it has
    /// changed. There is no warning without a threshold (`None`), or without a signal for more than
    /// a second.
    pub fn push(
        &mut self,
        time_us: u64,
        lateral_mps2: T,
        threshold_g: Option<Measured<T>>,
        gravity_mps2: T,
    ) -> Option<usize> {
        let interval_us = time_us.saturating_sub(self.last_us);
        if !lateral_mps2.present() {
            return if interval_us > SILENT_US { self.silence() } else { None };
        }
        self.last_us = time_us;
        if self.smooth_mps2.present() {
            let interval_s = seconds(interval_us);
            let weight = interval_s / (T::of(FILTER_S) + interval_s);
            self.smooth_mps2 += (lateral_mps2 - self.smooth_mps2) * weight;
        } else {
            self.smooth_mps2 = lateral_mps2;
        }
        let share = match threshold_g {
            Some(threshold_g) => self.smooth_mps2.abs() / gravity_mps2 / Self::bound_g(threshold_g),
            None => T::ZERO,
        };
        let reached = |share: T| self.levels.iter().filter(|level| share >= **level).count();
        let level = if reached(share) > self.level {
            reached(share)
        } else {
            self.level.min(reached(share + self.hysteresis))
        };
        if level >= self.level {
            self.reached_us = time_us;
        } else if time_us.saturating_sub(self.reached_us) < HOLD_US {
            return None;
        }
        self.change(level)
    }

    /// Ends the warning and restarts the filter, because there is no information on the present
    /// turn.
    fn silence(&mut self) -> Option<usize> {
        self.smooth_mps2 = T::absent();
        self.change(0)
    }

    fn change(&mut self, level: usize) -> Option<usize> {
        (level != core::mem::replace(&mut self.level, level)).then_some(level)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    extern crate std;
    use std::string::ToString;

    use super::*;

    /// The level in a long turn at this share of a threshold of 0.4 g.
    fn settle(warner: &mut Warner<f64>, share: f64) -> usize {
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        for _ in 0..200 {
            let time_us = warner.last_us + 50_000;
            warner.push(time_us, -share * 0.4 * 9.81, threshold, 9.81);
        }
        warner.level()
    }

    #[test]
    fn levels_end_a_little_below_where_they_begin() {
        let mut warner = Warner::new(&[0.9, 0.6], 0.05).unwrap();
        for (share, level) in
            [(0.58, 0), (0.61, 1), (0.58, 1), (0.54, 0), (0.95, 2), (0.86, 2), (0.84, 1), (0.0, 0)]
        {
            assert_eq!(settle(&mut warner, share), level, "{share}");
        }
    }

    /// The lateral acceleration falls while the trailer tips.
    #[test]
    fn a_level_stays_for_a_second() {
        let mut warner = Warner::new(&[0.6, 0.9], 0.05).unwrap();
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        assert_eq!(settle(&mut warner, 0.95), 2);
        let end_us = warner.last_us;
        let mut push = |share: f64, after_us: u64| {
            warner.push(end_us + after_us, share * 0.4 * 9.81, threshold, 9.81);
            warner.level()
        };
        assert_eq!(
            [(0.0, 50_000), (0.0, 999_999), (0.0, 1_000_000)].map(|(s, us)| push(s, us)),
            [2, 2, 0]
        );
    }

    /// A bump as high as the threshold for 20 ms: the filter passes 0.02/(0.2 + 0.02) = 0.09 of it.
    /// After 0.5 s it passes 1 − (0.2/0.22)^25 = 0.91.
    #[test]
    fn a_bump_is_no_turn() {
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        for (samples, expected) in [(1, 0), (25, 2)] {
            let mut warner = Warner::new(&[0.2, 0.8], 0.05).unwrap();
            settle(&mut warner, 0.0);
            for _ in 0..samples {
                let time_us = warner.last_us + 20_000;
                warner.push(time_us, 0.4 * 9.81, threshold, 9.81);
            }
            assert_eq!(warner.level(), expected, "{samples}");
        }
    }

    #[test]
    fn an_uncertain_threshold_warns_earlier_but_not_always() {
        assert!((Warner::bound_g(Measured { value: 0.4, sd: 0.02 }) - 0.3671_f64).abs() < 1e-9);
        assert!((Warner::bound_g(Measured { value: 0.4, sd: 0.3 }) - 0.2_f64).abs() < 1e-9);
    }

    #[test]
    fn without_a_height_or_a_signal_there_is_no_warning() {
        let mut warner = Warner::new(&[0.5], 0.05).unwrap();
        for k in 1..100 {
            assert_eq!(warner.push(k * 10_000, 5.0, None, 9.81), None);
            assert_eq!(warner.push(k * 10_000 + 5, f64::NAN, None, 9.81), None);
        }
    }

    #[test]
    fn levels_that_mean_nothing_are_refused() {
        for levels in [[0.5, f64::NAN], [0.5, -0.1], [f64::INFINITY, 0.2]] {
            assert_eq!(Warner::new(&levels, 0.05).unwrap_err(), LevelError::NotAShare);
        }
        assert_eq!(Warner::new(&[0.5], -0.05).unwrap_err(), LevelError::NotAShare);
        assert_eq!(Warner::new(&[0.5; LEVELS + 1], 0.0).unwrap_err(), LevelError::TooMany);
        assert!(Warner::new(&[0.5; LEVELS], 0.0).is_ok());
    }

    /// A gap of up to a second keeps filter and warning. A longer one ends both, also if samples
    /// without a lateral acceleration arrive during the gap.
    #[test]
    fn a_long_hole_ends_the_warning() {
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        let mut warner = Warner::new(&[0.5], 0.05).unwrap();
        settle(&mut warner, 0.8);
        let last_us = warner.last_us;
        let mut push =
            |after_us, lateral| warner.push(last_us + after_us, lateral, threshold, 9.81);
        let changes: [_; 4] =
            [20_000, SILENT_US, SILENT_US + 1, SILENT_US + 20_000].map(|us| push(us, f64::NAN));
        assert_eq!(changes, [None, None, Some(0), None]);
        assert_eq!(push(SILENT_US + 40_000, 1.5), None);
        assert_eq!(warner.lateral_mps2(), Some(1.5));
    }

    /// The filter is the backward difference of a lag of 0.2 s: after rest, 20 ms of 3 m/s² give
    /// 3 × 0.02/(0.2 + 0.02).
    #[test]
    fn the_filter_has_its_time_constant() {
        let mut warner = Warner::new(&[0.5], 0.05).unwrap();
        settle(&mut warner, 0.0);
        let time_us = warner.last_us + 20_000;
        warner.push(time_us, 3.0, None, 9.81);
        let expected = 3.0 * 0.02 / 0.22;
        assert!((warner.lateral_mps2().unwrap() / expected - 1.0_f64).abs() < 1e-12);
    }

    #[test]
    fn errors_say_what_is_allowed() {
        assert!(LevelError::TooMany.to_string().contains(&LEVELS.to_string()));
        assert!(LevelError::NotAShare.to_string().contains("not negative"));
    }
}
