//! Error and interval of the height over the bank of the road, for each pair of signals (no figure of
//! the thesis, which drives on a flat road).
//!
//! Drives on rural roads whose bank is multiplied, so that they differ in nothing else. The ratio of
//! suspension roll and specific force does not contain the bank. A roll angle relative to gravity
//! does, and the answer depends on what is declared of the road.

use std::ops::RangeInclusive;

use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator, RoadChoice};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadKind};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::design_with;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Variant, Vehicle, sensor_places};
use rayon::prelude::*;

use super::data::{Abscissa, Panel, Quantity, Series, Study, Unit};
use super::setting::Setting;

/// The greatest bank of the roads.
const BANKS_RAD: [f64; 8] = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07];
/// Seeds of the roads: with each bank there is one drive on each of them.
const ROADS: RangeInclusive<u64> = 1..=5;
/// Seeds of the roads of the two calibration runs.
const TRACKS: [u64; 2] = [101, 102];
/// Assumed standard deviation of an uncertain bank by its greatest value, as 0.02 rad on public roads
/// with up to 0.06 rad.
const SD_SHARE: f64 = 1.0 / 3.0;
/// Sampling rate.
const RATE_HZ: f64 = 50.0;

const BANK: Quantity =
    Quantity { name: "greatest_bank", label: "Greatest bank of the road", unit: Unit::One };
const ERROR: Quantity = Quantity { name: "error", label: "Error of the height", unit: Unit::One };

/// What is declared of the bank.
#[derive(Clone, Copy, Debug)]
enum Declared {
    Nothing,
    Flat,
    Uncertain,
}

/// One estimate from each drive.
struct Pair {
    name: &'static str,
    channel: Channel,
    declared: Declared,
}

const fn pair(name: &'static str, channel: Channel, declared: Declared) -> Pair {
    Pair { name, channel, declared }
}

/// The panels with their pairs.
const PANELS: [(&str, [Pair; 2]); 3] = [
    (
        "Suspension roll over specific force",
        [
            pair("suspension", Channel::Suspension, Declared::Nothing),
            pair("tractor", Channel::Tractor, Declared::Nothing),
        ],
    ),
    (
        "Roll to gravity, road declared flat",
        [
            pair("lateral-acceleration, flat", Channel::LateralAcceleration, Declared::Flat),
            pair("steer, flat", Channel::Steer, Declared::Flat),
        ],
    ),
    (
        "Roll to gravity, bank uncertain (×: no height)",
        [
            pair(
                "lateral-acceleration, uncertain",
                Channel::LateralAcceleration,
                Declared::Uncertain,
            ),
            pair("steer, uncertain", Channel::Steer, Declared::Uncertain),
        ],
    ),
];

/// The answer to a drive, relative to the true height.
#[derive(Clone, Copy, Debug)]
struct Answer {
    error: f64,
    interval: [f64; 2],
}

impl Answer {
    fn misses(&self) -> bool {
        self.interval[0] > 0.0 || self.interval[1] < 0.0
    }
}

/// A drive on a road.
struct Drive {
    bank_rad: f64,
    rows: Vec<LogRow>,
}

pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let vehicle = &setting.vehicle;
    let load = vehicle.reference_load();
    let design = calibrated(vehicle)?;
    let cases: Vec<(f64, u64)> =
        BANKS_RAD.iter().flat_map(|bank_rad| ROADS.map(|seed| (*bank_rad, seed))).collect();
    let pairs: Vec<&Pair> = PANELS.iter().flat_map(|(_, pairs)| pairs).collect();
    let answers: Vec<Vec<Option<Answer>>> = cases
        .par_iter()
        .map(|&(bank_rad, seed)| {
            let drive = Drive { bank_rad, rows: rows(vehicle, load, bank_rad, seed)? };
            pairs.iter().map(|pair| answer(vehicle, &design, pair, &drive)).collect()
        })
        .collect::<Result<_, VehicleError>>()?;
    let of = |k: usize| -> Vec<Vec<Option<Answer>>> {
        answers
            .chunks(ROADS.count())
            .map(|drives| drives.iter().map(|all| all[k]).collect())
            .collect()
    };
    let all: Vec<Series> = (0..).zip(&pairs).map(|(k, pair)| worst(pair, &of(k))).collect();
    let mut scenario = conditions(vehicle, load);
    scenario.extend((0..).zip(&pairs).map(|(k, pair)| counts(pair, &of(k)[1..])));
    let panels = PANELS.iter().zip(all.chunks(2)).map(|((title, _), series)| Panel {
        figure: "",
        title,
        x: Abscissa::Over(BANK),
        y: ERROR,
        series: series.to_vec(),
    });
    let [suspension, flat, uncertain] = [0, 2, 4].map(|k| off(&all[k..k + 2]));
    Ok(Study {
        name: setting.name,
        finding: format!(
            "Suspension roll over specific force is {suspension} on every bank; roll to gravity is \
             {flat} if the road is declared flat, and {uncertain} if the bank is uncertain"
        ),
        scenario,
        panels: panels.collect(),
        statements: Vec::new(),
    })
}

fn conditions(vehicle: &Vehicle, load: Load) -> Vec<String> {
    vec![
        format!("vehicle: {}, nonlinear plant", vehicle.name),
        format!(
            "semitrailer of {:.0} kg, sprung c.g. at {:.3} m",
            load.trailer_mass_kg, load.cg_height_m
        ),
        format!(
            "for each bank the drive with the greatest error of {}, on different rural roads of \
             150 s with their bank multiplied",
            ROADS.count()
        ),
        "bars: 95 % intervals, after a calibration with two drives on flat roads, empty and loaded; \
         crosses: no drive gives a height; bars are cut at ±100 %, which curves that contradict each \
         other exceed"
            .to_owned(),
        "levels: noise 0.5 mm, steps 1 mm; accelerometers: offset 0.05 m/s², noise 0.1 m/s²; roll \
         to gravity and lateral acceleration: perfect"
            .to_owned(),
        "uncertain: the assumed standard deviation of the bank is a third of its greatest value"
            .to_owned(),
    ]
}

