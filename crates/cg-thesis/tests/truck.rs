//! The independent truck: its recorded steer angle and speed drive the plant of `kraz.toml`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use std::path::PathBuf;

use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::log::{LogOptions, LogReader, LogRow};
use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_thesis::study::{Recorded, Replayed, drive_again};
use cg_vehicle::{Load, Vehicle, VehicleError};

struct Truth {
    log: String,
    load: Load,
    bank_rad: f64,
}

fn logs() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/logs"))
}

fn truths() -> Vec<Truth> {
    let text = std::fs::read_to_string(logs().join("truth.json")).unwrap();
    let entries: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    let steps = entries.iter().filter(|e| e["maneuver"]["type"] == "rounded_step");
    steps
        .map(|entry| Truth {
            log: entry["log"].as_str().unwrap().to_owned(),
            load: Load {
                trailer_mass_kg: entry["trailer_mass_kg"].as_f64().unwrap(),
                cg_height_m: entry["height_m"].as_f64().unwrap(),
            },
            bank_rad: entry["maneuver"]["bank_deg"].as_f64().unwrap().to_radians(),
        })
        .collect()
}

/// Mean of the last two seconds minus that of the first two.
fn steady(rows: &[LogRow], of: &[f64]) -> f64 {
    let end_s = rows[rows.len() - 1].time_s;
    let mean = |from_s: f64, to_s: f64| {
        let inside: Vec<f64> = rows
            .iter()
            .zip(of)
            .filter(|(row, _)| row.time_s >= from_s && row.time_s <= to_s)
            .map(|(_, value)| *value)
            .collect();
        #[allow(clippy::cast_precision_loss)] // hundreds
        let n = inside.len() as f64;
        inside.iter().sum::<f64>() / n
    };
    mean(end_s - 2.0, end_s) - mean(0.0, 1.9)
}

/// Errors of steady-state roll, steady-state lateral acceleration and their ratio, and the rms error of
/// roll over time relative to the steady-state roll.
fn replay(vehicle: &Vehicle, truth: &Truth) -> [f64; 4] {
    let reader = LogReader::open(&logs().join(&truth.log), &LogOptions::default()).unwrap();
    let rows = reader.collect::<Result<_, _>>().unwrap();
    let known = KnownLog {
        log: truth.log.clone(),
        load: KnownLoad::exact(truth.load.cg_height_m, Some(truth.load.trailer_mass_kg)),
    };
    let log = Recorded { known, rows };
    let options = PlantOptions { bank_rad: truth.bank_rad, ..PlantOptions::default() };
    let Replayed { roll_rad: roll, lateral_mps2: lateral } =
        drive_again(vehicle, &log, &options).unwrap();
    let rows = log.rows;
    let theirs: Vec<f64> = rows.iter().map(|row| row.roll_rad).collect();
    let their_lateral: Vec<f64> = rows.iter().map(|row| row.lateral_acceleration_mps2).collect();
    let size = steady(&rows, &theirs);
    let square: f64 =
        roll.iter().zip(&theirs).map(|(a, b)| (a - b - (roll[0] - theirs[0])).powi(2)).sum();
    #[allow(clippy::cast_precision_loss)] // thousands
    let rms = (square / rows.len() as f64).sqrt() / size.abs();
    let by_roll = steady(&rows, &roll) / size;
    let by_lateral = steady(&rows, &lateral) / steady(&rows, &their_lateral);
    println!(
        "{:24} straight {:+.5} {:+.5}, steady {:.5} {:.5} rad: {:+.1} %; a_y {:+.1} %, roll/a_y {:+.1} %; rms {:.1} %",
        truth.log,
        roll[0],
        theirs[0],
        steady(&rows, &roll),
        size,
        100.0 * (by_roll - 1.0),
        100.0 * (by_lateral - 1.0),
        100.0 * (by_roll / by_lateral - 1.0),
        100.0 * rms
    );
    [by_roll - 1.0, by_lateral - 1.0, by_roll / by_lateral - 1.0, rms]
}

