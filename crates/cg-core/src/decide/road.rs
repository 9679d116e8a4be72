//! What the bank of the road, tight turns and an unsteady speed do to a ratio.
//!
//! On a road with the bank `β` (positive if its left side is higher) the body feels the lateral
//! acceleration `a_y + g β`, and a roll sensor relative to gravity also shows `β` itself:
//!
//! ```text
//!     φ / a_y        = R (1 + g β / a_y)
//!     (φ + β) / a_y  = R (1 + (1 + 1/(g R)) g β / a_y)
//!     s / f          = S / (1 + g R)                       without β
//! ```
//!
//! The steer angle of a driver who follows the road contains only a part of `g β`, so its ratio
//! changes by at most as much as that of the lateral acceleration. The bank is not known. It enters
//! the uncertainty as a Gaussian: one half of its variance is common to all curves, because
//! superelevation always leans into the curve; the other half differs from curve to curve.
//!
//! Where the bank changes along the vehicle (road twist), the suspensions feel the difference between
//! the axles. The error is a roll angle, so it counts for more where the suspension rolls less. On
//! drives of an independent truck with 0.05 rad within 2 to 4 s, a hard case, it was up to 0.4 mrad for the
//! trailer. The tractor, which its trailer holds, rolls twice as far against its axles.
//!
//! In a tight turn the trailer stands at the articulation angle `ψ` to the tractor. What that does to a ratio
//! is part of the [design](crate::Articulation). The trailer follows inside the tractor's path, on a circle that
//! is smaller by `cos ψ`, so a lateral acceleration from the yaw rate is greater than its own by that.
//!
//! Traction and braking change the forces at the tires and at the fifth wheel. What that does to a ratio is not part of the
//! model, so it is an uncertainty, and turns at a steady speed count for more.

use crate::math::real::Real;
use crate::truck::articulation::Articulation;
use crate::truck::channel::{Channel, Input};
use crate::truck::design::Design;

/// The share of the variance of the bank that all curves have in common.
const COMMON_SHARE: f64 = 0.5;
/// Error of the suspension roll of the trailer and of the tractor by road twist, as a share of the standard deviation of the bank:
/// 0.4 and 0.8 mrad on public roads (0.02 rad). On the nonlinear plant it was 0.37 and 0.75 mrad (root mean square of 82 and 77
/// drives of four trucks) on roads with a superelevation of 4 % that is reached within 40 to 100 m, all of which a road has in common
/// (test `superelevation` of cg-thesis).
const TWIST_SHARE: [f64; 2] = [0.02, 0.04];
/// What `ψ²` may be without a correction, rad²: the ratios change by up to 0.9 % there, as much as the model leaves
/// anyway. That is a turn of 68 m for a wheelbase of 7.6 m, of 110 m for one of 12.3 m.
const USUAL_ARTICULATION: f64 = 0.0125;
/// Relative change of the ratio from the steer angle per m/s² of longitudinal acceleration: 0.6 on the first independent truck, and
/// 1.0 on the second one (8 % less at 0.1 m/s²).
const STEERED_S2_PER_M: f64 = 1.0;
/// Relative standard deviation of the other ratios per m/s² of the standard deviation of the longitudinal acceleration within a
/// turn (docs/limits.md, nonlinear plant), if it begins and ends on the straight. A turn of the second independent truck with
/// 0.36 m/s² had 2.3 %.
const UNSTEADY_S2_PER_M: f64 = 0.05;
/// If the lateral acceleration is that of the yaw rate, it is greater than the trailer's by `1/cos ψ` in a steady turn. The
/// articulation comes some seconds after the yaw rate, which the identified dynamics do not have, so that the ratio falls by a
/// multiple of `1 − cos ψ`: by 1.4 to 1.6 in turns of half a minute of the nonlinear plant (`euro`, `kraz`, `air`; 15 to 25 m), by
/// 0.8 in short ones and in those of an independent truck. This is the middle of both, and the distance from it.
const BY_YAW_RATE: f64 = 1.15;
const BY_YAW_RATE_SD: f64 = 0.35;
/// Least `cos² ψ`, for turns that no truck makes.
const LEAST_COS_SQUARE: f64 = 0.1;

/// The road of a maneuver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Road<T> {
    /// Standard deviation of the bank, rad.
    pub(crate) bank_sd_rad: T,
    /// Root mean square of the lateral acceleration in the turns, g.
    pub(crate) lateral_g: T,
    /// Roll angle of the trailer per g of lateral acceleration, rad.
    pub(crate) roll_rad_per_g: T,
    /// Whether the roll angle is relative to gravity.
    pub(crate) to_gravity: bool,
    /// Whether the lateral acceleration in a turn was that of the yaw rate.
    pub(crate) by_yaw_rate: bool,
    /// How unsteady the speed was, m²/s⁴: see [`unsteady_square`](crate::decide::window::Window::unsteady_square).
    pub(crate) unsteady_square: [T; 2],
    /// Articulation angle in the turns, rad.
    pub(crate) articulation_rad: T,
}

