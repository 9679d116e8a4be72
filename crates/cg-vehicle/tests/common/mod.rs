//! The independent truck's logs and what is known of them.
#![allow(dead_code, clippy::unwrap_used)] // each test file uses its part

use std::path::PathBuf;

use cg_core::{Channel, Design};
use cg_vehicle::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_vehicle::log::{LogOptions, LogReader};
use cg_vehicle::{Load, Vehicle};

pub(crate) fn fixtures() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures"))
}

pub(crate) fn vehicle(name: &str) -> Vehicle {
    Vehicle::load(fixtures().join("vehicles").join(name)).unwrap()
}

pub(crate) struct Known {
    pub(crate) log: String,
    pub(crate) load: Load,
    pub(crate) axle_load_n: Vec<f64>,
}

impl Known {
    pub(crate) fn feed(&self, estimator: &mut LogEstimator) {
        let path = fixtures().join("logs").join(&self.log);
        let mut reader = LogReader::open(&path, &LogOptions::default()).unwrap();
        while let Some(row) = reader.next_row().unwrap() {
            estimator.push(&row).unwrap();
        }
    }

    pub(crate) fn estimate(
        &self,
        design: &Design<f64>,
        channel: Option<Channel>,
        options: EstimateOptions,
    ) -> LogEstimate {
        let options = EstimateOptions { channel, ..options };
        let mut estimator = LogEstimator::from_design(design, None, options);
        self.feed(&mut estimator);
        estimator.finish()
    }
}

pub(crate) fn known() -> Vec<Known> {
    let text = std::fs::read_to_string(fixtures().join("logs/truth.json")).unwrap();
    let entries: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    let number = |entry: &serde_json::Value, key: &str| entry[key].as_f64().unwrap();
    entries
        .iter()
        .map(|entry| {
            let loads = &entry["static_axle_load_n"];
            let unit = |name: &str| loads[name].as_array().unwrap().clone();
            Known {
                log: entry["log"].as_str().unwrap().to_owned(),
                load: Load {
                    trailer_mass_kg: number(entry, "trailer_mass_kg"),
                    cg_height_m: number(entry, "height_m"),
                },
                axle_load_n: unit("tractor")
                    .iter()
                    .chain(&unit("trailer"))
                    .map(|load| load.as_f64().unwrap())
                    .collect(),
            }
        })
        .collect()
}

pub(crate) fn rms(errors: &[f64]) -> f64 {
    #[allow(clippy::cast_precision_loss)] // a few logs
    let n = errors.len() as f64;
    (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt()
}

pub(crate) fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, e| e.abs().max(most))
}
