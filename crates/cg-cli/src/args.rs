//! Arguments that several commands share.

use anyhow::bail;
use cg_logs::estimate::{EstimateOptions, Method};
use cg_logs::log::{ColumnMap, LogOptions, Signal};
use cg_vehicle::{Load, Vehicle};
use clap::{Args, ValueEnum};

use crate::numbers::{height_m, order, payload_kg, trailer_mass_kg};
use crate::words::word;

/// How to read the columns of logs.
#[derive(Debug, Args)]
pub(crate) struct ColumnArgs {
    /// Read a signal from a column with another name, such as `roll=MyName[deg]`; may be repeated
    #[arg(long, value_name = "SIGNAL=NAME[UNIT]")]
    column: Vec<ColumnMap>,
    /// Reverse the sign of sensors that are mounted the other way round, such as `roll,steer`
    #[arg(long, value_name = "SIGNALS", value_delimiter = ',')]
    flip: Vec<Signal>,
}

impl ColumnArgs {
    pub(crate) fn options(&self) -> LogOptions {
        let (columns, flip) = (self.column.clone(), self.flip.clone());
        LogOptions { columns, flip, ..LogOptions::default() }
    }

    /// Whether any of them is given.
    pub(crate) fn is_given(&self) -> bool {
        !self.column.is_empty() || !self.flip.is_empty()
    }

    /// Refuses these options where they do not apply to CAN frames that are read with `options`, and there is nothing
    /// else.
    pub(crate) fn refuse_for_frames(&self, options: &LogOptions) -> anyhow::Result<()> {
        if !self.column.is_empty() {
            bail!(
                "--column is for columns, but CAN frames have none; remove it, or map a signal of a DBC file with --dbc \
                 and --signal"
            );
        }
        let decoder = options.decoder();
        let may_come = |signal: Signal| signal.quantity().is_some_and(|one| decoder.may_give(one));
        match self.flip.iter().find(|signal| !may_come(**signal)) {
            Some(signal) => bail!(
                "--flip {signal}: no CAN frame gives this signal; remove it, or map the signal with --dbc and --signal"
            ),
            None => Ok(()),
        }
    }
}

/// How the DC ratio is identified.
#[derive(Debug, Args)]
pub(crate) struct MethodArgs {
    /// Method by which the DC ratio is identified
    #[arg(long, value_parser = word::<Method>(), default_value_t = Method::Filtered)]
    pub(crate) method: Method,
    /// Order of the classical ARX (for --method arx) [default: 5]
    #[arg(long, value_name = "N", value_parser = order)]
    order: Option<usize>,
}

impl MethodArgs {
    /// The order, which only the classical ARX has.
    pub(crate) fn order(&self) -> anyhow::Result<usize> {
        match self.order {
            Some(order) if self.method != Method::Arx => bail!(
                "--order {order}: the method \"{}\" has no order to choose; give --method arx too, or remove \
                 --order",
                self.method
            ),
            order => Ok(order.unwrap_or_else(|| EstimateOptions::default().order)),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct LoadArgs {
    /// Height of the c.g. of the trailer's sprung mass, m [default: from the vehicle file, that of the empty trailer
    /// without a payload]
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = height_m)]
    pub(crate) height_m: Option<f64>,
    /// Mass of the whole semitrailer, kg [default: from the vehicle file]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = trailer_mass_kg, conflicts_with = "payload_kg")]
    pub(crate) trailer_mass_kg: Option<f64>,
    /// Payload, kg; can be given instead of the mass of the whole semitrailer
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = payload_kg)]
    pub(crate) payload_kg: Option<f64>,
}

impl LoadArgs {
    pub(crate) fn load(&self, vehicle: &Vehicle) -> Load {
        let payload = self.payload_kg.map(|payload| vehicle.empty_trailer_mass_kg() + payload);
        vehicle.load_of(self.trailer_mass_kg.or(payload), self.height_m)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Table,
    Json,
    Csv,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModelFormat {
    Table,
    Json,
}
