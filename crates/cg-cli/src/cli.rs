//! The commands of `cg` and their arguments.

use std::path::PathBuf;

use cg_core::Channel;
use cg_logs::calibrate::KnownLog;
use cg_logs::estimate::{ChannelChoice, Method};
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::Plant;
use cg_thesis::reproduce::Options;
use cg_vehicle::Variant;
use cg_vehicle::calibration::{Part, Procedure};
use cg_vehicle::emit::Language;
use clap::{Args, Parser, Subcommand};

use crate::args::{ColumnArgs, Format, LoadArgs, MethodArgs, ModelFormat};
use crate::can::CanArgs;
use crate::fmu::FmuArgs;
use crate::numbers::{
    duration_s, gate_m, lateral_g, not_negative, number, payload_behind_hitch_m, payload_kg,
    radius_m, rate_hz, share_of_threshold, speed_change, speed_mps, steer_rad, step_rate,
    trailer_mass_kg, turn_deg,
};
use crate::run::args::RunArgs;
use crate::sensors::{ChassisArgs, SensorArgs};
use crate::truck::{LiftArgs, RoadArgs, TruckArgs};
use crate::vehicle::args::VehicleArgs;
use crate::words::word;

/// Maximum number of logs that are read at the same time.
const GREATEST_JOBS: usize = 256;

/// Maximum number of draws in a cell, which take about an hour.
const GREATEST_RUNS: u32 = 1_000_000;

/// Center-of-gravity height of a semitrailer from steer angle and trailer roll angle.
#[derive(Debug, Parser)]
#[command(name = "cg", version, about, arg_required_else_help = true)]
#[command(override_usage = "cg <COMMAND>")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Replace existing files that cg did not write, or that are write-protected; inputs of the
    /// same call are never replaced. `calibrate` then also writes a calibration whose runs contradict
    /// each other
    #[arg(long, global = true)]
    pub(crate) force: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Estimate the c.g. height from logs
    Estimate(EstimateArgs),
    /// Calibrate a vehicle with logs of known c.g. height
    Calibrate(CalibrateArgs),
    /// Write the constants of a vehicle for firmware as Rust, C or JSON
    Design(DesignArgs),
    /// Print the vehicle model: transfer function, DC ratio, reduced model, static loads
    Model(ModelArgs),
    /// Simulate a drive and write a log with known c.g. height
    Simulate(SimulateArgs),
    /// Write the plant or the estimator as an FMU (FMI 3.0) for simulation tools
    Fmu(FmuArgs),
    /// Compute rollover measures: thresholds, load transfer, rearward amplification, damping
    Rollover(RolloverArgs),
    /// Recompute the thesis's tables and print them next to the printed values
    Reproduce(ReproduceArgs),
    /// Estimate live from a CAN interface, or replay a recorded drive in the same way
    Run(RunArgs),
    /// Run a study of the thesis's chapter 2 and write a CSV file and a figure
    Study(StudyArgs),
    /// Make a vehicle file with typical values, check one, or explain its keys
    Vehicle(VehicleArgs),
}

