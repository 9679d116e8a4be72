//! `cg run`: live, from a CAN interface, or a recorded drive through the same stages.
//!
//! | file | what |
//! |---|---|
//! | `args` | the arguments |
//! | `live`, `socket` | a CAN interface: frames with the kernel's time stamps, errors, coming and going |
//! | `replay` | candump and CSV logs |
//! | `frames`, `clock` | frames to samples, with a time that never jumps |
//! | `session` | samples to events |
//! | `warning` | rollover warning levels |
//! | `events` | the lines on standard output |
//! | `outputs`: `state`, `metrics`, `transmit`, `latency` | what else goes out |
//! | `signals` | the wish to stop |

mod args;
mod clock;
mod events;
mod frames;
mod latency;
mod live;
mod metrics;
mod outputs;
mod replay;
mod session;
mod signals;
mod socket;
mod state;
mod transmit;
mod warning;

use std::io::{self, LineWriter, Stdout};
use std::path::PathBuf;

use cg_vehicle::can::{Decoder, MappedSignal, named};
use cg_vehicle::output::{Files, Kind, Target};

use crate::Outcome;
use clock::Clock;
use events::Event;
use frames::Frames;
use outputs::Outputs;
use session::Session;
use signals::Stop;
use state::StateFile;
use warning::Warner;

pub(crate) use args::RunArgs;

pub(crate) fn run(arguments: &RunArgs, files: Files) -> anyhow::Result<Outcome> {
    let [state, metrics] = targets(arguments, files)?;
    let vehicle = arguments.truck.load()?;
    let design = arguments.truck.design(&vehicle)?;
    let decoder = decoder(arguments)?;
    let live = arguments.can.is_some() || arguments.realtime;
    let settings = vehicle.align_settings();
    let mut frames = Frames::new(decoder, settings, live);
    let state = state.map(|target| StateFile::new(target, &design));
    let lines: LineWriter<Stdout> = LineWriter::new(io::stdout());
    let outputs = Outputs::new(lines, state, metrics, None);
    let warner = Warner::new(arguments.warn.clone(), arguments.warn_hysteresis);
    let mass_kg = arguments.trailer_mass_kg;
    let mut session = Session::new(&design, warner, mass_kg, arguments.status_s, outputs);
    if arguments.can.is_some() {
        #[allow(clippy::cast_precision_loss)] // microseconds since 1970
        session.tick(socket::wall_us() as f64 * 1e-6, 0);
    }
    let stop = Stop::listen()?;
    let restored = session.restore()?;
    let source = source(arguments);
    let version = env!("CARGO_PKG_VERSION");
    session.say(Event::Start { version, vehicle: &vehicle.name, source: &source, restored })?;
    let reason = match (&arguments.can, &arguments.candump, &arguments.csv) {
        (Some(interface), ..) => {
            let address = arguments.transmit.then_some(arguments.transmit_address);
            live::run(interface, address, &mut frames, &mut session, &stop)?
        }
        (_, Some(path), _) => {
            replay::candump(path, arguments.realtime, &mut frames, &mut session, &stop)?
        }
        (.., Some(path)) => {
            let clock = (Clock::default(), settings);
            let options = arguments.columns.options();
            replay::csv(path, arguments.realtime, &options, clock, &mut session, &stop)?
        }
        _ => "no source",
    };
    session.stop(reason)?;
    // Live, an end without a height is an end like any other.
    Ok(if live || session.has_height() { Outcome::Done } else { Outcome::NoAnswer })
}

/// State and metrics, where they are wanted.
fn targets(arguments: &RunArgs, files: Files) -> anyhow::Result<[Option<Target>; 2]> {
    let mut files = arguments
        .truck
        .read(files)
        .reads_some("--dbc", arguments.dbc.as_deref())
        .reads_some("--candump", arguments.candump.as_deref())
        .reads_some("--csv", arguments.csv.as_deref());
    let mut target = |flag, path: &Option<PathBuf>, kind| {
        path.as_deref().map(|path| files.writes(flag, path, kind)).transpose()
    };
    Ok([
        target("--state", &arguments.state, Kind::State)?,
        target("--metrics", &arguments.metrics, Kind::Metrics)?,
    ])
}

fn decoder(arguments: &RunArgs) -> anyhow::Result<Decoder> {
    let mapped = match &arguments.dbc {
        Some(path) => MappedSignal::load(path, &arguments.signal)?,
        None => Vec::new(),
    };
    let flipped = arguments.columns.options().flip;
    let flipped = flipped.iter().filter_map(|signal| named(signal.name()).ok()).collect();
    Ok(Decoder::new(mapped, arguments.source_of.clone(), flipped))
}

fn source(arguments: &RunArgs) -> String {
    let path = arguments.candump.as_ref().or(arguments.csv.as_ref());
    match (&arguments.can, path) {
        (Some(interface), _) => interface.clone(),
        (None, Some(path)) => path.display().to_string(),
        (None, None) => String::new(),
    }
}
