//! Whether the values of a signal can be measurements: zeros that stand for missing samples, and steps that are as
//! large as the signal.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::near_zero::NearZero;
use super::range_end::RangeEnd;

/// Samples without a zero before zeros are judged.
const LEAST_SAMPLES: f64 = 50.0;
/// How much greater than the usual difference of neighbors a value must be, for a zero beside it to be no
/// measurement: six standard deviations of white noise, whose differences have √2 of its own.
const JUMP: f64 = 4.0;
/// The same for half the root mean square of the signal so far.
const LARGE: f64 = 0.5;
/// Most zeros in a row that can be missing samples between two measured ones.
const LONGEST: u32 = 5;
/// Least number of such zeros, and least share of them in the large values, to be no chance. A share makes a
/// signal too small by as much.
const ZEROS: f64 = 5.0;
const ZEROS_SHARE: f64 = 0.01;
/// Values that differ by less than this are the same: what is left of steps after a change of units.
const SAME: f64 = 1e-9;
/// After this many samples only the first ones of each block are judged: they say the same for less.
const ALL: u64 = 8192;
const BLOCK: u64 = 256;
const OF_BLOCK: u64 = 16;
/// Share of the rounding of a step, its width over √12, in the root mean square of a signal, above which the
/// height can be wrong by as much.
const COARSE: f64 = 0.05;
/// Share of samples that differ from the one before, above which the noise of a signal in steps makes their mean true. With
/// noise of 0.4 steps, 0.43 of the samples differ from the one before, on average over where the signal stands between two steps, and
/// `e^(−2π²·0.4²)` = 4 % of the rounding are left.
const NOISY: f64 = 0.43;
/// Least number of changes to know the width of a step.
const CHANGES: f64 = 10.0;

/// Least distance of a value from zero in steps, for a zero beside it to be no measurement: one and a half steps of the sensor if
/// four samples make a mean, whose steps are a quarter.
const LEAST_STEPS: f64 = 6.0;

/// Speed from which on a truck does not stand, m/s.
const MOVING_MPS: f64 = 3.0;

/// Least value of an angle (rad), an acceleration (m/s²) and a yaw rate (rad/s) that is far from zero.
const ANGLE: f64 = 0.002;
const ACCELERATION: f64 = 0.1;
const RATE: f64 = 0.01;

/// A signal that is judged: its least value that is far from zero, and where it is in a sample.
type Judged = (Quantity, f64, fn(&Sample<f64>) -> f64);

const SIGNALS: [Judged; 12] = [
    (Quantity::Steer, ANGLE, |sample| sample.steer_rad),
    (Quantity::Roll, ANGLE, |sample| sample.roll_rad),
    (Quantity::RollToGravity, ANGLE, |sample| sample.roll_to_gravity_rad),
    (Quantity::Tilt, ANGLE, |sample| sample.tilt_rad),
    (Quantity::SuspensionRoll, ANGLE, |sample| sample.suspension_roll_rad),
    (Quantity::LateralAcceleration, ACCELERATION, |sample| sample.lateral_acceleration_mps2),
    (Quantity::LateralSpecificForce, ACCELERATION, |sample| sample.lateral_specific_force_mps2),
    (Quantity::TractorSuspensionRoll, ANGLE, |sample| sample.tractor_suspension_roll_rad),
    (Quantity::TractorLateralSpecificForce, ACCELERATION, |sample| {
        sample.tractor_lateral_specific_force_mps2
    }),
    (Quantity::TractorTilt, ANGLE, |sample| sample.tractor_tilt_rad),
    (Quantity::YawRate, RATE, |sample| sample.yaw_rate_radps),
    (Quantity::Speed, MOVING_MPS, |sample| sample.speed_mps),
];

/// Whether the motion of a signal is what a height follows from. A speed may be constant, and then has steps as large as its
/// motion; it stands still at zero.
fn is_of_roll(quantity: Quantity) -> bool {
    quantity != Quantity::Speed
}

/// The unit of a signal, as its column has it.
fn unit(signal: Quantity) -> &'static str {
    signal.column().trim_start_matches(signal.name()).trim_start_matches('_')
}

/// Whether nobody can hold a signal at one value, as a driver or a robot does with the steering wheel.
fn is_response(quantity: Quantity) -> bool {
    is_of_roll(quantity) && quantity != Quantity::Steer
}