#[derive(Debug, Args)]
pub(crate) struct EstimateArgs {
    /// Logs or patterns of them (`logs/*.csv`): .csv, .csv.gz, .parquet, candump (with time stamps: -L,
    /// -l, -ta) or .asc; `-` reads CSV or frames from standard input
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    #[command(flatten)]
    pub(crate) road: RoadArgs,
    /// Output format; JSON has one object per line
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// Pair of signals from which the height is estimated
    #[arg(long, value_parser = word::<ChannelChoice>(), default_value_t = ChannelChoice::Auto)]
    pub(crate) channel: ChannelChoice,
    /// Forward speed in m/s; replaces the speed in the log
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Mass of the whole semitrailer as weighed, kg; replaces the mass in the log
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = trailer_mass_kg)]
    pub(crate) trailer_mass_kg: Option<f64>,
    /// Standard deviation of the trailer mass, kg; without it that of its source ([sensors.mass] of the
    /// vehicle file), and a trailer without a mass has any load
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = payload_kg)]
    pub(crate) trailer_mass_sd_kg: Option<f64>,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) frames: CanArgs,
    /// Show the true heights from this JSON file next to the estimates (the estimator never reads
    /// them)
    #[arg(long, value_name = "TRUTH.json")]
    pub(crate) truth: Option<PathBuf>,
    /// Also write an HTML page with table, plots and messages: one file that needs no network
    #[arg(long, value_name = "OUT.html")]
    pub(crate) report: Option<PathBuf>,
    /// Number of logs that are read at the same time [default: number of processors]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = jobs)]
    pub(crate) jobs: usize,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// Vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// A log with turns at steady speed and its known c.g. height (of the whole sprung mass, load and body), exact or
    /// with its standard deviation (1.9±0.05 or 1.9+-0.05; the mass likewise), ? if it is not known, or LOG=empty for
    /// the empty trailer, whose height and mass are in the vehicle file; may be repeated
    #[arg(
        long,
        required_unless_present = "from_state",
        allow_hyphen_values = true,
        value_name = "LOG=HEIGHT_M[±SD]|?[,TRAILER_MASS_KG[±SD]]|LOG=empty"
    )]
    pub(crate) run: Vec<KnownLog>,
    /// A state file of `cg run`, whose trips with the empty trailer become runs; may be repeated
    #[arg(long, value_name = "STATE")]
    pub(crate) from_state: Vec<PathBuf>,
    /// Calibration file to write; its name ends in .toml
    #[arg(short, long, value_name = "C.toml")]
    pub(crate) output: PathBuf,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    /// Method by which the DC ratios of the runs are identified
    #[arg(long, value_parser = word::<Method>(), default_value_t = Method::Filtered)]
    pub(crate) method: Method,
    /// Signals whose ratios are used, if the logs have others too
    #[arg(long, value_parser = word::<ChannelChoice>(), default_value_t = ChannelChoice::Auto)]
    pub(crate) channel: ChannelChoice,
    /// What the runs determine
    #[arg(long, value_parser = word::<Procedure>(), default_value_t = Procedure::default())]
    pub(crate) procedure: Procedure,
    /// What the calibration is for; one of the tractor alone holds with any trailer
    #[arg(long, value_parser = word::<Part>(), default_value_t = Part::default())]
    pub(crate) part: Part,
    #[command(flatten)]
    pub(crate) lift: LiftArgs,
    #[command(flatten)]
    pub(crate) road: RoadArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) frames: CanArgs,
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    /// Language of the output
    #[arg(long, value_parser = word::<Language>())]
    pub(crate) emit: Language,
    /// The two channels of the design: steer, lateral-acceleration, suspension, tractor
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        default_value = "steer,lateral-acceleration",
        value_parser = word::<Channel>()
    )]
    pub(crate) channels: Vec<Channel>,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ModelArgs {
    #[command(flatten)]
    pub(crate) truck: TruckArgs,
    /// Forward speed, m/s [default: from the vehicle file]
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
    /// Vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    #[command(flatten)]
    pub(crate) lift: LiftArgs,
    /// Maneuver of the driver
    #[arg(long, required_unless_present = "road", value_parser = word::<Maneuver>())]
    pub(crate) maneuver: Option<Maneuver>,
    /// Road to drive along instead of a maneuver, with the nonlinear plant and the sensors of the
    /// chassis: rural, motorway, roundabouts or flat (--seed determines the curves), or a CSV file with the
    /// columns `distance_m`, `curvature_per_m`, `bank_rad` and, if it has limits or grades,
    /// `speed_mps` and `grade_rad`
    #[arg(long, value_name = "KIND|FILE", conflicts_with_all = ["maneuver", "steer_rad",
        "start_s", "step_rate", "turn_deg", "radius_m", "gate_m", "speed_change", "to_rollover"])]
    pub(crate) road: Option<PathBuf>,
    /// Every axle stands on the bank of its own place; without it, the whole truck on one bank
    #[arg(long)]
    pub(crate) road_twist: bool,
    /// Simulated vehicle [default: linear; on a road nonlinear, the only one that drives there]
    #[arg(long, value_parser = word::<Plant>())]
    pub(crate) plant: Option<Plant>,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Distance of the payload's c.g. behind the fifth wheel, m [default: from the vehicle file]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = payload_behind_hitch_m)]
    pub(crate) payload_behind_hitch_m: Option<f64>,
    /// Distance of the payload's c.g. to the left of the middle, m, to the right if negative; it must
    /// be 0 with the printed equations
    #[arg(long, value_name = "Y", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    pub(crate) payload_left_m: f64,
    /// Mean speed of the wind on the trailer's body, m/s, with gusts of 15 %; for the nonlinear plant; the vehicle file needs the table `wind`
    #[arg(long, value_name = "W", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) wind_mps: f64,
    /// Where the wind comes from at the start, rad: 0 from ahead, 1.571 from the left
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    pub(crate) wind_from_rad: f64,
    /// Forward speed, m/s; on a road, the greatest [default: from the vehicle file, or the limits of
    /// the road]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Amplitude of the road-wheel angle, rad; not for a driver on a path [default: the angle for 0.17 g]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = steer_rad)]
    pub(crate) steer_rad: Option<f64>,
    /// Samples per second, Hz
    #[arg(long, value_name = "F", default_value_t = 100.0, allow_negative_numbers = true, value_parser = rate_hz)]
    pub(crate) rate_hz: f64,
    /// Straight driving before the maneuver, s
    #[arg(long, value_name = "T", default_value_t = 2.0, allow_negative_numbers = true, value_parser = not_negative)]
    pub(crate) start_s: f64,
    /// Duration of the log from time 0, s [default: 20; 300 for a drive; as long as necessary for
    /// a driver on a path; 120 to 150 on a road, or as long as it is]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = duration_s)]
    pub(crate) duration_s: Option<f64>,
    /// Rate of rounded steps, 1/s; for rounded-step, and for steady-turn without a driver [default: 3]
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = step_rate)]
    pub(crate) step_rate: Option<f64>,
    /// Angle of a turn by a driver, degrees, to the right if negative; for steady-turn with the
    /// nonlinear plant [default with --radius-m: 90]
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = turn_deg)]
    pub(crate) turn_deg: Option<f64>,
    /// Radius of that turn, m [default with --turn-deg: 100]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius_m)]
    pub(crate) radius_m: Option<f64>,
    /// Gate length in m for a driver who changes the lane by 3.65 m (the thesis uses 20 and 30);
    /// for lane-change with the nonlinear plant
    #[arg(long, value_name = "L", allow_negative_numbers = true, value_parser = gate_m)]
    pub(crate) gate_m: Option<f64>,
    /// Greatest relative change of the speed, up and down; for drive [default: 0.3 with the
    /// nonlinear plant, otherwise 0]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, value_parser = speed_change)]
    pub(crate) speed_change: Option<f64>,
    /// End the log at the rollover of the vehicle; for the nonlinear plant. The default steer
    /// amplitude is then that for 1.2 g
    #[arg(long)]
    pub(crate) to_rollover: bool,
    #[command(flatten)]
    pub(crate) sensors: SensorArgs,
    #[command(flatten)]
    pub(crate) chassis: ChassisArgs,
    /// Seed of the random numbers of the sensors and of the drive
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Log to write: .csv, .csv.gz or .log (J1939 frames in the format of candump); `-` writes CSV
    /// to standard output
    #[arg(short, long, value_name = "LOG.csv")]
    pub(crate) output: PathBuf,
    /// Also write the truth (height, parameters, sensor errors) as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RolloverArgs {
    /// Vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    #[command(flatten)]
    pub(crate) lift: LiftArgs,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    /// Speed of the ramps and of the lane change, m/s; measures that are defined at a certain speed
    /// keep it [default: from the vehicle file]
    #[arg(long, value_name = "U", allow_negative_numbers = true, value_parser = speed_mps)]
    pub(crate) speed_mps: Option<f64>,
    /// Distance of the payload's c.g. to the left of the middle, m, to the right if negative; for the
    /// measures of the nonlinear plant, whose turns are to the left
    #[arg(long, value_name = "Y", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    pub(crate) payload_left_m: f64,
    /// Lateral acceleration at which the load transfer is computed, g
    #[arg(long, value_name = "A", default_value_t = 0.15, allow_negative_numbers = true, value_parser = lateral_g)]
    pub(crate) lateral_acceleration_g: f64,
    /// Gate length of the lane change, m (the thesis uses 20 and 30)
    #[arg(long, value_name = "L", default_value_t = 20.0, allow_negative_numbers = true, value_parser = gate_m)]
    pub(crate) gate_m: f64,
    /// Radius of a level curve, m: also gives the speed at which it keeps the margin of --share
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius_m)]
    pub(crate) radius_m: Option<f64>,
    /// Share of the lower bound of the threshold that the curve may use
    #[arg(long, value_name = "SHARE", default_value_t = 0.6, allow_negative_numbers = true, value_parser = share_of_threshold, requires = "radius_m")]
    pub(crate) share: f64,
    /// Standard deviation of the height, m, for that bound
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative, requires = "radius_m")]
    pub(crate) height_sd_m: f64,
    /// Output format
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
}

