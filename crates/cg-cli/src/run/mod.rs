//! `cg run`: live estimates from a CAN interface, or a replay of a recorded drive.
//!
//! | file | what |
//! |---|---|
//! | `args` | the arguments |
//! | `live`, `socket` | a CAN interface: frames with kernel time stamps, errors, loss of the interface (Linux) |
//! | `no_live` | in place of both on other systems, which can only replay |
//! | `replay` | candump and CSV logs |
//! | `stall` | input that may stall |
//! | `frames` | conversion of frames to samples |
//! | `presence`, `pace` | checks that signals are present and frequent enough |
//! | `session` | processing of samples to events |
//! | `channels` | the heights of the channels |
//! | `doubted` | doubt whether the mass is that of the load |
//! | `learning` | learning of the truck from empty driving |
//! | `request` | the speed that is requested in turns |
//! | `events` | the lines on standard output |
//! | `outputs`: `state`, `metrics`, `transmit`, `latency` | the other outputs |
//! | `serve` | the live page |
//! | `signals` | requests to stop |
//! | `wall` | the wall clock |
#![cfg_attr(not(target_os = "linux"), allow(dead_code))] // what only a live bus needs

pub(crate) mod args;
mod channels;
mod doubted;
mod events;
mod frames;
mod latency;
mod learning;
#[cfg_attr(not(target_os = "linux"), path = "no_live.rs")]
mod live;
mod metrics;
mod outputs;
mod pace;
mod presence;
mod replay;
mod request;
mod serve;
mod session;
mod signals;
#[cfg(target_os = "linux")]
mod socket;
mod stall;
mod state;
mod transmit;
mod wall;
mod weighing;

use std::io::{self, LineWriter, Stdout, Write};
use std::path::PathBuf;

use anyhow::Context as _;
use anyhow::bail;
use cg_core::Warner;
use cg_logs::estimate::{Basis, EstimateOptions, Lift, Method, Truck};
use cg_logs::log::LogOptions;
use cg_logs::state::Owner;
use cg_output::{Files, Kind, Target};
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::sensor_places::Road;
use cg_vehicle::{Vehicle, VehicleError};

use crate::outcome::{Outcome, error_message};
use events::Event;
use frames::Frames;
use learning::Start;
use outputs::Outputs;
use presence::Presence;
use replay::Recording;
use request::SpeedRequest;
use serve::Page;
use session::Session;
use signals::Stop;
use state::StateFile;

use args::{Learn, RunArgs};

/// The notice about a page that others can open.
const OPEN: &str = "every computer that can reach this address can read the page; none can change \
    anything";
/// The notice at the end of a log.
const STAYS: &str = "the log has ended; the page stays until the program is stopped (Ctrl-C)";

pub(crate) fn run(arguments: &RunArgs, files: Files) -> anyhow::Result<Outcome> {
    let [state, metrics] = targets(arguments, files)?;
    refuse_learning(arguments)?;
    refuse_outputs(arguments)?;
    refuse_endless_warnings(arguments)?;
    let vehicle = arguments.truck.load()?;
    refuse_mass(arguments, &vehicle)?;
    let (belief, basis) = arguments.truck.told_belief(&vehicle)?;
    let options = log_options(arguments, &vehicle)?;
    let recording = Recording::open(arguments, &options)?;
    let live = arguments.can.is_some() || arguments.realtime;
    let settings = (options.settings.unwrap_or_default(), options.raised);
    let mass_is_given = arguments.trailer_mass_kg.is_some();
    let mut frames = Frames::new(options.decoder(), settings, mass_is_given, live);
    // The state belongs to the design without what was learned, with the lift axles down.
    let calibration = arguments.truck.calibration(&vehicle)?;
    let owner = |target| {
        let own = design_with(&vehicle, arguments.truck.model, &belief)?;
        let owner = Owner::of(&vehicle, calibration.as_ref(), &own)?;
        Ok::<_, VehicleError>(StateFile::new(target, owner))
    };
    let mut state = state.map(owner).transpose()?;
    let start =
        state.as_mut().map(|state| learned(arguments, (&vehicle, calibration.as_ref()), state));
    let trips = start.as_ref().and_then(|start| start.belief.clone());
    let basis = basis.map(|basis| basis.with_trips(trips.is_some()));
    let belief = trips.unwrap_or(belief);
    let lines: LineWriter<Stdout> = LineWriter::new(io::stdout());
    let mut outputs = Outputs::new(lines, state, metrics, None);
    outputs.page = arguments.serve.as_ref().map(Page::open).transpose()?;
    let mut session = session(arguments, (&vehicle, &belief, basis), outputs)?;
    if arguments.can.is_some() {
        #[allow(clippy::cast_precision_loss)] // microseconds since 1970
        session.tick(wall::now_us() as f64 * 1e-6, 0);
    }
    let stop = Stop::listen()?;
    session.outputs.stop = Some(stop.clone());
    session.trips_in_use = start.as_ref().map_or((0, None), |start| start.trips_in_use);
    let restored = session.restore()?;
    frames.resume(session.lift.position());
    begin(arguments, &vehicle, &mut session, restored)?;
    start.map_or(Ok(()), |start| session.begin(start))?;
    let processed = process(arguments, (recording, &options), &mut frames, &mut session, &stop);
    let ends = stop.is_requested() || processed.is_err();
    let stays = !ends && arguments.is_of_a_file() && session.outputs.page.is_some();
    if stays {
        session.notice("page", STAYS)?;
    }
    if let Err(error) = &processed {
        session.notice("source", &error_message(error))?;
    }
    session.stop(processed.as_ref().map_or("error", |reason| reason))?;
    session.outputs.failed().context("standard output: cannot be written")?;
    processed?;
    if stays {
        stop.wait();
    }
    session.outputs.unsaved()?;
    // A run on a bus without a height ends normally.
    let is_done = arguments.can.is_some() || session.has_height();
    Ok(if is_done { Outcome::Done } else { Outcome::NoAnswer })
}

