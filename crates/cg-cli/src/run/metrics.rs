//! Counters and results as a text file for the node exporter of Prometheus.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use cg_output::{Draft, Target};

use super::events::{Latency, Status};

/// Writes a new file, which replaces the previous one completely.
pub(crate) fn write(target: &Target, status: &Status, latency: Option<Latency>) -> io::Result<()> {
    let (draft, mut file) = target.open()?;
    file.write_all(text(status, latency).as_bytes())?;
    draft.map_or(Ok(()), Draft::publish)
}

#[allow(clippy::cast_precision_loss)] // counters: exact up to 2^53
fn text(status: &Status, latency: Option<Latency>) -> String {
    let (result, counters) = (&status.result, &status.counters);
    let of = |pick: fn(&Latency) -> f64| latency.as_ref().map(|latency| pick(latency) * 1e-3);
    let present = if status.missing.is_empty() { 1.0 } else { 0.0 };
    let rows: [(&str, &str, &str, Option<f64>); 16] = [
        ("height_metres", "gauge", "c.g. height of the trailer's sprung mass", result.height_m),
        ("height_sd_metres", "gauge", "standard deviation of the height", result.height_sd_m),
        (
            "rollover_threshold_g",
            "gauge",
            "static rollover threshold at this height",
            result.static_rollover_threshold_g,
        ),
        ("margin_g", "gauge", "threshold minus the present lateral acceleration", status.margin_g),
        ("warning_level", "gauge", "rollover warning level", Some(status.warning_level as f64)),
        ("trailer_mass_kilograms", "gauge", "trailer mass used", Some(result.trailer_mass_kg)),
        ("maneuvers", "gauge", "maneuvers used for the height", Some(f64::from(result.maneuvers))),
        ("signals_present", "gauge", "1 if no signal is missing, otherwise 0", Some(present)),
        ("samples_total", "counter", "samples processed", Some(status.samples as f64)),
        ("frames_total", "counter", "frames received", Some(counters.frames as f64)),
        (
            "frames_lost_total",
            "counter",
            "frames dropped by the kernel",
            Some(counters.frames_lost as f64),
        ),
        (
            "malformed_total",
            "counter",
            "frames or lines that are not valid",
            Some(counters.malformed as f64),
        ),
        (
            "error_frames_total",
            "counter",
            "error frames on the bus",
            Some(counters.error_frames as f64),
        ),
        ("latency_p50_seconds", "gauge", "median delay of a frame", of(|latency| latency.p50)),
        ("latency_p99_seconds", "gauge", "99th percentile of the delay", of(|latency| latency.p99)),
        ("latency_max_seconds", "gauge", "greatest delay", of(|latency| latency.greatest)),
    ];
    let mut text = String::new();
    for (name, kind, help, value) in rows {
        if let Some(value) = value {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "# HELP cg_{name} {help}\n# TYPE cg_{name} {kind}\ncg_{name} {value}"
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::events::{Counters, Result};

    #[test]
    fn every_counter_stands_under_its_own_name() {
        let counters = Counters {
            frames: 7,
            frames_lost: 3,
            malformed: 2,
            error_frames: 5,
            ..Counters::default()
        };
        let status = Status {
            state: "straight",
            present: Vec::new(),
            missing: Vec::new(),
            result: Result::default(),
            load_since_s: None,
            height_restored: false,
            lateral_acceleration_g: None,
            margin_g: None,
            warning_level: 0,
            requests_speed: false,
            requested_speed_mps: None,
            samples: 11,
            counters,
        };
        let text = text(&status, None);
        for line in [
            "cg_frames_total 7",
            "cg_frames_lost_total 3",
            "cg_malformed_total 2",
            "cg_error_frames_total 5",
            "cg_samples_total 11",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}: {text}");
        }
    }
}
