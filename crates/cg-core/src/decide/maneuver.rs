//! The results of the estimator for a sample and for a maneuver.

use core::fmt;

use crate::decide::consistency::Inconsistency;
use crate::identify::identifier::{Fit, Unexcited};
use crate::math::real::Real;
use crate::truck::channel::CHANNELS;
use crate::truck::ratio::{HeightError, Measured};

/// State of the estimator after a sample.
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The sample has no roll angle or no input.
    Absent,
    /// The truck drives straight; no maneuver is in progress.
    Straight,
    /// The truck is in a turn.
    Turning,
}

/// The reason why a channel gives no height for a maneuver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Reject<T> {
    /// The input or the roll angle of the channel was absent.
    Absent,
    /// The data do not determine the ratio.
    Unexcited(Unexcited),
    /// The ratio is too uncertain.
    Imprecise {
        /// Relative standard deviation of the ratio.
        ratio_sd_relative: T,
    },
    /// Speed or trailer mass is outside the axes of the design.
    OutsideDesign {
        /// Mean speed of the maneuver, m/s.
        speed_mps: T,
        /// Mean trailer mass of the maneuver, kg.
        trailer_mass_kg: T,
    },
    /// No height, or no physically possible height, explains the ratio.
    Height(HeightError<T>),
    /// The bank of the road is not known and changes the ratio by too much.
    Road {
        /// Relative standard deviation of the ratio due to the bank.
        ratio_sd_relative: T,
    },
    /// The roll angle cannot be true.
    Inconsistent(Inconsistency<T>),
}

impl<T: Real> fmt::Display for Reject<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => write!(f, "the signal is absent"),
            Self::Unexcited(reason) => reason.fmt(f),
            // A constant roll angle or input determines nothing, and its number means nothing.
            Self::Imprecise { ratio_sd_relative } => match ratio_sd_relative.as_f64() {
                sd if sd <= 10.0 => write!(f, "the ratio is uncertain by {:.0} %", sd * 100.0),
                _ => f.write_str("the ratio is uncertain by more than 1000 %"),
            },
            Self::Road { ratio_sd_relative } => write!(
                f,
                "the bank of the road is not known and makes the ratio uncertain by {:.0} %",
                ratio_sd_relative.as_f64() * 100.0
            ),
            Self::OutsideDesign { speed_mps, trailer_mass_kg } => write!(
                f,
                "speed {:.1} m/s or trailer mass {:.0} kg is outside the design",
                speed_mps.as_f64(),
                trailer_mass_kg.as_f64()
            ),
            Self::Height(error) => error.fmt(f),
            Self::Inconsistent(Inconsistency::Misfit { share }) => write!(
                f,
                "inconsistent: the model leaves {:.0} % of the roll angle unexplained; check the \
                 sensors' times, signs and units (or, of a suspension, the bank of the road changed \
                 along the truck)",
                share.as_f64() * 100.0
            ),
            Self::Inconsistent(Inconsistency::Bent { .. }) => f.write_str(
                "inconsistent: the roll angle falls behind the expected one as it grows; the sensor \
                 seems to reach the end of its range",
            ),
            Self::Inconsistent(Inconsistency::Standstill { roll_rad }) => write!(
                f,
                "inconsistent: the roll angle stood still at {:.4} rad while the truck rolled on; \
                 the sensor is stuck, has a dead band or is at the end of its range (or, of a \
                 suspension, the bank of the road changed along the truck)",
                roll_rad.as_f64()
            ),
        }
    }
}

/// The result of one maneuver in one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Outcome<T> {
    /// Result of the identification. Its `ratio` is the DC ratio `R_i` in radians of roll per unit
    /// of input. `None` if nothing was identified.
    pub fit: Option<Fit<T>>,
    /// Height in meters with its standard deviation due to noise and to this curve's own bank, or
    /// the reason why there is none.
    pub height_m: Result<Measured<T>, Reject<T>>,
    /// Standard deviation of the height due to compensation, model and the part of the bank of the
    /// road that all curves have in common, meters.
    pub systematic_sd_m: T,
    /// Standard deviation of the height due to the bank of the road, meters. It is contained in the
    /// other two.
    pub road_sd_m: T,
}

impl<T: Real> Outcome<T> {
    /// No height, for this reason.
    pub(crate) fn rejected(fit: Option<Fit<T>>, reject: Reject<T>) -> Self {
        let zero = T::zero();
        Self { fit, height_m: Err(reject), systematic_sd_m: zero, road_sd_m: zero }
    }
}

/// The results of one closed maneuver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [Outcome<T>; C]: serde::Serialize, [[T; C]; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [Outcome<T>; C]: serde::Deserialize<'de>, [[T; C]; C]: serde::Deserialize<'de>"
    ))
)]
pub struct Maneuver<T, const C: usize = CHANNELS> {
    /// First time stamp, µs.
    pub start_us: u64,
    /// Last time stamp, µs.
    pub end_us: u64,
    /// Mean speed in the turns, m/s.
    pub speed_mps: T,
    /// Mean trailer mass, kg.
    pub trailer_mass_kg: T,
    /// Whether the roll angle was relative to gravity and thus contained the bank of the road.
    pub to_gravity: bool,
    /// Results of all channels, in the order of the design's [channels](crate::Design::channels).
    pub outcomes: [Outcome<T>; C],
    /// Correlations of the systematic errors of the channels.
    pub correlation: [[T; C]; C],
}

/// The result of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T, const C: usize = CHANNELS> {
    /// State of the estimator after the sample.
    pub status: Status,
    /// The maneuver that this sample closed, if any; with [`Settings::spreads`](crate::Settings::spreads) the one whose
    /// solution it completed.
    pub closed: Option<Maneuver<T, C>>,
}
