//! The text of a candump log, as it is replayed frame by frame.

use std::io::Read;

use super::error::{LogError, Place, Position};
use super::frames::{is_asc, is_candump};
use super::source::{Magic, head, sniff, text};

/// What a log is that is expected to be one of candump.
#[non_exhaustive]
pub enum FrameText {
    /// Lines, decompressed. Some may be damaged.
    Candump(Box<dyn Read + Send>),
    /// A log in the format ASC.
    Asc,
    /// A table of rows: CSV or parquet.
    Rows,
}

impl FrameText {
    /// Looks at the beginning of a log, plain or gzip. `name` is its name in messages.
    ///
    /// # Errors
    /// It cannot be read, or is in a format that is not read at all.
    pub fn of(name: &str, stream: Box<dyn Read + Send>) -> Result<Self, LogError> {
        let place = || Place { file: name.into(), position: Position::File };
        let sniffed = sniff(stream).map_err(|source| LogError::Read { place: place(), source })?;
        match sniffed.magic {
            Magic::Parquet => return Ok(Self::Rows),
            Magic::Other(format, remedy) => {
                return Err(LogError::OtherFormat { place: place(), format, remedy });
            }
            Magic::Text | Magic::Gzip => {}
        }
        let (head, text) = head(text(sniffed));
        Ok(if is_candump(&head) {
            Self::Candump(text)
        } else if is_asc(&head) {
            Self::Asc
        } else if is_table(&head) {
            Self::Rows
        } else {
            Self::Candump(text)
        })
    }
}

/// Whether the first line that is not a comment has columns.
fn is_table(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let mut lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| !line.starts_with('(') && line.contains([',', ';', '\t']))
}
