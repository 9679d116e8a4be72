//! Whether the signals that show a turn agree at present.
//!
//! A signal that dies in the course of a day is hidden in the means of the whole day. Each lateral acceleration is
//! therefore compared with yaw rate times speed in one stretch of driving after the other, and the last one counts.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::pair::Pair;
use super::signals::is_tight;

/// Time constant of the filter before the comparison.
const FILTER_S: f64 = 1.0;
/// Longest interval between two samples of one drive, and least one between two that are taken, s.
const GAP_S: f64 = 0.5;
const STEP_S: f64 = 0.05;
/// A truck below the first speed stands; between both a yaw rate can be that of a tractor that maneuvers, m/s.
const STANDS_MPS: f64 = 0.1;
const DRIVES_MPS: f64 = 2.0;
/// Least duration of a stretch, and the duration after which one without turns is forgotten, s.
const STRETCH_S: f64 = 30.0;
const STRAIGHT_S: f64 = 120.0;
/// A signal stands still if it varies by less than this share of what the other one shows.
const STILL: f64 = 0.2;
/// Wheelbase with which a steer angle gives a lateral acceleration, m. Long tractors and trucks that understeer have up to
/// four times less of it, so a signal stands still below a smaller share.
const WHEELBASE_M: f64 = 4.0;
const STILL_BESIDE_STEER: f64 = 0.05;

/// A lateral acceleration, what it must vary by to be judged, m/s², and which multiples of yaw rate times speed it can be.
struct Lateral {
    quantity: Quantity,
    of: fn(&Sample<f64>) -> f64,
    excited_mps2: f64,
    possible: [f64; 2],
}

/// In a single stretch, gain and side slip make less than a half. A specific force also contains gravity, by the roll
/// of the body (up to 1.4 times) and by the bank of the road, which on public roads takes away up to a half of it or,
/// in a roundabout, adds as much.
const LATERALS: [Lateral; 3] = [
    Lateral {
        quantity: Quantity::LateralAcceleration,
        of: |sample| sample.lateral_acceleration_mps2,
        excited_mps2: 0.3,
        possible: [0.6, 1.6],
    },
    Lateral {
        quantity: Quantity::LateralSpecificForce,
        of: |sample| sample.lateral_specific_force_mps2,
        excited_mps2: 0.6,
        possible: [0.3, 2.0],
    },
    Lateral {
        quantity: Quantity::TractorLateralSpecificForce,
        of: |sample| sample.tractor_lateral_specific_force_mps2,
        excited_mps2: 0.6,
        possible: [0.3, 2.0],
    },
];

/// What is wrong in a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Fault {
    /// The lateral acceleration stands still in turns.
    Still,
    /// Yaw rate or speed stands still in turns.
    NoTurn,
    /// The lateral acceleration is this multiple of yaw rate times speed.
    Gain(f64),
}

/// A stretch of driving, and what was wrong in the last one that was judged.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Stretch {
    seconds: f64,
    /// Time without one of the signals, s.
    absent_s: f64,
    rows: f64,
    both: Pair,
    fault: Option<Fault>,
}

impl Stretch {
    /// Takes the acceleration that the turn has by other signals, and the lateral one; whether a stretch was judged. A fault of a
    /// signal that does not come any more is forgotten.
    fn push(
        &mut self,
        interval_s: f64,
        both: [f64; 2],
        excited_mps2: f64,
        judge: impl Fn(&Pair) -> Option<Fault>,
    ) -> bool {
        if !both.iter().all(|one| one.is_finite()) {
            self.absent_s += interval_s;
            return self.absent_s > STRAIGHT_S && self.fault.take().is_some();
        }
        self.absent_s = 0.0;
        self.seconds += interval_s;
        self.rows += 1.0;
        self.both.push(self.rows, both);
        if self.seconds < STRETCH_S {
            return false;
        }
        let least = excited_mps2 * excited_mps2 * self.rows;
        let is_excited = self.both.square().max(self.both.second_square()) > least;
        if is_excited {
            self.fault = judge(&self.both);
        }
        if is_excited || self.seconds > STRAIGHT_S {
            *self = Self { fault: self.fault, ..Self::default() };
        }
        is_excited
    }
}

/// What a lateral acceleration is beside yaw rate times speed.
fn beside_turn(both: &Pair, [least, greatest]: [f64; 2]) -> Option<Fault> {
    let [turn, lateral] = [both.square(), both.second_square()];
    if lateral < STILL * STILL * turn {
        return Some(Fault::Still);
    }
    if turn < STILL * STILL * lateral {
        return Some(Fault::NoTurn);
    }
    let gain = both.gain();
    (!(least..=greatest).contains(&gain)).then_some(Fault::Gain(gain))
}

