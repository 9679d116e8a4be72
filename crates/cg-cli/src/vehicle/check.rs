//! `cg vehicle check`: findings, loads, thresholds, and the parameters that matter most.

use std::io::Write;

use anyhow::Context;
use cg_core::Channel;
use cg_vehicle::assumptions::Assumption;
use cg_vehicle::balance::{StaticBalance, static_balance};
use cg_vehicle::belief::Belief;
use cg_vehicle::design::design;
use cg_vehicle::finding::{Finding, Severity};
use cg_vehicle::influence::{Influence, Influences, influences};
use cg_vehicle::second_sensor::SecondShare;
use cg_vehicle::slip::USUAL_G;
use cg_vehicle::steady_turn::steady_turn_threshold_g;
use cg_vehicle::vehicle::Tyre;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::{Value, json};

use super::args::CheckArgs;
use crate::args::ModelFormat;
use crate::outcome::Outcome;
use crate::truck;

/// Number of parameters in the table.
const MOST: usize = 5;

/// What is computed for one load.
struct Loaded {
    name: &'static str,
    load: Load,
    balance: StaticBalance,
    threshold_g: f64,
}

impl Loaded {
    fn new(
        name: &'static str,
        load: Load,
        vehicle: &Vehicle,
        speed_mps: f64,
    ) -> Result<Self, VehicleError> {
        load.check()?;
        let balance = static_balance(vehicle, load)?;
        let threshold_g = steady_turn_threshold_g(vehicle, load, speed_mps)?;
        Ok(Self { name, load, balance, threshold_g })
    }

    /// With the axles of the file that are raised, which carry nothing.
    fn with_raised_axles(mut self, vehicle: &Vehicle) -> Self {
        for (i, axle) in vehicle.trailer.axle.iter().enumerate() {
            if axle.lift_m.is_some() {
                self.balance.axle_load_n.insert(vehicle.tractor.axle.len() + i, 0.0);
            }
        }
        self
    }
}

/// Everything that the command prints.
struct Report {
    vehicle: Vehicle,
    findings: Vec<Finding>,
    speed_mps: f64,
    /// Empty and laden.
    loads: [Loaded; 2],
    /// The same with the lift axles raised.
    raised: Option<[Loaded; 2]>,
    influences: Influences,
    /// The share of the second roll sensor: that of the file, and the best one.
    second_roll: Option<[SecondShare; 2]>,
    tyres: Vec<Slopes>,
}

/// Cornering stiffness of a tire with a slip table at its greatest static load.
struct Slopes {
    tyre: String,
    load_n: f64,
    file: f64,
    at_zero_slip: f64,
    secant: f64,
}

