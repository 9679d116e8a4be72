//! Files and streams: gzip, endless lines, progress.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use cg_logs::can::CandumpReader;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::*;

fn gzip(text: impl AsRef<[u8]>) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text.as_ref()).unwrap();
    packed.finish().unwrap()
}

fn steady(rows: usize) -> String {
    let rows = (0..rows).map(|k| format!("{k},0.{k},-0.{k}\n"));
    std::iter::once("time_s,steer_rad,roll_rad\n".into()).chain(rows).collect()
}

/// A stream of a head and an endlessly repeated part, which counts the bytes read.
struct Endless(Vec<u8>, Vec<u8>, Arc<AtomicUsize>);

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.0.as_slice().read(buffer)?;
        self.0.drain(..count);
        if self.0.is_empty() {
            self.0 = self.1.clone();
        }
        self.2.fetch_add(count, Ordering::Relaxed);
        Ok(count)
    }
}

/// The error for an endless stream. It must occur before a mebibyte is read.
fn soon(head: &[u8], part: &[u8]) -> LogError {
    let taken = Arc::new(AtomicUsize::new(0));
    let stream = Endless(head.to_vec(), part.to_vec(), Arc::clone(&taken));
    let log = LogReader::from_reader("drive.csv", Box::new(stream), &LogOptions::default());
    let error = log.and_then(Iterator::collect::<Result<Vec<_>, _>>).unwrap_err();
    assert!(taken.load(Ordering::Relaxed) < 1 << 20, "{taken:?} bytes taken");
    error
}

#[test]
fn an_endless_line_is_an_error_at_once() {
    says(&soon(ONE.as_bytes(), b"1"), &["line 3", "longer than 65536 bytes"]);
    says(&soon(ONE.as_bytes(), b"1,0,0,"), &["line 3", "longer than 65536 bytes"]);
    says(&soon(b"time_s,", b"x"), &["line 1", "longer than 65536 bytes"]);
}

#[test]
fn an_endless_comment_is_an_error_at_once() {
    says(&soon(format!("{ONE}#").as_bytes(), b"#"), &["line 3", "longer than 65536 bytes"]);
    says(&soon(b"#", &[0; 4096]), &["line 1", "longer than 65536 bytes"]);
}

#[test]
fn an_endless_field_in_quotes_is_an_error_at_once_though_it_has_line_feeds() {
    let head = format!("{ONE}1,\"");
    says(&soon(head.as_bytes(), b"0,0\n"), &["line 3", "65536 bytes", "a quote is not closed"]);
}

#[test]
fn an_endless_gzip_line_is_an_error_at_once() {
    let part = gzip(vec![b'7'; 1 << 20]);
    says(&soon(&gzip(ONE), &part), &["line 3", "longer than 65536 bytes"]);
}

#[test]
fn a_line_of_the_longest_length_is_read_and_one_more_byte_is_an_error() {
    let row = |length: usize| format!("{ONE}1,0,{}\n2,0,0\n", "0".repeat(length - 4));
    assert_eq!(read(row(65_536)).unwrap().len(), 3);
    refused(row(65_537), &["line 3", "longer than 65536 bytes"]);
    let comments = format!("#{}\n", "#".repeat(60_000)).repeat(9);
    assert_eq!(pair(format!("{comments}{ONE}")), (0.1, -0.2));
}

#[test]
fn a_quote_that_is_never_closed_is_an_error_where_it_opens() {
    refused(format!("{ONE}1,0,0\n2,\"0,0\n3,0,0\n"), &["line 4", "not closed"]);
    refused("time_s,\"steer_rad,roll_rad\n0,0,0\n", &["line 1", "not closed"]);
}

#[test]
fn a_header_that_is_not_text_is_an_error() {
    refused(b"time_s,steer_rad,roll_rad,\x01\n0,0,0,0\n", &["line 1", "not UTF-8"]);
    let wide: Vec<u8> = ONE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    refused(wide, &["line 1", "not UTF-8", "export the log"]);
    refused(ONE.replace('\n', "\r"), &["line 1", "bare carriage return", "line feeds"]);
}

