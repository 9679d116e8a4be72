//! Checks names, lengths of lists, and the order of axles.

use toml::{Table, Value};

use super::keys::{Key, Kind};
use super::table::TABLES;
use crate::finding::{Finding, Severity};
use crate::tables::Spring;
use crate::vehicle::{Axle, Tyre, Vehicle};

/// Greatest number of axles of one unit; heavy-haulage modules have fewer.
const MOST_AXLES: usize = 20;
/// Greatest length of a name in bytes, because names are printed in reports and file headers.
const LONGEST_NAME: usize = 200;

/// Unknown keys of axles, and values of the wrong type. The structure of an axle is flattened into
/// another one, and then serde reports neither of them with its position.
pub(super) fn axle_keys(root: &Table) -> Vec<Finding> {
    let mut found = Vec::new();
    for unit in ["tractor", "trailer"] {
        let place = format!("{unit}.axle[i]");
        let tables = TABLES.iter().filter(|table| table.paths.contains(&place.as_str()));
        let known: Vec<(&Key, bool)> = tables
            .flat_map(|table| table.keys.iter().map(|key| (key, table.paths.len() > 1)))
            .collect();
        let axles = root.get(unit).and_then(|unit| unit.get("axle")).and_then(|a| a.as_array());
        for (i, axle) in axles.into_iter().flatten().enumerate() {
            for (name, value) in axle.as_table().into_iter().flatten() {
                let problem = match known.iter().find(|(key, _)| key.name == name) {
                    None => {
                        let names: Vec<&str> = known.iter().map(|(key, _)| key.name).collect();
                        format!("unknown key; expected one of {}", names.join(", "))
                    }
                    Some((key, true)) if !is_of(value, key.kind) => {
                        format!("is of the wrong type, expected {}", type_of(key.kind))
                    }
                    Some(_) => continue,
                };
                found.push(Finding::error(format!("{unit}.axle[{i}].{name}"), value, problem));
            }
        }
    }
    found
}

fn is_of(value: &Value, kind: Kind) -> bool {
    let number = |value: &Value| value.is_float() || value.is_integer();
    match kind {
        Kind::Text => value.is_str(),
        Kind::Flag => value.is_bool(),
        Kind::Whole => value.as_integer().is_some_and(|number| u32::try_from(number).is_ok()),
        Kind::Number(_) => number(value),
        Kind::Numbers(_) => value.as_array().is_some_and(|list| list.iter().all(number)),
        Kind::Rows(_) => value.is_array(),
    }
}

const fn type_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Text => "text in quotes",
        Kind::Flag => "true or false",
        Kind::Whole => "a whole number from 0",
        Kind::Number(_) => "a number",
        Kind::Numbers(_) => "a list of numbers",
        Kind::Rows(_) => "a list of lists of numbers",
    }
}

/// All findings except numbers outside their ranges.
pub(super) fn findings(v: &Vehicle) -> Vec<Finding> {
    let mut found = Vec::new();
    names(v, &mut found);
    heights_and_masses(v, &mut found);
    let roll = &v.sensors.roll;
    if let (Some(share), None) = (roll.second_share, roll.second_behind_hitch_m) {
        let problem = "needs the place of the second sensor, sensors.roll.second_behind_hitch_m";
        found.push(Finding::error("sensors.roll.second_share", share, problem));
    }
    axles(v, &mut found);
    for (i, tyre) in v.tyre.iter().enumerate() {
        tyre_tables(&format!("tyre[{i}]"), tyre, &mut found);
    }
    for (i, spring) in v.spring.iter().enumerate() {
        spring_table(&format!("spring[{i}]"), spring, &mut found);
    }
    as_printed(v, &mut found);
    found
}

fn names(v: &Vehicle, found: &mut Vec<Finding>) {
    let tyres: Vec<&str> = v.tyre.iter().map(|tyre| tyre.name.as_str()).collect();
    let springs: Vec<&str> = v.spring.iter().map(|spring| spring.name.as_str()).collect();
    one_line("name", &v.name, found);
    for (list, names) in [("tyre", &tyres), ("spring", &springs)] {
        for (i, name) in names.iter().enumerate() {
            let key = format!("{list}[{i}].name");
            one_line(&key, name, found);
            if names[..i].contains(name) {
                let problem = format!("another [[{list}]] has this name; give each its own");
                found.push(Finding::error(key, format!("{name:?}"), problem));
            }
        }
    }
}

fn one_line(key: &str, name: &str, found: &mut Vec<Finding>) {
    if name.trim().is_empty() || name.len() > LONGEST_NAME || name.chars().any(char::is_control) {
        let problem = format!("must be one line of text, up to {LONGEST_NAME} bytes");
        found.push(Finding::error(key, format!("{name:?}"), problem));
    }
}

