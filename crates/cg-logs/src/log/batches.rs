//! Reads the rows of a parquet log, one record batch at a time.

use std::fs::File;

use arrow::array::AsArray;
use arrow::array::{Array, Float64Array, RecordBatch};
use arrow::compute::cast;
use arrow::datatypes::{DataType, Float64Type};
use arrow::error::ArrowError;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};

use super::cell::{BadCell, Slot, bad_cell};
use super::columns::{Column, column_name, resolve};
use super::error::{ColumnName, LogError, Place, Position};
use super::options::LogOptions;
use super::signal::Signal;

const BATCH_ROWS: usize = 8192;

pub(super) struct Batches {
    file: Box<str>,
    reader: ParquetRecordBatchReader,
    names: Box<[Box<str>]>,
    columns: Box<[Column]>,
    /// The columns of the current batch in the order of the file, and the next row in it.
    batch: Vec<(Slot, Float64Array)>,
    next: usize,
    length: usize,
    row: u64,
    rows: u64,
    over: bool,
}

impl Batches {
    pub(super) fn open(name: &str, file: File, options: &LogOptions) -> Result<Self, LogError> {
        let place = Place { file: name.into(), position: Position::File };
        let bad = |error: &dyn std::fmt::Display| LogError::Parquet {
            place: place.clone(),
            message: error.to_string().into(),
        };
        let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|e| bad(&e))?;
        let fields = builder.schema().fields().clone();
        let names: Box<[Box<str>]> = fields.iter().map(|f| f.name().trim().into()).collect();
        let columns = resolve(&place, &names, options)?;
        for column in &columns {
            let kind = fields[column.index].data_type();
            if !kind.is_numeric() {
                return Err(LogError::NotNumeric {
                    place,
                    column: column_name(&names, column.index),
                    kind: kind.to_string().into(),
                });
            }
        }
        let rows = u64::try_from(builder.metadata().file_metadata().num_rows()).unwrap_or(0);
        let wanted = columns.iter().map(|column| column.index);
        let mask = ProjectionMask::roots(builder.parquet_schema(), wanted);
        let reader = builder.with_projection(mask).with_batch_size(BATCH_ROWS).build();
        let reader = reader.map_err(|e| bad(&e))?;
        Ok(Self {
            file: name.into(),
            reader,
            names,
            columns,
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
            let raw = if numbers.is_null(at) { f64::NAN } else { numbers.value(at) };
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
        let Some(batch) = self.reader.next() else { return Ok(false) };
        match batch.and_then(|batch| self.unpack(&batch)) {
            Ok(()) => Ok(true),
            Err(error) => {
                self.over = true;
                self.row += 1;
                let (place, message) = (self.place(), error.to_string().into());
                Err(LogError::Parquet { place, message })
            }
        }
    }

    fn unpack(&mut self, batch: &RecordBatch) -> Result<(), ArrowError> {
        self.batch.clear();
        self.next = 0;
        self.length = 0;
        for (column, array) in self.columns.iter().zip(batch.columns()) {
            let numbers = cast(array, &DataType::Float64)?;
            let numbers = numbers.as_primitive::<Float64Type>().clone();
            self.batch.push((Slot::from(column), numbers));
        }
        self.length = batch.num_rows();
        Ok(())
    }
}
