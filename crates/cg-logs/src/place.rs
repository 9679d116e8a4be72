//! Places in logs, for messages.

use std::fmt;

/// A place in a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named by the caller.
    pub file: Box<str>,
    /// Where in the file.
    pub position: Position,
}

/// A position in a log. Both counts start at one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// The file as a whole.
    File,
    /// A line of text, comments and blank lines counted.
    Line(u64),
    /// A row of a parquet file.
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
