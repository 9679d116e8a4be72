//! Errors of log files: where, what is wrong, and what to do.

use std::fmt;
use std::io;

use crate::can::CandumpFault;

use super::signal::Signal;
pub use crate::place::{Place, Position};

/// A column of a log, displayed as "column 3 `roll_rad`".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnName {
    /// Number of the column, from one.
    pub number: usize,
    /// Name of the column in the header.
    pub name: Box<str>,
}

impl fmt::Display for ColumnName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {} `{}`", self.number, shown(&self.name, 80))
    }
}

/// The reason why a log cannot be read or written.
///
/// Every message contains the file, the line (in parquet files: the row), the column if there is
/// one, and the remedy. The fields have the same meaning in all variants: `place` and `column` are
/// the position, `source` and `message` are the error of the system or of a library, and `signal`
/// is the signal of the column. Texts from the log are shortened and their control characters are
/// escaped.
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
    /// The compressed data are damaged or incomplete.
    #[error(
        "{place}: the gzip file is truncated or corrupt here ({source}); copy it again, \
         or save the intact part with `gzip -dc FILE > whole.csv` and delete its last line"
    )]
    Gzip { place: Place, source: io::Error },
    /// The file is not a parquet file, or it is damaged.
    #[error("{place}: not a readable parquet file ({message}); copy or export it again")]
    Parquet { place: Place, message: Box<str> },
    /// The file is a parquet file, and this build cannot read it.
    #[error(
        "{place}: this program was built without the feature `parquet`; build it with that feature, \
         or export the log as CSV"
    )]
    ParquetLeftOut { place: Place },
    /// The parquet format is read from a stream. It requires a file, because it is read out of
    /// order.
    #[error("{place}: parquet cannot be read from a stream; give the path of the file")]
    ParquetStream { place: Place },
    /// There is no header: the file is empty or contains only comments and blank lines.
    #[error("{place}: the log is empty; it needs a header such as time_s,steer_rad,roll_rad")]
    Empty { place: Place },
    /// There is a header but no row.
    #[error("{place}: the log has a header but no rows; record or export it again")]
    NoRows { place: Place },
    /// The first line that is not a comment contains numbers.
    #[error(
        "{place}: there are numbers instead of a header; \
         put the column names first, such as time_s,steer_rad,roll_rad"
    )]
    NoHeader { place: Place },
    /// The header is no text in one byte per letter.
    #[error("{place}: the header is not UTF-8 or Latin-1 text; export the log as CSV in UTF-8")]
    NotUtf8 { place: Place },
    /// The file has a format that is not read here.
    #[error("{place}: is {format}, which is not read here; {remedy}")]
    OtherFormat { place: Place, format: &'static str, remedy: &'static str },
    /// A file has decimal commas and decimal points.
    #[error(
        "{place}, {column}: `{text}` has another decimal sign than the numbers before it; write all \
         decimals alike, without thousands separators"
    )]
    TwoDecimals { place: Place, column: ColumnName, text: Box<str> },
    /// Lines end with a carriage return only.
    #[error("{place}: lines end in a bare carriage return; save the log with line feeds")]
    CarriageReturns { place: Place },
    /// A line is longer than the limit.
    #[error(
        "{place}: the line is longer than {limit_bytes} bytes; the file is not a log, its line \
         feeds are missing, or a quote is not closed"
    )]
    TooLong { place: Place, limit_bytes: usize },
    /// The file ends inside quotes.
    #[error("{place}: the quote that begins here is not closed; close or remove it")]
    OpenQuote { place: Place },
    /// A column that is required or named by an option is missing.
    #[error("{place}: there is no column for {wanted}; the columns are {found}; {remedy}")]
    MissingColumn { place: Place, wanted: Box<str>, found: Box<str>, remedy: Box<str> },
    /// A column with a known signal name has an unknown unit.
    #[error(
        "{place}, {column}: unknown unit, or two different ones; the units of {signal} are {accepted}; rename the column, \
         or give column and unit with ⟨columns {signal}=NAME[{}]⟩", .signal.usual_unit()
    )]
    UnknownUnit { place: Place, column: ColumnName, signal: Signal, accepted: Box<str> },
    /// Two columns contain the same signal.
    #[error(
        "{place}: the log has {signal} twice, in {first} and in {second}; remove \
         one, or choose one with ⟨columns {signal}=NAME[{}]⟩", .signal.usual_unit()
    )]
    DuplicateSignal { place: Place, signal: Signal, first: ColumnName, second: ColumnName },
    /// Two options use the same column.
    #[error("{place}, {column}: is used as {first} and as {second}; remove one ⟨columns⟩ option")]
    SharedColumn { place: Place, column: ColumnName, first: Signal, second: Signal },
    /// The sign of a signal cannot be reversed because it has no direction or is not in the log.
    #[error("{place}: {signal} cannot be flipped: {reason}; remove it from ⟨flip⟩")]
    Flip { place: Place, signal: Signal, reason: &'static str },
    /// A parquet column contains something other than numbers.
    #[error("{place}, {column}: contains {kind} instead of numbers; export it as a numeric column")]
    NotNumeric { place: Place, column: ColumnName, kind: Box<str> },
    /// A row has more or fewer fields than the header.
    #[error(
        "{place}: {found} fields, but the header has {expected} columns; {}", 
        count_remedy(*.found, *.expected)
    )]
    FieldCount { place: Place, found: usize, expected: usize },
    /// A cell contains text instead of a number.
    #[error("{place}, {column}: `{text}` is not a number; {remedy}")]
    NotANumber { place: Place, column: ColumnName, text: Box<str>, remedy: &'static str },
    /// A cell contains infinity or a number that is too large.
    #[error("{place}, {column}: `{text}` is not finite; leave the cell empty if there is no value")]
    Infinite { place: Place, column: ColumnName, text: Box<str> },
    /// A standard deviation is negative.
    #[error(
        "{place}, {column}: {value} kg is negative, which no standard deviation is; correct it, or leave \
         the cell empty"
    )]
    NegativeSd { place: Place, column: ColumnName, value: f64 },
    /// A row has no time.
    #[error("{place}, {column}: the time is missing; remove the row or enter the time")]
    AbsentTime { place: Place, column: ColumnName },
    /// The time does not increase.
    #[error(
        "{place}, {column}: time {time_s} s does not come after {previous_s} s; {}",
        order_remedy(*.previous_s, *.time_s)
    )]
    TimeOrder { place: Place, column: ColumnName, previous_s: f64, time_s: f64 },
    /// A log of CAN frames cannot be read.
    #[error("{place}: {source}")]
    Candump { place: Place, source: CandumpFault },
    /// A log of CAN frames contains no valid roll angle.
    #[error(
        "{place}: none of its {frames} frames contains a valid roll angle (J1939 SSI2 or SSI); \
         for another sensor give ⟨dbc⟩ and ⟨signals⟩{remarks}"
    )]
    NoSamples { place: Place, frames: u64, remarks: Box<str> },
    /// The log cannot be written.
    #[error("{place}: cannot be written ({source}); check the folder, its permissions and space")]
    Write { place: Place, source: io::Error },
    /// The format can be read but not written.
    #[error("{place}: parquet cannot be written; give a name that ends in .csv or .csv.gz")]
    WriteFormat { place: Place },
}

