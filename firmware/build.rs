//! Converts the logs to bytes: each row is its time (µs) and six signals in single precision,
//! little-endian. Also copies the linker scripts.

use std::env;
use std::error::Error;
use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;

/// Played one after the other, with a stop between them in which the load changes.
const LOGS: [&str; 2] = ["A_p20_h190_v50_L.csv", "F_drive1_p15_h155.csv.gz"];
const STOP_US: u32 = 100_000_000;
const COLUMNS: &str =
    "time_s,steer_rad,roll_rad,speed_mps,lateral_acceleration_mps2,yaw_rate_radps,trailer_mass_kg";

fn main() -> Result<(), Box<dyn Error>> {
    let out = env::var("OUT_DIR")?;
    let (mut bytes, mut last_us) = (Vec::new(), 0_u32);
    for (k, name) in LOGS.iter().enumerate() {
        let path = Path::new("../fixtures/logs").join(name);
        println!("cargo:rerun-if-changed={}", path.display());
        let start_us = if k == 0 { 0 } else { last_us + STOP_US };
        let text = text(&path)?;
        let mut lines = text.lines();
        if lines.next() != Some(COLUMNS) {
            return Err(format!("{}: the columns are not {COLUMNS}", path.display()).into());
        }
        for line in lines {
            let values = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let [time_s, signals @ ..] = &values[..] else { continue };
            last_us = start_us + micros(*time_s);
            bytes.extend(last_us.to_le_bytes());
            for signal in signals {
                bytes.extend(narrow(*signal).to_le_bytes());
            }
        }
    }
    fs::write(Path::new(&out).join("log.bin"), &bytes)?;
    let text = format!(
        "/// The logs.\n#[allow(clippy::unreadable_literal)]\n\
         #[cfg_attr(target_os = \"none\", unsafe(link_section = \".fixture\"))]\n\
         static LOG: [u8; {}] = *include_bytes!(concat!(env!(\"OUT_DIR\"), \"/log.bin\"));\n",
        bytes.len()
    );
    fs::write(Path::new(&out).join("log.rs"), text)?;
    for script in ["memory.x", "fixture.x"] {
        fs::copy(script, Path::new(&out).join(script))?;
        println!("cargo:rerun-if-changed={script}");
    }
    println!("cargo:rustc-link-search={out}");
    Ok(())
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // minutes
fn micros(time_s: f64) -> u32 {
    (time_s * 1e6).round() as u32
}

#[allow(clippy::cast_possible_truncation)] // to single precision, once
fn narrow(value: f64) -> f32 {
    value as f32
}

fn text(path: &Path) -> Result<String, Box<dyn Error>> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut text = String::new();
    if path.extension().is_some_and(|extension| extension == "gz") {
        GzDecoder::new(&bytes[..]).read_to_string(&mut text)?;
    } else {
        text = String::from_utf8(bytes)?;
    }
    Ok(text)
}
