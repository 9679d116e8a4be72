//! Bad input: a clear message with file, line, column and remedy, the right exit status, nothing
//! half-written.
#![allow(clippy::unwrap_used)] // helpers of tests

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const HEADER: &str = "time_s,steer_rad,roll_rad,speed_mps";

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}

fn kraz() -> String {
    fixture("vehicles/kraz.toml").display().to_string()
}

fn cg(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cg")).args(arguments).output().unwrap()
}

/// Runs `cg estimate` on a log with this content; the name of the log is `log.csv`.
fn estimate(content: &[u8]) -> Output {
    estimate_named("log.csv", content)
}

fn estimate_named(name: &str, content: &[u8]) -> Output {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join(name);
    std::fs::write(&log, content).unwrap();
    cg(&["estimate", log.to_str().unwrap(), "--vehicle", &kraz(), "--format", "json"])
}

/// Exit status 2, nothing on standard output, a message with all of `parts` and no panic.
#[track_caller]
fn refused(output: &Output, parts: &[&str]) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(!message.contains("panicked"), "{message}");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
}

#[test]
fn a_missing_column_is_named_with_the_way_to_map_it() {
    let output = estimate(b"time_s,steer_rad,Lean_deg\n0,0,0\n");
    refused(&output, &["log.csv", "roll", "--column", "Lean_deg"]);
}

#[test]
fn an_unknown_unit_is_named_with_the_units_accepted() {
    let output = estimate(b"time_s,steer_rad,roll_grad\n0,0,0\n");
    refused(&output, &["log.csv", "line 1", "roll_grad", "deg"]);
}

#[test]
fn time_that_does_not_increase_is_refused_with_both_times() {
    let text = format!("{HEADER}\n0.00,0,0,14\n0.02,0,0,14\n0.01,0,0,14\n");
    refused(&estimate(text.as_bytes()), &["log.csv", "line 4", "0.01", "0.02"]);
}

#[test]
fn text_in_a_number_is_named_with_line_and_column() {
    let text = format!("{HEADER}\n0.00,0,0,14\n0.01,0,abc,14\n");
    refused(&estimate(text.as_bytes()), &["log.csv", "line 3", "roll_rad", "abc"]);
}

#[test]
fn an_empty_file_is_refused() {
    refused(&estimate(b""), &["log.csv", "empty"]);
}

#[test]
fn a_truncated_gzip_is_refused() {
    let whole = std::fs::read(fixture("logs/F_drive1_p15_h155.csv.gz")).unwrap();
    let output = estimate_named("log.csv.gz", &whole[..whole.len() / 2]);
    refused(&output, &["log.csv.gz", "truncated"]);
}

#[test]
fn a_single_line_of_two_gigabytes_is_refused_at_once() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_cg"))
        .args(["estimate", "-", "--vehicle", &kraz()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let block = vec![b'1'; 1 << 20];
    let mut written_mib = 0;
    // The pipe breaks when the reader has had enough.
    while written_mib < 2048 && pipe.write_all(&block).is_ok() {
        written_mib += 1;
    }
    drop(pipe);
    refused(&child.wait_with_output().unwrap(), &["standard input", "line 1"]);
    assert!(written_mib < 16, "{written_mib} MiB were taken");
}

#[test]
fn a_run_without_roll_angle_is_left_out_and_said() {
    let text = std::fs::read_to_string(fixture("logs/A_p20_h190_v50_L.csv")).unwrap();
    let holed: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(i, line)| {
            if !(401..421).contains(&i) {
                return line.to_owned();
            }
            let mut cells: Vec<&str> = line.split(',').collect();
            cells[2] = "NaN";
            cells.join(",")
        })
        .collect();
    let output = estimate(holed.join("\n").as_bytes());
    let answer = json(&output);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(answer["status"], "ok");
    assert!(answer["messages"].to_string().contains("20 of "), "{}", answer["messages"]);
    // 0.2 s of 20 are bridged by a straight line: far less than the model's own 4 %.
    let whole = cg(&[
        "estimate",
        fixture("logs/A_p20_h190_v50_L.csv").to_str().unwrap(),
        "--vehicle",
        &kraz(),
        "--format",
        "json",
    ]);
    let (a, b) = (answer["height_m"].as_f64().unwrap(), json(&whole)["height_m"].as_f64().unwrap());
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn straight_driving_is_rejected_with_the_reason() {
    let mut text = format!("{HEADER}\n");
    for k in 0..2000 {
        text += &format!("{:.2},0.0001,-0.0003,14\n", f64::from(k) * 0.01);
    }
    let output = estimate(text.as_bytes());
    assert_eq!(output.status.code(), Some(1));
    let answer = json(&output);
    assert_eq!(answer["status"], "rejected");
    assert!(answer["height_m"].is_null());
    assert!(answer["messages"].to_string().contains("unexcited"), "{}", answer["messages"]);
}

#[test]
fn a_missing_log_does_not_keep_the_others_from_being_answered() {
    let good = fixture("logs/A_p20_h190_v50_L.csv");
    let output = cg(&[
        "estimate",
        "nowhere.csv",
        good.to_str().unwrap(),
        "--vehicle",
        &kraz(),
        "--format",
        "json",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nowhere.csv"));
    assert_eq!(json(&output)["status"], "ok");
}

/// The baseline with one change; `cg model` must refuse it.
#[track_caller]
fn vehicle_refused(from: &str, to: &str, parts: &[&str]) {
    let text = std::fs::read_to_string(fixture("vehicles/kraz.toml")).unwrap();
    assert!(text.contains(from));
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("truck.toml");
    std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
    let line = 1 + text[..text.find(from).unwrap()].matches('\n').count();
    let output = cg(&["model", "--vehicle", file.to_str().unwrap()]);
    refused(&output, parts);
    let message = String::from_utf8_lossy(&output.stderr);
    let place = [format!("truck.toml:{line}:"), format!("line {line}, column ")];
    assert!(place.iter().any(|place| message.contains(place.as_str())), "{line}: {message}");
}

#[test]
fn a_negative_mass_is_refused_with_its_place() {
    vehicle_refused(
        "sprung_mass_kg = 6500.0",
        "sprung_mass_kg = -6500.0",
        &["trailer.tare.sprung_mass_kg", "-6500", "must be a positive number"],
    );
}

#[test]
fn a_wrong_key_is_refused_with_its_place_and_the_right_ones() {
    vehicle_refused("roll_inertia_kgm2 = 3441.0", "roll_inertia = 3441.0", &["roll_inertia"]);
    vehicle_refused("spring_spread_m = 1.058", "spring_spread_mm = 1058", &["spring_spread"]);
}

#[test]
fn an_unknown_tyre_is_refused_with_the_names_there_are() {
    vehicle_refused("tyre = \"trailer\"", "tyre = \"traler\"", &["traler", "tractor, trailer"]);
}

#[test]
fn a_trailer_lighter_than_empty_is_refused() {
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let output =
        cg(&["estimate", log.to_str().unwrap(), "--vehicle", &kraz(), "--trailer-mass-kg", "1000"]);
    refused(&output, &["1000", "8684", "as weighed"]);
}

#[test]
fn the_printed_model_is_refused_where_it_is_not_known() {
    refused(
        &cg(&["model", "--vehicle", &kraz(), "--model", "as-printed"]),
        &["[as_printed]", "--model complete"],
    );
}

#[test]
fn a_failing_simulation_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("nowhere/log.csv");
    let output =
        cg(&["simulate", "--vehicle", &kraz(), "--maneuver", "sine", "-o", log.to_str().unwrap()]);
    refused(&output, &["log.csv"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