fn heights_and_masses(v: &Vehicle, found: &mut Vec<Finding>) {
    let (least, greatest) = (v.height.least_m, v.height.greatest_m);
    if !(greatest > least) {
        found.push(Finding::error(
            "height.greatest_m",
            greatest,
            format!("must be above height.least_m = {least}"),
        ));
    }
    let reference = v.trailer.reference_cg_height_m;
    if !(reference > least && reference < greatest) {
        let problem =
            format!("must lie between height.least_m = {least} and height.greatest_m = {greatest}");
        found.push(Finding::error("trailer.reference_cg_height_m", reference, problem));
    }
    let (mass, empty) = (v.trailer.reference_mass_kg, v.empty_trailer_mass_kg());
    if mass < empty {
        let problem = format!(
            "must be at least the empty trailer's {empty} kg: trailer.tare.sprung_mass_kg and the \
             trailer's axles, unsprung_mass_kg"
        );
        found.push(Finding::error("trailer.reference_mass_kg", mass, problem));
    }
    if v.hitch.lash_rad > 0.0 && v.hitch.separation_moment_nm.is_none() {
        let problem =
            "needs hitch.separation_moment_nm: the plates are free only after they have separated";
        found.push(Finding::error("hitch.lash_rad", v.hitch.lash_rad, problem));
    }
    for (path, readings) in v.pressure_readings() {
        for (key, [first, second]) in
            [("gauge_pa", readings.gauge_pa), ("axle_load_kg", readings.axle_load_kg)]
        {
            if !(second > first) {
                found.push(Finding::error(
                    format!("{path}.{key}"),
                    second,
                    "the second reading must be greater than the first",
                ));
            }
        }
    }
}

fn axles(v: &Vehicle, found: &mut Vec<Finding>) {
    if !v.tractor.axle.iter().any(|a| a.steered) {
        let (key, n) = ("tractor.axle", v.tractor.axle.len());
        found.push(Finding::error(key, n, "one axle must have steered = true"));
    }
    let lift_m = v.trailer.axle.iter().map(|a| a.lift_m).collect::<Option<Vec<f64>>>();
    if let Some(&lift_m) = lift_m.as_ref().and_then(|all| all.first()) {
        let problem = "every axle has lift_m, but one must stay on the road";
        found.push(Finding::error("trailer.axle[0].lift_m", lift_m, problem));
    }
    let ahead = v.tractor.axle.iter().map(|a| -a.ahead_of_cg_m);
    in_order("tractor", "ahead_of_cg_m", &ahead.collect::<Vec<_>>(), found);
    let behind = v.trailer.axle.iter().map(|a| a.behind_hitch_m);
    in_order("trailer", "behind_hitch_m", &behind.collect::<Vec<_>>(), found);
    let tractor: Vec<&Axle> = v.tractor.axle.iter().map(|a| &a.axle).collect();
    let trailer: Vec<&Axle> = v.trailer.axle.iter().map(|a| &a.axle).collect();
    for (unit, axles) in [("tractor", tractor), ("trailer", trailer)] {
        for (i, a) in axles.iter().enumerate() {
            let path = format!("{unit}.axle[{i}]");
            axle(&path, a, v, found);
            let Some(group) = a.load_group else { continue };
            if axles.iter().filter(|other| other.load_group == Some(group)).count() < 2 {
                let (key, problem) =
                    (format!("{path}.load_group"), "no other axle of the unit has it");
                found.push(Finding {
                    remedy: "give it to the axles that share their load, or leave it out"
                        .to_owned(),
                    ..Finding::new(Severity::Warning, key, group, problem)
                });
            }
        }
    }
}

/// Checks the number of axles of a unit and their order from front to rear, given their positions
/// backwards.
fn in_order(unit: &str, key: &str, backwards_m: &[f64], found: &mut Vec<Finding>) {
    let (axles, n) = (format!("{unit}.axle"), backwards_m.len());
    if n == 0 {
        found.push(Finding::error(
            axles.as_str(),
            n,
            format!("the {unit} needs at least one axle"),
        ));
    } else if n > MOST_AXLES {
        let problem = format!("there can be up to {MOST_AXLES} axles");
        found.push(Finding::error(axles.as_str(), n, problem));
    }
    if let Some(i) = backwards_m.windows(2).position(|pair| !(pair[1] > pair[0])) {
        let given = |i: usize| if unit == "tractor" { -backwards_m[i] } else { backwards_m[i] };
        let problem = format!(
            "must lie behind {axles}[{i}].{key} = {}: axles are listed from front to rear",
            given(i)
        );
        let key = format!("{axles}[{}].{key}", i + 1);
        found.push(Finding::error(key, given(i + 1), problem));
    }
}

