//! What can be wrong with a log: where, what, and what to do about it.

use std::fmt;
use std::io;

use crate::can::CandumpFault;

use super::signal::Signal;
pub use crate::place::{Place, Position};

/// A column of a log: "column 3 `roll_rad`".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnName {
    /// The number of the column, from one.
    pub number: usize,
    /// Its name in the header.
    pub name: Box<str>,
}

impl fmt::Display for ColumnName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {} `{}`", self.number, shown(&self.name, 80))
    }
}

/// Why a log could not be read or written.
///
/// Every message names the file, the line (in parquet: the row), the column where there
/// is one, and the remedy. The fields of the variants mean the same throughout: `place` and
/// `column` say where, `source` and `message` what the system or a library said, `signal`
/// what the column is for; texts taken from the log are shortened and their control
/// characters escaped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the fields are explained once, above")]
pub enum LogError {
    /// The file cannot be opened.
    #[error("{place}: cannot be opened ({source}); check the path and its permissions")]
    Open { place: Place, source: io::Error },
    /// The file cannot be read further.
    #[error("{place}: cannot be read ({source}); check the path, the disk or the connection")]
    Read { place: Place, source: io::Error },
    /// The compressed data end too early or are damaged.
    #[error(
        "{place}: the gzip file is truncated or corrupt here ({source}); copy it again, \
         or save what is whole with `gzip -dc FILE > whole.csv` and drop its last line"
    )]
    Gzip { place: Place, source: io::Error },
    /// Not a parquet file, or a damaged one.
    #[error("{place}: not a readable parquet file ({message}); copy or export it again")]
    Parquet { place: Place, message: Box<str> },
    /// A parquet file, and a build that cannot read it.
    #[error(
        "{place}: this program was built without the feature `parquet`; build it with that feature, \
         or export the log as CSV"
    )]
    ParquetLeftOut { place: Place },
    /// A parquet file on a stream, which cannot be rewound.
    #[error("{place}: parquet cannot be read from a stream; give the path of the file")]
    ParquetStream { place: Place },
    /// No header: nothing but comments and blank lines, or nothing at all.
    #[error("{place}: the log is empty; it needs a header such as time_s,steer_rad,roll_rad")]
    Empty { place: Place },
    /// A header and no rows.
    #[error("{place}: the log has a header but no rows; record or export it again")]
    NoRows { place: Place },
    /// The first line that is no comment holds numbers.
    #[error(
        "{place}: numbers where the header should be; \
         put the column names first, such as time_s,steer_rad,roll_rad"
    )]
    NoHeader { place: Place },
    /// The header is not text.
    #[error("{place}: the header is not UTF-8 text; export the log as CSV in UTF-8")]
    NotUtf8 { place: Place },
    /// Lines that end in a carriage return alone.
    #[error("{place}: lines end in a bare carriage return; save the log with line feeds")]
    CarriageReturns { place: Place },
    /// A line that is not one.
    #[error(
        "{place}: the line is longer than {limit_bytes} bytes; this is no log, or its line feeds \
         were lost, or a quote was never closed"
    )]
    TooLong { place: Place, limit_bytes: usize },
    /// The file ends inside quotes.
    #[error("{place}: the quote opened here is never closed; close or remove it")]
    OpenQuote { place: Place },
    /// A required column, or one that was asked for, is not there.
    #[error("{place}: no column for {wanted}; the columns found are {found}; {remedy}")]
    MissingColumn { place: Place, wanted: Box<str>, found: Box<str>, remedy: Box<str> },
    /// A column of ours with a unit that is not.
    #[error(
        "{place}, {column}: unknown unit; {signal} may come in {accepted}: rename the column, or \
         say which column and unit to take with ⟨columns {signal}=NAME[{}]⟩", .signal.usual_unit()
    )]
    UnknownUnit { place: Place, column: ColumnName, signal: Signal, accepted: Box<str> },
    /// A signal that comes twice.
    #[error(
        "{place}: {signal} comes twice, in {first} and in {second}; remove one, \
         or choose with ⟨columns {signal}=NAME[{}]⟩", .signal.usual_unit()
    )]
    DuplicateSignal { place: Place, signal: Signal, first: ColumnName, second: ColumnName },
    /// One column that two options claim.
    #[error("{place}, {column}: asked for as {first} and as {second}; drop one ⟨columns⟩ option")]
    SharedColumn { place: Place, column: ColumnName, first: Signal, second: Signal },
    /// A sensor to flip that has no sign to turn, or is not in the log.
    #[error("{place}: {signal} cannot be flipped: {reason}; remove it from ⟨flip⟩")]
    Flip { place: Place, signal: Signal, reason: &'static str },
    /// A parquet column that holds no numbers.
    #[error("{place}, {column}: holds {kind}, not numbers; export it as a numeric column")]
    NotNumeric { place: Place, column: ColumnName, kind: Box<str> },
    /// A row with more or fewer fields than the header.
    #[error(
        "{place}: {found} fields where the header has {expected} columns; {}", 
        count_remedy(*.found, *.expected)
    )]
    FieldCount { place: Place, found: usize, expected: usize },
    /// Text where a number should be.
    #[error("{place}, {column}: `{text}` is not a number; {remedy}")]
    NotANumber { place: Place, column: ColumnName, text: Box<str>, remedy: &'static str },
    /// Infinity, or a number that overflows to it.
    #[error(
        "{place}, {column}: `{text}` is not finite; leave the cell empty where there is no value"
    )]
    Infinite { place: Place, column: ColumnName, text: Box<str> },
    /// A row without its time.
    #[error("{place}, {column}: the time is absent; remove the row, or fill the time in")]
    AbsentTime { place: Place, column: ColumnName },
    /// Time that stands still or runs backwards.
    #[error(
        "{place}, {column}: time {time_s} s does not come after {previous_s} s; \
         sort the log by time, or remove the duplicate"
    )]
    TimeOrder { place: Place, column: ColumnName, previous_s: f64, time_s: f64 },
    /// A candump log that cannot be read, or not further.
    #[error("{place}: {source}")]
    Candump { place: Place, source: CandumpFault },
    /// A candump log without roll angles.
    #[error(
        "{place}: none of its {frames} frames has a roll angle that counts (J1939 SSI2 or SSI); for \
         another sensor give ⟨dbc⟩ and ⟨signals⟩{remarks}"
    )]
    NoSamples { place: Place, frames: u64, remarks: Box<str> },
    /// The log cannot be written.
    #[error("{place}: cannot be written ({source}); check the folder, its permissions and space")]
    Write { place: Place, source: io::Error },
    /// A kind of file that is only read.
    #[error("{place}: only CSV is written; end the name in .csv or .csv.gz")]
    WriteFormat { place: Place },
}

