//! `cg rollover`: rollover measures of a loaded vehicle.

use std::io::Write;

use anyhow::Context;
use cg_plant::rollover::{Curve, RolloverMeasures, RolloverOptions, measures};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::{Map, Value, json};

use crate::args::ModelFormat;
use crate::cli::RolloverArgs;
use crate::outcome::Outcome;
use crate::truck;

pub(crate) fn run(arguments: &RolloverArgs) -> anyhow::Result<Outcome> {
    let vehicle = arguments.lift.of(&truck::load(&arguments.vehicle)?)?;
    let load = arguments.load.load(&vehicle);
    let options = RolloverOptions {
        speed_mps: arguments.speed_mps.unwrap_or(vehicle.nominal_speed_mps),
        lateral_acceleration_g: arguments.lateral_acceleration_g,
        gate_m: arguments.gate_m,
        payload_left_m: arguments.payload_left_m,
        curve: arguments.radius_m.map(|radius_m| Curve {
            radius_m,
            share: arguments.share,
            height_sd_m: arguments.height_sd_m,
        }),
    };
    let all = measures(&vehicle, load, &options)?;
    let mut out = std::io::stdout().lock();
    let written = match arguments.format {
        ModelFormat::Json => {
            let mut object = Map::new();
            object.insert("vehicle".into(), json!(vehicle.name));
            object.insert("speed_mps".into(), json!(options.speed_mps));
            object.insert("height_m".into(), json!(load.cg_height_m));
            object.insert("trailer_mass_kg".into(), json!(load.trailer_mass_kg));
            object.insert("payload_left_m".into(), json!(options.payload_left_m));
            describe(&mut object, &all);
            // The line is formatted first, so that it is written completely or not at all.
            writeln!(out, "{}", Value::Object(object))
        }
        ModelFormat::Table => {
            let head = format!(
                "{}: {:.2} m/s, c.g. height {:.3} m, trailer {:.0} kg",
                vehicle.name, options.speed_mps, load.cg_height_m, load.trailer_mass_kg
            );
            print(&mut out, &head, &all)
        }
    };
    written.context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

fn describe(object: &mut Map<String, Value>, all: &RolloverMeasures) {
    let mut meanings = Map::new();
    for measure in &all.measures {
        object.insert(measure.name.into(), json!(measure.value));
        meanings.insert(measure.name.into(), json!(measure.meaning));
    }
    object.insert("rearward_amplification_over_hz".into(), json!(all.rearward_amplification));
    object.insert("meaning".into(), Value::Object(meanings));
}

fn print(out: &mut impl Write, head: &str, all: &RolloverMeasures) -> std::io::Result<()> {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    for measure in &all.measures {
        let value = measure.value.map_or_else(|| "none".to_owned(), |value| format!("{value:.3}"));
        let unit = if measure.unit == "-" { "" } else { measure.unit };
        // The unit has its own column here.
        let bare = measure.name.rsplit_once('_').filter(|_| !unit.is_empty());
        let name = bare.map_or(measure.name, |(name, _)| name);
        table.add_row([name.replace('_', " "), value, unit.to_owned(), measure.meaning.clone()]);
    }
    if let Some(column) = table.column_mut(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    writeln!(out, "{head}\n\n{}", table.trim_fmt())?;
    let curve: Vec<String> = all
        .rearward_amplification
        .iter()
        .filter(|(hz, _)| (hz * 10.0).fract().abs() < 1e-9 || (hz * 10.0).fract() > 1.0 - 1e-9)
        .map(|(hz, ratio)| format!("{hz:.1} Hz {ratio:.2}"))
        .collect();
    writeln!(out, "\n Rearward amplification, linear, 88 km/h: {}", curve.join(", "))
}
