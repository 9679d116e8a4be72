//! Writing of logs, and reading what was written.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

use cg_logs::log::LogWriter;
use cg_output::{Files, Kind};
use proptest::prelude::*;

use super::*;

const COLUMNS: [Signal; 3] = [Signal::Time, Signal::Steer, Signal::Roll];

fn row(time_s: f64, steer_rad: f64, roll_rad: f64) -> LogRow {
    LogRow { time_s, steer_rad, roll_rad, ..LogRow::ABSENT }
}

/// A writer to a file that may exist already.
fn writer(path: &Path) -> Result<LogWriter, LogError> {
    let target = Files::new(true).writes("path", path, Kind::Log).unwrap();
    LogWriter::create(&target, &[], &COLUMNS)
}

/// A stream whose bytes can be inspected afterwards.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn written(comments: &[&str], columns: &[Signal], rows: &[LogRow]) -> Result<String, LogError> {
    let out = Shared::default();
    let comments: Vec<_> = comments.iter().map(|&text| text.into()).collect();
    let stream = Box::new(out.clone());
    let mut log = LogWriter::from_writer("drive.csv", stream, &comments, columns)?;
    rows.iter().try_for_each(|row| log.write_row(row))?;
    log.finish()?;
    let bytes = out.0.lock().unwrap().clone();
    Ok(String::from_utf8(bytes).unwrap())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn comments_header_and_rows_are_written_with_the_digits_they_need() {
    let rows = [row(0.0, 0.1, -0.2), row(0.01, f64::NAN, 1e-7), row(2.0, 1.0 / 3.0, 40.0)];
    let text = written(&["truth 1.9 m", "a\nb"], &COLUMNS, &rows).unwrap();
    let expected = "# truth 1.9 m\n# a\n# b\ntime_s,steer_rad,roll_rad\n\
                    0,0.1,-0.2\n0.01,,1e-7\n2,0.3333333333333333,40.0\n";
    assert_eq!(text, expected);
}

#[test]
fn what_the_reader_would_refuse_is_not_written() {
    let refuse = |rows: &[LogRow], words: &[&str]| {
        says(&written(&["c"], &COLUMNS, rows).unwrap_err(), words);
    };
    refuse(&[row(f64::NAN, 0.0, 0.0)], &["line 3", "`time_s`", "missing"]);
    refuse(&[row(1.0, 0.0, 0.0), row(1.000_000_1, 0.0, 0.0)], &["line 4", "does not come after"]);
    refuse(&[row(1.0, 0.0, f64::INFINITY)], &["line 3", "column 3 `roll_rad`", "not finite"]);
    let unsure = LogRow { trailer_mass_kg: 2e4, trailer_mass_sd_kg: -1.0, ..row(1.0, 0.0, 0.0) };
    let with_sd = [&COLUMNS[..], &[Signal::TrailerMass, Signal::TrailerMassSd]].concat();
    says(&written(&[], &with_sd, &[unsure]).unwrap_err(), &["line 2", "column 5", "negative"]);
    let columns = |columns: &[Signal]| written(&[], columns, &[]).unwrap_err();
    says(&columns(&COLUMNS[..2]), &["roll_rad or tilt_rad"]);
    says(&columns(&[COLUMNS, COLUMNS].concat()), &["the log has time twice"]);
    says(&written(&[&"c".repeat(1 << 16)], &COLUMNS, &[]).unwrap_err(), &["line 1", "longer"]);
}

#[test]
fn a_file_takes_its_name_when_it_is_finished_and_leaves_nothing_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    fs::write(&path, "old").unwrap();
    let begin = || writer(&path).unwrap();
    let mut log = begin();
    log.write_row(&row(0.0, 0.1, -0.2)).unwrap();
    assert_eq!((names(folder.path()).len(), fs::read_to_string(&path).unwrap()), (2, "old".into()));
    drop(log);
    assert_eq!(
        (names(folder.path()), fs::read(&path).unwrap()),
        (vec!["drive.csv".into()], b"old".into())
    );
    let (mut log, other) = (begin(), begin());
    log.write_row(&row(0.0, 0.1, -0.2)).unwrap();
    log.finish().unwrap();
    drop(other);
    assert_eq!(names(folder.path()), ["drive.csv"]);
    assert_eq!(LogReader::open(&path, &LogOptions::default()).unwrap().count(), 1);
}

#[test]
fn a_name_in_gz_is_packed_and_one_in_parquet_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv.gz");
    let mut log = writer(&path).unwrap();
    log.write_row(&row(0.0, 0.1, -0.2)).unwrap();
    log.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap()[..2], [0x1f, 0x8b]);
    let rows: Result<Vec<_>, _> = LogReader::open(&path, &LogOptions::default()).unwrap().collect();
    assert_eq!(rows.unwrap()[0].roll_rad, -0.2);
    let path = folder.path().join("drive.parquet");
    let error = writer(&path).err().unwrap();
    says(&error, &["parquet cannot be written", ".csv.gz"]);
}

#[test]
fn a_folder_that_is_not_there_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none").join("drive.csv");
    let error = writer(&path).err().unwrap();
    says(&error, &["cannot be written", "check the folder"]);
}

#[cfg(unix)]
#[test]
fn a_device_is_written_to_and_a_link_stays_a_link() {
    let mut log = writer(Path::new("/dev/null")).unwrap();
    log.write_row(&row(0.0, 0.1, -0.2)).unwrap();
    log.finish().unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
    let folder = tempfile::tempdir().unwrap();
    let (link, target) = (folder.path().join("link.csv"), folder.path().join("drive.csv"));
    fs::write(&target, "").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    writer(&link).unwrap().finish().unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::read_to_string(&target).unwrap().starts_with("time_s,"));
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![8 => any::<f64>(), 8 => -10.0..10.0, 1 => Just(f64::NAN), 1 => Just(-0.0)]
        .prop_map(|value| if value.is_infinite() { f64::NAN } else { value })
}

proptest! {
    #[test]
    fn what_is_written_is_read_again_bit_for_bit(
        steps_us in prop::collection::vec((1_u32..2_000_000_000, prop::array::uniform26(any_number())), 1..20),
        start_us in -1e15..1e15,
    ) {
        // A roll rate would change the roll angle.
        let columns: Vec<Signal> =
            Signal::ALL.into_iter().filter(|signal| *signal != Signal::RollRate).collect();
        let mut time_us = f64::round(start_us);
        let rows: Vec<_> = steps_us.iter().map(|(step_us, v)| {
            time_us += f64::from(*step_us);
            let mut values = [f64::NAN; Signal::COUNT];
            values[..v.len()].copy_from_slice(v);
            LogRow { time_s: time_us / 1e6, ..LogRow::from_values(values) }
        }).collect();
        let back = read(written(&["seed"], &columns, &rows).unwrap()).unwrap();
        prop_assert_eq!(back.len(), rows.len());
        for (back, row) in back.iter().zip(&rows) {
            for signal in Signal::ALL {
                let (a, b) = (back.get(signal), row.get(signal));
                prop_assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(), "{signal}: {a} {b}");
            }
        }
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), row in ".{0,80}") {
        let _ = read(&bytes);
        let _ = read([ONE.as_bytes(), &bytes].concat());
        let _ = read(format!("{ONE}{row}\n1,0,0\n\"{row}"));
    }
}