impl LogError {
    /// Whether one row alone is bad, so that reading can go on after it.
    pub const fn is_of_a_row(&self) -> bool {
        matches!(
            self,
            Self::FieldCount { .. }
                | Self::NotANumber { .. }
                | Self::Infinite { .. }
                | Self::AbsentTime { .. }
                | Self::TimeOrder { .. }
        )
    }
}

fn count_remedy(found: usize, expected: usize) -> &'static str {
    if found < expected {
        "complete the row or remove it (a last row may have been cut off)"
    } else {
        "remove what is too much, put text with delimiters in quotes, \
         and write decimals with a point"
    }
}

/// At most `limit` characters of a text, control characters escaped.
pub(super) fn shown(text: &str, limit: usize) -> String {
    let mut out = String::new();
    for (count, letter) in text.chars().enumerate() {
        if count == limit {
            out.push('…');
            break;
        }
        if letter.is_control() || matches!(letter, '\u{200e}'..='\u{202e}' | '\u{feff}') {
            out.extend(letter.escape_default());
        } else {
            out.push(letter);
        }
    }
    out
}

/// The same for bytes of unknown encoding, of which only the head is looked at.
pub(super) fn shown_bytes(bytes: &[u8]) -> Box<str> {
    const LIMIT: usize = 40;
    let head = bytes.get(..=4 * LIMIT).unwrap_or(bytes);
    shown(&String::from_utf8_lossy(head), LIMIT).into()
}