pub(super) fn run(arguments: &CheckArgs) -> anyhow::Result<Outcome> {
    let (vehicle, findings) = truck::load_checked("V.toml", &arguments.vehicle)?;
    let report = report(arguments, vehicle, findings)?;
    let mut out = std::io::stdout().lock();
    match arguments.format {
        // The line is formatted first, so that it is written completely or not at all.
        ModelFormat::Json => writeln!(out, "{}", describe(&report)),
        ModelFormat::Table => print(&mut out, &report),
    }
    .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

fn report(
    arguments: &CheckArgs,
    vehicle: Vehicle,
    findings: Vec<Finding>,
) -> anyhow::Result<Report> {
    let speed_mps = arguments.speed_mps.unwrap_or(vehicle.nominal_speed_mps);
    let laden = arguments.load.load(&vehicle);
    let empty = vehicle.empty_load();
    let loads = [
        Loaded::new("empty", empty, &vehicle, speed_mps)?,
        Loaded::new("laden", laden, &vehicle, speed_mps)?,
    ];
    // What every estimate needs.
    design(&vehicle, Variant::Complete)?;
    let raised = match vehicle.raised()? {
        Some(raised) => {
            design(&raised, Variant::Complete)?;
            let [empty, laden] = [raised.empty_load(), arguments.load.load(&raised)];
            let loads = [
                Loaded::new("empty_raised", empty, &raised, speed_mps)?,
                Loaded::new("laden_raised", laden, &raised, speed_mps)?,
            ];
            Some(loads.map(|loaded| loaded.with_raised_axles(&vehicle)))
        }
        None => None,
    };
    let influences = influences(&vehicle, &Belief::prior(&vehicle), speed_mps, laden)?;
    let share = vehicle.sensors.roll.second_share.unwrap_or(0.5);
    let second_roll = match SecondShare::best(&vehicle)? {
        Some(best) => Some([SecondShare::of(&vehicle, share)?, best]),
        None => None,
    };
    let tyres = slopes(&vehicle, &loads[1].balance);
    Ok(Report { vehicle, findings, speed_mps, loads, raised, influences, second_roll, tyres })
}

impl Report {
    /// Every load, in the order of the columns.
    fn all_loads(&self) -> impl Iterator<Item = &Loaded> {
        self.loads.iter().chain(self.raised.iter().flatten())
    }
}

fn slopes(vehicle: &Vehicle, laden: &StaticBalance) -> Vec<Slopes> {
    let axles = vehicle.axles();
    let of_tyre = |tyre: &Tyre| {
        let own =
            axles.iter().zip(&laden.axle_load_n).filter(|(axle, _)| axle.tyre.name == tyre.name);
        let load_n = own.map(|(axle, load_n)| load_n / axle.tyres()).fold(0.0, f64::max);
        let table = tyre.lateral_force.as_ref()?;
        let [at_zero_slip, secant] = table.slopes_n_per_rad(load_n, USUAL_G)?;
        let file = tyre.stiffness_at(load_n).0;
        Some(Slopes { tyre: tyre.name.clone(), load_n, file, at_zero_slip, secant })
    };
    vehicle.tyre.iter().filter_map(of_tyre).collect()
}

fn describe(report: &Report) -> Value {
    let vehicle = &report.vehicle;
    let kg = |load_n: f64| load_n / vehicle.gravity_mps2;
    let finding = |finding: &Finding| {
        json!({
            "severity": if finding.severity == Severity::Error { "error" } else { "warning" },
            "line": finding.line,
            "column": finding.column,
            "key": finding.key,
            "value": finding.value,
            "problem": finding.problem,
            "usual": finding.usual,
            "remedy": finding.remedy,
        })
    };
    let mut object = json!({
        "vehicle": vehicle.name,
        "speed_mps": report.speed_mps,
        "findings": report.findings.iter().map(finding).collect::<Vec<_>>(),
        "parameters": report.influences.parameters.iter().map(|one| json!({
            "parameter": one.parameter,
            "sd": one.sd,
            "height_relative_sd": of_channels(one.height_sd),
        })).collect::<Vec<_>>(),
        "height_relative_sd": of_channels(report.influences.height_sd),
    });
    if let Some(shares) = &report.second_roll {
        let [file, best] = shares.map(|one| {
            let [empty, laden] = one.height_sd;
            json!({ "share": one.share, "height_relative_sd": { "empty": empty, "laden": laden } })
        });
        object["second_roll_sensor"] = json!({ "file": file, "best": best });
    }
    let notes = Assumption::of(vehicle);
    object["notes"] = notes.iter().map(|one| json!({ "key": one.key, "note": one.note })).collect();
    object["tyres"] = report
        .tyres
        .iter()
        .map(|one| {
            json!({
                "name": one.tyre,
                "load_n": one.load_n,
                "cornering_stiffness_n_per_rad": one.file,
                "at_zero_slip_n_per_rad": one.at_zero_slip,
                "secant_n_per_rad": one.secant,
            })
        })
        .collect();
    for loaded in report.all_loads() {
        let axles = loaded.balance.axle_load_n.iter().map(|n| kg(*n)).collect::<Vec<_>>();
        object[loaded.name] = json!({
            "trailer_mass_kg": loaded.load.trailer_mass_kg,
            "height_m": loaded.load.cg_height_m,
            "axle_load_kg": axles,
            "fifth_wheel_load_kg": kg(loaded.balance.hitch_load_n),
            "rollover_threshold_g": loaded.threshold_g,
        });
    }
    object
}

fn of_channels(values: [f64; Channel::ALL.len()]) -> Value {
    let named = Channel::ALL.map(|channel| (channel.to_string(), json!(values[channel.index()])));
    Value::Object(named.into_iter().collect())
}

fn print(out: &mut impl Write, report: &Report) -> std::io::Result<()> {
    let findings = match report.findings.len() {
        0 => "no findings".to_owned(),
        1 => "1 warning, see above".to_owned(),
        n => format!("{n} warnings, see above"),
    };
    writeln!(out, "{}: {findings}", report.vehicle.name)?;
    for one in Assumption::of(&report.vehicle) {
        writeln!(out, "Note on {}: {}", one.key, one.note)?;
    }
    let [_, laden] = &report.loads;
    writeln!(
        out,
        "Laden: trailer {:.0} kg, c.g. height {:.3} m; both at {:.2} m/s\n\n{}",
        laden.load.trailer_mass_kg,
        laden.load.cg_height_m,
        report.speed_mps,
        loads(report).trim_fmt()
    )?;
    writeln!(
        out,
        "\nStandard deviation of the laden height in % of it, by the pair of signals (channel), \
         before a calibration\n\n{}",
        parameters(&report.influences).trim_fmt()
    )?;
    if let Some(shares) = &report.second_roll {
        print_second_roll(out, &report.vehicle, shares)?;
    }
    if report.tyres.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\nCornering stiffness at the greatest laden load of a tire, kN/rad: that of the file should be \
         the secant at {USUAL_G} g in the slip table\n\n{}",
        tyres(&report.tyres).trim_fmt()
    )
}

