//! `cg design`: the constants of one truck for firmware.

use std::path::Path;

use anyhow::{Context, anyhow};
use cg_core::{Channel, Design};
use cg_output::{Draft, Files, Kind};
use cg_vehicle::Vehicle;
use cg_vehicle::emit::emit;

use crate::cli::DesignArgs;
use crate::outcome::Outcome;

pub(crate) fn run(arguments: &DesignArgs, files: Files) -> anyhow::Result<Outcome> {
    let target = arguments.truck.read(files).writes("--output", &arguments.output, Kind::Design)?;
    let vehicle = arguments.truck.load()?;
    let chosen = <[Channel; 2]>::try_from(arguments.channels.as_slice()).ok();
    let chosen = chosen.filter(|[first, second]| first != second).ok_or_else(|| {
        anyhow!("--channels: expected two different channels, such as suspension,tractor")
    })?;
    let all = arguments.truck.design(&vehicle)?;
    let design: Design<f32, 2> =
        all.with_channels(chosen).context("--channels: the design has no such channel")?.cast();
    // In single precision, ranges are narrower and neighboring values may become equal. The check
    // is the same as in the firmware.
    design.validate().context("in single precision")?;
    let text = emit(&design, arguments.emit, &comment(arguments, &vehicle));
    target.write(&text)?.map_or(Ok(()), Draft::publish)?;
    Ok(Outcome::Done)
}

/// A comment with the source of the design and the command that writes it.
fn comment(arguments: &DesignArgs, vehicle: &Vehicle) -> Vec<String> {
    let option = |flag: &str, path: Option<&Path>| {
        path.map_or_else(String::new, |path| format!(" {flag} {}", path.display()))
    };
    let truck = &arguments.truck;
    let calibration = truck.calibration.as_deref();
    let calibrated = match calibration {
        Some(path) => format!("calibrated by {}", path.display()),
        None => "not calibrated".to_owned(),
    };
    let position = truck.lift.lift_axle.unwrap_or_default();
    let lift =
        if vehicle.has_lift_axle() { format!(", lift axle {position}") } else { String::new() };
    vec![
        format!("Design of the vehicle \"{}\", {calibrated}{lift}.", vehicle.name),
        "Make it again, do not edit it:".to_owned(),
        format!(
            "cg design{}{} --model {}{} --emit {} --channels {}{}",
            option("--vehicle", Some(&truck.vehicle)),
            option("--calibration", calibration),
            truck.model,
            truck.lift.lift_axle.map_or_else(String::new, |one| format!(" --lift-axle {one}")),
            arguments.emit,
            arguments.channels.iter().map(ToString::to_string).collect::<Vec<_>>().join(","),
            option("--output", Some(&arguments.output))
        ),
    ]
    .into_iter()
    // A line break in a name would end the comment.
    .map(|line| line.replace(char::is_control, " "))
    .collect()
}
