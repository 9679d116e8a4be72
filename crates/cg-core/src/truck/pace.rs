//! What the speed changes in the dynamics of the channels.

use crate::math::real::Real;
use crate::truck::channel::Channel;
use crate::truck::design::Design;

impl<T: Real, const C: usize> Design<T, C> {
    /// `U0/U − 1`, by which the numerators of the reduced models change, between a quarter of the nominal
    /// speed and four times that speed; zero if the speed is NaN.
    pub fn pace(&self, speed_mps: T) -> T {
        let pace = self.nominal_speed_mps / speed_mps - T::one();
        if pace.present() { pace.max(T::of(-0.75)).min(T::of(3.0)) } else { T::zero() }
    }

    /// `τ` of the channel at this place at a pace, s. Zero if its input is not the lateral acceleration.
    pub(crate) fn lead_s(&self, place: usize, pace: T) -> T {
        if self.channel(place) != Some(Channel::LateralAcceleration) {
            return T::zero();
        }
        let speed_mps = self.nominal_speed_mps / (T::one() + pace);
        self.path_lead.ahead_m / speed_mps - self.path_lead.slip_s2_per_m * speed_mps
    }
}
