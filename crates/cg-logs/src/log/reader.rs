//! The reader of logs: one row at a time for every file format.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::batches::Batches;
use super::beginning::Beginning;
use super::columns::Column;
use cg_core::Quantity;

use super::error::{ColumnName, LogError, Place, Position};
use super::frames::{Frames, is_asc, is_candump};
use super::options::LogOptions;
use super::plausibility::Plausibility;
use super::preparation::Preparation;
use super::rows::Rows;
use super::signal::{LogRow, Signal};
use super::source::{Counted, Magic, Sniffed, head, sniff, text};
use cg_vehicle::scales::Scale;

/// A log that is read row by row in constant memory.
///
/// It reads CSV, candump and ASC logs, plain or gzip, and parquet. The format is detected from the first
/// bytes of the file, not from its name. The reader is also an iterator.
///
/// # Example
///
/// ```
/// use cg_logs::log::{LogOptions, LogReader};
///
/// let csv = "time_s,steer_deg,roll_rad\n0.00,1.5,0.010\n0.01,1.6,\n";
/// let options = LogOptions::default();
/// let mut log = LogReader::from_reader("example", Box::new(csv.as_bytes()), &options)?;
/// let first = log.next_row()?.expect("two rows");
/// assert_eq!(first.steer_rad, 1.5_f64.to_radians());
/// let second = log.next_row()?.expect("two rows");
/// assert!(second.roll_rad.is_nan() && log.line() == 3);
/// assert!(log.next_row()?.is_none());
/// # Ok::<(), cg_logs::log::LogError>(())
/// ```
pub struct LogReader {
    body: Body,
    signals: Box<[Signal]>,
    /// Quantities that may have a value.
    quantities: Box<[Quantity]>,
    values: [f64; Signal::COUNT],
    /// What the truck can have, if it is known.
    plausibility: Option<Plausibility>,
    preparation: Option<Preparation>,
    /// Rows that were read before they are given, until one is read after them.
    beginning: Option<Box<Beginning>>,
    /// The row that was given last and its line, if rows are prepared.
    given: Option<(u64, LogRow)>,
    /// Whether the rows of the file are at their end.
    at_end: bool,
    previous_s: f64,
    /// Whether a row, valid or not, has been read.
    begun: bool,
    /// Whether the caller continues after invalid rows.
    over_bad_rows: bool,
    taken_bytes: Arc<AtomicU64>,
    total_bytes: Option<u64>,
}

enum Body {
    Text(Box<Rows>),
    Parquet(Box<Batches>),
    Can(Box<Frames>),
}

impl LogReader {
    /// Opens a `.csv`, `.csv.gz`, `.log` (candump), `.asc` or `.parquet` file and reads its header.
    ///
    /// # Errors
    ///
    /// The file cannot be opened or read, or its header is not valid.
    pub fn open(path: &Path, options: &LogOptions) -> Result<Self, LogError> {
        let mut log = Self::unprepared(path, options)?;
        if !log.is_of_frames() && log.total_bytes.is_some() {
            log.look(options);
        }
        Ok(log.prepared(options))
    }

    /// Reads the first rows. They, and what ended them, are given later.
    fn look(&mut self, options: &LogOptions) {
        let mut beginning = Box::new(Beginning::new(options, self.body.position()));
        while beginning.is_open() {
            let more = self.read();
            beginning.push(more, self.body.position(), &self.quantities, &self.values);
        }
        self.beginning = Some(beginning);
    }

    fn prepared(mut self, options: &LogOptions) -> Self {
        if !self.is_of_frames() {
            let rasters = self.beginning.as_ref().map(|rows| rows.rasters().clone());
            let rasters = rasters.unwrap_or_default();
            self.preparation = Preparation::of(&self.signals, &rasters, options);
        }
        if let Some(preparation) = &self.preparation {
            self.signals = preparation.signals(&self.signals).into();
        }
        self
    }

