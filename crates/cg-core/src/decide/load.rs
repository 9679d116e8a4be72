//! Detects a change of the load.
//!
//! Maneuvers are fused as long as the load is the same. The load has changed
//!
//! * if the mass of the trailer has changed since the last turn, or since the first one of the load if the truck has stopped, where it
//!   may be unloaded little by little;
//! * after a stop, if the next maneuver contradicts the height so far;
//! * while driving (cargo that shifts), if two successive maneuvers contradict the height so far
//!   but agree with each other. The first of the two is kept until the second one.

use crate::decide::height::Height;
use crate::math::real::Real;
use crate::truck::ratio::Measured;

/// Speed below which the truck counts as stopped.
pub const STANDING_MPS: f64 = 0.5;
/// Duration of a stop after which the truck may have another load.
pub const STOP_US: u64 = 60_000_000;
/// Standard deviations of a contradiction while driving, and after a stop.
const CONTRADICTION: f64 = 4.0;
const AFTER_A_STOP: f64 = 3.0;
/// The share of the uncertainty of model and calibration that differs between maneuvers, because it
/// depends on speed and steering. The rest is common to all maneuvers of a load.
pub const NOT_COMMON: f64 = 0.3;

/// The result of a maneuver in one channel: the height with its standard deviation due to noise,
/// and the systematic standard deviation. `None` if the channel has no height.
pub(crate) type Said<T> = Option<(Measured<T>, T)>;

/// What a maneuver means for the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict<T, const C: usize> {
    /// The load is the same: fuse the maneuver.
    Same,
    /// The load may have changed: do not fuse the maneuver yet.
    Wait,
    /// The load has changed: delete the heights so far, then fuse the waiting maneuver, then this
    /// one.
    Changed {
        /// The waiting maneuver; `None` in a channel without a height.
        waited: [Said<T>; C],
    },
}

/// The state of the detection of load changes.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [Said<T>; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [Said<T>; C]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct LoadWatch<T, const C: usize> {
    mass_kg: Option<T>,
    /// That of the first maneuver of the load.
    first_kg: Option<T>,
    mass_change: T,
    last_us: Option<u64>,
    standing_us: u64,
    stopped: bool,
    waiting: Option<[Said<T>; C]>,
}

impl<T: Real, const C: usize> LoadWatch<T, C> {
    /// The state before the first row. A relative change of the mass by more than `mass_change`
    /// means another load.
    pub(crate) fn new(mass_change: T) -> Self {
        Self {
            mass_kg: None,
            first_kg: None,
            mass_change,
            last_us: None,
            standing_us: 0,
            stopped: false,
            waiting: None,
        }
    }

    /// The state after a restart, which may have been a stop for loading.
    pub(crate) fn resumed(
        mass_change: T,
        mass_kg: Option<T>,
        waiting: Option<[Said<T>; C]>,
    ) -> Self {
        Self { mass_kg, first_kg: mass_kg, waiting, stopped: true, ..Self::new(mass_change) }
    }

    /// The trailer mass of the last maneuver.
    pub(crate) fn mass_kg(&self) -> Option<T> {
        self.mass_kg
    }

    /// The maneuver that waits for a second one that agrees with it.
    pub(crate) fn waiting(&self) -> Option<[Said<T>; C]> {
        self.waiting
    }

    /// Updates the state with the speed of a row.
    pub(crate) fn drive(&mut self, time_us: u64, speed_mps: T) {
        let interval_us = self.last_us.map_or(0, |last_us| time_us.saturating_sub(last_us));
        self.last_us = Some(time_us);
        self.standing_us = if speed_mps.abs() < T::of(STANDING_MPS) {
            self.standing_us.saturating_add(interval_us)
        } else {
            0
        };
        // If the log is switched off while the truck stands, the stop is a gap in the log.
        self.stopped |= self.standing_us >= STOP_US || interval_us >= STOP_US;
    }

