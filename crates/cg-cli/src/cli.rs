//! The arguments.

use std::path::PathBuf;

use cg_core::identify::arx::SampledArx;
use cg_logs::calibrate::KnownLog;
use cg_logs::estimate::{ChannelChoice, Method};
use cg_plant::maneuver::{Histories, Maneuver};
use cg_plant::simulate::Plant;
use cg_thesis::reproduce::Options;
use cg_vehicle::Variant;
use cg_vehicle::emit::Language;
use clap::{Args, Parser, Subcommand};

use crate::args::{ColumnArgs, Format, LoadArgs, ModelFormat};
use crate::can::CanArgs;
use crate::numbers::{
    duration_s, gate_m, lateral_g, not_negative, radius_m, rate_hz, speed_change, speed_mps,
    steer_rad, step_rate, trailer_mass_kg, turn_deg,
};
use crate::run::args::RunArgs;
use crate::sensors::SensorArgs;
use crate::truck::TruckArgs;
use crate::words::word;

/// The most logs read at the same time.
const GREATEST_JOBS: usize = 256;

/// The most draws in a cell: an hour of them.
const GREATEST_RUNS: u32 = 1_000_000;

/// Centre-of-gravity height of a semitrailer from steer angle and trailer roll angle.
#[derive(Debug, Parser)]
#[command(name = "cg", version, about, arg_required_else_help = true)]
#[command(override_usage = "cg <COMMAND>")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Replace files that this program did not write; one that is an input of the same call is
    /// never replaced
    #[arg(long, global = true)]
    pub(crate) force: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Estimate the c.g. height from logs
    Estimate(EstimateArgs),
    /// Calibrate a vehicle with logs of known height
    Calibrate(CalibrateArgs),
    /// Write the constants of a vehicle for firmware, as Rust, C or JSON
    Design(DesignArgs),
    /// Print what the vehicle model says: transfer function, ratio, reduced model, loads
    Model(ModelArgs),
    /// Write a log with known truth
    Simulate(SimulateArgs),
    /// Print rollover measures: thresholds, load transfer, rearward amplification, damping
    Rollover(RolloverArgs),
    /// Compute the source's tables anew and set ours beside them
    Reproduce(ReproduceArgs),
    /// Estimate live from a CAN interface, or replay a recorded drive the same way
    Run(RunArgs),
    /// Run a study of the source's chapter 2 on the nonlinear plant: a CSV file and a figure
    Study(StudyArgs),
}

