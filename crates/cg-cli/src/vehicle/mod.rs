//! `cg vehicle`: makes, checks and explains vehicle files.
//!
//! | file | what |
//! |---|---|
//! | `args` | the arguments |
//! | `check` | `cg vehicle check`: findings, loads, thresholds, and the parameters that matter most |
//! | `residual` | `cg vehicle residual`: what the equations leave out |

pub(crate) mod args;
mod check;
mod residual;

use std::io::Write;

use anyhow::Context;
use cg_output::{Draft, Files, Kind};
use cg_vehicle::guide::{page, schema, template};

use self::args::{Command, VehicleArgs};
use crate::outcome::Outcome;

pub(crate) fn run(arguments: &VehicleArgs, mut files: Files) -> anyhow::Result<Outcome> {
    match &arguments.command {
        Command::New(new) => {
            let target = files.writes("--output", &new.output, Kind::Vehicle)?;
            target.write(&template(new.kind))?.map_or(Ok(()), Draft::publish)?;
            Ok(Outcome::Done)
        }
        Command::Check(check) => check::run(check),
        Command::Residual(residual) => residual::run(residual),
        Command::Schema => print(&schema()),
        Command::Doc => print(&page()),
    }
}

fn print(text: &str) -> anyhow::Result<Outcome> {
    let mut out = std::io::stdout().lock();
    write!(out, "{text}").context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}