    /// Compares the results of a maneuver (`said`, per channel) with the fused heights and decides
    /// whether the load has changed.
    pub(crate) fn judge(
        &mut self,
        mass_kg: T,
        said: [Said<T>; C],
        fused: [Option<Height<T>>; C],
    ) -> Verdict<T, C> {
        let verdict = self.verdict(mass_kg, said, fused);
        self.mass_kg = Some(mass_kg);
        if self.first_kg.is_none() || matches!(verdict, Verdict::Changed { .. }) {
            self.first_kg = Some(mass_kg);
        }
        verdict
    }

    fn verdict(
        &mut self,
        mass_kg: T,
        said: [Said<T>; C],
        fused: [Option<Height<T>>; C],
    ) -> Verdict<T, C> {
        let is_other = |before: T| (mass_kg - before).abs() > self.mass_change * before;
        let since_first = self.first_kg.filter(|_| self.stopped);
        if self.mass_kg.is_some_and(is_other) || since_first.is_some_and(is_other) {
            (self.stopped, self.waiting) = (false, None);
            return Verdict::Changed { waited: [None; C] };
        }
        if said.iter().all(Option::is_none) {
            return Verdict::Same;
        }
        let limit = if self.stopped { AFTER_A_STOP } else { CONTRADICTION };
        if !contradicts(&said, &fused, T::of(limit)) {
            (self.stopped, self.waiting) = (false, None);
            return Verdict::Same;
        }
        if self.stopped {
            (self.stopped, self.waiting) = (false, None);
            return Verdict::Changed { waited: [None; C] };
        }
        match self.waiting.replace(said) {
            Some(waited) if agree(&said, &waited) => {
                self.waiting = None;
                Verdict::Changed { waited }
            }
            _ => Verdict::Wait,
        }
    }
}

/// Whether the height of a channel differs from the fused one by more than `limit` standard
/// deviations.
fn contradicts<T: Real>(said: &[Said<T>], fused: &[Option<Height<T>>], limit: T) -> bool {
    said.iter().zip(fused).any(|pair| match pair {
        (Some((height, systematic)), Some(fused)) => {
            far(*height, fused.height_m.value, fused.random_sd_m, *systematic, limit)
        }
        _ => false,
    })
}

/// Whether two maneuvers agree in every channel in which both have a height, of which there is one.
fn agree<T: Real>(one: &[Said<T>], other: &[Said<T>]) -> bool {
    let mut both = false;
    for pair in one.iter().zip(other) {
        if let (Some((height, systematic)), Some((other, _))) = pair {
            both = true;
            if far(*height, other.value, other.sd, *systematic, T::of(CONTRADICTION)) {
                return false;
            }
        }
    }
    both
}

