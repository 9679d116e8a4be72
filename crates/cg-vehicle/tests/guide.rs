//! Tests of templates, schema and page of the vehicle file.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use std::collections::BTreeSet;

use cg_core::Word;
use cg_vehicle::balance::static_balance;
use cg_vehicle::check::{TABLES, key};
use cg_vehicle::design::design;
use cg_vehicle::guide::{TruckKind, changed, page, schema, template};
use cg_vehicle::steady_turn::steady_turn_threshold_g;
use cg_vehicle::{LinearModel, Load, Variant, Vehicle};
use toml::{Table, Value};

fn kinds() -> impl Iterator<Item = (TruckKind, &'static str)> {
    TruckKind::WORDS.iter().map(|(kind, word, _)| (*kind, *word))
}

fn truck(kind: TruckKind) -> Vehicle {
    let (vehicle, findings) = Vehicle::check(&template(kind), "template").unwrap();
    let told: Vec<String> = findings.iter().map(|finding| finding.in_file("template")).collect();
    assert!(told.is_empty(), "{kind}: {}", told.join("\n"));
    vehicle
}

fn repository(name: &str) -> String {
    let path = format!("{}/../../{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn a_template_has_no_finding_and_gives_a_design() {
    for (kind, word) in kinds() {
        design(&truck(kind), Variant::Complete).unwrap_or_else(|error| panic!("{word}: {error}"));
    }
}

#[test]
fn a_template_is_stable_empty_and_laden_in_town_and_on_a_motorway() {
    for (kind, word) in kinds() {
        let vehicle = truck(kind);
        let empty = Load {
            trailer_mass_kg: vehicle.empty_trailer_mass_kg(),
            cg_height_m: vehicle.trailer.tare.cg_height_m,
        };
        for load in [empty, vehicle.reference_load()] {
            for speed_mps in [8.0, vehicle.nominal_speed_mps, 25.0] {
                let model = LinearModel::new(&vehicle, Variant::Complete, speed_mps, load).unwrap();
                let roll = model.state_space.to_trailer_roll().transfer_function().unwrap();
                // Slower motions than 0.3 rad/s do not decay within a turn.
                let slowest = roll.poles.iter().map(|pole| pole.0).fold(f64::MIN, f64::max);
                assert!(slowest < -0.3, "{word}, {speed_mps} m/s: {slowest}");
            }
        }
    }
}

/// Also with all lines that are switched off.
#[test]
fn every_optional_line_of_a_template_can_be_used() {
    for (kind, word) in kinds() {
        let text = template(kind);
        let is_off = |line: &&str| line.starts_with('#') && !line.starts_with("# ") && *line != "#";
        assert!(text.lines().filter(is_off).count() > 20, "{word}");
        let on = |line: &str| if is_off(&line) { line[1..].to_owned() } else { line.to_owned() };
        let all: String = text.lines().flat_map(|line| [on(line), "\n".to_owned()]).collect();
        let (_, findings) = Vehicle::check(&all, word).unwrap();
        assert!(findings.is_empty(), "{findings:?}");
    }
}

/// The legal loads of the region of each kind, t: steered axle, drive axles and trailer axles, all
/// together. Europe: directive 96/53/EC, and 8 t, which two single tires carry; North America: 34 000 lb on a
/// tandem, 13 200 lb on the steered axle, 80 000 lb; three drive and trailer axles: 18 t and 24 t.
#[test]
fn a_template_has_legal_axle_loads() {
    for (kind, most_t) in [
        (TruckKind::FourByTwoThreeAxle, [8.0, 11.5, 24.0, 40.0]),
        (TruckKind::SixByFourTwoAxle, [5.99, 15.42, 15.42, 36.29]),
        (TruckKind::SixByFourThreeAxle, [8.0, 18.0, 24.0, 44.0]),
    ] {
        let vehicle = truck(kind);
        let reference = vehicle.reference_load();
        let empty = Load { trailer_mass_kg: vehicle.empty_trailer_mass_kg(), ..reference };
        for load in [empty, reference] {
            let loads_n = static_balance(&vehicle, load).unwrap().axle_load_n;
            let mut of_t = [0.0; 4];
            for (axle, load_n) in vehicle.axles().iter().zip(loads_n) {
                let group = if axle.steered { 0 } else { 1 + usize::from(axle.on_trailer) };
                of_t[group] += load_n / vehicle.gravity_mps2 / 1e3;
                of_t[3] += load_n / vehicle.gravity_mps2 / 1e3;
            }
            for (load_t, most_t) in of_t.into_iter().zip(most_t) {
                assert!(load_t <= most_t && load_t > 0.2 * most_t, "{kind}: {of_t:?}");
            }
            // A laden truck uses what the law permits.
            assert!(load == empty || of_t[3] > 0.95 * most_t[3], "{kind}: {of_t:?}");
        }
    }
}

/// Laden semitrailers roll over at 0.3 to 0.6 g (Winkler and Ervin, UMTRI-99-19).
#[test]
fn a_template_rolls_over_like_a_laden_truck() {
    for (kind, word) in kinds() {
        let vehicle = truck(kind);
        let load = vehicle.reference_load();
        let g = steady_turn_threshold_g(&vehicle, load, vehicle.nominal_speed_mps).unwrap();
        assert!((0.3..0.6).contains(&g), "{word}: {g}");
    }
}

#[test]
fn every_uncertainty_of_a_template_is_wider_than_that_of_a_known_truck() {
    let known: Table = repository("fixtures/vehicles/kraz.toml").parse().unwrap();
    for (kind, word) in kinds() {
        let root: Table = template(kind).parse().unwrap();
        for (name, known) in known["uncertainty"].as_table().unwrap() {
            let here = root["uncertainty"][name].as_float().unwrap();
            assert!(here > known.as_float().unwrap(), "{word}: {name} = {here}");
        }
    }
}

/// Before the first occurrence of each key is its meaning, and each key is in some template, except
/// those of measured springs and tires.
#[test]
fn a_template_says_what_every_key_means() {
    let mut seen = BTreeSet::new();
    for (kind, word) in kinds() {
        let text = template(kind);
        let mut before = "";
        for line in text.lines() {
            let bare = line.trim_start_matches('#');
            if let Some((name, _)) = bare.split_once(" = ").filter(|_| !bare.starts_with(' '))
                && seen.insert((word, name.to_owned()))
            {
                let is_meaning = before.starts_with("# ") && before.len() > 6;
                assert!(is_meaning, "{word}: {name} after {before:?}");
            }
            before = line;
        }
    }
    let names: BTreeSet<&str> = seen.iter().map(|(_, name)| name.as_str()).collect();
    let measured = ["lateral_force", "aligning_moment", "spring[i]", "as_printed"];
    for table in TABLES
        .iter()
        .filter(|table| !table.paths.iter().any(|p| measured.iter().any(|m| p.ends_with(m))))
    {
        for key in table.keys.iter().filter(|key| key.name != "spring") {
            assert!(names.contains(key.name), "{} is in no template", key.name);
        }
    }
}

#[test]
fn page_and_schema_are_those_of_the_code() {
    for (file, made, command) in [
        ("docs/vehicle.md", page(), "cg vehicle doc > docs/vehicle.md"),
        ("docs/vehicle.schema.json", schema(), "cg vehicle schema > docs/vehicle.schema.json"),
    ] {
        assert!(repository(file) == made, "{file} is not up to date; renew it: {command}");
    }
}

#[test]
fn the_page_lists_every_key_and_says_which_lengths_are_half() {
    let page = page();
    for table in TABLES {
        for key in table.keys {
            assert!(
                page.contains(&format!("\n| `{}` | {} | ", key.name, key.unit)),
                "{}",
                key.name
            );
        }
    }
    for (name, word) in [
        ("trailer.axle[i].tyre_positions_m", "half"),
        ("trailer.axle[i].spring_spread_m", "full"),
        ("trailer.axle[i].damper_spread_m", "full"),
        ("trailer.payload.width_m", "full"),
        ("trailer.payload.length_m", "full"),
        ("sensors.level.spread_m", "full"),
    ] {
        let meaning = key(name).unwrap().meaning;
        assert!(meaning.starts_with(word), "{name}: {meaning}");
        assert!(page.contains(&format!("* `{}`: {meaning}.", name.replace("[i]", ""))), "{name}");
    }
}

/// The labels of the drawing are keys, and each key of a position or a dimension is in the drawing.
/// The first table of a file at a path without indices.
fn inner<'a>(root: &'a mut Table, path: &str) -> Option<&'a mut Table> {
    path.split('.').filter(|step| !step.is_empty()).try_fold(root, |table, step| {
        let value = table.get_mut(step)?;
        if value.is_array() { value.get_mut(0)?.as_table_mut() } else { value.as_table_mut() }
    })
}