/// Uncalibrated, roll per lateral acceleration is within the 3.5 % of the linear model's steady-state
/// gains plus half of that. The truck understeers more than the tabulated tires (8 to 15 % less lateral
/// acceleration for a steer angle, growing with the load). The roll angle at equal steer is therefore
/// too great by the error of the steer channel without calibration.
#[test]
fn steady_roll_of_the_independent_truck() {
    let vehicle = common::vehicle("kraz.toml");
    let errors: Vec<_> = truths().iter().map(|truth| replay(&vehicle, truth)).collect();
    println!(
        "rms: roll at equal steer {:.3}, lateral {:.3}, roll/lateral {:.3}",
        rms(&errors, 0),
        rms(&errors, 1),
        rms(&errors, 2)
    );
    assert!(rms(&errors, 2) < 0.05, "{}", rms(&errors, 2));
    assert!(rms(&errors, 0) < 0.18, "{}", rms(&errors, 0));
}

/// Calibrated on the empty and one loaded log (tires and springs adjusted within their documented
/// uncertainty), the plant's steady-state roll angle is within 5 % of every log.
#[test]
fn calibrated_the_plant_rolls_as_the_independent_truck_does() {
    let vehicle = common::vehicle("kraz.toml");
    let truths = truths();
    let known: Vec<KnownLog> = ["A_p00", "A_p20_h190"]
        .iter()
        .filter_map(|name| truths.iter().find(|truth| truth.log.starts_with(name)))
        .map(|truth| KnownLog {
            log: truth.log.clone(),
            load: KnownLoad::exact(truth.load.cg_height_m, None),
        })
        .collect();
    let calibration = calibrate::<VehicleError>(
        &vehicle,
        CalibrateOptions::default(),
        &known,
        |known, estimator| {
            let rows = LogReader::open(&logs().join(&known.log), &LogOptions::default()).unwrap();
            for row in rows {
                estimator.push(&row.unwrap()).unwrap();
            }
            Ok(())
        },
    )
    .unwrap();
    let calibrated = calibration.belief().applied_to(&vehicle);
    let gain = calibration.compensation.steer;
    for truth in &truths {
        let [roll, ..] = replay(&calibrated, truth);
        let error = gain * (1.0 + roll) - 1.0;
        assert!(error.abs() < 0.05, "{}: {error}", truth.log);
    }
}

fn rms(errors: &[[f64; 4]], of: usize) -> f64 {
    #[allow(clippy::cast_precision_loss)] // nine
    let n = errors.len() as f64;
    (errors.iter().map(|error| error[of] * error[of]).sum::<f64>() / n).sqrt()
}

/// Without steering (straight ahead on a bank of 2 degrees) the roll angle agrees within 5 %.
#[test]
fn straight_on_a_bank_the_independent_truck_rolls_as_much() {
    let truth = truths().into_iter().find(|truth| truth.bank_rad > 0.0).unwrap();
    let reader = LogReader::open(&logs().join(&truth.log), &LogOptions::default()).unwrap();
    let rows: Vec<LogRow> = reader.take(150).collect::<Result<_, _>>().unwrap();
    #[allow(clippy::cast_precision_loss)] // 150
    let theirs = rows.iter().map(|row| row.roll_rad).sum::<f64>() / rows.len() as f64;
    let options = PlantOptions { bank_rad: truth.bank_rad, ..PlantOptions::default() };
    let plant = YawRollPlant::new(&common::vehicle("kraz.toml"), truth.load, &options).unwrap();
    let ours = plant.start(rows[0].speed_mps).unwrap().sample().trailer.roll_rad;
    // The drive torque rolls the truck by -0.0003 rad on any straight road (fixtures/logs).
    println!("{ours:.5} rad, {:.5} rad without the drive torque", theirs + 0.0003);
    assert!((ours / (theirs + 0.0003) - 1.0).abs() < 0.05, "{ours} {theirs}");
}