fn print_second_roll(
    out: &mut impl Write,
    vehicle: &Vehicle,
    [file, best]: &[SecondShare; 2],
) -> std::io::Result<()> {
    let named = match vehicle.sensors.roll.second_share {
        Some(_) => "sensors.roll.second_share = ",
        None => "The roll angle is the mean of two sensors: a share of ",
    };
    let sd = |one: &SecondShare| one.height_sd.map(|sd| format!("{:.1}", 100.0 * sd));
    let ([empty, laden], [best_empty, best_laden]) = (sd(file), sd(best));
    writeln!(
        out,
        "\n{named}{:.2} leaves {empty} % (empty) and {laden} % (laden) in the channel \
         lateral-acceleration; the best share, {:.2}, would leave {best_empty} % and {best_laden} %",
        file.share, best.share
    )
}

fn tyres(all: &[Slopes]) -> Table {
    let kilo = |n: f64| format!("{:.1}", n / 1e3);
    let row = |one: &Slopes| {
        let values = [one.load_n, one.file, one.at_zero_slip, one.secant].map(kilo);
        std::iter::once(one.tyre.clone()).chain(values).collect()
    };
    plain(vec!["tire", "load kN", "file", "at zero slip", "secant"], all.iter().map(row))
}

/// A table without lines whose columns are aligned to the right, except the first.
fn plain(header: Vec<&str>, rows: impl IntoIterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_header(header).add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn loads(report: &Report) -> Table {
    let vehicle = &report.vehicle;
    let tons = |load_n: f64| format!("{:.2} t", load_n / vehicle.gravity_mps2 / 1e3);
    let row = |name: &str, value: &dyn Fn(&Loaded) -> String| {
        std::iter::once(name.to_owned()).chain(report.all_loads().map(value)).collect()
    };
    let mut rows = Vec::new();
    let tractor = vehicle.tractor.axle.len();
    for (i, axle) in vehicle.axles().iter().enumerate() {
        let name = match (axle.on_trailer, axle.steered) {
            (true, _) => format!("trailer axle {}", i + 1 - tractor),
            (false, true) => format!("tractor axle {}, steered", i + 1),
            (false, false) => format!("tractor axle {}", i + 1),
        };
        rows.push(row(&name, &|loaded| tons(loaded.balance.axle_load_n[i])));
    }
    rows.push(row("all axles", &|loaded| tons(loaded.balance.axle_load_n.iter().sum())));
    rows.push(row("fifth wheel", &|loaded| tons(loaded.balance.hitch_load_n)));
    rows.push(row("c.g. height of the trailer", &|loaded| {
        format!("{:.2} m", loaded.load.cg_height_m)
    }));
    rows.push(row("rollover threshold", &|loaded| format!("{:.2} g", loaded.threshold_g)));
    let mut header = vec!["", "empty", "laden"];
    if report.raised.is_some() {
        header.extend(["empty, raised", "laden, raised"]);
    }
    plain(header, rows)
}

fn parameters(all: &Influences) -> Table {
    let percent = |values: [f64; Channel::ALL.len()]| {
        Channel::ALL.map(|channel| format!("{:.1}", 100.0 * values[channel.index()]))
    };
    let sd = |one: &Influence| {
        if one.parameter.is_factor() {
            format!("{:.0} %", 100.0 * one.sd)
        } else {
            format!("{:.2} m", one.sd)
        }
    };
    let mut rows: Vec<Vec<String>> = all
        .parameters
        .iter()
        .take(MOST)
        .map(|one| {
            let mut row = vec![one.parameter.words().to_owned(), sd(one)];
            row.extend(percent(one.height_sd));
            row
        })
        .collect();
    let mut together = vec!["all parameters and the rest of the model".to_owned(), String::new()];
    together.extend(percent(all.height_sd));
    rows.push(together);
    let mut header = vec!["these matter most", "sd"];
    let words: Vec<String> = Channel::ALL.iter().map(ToString::to_string).collect();
    header.extend(words.iter().map(String::as_str));
    plain(header, rows)
}
