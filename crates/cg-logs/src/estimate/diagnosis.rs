//! Diagnosis of a contradiction between the channels: single faults (sign, unit or gain) that
//! explain it.
//!
//! Each fault changes the DC ratio of one or both channels in its own way. If the identified ratios
//! contradict each other, each fault is reversed in turn. The faults after whose reversal both
//! channels give the same possible height are the likely causes.

use std::fmt;

use cg_core::truck::ratio::solve_height;
use cg_core::{Channel, Design, Measured};

/// Steering-wheel angle divided by road-wheel angle of most trucks, used if the vehicle file has
/// none.
const USUAL_STEERING_RATIO: f64 = 20.0;
/// Number of standard deviations up to which two heights agree.
const AGREES: f64 = 2.0;
/// Relative error of a sensor gain above which it is reported.
const NOTEWORTHY: f64 = 0.05;

/// A fault of one sensor that would explain the ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    RollReversed,
    SteerReversed,
    LateralReversed,
    RollIsTilt,
    RollInDegrees,
    SteeringWheel,
    SteerInDegrees,
    LateralInG,
    LateralHasGravity,
    /// The steer angle divided by its true value, and the lateral acceleration divided by its true
    /// value. Either of them explains the contradiction.
    Gain {
        steer: f64,
        lateral: f64,
    },
}

impl Cause {
    /// Whether it is a fault of the lateral acceleration, which a yaw rate would show.
    pub(super) fn is_of_lateral(&self) -> bool {
        matches!(self, Self::LateralReversed | Self::LateralInG | Self::LateralHasGravity)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RollReversed => f.write_str("the roll sensor is reversed (⟨flip roll⟩)"),
            Self::SteerReversed => f.write_str("the steer angle is reversed (⟨flip steer⟩)"),
            Self::LateralReversed => f.write_str(
                "the lateral acceleration is reversed (⟨flip lateral_acceleration⟩, or yaw_rate)",
            ),
            Self::RollIsTilt => f.write_str(
                "the roll angle comes from an inclinometer, which also measures the lateral \
                 acceleration (name its column tilt_rad)",
            ),
            Self::RollInDegrees => {
                f.write_str("the roll angle is in degrees (⟨columns roll=NAME[deg]⟩)")
            }
            Self::SteeringWheel => f.write_str(
                "the steer angle is that of the steering wheel (name its column \
                 steering_wheel_rad)",
            ),
            Self::SteerInDegrees => {
                f.write_str("the steer angle is in degrees (⟨columns steer=NAME[deg]⟩)")
            }
            Self::LateralInG => f.write_str(
                "the lateral acceleration is in g (⟨columns lateral_acceleration=NAME[g]⟩)",
            ),
            Self::LateralHasGravity => f.write_str(
                "the lateral acceleration comes from an accelerometer fixed to the body, which \
                 also measures gravity when the body rolls (remove its column, so that yaw rate \
                 and speed are used instead)",
            ),
            Self::Gain { steer, lateral } => write!(
                f,
                "the steer angle is {steer:.2} times its true value, or the lateral acceleration is \
                 {lateral:.2} times its true value; check scale and unit",
            ),
        }
    }
}

/// The identified ratios of the channels and the data to judge them.
pub(super) struct Evidence<'a> {
    pub(super) design: &'a Design<f64>,
    pub(super) steering_ratio: Option<f64>,
    /// DC ratios of the roll angle, by the steer angle and by the lateral acceleration, divided by
    /// the compensation.
    pub(super) ratio: [Option<Measured<f64>>; 2],
    pub(super) speed_mps: f64,
    pub(super) trailer_mass_kg: f64,
}

