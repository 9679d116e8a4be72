//! Tests of the check of vehicle files.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod fixtures;
mod keys;
mod mutations;
mod slips;

use cg_vehicle::{Vehicle, VehicleError};
use toml::{Table, Value};

const NAMES: [&str; 6] =
    ["air", "baseline", "baseline-tables", "kraz", "worn-tyres-half", "worn-tyres-third"];

fn path(name: &str) -> String {
    format!("{}/../../fixtures/vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap()
}

fn table(name: &str) -> Table {
    text(name).parse().unwrap()
}

/// Checks a changed file.
fn parsed(root: &Table) -> Result<(Vehicle, Vec<cg_vehicle::finding::Finding>), VehicleError> {
    Vehicle::check(&toml::to_string(root).unwrap(), "truck.toml")
}

/// One step of the path to a value.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// The paths to all numbers of a file.
fn numbers(value: &Value, way: &[Step], found: &mut Vec<Vec<Step>>) {
    let further = |step: Step| [way, &[step]].concat();
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                numbers(value, &further(Step::Key(key.clone())), found);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                numbers(item, &further(Step::Index(i)), found);
            }
        }
        Value::Float(_) | Value::Integer(_) => found.push(way.to_vec()),
        _ => {}
    }
}

fn at<'a>(root: &'a mut Table, way: &[Step]) -> &'a mut Value {
    let (first, rest) = way.split_first().unwrap();
    let Step::Key(first) = first else { panic!("a file begins with a key") };
    rest.iter().fold(root.get_mut(first).unwrap(), |value, step| match step {
        Step::Key(key) => value.get_mut(key).unwrap(),
        Step::Index(i) => value.get_mut(*i).unwrap(),
    })
}

/// The path as text: `tyre[0].load_n[3]`.
fn words(way: &[Step]) -> String {
    way.iter().fold(String::new(), |text, step| match step {
        Step::Key(key) if text.is_empty() => key.clone(),
        Step::Key(key) => format!("{text}.{key}"),
        Step::Index(i) => format!("{text}[{i}]"),
    })
}

/// The key without the index of a list entry.
fn list_of(key: &str) -> &str {
    let last = key.rfind('.').map_or(0, |dot| dot + 1);
    key[last..].find('[').map_or(key, |bracket| &key[..last + bracket])
}
