//! Foreign column names and flipped sensors.

use std::str::FromStr;

use cg_core::signal::j1939::Compensation;
use cg_core::{AlignSettings, Unit};

use crate::can::{Decoder, DeviceFilter, MappedSignal};

use super::signal::{Signal, UnknownSignal};

/// How a log differs from the format of this project.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogOptions {
    /// Foreign names, one for each signal at most. A signal named here is read from that
    /// column alone: other columns of the same signal in the file are ignored.
    pub columns: Vec<ColumnMap>,
    /// Sensors mounted the other way round: their values change sign.
    pub flip: Vec<Signal>,
    /// How a CAN log is read.
    pub can: CanOptions,
    /// What the truck's sensors mean, of
    /// [`Vehicle::align_settings`](cg_vehicle::Vehicle::align_settings): values that it
    /// [cannot have](AlignSettings::believes) are absent then, and a CAN log has its steer angle.
    /// Without it the values of a table are read as they stand.
    pub settings: Option<AlignSettings<f64>>,
}

impl LogOptions {
    /// How the frames of a log are understood.
    pub fn decoder(&self) -> Decoder {
        let flipped = self.flip.iter().filter_map(|signal| signal.quantity()).collect();
        Decoder::new(self.can.mapped.clone(), self.can.filters.clone(), flipped)
            .with_compensation(self.can.compensation)
    }
}

/// How frames become signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CanOptions {
    /// Signals of a DBC file, in place of J1939's.
    pub mapped: Vec<MappedSignal>,
    /// Quantities that are taken from one source address only.
    pub filters: Vec<DeviceFilter>,
    /// Whether slope sensors measure roll or tilt.
    pub compensation: Compensation,
    /// The only bus of the log that is listened to.
    pub bus: Option<String>,
}

/// One foreign column, in text form `roll=MyName[deg]`.
///
/// The `[unit]` may be left out. Then the unit is the suffix of the foreign name if that
/// is a unit of the signal (`roll=Gyro_deg` is in degrees), else the SI unit of the signal
/// (`roll=Gyro` is in radians). A suffix that is a unit of something else
/// (`roll=Gyro_kmh`) needs the `[unit]`.
///
/// A column whose own name ends in a bracket may be written as it is: `roll=Roll [deg]`
/// finds the column `Roll`, or else the column `Roll [deg]`.
///
/// # Example
///
/// ```
/// use cg_logs::log::{ColumnMap, Signal};
///
/// let map: ColumnMap = "roll=Gyro X[deg]".parse()?;
/// assert_eq!((map.signal(), map.name(), map.unit()), (Signal::Roll, "Gyro X", "deg"));
/// assert!("roll=Gyro X[kmh]".parse::<ColumnMap>().is_err());
/// # Ok::<(), cg_logs::log::OptionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    signal: Signal,
    name: Box<str>,
    written: Box<str>,
    unit: Unit,
}

impl ColumnMap {
    /// Reads `signal` from the column `name`, whose values are in `unit` (`deg`, `kmh`, …).
    ///
    /// # Errors
    ///
    /// The unit is not one of the signal, or the name is empty.
    pub fn new(signal: Signal, name: &str, unit: &str) -> Result<Self, OptionError> {
        let name = name.trim();
        if name.is_empty() {
            return Err(OptionError::Shape { text: format!("{signal}={name}[{unit}]").into() });
        }
        let unit = signal.unit(unit).ok_or_else(|| OptionError::UnknownUnit {
            signal,
            unit: unit.into(),
            accepted: signal.unit_names().into(),
        })?;
        Ok(Self { signal, name: name.into(), written: name.into(), unit })
    }

    /// The signal that is read.
    pub const fn signal(&self) -> Signal {
        self.signal
    }

    /// The name of the column it is read from.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The unit of that column: `deg`.
    pub const fn unit(&self) -> &'static str {
        self.unit.suffix
    }

    /// Everything after the `=`, for a column whose own name ends in a bracket.
    pub(super) fn written(&self) -> &str {
        &self.written
    }

    pub(super) const fn factor(&self) -> Unit {
        self.unit
    }
}

impl FromStr for ColumnMap {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let shape = || OptionError::Shape { text: text.into() };
        let (signal, written) = text.split_once('=').ok_or_else(shape)?;
        let signal: Signal = signal.trim().parse()?;
        let written = written.trim();
        let bracket = written.strip_suffix(']').and_then(|head| head.rsplit_once('['));
        let (name, unit) = match bracket {
            Some((name, unit)) => (name.trim(), unit.trim()),
            None => (written, unit_of_name(signal, written)?),
        };
        if name.is_empty() {
            return Err(shape());
        }
        Ok(Self { written: written.into(), ..Self::new(signal, name, unit)? })
    }
}

/// The unit meant by a foreign name without brackets.
fn unit_of_name(signal: Signal, name: &str) -> Result<&str, OptionError> {
    match name.rsplit_once('_') {
        Some((_, suffix)) if signal.unit(suffix).is_some() => Ok(suffix),
        Some((_, suffix)) if Signal::any_has_unit(suffix) => {
            Err(OptionError::ForeignUnit { signal, name: name.into(), suffix: suffix.into() })
        }
        _ => Ok(signal.si().suffix),
    }
}

/// Why an option was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// Not the name of a signal.
    #[error(transparent)]
    UnknownSignal(#[from] UnknownSignal),
    /// Not of the form `signal=name[unit]`.
    #[error("`{}` names no column; write it as roll=NAME[deg]", .text.escape_debug())]
    Shape {
        /// What was given.
        text: Box<str>,
    },
    /// A unit the signal cannot have.
    #[error("`{}` is no unit of {signal}; the units are {accepted}", .unit.escape_debug())]
    UnknownUnit {
        /// The signal.
        signal: Signal,
        /// What was given.
        unit: Box<str>,
        /// The units of that signal.
        accepted: Box<str>,
    },
    /// The name ends in a unit the signal cannot have, and no `[unit]` says otherwise.
    #[error(
        "the name `{}` ends in `{suffix}`, which is no unit of {signal}; \
         say the unit: {signal}={name}[{}]", .name.escape_debug(), .signal.si().suffix
    )]
    ForeignUnit {
        /// The signal.
        signal: Signal,
        /// The foreign name.
        name: Box<str>,
        /// Its suffix.
        suffix: Box<str>,
    },
}
