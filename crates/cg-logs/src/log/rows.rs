//! Reads the rows of a CSV log.

use std::io::{self, Read};

use super::cell::{Slot, Stop, Writing, bad_cell, plan, read_plain};
use super::clock;
use super::columns::{Column, column_name, resolve};
use super::error::{ColumnName, LogError, Place, Position};
use super::heading::{Heading, Stated, are_units};
use super::lines::{Fault, LIMIT_BYTES, Lines};
use super::numbers::{read_any_numbers, read_numbers};
use super::options::LogOptions;
use super::quoted::Quoted;
use super::signal::Signal;

const BYTE_ORDER_MARK: &str = "\u{feff}";

pub(super) struct Rows {
    file: Box<str>,
    gzip: bool,
    lines: Lines,
    /// The line in which the current record begins.
    line: u64,
    writing: Writing,
    names: Box<[Heading]>,
    columns: Box<[Column]>,
    plan: Box<[Option<Slot>]>,
    quoted: Quoted,
    options: LogOptions,
    /// The current line is a row that has not been read yet.
    held: bool,
    /// How often the first row may still turn out to be a row of units, or to have points in time.
    looks: u8,
    over: bool,
}

impl Rows {
    pub(super) fn open(
        file: &str,
        source: Box<dyn Read + Send>,
        gzip: bool,
        options: &LogOptions,
    ) -> Result<Self, LogError> {
        let mut rows = Self {
            file: file.into(),
            gzip,
            lines: Lines::new(source),
            line: 1,
            writing: Writing::new(b','),
            names: Box::default(),
            columns: Box::default(),
            plan: Box::default(),
            quoted: Quoted::new(b','),
            options: options.clone(),
            held: false,
            looks: 2,
            over: false,
        };
        if !rows.advance()? {
            return Err(LogError::Empty { place: rows.place() });
        }
        let header = rows.header();
        header.map_err(|error| rows.damage().unwrap_or(error))?;
        Ok(rows)
    }

    pub(super) fn columns(&self) -> &[Column] {
        &self.columns
    }

    pub(super) fn name(&self, index: usize) -> ColumnName {
        column_name(&self.names, index)
    }