/// The rows of a drive with usual sensors of the chassis (docs/sensors.md).
fn rows(
    vehicle: &Vehicle,
    load: Load,
    bank_rad: f64,
    seed: u64,
) -> Result<Vec<LogRow>, VehicleError> {
    let road = Road::kind(RoadKind::Rural, seed)?.banked_up_to(bank_rad);
    let scenario = Scenario {
        load,
        rate_hz: RATE_HZ,
        duration_s: road.usual_duration_s(),
        seed,
        ..Scenario::of(vehicle, Maneuver::Drive)
    };
    Ok(LogSimulation::on_road(vehicle, scenario, &road, &ChassisSensors::usual())?.rows())
}

fn push<'a>(
    estimator: &mut LogEstimator,
    rows: impl IntoIterator<Item = &'a LogRow>,
) -> Result<(), VehicleError> {
    for row in rows {
        estimator.push(row).map_err(|error| VehicleError::Model(error.to_string()))?;
    }
    Ok(())
}

/// The design after two drives with known load on flat roads.
fn calibrated(vehicle: &Vehicle) -> Result<Design<f64>, VehicleError> {
    let mut on_track = vehicle.clone();
    on_track.road = Some(sensor_places::Road { bank_sd_rad: 0.0 });
    let empty = vehicle.empty_load();
    let (mut logs, mut drives) = (Vec::new(), Vec::new());
    for (load, seed) in [empty, vehicle.reference_load()].into_iter().zip(TRACKS) {
        let (height_m, mass_kg) = (load.cg_height_m, load.trailer_mass_kg);
        let log = format!("flat road {seed}");
        let known = KnownLoad::exact(height_m, Some(mass_kg));
        logs.push(KnownLog { log, load: known });
        drives.push(rows(vehicle, load, 0.0, seed)?);
    }
    let found = calibrate(&on_track, CalibrateOptions::default(), &logs, |known, estimator| {
        let drive = logs.iter().zip(&drives).find(|(log, _)| *log == known);
        push(estimator, drive.into_iter().flat_map(|(_, rows)| rows))
    })?;
    design_with(vehicle, Variant::Complete, &found.belief())
}

fn answer(
    vehicle: &Vehicle,
    design: &Design<f64>,
    pair: &Pair,
    drive: &Drive,
) -> Result<Option<Answer>, VehicleError> {
    let bank_sd_rad = match pair.declared {
        Declared::Nothing => None,
        Declared::Flat => Some(0.0),
        Declared::Uncertain => Some(SD_SHARE * drive.bank_rad),
    };
    let options = EstimateOptions {
        channel: Some(pair.channel),
        road: bank_sd_rad.map(|bank_sd_rad| RoadChoice { bank_sd_rad }),
        ..EstimateOptions::default()
    };
    let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
    if pair.channel.feels_bank() {
        let rows: Vec<LogRow> = drive.rows.iter().map(to_gravity).collect();
        push(&mut estimator, &rows)?;
    } else {
        push(&mut estimator, &drive.rows)?;
    }
    let found = estimator.finish();
    let relative = |height_m: f64| height_m / vehicle.reference_load().cg_height_m - 1.0;
    Ok(found.height_m.zip(found.height_ci95_m).map(|(height_m, ends_m)| Answer {
        error: relative(height_m),
        interval: ends_m.map(|end_m| relative(end_m).clamp(-1.0, 1.0)),
    }))
}

/// What a truck measures whose only sensor of roll shows the angle relative to gravity.
fn to_gravity(row: &LogRow) -> LogRow {
    LogRow {
        time_s: row.time_s,
        steer_rad: row.steer_rad,
        speed_mps: row.speed_mps,
        lateral_acceleration_mps2: row.lateral_acceleration_mps2,
        trailer_mass_kg: row.trailer_mass_kg,
        roll_to_gravity_rad: row.roll_to_gravity_rad,
        ..LogRow::ABSENT
    }
}

/// The greatest error for each bank with the interval of this drive; unanswered where no drive gives
/// a height.
fn worst(pair: &Pair, answers: &[Vec<Option<Answer>>]) -> Series {
    let mut series = Series::new(pair.name, pair.channel.index(), Vec::new());
    for (bank_rad, drives) in BANKS_RAD.into_iter().zip(answers) {
        match drives.iter().flatten().max_by(|a, b| a.error.abs().total_cmp(&b.error.abs())) {
            Some(answer) => {
                series.points.push([bank_rad, answer.error]);
                series.intervals.push(answer.interval);
            }
            None => series.unanswered.push(bank_rad),
        }
    }
    series
}

/// How many drives on banked roads give a height, and how many intervals miss it.
fn counts(pair: &Pair, banked: &[Vec<Option<Answer>>]) -> String {
    let drives = banked.iter().flatten();
    let given = drives.clone().flatten();
    format!(
        "{}: {} heights from {} drives on banked roads, {} intervals miss the true one",
        pair.name,
        given.clone().count(),
        drives.count(),
        given.filter(|answer| answer.misses()).count()
    )
}

/// The greatest error of some series as text.
fn off(series: &[Series]) -> String {
    let errors = series.iter().flat_map(Series::values).map(f64::abs);
    let unanswered = series.iter().any(|series| !series.unanswered.is_empty());
    let or = if unanswered { " or without a height" } else { "" };
    format!("up to {:.1} % off{or}", 100.0 * errors.fold(0.0, f64::max))
}