    fn unprepared(path: &Path, options: &LogOptions) -> Result<Self, LogError> {
        let name = path.display().to_string();
        let place = || Place { file: name.as_str().into(), position: Position::File };
        let open = |source| LogError::Open { place: place(), source };
        let file = File::open(path).map_err(open)?;
        let about = file.metadata().map_err(open)?;
        let total_bytes = about.is_file().then_some(about.len());
        let (counted, taken_bytes) = Counted::new(file.try_clone().map_err(open)?);
        let read = |source| LogError::Read { place: place(), source };
        let sniffed = sniff(counted).map_err(read)?;
        let named_parquet = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"));
        let body = if sniffed.magic == Magic::Parquet || named_parquet {
            if total_bytes.is_none() {
                return Err(LogError::ParquetStream { place: place() });
            }
            let mut file = file;
            file.rewind().map_err(read)?;
            Body::Parquet(Box::new(Batches::open(&name, file, options)?))
        } else {
            text_body(&name, sniffed, options)?
        };
        Ok(Self::new(body, options, taken_bytes, total_bytes))
    }

    /// Reads CSV or CAN frames (candump, ASC), plain or gzip, from a stream such as the standard input.
    /// `name` is its name in messages. Channels of a stream must have the same time stamps.
    ///
    /// # Errors
    ///
    /// The stream cannot be read, it is parquet, or its header is not valid.
    pub fn from_reader(
        name: &str,
        stream: Box<dyn Read + Send>,
        options: &LogOptions,
    ) -> Result<Self, LogError> {
        let place = || Place { file: name.into(), position: Position::File };
        let (counted, taken_bytes) = Counted::new(stream);
        let sniffed = sniff(counted).map_err(|source| LogError::Read { place: place(), source })?;
        if sniffed.magic == Magic::Parquet {
            return Err(LogError::ParquetStream { place: place() });
        }
        let body = text_body(name, sniffed, options)?;
        Ok(Self::new(body, options, taken_bytes, None).prepared(options))
    }

    fn new(
        body: Body,
        options: &LogOptions,
        taken_bytes: Arc<AtomicU64>,
        total_bytes: Option<u64>,
    ) -> Self {
        Self {
            signals: body.signals(),
            quantities: body.quantities(),
            body,
            values: [f64::NAN; Signal::COUNT],
            plausibility: options.settings.map(Plausibility::new),
            preparation: None,
            beginning: None,
            given: None,
            at_end: false,
            previous_s: f64::NEG_INFINITY,
            begun: false,
            over_bad_rows: false,
            taken_bytes,
            total_bytes,
        }
    }

    /// A reader for callers that continue after invalid rows, also in a gzip log. Damage of the
    /// file is reported at the position where reading fails and is not searched for after an
    /// invalid row.
    #[must_use]
    pub fn over_bad_rows(self) -> Self {
        Self { over_bad_rows: true, ..self }
    }

    /// Whether the log contains CAN frames.
    pub fn is_of_frames(&self) -> bool {
        matches!(self.body, Body::Can(_))
    }

    /// The scale on the bus from which the trailer mass in the last row follows, in a log of frames.
    pub fn scale(&self) -> Option<Scale> {
        match &self.body {
            Body::Can(frames) => frames.scale(),
            Body::Text(_) | Body::Parquet(_) => None,
        }
    }

    /// The next row; `None` at the end of the log.
    ///
    /// # Errors
    ///
    /// If a row is not valid, the next call continues with the row after it. In a gzip log,
    /// however, the rest of the file is searched for damage that explains the invalid row, and the
    /// next call returns `None`. If the file cannot be read further, the next call returns `None`.
    #[inline]
    pub fn next_row(&mut self) -> Result<Option<LogRow>, LogError> {
        Ok(self.advance()?.then(|| self.row()))
    }

    /// Reads the next [row](Self::row), which is not copied unless it is looked at; `false` at the end of the log.
    ///
    /// # Errors
    ///
    /// As [`next_row`](Self::next_row).
    #[inline]
    pub fn advance(&mut self) -> Result<bool, LogError> {
        if self.preparation.is_some() { self.advance_prepared() } else { self.advance_body() }
    }

    /// The row that was read last.
    #[inline]
    pub fn row(&self) -> LogRow {
        match self.given {
            Some((_, row)) => row,
            None => LogRow::from_values(self.values),
        }
    }

    /// A value of that row.
    #[inline]
    pub fn value(&self, signal: Signal) -> f64 {
        self.given.map_or_else(|| self.values[signal as usize], |(_, row)| row.get(signal))
    }

