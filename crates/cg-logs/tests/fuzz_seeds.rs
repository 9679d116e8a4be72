//! The targets of `make fuzz`, run on their kept seeds and on some hundred variations of each seed.
//! Faults that coverage-guided fuzzing has found are thus detected again.

#![cfg(feature = "dbc")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // helpers of tests

#[allow(unreachable_pub, reason = "it is a separate library")]
#[path = "../../../fuzz/src/lib.rs"]
mod fuzz;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// The seeds of a target, in the order of their names.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut seeds: Vec<(String, Vec<u8>)> = entries
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.display().to_string(), fs::read(&path).unwrap()))
        .collect();
    assert!(!seeds.is_empty(), "{} is empty", folder.display());
    seeds.sort();
    seeds
}

/// One to four variations: bit flips, other bytes, cuts, splices with another seed, repeated
/// blocks.
fn changed(seed: &[u8], other: &[u8], random: &mut StdRng) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..random.random_range(1..=4) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..=40)).min(bytes.len());
        match random.random_range(0..6) {
            0 | 1 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            2 if at < bytes.len() => {
                bytes[at] = b"0-+.eE\n,;\"#\0\xFF9"[random.random_range(0..14)];
            }
            3 => drop(bytes.drain(at..end)),
            4 => {
                let from = random.random_range(0..=other.len());
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
            _ => {
                let block = bytes[at..end].repeat(random.random_range(1..=8));
                bytes.splice(at..at, block);
            }
        }
    }
    bytes
}

/// Runs a target on its seeds and on variations of each seed. The target must accept at least one
/// seed as valid. An input that fails is kept in the folder for temporary files.
fn run(name: &str, target: fn(&[u8]) -> bool, changes: u32) {
    let seeds = seeds(name);
    let mut random = StdRng::seed_from_u64(u64::from(crc32fast::hash(name.as_bytes())));
    let survives = |what: &str, bytes: &[u8]| {
        catch_unwind(AssertUnwindSafe(|| target(bytes))).unwrap_or_else(|_| {
            let kept = std::env::temp_dir().join(format!("cg-fuzz-{name}"));
            fs::write(&kept, bytes).unwrap();
            panic!("{name} fails on {what}, kept as {}", kept.display());
        })
    };
    let taken = seeds.iter().filter(|(path, bytes)| survives(path, bytes)).count();
    assert!(taken > 0, "{name} accepts none of its seeds");
    for (path, bytes) in &seeds {
        for change in 0..changes {
            let (_, other) = &seeds[random.random_range(0..seeds.len())];
            let bytes = changed(bytes, other, &mut random);
            survives(&format!("change {change} of {path}"), &bytes);
        }
    }
}

#[test]
fn logs() {
    run("log_reader", fuzz::log_reader, 400);
}

#[test]
fn candump_logs() {
    run("candump", fuzz::candump, 300);
}

#[test]
fn dbc_files() {
    run("dbc", fuzz::dbc, 200);
}

#[test]
fn vehicle_files() {
    run("vehicle_file", fuzz::vehicle_file, 200);
}

#[test]
fn calibration_files() {
    run("calibration_file", fuzz::calibration_file, 200);
}

#[test]
fn state_files() {
    run("state_file", fuzz::state_file, 300);
}

#[test]
fn samples() {
    run("estimator_push", fuzz::estimator_push, 200);
}
