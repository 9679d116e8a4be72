//! The rollover threshold at a height: static stability factor, threshold and margin.
//!
//! A rigid trailer tips when the moment of the lateral force about the outer wheels reaches the
//! moment of the weight. The lateral acceleration is then `T/2` divided by the height of the c.g.,
//! the static stability factor. Springs, tires, lash and axles that lift one after the other reduce
//! the real threshold far below this value. The threshold is the greatest lateral acceleration of
//! the trailer that the vehicle sustains in a steady turn; beyond it, the vehicle tips. It is
//! computed offline for each height and mass, in turns at 40 and at 90 km/h, and stored in the
//! design.
//!
//! At the same lateral acceleration a slower turn is tighter. The vehicle articulates more, and the
//! slip angles within an axle group differ more. The curvature decreases with the square of the
//! speed, and the effect of articulation is of second order in the curvature (a cosine). The
//! reciprocal of the threshold is therefore linear in `1/U⁴`, between the two speeds and down to 25 km/h. A trailer that
//! stands at about 45° to the tractor cannot be accelerated more by a tighter turn: its lateral acceleration cannot exceed
//! about `U²/2L`, and nor can the threshold. docs/plant.md has the errors.
//!
//! **Reference.** Winkler et al., *Rollover of Heavy Commercial Vehicles*, UMTRI-99-19,
//! ch. 2; Gillespie, *Fundamentals of Vehicle Dynamics*, ch. 9.

use crate::math::real::Real;
use crate::truck::ratio::Measured;

/// Number of heights at which a design has thresholds, equally spaced from its least to its
/// greatest height.
pub const HEIGHTS: usize = 8;

/// The speeds at which a design has thresholds, 40 and 90 km/h. Faster turns are treated as turns at 90 km/h.
pub const TURN_MPS: [f64; 2] = [40.0 / 3.6, 90.0 / 3.6];
/// The speed of [`RolloverDesign::tightest_turn_g`], 30 km/h.
pub const TIGHTEST_MPS: f64 = 30.0 / 3.6;
/// In slower turns, below 25 km/h, trailers do not tip, however tight the turn is. From there on the threshold returns to that
/// of wide turns, which it is at rest.
const SLOWEST_MPS: f64 = 25.0 / 3.6;

/// Rollover thresholds over the height, for one trailer mass.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ThresholdLine<T> {
    /// Lateral acceleration beyond which the vehicle tips, in g: `[speed][height]`, with the speeds
    /// of [`TURN_MPS`].
    pub threshold_g: [[T; HEIGHTS]; 2],
}

impl<T: Real> ThresholdLine<T> {
    /// Interpolates every threshold between `self` (`weight` 0) and `other` (`weight` 1).
    #[must_use]
    pub(crate) fn blend(&self, other: &Self, weight: T) -> Self {
        let mut blended = *self;
        let pairs = blended.threshold_g.iter_mut().flatten();
        for (a, b) in pairs.zip(other.threshold_g.iter().flatten()) {
            *a += (*b - *a) * weight;
        }
        blended
    }

    /// The thresholds over the height at a speed, of a vehicle with this [`RolloverDesign::tightest_turn_g`]. If the speed is not
    /// known (NaN), the smaller threshold of both speeds applies.
    pub fn at_speed(&self, speed_mps: T, tightest_turn_g: T) -> [T; HEIGHTS] {
        self.in_turns(&Turns::at(speed_mps), tightest_turn_g)
    }

    pub(super) fn in_turns(&self, turns: &Turns<T>, tightest_turn_g: T) -> [T; HEIGHTS] {
        let most_g = tightest_turn_g * turns.of_tightest;
        let [mut at, fast_g] = self.threshold_g;
        for (at_g, fast_g) in at.iter_mut().zip(fast_g) {
            *at_g = if turns.are_known {
                between(fast_g, *at_g, turns.tightness).min(most_g)
            } else {
                at_g.min(fast_g)
            };
        }
        at
    }
}

