//! Recorded logs driven again: the plant is driven with a log's steer angle and speed, and its roll angle
//! and lateral acceleration are compared with the recorded ones.

use super::data::{Abscissa, Panel, Quantity, Series, Study, Unit};
use cg_logs::calibrate::KnownLog;
use cg_logs::log::LogRow;
use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_vehicle::calibration::Calibration;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Vehicle};

/// A recorded log whose load is known.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Its name and load.
    pub known: KnownLog,
    /// Its rows; absent steer angles and speeds keep the previous value.
    pub rows: Vec<LogRow>,
}

/// The response of the plant to a log, sample by sample.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// Roll angle of the semitrailer, rad.
    pub roll_rad: Vec<f64>,
    /// Its lateral acceleration, m/s².
    pub lateral_mps2: Vec<f64>,
}

/// Drives a log again through the plant.
///
/// # Errors
/// [`VehicleError`] if the log has no rows, no trailer mass is known, the vehicle cannot be
/// simulated, or if it rolls over.
pub fn drive_again(
    vehicle: &Vehicle,
    log: &Recorded,
    options: &PlantOptions,
) -> Result<Replayed, VehicleError> {
    let name = &log.known.log;
    let known = |of: fn(&LogRow) -> f64| log.rows.iter().map(of).find(|value| value.is_finite());
    let none = |what: &str| VehicleError::Model(format!("{name}: no row has {what}"));
    let cg_height_m = log.known.load.height_m(vehicle).value;
    let mass_kg = log.known.load.trailer_mass(vehicle).map(|mass| mass.kg);
    let trailer_mass_kg = mass_kg
        .or_else(|| known(|row| row.trailer_mass_kg))
        .ok_or_else(|| none("the trailer's mass; give it after the height"))?;
    let mut steer_rad = known(|row| row.steer_rad).ok_or_else(|| none("a steer angle"))?;
    let mut speed_mps = known(|row| row.speed_mps).ok_or_else(|| none("a speed"))?;
    let load = Load { trailer_mass_kg, cg_height_m };
    let plant = YawRollPlant::new(vehicle, load, options)?;
    let mut run = plant.start(speed_mps)?;
    let (mut roll_rad, mut lateral_mps2) = (Vec::new(), Vec::new());
    let mut time_s = log.rows[0].time_s;
    for row in &log.rows {
        steer_rad = if row.steer_rad.is_finite() { row.steer_rad } else { steer_rad };
        speed_mps = if row.speed_mps.is_finite() { row.speed_mps } else { speed_mps };
        if row.time_s > time_s {
            run.push(steer_rad, speed_mps, row.time_s - time_s);
            time_s = row.time_s;
        }
        run.upright()?;
        let sample = run.sample();
        roll_rad.push(sample.trailer.roll_rad);
        lateral_mps2.push(sample.trailer.lateral_acceleration_mps2);
    }
    Ok(Replayed { roll_rad, lateral_mps2 })
}

/// The study of some logs. With a calibration the plant has its parameters and roll gain.
///
/// # Errors
/// As [`drive_again`].
pub fn replay(
    vehicle: &Vehicle,
    calibration: Option<&Calibration>,
    logs: &[Recorded],
) -> Result<Study, VehicleError> {
    let (vehicle, gain) = match calibration {
        Some(found) => (found.belief().applied_to(vehicle), found.compensation.steer),
        None => (vehicle.clone(), 1.0),
    };
    let as_is = if calibration.is_some() { "calibrated" } else { "as documented" };
    let mut scenario = vec![format!("vehicle: {}, {as_is}", vehicle.name)];
    let mut panels = [
        ("Roll angle of the semitrailer", "roll", Unit::Radian),
        ("Its lateral acceleration", "lateral_acceleration", Unit::MeterPerSecondSquared),
    ]
    .map(|(label, name, unit)| Panel {
        figure: "",
        title: "recorded (solid) and driven again by the plant (dashed)",
        x: Abscissa::Over(Quantity { name: "time", label: "Time", unit: Unit::Second }),
        y: Quantity { name, label, unit },
        series: Vec::new(),
    });
    for (kind, log) in logs.iter().enumerate() {
        let mut plant = drive_again(&vehicle, log, &PlantOptions::default())?;
        plant.roll_rad.iter_mut().for_each(|roll| *roll *= gain);
        let theirs = [
            log.rows.iter().map(|row| row.roll_rad).collect::<Vec<_>>(),
            log.rows.iter().map(|row| row.lateral_acceleration_mps2).collect(),
        ];
        let [roll, lateral] = [(&theirs[0], &plant.roll_rad), (&theirs[1], &plant.lateral_mps2)]
            .map(|(theirs, ours)| {
                compare(theirs, ours).map_or_else(|| "—".to_owned(), difference_text)
            });
        let name = &log.known.log;
        scenario.push(format!("{name}: roll {roll}; lateral acceleration {lateral}"));
        let height_m = log.known.load.height_m(&vehicle).value;
        for (panel, values) in
            panels.iter_mut().zip([(&theirs[0], plant.roll_rad), (&theirs[1], plant.lateral_mps2)])
        {
            let (recorded, ours) = (curve(&log.rows, values.0), curve(&log.rows, &values.1));
            panel.series.push(Series::new(format!("{name}, {height_m:.2} m"), kind, recorded));
            panel.series.push(Series::new("plant", kind, ours).aside());
        }
    }
    Ok(Study {
        name: "replay",
        finding: match logs {
            [one] => format!("{} driven again by the plant, {as_is}", one.known.log),
            _ => format!("{} recorded logs driven again by the plant, {as_is}", logs.len()),
        },
        scenario,
        panels: panels.into(),
        statements: Vec::new(),
    })
}

/// Slope of the plant's values over the recorded ones, and the residual relative to their spread.
fn compare(theirs: &[f64], ours: &[f64]) -> Option<[f64; 2]> {
    let pairs: Vec<[f64; 2]> =
        theirs.iter().zip(ours).filter(|(a, _)| a.is_finite()).map(|(a, b)| [*a, *b]).collect();
    #[allow(clippy::cast_precision_loss)] // thousands
    let n = pairs.len() as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|p| p[k]).sum::<f64>() / n);
    let moment = |i: usize, j: usize| -> f64 {
        pairs.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>() / n
    };
    let slope = moment(0, 1) / moment(0, 0);
    let left = (moment(1, 1) - slope * moment(0, 1)).max(0.0) / moment(1, 1);
    (slope.is_finite() && left.is_finite()).then(|| [slope, left.sqrt()])
}

fn difference_text([slope, left]: [f64; 2]) -> String {
    format!("{:+.1} %, remaining difference {:.1} %", 100.0 * (slope - 1.0), 100.0 * left)
}

/// Every fourth point that is present.
fn curve(rows: &[LogRow], values: &[f64]) -> Vec<[f64; 2]> {
    let points = rows.iter().zip(values).step_by(4);
    points.filter(|(_, v)| v.is_finite()).map(|(row, v)| [row.time_s, *v]).collect()
}
