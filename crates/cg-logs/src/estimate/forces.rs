//! Whether a specific force contains the gravity of the body's roll.
//!
//! An accelerometer fixed to the body shows `f = a_y + g (φ + β)`: the lateral acceleration of the path,
//! and gravity by the roll of the body and by the bank of the road. Some sensors are compensated and show
//! `a_y` alone. With the yaw rate the two can be told apart: `f − U r` is `g (φ + β)` or nothing, apart
//! from the lag of one unit behind the other, which is proportional to the rate of change.
//!
//! The roll of the suspension is the scale: on a flat road the body rolls by at least as much, so `f − U r`
//! is at least `g s`. On a banked road it is greater, unless the bank cancels the roll in every turn; a
//! compensated force then still follows `U r` better than the suspension, which feels the bank.
//!
//! In a tight turn the trailer stands at the angle `ψ` to the tractor, on a circle that is smaller by `cos ψ`. The sine is its
//! wheelbase over the radius of the tractor's path, `l r / U`, and the lateral acceleration of the trailer `U r cos ψ`.

use cg_core::{Channel, Design, Input, Output, Sample, Signals};
use serde::{Deserialize, Serialize};

/// Time constant of both filters before the comparison.
const FILTER_S: f64 = 1.0;
/// Speed below which the yaw rate is not used, m/s.
const LEAST_MPS: f64 = 3.0;
/// Greatest `sin ψ` in a turn that is compared, `ψ` being 53 degrees: in a tighter one it changes all the time.
const GREATEST_SINE: f64 = 0.8;
/// Longest interval between two samples of one drive, s.
const GAP_S: f64 = 0.5;
/// Interval between the compared values, s: the filters pass nothing that is faster.
const STEP_S: f64 = 0.1;
/// Minimum number of compared values: 20 s.
const LEAST_ROWS: f64 = 200.0;
/// Minimum standard deviation of yaw rate times speed for a comparison, m/s².
const EXCITED_MPS2: f64 = 0.3;
/// `f − U r` over `g s`, below which the force has no gravity: the middle between nothing and 1, the least
/// on a flat road.
const WITHOUT: f64 = 0.5;
/// How much better a force must follow `U r` than the suspension roll to be without gravity on a banked
/// road. Both fit equally well where the road is flat.
const BETTER: f64 = 0.5;

/// What a specific force can be as a multiple of yaw rate times speed: with the gravity of the body's roll 1.0 to 1.4 on a
/// flat road. On public roads the bank of curves takes away up to a half in the mean of a drive, and that of roundabouts
/// adds 0.25 m/s² to 1 to 2 m/s².
const POSSIBLE_FLAT: [f64; 2] = [0.85, 1.45];
const POSSIBLE: [f64; 2] = [0.45, 1.6];

/// Least share of `g s` in yaw rate times speed for this. An empty trailer has 0.02, in which friction of the springs and
/// noise make the suspension follow worse than `U r`, a loaded one 0.06 to 0.12.
const LOADED: f64 = 0.04;

/// The compared signals: suspension roll, rate of change of `U r`, `f − U r`, and `f`.
const COUNT: usize = 4;
const ROLL: usize = 0;
const RATE: usize = 1;
const REST: usize = 2;
const FORCE: usize = 3;

/// Running means and sums of products of the compared signals.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Sums {
    rows: f64,
    mean: [f64; COUNT],
    products: [[f64; COUNT]; COUNT],
}

impl Sums {
    fn push(&mut self, row: [f64; COUNT]) {
        self.rows += 1.0;
        let before: [f64; COUNT] = std::array::from_fn(|k| row[k] - self.mean[k]);
        for (mean, before) in self.mean.iter_mut().zip(before) {
            *mean += before / self.rows;
        }
        for (k, sums) in self.products.iter_mut().enumerate() {
            for (sum, before) in sums.iter_mut().zip(before) {
                *sum += (row[k] - self.mean[k]) * before;
            }
        }
    }

