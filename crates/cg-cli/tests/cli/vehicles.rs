//! Vehicle files with one mistake each.

use crate::common::{Scratch, baseline, cg, estimate, fixture, kraz};

/// Checks that the baseline with one changed line is refused by both commands that read it. The
/// message contains all `parts` and the position of `place` in the changed file.
#[track_caller]
fn refused(from: &str, to: &str, place: &str, parts: &[&str]) {
    let text = std::fs::read_to_string(baseline()).unwrap();
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    let at = text.find(place).unwrap();
    let line = 1 + text[..at].matches('\n').count();
    let column = 1 + at - text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let scratch = Scratch::new();
    let file = scratch.file("truck.toml", text);
    let ours = format!("{file}:{line}:{column}: ");
    let toml = format!("{file}: TOML parse error at line {line}, column {column}\n");
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    for arguments in [
        &["model", "--vehicle", &file][..],
        &["estimate", &log, "--vehicle", &file, "--format", "json"],
        &["simulate", "--maneuver", "sine", "-o", &scratch.path("log.csv"), "--vehicle", &file],
    ] {
        let run = cg(arguments);
        assert!(run.err.contains(&ours) || run.err.contains(&toml), "{ours}: {}", run.err);
        run.refused(parts);
    }
    assert_eq!(scratch.names(), ["truck.toml"]);
}

#[test]
fn a_wrong_key_at_the_top_is_named_with_the_keys_there_are() {
    let parts = ["unknown field `gravity_ms2`", "expected one of", "`gravity_mps2`"];
    refused("gravity_mps2 =", "gravity_ms2 =", "gravity_ms2", &parts);
}

#[test]
fn a_wrong_key_in_an_axle_is_named_with_the_keys_there_are() {
    let parts = ["tractor.axle[0].paint", "unknown key; expected one of", "spring_spread_m"];
    refused("steered = true", "steered = true\npaint = \"red\"", "\"red\"", &parts);
    // A misspelled key is unknown, and the correct key is missing.
    let parts =
        ["tractor.axle[0].spring_spred_m", "unknown key; expected one of", "spring_spread_m"];
    refused("spring_spread_m = 0.8128", "spring_spred_m = 0.8128", "0.8128", &parts);
    let parts = ["trailer.axle[0].steered", "unknown key; expected one of behind_hitch_m"];
    let from = "behind_hitch_m = 11.734737438913163";
    refused(from, &format!("{from}\nsteered = true #"), "true #", &parts);
}

#[test]
fn a_wrong_key_in_a_tyre_is_named_with_the_keys_there_are() {
    let parts = ["unknown field `vertical_stiffness`", "`vertical_stiffness_n_per_m`"];
    let from = "\nvertical_stiffness_n_per_m";
    refused(from, "\nvertical_stiffness", "vertical_stiffness =", &parts);
}

#[test]
fn readings_of_a_gauge_that_do_not_rise_are_named() {
    let table = "[trailer.suspension_pressure]\ngauge_pa = [2e5, 1e5]\naxle_load_kg = [5e3, 9e3]\n";
    let to = format!("{table}\n[trailer.payload]");
    let parts =
        ["trailer.suspension_pressure.gauge_pa = 100000: the second reading must be greater"];
    refused("[trailer.payload]", &to, "[2e5", &parts);
}

#[test]
fn a_third_reading_of_a_gauge_is_refused() {
    let table =
        "[trailer.suspension_pressure]\ngauge_pa = [1e5, 3e5, 5e5]\naxle_load_kg = [5e3, 9e3]\n";
    let to = format!("{table}\n[trailer.payload]");
    refused("[trailer.payload]", &to, "[1e5", &["3 numbers: a line needs two readings"]);
}

