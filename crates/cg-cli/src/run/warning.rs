//! Rollover warning: how much of the threshold the present turn takes, in levels with hysteresis.

use cg_core::Measured;

/// Time constant of the filter of the lateral acceleration: bumps are no turns.
const FILTER_S: f64 = 0.2;
/// One-sided 95 % bound of the threshold, in standard deviations.
const BOUND: f64 = 1.645;
/// The bound is never taken below this share of the threshold: a height that is hardly known must
/// not warn all day.
const LEAST_SHARE: f64 = 0.5;

/// Levels with hysteresis.
#[derive(Clone, Debug)]
pub(crate) struct Warner {
    levels: Vec<f64>,
    hysteresis: f64,
    level: usize,
    smooth_mps2: Option<f64>,
    last_us: u64,
}

impl Warner {
    /// `levels` are shares of the threshold, increasing.
    pub(crate) fn new(mut levels: Vec<f64>, hysteresis: f64) -> Self {
        levels.sort_by(f64::total_cmp);
        Self { levels, hysteresis, level: 0, smooth_mps2: None, last_us: 0 }
    }

    /// The present level: 0 is none.
    pub(crate) fn level(&self) -> usize {
        self.level
    }

    /// The lateral acceleration, smoothed.
    pub(crate) fn lateral_mps2(&self) -> Option<f64> {
        self.smooth_mps2
    }

    /// The lateral acceleration that counts as the threshold, in g.
    pub(crate) fn bound_g(threshold_g: Measured<f64>) -> f64 {
        let bound = threshold_g.value - BOUND * threshold_g.sd;
        bound.max(LEAST_SHARE * threshold_g.value)
    }

    /// Takes in a lateral acceleration (NaN: absent); the new level if it has changed.
    pub(crate) fn push(
        &mut self,
        time_us: u64,
        lateral_mps2: f64,
        threshold_g: Option<Measured<f64>>,
        gravity_mps2: f64,
    ) -> Option<usize> {
        #[allow(clippy::cast_precision_loss)] // microseconds between two samples
        let interval_s = time_us.saturating_sub(self.last_us) as f64 * 1e-6;
        self.last_us = time_us;
        if lateral_mps2.is_nan() {
            if interval_s > 1.0 {
                self.smooth_mps2 = None;
            }
            return None;
        }
        let smooth = self.smooth_mps2.get_or_insert(lateral_mps2);
        *smooth += (lateral_mps2 - *smooth) * interval_s / (FILTER_S + interval_s);
        let share = match threshold_g {
            Some(threshold_g) => smooth.abs() / gravity_mps2 / Self::bound_g(threshold_g),
            None => 0.0,
        };
        let reached = |share: f64| self.levels.iter().filter(|level| share >= **level).count();
        let level = if reached(share) > self.level {
            reached(share)
        } else {
            self.level.min(reached(share + self.hysteresis))
        };
        (level != std::mem::replace(&mut self.level, level)).then_some(level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Settled at a share of a threshold of 0.4 g.
    fn settle(warner: &mut Warner, share: f64) -> usize {
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        for _ in 0..200 {
            let time_us = warner.last_us + 50_000;
            warner.push(time_us, -share * 0.4 * 9.81, threshold, 9.81);
        }
        warner.level()
    }

    #[test]
    fn levels_end_a_little_below_where_they_begin() {
        let mut warner = Warner::new(vec![0.9, 0.6], 0.05);
        for (share, level) in
            [(0.58, 0), (0.61, 1), (0.58, 1), (0.54, 0), (0.95, 2), (0.86, 2), (0.84, 1), (0.0, 0)]
        {
            assert_eq!(settle(&mut warner, share), level, "{share}");
        }
    }

    /// A bump of a whole threshold, 20 ms long: 0.02/(0.2 + 0.02) = 0.09 of it comes through. The same for
    /// 0.5 s: 1 − (0.2/0.22)^25 = 0.91 do.
    #[test]
    fn a_bump_is_no_turn() {
        let threshold = Some(Measured { value: 0.4, sd: 0.0 });
        for (samples, expected) in [(1, 0), (25, 2)] {
            let mut warner = Warner::new(vec![0.2, 0.8], 0.05);
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
        assert!((Warner::bound_g(Measured { value: 0.4, sd: 0.02 }) - 0.3671).abs() < 1e-9);
        assert!((Warner::bound_g(Measured { value: 0.4, sd: 0.3 }) - 0.2).abs() < 1e-9);
    }

    #[test]
    fn without_a_height_or_a_signal_there_is_no_warning() {
        let mut warner = Warner::new(vec![0.5], 0.05);
        for k in 1..100 {
            assert_eq!(warner.push(k * 10_000, 5.0, None, 9.81), None);
            assert_eq!(warner.push(k * 10_000 + 5, f64::NAN, None, 9.81), None);
        }
    }
}