    /// Sum of the squares of a signal without what is proportional to the rate of change and, if so
    /// wanted, to the suspension roll.
    fn left(&self, of: usize, without_roll: bool) -> f64 {
        let without_rate = |a: usize, b: usize| {
            self.products[a][b]
                - self.products[a][RATE] * self.products[RATE][b] / self.products[RATE][RATE]
        };
        let common = without_rate(of, ROLL);
        let by_roll = if without_roll { common * common / without_rate(ROLL, ROLL) } else { 0.0 };
        (without_rate(of, of) - by_roll).max(0.0)
    }

    /// Sum of the squares of yaw rate times speed, which is the force without the rest, if it varies enough.
    fn turn(&self) -> Option<f64> {
        let turn = self.products[FORCE][FORCE] - 2.0 * self.products[FORCE][REST]
            + self.products[REST][REST];
        let is_enough = self.rows >= LEAST_ROWS && turn >= EXCITED_MPS2 * EXCITED_MPS2 * self.rows;
        is_enough.then_some(turn)
    }

    /// The force as a multiple of yaw rate times speed.
    fn gain(&self) -> Option<f64> {
        let turn = self.turn()?;
        Some((self.products[FORCE][FORCE] - self.products[FORCE][REST]) / turn)
    }

    /// Whether the force has no gravity.
    fn is_without_gravity(&self, gravity_mps2: f64) -> bool {
        let Some(turn) = self.turn().filter(|_| self.products[RATE][RATE] > 0.0) else {
            return false;
        };
        let rest = self.left(REST, false);
        let least = gravity_mps2 * gravity_mps2 * self.products[ROLL][ROLL];
        let on_bank = rest < least
            && least > LOADED * LOADED * turn
            && rest < BETTER * BETTER * self.left(FORCE, true);
        rest < WITHOUT * WITHOUT * least || on_bank
    }
}

/// One unit of the truck.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Unit {
    last_us: u64,
    compared_us: u64,
    /// Suspension roll, yaw rate times speed and force after one and after two filters.
    smooth: Option<[[f64; 3]; 2]>,
    sums: Sums,
}

impl Unit {
    fn push(&mut self, time_us: u64, found: [f64; 3]) {
        // Also excludes NaN.
        if !found.iter().all(|one| one.is_finite()) {
            return;
        }
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds_since = |us: u64| time_us.saturating_sub(us) as f64 * 1e-6;
        let interval_s = seconds_since(self.last_us);
        self.last_us = time_us;
        if interval_s > GAP_S {
            self.smooth = None;
        }
        let share = interval_s / (FILTER_S + interval_s);
        let [once, twice] = self.smooth.get_or_insert([found; 2]);
        for ((once, twice), found) in once.iter_mut().zip(twice.iter_mut()).zip(found) {
            *once += (found - *once) * share;
            *twice += (*once - *twice) * share;
        }
        if seconds_since(self.compared_us) >= STEP_S {
            self.compared_us = time_us;
            let [roll, turn, force] = *twice;
            self.sums.push([roll, (once[1] - turn) / FILTER_S, force - turn, force]);
        }
    }
}

/// Checks the specific forces of one log.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct ForceCheck {
    trailer: Unit,
    tractor: Unit,
}

impl ForceCheck {
    /// Adds a sample.
    pub(super) fn push(&mut self, sample: &Sample<f64>, design: &Design<f64>) {
        let rolls = [sample.suspension_roll_rad, sample.tractor_suspension_roll_rad];
        if rolls.iter().all(|roll| roll.is_nan()) {
            return;
        }
        let sample = sample.checked();
        let sine = design.trailer_wheelbase_m * sample.yaw_rate_radps / sample.speed_mps;
        if !(sample.speed_mps > LEAST_MPS) || sine.abs() > GREATEST_SINE {
            return;
        }
        let turn_mps2 = sample.yaw_rate_radps * sample.speed_mps;
        let of_trailer_mps2 = turn_mps2 * (1.0 - sine * sine).sqrt();
        let signals = Signals::of(&sample, sample.speed_mps, design.gravity_mps2);
        for (unit, turn_mps2, output, input) in [
            (&mut self.trailer, of_trailer_mps2, Output::SuspensionRoll, Input::SpecificForce),
            (
                &mut self.tractor,
                turn_mps2,
                Output::TractorSuspensionRoll,
                Input::TractorSpecificForce,
            ),
        ] {
            unit.push(sample.time_us, [signals.output(output), turn_mps2, signals.input(input)]);
        }
    }

