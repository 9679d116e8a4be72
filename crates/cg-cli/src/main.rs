//! `cg`: the centre-of-gravity height of a semitrailer, from logs.
//!
//! | file | what |
//! |---|---|
//! | `cli`, `args` | the arguments; those that several commands share |
//! | `outcome`, `answer` | how a command ended; the answer for one log |
//! | `estimate` | `cg estimate`: logs to heights, in parallel |
//! | `calibrate` | `cg calibrate`: logs with known height to a calibration |
//! | `sink` | their output as table, JSON Lines or CSV |
//! | `report` | the same as a page (`--report`) |
//! | `design` | `cg design`: the constants of a vehicle, for firmware |
//! | `model` | `cg model`: what the vehicle model says |
//! | `simulate`, `sensors` | `cg simulate`: logs with known truth, what sensors make of it |
//! | `rollover` | `cg rollover`: rollover measures of a vehicle under a load |
//! | `run` | `cg run`: live from CAN, or a recorded drive through the same stages |
//! | `reproduce` | `cg reproduce`: the source's tables beside ours |
//! | `truck` | the arguments that say which truck |
//! | `numbers` | arguments that are numbers, and their limits |
//! | `study` | `cg study`: chapter 2 as CSV files and figures |
//! | `words`, `flags` | arguments that are words of a library; flags in the libraries' messages |
//! | `units` | SI to the units of its columns and axes |
//! | `interrupt` | SIGINT and SIGTERM: nothing half-written stays |
//!
//! Exit status: 0 every log has a height, 1 some log has none, 2 bad usage, unreadable input or an
//! output that may not be written; after a signal that of the signal.

mod answer;
mod args;
mod calibrate;
mod can;
mod cli;
mod design;
mod estimate;
mod flags;
#[cfg(unix)]
mod interrupt;
mod model;
mod numbers;
mod outcome;
mod report;
mod reproduce;
mod rollover;
mod run;
mod sensors;
mod simulate;
mod sink;
mod study;
mod truck;
mod units;
mod words;

use std::process::ExitCode;

use cg_logs::output::Files;
use clap::Parser;

use cli::{Cli, Command};
use outcome::{Outcome, tell};

fn main() -> ExitCode {
    match answer(&Cli::parse()) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NoAnswer) => ExitCode::from(1),
        Ok(Outcome::Unreadable) => ExitCode::from(2),
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            tell(&error);
            ExitCode::from(2)
        }
    }
}

fn answer(cli: &Cli) -> anyhow::Result<Outcome> {
    // `cg run` ends in order, in its own time.
    #[cfg(unix)]
    if !matches!(cli.command, Command::Run(_)) {
        interrupt::watch(None)?;
    }
    let files = Files::new(cli.force);
    match &cli.command {
        Command::Estimate(arguments) => estimate::run(arguments, files),
        Command::Calibrate(arguments) => calibrate::run(arguments, files),
        Command::Design(arguments) => design::run(arguments, files),
        Command::Model(arguments) => model::run(arguments),
        Command::Simulate(arguments) => simulate::run(arguments, files),
        Command::Rollover(arguments) => rollover::run(arguments),
        Command::Reproduce(arguments) => reproduce::run(arguments),
        Command::Run(arguments) => run::run(arguments, files),
        Command::Study(arguments) => study::run(arguments, files),
    }
}

/// The reader of our output has seen enough (`cg … | head`): not an error.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
