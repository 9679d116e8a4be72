//! The signals of a log, the units they may come in, and one row of them.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use cg_core::{AlignSettings, Quantity, Sample};

use super::OptionError;

/// One row of a log in SI units, ISO 8855 signs; absent signals are NaN.
///
/// Axes: x forward, y left, z up. A left turn gives all angles and rates positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogRow {
    /// Time stamp from any origin, strictly increasing; never NaN in a row that was read.
    pub time_s: f64,
    /// Mean road-wheel angle of the steered axle, positive to the left.
    pub steer_rad: f64,
    /// Steering-wheel angle, positive to the left.
    pub steering_wheel_rad: f64,
    /// Roll angle of the trailer's sprung mass to the road, positive right side down.
    pub roll_rad: f64,
    /// What an accelerometer inclinometer shows: roll plus lateral acceleration over g.
    pub tilt_rad: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// Lateral acceleration of the trailer's sprung mass, positive to the left.
    pub lateral_acceleration_mps2: f64,
    /// Trailer yaw rate, positive to the left.
    pub yaw_rate_radps: f64,
    /// Mass of the whole semitrailer as weighed (sprung mass and axles).
    pub trailer_mass_kg: f64,
    /// Load of the trailer's axles on the road; stands in for an absent mass.
    pub trailer_axle_load_kg: f64,
    /// Pressure in the trailer's air suspension, mean of both sides; stands in for both.
    pub trailer_suspension_pressure_pa: f64,
}

impl LogRow {
    /// A row with every signal absent.
    pub const ABSENT: Self = Self::from_values([f64::NAN; Signal::COUNT]);

    /// The value of one signal, in its SI unit.
    pub const fn get(&self, signal: Signal) -> f64 {
        match signal {
            Signal::Time => self.time_s,
            Signal::Steer => self.steer_rad,
            Signal::SteeringWheel => self.steering_wheel_rad,
            Signal::Roll => self.roll_rad,
            Signal::Tilt => self.tilt_rad,
            Signal::Speed => self.speed_mps,
            Signal::LateralAcceleration => self.lateral_acceleration_mps2,
            Signal::YawRate => self.yaw_rate_radps,
            Signal::TrailerMass => self.trailer_mass_kg,
            Signal::TrailerAxleLoad => self.trailer_axle_load_kg,
            Signal::TrailerSuspensionPressure => self.trailer_suspension_pressure_pa,
        }
    }

    /// The same for an estimator: steer angle and mass of whatever measures them.
    pub fn sample(&self, time_us: u64, settings: &AlignSettings<f64>) -> Sample<f64> {
        Sample {
            time_us,
            steer_rad: settings.steer_rad(self.steer_rad, self.steering_wheel_rad),
            roll_rad: self.roll_rad,
            tilt_rad: self.tilt_rad,
            speed_mps: self.speed_mps,
            lateral_acceleration_mps2: self.lateral_acceleration_mps2,
            yaw_rate_radps: self.yaw_rate_radps,
            trailer_mass_kg: settings.trailer_mass_kg(
                self.trailer_mass_kg,
                self.trailer_axle_load_kg,
                self.trailer_suspension_pressure_pa,
            ),
        }
    }

    /// The row whose values stand in the order of [`Signal::ALL`].
    pub(super) const fn from_values(values: [f64; Signal::COUNT]) -> Self {
        let [
            time_s,
            steer_rad,
            steering_wheel_rad,
            roll_rad,
            tilt_rad,
            speed_mps,
            lateral_acceleration_mps2,
            yaw_rate_radps,
            trailer_mass_kg,
            trailer_axle_load_kg,
            trailer_suspension_pressure_pa,
        ] = values;
        Self {
            time_s,
            steer_rad,
            steering_wheel_rad,
            roll_rad,
            tilt_rad,
            speed_mps,
            lateral_acceleration_mps2,
            yaw_rate_radps,
            trailer_mass_kg,
            trailer_axle_load_kg,
            trailer_suspension_pressure_pa,
        }
    }
}

/// A signal of a log. Its text form is the column name without the unit: `roll`, `yaw_rate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Signal {
    /// `time_s`; required.
    Time,
    /// `steer_rad`; this or another input is required.
    Steer,
    /// `steering_wheel_rad`; an input.
    SteeringWheel,
    /// `roll_rad`; this or tilt is required.
    Roll,
    /// `tilt_rad`; this or roll is required.
    Tilt,
    /// `speed_mps`.
    Speed,
    /// `lateral_acceleration_mps2`; an input.
    LateralAcceleration,
    /// `yaw_rate_radps`; an input.
    YawRate,
    /// `trailer_mass_kg`.
    TrailerMass,
    /// `trailer_axle_load_kg`.
    TrailerAxleLoad,
    /// `trailer_suspension_pressure_pa`.
    TrailerSuspensionPressure,
}

impl Signal {
    pub(super) const COUNT: usize = 11;

    /// Every signal, in the order of the fields of [`LogRow`].
    pub const ALL: [Self; Self::COUNT] = [
        Self::Time,
        Self::Steer,
        Self::SteeringWheel,
        Self::Roll,
        Self::Tilt,
        Self::Speed,
        Self::LateralAcceleration,
        Self::YawRate,
        Self::TrailerMass,
        Self::TrailerAxleLoad,
        Self::TrailerSuspensionPressure,
    ];

