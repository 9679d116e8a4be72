//! `cg design`: the constants of one truck, for firmware.

use std::path::Path;

use anyhow::{Context, anyhow};
use cg_core::Design;
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::emit::{Language, emit};
use cg_vehicle::{Variant, Vehicle};

use crate::Outcome;
use crate::cli::DesignArgs;
use crate::draft::Draft;

pub(crate) fn run(arguments: &DesignArgs) -> anyhow::Result<Outcome> {
    let vehicle = Vehicle::load(&arguments.vehicle)?;
    let design = of(&vehicle, arguments.calibration.as_deref(), arguments.model.into())?.cast();
    // Single precision narrows ranges and joins neighbours: checked as the firmware would.
    design.validate().context("in single precision")?;
    let language: Language = arguments.emit.into();
    let text = emit(&design, language, &comment(arguments, &vehicle));
    Draft::write(&arguments.output, "--output", &text)?.publish()?;
    Ok(Outcome::Done)
}

/// The design of a vehicle as its file says, or as a calibration does.
pub(crate) fn of(
    vehicle: &Vehicle,
    calibration: Option<&Path>,
    variant: Variant,
) -> anyhow::Result<Design<f64>> {
    let belief = match calibration {
        Some(path) => {
            let calibration = Calibration::load(path, vehicle)?;
            if calibration.model != variant {
                return Err(anyhow!(
                    "{}: made for the other model; give the same --model as to cg calibrate",
                    path.display()
                ));
            }
            calibration.belief()
        }
        None => Belief::prior(vehicle),
    };
    Ok(design_with(vehicle, variant, &belief)?)
}

/// What it is of, and how to make it again.
fn comment(arguments: &DesignArgs, vehicle: &Vehicle) -> Vec<String> {
    let option = |flag: &str, path: Option<&Path>| {
        path.map_or_else(String::new, |path| format!(" {flag} {}", path.display()))
    };
    let calibration = arguments.calibration.as_deref();
    let calibrated = match calibration {
        Some(path) => format!("calibrated by {}", path.display()),
        None => "not calibrated".to_owned(),
    };
    vec![
        format!("Design of the vehicle \"{}\", {calibrated}.", vehicle.name),
        "Make it again, do not edit it:".to_owned(),
        format!(
            "cg design{}{} --model {} --emit {}{}",
            option("--vehicle", Some(&arguments.vehicle)),
            option("--calibration", calibration),
            crate::cli::word(&arguments.model),
            crate::cli::word(&arguments.emit),
            option("--output", Some(&arguments.output))
        ),
    ]
    .into_iter()
    // A line break in a name would end the comment.
    .map(|line| line.replace(char::is_control, " "))
    .collect()
}