impl LogError {
    /// Whether nothing has come for now, as a stream says with [`io::ErrorKind::WouldBlock`]: reading can go on later. Nothing that
    /// has come is lost, but for a row whose quotes are open.
    pub fn is_pause(&self) -> bool {
        matches!(self, Self::Read { source, .. } if source.kind() == io::ErrorKind::WouldBlock)
    }

    /// Whether only one row is wrong, so that reading can continue with the next row.
    pub const fn is_of_a_row(&self) -> bool {
        matches!(
            self,
            Self::FieldCount { .. }
                | Self::NotANumber { .. }
                | Self::TwoDecimals { .. }
                | Self::Infinite { .. }
                | Self::NegativeSd { .. }
                | Self::AbsentTime { .. }
                | Self::TimeOrder { .. }
        )
    }
}

fn order_remedy(previous_s: f64, time_s: f64) -> &'static str {
    const DAY_S: f64 = 86_400.0;
    let of_day = time_s >= 0.0 && previous_s <= DAY_S;
    if of_day && previous_s - time_s > 0.5 * DAY_S {
        "a time of day begins again at midnight: write the date before it"
    } else {
        "sort the log by time, or remove the duplicate row"
    }
}

fn count_remedy(found: usize, expected: usize) -> &'static str {
    if found < expected {
        "complete the row or remove it (a last row may have been cut off)"
    } else {
        "remove the extra fields, put text that contains delimiters in quotes, \
         and use a decimal point"
    }
}

/// At most `limit` characters of a text, with control characters escaped.
pub(super) fn shown(text: &str, limit: usize) -> String {
    let mut out = String::new();
    for (count, letter) in text.chars().enumerate() {
        if count == limit {
            out.push('…');
            break;
        }
        if letter.is_control() || is_invisible(letter) {
            out.extend(letter.escape_default());
        } else {
            out.push(letter);
        }
    }
    out
}

/// Whether a letter is a mark of direction, the end of a line or paragraph, or a byte-order mark.
fn is_invisible(letter: char) -> bool {
    matches!(
        letter,
        '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}'
    )
}

/// The beginning of a text of unknown encoding, shortened and escaped like [`shown`].
pub(super) fn shown_bytes(bytes: &[u8]) -> Box<str> {
    const LIMIT: usize = 40;
    let head = bytes.get(..=4 * LIMIT).unwrap_or(bytes);
    shown(&String::from_utf8_lossy(head), LIMIT).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_shortened_once_and_its_marks_are_visible() {
        let once = shown(&"x".repeat(50), 40);
        assert_eq!((once.chars().count(), once.ends_with('…')), (41, true));
        assert_eq!(shown(&once, 80), once);
        assert_eq!(shown("Roll\u{202e}\u{2066}\n – “a”", 40), "Roll\\u{202e}\\u{2066}\\n – “a”");
    }
}
