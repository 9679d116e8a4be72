//! Arguments of `cg run`.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};

use crate::args::{ColumnArgs, MethodArgs};
use crate::can::CanArgs;
use crate::numbers::{not_negative, payload_kg, share_of_threshold, trailer_mass_kg};
use crate::truck::{RoadArgs, TruckArgs};

use super::serve::address::Address;

/// Source of the signals, truck, and outputs.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("source").required(true)))]
pub(crate) struct RunArgs {
    /// Read from this CAN interface (J1939, and the signals of --dbc); on Linux only
    #[arg(long, group = "source", value_name = "IFACE", value_parser = interface)]
    pub(crate) can: Option<String>,
    /// Replay a candump log with time stamps (`candump -L`, -l, -ta, -td or -tz); `-` reads
    /// standard input
    #[arg(long, group = "source", value_name = "FILE")]
    pub(crate) candump: Option<PathBuf>,
    /// Replay a CSV log; `-` reads standard input
    #[arg(long, group = "source", value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Replay a file at the recorded speed, without pauses of ten minutes and more, instead of as fast as
    /// possible; what comes through a pipe is live, and if it stops coming, warnings end
    #[arg(long, conflicts_with = "can")]
    pub(crate) realtime: bool,
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    #[command(flatten)]
    pub(crate) road: RoadArgs,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// Mass of the whole semitrailer, kg; replaces the mass from the bus
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = trailer_mass_kg)]
    pub(crate) trailer_mass_kg: Option<f64>,
    /// Standard deviation of the trailer mass, kg; without it that of its source ([sensors.mass] of the
    /// vehicle file), and a trailer without a mass has any load
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = payload_kg)]
    pub(crate) trailer_mass_sd_kg: Option<f64>,
    #[command(flatten)]
    pub(crate) frames: CanArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Keep the estimator's memory in this file over restarts
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// Whether the truck learns itself from trips with the empty trailer: what was learned is kept in
    /// the file of --state and used from the next start on, on top of --calibration if it is given.
    /// Default: on with --state
    #[arg(long, value_enum, value_name = "on|off")]
    pub(crate) learn: Option<Learn>,
    /// Write counters and results to this file for Prometheus (textfile collector of its node
    /// exporter)
    #[arg(long, value_name = "FILE")]
    pub(crate) metrics: Option<PathBuf>,
    /// Send height, threshold, margin and warning level on the interface as a Proprietary B message
    /// (see `fixtures/can/cg_height.dbc`)
    #[arg(long, conflicts_with_all = ["csv", "candump"])]
    pub(crate) transmit: bool,
    /// Source address of the sent frames
    #[arg(long, value_name = "ADDRESS", default_value = "0xD0", value_parser = address, requires = "transmit",
        conflicts_with_all = ["csv", "candump"])]
    pub(crate) transmit_address: u8,
    /// Warning levels, in any order, as shares of the lower bound of the rollover threshold
    #[arg(long, value_name = "SHARES", value_delimiter = ',', default_value = "0.6,0.75,0.9", value_parser = share_of_threshold)]
    pub(crate) warn: Vec<f64>,
    /// Hysteresis of the warning, as a share of the threshold: how far below its level a warning
    /// ends
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share_of_threshold)]
    pub(crate) warn_hysteresis: f64,
    /// Request a speed in turns that use more than this share of the lower bound of the rollover threshold:
    /// on standard output, and with --transmit as a frame that asks and controls nothing. Off without it
    #[arg(long, value_name = "SHARE", value_parser = share_of_threshold)]
    pub(crate) speed_request: Option<f64>,
    /// Show a live page at this port of this computer, or at an address and a port that others can
    /// open, such as 0.0.0.0:8080; after a replay it stays until Ctrl-C
    #[arg(long, value_name = "ADDR")]
    pub(crate) serve: Option<Address>,
    /// Time between two status lines, s; 0 writes none
    #[arg(long, value_name = "T", default_value_t = 1.0, allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) status_s: f64,
}

impl RunArgs {
    /// Whether the source is a file, which ends.
    pub(crate) fn is_of_a_file(&self) -> bool {
        let path = self.candump.as_ref().or(self.csv.as_ref());
        path.is_some_and(|path| path.as_os_str() != "-")
    }
}

/// Whether the truck learns itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Learn {
    /// It does
    On,
    /// It does not, and what was learned before is not used
    Off,
}

/// The name of an interface, on systems that have SocketCAN.
fn interface(name: &str) -> Result<String, String> {
    if cfg!(target_os = "linux") {
        Ok(name.to_owned())
    } else {
        Err("this system has no SocketCAN, only Linux has; record the frames and replay them with \
             --candump or --csv"
            .to_owned())
    }
}

fn address(text: &str) -> Result<u8, String> {
    let parsed = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u8::from_str_radix(digits, 16),
        None => text.parse(),
    };
    match parsed {
        Ok(address) if address <= 253 => Ok(address),
        _ => Err("expected a source address from 0 to 253, as in 0xD0".to_owned()),
    }
}