impl<T: Real> Road<T> {
    /// Relative standard deviation of the ratio of a channel due to the bank.
    pub(crate) fn sd_relative(&self, channel: Channel) -> T {
        if !channel.feels_bank() || !(self.bank_sd_rad > T::zero()) {
            return T::zero();
        }
        let shown = if self.to_gravity { T::one() / self.roll_rad_per_g } else { T::zero() };
        self.bank_sd_rad * (T::one() + shown) / self.lateral_g
    }

    /// Relative standard deviation of the ratio of a channel due to bank, twist, tight turns and an
    /// unsteady speed: the part that all curves have in common, and the rest. `ratio` is what the channel can have, rad
    /// per m/s².
    pub(crate) fn parts(
        &self,
        channel: Channel,
        articulation: &Articulation<T>,
        ratio: T,
        gravity_mps2: T,
    ) -> [T; 2] {
        let sd = if channel.feels_bank() {
            self.sd_relative(channel)
        } else {
            let force_mps2 = self.lateral_g * (T::one() + self.roll_rad_per_g) * gravity_mps2;
            let [trailer, tractor] = TWIST_SHARE;
            let share = if channel == Channel::Tractor { tractor } else { trailer };
            T::of(share) * self.bank_sd_rad / (ratio * force_mps2).abs()
        };
        let [common, own] =
            [COMMON_SHARE, 1.0 - COMMON_SHARE].map(|share| sd * T::of(share).root());
        let articulation = self.articulated_sd(channel, articulation);
        let common = (common * common + articulation * articulation).root();
        [common, (own * own + self.unsteady_variance(channel)).root()]
    }

    /// Relative variance of the ratio of a channel by traction and braking. It differs from curve to
    /// curve.
    fn unsteady_variance(&self, channel: Channel) -> T {
        let [steered, within] = self.unsteady_square;
        match channel.input() {
            Input::Steer => T::of(STEERED_S2_PER_M * STEERED_S2_PER_M) * steered,
            _ => T::of(UNSTEADY_S2_PER_M * UNSTEADY_S2_PER_M) * within,
        }
    }

    /// The factor of the ratio of a channel by articulation.
    pub(crate) fn articulated(&self, channel: Channel, articulation: &Articulation<T>) -> T {
        let by_yaw_rate = T::of(BY_YAW_RATE) * self.shorter(channel);
        // At least a half, for turns that no truck makes.
        (T::one() + articulation.mean * self.articulation() - by_yaw_rate).max(T::of(0.5))
    }

    /// Relative standard deviation of the ratio of a channel by articulation. What is of the fourth power of
    /// `ψ` is not known.
    pub(crate) fn articulated_sd(&self, channel: Channel, articulation: &Articulation<T>) -> T {
        let beyond = self.articulation();
        let of_ratio = (articulation.sd + articulation.mean.abs() * beyond) * beyond;
        let by_yaw_rate = T::of(BY_YAW_RATE_SD) * self.shorter(channel);
        (of_ratio * of_ratio + by_yaw_rate * by_yaw_rate).root()
    }

    /// By which share the circle of the trailer is smaller than that of the tractor, `1 − cos ψ` beyond the usual, if a channel has
    /// the lateral acceleration from the yaw rate.
    fn shorter(&self, channel: Channel) -> T {
        if channel.input() != Input::LateralAcceleration || !self.by_yaw_rate {
            return T::zero();
        }
        // The wheelbase over the radius, which is given, is the sine.
        let square = self.articulation_rad * self.articulation_rad;
        let cos = |square: T| (T::one() - square).max(T::of(LEAST_COS_SQUARE)).root();
        (cos(T::of(USUAL_ARTICULATION)) - cos(square)).max(T::zero())
    }

    /// `ψ²` beyond the usual.
    fn articulation(&self) -> T {
        let square = self.articulation_rad * self.articulation_rad;
        (square - T::of(USUAL_ARTICULATION)).max(T::zero())
    }
}

