//! Pairs of suspension roll and specific force on measured springs with friction (leaf springs, and air
//! springs under the trailer and the drive axles): drives of the nonlinear plant on banked roads with usual
//! sensors, as the vehicle file and calibrated on two flat drives, on roads without and with twist. `CG_DRIVES=24`
//! drives more on each road.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::{Channel, Design};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadKind};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::{design, design_with};
use cg_vehicle::preparation::Prepares;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use rayon::prelude::*;

/// Drives on each kind of road if the environment says nothing.
const DRIVES: u64 = 8;

/// A vehicle file, the greater height of its loads (with the air springs the truck rolls over at 2.1 m),
/// and the greatest root mean square of the errors of both pairs after a calibration, on all roads together.
type Case = (&'static str, f64, [f64; 2]);
/// Wanted are 1.5 % and 2.5 %, which air springs keep. The suspension of a tractor on leaf springs rolls by 1 to 7 mrad, of
/// which friction holds up to a half, and leaves 5.5 % of 72 drives; the trailer's leaves 1.3 %. The root mean square of
/// 24 errors (8 drives on each road) has a standard deviation of 14 % of itself, or more, because the drives with a load
/// share its error. Three of them are allowed.
const CASES: [Case; 2] =
    [("baseline-tables.toml", 2.1, [0.0205, 0.087]), ("air.toml", 1.85, [0.015, 0.025])];

fn laden(vehicle: &Vehicle, payload_kg: f64, cg_height_m: f64) -> Load {
    Load { trailer_mass_kg: vehicle.empty_trailer_mass_kg() + payload_kg, cg_height_m }
}

/// What the sensors of the chassis measure, and the yaw rate.
fn rows(vehicle: &Vehicle, load: Load, road: &Road, seed: u64) -> Vec<LogRow> {
    let scenario = Scenario {
        load,
        seed,
        rate_hz: 50.0,
        duration_s: road.usual_duration_s(),
        ..Scenario::of(vehicle, Maneuver::Drive)
    };
    let chassis = ChassisSensors::usual();
    let simulation = LogSimulation::on_road(vehicle, scenario, road, &chassis).unwrap();
    let measured = |row: &LogRow| LogRow {
        time_s: row.time_s,
        speed_mps: row.speed_mps,
        trailer_mass_kg: row.trailer_mass_kg,
        yaw_rate_radps: row.yaw_rate_radps,
        suspension_roll_rad: row.suspension_roll_rad,
        lateral_specific_force_mps2: row.lateral_specific_force_mps2,
        tractor_suspension_roll_rad: row.tractor_suspension_roll_rad,
        tractor_lateral_specific_force_mps2: row.tractor_lateral_specific_force_mps2,
        ..LogRow::ABSENT
    };
    simulation.rows().iter().map(measured).collect()
}

/// The same, with the yaw rate or without it.
fn kept(row: &LogRow, has_yaw_rate: bool) -> LogRow {
    let yaw_rate_radps = if has_yaw_rate { row.yaw_rate_radps } else { f64::NAN };
    LogRow { yaw_rate_radps, ..*row }
}

/// The design after a nearly empty and a loaded drive on flat roads.
fn calibrated(vehicle: &Vehicle, high_m: f64) -> Design<f64> {
    let known = [laden(vehicle, 2e3, 1.45), laden(vehicle, 22e3, high_m)];
    let logs = known.map(|load| KnownLog {
        log: format!("{} m", load.cg_height_m),
        load: KnownLoad::exact(load.cg_height_m, None),
    });
    let road = Road::kind(RoadKind::Rural, 99).unwrap().flat();
    let drives = known.map(|load| rows(vehicle, load, &road, 99));
    // The sensors were calibrated on a flat road and are used on others.
    let mut flat = vehicle.clone();
    flat.road = Some(cg_vehicle::sensor_places::Road { bank_sd_rad: 0.0 });
    let found = calibrate(&flat, CalibrateOptions::default(), &logs, |log, estimator| {
        let place = logs.iter().position(|other| other.log == log.log).unwrap();
        for row in &drives[place] {
            estimator.push(&kept(row, false)).unwrap();
        }
        Ok::<(), VehicleError>(())
    });
    design_with(vehicle, Variant::Complete, &found.unwrap().belief()).unwrap()
}

/// The rows of all drives on a kind of road, with their loads: payloads spread evenly, each at one of two heights.
fn drives(
    vehicle: &Vehicle,
    high_m: f64,
    road: impl Fn(u64) -> Road + Sync,
) -> Vec<(Load, Vec<LogRow>)> {
    let count = std::env::var("CG_DRIVES").map_or(DRIVES, |count| count.parse().unwrap());
    let drive = |seed: u64| {
        // Multiples of the golden ratio fill the range evenly, however many there are.
        let share = (f64::from(u32::try_from(seed).unwrap()) * 0.618_034).fract();
        let high = seed.is_multiple_of(2);
        let load = laden(vehicle, 5e3 + 20e3 * share, if high { high_m } else { 1.6 });
        (load, rows(vehicle, load, &road(seed), seed))
    };
    (0..count).into_par_iter().map(drive).collect()
}

/// What a pair gives for some drives.
#[derive(Default)]
struct Judged {
    heights: f64,
    held: f64,
    /// Sums of the squares of the relative error, of its stated standard deviation, and of their quotient.
    squares: [f64; 3],
}

impl Judged {
    fn of(
        vehicle: &Vehicle,
        design: &Design<f64>,
        (pair, has_yaw_rate): (Channel, bool),
        drives: &[(Load, Vec<LogRow>)],
    ) -> Self {
        let prepares = has_yaw_rate.then(|| Prepares::of(vehicle).unwrap());
        let channel = Some(pair);
        let options = EstimateOptions { channel, prepares, ..EstimateOptions::default() };
        let mut judged = Self::default();
        for (load, rows) in drives {
            let mut estimator =
                LogEstimator::from_design(design, vehicle.align_settings(), options);
            for row in rows {
                estimator.push(&kept(row, has_yaw_rate)).unwrap();
            }
            let found = estimator.finish();
            let (Some(height_m), Some(sd_m), Some([low, high])) =
                (found.height_m, found.height_sd_m, found.height_ci95_m)
            else {
                assert!(!found.messages.is_empty());
                continue;
            };
            let truth_m = load.cg_height_m;
            judged.heights += 1.0;
            judged.held += f64::from(u8::from(low < truth_m && truth_m < high));
            let [error, sd] = [height_m / truth_m - 1.0, sd_m / truth_m];
            for (sum, term) in judged.squares.iter_mut().zip([error, sd, error / sd]) {
                *sum += term * term;
            }
        }
        judged
    }

    /// Root mean squares of the error, of the stated standard deviation, and of their quotient.
    fn rms(&self) -> [f64; 3] {
        self.squares.map(|sum| (sum / self.heights).sqrt())
    }

    fn add(&mut self, other: &Self) {
        self.heights += other.heights;
        self.held += other.held;
        for (sum, term) in self.squares.iter_mut().zip(other.squares) {
            *sum += term;
        }
    }

    fn print(&self, what: &str) {
        let [error, sd, quotient] = self.rms();
        println!(
            "| {what} | {:.1} % | {:.1} % | {quotient:.2} | {} of {} |",
            100.0 * error,
            100.0 * sd,
            self.held,
            self.heights
        );
    }
}

const ROADS: [RoadKind; 3] = [RoadKind::Rural, RoadKind::Motorway, RoadKind::Roundabouts];

/// Friction makes springs stiffer in small motion than in the motion for which the model is linear, and bends of
/// their curves make them stiffer or softer in great motion. Every drive gives a height with either pair, all
/// intervals hold it, and what a pair leaves is within the standard deviation that is stated: a mean of 24
/// squared errors above its stated value by half has a probability of 4 % if the statement is true. The errors
/// are less, because the interval also contains what these drives do not have: road twist, and friction that
/// changes from drive to drive.
#[test]
fn intervals_hold_on_measured_springs() {
    println!(
        "| vehicle | calibrated with | pair | road | RMSE | stated sd | error over sd | held |"
    );
    for (name, high_m, greatest) in CASES {
        let vehicle = common::vehicle(name);
        let file = design(&vehicle, Variant::Complete).unwrap();
        let designs = [("file", &file), ("two flat drives", &calibrated(&vehicle, high_m))];
        let drives =
            ROADS.map(|kind| drives(&vehicle, high_m, |seed| Road::kind(kind, seed).unwrap()));
        for (known, design) in designs {
            for (pair, greatest) in [Channel::Suspension, Channel::Tractor].iter().zip(greatest) {
                let mut all = Judged::default();
                for (kind, drives) in ROADS.iter().zip(&drives) {
                    let judged = Judged::of(&vehicle, design, (*pair, false), drives);
                    judged.print(&format!("{name} | {known} | `{pair}` | {kind}"));
                    all.add(&judged);
                }
                let count = drives.iter().map(Vec::len).sum::<usize>();
                assert!(
                    (all.held - f64::from(u32::try_from(count).unwrap())).abs() < 0.5,
                    "{name} {known} {pair}"
                );
                let [error, sd, _] = all.rms();
                assert!(error * error < 1.5 * sd * sd, "{name} {known} {pair}: {error} {sd}");
                assert!(known == "file" || error < greatest, "{name} {pair}: {error}");
            }
        }
    }
}

/// On roads whose bank changes along the truck, which is what the stated standard deviation of a calibrated truck
/// mostly is, it is neither too small nor too great. The bank enters every curve in the same way, so that the
/// errors are not independent: of 50 heights with a correlation of a half the mean square of error over sd is
/// between 0.3 and 2 with a probability of 95 %. At least 93 % of the intervals hold. That of the tractor's pair is also for roads
/// whose bank begins before the curve (`superelevation`), and wider than these need. With a yaw rate, which shows the bank, the trailer's
/// errors are less.
#[test]
fn the_stated_deviation_is_that_of_roads_with_twist() {
    println!(
        "| vehicle | calibrated with | pair | road | RMSE | stated sd | error over sd | held |"
    );
    for (name, high_m, _) in CASES {
        let vehicle = common::vehicle(name);
        let design = calibrated(&vehicle, high_m);
        let cases = [false, true]
            .map(|yaw| [Channel::Suspension, Channel::Tractor].map(|pair| (pair, yaw)));
        let mut all = cases.map(|pairs| pairs.map(|_| Judged::default()));
        for kind in ROADS {
            let road = |seed| Road::kind(kind, seed).unwrap().twisted();
            let drives = drives(&vehicle, high_m, road);
            for (case, all) in cases.iter().flatten().zip(all.iter_mut().flatten()) {
                let judged = Judged::of(&vehicle, &design, *case, &drives);
                let yaw = if case.1 { ", yaw rate" } else { "" };
                let pair = case.0;
                judged.print(&format!("{name} | two flat drives | `{pair}` | {kind}, twist{yaw}"));
                all.add(&judged);
            }
        }
        let [without, _, quotient] = all[0][0].rms();
        let [with, ..] = all[1][0].rms();
        assert!(with < without, "{name}: {with} {without}");
        for pair in all.iter().flatten() {
            assert!(pair.held >= 0.93 * pair.heights, "{name}: {} of {}", pair.held, pair.heights);
        }
        assert!((0.3..2.0).contains(&(quotient * quotient)), "{name}: {quotient}");
    }
}