#[derive(Debug, Args)]
pub(crate) struct EstimateArgs {
    /// Logs: .csv, .csv.gz, .parquet, or what candump has recorded (with time stamps: -L, -l, -ta);
    /// `-` reads CSV or candump from standard input
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    /// Output format; JSON is one object per line
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
    /// How the DC ratio is identified
    #[arg(long, value_parser = word::<Method>(), default_value_t = Method::Filtered)]
    pub(crate) method: Method,
    /// What drives the roll angle; `auto` combines both by what each knows
    #[arg(long, value_parser = word::<ChannelChoice>(), default_value_t = ChannelChoice::Auto)]
    pub(crate) channel: ChannelChoice,
    /// Order of the classical ARX (with --method arx)
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = order)]
    pub(crate) order: usize,
    /// Forward speed, whatever the log says
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Mass of the whole semitrailer as weighed, whatever the log says
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = trailer_mass_kg)]
    pub(crate) trailer_mass_kg: Option<f64>,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) frames: CanArgs,
    /// Print the known heights of this JSON file beside (the estimator never reads it)
    #[arg(long, value_name = "TRUTH.json")]
    pub(crate) truth: Option<PathBuf>,
    /// Also write a page with table, pictures and messages, in one file that needs no network
    #[arg(long, value_name = "OUT.html")]
    pub(crate) report: Option<PathBuf>,
    /// Logs read at the same time
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = jobs)]
    pub(crate) jobs: usize,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// A log with turns at steady speed and its known height; may be repeated. One run fixes the
    /// compensation, more (an empty and a laden one) the truck's parameters
    #[arg(
        long,
        required = true,
        allow_hyphen_values = true,
        value_name = "LOG=HEIGHT_M[,TRAILER_MASS_KG]"
    )]
    pub(crate) run: Vec<KnownLog>,
    /// The calibration file to write
    #[arg(short, long, value_name = "C.toml")]
    pub(crate) output: PathBuf,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) frames: CanArgs,
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    /// The language
    #[arg(long, value_parser = word::<Language>())]
    pub(crate) emit: Language,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    /// Forward speed [default: the vehicle file's]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
}

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// What the driver does
    #[arg(long, value_parser = word::<Maneuver>())]
    pub(crate) maneuver: Maneuver,
    /// What moves
    #[arg(long, value_parser = word::<Plant>(), default_value_t = Plant::Linear)]
    pub(crate) plant: Plant,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Forward speed [default: the vehicle file's]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Road-wheel steer amplitude [default: for 0.17 g]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = steer_rad)]
    pub(crate) steer_rad: Option<f64>,
    /// Samples per second
    #[arg(long, value_name = "F", default_value_t = 100.0, allow_negative_numbers = true, value_parser = rate_hz)]
    pub(crate) rate_hz: f64,
    /// Straight driving before the maneuver
    #[arg(long, value_name = "T", default_value_t = 2.0, allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) start_s: f64,
    /// Length of the log, from time 0 [default: 20, a drive 300, a driver's
    /// path as long as it takes]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = duration_s)]
    pub(crate) duration_s: Option<f64>,
    /// Rate of rounded steps, 1/s
    #[arg(long, value_name = "A", default_value_t = Histories::STEP_RATE_PER_S, allow_negative_numbers = true, value_parser = step_rate)]
    pub(crate) step_rate: f64,
    /// With steady-turn and the nonlinear plant: a driver turns by this angle (right if negative)
    /// on a radius of --radius-m [default with --radius-m: 90]
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = turn_deg)]
    pub(crate) turn_deg: Option<f64>,
    /// Radius of that turn [default with --turn-deg: 100]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius_m)]
    pub(crate) radius_m: Option<f64>,
    /// With lane-change and the nonlinear plant: a driver changes the lane (3.65 m) over this gate
    /// length (the source: 20 and 30)
    #[arg(long, value_name = "L", allow_negative_numbers = true, value_parser = gate_m)]
    pub(crate) gate_m: Option<f64>,
    /// With drive: the speed changes by up to this share either way [default: 0.3 with the
    /// nonlinear plant, else 0]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, value_parser = speed_change)]
    pub(crate) speed_change: Option<f64>,
    /// With the nonlinear plant: the log ends where the vehicle rolls over; the default steer
    /// amplitude is then that of 1.2 g
    #[arg(long)]
    pub(crate) to_rollover: bool,
    #[command(flatten)]
    pub(crate) sensors: SensorArgs,
    /// Seed of the sensors and of the drive
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// The log to write: .csv, .csv.gz or .log (J1939 frames as candump writes them); `-` writes CSV
    /// to standard output
    #[arg(short, long, value_name = "LOG.csv")]
    pub(crate) output: PathBuf,
    /// Also write the truth as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RolloverArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Speed of the ramps and of the lane change; measures that are defined at a speed keep it
    /// [default: the vehicle file's]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Lateral acceleration of the load transfer, in g
    #[arg(long, value_name = "A", default_value_t = 0.15, allow_negative_numbers = true, value_parser = lateral_g)]
    pub(crate) lateral_acceleration_g: f64,
    /// Gate length of the lane change (the source: 20 and 30)
    #[arg(long, value_name = "L", default_value_t = 20.0, allow_negative_numbers = true, value_parser = gate_m)]
    pub(crate) gate_m: f64,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
}

#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// One table, equation or figure, such as 5.11, "eq. 5.12" or C; an unknown one lists all
    /// [default: all]
    #[arg(long, value_name = "N")]
    pub(crate) table: Option<String>,
    /// Output format; JSON is one object per line
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
    /// Draws of the noise in each cell of a Monte-Carlo table
    #[arg(long, value_name = "N", default_value_t = Options::default().runs, value_parser = runs)]
    pub(crate) runs: u32,
    /// Seed of the first draw
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    pub(crate) seed: u64,
}

#[derive(Debug, Args)]
pub(crate) struct StudyArgs {
    /// Which one; an unknown one lists all
    #[arg(required_unless_present = "list")]
    pub(crate) name: Option<String>,
    /// List all studies
    #[arg(long, conflicts_with_all = ["name", "vehicle", "output", "run", "calibration"])]
    pub(crate) list: bool,
    /// The vehicle file, in place of the source's baseline with its measured springs and tyres
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// With `replay`: a recorded log and its known load; may be repeated
    #[arg(long, allow_hyphen_values = true, value_name = "LOG=HEIGHT_M[,TRAILER_MASS_KG]")]
    pub(crate) run: Vec<KnownLog>,
    /// With `replay`: a calibration of this vehicle (from `cg calibrate`)
    #[arg(long, value_name = "C.toml")]
    pub(crate) calibration: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Where NAME.csv and NAME.svg go; made if it does not exist
    #[arg(short, long, value_name = "FOLDER", default_value = ".", hide_default_value = true)]
    pub(crate) output: PathBuf,
}

/// Zero means as many as there are processors; each costs a thread, so there is an end to them.
fn jobs(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(jobs) if jobs <= GREATEST_JOBS => Ok(jobs),
        _ => Err(format!("expected a whole number from 0 (all processors) to {GREATEST_JOBS}")),
    }
}

fn runs(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(runs) if (1..=GREATEST_RUNS).contains(&runs) => Ok(runs),
        _ => Err(format!("expected a whole number from 1 to {GREATEST_RUNS}")),
    }
}

fn order(text: &str) -> Result<usize, String> {
    let greatest = SampledArx::<f64>::GREATEST_ORDER;
    match text.parse() {
        Ok(order) if (1..=greatest).contains(&order) => Ok(order),
        _ => Err(format!("expected a whole number from 1 to {greatest}")),
    }
}
