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
//! between −1 and 1. `s + δ q` is therefore what the suspension would roll by without friction. The stiffness
//! `k` itself changes with the roll angle where the curves have bends.

use crate::math::real::Real;

/// Motion that is not counted, because noise of the sensor would otherwise release the friction: this many standard
/// deviations of it, at least this share of [`Friction::deflection_rad`] for noise that is too slow to be noticed.
///
/// The greatest of some hundred roll angles deviates by three standard deviations, so with this play the place follows
/// the roll angle itself, and a reversal loses nothing. Every reversal loses the share: on the nonlinear plant with
/// leaf springs, 0.03 makes lane changes worse, and 0.01 steady turns with slow noise.
const PLAY: f64 = 3.0;
const PLAY_SHARE: f64 = 0.02;

/// The friction and the bends of the springs in a channel, at one mass; all zero without friction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction<T> {
    /// The part of the roll angle that the linear model takes as friction: its stiffness contains the
    /// mean effect of friction in a usual turn, which is subtracted first. It is negative where the springs
    /// are stiffer for small angles than in a usual turn.
    pub usual_share: T,
    /// By how much the slope of the springs increases beyond the knee, over that of the linear model.
    pub bend: T,
    /// The roll angle of the knee.
    pub knee_rad: T,
    /// `δ`: the roll angle by which the springs' whole friction holds the suspension.
    pub roll_rad: T,
    /// `β`: the roll angle within which the friction changes sides.
    pub deflection_rad: T,
}

impl<T: Real> Friction<T> {
    /// No friction.
    pub const NONE: Self = Self {
        usual_share: T::ZERO,
        bend: T::ZERO,
        knee_rad: T::ZERO,
        roll_rad: T::ZERO,
        deflection_rad: T::ZERO,
    };

    /// The same in another precision.
    pub(crate) fn cast<U: Real>(&self) -> Friction<U> {
        let to = |x: T| U::of(x.as_f64());
        Friction {
            usual_share: to(self.usual_share),
            bend: to(self.bend),
            knee_rad: to(self.knee_rad),
            roll_rad: to(self.roll_rad),
            deflection_rad: to(self.deflection_rad),
        }
    }

    /// Whether there is friction.
    pub(crate) fn acts(&self) -> bool {
        self.deflection_rad > T::zero()
    }

    /// Whether this is no friction, or leaves the springs a slope and has positive angles.
    pub(crate) fn is_possible(&self) -> bool {
        let Self { usual_share, bend, knee_rad, roll_rad, deflection_rad } = *self;
        // Comparisons that NaN fails.
        let sloped = usual_share.abs() < T::one() && bend - usual_share > -T::one();
        let acts = roll_rad > T::zero() && deflection_rad > T::zero() && knee_rad >= T::zero();
        let finite = (bend + knee_rad + roll_rad + deflection_rad).present();
        (sloped && acts && finite) || *self == Self::NONE
    }

    /// The friction between this one and another.
    #[must_use]
    pub fn blend(&self, other: &Self, share: T) -> Self {
        let between = |a: T, b: T| a + (b - a) * share;
        Self {
            usual_share: between(self.usual_share, other.usual_share),
            bend: between(self.bend, other.bend),
            knee_rad: between(self.knee_rad, other.knee_rad),
            roll_rad: between(self.roll_rad, other.roll_rad),
            deflection_rad: between(self.deflection_rad, other.deflection_rad),
        }
    }
}

/// The state of the friction.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrictionState<T> {
    /// The roll angle at rest.
    rest_rad: T,
    /// The roll angle so far, without small motion.
    place_rad: T,
    /// `q`.
    side: T,
}

impl<T: Real> FrictionState<T> {
    /// Springs midway between their curves.
    pub const fn at_rest(roll_rad: T) -> Self {
        Self { rest_rad: roll_rad, place_rad: roll_rad, side: T::ZERO }
    }