    fn advance_prepared(&mut self) -> Result<bool, LogError> {
        loop {
            let Some(preparation) = &mut self.preparation else { return Ok(false) };
            if let Some(next) = preparation.next_row() {
                self.given = Some(next);
                return Ok(true);
            }
            if self.at_end {
                return Ok(false);
            }
            self.given = None;
            let more = self.advance_body()?;
            let line = self.line();
            let Some(preparation) = &mut self.preparation else { return Ok(false) };
            if more {
                preparation.push(line, LogRow::from_values(self.values));
            } else {
                self.at_end = true;
                preparation.finish();
            }
        }
    }

    #[inline]
    fn advance_body(&mut self) -> Result<bool, LogError> {
        let looked_at = self.beginning.as_mut().and_then(|rows| rows.next(&mut self.values));
        let more = looked_at.unwrap_or_else(|| {
            self.beginning = None;
            self.read()
        });
        if !matches!(more, Ok(true)) {
            return self.stopped(more);
        }
        if let Some(plausibility) = &mut self.plausibility {
            let position = || position(&self.body, self.beginning.as_deref());
            plausibility.check(&self.quantities, &mut self.values, position);
        }
        Ok(true)
    }

    /// Reads the next row of the file and checks its time and its standard deviation.
    #[inline]
    fn read(&mut self) -> Result<bool, LogError> {
        let more = match &mut self.body {
            Body::Text(rows) => rows.read(&mut self.values),
            Body::Parquet(batches) => batches.read(&mut self.values),
            Body::Can(frames) => frames.read(&mut self.values),
        };
        if !matches!(more, Ok(true)) {
            return more;
        }
        if !std::mem::replace(&mut self.begun, true) && self.preparation.is_none() {
            // A row of units may have said more than the header.
            self.signals = self.body.signals();
            self.quantities = self.body.quantities();
        }
        let time_s = self.values[Signal::Time as usize];
        // The time is stored even if it decreased, because the following rows may be in order
        // again.
        let previous_s = std::mem::replace(&mut self.previous_s, time_s);
        let mass_sd_kg = self.values[Signal::TrailerMassSd as usize];
        if time_s > previous_s && mass_sd_kg < 0.0 {
            Err(self.negative_sd(mass_sd_kg))
        } else if time_s > previous_s {
            Ok(true)
        } else {
            Err(self.bad_time(time_s, previous_s))
        }
    }

    /// Findings about values since the last call, each as signal and sentence.
    pub fn news(&mut self) -> Vec<(&'static str, String)> {
        self.plausibility.as_mut().map(Plausibility::news).unwrap_or_default()
    }

    /// All findings so far, as text for the user.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = match &self.body {
            Body::Can(frames) => frames.remarks(),
            _ => Vec::new(),
        };
        remarks.extend(self.preparation.iter().flat_map(Preparation::remarks));
        remarks.extend(self.plausibility.iter().flat_map(Plausibility::remarks));
        remarks
    }

    /// Number of values so far that the truck cannot have. They were replaced by NaN.
    pub fn implausible_values(&self) -> u64 {
        self.plausibility.as_ref().map_or(0, Plausibility::values)
    }

    #[cold]
    fn stopped(&mut self, more: Result<bool, LogError>) -> Result<bool, LogError> {
        let first = !std::mem::replace(&mut self.begun, true);
        match more {
            Err(error) if self.over_bad_rows => Err(error),
            Err(error) => Err(self.body.damage().unwrap_or(error)),
            Ok(_) if first => Err(self.body.no_rows()),
            Ok(_) => Ok(false),
        }
    }

    #[cold]
    fn bad_time(&mut self, time_s: f64, previous_s: f64) -> LogError {
        let (place, column) = self.cell(Signal::Time);
        if time_s.is_nan() {
            self.previous_s = previous_s;
            LogError::AbsentTime { place, column }
        } else {
            LogError::TimeOrder { place, column, previous_s, time_s }
        }
    }

    #[cold]
    fn negative_sd(&self, value: f64) -> LogError {
        let (place, column) = self.cell(Signal::TrailerMassSd);
        LogError::NegativeSd { place, column, value }
    }

    /// Where a signal is in the last row.
    fn cell(&self, signal: Signal) -> (Place, ColumnName) {
        let found = self.body.columns().iter().find(|column| column.signal == signal);
        (self.body.place(), self.body.name(found.map_or(0, |column| column.index)))
    }

    /// Whether the log has a column for this signal.
    pub fn has(&self, signal: Signal) -> bool {
        self.signals.contains(&signal)
    }

    /// The signals of the log, in the order of [`Signal::ALL`].
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// The line of the last row, counted from one and with comments and blank lines. In a parquet
    /// file it is the number of the row.
    pub fn line(&self) -> u64 {
        if let Some((line, _)) = self.given {
            return line;
        }
        match position(&self.body, self.beginning.as_deref()) {
            Position::Line(number) | Position::Row(number) => number,
            Position::File => 0,
        }
    }

    /// The number of bytes read from the file so far, before decompression. A parquet file is read
    /// in any order, so its value is estimated from the number of rows.
    pub fn bytes_read(&self) -> u64 {
        match (&self.body, self.total_bytes) {
            (Body::Parquet(batches), Some(total_bytes)) => batches.share(total_bytes),
            _ => self.taken_bytes.load(Ordering::Relaxed),
        }
    }

    /// The size of the file in bytes; `None` for a stream.
    pub fn total_bytes(&self) -> Option<u64> {
        self.total_bytes
    }
}

