//! Coverage of the intervals on banked roads: trucks that differ from their vehicle file, drives of the
//! nonlinear plant, usual sensors of the chassis, nothing calibrated.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::{Channel, Design};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadKind};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::belief::{Belief, Deviations, adjusted, log_gain};
use cg_vehicle::{Load, Variant, Vehicle};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

const PAIRS: [Channel; 2] = [Channel::Suspension, Channel::Tractor];
/// Drives on roads of each kind if the environment says nothing; docs/sensors.md has those of `CG_DRIVES=24`.
const DRIVES: u64 = 12;
/// Each kind of road with the seed of its first drive.
const ROADS: [(RoadKind, u64); 3] =
    [(RoadKind::Rural, 1000), (RoadKind::Motorway, 2000), (RoadKind::Roundabouts, 3000)];

fn count() -> u64 {
    std::env::var("CG_DRIVES").map_or(DRIVES, |count| count.parse().unwrap())
}

/// The truck of a drive: its load, its deviations from the vehicle file, and the errors of both ratios
/// that the equations leave out.
struct Truck {
    load: Load,
    deviations: Deviations,
    residual: [f64; 2],
}

impl Truck {
    /// A truck with a drawn load that differs from the file by this many standard deviations, drawn too.
    fn drawn(belief: &Belief, seed: u64, spread: f64) -> Self {
        let mut source = StdRng::seed_from_u64(seed);
        let load = Load {
            trailer_mass_kg: source.random_range(14e3..28.7e3),
            cg_height_m: source.random_range(1.6..2.0),
        };
        let mut normal = || -> f64 {
            let standard: f64 = StandardNormal.sample(&mut source);
            spread * standard
        };
        Self {
            load,
            deviations: belief.drawn(&mut normal),
            residual: [belief.residual_sd * normal(), belief.residual_sd * normal()],
        }
    }

    /// The row of a truck that has only the sensors of these pairs, with their gains.
    fn with_sensor_gains(&self, row: &LogRow) -> LogRow {
        let gain = |k: usize| (log_gain(&self.deviations, PAIRS[k]) + self.residual[k]).exp();
        LogRow {
            time_s: row.time_s,
            speed_mps: row.speed_mps,
            trailer_mass_kg: row.trailer_mass_kg,
            suspension_roll_rad: row.suspension_roll_rad * gain(0),
            lateral_specific_force_mps2: row.lateral_specific_force_mps2,
            tractor_suspension_roll_rad: row.tractor_suspension_roll_rad * gain(1),
            tractor_lateral_specific_force_mps2: row.tractor_lateral_specific_force_mps2,
            ..LogRow::ABSENT
        }
    }
}

fn rows(vehicle: &Vehicle, truck: &Truck, road: &Road, seed: u64) -> Vec<LogRow> {
    let chassis = ChassisSensors::usual();
    let other = adjusted(vehicle, &truck.deviations);
    let scenario = Scenario {
        load: truck.load,
        rate_hz: 50.0,
        duration_s: road.usual_duration_s(),
        seed,
        ..Scenario::of(&other, Maneuver::Drive)
    };
    let simulation = LogSimulation::on_road(&other, scenario, road, &chassis).unwrap();
    simulation.rows().iter().map(|row| truck.with_sensor_gains(row)).collect()
}

/// The answer of a pair to a drive, relative to the true height.
#[derive(Clone, Copy, Debug)]
struct Answer {
    error: f64,
    sd: f64,
    ends: [f64; 2],
}

fn answer(
    vehicle: &Vehicle,
    design: &Design<f64>,
    channel: Channel,
    rows: &[LogRow],
    truth_m: f64,
) -> Option<Answer> {
    let options = EstimateOptions { channel: Some(channel), ..EstimateOptions::default() };
    let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
    for row in rows {
        estimator.push(row).unwrap();
    }
    let found = estimator.finish();
    let relative = |height_m: f64| height_m / truth_m - 1.0;
    found.height_m.map(|height_m| Answer {
        error: relative(height_m),
        sd: found.height_sd_m.unwrap() / truth_m,
        ends: found.height_ci95_m.unwrap().map(relative),
    })
}

/// The answers of one pair to all drives on a kind of road.
#[derive(Debug)]
struct Answers {
    kind: RoadKind,
    pair: Channel,
    heights: usize,
    low: usize,
    high: usize,
    /// Mean of the square of error over standard deviation.
    square: f64,
}