    /// Advances to the next roll angle, whose noise has the standard deviation `noise_rad`; returns `δ q`.
    pub fn push(&mut self, friction: &Friction<T>, roll_rad: T, noise_rad: T) -> T {
        if !friction.acts() {
            return T::zero();
        }
        let least_rad = friction.deflection_rad * T::of(PLAY_SHARE);
        let play_rad = least_rad.max(noise_rad * T::of(PLAY));
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

    /// The roll angle on linear springs without friction, where the friction [holds](Self::push) `held_rad`.
    #[inline(never)] // one copy in the firmware image
    pub fn free_rad(&self, friction: &Friction<T>, roll_rad: T, held_rad: T) -> T {
        let away_rad = roll_rad - self.rest_rad;
        let within_rad = away_rad.max(-friction.knee_rad).min(friction.knee_rad);
        let bent_rad = friction.bend * (away_rad - within_rad);
        roll_rad - friction.usual_share * away_rad + bent_rad + held_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::white::white;

    const FRICTION: Friction<f64> =
        Friction { roll_rad: 2e-3, deflection_rad: 8e-3, ..Friction::NONE };

    /// The law over a monotone motion from the middle is `q = 1 − e^(−s/β)`; the play delays it.
    /// In the other direction it starts from where the friction is: `q = −1 + (1 + q₀) e^(−s/β)`.
    #[test]
    fn friction_follows_its_law_in_both_directions() {
        let mut state = FrictionState::at_rest(0.0);
        let mut held_rad = 0.0;
        for k in 1..=400 {
            held_rad = state.push(&FRICTION, f64::from(k) * 5e-5, 0.0);
        }
        let (reach, play) = (20.0_f64 / 8.0, PLAY_SHARE);
        let there = 1.0 - (play - reach).exp();
        assert!((held_rad / 2e-3 - there).abs() < 1e-4, "{held_rad}");
        for k in 1..=400 {
            held_rad = state.push(&FRICTION, 0.02 - f64::from(k) * 5e-5, 0.0);
        }
        // The play is crossed before the motion counts.
        let back = -1.0 + (1.0 + there) * (2.0 * play - reach).exp();
        assert!((held_rad / 2e-3 - back).abs() < 1e-4, "{held_rad} {back}");
    }

    /// Springs that are stiffer by a twentieth up to 4 mrad and softer by a tenth beyond.
    #[test]
    fn bends_are_straightened_about_the_angle_at_rest() {
        let bent = Friction { usual_share: -0.05, bend: -0.15, knee_rad: 0.004, ..FRICTION };
        let state = FrictionState::at_rest(0.003);
        let far_rad = 0.003 + 0.004 * 1.05 + 0.006 * 0.9;
        for (roll_rad, expected_rad) in
            [(0.003, 0.003), (0.005, 0.0051), (0.013, far_rad), (-0.007, 0.006 - far_rad)]
        {
            let free_rad: f64 = state.free_rad(&bent, roll_rad, 0.0);
            assert!((free_rad - expected_rad).abs() < 1e-12, "{roll_rad}: {free_rad}");
            let held_rad = state.free_rad(&bent, roll_rad, 1e-3);
            assert!((held_rad - expected_rad - 1e-3).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_within_the_play_and_no_friction_change_nothing() {
        let mut state = FrictionState::at_rest(0.01);
        let play_rad = 0.99 * PLAY_SHARE * FRICTION.deflection_rad;
        for k in 0..100 {
            let noise_rad = if k % 2 == 0 { play_rad } else { -play_rad };
            assert!(state.push(&FRICTION, 0.01 + noise_rad, 0.0).abs() < 1e-12);
        }
        let mut none = FrictionState::at_rest(0.0);
        assert!(
            none.push(&Friction::NONE, 0.05, 0.0) == 0.0
                && none.push(&Friction::NONE, -0.05, 0.0) == 0.0
        );
    }

    /// A roll angle that is reached in ten seconds and held for a minute, in noise of a tenth of `β`: the friction keeps
    /// its side if the noise is known, but noise that counts as motion takes it to the middle.
    #[test]
    fn noise_that_is_known_does_not_release_the_friction() {
        let noise_rad = 0.1 * FRICTION.deflection_rad;
        let side = |known_rad: f64| {
            let mut state = FrictionState::at_rest(0.0);
            let mut held_rad = 0.0;
            for k in 0..1750 {
                let roll_rad = 2.0 * FRICTION.deflection_rad * (f64::from(k) / 250.0).min(1.0);
                held_rad = state.push(&FRICTION, roll_rad + noise_rad * white(k), known_rad);
            }
            held_rad / FRICTION.roll_rad
        };
        // The play delays the way of 2 β by 0.3 β, less what uniform noise deviates by, √3 of 0.1 β.
        let expected = 1.0 - (0.3 - 0.1 * 3.0_f64.sqrt() - 2.0).exp();
        assert!((side(noise_rad) - expected).abs() < 0.01, "{} {expected}", side(noise_rad));
        // About the middle by one step at most: √12 of a tenth of β, and 1 − e^(−0.35) = 0.3.
        assert!(side(0.0).abs() < 0.3, "{}", side(0.0));
    }

    #[test]
    fn one_long_step_turns_the_friction_over() {
        let mut state = FrictionState::at_rest(0.0);
        assert!((state.push(&FRICTION, 1.0, 0.0) - 2e-3).abs() < 1e-12);
        assert!((state.push(&FRICTION, -1.0, 0.0) + 2e-3).abs() < 1e-12);
    }
}
