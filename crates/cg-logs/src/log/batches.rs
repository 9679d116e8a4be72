//! Reads the rows of a parquet log, one record batch at a time.

use std::fs::File;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, DecimalType, Float16Type,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, Float64Array, Int64Array, RecordBatch};
use arrow_schema::{ArrowError, DataType, FieldRef, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};

use super::cell::{BadCell, Slot, bad_cell};
use super::columns::{Column, column_name, resolve};
use super::error::{ColumnName, LogError, Place, Position};
use super::heading::{Heading, Stated};
use super::options::LogOptions;
use super::signal::Signal;

const BATCH_ROWS: usize = 8192;

pub(super) struct Batches {
    file: Box<str>,
    reader: ParquetRecordBatchReader,
    names: Box<[Heading]>,
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
        let heading = |field: &FieldRef| {
            let mut heading = Heading::new(field.name().trim());
            if matches!(field.data_type(), DataType::Timestamp(..) | DataType::Duration(_)) {
                heading.stated = Stated::Clock;
            }
            heading
        };
        let names: Box<[Heading]> = fields.iter().map(heading).collect();
        let columns = resolve(&place, &names, options)?;
        for column in &columns {
            let kind = fields[column.index].data_type();
            if !kind.is_numeric() && !column.clock {
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
            self.batch.push((Slot::from(column), numbers(array)?));
        }
        self.length = batch.num_rows();
        Ok(())
    }
}

/// A column of numbers in double precision, each rounded once. (`arrow_cast` knows this too, beside much
/// that takes a fifth of the whole build.)
#[allow(clippy::cast_precision_loss, reason = "the rounding")]
fn numbers(array: &dyn Array) -> Result<Float64Array, ArrowError> {
    Ok(match array.data_type() {
        DataType::Int8 => array.as_primitive::<Int8Type>().unary(f64::from),
        DataType::Int16 => array.as_primitive::<Int16Type>().unary(f64::from),
        DataType::Int32 => array.as_primitive::<Int32Type>().unary(f64::from),
        DataType::Int64 => array.as_primitive::<Int64Type>().unary(|x| x as f64),
        DataType::UInt8 => array.as_primitive::<UInt8Type>().unary(f64::from),
        DataType::UInt16 => array.as_primitive::<UInt16Type>().unary(f64::from),
        DataType::UInt32 => array.as_primitive::<UInt32Type>().unary(f64::from),
        DataType::UInt64 => array.as_primitive::<UInt64Type>().unary(|x| x as f64),
        DataType::Float16 => array.as_primitive::<Float16Type>().unary(f64::from),
        DataType::Float32 => array.as_primitive::<Float32Type>().unary(f64::from),
        DataType::Float64 => array.as_primitive::<Float64Type>().clone(),
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => times(array, *unit)?,
        DataType::Decimal32(_, scale) => decimals::<Decimal32Type>(array, *scale),
        DataType::Decimal64(_, scale) => decimals::<Decimal64Type>(array, *scale),
        DataType::Decimal128(_, scale) => decimals::<Decimal128Type>(array, *scale),
        DataType::Decimal256(_, scale) => decimals::<Decimal256Type>(array, *scale),
        other => return Err(ArrowError::CastError(format!("{other} is not a number"))),
    })
}

/// Points in time and durations, s.
fn times(array: &dyn Array, unit: TimeUnit) -> Result<Float64Array, ArrowError> {
    let per_second: i64 = match unit {
        TimeUnit::Second => 1,
        TimeUnit::Millisecond => 1_000,
        TimeUnit::Microsecond => 1_000_000,
        TimeUnit::Nanosecond => 1_000_000_000,
    };
    let data = array.to_data().into_builder().data_type(DataType::Int64).build()?;
    // Whole seconds are exact, so that the sum is rounded once.
    #[allow(clippy::cast_precision_loss, reason = "the rounding")]
    let seconds = |x: i64| {
        x.div_euclid(per_second) as f64 + x.rem_euclid(per_second) as f64 / per_second as f64
    };
    Ok(Int64Array::from(data).unary(seconds))
}

fn decimals<D: DecimalType>(array: &dyn Array, scale: i8) -> Float64Array {
    let number = |x| D::format_decimal(x, u8::MAX, scale).parse().unwrap_or(f64::NAN);
    array.as_primitive::<D>().unary(number)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Decimal128Array, Int8Array, StringArray};

    use super::*;

    #[test]
    fn numbers_of_every_kind_are_rounded_once_and_nulls_stay() {
        let decimal = Decimal128Array::from(vec![Some(-12_345), None, Some(9_007_199_254_740_993)]);
        let columns: [(ArrayRef, [Option<f64>; 3]); 3] = [
            (
                Arc::new(decimal.with_precision_and_scale(38, 3).unwrap()),
                [Some(-12.345), None, Some(9_007_199_254_740.993)],
            ),
            (
                Arc::new(Int8Array::from(vec![Some(-128), None, Some(127)])),
                [Some(-128.0), None, Some(127.0)],
            ),
            (
                Arc::new(Int64Array::from(vec![Some(i64::MAX), None, Some(1)])),
                [Some(9_223_372_036_854_775_807.0), None, Some(1.0)],
            ),
        ];
        for (column, expected) in columns {
            assert_eq!(numbers(&column).unwrap().iter().collect::<Vec<_>>(), expected);
        }
        assert!(numbers(&StringArray::from(vec!["1"])).is_err());
    }
}