    /// What is wrong with the specific force of a channel that is used, on roads that are known to be flat or not.
    pub(super) fn contradiction(
        &self,
        gravity_mps2: f64,
        is_flat: bool,
        is_used: impl Fn(Channel) -> bool,
    ) -> Option<String> {
        self.without_gravity(gravity_mps2, &is_used).or_else(|| self.wrong_gain(is_flat, is_used))
    }

    /// The specific force that cannot be that of the turns.
    fn wrong_gain(&self, is_flat: bool, is_used: impl Fn(Channel) -> bool) -> Option<String> {
        let [least, greatest] = if is_flat { POSSIBLE_FLAT } else { POSSIBLE };
        let units = [
            (Channel::Suspension, &self.trailer, "trailer"),
            (Channel::Tractor, &self.tractor, "tractor"),
        ];
        units.into_iter().filter(|(channel, ..)| is_used(*channel)).find_map(|(_, unit, name)| {
            let gain = unit.sums.gain().filter(|gain| !(least..=greatest).contains(gain))?;
            Some(format!(
                "the specific force of the {name} is {gain:.2} times the product of yaw rate and speed, and at most \
                 {least} to {greatest} times is possible: its gain or unit is wrong, or that of yaw rate or speed"
            ))
        })
    }

    /// The specific force that does not contain gravity.
    fn without_gravity(
        &self,
        gravity_mps2: f64,
        is_used: impl Fn(Channel) -> bool,
    ) -> Option<String> {
        let units = [
            (Channel::Suspension, &self.trailer, "trailer", "name it lateral_acceleration"),
            (
                Channel::Tractor,
                &self.tractor,
                "tractor",
                "⟨vdc2 acceleration⟩ for that of VDC2, or name it lateral_acceleration",
            ),
        ];
        let found = units.into_iter().find(|(channel, unit, ..)| {
            is_used(*channel) && unit.sums.is_without_gravity(gravity_mps2)
        });
        found.map(|(_, _, name, remedy)| {
            format!(
                "the specific force of the {name} is yaw rate times speed and does not contain the gravity of \
                 its roll: either its sensor is compensated, so that it gives no height ({remedy}), or a \
                 sensor's gain is wrong, or the bank cancelled the roll in every turn, which another road shows"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::design;

    const GRAVITY_MPS2: f64 = 9.81;

    /// What is told of 60 s at 20 m/s. Body and suspension roll by 0.014 and 0.01 rad per m/s² over the
    /// road, whose bank is that of the time. The force has this share of gravity.
    fn told(share: f64, bank_rad: impl Fn(f64) -> f64) -> Option<String> {
        let mut check = ForceCheck::default();
        for k in 0..1200_u32 {
            let time_s = f64::from(k) * 0.05;
            let path_mps2 = (0.4 * time_s).sin() + 0.5 * (0.17 * time_s).sin();
            let felt_mps2 = path_mps2 + GRAVITY_MPS2 * bank_rad(time_s);
            let mut sample = Sample::absent(u64::from(k) * 50_000);
            (sample.speed_mps, sample.yaw_rate_radps) = (20.0, path_mps2 / 20.0);
            sample.tractor_suspension_roll_rad = 0.01 * felt_mps2;
            let to_gravity_rad = 0.014 * felt_mps2 + bank_rad(time_s);
            sample.tractor_lateral_specific_force_mps2 =
                path_mps2 + share * GRAVITY_MPS2 * to_gravity_rad;
            check.push(&sample, &design());
        }
        check.contradiction(GRAVITY_MPS2, false, |_| true)
    }

    #[test]
    fn a_force_without_gravity_is_told_on_every_road() {
        let banks: [fn(f64) -> f64; 3] =
            [|_| 0.0, |t| -0.04 * (0.4 * t).sin(), |t| 0.02 * (0.31 * t).cos()];
        for bank_rad in banks {
            assert_eq!(told(1.0, bank_rad), None);
            assert!(told(0.0, bank_rad).unwrap().contains("of the tractor"));
        }
    }

    /// With a speed every 0.6 s each value is the first after a gap, so that nothing is known of its rate of change.
    #[test]
    fn values_that_come_one_by_one_tell_nothing() {
        let mut check = ForceCheck::default();
        for k in 0..1200_u32 {
            let path_mps2 = (0.2 * f64::from(k)).sin();
            let mut sample = Sample::absent(u64::from(k) * 600_000);
            (sample.speed_mps, sample.yaw_rate_radps) = (20.0, path_mps2 / 20.0);
            sample.suspension_roll_rad = 0.01 * path_mps2;
            sample.lateral_specific_force_mps2 = 1.14 * path_mps2;
            check.push(&sample, &design());
        }
        assert_eq!(check.contradiction(GRAVITY_MPS2, false, |_| true), None);
    }

    /// On a flat road `f − U r` is `1.4 · share · g s`; it counts as nothing below 0.5.
    #[test]
    fn half_of_the_suspension_roll_is_the_limit() {
        for (share, is_told) in [(0.34, true), (0.37, false)] {
            assert_eq!(told(share, |_| 0.0).is_some(), is_told, "{share}");
        }
    }

    /// The roll of the body makes the force 1.14 times the turn. A road that may be banked allows 1.6 times.
    #[test]
    fn a_force_that_no_turn_has_is_told() {
        let told = |gain: f64, is_flat: bool| {
            let mut check = ForceCheck::default();
            for k in 0..1200_u32 {
                let path_mps2 = (0.02 * f64::from(k)).sin();
                let mut sample = Sample::absent(u64::from(k) * 50_000);
                (sample.speed_mps, sample.yaw_rate_radps) = (20.0, path_mps2 / 20.0);
                sample.suspension_roll_rad = 0.01 * path_mps2;
                sample.lateral_specific_force_mps2 =
                    gain * path_mps2 * (1.0 + GRAVITY_MPS2 * 0.014);
                check.push(&sample, &design());
            }
            check.contradiction(GRAVITY_MPS2, is_flat, |one| one == Channel::Suspension)
        };
        assert!(told(1.0, true).is_none() && told(1.25, true).is_none());
        assert!(told(1.3, true).unwrap().contains("1.48 times"));
        assert!(told(1.35, false).is_none());
        let message = told(2.0, false).unwrap();
        assert!(
            message.starts_with("the specific force of the trailer is 2.27 times"),
            "{message}"
        );
    }

    /// Without a yaw rate, a turn, or a height there is nothing to tell.
    #[test]
    fn what_cannot_be_known_is_not_told() {
        let check = |yaw_rate_radps: f64| {
            let mut check = ForceCheck::default();
            for k in 0..1200_u32 {
                let mut sample = Sample::absent(u64::from(k) * 50_000);
                sample.speed_mps = 20.0;
                sample.yaw_rate_radps = yaw_rate_radps * (0.02 * f64::from(k)).sin();
                sample.suspension_roll_rad = 0.2 * sample.yaw_rate_radps;
                sample.lateral_specific_force_mps2 = 20.0 * sample.yaw_rate_radps;
                check.push(&sample, &design());
            }
            check
        };
        let tell =
            |check: ForceCheck, used| check.contradiction(GRAVITY_MPS2, false, |one| one == used);
        assert!(tell(check(0.05), Channel::Suspension).unwrap().contains("of the trailer"));
        assert_eq!(tell(check(0.05), Channel::Tractor), None);
        assert_eq!(tell(check(0.01), Channel::Suspension), None, "hardly a turn");
        assert_eq!(tell(check(f64::NAN), Channel::Suspension), None);
    }
}
