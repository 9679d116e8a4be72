//! The writer of CSV logs: a log appears completely under its name, or not at all.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use flate2::Compression;
use flate2::write::GzEncoder;

use cg_output::{Draft, Target};

use super::columns::resolve;
use super::error::{ColumnName, LogError, Place, Position};
use super::heading::Heading;
use super::lines::LIMIT_BYTES;
use super::options::LogOptions;
use super::signal::{LogRow, Signal};

/// Writes a CSV log that [`LogReader`](super::LogReader) can read.
///
/// It refuses everything that the reader refuses: columns that do not form a log, infinite values,
/// and a time that is absent or does not increase. Times are written with microsecond resolution,
/// all other values with the digits that give the same `f64` again. Absent values are empty cells.
///
/// A file is written under a temporary name in the same folder and gets its name in
/// [`finish`](Self::finish). If the writer is dropped before, the file is removed, and an older
/// file with the same name is unchanged.
///
/// # Example
///
/// ```
/// use cg_logs::log::{LogRow, LogWriter, Signal};
///
/// let columns = [Signal::Time, Signal::Steer, Signal::Roll];
/// let mut log = LogWriter::from_writer("out", Box::new(Vec::new()), &[], &columns)?;
/// log.write_row(&LogRow { time_s: 0.01, steer_rad: 0.02, ..LogRow::ABSENT })?;
/// log.finish()?;
/// # Ok::<(), cg_logs::log::LogError>(())
/// ```
pub struct LogWriter {
    sink: Sink,
    file: Box<str>,
    columns: Box<[Signal]>,
    line: String,
    lines: u64,
    previous_us: f64,
    /// Declared after the sink and therefore dropped after it, so that the file is closed before it
    /// is removed.
    draft: Option<Draft>,
}

enum Sink {
    Plain(BufWriter<Box<dyn Write + Send>>),
    Gzip(Box<GzEncoder<BufWriter<Box<dyn Write + Send>>>>),
}

impl LogWriter {
    /// Begins a `.csv` or `.csv.gz` file with comment lines and the header.
    ///
    /// A path that is not a regular file, such as `/dev/stdout` or a pipe, is written directly.
    /// [`Files`](cg_output::Files) decides which files may be written.
    ///
    /// # Errors
    ///
    /// The file cannot be created, the name ends in `.parquet`, or the columns do not form a log.
    pub fn create(
        target: &Target,
        comments: &[String],
        columns: &[Signal],
    ) -> Result<Self, LogError> {
        let path = target.path();
        let name = path.display().to_string();
        let place = || Place { file: name.as_str().into(), position: Position::File };
        let ends_in = |end| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        if ends_in("parquet") {
            return Err(LogError::WriteFormat { place: place() });
        }
        check_columns(&place(), columns)?;
        let fail = |source| LogError::Write { place: place(), source };
        let (draft, file) = target.open().map_err(fail)?;
        let buffer: BufWriter<Box<dyn Write + Send>> = BufWriter::new(Box::new(file));
        let sink = if ends_in("gz") {
            Sink::Gzip(Box::new(GzEncoder::new(buffer, Compression::default())))
        } else {
            Sink::Plain(buffer)
        };
        Self { draft, ..Self::new(&name, sink, columns) }.begin(comments)
    }

    /// Begins a log on a stream such as the standard output, without compression. `name` is its
    /// name in messages.
    ///
    /// # Errors
    ///
    /// The stream cannot be written, or the columns do not form a log.
    pub fn from_writer(
        name: &str,
        stream: Box<dyn Write + Send>,
        comments: &[String],
        columns: &[Signal],
    ) -> Result<Self, LogError> {
        let place = Place { file: name.into(), position: Position::File };
        check_columns(&place, columns)?;
        Self::new(name, Sink::Plain(BufWriter::new(stream)), columns).begin(comments)
    }

    fn new(file: &str, sink: Sink, columns: &[Signal]) -> Self {
        Self {
            sink,
            file: file.into(),
            columns: columns.into(),
            line: String::new(),
            lines: 0,
            previous_us: f64::NEG_INFINITY,
            draft: None,
        }
    }