/// A file without a key is the same vehicle as one with the value that the page names for it, and keys
/// with "none" have no value.
#[test]
fn the_page_says_what_an_absent_key_means() {
    let text = template(TruckKind::SixByFourThreeAxle);
    let is_key = |line: &str| line.starts_with('[') || line.contains(" = ");
    let lines = text.lines().map(|line| match line.strip_prefix('#') {
        Some(rest) if !rest.starts_with(' ') && is_key(rest) => rest,
        _ => line,
    });
    let example: Table = lines.collect::<Vec<_>>().join("\n").parse().unwrap();
    let read = |root: Table| Value::Table(root).try_into::<Vehicle>();
    let (mut path, mut found) = (String::new(), Vec::new());
    for line in page().lines() {
        if let Some(header) = line.strip_prefix("### ") {
            path = header.split('`').nth(1).unwrap_or("").trim_matches(['[', ']']).to_owned();
        }
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let ([name, .., absent], true) = (&cells[..], cells.len() == 6) else { continue };
        let name = name.trim_matches('`');
        let mut root = example.clone();
        let Some(table) = inner(&mut root, &path) else { continue };
        if table.remove(name).is_none() || *absent == "required" {
            continue;
        }
        let place = format!("{path}.{name}");
        let without = read(root.clone()).unwrap_or_else(|error| panic!("{place}: {error}"));
        if *absent == "none" {
            let mut written = Table::try_from(&without).unwrap();
            let value = inner(&mut written, &path).unwrap().remove(name);
            let is_empty = |value: &Value| value.as_array().is_some_and(Vec::is_empty);
            assert!(value.as_ref().is_none_or(is_empty), "{place} = {value:?}");
            continue;
        }
        let value: Table = format!("value = {absent}").parse().unwrap();
        inner(&mut root, &path).unwrap().insert(name.to_owned(), value["value"].clone());
        assert_eq!(read(root).unwrap(), without, "{place}");
        found.push(format!("{place} = {absent}"));
    }
    for known in [
        ".gravity_mps2 = 9.80665",
        "uncertainty.payload_place_sd_m = 0.3",
        "uncertainty.spring_friction_sd = 0.3",
        "uncertainty.cornering_over_load_sd = 0.04",
        "uncertainty.frame_torsional_stiffness_sd = 0.3",
        "uncertainty.suspension_roll_gain_sd = 0.03",
        "uncertainty.specific_force_gain_sd = 0.01",
        "sensors.accelerometer.height_m = 1.0",
        "trailer.axle.leveled = false",
    ] {
        assert!(found.iter().any(|one| one == known), "no {known} in {found:?}");
    }
}

