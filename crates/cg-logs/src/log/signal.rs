//! Signals of a log (the time, all quantities of [`cg_core::quantities!`], the roll rate, the roll of an
//! axle to gravity, the standard deviation of the trailer mass, the position of the lift axles and what is measured on the tractor)
//! and one row of them.
//!
//! The last six are no quantities of the estimator, which has no room for more on a chip: `roll_rate`
//! makes a roll angle of the rate, a row makes the roll of the suspension of that of an axle, raised lift axles
//! make another truck, and the path of the tractor becomes that of the trailer.

use std::fmt;
use std::str::FromStr;

use cg_core::{AlignSettings, Dimension, Quantity, Sample, Unit};

macro_rules! rows {
    ($(
        $(#[doc = $meaning:literal])+
        $variant:ident $field:ident $name:literal $dimension:ident $limits:tt $direction:ident $serves_us:expr;
    )+) => {
        /// One row of a log in SI units with the signs of ISO 8855; absent signals are NaN.
        ///
        /// Axes: x forward, y left, z up. In a left turn all angles and rates are positive.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct LogRow {
            /// Time stamp from any origin, s. It increases strictly and is never NaN in a row from
            /// a reader.
            pub time_s: f64,
            $($(#[doc = $meaning])+ pub $field: f64,)+
            /// Roll rate of the trailer's sprung mass (a gyroscope on its body), positive if the right
            /// side moves down. In a row for an estimator, it is that of which `roll_to_gravity_rad` is the integral.
            pub roll_rate_radps: f64,
            /// Roll angle of an axle of the trailer to gravity, positive right side down.
            pub axle_roll_to_gravity_rad: f64,
            /// Standard deviation of the trailer mass, kg.
            pub trailer_mass_sd_kg: f64,
            /// Position of the trailer's lift axles: 0 down, 1 raised.
            pub lift_axle: f64,
            /// Whether the yaw rate is that of the tractor: 0 no, 1 yes.
            pub yaw_rate_on_tractor: f64,
            /// Whether the lateral acceleration is that of the tractor's path: 0 no, 1 yes.
            pub lateral_acceleration_on_tractor: f64,
            /// Relative standard deviation of the roll angles of this turn due to the unknown mounting of the sensor of
            /// `roll_rate_radps`, whose integral they are. No signal of a log has it.
            pub roll_gain_sd: f64,
        }

        impl LogRow {
            /// The value of a signal in its SI unit.
            #[inline]
            pub const fn get(&self, signal: Signal) -> f64 {
                match signal {
                    Signal::Time => self.time_s,
                    Signal::RollRate => self.roll_rate_radps,
                    Signal::AxleRollToGravity => self.axle_roll_to_gravity_rad,
                    Signal::TrailerMassSd => self.trailer_mass_sd_kg,
                    Signal::LiftAxle => self.lift_axle,
                    Signal::YawRateOnTractor => self.yaw_rate_on_tractor,
                    Signal::LateralAccelerationOnTractor => self.lateral_acceleration_on_tractor,
                    $(Signal::$variant => self.$field),+
                }
            }

            /// A row with these values in the order of [`Signal::ALL`].
            #[inline]
            pub const fn from_values(values: [f64; Signal::COUNT]) -> Self {
                let [
                    time_s,
                    $($field,)+
                    roll_rate_radps,
                    axle_roll_to_gravity_rad,
                    trailer_mass_sd_kg,
                    lift_axle,
                    yaw_rate_on_tractor,
                    lateral_acceleration_on_tractor,
                ] = values;
                Self {
                    time_s,
                    $($field,)+
                    roll_rate_radps,
                    axle_roll_to_gravity_rad,
                    trailer_mass_sd_kg,
                    lift_axle,
                    yaw_rate_on_tractor,
                    lateral_acceleration_on_tractor,
                    roll_gain_sd: f64::NAN,
                }
            }
        }

        /// A signal of a log. Its text form is the column name without the unit, such as `roll`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Signal {
            /// Time stamp.
            Time,
            $($(#[doc = $meaning])+ $variant,)+
            /// Roll rate of the trailer's sprung mass.
            RollRate,
            /// Roll angle of an axle of the trailer to gravity.
            AxleRollToGravity,
            /// Standard deviation of the trailer mass.
            TrailerMassSd,
            /// Position of the trailer's lift axles.
            LiftAxle,
            /// Whether the yaw rate is that of the tractor.
            YawRateOnTractor,
            /// Whether the lateral acceleration is that of the tractor's path.
            LateralAccelerationOnTractor,
        }

        impl Signal {
            /// Every signal, in the order of the fields of [`LogRow`].
            pub const ALL: [Self; Self::COUNT] = [
                Self::Time,
                $(Self::$variant,)+
                Self::RollRate,
                Self::AxleRollToGravity,
                Self::TrailerMassSd,
                Self::LiftAxle,
                Self::YawRateOnTractor,
                Self::LateralAccelerationOnTractor,
            ];

            /// The quantity of the estimator; `None` for what only logs have.
            pub const fn quantity(self) -> Option<Quantity> {
                match self {
                    Self::Time
                    | Self::RollRate
                    | Self::AxleRollToGravity
                    | Self::TrailerMassSd
                    | Self::LiftAxle
                    | Self::YawRateOnTractor
                    | Self::LateralAccelerationOnTractor => None,
                    $(Self::$variant => Some(Quantity::$variant)),+
                }
            }
        }

        /// Every quantity is a signal of a log.
        impl From<Quantity> for Signal {
            #[inline]
            fn from(quantity: Quantity) -> Self {
                match quantity { $(Quantity::$variant => Self::$variant),+ }
            }
        }
    };
}

cg_core::quantities!(rows);

impl LogRow {
    /// A row with every signal absent.
    pub const ABSENT: Self = Self::from_values([f64::NAN; Signal::COUNT]);

    /// The row of a sample that was aligned from frames. It does not contain the values from which
    /// steer angle, suspension roll and mass of the sample were computed.
    pub fn of_sample(time_s: f64, sample: &Sample<f64>) -> Self {
        Self {
            time_s,
            steer_rad: sample.steer_rad,
            roll_rad: sample.roll_rad,
            roll_to_gravity_rad: sample.roll_to_gravity_rad,
            tilt_rad: sample.tilt_rad,
            suspension_roll_rad: sample.suspension_roll_rad,
            speed_mps: sample.speed_mps,
            lateral_acceleration_mps2: sample.lateral_acceleration_mps2,
            lateral_specific_force_mps2: sample.lateral_specific_force_mps2,
            tractor_suspension_roll_rad: sample.tractor_suspension_roll_rad,
            tractor_lateral_specific_force_mps2: sample.tractor_lateral_specific_force_mps2,
            tractor_tilt_rad: sample.tractor_tilt_rad,
            yaw_rate_radps: sample.yaw_rate_radps,
            trailer_mass_kg: sample.trailer_mass_kg,
            ..Self::ABSENT
        }
    }

    /// The sample for the estimator. Steer angle, suspension roll and mass come from whichever signal
    /// measures them.
    #[inline]
    pub fn sample(&self, time_us: u64, settings: &AlignSettings<f64>) -> Sample<f64> {
        let mut sample = settings.sample(time_us, |quantity| self.get(Signal::from(quantity)));
        if sample.suspension_roll_rad.is_nan() {
            sample.suspension_roll_rad = self.roll_to_gravity_rad - self.axle_roll_to_gravity_rad;
        }
        sample
    }

    /// The trailer mass, kg, with the quantity from which it follows, if there is one.
    pub fn weighed(&self, settings: &AlignSettings<f64>) -> Option<(Quantity, f64)> {
        settings.weighed(|quantity| self.get(Signal::from(quantity)))
    }
}

/// Signals that are needed on both sides.
const SIDES: [[Signal; 2]; 2] = [
    [Signal::LevelLeft, Signal::LevelRight],
    [Signal::TractorLevelLeft, Signal::TractorLevelRight],
];

/// Inputs of the roll angle, of which one is needed.
const INPUTS: &[Signal] =
    &[Signal::Steer, Signal::SteeringWheel, Signal::LateralAcceleration, Signal::YawRate];

/// Accelerations of the path, which give the specific force with a roll angle relative to gravity.
const PATHS: &[Signal] = &[Signal::LateralAcceleration, Signal::YawRate];

/// Inputs of a suspension roll beside a roll angle relative to gravity, of which one is needed.
const FORCES: &[Signal] =
    &[Signal::LateralSpecificForce, Signal::LateralAcceleration, Signal::YawRate];

impl Signal {
    /// What a log with these signals lacks for an estimate: signals of which one is needed; empty if
    /// it has a roll angle and an input that belong together.
    pub fn lacking(present: &[Self]) -> &'static [Self] {
        let has = |signals: &[Self]| signals.iter().any(|signal| present.contains(signal));
        for sides in &SIDES {
            if has(sides)
                && let Some(k) = (0..2).find(|&k| !has(&sides[k..=k]))
            {
                return &sides[k..=k];
            }
        }
        let by_gravity = has(&[Self::RollToGravity]);
        let suspension = has(&[Self::SuspensionRoll, Self::LevelLeft, Self::AxleTilt])
            || (by_gravity && has(&[Self::AxleRollToGravity]));
        let force = has(&[Self::LateralSpecificForce, Self::Tilt]);
        let trailer = suspension && (force || (by_gravity && has(PATHS)));
        let tractor =
            has(&[Self::TractorSuspensionRoll, Self::TractorLevelLeft, Self::TractorAxleTilt])
                && has(&[Self::TractorLateralSpecificForce, Self::TractorTilt]);
        if trailer || tractor {
            &[]
        } else if suspension && by_gravity {
            FORCES
        } else if !has(INPUTS) && !has(&[Self::LateralSpecificForce]) {
            INPUTS
        } else if !has(&[Self::Roll, Self::RollToGravity, Self::Tilt, Self::RollRate]) {
            &[Self::Roll, Self::Tilt]
        } else {
            &[]
        }
    }

    /// Number of signals.
    pub const COUNT: usize = 7 + Quantity::COUNT;

    /// The name without the unit, such as `roll`.
    pub const fn name(self) -> &'static str {
        match self.quantity() {
            Some(quantity) => quantity.name(),
            None => match self {
                Self::RollRate => "roll_rate",
                Self::AxleRollToGravity => "axle_roll_to_gravity",
                Self::TrailerMassSd => "trailer_mass_sd",
                Self::LiftAxle => "lift_axle",
                Self::YawRateOnTractor => "yaw_rate_on",
                Self::LateralAccelerationOnTractor => "lateral_acceleration_on",
                _ => "time",
            },
        }
    }

    /// The column name in SI units, such as `roll_rad`.
    pub const fn column(self) -> &'static str {
        match self.quantity() {
            Some(quantity) => quantity.column(),
            None => match self {
                Self::RollRate => "roll_rate_radps",
                Self::AxleRollToGravity => "axle_roll_to_gravity_rad",
                Self::TrailerMassSd => "trailer_mass_sd_kg",
                Self::LiftAxle => "lift_axle_raised",
                Self::YawRateOnTractor => "yaw_rate_on_tractor",
                Self::LateralAccelerationOnTractor => "lateral_acceleration_on_tractor",
                _ => "time_s",
            },
        }
    }

    /// The signal with this column name in SI units.
    pub fn of_column(column: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| signal.column() == column)
    }

    /// The meaning of the signal in one sentence.
    pub const fn meaning(self) -> &'static str {
        match self.quantity() {
            Some(quantity) => quantity.meaning(),
            None => match self {
                Self::RollRate => {
                    "Roll rate of the trailer's sprung mass (a gyroscope on its body), positive if the \
                     right side moves down."
                }
                Self::AxleRollToGravity => {
                    "Roll angle of an axle of the trailer to gravity, positive right side down."
                }
                Self::TrailerMassSd => "Standard deviation of the trailer mass.",
                Self::LiftAxle => "Position of the trailer's lift axles: 0 down, 1 raised.",
                Self::YawRateOnTractor => {
                    "Whether the yaw rate is that of the tractor: 0 no, 1 yes."
                }
                Self::LateralAccelerationOnTractor => {
                    "Whether the lateral acceleration is that of the tractor's path: 0 no, 1 yes."
                }
                _ => "Time stamp from any origin, strictly increasing.",
            },
        }
    }

    const fn dimension(self) -> Dimension {
        match self.quantity() {
            Some(quantity) => quantity.dimension(),
            None => match self {
                Self::RollRate => Dimension::AngularRate,
                Self::AxleRollToGravity => Dimension::Angle,
                Self::TrailerMassSd => Dimension::Mass,
                Self::LiftAxle => Dimension::Position,
                Self::YawRateOnTractor | Self::LateralAccelerationOnTractor => Dimension::Place,
                _ => Dimension::Time,
            },
        }
    }

    /// Whether the sign depends on how the sensor is mounted.
    pub fn is_directed(self) -> bool {
        matches!(self, Self::RollRate | Self::AxleRollToGravity)
            || self.quantity().is_some_and(Quantity::is_directed)
    }

    /// Whether it is the state of a part, and no number.
    pub(super) fn is_state(self) -> bool {
        matches!(self, Self::LiftAxle | Self::YawRateOnTractor | Self::LateralAccelerationOnTractor)
    }

    /// The SI unit of this signal.
    pub(super) const fn si(self) -> Unit {
        self.dimension().si()
    }

    /// The unit with this suffix; `None` if it is not a unit of this signal.
    pub(super) fn unit(self, suffix: &str) -> Option<Unit> {
        self.dimension().unit(suffix)
    }

    /// The unit with this suffix or spelling, such as `km/h`, in upper or lower case.
    pub(super) fn spelled(self, text: &str) -> Option<Unit> {
        self.dimension().spelled(text)
    }

    /// Whether any signal has a unit with this suffix or spelling.
    pub(super) fn any_spells(text: &str) -> bool {
        Self::ALL.into_iter().any(|signal| signal.spelled(text).is_some())
    }

    /// The units for messages, such as "rad, deg".
    pub(super) fn unit_names(self) -> String {
        self.dimension().units().iter().map(|unit| unit.suffix).collect::<Vec<_>>().join(", ")
    }

    /// The unit that messages suggest: the most common one in logs of other programs.
    pub(super) fn usual_unit(self) -> &'static str {
        let units = self.dimension().units();
        let place = usize::from(self != Self::Time && units.len() > 1);
        units[place].suffix
    }

    /// Whether any signal has a unit with this suffix.
    pub(super) fn any_has_unit(suffix: &str) -> bool {
        Self::ALL.into_iter().any(|signal| signal.unit(suffix).is_some())
    }
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The error for a text that is not the name of a signal.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{}` is not a signal; the signals are {}",
    .text.escape_debug(),
    Signal::ALL.map(Signal::name).join(", ")
)]
pub struct UnknownSignal {
    text: Box<str>,
}

impl FromStr for Signal {
    type Err = UnknownSignal;

    fn from_str(text: &str) -> Result<Self, UnknownSignal> {
        let known = Self::ALL.into_iter().find(|signal| signal.name() == text);
        known.ok_or_else(|| UnknownSignal { text: text.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_signal_stands_at_its_own_place_in_the_row() {
        let mut value = 0.0;
        let values = [(); Signal::COUNT].map(|()| {
            value += 1.0;
            value
        });
        let row = LogRow::from_values(values);
        for (signal, value) in Signal::ALL.into_iter().zip(values) {
            assert_eq!(row.get(signal).to_bits(), value.to_bits(), "{signal}");
        }
    }

    #[test]
    fn every_column_name_is_the_signal_and_its_si_unit() {
        for (index, signal) in Signal::ALL.into_iter().enumerate() {
            assert_eq!(signal as usize, index);
            assert_eq!(signal.column(), format!("{}_{}", signal.name(), signal.si().suffix));
            assert_eq!(signal.name().parse::<Signal>().unwrap(), signal);
        }
    }

    /// A roll angle and an input of one unit are enough; levels are needed on both sides.
    #[test]
    fn a_log_needs_a_roll_angle_and_an_input_that_belong_together() {
        use Signal::{
            AxleTilt, LateralSpecificForce, LevelLeft, LevelRight, Roll, RollToGravity, Speed,
            Steer, SuspensionRoll, Tilt, TractorLateralSpecificForce, TractorSuspensionRoll,
        };
        for enough in [
            &[Steer, Roll][..],
            &[Steer, RollToGravity],
            &[LateralSpecificForce, RollToGravity],
            &[SuspensionRoll, LateralSpecificForce],
            &[LevelLeft, LevelRight, LateralSpecificForce],
            &[Tilt, AxleTilt],
            &[TractorSuspensionRoll, TractorLateralSpecificForce],
        ] {
            assert_eq!(Signal::lacking(enough), &[], "{enough:?}");
        }
        for (signals, first) in [
            (&[Roll, Speed][..], Steer),
            (&[Steer, Speed], Roll),
            (&[SuspensionRoll, TractorLateralSpecificForce], Steer),
            (&[LevelLeft, LateralSpecificForce, Steer, Roll], LevelRight),
        ] {
            assert_eq!(Signal::lacking(signals).first(), Some(&first), "{signals:?}");
        }
    }
}
