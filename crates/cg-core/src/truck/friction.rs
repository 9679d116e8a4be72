//! The friction of leaf springs, calculated from the roll angle itself.
//!
//! Friction holds a suspension anywhere between two curves, so its roll angle depends on how it got
//! there, and no linear model describes that. But the roll angle is measured. The moment of the
//! springs is
//!
//! ```text
//!     M = k (s + δ q),    dq/ds = (sign ds − q)/β
//! ```
//!
//! with the law of Fancher, Ervin, MacAdam and Winkler (SAE 800905) for the state `q` of the friction,
//! between −1 and 1. `s + δ q` is therefore what the suspension would roll by without friction.

use crate::math::real::Real;

/// Motion that is not counted, as a share of [`Friction::deflection_rad`]: noise of the sensor would
/// otherwise release the friction. It delays the friction by as much.
const PLAY_SHARE: f64 = 0.05;

/// The friction of the springs in a channel, at one mass; all zero without friction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction<T> {
    /// The part of the roll angle that the linear model takes as friction: its stiffness contains the
    /// mean effect of friction in a usual turn, which is subtracted first.
    pub usual_share: T,
    /// `δ`: the roll angle by which the springs' whole friction holds the suspension.
    pub roll_rad: T,
    /// `β`: the roll angle within which the friction changes sides.
    pub deflection_rad: T,
}

impl<T: Real> Friction<T> {
    /// No friction.
    pub const NONE: Self =
        Self { usual_share: T::ZERO, roll_rad: T::ZERO, deflection_rad: T::ZERO };

    /// The friction between this one and another.
    #[must_use]
    pub fn blend(&self, other: &Self, share: T) -> Self {
        let between = |a: T, b: T| a + (b - a) * share;
        Self {
            usual_share: between(self.usual_share, other.usual_share),
            roll_rad: between(self.roll_rad, other.roll_rad),
            deflection_rad: between(self.deflection_rad, other.deflection_rad),
        }
    }
}

/// The state of the friction.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrictionState<T> {
    /// The roll angle so far, without small motion.
    place_rad: T,
    /// `q`.
    side: T,
}

impl<T: Real> FrictionState<T> {
    /// Springs midway between their curves.
    pub const fn at_rest(roll_rad: T) -> Self {
        Self { place_rad: roll_rad, side: T::ZERO }
    }

    /// Advances to the next roll angle; returns `δ q`.
    pub fn push(&mut self, friction: &Friction<T>, roll_rad: T) -> T {
        if !(friction.deflection_rad > T::zero()) {
            return T::zero();
        }
        let play_rad = friction.deflection_rad * T::of(PLAY_SHARE);
        let place_rad = self.place_rad.max(roll_rad - play_rad).min(roll_rad + play_rad);
        let moved = (place_rad - self.place_rad) / friction.deflection_rad;
        self.place_rad = place_rad;
        // 1 − e^(−x) for a small x, and at most 1.
        let (size, half) = (moved.abs(), T::of(0.5));
        let share = (size / (T::one() + size * half)).min(T::one());
        let target = if moved > T::zero() { T::one() } else { -T::one() };
        self.side += (target - self.side) * share;
        friction.roll_rad * self.side
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: Friction<f64> =
        Friction { usual_share: 0.0, roll_rad: 2e-3, deflection_rad: 8e-3 };

    /// The law over a monotone motion from the middle is `q = 1 − e^(−s/β)`; the play of 0.05 delays it.
    /// In the other direction it starts from where the friction is: `q = −1 + (1 + q₀) e^(−s/β)`.
    #[test]
    fn friction_follows_its_law_in_both_directions() {
        let mut state = FrictionState::at_rest(0.0);
        let mut held_rad = 0.0;
        for k in 1..=400 {
            held_rad = state.push(&FRICTION, f64::from(k) * 5e-5);
        }
        let (reach, play) = (20.0_f64 / 8.0, 0.05);
        let there = 1.0 - (play - reach).exp();
        assert!((held_rad / 2e-3 - there).abs() < 1e-4, "{held_rad}");
        for k in 1..=400 {
            held_rad = state.push(&FRICTION, 0.02 - f64::from(k) * 5e-5);
        }
        // The play is crossed before the motion counts.
        let back = -1.0 + (1.0 + there) * (2.0 * play - reach).exp();
        assert!((held_rad / 2e-3 - back).abs() < 1e-4, "{held_rad} {back}");
    }

    #[test]
    fn noise_within_the_play_and_no_friction_change_nothing() {
        let mut state = FrictionState::at_rest(0.01);
        for k in 0..100 {
            let noise_rad = if k % 2 == 0 { 3.9e-4 } else { -3.9e-4 };
            assert!(state.push(&FRICTION, 0.01 + noise_rad).abs() < 1e-12);
        }
        let mut none = FrictionState::at_rest(0.0);
        assert!(
            none.push(&Friction::NONE, 0.05) == 0.0 && none.push(&Friction::NONE, -0.05) == 0.0
        );
    }

    #[test]
    fn one_long_step_turns_the_friction_over() {
        let mut state = FrictionState::at_rest(0.0);
        assert!((state.push(&FRICTION, 1.0) - 2e-3).abs() < 1e-12);
        assert!((state.push(&FRICTION, -1.0) + 2e-3).abs() < 1e-12);
    }
}