#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// Only this table, equation or figure, such as 5.11, "eq. 5.12" or C; an unknown name lists
    /// all [default: all]
    #[arg(long, value_name = "N")]
    pub(crate) table: Option<String>,
    /// Every numbered table and figure of the thesis with one verdict each, the studies included
    #[arg(long, conflicts_with = "table")]
    pub(crate) list: bool,
    /// Write the figures of chapters 4 and 5 and of appendix C into this folder, each as SVG and CSV
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["table", "list"])]
    pub(crate) figures: Option<PathBuf>,
    /// Output format; JSON has one object per line
    #[arg(long, value_enum, default_value_t = ModelFormat::Table)]
    pub(crate) format: ModelFormat,
    /// Number of noise draws in each cell of a Monte-Carlo table
    #[arg(long, value_name = "N", default_value_t = Options::default().runs, value_parser = runs)]
    pub(crate) runs: u32,
    /// Seed of the first draw
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    pub(crate) seed: u64,
}

#[derive(Debug, Args)]
pub(crate) struct StudyArgs {
    /// Name of the study; an unknown name lists all
    #[arg(required_unless_present = "list")]
    pub(crate) name: Option<String>,
    /// List all studies
    #[arg(long, conflicts_with_all = ["name", "vehicle", "output", "run", "calibration", "column", "flip"])]
    pub(crate) list: bool,
    /// Vehicle file [default: the thesis's baseline with its measured springs and tires]
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: Option<PathBuf>,
    /// For `replay`: a recorded log with its known load; may be repeated
    #[arg(long, allow_hyphen_values = true, value_name = "LOG=HEIGHT_M[,TRAILER_MASS_KG]")]
    pub(crate) run: Vec<KnownLog>,
    /// For `replay`: calibration of this vehicle (from `cg calibrate`)
    #[arg(long, value_name = "C.toml")]
    pub(crate) calibration: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Folder for NAME.csv and NAME.svg; it is created if it does not exist [default: current
    /// folder]
    #[arg(short, long, value_name = "FOLDER", default_value = ".", hide_default_value = true)]
    pub(crate) output: PathBuf,
}

/// Zero means the number of processors. Each job needs a thread, so their number is limited.
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