#[test]
fn the_drawing_has_the_keys_of_all_dimensions() {
    let drawing = repository("docs/figures/vehicle.svg");
    let labels: BTreeSet<String> = drawing
        .split("class=\"key\"")
        .skip(1)
        .map(|rest| {
            let text = rest.split_once('>').unwrap().1;
            text.split('<').next().unwrap().trim().to_owned()
        })
        .collect();
    let place = |path: &str, name: &str| format!("{path}.{name}").replace("[i]", "");
    let (mut all, mut wanted) = (BTreeSet::new(), BTreeSet::new());
    for table in TABLES {
        for path in table.paths {
            for key in table.keys {
                all.insert(place(path, key.name));
                let elsewhere = ["height", "uncertainty", "spring[i]", "as_printed"];
                // The second sensor has the length of the first one; an axle is drawn on the road; the body has no outline.
                let not_seen = [
                    "spring_free_rise_m",
                    "unloaded_radius_m",
                    "second_behind_hitch_m",
                    "lift_m",
                    "side_height_m",
                ];
                if key.unit == "m" && !elsewhere.contains(path) && !not_seen.contains(&key.name) {
                    wanted.insert(key.name);
                }
            }
        }
    }
    wanted.remove("relaxation_length_m");
    for label in &labels {
        assert!(all.contains(label), "{label} is not a key");
    }
    for name in wanted {
        let shown = labels.iter().any(|label| label.ends_with(&format!(".{name}")));
        assert!(shown, "{name} is not in the drawing");
    }
}

#[test]
fn a_changed_file_has_the_new_values_and_keeps_the_others() {
    let text = template(TruckKind::FourByTwoThreeAxle);
    let change = |path: &str, value: Value| changed(&text, "truck", [(path.to_owned(), value)]);
    let old = Vehicle::parse(&text, "truck").unwrap();
    let table: Table = "bank_sd_rad = 0.01".parse().unwrap();
    for (path, value) in [
        ("trailer.axle[2].behind_hitch_m", Value::Float(9.1)),
        ("trailer.axle[2]", Value::Table("behind_hitch_m = 9.1".parse().unwrap())),
    ] {
        let new = Vehicle::parse(&change(path, value).unwrap(), "truck").unwrap();
        let mut expected = old.clone();
        expected.trailer.axle[2].behind_hitch_m = 9.1;
        assert_eq!(new, expected);
    }
    let new = Vehicle::parse(&change("road", Value::Table(table)).unwrap(), "truck").unwrap();
    assert!(new.road.is_some() && old.road.is_none());
    for path in ["trailer.axle[3].behind_hitch_m", "name.first", "trailer.axle.behind_hitch_m"] {
        let error = change(path, Value::Float(9.1)).unwrap_err().to_string();
        assert!(error.contains(path), "{error}");
    }
    let unknown = change("trailer.paint", Value::Float(1.0)).unwrap();
    assert!(Vehicle::parse(&unknown, "truck").unwrap_err().to_string().contains("paint"));
}
