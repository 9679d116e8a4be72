//! Logs in the parquet format.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use ::parquet::column::writer::ColumnWriter;
use ::parquet::data_type::{ByteArray, FixedLenByteArray, Int96};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use super::*;

/// The values of a column as they are stored.
enum Stored {
    Double(Vec<Option<f64>>),
    Float(Vec<Option<f32>>),
    Int(Vec<Option<i32>>),
    Long(Vec<Option<i64>>),
    Int96(Vec<Option<Int96>>),
    Bytes(Vec<Option<Vec<u8>>>),
    Fixed(Vec<Option<Vec<u8>>>),
}

/// Two row groups, because rows of one group are unpacked together.
fn save(path: &Path, columns: &[(&str, &str, Stored)]) {
    save_beside(path, columns, WriterProperties::default());
}

fn save_beside(path: &Path, columns: &[(&str, &str, Stored)], properties: WriterProperties) {
    let fields: Vec<String> = (columns.iter())
        .map(|(name, kind, _)| match kind.split_once(' ') {
            Some((kind, meaning)) => format!("optional {kind} {name} {meaning};"),
            None => format!("optional {kind} {name};"),
        })
        .collect();
    let schema = parse_message_type(&format!("message log {{ {} }}", fields.join(" "))).unwrap();
    let file = File::create(path).unwrap();
    let mut out = SerializedFileWriter::new(file, Arc::new(schema), properties.into()).unwrap();
    for half in 0..2 {
        let mut group = out.next_row_group().unwrap();
        for (_, _, stored) in columns {
            let mut column = group.next_column().unwrap().unwrap();
            macro_rules! write {
                ($writer:ident, $values:expr, $from:expr) => {{
                    let ColumnWriter::$writer(writer) = column.untyped() else { panic!() };
                    let middle = $values.len() / 2;
                    let part = if half == 0 { &$values[..middle] } else { &$values[middle..] };
                    let present: Vec<i16> = part.iter().map(|x| x.is_some().into()).collect();
                    let values: Vec<_> = part.iter().flatten().cloned().map($from).collect();
                    writer.write_batch(&values, Some(&present), None).unwrap();
                }};
            }
            match stored {
                Stored::Double(values) => write!(DoubleColumnWriter, values, |x| x),
                Stored::Float(values) => write!(FloatColumnWriter, values, |x| x),
                Stored::Int(values) => write!(Int32ColumnWriter, values, |x| x),
                Stored::Long(values) => write!(Int64ColumnWriter, values, |x| x),
                Stored::Int96(values) => write!(Int96ColumnWriter, values, |x| x),
                Stored::Bytes(values) => write!(ByteArrayColumnWriter, values, ByteArray::from),
                Stored::Fixed(values) => {
                    write!(FixedLenByteArrayColumnWriter, values, FixedLenByteArray::from);
                }
            }
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    out.close().unwrap();
}

fn floats(values: Vec<Option<f64>>) -> Stored {
    Stored::Double(values)
}

/// Saves time, steer and roll as parquet and reads the file.
fn through(time_s: Vec<Option<f64>>, roll: (&str, Stored)) -> Result<Vec<LogRow>, LogError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    let steer = floats(vec![Some(0.1); time_s.len()]);
    let kind = if matches!(roll.1, Stored::Bytes(_)) { "binary (UTF8)" } else { "double" };
    let time = ("time_s", "double", floats(time_s));
    save(&path, &[time, (roll.0, kind, roll.1), ("steer_rad", "double", steer)]);
    LogReader::open(&path, &LogOptions::default())?.collect()
}

#[test]
fn parquet_numbers_of_any_width_are_read_and_nulls_are_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.any");
    let text = |text: &str| Some(text.as_bytes().to_vec());
    let columns = [
        ("note", "binary (UTF8)", Stored::Bytes(vec![text("a"), text("b")])),
        ("Roll", "float", Stored::Float(vec![Some(0.25), Some(0.5)])),
        ("time_s", "int64 (INTEGER(64,false))", Stored::Long(vec![Some(3), Some(5)])),
        ("steer_rad", "int32 (INTEGER(16,true))", Stored::Int(vec![Some(-7), None])),
    ];
    save(&path, &columns);
    let options = options(&["roll=Roll[rad]"], &[Signal::Roll]);
    let rows: Vec<_> = LogReader::open(&path, &options).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!((rows[0].time_s, rows[0].steer_rad, rows[0].roll_rad), (3.0, -7.0, -0.25));
    assert!(rows[1].steer_rad.is_nan() && rows[1].roll_rad == -0.5 && rows[1].tilt_rad.is_nan());
}

