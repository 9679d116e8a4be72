//! The independent truck's logs with the nominal vehicle file: no calibration, both channels.

use std::path::PathBuf;

use cg_core::Channel;
use cg_vehicle::balance::static_balance;
use cg_vehicle::estimate::{EstimateOptions, LogEstimate, LogEstimator, Method};
use cg_vehicle::log::{LogOptions, LogReader};
use cg_vehicle::{Load, Vehicle};

fn fixtures() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures"))
}

struct Known {
    log: String,
    height_m: f64,
    trailer_mass_kg: f64,
    axle_load_n: Vec<f64>,
}

fn known() -> Vec<Known> {
    let text = std::fs::read_to_string(fixtures().join("logs/truth.json")).unwrap();
    let entries: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    entries
        .iter()
        .map(|entry| {
            let loads = &entry["static_axle_load_n"];
            let unit = |name: &str| loads[name].as_array().unwrap().clone();
            Known {
                log: entry["log"].as_str().unwrap().to_owned(),
                height_m: entry["height_m"].as_f64().unwrap(),
                trailer_mass_kg: entry["trailer_mass_kg"].as_f64().unwrap(),
                axle_load_n: unit("tractor")
                    .iter()
                    .chain(&unit("trailer"))
                    .map(|load| load.as_f64().unwrap())
                    .collect(),
            }
        })
        .collect()
}

fn kraz() -> Vehicle {
    Vehicle::load(fixtures().join("vehicles/kraz.toml")).unwrap()
}

fn estimate(known: &Known, options: EstimateOptions) -> LogEstimate {
    let path = fixtures().join("logs").join(&known.log);
    let mut reader = LogReader::open(&path, &LogOptions::default()).unwrap();
    let mut estimator = LogEstimator::new(&kraz(), options).unwrap();
    while let Some(row) = reader.next_row().unwrap() {
        estimator.push(&row).unwrap();
    }
    estimator.finish()
}

/// Axle loads of six independently sprung axles: springs, tyres and frame pitch decide.
#[test]
fn static_loads_agree_with_the_multibody_model() {
    for known in known() {
        let load = Load { trailer_mass_kg: known.trailer_mass_kg, cg_height_m: known.height_m };
        let ours = static_balance(&kraz(), load).unwrap();
        for (ours, theirs) in ours.axle_load_n.iter().zip(&known.axle_load_n) {
            println!("{}: {ours:.0} N, {theirs:.0} N", known.log);
        }
    }
}

fn errors(channel: Channel, method: Method) -> Vec<(String, f64)> {
    known()
        .iter()
        .map(|known| {
            let options = EstimateOptions { channel: Some(channel), method, ..Default::default() };
            let estimate = estimate(known, options);
            let height_m = estimate.height_m.unwrap_or(f64::NAN);
            println!(
                "{:28} {channel:20} {:.3} m of {:.3} m, {:+.2} % ± {:.2} %, {} maneuvers {:?} {:?}",
                known.log,
                height_m,
                known.height_m,
                100.0 * (height_m / known.height_m - 1.0),
                100.0 * estimate.height_sd_m.unwrap_or(f64::NAN) / known.height_m,
                estimate.maneuvers.len(),
                estimate.ratio,
                estimate.messages,
            );
            (known.log.clone(), height_m / known.height_m - 1.0)
        })
        .collect()
}

#[test]
fn heights_without_calibration() {
    for method in [Method::Filtered, Method::Gain, Method::Arx] {
        for channel in Channel::ALL {
            println!("{method:?}");
            errors(channel, method);
        }
    }
}
