//! A lateral acceleration or specific force that repeats one value while the truck rolls.
//!
//! Where a yaw rate or a steer angle is known, [`agreement`](super::agreement) compares them. Without both, only the roll angle
//! shows that the truck turns. It also changes on a banked road, so a small lateral acceleration beside it is no fault, but one
//! that is the same to the last bit is.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

/// Time for which a value is the same, s. Coarse sensors repeat their values for some seconds, also while the bank of a straight
/// road changes.
const HELD_S: f64 = 30.0;
/// Time over which the roll angle is smoothed, s. Noise of a tenth of a turn leaves a tenth of a degree of it.
const SMOOTH_S: f64 = 1.0;
/// Time between two samples after which the count begins again, s.
const GAP_S: f64 = 1.0;
/// Below this speed a truck may stand, m/s, and is loaded.
const DRIVES_MPS: f64 = 5.0;

/// An input, the roll angle that it explains, and how much that changes in a turn, rad: that of about 0.4 m/s² of usual trucks.
struct Pair {
    quantity: Quantity,
    input: fn(&Sample<f64>) -> f64,
    roll: fn(&Sample<f64>) -> f64,
    turn_rad: f64,
}

const PAIRS: [Pair; 3] = [
    Pair {
        quantity: Quantity::LateralAcceleration,
        input: |sample| sample.lateral_acceleration_mps2,
        roll: |sample| sample.roll_rad,
        turn_rad: 0.01,
    },
    Pair {
        quantity: Quantity::LateralSpecificForce,
        input: |sample| sample.lateral_specific_force_mps2,
        roll: |sample| sample.suspension_roll_rad,
        turn_rad: 0.007,
    },
    Pair {
        quantity: Quantity::TractorLateralSpecificForce,
        input: |sample| sample.tractor_lateral_specific_force_mps2,
        roll: |sample| sample.tractor_suspension_roll_rad,
        turn_rad: 0.005,
    },
];

/// How long an input has had its value, and what the roll angle did meanwhile.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Held {
    value: f64,
    seconds: f64,
    smooth_rad: f64,
    least_rad: f64,
    greatest_rad: f64,
}

impl Held {
    fn begin(value: f64, roll_rad: f64) -> Self {
        let [smooth_rad, least_rad, greatest_rad] = [roll_rad; 3];
        Self { value, seconds: 0.0, smooth_rad, least_rad, greatest_rad }
    }

    fn push(&mut self, interval_s: f64, roll_rad: f64) {
        self.seconds += interval_s;
        self.smooth_rad += (roll_rad - self.smooth_rad) * interval_s / (SMOOTH_S + interval_s);
        self.least_rad = self.least_rad.min(self.smooth_rad);
        self.greatest_rad = self.greatest_rad.max(self.smooth_rad);
    }

    fn is_frozen(&self, pair: &Pair) -> bool {
        self.seconds >= HELD_S && self.greatest_rad - self.least_rad > pair.turn_rad
    }
}

/// Watches the inputs of a drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct FrozenCheck {
    last_us: u64,
    held: [Option<Held>; PAIRS.len()],
}

impl FrozenCheck {
    /// Takes the next sample; whether an input has frozen, or moves again.
    pub(super) fn push(&mut self, sample: &Sample<f64>) -> bool {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let interval_s = sample.time_us.saturating_sub(self.last_us) as f64 * 1e-6;
        self.last_us = sample.time_us;
        let drives = !(sample.speed_mps < DRIVES_MPS) && interval_s <= GAP_S;
        let mut is_news = false;
        for (pair, held) in PAIRS.iter().zip(&mut self.held) {
            let was_frozen = held.is_some_and(|held| held.is_frozen(pair));
            let [value, roll_rad] = [(pair.input)(sample), (pair.roll)(sample)];
            if !drives || !value.is_finite() || !roll_rad.is_finite() {
                *held = None;
            } else if let Some(held) =
                held.as_mut().filter(|held| held.value.to_bits() == value.to_bits())
            {
                held.push(interval_s, roll_rad);
            } else {
                *held = Some(Held::begin(value, roll_rad));
            }
            is_news |= held.is_some_and(|held| held.is_frozen(pair)) != was_frozen;
        }
        is_news
    }

    /// What has frozen, at present.
    pub(super) fn message(&self) -> Option<String> {
        let mut pairs = PAIRS.iter().zip(&self.held);
        let frozen = |(pair, held): (&Pair, &Option<Held>)| {
            held.filter(|held| held.is_frozen(pair)).map(|held| (pair.quantity, held))
        };
        let (quantity, held) = pairs.find_map(frozen)?;
        Some(format!(
            "{} has been {:.3} m/s² for {:.0} s, while the roll angle changed by {:.1} degrees: that sensor or its signal has \
             frozen, and neither turns nor a rollover warning can follow from it",
            quantity.name(),
            held.value,
            held.seconds,
            (held.greatest_rad - held.least_rad).to_degrees()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A truck at 15 m/s that rolls by 0.02 rad in turns of 10 s; `lateral` is what its sensor says at a time, s.
    fn after(seconds: u32, roll_rad: f64, lateral: impl Fn(f64) -> f64) -> (FrozenCheck, usize) {
        let (mut check, mut news) = (FrozenCheck::default(), 0);
        for k in 0..seconds * 50 {
            let time_s = f64::from(k) * 0.02;
            let mut sample = Sample::absent(u64::from(k) * 20_000);
            (sample.speed_mps, sample.roll_rad) = (15.0, roll_rad * (0.6 * time_s).sin());
            sample.lateral_acceleration_mps2 = lateral(time_s);
            news += usize::from(check.push(&sample));
        }
        (check, news)
    }

    #[test]
    fn a_value_that_does_not_change_in_turns_is_told_until_it_does() {
        let until =
            |frozen_s: f64| move |time_s: f64| if time_s < frozen_s { 0.25 } else { time_s };
        let (frozen, news) = after(32, 0.02, until(99.0));
        assert_eq!(news, 1);
        assert!(
            frozen
                .message()
                .unwrap()
                .starts_with("lateral_acceleration has been 0.250 m/s² for 32 s")
        );
        let (thawed, news) = after(34, 0.02, until(32.0));
        assert_eq!((thawed.message(), news), (None, 2));
        // One that moves, one of a truck that drives straight on, and one that is not there.
        assert_eq!(after(50, 0.02, |time_s| 1e-9 * time_s).0.message(), None);
        assert_eq!(after(50, 0.003, |_| 0.0).0.message(), None);
        assert_eq!(after(50, 0.02, |_| f64::NAN).0.message(), None);
    }
}
