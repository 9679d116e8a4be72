//! A truck that learns itself from its empty trips, over a year (no figure of the thesis).
//!
//! Trucks that differ from their vehicle file drive with random loads, some trips
//! without a load. Their springs lose stiffness over the year. The height of each laden trip is
//! estimated twice: with what the truck has learned from its earlier empty trips, and without.

use std::convert::Infallible;

use cg_core::{Channel, Design};
use cg_logs::estimate::{EstimateOptions, LogEstimator, RoadChoice};
use cg_logs::learn::{Learned, Learner};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::random::standard_normal;
use cg_plant::sensors::{Instruments, Sensors};
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::belief::{Belief, Deviations, Parameter, adjusted, log_gain};
use cg_vehicle::design::design_with;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Variant, Vehicle};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rayon::prelude::*;

use super::data::{Abscissa, Panel, Quantity, Series, Study, Unit};
use super::setting::Setting;
use crate::accuracy;

/// Length of the simulated time, s.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// Part of the trips that have no load.
const EMPTY_SHARE: f64 = 0.2;
/// Greatest and least mass of a payload, and heights of a laden trailer's c.g., which are drawn.
const PAYLOADS_KG: [f64; 2] = [5e3, 20e3];
const HEIGHTS_M: [f64; 2] = [1.6, 2.0];
/// Roll stiffness that the springs have left after the year.
const WORN: f64 = 0.85;
/// Number of empty trips after which the truck is expected to know itself.
const KNOWN_AFTER: usize = 3;
/// Number of months into which the year is divided.
const MONTHS: u32 = 12;
/// Length of a trip, s.
const TRIP_S: f64 = 120.0;
/// Noise of the roll angle with the reference load; with other loads the noise is the same.
const SNR_DB: f64 = 20.0;
/// Sampling rate.
const RATE_HZ: f64 = 50.0;
const TIME: Quantity = Quantity { name: "time", label: "Time", unit: Unit::Month };
const ERROR: Quantity =
    Quantity { name: "error", label: "Error of the height, rms", unit: Unit::One };
const COVERAGE: Quantity =
    Quantity { name: "coverage", label: "Share of intervals that hold", unit: Unit::One };

/// What is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InService {
    /// Number of trucks.
    pub trucks: u32,
    /// Trips of each truck in the year.
    pub trips: u32,
    /// What the trucks are before their springs wear.
    pub truck: accuracy::Truck,
}

/// The answer to a laden trip, relative to the true height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Answer {
    /// Error of the height.
    pub error: f64,
    /// Stated standard deviation.
    pub sd: f64,
    /// Whether the 95 % interval holds the height.
    pub holds: bool,
}

/// A laden trip of a truck in service.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LadenTrip {
    /// Share of the year that has passed.
    pub passed: f64,
    /// Number of empty trips before it.
    pub empty_trips: usize,
    /// Number of them that the truck counts.
    pub counted: usize,
    /// The answer with what was learned; `None` if there is no height.
    pub learned: Option<Answer>,
    /// The answer with the vehicle file alone.
    pub unlearned: Option<Answer>,
}

/// A truck that differs from its vehicle file.
struct Truck<'a> {
    vehicle: &'a Vehicle,
    new: Deviations,
    /// The part of the ratios' error that the equations leave out, for the empty trailer.
    residual: [f64; 2],
    residual_sd: f64,
    /// Standard deviation of the place of a payload.
    place_sd_m: f64,
    noise_sd_rad: f64,
    source: StdRng,
}

impl<'a> Truck<'a> {
    fn new(vehicle: &'a Vehicle, truck: accuracy::Truck, seed: u64) -> Result<Self, VehicleError> {
        let prior = Belief::prior(vehicle);
        let spread = if truck == accuracy::Truck::OfTheFile { 0.0 } else { 1.0 };
        let mut source = StdRng::seed_from_u64(seed);
        let mut normal = || standard_normal(&mut source);
        let new = prior.drawn(&mut normal) * spread;
        let residual_sd = prior.residual_sd * spread;
        let residual = [(); 2].map(|()| residual_sd * normal());
        let noise_sd_rad = LogSimulation::new(vehicle, trip(vehicle))?.truth.noise_sd_rad;
        let place_sd_m = vehicle.uncertainty.payload_place_sd_m * spread;
        Ok(Self { vehicle, new, residual, residual_sd, place_sd_m, noise_sd_rad, source })
    }

    /// Draws the load of the next trip; `None` is the empty trailer.
    fn load(&mut self) -> Option<Load> {
        let [least_kg, greatest_kg] = PAYLOADS_KG;
        let payload_kg = self.source.random_range(least_kg..greatest_kg);
        let cg_height_m = self.source.random_range(HEIGHTS_M[0]..HEIGHTS_M[1]);
        let trailer_mass_kg = self.vehicle.empty_trailer_mass_kg() + payload_kg;
        let laden = !self.source.random_bool(EMPTY_SHARE);
        laden.then_some(Load { trailer_mass_kg, cg_height_m })
    }