fn far<T: Real>(height: Measured<T>, other_m: T, other_sd_m: T, systematic_m: T, limit: T) -> bool {
    let own = T::of(NOT_COMMON) * systematic_m;
    let variance = height.sd * height.sd + other_sd_m * other_sd_m + own * own;
    (height.value - other_m).abs() > limit * variance.root()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(value: f64) -> [Said<f64>; 2] {
        [None, Some((Measured { value, sd: 0.02 }, 0.05))]
    }

    fn fused(value: f64) -> [Option<Height<f64>>; 2] {
        let height_m = Measured { value, sd: 0.05 };
        [None, Some(Height { height_m, random_sd_m: 0.005, maneuvers: 9 })]
    }

    #[test]
    fn one_outlier_is_left_out_and_two_that_agree_are_another_load() {
        let mut watch = LoadWatch::new(0.05);
        assert_eq!(watch.judge(3e4, said(2.0), fused(2.01)), Verdict::Same);
        // 4 √(0.02² + 0.005² + 0.015²) = 0.10 m.
        assert_eq!(watch.judge(3e4, said(2.2), fused(2.0)), Verdict::Wait);
        assert_eq!(watch.judge(3e4, said(2.02), fused(2.0)), Verdict::Same);
        assert_eq!(watch.judge(3e4, said(2.2), fused(2.0)), Verdict::Wait);
        assert_eq!(watch.judge(3e4, said(1.8), fused(2.0)), Verdict::Wait);
        let changed = Verdict::Changed { waited: said(1.8) };
        assert_eq!(watch.judge(3e4, said(1.82), fused(2.0)), changed);
        assert_eq!(watch.judge(3e4, said(1.82), fused(1.81)), Verdict::Same);
    }

    #[test]
    fn after_a_stop_one_is_enough() {
        for interval_us in [1_000_000, 70_000_000] {
            let mut watch = LoadWatch::new(0.05);
            assert_eq!(watch.judge(3e4, said(2.0), fused(2.0)), Verdict::Same);
            for k in 0..=70 {
                watch.drive(k * interval_us, 0.0);
            }
            watch.drive(71 * interval_us, 15.0);
            assert_eq!(watch.judge(3e4, said(2.03), fused(2.0)), Verdict::Same);
            watch.drive(72 * interval_us + 70_000_000, 15.0);
            let changed = Verdict::Changed { waited: [None; 2] };
            assert_eq!(watch.judge(3e4, said(2.2), fused(2.0)), changed);
        }
    }

    #[test]
    fn another_mass_is_another_load() {
        let mut watch = LoadWatch::new(0.05);
        assert_eq!(watch.judge(3e4, said(2.0), [None; 2]), Verdict::Same);
        assert_eq!(watch.judge(3.1e4, said(2.0), fused(2.0)), Verdict::Same);
        let changed = Verdict::Changed { waited: [None; 2] };
        assert_eq!(watch.judge(3.4e4, said(2.0), fused(2.0)), changed);
    }

    /// Each stop takes 4 %, which is no other load by itself; while the truck drives, so slow a change is that of the scale.
    #[test]
    fn a_load_that_goes_little_by_little_is_another_one() {
        for (stops, expected) in
            [(true, [false, false, true, false, true, false]), (false, [false; 6])]
        {
            let mut watch = LoadWatch::new(0.05);
            let mut mass_kg = 28e3;
            let changes = [1, 2, 3, 4, 5, 6].map(|k: u64| {
                if stops {
                    watch.drive(k * 100_000_000, 15.0);
                }
                let verdict = watch.judge(mass_kg, said(2.0), fused(2.0));
                mass_kg *= 0.96;
                verdict != Verdict::Same
            });
            assert_eq!(changes, expected);
            assert!(watch.mass_kg().unwrap() > mass_kg);
        }
    }

    /// Noise of 0.02 and 0.005 m and 0.3 of 0.05 m give 0.0255 m. A contradiction is 4 times that
    /// while driving and 3 times that after a stop.
    #[test]
    fn four_standard_deviations_contradict_and_three_after_a_stop() {
        let sd = (0.02_f64.powi(2) + 0.005_f64.powi(2) + 0.015_f64.powi(2)).sqrt();
        for (deviations, same) in [(3.99, true), (4.01, false), (-3.99, true), (-4.01, false)] {
            let mut watch = LoadWatch::new(0.05);
            let verdict = watch.judge(3e4, said(2.0 + deviations * sd), fused(2.0));
            assert_eq!(verdict == Verdict::Same, same, "{deviations}");
        }
        for (deviations, same) in [(2.99, true), (3.01, false)] {
            let mut watch = LoadWatch::resumed(0.05, Some(3e4), None);
            let verdict = watch.judge(3e4, said(2.0 + deviations * sd), fused(2.0));
            let changed = Verdict::Changed { waited: [None; 2] };
            assert_eq!(verdict, if same { Verdict::Same } else { changed });
            // The effect of the stop has ended.
            assert_eq!(watch.judge(3e4, said(2.0 + 3.5 * sd), fused(2.0)), Verdict::Same);
        }
    }

    /// The waiting maneuver has its own noise: √(2 · 0.02² + 0.015²) = 0.032 m.
    #[test]
    fn two_maneuvers_agree_within_four_of_their_standard_deviations() {
        let sd = (2.0 * 0.02_f64.powi(2) + 0.015_f64.powi(2)).sqrt();
        for (deviations, agree) in [(3.99, true), (4.01, false)] {
            let mut watch = LoadWatch::new(0.05);
            assert_eq!(watch.judge(3e4, said(2.5), fused(2.0)), Verdict::Wait);
            assert_eq!(watch.waiting(), Some(said(2.5)));
            let verdict = watch.judge(3e4, said(2.5 + deviations * sd), fused(2.0));
            assert_eq!(verdict != Verdict::Wait, agree, "{deviations}");
            assert_eq!(watch.waiting().is_none(), agree);
        }
    }

    /// Each contradicts the height of its own channel, which two wrong sensors do, too.
    #[test]
    fn two_maneuvers_with_no_channel_in_common_do_not_agree() {
        let [_, height] = said(2.5);
        let [_, so_far] = fused(2.0);
        let mut watch = LoadWatch::new(0.05);
        assert_eq!(watch.judge(3e4, [height, None], [so_far; 2]), Verdict::Wait);
        assert_eq!(watch.judge(3e4, [None, height], [so_far; 2]), Verdict::Wait);
        assert_eq!(watch.waiting(), Some([None, height]));
        let changed = Verdict::Changed { waited: [None, height] };
        assert_eq!(watch.judge(3e4, [height, height], [so_far; 2]), changed);
    }

    #[test]
    fn a_maneuver_that_says_nothing_keeps_what_waits() {
        let mut watch = LoadWatch::new(0.05);
        assert_eq!(watch.judge(3e4, said(2.5), fused(2.0)), Verdict::Wait);
        assert_eq!(watch.judge(3e4, [None; 2], fused(2.0)), Verdict::Same);
        assert_eq!(watch.waiting(), Some(said(2.5)));
        assert_eq!(watch.judge(3e4, said(2.0), fused(2.0)), Verdict::Same);
        assert_eq!(watch.waiting(), None);
        assert_eq!(watch.mass_kg(), Some(3e4));
    }

    #[test]
    fn a_mass_that_changes_by_more_than_its_share_is_another_load() {
        for (mass_kg, same) in [(31.4e3, true), (31.6e3, false), (28.6e3, true), (28.4e3, false)] {
            let mut watch = LoadWatch::resumed(0.05, Some(30e3), Some(said(2.5)));
            assert_eq!((watch.mass_kg(), watch.waiting()), (Some(30e3), Some(said(2.5))));
            let verdict = watch.judge(mass_kg, said(2.0), [None; 2]);
            assert_eq!(verdict == Verdict::Same, same, "{mass_kg}");
            assert_eq!(watch.waiting(), None);
        }
    }

    /// Whether a maneuver that deviates by 3.5 standard deviations counts as another load.
    fn stopped(rows: &[(u64, f64)]) -> bool {
        let mut watch = LoadWatch::new(0.05);
        for (time_s, speed_mps) in rows {
            watch.drive(time_s * 1_000_000, *speed_mps);
        }
        watch.judge(3e4, said(2.09), fused(2.0)) != Verdict::Same
    }

    #[test]
    fn a_minute_below_half_a_meter_per_second_is_a_stop() {
        let still = |seconds: u64, speed_mps: f64| {
            let rows: [(u64, f64); 70] =
                core::array::from_fn(|k| (1000 + (k as u64).min(seconds), speed_mps));
            stopped(&rows)
        };
        assert!(still(60, 0.0) && still(60, -0.49) && still(60, 0.49));
        assert!(!still(59, 0.0) && !still(60, 0.5) && !still(60, -0.51));
        // Driving restarts the time of the stop.
        assert!(!stopped(&[(0, 0.0), (40, 0.0), (41, 9.0), (60, 9.0), (90, 0.0), (119, 0.0)]));
        // A gap counts as a stop at any speed before and after it.
        assert!(stopped(&[(0, 9.0), (60, 9.0)]) && !stopped(&[(0, 9.0), (59, 9.0)]));
    }
}