#[test]
fn gzip_is_unpacked_whatever_the_name_and_in_any_number_of_members() {
    assert_eq!(pair(gzip(ONE)), (0.1, -0.2));
    let (head, tail) = ONE.split_at(30);
    assert_eq!(pair([gzip(head), gzip(""), gzip(tail)].concat()), (0.1, -0.2));
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("drive.csv", gzip(ONE)), ("drive.csv.gz", ONE.into())] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        assert_eq!(LogReader::open(&path, &LogOptions::default()).unwrap().count(), 1);
    }
}

#[test]
fn truncated_gzip_is_an_error_with_the_line_reached_after_all_rows_before_it() {
    let text = steady(50_000);
    let packed = gzip(&text);
    for kept in [packed.len() / 2, packed.len() - 9, packed.len() - 1] {
        let mut log = open(&packed[..kept], &LogOptions::default()).unwrap();
        let mut rows = 0;
        let error = loop {
            match log.next_row() {
                Ok(row) => rows += usize::from(row.is_some()),
                Err(error) => break error,
            }
        };
        assert!(rows > 20_000 && log.next_row().unwrap().is_none());
        says(&error, &["truncated", &format!("line {}", rows + 2), "copy it again"]);
        assert!(matches!(error, LogError::Gzip { .. }));
    }
    refused(&packed[..5], &["line 1", "truncated"]);
}

#[test]
fn corrupt_gzip_is_an_error() {
    let mut packed = gzip(steady(50_000));
    let middle = packed.len() / 2;
    packed[middle..middle + 64].fill(0xff);
    refused(&packed, &["line 2", "corrupt", "copy it again"]);
    packed[20..40].fill(0xff);
    refused(&packed, &["line 1", "corrupt"]);
    refused(gzip(format!("{ONE}1,x,0\n")), &["line 3", "`x` is not a number"]);
    refused([gzip(ONE), b"tail".to_vec()].concat(), &["line 3", "corrupt"]);
    let mut packed = gzip(ONE);
    let crc = packed.len() - 8;
    packed[crc] ^= 1;
    refused(&packed, &["line 3", "corrupt"]);
}

#[test]
fn progress_counts_the_bytes_of_the_file_as_it_is_packed() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("a.csv", steady(60_000).into_bytes()), ("b.gz", gzip(steady(60_000)))] {
        let path = folder.path().join(name);
        fs::write(&path, &bytes).unwrap();
        let mut log = LogReader::open(&path, &LogOptions::default()).unwrap();
        assert_eq!(log.total_bytes(), Some(bytes.len() as u64));
        let early = log.bytes_read();
        assert!(0 < early && early < bytes.len() as u64, "{name}: {early}");
        assert!(log.by_ref().all(|row| row.is_ok()));
        assert_eq!(log.bytes_read(), bytes.len() as u64);
    }
    assert_eq!(open(ONE, &LogOptions::default()).unwrap().total_bytes(), None);
}

#[test]
fn a_file_that_cannot_be_opened_or_read_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let open = |name| LogReader::open(&folder.path().join(name), &LogOptions::default()).err();
    says(&open("drive.csv").unwrap(), &["cannot be opened", "check the path"]);
    fs::create_dir(folder.path().join("drive.d")).unwrap();
    says(&open("drive.d").unwrap(), &["cannot be read", "check the path"]);
}

#[test]
fn a_row_is_given_as_soon_as_its_line_is_whole() {
    let (reading, mut writing) = io::pipe().unwrap();
    writing.write_all(ONE.as_bytes()).unwrap();
    let stream = File::from(std::os::fd::OwnedFd::from(reading));
    let mut log =
        LogReader::from_reader("drive.csv", Box::new(stream), &LogOptions::default()).unwrap();
    assert_eq!(log.next_row().unwrap().unwrap().steer_rad, 0.1);
    drop(writing);
    assert!(log.next_row().unwrap().is_none());
}

/// A stream that pauses after every few bytes behind its first line.
struct Pausing(Vec<u8>, usize, bool);

impl Read for Pausing {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.2 = !self.2;
        if self.2 && self.1 == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let few = if self.1 > 0 { self.1 } else { 7 }.min(buffer.len());
        let count = (&self.0[..few.min(self.0.len())]).read(buffer)?;
        self.0.drain(..count);
        self.1 = self.1.saturating_sub(count);
        Ok(count)
    }
}

