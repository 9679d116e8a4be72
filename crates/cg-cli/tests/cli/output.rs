//! The formats of `cg estimate`, and options that must not change its results.

use std::path::Path;

use serde_json::Value;

use crate::common::{Run, Scratch, baseline, cg, command, estimate, fixture, height_m, kraz};

const KEYS: [&str; 20] = [
    "channel",
    "channels",
    "fit_percent",
    "height_ci95_m",
    "height_m",
    "height_sd_m",
    "lift_axle",
    "log",
    "maneuvers",
    "messages",
    "method",
    "ratio",
    "ratio_sd",
    "road_share",
    "snr_db",
    "speed_mps",
    "static_rollover_threshold_ci95_g",
    "static_rollover_threshold_g",
    "status",
    "trailer_mass_kg",
];

const MANEUVER_KEYS: [&str; 9] = [
    "end_s",
    "height_m",
    "height_sd_m",
    "ratio",
    "ratio_sd",
    "reason",
    "snr_db",
    "start_s",
    "status",
];

pub(crate) fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

/// A log with a height, one without a height, and one with a turn to the other side.
fn logs(scratch: &Scratch) -> [String; 3] {
    let straight = ["--maneuver", "sine", "--steer-rad", "0"];
    [
        fixture("logs/A_p20_h190_v50_L.csv"),
        scratch.simulate("straight, \"very\".csv", &kraz(), &straight),
        fixture("logs/C_p15_h185_v50_R.csv"),
    ]
}

fn estimate_all(logs: &[String], more: &[&str]) -> Run {
    let mut arguments = vec!["estimate"];
    arguments.extend(logs.iter().map(String::as_str));
    let vehicle = kraz();
    arguments.extend(["--vehicle", &vehicle]);
    arguments.extend(more);
    // One of the logs gives no height.
    cg(&arguments).told(1, &[])
}

#[test]
fn json_lines_have_the_keys_of_the_contract_with_and_without_a_height() {
    let scratch = Scratch::new();
    let answers = estimate_all(&logs(&scratch), &["--format", "json"]).json();
    for answer in &answers {
        assert_eq!(keys(answer), KEYS);
        for maneuver in answer["maneuvers"].as_array().unwrap() {
            assert_eq!(keys(maneuver), MANEUVER_KEYS);
        }
    }
    let (good, none) = (&answers[0], &answers[1]);
    assert_eq!((&good["status"], &none["status"]), (&"ok".into(), &"rejected".into()));
    assert!(!good["maneuvers"].as_array().unwrap().is_empty());
    let interval = |i: usize| good["height_ci95_m"][i].as_f64().unwrap();
    assert!(interval(0) < height_m(good) && height_m(good) < interval(1));
    for key in ["height_m", "height_sd_m", "height_ci95_m", "static_rollover_threshold_g"] {
        assert!(none[key].is_null(), "{none}");
    }
}

/// What a cell of the CSV output stands for in the JSON output.
fn in_json(answer: &Value, column: &str) -> Value {
    let alone = |name: &str| {
        let channels = answer["channels"].as_array().unwrap();
        channels.iter().find(|one| one["channel"] == name).cloned().unwrap_or_default()
    };
    match column {
        "height_ci95_low_m" => answer["height_ci95_m"][0].clone(),
        "height_ci95_high_m" => answer["height_ci95_m"][1].clone(),
        "static_rollover_threshold_ci95_low_g" => {
            answer["static_rollover_threshold_ci95_g"][0].clone()
        }
        "static_rollover_threshold_ci95_high_g" => {
            answer["static_rollover_threshold_ci95_g"][1].clone()
        }
        "maneuvers" => answer["maneuvers"].as_array().unwrap().len().into(),
        "messages" => {
            let all = answer["messages"].as_array().unwrap().iter();
            all.map(|one| one.as_str().unwrap()).collect::<Vec<_>>().join("; ").into()
        }
        "steer_height_m" => alone("steer")["height_m"].clone(),
        "steer_height_sd_m" => alone("steer")["height_sd_m"].clone(),
        "lateral_acceleration_height_m" => alone("lateral-acceleration")["height_m"].clone(),
        "lateral_acceleration_height_sd_m" => alone("lateral-acceleration")["height_sd_m"].clone(),
        // These logs do not have the signals.
        "suspension_height_m"
        | "suspension_height_sd_m"
        | "tractor_height_m"
        | "tractor_height_sd_m" => Value::Null,
        _ => answer[column].clone(),
    }
}

#[test]
fn csv_has_one_row_of_the_same_numbers_for_each_log() {
    let scratch = Scratch::new();
    let logs = logs(&scratch);
    let answers = estimate_all(&logs, &["--format", "json"]).json();
    let text = estimate_all(&logs, &["--format", "csv"]).out;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!((rows.len(), answers.len(), header.len()), (logs.len(), logs.len(), 29));
    for ((row, answer), log) in rows.iter().zip(&answers).zip(&logs) {
        assert_eq!(&row[0], log.as_str());
        for (column, cell) in header.iter().zip(row) {
            match in_json(answer, column) {
                Value::Null => assert_eq!(cell, "", "{column}"),
                Value::String(text) => assert_eq!(cell, text, "{column}"),
                value => {
                    // The JSON reader of this test may be off by one in the last bit.
                    let (a, b) = (cell.parse::<f64>().unwrap(), value.as_f64().unwrap());
                    assert!((a - b).abs() <= 1e-15 * b.abs(), "{column}: {a} {b}");
                }
            }
        }
    }
    // Of the two logs with an answer every number is there, but the height that nobody has told. The trailer has no lift axle.
    for row in [&rows[0], &rows[2]] {
        let empty = header.iter().zip(row).filter(|(_, cell)| cell.is_empty());
        let mut empty = empty.map(|(name, _)| name);
        let elsewhere = |name: &str| name.starts_with("suspension") || name.starts_with("tractor");
        assert!(
            empty.all(|name| ["known_height_m", "messages", "lift_axle"].contains(&name)
                || elsewhere(name)),
            "{row:?}"
        );
    }
}

