//! The tables of the vehicle file as a tree: which tables a table contains.

use crate::check::{Key, KeyTable, TABLES};

/// The tables of the table of keys at a path, such as `trailer.axle[i]`.
pub(super) fn at(path: &str) -> impl Iterator<Item = &'static KeyTable> {
    TABLES.iter().filter(move |table| table.paths.contains(&path))
}

/// All keys at a path.
pub(super) fn keys(path: &str) -> impl Iterator<Item = &'static Key> {
    at(path).flat_map(|table| table.keys)
}

/// What the table at a path is; empty for one that only contains others.
pub(super) fn meaning(path: &str) -> &'static str {
    at(path).next().map_or("", |table| table.meaning)
}

/// Whether the table at a path must be present.
pub(super) fn is_required(path: &str) -> bool {
    at(path).any(|table| table.required)
}

/// The steps to the tables within the one at a path, such as `axle[i]`, in the order of the table of
/// keys.
pub(super) fn inner(path: &str) -> Vec<&'static str> {
    let mut steps = Vec::new();
    for all in TABLES.iter().flat_map(|table| table.paths) {
        let rest = if path.is_empty() {
            Some(*all)
        } else {
            all.strip_prefix(path).and_then(|rest| rest.strip_prefix('.'))
        };
        let step = rest.and_then(|rest| rest.split('.').next()).filter(|step| !step.is_empty());
        if let Some(step) = step.filter(|step| !steps.contains(step)) {
            steps.push(step);
        }
    }
    steps
}

/// The path to a table or a key within the table at a path.
pub(super) fn within(path: &str, step: &str) -> String {
    if path.is_empty() { step.to_owned() } else { format!("{path}.{step}") }
}

/// All paths of tables, each before those that it contains.
pub(super) fn paths() -> Vec<String> {
    fn below(path: &str, found: &mut Vec<String>) {
        found.push(path.to_owned());
        for step in inner(path) {
            below(&within(path, step), found);
        }
    }
    let mut found = Vec::new();
    below("", &mut found);
    found
}