fn axle(path: &str, a: &Axle, v: &Vehicle, found: &mut Vec<Finding>) {
    let tyres: Vec<&str> = v.tyre.iter().map(|tyre| tyre.name.as_str()).collect();
    let springs: Vec<&str> = v.spring.iter().map(|spring| spring.name.as_str()).collect();
    let wanted = [("tyre", Some(&a.tyre), tyres), ("spring", a.spring.as_ref(), springs)];
    for (key, name, names) in wanted {
        let Some(name) = name.filter(|name| !names.contains(&name.as_str())) else { continue };
        let problem = format!("no [[{key}]] has this name; there are: {}", names.join(", "));
        found.push(Finding::error(format!("{path}.{key}"), name, problem));
    }
    let sides = a.tyre_positions_m.len();
    if !(1..=2).contains(&sides) {
        found.push(Finding::error(
            format!("{path}.tyre_positions_m"),
            format!("{:?}", a.tyre_positions_m),
            "needs one entry (single tires) or two (dual tires)",
        ));
    }
}

/// Whether `values` has at least two entries, each greater than the previous one.
fn increasing(path: &str, values: &[f64], found: &mut Vec<Finding>) -> bool {
    let sound = values.len() >= 2 && values.windows(2).all(|pair| pair[0] < pair[1]);
    if !sound {
        let problem = "needs two or more strictly increasing numbers";
        found.push(Finding::error(path, format!("{values:?}"), problem));
    }
    sound
}

/// Whether a list has the expected length.
fn as_long(path: &str, list: usize, of: usize, what: &str, found: &mut Vec<Finding>) -> bool {
    if list != of {
        let problem = format!("needs one {what}: {of}");
        found.push(Finding::error(path, format!("{list} values"), problem));
    }
    list == of
}

fn tyre_tables(path: &str, tyre: &Tyre, found: &mut Vec<Finding>) {
    let loads = &tyre.load_n;
    increasing(&format!("{path}.load_n"), loads, found);
    for (key, table) in [
        ("cornering_stiffness_n_per_rad", &tyre.cornering_stiffness_n_per_rad),
        ("aligning_stiffness_nm_per_rad", &tyre.aligning_stiffness_nm_per_rad),
    ] {
        as_long(&format!("{path}.{key}"), table.len(), loads.len(), "value per load", found);
    }
    if let Some(t) = &tyre.lateral_force {
        let path = format!("{path}.lateral_force");
        table(&path, "coefficient", &t.slip_rad, &t.load_n, &t.coefficient, found);
    }
    if let Some(t) = &tyre.aligning_moment {
        let path = format!("{path}.aligning_moment");
        table(&path, "moment_nm", &t.slip_rad, &t.load_n, &t.moment_nm, found);
    }
}

fn table(
    path: &str,
    key: &str,
    slip_rad: &[f64],
    load_n: &[f64],
    rows: &[Vec<f64>],
    found: &mut Vec<Finding>,
) {
    increasing(&format!("{path}.slip_rad"), slip_rad, found);
    increasing(&format!("{path}.load_n"), load_n, found);
    let path = format!("{path}.{key}");
    as_long(&path, rows.len(), slip_rad.len(), "row per slip angle", found);
    for (i, row) in rows.iter().enumerate() {
        as_long(&format!("{path}[{i}]"), row.len(), load_n.len(), "value per load", found);
    }
}

fn spring_table(path: &str, spring: &Spring, found: &mut Vec<Finding>) {
    let deflections = spring.deflection_m.len();
    let mut sound = increasing(&format!("{path}.deflection_m"), &spring.deflection_m, found);
    for (key, force) in
        [("compression_n", &spring.compression_n), ("extension_n", &spring.extension_n)]
    {
        let path = format!("{path}.{key}");
        if !as_long(&path, force.len(), deflections, "force per deflection", found) {
            sound = false;
        } else if let Some(j) = force.windows(2).position(|pair| !(pair[0] <= pair[1])) {
            let problem = format!("must not decrease with deflection, from {}", force[j]);
            found.push(Finding::error(format!("{path}[{}]", j + 1), force[j + 1], problem));
        } else if force.first() == force.last() {
            let problem = "must increase with deflection";
            found.push(Finding::error(path, format!("{force:?}"), problem));
        }
    }
    let mut pairs = spring.compression_n.iter().zip(&spring.extension_n);
    if let (true, Some(j)) = (sound, pairs.position(|(up, down)| !(down <= up))) {
        let problem =
            format!("must not exceed {path}.compression_n[{j}] = {}", spring.compression_n[j]);
        let key = format!("{path}.extension_n[{j}]");
        found.push(Finding::error(key, spring.extension_n[j], problem));
    }
}

fn as_printed(v: &Vehicle, found: &mut Vec<Finding>) {
    let Some(printed) = &v.as_printed else { return };
    let axles = v.tractor.axle.len() + v.trailer.axle.len();
    for (key, values) in
        [("axle_load_n", &printed.axle_load_n), ("unsprung_weight_n", &printed.unsprung_weight_n)]
    {
        as_long(&format!("as_printed.{key}"), values.len(), axles, "value per axle", found);
    }
}