    /// What its sensors measure on a drive.
    fn drive(&mut self, load: Option<Load>, passed: f64) -> Result<Vec<LogRow>, VehicleError> {
        let mut now = self.new;
        for parameter in [Parameter::TrailerRollStiffness, Parameter::TractorRollStiffness] {
            now[parameter as usize] += passed * libm::log(WORN);
        }
        // All empty trips have the same residual, each load has its own.
        let mut normal = || standard_normal(&mut self.source);
        let drawn = [(); 2].map(|()| self.residual_sd * normal());
        let residual = if load.is_some() { drawn } else { self.residual };
        let gain =
            |channel: Channel| libm::exp(log_gain(&now, channel) + residual[channel.index()]);
        let (steer, lateral) = (gain(Channel::Steer), gain(Channel::LateralAcceleration));
        let mut payload_behind_hitch_m = self.vehicle.trailer.payload.behind_hitch_m;
        if self.place_sd_m > 0.0 {
            payload_behind_hitch_m += self.place_sd_m * normal();
        }
        let seed = self.source.random();
        let truck = adjusted(self.vehicle, &now);
        let load = load.unwrap_or_else(|| empty(&truck));
        let scenario = Scenario { seed, load, payload_behind_hitch_m, ..trip(&truck) };
        let gravity_mps2 = self.vehicle.gravity_mps2;
        let mut instruments =
            Instruments::new(&scenario.sensors, self.noise_sd_rad, gravity_mps2, 1.0, seed);
        let mut rows = Vec::new();
        let Ok(()) = LogSimulation::new(&truck, scenario)?.run_true(|row| {
            rows.push(instruments.measure(&LogRow {
                time_s: passed * YEAR_S + row.time_s,
                steer_rad: row.steer_rad / steer,
                lateral_acceleration_mps2: row.lateral_acceleration_mps2 / lateral,
                yaw_rate_radps: row.yaw_rate_radps / lateral,
                ..*row
            }));
            Ok::<(), Infallible>(())
        });
        Ok(rows)
    }

    /// All laden trips of a year.
    fn year(mut self, trips: u32) -> Result<Vec<LadenTrip>, VehicleError> {
        let vehicle = self.vehicle;
        let variant = Variant::Complete;
        let unlearned = design_with(vehicle, variant, &Belief::prior(vehicle))?;
        let mut learned = Learned::default();
        let (mut laden, mut empty_trips) = (Vec::new(), 0);
        let mut design = unlearned;
        for trip in 0..trips {
            let passed = f64::from(trip) / f64::from(trips);
            let load = self.load();
            let rows = self.drive(load, passed)?;
            let log = pushed(vehicle, &design, &rows)?;
            // The truck does not know which trip is empty.
            let mut learner = Learner::new(vehicle, variant, learned);
            learner.log(log.clone())?;
            learned = learner.learned(&design);
            let Some(load) = load else {
                empty_trips += 1;
                let known = learned.design(vehicle, variant, passed * YEAR_S);
                // As `cg run`: a truck that gives no design is taken as its file.
                design = known.ok().flatten().unwrap_or(unlearned);
                continue;
            };
            laden.push(LadenTrip {
                passed,
                empty_trips,
                counted: learned.trips(),
                learned: answer(log, load),
                unlearned: answer(pushed(vehicle, &unlearned, &rows)?, load),
            });
        }
        Ok(laden)
    }
}

/// A drive of the linear model.
fn trip(vehicle: &Vehicle) -> Scenario {
    let sensors = Sensors { snr_db: Some(SNR_DB), ..Sensors::default() };
    let drive = Scenario::of(vehicle, Maneuver::Drive);
    Scenario { rate_hz: RATE_HZ, duration_s: TRIP_S, sensors, ..drive }
}

fn empty(vehicle: &Vehicle) -> Load {
    vehicle.empty_load()
}

fn pushed(
    vehicle: &Vehicle,
    design: &Design<f64>,
    rows: &[LogRow],
) -> Result<LogEstimator, VehicleError> {
    let options = EstimateOptions {
        road: Some(RoadChoice::FLAT), // that of the plant
        ..EstimateOptions::default()
    };
    let mut log = LogEstimator::from_design(design, vehicle.align_settings(), options);
    for row in rows {
        log.push(row).map_err(|error| VehicleError::Model(error.to_string()))?;
    }
    Ok(log)
}

fn answer(log: LogEstimator, load: Load) -> Option<Answer> {
    let found = log.finish();
    let (height_m, sd_m) = found.height_m.zip(found.height_sd_m)?;
    let [low_m, high_m] = found.height_ci95_m?;
    Some(Answer {
        error: height_m / load.cg_height_m - 1.0,
        sd: sd_m / load.cg_height_m,
        holds: (low_m..=high_m).contains(&load.cg_height_m),
    })
}

