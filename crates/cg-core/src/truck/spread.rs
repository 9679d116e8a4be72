//! The uncertainty of the DC ratios of one truck.

use crate::math::real::Real;
use crate::truck::channel::CHANNELS;

/// The uncertainty of the DC ratios of all channels at one speed and mass. It comes from the model
/// and the calibration, so it does not average out over maneuvers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "[[T; C]; C]: serde::Serialize",
        deserialize = "[[T; C]; C]: serde::Deserialize<'de>"
    ))
)]
pub struct Spread<T, const C: usize = CHANNELS> {
    /// Covariance of the logarithms of the ratios, in the order of the channels of the design. Springs and
    /// roll centers affect several of them.
    pub covariance: [[T; C]; C],
}

impl<T: Real, const C: usize> Spread<T, C> {
    /// Adds another covariance with a weight.
    pub(super) fn add(&mut self, other: &Self, weight: T) {
        let others = other.covariance.iter().flatten();
        for (entry, other) in self.covariance.iter_mut().flatten().zip(others) {
            *entry += *other * weight;
        }
    }

    pub(super) fn at(&self, i: usize, j: usize) -> T {
        self.covariance.get(i).and_then(|row| row.get(j)).copied().unwrap_or(T::zero())
    }

    /// Relative standard deviation of the ratio at this place among the channels of the design.
    pub fn sd(&self, place: usize) -> T {
        self.at(place, place).root()
    }

    /// Correlation of the ratios at two places.
    pub fn correlation(&self, i: usize, j: usize) -> T {
        let scale = (self.at(i, i) * self.at(j, j)).root();
        if scale > T::zero() {
            (self.at(i, j) / scale).max(-T::one()).min(T::one())
        } else {
            T::zero()
        }
    }
}
