//! What README and docs/thesis.md say about the thesis is what the named commands print.
#![allow(clippy::unwrap_used)] // helpers of tests

use std::path::PathBuf;

use cg_thesis::reproduce::{Options, Row, table, tables};
use cg_thesis::study::studies;

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn page(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap()
}

/// A number as in the pages.
fn number(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('-', "−")
}

/// The numbers of ours, or of the thesis, whose item contains both parts, in the order of the table.
fn column(rows: &[Row], parts: [&str; 2], of: fn(&Row) -> Option<f64>) -> Vec<f64> {
    let wanted = |row: &&Row| parts.iter().all(|part| row.item.contains(part));
    rows.iter().filter(wanted).filter_map(of).collect()
}

fn ours(row: &Row) -> Option<f64> {
    row.ours
}

fn thesis(row: &Row) -> Option<f64> {
    row.thesis
}

/// Least and greatest number.
fn ends(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

#[track_caller]
fn holds(page: &str, text: &str) {
    assert!(page.contains(text), "the page does not say: {text}");
}

/// Table 5.7, as the command prints it without options.
#[test]
fn the_noise_of_20_db_is_as_the_pages_say() {
    let (readme, docs) = (page("README.md"), page("docs/thesis.md"));
    let rows = table("5.7", &Options::default()).unwrap();
    let of = |what: &str, decimals: usize| {
        let item = format!("20 dB: {what}");
        let row = rows.iter().find(|row| row.item == item);
        number(row.unwrap().ours.unwrap(), decimals)
    };
    let [arx, own, off] = ["ARX", "filtered", "filtered, dynamics 20 % off,"];
    let offset = "filtered, dynamics 20 % off, free offset,";
    let pair = |what: &str, decimals: usize| {
        [of(&format!("{what} bias, %"), decimals), of(&format!("{what} RMSE, %"), decimals)]
    };
    for (begins, what) in [
        ("nothing: the thesis's ARX, which has no offset", arx),
        ("the true dynamics within 20 %, no offset", own),
        (
            "dynamics that are wrong by 20 % (each draw by others), no offset: like ARX, which has none",
            off,
        ),
        (
            "the same and a free offset of the sensor, without straight driving before the step: as on board, but harder",
            offset,
        ),
    ] {
        let [bias, rmse] = pair(what, 2);
        holds(&docs, &format!("| {begins} | {bias} % | {rmse} % |"));
    }
    let ([arx_bias, arx_rmse], [bias, rmse]) = (pair(arx, 2), pair(off, 2));
    let [free_bias, free_rmse] = pair(offset, 1);
    holds(
        &readme,
        &format!("RMSE {rmse} %, bias {bias} % (the thesis's ARX: {arx_rmse} %, {arx_bias} %)"),
    );
    holds(&readme, &format!("before the step {free_rmse} %, {free_bias} % |"));
    let [bound, gain] = [of("bound, %", 2), of("bound, gain only, %", 2)];
    holds(&docs, &format!("cannot be better than {bound} %"));
    holds(&docs, &format!("better than {gain} %"));
}

/// Tables 5.10 and 5.11 on the nonlinear plant.
#[test]
fn springs_and_heights_are_as_the_pages_say() {
    let (readme, docs) = (page("README.md"), page("docs/thesis.md"));
    let one = |value: f64| number(value, 1);
    let rows = table("5.11", &Options::default()).unwrap();
    let procedure = column(&rows, ["own plant", "F(s) and ARX"], ours);
    let filtered = column(&rows, ["own plant", "complete and filtered"], ours);
    assert_eq!([procedure.len(), filtered.len()], [8, 8]);
    let [[from, to], [least, most]] = [ends(&procedure), ends(&filtered)].map(|e| e.map(one));
    holds(&readme, &format!("{least} to {most} % (the thesis's procedure: {from} to {to} %)"));
    let printed = ends(&column(&rows, ["own plant", "F(s) and ARX"], thesis)).map(one);
    let [a, b] = printed;
    holds(&docs, &format!("| {a} … {b} % | {from} … {to} % | {least} … {most} % |"));

    let rows = table("5.10", &Options::default()).unwrap();
    // From the softest springs to the stiffest.
    let span = |part: &str, of: fn(&Row) -> Option<f64>, decimals: usize| {
        let values = column(&rows, ["own plant, bias", part], of);
        assert_eq!(values.len(), 7, "{part}");
        format!("{} … {} %", number(values[0], decimals), number(values[6], decimals))
    };
    // The thesis prints two decimals.
    let printed = span("baseline F(s), ARX", thesis, 2);
    let theirs = span("baseline F(s), ARX", ours, 1);
    let own = span("baseline R_c, filtered", ours, 1);
    holds(&docs, &format!("not recalibrated | {printed} | {theirs} | {own} |"));
    let range = |part: &str, of: fn(&Row) -> Option<f64>| {
        let [least, most] = ends(&column(&rows, ["own plant, bias", part], of)).map(one);
        format!("{least} … {most} %")
    };
    let [printed, theirs] = [thesis, ours].map(|of| range("updated F(s), ARX", of));
    let own = range("updated R_c, filtered", ours);
    holds(&docs, &format!("recalibrated | {printed} | {theirs} | {own} |"));
}

/// Each claim of README's table names a command of `cg`, or a file that runs it as a test.
#[test]
fn every_claim_of_the_readme_names_what_shows_it() {
    let readme = page("README.md");
    let claims = readme.split("## How accurate it is").nth(1).unwrap();
    let claims = claims.split("## How it works").next().unwrap();
    let rows: Vec<&str> = claims.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert!(rows.len() >= 12, "{}", rows.len());
    for row in rows {
        let shown_by = row.trim_end_matches(" |").rsplit(" | ").next().unwrap();
        let file = shown_by.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        let mut tests = file.filter(|file| {
            std::path::Path::new(file).extension().is_some_and(|extension| extension == "rs")
        });
        let exists = tests.any(|file| root().join(file).is_file());
        assert!(exists || shown_by.contains("`cg "), "{row}");
    }
}

/// The tables and studies that the pages name exist.
#[test]
fn the_pages_name_commands_that_exist() {
    let names: Vec<&str> = studies().iter().map(|study| study.name).collect();
    let mut found = 0;
    for name in ["README.md", "docs/thesis.md", "docs/studies.md", "docs/accuracy.md"] {
        let text = page(name);
        let after = |part: &str| -> Vec<String> {
            let word = |rest: &str| -> String {
                let end = |c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '-');
                rest.split(end).next().unwrap_or_default().trim_end_matches('.').to_owned()
            };
            text.split(part).skip(1).map(word).collect()
        };
        for named in after("cg reproduce --table ") {
            assert!(tables().contains(&named.as_str()), "{name}: --table {named}");
            found += 1;
        }
        for named in after("cg study ").into_iter().filter(|named| !named.is_empty()) {
            let is_option = named.starts_with("--") || named == "NAME" || named == "replay";
            assert!(is_option || names.contains(&named.as_str()), "{name}: cg study {named}");
            found += 1;
        }
    }
    assert!(found > 20, "{found}");
}