/// Processes the source until it ends or the program is asked to stop, and returns the reason.
fn process<W: Write>(
    arguments: &RunArgs,
    (recording, options): (Option<Recording<'_>>, &LogOptions),
    frames: &mut Frames,
    session: &mut Session<W>,
    stop: &Stop,
) -> anyhow::Result<&'static str> {
    match (&arguments.can, recording) {
        (Some(interface), _) => {
            let address = arguments.transmit.then_some(arguments.transmit_address);
            Ok(live::run(interface, address, frames, session, stop)?)
        }
        (_, Some(Recording::Frames(path, file))) => {
            let (bus, log) = (options.can.bus.clone(), (path, file));
            replay::candump(log, bus, arguments.realtime, frames, session, stop)
        }
        (_, Some(Recording::Rows(path, rows))) => {
            let settings = options.settings.unwrap_or_default();
            let mass_is_given = arguments.trailer_mass_kg.is_some();
            let (mut presence, log) = (Presence::new(&settings, mass_is_given, &[]), (path, rows));
            replay::csv(log, arguments.realtime, options, &mut presence, session, stop)
        }
        _ => Ok("no source"),
    }
}

/// The processing of samples with the options of this run.
fn session<W: Write>(
    arguments: &RunArgs,
    (vehicle, belief, basis): (&Vehicle, &Belief, Option<Basis>),
    outputs: Outputs<W>,
) -> anyhow::Result<Session<W>> {
    let warner = Warner::new(&arguments.warn, arguments.warn_hysteresis)
        .context("--warn, --warn-hysteresis")?;
    let (mass_kg, options) = (arguments.trailer_mass_kg, identification(arguments, vehicle)?);
    let options = EstimateOptions { basis, ..options };
    let (Truck { design, settings, options }, raised) = Truck::positions(vehicle, belief, options)?;
    let mut session =
        Session::new((&design, options), warner, mass_kg, arguments.status_s, outputs);
    (session.settings, session.lift) = (settings, Lift::new(options.lift_axle, raised));
    session.request = arguments.speed_request.map(SpeedRequest::new);
    session.weighing.sd_kg = arguments.trailer_mass_sd_kg;
    session.weighing.scales = options.scales;
    Ok(session)
}

/// Reports the start, and a state file that cannot be written.
fn begin<W: Write>(
    arguments: &RunArgs,
    vehicle: &Vehicle,
    session: &mut Session<W>,
    restored: bool,
) -> io::Result<()> {
    let (source, version) = (source(arguments), env!("CARGO_PKG_VERSION"));
    let page = session.outputs.page.as_ref().map(|page| (page.url.clone(), page.is_open));
    session.write_event(&Event::Start {
        version,
        vehicle: &vehicle.name,
        source: &source,
        restored,
        method: arguments.method.method,
        page: page.as_ref().map(|(url, _)| url.as_str()),
    })?;
    if let Some(message) = session.outputs.try_state() {
        session.notice("state", &message)?;
    }
    if page.is_some_and(|(_, is_open)| is_open) { session.notice("page", OPEN) } else { Ok(()) }
}

