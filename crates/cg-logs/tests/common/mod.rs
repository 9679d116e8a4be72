//! The logs of the independent truck and their known data.
#![allow(dead_code, unused_imports, clippy::unwrap_used)] // each test file uses its part

use cg_core::{AlignSettings, Channel, Design, Measured};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_vehicle::belief::{Belief, Deviations};
use cg_vehicle::calibration::{Calibration, Run};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, Normal};

#[path = "../../../cg-vehicle/tests/common/mod.rs"]
mod trucks;
pub(crate) use trucks::*;

pub(crate) struct Known {
    folder: &'static str,
    pub(crate) log: String,
    pub(crate) load: Load,
    pub(crate) axle_load_n: Vec<f64>,
}

impl Known {
    pub(crate) fn rows(&self) -> Vec<LogRow> {
        let path = fixtures().join(self.folder).join(&self.log);
        let reader = LogReader::open(&path, &LogOptions::default()).unwrap();
        reader.map(Result::unwrap).collect()
    }

    /// The log at 50 Hz with white noise: 30 dB of the roll angle, 2 mrad of the steer angle, 0.1 m/s², 3 mrad/s and 0.05 m/s.
    pub(crate) fn noisy(&self, seed: u64) -> Vec<LogRow> {
        let mut rng = StdRng::seed_from_u64(seed);
        let mut rows: Vec<LogRow> = self.rows().into_iter().step_by(2).collect();
        #[allow(clippy::cast_precision_loss)]
        let number = rows.len() as f64;
        let mean = rows.iter().map(|row| row.roll_rad).sum::<f64>() / number;
        let variance = rows.iter().map(|row| (row.roll_rad - mean).powi(2)).sum::<f64>() / number;
        let normal = Normal::new(0.0, 1.0).unwrap();
        for row in &mut rows {
            let mut add = |value: &mut f64, sd: f64| *value += sd * normal.sample(&mut rng);
            add(&mut row.roll_rad, (variance * 1e-3).sqrt());
            add(&mut row.steer_rad, 0.002);
            add(&mut row.lateral_acceleration_mps2, 0.1);
            add(&mut row.yaw_rate_radps, 0.003);
            add(&mut row.speed_mps, 0.05);
        }
        rows
    }

    /// Options with its trailer mass, which not every log has.
    pub(crate) fn weighed(&self) -> EstimateOptions {
        EstimateOptions {
            trailer_mass_kg: Some(self.load.trailer_mass_kg),
            ..EstimateOptions::default()
        }
    }

    pub(crate) fn feed(&self, estimator: &mut LogEstimator) {
        for row in self.rows() {
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
        let mut estimator = LogEstimator::from_design(design, AlignSettings::NONE, options);
        self.feed(&mut estimator);
        estimator.finish()
    }
}

/// The logs of the first independent truck.
pub(crate) fn known() -> Vec<Known> {
    known_in("logs")
}

/// The logs of a folder in the fixtures.
pub(crate) fn known_in(folder: &'static str) -> Vec<Known> {
    let text = std::fs::read_to_string(fixtures().join(folder).join("truth.json")).unwrap();
    let entries: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    let number = |entry: &serde_json::Value, key: &str| entry[key].as_f64().unwrap();
    entries
        .iter()
        .map(|entry| {
            let loads = &entry["static_axle_load_n"];
            let unit = |name: &str| loads[name].as_array().unwrap().clone();
            Known {
                folder,
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

/// The calibration of the truck on these runs.
pub(crate) fn calibrated(vehicle: &Vehicle, runs: &[&Known]) -> Calibration {
    let logs: Vec<KnownLog> = runs
        .iter()
        .map(|known| KnownLog {
            log: known.log.clone(),
            load: KnownLoad::exact(known.load.cg_height_m, Some(known.load.trailer_mass_kg)),
        })
        .collect();
    calibrate::<VehicleError>(vehicle, CalibrateOptions::default(), &logs, |log, estimator| {
        let known = runs.iter().find(|known| known.log == log.log).unwrap();
        known.feed(estimator);
        Ok(())
    })
    .unwrap()
}

/// Runs of a truck whose parameters differ from its file, as exact ratios at some loads and speeds.
pub(crate) fn runs_of(
    vehicle: &Vehicle,
    truth: &Deviations,
    loads: &[(f64, f64, f64)],
) -> Vec<Run> {
    let belief = Belief { mean: *truth, ..Belief::prior(vehicle) };
    let truck = belief.applied_to(vehicle);
    loads
        .iter()
        .map(|&(trailer_mass_kg, cg_height_m, speed_mps)| {
            let load = Load { trailer_mass_kg, cg_height_m };
            let lines = ratio_line(&truck, Variant::Complete, speed_mps, load).unwrap();
            let ratio = Channel::ALL.map(|channel| {
                let gain = belief.gain(channel);
                let value = gain * lines[channel.index()].ratio_at(cg_height_m);
                Some(Measured { value, sd: 1e-4 * value })
            });
            Run {
                log: format!("{trailer_mass_kg} kg"),
                load,
                height_sd_m: 0.0,
                trailer_mass_sd_kg: 0.0,
                speed_mps,
                turn_g: None,
                ratio,
                lift_axle: LiftAxle::Down,
                age_s: None,
            }
        })
        .collect()
}
