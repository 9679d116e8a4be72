//! What the articulation of a tight turn does to the ratio of a channel.

use crate::math::real::Real;

/// Relative change of a ratio in a turn with the articulation angle `ψ`, divided by `ψ²`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Articulation<T> {
    /// The change, 1/rad².
    pub mean: T,
    /// Its standard deviation, 1/rad².
    pub sd: T,
}

impl<T: Real> Articulation<T> {
    /// No change.
    pub const NONE: Self = Self { mean: T::ZERO, sd: T::ZERO };

    /// The same in another precision.
    pub(crate) fn cast<U: Real>(&self) -> Articulation<U> {
        Articulation { mean: U::of(self.mean.as_f64()), sd: U::of(self.sd.as_f64()) }
    }

    /// Whether both numbers are finite and the standard deviation is none.
    pub(crate) fn is_possible(&self) -> bool {
        self.mean.present() && self.sd.present() && self.sd >= T::zero()
    }
}