    pub(super) fn position(&self) -> Position {
        Position::Line(self.line)
    }

    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), position: self.position() }
    }

    /// Reads the signals of the next row into `values`. Returns `false` at the end.
    #[inline]
    pub(super) fn read(&mut self, values: &mut [f64; Signal::COUNT]) -> Result<bool, LogError> {
        if self.held {
            self.held = false;
        } else if self.read_ahead(values) {
            return Ok(true);
        } else if !self.advance()? {
            return Ok(false);
        }
        let looks = std::mem::take(&mut self.looks);
        match read_plain(self.lines.line(), &mut self.writing, &self.plan, values) {
            Ok(()) => Ok(true),
            Err(_) if looks > 0 && self.learns()? => {
                self.looks = looks - 1;
                self.read(values)
            }
            Err(Stop::Quote) => self.read_quoted(values).map(|()| true),
            Err(stop) => Err(self.refuse(&stop)),
        }
    }

    /// Reads the next row in place if it is plain numbers and has been read from the source.
    #[inline]
    fn read_ahead(&mut self, values: &mut [f64; Signal::COUNT]) -> bool {
        if self.over || !self.writing.has_points() {
            return false;
        }
        let (text, delimiter) = (self.lines.ahead(), self.writing.delimiter);
        let (mut length, mut long) = (None, self.writing.long);
        if long == 0 {
            length = read_numbers(text, delimiter, &self.plan, values);
        }
        if length.is_none() {
            length = read_any_numbers(text, delimiter, &self.plan, &mut long, values);
        }
        if !length.is_some_and(|length| self.lines.skip(length)) {
            return false;
        }
        self.writing.long = long;
        self.line = self.lines.number();
        self.looks = 0;
        true
    }

    /// The error of a damaged gzip file, if damage explains an invalid row. Damaged data decompress
    /// to arbitrary bytes until a checksum fails, often the last one. The search reads the rest of
    /// the file.
    pub(super) fn damage(&mut self) -> Option<LogError> {
        if !self.gzip || self.over {
            return None;
        }
        self.over = true;
        self.lines.drain().err().map(|source| self.fail(Fault::Io(source)))
    }

    /// Takes the next line that is neither a comment nor blank. Returns `false` at the end.
    #[inline]
    fn advance(&mut self) -> Result<bool, LogError> {
        if self.over {
            return Ok(false);
        }
        loop {
            match self.lines.advance() {
                Ok(true) => {}
                Ok(false) => {
                    self.over = true;
                    return Ok(false);
                }
                Err(fault) => {
                    self.line = self.lines.number() + 1;
                    return Err(self.fail(fault));
                }
            }
            self.line = self.lines.number();
            match self.lines.line() {
                [] | [b'#', ..] => {}
                [b' ', rest @ ..] if rest.iter().all(|&byte| byte == b' ') => {}
                record if self.line == 1 && only_mark(record) => {}
                _ => return Ok(true),
            }
        }
    }

    #[cold]
    fn fail(&mut self, fault: Fault) -> LogError {
        let place = self.place();
        let error = match fault {
            Fault::TooLong => LogError::TooLong { place, limit_bytes: LIMIT_BYTES },
            Fault::Io(source) if self.gzip && is_damage(&source) => {
                LogError::Gzip { place, source }
            }
            Fault::Io(source) => LogError::Read { place, source },
        };
        self.over = !error.is_pause();
        error
    }

    /// Reads the header from the current line. The line after it is read only if the names leave
    /// something open, so that a live stream is not delayed.
    fn header(&mut self) -> Result<(), LogError> {
        self.names = self.split_names()?;
        let header_line = self.line;
        let mut settled = self.settle_at(header_line);
        if settled.is_ok() || !matches!(self.advance(), Ok(true)) {
            return settled;
        }
        self.looks = 0;
        if self.take_units() {
            settled = self.settle_at(header_line);
            if settled.is_ok() || !matches!(self.advance(), Ok(true)) {
                return settled;
            }
        }
        self.held = true;
        self.find_clocks();
        self.settle_at(header_line)
    }

    /// Whether the current line says more about the columns than the header: it is a row of units, or
    /// has points in time.
    #[cold]
    fn learns(&mut self) -> Result<bool, LogError> {
        if !self.take_units() {
            if !self.find_clocks() {
                return Ok(false);
            }
            self.held = true;
        }
        self.settle_at(self.line).map(|()| true)
    }

    /// Finds the columns by the names and what is stated with them.
    fn settle_at(&mut self, line: u64) -> Result<(), LogError> {
        let place = Place { file: self.file.clone(), position: Position::Line(line) };
        self.columns = resolve(&place, &self.names, &self.options)?;
        self.plan = plan(&self.columns, self.names.len());
        Ok(())
    }

    /// The cells of the current line as text.
    fn cells(&mut self) -> Vec<String> {
        if !self.quoted.begin(self.lines.line()) {
            return Vec::new();
        }
        self.quoted.fields().map(|field| one_byte_text(field).trim().to_owned()).collect()
    }

    /// Takes the units from the current line, if it is a row of units.
    #[cold]
    fn take_units(&mut self) -> bool {
        let cells = self.cells();
        if cells.len() != self.names.len() || !are_units(cells.iter().map(String::as_str)) {
            return false;
        }
        for (heading, cell) in self.names.iter_mut().zip(&cells) {
            heading.take_unit(cell);
        }
        true
    }

    /// Marks the columns whose cell in the current line is a point in time. Returns whether there are
    /// any.
    fn find_clocks(&mut self) -> bool {
        let cells = self.cells();
        let mut any = false;
        for (heading, cell) in self.names.iter_mut().zip(&cells) {
            if clock::seconds(cell.as_bytes()).is_some() {
                heading.stated = Stated::Clock;
                any = true;
            }
        }
        any
    }

    fn split_names(&mut self) -> Result<Box<[Heading]>, LogError> {
        let mut record = self.lines.line();
        if self.line == 1 {
            record = record.strip_prefix(BYTE_ORDER_MARK.as_bytes()).unwrap_or(record);
        }
        if record.iter().any(|&byte| byte < b' ' && !b"\t\r".contains(&byte)) {
            return Err(LogError::NotUtf8 { place: self.place() });
        }
        if record.contains(&b'\r') {
            return Err(LogError::CarriageReturns { place: self.place() });
        }
        let delimiter = sniff_delimiter(record);
        self.writing = Writing::new(delimiter);
        self.quoted = Quoted::new(delimiter);
        if !self.quoted.begin(record) {
            return Err(LogError::OpenQuote { place: self.place() });
        }
        let name = |field| Heading::new(one_byte_text(field).trim());
        let names: Box<[Heading]> = self.quoted.fields().map(name).collect();
        if names.iter().all(|h| fast_float2::parse::<f64, _>(h.name.as_bytes()).is_ok()) {
            return Err(LogError::NoHeader { place: self.place() });
        }
        Ok(names)
    }

    fn read_quoted(&mut self, values: &mut [f64; Signal::COUNT]) -> Result<(), LogError> {
        let mut whole = self.quoted.begin(self.lines.line());
        while !whole {
            whole = match self.lines.advance() {
                Ok(true) => self.quoted.extend(self.lines.line()),
                Ok(false) => {
                    self.over = true;
                    return Err(LogError::OpenQuote { place: self.place() });
                }
                Err(fault) => return Err(self.fail(fault)),
            };
            if self.quoted.text_bytes() > LIMIT_BYTES {
                return Err(self.fail(Fault::TooLong));
            }
        }
        let found = self.quoted.fields().len();
        if found != self.plan.len() {
            return Err(self.refuse(&Stop::Count(found)));
        }
        for (index, (field, slot)) in self.quoted.fields().zip(&self.plan).enumerate() {
            let Some(slot) = slot else { continue };
            values[slot.signal] = slot
                .any(field, &mut self.writing)
                .map_err(|bad| bad_cell(self.place(), self.name(index), field, bad))?;
        }
        Ok(())
    }

    #[cold]
    fn refuse(&self, stop: &Stop) -> LogError {
        let place = self.place();
        match stop {
            Stop::Cell(field, range, bad) => {
                let cell = &self.lines.line()[range.clone()];
                bad_cell(place, self.name(*field), cell, *bad)
            }
            Stop::Count(found) => {
                LogError::FieldCount { place, found: *found, expected: self.plan.len() }
            }
            Stop::Quote => LogError::OpenQuote { place },
        }
    }
}

/// UTF-8 text, or Latin-1, in which every byte is the letter of its number.
fn one_byte_text(field: &[u8]) -> String {
    match str::from_utf8(field) {
        Ok(text) => text.to_owned(),
        Err(_) => field.iter().copied().map(char::from).collect(),
    }
}

fn only_mark(record: &[u8]) -> bool {
    let text = record.strip_prefix(BYTE_ORDER_MARK.as_bytes());
    text.is_some_and(|text| text.is_empty() || text[0] == b'#')
}

fn is_damage(error: &io::Error) -> bool {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    matches!(error.kind(), UnexpectedEof | InvalidData | InvalidInput)
}

/// The most frequent of comma, semicolon and tab outside quotes; comma if there is none.
fn sniff_delimiter(header: &[u8]) -> u8 {
    let mut inside = false;
    let mut counts = [(0_usize, b'\t'), (0, b';'), (0, b',')];
    for byte in header {
        inside ^= *byte == b'"';
        for (count, delimiter) in &mut counts {
            *count += usize::from(!inside && byte == delimiter);
        }
    }
    counts.iter().max_by_key(|(count, _)| count).map_or(b',', |&(_, delimiter)| delimiter)
}