impl Answers {
    #[allow(clippy::cast_precision_loss)] // two dozens
    fn new(kind: RoadKind, pair: Channel, answers: &[Answer]) -> Self {
        let low = answers.iter().filter(|answer| answer.ends[1] < 0.0).count();
        let high = answers.iter().filter(|answer| answer.ends[0] > 0.0).count();
        let mean = |value: fn(&Answer) -> f64| {
            answers.iter().map(value).sum::<f64>() / answers.len() as f64
        };
        let square = mean(|answer| (answer.error / answer.sd).powi(2));
        println!(
            "| {kind} | {pair} | {} | {low} | {high} | {:+.1} | {:.1} | {:.1} | {:.1} | {square:.2} |",
            answers.len(),
            100.0 * mean(|answer| answer.error),
            100.0 * mean(|answer| answer.error.powi(2)).sqrt(),
            100.0 * answers.iter().map(|answer| answer.error.abs()).fold(0.0, f64::max),
            100.0 * mean(|answer| answer.sd),
        );
        Self { kind, pair, heights: answers.len(), low, high, square }
    }

    /// More misses than allowed have a probability of 0.1 %, with a chance of 5 % each and of 2.5 % on one side.
    fn hold(&self) {
        let Self { kind, pair, heights, low, high, .. } = *self;
        assert!(low + high <= most(heights, 0.05), "{kind} {pair}: {self:?}");
        assert!(low.max(high) <= most(heights, 0.025), "{kind} {pair}: {self:?}");
    }
}

/// The number of misses that as many intervals exceed with a probability of 0.1 %, if each misses with this chance
/// (binomial distribution).
#[allow(clippy::cast_precision_loss)] // dozens
fn most(count: usize, chance: f64) -> usize {
    let n = count as f64;
    let mut term = (1.0 - chance).powf(n);
    let (mut misses, mut within) = (0, term);
    while within < 0.999 {
        term *= (n - misses as f64) / (misses as f64 + 1.0) * chance / (1.0 - chance);
        misses += 1;
        within += term;
    }
    misses
}

/// The mean of as many squares of a standard normal variable that is undershot with a probability of 0.1 % (χ²
/// distribution, by Wilson and Hilferty).
#[allow(clippy::cast_precision_loss)] // dozens
fn least_square(count: usize) -> f64 {
    let variance = 2.0 / (9.0 * count as f64);
    (1.0 - variance - 3.09 * variance.sqrt()).powi(3)
}

#[test]
fn the_bounds_are_those_of_tables() {
    // Of 24, six or more have 0.10 %, five or more on one side 0.03 %; χ² with 24 degrees of freedom is below 8.1.
    assert_eq!((most(24, 0.05), most(24, 0.025)), (5, 4));
    assert!((24.0 * least_square(24) - 8.1).abs() < 0.1);
}

/// The trucks differ from the file by this many standard deviations.
fn drives(spread: f64, twisted: bool, kinds: &[(RoadKind, u64)]) -> Vec<Answers> {
    let vehicle = common::vehicle("kraz.toml");
    let belief = Belief::prior(&vehicle);
    let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
    println!(
        "| road | pair | heights | too low | too high | bias | RMSE | worst | sd, % | (error/sd)² |"
    );
    let on = |&(kind, first): &(RoadKind, u64)| {
        let both = (first..first + count()).into_par_iter().map(|seed| {
            let truck = Truck::drawn(&belief, seed, spread);
            let road = Road::kind(kind, seed).unwrap();
            let road = if twisted { road.twisted() } else { road };
            let rows = rows(&vehicle, &truck, &road, seed);
            PAIRS.map(|pair| answer(&vehicle, &design, pair, &rows, truck.load.cg_height_m))
        });
        let both: Vec<[Option<Answer>; 2]> = both.collect();
        [0, 1].map(|k| {
            let answers: Vec<Answer> = both.iter().filter_map(|both| both[k]).collect();
            Answers::new(kind, PAIRS[k], &answers)
        })
    };
    kinds.iter().flat_map(on).collect()
}

/// Every drive gives a height with both pairs. The 95 % intervals hold it, on either side, and are not
/// too wide.
#[test]
fn intervals_of_drawn_trucks_hold_on_banked_roads() {
    for found in drives(1.0, false, &ROADS) {
        assert_eq!(found.heights as u64, count(), "{found:?}");
        found.hold();
        assert!(found.square > least_square(found.heights), "{found:?}");
    }
}

/// With the truck of the file, the articulation on roundabouts alone leaves all intervals true.
#[test]
fn intervals_of_the_truck_of_the_file_hold_on_roundabouts() {
    for found in drives(0.0, false, &ROADS[2..]) {
        let all = usize::try_from(count()).unwrap();
        assert_eq!((found.heights, found.low, found.high), (all, 0, 0), "{found:?}");
    }
}

/// The same where every axle stands on the bank of its own place. Where the bank changes within the length
/// of the truck, the suspension can contradict the force, and a drive can be without a height.
#[test]
fn intervals_of_drawn_trucks_hold_on_twisted_roads() {
    for found in drives(1.0, true, &ROADS) {
        found.hold();
        // In a roundabout the bank changes from one side to the other within the length of the truck. On
        // other roads a drive without a height is an exception.
        let few = found.heights as u64 + 2 < count();
        assert!(!few || found.kind == RoadKind::Roundabouts, "{found:?}");
    }
}
