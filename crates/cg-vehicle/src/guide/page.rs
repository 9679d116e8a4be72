//! The page of the documentation about the vehicle file: `page.md`, and a table of keys for each
//! table of the file.

use std::fmt::Write;

use toml::{Table, Value};

use super::{template, tree};
use crate::check::{Key, Kind};
use crate::finding::span;
use crate::vehicle::Vehicle;

/// The page (`docs/vehicle.md`), with one line feed at its end.
pub fn page() -> String {
    let mut text = include_str!("page.md").replace("{widths}", widths().trim_end());
    let example: Table = toml::from_str(&template::everything()).unwrap_or_default();
    for path in tree::paths() {
        if tree::keys(&path).next().is_some() {
            section(&mut text, &path, &example);
        }
    }
    text
}

/// The lengths that are full or half, as their meanings say.
fn widths() -> String {
    let mut text = String::new();
    for path in tree::paths() {
        let is_length = |key: &&Key| {
            ["full ", "half "].iter().any(|beginning| key.meaning.starts_with(beginning))
        };
        for key in tree::keys(&path).filter(is_length) {
            let place = tree::within(&path, key.name).replace("[i]", "");
            let _ = writeln!(text, "* `{place}`: {}.", key.meaning);
        }
    }
    text
}

fn section(text: &mut String, path: &str, example: &Table) {
    let header = match path.strip_suffix("[i]") {
        _ if path.is_empty() => "At the top of the file".to_owned(),
        Some(list) => format!("`[[{}]]`", list.replace("[i]", "")),
        None => format!("`[{}]`", path.replace("[i]", "")),
    };
    let optional = if tree::is_required(path) { "" } else { " (optional)" };
    let meaning = tree::meaning(path);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n### {header}: {meaning}{optional}\n");
    let _ = writeln!(text, "| key | unit | meaning | usual | possible | if absent |");
    let _ = writeln!(text, "|---|---|---|---|---|---|");
    for key in tree::keys(path) {
        let (usual, possible) = ranges(key);
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {usual} | {possible} | {} |",
            key.name,
            key.unit,
            key.meaning,
            absent(key, path, example)
        );
    }
}

/// The usual and the possible values.
fn ranges(key: &Key) -> (String, String) {
    match (key.kind, key.range()) {
        (Kind::Number(_), Some(range)) => (range.usual_in(""), span(range.possible, "")),
        (_, Some(range)) => {
            (format!("list: {}", range.usual_in("")), format!("list: {}", span(range.possible, "")))
        }
        (Kind::Flag, _) => ("true or false".to_owned(), String::new()),
        (Kind::Whole, _) => ("whole number".to_owned(), String::new()),
        _ => ("text".to_owned(), String::new()),
    }
}

/// What a missing key means: it is required, or the value that is read instead.
fn absent(key: &Key, path: &str, example: &Table) -> String {
    if key.required {
        return "required".to_owned();
    }
    let mut without = Value::Table(example.clone());
    if let Some(table) = first(&mut without, path) {
        table.remove(key.name);
    }
    // As text, because all that reads a vehicle from a value would be another tenth of the code of this crate.
    let text = toml::to_string(&without).ok();
    let read: Option<Vehicle> = text.and_then(|text| toml::from_str(&text).ok());
    let value = read
        .and_then(|read| Value::try_from(read).ok())
        .and_then(|mut read| first(&mut read, path)?.remove(key.name));
    let value = value.filter(|value| value.as_array().is_none_or(|list| !list.is_empty()));
    value.map_or_else(|| "none".to_owned(), |value| value.to_string())
}

/// The first table of a file at a path.
fn first<'a>(root: &'a mut Value, path: &str) -> Option<&'a mut Table> {
    let mut value = root;
    for step in path.split('.').filter(|step| !step.is_empty()) {
        let name = step.trim_end_matches("[i]");
        value = value.get_mut(name)?;
        if name != step {
            value = value.get_mut(0)?;
        }
    }
    value.as_table_mut()
}
