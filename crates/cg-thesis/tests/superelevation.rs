//! What road twist does to the ratios of the pairs where the superelevation of a road is reached within 40 to 100 m, as guides
//! of road design ask for, with spirals and without (where two thirds of the ramp lie before the curve). The nonlinear plant without
//! noise, trucks as in their files, on the same road with and without twist. `CG_DRIVES` takes three loads for one.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Channel;
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadPoint};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::{Load, Vehicle};
use rayon::prelude::*;

/// Lengths of the spirals and of the ramps, how far before the curve a ramp begins, and how far after it the other one ends, m.
type Ramps = [f64; 4];
/// Those of guides.
const ALIKE: [Ramps; 7] = [
    [40.0, 40.0, 0.0, 0.0],
    [60.0, 60.0, 0.0, 0.0],
    [40.0, 60.0, 20.0, 20.0],
    [40.0, 60.0, 40.0, 40.0],
    [40.0, 60.0, 60.0, 60.0],
    [40.0, 100.0, 67.0, 67.0],
    [20.0, 60.0, 40.0, 40.0],
];
/// The bank comes before every curve and ends with it.
const UNLIKE: [Ramps; 2] = [[60.0, 60.0, 20.0, 0.0], [40.0, 60.0, 60.0, 0.0]];
const SUPERELEVATION_RAD: f64 = 0.04;
/// Radii and sides of the curves, m.
const CURVES_M: [f64; 5] = [150.0, -240.0, -190.0, 320.0, -130.0];
const LATERAL_MPS2: f64 = 1.7;
const GREATEST_MPS: f64 = 22.0;
const TRUCKS: [&str; 4] = ["baseline.toml", "euro.toml", "kraz.toml", "air.toml"];
/// Payloads and heights of their loads.
const LOADS: [(f64, f64); 3] = [(14e3, 1.9), (5e3, 1.7), (22e3, 2.0)];

fn road([spiral_m, ramp_m, before_m, after_m]: Ramps) -> Road {
    let mut points = Vec::new();
    let mut at_m = 0.0;
    for radius_m in CURVES_M {
        let speed_mps = (LATERAL_MPS2 * radius_m.abs()).sqrt().min(GREATEST_MPS);
        let straight_m = 50.0 + before_m.max(after_m);
        let curve_m = 2.0 * spiral_m + 100.0;
        let (end_m, step_m) = (curve_m + 2.0 * straight_m, 5.0);
        let mut along_m = 0.0;
        while along_m < end_m {
            let ends_m = [along_m - straight_m, straight_m + curve_m - along_m];
            let share = |beyond_m: [f64; 2], length_m: f64| {
                let into_m = (ends_m[0] + beyond_m[0]).min(ends_m[1] + beyond_m[1]);
                (into_m / length_m).clamp(0.0, 1.0)
            };
            points.push(RoadPoint {
                distance_m: at_m + along_m,
                curvature_per_m: share([0.0; 2], spiral_m) / radius_m,
                bank_rad: -radius_m.signum()
                    * SUPERELEVATION_RAD
                    * share([before_m, after_m], ramp_m),
                grade_rad: 0.0,
                speed_mps,
            });
            along_m += step_m;
        }
        at_m += end_m;
    }
    Road::new("ramps", points).unwrap()
}

