//! Whether a signal with noise stays at exactly 0: its sensor, or what comes after it, has a dead band there.

use serde::{Deserialize, Serialize};

/// Least number of zeros in a row that are no chance, if no value is held: with noise of two steps, a value is the one in the
/// middle in one of five samples, and three times in a row in 0.8 % of all places.
const IN_A_ROW: f64 = 3.0;
/// Least share of such zeros, and least number of them, to be a dead band.
const SHARE: f64 = 0.05;
const LEAST: f64 = 50.0;
/// Values that differ, after zeros in a row, of which the noise is that at zero: elsewhere a motion may have its own.
const AFTER: f64 = 25.0;
/// Least noise in steps of the signal. With less, a signal that is rounded stays where it is.
const NOISY_STEPS: f64 = 2.0;
/// Least noise over the root mean square of the signal: the corners of a simulated turn without noise make less.
const NOISY_SHARE: f64 = 1e-3;

/// What a signal does at zero and elsewhere.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct NearZero {
    /// The last value and its last two differences, each of a value that differs from the one before.
    last: Option<f64>,
    difference: Option<f64>,
    bend: Option<f64>,
    /// Sum of the products of successive second differences, and their number.
    products: f64,
    bends: f64,
    /// Zeros since the last other value, those in rows of them, all other values, and those of them that are held.
    zeros: f64,
    in_rows: f64,
    others: f64,
    held: f64,
    /// Values that differ since zeros in a row.
    since: f64,
}

impl NearZero {
    /// The next value has no neighbor before it.
    pub(super) fn interrupt(&mut self) {
        (self.last, self.difference, self.bend, self.zeros) = (None, None, None, 0.0);
    }

    pub(super) fn push(&mut self, value: f64) {
        if value == 0.0 {
            (self.last, self.difference, self.bend) = (None, None, None);
            self.zeros += 1.0;
            // A sensor that is slower than the log gives each value several times.
            let times =
                if self.held < self.others { self.others / (self.others - self.held) } else { 1.0 };
            if self.zeros >= IN_A_ROW * times {
                // The first ones count when the row is long enough.
                let is_new = self.zeros - 1.0 < IN_A_ROW * times;
                self.in_rows += if is_new { self.zeros } else { 1.0 };
                self.since = 0.0;
            }
            return;
        }
        self.zeros = 0.0;
        self.others += 1.0;
        // A value that is held says nothing new.
        let Some(change) = self.last.replace(value).map(|last| value - last) else { return };
        if change == 0.0 {
            self.held += 1.0;
            return;
        }
        self.since += 1.0;
        let Some(bend) = self.difference.replace(change).map(|before| change - before) else {
            return;
        };
        if let Some(before) = self.bend.replace(bend)
            && self.since <= AFTER
        {
            self.products += bend * before;
            self.bends += 1.0;
        }
    }

    /// The share of the values in a dead band, if there is one in a signal with these steps and this root mean square.
    ///
    /// White noise of variance σ² has second differences whose neighbors have the covariance −4 σ²; those of a motion that
    /// is sampled often enough have the same sign.
    pub(super) fn dead_share(&self, (step, size): (f64, f64)) -> Option<f64> {
        let variance = -self.products / self.bends / 4.0;
        let share = self.in_rows / (self.in_rows + self.others);
        let is_noisy = variance.sqrt() > (NOISY_STEPS * step).max(NOISY_SHARE * size);
        (self.in_rows >= LEAST && share > SHARE && is_noisy).then_some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Root mean square of the turns below.
    const SIZE: f64 = 0.5;

    /// Turns to both sides with straight driving between them for half of the time, as a sensor shows them.
    fn check(noise: f64, mut sensor: impl FnMut(f64, u32) -> f64) -> NearZero {
        let mut source = StdRng::seed_from_u64(1);
        let mut check = NearZero::default();
        for k in 0..4000 {
            let white: f64 = StandardNormal.sample(&mut source);
            let phase = f64::from(k) / 50.0 * std::f64::consts::TAU / 20.0;
            let turn = if (k / 500) % 2 == 0 { 0.0 } else { (2.0 * phase).sin() };
            check.push(sensor(turn + noise * white, k));
        }
        check
    }

    fn cut(band: f64) -> impl Fn(f64, u32) -> f64 {
        move |value, _| (value.abs() - band).max(0.0).copysign(value)
    }

    fn rounded(step: f64) -> impl Fn(f64) -> f64 {
        move |value| (value / step).round() * step
    }

    /// In half of the time the motion is zero, so nearly all of the samples within a band of three standard deviations are.
    #[test]
    fn a_band_in_which_noise_is_lost_is_found() {
        for band in [0.1, 0.2] {
            let share = check(0.03, cut(band)).dead_share((1e-9, SIZE)).unwrap();
            assert!(share > 0.49 && share < 0.6, "{share}");
        }
        let both = |value, k| rounded(0.01)(cut(0.1)(value, k));
        assert!(check(0.03, both).dead_share((0.01, SIZE)).is_some());
    }

    /// A truck that shakes in turns and stands straight without any noise, as a simulated one does.
    #[test]
    fn noise_that_comes_with_the_motion_is_none_at_zero() {
        let shaken = |value: f64, k: u32| {
            let side = if k.is_multiple_of(2) { 0.03 } else { -0.03 };
            if value != 0.0 && k % 500 > 100 { value + side } else { value }
        };
        assert_eq!(check(0.0, shaken).dead_share((1e-9, SIZE)), None);
    }

    #[test]
    fn rest_without_noise_and_rounding_are_none() {
        assert_eq!(check(0.0, |value, _| value).dead_share((1e-9, SIZE)), None);
        assert_eq!(check(0.03, |value, _| value).dead_share((1e-9, SIZE)), None);
        // What rounding and corners of a simulated turn leave is no noise.
        let shaken = |value: f64, k: u32| value + if k.is_multiple_of(2) { 1e-4 } else { -1e-4 };
        let zeros = |value: f64, k: u32| if value == 0.0 { 0.0 } else { shaken(value, k) };
        assert_eq!(check(0.0, zeros).dead_share((1e-9, SIZE)), None);
        for noise in [0.0, 0.002, 0.005, 0.02, 0.03] {
            let step = 0.01;
            let found = check(noise, |value, _| rounded(step)(value)).dead_share((step, SIZE));
            assert_eq!(found, None, "{noise}");
            // A sensor at 10 Hz in a log at 50 Hz.
            let mut held = 0.0;
            let hold = |value: f64, k: u32| {
                held = if k.is_multiple_of(5) { rounded(step)(value) } else { held };
                held
            };
            assert_eq!(check(noise, hold).dead_share((step, SIZE)), None, "held, {noise}");
        }
    }
}
