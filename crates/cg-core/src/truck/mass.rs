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

    /// The height at which a trailer of another mass rolls as one of this mass does at this height.
    fn height_at_mass(
        &self,
        channel: Channel,
        speed_mps: T,
        [mass_kg, other_kg]: [T; 2],
        height_m: T,
    ) -> Option<T> {
        let (least, greatest) = (*self.trailer_mass_kg.first()?, *self.trailer_mass_kg.last()?);
        let ratio = self.line(channel, speed_mps, mass_kg)?.ratio_at(height_m);
        let line = self.line(channel, speed_mps, other_kg.max(least).min(greatest))?;
        let other_m = (ratio * line.b0 - line.a0) / (line.a1 - ratio * line.b1);
        // No height of a much lighter trailer gives this ratio: the quotient changes its sign.
        let lighter = other_kg < mass_kg;
        let reached = if lighter { other_m >= height_m } else { other_m <= height_m };
        Some(match (reached, lighter) {
            (true, _) => other_m.max(self.least_height_m).min(self.greatest_height_m),
            (false, true) => self.greatest_height_m,
            (false, false) => self.least_height_m,
        })
    }

    /// Standard deviation of the mass of a trailer that may have any load, kg.
    pub fn any_load_sd_kg(&self) -> T {
        match (self.trailer_mass_kg.first(), self.trailer_mass_kg.last()) {
            (Some(least), Some(greatest)) => (*greatest - *least) * T::of(0.288_675), // 1/√12
            _ => T::zero(),
        }
    }
}