/// The ratio of a pair from a drive, and the root mean square of the specific force in its turns, m/s².
fn found(vehicle: &Vehicle, rows: &[LogRow], pair: Channel) -> Option<[f64; 2]> {
    let options = EstimateOptions { channel: Some(pair), ..EstimateOptions::default() };
    let mut estimator = LogEstimator::new(vehicle, options).unwrap();
    let force = |row: &LogRow| match pair {
        Channel::Tractor => row.tractor_lateral_specific_force_mps2,
        _ => row.lateral_specific_force_mps2,
    };
    for row in rows {
        let signals = LogRow { time_s: row.time_s, speed_mps: row.speed_mps, ..LogRow::ABSENT };
        let mut signals = LogRow { trailer_mass_kg: row.trailer_mass_kg, ..signals };
        if pair == Channel::Tractor {
            signals.tractor_suspension_roll_rad = row.tractor_suspension_roll_rad;
            signals.tractor_lateral_specific_force_mps2 = force(row);
        } else {
            signals.suspension_roll_rad = row.suspension_roll_rad;
            signals.lateral_specific_force_mps2 = force(row);
        }
        estimator.push(&signals).unwrap();
    }
    let turns: Vec<f64> = rows.iter().map(force).filter(|force| force.abs() > 0.6).collect();
    let square = turns.iter().map(|force| force * force).sum::<f64>();
    #[allow(clippy::cast_precision_loss)]
    let force_mps2 = (square / turns.len() as f64).sqrt();
    Some([estimator.finish().ratio?, force_mps2])
}

/// Errors of the roll angles of both pairs by twist, rad, in a drive.
fn errors(
    vehicle: &Vehicle,
    (payload_kg, cg_height_m): (f64, f64),
    ramps: Ramps,
) -> [Option<f64>; 2] {
    let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
    let drive = |road: Road| {
        let scenario = Scenario {
            load: Load { trailer_mass_kg, cg_height_m },
            rate_hz: 50.0,
            duration_s: road.usual_duration_s(),
            ..Scenario::of(vehicle, Maneuver::Drive)
        };
        let perfect = ChassisSensors::default();
        LogSimulation::on_road(vehicle, scenario, &road, &perfect).unwrap().rows().clone()
    };
    let [level, twisted] = [drive(road(ramps)), drive(road(ramps).twisted())];
    [Channel::Suspension, Channel::Tractor].map(|pair| {
        let [[level, force_mps2], [twisted, _]] =
            [found(vehicle, &level, pair)?, found(vehicle, &twisted, pair)?];
        Some((twisted - level) * force_mps2)
    })
}

/// Root mean squares of the errors of both pairs over all trucks, loads and ramps, mrad.
fn rms_mrad(what: &str, ramps: &[Ramps]) -> [f64; 2] {
    let loads = if std::env::var("CG_DRIVES").is_ok() { &LOADS[..] } else { &LOADS[..1] };
    let trucks = TRUCKS.map(common::vehicle);
    let mut cases = Vec::new();
    for ramps in ramps {
        for truck in &trucks {
            cases.extend(loads.iter().map(|load| (truck, *load, *ramps)));
        }
    }
    let all: Vec<_> =
        cases.par_iter().map(|(truck, load, ramps)| errors(truck, *load, *ramps)).collect();
    [0, 1].map(|pair: usize| {
        let known: Vec<f64> = all.iter().filter_map(|both| both[pair]).collect();
        #[allow(clippy::cast_precision_loss)]
        let mean = |sum: f64| sum / known.len() as f64;
        let [mean, square] = [mean(known.iter().sum()), mean(known.iter().map(|x| x * x).sum())];
        let (pair, rms) = (["trailer", "tractor"][pair], 1e3 * square.sqrt());
        println!("{what}, {pair}: {rms:.2} mrad, mean {:+.2}, {} drives", 1e3 * mean, known.len());
        rms
    })
}

/// What a turn on public roads has in its interval is neither less than the ramps of guides make, nor twice as much. It is less than
/// what ramps of one end of each curve make (docs/limits.md).
#[test]
fn ramps_of_superelevation_are_in_the_interval() {
    const STATED_MRAD: [f64; 2] = [0.4, 0.8];
    let [alike, unlike] =
        [("alike", &ALIKE[..]), ("unlike", &UNLIKE[..])].map(|(what, ramps)| rms_mrad(what, ramps));
    for (pair, stated_mrad) in STATED_MRAD.into_iter().enumerate() {
        assert!((0.5 * stated_mrad..stated_mrad).contains(&alike[pair]), "{pair}: {alike:?}");
        assert!(unlike[pair] > stated_mrad, "{pair}: {unlike:?}");
    }
}
