//! What the uncertainty of the trailer mass does to a height.

use crate::math::real::Real;
use crate::truck::channel::Channel;
use crate::truck::design::Design;

impl<T: Real, const C: usize> Design<T, C> {
    /// Standard deviation of a height due to that of the trailer mass, m: half of what two standard
    /// deviations change at the same ratio, on the side and in the channel where it is most. A heavier
    /// trailer needs less height to roll as much. Masses end at the axis, heights at the
    /// [least](Design::least_height_m) and [greatest](Design::greatest_height_m).
    pub fn mass_sd_m(
        &self,
        channels: impl Iterator<Item = Channel>,
        speed_mps: T,
        [trailer_mass_kg, sd_kg]: [T; 2],
        height_m: T,
    ) -> T {
        let two_kg = sd_kg + sd_kg;
        let height_m = height_m.max(self.least_height_m).min(self.greatest_height_m);
        channels.fold(T::zero(), |most_m, channel| {
            let other = |mass_kg| {
                self.height_at_mass(channel, speed_mps, [trailer_mass_kg, mass_kg], height_m)
            };
            let others = [other(trailer_mass_kg - two_kg), other(trailer_mass_kg + two_kg)];
            others
                .into_iter()
                .flatten()
                .fold(most_m, |most_m, other_m| most_m.max((other_m - height_m).abs() * T::of(0.5)))
        })
    }

    /// The height at which a trailer of another mass rolls as one of this mass does at this height;
    /// a limit where no height of the other trailer gives this ratio.
    fn height_at_mass(
        &self,
        channel: Channel,
        speed_mps: T,
        [mass_kg, other_kg]: [T; 2],
        height_m: T,
    ) -> Option<T> {
        let (least, greatest) = (*self.trailer_mass_kg.first()?, *self.trailer_mass_kg.last()?);
        let own = self.line(channel, speed_mps, mass_kg)?;
        let other = self.line(channel, speed_mps, other_kg.max(least).min(greatest))?;
        let ratio = own.ratio_at(height_m);
        let slope = other.a1 - ratio * other.b1;
        // The height goes to infinity where this changes its sign, and comes back from the other side.
        let reached = slope * (own.a1 - ratio * own.b1) > T::zero();
        let other_m = if reached {
            (ratio * other.b0 - other.a0) / slope
        } else if other_kg < mass_kg {
            self.greatest_height_m
        } else {
            self.least_height_m
        };
        Some(other_m.max(self.least_height_m).min(self.greatest_height_m))
    }

    /// Standard deviation of the mass of a trailer that may have any load, kg.
    pub fn any_load_sd_kg(&self) -> T {
        match (self.trailer_mass_kg.first(), self.trailer_mass_kg.last()) {
            (Some(least), Some(greatest)) => (*greatest - *least) * T::of(0.288_675), // 1/√12
            _ => T::zero(),
        }
    }
}
