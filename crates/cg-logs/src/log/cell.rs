//! Reads the numbers in the cells of a CSV row.

use super::clock;
use super::columns::Column;
use super::error::{ColumnName, LogError, Place, shown_bytes};
use super::signal::Signal;

/// The position in a row of values, and the conversion to SI, for a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) signal: usize,
    times: f64,
    per: f64,
    /// Whether the field is in SI units already.
    pub(super) is_si: bool,
    clock: bool,
    /// Whether the field may be true or false.
    is_state: bool,
}

impl From<&Column> for Slot {
    fn from(column: &Column) -> Self {
        let &Column { signal, times, per, clock, .. } = column;
        let is_si = [times, per].map(f64::to_bits) == [1.0_f64; 2].map(f64::to_bits);
        Self { signal: signal as usize, times, per, is_si, clock, is_state: signal.is_state() }
    }
}

/// How a file writes numbers: its delimiter, and the decimal sign and digits that it has used so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Writing {
    pub(super) delimiter: u8,
    decimal: Option<u8>,
    /// The signals that have had numbers with many digits or an exponent, a bit for each.
    pub(super) long: u64,
}

impl Writing {
    /// Whether numbers have a decimal point.
    #[inline]
    pub(super) fn has_points(self) -> bool {
        self.decimal == Some(b'.')
    }

    /// A comma that separates fields is no decimal sign.
    pub(super) fn new(delimiter: u8) -> Self {
        let decimal = (delimiter == b',').then_some(b'.');
        Self { delimiter, decimal, long: 0 }
    }

    /// Learns from a number with a decimal point, in a file that may have decimal commas. Returns
    /// `false` if the file has decimal commas.
    #[inline]
    fn see(&mut self, number: &[u8]) -> bool {
        if self.has_points() || !number.contains(&b'.') {
            return true;
        }
        self.decimal.replace(b'.').is_none()
    }

    /// A number with a decimal comma; `None` if the cell is not one.
    #[cold]
    fn with_comma(&mut self, cell: &[u8]) -> Option<Result<f64, BadCell>> {
        let comma = cell.iter().position(|&byte| byte == b',')?;
        if self.delimiter == b',' || cell.len() > 40 {
            return None;
        }
        let mut text = cell.to_vec();
        text[comma] = b'.';
        let value = fast_float2::parse::<f64, _>(&text).ok()?;
        if self.decimal == Some(b'.') {
            return Some(Err(BadCell::Decimals));
        }
        self.decimal = Some(b',');
        Some(Ok(value))
    }
}

/// The reason why a cell is not a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BadCell {
    Text,
    Infinite,
    /// Its decimal sign is not that of the numbers before it.
    Decimals,
}

impl Slot {
    /// Converts a number to SI units.
    #[inline]
    pub(super) fn si(self, value: f64) -> f64 {
        if self.is_si { value } else { value * self.times / self.per }
    }

    /// The number at the beginning of `rest` and its length in bytes, if it is finite and ends at
    /// the delimiter.
    #[inline]
    pub(super) fn plain(self, rest: &[u8], delimiter: u8) -> Option<(f64, usize)> {
        let (value, length) = fast_float2::parse_partial::<f64, _>(rest).ok()?;
        let ends = rest.get(length).is_none_or(|&byte| byte == delimiter);
        let value = self.si(value);
        (ends && value.is_finite()).then_some((value, length))
    }

