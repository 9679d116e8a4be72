//! Reads the rows of a CSV log.

use std::io::{self, Read};

use super::cell::{Slot, Stop, bad_cell, plan, read_plain};
use super::columns::{Column, column_name, resolve};
use super::error::{ColumnName, LogError, Place, Position};
use super::lines::{Fault, LIMIT_BYTES, Lines};
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
    delimiter: u8,
    names: Box<[Box<str>]>,
    columns: Box<[Column]>,
    plan: Box<[Option<Slot>]>,
    quoted: Quoted,
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
            delimiter: b',',
            names: Box::default(),
            columns: Box::default(),
            plan: Box::default(),
            quoted: Quoted::new(b','),
            over: false,
        };
        if !rows.advance()? {
            return Err(LogError::Empty { place: rows.place() });
        }
        let header = rows.header(options);
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
        if !self.advance()? {
            return Ok(false);
        }
        match read_plain(self.lines.line(), self.delimiter, &self.plan, values) {
            Ok(()) => Ok(true),
            Err(Stop::Quote) => self.read_quoted(values).map(|()| true),
            Err(stop) => Err(self.refuse(&stop)),
        }
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
        self.over = true;
        let place = self.place();
        match fault {
            Fault::TooLong => LogError::TooLong { place, limit_bytes: LIMIT_BYTES },
            Fault::Io(source) if self.gzip && is_damage(&source) => {
                LogError::Gzip { place, source }
            }
            Fault::Io(source) => LogError::Read { place, source },
        }
    }

    /// Reads the header from the current line.
    fn header(&mut self, options: &LogOptions) -> Result<(), LogError> {
        self.names = self.split_names()?;
        self.columns = resolve(&self.place(), &self.names, options)?;
        self.plan = plan(&self.columns, self.names.len());
        Ok(())
    }

    fn split_names(&mut self) -> Result<Box<[Box<str>]>, LogError> {
        let mut record = self.lines.line();
        if self.line == 1 {
            record = record.strip_prefix(BYTE_ORDER_MARK.as_bytes()).unwrap_or(record);
        }
        if str::from_utf8(record).is_err() || record.contains(&0) {
            return Err(LogError::NotUtf8 { place: self.place() });
        }
        if record.contains(&b'\r') {
            return Err(LogError::CarriageReturns { place: self.place() });
        }
        self.delimiter = sniff_delimiter(record);
        self.quoted = Quoted::new(self.delimiter);
        if !self.quoted.begin(record) {
            return Err(LogError::OpenQuote { place: self.place() });
        }
        let name = |field| String::from_utf8_lossy(field).trim().into();
        let names: Box<[Box<str>]> = self.quoted.fields().map(name).collect();
        if names.iter().all(|name| fast_float2::parse::<f64, _>(name.as_bytes()).is_ok()) {
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
                .any(field)
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
