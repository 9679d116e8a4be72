//! By how much the lateral acceleration of the trailer comes before yaw rate times speed.
//!
//! Yaw rate times speed is the lateral acceleration of a point that follows its path without slip. The sprung c.g. is ahead of
//! this point, so its acceleration contains the change of the yaw rate; and the tires slip the more, the greater the acceleration
//! is. In slow changes the two together are a lead,
//!
//! ```text
//! a₂ = (1 + τ p) U r₂,   τ = l/U − κ U
//! ```
//!
//! In steady turns it has no effect. A semitrailer that has its c.g. 5 m ahead of its axles leads by 0.3 s at 50 km/h.

use crate::math::real::Real;

/// The lead `τ` of the trailer's lateral acceleration over its yaw rate times the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathLead<T> {
    /// `l`, the distance of the sprung c.g. ahead of the point that follows its path, m.
    pub ahead_m: T,
    /// `κ`, the slip angle of the trailer's axles per lateral acceleration, rad per m/s².
    pub slip_s2_per_m: T,
}

impl<T: Real> PathLead<T> {
    /// No lead.
    pub const NONE: Self = Self { ahead_m: T::ZERO, slip_s2_per_m: T::ZERO };

    /// The same in another precision.
    pub(crate) fn cast<U: Real>(&self) -> PathLead<U> {
        let to = |x: T| U::of(x.as_f64());
        PathLead { ahead_m: to(self.ahead_m), slip_s2_per_m: to(self.slip_s2_per_m) }
    }

    /// Whether both numbers are finite.
    pub(crate) fn is_possible(&self) -> bool {
        (self.ahead_m + self.slip_s2_per_m).present()
    }
}