#[test]
fn the_table_has_one_line_for_each_log_and_its_messages_below() {
    let scratch = Scratch::new();
    let logs = logs(&scratch);
    let text = estimate_all(&logs, &[]).out;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].contains("height") && lines[0].contains("95 % interval"), "{text}");
    for (line, log) in lines[1..].iter().zip(&logs) {
        assert!(line.contains(log.as_str()), "{text}");
    }
    assert!(text.contains("rejected: unexcited"), "{text}");
}

#[test]
fn answers_come_in_the_order_of_the_arguments_whatever_the_number_of_jobs() {
    let scratch = Scratch::new();
    let [a, straight, c] = logs(&scratch);
    // The longest log is first, so that it is not finished first.
    let long = fixture("logs/F_drive1_p15_h155.csv.gz");
    let logs = [long, a.clone(), straight, c, a];
    let [one, two] =
        ["1", "2"].map(|jobs| estimate_all(&logs, &["--format", "json", "--jobs", jobs]));
    assert_eq!(one, two);
    let named: Vec<_> = two.json().iter().map(|answer| answer["log"].clone()).collect();
    assert_eq!(named, logs);
}

#[test]
fn known_heights_stand_beside_and_change_nothing() {
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let without = estimate(&log, &kraz(), &[]).done().answer();
    let scratch = Scratch::new();
    let truth = "[{\"log\": \"A_p20_h190_v50_L.csv\", \"height_m\": 1.23, \"more\": 1}]";
    let truth = scratch.file("truth.json", truth);
    let mut with = estimate(&log, &kraz(), &["--truth", &truth]).done().answer();
    assert_eq!(with.as_object_mut().unwrap().remove("known_height_m"), Some(1.23.into()));
    assert_eq!(with, without);
}

/// The truth beside a simulated log is that of this log alone.
#[test]
fn the_truth_of_a_simulation_is_read() {
    let scratch = Scratch::new();
    let truth = scratch.path("truth.json");
    let more = ["--maneuver", "rounded-step", "--height-m", "1.83", "--truth", &truth];
    let log = scratch.simulate("log.csv", &kraz(), &more);
    let answer = estimate(&log, &kraz(), &["--truth", &truth]).done().answer();
    assert_eq!(answer["known_height_m"], 1.83);
    let two = cg(&["estimate", &log, &log, "--vehicle", &kraz(), "--truth", &truth]);
    two.refused(&[&truth, "the truth of one simulated log, but 2 logs"]);
}

/// The simulated log in the format of another manufacturer's instrument.
fn foreign(text: &str) -> String {
    let mut out = "Zeit [ms];Lenk;Wank;v_kmh;aq;Gier;Masse\n".to_owned();
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    for row in rows {
        let v: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let cells = [
            v[0] * 1e3,
            -v[1].to_degrees(),
            -v[2].to_degrees(),
            v[3] * 3.6,
            v[4] / 9.806_65,
            v[5].to_degrees(),
            v[6] / 1e3,
        ];
        out += &cells.map(|cell| cell.to_string()).join(";");
        out.push('\n');
    }
    out
}

#[test]
fn foreign_columns_in_other_units_and_flipped_give_the_same_height() {
    let scratch = Scratch::new();
    let log = scratch.simulate("si.csv", &baseline(), &["--maneuver", "steady-turn"]);
    let other = scratch.file("foreign.csv", foreign(&std::fs::read_to_string(&log).unwrap()));
    for channel in ["steer", "lateral-acceleration"] {
        let ours = estimate(&log, &baseline(), &["--channel", channel]).done().answer();
        let mut more = vec!["--channel", channel, "--flip", "steer,roll"];
        for column in [
            "time=Zeit [ms]",
            "steer=Lenk[deg]",
            "roll=Wank[deg]",
            "speed=v_kmh",
            "lateral_acceleration=aq[g]",
            "yaw_rate=Gier[degps]",
            "trailer_mass=Masse[t]",
        ] {
            more.extend(["--column", column]);
        }
        let theirs = estimate(&other, &baseline(), &more).done().answer();
        // Converting units twice changes each number by some units in the last place, 1e-15.
        let error = height_m(&theirs) / height_m(&ours) - 1.0;
        assert!(error.abs() < 1e-9, "{channel}: {error:e}");
        assert_eq!(theirs["messages"], ours["messages"]);
    }
}

/// The output that the README shows below its first command is what that command prints.
#[test]
fn the_readme_shows_what_its_first_command_prints() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let first = readme.lines().find_map(|line| line.strip_prefix("cargo run ")).unwrap();
    let (_, arguments) = first.split_once(" -- ").unwrap();
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let run: Run = command(&arguments).current_dir(&root).output().unwrap().into();
    let out = run.done().out;
    assert!(out.lines().count() == 2 && readme.contains(out.trim_end()), "{out}");
}
