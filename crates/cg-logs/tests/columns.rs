//! docs/columns.md lists every column of a log as the code has it.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_logs::log::Signal;

/// The rows of the table: column, meaning, and whether `flip` reverses it.
fn table() -> String {
    let row = |signal: Signal| {
        let sign = if signal.is_directed() { "yes" } else { "" };
        format!("| `{}` | {} | {sign} |\n", signal.column(), signal.meaning().trim_end_matches('.'))
    };
    Signal::ALL.into_iter().map(row).collect()
}

#[test]
fn the_page_lists_every_column() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/columns.md");
    let page = std::fs::read_to_string(path).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let found: String = rows.map(|line| line.to_owned() + "\n").collect();
    assert_eq!(found, table(), "the rows of docs/columns.md should be\n{}", table());
}
