//! `cg study`: it writes both files or none. The tests of `cg-thesis` check the results of the
//! studies.

use crate::common::{Run, Scratch, cg, fixture};

const NAMES: [&str; 16] = [
    "height-steady",
    "height-lane-change",
    "cornering-angle",
    "gate-length",
    "lane-change-speed",
    "roll-inertia",
    "height",
    "fifth-wheel",
    "payload-height",
    "lateral-shift",
    "longitudinal-shift",
    "suspension",
    "tyres",
    "accuracy",
    "roads",
    "in-service",
];

/// A short study.
const SHORT: &str = "height-lane-change";

fn study(more: &[&str]) -> Run {
    cg(&[&["study"][..], more].concat())
}

fn read(scratch: &Scratch, name: &str) -> String {
    std::fs::read_to_string(scratch.path(name)).unwrap()
}

#[test]
fn all_studies_are_listed_with_a_sentence_and_their_figures() {
    let list = study(&["--list"]).done();
    assert_eq!(list.out.lines().count(), NAMES.len() + 1);
    assert!(list.out.contains("replay"));
    for (line, name) in list.out.lines().zip(NAMES) {
        assert_eq!(line.split_whitespace().next(), Some(name));
        assert!(
            line.contains('.') && (line.contains("Fig") || NAMES[13..].contains(&name)),
            "{line}"
        );
    }
}

/// The causes are those of the vehicles of the thesis.
#[test]
fn a_verdict_on_another_vehicle_has_no_cause() {
    let scratch = Scratch::new();
    let [folder, vehicle] = [scratch.path(""), fixture("vehicles/kraz.toml")];
    let told = study(&[SHORT, "--vehicle", &vehicle, "-o", &folder]).done().out;
    assert!(told.contains("differs: ") && !told.contains("because"), "{told}");
}

#[test]
fn an_unknown_study_is_refused_with_the_names_there_are() {
    let scratch = Scratch::new();
    for name in ["hight", "", "2.26"] {
        let parts = [&format!("no study `{name}`"), "height-steady", "tyres"];
        study(&[name, "-o", &scratch.path("")]).refused(&parts);
    }
    study(&[]).refused(&["<NAME>"]);
    study(&["height", "--list"]).refused(&["--list"]);
    assert!(scratch.names().is_empty());
}

#[test]
fn a_study_writes_a_table_and_a_figure_and_says_what_it_found() {
    let scratch = Scratch::new();
    let folder = scratch.path("new");
    let run = study(&[SHORT, "-o", &folder]).done();
    assert_eq!(scratch.names(), ["new"]);
    for part in ["thesis", "ours", "the same if", "verdict", "Fig. 2.6", "30 m long", "written: "] {
        assert!(run.out.contains(part), "no {part} in {}", run.out);
    }
    let table = read(&scratch, "new/height-lane-change.csv");
    let comments = table.lines().take_while(|line| line.starts_with("# ")).count();
    assert!(comments > 3, "{table}");
    let rows: Vec<&str> = table.lines().skip(comments).collect();
    assert_eq!(rows[0], "figure,series,response,before,after,unit,relative_change_percent");
    assert_eq!(rows.len(), 1 + 14);
    assert!(rows.iter().all(|row| row.split(',').count() == 7), "{table}");

    let figure = read(&scratch, "new/height-lane-change.svg");
    assert!(figure.starts_with("<svg ") && figure.ends_with("</svg>\n"));
    for part in ["semitrailer roll", "Change of the peak (%)", "viewBox"] {
        assert!(figure.contains(part), "no {part}");
    }
    // A second run replaces the files with the same bytes.
    study(&[SHORT, "-o", &folder]).done();
    assert_eq!(read(&scratch, "new/height-lane-change.csv"), table);
    assert_eq!(read(&scratch, "new/height-lane-change.svg"), figure);
}

#[test]
fn a_study_of_another_vehicle_says_so() {
    let scratch = Scratch::new();
    let air = fixture("vehicles/air.toml");
    study(&[SHORT, "--vehicle", &air, "-o", &scratch.path("")]).done();
    assert!(read(&scratch, "height-lane-change.csv").contains("# vehicle: air suspension\n"));
    study(&[SHORT, "--vehicle", &scratch.path("none.toml")]).refused(&["none.toml"]);
}

#[test]
fn a_study_that_cannot_be_written_leaves_nothing() {
    let scratch = Scratch::new();
    let file = scratch.file("file", "precious");
    study(&[SHORT, "-o", &file]).refused(&["is a file", "give a folder with --output"]);
    study(&[SHORT, "-o", &scratch.path("a/b")]).refused(&["cannot be created"]);
    // A folder has the name of the second file, so the first file is not written either.
    std::fs::create_dir(scratch.path("height-lane-change.svg")).unwrap();
    study(&[SHORT, "-o", &scratch.path("")]).refused(&["height-lane-change.svg", "is a folder"]);
    assert_eq!(scratch.names(), ["file", "height-lane-change.svg"]);
}

/// A log of the truck itself: the simulated roll angle is drawn dashed next to the recorded one.
#[test]
fn a_recorded_log_is_driven_again() {
    let scratch = Scratch::new();
    let vehicle = fixture("vehicles/kraz.toml");
    let log = format!("{}=1.85", fixture("logs/C_p15_h185_v50_R.csv"));
    let run =
        study(&["replay", "--vehicle", &vehicle, "--run", &log, "-o", &scratch.path("")]).done();
    assert!(run.out.contains("C_p15_h185_v50_R.csv: roll +1"), "{}", run.out);
    assert_eq!(scratch.names(), ["replay.csv", "replay.svg"]);
    let table = read(&scratch, "replay.csv");
    let column = "figure,series,time_s,roll_deg,lateral_acceleration_g";
    assert!(table.lines().any(|line| line == column), "{table:.300}");
    // A right turn: the vehicle rolls to the left in the log and in the simulation.
    for series in ["\"C_p15_h185_v50_R.csv, 1.85 m\"", "plant"] {
        let last = table.lines().filter_map(|l| l.strip_prefix(&format!(",{series},"))).next_back();
        let last = last.unwrap();
        assert!(last.split(',').nth(2).unwrap().starts_with("-0.1"), "{last}");
    }
}

#[test]
fn a_replay_says_what_it_needs() {
    let vehicle = fixture("vehicles/kraz.toml");
    let log = format!("{}=1.85", fixture("logs/C_p15_h185_v50_R.csv"));
    study(&["replay", "--run", &log]).refused(&["--vehicle"]);
    study(&["replay", "--vehicle", &vehicle]).refused(&["--run LOG=HEIGHT_M"]);
    study(&["replay", "--vehicle", &vehicle, "--run", "-=1.85"]).refused(&["standard input"]);
    for option in [["--run", &log], ["--flip", "roll"], ["--column", "roll=Gyro[deg]"]] {
        study(&["height", option[0], option[1]]).refused(&[option[0], "`replay` only"]);
        study(&["--list", option[0], option[1]]).refused(&[option[0], "--list"]);
    }
}