impl Iterator for LogReader {
    type Item = Result<LogRow, LogError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.next_row().transpose()
    }
}

impl Body {
    /// The signals, in the order of [`Signal::ALL`].
    fn signals(&self) -> Box<[Signal]> {
        let mut signals: Vec<Signal> = match self {
            Self::Can(frames) => frames.signals(),
            _ => self.columns().iter().map(|column| column.signal).collect(),
        };
        signals.sort_unstable();
        signals.into()
    }

    /// The quantities that may have a value: in frames any.
    fn quantities(&self) -> Box<[Quantity]> {
        match self {
            Self::Can(_) => Quantity::ALL.into(),
            _ => self.columns().iter().filter_map(|column| column.signal.quantity()).collect(),
        }
    }

    /// Index of the column of the time.
    fn columns(&self) -> &[Column] {
        match self {
            Self::Text(rows) => rows.columns(),
            Self::Parquet(batches) => batches.columns(),
            Self::Can(_) => &[],
        }
    }

    fn name(&self, index: usize) -> ColumnName {
        match self {
            Self::Text(rows) => rows.name(index),
            Self::Parquet(batches) => batches.name(index),
            Self::Can(_) => ColumnName { number: index + 1, name: "time".into() },
        }
    }

    fn damage(&mut self) -> Option<LogError> {
        match self {
            Self::Text(rows) => rows.damage(),
            Self::Parquet(_) | Self::Can(_) => None,
        }
    }

    fn no_rows(&self) -> LogError {
        match self {
            Self::Can(frames) => frames.no_rows(),
            _ => LogError::NoRows { place: self.place() },
        }
    }

    fn position(&self) -> Position {
        match self {
            Self::Text(rows) => rows.position(),
            Self::Parquet(batches) => batches.position(),
            Self::Can(frames) => frames.position(),
        }
    }

    fn place(&self) -> Place {
        match self {
            Self::Text(rows) => rows.place(),
            Self::Parquet(batches) => batches.place(),
            Self::Can(frames) => frames.place(),
        }
    }
}

/// The position of the row that was given last.
fn position(body: &Body, beginning: Option<&Beginning>) -> Position {
    beginning.map_or_else(|| body.position(), Beginning::position)
}

fn text_body<R: Read + Send + 'static>(
    name: &str,
    sniffed: Sniffed<R>,
    options: &LogOptions,
) -> Result<Body, LogError> {
    if let Magic::Other(format, remedy) = sniffed.magic {
        let place = Place { file: name.into(), position: Position::File };
        return Err(LogError::OtherFormat { place, format, remedy });
    }
    let gzip = sniffed.magic == Magic::Gzip;
    let (head, text) = head(text(sniffed));
    Ok(if is_candump(&head) || is_asc(&head) {
        Body::Can(Box::new(Frames::new(name, text, is_asc(&head), options)))
    } else {
        Body::Text(Box::new(Rows::open(name, text, gzip, options)?))
    })
}