/// What turns at a speed are. If the speed is not known (NaN), they count as those at 40 km/h.
pub(super) struct Turns<T> {
    are_known: bool,
    /// How tight they are, by the squared curvature at the same lateral acceleration: one at 40 km/h, zero at 90 km/h and, as
    /// no turn tips the trailer then, at rest.
    pub(super) tightness: T,
    /// The greatest lateral acceleration that they may have over that at [`TIGHTEST_MPS`]; without a limit at rest.
    of_tightest: T,
}

impl<T: Real> Turns<T> {
    pub(super) fn at(speed_mps: T) -> Self {
        let [slow, fast] = TURN_MPS.map(T::of);
        let slowest = T::of(SLOWEST_MPS);
        let are_known = speed_mps.present();
        let held = if are_known { speed_mps.max(slowest).min(fast) } else { slow };
        let matters =
            if speed_mps < slowest { square(square(speed_mps / slowest)) } else { T::one() };
        let of_tightest = square(held / T::of(TIGHTEST_MPS)) / matters;
        let [here, slow, fast] = [held, slow, fast].map(|mps| T::one() / square(square(mps)));
        Self { are_known, tightness: (here - fast) / (slow - fast) * matters, of_tightest }
    }
}

fn square<T: Real>(x: T) -> T {
    x * x
}

/// Interpolates between two thresholds; the reciprocal is linear in `part`.
fn between<T: Real>(from: T, to: T, part: T) -> T {
    T::one() / ((T::one() - part) / from + part / to)
}

/// The threshold at a share of the way from the least to the greatest height; the share is limited
/// to 0…1. The reciprocal is interpolated linearly, which is exact for a rigid trailer.
fn at_height<T: Real>(threshold_g: &[T; HEIGHTS], share: T) -> T {
    #[allow(clippy::cast_precision_loss)] // a small constant
    let mut place = share.max(T::zero()).min(T::one()) * T::of(HEIGHTS as f64 - 1.0);
    let mut found = T::zero();
    for pair in threshold_g.windows(2) {
        let [low, high] = pair else { break };
        found = between(*low, *high, place.min(T::one()));
        place -= T::one();
        if !(place > T::zero()) {
            break;
        }
    }
    found
}

/// The parameters of the static stability factor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RolloverDesign<T> {
    /// Half the effective track: the lever arm of the outer wheels (the middle of dual wheels). It
    /// is the mean over the axles that support the trailer, weighted with their loads.
    pub half_track_m: T,
    /// Mass of the trailer's axles.
    pub unsprung_mass_kg: T,
    /// Height of the c.g. of the axles.
    pub unsprung_height_m: T,
    /// Standard deviation of the distance of a payload's c.g. from the middle of the trailer, to the left or to the
    /// right.
    pub payload_beside_sd_m: T,
    /// Greatest lateral acceleration that the trailer has in any steady turn at 30 km/h ([`TIGHTEST_MPS`]), in g: beyond it, a
    /// tighter turn articulates the trailer so far that it accelerates it less. It grows with the square of the speed.
    pub tightest_turn_g: T,
}

/// Rollover measures at one height, mass and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rollover<T> {
    /// `T/2` divided by the height of the whole trailer's c.g., in g: the upper limit, for a rigid
    /// vehicle.
    pub static_stability_factor_g: T,
    /// Lateral acceleration of the trailer beyond which the vehicle tips in a steady turn, in g, with the
    /// standard deviation that it has in a turn to one side.
    pub static_rollover_threshold_g: Measured<T>,
}

