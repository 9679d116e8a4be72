//! From height to rollover: static stability factor, compliant threshold, margin.
//!
//! In a steady turn the trailer lifts its inner wheels when
//!
//! ```text
//!     a_y (m_s h + m_u h_u)  +  m_s g (h − h_R) φ  =  (m_s + m_u) g T/2,     φ = R a_y
//! ```
//!
//! with `R` the steady roll angle per lateral acceleration at this height: overturning
//! moment of the lateral force, plus that of the c.g. shifted by the roll angle, against
//! the moment of the weight about the outer wheels.
//!
//! **Reference.** Winkler et al., *Rollover of Heavy Commercial Vehicles*, UMTRI-99-19,
//! ch. 2; Gillespie, *Fundamentals of Vehicle Dynamics*, ch. 9.

use crate::ratio::{Measured, RatioLine};
use crate::real::Real;

/// What the threshold needs beside the height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloverDesign<T> {
    /// Half the effective track: the lever of the outer wheels (their middle, if dual),
    /// averaged over the axles that carry the trailer with the load that each carries.
    pub half_track_m: T,
    /// Mass of the trailer's axles.
    pub unsprung_mass_kg: T,
    /// Height of their c.g.
    pub unsprung_height_m: T,
    /// Height of the trailer's roll axis under its c.g.
    pub roll_center_height_m: T,
}

/// How near the vehicle is to rolling over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rollover<T> {
    /// `T/2` over the height of the whole trailer's c.g., in g: the rigid-vehicle bound.
    pub static_stability_factor_g: T,
    /// Lateral acceleration of wheel lift with compliant suspension and tyres, in g.
    pub static_rollover_threshold_g: Measured<T>,
}

impl<T: Real> RolloverDesign<T> {
    /// The rollover measures at height `height` of the sprung c.g.
    ///
    /// `lateral` is the ratio line of lateral acceleration to roll (rad per m/s²),
    /// compensation included in `compensation`.
    pub fn at(
        &self,
        height: Measured<T>,
        trailer_mass_kg: T,
        lateral: &RatioLine<T>,
        compensation: T,
        gravity_mps2: T,
    ) -> Rollover<T> {
        let threshold = |h: T| {
            let sprung = trailer_mass_kg - self.unsprung_mass_kg;
            let rigid = sprung * h + self.unsprung_mass_kg * self.unsprung_height_m;
            let roll_per_g = lateral.ratio_at(h) * compensation * gravity_mps2;
            let compliant = rigid + sprung * (h - self.roll_center_height_m) * roll_per_g;
            let restoring = trailer_mass_kg * self.half_track_m;
            (restoring / rigid, restoring / compliant)
        };
        let (static_stability_factor_g, value) = threshold(height.value);
        let step = height.value * T::of(0.01);
        let slope = (threshold(height.value + step).1 - value) / step;
        Rollover {
            static_stability_factor_g,
            static_rollover_threshold_g: Measured { value, sd: (slope * height.sd).abs() },
        }
    }
}

impl<T: Real> Rollover<T> {
    /// Threshold less the present lateral acceleration, in g: zero is wheel lift.
    pub fn margin_g(&self, lateral_acceleration_mps2: T, gravity_mps2: T) -> T {
        self.static_rollover_threshold_g.value - lateral_acceleration_mps2.abs() / gravity_mps2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGID: RatioLine<f64> = RatioLine { a0: 0.0, a1: 0.0, b0: 1.0, b1: 0.0 };

    #[test]
    fn a_rigid_vehicle_lifts_at_half_track_over_height() {
        let design = RolloverDesign {
            half_track_m: 1.0,
            unsprung_mass_kg: 0.0,
            unsprung_height_m: 0.5,
            roll_center_height_m: 0.7,
        };
        let measures = design.at(Measured { value: 2.0, sd: 0.02 }, 30e3, &RIGID, 1.0, 9.81);
        assert!((measures.static_rollover_threshold_g.value - 0.5).abs() < 1e-12);
        assert!((measures.static_stability_factor_g - 0.5).abs() < 1e-12);
        // d(1/h)/dh = −1/h²; the 1 % forward difference is good to 1 %.
        assert!((measures.static_rollover_threshold_g.sd / (0.02 / 4.0) - 1.0).abs() < 0.011);
        assert!((measures.margin_g(-0.3 * 9.81, 9.81) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn compliance_lowers_the_threshold() {
        let design = RolloverDesign {
            half_track_m: 1.0,
            unsprung_mass_kg: 1.5e3,
            unsprung_height_m: 0.5,
            roll_center_height_m: 0.7,
        };
        let soft = RatioLine { a0: 0.02, a1: 0.0, b0: 1.0, b1: 0.0 };
        let h = Measured::exact(2.0);
        let rigid = design.at(h, 30e3, &RIGID, 1.0, 9.81).static_rollover_threshold_g.value;
        let compliant = design.at(h, 30e3, &soft, 1.0, 9.81).static_rollover_threshold_g.value;
        assert!(compliant < rigid && compliant > 0.8 * rigid);
    }
}
