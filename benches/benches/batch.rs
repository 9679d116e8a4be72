//! The work of `cg estimate` on a long CSV file, compared with its named peer: only parsing the
//! same file with the csv crate. `CG_BENCH_ROWS` sets the rows, 10 million by default.
#![allow(missing_docs, clippy::unwrap_used)]

use std::fs::File;
use std::path::Path;
use std::sync::OnceLock;

use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::{LogOptions, LogReader};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
    let _ = std::fs::remove_file(log());
}

fn rows() -> usize {
    std::env::var("CG_BENCH_ROWS").ok().and_then(|rows| rows.parse().ok()).unwrap_or(10_000_000)
}

fn log() -> &'static Path {
    static LOG: OnceLock<std::path::PathBuf> = OnceLock::new();
    LOG.get_or_init(|| cg_bench::long_log(rows()).unwrap())
}

/// Peer: splits every row into fields and uses none of them.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn csv_crate_parse_only(bencher: Bencher) {
    let log = log();
    bencher.counter(ItemsCount::new(rows())).bench(|| {
        let mut reader = csv::Reader::from_reader(File::open(log).unwrap());
        let mut record = csv::ByteRecord::new();
        let mut fields = 0;
        while reader.read_byte_record(&mut record).unwrap() {
            fields += record.len();
        }
        fields
    });
}

/// The log reader alone: fields, numbers, units, checks.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn log_reader(bencher: Bencher) {
    let log = log();
    bencher.counter(ItemsCount::new(rows())).bench(|| {
        let mut reader = LogReader::open(log, &LogOptions::default()).unwrap();
        let mut sum = 0.0;
        while let Some(row) = reader.next_row().unwrap() {
            sum += row.roll_rad;
        }
        sum
    });
}

/// The whole command: read, condition, identify both channels, fuse.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn cg_estimate(bencher: Bencher) {
    let log = log();
    let estimator = LogEstimator::new(&cg_bench::kraz(), EstimateOptions::default()).unwrap();
    bencher.counter(ItemsCount::new(rows())).bench(|| {
        let mut reader = LogReader::open(log, &LogOptions::default()).unwrap();
        let mut estimator = estimator.clone();
        while let Some(row) = reader.next_row().unwrap() {
            estimator.push(&row).unwrap();
        }
        estimator.finish()
    });
}