    /// The number in a whole cell; NaN if the cell is empty, `NaN` or `NA`.
    pub(super) fn any(self, cell: &[u8], writing: &mut Writing) -> Result<f64, BadCell> {
        let cell = cell.trim_ascii();
        if cell.is_empty() || cell.eq_ignore_ascii_case(b"na") {
            return Ok(f64::NAN);
        }
        if self.clock {
            return clock::seconds(cell).ok_or(BadCell::Text);
        }
        if self.is_state
            && let Some(state) =
                [&b"false"[..], b"true"].iter().position(|word| cell.eq_ignore_ascii_case(word))
        {
            return Ok(if state == 0 { 0.0 } else { 1.0 });
        }
        let value = match fast_float2::parse::<f64, _>(cell) {
            Ok(value) if writing.see(cell) => value,
            Ok(_) => return Err(BadCell::Decimals),
            Err(_) => writing.with_comma(cell).ok_or(BadCell::Text)??,
        };
        let value = self.si(value);
        if value.is_infinite() { Err(BadCell::Infinite) } else { Ok(value) }
    }
}

/// The error for a cell, with a remedy that fits its text.
pub(super) fn bad_cell(place: Place, column: ColumnName, cell: &[u8], bad: BadCell) -> LogError {
    let cell = cell.trim_ascii();
    let text = shown_bytes(cell);
    match bad {
        BadCell::Infinite => LogError::Infinite { place, column, text },
        BadCell::Decimals => LogError::TwoDecimals { place, column, text },
        BadCell::Text => LogError::NotANumber { place, column, text, remedy: remedy(cell) },
    }
}

fn remedy(cell: &[u8]) -> &'static str {
    let numeric = |byte: &u8| byte.is_ascii_digit() || b"+-,.".contains(byte);
    if cell.contains(&b',') && cell.len() < 40 && cell.iter().all(numeric) {
        "write decimals with a point, without thousands separators"
    } else if cell.contains(&b'/') && cell.contains(&b':') {
        "write dates with the year first, such as 2024-05-01 12:00:00.02"
    } else {
        "correct it, or leave the cell empty if there is no value"
    }
}

/// A slot for each field of a row; `None` if the field is not read.
pub(super) fn plan(columns: &[Column], fields: usize) -> Box<[Option<Slot>]> {
    let mut plan = vec![None; fields];
    for column in columns {
        plan[column.index] = Some(Slot::from(column));
    }
    plan.into()
}

/// The reason why the fast reading of a row stopped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// A field in quotes; the row needs the slower reading.
    Quote,
    /// The number of fields, which differs from the number of columns.
    Count(usize),
    /// A field that is not a number: its index and its range of bytes.
    Cell(usize, std::ops::Range<usize>, BadCell),
}

/// Reads the planned fields of a row without quotes into `values`.
#[inline]
pub(super) fn read_plain(
    row: &[u8],
    writing: &mut Writing,
    plan: &[Option<Slot>],
    values: &mut [f64; Signal::COUNT],
) -> Result<(), Stop> {
    let mut start = 0;
    let last = plan.len() - 1;
    let delimiter = writing.delimiter;
    for (field, slot) in plan.iter().enumerate() {
        let rest = &row[start..];
        let length = if let Some(slot) = slot {
            if let Some((value, length)) = slot.plain(rest, delimiter) {
                values[slot.signal] = value;
                if !writing.see(&rest[..length]) {
                    return Err(Stop::Cell(field, start..start + length, BadCell::Decimals));
                }
                length
            } else {
                let length = field_length(rest, delimiter)?;
                let stop = |bad| Stop::Cell(field, start..start + length, bad);
                values[slot.signal] = slot.any(&rest[..length], writing).map_err(stop)?;
                length
            }
        } else {
            field_length(rest, delimiter)?
        };
        match (field == last, length == rest.len()) {
            (false, false) => start += length + 1,
            (true, true) => {}
            (false, true) => return Err(Stop::Count(field + 1)),
            (true, false) => {
                let more = memchr::memchr_iter(delimiter, rest).count();
                return Err(Stop::Count(field + 1 + more));
            }
        }
    }
    Ok(())
}

#[inline]
fn field_length(rest: &[u8], delimiter: u8) -> Result<usize, Stop> {
    if rest.first() == Some(&b'"') {
        return Err(Stop::Quote);
    }
    Ok(memchr::memchr(delimiter, rest).unwrap_or(rest.len()))
}