/// One signal.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Values {
    /// The last value that was not zero, and the zeros since.
    last: Option<f64>,
    zeros_since: u32,
    /// Pairs of neighbors that are not zero, and the sum of the squares of their differences.
    pairs: f64,
    difference_square: f64,
    /// Values that are not zero, their sum, and that of their squares.
    rows: f64,
    sum: f64,
    square: f64,
    /// Values large enough for a zero beside them to be no measurement, and such zeros.
    large: f64,
    zeros: f64,
    /// The last value, zero or not.
    before: Option<f64>,
    /// Values that follow another one, changes to another value, and the smallest one.
    followers: f64,
    changes: f64,
    step: f64,
    #[serde(default)]
    near_zero: NearZero,
    #[serde(default)]
    range_end: RangeEnd,
}

impl Values {
    /// The next value has no neighbor before it.
    fn interrupt(&mut self) {
        (self.last, self.zeros_since, self.before) = (None, 0, None);
        self.near_zero.interrupt();
        self.range_end.interrupt();
    }

    fn push(&mut self, value: f64, far: f64, is_moving: bool) {
        if !value.is_finite() {
            if self.before.is_some() {
                self.interrupt();
            }
            return;
        }
        // Sensors are set to zero at standstill.
        if is_moving {
            self.near_zero.push(value);
            self.range_end.push(value, self.step);
        } else {
            self.near_zero.interrupt();
            self.range_end.interrupt();
        }
        if let Some(before) = self.before.replace(value) {
            self.step(value - before);
        }
        if value == 0.0 {
            self.zeros_since = self.zeros_since.saturating_add(1);
            return;
        }
        if let Some(last) = self.last {
            self.follow(last, value, far);
        }
        (self.last, self.zeros_since) = (Some(value), 0);
        self.rows += 1.0;
        self.sum += value;
        self.square += value * value;
    }

    /// A value after another one.
    fn follow(&mut self, last: f64, value: f64, far: f64) {
        let difference = (value - last).abs();
        let small = last.abs().min(value.abs());
        let is_large = last * value > 0.0
            && small > far
            && small > LEAST_STEPS * self.step
            && self.pairs > LEAST_SAMPLES
            && small * small * self.pairs > JUMP * JUMP * self.difference_square
            && small * small * self.rows > LARGE * LARGE * self.square;
        if is_large {
            self.large += 1.0;
            if (1..=LONGEST).contains(&self.zeros_since) && difference < small {
                self.zeros += f64::from(self.zeros_since);
            }
        }
        if self.zeros_since == 0 {
            self.pairs += 1.0;
            self.difference_square += difference * difference;
        }
    }

    /// The difference to the value before.
    fn step(&mut self, change: f64) {
        let size = change.abs();
        self.followers += 1.0;
        if size > SAME {
            self.step = if self.changes > 0.0 { self.step.min(size) } else { size };
            self.changes += 1.0;
        }
    }

    /// The share of zeros that are no measurements, if it matters.
    fn missing(&self) -> Option<f64> {
        let share = self.zeros / (self.zeros + self.large);
        (self.zeros >= ZEROS && share > ZEROS_SHARE).then_some(share)
    }

    /// The step, and the share of its rounding in the signal, if it matters.
    fn coarse(&self) -> Option<(f64, f64)> {
        let mean = self.sum / self.rows;
        let sd = (self.square / self.rows - mean * mean).max(0.0).sqrt();
        let share = self.step / 12.0_f64.sqrt() / sd;
        let is_noisy = self.changes > NOISY * self.followers;
        (self.changes >= CHANGES && !is_noisy && share > COARSE).then_some((self.step, share))
    }
}

/// Checks the values of all signals.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct ValueCheck {
    samples: u64,
    of_signals: [Values; SIGNALS.len()],
}

impl ValueCheck {
    /// Takes the next sample.
    pub(super) fn push(&mut self, sample: &Sample<f64>) {
        let of_block = self.samples % BLOCK;
        let is_later = self.samples >= ALL;
        self.samples += 1;
        if is_later && of_block >= OF_BLOCK {
            return;
        }
        if is_later && of_block == 0 {
            self.of_signals.iter_mut().for_each(Values::interrupt);
        }
        let is_moving = !(sample.speed_mps < MOVING_MPS);
        for (of_signal, (_, far, value)) in self.of_signals.iter_mut().zip(SIGNALS) {
            of_signal.push(value(sample), far, is_moving);
        }
    }

