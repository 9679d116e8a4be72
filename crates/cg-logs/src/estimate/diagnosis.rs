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
        if self.makes_sense(self.ratio) || self.ratio.iter().all(Option::is_none) {
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
                (one.value - other.value).abs() <= AGREES * one.sd.hypot(other.sd)
            }
            Some(_) => true,
            None => false,
        }
    }

    /// The gains with which both channels would agree, each at the height of the other channel.
    fn gain(&self) -> Option<Cause> {
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
        let told = steer_gain > 0.0 && (steer_gain - 1.0).abs() > NOTEWORTHY;
        told.then_some(Cause::Gain { steer: steer_gain, lateral: lateral_gain })
    }
}
