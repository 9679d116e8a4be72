//! What the estimator says of a sample and of a maneuver.

use core::fmt;

use crate::decide::consistency::Inconsistency;
use crate::identify::identifier::{Fit, Unexcited};
use crate::math::real::Real;
use crate::truck::ratio::{HeightError, Measured};

/// What the estimator is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// No roll angle or no input in this sample.
    Absent,
    /// Driving straight: nothing to learn.
    Straight,
    /// In a turn.
    Turning,
}

/// Why a maneuver gave no height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reject<T> {
    /// The channel's signal was absent.
    Absent,
    /// The data do not determine the ratio.
    Unexcited(Unexcited),
    /// The ratio is too uncertain.
    Imprecise {
        /// Relative standard deviation of the ratio.
        ratio_sd_relative: T,
    },
    /// Speed or trailer mass are not covered by the design.
    OutsideDesign {
        /// Mean speed of the maneuver.
        speed_mps: T,
        /// Trailer mass.
        trailer_mass_kg: T,
    },
    /// No height, or none that can be, explains the ratio.
    Height(HeightError<T>),
    /// The roll angle does not fit the rest.
    Inconsistent(Inconsistency<T>),
}

impl<T: Real> fmt::Display for Reject<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => write!(f, "the signal is absent"),
            Self::Unexcited(reason) => reason.fmt(f),
            Self::Imprecise { ratio_sd_relative } => {
                write!(f, "ratio uncertain by {:.0} %", ratio_sd_relative.as_f64() * 100.0)
            }
            Self::OutsideDesign { speed_mps, trailer_mass_kg } => write!(
                f,
                "speed {:.1} m/s or trailer mass {:.0} kg is outside the design",
                speed_mps.as_f64(),
                trailer_mass_kg.as_f64()
            ),
            Self::Height(error) => error.fmt(f),
            Self::Inconsistent(Inconsistency::Misfit { share }) => write!(
                f,
                "inconsistent: the model misses {:.0} % of the roll angle; check the sensors' \
                 times, signs and units",
                share.as_f64() * 100.0
            ),
            Self::Inconsistent(Inconsistency::Bent { .. }) => f.write_str(
                "inconsistent: the roll angle falls behind the expected one as it grows; the sensor \
                 seems to come to the end of its range",
            ),
            Self::Inconsistent(Inconsistency::Standstill { roll_rad }) => write!(
                f,
                "inconsistent: the roll angle stood still at {:.4} rad while the truck rolled on; \
                 the sensor hangs, has a dead band or is at the end of its range",
                roll_rad.as_f64()
            ),
        }
    }
}

/// What one channel says of one maneuver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outcome<T> {
    /// Quality of the identification, with `ratio` the DC ratio `R_i` in rad per unit of input.
    pub fit: Option<Fit<T>>,
    /// Height with the noise's standard deviation, or why there is none.
    pub height_m: Result<Measured<T>, Reject<T>>,
    /// Standard deviation of the height from compensation and model.
    pub systematic_sd_m: T,
}

/// One closed maneuver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Maneuver<T> {
    /// First time stamp.
    pub start_us: u64,
    /// Last time stamp.
    pub end_us: u64,
    /// Mean speed of the rows used.
    pub speed_mps: T,
    /// Trailer mass.
    pub trailer_mass_kg: T,
    /// Per channel, in the order of [`Channel::ALL`](crate::Channel::ALL).
    pub outcomes: [Outcome<T>; 2],
    /// Correlation of the two channels' systematic errors.
    pub correlation: T,
}

/// The estimator's answer to one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T> {
    /// What it is doing.
    pub status: Status,
    /// The maneuver that this sample closed.
    pub closed: Option<Maneuver<T>>,
}
