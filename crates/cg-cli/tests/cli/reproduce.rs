//! `cg reproduce`: the thesis's tables. The tests of `cg-thesis` check how close the values are.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Instant;

use crate::common::{Run, Scratch, cg};
use crate::output::keys;

const TABLES: [&str; 25] = [
    "inputs",
    "5.8-histories",
    "2.1",
    "2.2",
    "2.3",
    "2.4",
    "2.9",
    "4.1",
    "4.2",
    "5.1",
    "5.2",
    "5.3",
    "5.4",
    "5.5",
    "5.6",
    "5.7",
    "5.8",
    "5.9",
    "5.10",
    "5.11",
    "5.12",
    "5.17",
    "5.19",
    "5.6.3",
    "C",
];

fn reproduce(more: &[&str]) -> Run {
    cg(&[&["reproduce"][..], more].concat())
}

#[test]
fn json_lines_have_the_keys_of_the_contract() {
    for row in reproduce(&["--table", "5.11", "--format", "json"]).done().json() {
        let known = ["criterion", "criterion_reason", "item", "note", "ours", "relative_error"];
        assert_eq!(keys(&row)[..6], known);
        assert_eq!(keys(&row)[6..], ["table", "thesis", "verdict"]);
        assert_eq!(row["table"], "5.11");
        assert!(row["item"].is_string() && row["ours"].is_f64(), "{row}");
        assert!(!row["thesis"].is_null() || row["note"].is_string(), "{row}");
    }
}

#[test]
fn without_a_table_all_of_them_come() {
    let run = reproduce(&["--format", "json", "--runs", "2"]).done();
    let rows = run.json();
    let found: BTreeSet<&str> = rows.iter().map(|row| row["table"].as_str().unwrap()).collect();
    assert_eq!(found, BTreeSet::from(TABLES));
    let printed = reproduce(&["--runs", "2"]).done();
    assert_eq!(printed.out.lines().filter(|line| line.contains("the same within")).count(), 25);
}

#[test]
fn a_table_has_a_title_aligned_columns_and_each_note_once() {
    let run = reproduce(&["--table", "Table 4.1"]).done();
    let lines: Vec<&str> = run.out.lines().collect();
    assert_eq!(lines[0], "Table 4.1: coefficients of the transfer function");
    // Two reasons of criteria and one note.
    assert_eq!(lines.len(), 1 + 1 + 35 + 2 + 1);
    // In "A0 … thesis … ours … difference … the same within … verdict … [1]", the cells of each column end at the
    // same place.
    let width = lines[1].chars().count();
    for line in &lines[2..37] {
        assert_eq!(line.chars().count(), width, "{line}");
        assert!(line.ends_with("[1]"), "{line}");
    }
    assert_eq!(run.out.matches("as-printed model").count(), 1);
    assert!(lines[2].contains("-4.5839e25"), "{}", lines[2]);
}

#[test]
fn tables_are_found_however_they_are_called() {
    let plain = reproduce(&["--table", "5.12"]).done();
    for name in ["eq 5.12", "Eq. (5.12)", "equation 5.12"] {
        assert_eq!(reproduce(&["--table", name]).done(), plain, "{name}");
    }
    assert_eq!(reproduce(&["--table", "c"]).done(), reproduce(&["--table", "C"]).done());
}

#[test]
fn an_unknown_table_is_refused_with_the_names_there_are() {
    for name in ["6.1", "", "5", "table"] {
        reproduce(&["--table", name]).refused(&[&format!("`{name}`"), "2.1, 2.2", "5.11", "C"]);
    }
}

#[test]
fn runs_and_seed_are_checked_and_decide_the_draws() {
    for runs in ["0", "-1", "1000001", "many"] {
        reproduce(&[&format!("--runs={runs}")]).refused(&["--runs", "from 1 to 1000000"]);
    }
    reproduce(&["--seed=-1"]).refused(&["--seed"]);
    let drawn = |seed| reproduce(&["--table", "5.7", "--runs", "3", "--seed", seed]).done().out;
    assert_eq!(drawn("1"), drawn("1"));
    assert_ne!(drawn("1"), drawn("2"));
}

#[test]
fn figures_are_written_once_with_their_tables_and_never_over_other_files() {
    let scratch = Scratch::new();
    let path = PathBuf::from(scratch.path("out"));
    let name = path.to_str().unwrap();
    let run = reproduce(&["--figures", name, "--runs", "2"]).done();
    assert_eq!(run.out.lines().count(), 8);
    let map = std::fs::read_to_string(path.join("reproduce-4.1.svg")).unwrap();
    assert!(map.contains("thesis, Table 4.2"));
    let table = std::fs::read_to_string(path.join("reproduce-4.2-C.csv")).unwrap();
    for figure in ["C.1", "4.2 and C.5", "C.10"] {
        assert!(table.lines().any(|line| line.starts_with(figure)), "{figure}");
    }
    // All or none: of the others, no one is written again, whatever their order is.
    let begun = Instant::now();
    for figure in run.out.lines().map(|line| line.strip_prefix("written: ").unwrap()) {
        std::fs::remove_dir_all(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        std::fs::write(figure, "mine").unwrap();
        reproduce(&["--figures", name, "--runs", "5000"]).refused(&[figure, "--figures"]);
        assert_eq!(std::fs::read_to_string(figure).unwrap(), "mine");
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 1, "{figure}");
    }
    // So many draws would take half a minute each time.
    assert!(begun.elapsed().as_secs() < 20);
    let file = scratch.file("file", "mine");
    reproduce(&["--figures", &file]).refused(&["is a file", "a folder with --figures"]);
}
