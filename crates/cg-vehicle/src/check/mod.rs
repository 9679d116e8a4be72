//! The check of a vehicle file: every number beside what is possible and what is usual, and the
//! numbers beside each other. All findings at once.
//!
//! | file | what |
//! |---|---|
//! | `table` | every key: meaning, unit, possible and usual range |
//! | `keys` | what such an entry is |
//! | `ranges` | numbers beyond their ranges; the numbers farthest from usual |
//! | `shapes` | names, lengths of lists, orders |
//! | `relation`, `relations`, `tables` | numbers that contradict each other |
//! | `place` | where in the file a finding is |
//! | `read` | reads a vehicle file and runs all checks |

mod keys;
mod place;
mod relation;
mod table;
mod ranges;
mod shapes;
mod tables;
mod relations;
mod read;

/// A table of the vehicle file.
pub use keys::Table as KeyTable;
pub use keys::{Key, Kind, Range};
pub use table::{TABLES, key};
