//! The arguments.

use std::path::PathBuf;

use cg_core::Channel;
use cg_core::arx::SampledArx;
use cg_vehicle::estimate::Method;
use cg_vehicle::log::{ColumnMap, Signal};
use cg_vehicle::maneuver::Maneuver;
use cg_vehicle::reproduce::Options;
use cg_vehicle::simulate::Plant;
use cg_vehicle::{Load, Variant, Vehicle};
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::calibrate::RunArg;

/// The most logs read at the same time.
const GREATEST_JOBS: usize = 256;

/// The most draws in a cell: an hour of them.
const GREATEST_RUNS: u32 = 1_000_000;

/// Centre-of-gravity height of a semitrailer from steer angle and trailer roll angle.
#[derive(Debug, Parser)]
#[command(name = "cg", version, about, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Estimate the c.g. height from logs
    Estimate(EstimateArgs),
    /// Calibrate a vehicle with logs of known height
    Calibrate(CalibrateArgs),
    /// Print what the vehicle model says: transfer function, ratio, reduced model, loads
    Model(ModelArgs),
    /// Write a log with known truth
    Simulate(SimulateArgs),
    /// Compute the source's tables anew and set ours beside them
    Reproduce(ReproduceArgs),
    /// Run a study of the source's chapter 2 on the nonlinear plant: a CSV file and a figure
    Study(StudyArgs),
}

#[derive(Debug, Args)]
pub(crate) struct EstimateArgs {
    /// Logs: .csv, .csv.gz or .parquet; `-` reads CSV from standard input
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// A calibration of this vehicle (from `cg calibrate`)
    #[arg(long, value_name = "C.toml")]
    pub(crate) calibration: Option<PathBuf>,
    /// Output format; JSON is one object per line
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
    /// How the DC ratio is identified
    #[arg(long, value_enum, default_value_t = MethodArg::Filtered)]
    pub(crate) method: MethodArg,
    /// What drives the roll angle; `auto` combines both by what each knows
    #[arg(long, value_enum, default_value_t = ChannelArg::Auto)]
    pub(crate) channel: ChannelArg,
    /// Order of the classical ARX (with --method arx)
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = order)]
    pub(crate) order: usize,
    /// Forward speed, whatever the log says
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) speed_mps: Option<f64>,
    /// Mass of the whole semitrailer as weighed, whatever the log says
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) trailer_mass_kg: Option<f64>,
    /// Equations of the vehicle model
    #[arg(long, value_enum, default_value_t = ModelArg::Complete)]
    pub(crate) model: ModelArg,
    /// Read a signal from a foreign column: `roll=MyName[deg]`; may be repeated
    #[arg(long, value_name = "SIGNAL=NAME[UNIT]")]
    pub(crate) column: Vec<ColumnMap>,
    /// Sensors mounted the other way round: `roll,steer`
    #[arg(long, value_name = "SIGNALS", value_delimiter = ',')]
    pub(crate) flip: Vec<Signal>,
    /// Print the known heights of this JSON file beside (the estimator never reads it)
    #[arg(long, value_name = "TRUTH.json")]
    pub(crate) truth: Option<PathBuf>,
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
    pub(crate) run: Vec<RunArg>,
    /// The calibration file to write
    #[arg(short, long, value_name = "C.toml")]
    pub(crate) output: PathBuf,
    /// Equations of the vehicle model
    #[arg(long, value_enum, default_value_t = ModelArg::Complete)]
    pub(crate) model: ModelArg,
    /// Read a signal from a foreign column: `roll=MyName[deg]`; may be repeated
    #[arg(long, value_name = "SIGNAL=NAME[UNIT]")]
    pub(crate) column: Vec<ColumnMap>,
    /// Sensors mounted the other way round: `roll,steer`
    #[arg(long, value_name = "SIGNALS", value_delimiter = ',')]
    pub(crate) flip: Vec<Signal>,
}

#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// Equations of the vehicle model
    #[arg(long, value_enum, default_value_t = ModelArg::Complete)]
    pub(crate) model: ModelArg,
    /// Forward speed [default: the vehicle file's]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) speed_mps: Option<f64>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
}

#[derive(Debug, Args)]
pub(crate) struct LoadArgs {
    /// C.g. height of the trailer's sprung mass [default: the vehicle file's]
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) height_m: Option<f64>,
    /// Mass of the whole semitrailer [default: the vehicle file's]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive, conflicts_with = "payload_kg")]
    pub(crate) trailer_mass_kg: Option<f64>,
    /// Payload, in place of the mass of the whole semitrailer
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) payload_kg: Option<f64>,
}

