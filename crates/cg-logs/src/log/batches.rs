//! Reads the rows of a parquet log, some thousand at a time and only the columns that are used.

use std::fs::File;

use parquet::basic::Compression;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::metadata::{FileMetaData, ParquetMetaData};
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::arrow_units;
use super::cell::{BadCell, Slot, bad_cell};
use super::columns::{Column, column_name, resolve};
use super::error::{ColumnName, LogError, Place, Position};
use super::heading::{Heading, Stated};
use super::options::LogOptions;
use super::parquet_kind::Kind;
use super::signal::Signal;

const BATCH_ROWS: usize = 8192;

pub(super) struct Batches {
    file: Box<str>,
    reader: SerializedFileReader<File>,
    names: Box<[Heading]>,
    columns: Box<[Column]>,
    /// The places of these columns among those that store values, and their kinds.
    numbers: Box<[(usize, Kind)]>,
    /// The columns in the current row group, and the next group.
    group: Vec<ColumnReader>,
    next_group: usize,
    /// The columns of the current batch in the order of the file, and the next row in it.
    batch: Vec<(Slot, Vec<f64>)>,
    next: usize,
    length: usize,
    row: u64,
    rows: u64,
    over: bool,
}

impl Batches {
    pub(super) fn open(name: &str, file: File, options: &LogOptions) -> Result<Self, LogError> {
        let place = Place { file: name.into(), position: Position::File };
        let reader = SerializedFileReader::new(file).map_err(|error| LogError::Parquet {
            place: place.clone(),
            message: error.to_string().into(),
        })?;
        let metadata = reader.metadata().file_metadata();
        let roots = roots(metadata);
        let heading = |root: &Root| {
            let mut heading = Heading::new(root.name.trim());
            if matches!(root.numbers, Ok((_, Kind::Clock(_)))) {
                heading.stated = Stated::Clock;
            }
            heading
        };
        let names: Box<[Heading]> = roots.iter().map(heading).collect();
        let columns = resolve(&place, &names, options)?;
        let number = |column: &Column| {
            let kind = match &roots[column.index].numbers {
                Ok((_, Kind::Truth)) if !column.signal.is_state() => "BOOLEAN",
                Ok(numbers) => return Ok(*numbers),
                Err(kind) => kind.as_str(),
            };
            let column = column_name(&names, column.index);
            Err(LogError::NotNumeric { place: place.clone(), column, kind: kind.into() })
        };
        let numbers: Box<[(usize, Kind)]> = columns.iter().map(number).collect::<Result<_, _>>()?;
        if let Some(format) = unread_compression(reader.metadata(), &numbers) {
            let remedy = "export it again with snappy, zstd or gzip, or without compression";
            return Err(LogError::OtherFormat { place, format, remedy });
        }
        let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
        Ok(Self {
            file: name.into(),
            reader,
            names,
            columns,
            numbers,
            group: Vec::new(),
            next_group: 0,
            batch: Vec::new(),
            next: 0,
            length: 0,
            row: 0,
            rows,
            over: false,
        })
    }

    pub(super) fn columns(&self) -> &[Column] {
        &self.columns
    }

    pub(super) fn name(&self, index: usize) -> ColumnName {
        column_name(&self.names, index)
    }

