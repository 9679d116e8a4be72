//! The check of a vehicle file: every number beside what is possible and what is usual, and the
//! numbers beside each other. All findings at once.
//!
//! | file | what |
//! |---|---|
//! | `table` | every key: meaning, unit, possible and usual range |
//! | `keys` | what such an entry is |
//! | `ranges` | numbers beyond their ranges; the numbers farthest from usual |
//! | `shapes` | names, lengths of lists, orders |
//! | `relations`, `tables` | numbers that contradict each other |
//! | `finding` | what is told, and its place in the file |

mod finding;
mod keys;
mod ranges;
mod relations;
mod shapes;
mod table;
mod tables;

use toml::Table;

pub use finding::{Finding, Severity};
/// A table of the vehicle file.
pub use keys::Table as KeyTable;
pub(crate) use keys::plain;
pub use keys::{Key, Kind, Range};
pub use ranges::Unusual;
pub use table::{TABLES, key};

use crate::error::VehicleError;
use crate::vehicle::Vehicle;

/// Reads the text of a vehicle file; warnings stand beside the vehicle.
pub(crate) fn checked(text: &str, file: &str) -> Result<(Vehicle, Vec<Finding>), VehicleError> {
    let located = |findings| finding::located(findings, text);
    let refused =
        |findings| VehicleError::Invalid { file: file.to_owned(), findings: located(findings) };
    let syntax = |source| VehicleError::syntax(file, &source);
    let root: Table = toml::from_str(text).map_err(syntax)?;
    // Unknown keys first: a misspelt key is also a missing one, and its place says more.
    let unknown = shapes::axle_keys(&root);
    if !unknown.is_empty() {
        return Err(refused(unknown));
    }
    let vehicle: Vehicle = toml::from_str(text).map_err(syntax)?;
    let mut findings = ranges::findings(&ranges::numbers(&root));
    findings.extend(shapes::findings(&vehicle));
    let related = relations::findings(&vehicle, &findings);
    findings.extend(related);
    if findings.iter().any(|finding| finding.severity == Severity::Error) {
        return Err(refused(findings));
    }
    Ok((vehicle, located(findings)))
}

/// The numbers of a vehicle that are farthest from usual, farthest first.
pub(crate) fn farthest(vehicle: &Vehicle, most: usize) -> Vec<Unusual> {
    let root = Table::try_from(vehicle).unwrap_or_default();
    ranges::farthest(&ranges::numbers(&root), most)
}
