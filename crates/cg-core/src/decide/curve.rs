//! The speed at which a curve uses only a share of the rollover threshold.

use core::borrow::Borrow;

use crate::decide::warning::Warner;
use crate::math::real::Real;
use crate::truck::design::Design;
use crate::truck::ratio::Measured;

/// Greatest speed that is given, far beyond that of any truck.
const GREATEST_MPS: f64 = 100.0;
/// Number of bisections: the speed is exact to 1e-10 m/s, or to the rounding of `T`.
const BISECTIONS: u32 = 40;

/// The greatest speed, in m/s, in a level curve of this radius at which the lateral acceleration is at most a
/// `share` of the [bound](Warner::bound_g) of the threshold. The threshold is that of a turn at this
/// speed. `None` if the mass is outside the design, or if radius or share is not positive.
pub fn curve_speed_mps<T: Real, const C: usize>(
    design: impl Borrow<Design<T, C>>,
    height: Measured<T>,
    trailer_mass_kg: T,
    radius_m: T,
    share: T,
) -> Option<T> {
    if !(radius_m > T::ZERO && share > T::ZERO) {
        return None;
    }
    let design = design.borrow();
    let keeps = |speed_mps: T| {
        let rollover = design.rollover(height, trailer_mass_kg, speed_mps)?;
        let bound_g = Warner::bound_g(rollover.static_rollover_threshold_g);
        let allowed_mps2 = share * bound_g * design.gravity_mps2;
        Some(speed_mps * speed_mps <= allowed_mps2 * radius_m)
    };
    let (mut kept_mps, mut too_fast_mps) = (T::ZERO, T::of(GREATEST_MPS));
    for _ in 0..BISECTIONS {
        let middle_mps = (kept_mps + too_fast_mps) * T::of(0.5);
        if keeps(middle_mps)? {
            kept_mps = middle_mps;
        } else {
            too_fast_mps = middle_mps;
        }
    }
    Some(kept_mps)
}