    /// The name without a unit: `roll`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Steer => "steer",
            Self::SteeringWheel => "steering_wheel",
            Self::Roll => "roll",
            Self::Tilt => "tilt",
            Self::Speed => "speed",
            Self::LateralAcceleration => "lateral_acceleration",
            Self::YawRate => "yaw_rate",
            Self::TrailerMass => "trailer_mass",
            Self::TrailerAxleLoad => "trailer_axle_load",
            Self::TrailerSuspensionPressure => "trailer_suspension_pressure",
        }
    }

    /// The column name in SI: `roll_rad`.
    pub const fn column(self) -> &'static str {
        match self {
            Self::Time => "time_s",
            Self::Steer => "steer_rad",
            Self::SteeringWheel => "steering_wheel_rad",
            Self::Roll => "roll_rad",
            Self::Tilt => "tilt_rad",
            Self::Speed => "speed_mps",
            Self::LateralAcceleration => "lateral_acceleration_mps2",
            Self::YawRate => "yaw_rate_radps",
            Self::TrailerMass => "trailer_mass_kg",
            Self::TrailerAxleLoad => "trailer_axle_load_kg",
            Self::TrailerSuspensionPressure => "trailer_suspension_pressure_pa",
        }
    }

    /// The units a column of this signal may come in, the SI unit first.
    pub(super) const fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => &[Unit::S, Unit::MS, Unit::US],
            Self::Steer | Self::SteeringWheel | Self::Roll | Self::Tilt => &[Unit::RAD, Unit::DEG],
            Self::Speed => &[Unit::MPS, Unit::KMH],
            Self::LateralAcceleration => &[Unit::MPS2, Unit::G],
            Self::YawRate => &[Unit::RADPS, Unit::DEGPS],
            Self::TrailerMass | Self::TrailerAxleLoad => &[Unit::KG, Unit::T],
            Self::TrailerSuspensionPressure => &[Unit::PA, Unit::KPA, Unit::BAR],
        }
    }

    /// The SI unit of this signal.
    pub(super) const fn si(self) -> Unit {
        self.units()[0]
    }

    /// The unit of this name, if this signal may come in it.
    pub(super) fn unit(self, name: &str) -> Option<Unit> {
        self.units().iter().copied().find(|unit| unit.name == name)
    }

    /// "rad, deg": for messages.
    pub(super) fn unit_names(self) -> String {
        self.units().iter().map(|unit| unit.name).collect::<Vec<_>>().join(", ")
    }

    /// The unit a proposal in a message shows: the one foreign logs mostly use.
    pub(super) fn usual_unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            _ => self.units()[1].name,
        }
    }
}

/// What a sensor measures is a signal of a log too.
impl From<Quantity> for Signal {
    fn from(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Steer => Self::Steer,
            Quantity::SteeringWheel => Self::SteeringWheel,
            Quantity::Roll => Self::Roll,
            Quantity::Tilt => Self::Tilt,
            Quantity::Speed => Self::Speed,
            Quantity::LateralAcceleration => Self::LateralAcceleration,
            Quantity::YawRate => Self::YawRate,
            Quantity::TrailerMass => Self::TrailerMass,
            Quantity::TrailerAxleLoad => Self::TrailerAxleLoad,
            Quantity::TrailerSuspensionPressure => Self::TrailerSuspensionPressure,
        }
    }
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Signal {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        Self::ALL
            .into_iter()
            .find(|signal| signal.name() == text)
            .ok_or_else(|| OptionError::UnknownSignal { text: text.into() })
    }
}

/// A unit and the way to SI: `SI = value * times / per`, which is exact for SI itself
/// and rounds once for the decimal units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    pub(super) name: &'static str,
    pub(super) times: f64,
    pub(super) per: f64,
}

impl Unit {
    const S: Self = Self::new("s", 1.0, 1.0);
    const MS: Self = Self::new("ms", 1.0, 1e3);
    const US: Self = Self::new("us", 1.0, 1e6);
    const RAD: Self = Self::new("rad", 1.0, 1.0);
    const DEG: Self = Self::new("deg", PI / 180.0, 1.0);
    const MPS: Self = Self::new("mps", 1.0, 1.0);
    const KMH: Self = Self::new("kmh", 1.0, 3.6);
    const MPS2: Self = Self::new("mps2", 1.0, 1.0);
    /// Standard gravity, exact by definition (CGPM 1901).
    const G: Self = Self::new("g", 9.806_65, 1.0);
    const RADPS: Self = Self::new("radps", 1.0, 1.0);
    const DEGPS: Self = Self::new("degps", PI / 180.0, 1.0);
    const KG: Self = Self::new("kg", 1.0, 1.0);
    const T: Self = Self::new("t", 1e3, 1.0);
    const PA: Self = Self::new("pa", 1.0, 1.0);
    const KPA: Self = Self::new("kpa", 1e3, 1.0);
    const BAR: Self = Self::new("bar", 1e5, 1.0);

    const fn new(name: &'static str, times: f64, per: f64) -> Self {
        Self { name, times, per }
    }

    /// Whether this is the name of some unit, of whatever signal.
    pub(super) fn is_known(name: &str) -> bool {
        Signal::ALL.into_iter().any(|signal| signal.unit(name).is_some())
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
            assert_eq!(signal.column(), format!("{}_{}", signal.name(), signal.si().name));
            assert_eq!(signal.name().parse::<Signal>().unwrap(), signal);
        }
    }
}