/// Compares the signals of one drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct AgreementCheck {
    last_us: Option<u64>,
    /// Yaw rate times speed, the acceleration by the steer angle, and the lateral ones.
    smooth: Option<[f64; 2 + LATERALS.len()]>,
    beside_turn: [Stretch; LATERALS.len()],
    /// Without a yaw rate.
    beside_steer: [Stretch; LATERALS.len()],
}

impl AgreementCheck {
    /// Takes the next sample; whether a stretch of driving was judged.
    pub(super) fn push(&mut self, sample: &Sample<f64>) -> bool {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let interval_s = self
            .last_us
            .map_or(GAP_S, |last_us| sample.time_us.saturating_sub(last_us) as f64 * 1e-6);
        if interval_s < STEP_S {
            return false;
        }
        self.last_us = Some(sample.time_us);
        let of = |quantity: Quantity, x: f64| if quantity.plausible(x) { x } else { f64::NAN };
        let speed_mps = of(Quantity::Speed, sample.speed_mps);
        let is_known = speed_mps <= STANDS_MPS || speed_mps >= DRIVES_MPS;
        if !is_known || interval_s > GAP_S {
            self.smooth = None;
            return false;
        }
        let turn = of(Quantity::YawRate, sample.yaw_rate_radps) * speed_mps;
        let by_steer = of(Quantity::Steer, sample.steer_rad) * speed_mps * speed_mps / WHEELBASE_M;
        let [path, trailer, tractor] =
            LATERALS.map(|lateral| of(lateral.quantity, (lateral.of)(sample)));
        if speed_mps >= DRIVES_MPS
            && [path, trailer, tractor].iter().any(|a| is_tight(speed_mps, &[turn, *a]))
        {
            return false;
        }
        let found = [turn, by_steer, path, trailer, tractor];
        let share = interval_s / (FILTER_S + interval_s);
        let smooth = self.smooth.get_or_insert(found);
        for (smooth, found) in smooth.iter_mut().zip(found) {
            *smooth = if smooth.is_finite() { *smooth + (found - *smooth) * share } else { found };
        }
        let [turn, by_steer, laterals @ ..] = *smooth;
        let mut is_judged = false;
        for (k, (lateral, known)) in laterals.into_iter().zip(&LATERALS).enumerate() {
            let excited_mps2 = known.excited_mps2;
            is_judged |=
                self.beside_turn[k].push(interval_s, [turn, lateral], excited_mps2, |both| {
                    beside_turn(both, known.possible)
                });
            if turn.is_nan() {
                is_judged |= self.beside_steer[k].push(
                    interval_s,
                    [by_steer, lateral],
                    excited_mps2,
                    |both| {
                        let least = STILL_BESIDE_STEER * STILL_BESIDE_STEER * both.square();
                        (both.second_square() < least).then_some(Fault::Still)
                    },
                );
            }
        }
        is_judged
    }

    /// What does not agree in the last stretch with turns.
    pub(super) fn contradiction(&self) -> Option<String> {
        let known = || LATERALS.iter().map(|lateral| lateral.quantity);
        let beside = |others: &'static str, stretches: &[Stretch]| {
            let faults = stretches.iter().zip(known()).map(|(one, name)| Some((one.fault?, name)));
            faults.flatten().next().map(|(fault, quantity)| said(fault, quantity, others))
        };
        beside("yaw rate and speed show", &self.beside_turn)
            .or_else(|| beside("steer angle and speed show", &self.beside_steer))
    }
}

