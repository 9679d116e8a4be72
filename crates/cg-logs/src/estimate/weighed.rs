//! Whether the trailer mass is that of the load on the trailer.

use cg_core::decide::load::{STANDING_MPS, STOP_US};
use serde::{Deserialize, Serialize};

use super::known::is_other_load;
use super::options::EMPTY_SHARE;
use crate::can::MASS_SERVES_US;

/// A mass that came less than this before a turn is that of the load in it, µs: nobody loads a truck and drives off so fast, and
/// scales on a bus send every ten seconds.
const NO_STOP_US: u64 = 30_000_000;

/// Least share of the mass of the last turn that a part of the load is: less moves a c.g. by millimeters.
const LEAST_PART: f64 = 0.01;

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
    /// The present standstill, in which the truck may be loaded little by little.
    standing: Option<Standstill>,
}

/// Since when a truck stands, µs, the mass before, kg, and what was known of its scatter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Standstill {
    since_us: u64,
    before_kg: f64,
    known: [f64; 3],
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
        standing: None,
    };

    /// After a restart, with a kept mass that may be of another load.
    pub fn kept(of_another_load: bool) -> Self {
        Self { of_another_load, ..Self::NEVER }
    }

    /// Takes a mass by a signal, kg, the one that is [used](super::weighed_mass) instead, its time, µs, and the speed, NaN if it is not
    /// known.
    pub fn weigh(&mut self, time_us: u64, [mass_kg, used_kg]: [f64; 2], speed_mps: f64) {
        self.is_light = mass_kg < (1.0 - EMPTY_SHARE) * used_kg;
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let interval_s =
            self.last_us.map_or(0.0, |last_us| time_us.saturating_sub(last_us) as f64 * 1e-6);
        self.first_us = self.first_us.or(Some(time_us));
        (self.last_us, self.of_another_load) = (Some(time_us), false);
        let is_near = !self.recent_kg.is_nan() && !is_other_load(mass_kg, self.recent_kg);
        if speed_mps.abs() < STANDING_MPS {
            let before_kg = if self.recent_kg.is_nan() { mass_kg } else { self.recent_kg };
            let known = [self.seconds, self.mean_kg, self.squares];
            self.standing =
                self.standing.or(Some(Standstill { since_us: time_us, before_kg, known }));
        } else if let Some(stop) = self.standing.take_if(|_| !speed_mps.is_nan()) {
            self.drive_off(time_us, stop);
        }
        if !is_near {
            let before = self
                .standing
                .map_or((time_us, self.recent_kg), |stop| (stop.since_us, stop.before_kg));
            self.begin(before, mass_kg);
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

    /// The end of a standstill. What a scale shows while its trailer is loaded is no scatter.
    fn drive_off(&mut self, time_us: u64, stop: Standstill) {
        let Standstill { since_us, before_kg, known: [seconds, mean_kg, squares] } = stop;
        if is_other_load(self.recent_kg, before_kg) {
            self.begin((since_us, before_kg), self.recent_kg);
        } else if time_us.saturating_sub(since_us) >= STOP_US && seconds > MEAN_S {
            // A part of the load may be gone. The scatter remains that of driving.
            let mean_kg = mean_kg + self.recent_kg - before_kg;
            (self.seconds, self.mean_kg, self.squares) = (seconds, mean_kg, squares);
        }
    }

    /// Another load, kg, with the time, µs, until which the mass was that before.
    fn begin(&mut self, before: (u64, f64), mass_kg: f64) {
        self.before = Some(before).filter(|(_, before_kg)| !before_kg.is_nan()).or(self.before);
        (self.recent_kg, self.seconds, self.mean_kg, self.squares) = (mass_kg, 0.0, mass_kg, 0.0);
    }

    /// When the first mass came, µs.
    pub fn since_us(&self) -> Option<u64> {
        self.first_us
    }

    /// The mass at a time, µs, that of the present load or of the one before, kg.
    pub fn mass_at_kg(&self, time_us: u64) -> Option<f64> {
        let standing = self.standing.map(|stop| (stop.since_us, stop.before_kg));
        match standing.or(self.before) {
            _ if self.first_us.is_none_or(|first_us| time_us < first_us) => None,
            Some((since_us, before_kg)) if time_us < since_us => Some(before_kg),
            _ => Some(self.recent_kg),
        }
    }

    /// Standard deviation of the mass of this load from one time to another, kg: a scale that wanders is not more exact.
    pub fn scatter_kg(&self) -> f64 {
        if self.seconds > MEAN_S { (self.squares / self.seconds).sqrt() } else { 0.0 }
    }

    /// By how much the mass is another one than `turn_kg`, that of a turn, kg: a part of the load came or went. What the scale
    /// may do by itself does not count.
    pub fn part_kg(&self, turn_kg: f64) -> f64 {
        let change_kg = (self.recent_kg - turn_kg).abs();
        let is_clear = change_kg > LEAST_PART * turn_kg + 2.0 * self.scatter_kg();
        if is_clear { change_kg } else { 0.0 }
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

    /// Takes a change of the load that a maneuver from `start_us` on, µs, has revealed, with the masses, kg, in the one before, NaN
    /// if there was none, and in this one. Returns whether the mass was weighed before it: one that has changed with the load was
    /// not.
    pub fn change_load(&mut self, start_us: u64, [before_kg, mass_kg]: [f64; 2]) -> bool {
        let is_old = |last_us: u64| last_us.saturating_add(NO_STOP_US) < start_us;
        let is_new = is_other_load(mass_kg, before_kg);
        let outdated = !is_new && self.last_us.is_none_or(is_old);
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
        weighed.weigh(1_000_000, [20e3; 2], 15.0);
        let times_us = [999_999, 1_000_000, 121_000_000, 121_000_001];
        assert_eq!(times_us.map(|us| weighed.covers(us)), [false, true, true, false]);
        let same_kg = [20.5e3, 20e3];
        assert!(!weighed.change_load(31_000_000, same_kg));
        assert!(!weighed.change_load(31_000_001, [25e3, 20e3]), "the new one");
        assert!(!weighed.is_of_another_load());
        assert!(weighed.change_load(31_000_001, same_kg));
        assert!(weighed.is_of_another_load() && !weighed.covers(1_000_001));
        weighed.weigh(2_000_000, [20e3; 2], 15.0);
        assert!(weighed.covers(1_000_001));
        assert!(!weighed.is_of_another_load());
        // After a restart.
        assert!(Weighed::kept(true).is_of_another_load());
        let mut resumed = Weighed::kept(false);
        assert!(resumed.change_load(0, [f64::NAN, 20e3]));
    }

    /// At 10 Hz, a sine of 100 s, of which the mean over 5 s has 0.95. Noise hardly counts, and another load
    /// begins again.
    #[test]
    fn a_mass_that_wanders_is_no_more_exact_than_that() {
        let after = |mass_kg: fn(f64) -> f64, samples: u32| {
            let mut weighed = Weighed::NEVER;
            for k in 0..samples {
                weighed.weigh(u64::from(k) * 100_000, [mass_kg(f64::from(k)); 2], 15.0);
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

    /// Pallets of 0.5 t every 20 s, and a hose that fills the trailer in ten minutes, change the mass by less than 5 % within 5 s. From
    /// the beginning of a log on, and after a drive with another load.
    #[test]
    fn loading_little_by_little_is_no_scatter() {
        let pallets = |s: f64| 12e3 + 500.0 * (s / 20.0).floor();
        let hose = |s: f64| 12e3 + 20.0 * s;
        for (loaded_kg, drive_s) in
            [(pallets as fn(f64) -> f64, 0), (pallets, 120), (hose, 0), (hose, 120)]
        {
            let mut weighed = Weighed::NEVER;
            let mut weigh =
                |from_s: u32, duration_s: u32, speed_mps: f64, kg: &dyn Fn(f64) -> f64| {
                    for k in 0..10 * duration_s {
                        let time_us = u64::from(10 * from_s + k) * 100_000;
                        // The speed comes in every third row.
                        let speed_mps = if k % 3 == 0 { speed_mps } else { f64::NAN };
                        weighed.weigh(time_us, [kg(f64::from(k) * 0.1); 2], speed_mps);
                    }
                    weighed
                };
            weigh(0, drive_s, 15.0, &|_| 12e3);
            let loading = weigh(drive_s, 600, 0.0, &loaded_kg);
            // Until it drives, the mass of the turns before is the one before.
            if drive_s > 0 {
                assert_eq!(loading.mass_at_kg(60_000_000), Some(12e3));
            }
            assert!(loading.scatter_kg() > 1e3);
            let last_kg = loaded_kg(600.0 - 0.1);
            weigh(drive_s + 600, 3600, 0.4, &|_| last_kg);
            let driven = weigh(drive_s + 4200, 60, 3.0, &|_| last_kg);
            assert!(driven.scatter_kg() < 1.0, "{}", driven.scatter_kg());
            let seen_kg = driven.mass_at_kg(u64::MAX).unwrap();
            assert!((seen_kg - last_kg).abs() < 1.0, "{seen_kg}");
            if drive_s > 0 {
                assert_eq!(driven.mass_at_kg(60_000_000), Some(12e3));
            }
        }
    }

    /// Drops of 4 % each at stops of two minutes, with a load between them and with the noise of a scale.
    #[test]
    fn small_drops_at_stops_are_no_scatter() {
        let mut weighed = Weighed::NEVER;
        for k in 0..36_000_u32 {
            let (leg, in_leg) = (k / 6000, k % 6000); // ten minutes each
            let drops = f64::from(leg) + f64::from(in_leg.saturating_sub(4800).min(600)) / 600.0;
            let noise = if k % 2 == 0 { 100.0 } else { -100.0 };
            let speed_mps = if in_leg < 4800 { 15.0 } else { 0.0 };
            let mass_kg = 20e3 - 800.0 * drops + noise;
            weighed.weigh(u64::from(k) * 100_000, [mass_kg; 2], speed_mps);
        }
        weighed.weigh(3_600_000_000, [15.2e3; 2], 15.0);
        // The mean over 5 s leaves 1 % of the alternating noise.
        assert!(weighed.scatter_kg() < 2.0, "{}", weighed.scatter_kg());
    }

    /// A stop without another load keeps what is known of the scale.
    #[test]
    fn a_stop_with_the_same_load_keeps_the_scatter() {
        let mut weighed = Weighed::NEVER;
        for k in 0..4000_u32 {
            let wander = 600.0 * (f64::from(k) * std::f64::consts::TAU / 1000.0).sin();
            let speed_mps = if (1500..2500).contains(&k) { 0.0 } else { 15.0 };
            weighed.weigh(u64::from(k) * 100_000, [20e3 + wander; 2], speed_mps);
        }
        let exact = 600.0 / 2.0_f64.sqrt() / 0.314_f64.hypot(1.0);
        assert!((weighed.scatter_kg() / exact - 1.0).abs() < 0.02, "{}", weighed.scatter_kg());
    }
}
