//! The roll angle that the design expects per unit of each input, as a function of the speed.

use crate::math::real::Real;
use crate::truck::axis::{Cell, cubic, polynomial};
use crate::truck::design::Design;

/// The gains of all channels at one mass and within one interval of the speed axis: a cubic each, so that a
/// new speed costs three multiplications for each channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gains<T, const C: usize> {
    trailer_mass_kg: T,
    /// The ends of the interval.
    span_mps: [T; 2],
    /// In the distance from the lower end of the interval, on the axis of the channel.
    cubics: [[T; 4]; C],
}

impl<T: Real, const C: usize> Gains<T, C> {
    /// The gains around a speed at a mass; `None` outside the axes of the design.
    #[inline(never)]
    pub(crate) fn around(design: &Design<T, C>, speed_mps: T, trailer_mass_kg: T) -> Option<Self> {
        let mass = cubic(&design.trailer_mass_kg, trailer_mass_kg, false)?;
        let cell = Cell::around(&design.speed_mps, speed_mps)?;
        let [low_mps, _] = cell.span;
        let springs = design.springs(trailer_mass_kg);
        let mut cubics = [[T::zero(); 4]; C];
        for (cubic, channel) in cubics.iter_mut().zip(&design.channels) {
            let origin = channel.speed_axis(low_mps);
            let nodes = cell.nodes.map(|node| channel.speed_axis(node) - origin);
            let mut gains = [channel.compensation * channel.of_lines(springs); 4];
            for (place, gain) in (cell.first..).zip(&mut gains) {
                *gain *= channel.line_of_speed(place, &mass).ratio_at(design.reference_height_m);
            }
            *cubic = polynomial(&nodes, gains);
        }
        Some(Self { trailer_mass_kg, span_mps: cell.span, cubics })
    }

    /// The compensated ratio of every channel at the reference height, in radians of roll per unit of
    /// input; `None` if these gains are for another interval or mass.
    pub(crate) fn at(
        &self,
        design: &Design<T, C>,
        speed_mps: T,
        trailer_mass_kg: T,
    ) -> Option<[T; C]> {
        let [low_mps, high_mps] = self.span_mps;
        let same = trailer_mass_kg == self.trailer_mass_kg;
        if !(same && speed_mps >= low_mps && speed_mps <= high_mps) {
            return None;
        }
        let mut gains = [T::zero(); C];
        for ((gain, channel), [c0, c1, c2, c3]) in
            gains.iter_mut().zip(&design.channels).zip(self.cubics)
        {
            let x = channel.speed_axis(speed_mps) - channel.speed_axis(low_mps);
            *gain = c0 + x * (c1 + x * (c2 + x * c3));
        }
        Some(gains)
    }
}