#[test]
fn parquet_is_streamed_and_counts_its_rows_and_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    let ramp = || floats((0..20_000).map(|k| Some(f64::from(k))).collect());
    let names = ["time_s", "steer_deg", "tilt_rad"];
    save(&path, &names.map(|name| (name, "double", ramp())));
    let mut log = LogReader::open(&path, &LogOptions::default()).unwrap();
    let size = fs::metadata(&path).unwrap().len();
    // Of the 20 000 rows, 250 have been looked at.
    assert!(log.bytes_read() <= size / 80 && log.total_bytes() == Some(size));
    for k in 0..20_000_u32 {
        let row = log.next_row().unwrap().unwrap();
        assert_eq!((row.time_s, row.tilt_rad, log.line()), (k.into(), k.into(), u64::from(k) + 1));
    }
    assert!(log.next_row().unwrap().is_none());
    assert_eq!(log.bytes_read(), size);
}

#[test]
fn parquet_errors_name_the_row() {
    let roll = |values| ("roll_deg", floats(values));
    let error = through(vec![Some(1.0), Some(1.0)], roll(vec![None; 2])).unwrap_err();
    says(&error, &["drive.parquet, row 2", "column 1 `time_s`", "does not come after"]);
    let error = through(vec![Some(1.0), None], roll(vec![None; 2])).unwrap_err();
    says(&error, &["row 2", "column 1 `time_s`", "missing"]);
    let error = through(vec![Some(1.0)], roll(vec![Some(f64::INFINITY)])).unwrap_err();
    says(&error, &["row 1", "column 2 `roll_deg`", "`inf`", "not finite"]);
    let text = Stored::Bytes(vec![Some(b"a".to_vec())]);
    let error = through(vec![Some(1.0)], ("roll_rad", text)).unwrap_err();
    says(&error, &["column 2 `roll_rad`", "contains text", "export it as a numeric column"]);
    says(&through(vec![], roll(vec![])).unwrap_err(), &["no rows"]);
    says(&through(vec![Some(1.0)], ("roll_grad", floats(vec![None]))).unwrap_err(), &["rad, deg"]);
}

#[test]
fn damaged_parquet_and_parquet_on_a_stream_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    fs::write(&path, ONE).unwrap();
    let open_it = || LogReader::open(&path, &LogOptions::default()).err().unwrap();
    says(&open_it(), &["drive.parquet", "not a readable parquet file", "copy or export"]);
    let ramp = || floats((0..99).map(|k| Some(f64::from(k))).collect());
    let names = ["time_s", "steer_rad", "roll_rad"];
    save(&path, &names.map(|name| (name, "double", ramp())));
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    says(&open_it(), &["drive.parquet", "not a readable parquet file", "copy or export"]);
    refused(&whole, &["parquet cannot be read from a stream", "path"]);
}

