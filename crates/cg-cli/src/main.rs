//! `cg`: the command-line program that estimates the center-of-gravity height of a semitrailer.
//!
//! | file | what |
//! |---|---|
//! | `cli`, `args` | the arguments; those that several commands share |
//! | `outcome`, `answer` | the exit status of a command; the result for one log |
//! | `estimate` | `cg estimate`: heights from logs, in parallel |
//! | `calibrate` | `cg calibrate`: a calibration from logs with known height |
//! | `sink` | output of heights as table, JSON Lines or CSV |
//! | `design` | `cg design`: the constants of a vehicle for firmware |
//! | `model` | `cg model`: properties of the vehicle model |
//! | `simulate`, `sensors` | `cg simulate`: logs with known truth; errors of the sensors |
//! | `fmu` | `cg fmu`: plant or estimator as a functional mock-up unit |
//! | `rollover` | `cg rollover`: rollover measures of a loaded vehicle |
//! | `run` | `cg run`: live estimates from CAN, or a replay of a recorded drive |
//! | `reproduce` | `cg reproduce`: the thesis's tables, recomputed |
//! | `vehicle` | `cg vehicle`: makes, checks and explains vehicle files |
//! | `truck` | the arguments that select the truck |
//! | `numbers` | arguments that are numbers, and their limits |
//! | `study` | `cg study`: the studies of chapter 2 as CSV files and figures |
//! | `words`, `flags` | arguments that are words of a library; flags in the libraries' messages |
//! | `units` | conversion from SI to the units of columns and axes |
//! | `interrupt` | SIGINT and SIGTERM (`interrupt_console`: Ctrl-C on Windows), without incomplete files |
//!
//! Exit status: 0 every log has a height; 1 some log has no height; 2 wrong usage, an input that
//! cannot be read, or an output that may not be written. After a signal it is that of the signal.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod answer;
mod args;
mod calibrate;
mod can;
mod cli;
mod design;
mod estimate;
mod flags;
mod fmu;
#[cfg_attr(windows, path = "interrupt_console.rs")]
mod interrupt;
mod model;
mod numbers;
mod outcome;
mod reproduce;
mod rollover;
mod run;
mod sensors;
mod simulate;
mod sink;
mod study;
mod truck;
mod truth;
mod units;
mod vehicle;
mod words;

use std::process::ExitCode;

use cg_output::Files;
use clap::Parser;

use cli::{Cli, Command};
use outcome::{Outcome, is_closed_pipe, print_error};

fn main() -> ExitCode {
    // The shells of Windows leave wildcards such as `*.csv` to the program.
    match answer(&Cli::parse_from(wild::args_os())) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NoAnswer) => ExitCode::from(1),
        Ok(Outcome::Unreadable) => ExitCode::from(2),
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            print_error(&error);
            ExitCode::from(2)
        }
    }
}

fn answer(cli: &Cli) -> anyhow::Result<Outcome> {
    // `cg run` handles signals itself, so that it can save its state.
    if !matches!(cli.command, Command::Run(_)) {
        interrupt::handle_signals(None)?;
    }
    let files = Files::new(cli.force);
    match &cli.command {
        Command::Estimate(arguments) => estimate::run(arguments, files),
        Command::Calibrate(arguments) => calibrate::run(arguments, files),
        Command::Design(arguments) => design::run(arguments, files),
        Command::Model(arguments) => model::run(arguments),
        Command::Simulate(arguments) => simulate::run(arguments, files),
        Command::Fmu(arguments) => fmu::run(arguments, files),
        Command::Rollover(arguments) => rollover::run(arguments),
        Command::Reproduce(arguments) => reproduce::run(arguments, files),
        Command::Run(arguments) => run::run(arguments, files),
        Command::Study(arguments) => study::run(arguments, files),
        Command::Vehicle(arguments) => vehicle::run(arguments, files),
    }
}
