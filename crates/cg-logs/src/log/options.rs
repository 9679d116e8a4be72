//! Options for reading a log: column names of other programs, reversed signs, CAN signals.

use std::str::FromStr;

use cg_core::signal::j1939::Compensation;
use cg_core::{AlignSettings, Unit};

use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Variant, Vehicle, VehicleError};

use crate::can::{Decoder, DeviceFilter, MappedSignal, Vdc2};

use super::signal::{Signal, UnknownSignal};

/// How to read a log that differs from the format of this project.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogOptions {
    /// Columns with other names, at most one for each signal. A signal listed here is read from
    /// this column only; other columns with the same signal are ignored.
    pub columns: Vec<ColumnMap>,
    /// Signals whose sign is reversed, because the sensor is mounted the other way round.
    pub flip: Vec<Signal>,
    /// How to read a CAN log.
    pub can: CanOptions,
    /// The sensor settings of the truck, from
    /// [`Vehicle::align_settings`](cg_vehicle::Vehicle::align_settings). With them, values that the
    /// truck [cannot have](AlignSettings::believes) are absent, and the steer angle of a CAN log is
    /// known. Without them, the values of a table are used unchanged.
    pub settings: Option<AlignSettings<f64>>,
    /// The same with the lift axles raised, if frames may say that they are.
    pub raised: Option<AlignSettings<f64>>,
}

impl LogOptions {
    /// The same for the logs of a vehicle whose lift axles are in a given position, or where the log says.
    ///
    /// # Errors
    /// As [`Vehicle::in_positions`].
    pub fn of_vehicle(
        self,
        vehicle: &Vehicle,
        given: Option<LiftAxle>,
        variant: Variant,
    ) -> Result<Self, VehicleError> {
        let (present, raised) = vehicle.in_positions(given, variant)?;
        let raised = raised.map(|raised| raised.align_settings());
        Ok(Self { settings: Some(present.align_settings()), raised, ..self })
    }

    /// The decoder for the frames of a log.
    pub fn decoder(&self) -> Decoder {
        let flipped = self.flip.iter().filter_map(|signal| signal.quantity()).collect();
        Decoder::new(self.can.mapped.clone(), self.can.filters.clone(), flipped)
            .with_compensation(self.can.compensation)
            .with_vdc2(self.can.vdc2)
    }
}

/// How to decode CAN frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CanOptions {
    /// Signals of a DBC file that are used instead of the J1939 signals.
    pub mapped: Vec<MappedSignal>,
    /// Quantities that are accepted from one source address only.
    pub filters: Vec<DeviceFilter>,
    /// Whether the angle of slope sensors counts as roll or as tilt.
    pub compensation: Compensation,
    /// What the lateral acceleration of VDC2 is.
    pub vdc2: Vdc2,
    /// The bus whose frames are used; `None` uses all buses.
    pub bus: Option<String>,
}

/// The column for a signal, as text `roll=MyName[deg]`.
///
/// The `[unit]` is optional. Without it, the unit is the suffix of the name if that is a unit of
/// the signal (`roll=Gyro_deg` is in degrees), otherwise that which the file gives (in brackets after
/// the name, or in a row of units below it), and otherwise the SI unit of the signal (`roll=Gyro`
/// is in radians). If the suffix is a unit of another signal (`roll=Gyro_kmh`), the `[unit]` is
/// required.
///
/// If the name of a column ends in a bracket, it may be written as it is: `roll=Roll [deg]` selects
/// the column `Roll` or, if there is none, the column `Roll [deg]`.
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
    /// Whether the unit is given, by `[unit]` or the suffix, and not the SI unit for lack of one.
    unit_is_given: bool,
}

impl ColumnMap {
    /// The column `name` for `signal`, with values in `unit` (`deg`, `kmh`, …).
    ///
    /// # Errors
    ///
    /// The name is empty, or the unit is not a unit of the signal.
    pub fn new(signal: Signal, name: &str, unit: &str) -> Result<Self, OptionError> {
        let name = name.trim();
        if name.is_empty() {
            return Err(OptionError::Shape { text: format!("{signal}={name}[{unit}]").into() });
        }
        let unit = signal.spelled(unit).ok_or_else(|| OptionError::UnknownUnit {
            signal,
            unit: unit.into(),
            accepted: signal.unit_names().into(),
        })?;
        Ok(Self { signal, name: name.into(), written: name.into(), unit, unit_is_given: true })
    }

    /// The signal.
    pub const fn signal(&self) -> Signal {
        self.signal
    }

    /// The name of the column.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The unit of the column, such as `deg`.
    pub const fn unit(&self) -> &'static str {
        self.unit.suffix
    }

    /// The text after the `=`, for a column whose name ends in a bracket.
    pub(super) fn written(&self) -> &str {
        &self.written
    }

    pub(super) const fn factor(&self) -> Unit {
        self.unit
    }

    pub(super) const fn unit_is_given(&self) -> bool {
        self.unit_is_given
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
        let of_name = || unit_of_name(signal, written);
        let (name, unit) = match bracket {
            Some((name, unit)) => (name.trim(), Some(unit.trim())),
            None => (written, of_name()?),
        };
        if name.is_empty() {
            return Err(shape());
        }
        let map = Self::new(signal, name, unit.unwrap_or(signal.si().suffix))?;
        Ok(Self { written: written.into(), unit_is_given: unit.is_some(), ..map })
    }
}

/// The unit that is the suffix of a name without brackets, if there is one.
fn unit_of_name(signal: Signal, name: &str) -> Result<Option<&str>, OptionError> {
    match name.rsplit_once('_') {
        Some((_, suffix)) if signal.unit(suffix).is_some() => Ok(Some(suffix)),
        Some((_, suffix)) if Signal::any_has_unit(suffix) => {
            Err(OptionError::ForeignUnit { signal, name: name.into(), suffix: suffix.into() })
        }
        _ => Ok(None),
    }
}

/// The reason why an option is not valid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// The name of the signal is unknown.
    #[error(transparent)]
    UnknownSignal(#[from] UnknownSignal),
    /// The text does not have the form `signal=name[unit]`.
    #[error("`{}` is not of the form SIGNAL=NAME[UNIT] (roll=Gyro[deg])", .text.escape_debug())]
    Shape {
        /// The given text.
        text: Box<str>,
    },
    /// The unit is not a unit of the signal.
    #[error("`{}` is not a unit of {signal}; the units are {accepted}", .unit.escape_debug())]
    UnknownUnit {
        /// The signal.
        signal: Signal,
        /// The given unit.
        unit: Box<str>,
        /// The units of the signal.
        accepted: Box<str>,
    },
    /// The name ends in a unit of another signal, and there is no `[unit]`.
    #[error(
        "the name `{}` ends in `{suffix}`, which is not a unit of {signal}; \
         give the unit: {signal}={name}[{}]", .name.escape_debug(), .signal.si().suffix
    )]
    ForeignUnit {
        /// The signal.
        signal: Signal,
        /// The name of the column.
        name: Box<str>,
        /// Its suffix.
        suffix: Box<str>,
    },
}