    /// What is found of the signal in which the share of it is the greatest, with that share, and the signal.
    fn worst<T>(
        &self,
        find: impl Fn(&Values, Quantity) -> Option<(f64, T)>,
    ) -> Option<(f64, T, Quantity)> {
        let found = self.of_signals.iter().zip(SIGNALS).filter_map(|(one, (signal, ..))| {
            let (share, more) = find(one, signal)?;
            Some((share, more, signal))
        });
        found.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The signal with zeros that stand for missing samples, if there is one.
    pub(super) fn missing(&self) -> Option<String> {
        let (share, (), signal) = self.worst(|one, _| Some((one.missing()?, ())))?;
        Some(format!(
            "{:.0} % of the {} is exactly 0 between values that are far from it: these are missing samples, which \
             count as measured; leave such cells empty",
            100.0 * share,
            signal.name()
        ))
    }

    /// The signal that is cut off at the end of a sensor's range, if there is one.
    pub(super) fn cut_off(&self) -> Option<String> {
        let (share, end, signal) = self.worst(|one, signal| {
            let (end, share) = one.range_end.share(one.step).filter(|_| is_response(signal))?;
            Some((share, end))
        })?;
        Some(format!(
            "{} stays at exactly {end:.3} {} in {:.0} % of its large values and never exceeds it, although it changes from \
             row to row elsewhere: it is cut off at the end of a range; record it with a wider one, or remove its column",
            signal.name(),
            unit(signal),
            100.0 * share
        ))
    }

    /// The signal with a dead band about zero, if there is one.
    pub(super) fn dead(&self) -> Option<String> {
        let (share, (), signal) = self.worst(|one, signal| {
            let noise = (one.step, (one.square / one.rows).sqrt());
            let share = one.near_zero.dead_share(noise).filter(|_| is_of_roll(signal))?;
            Some((share, ()))
        })?;
        Some(format!(
            "{} is exactly 0 in {:.0} % of the rows, although it has noise: it has a dead band there, so that the height can \
             be wrong by 20 %, which the interval does not contain; record it without one",
            signal.name(),
            100.0 * share
        ))
    }

    /// The signal whose steps are as large as its motion, if there is one.
    pub(super) fn coarse(&self) -> Option<String> {
        let (share, step, signal) = self.worst(|one, signal| {
            let (step, share) = one.coarse().filter(|_| is_of_roll(signal))?;
            Some((share, step))
        })?;
        Some(format!(
            "{} comes in steps of {step:.2e} {}, whose rounding is {:.0} % of its motion: the height can be wrong \
             by as much and more, which the interval does not contain; record it with a finer resolution",
            signal.name(),
            unit(signal),
            100.0 * share
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive of a minute at 50 Hz with turns every 10 s; the roll angle after `sensor`, which also gets the number
    /// of the sample.
    fn check(sensor: impl FnMut(f64, u32) -> f64) -> ValueCheck {
        check_of(3000, sensor)
    }

    /// The same for a number of samples.
    fn check_of(samples: u32, mut sensor: impl FnMut(f64, u32) -> f64) -> ValueCheck {
        let mut check = ValueCheck::default();
        for k in 0..samples {
            let time_s = f64::from(k) * 0.02;
            let turn = (time_s * std::f64::consts::TAU / 10.0).sin();
            let roll_rad = 0.03 * turn.powi(3);
            check.push(&Sample {
                roll_rad: sensor(roll_rad, k),
                yaw_rate_radps: 0.1 * turn,
                ..Sample::absent(u64::from(k) * 20_000)
            });
        }
        check
    }

    /// Pseudo-random, uniform between −√3 and √3, so that its standard deviation is one.
    fn noise(k: u32) -> f64 {
        let mixed = k.wrapping_mul(2_654_435_761) ^ 0x9e37_79b9;
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(2_246_822_519);
        (f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) - 0.5) * 12.0_f64.sqrt()
    }

    #[test]
    fn zeros_for_missing_samples_are_told_from_measured_ones() {
        assert_eq!(check(|roll_rad, _| roll_rad).missing(), None);
        for noise_rad in [0.0, 3e-4, 1.5e-3] {
            let every = |n: u32| {
                move |roll_rad: f64, k: u32| {
                    if n > 0 && noise(7 * k + 1).abs() < 12.0_f64.sqrt() / 2.0 / f64::from(n) {
                        0.0
                    } else {
                        roll_rad + noise_rad * noise(k)
                    }
                }
            };
            assert_eq!(check(every(0)).missing(), None, "{noise_rad}");
            for n in [5, 20] {
                let told = check(every(n)).missing().unwrap();
                assert!(told.contains("of the roll is exactly 0"), "{told}");
            }
        }
    }

    /// Steps with noise pass through zero and stay there, which are measurements.
    #[test]
    fn zeros_of_steps_are_measured() {
        for step_rad in [1e-3, 3e-3, 1e-2] {
            for share in [0.0, 0.2, 0.5, 1.0] {
                let sensor = |roll_rad: f64, k: u32| {
                    ((roll_rad + share * step_rad * noise(k)) / step_rad).round() * step_rad
                };
                assert_eq!(check(sensor).missing(), None, "{step_rad} {share}");
            }
        }
    }

    /// The difference of two levels that are rounded each by itself, with little noise: it is zero for many samples, and it
    /// flickers when one of both changes.
    #[test]
    fn the_difference_of_coarse_levels_is_told() {
        for noise_m in [2e-4, 5e-4, 1e-3] {
            let level = |roll_rad: f64, k: u32| {
                ((0.4 * roll_rad + 0.013 + noise_m * noise(k)) / 5e-3).round() * 5e-3
            };
            let found = check(|roll_rad, k| level(roll_rad, 2 * k) - level(-roll_rad, 2 * k + 1));
            assert!(found.coarse().is_some_and(|told| told.contains("steps")), "{noise_m}");
            assert_eq!(found.missing(), None, "{noise_m}");
        }
    }

    /// Steps of a sixth of the amplitude are coarse if the noise is less than they are; noise of half a step makes
    /// their mean true.
    #[test]
    fn steps_as_large_as_the_signal_are_told() {
        let steps = |step_rad: f64, noise_rad: f64| {
            check(|roll_rad, k| ((roll_rad + noise_rad * noise(k)) / step_rad).round() * step_rad)
                .coarse()
        };
        let told = steps(5e-3, 0.0).unwrap();
        assert!(told.contains("roll comes in steps of 5.00e-3 rad"), "{told}");
        assert_eq!(steps(1e-3, 0.0), None);
        // Some flicker between two steps does not make their mean true.
        assert!(steps(5e-3, 1e-3).is_some());
        assert_eq!(steps(5e-3, 2.5e-3), None);
        assert_eq!(check(|roll_rad, k| roll_rad + 1e-3 * noise(k)).coarse(), None);
    }

    /// A sensor that shows nothing within a tenth of the greatest angle; at standstill all of them show nothing.
    #[test]
    fn a_dead_band_is_told() {
        let noisy = |roll_rad: f64, k: u32| roll_rad + 5e-4 * noise(k);
        let cut = |roll_rad: f64| (roll_rad.abs() - 3e-3).max(0.0).copysign(roll_rad);
        let told = check(|roll_rad, k| cut(noisy(roll_rad, k))).dead().unwrap();
        assert!(told.starts_with("roll is exactly 0 in"), "{told}");
        assert_eq!(check(noisy).dead(), None);
        let mut parked = check(noisy);
        for k in 0..3000_u32 {
            let time_us = 60_000_000 + u64::from(k) * 20_000;
            parked.push(&Sample { roll_rad: 0.0, speed_mps: 0.0, ..Sample::absent(time_us) });
        }
        assert_eq!(parked.dead(), None);
    }

    /// In a long drive, of which a part is judged, zeros that come late are told, and blocks make none.
    #[test]
    fn late_zeros_are_told() {
        let late = |from: u32| {
            move |roll_rad: f64, k: u32| if k >= from && k % 17 == 3 { 0.0 } else { roll_rad }
        };
        assert!(check_of(60_000, late(15_000)).missing().is_some());
        assert_eq!(check_of(60_000, late(60_000)).missing(), None);
    }

    /// A sensor of 10 Hz in a log of 50 Hz has steps in time, not in value.
    #[test]
    fn held_values_are_no_steps() {
        let mut held = 0.0;
        let sensor = |roll_rad: f64, k: u32| {
            if k.is_multiple_of(5) {
                held = roll_rad;
            }
            held
        };
        assert_eq!(check(sensor).coarse(), None);
    }

    /// A truck that drives at one speed, in steps of 1 km/h, and stops once.
    #[test]
    fn a_speed_of_zero_between_others_is_a_missing_sample() {
        let told = |every: u32| {
            let mut check = ValueCheck::default();
            for k in 0..3000_u32 {
                let time_s = f64::from(k) * 0.02;
                let stops = if time_s < 50.0 { 1.0 } else { (60.0 - time_s) / 10.0 };
                let speed_mps = (50.0 * stops + 0.3 * noise(k)).round().max(0.0) / 3.6;
                let is_missing = every > 0 && k % every == 0;
                let speed_mps = if is_missing { 0.0 } else { speed_mps };
                check.push(&Sample { speed_mps, ..Sample::absent(u64::from(k) * 20_000) });
            }
            assert_eq!((check.coarse(), check.dead()), (None, None));
            check.missing()
        };
        assert_eq!(told(0), None);
        // A speed that is held has steps as large as its motion.
        let mut held = ValueCheck::default();
        for k in 0..3000_u32 {
            let speed_mps = f64::from(50 + k / 100 % 2) / 3.6;
            held.push(&Sample { speed_mps, ..Sample::absent(u64::from(k) * 20_000) });
        }
        assert_eq!((held.coarse(), held.missing()), (None, None));
        for every in [5, 20, 50] {
            assert!(told(every).unwrap().contains("of the speed is exactly 0"), "{every}");
        }
    }
}
