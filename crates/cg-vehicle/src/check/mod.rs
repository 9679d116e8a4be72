//! The check of a vehicle file: compares every number with its possible and usual range, and
//! related numbers with each other. It reports all findings at once.
//!
//! | file | contents |
//! |---|---|
//! | `table` | every key: meaning, unit, possible and usual range |
//! | `keys` | the types of the entries in `table` |
//! | `ranges` | numbers outside their ranges; the least usual numbers |
//! | `shapes` | names, lengths of lists, order of axles |
//! | `relation`, `relations`, `tables` | numbers that contradict each other |
//! | `widths` | full widths that are half by mistake, for vehicles that are impossible as a whole |
//! | `place` | position of a finding in the file |
//! | `read` | reads a vehicle file and runs all checks |

mod keys;
mod place;
mod relation;
mod table;
mod ranges;
mod shapes;
mod tables;
mod relations;
mod widths;
mod read;

/// A table of the vehicle file.
pub use keys::Table as KeyTable;
pub use keys::{Key, Kind, Range};
pub use table::{TABLES, key};