    pub(super) fn position(&self) -> Position {
        Position::Row(self.row)
    }

    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), position: self.position() }
    }

    /// The share of a file of this size that corresponds to the rows read so far, bytes.
    pub(super) fn share(&self, total_bytes: u64) -> u64 {
        let rows = u128::from(self.rows.max(1));
        let read = u128::from(total_bytes) * u128::from(self.row.min(self.rows)) / rows;
        u64::try_from(read).unwrap_or(total_bytes)
    }

    /// Reads the signals of the next row into `values`. Returns `false` at the end.
    pub(super) fn read(&mut self, values: &mut [f64; Signal::COUNT]) -> Result<bool, LogError> {
        while self.next == self.length {
            if self.over || !self.load()? {
                self.over = true;
                return Ok(false);
            }
        }
        let at = self.next;
        self.next += 1;
        self.row += 1;
        for (index, (slot, numbers)) in self.batch.iter().enumerate() {
            let raw = numbers[at];
            let value = slot.si(raw);
            if value.is_infinite() {
                let column = self.name(self.columns[index].index);
                let text = raw.to_string();
                return Err(bad_cell(self.place(), column, text.as_bytes(), BadCell::Infinite));
            }
            values[slot.signal] = value;
        }
        Ok(true)
    }

    fn load(&mut self) -> Result<bool, LogError> {
        self.unpack().map_err(|error| {
            self.over = true;
            self.row += 1;
            let (place, message) = (self.place(), error.to_string().into());
            LogError::Parquet { place, message }
        })
    }

    /// Unpacks the next rows of the current row group, or the first ones of the next group. Returns
    /// `false` after the last group.
    fn unpack(&mut self) -> Result<bool, ParquetError> {
        self.batch.clear();
        self.next = 0;
        self.length = 0;
        let columns = self.columns.iter().zip(&self.numbers).zip(&mut self.group);
        for ((column, (_, kind)), reader) in columns {
            self.batch.push((Slot::from(column), kind.read(reader, BATCH_ROWS)?));
        }
        self.length = self.batch.first().map_or(0, |(_, values)| values.len());
        if self.batch.iter().any(|(_, values)| values.len() != self.length) {
            return Err(ParquetError::General("its columns have different lengths".to_owned()));
        }
        if self.length > 0 {
            return Ok(true);
        }
        if self.next_group == self.reader.num_row_groups() {
            return Ok(false);
        }
        let group = self.reader.get_row_group(self.next_group)?;
        self.group = (self.numbers.iter())
            .map(|(leaf, _)| group.get_column_reader(*leaf))
            .collect::<Result<_, _>>()?;
        self.next_group += 1;
        Ok(true)
    }
}

/// A compression of these columns that is not read.
fn unread_compression(
    metadata: &ParquetMetaData,
    numbers: &[(usize, Kind)],
) -> Option<&'static str> {
    let groups = metadata.row_groups().iter();
    let mut chunks = groups.flat_map(|group| numbers.iter().map(|(leaf, _)| group.column(*leaf)));
    chunks.find_map(|chunk| match chunk.compression() {
        Compression::LZO => Some("a parquet file compressed with LZO"),
        Compression::LZ4 | Compression::LZ4_RAW => Some("a parquet file compressed with LZ4"),
        Compression::BROTLI(_) => Some("a parquet file compressed with Brotli"),
        _ => None,
    })
}

/// A column of the file as its heading names it.
struct Root {
    name: String,
    /// Its place among the columns that store values, and their kind; otherwise what it is.
    numbers: Result<(usize, Kind), String>,
}

fn roots(metadata: &FileMetaData) -> Vec<Root> {
    let pairs = metadata.key_value_metadata().map_or(&[][..], Vec::as_slice);
    let arrow = pairs.iter().find(|pair| pair.key == arrow_units::KEY);
    let units = arrow.and_then(|pair| arrow_units::units_per_second(pair.value.as_deref()?));
    let units = units.unwrap_or_default();
    let schema = metadata.schema_descr();
    let mut roots: Vec<Root> = (schema.root_schema().get_fields().iter())
        .map(|field| Root { name: field.name().to_owned(), numbers: Err("group".to_owned()) })
        .collect();
    for leaf in 0..schema.num_columns() {
        if schema.get_column_root(leaf).is_primitive() {
            let root = &mut roots[schema.get_column_root_idx(leaf)];
            let kind = Kind::of(&schema.column(leaf), units.get(&root.name).copied());
            root.numbers = kind.map(|kind| (leaf, kind));
        }
    }
    roots
}