impl Evidence<'_> {
    /// The faults that explain a contradiction; empty if there is no contradiction or no
    /// explanation.
    pub(super) fn likely_causes(&self) -> Vec<Cause> {
        if self.makes_sense(self.ratio) {
            return Vec::new();
        }
        let gravity = self.design.gravity_mps2;
        let wheel = self.steering_ratio.unwrap_or(USUAL_STEERING_RATIO);
        let degree = 1_f64.to_radians();
        let [_, lateral] = self.ratio.map(|ratio| ratio.map_or(f64::NAN, |ratio| ratio.value));
        // An inclinometer adds a_y/g to the roll. A body-fixed accelerometer adds g times the roll
        // to a_y.
        let tilt = 1.0 - 1.0 / (gravity * lateral);
        let body = 1.0 / (1.0 - gravity * lateral);
        let single: Vec<Cause> = [
            (Cause::RollReversed, [-1.0, -1.0]),
            (Cause::SteerReversed, [-1.0, 1.0]),
            (Cause::LateralReversed, [1.0, -1.0]),
            (Cause::LateralHasGravity, [1.0, body]),
            (Cause::RollIsTilt, [tilt, tilt]),
            (Cause::SteeringWheel, [wheel, 1.0]),
            (Cause::LateralInG, [1.0, 1.0 / gravity]),
            (Cause::SteerInDegrees, [1.0 / degree, 1.0]),
            (Cause::RollInDegrees, [degree, degree]),
        ]
        .into_iter()
        .filter(|(_, factors)| self.makes_sense(self.corrected(*factors)))
        .map(|(cause, _)| cause)
        .collect();
        if single.is_empty() { self.gain().into_iter().collect() } else { single }
    }

    fn corrected(&self, factors: [f64; 2]) -> [Option<Measured<f64>>; 2] {
        let mut ratio = self.ratio;
        for (ratio, factor) in ratio.iter_mut().zip(factors) {
            if let Some(ratio) = ratio {
                *ratio = Measured { value: ratio.value * factor, sd: (ratio.sd * factor).abs() };
            }
        }
        ratio
    }

    /// Height of a channel with its whole uncertainty.
    fn height(&self, channel: Channel, ratio: Measured<f64>) -> Option<Measured<f64>> {
        let (speed_mps, mass_kg) = (self.speed_mps, self.trailer_mass_kg);
        let line = self.design.line(channel, speed_mps, mass_kg)?;
        let sd = self.design.spread(speed_mps, mass_kg)?.sd(channel.index());
        let height = solve_height(&line, ratio, Measured::exact(1.0), sd).ok()?;
        let Design { least_height_m, greatest_height_m, .. } = self.design;
        (height.value >= *least_height_m && height.value <= *greatest_height_m).then_some(height)
    }

    /// Whether every channel with a ratio has a possible height and both heights agree.
    fn makes_sense(&self, ratio: [Option<Measured<f64>>; 2]) -> bool {
        let heights: Option<Vec<Measured<f64>>> = Channel::ALL
            .into_iter()
            .zip(ratio)
            .filter_map(|(channel, ratio)| Some((channel, ratio?)))
            .map(|(channel, ratio)| self.height(channel, ratio))
            .collect();
        match heights.as_deref() {
            Some([one, other]) => {
                (one.value - other.value).abs() <= AGREES * libm::hypot(one.sd, other.sd)
            }
            Some(_) => true,
            None => false,
        }
    }

    /// The gains with which both channels would agree, each at the height of the other channel.
    pub(super) fn gain(&self) -> Option<Cause> {
        let [steer, lateral] = self.ratio;
        let (steer, lateral) = (steer?, lateral?);
        let wanted = |channel: Channel, other: Channel, its: Measured<f64>| {
            let height = self.height(other, its)?;
            let line = self.design.line(channel, self.speed_mps, self.trailer_mass_kg)?;
            Some(line.ratio_at(height.value))
        };
        // A signal that is too large gives a ratio that is too small.
        let steer_gain =
            wanted(Channel::Steer, Channel::LateralAcceleration, lateral)? / steer.value;
        let lateral_gain =
            wanted(Channel::LateralAcceleration, Channel::Steer, steer)? / lateral.value;
        let is_noteworthy = steer_gain > 0.0 && (steer_gain - 1.0).abs() > NOTEWORTHY;
        is_noteworthy.then_some(Cause::Gain { steer: steer_gain, lateral: lateral_gain })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, SPEED_MPS, design};

    /// True ratios at a height of 2 m by [`design`].
    const STEER: f64 = 0.2;
    const LATERAL: f64 = 0.02;
    const GRAVITY_MPS2: f64 = 9.81;

    fn causes_of(design: &Design<f64>, ratio: [Option<f64>; 2]) -> Vec<Cause> {
        let ratio = ratio.map(|ratio| ratio.map(Measured::exact));
        let (speed_mps, trailer_mass_kg) = (SPEED_MPS, MASS_KG);
        Evidence { design, steering_ratio: None, ratio, speed_mps, trailer_mass_kg }.likely_causes()
    }

    fn causes(steer: f64, lateral: f64) -> Vec<Cause> {
        causes_of(&design(), [Some(steer), Some(lateral)])
    }

    #[test]
    fn a_wrong_sign_is_found() {
        assert_eq!(causes(-STEER, -LATERAL), [Cause::RollReversed]);
        assert_eq!(causes(-STEER, LATERAL), [Cause::SteerReversed]);
        assert_eq!(causes(STEER, -LATERAL), [Cause::LateralReversed]);
    }

    /// A signal that is too large gives a ratio that is too small.
    #[test]
    fn a_wrong_unit_is_found() {
        let degrees = 1_f64.to_degrees();
        assert_eq!(causes(STEER / degrees, LATERAL), [Cause::SteerInDegrees]);
        assert_eq!(causes(STEER * degrees, LATERAL * degrees), [Cause::RollInDegrees]);
        assert_eq!(causes(STEER, LATERAL * GRAVITY_MPS2), [Cause::LateralInG]);
    }

    #[test]
    fn the_steering_wheel_is_found_by_the_ratio_of_the_truck() {
        assert_eq!(causes(STEER / 20.0, LATERAL), [Cause::SteeringWheel]);
        let design = design();
        let evidence = Evidence {
            design: &design,
            steering_ratio: Some(30.0),
            ratio: [STEER / 30.0, LATERAL].map(|ratio| Some(Measured::exact(ratio))),
            speed_mps: SPEED_MPS,
            trailer_mass_kg: MASS_KG,
        };
        assert_eq!(evidence.likely_causes(), [Cause::SteeringWheel]);
    }

    /// Roll and lateral acceleration are `R a` and `a`. With gravity, `a (1 + g R)` is measured; an
    /// inclinometer measures `a (R + 1/g)`.
    #[test]
    fn gravity_in_a_signal_is_found() {
        let body = 1.0 + GRAVITY_MPS2 * LATERAL;
        assert_eq!(causes(STEER, LATERAL / body), [Cause::LateralHasGravity]);
        let tilt = LATERAL + 1.0 / GRAVITY_MPS2;
        assert_eq!(causes(STEER * tilt / LATERAL, tilt), [Cause::RollIsTilt]);
    }

    #[test]
    fn a_gain_is_found_for_either_sensor() {
        let found = causes(STEER / 1.3, LATERAL);
        let [Cause::Gain { steer, lateral }] = found[..] else { panic!("{found:?}") };
        assert!((steer - 1.3).abs() < 1e-12 && (lateral - 1.0 / 1.3).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_gain_within_five_percent_is_not_reported() {
        let mut design = design();
        for spread in design.spread.iter_mut().flatten() {
            (spread.covariance[0][0], spread.covariance[1][1]) = (1e-8, 1e-8);
        }
        for (gain, named) in [(0.94, true), (0.96, false), (1.04, false), (1.06, true)] {
            let found = causes_of(&design, [Some(STEER / gain), Some(LATERAL)]);
            assert_eq!(found.len(), usize::from(named), "{gain}: {found:?}");
        }
    }

    #[test]
    fn where_nothing_is_wrong_or_nothing_explains_it_there_is_no_cause() {
        let design = design();
        assert_eq!(causes(STEER, LATERAL), []);
        // Heights of 9 m and −5 m.
        assert_eq!(causes(0.9, -0.05), []);
        assert_eq!(causes_of(&design, [None, None]), []);
        assert_eq!(causes_of(&design, [Some(STEER), None]), []);
        assert_eq!(causes_of(&design, [None, Some(LATERAL)]), []);
        // One channel with an impossible height of 9 m: a gain cannot be compared.
        assert_eq!(causes_of(&design, [Some(0.9), None]), []);
    }

    /// Heights of 2 and 2.05 m with standard deviations of 1 % are 1.75 joint standard deviations
    /// apart, 2 and 2.07 m are 2.43.
    #[test]
    fn heights_agree_up_to_two_standard_deviations() {
        let design = design();
        let (speed_mps, trailer_mass_kg) = (SPEED_MPS, MASS_KG);
        for (height_m, agree) in [(1.93, false), (1.95, true), (2.05, true), (2.07, false)] {
            let ratio = [STEER, 0.01 * height_m].map(|ratio| Some(Measured::exact(ratio)));
            let evidence = Evidence {
                design: &design,
                steering_ratio: None,
                ratio,
                speed_mps,
                trailer_mass_kg,
            };
            assert_eq!(evidence.makes_sense(ratio), agree, "{height_m}");
        }
    }

    #[test]
    fn only_heights_of_this_trailer_are_possible() {
        let design = design();
        let ratio = [None, None];
        let (speed_mps, trailer_mass_kg) = (SPEED_MPS, MASS_KG);
        let evidence =
            Evidence { design: &design, steering_ratio: None, ratio, speed_mps, trailer_mass_kg };
        for (height_m, possible) in [(0.99, false), (1.01, true), (2.99, true), (3.01, false)] {
            let found = evidence.height(Channel::Steer, Measured::exact(0.1 * height_m));
            assert_eq!(found.is_some(), possible, "{height_m}");
            assert!(found.is_none_or(|found| (found.value - height_m).abs() < 1e-9));
        }
        // The noise of the ratio and the uncertainty of the model add up: 5 % is √(4.9² + 1²) %.
        let noisy = Measured { value: LATERAL, sd: LATERAL * 24_f64.sqrt() * 0.01 };
        let found = evidence.height(Channel::LateralAcceleration, noisy).unwrap();
        assert!((found.sd - 0.1).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_factor_scales_the_uncertainty_too() {
        let design = design();
        let ratio = [Some(Measured { value: 0.2, sd: 0.01 }), None];
        let (speed_mps, trailer_mass_kg) = (SPEED_MPS, MASS_KG);
        let evidence =
            Evidence { design: &design, steering_ratio: None, ratio, speed_mps, trailer_mass_kg };
        let expected = Measured { value: -0.8, sd: 0.04 };
        assert_eq!(evidence.corrected([-4.0, 1.0]), [Some(expected), None]);
    }

    #[test]
    fn each_cause_names_its_remedy() {
        let gain = Cause::Gain { steer: 1.3, lateral: 0.769 };
        for (cause, words) in [
            (Cause::RollReversed, "⟨flip roll⟩"),
            (Cause::SteerReversed, "⟨flip steer⟩"),
            (Cause::LateralReversed, "⟨flip lateral_acceleration⟩"),
            (Cause::RollIsTilt, "tilt_rad"),
            (Cause::RollInDegrees, "⟨columns roll=NAME[deg]⟩"),
            (Cause::SteeringWheel, "steering_wheel_rad"),
            (Cause::SteerInDegrees, "⟨columns steer=NAME[deg]⟩"),
            (Cause::LateralInG, "⟨columns lateral_acceleration=NAME[g]⟩"),
            (Cause::LateralHasGravity, "measures gravity"),
            (gain, "1.30 times its true value, or the lateral acceleration is 0.77 times"),
        ] {
            assert!(cause.to_string().contains(words), "{cause}");
        }
    }
}