/// Nothing is lost, in quotes or not.
#[test]
fn a_stream_goes_on_after_a_pause() {
    let quoted = "time_s,steer_rad,roll_rad\n0,\"0.5\",-0.1\n1,\"0.25\",0\n";
    for text in [steady(50), quoted.to_owned()] {
        let head = "time_s,steer_rad,roll_rad\n".len();
        let least = (text.len() - head) / 7;
        let stream = Pausing(text.clone().into(), head, false);
        let log = LogReader::from_reader("drive.csv", Box::new(stream), &LogOptions::default());
        let (mut log, mut rows, mut pauses) = (log.unwrap(), Vec::new(), 0);
        loop {
            match log.next_row() {
                Ok(Some(row)) => rows.push([row.time_s, row.steer_rad, row.roll_rad]),
                Ok(None) => break,
                Err(error) => {
                    assert!(error.is_pause(), "{error}");
                    pauses += 1;
                }
            }
        }
        let expected = read(&text).unwrap();
        let expected = expected.iter().map(|row| [row.time_s, row.steer_rad, row.roll_rad]);
        assert!(rows.iter().copied().eq(expected), "{} rows", rows.len());
        assert!(pauses >= least, "{pauses}");
    }
}

/// The last line lacks its end.
#[test]
fn frames_go_on_after_a_pause() {
    let text = "(1.000000) can0 123#00\n(2.000000) can0 123#01\n(3.000000) can0 123#02";
    let stream = io::BufReader::new(Pausing(text.into(), 0, false));
    let (mut reader, mut times_us, mut pauses) = (CandumpReader::new(stream, None), Vec::new(), 0);
    loop {
        match reader.next_frame() {
            Ok(Some(frame)) => times_us.push(frame.time_us),
            Ok(None) => break,
            Err(fault) => {
                assert!(fault.is_pause(), "{fault}");
                pauses += 1;
            }
        }
    }
    assert_eq!(times_us, [1_000_000, 2_000_000, 3_000_000]);
    assert!(pauses > text.len() / 7, "{pauses}");
}

/// What a reader gives, one after the other: rows, errors and findings, each with the line reached.
fn given(mut log: LogReader) -> Vec<String> {
    let mut all = vec![format!("{:?}", log.signals())];
    while all.len() < 2000 {
        let row = log.next_row();
        let over = matches!(row, Ok(None));
        let row = row.map_err(|error| error.to_string());
        all.push(format!("{} {row:?} {:?}", log.line(), log.news()));
        if over {
            break;
        }
    }
    all
}

/// The first rows of a file are looked at before they are given; nothing of it shows.
#[test]
fn a_file_gives_what_a_stream_of_its_bytes_gives() {
    let settings = Some(AlignSettings::NONE);
    let options = LogOptions { settings, ..LogOptions::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    let head = "time_s,steer_rad,roll_rad\n";
    for bytes in [
        steady(700).into_bytes(),
        format!("{}x\n{}", steady(3), "900,0.1,0.2\n").into_bytes(),
        format!("{}1,0,0\n900,-45,0.2\n901,0.1,7\n902,,\n", steady(700)).into_bytes(),
        format!("{head}0,-45,0\n\n1,0.1,7\n2,0.1,0.1\n2,0,0\n# 3\n3,0.1,0.2").into_bytes(),
        "time,steer,roll,lateral_acceleration\ns,rad,deg,m/s^2\n0,1,2,3\n1,2,3,4\n".into(),
        head.into(),
        gzip(format!("{}0,x,1\n900,1,1\n", steady(20))),
        gzip(steady(20))[..60].to_vec(),
    ] {
        fs::write(&path, &bytes).unwrap();
        let file = LogReader::open(&path, &options).unwrap();
        let name = path.display().to_string();
        let stream = LogReader::from_reader(&name, Box::new(io::Cursor::new(bytes)), &options);
        let stream = stream.unwrap();
        assert_eq!(file.line(), stream.line());
        let (file, stream) = (given(file), given(stream));
        assert_eq!(file.len(), stream.len());
        for (one, other) in file.iter().zip(&stream) {
            assert_eq!(one, other);
        }
    }
}
