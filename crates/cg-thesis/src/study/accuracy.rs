//! Errors and intervals over noise, payload, height and time, as a study with its figure.

use super::data::{Abscissa, Panel, Quantity, Series, Study, Unit};
use super::setting::Setting;
use crate::accuracy::{Experiment, Score};
use cg_core::Design;
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Vehicle};

/// Number of runs for each point: an RMSE scatters by 4 %.
const RUNS: u32 = 300;
/// Noise in panels in which it is not varied, dB.
const SNR_DB: f64 = 20.0;
/// Lateral acceleration of the turn whose first seconds are studied, in g.
const TURN_G: f64 = 0.15;
/// Default amplitude of the scenario, in g.
const USUAL_G: f64 = 0.17;
/// Straight driving before that turn, s.
const BEFORE_S: f64 = 4.0;

const ERROR: Quantity =
    Quantity { name: "relative_to_height", label: "Of the height", unit: Unit::One };

/// The study.
pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let vehicle = &setting.vehicle;
    let turn = |load: Load, snr_db: f64| {
        let sensors = Sensors { snr_db: Some(snr_db), ..Sensors::default() };
        Scenario { load, sensors, ..Scenario::of(vehicle, Maneuver::RoundedStep) }
    };
    let reference = vehicle.reference_load();
    let known = (vehicle, &design(vehicle, turn(reference, SNR_DB).variant)?);
    let snr = points(known, &[5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0], |snr_db| {
        turn(reference, snr_db)
    })?;
    let empty_kg = vehicle.empty_trailer_mass_kg();
    let payload_kg: Vec<f64> = (1..=5).map(|k| 5e3 * f64::from(k)).collect();
    let payload = points(known, &payload_kg, |payload_kg| {
        let load = Load { trailer_mass_kg: empty_kg + payload_kg, ..reference };
        noise_as_under(vehicle, turn(load, SNR_DB), reference)
    })?;
    let heights: Vec<f64> = (0..6).map(|k| 1.5 + 0.15 * f64::from(k)).collect();
    let height = points(known, &heights, |cg_height_m| {
        let load = Load { cg_height_m, ..reference };
        noise_as_under(vehicle, turn(load, SNR_DB), reference)
    })?;
    let seconds: Vec<f64> = vec![1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 7.0, 10.0];
    let whole = LogSimulation::new(vehicle, turn(reference, SNR_DB))?.truth;
    let until = |since_s: f64| Scenario {
        start_s: BEFORE_S,
        duration_s: BEFORE_S + since_s,
        steer_rad: Some(TURN_G / USUAL_G * whole.steer_rad),
        ..turn(reference, SNR_DB)
    };
    let time = points(known, &seconds, |since_s| {
        let mut scenario = until(since_s);
        // The noise is that of the whole turn, although the log ends earlier.
        let noise_rad = LogSimulation::new(vehicle, scenario).map(|log| log.truth.noise_sd_rad);
        let louder = noise_rad.map_or(1.0, |noise_rad| noise_rad / whole.noise_sd_rad);
        scenario.sensors.snr_db = Some(SNR_DB + 20.0 * libm::log10(louder));
        scenario
    })?;
    let soon = good(&time).find(|(_, score)| score.rmse < 0.03).map(|(since_s, _)| *since_s);
    Ok(Study {
        name: setting.name,
        finding: match soon {
            Some(since_s) => format!(
                "With noise of 20 dB the error is 3 % of the height {since_s:.1} s after the start of a \
                 turn of 0.15 g"
            ),
            None => {
                "With noise of 20 dB the error is more than 3 % of the height after 10 s".to_owned()
            }
        },
        scenario: conditions(vehicle),
        panels: panels([&snr, &payload, &height, &time]),
        statements: Vec::new(),
    })
}

fn conditions(vehicle: &Vehicle) -> Vec<String> {
    vec![
        format!("vehicle: {}, linear model", vehicle.name),
        format!("{RUNS} rounded steps of 0.17 g for each point, 100 Hz, 20 s"),
        "where the noise is not varied: 20 dB with the reference load, and the same noise with \
         other loads"
            .to_owned(),
        "bound: Cramér-Rao, everything known except the height and the sensor's offset".to_owned(),
        "only the part of the interval that noise causes; the uncertainty of model and \
         calibration is added to it"
            .to_owned(),
    ]
}

/// Scores over noise, payload, height and time.
fn panels([snr, payload, height, time]: [&[(f64, Score)]; 4]) -> Vec<Panel> {
    let panel = |title, quantity, points: &[(f64, Score)]| Panel {
        figure: "",
        title,
        x: Abscissa::Over(quantity),
        y: ERROR,
        series: series(points),
    };
    let x = |name, label, unit| Quantity { name, label, unit };
    vec![
        panel("Over the noise", x("snr", "Signal to noise", Unit::Decibel), snr),
        panel("Over the payload", x("payload", "Payload", Unit::Kilogram), payload),
        panel("Over the height", x("cg_height", "C.g. height", Unit::Meter), height),
        panel("Over time", x("since", "Since the start of the turn", Unit::Second), time),
    ]
}

/// The same sensor under another load: the noise is the same, not its ratio to the signal.
fn noise_as_under(vehicle: &Vehicle, scenario: Scenario, reference: Load) -> Scenario {
    let roll = |load: Load| {
        let lines =
            cg_vehicle::linear::ratio_line(vehicle, scenario.variant, scenario.speed_mps, load);
        lines.map_or(1.0, |lines| lines[1].ratio_at(load.cg_height_m))
    };
    let louder_db = 20.0 * libm::log10(roll(scenario.load) / roll(reference));
    let snr_db = scenario.sensors.snr_db.map(|snr_db| snr_db + louder_db);
    Scenario { sensors: Sensors { snr_db, ..scenario.sensors }, ..scenario }
}

/// The scores of a vehicle, with its design, in some scenarios.
fn points(
    (vehicle, design): (&Vehicle, &Design<f64>),
    values: &[f64],
    scenario: impl Fn(f64) -> Scenario,
) -> Result<Vec<(f64, Score)>, VehicleError> {
    let score = |&value: &f64| {
        let experiment = Experiment { runs: RUNS, ..Experiment::of(scenario(value)) };
        Ok((value, experiment.score_with(vehicle, design)?))
    };
    values.iter().map(score).collect()
}

/// The points at which most runs give a height.
fn good(points: &[(f64, Score)]) -> impl Iterator<Item = &(f64, Score)> {
    points.iter().filter(|(_, score)| 2 * score.answered > RUNS)
}

/// Error, stated standard deviation and bound of the [good] points.
fn series(points: &[(f64, Score)]) -> Vec<Series> {
    let of = |value: fn(&Score) -> f64| good(points).map(|(x, score)| [*x, value(score)]).collect();
    vec![
        Series::new("root mean square error", 0, of(|score| score.rmse)),
        Series::new("stated standard deviation", 1, of(|score| score.stated_sd)),
        Series::new("bound", 2, of(|score| score.bound)).aside(),
    ]
}
