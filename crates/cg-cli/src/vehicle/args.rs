//! The arguments of `cg vehicle`.

use std::path::PathBuf;

use cg_vehicle::guide::TruckKind;
use clap::{Args, Subcommand};

use crate::args::{LoadArgs, ModelFormat};
use crate::numbers::speed_mps;
use crate::words::word;

#[derive(Debug, Args)]
pub(crate) struct VehicleArgs {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Write a commented vehicle file with typical values
    New(NewArgs),
    /// Check a vehicle file: findings, axle loads, rollover thresholds, and which uncertain parameters
    /// matter most for the height
    Check(CheckArgs),
    /// Show with the vehicle's nonlinear plant what the equations leave out, the least residual of the file
    Residual(ResidualArgs),
    /// Print the JSON schema of vehicle files, for editors (docs/vehicle.schema.json)
    Schema,
    /// Print the page about vehicle files, with every key (docs/vehicle.md)
    Doc,
}

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// Kind of truck
    #[arg(long, value_parser = word::<TruckKind>())]
    pub(super) kind: TruckKind,
    /// Vehicle file to write
    #[arg(short, long, value_name = "V.toml")]
    pub(super) output: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Vehicle file
    #[arg(value_name = "V.toml")]
    pub(super) vehicle: PathBuf,
    #[command(flatten)]
    pub(super) load: LoadArgs,
    /// Forward speed, m/s [default: from the vehicle file]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(super) speed_mps: Option<f64>,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(super) format: ModelFormat,
}

#[derive(Debug, Args)]
pub(super) struct ResidualArgs {
    /// Vehicle file
    #[arg(value_name = "V.toml")]
    pub(super) vehicle: PathBuf,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(super) format: ModelFormat,
}