impl<T: Real> RolloverDesign<T> {
    /// The rollover measures at height `height` of the sprung c.g. The standard deviation of the threshold is that
    /// due to the height; [`Design::rollover`](crate::Design::rollover) adds what else is uncertain.
    ///
    /// `threshold_g` contains the thresholds of this trailer mass and speed, equally spaced between
    /// the least and the greatest height.
    pub fn at(
        &self,
        height: Measured<T>,
        trailer_mass_kg: T,
        threshold_g: &[T; HEIGHTS],
        [least_m, greatest_m]: [T; 2],
    ) -> Rollover<T> {
        let sprung_kg = trailer_mass_kg - self.unsprung_mass_kg;
        let moment = sprung_kg * height.value + self.unsprung_mass_kg * self.unsprung_height_m;
        let threshold = |h: T| at_height(threshold_g, (h - least_m) / (greatest_m - least_m));
        let half_m = height.value * T::of(0.01);
        let (above, below) = (threshold(height.value + half_m), threshold(height.value - half_m));
        let slope = (above - below) / (half_m + half_m);
        Rollover {
            static_stability_factor_g: trailer_mass_kg * self.half_track_m / moment,
            static_rollover_threshold_g: Measured {
                value: threshold(height.value),
                sd: (slope * height.sd).abs(),
            },
        }
    }
}

