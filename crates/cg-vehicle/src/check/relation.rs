//! A quantity that follows from several numbers of a vehicle file, compared with its possible and
//! usual range.

use std::collections::HashSet;

use crate::finding::{Finding, Severity, plain, span};

/// A quantity that follows from several numbers.
pub(super) struct Relation {
    /// The key that the message names first, and its value.
    pub(super) key: String,
    pub(super) value: f64,
    /// The other keys on which the quantity depends.
    pub(super) with: Vec<String>,
    /// Name of the quantity in the message.
    pub(super) what: &'static str,
    pub(super) quantity: f64,
    pub(super) unit: &'static str,
    pub(super) usual: [f64; 2],
    pub(super) possible: [f64; 2],
}

/// Collects contradictions between numbers that are possible by themselves.
pub(super) struct Relations {
    /// Keys that already have an error, for lists without index.
    pub(super) bad: HashSet<String>,
    pub(super) found: Vec<Finding>,
}

impl Relations {
    fn is_bad(&self, key: &str) -> bool {
        self.bad.contains(list_of(key))
    }

    pub(super) fn check(&mut self, relation: Relation) {
        let Relation { key, value, with, what, quantity, unit, usual, possible } = relation;
        if self.is_bad(&key) || with.iter().any(|key| self.is_bad(key)) {
            return;
        }
        let inside = |[least, greatest]: [f64; 2]| (least..=greatest).contains(&quantity);
        if inside(usual) {
            return;
        }
        let severity = if inside(possible) { Severity::Warning } else { Severity::Error };
        let rounded = format!("{quantity:.4}").parse().unwrap_or(quantity);
        let problem =
            format!("{what} is {} {unit}", plain(rounded)).trim_end().to_owned() + &others(&with);
        self.found.push(Finding {
            usual: span(usual, unit),
            remedy: "check these numbers and their units".to_owned(),
            ..Finding::new(severity, key, plain(value), problem)
        });
    }
}

fn others(with: &[String]) -> String {
    if with.is_empty() { String::new() } else { format!(", with {}", with.join(", ")) }
}

/// `tyre[0].load_n[3]` is a number of the list `tyre[0].load_n`.
pub(super) fn list_of(key: &str) -> &str {
    let last = key.rfind('.').map_or(0, |dot| dot + 1);
    key[last..].find('[').map_or(key, |bracket| &key[..last + bracket])
}

pub(super) fn keys(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}
