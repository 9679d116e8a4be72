//! Channels: the pairs of signals from which a height is identified.
//!
//! A channel is the transfer function from an input to a roll angle. On a banked road, the body and
//! its suspension feel `a_e = a_y + g β` (`β` is the bank), an accelerometer fixed to the body
//! shows `f = a_e + g φ`, and a roll sensor relative to gravity shows `φ + β`. The ratio of the
//! suspension roll to the specific force `f` therefore does not depend on the bank; all other
//! ratios do.

/// The roll angle that a channel explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Roll angle of the trailer's sprung mass, relative to the road or to gravity.
    Roll,
    /// Roll angle of the trailer's sprung mass relative to its axles.
    SuspensionRoll,
    /// Roll angle of the tractor's sprung mass relative to its drive axles.
    TractorSuspensionRoll,
}

/// The signal that causes the roll angle, or that is caused together with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Road-wheel steer angle.
    Steer,
    /// Lateral acceleration of the trailer, free of gravity.
    LateralAcceleration,
    /// Lateral specific force of the trailer's body.
    SpecificForce,
    /// Lateral specific force of the tractor's body.
    TractorSpecificForce,
}

impl Output {
    /// All outputs.
    pub const ALL: [Self; 3] = [Self::Roll, Self::SuspensionRoll, Self::TractorSuspensionRoll];
}

impl Input {
    /// All inputs.
    pub const ALL: [Self; 4] =
        [Self::Steer, Self::LateralAcceleration, Self::SpecificForce, Self::TractorSpecificForce];
}

/// A pair of an output and an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Channel {
    /// Steer angle to roll angle, as in the thesis. Its ratio depends on the tires and on the speed.
    Steer,
    /// Lateral acceleration to roll angle. Its ratio does not depend on the tires.
    LateralAcceleration,
    /// Specific force of the trailer to its suspension roll. Its ratio does not depend on the bank
    /// of the road.
    Suspension,
    /// Specific force of the tractor to its suspension roll: no sensor on the trailer. Its ratio
    /// does not depend on the bank of the road.
    Tractor,
}

/// Time constant of each of the two lags through which the roll angle of a channel passes if its input
/// is an acceleration.
///
/// The tractor rolls the trailer through the fifth wheel before the trailer's own acceleration does.
/// A model that may use only the past of the acceleration therefore cannot explain the roll angle; it
/// can explain that of 0.3 s ago. With longer lags the models are hardly more exact, and the noise of the
/// roll angle becomes slower.
pub const ROLL_LAG_S: f64 = 0.15;

/// Number of channels.
pub const CHANNELS: usize = Channel::ALL.len();

impl Channel {
    /// All channels.
    pub const ALL: [Self; 4] =
        [Self::Steer, Self::LateralAcceleration, Self::Suspension, Self::Tractor];

    /// Its index in [`Channel::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The roll angle that it explains.
    pub const fn output(self) -> Output {
        match self {
            Self::Steer | Self::LateralAcceleration => Output::Roll,
            Self::Suspension => Output::SuspensionRoll,
            Self::Tractor => Output::TractorSuspensionRoll,
        }
    }

    /// The signal by which it explains the roll angle.
    pub const fn input(self) -> Input {
        match self {
            Self::Steer => Input::Steer,
            Self::LateralAcceleration => Input::LateralAcceleration,
            Self::Suspension => Input::SpecificForce,
            Self::Tractor => Input::TractorSpecificForce,
        }
    }

    /// Whether its roll angle passes the lags of [`ROLL_LAG_S`].
    pub const fn lags_roll(self) -> bool {
        !matches!(self.input(), Input::Steer)
    }

    /// Whether a bank of the road changes its ratio.
    pub const fn feels_bank(self) -> bool {
        matches!(self.output(), Output::Roll)
    }
}

words!(Channel {
    Steer => "steer", "Roll angle by the steer angle";
    LateralAcceleration => "lateral-acceleration",
        "Roll angle by the lateral acceleration, or by yaw rate times speed";
    Suspension => "suspension", "Suspension roll of the trailer by its specific force";
    Tractor => "tractor", "Suspension roll of the tractor by its specific force", "tractor-suspension";
});
