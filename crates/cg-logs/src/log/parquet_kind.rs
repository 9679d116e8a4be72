//! The kinds of numbers in the columns of a parquet file.

use half::f16;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, FixedLenByteArray, Int96};
use parquet::errors::Result;
use parquet::schema::types::ColumnDescriptor;

/// Decimals of more digits are refused: they do not fit in 16 bytes.
const MOST_DIGITS: i32 = 38;

/// What the stored values of a column mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Integers with a sign, or numbers in floating point.
    Plain,
    /// Integers without a sign.
    Unsigned,
    /// Numbers of two bytes in floating point.
    Half,
    /// Integers with this number of decimal places.
    Decimal(i32),
    /// Points in time or durations with this many units per second.
    Clock(i64),
    /// True or false, as 1 or 0.
    Truth,
}

impl Kind {
    /// The kind of a column, or its name if it has no numbers. `per_second` is the unit of a time that only
    /// Arrow's schema knows.
    pub(super) fn of(
        column: &ColumnDescriptor,
        per_second: Option<i64>,
    ) -> std::result::Result<Self, String> {
        let logical = column.logical_type_ref();
        let other = || match (logical, column.converted_type()) {
            (None | Some(LogicalType::String), ConvertedType::NONE | ConvertedType::UTF8)
                if column.physical_type() == Physical::BYTE_ARRAY =>
            {
                "text".to_owned()
            }
            (Some(logical), _) => format!("{logical:?}"),
            (None, ConvertedType::NONE) => column.physical_type().to_string(),
            (None, converted) => converted.to_string(),
        };
        if column.max_rep_level() > 0 {
            return Err(format!("list of {}", other()));
        }
        match column.physical_type() {
            Physical::FLOAT | Physical::DOUBLE => return Ok(Self::Plain),
            Physical::INT96 => return Ok(Self::Clock(1_000_000_000)),
            Physical::BOOLEAN => return Ok(Self::Truth),
            _ => {}
        }
        let integers = matches!(column.physical_type(), Physical::INT32 | Physical::INT64);
        match (logical, column.converted_type()) {
            (Some(LogicalType::Float16), _) => Ok(Self::Half),
            (Some(LogicalType::Decimal(_)), _) | (None, ConvertedType::DECIMAL)
                if column.type_precision() <= MOST_DIGITS =>
            {
                Ok(Self::Decimal(column.type_scale()))
            }
            _ if !integers => Err(other()),
            (Some(LogicalType::Timestamp(time)), _) => Ok(Self::Clock(match time.unit {
                TimeUnit::MILLIS => 1_000,
                TimeUnit::MICROS => 1_000_000,
                TimeUnit::NANOS => 1_000_000_000,
            })),
            (None, ConvertedType::TIMESTAMP_MILLIS) => Ok(Self::Clock(1_000)),
            (None, ConvertedType::TIMESTAMP_MICROS) => Ok(Self::Clock(1_000_000)),
            (Some(LogicalType::Integer(integer)), _) if !integer.is_signed => Ok(Self::Unsigned),
            (
                None,
                ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64,
            ) => Ok(Self::Unsigned),
            (Some(LogicalType::Integer(_)), _)
            | (
                None,
                ConvertedType::INT_8
                | ConvertedType::INT_16
                | ConvertedType::INT_32
                | ConvertedType::INT_64,
            ) => Ok(Self::Plain),
            (None, ConvertedType::NONE) => Ok(per_second.map_or(Self::Plain, Self::Clock)),
            _ => Err(other()),
        }
    }

    /// The next values of a column, at most this many, each rounded once; a missing one is NaN.
    pub(super) fn read(self, column: &mut ColumnReader, most: usize) -> Result<Vec<f64>> {
        match column {
            ColumnReader::FloatColumnReader(column) => {
                values(column, most, |value| f64::from(*value))
            }
            ColumnReader::BoolColumnReader(column) => {
                values(column, most, |value| f64::from(u8::from(*value)))
            }
            ColumnReader::DoubleColumnReader(column) => values(column, most, |value| *value),
            ColumnReader::Int32ColumnReader(column) => values(column, most, |value| match self {
                Self::Unsigned => f64::from(value.cast_unsigned()),
                _ => self.number((*value).into()),
            }),
            ColumnReader::Int64ColumnReader(column) => values(column, most, |value| match self {
                #[allow(clippy::cast_precision_loss, reason = "the rounding")]
                Self::Unsigned => value.cast_unsigned() as f64,
                _ => self.number((*value).into()),
            }),
            ColumnReader::Int96ColumnReader(column) => {
                values(column, most, |value: &Int96| self.number(value.to_nanos().into()))
            }
            ColumnReader::FixedLenByteArrayColumnReader(column) => {
                values(column, most, |value: &FixedLenByteArray| match (self, value.data()) {
                    (Self::Half, &[low, high]) => f16::from_le_bytes([low, high]).to_f64(),
                    (_, bytes) => self.number(big_endian(bytes)),
                })
            }
            ColumnReader::ByteArrayColumnReader(column) => {
                values(column, most, |value| self.number(big_endian(value.data())))
            }
        }
    }

    #[allow(clippy::cast_precision_loss, reason = "the rounding")]
    fn number(self, stored: i128) -> f64 {
        match self {
            Self::Decimal(places) => format!("{stored}e{}", -places).parse().unwrap_or(f64::NAN),
            // Whole seconds are exact, so that the sum is rounded once.
            Self::Clock(per_second) => {
                let unit = i128::from(per_second);
                stored.div_euclid(unit) as f64 + stored.rem_euclid(unit) as f64 / unit as f64
            }
            Self::Plain | Self::Unsigned | Self::Half | Self::Truth => stored as f64,
        }
    }
}

/// An integer in two's complement, at most 16 bytes of which count.
fn big_endian(bytes: &[u8]) -> i128 {
    let start = if bytes.first().is_some_and(|first| *first >= 0x80) { -1 } else { 0 };
    bytes.iter().fold(start, |number, byte| (number << 8) | i128::from(*byte))
}

fn values<T: DataType>(
    column: &mut ColumnReaderImpl<T>,
    most: usize,
    number: impl Fn(&T::T) -> f64,
) -> Result<Vec<f64>> {
    let (mut present, mut stored) = (Vec::new(), Vec::new());
    let (rows, ..) = column.read_records(most, Some(&mut present), None, &mut stored)?;
    if present.is_empty() {
        return Ok(stored.iter().map(number).collect());
    }
    let mut stored = stored.iter();
    let row = |&level: &i16| {
        if level == 0 { f64::NAN } else { stored.next().map_or(f64::NAN, &number) }
    };
    Ok(present.iter().take(rows).map(row).collect())
}
