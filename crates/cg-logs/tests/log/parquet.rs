//! Logs in the parquet format.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use ::parquet::arrow::ArrowWriter;
use arrow_array::{
    ArrayRef, Float32Array, Float64Array, Int16Array, RecordBatch, StringArray, UInt64Array,
};

use super::*;

fn save(path: &Path, columns: Vec<(&str, ArrayRef)>) {
    let batch = RecordBatch::try_from_iter_with_nullable(
        columns.into_iter().map(|(name, array)| (name, array, true)),
    );
    let batch = batch.unwrap();
    let mut out = ArrowWriter::try_new(File::create(path).unwrap(), batch.schema(), None).unwrap();
    out.write(&batch).unwrap();
    out.close().unwrap();
}

fn floats(values: Vec<Option<f64>>) -> ArrayRef {
    Arc::new(Float64Array::from(values))
}

/// Saves time, steer and roll as parquet and reads the file.
fn through(time_s: Vec<Option<f64>>, roll: (&str, ArrayRef)) -> Result<Vec<LogRow>, LogError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.parquet");
    let steer = floats(vec![Some(0.1); time_s.len()]);
    save(&path, vec![("time_s", floats(time_s)), roll, ("steer_rad", steer)]);
    LogReader::open(&path, &LogOptions::default())?.collect()
}

#[test]
fn parquet_numbers_of_any_width_are_read_and_nulls_are_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.any");
    let text: ArrayRef = Arc::new(StringArray::from(vec!["a", "b"]));
    let time: ArrayRef = Arc::new(UInt64Array::from(vec![3, 5]));
    let steer: ArrayRef = Arc::new(Int16Array::from(vec![Some(-7), None]));
    let roll: ArrayRef = Arc::new(Float32Array::from(vec![0.25, 0.5]));
    save(&path, vec![("note", text), ("Roll", roll), ("time_s", time), ("steer_rad", steer)]);
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
    save(&path, vec![("time_s", ramp()), ("steer_deg", ramp()), ("tilt_rad", ramp())]);
    let mut log = LogReader::open(&path, &LogOptions::default()).unwrap();
    let size = fs::metadata(&path).unwrap().len();
    assert_eq!((log.bytes_read(), log.total_bytes()), (0, Some(size)));
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
    let text: ArrayRef = Arc::new(StringArray::from(vec!["a"]));
    let error = through(vec![Some(1.0)], ("roll_rad", text)).unwrap_err();
    says(&error, &["column 2 `roll_rad`", "Utf8", "export it as a numeric column"]);
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
    save(&path, vec![("time_s", ramp()), ("steer_rad", ramp()), ("roll_rad", ramp())]);
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    says(&open_it(), &["drive.parquet", "not a readable parquet file", "copy or export"]);
    refused(&whole, &["parquet cannot be read from a stream", "path"]);
}