    fn begin(mut self, comments: &[String]) -> Result<Self, LogError> {
        for text in comments.iter().flat_map(|comment| comment.split(['\n', '\r'])) {
            self.line.clear();
            self.line.push_str("# ");
            self.line.push_str(text);
            self.write_line()?;
        }
        let names: Vec<_> = self.columns.iter().map(|signal| signal.column()).collect();
        self.line = names.join(",");
        self.write_line()?;
        Ok(self)
    }

    /// Writes one row.
    ///
    /// # Errors
    ///
    /// The row is not valid, and nothing of it is written; or the file cannot be written.
    pub fn write_row(&mut self, row: &LogRow) -> Result<(), LogError> {
        self.line.clear();
        for index in 0..self.columns.len() {
            if index > 0 {
                self.line.push(',');
            }
            let signal = self.columns[index];
            let value = row.get(signal);
            if value.is_infinite() {
                let (place, column) = (self.place(), self.name(signal));
                return Err(LogError::Infinite { place, column, text: value.to_string().into() });
            }
            if signal == Signal::TrailerMassSd && value < 0.0 {
                let (place, column) = (self.place(), self.name(signal));
                return Err(LogError::NegativeSd { place, column, value });
            }
            if signal == Signal::Time {
                push_time(&mut self.line, value);
            } else if !value.is_nan() {
                push_shortest(&mut self.line, value);
            }
        }
        self.check_time(row.time_s)?;
        self.write_line()
    }

    /// Ends the log and gives the file its name.
    ///
    /// # Errors
    ///
    /// The file cannot be written or renamed. It is then removed.
    pub fn finish(self) -> Result<(), LogError> {
        let place = self.place();
        let end = || -> io::Result<()> {
            match self.sink {
                Sink::Plain(mut buffer) => buffer.flush()?,
                Sink::Gzip(packed) => packed.finish()?.flush()?,
            }
            self.draft.map_or(Ok(()), Draft::publish)
        };
        end().map_err(|source| LogError::Write { place, source })
    }

    /// The position of the next line.
    fn place(&self) -> Place {
        Place { file: self.file.clone(), position: Position::Line(self.lines + 1) }
    }

    fn name(&self, signal: Signal) -> ColumnName {
        let index = self.columns.iter().position(|&other| other == signal).unwrap_or(0);
        ColumnName { number: index + 1, name: signal.column().into() }
    }

    /// Checks that the time increases in the written digits.
    fn check_time(&mut self, time_s: f64) -> Result<(), LogError> {
        let time_us = (time_s * 1e6).round();
        if time_us > self.previous_us {
            self.previous_us = time_us;
            return Ok(());
        }
        let (place, column) = (self.place(), self.name(Signal::Time));
        if time_s.is_nan() {
            return Err(LogError::AbsentTime { place, column });
        }
        Err(LogError::TimeOrder { place, column, previous_s: self.previous_us / 1e6, time_s })
    }

    fn write_line(&mut self) -> Result<(), LogError> {
        if self.line.len() > LIMIT_BYTES {
            return Err(LogError::TooLong { place: self.place(), limit_bytes: LIMIT_BYTES });
        }
        self.line.push('\n');
        let sink: &mut dyn Write = match &mut self.sink {
            Sink::Plain(buffer) => buffer,
            Sink::Gzip(packed) => packed,
        };
        match sink.write_all(self.line.as_bytes()) {
            Ok(()) => {
                self.lines += 1;
                Ok(())
            }
            Err(source) => Err(LogError::Write { place: self.place(), source }),
        }
    }
}

/// Checks that the columns form a log.
fn check_columns(place: &Place, columns: &[Signal]) -> Result<(), LogError> {
    let names: Vec<Heading> = columns.iter().map(|s| Heading::new(s.column())).collect();
    resolve(place, &names, &LogOptions::default()).map(|_| ())
}

/// Appends a time with at most six decimals, without trailing zeros.
fn push_time(line: &mut String, time_s: f64) {
    let start = line.len();
    // Writing to a string cannot fail.
    let _ = write!(line, "{time_s:.6}");
    let kept = line[start..].trim_end_matches('0').trim_end_matches('.').len();
    line.truncate(start + kept);
}

/// Appends the fewest digits that are read back as the same number.
fn push_shortest(line: &mut String, value: f64) {
    // Writing to a string cannot fail.
    let _ = write!(line, "{value:?}");
}