#[test]
fn a_negative_mass_is_named_with_its_value() {
    let parts = ["tractor.sprung_mass_kg = -5: must be a positive number"];
    refused("sprung_mass_kg = 5345.646233765785", "sprung_mass_kg = -5", "-5", &parts);
    let parts = ["tractor.axle[1].unsprung_mass_kg = 0: must be a positive number"];
    let text = "unsprung_mass_kg = 1132.6553609391638";
    refused(text, "unsprung_mass_kg = 0.0  #", "0.0  #", &parts);
}

#[test]
fn a_missing_key_is_named_with_the_table_it_belongs_to() {
    let text = "cg_height_m = 1.40\n";
    refused(text, "", "[trailer.tare]", &["missing field `cg_height_m`"]);
    let text = "spring_spread_m = 0.8128\n";
    refused(text, "", "[[tractor.axle]]", &["missing field `spring_spread_m`"]);
}

#[test]
fn a_value_of_the_wrong_type_is_named_with_the_type_it_should_have() {
    let parts = ["invalid type: string \"low\"", "expected f64"];
    refused("cg_height_m = 1.40", "cg_height_m = \"low\"", "\"low\"", &parts);
    let parts = ["invalid type: string \"yes\"", "expected a boolean"];
    refused("steered = true", "steered = \"yes\"", "\"yes\"", &parts);
}

#[test]
fn an_unknown_tyre_is_named_with_the_tyres_there_are() {
    let parts = ["tractor.axle[0].tyre = frnt", "no [[tyre]] has this name", "front, rear"];
    refused("tyre = \"front\"", "tyre = \"frnt\"", "\"frnt\"", &parts);
}

#[test]
fn tables_of_unequal_length_are_named_with_the_length_they_need() {
    let key = "cornering_stiffness_n_per_rad";
    let parts = ["tyre[0].cornering_stiffness_n_per_rad = 2 values", "one value per load: 10"];
    refused(&format!("{key} = ["), &format!("{key} = [1.0, 2.0] # ["), "[1.0, 2.0]", &parts);
}

#[test]
fn a_reference_mass_below_the_empty_trailer_is_named_with_the_least_there_can_be() {
    let parts = ["trailer.reference_mass_kg = 1000", "must be at least the empty trailer's 6259"];
    let text = "reference_mass_kg = 31298.351130684357";
    refused(text, "reference_mass_kg = 1000.0", "1000.0", &parts);
}

#[test]
fn what_is_no_toml_is_named_with_its_place() {
    refused("gravity_mps2 = ", "gravity_mps2 = = ", "= 9.8", &["extra `=`"]);
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    cg(&["model", "--vehicle", &log]).refused(&[&log, "TOML parse error at line 1, column "]);
    let scratch = Scratch::new();
    let garbage = scratch.file("truck.toml", [0xff, 0xfe, 0x00]);
    cg(&["model", "--vehicle", &garbage]).refused(&[&garbage, "UTF-8", "check that it is a text"]);
}

#[test]
fn a_missing_vehicle_file_is_named_with_the_remedy() {
    let scratch = Scratch::new();
    let missing = scratch.path("truck.toml");
    let parts =
        [missing.as_str(), "cannot be read", "No such file", "check that it is a text file"];
    cg(&["model", "--vehicle", &missing]).refused(&parts);
    estimate(&fixture("logs/A_p20_h190_v50_L.csv"), &missing, &[]).refused(&parts);
    let log = scratch.path("log.csv");
    cg(&["simulate", "--maneuver", "sine", "-o", &log, "--vehicle", &missing]).refused(&parts);
    assert!(scratch.names().is_empty());
}

#[test]
fn a_trailer_below_its_empty_mass_is_refused_with_that_mass() {
    let scratch = Scratch::new();
    let mass = ["--trailer-mass-kg", "1000"];
    let parts = ["1000 kg", "the empty trailer's 8684 kg", "as weighed"];
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    estimate(&log, &kraz(), &mass).refused(&[&parts[..], &["--trailer-mass-kg"]].concat());
    cg(&[&["model", "--vehicle", &kraz()][..], &mass].concat()).refused(&parts);
    let out = scratch.path("log.csv");
    let simulate = ["simulate", "--vehicle", &kraz(), "--maneuver", "sine", "-o", &out];
    cg(&[&simulate[..], &mass].concat()).refused(&parts);
    assert!(scratch.names().is_empty());
}

