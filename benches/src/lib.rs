//! Logs for the benches.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_vehicle::Vehicle;

/// A file under `fixtures/`.
pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

/// The independent truck.
///
/// # Panics
/// If the fixture is missing.
#[allow(clippy::expect_used)] // a bench needs its fixture
pub fn kraz() -> Vehicle {
    Vehicle::load(fixture("vehicles/kraz.toml")).expect("a good vehicle file")
}

/// The rows of the independent truck's drive (330 s at 50 Hz).
///
/// # Panics
/// If the fixture is missing.
#[allow(clippy::expect_used)]
pub fn drive() -> Vec<LogRow> {
    let path = fixture("logs/F_drive1_p15_h155.csv.gz");
    let mut reader = LogReader::open(&path, &LogOptions::default()).expect("a good log");
    std::iter::from_fn(|| reader.next_row().expect("a good row")).collect()
}

/// Repeats the drive with increasing time until the file has `rows` rows at 50 or 100 Hz (by linear interpolation
/// between its rows), in seven columns as a logger writes them. Returns its path in the system's temporary folder.
///
/// # Errors
/// If the file cannot be written.
pub fn long_log(rows: usize, rate_hz: usize) -> std::io::Result<PathBuf> {
    let path = std::env::temp_dir().join(format!("cg-bench-{rows}-{rate_hz}.csv"));
    let drive = drive();
    let per_row = rate_hz / 50;
    let mut out = BufWriter::with_capacity(1 << 20, File::create(&path)?);
    writeln!(
        out,
        "time_s,steer_rad,roll_rad,speed_mps,lateral_acceleration_mps2,yaw_rate_radps,trailer_mass_kg"
    )?;
    for k in 0..rows {
        let [row, next] = [0, 1].map(|more| &drive[(k / per_row + more) % drive.len()]);
        #[allow(clippy::cast_precision_loss)]
        let (time_s, share) = (k as f64 / rate_hz as f64, (k % per_row) as f64 / per_row as f64);
        let at = |of: fn(&LogRow) -> f64| of(row) + share * (of(next) - of(row));
        writeln!(
            out,
            "{time_s:.2},{:.6},{:.7},{:.4},{:.4},{:.6},{:.0}",
            at(|row| row.steer_rad),
            at(|row| row.roll_rad),
            at(|row| row.speed_mps),
            at(|row| row.lateral_acceleration_mps2),
            at(|row| row.yaw_rate_radps),
            at(|row| row.trailer_mass_kg)
        )?;
    }
    out.flush()?;
    Ok(path)
}