impl<T: Real> Rollover<T> {
    /// The threshold minus the magnitude of the present lateral acceleration, in g. The vehicle
    /// tips at zero.
    pub fn margin_g(&self, lateral_acceleration_mps2: T, gravity_mps2: T) -> T {
        self.static_rollover_threshold_g.value - lateral_acceleration_mps2.abs() / gravity_mps2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rigid trailer with heights from 1 to 3 m: the threshold is 1/h at every height.
    fn rigid() -> (RolloverDesign<f64>, [f64; HEIGHTS]) {
        let design = RolloverDesign {
            half_track_m: 1.0,
            unsprung_mass_kg: 0.0,
            unsprung_height_m: 0.5,
            payload_beside_sd_m: 0.0,
            tightest_turn_g: 0.4,
        };
        #[allow(clippy::cast_precision_loss)]
        let threshold_g = core::array::from_fn(|k| 1.0 / (1.0 + 2.0 * k as f64 / 7.0));
        (design, threshold_g)
    }

    const FAST_MPS: f64 = TURN_MPS[1];

    #[test]
    fn a_rigid_vehicle_tips_at_half_track_over_height() {
        let (design, line) = rigid();
        for h in [1.0, 1.7, 2.0, 3.0] {
            let height = Measured { value: h, sd: 0.02 };
            let measures = design.at(height, 30e3, &line, [1.0, 3.0]);
            assert!((measures.static_rollover_threshold_g.value - 1.0 / h).abs() < 1e-12, "{h}");
            assert!((measures.static_stability_factor_g - 1.0 / h).abs() < 1e-12);
        }
        let measures = design.at(Measured { value: 2.0, sd: 0.02 }, 30e3, &line, [1.0, 3.0]);
        // d(1/h)/dh = −1/h²; the central difference over 2 % is good to 1e-4.
        assert!((measures.static_rollover_threshold_g.sd / (0.02 / 4.0) - 1.0).abs() < 1.1e-4);
        assert!((measures.margin_g(-0.3 * 9.81, 9.81) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn thresholds_between_two_masses_are_blended() {
        let (design, line) = rigid();
        let light = ThresholdLine { threshold_g: [line; 2] };
        let heavy = ThresholdLine { threshold_g: [line.map(|g| 0.8 * g); 2] };
        let between = light.blend(&heavy, 0.25).at_speed(FAST_MPS, 9.0);
        let measures = design.at(Measured::exact(2.0), 30e3, &between, [1.0, 3.0]);
        assert!((measures.static_rollover_threshold_g.value - 0.95 / 2.0).abs() < 1e-12);
    }

    /// 0.4 g at 40 km/h and 0.5 g at 90 km/h. Halfway between them in `1/U⁴` it is 1/(1.25 + 1) of
    /// a g.
    #[test]
    fn a_tighter_turn_tips_at_less() {
        let line = ThresholdLine { threshold_g: [[0.4; HEIGHTS], [0.5; HEIGHTS]] };
        let middle_mps = (0.5 / TURN_MPS[0].powi(4) + 0.5 / TURN_MPS[1].powi(4)).powf(-0.25);
        // At 25 km/h `1/U⁴` is 1.6⁴ times that at 40 km/h, and (4/9)⁴ of the latter at 90 km/h: 1/g is 2 + 0.5 · 6.779….
        let fast_4 = (4.0_f64 / 9.0).powi(4);
        let slowest_g = 1.0 / (2.0 + 0.5 * (1.6_f64.powi(4) - fast_4) / (1.0 - fast_4));
        let known = [
            (0.0, 0.5),
            (25.0 / 3.6, slowest_g),
            (40.0 / 3.6, 0.4),
            (middle_mps, 1.0 / 2.25),
            (25.0, 0.5),
        ];
        // At 12.5 km/h, a sixteenth of the way from the threshold at rest to that at 25 km/h.
        let slower_g = 1.0 / (2.0 + (1.0 / slowest_g - 2.0) / 16.0);
        let known = known.into_iter().chain([(12.5 / 3.6, slower_g)]);
        for (speed_mps, g) in known.into_iter().chain([(40.0, 0.5), (f64::NAN, 0.4)]) {
            for found in line.at_speed(speed_mps, 9.0) {
                assert!((found - g).abs() < 1e-12, "{speed_mps}: {found}");
            }
        }
        let turned = ThresholdLine { threshold_g: [[0.5; HEIGHTS], [0.4; HEIGHTS]] };
        assert!(turned.at_speed(f64::NAN, 9.0).iter().all(|g| (g - 0.4).abs() < 1e-15));
    }

    /// The tightest turn at 30 km/h has 0.2 g, that at 45 km/h 2.25 times as much, which is less than its threshold, and that at
    /// 60 km/h more. Below 25 km/h it matters less: at 20 km/h the limit is that at 25 over 0.8⁴, and at 15 km/h
    /// above the threshold.
    #[test]
    fn no_threshold_is_above_the_tightest_turn() {
        let line = ThresholdLine { threshold_g: [[0.5; HEIGHTS]; 2] };
        let at_25_g = 0.2 / 1.44;
        let at_20_g = at_25_g / 0.8_f64.powi(4);
        for (kmh, g) in [
            (0.0_f64, 0.5),
            (15.0, 0.5),
            (20.0, at_20_g),
            (25.0, at_25_g),
            (30.0, 0.2),
            (45.0, 0.45),
            (60.0, 0.5),
        ] {
            for found in line.at_speed(kmh / 3.6, 0.2) {
                assert!((found - g).abs() < 1e-12, "{kmh} km/h: {found}");
            }
        }
    }

    /// 27 t at 2 m and axles of 3 t at 0.5 m give 30 t at 1.85 m.
    #[test]
    fn the_axles_lower_the_whole_trailers_center_of_gravity() {
        let (design, line) = rigid();
        let design = RolloverDesign { half_track_m: 0.925, unsprung_mass_kg: 3e3, ..design };
        let measures = design.at(Measured::exact(2.0), 30e3, &line, [1.0, 3.0]);
        assert!((measures.static_stability_factor_g - 0.5).abs() < 1e-12);
    }

    #[test]
    fn beyond_the_heights_the_last_threshold_holds() {
        let (design, line) = rigid();
        for (height_m, g) in [(0.5, 1.0), (1.0, 1.0), (3.0, 1.0 / 3.0), (3.5, 1.0 / 3.0)] {
            let measures = design.at(Measured::exact(height_m), 30e3, &line, [1.0, 3.0]);
            assert!((measures.static_rollover_threshold_g.value - g).abs() < 1e-12, "{height_m}");
        }
    }
}
