//! What to estimate with.

use cg_core::Channel;
use cg_vehicle::Variant;
use serde::Serialize;

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE_95: f64 = 1.959_964;

/// How the DC ratio is identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// ARX on filtered signals with prior dynamics: the production method.
    #[default]
    Filtered,
    /// Classical shift-form ARX, as in the source.
    Arx,
    /// Nominal dynamics, only the gain is free: least variance, if the dynamics are right.
    Gain,
}

cg_core::words!(Method {
    Filtered => "filtered", "Filtered signals and prior dynamics";
    Arx => "arx", "Classical shift form, as in the thesis";
    Gain => "gain", "Nominal dynamics, only the gain is free";
});

/// Which channel a height is estimated from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelChoice {
    /// Both, combined.
    #[default]
    Auto,
    /// Steer angle alone.
    Steer,
    /// Lateral acceleration alone.
    LateralAcceleration,
}

cg_core::words!(ChannelChoice {
    Auto => "auto", "Both, by what each knows";
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

/// What to estimate with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateOptions {
    /// Equations of the vehicle model.
    pub variant: Variant,
    /// Identification.
    pub method: Method,
    /// Order of the classical ARX.
    pub order: usize,
    /// The channel to use; `None` combines both, each with the weight of what it knows.
    pub channel: Option<Channel>,
    /// Speed, whatever the log says.
    pub speed_mps: Option<f64>,
    /// Trailer mass, whatever the log says.
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