/// The files of state and metrics, if they are written.
fn targets(arguments: &RunArgs, files: Files) -> anyhow::Result<[Option<Target>; 2]> {
    let mut files = arguments
        .truck
        .read(files)
        .reads_some("--dbc", arguments.frames.dbc.as_deref())
        .reads_some("--candump", arguments.candump.as_deref())
        .reads_some("--csv", arguments.csv.as_deref())
        .prints()?;
    let mut target = |flag, path: &Option<PathBuf>, kind| {
        path.as_deref().map(|path| files.writes(flag, path, kind)).transpose()
    };
    Ok([
        target("--state", &arguments.state, Kind::State)?,
        target("--metrics", &arguments.metrics, Kind::Metrics)?,
    ])
}

/// Learning needs a state file.
fn refuse_learning(arguments: &RunArgs) -> anyhow::Result<()> {
    if arguments.learn == Some(Learn::On) && arguments.state.is_none() {
        bail!("--learn on: what is learned is kept in a state file; give --state FILE too");
    }
    Ok(())
}

/// Refuses a mass with which the trailer of this vehicle is impossible.
fn refuse_mass(arguments: &RunArgs, vehicle: &Vehicle) -> anyhow::Result<()> {
    let known = EstimateOptions {
        variant: arguments.truck.model,
        trailer_mass_kg: arguments.trailer_mass_kg,
        ..EstimateOptions::default()
    };
    known.checked(vehicle).map(|_| ()).context("--trailer-mass-kg")
}

/// How the height is identified.
fn identification(arguments: &RunArgs, vehicle: &Vehicle) -> anyhow::Result<EstimateOptions> {
    Ok(EstimateOptions {
        variant: arguments.truck.model,
        method: arguments.method.method,
        order: arguments.method.order()?,
        lift_axle: arguments.truck.lift.lift_axle,
        road: arguments.road.of(vehicle),
        ..EstimateOptions::default()
    })
}

/// What is kept or sent does not say by which method a height was identified.
fn refuse_outputs(arguments: &RunArgs) -> anyhow::Result<()> {
    let method = arguments.method.method;
    let used = [("--state", arguments.state.is_some()), ("--transmit", arguments.transmit)];
    match used.into_iter().find(|(_, used)| *used) {
        Some((option, _)) if method != Method::Filtered => bail!(
            "--method {method}: {option} is for the heights of the method \"filtered\" alone, because \
             noise or wrong dynamics bias those of others; remove one of the two options"
        ),
        _ => Ok(()),
    }
}

/// A warning ends when the share is the hysteresis below its level.
fn refuse_endless_warnings(arguments: &RunArgs) -> anyhow::Result<()> {
    let hysteresis = arguments.warn_hysteresis;
    match arguments.warn.iter().copied().reduce(f64::min) {
        Some(lowest) if hysteresis >= lowest => bail!(
            "--warn-hysteresis {hysteresis}: a warning of the level {lowest} would never end; give a \
             hysteresis below the lowest level of --warn"
        ),
        _ => Ok(()),
    }
}

/// What the truck starts with.
fn learned(
    arguments: &RunArgs,
    (vehicle, calibration): (&Vehicle, Option<&Calibration>),
    state: &mut StateFile,
) -> Start {
    let on = arguments.learn != Some(Learn::Off);
    let (learned, saved_s) = state.learned();
    let learned = learned.on(calibration);
    // A replay begins when the state was saved.
    #[allow(clippy::cast_precision_loss)] // microseconds since 1970
    let now_s = if arguments.can.is_some() { wall::now_us() as f64 * 1e-6 } else { saved_s };
    let mut vehicle = vehicle.clone();
    vehicle.road = arguments.road.of(&vehicle).map(|road| Road { bank_sd_rad: road.bank_sd_rad });
    Start::new((&vehicle, arguments.truck.model), (learned, now_s), on)
}

/// The options for reading the source. Options that do not apply to it are refused.
fn log_options(arguments: &RunArgs, vehicle: &Vehicle) -> anyhow::Result<LogOptions> {
    if arguments.csv.is_some() {
        let why = "--csv has none; remove it, or give --candump or --can instead of --csv";
        arguments.frames.refuse(why)?;
    }
    if arguments.can.is_some() && arguments.frames.bus.is_some() {
        bail!("--bus selects a bus of a log, but --can names the interface; remove --bus");
    }
    let truck = (vehicle, arguments.truck.lift, arguments.truck.model);
    let options = arguments.frames.log_options(&arguments.columns, truck)?;
    if arguments.csv.is_none() {
        arguments.columns.refuse_for_frames(&options)?;
    }
    Ok(options)
}

fn source(arguments: &RunArgs) -> String {
    let path = arguments.candump.as_ref().or(arguments.csv.as_ref());
    match (&arguments.can, path) {
        (Some(interface), _) => interface.clone(),
        (None, Some(path)) => path.display().to_string(),
        (None, None) => String::new(),
    }
}