impl<T: Real, const C: usize> Design<T, C> {
    /// Relative standard deviation of the ratio of a channel in turns of this curvature (1/m) by articulation;
    /// `by_yaw_rate` if the lateral acceleration is yaw rate times speed.
    pub fn articulated_sd(&self, channel: Channel, curvature_per_m: T, by_yaw_rate: bool) -> T {
        let road = Road {
            bank_sd_rad: T::zero(),
            lateral_g: T::one(),
            roll_rad_per_g: T::one(),
            to_gravity: false,
            by_yaw_rate,
            unsteady_square: [T::zero(); 2],
            articulation_rad: self.trailer_wheelbase_m * curvature_per_m,
        };
        road.articulated_sd(channel, &self.articulation(channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of docs/sensors.md: 20 t at 1.9 m in a turn of 0.15 g; a bank of 0.7 % changes
    /// the ratio by 5 % relative to the road and by 26 % relative to gravity.
    #[test]
    fn a_bank_of_seven_per_mil_changes_the_ratio_by_a_quarter() {
        let road = |to_gravity| Road {
            bank_sd_rad: 0.007_f64,
            lateral_g: 0.15,
            roll_rad_per_g: 0.22,
            to_gravity,
            by_yaw_rate: false,
            unsteady_square: [0.0; 2],
            articulation_rad: 0.1,
        };
        for channel in [Channel::Steer, Channel::LateralAcceleration] {
            assert!((road(false).sd_relative(channel) - 0.007 / 0.15).abs() < 1e-12);
            let sd = road(true).sd_relative(channel);
            assert!((sd - 0.007 / 0.15 * (1.0 + 1.0 / 0.22)).abs() < 1e-12 && sd > 0.25);
            let [common, own] = road(true).parts(channel, &Articulation::NONE, 0.02, 9.81);
            assert!((common.hypot(own) - sd).abs() < 1e-12 && (common - own).abs() < 1e-12);
        }
        for channel in [Channel::Suspension, Channel::Tractor] {
            assert!(road(true).sd_relative(channel).abs() < f64::EPSILON);
        }
        // The suspension rolls by 0.02 rad per m/s² times 1.22 times 0.15 g, twist by 0.14 mrad.
        let twist = 0.02 * 0.007 / (0.02 * 1.22 * 0.15 * 9.81);
        for (channel, twist) in [(Channel::Suspension, twist), (Channel::Tractor, 2.0 * twist)] {
            let [common, own] = road(true).parts(channel, &Articulation::NONE, 0.02, 9.81);
            assert!((common - own).abs() < 1e-12 && (common.hypot(own) - twist).abs() < 1e-12);
        }
        let flat = Road { bank_sd_rad: 0.0, lateral_g: 0.0, ..road(true) };
        assert!(flat.sd_relative(Channel::Steer).abs() < f64::EPSILON);
    }

    /// 0.02 m/s² where the steer angle is used change its ratio by 2 %, and 0.4 m/s² within the turn the
    /// others by 2 %, each in its own way in every turn.
    #[test]
    fn an_unsteady_speed_is_an_uncertainty_of_one_turn() {
        let road = Road {
            bank_sd_rad: 0.0_f64,
            lateral_g: 0.15,
            roll_rad_per_g: 0.22,
            to_gravity: false,
            by_yaw_rate: false,
            unsteady_square: [0.02 * 0.02, 0.4 * 0.4],
            articulation_rad: 0.1,
        };
        for (channel, sd) in [
            (Channel::Steer, 1.0 * 0.02),
            (Channel::LateralAcceleration, 0.05 * 0.4),
            (Channel::Suspension, 0.05 * 0.4),
            (Channel::Tractor, 0.05 * 0.4),
        ] {
            let [common, own] = road.parts(channel, &Articulation::NONE, 0.02, 9.81);
            assert!(common.abs() < f64::EPSILON && (own - sd).abs() < 1e-12, "{channel}");
        }
    }

    /// In a turn of 19 m the trailer stands at 0.4 rad to the tractor. That changes each ratio by its own
    /// share of the 0.1475 rad² beyond the usual, and all curves have the uncertainty in common.
    #[test]
    fn a_tight_turn_changes_each_ratio_by_its_share() {
        let tight = Road {
            bank_sd_rad: 0.0_f64,
            lateral_g: 0.15,
            roll_rad_per_g: 0.22,
            to_gravity: false,
            by_yaw_rate: false,
            unsteady_square: [0.0; 2],
            articulation_rad: 0.4,
        };
        let by_yaw_rate = Road { by_yaw_rate: true, ..tight };
        let usual = Road { articulation_rad: 0.07, ..tight };
        let known = Articulation { mean: -0.3, sd: 0.2 };
        for (road, channel, mean) in [
            (tight, Channel::Tractor, -0.3),
            (tight, Channel::LateralAcceleration, -0.3),
            (by_yaw_rate, Channel::Suspension, -0.3),
        ] {
            let factor = road.articulated(channel, &known);
            assert!((factor - 1.0 - 0.1475 * mean).abs() < 1e-12, "{channel}");
            let [common, own] = road.parts(channel, &known, 0.02, 9.81);
            let sd = 0.1475 * (0.2 + 0.3 * 0.1475);
            assert!((common - sd).abs() < 1e-12 && own.abs() < f64::EPSILON, "{channel}");
            assert!((usual.articulated(channel, &known) - 1.0).abs() < 1e-12);
            assert!(usual.parts(channel, &known, 0.02, 9.81)[0].abs() < 1e-12);
        }
        // Its circle is smaller by cos ψ, √(1 − 0.4²) for √(1 − 0.0125).
        let shorter = 0.9875_f64.sqrt() - 0.84_f64.sqrt();
        let channel = Channel::LateralAcceleration;
        let factor = by_yaw_rate.articulated(channel, &known);
        assert!((factor - (1.0 - 0.1475 * 0.3 - 1.15 * shorter)).abs() < 1e-12, "{factor}");
        let [common, own] = by_yaw_rate.parts(channel, &known, 0.02, 9.81);
        let sd = (0.1475_f64 * (0.2 + 0.3 * 0.1475)).hypot(0.35 * shorter);
        assert!((common - sd).abs() < 1e-12 && own.abs() < f64::EPSILON);
        let yard = Road { articulation_rad: 3.0, ..by_yaw_rate };
        assert!(yard.articulated(channel, &Articulation::NONE) >= 0.5);
    }
}