#[test]
fn the_printed_model_is_refused_without_its_table_and_at_another_mass() {
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let printed = ["--model", "as-printed"];
    let parts = ["needs an [as_printed] table in the vehicle file", "use --model complete"];
    cg(&[&["model", "--vehicle", &kraz()][..], &printed].concat()).refused(&parts);
    estimate(&log, &kraz(), &printed).refused(&parts);

    let heavier = [&printed[..], &["--trailer-mass-kg", "20000"]].concat();
    let parts = ["31298 kg only, not at 20000 kg", "use --model complete"];
    cg(&[&["model", "--vehicle", &baseline()][..], &heavier].concat()).refused(&parts);
    estimate(&log, &baseline(), &heavier).refused(&parts);
}

#[test]
fn all_that_is_wrong_is_told_at_once() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(kraz()).unwrap();
    let text = text
        .replace("floor_height_m = 1.27", "floor_height_m = 1270")
        .replace("sprung_mass_kg = 10000.0", "sprung_mass_kg = 10.0")
        .replace("spring_spread_m = 1.458", "spring_spread_m = 1458");
    let file = scratch.file("truck.toml", text);
    cg(&["model", "--vehicle", &file]).refused(&[
        "tractor.sprung_mass_kg = 10: ",
        "10 t would be usual, but the key is in kg",
        "trailer.payload.floor_height_m = 1270: ",
        "trailer.axle[0].spring_spread_m = 1458: ",
        "trailer.axle[2].spring_spread_m = 1458: ",
        "(usual: 0.5 to 1.5 m); 1458 mm would be usual, but the key is in m",
    ]);
}

/// Every command that reads a vehicle file reports unusual values once.
#[test]
fn what_is_unusual_is_told_once_by_every_command() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(kraz()).unwrap();
    let text = text.replace("floor_height_m = 1.27", "floor_height_m = 1.75");
    let file = scratch.file("truck.toml", text);
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let run = format!("{log}=1.9");
    let (out, json) = (scratch.path("out.csv"), scratch.path("out.json"));
    let calibration = scratch.path("c.toml");
    for arguments in [
        &["model"][..],
        &["estimate", &log],
        &["run", "--csv", &log],
        &["calibrate", "--run", &run, "-o", &calibration],
        &["design", "--emit", "json", "-o", &json],
        &["simulate", "--maneuver", "sine", "-o", &out],
        &["rollover"],
    ] {
        let run = cg(&[arguments, &["--vehicle", &file]].concat());
        let told = "warning: trailer.payload.floor_height_m = 1.75: is unusually large";
        assert_eq!(run.err.matches(told).count(), 1, "{arguments:?} {run:?}");
        run.told(0, &[&format!("cg: {file}:"), "(usual: 0.6 to 1.7 m)"]);
    }
}

/// A file that is too large is refused at once, also if it is endless.
#[cfg(unix)]
#[test]
fn an_endless_file_is_refused_at_once() {
    let zero = "/dev/zero";
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let parts =
        ["/dev/zero: cannot be read", "it has more than the", "MiB that such a file may have"];
    cg(&["model", "--vehicle", zero]).refused(&parts);
    estimate(&log, &kraz(), &["--calibration", zero]).refused(&parts);
    estimate(&log, &kraz(), &["--truth", zero, "--report", "report.html"]).refused(&parts);
    let dbc = ["--dbc", zero, "--signal", "roll=A.B", "--candump", &log];
    cg(&[&["run", "--vehicle", &kraz()][..], &dbc].concat()).refused(&parts);
}
