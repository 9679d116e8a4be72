//! What the bank of the road does to a ratio.
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

use crate::math::real::Real;
use crate::truck::channel::Channel;

/// The share of the variance of the bank that all curves have in common.
const COMMON_SHARE: f64 = 0.5;

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

    /// The part of [`sd_relative`](Self::sd_relative) that all curves have in common, and the rest.
    pub(crate) fn parts(&self, channel: Channel) -> [T; 2] {
        let sd = self.sd_relative(channel);
        [COMMON_SHARE, 1.0 - COMMON_SHARE].map(|share| sd * T::of(share).root())
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
        };
        for channel in [Channel::Steer, Channel::LateralAcceleration] {
            assert!((road(false).sd_relative(channel) - 0.007 / 0.15).abs() < 1e-12);
            let sd = road(true).sd_relative(channel);
            assert!((sd - 0.007 / 0.15 * (1.0 + 1.0 / 0.22)).abs() < 1e-12 && sd > 0.25);
            let [common, own] = road(true).parts(channel);
            assert!((common.hypot(own) - sd).abs() < 1e-12 && (common - own).abs() < 1e-12);
        }
        for channel in [Channel::Suspension, Channel::Tractor] {
            assert!(road(true).sd_relative(channel).abs() < f64::EPSILON);
        }
        let flat = Road { bank_sd_rad: 0.0, lateral_g: 0.0, ..road(true) };
        assert!(flat.sd_relative(Channel::Steer).abs() < f64::EPSILON);
    }
}
