//! Arguments for reading CAN frames, shared by all commands that read them.

use std::path::PathBuf;

use anyhow::anyhow;
use cg_core::signal::j1939::Compensation;
use cg_logs::can::{DeviceFilter, MappedSignal, SignalMap, Vdc2};
use cg_logs::log::{CanOptions, LogOptions};
use cg_vehicle::{Variant, Vehicle};
use clap::Args;

use crate::args::ColumnArgs;
use crate::truck::LiftArgs;
use crate::words::word;

/// How to decode CAN frames.
#[derive(Debug, Args)]
#[command(next_help_heading = "CAN frames")]
pub(crate) struct CanArgs {
    /// DBC file with signals that are not part of J1939
    #[arg(long, value_name = "FILE", requires = "signal")]
    pub(crate) dbc: Option<PathBuf>,
    /// Read a quantity from a signal of the DBC file instead of J1939; unit, factor and offset may
    /// follow, as in `roll=TILT.Angle[deg]*-1+0.3`; may be repeated
    #[arg(long, value_name = "QUANTITY=MESSAGE.SIGNAL", requires = "dbc")]
    signal: Vec<SignalMap>,
    /// Accept a quantity from one source address only, such as `roll=0xE4`; may be repeated
    #[arg(long, value_name = "QUANTITY=ADDRESS")]
    source_of: Vec<DeviceFilter>,
    /// Whether a J1939 slope sensor (SSI, SSI2) compensates its angle for the vehicle's
    /// accelerations; a compensated angle is a roll angle, an uncompensated one a tilt
    #[arg(long, value_name = "WORD", value_parser = word::<Compensation>(), default_value_t = Compensation::Bits)]
    roll_compensated: Compensation,
    /// What the lateral acceleration of VDC2 is; one without gravity tells no height on banked roads
    #[arg(long, value_name = "WORD", value_parser = word::<Vdc2>(), default_value_t = Vdc2::SpecificForce)]
    vdc2: Vdc2,
    /// Use only this bus of a log with several buses [default: each signal from the bus on which it
    /// appears first]
    #[arg(long, value_name = "NAME")]
    pub(crate) bus: Option<String>,
}

impl CanArgs {
    fn options(&self) -> anyhow::Result<CanOptions> {
        let mapped = match &self.dbc {
            Some(path) => MappedSignal::load(path, &self.signal)?,
            None => Vec::new(),
        };
        Ok(CanOptions {
            mapped,
            filters: self.source_of.clone(),
            compensation: self.roll_compensated,
            vdc2: self.vdc2,
            bus: self.bus.clone(),
        })
    }

    /// The options for reading logs of this vehicle, CSV or CAN frames.
    pub(crate) fn log_options(
        &self,
        columns: &ColumnArgs,
        (vehicle, lift, variant): (&Vehicle, LiftArgs, Variant),
    ) -> anyhow::Result<LogOptions> {
        let options = LogOptions { can: self.options()?, ..columns.options() };
        Ok(options.of_vehicle(vehicle, lift.lift_axle, variant)?)
    }

    /// Refuses these options where there are no CAN frames. `why` says so, and what to do.
    pub(crate) fn refuse(&self, why: &str) -> anyhow::Result<()> {
        let given = [
            ("--dbc", self.dbc.is_some()),
            ("--source-of", !self.source_of.is_empty()),
            ("--roll-compensated", self.roll_compensated != Compensation::Bits),
            ("--vdc2", self.vdc2 != Vdc2::SpecificForce),
            ("--bus", self.bus.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((flag, _)) => Err(anyhow!("{flag} is for CAN frames, but {why}")),
            None => Ok(()),
        }
    }
}