fn said(fault: Fault, quantity: Quantity, others: &str) -> String {
    let name = quantity.name();
    match fault {
        Fault::Still => format!(
            "{name} stood still in turns that {others}: that sensor or its signal is dead, or the others are wrong"
        ),
        Fault::NoTurn => format!(
            "yaw rate or speed stood still in turns that {name} shows: that sensor or its signal is dead, or \
             {name} is wrong"
        ),
        Fault::Gain(gain) => format!(
            "{name} was {gain:.2} times the product of yaw rate and speed in the last turns, which it cannot be: a \
             sensor fails, or a sign, unit or gain is wrong"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A truck that weaves at 15 m/s, with what sensors make of it, from a time to another one, s.
    fn drive(
        check: &mut AgreementCheck,
        [from_s, to_s]: [u32; 2],
        sensors: impl Fn(&mut Sample<f64>, f64),
    ) -> usize {
        let mut judged = 0;
        for k in from_s * 50..to_s * 50 {
            let turn_mps2 = (f64::from(k) * 0.02 * 0.5).sin();
            let mut sample = Sample::absent(u64::from(k) * 20_000);
            (sample.speed_mps, sample.yaw_rate_radps) = (15.0, turn_mps2 / 15.0);
            sample.steer_rad = turn_mps2 * 6.0 / 225.0;
            sensors(&mut sample, turn_mps2);
            judged += usize::from(check.push(&sample));
        }
        judged
    }

    fn told(sensors: impl Fn(&mut Sample<f64>, f64)) -> Option<String> {
        let mut check = AgreementCheck::default();
        drive(&mut check, [0, 40], sensors);
        check.contradiction()
    }

    #[test]
    fn signals_that_agree_are_no_fault() {
        assert_eq!(told(|sample, turn| sample.lateral_acceleration_mps2 = 1.1 * turn), None);
        assert_eq!(told(|sample, turn| sample.lateral_specific_force_mps2 = 1.9 * turn), None);
        assert_eq!(
            told(|sample, turn| sample.tractor_lateral_specific_force_mps2 = 0.4 * turn),
            None
        );
        // Hardly any turn.
        assert_eq!(
            told(|sample, turn| {
                sample.yaw_rate_radps *= 0.1;
                sample.lateral_acceleration_mps2 = 0.3 * turn;
            }),
            None
        );
        // A trailer that follows by 0.8 of a radian, a third of a second in a lane change.
        assert_eq!(
            told(|sample, _| {
                #[allow(clippy::cast_precision_loss)]
                let before_s = sample.time_us as f64 * 1e-6 - 1.6;
                sample.lateral_acceleration_mps2 = (0.5 * before_s).sin();
            }),
            None
        );
    }

    #[test]
    fn each_fault_is_told() {
        let names = |found: Option<String>, words: [&str; 2]| {
            let found = found.unwrap();
            assert!(words.iter().all(|word| found.contains(word)), "{found}");
        };
        names(
            told(|sample, _| sample.lateral_acceleration_mps2 = 0.0),
            ["lateral_acceleration stood still", "yaw rate and speed"],
        );
        names(
            told(|sample, turn| {
                sample.tractor_lateral_specific_force_mps2 = turn;
                sample.yaw_rate_radps = 0.001;
            }),
            ["yaw rate or speed stood still", "tractor_lateral_specific_force shows"],
        );
        // A standing truck does not turn.
        names(
            told(|sample, turn| {
                sample.lateral_acceleration_mps2 = turn;
                sample.speed_mps = 0.0;
            }),
            ["yaw rate or speed stood still", "lateral_acceleration shows"],
        );
        names(
            told(|sample, turn| sample.lateral_specific_force_mps2 = 2.1 * turn),
            ["lateral_specific_force was 2.10 times", "unit"],
        );
        names(
            told(|sample, turn| sample.lateral_acceleration_mps2 = -turn),
            ["lateral_acceleration was -1.00 times", "sign"],
        );
        names(
            told(|sample, _| {
                sample.yaw_rate_radps = f64::NAN;
                sample.lateral_acceleration_mps2 = 0.01;
            }),
            ["lateral_acceleration stood still", "steer angle and speed"],
        );
    }

    /// The fault of the last stretch counts: one that begins after an hour is found within a minute, and one that ends is
    /// forgotten.
    #[test]
    fn the_last_stretch_counts() {
        let mut check = AgreementCheck::default();
        let good = |sample: &mut Sample<f64>, turn: f64| sample.lateral_acceleration_mps2 = turn;
        assert!(drive(&mut check, [0, 3600], good) >= 119);
        assert_eq!(check.contradiction(), None);
        drive(&mut check, [3600, 3660], |sample, _| sample.lateral_acceleration_mps2 = 0.2);
        assert!(check.contradiction().is_some());
        drive(&mut check, [3660, 3721], good);
        assert_eq!(check.contradiction(), None);
    }

    #[test]
    fn a_signal_that_does_not_come_any_more_is_no_fault() {
        let mut check = AgreementCheck::default();
        drive(&mut check, [0, 40], |sample, _| sample.lateral_acceleration_mps2 = 0.0);
        let without = |sample: &mut Sample<f64>, _: f64| {
            (sample.yaw_rate_radps, sample.steer_rad) = (f64::NAN, f64::NAN);
        };
        assert_eq!(drive(&mut check, [40, 159], without), 0);
        assert!(check.contradiction().is_some());
        assert_eq!(drive(&mut check, [159, 170], without), 1);
        assert_eq!(check.contradiction(), None);
    }

    /// A long straight does not dilute the turn after it.
    #[test]
    fn a_stretch_without_turns_is_forgotten() {
        let mut check = AgreementCheck::default();
        let straight = |sample: &mut Sample<f64>, _: f64| {
            (sample.yaw_rate_radps, sample.lateral_acceleration_mps2) = (0.0, 0.0);
        };
        assert_eq!(drive(&mut check, [0, 600], straight), 0);
        drive(&mut check, [600, 660], |sample, _| sample.lateral_acceleration_mps2 = 0.0);
        assert!(check.contradiction().is_some());
    }
}
