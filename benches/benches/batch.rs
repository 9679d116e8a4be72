//! The work of `cg estimate` on a long CSV file, compared with its named peer: only parsing the
//! same file with the csv crate. The drive is at 100 Hz, of which eight rows make a mean, and at 50 Hz, of which four do.
//! `CG_BENCH_ROWS` sets the rows, 10 million by default.
#![allow(missing_docs, clippy::unwrap_used)]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::{LogOptions, LogReader};
use divan::Bencher;
use divan::counter::ItemsCount;

/// Rates of the log, Hz.
const RATES: [usize; 2] = [50, 100];

fn main() {
    divan::main();
    for rate_hz in RATES {
        let _ = std::fs::remove_file(log(rate_hz));
    }
}

fn rows() -> usize {
    std::env::var("CG_BENCH_ROWS").ok().and_then(|rows| rows.parse().ok()).unwrap_or(10_000_000)
}

fn log(rate_hz: usize) -> &'static Path {
    static LOGS: OnceLock<[PathBuf; 2]> = OnceLock::new();
    let logs =
        LOGS.get_or_init(|| RATES.map(|rate_hz| cg_bench::long_log(rows(), rate_hz).unwrap()));
    &logs[RATES.iter().position(|one| *one == rate_hz).unwrap()]
}

/// Peer: splits every row into fields and uses none of them.
#[divan::bench(args = RATES, sample_count = 3, sample_size = 1)]
fn csv_crate_parse_only(bencher: Bencher, rate_hz: usize) {
    let log = log(rate_hz);
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
#[divan::bench(args = RATES, sample_count = 3, sample_size = 1)]
fn log_reader(bencher: Bencher, rate_hz: usize) {
    let log = log(rate_hz);
    bencher.counter(ItemsCount::new(rows())).bench(|| {
        let mut reader = LogReader::open(log, &LogOptions::default()).unwrap();
        let mut sum = 0.0;
        while reader.advance().unwrap() {
            sum += reader.row().roll_rad;
        }
        sum
    });
}

/// The whole command: read, condition, identify both channels, fuse.
#[divan::bench(args = RATES, sample_count = 3, sample_size = 1)]
fn cg_estimate(bencher: Bencher, rate_hz: usize) {
    let log = log(rate_hz);
    let estimator = LogEstimator::new(&cg_bench::kraz(), EstimateOptions::default()).unwrap();
    bencher.counter(ItemsCount::new(rows())).bench(|| {
        let mut reader = LogReader::open(log, &LogOptions::default()).unwrap();
        let mut estimator = estimator.clone();
        while reader.advance().unwrap() {
            estimator.push(&reader.row()).unwrap();
        }
        estimator.finish()
    });
}