/// One of the answers to a trip.
type Pick = fn(&LadenTrip) -> Option<Answer>;

/// Error and coverage of some laden trips.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    answers: f64,
    square: f64,
    held: f64,
}

impl Score {
    fn of<'a>(trips: impl Iterator<Item = &'a LadenTrip>, answer: Pick) -> Self {
        trips.filter_map(answer).fold(Self::default(), |score, answer| Self {
            answers: score.answers + 1.0,
            square: score.square + answer.error * answer.error,
            held: score.held + f64::from(u8::from(answer.holds)),
        })
    }

    fn rms(&self) -> f64 {
        (self.square / self.answers).sqrt()
    }

    fn coverage(&self) -> f64 {
        self.held / self.answers
    }
}

/// The answers with what was learned, and without.
const ANSWERS: [(&str, Pick); 2] =
    [("learned", |trip| trip.learned), ("vehicle file", |trip| trip.unlearned)];

/// The trucks of the study.
const GROUPS: [(&str, InService); 2] = [
    (
        "as the vehicle file when new",
        InService { trucks: 2, trips: 300, truck: accuracy::Truck::OfTheFile },
    ),
    (
        "drawn from its uncertainty",
        InService { trucks: 20, trips: 100, truck: accuracy::Truck::Drawn },
    ),
];

pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let (mut errors, mut coverages) = (Vec::new(), Vec::new());
    let mut scenario = conditions(&setting.vehicle);
    let mut found = Vec::new();
    for (kind, (group, what)) in GROUPS.into_iter().enumerate() {
        let all = in_service(&setting.vehicle, what)?;
        let trips: Vec<&LadenTrip> = all.iter().flatten().collect();
        for (name, answer) in ANSWERS {
            let series = |value: fn(&Score) -> f64| {
                let points = (0..MONTHS).filter_map(|month| {
                    let score = Score::of(of_month(&trips, month), answer);
                    (score.answers > 0.0).then(|| [f64::from(month + 1), value(&score)])
                });
                let one = Series::new(format!("{group}, {name}"), kind, points.collect());
                if name == "learned" { one } else { one.aside() }
            };
            errors.push(series(Score::rms));
            coverages.push(series(Score::coverage));
        }
        let known = || trips.iter().copied().filter(|trip| trip.empty_trips >= KNOWN_AFTER);
        let [learned, file] = ANSWERS.map(|(_, answer)| Score::of(known(), answer));
        found.push(100.0 * learned.rms());
        scenario.push(format!(
            "{} trucks {group}, {} trips each, after the third empty trip: rms error {:.1} %, with the vehicle file \
             alone {:.1} %; the interval holds in {:.1} % of {} laden trips",
            what.trucks,
            what.trips,
            100.0 * learned.rms(),
            100.0 * file.rms(),
            100.0 * learned.coverage(),
            learned.answers
        ));
    }
    let panel = |title, y, series| Panel { figure: "", title, x: Abscissa::Over(TIME), y, series };
    Ok(Study {
        name: setting.name,
        finding: format!(
            "A truck that learns itself from its empty trips is {:.1} % off (rms) while its springs \
             lose 15 % in a year, and {:.1} % if it also differs from its vehicle file",
            found[0], found[1]
        ),
        scenario,
        panels: vec![
            panel("Error of laden trips", ERROR, errors),
            panel("Coverage of the 95 % intervals", COVERAGE, coverages),
        ],
        statements: Vec::new(),
    })
}

/// The trips in a month of the year, counted from 0.
fn of_month<'a>(trips: &'a [&LadenTrip], month: u32) -> impl Iterator<Item = &'a LadenTrip> {
    let months = f64::from(MONTHS);
    let (begin, end) = (f64::from(month) / months, f64::from(month + 1) / months);
    let within = move |passed: f64| (begin..end).contains(&passed);
    trips.iter().copied().filter(move |trip| within(trip.passed))
}

fn conditions(vehicle: &Vehicle) -> Vec<String> {
    vec![
        format!(
            "vehicle: {}, linear model, roll angle over steer angle and lateral acceleration",
            vehicle.name
        ),
        format!(
            "trips of {TRIP_S:.0} s over a year, {:.0} % of them empty, the others with 5 to 20 t at \
             1.6 to 2.0 m; noise of {SNR_DB:.0} dB with the reference load",
            100.0 * EMPTY_SHARE
        ),
        format!(
            "the roll stiffness of all suspensions falls to {:.0} % over the year",
            100.0 * WORN
        ),
    ]
}

/// The laden trips of each truck in a year.
///
/// # Errors
/// If the vehicle cannot be simulated.
pub fn in_service(vehicle: &Vehicle, what: InService) -> Result<Vec<Vec<LadenTrip>>, VehicleError> {
    let seeds = 1..=u64::from(what.trucks);
    seeds
        .into_par_iter()
        .map(|seed| Truck::new(vehicle, what.truck, seed)?.year(what.trips))
        .collect()
}
