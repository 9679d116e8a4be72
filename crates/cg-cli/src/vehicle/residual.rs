//! `cg vehicle residual`: what the equations leave out, as the nonlinear plant of the vehicle shows it.

use std::io::Write;

use anyhow::Context;
use cg_plant::residual::{ModelResidual, model_residual};
use comfy_table::Table;
use comfy_table::presets::NOTHING;
use serde_json::{Value, json};

use super::args::ResidualArgs;
use crate::args::ModelFormat;
use crate::outcome::Outcome;
use crate::truck;

pub(super) fn run(arguments: &ResidualArgs) -> anyhow::Result<Outcome> {
    let (vehicle, _) = truck::load_checked("V.toml", &arguments.vehicle)?;
    let found = model_residual(&vehicle)?;
    let file_sd = vehicle.uncertainty.residual_sd;
    let mut out = std::io::stdout().lock();
    match arguments.format {
        ModelFormat::Json => writeln!(out, "{}", describe(&found, file_sd)),
        ModelFormat::Table => write!(out, "{}", print(&found, file_sd)),
    }
    .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

fn describe(found: &ModelResidual, file_sd: f64) -> Value {
    let channel = |one: &cg_plant::residual::ChannelResidual| {
        json!({
            "channel": one.channel.to_string(),
            "mean": one.mean,
            "spread": one.spread,
            "explained": one.explained,
            "residual_sd": one.residual_sd,
        })
    };
    json!({
        "runs": found.runs,
        "runs_without_ratio": found.without_ratio,
        "channels": found.channels.iter().map(channel).collect::<Vec<_>>(),
        "residual_sd": found.residual_sd(),
        "residual_sd_of_file": file_sd,
    })
}

fn print(found: &ModelResidual, file_sd: f64) -> String {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_header(["channel", "mean", "spread", "explained", "rest"]);
    for one in &found.channels {
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        table.add_row([
            one.channel.to_string(),
            format!("{:+.2} %", 100.0 * one.mean),
            percent(one.spread),
            percent(one.explained),
            percent(one.residual_sd),
        ]);
    }
    let found_sd = found.residual_sd();
    let verdict = if found_sd > file_sd {
        "less than the plant shows: raise it to that"
    } else {
        "the rest is for what neither the plant nor the equations contain"
    };
    format!(
        "identified DC ratio over that of the equations, {} runs of the nonlinear plant (steps, turns on a\n\
         circle, lane changes and drives at one speed; {} more gave no ratio):\n\
         {table}\n\
         mean: a gain, which a calibration removes; spread: from run to run; explained: what an interval\n\
         has for it (identification, measured springs, tires in turns); rest: the residual_sd with which\n\
         the runs differ as their intervals say\n\
         residual_sd: the plant shows {found_sd:.4}, the file says {file_sd}: {verdict}\n",
        found.runs, found.without_ratio
    )
}
