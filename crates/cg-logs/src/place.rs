//! Positions in log files for messages.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A file and a position in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The name of the file as given by the caller.
    pub file: Box<str>,
    /// The position in the file.
    pub position: Position,
}

/// A position in a log file. Lines and rows are counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Position {
    /// The whole file.
    File,
    /// A line of text; comments and blank lines are counted.
    Line(u64),
    /// A row of a parquet file, or of a table in memory.
    Row(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Position::File => write!(f, "{}", self.file),
            Position::Line(line) => write!(f, "{}, line {line}", self.file),
            Position::Row(row) => write!(f, "{}, row {row}", self.file),
        }
    }
}
