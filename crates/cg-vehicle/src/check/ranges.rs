//! Compares every number of a vehicle file with the range of its key.

use toml::{Table, Value};

use super::keys::{Key, Range};
use super::table;
use crate::finding::{Finding, Severity};
use crate::finding::{Unusual, plain, span};

/// A number in the file.
#[derive(Clone, Debug)]
pub(super) struct Number {
    /// Its path: `tyre[0].load_n[3]`.
    pub(super) path: String,
    /// Its key: `tyre[0].load_n`.
    pub(super) key: String,
    /// Its key in the table of keys, with `[i]` for any index: `tyre[i].load_n`.
    pub(super) place: String,
    /// Its value.
    pub(super) value: f64,
}

/// All numbers of a file.
pub(super) fn numbers(root: &Table) -> Vec<Number> {
    let mut found = Vec::new();
    in_table(root, "", "", &mut found);
    found
}

fn in_table(entries: &Table, path: &str, place: &str, found: &mut Vec<Number>) {
    for (name, value) in entries {
        let under =
            |above: &str| if above.is_empty() { name.clone() } else { format!("{above}.{name}") };
        let key = under(path);
        in_value(value, &key, &key, &under(place), found);
    }
}

fn in_value(value: &Value, path: &str, key: &str, place: &str, found: &mut Vec<Number>) {
    let number = match value {
        Value::Float(number) => *number,
        #[allow(clippy::cast_precision_loss)] // rounded in the same way as by serde
        Value::Integer(number) => *number as f64,
        Value::Table(entries) => return in_table(entries, path, place, found),
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                let path = format!("{path}[{i}]");
                if item.is_table() {
                    in_value(item, &path, &path, &format!("{place}[i]"), found);
                } else {
                    in_value(item, &path, key, place, found);
                }
            }
            return;
        }
        _ => return,
    };
    let (path, key, place) = (path.to_owned(), key.to_owned(), place.to_owned());
    found.push(Number { path, key, place, value: number });
}

/// Numbers outside the ranges of their keys. Of a list, only the first one of each severity is
/// reported, with the number of the others.
pub(super) fn findings(numbers: &[Number]) -> Vec<Finding> {
    let mut merged: Vec<Finding> = Vec::new();
    let mut of: Vec<(&str, usize)> = Vec::new(); // key and number of values of each finding
    for number in numbers {
        let Some(key) = table::key(&number.place) else { continue };
        let Some(range) = key.range() else { continue };
        let Some(finding) = finding(number, key, range) else { continue };
        let known = (0..merged.len())
            .find(|&i| of[i].0 == number.key && merged[i].severity == finding.severity);
        if let Some(i) = known {
            of[i].1 += 1;
        } else {
            merged.push(finding);
            of.push((&number.key, 1));
        }
    }
    for (finding, (_, values)) in merged.iter_mut().zip(of) {
        if values > 1 {
            finding.remedy = format!(
                "{}; the same applies to {} more values of the list",
                finding.remedy,
                values - 1
            );
        }
    }
    merged
}

fn finding(number: &Number, key: &Key, range: Range) -> Option<Finding> {
    let value = number.value;
    if range.is_possible(value) && range.is_usual(value) {
        return None;
    }
    let severity = if range.is_possible(value) { Severity::Warning } else { Severity::Error };
    let [least, greatest] = range.possible;
    let problem = if severity == Severity::Warning {
        let much = if value < range.usual[0] { "small" } else { "large" };
        format!("is unusually {much}")
    } else if !value.is_finite() {
        "must be a finite number".to_owned()
    } else if least > 0.0 && value <= 0.0 {
        "must be a positive number".to_owned()
    } else if least == 0.0 && value < 0.0 {
        "must not be negative".to_owned()
    } else {
        format!("is impossible (possible: {})", span([least, greatest], key.unit))
    };
    Some(Finding {
        usual: range.usual_in(key.unit),
        remedy: remedy(value, key.unit, range),
        ..Finding::new(severity, number.path.as_str(), plain(value), problem)
    })
}

/// Units that are often used by mistake instead of those of the file, and their conversion factors.
const UNITS: [(&str, &[(&str, f64)]); 13] = [
    ("m", &[("mm", 1e-3), ("cm", 1e-2), ("inch", 0.0254)]),
    ("kg", &[("t", 1e3), ("lb", 0.453_592_37), ("N", 0.102)]),
    ("N", &[("kN", 1e3), ("kg", 9.81)]),
    ("N m", &[("kN m", 1e3)]),
    ("N/m", &[("kN/m", 1e3)]),
    ("N s/m", &[("kN s/m", 1e3)]),
    ("N/rad", &[("kN/rad", 1e3), ("N/deg", 57.3)]),
    ("N m/rad", &[("kN m/rad", 1e3), ("N m/deg", 57.3)]),
    ("N m s/rad", &[("kN m s/rad", 1e3)]),
    ("kg m²", &[("t m²", 1e3)]),
    ("rad", &[("degrees", 0.017_453_293)]),
    ("m/s", &[("km/h", 1.0 / 3.6)]),
    ("Pa", &[("bar", 1e5), ("kPa", 1e3)]),
];

fn remedy(value: f64, unit: &str, range: Range) -> String {
    let others = UNITS.iter().find(|(name, _)| *name == unit).map_or(&[][..], |(_, others)| others);
    let usual = |size: f64| {
        let value = value * size;
        (range.usual[0]..=range.usual[1]).contains(&value)
    };
    match others.iter().find(|(_, size)| usual(*size)) {
        Some((other, _)) => {
            format!("{} {other} would be usual, but the key is in {unit}", plain(value))
        }
        None => "check the number and its unit".to_owned(),
    }
}

/// The least usual numbers, one for each key, the least usual one first.
pub(super) fn farthest(numbers: &[Number], most: usize) -> Vec<Unusual> {
    let mut all: Vec<(&str, Unusual)> = numbers
        .iter()
        .filter_map(|number| {
            let key = table::key(&number.place)?;
            let range = key.range()?;
            let unusual = Unusual {
                key: number.path.clone(),
                value: number.value,
                usual: range.usual_in(key.unit),
                distance: range.distance(number.value),
            };
            Some((number.place.as_str(), unusual))
        })
        .collect();
    all.sort_by(|a, b| b.1.distance.total_cmp(&a.1.distance));
    let mut named: Vec<&str> = Vec::new();
    let mut chosen = Vec::new();
    for (place, unusual) in all {
        if chosen.len() < most && !named.contains(&place) {
            named.push(place);
            chosen.push(unusual);
        }
    }
    chosen
}