#[test]
fn parquet_numbers_of_every_kind_are_rounded_once() {
    let decimal = |number: i128, bytes: usize| Some(number.to_be_bytes()[16 - bytes..].to_vec());
    let wide = |number: i128| {
        let sign = if number < 0 { 0xff } else { 0 };
        Some([vec![sign; 4], number.to_be_bytes().to_vec()].concat())
    };
    let f16 = |bits: u16| Some(bits.to_le_bytes().to_vec());
    let cases: Vec<(&str, Stored, [f64; 2])> = vec![
        ("int32", Stored::Int(vec![Some(-128), Some(127)]), [-128.0, 127.0]),
        ("int32 (UINT_32)", Stored::Int(vec![Some(-1), Some(1)]), [4_294_967_295.0, 1.0]),
        ("int32 (INTEGER(8,false))", Stored::Int(vec![Some(200), Some(1)]), [200.0, 1.0]),
        ("int32 (INTEGER(32,false))", Stored::Int(vec![Some(-1), Some(1)]), [4_294_967_295.0, 1.0]),
        ("int64", Stored::Long(vec![Some(i64::MAX), Some(1)]), [9_223_372_036_854_775_807.0, 1.0]),
        (
            "int64 (UINT_64)",
            Stored::Long(vec![Some(-1), Some(1)]),
            [18_446_744_073_709_551_615.0, 1.0],
        ),
        (
            "int64 (INTEGER(64,false))",
            Stored::Long(vec![Some(-1), Some(1)]),
            [18_446_744_073_709_551_615.0, 1.0],
        ),
        ("int32 (DECIMAL(9,3))", Stored::Int(vec![Some(-12_345), Some(1)]), [-12.345, 0.001]),
        ("int64 (DECIMAL(18,1))", Stored::Long(vec![Some(-7), Some(3)]), [-0.7, 0.3]),
        (
            "fixed_len_byte_array(5) (DECIMAL(11,2))",
            Stored::Fixed(vec![decimal(-12_345, 5), decimal(70_000, 5)]),
            [-123.45, 700.0],
        ),
        (
            "fixed_len_byte_array(20) (DECIMAL(38,3))",
            Stored::Fixed(vec![wide(-9_007_199_254_740_993), wide(9_007_199_254_740_993)]),
            [-9_007_199_254_740.993, 9_007_199_254_740.993],
        ),
        (
            "binary (DECIMAL(20,4))",
            Stored::Bytes(vec![decimal(-1, 1), decimal(12_345, 3)]),
            [-0.0001, 1.2345],
        ),
        (
            "fixed_len_byte_array(2) (FLOAT16)",
            Stored::Fixed(vec![f16(0x3e00), f16(0xc000)]),
            [1.5, -2.0],
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    let options = options(&["roll=R[rad]"], &[]);
    for (kind, stored, expected) in cases {
        let time = floats(vec![Some(0.0), Some(1.0)]);
        let steer = floats(vec![Some(0.0); 2]);
        save(
            &path,
            &[("time_s", "double", time), ("R", kind, stored), ("steer_rad", "double", steer)],
        );
        let log = LogReader::open(&path, &options).unwrap();
        let read: Vec<f64> = log.map(|row| row.unwrap().roll_rad).collect();
        assert_eq!(read, expected, "{kind}");
    }
}

#[test]
fn parquet_times_are_seconds_whatever_their_unit() {
    let mut spark = [Int96::new(), Int96::new()];
    // Nanoseconds of the day, then the Julian day: one second before midnight, and one after.
    let before = 86_399_000_000_000_u64;
    spark[0].set_data((before & 0xffff_ffff) as u32, (before >> 32) as u32, 2_460_000);
    spark[1].set_data(1_000_000_000, 0, 2_460_001);
    let longs = |first: i64, unit: i64| Stored::Long(vec![Some(first), Some(first + 2 * unit)]);
    let cases = [
        ("int64 (TIMESTAMP_MILLIS)", longs(1_700_000_000_000, 1_000), 1.7e9),
        ("int64 (TIMESTAMP(MICROS,true))", longs(-1_500_000, 1_000_000), -1.5),
        ("int64 (TIMESTAMP(NANOS,false))", longs(1_700_000_000_000_000_000, 1_000_000_000), 1.7e9),
        ("int96", Stored::Int96(spark.map(Some).to_vec()), 1_677_283_199.0),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    for (kind, when, first) in cases {
        let zeros = || floats(vec![Some(0.0); 2]);
        save(
            &path,
            &[
                ("when", kind, when),
                ("roll_rad", "double", zeros()),
                ("steer_rad", "double", zeros()),
            ],
        );
        let log = LogReader::open(&path, &LogOptions::default()).unwrap();
        let read: Vec<f64> = log.map(|row| row.unwrap().time_s).collect();
        assert_eq!(read, [first, first + 2.0], "{kind}");
    }
}

/// What pyarrow 26 writes beside the columns `d_s`, `d_ms`, `d_us` and `d_ns` of `pyarrow.duration(unit)`, `t_s` of
/// `timestamp("s")`, `t_ns` of `timestamp("ns", "UTC")` and `n` of `int64()`, in
/// `pyarrow.parquet.read_metadata(file).metadata[b"ARROW:schema"]`.
const ARROW_SCHEMA: &str = "/////6gBAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAcAAABIAQAACAEAANgAAACoAAAA\
    gAAAADwAAAAEAAAA5P7//wAAAQIQAAAAHAAAAAQAAAAAAAAAAQAAAG4AAAAIAAwACAAHAAgAAAAAAAABQAAAABj///8AAAEK\
    EAAAACAAAAAEAAAAAAAAAAQAAAB0X25zAAAAAAgADAAGAAgACAAAAAAAAwAEAAAAAwAAAFVUQwBY////AAABChAAAAAUAAAA\
    BAAAAAAAAAADAAAAdF9zAID///98////AAABEhAAAAAYAAAABAAAAAAAAAAEAAAAZF9ucwAAAABu////AAADAKj///8AAAES\
    EAAAABgAAAAEAAAAAAAAAAQAAABkX3VzAAAAAJr///8AAAIA1P///wAAARIQAAAAHAAAAAQAAAAAAAAABAAAAGRfbXMAAAAA\
    BAAEAAQAAAAQABQACAAGAAcADAAAABAAEAAAAAAAARIQAAAAHAAAAAQAAAAAAAAAAwAAAGRfcwAAAAYACAAGAAYAAAAAAAAA";

/// Parquet has neither durations nor whole seconds; Arrow's programs store plain integers and say the unit in a schema
/// of their own, which older ones wrote without the mark and the length at its beginning.
#[test]
fn parquet_times_of_arrow_have_the_unit_of_its_schema() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    let read = |name: &str, unit: i64, schema: &str| -> Vec<f64> {
        let when = Stored::Long(vec![Some(3 * unit / 2), Some(7 * unit)]);
        let zeros = || floats(vec![Some(0.0); 2]);
        let (roll, steer) = (("roll_rad", "double", zeros()), ("steer_rad", "double", zeros()));
        let pair = KeyValue::new("ARROW:schema".to_owned(), schema.to_owned());
        let beside = WriterProperties::builder().set_key_value_metadata(Some(vec![pair]));
        save_beside(&path, &[(name, "int64", when), roll, steer], beside.build());
        let options = options(&[&format!("time={name}[s]")], &[]);
        let log = LogReader::open(&path, &options).unwrap();
        log.map(|row| row.unwrap().time_s).collect()
    };
    let older = BASE64_STANDARD.encode(&BASE64_STANDARD.decode(ARROW_SCHEMA).unwrap()[8..]);
    for schema in [ARROW_SCHEMA, &older] {
        for (name, unit) in [("d_ms", 1_000), ("d_us", 1_000_000), ("d_ns", 1_000_000_000)] {
            assert_eq!(read(name, unit, schema), [1.5, 7.0], "{name}");
        }
        assert_eq!(read("d_s", 1, schema), [1.0, 7.0]);
        assert_eq!(read("t_s", 1, schema), [1.0, 7.0]);
        assert_eq!(read("t_ns", 1_000_000_000, schema), [1.5, 7.0]);
        assert_eq!(read("n", 1_000, schema), [1_500.0, 7_000.0], "a number has no unit");
    }
    for none in ["", "no schema", "////"] {
        assert_eq!(read("d_ms", 1_000, none), [1_500.0, 7_000.0], "{none:?}");
    }
}
