//! The commands as a user runs them: keys, formats, round trips.
#![allow(clippy::unwrap_used)] // helpers of tests

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).display().to_string()
}

fn cg(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_cg")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn json_lines_have_the_keys_of_the_contract_in_the_order_of_the_arguments() {
    let (a, b) = (fixture("logs/A_p20_h190_v50_L.csv"), fixture("logs/C_p15_h185_v50_R.csv"));
    let kraz = fixture("vehicles/kraz.toml");
    let run = |jobs| {
        lines(&cg(&["estimate", &a, &b, "--vehicle", &kraz, "--format", "json", "--jobs", jobs]))
    };
    let answers = run("2");
    assert_eq!(answers, run("1"));
    assert_eq!(answers[0]["log"], a.as_str());
    assert_eq!(answers[1]["log"], b.as_str());
    assert_eq!(
        keys(&answers[0]),
        [
            "channel",
            "fit_percent",
            "height_ci95_m",
            "height_m",
            "height_sd_m",
            "log",
            "maneuvers",
            "messages",
            "method",
            "ratio",
            "ratio_sd",
            "snr_db",
            "speed_mps",
            "static_rollover_threshold_g",
            "status",
            "trailer_mass_kg",
        ]
    );
    assert_eq!(
        keys(&answers[0]["maneuvers"][0]),
        [
            "end_s",
            "height_m",
            "height_sd_m",
            "ratio",
            "ratio_sd",
            "reason",
            "snr_db",
            "start_s",
            "status"
        ]
    );
}

#[test]
fn the_model_command_gives_the_printed_numbers() {
    let output = cg(&[
        "model",
        "--vehicle",
        &fixture("vehicles/baseline.toml"),
        "--model",
        "as-printed",
        "--format",
        "json",
    ]);
    let model: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "numerator",
        "denominator",
        "poles",
        "zeros",
        "gain",
        "dc_gain",
        "reduced",
        "static_balance",
    ] {
        assert!(!model[key].is_null(), "{key}");
    }
    let ratio = |a: &str, b: &str| {
        model["ratio"][a].as_f64().unwrap() / model["ratio"][b].as_f64().unwrap()
    };
    // Eq. 5.17 in metres.
    for (ours, printed) in [
        (ratio("a1", "a0"), 0.519_320 / 0.0254),
        (ratio("b1", "b0"), -1.775_489_4e-3 / 0.0254),
        (ratio("a0", "b0"), 0.011_837_4),
    ] {
        assert!((ours / printed - 1.0).abs() < 1e-4, "{ours} {printed}");
    }
}

fn simulate(folder: &TempDir, name: &str, more: &[&str]) -> (PathBuf, Value) {
    let (log, truth) = (folder.path().join(name), folder.path().join("truth.json"));
    let (log_text, truth_text) = (log.display().to_string(), truth.display().to_string());
    let mut arguments = vec!["simulate", "-o", &log_text, "--truth", &truth_text];
    arguments.extend(more);
    cg(&arguments);
    (log, serde_json::from_str(&std::fs::read_to_string(truth).unwrap()).unwrap())
}

#[test]
fn a_simulated_log_gives_the_height_that_made_it() {
    let folder = TempDir::new().unwrap();
    for vehicle in ["vehicles/baseline.toml", "vehicles/kraz.toml"] {
        let vehicle = fixture(vehicle);
        for plant in ["linear", "reduced"] {
            for maneuver in ["rounded-step", "steady-turn", "sine", "drive"] {
                let (log, truth) = simulate(
                    &folder,
                    "log.csv",
                    &["--vehicle", &vehicle, "--maneuver", maneuver, "--plant", plant],
                );
                let answer = &lines(&cg(&[
                    "estimate",
                    log.to_str().unwrap(),
                    "--vehicle",
                    &vehicle,
                    "--channel",
                    "steer",
                    "--format",
                    "json",
                ]))[0];
                let (found, known) =
                    (answer["height_m"].as_f64().unwrap(), truth["height_m"].as_f64().unwrap());
                println!("{vehicle} {plant} {maneuver}: {:+.3} %", 100.0 * (found / known - 1.0));
                // What order 5 misses of order 18 and 20, within the prior of 20 %.
                assert!((found / known - 1.0).abs() < 0.01, "{plant} {maneuver}: {found} {known}");
            }
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_log_and_the_truth_in_it_is_not_read() {
    let folder = TempDir::new().unwrap();
    let vehicle = fixture("vehicles/baseline.toml");
    let noisy = |name: &str, seed: &str| {
        simulate(
            &folder,
            name,
            &[
                "--vehicle",
                &vehicle,
                "--maneuver",
                "rounded-step",
                "--snr-db",
                "20",
                "--seed",
                seed,
            ],
        )
        .0
    };
    let (a, b, c) = (noisy("a.csv", "1"), noisy("b.csv", "1"), noisy("c.csv", "2"));
    let text = std::fs::read_to_string(&a).unwrap();
    assert_eq!(text, std::fs::read_to_string(b).unwrap());
    assert_ne!(text, std::fs::read_to_string(c).unwrap());
    assert!(text.starts_with("# truth"));
    let lied = folder.path().join("lied.csv");
    std::fs::write(&lied, text.replace("# truth height_m = 1.97", "# truth height_m = 1.11"))
        .unwrap();
    let height = |log: &Path| {
        let output =
            cg(&["estimate", log.to_str().unwrap(), "--vehicle", &vehicle, "--format", "json"]);
        lines(&output)[0]["height_m"].as_f64().unwrap()
    };
    assert!((height(&a) - height(&lied)).abs() < 1e-15);
}

#[test]
fn foreign_columns_in_other_units_give_the_same_height() {
    let folder = TempDir::new().unwrap();
    let source = std::fs::read_to_string(fixture("logs/C_p15_h185_v50_R.csv")).unwrap();
    let mut foreign = "t [ms];Lenk;Wank;v_kmh;aq\n".to_owned();
    for line in source.lines().skip(1) {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        foreign += &format!(
            "{};{};{};{};{}\n",
            v[0] * 1e3,
            v[1].to_degrees(),
            -v[2].to_degrees(),
            v[3] * 3.6,
            v[4] / 9.806_65
        );
    }
    let log = folder.path().join("foreign.csv");
    std::fs::write(&log, foreign).unwrap();
    let kraz = fixture("vehicles/kraz.toml");
    let height = |arguments: &[&str]| {
        let mut all =
            vec!["estimate", "--vehicle", &kraz, "--format", "json", "--trailer-mass-kg", "23684"];
        all.extend(arguments);
        lines(&cg(&all))[0]["height_m"].as_f64().unwrap()
    };
    let ours = height(&[&fixture("logs/C_p15_h185_v50_R.csv")]);
    let theirs = height(&[
        log.to_str().unwrap(),
        "--column",
        "time=t [ms]",
        "--column",
        "steer=Lenk[deg]",
        "--column",
        "roll=Wank[deg]",
        "--column",
        "speed=v_kmh[kmh]",
        "--column",
        "lateral_acceleration=aq[g]",
        "--flip",
        "roll",
    ]);
    // Conversion to and fro costs a few units in the last place.
    assert!((ours / theirs - 1.0).abs() < 1e-9, "{ours} {theirs}");
}
