//! Options of an estimate.

use cg_core::Channel;
use cg_vehicle::Variant;
use serde::Serialize;

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE_95: f64 = 1.959_964;

/// Method by which the DC ratio is identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// ARX on filtered signals with prior dynamics: the recommended method.
    #[default]
    Filtered,
    /// Classical ARX in shift form, as in the thesis.
    Arx,
    /// Nominal dynamics with a free gain. It has the smallest variance if the dynamics are right.
    Gain,
}

cg_core::words!(Method {
    Filtered => "filtered", "ARX on filtered signals with prior dynamics";
    Arx => "arx", "Classical ARX in shift form, as in the thesis";
    Gain => "gain", "Nominal dynamics; only the gain is identified";
});

/// The channel from which a height is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelChoice {
    /// Both channels, combined.
    #[default]
    Auto,
    /// Only the steer angle.
    Steer,
    /// Only the lateral acceleration.
    LateralAcceleration,
}

cg_core::words!(ChannelChoice {
    Auto => "auto", "Both, weighted by their uncertainty";
    Steer => "steer", "Steer angle";
    LateralAcceleration => "lateral-acceleration", "Lateral acceleration, or yaw rate times speed";
});

impl From<ChannelChoice> for Option<Channel> {
    fn from(choice: ChannelChoice) -> Self {
        match choice {
            ChannelChoice::Auto => None,
            ChannelChoice::Steer => Some(Channel::Steer),
            ChannelChoice::LateralAcceleration => Some(Channel::LateralAcceleration),
        }
    }
}

/// Options of an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateOptions {
    /// Equations of the vehicle model.
    pub variant: Variant,
    /// Method of identification.
    pub method: Method,
    /// Order of the classical ARX.
    pub order: usize,
    /// The channel to use; `None` combines both, weighted by their uncertainty.
    pub channel: Option<Channel>,
    /// Speed in m/s that replaces the one in the log.
    pub speed_mps: Option<f64>,
    /// Trailer mass in kg that replaces the one in the log.
    pub trailer_mass_kg: Option<f64>,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self {
            variant: Variant::Complete,
            method: Method::Filtered,
            order: 5,
            channel: None,
            speed_mps: None,
            trailer_mass_kg: None,
        }
    }
}
