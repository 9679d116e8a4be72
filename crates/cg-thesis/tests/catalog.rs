//! Every numbered table and figure of the thesis is named, with a verdict and its reason.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_thesis::catalog::{Kind, catalog};
use cg_thesis::reproduce::Options;
use cg_thesis::verdict::Verdict;

/// The thesis's own list: tables of chapters 2, 4 and 5, figures of chapters 2 to 5 and appendix C.
fn captions() -> Vec<(Kind, String)> {
    let count = |kind: Kind, chapter: &str, last: u32| -> Vec<(Kind, String)> {
        (1..=last).map(|k| (kind, format!("{chapter}.{k}"))).collect()
    };
    [
        count(Kind::Table, "2", 9),
        count(Kind::Table, "4", 2),
        count(Kind::Table, "5", 11),
        count(Kind::Figure, "2", 31),
        count(Kind::Figure, "3", 5),
        count(Kind::Figure, "4", 2),
        count(Kind::Figure, "5", 9),
        count(Kind::Figure, "C", 10),
    ]
    .concat()
}

#[test]
fn every_table_and_figure_has_one_verdict_and_its_reason() {
    let entries = catalog(&Options { runs: 20, seed: 7 }).unwrap();
    let mut found: Vec<_> = entries.iter().map(|e| (e.kind, e.number.clone())).collect();
    let mut known = captions();
    found.sort();
    known.sort();
    assert_eq!(found, known);
    for entry in &entries {
        assert!(!entry.subject.is_empty() && !entry.because.is_empty(), "{entry:?}");
        assert_ne!(entry.verdict, Verdict::NotPrinted, "{entry:?}");
        // Only a drawing has no command.
        assert_eq!(entry.command.is_empty(), entry.because.contains("drawing"), "{entry:?}");
    }
    let verdict = |kind: Kind, number: &str| {
        entries.iter().find(|e| e.kind == kind && e.number == number).unwrap().verdict
    };
    assert_eq!(verdict(Kind::Table, "4.1"), Verdict::Same);
    // One draw of an unknown noise, and curves without numbers.
    assert_eq!(verdict(Kind::Table, "5.8"), Verdict::Differs);
    assert_eq!(verdict(Kind::Figure, "C.5"), Verdict::NotComputed);
    // The printed inputs do not give the printed slope.
    assert_eq!(verdict(Kind::Figure, "2.26"), Verdict::Differs);
}