impl LoadArgs {
    pub(crate) fn load(&self, vehicle: &Vehicle) -> Load {
        let reference = vehicle.reference_load();
        let payload = self.payload_kg.map(|payload| vehicle.empty_trailer_mass_kg() + payload);
        Load {
            trailer_mass_kg: self.trailer_mass_kg.or(payload).unwrap_or(reference.trailer_mass_kg),
            cg_height_m: self.height_m.unwrap_or(reference.cg_height_m),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// What the driver does
    #[arg(long, value_enum)]
    pub(crate) maneuver: ManeuverArg,
    /// What moves
    #[arg(long, value_enum, default_value_t = PlantArg::Linear)]
    pub(crate) plant: PlantArg,
    /// Equations of the vehicle model
    #[arg(long, value_enum, default_value_t = ModelArg::Complete)]
    pub(crate) model: ModelArg,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Forward speed [default: the vehicle file's]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) speed_mps: Option<f64>,
    /// Road-wheel steer amplitude [default: for 0.17 g]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = number)]
    pub(crate) steer_rad: Option<f64>,
    /// Samples per second
    #[arg(long, value_name = "F", default_value_t = 100.0, allow_negative_numbers = true, value_parser = positive)]
    pub(crate) rate_hz: f64,
    /// Straight driving before the maneuver
    #[arg(long, value_name = "T", default_value_t = 2.0, allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) start_s: f64,
    /// Length of the log, from time 0 [default: 20, a drive 300]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) duration_s: Option<f64>,
    /// White noise on the roll angle, decibels below its mean square
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = decibels)]
    pub(crate) snr_db: Option<f64>,
    /// Seed of the noise and of the drive
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// The log to write: .csv or .csv.gz; `-` writes CSV to standard output
    #[arg(short, long, value_name = "LOG.csv")]
    pub(crate) output: PathBuf,
    /// Also write the truth as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
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
    #[arg(long, conflicts_with_all = ["name", "vehicle", "output"])]
    pub(crate) list: bool,
    /// The vehicle file, in place of the source's baseline with its measured springs and tyres
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// Where NAME.csv and NAME.svg go; made if it does not exist
    #[arg(short, long, value_name = "FOLDER", default_value = ".", hide_default_value = true)]
    pub(crate) output: PathBuf,
}

fn number(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
        .ok_or_else(|| "expected a number".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    number(text).and_then(
        |value| {
            if value > 0.0 { Ok(value) } else { Err("must be positive".to_owned()) }
        },
    )
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| {
        if value >= 0.0 { Ok(value) } else { Err("must not be negative".to_owned()) }
    })
}

fn decibels(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| {
        if value.abs() <= 300.0 {
            Ok(value)
        } else {
            Err("must lie between -300 and 300".to_owned())
        }
    })
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

/// An argument with the values of a library's enumeration.
macro_rules! mirrored {
    ($name:ident => $target:ty { $($(#[$doc:meta])* $variant:ident => $value:expr),+ $(,)? }) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub(crate) enum $name { $($(#[$doc])* $variant),+ }

        impl From<$name> for $target {
            fn from(argument: $name) -> Self {
                match argument { $($name::$variant => $value),+ }
            }
        }
    };
}

mirrored!(MethodArg => Method {
    /// Filtered signals and prior dynamics
    Filtered => Self::Filtered,
    /// Classical shift form, as in the source
    Arx => Self::Arx,
    /// Nominal dynamics, only the gain is free
    Gain => Self::Gain,
});

mirrored!(ChannelArg => Option<Channel> {
    /// Both, by what each knows
    Auto => None,
    /// Steer angle
    Steer => Some(Channel::Steer),
    /// Lateral acceleration, or yaw rate times speed
    LateralAcceleration => Some(Channel::LateralAcceleration),
});

mirrored!(ModelArg => Variant {
    /// All terms
    Complete => Self::Complete,
    /// The source's appendix B, misprints corrected
    AsPrinted => Self::AsPrinted,
});

mirrored!(PlantArg => Plant {
    /// The linear model in full
    Linear => Self::Linear,
    /// The reduced 5th-order model
    Reduced => Self::Reduced,
    /// The nonlinear yaw/roll plant, springs and tyres as the vehicle file has them
    Nonlinear => Self::Nonlinear,
});

mirrored!(ManeuverArg => Maneuver {
    /// Rounded step, held
    RoundedStep => Self::RoundedStep,
    /// Into a turn and out again
    SteadyTurn => Self::SteadyTurn,
    /// One sine of three seconds
    LaneChange => Self::LaneChange,
    /// Sine of 0.2 Hz
    Sine => Self::Sine,
    /// Linearly growing
    Ramp => Self::Ramp,
    /// Random turns and straights
    Drive => Self::Drive,
});
