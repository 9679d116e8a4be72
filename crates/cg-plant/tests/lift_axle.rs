//! Trucks with a raised lift axle that differ from their file, calibrated with the axle down: whether their intervals hold.
#![allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "helpers of tests")]

use crate::{common, drawn};
use cg_logs::calibrate::{CalibrateOptions, Calibrator, KnownLoad, KnownLog};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator, RoadChoice, Truck};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::belief::{Belief, Deviations, adjusted};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Load, Vehicle, VehicleError};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, StandardNormal};

/// Payload, kg, and height, m, with the axle raised.
const LOADS: [(f64, f64); 2] = [(5e3, 1.6), (11e3, 1.95)];
/// The same of the turns of a calibration, with the axle down; the first is empty.
const KNOWN: [(f64, Option<f64>); 2] = [(0.0, None), (18e3, Some(1.9))];
/// Number of trucks of each vehicle.
const TRUCKS: u64 = 16;

/// A vehicle whose first trailer axle can be raised by 10 cm.
fn lifting(name: &str) -> Vehicle {
    let mut vehicle = common::vehicle(name);
    vehicle.trailer.axle[0].lift_m = Some(0.1);
    vehicle
}

/// A truck that differs from its file, as the file says of its own uncertainty.
struct Drawn<'a> {
    file: &'a Vehicle,
    calibrator: &'a Calibrator<'a>,
    deviations: Deviations,
    seed: u64,
}

/// A payload, kg, at a height, m, or the height of the empty trailer.
fn load_of(file: &Vehicle, (payload_kg, height_m): (f64, Option<f64>)) -> Load {
    file.load_of(Some(file.empty_trailer_mass_kg() + payload_kg), height_m)
}

impl Drawn<'_> {
    /// A turn in noise of 30 dB, with the lift axle in a position and this payload, kg; the height is that of the
    /// empty trailer if it is not given, m.
    fn turn(
        &self,
        position: LiftAxle,
        load: (f64, Option<f64>),
        noise: u64,
    ) -> (Load, Vec<LogRow>) {
        let file = self.file.clone().with_lift_axle(position).unwrap();
        let truck = adjusted(&file, &self.deviations);
        let load = load_of(&file, load);
        let scenario = Scenario {
            plant: Plant::Nonlinear,
            load,
            rate_hz: 50.0,
            duration_s: 12.0,
            sensors: Sensors { snr_db: Some(30.0), ..Sensors::default() },
            seed: 10 * self.seed + noise,
            ..Scenario::of(&truck, Maneuver::RoundedStep)
        };
        let seed = scenario.seed;
        let mut rows = LogSimulation::new(&truck, scenario).unwrap().rows();
        drawn::measure(&mut rows, (&file, &self.deviations), seed);
        for row in &mut rows {
            row.lift_axle = position.value();
        }
        (load, rows)
    }

    /// What is known after a calibration with a turn of the empty and of a laden trailer, all axles on the road.
    fn calibrated(&self) -> Belief {
        let turns = [0, 1].map(|k| self.turn(LiftAxle::Down, KNOWN[k], k as u64).1);
        let calibration = self.calibrator.calibrate::<VehicleError>(&[], |known, estimator| {
            for row in &turns[known.log.parse::<usize>().unwrap()] {
                estimator.push(row).unwrap();
            }
            Ok(())
        });
        calibration.unwrap().belief()
    }

    /// The truck of the file after a calibration, with its axles down, and with one raised.
    fn positions(&self) -> (Truck, Option<Truck>) {
        let road = Some(RoadChoice::FLAT); // that of the plant
        let options = EstimateOptions { road, ..EstimateOptions::default() };
        Truck::positions(self.file, &self.calibrated(), options).unwrap()
    }
}

fn estimate((down, raised): &(Truck, Option<Truck>), load: Load, rows: &[LogRow]) -> LogEstimate {
    let weighed = |truck: &Truck| {
        let trailer_mass_kg = Some(load.trailer_mass_kg);
        let options = EstimateOptions { trailer_mass_kg, ..truck.options };
        Truck { options, ..truck.clone() }
    };
    let mut estimator = LogEstimator::of_positions(&weighed(down), raised.as_ref().map(weighed));
    for row in rows {
        estimator.push(row).unwrap();
    }
    estimator.finish()
}

/// For each load: whether the interval holds the truth, the error divided by its standard deviation, and relative.
fn outcome(drawn: &Drawn<'_>) -> [(bool, f64, f64); 2] {
    let positions = drawn.positions();
    [0, 1].map(|k| {
        let (payload_kg, height_m) = LOADS[k];
        let (load, rows) = drawn.turn(LiftAxle::Raised, (payload_kg, Some(height_m)), 2 + k as u64);
        let estimate = estimate(&positions, load, &rows);
        let (found_m, sd_m) = (estimate.height_m.unwrap(), estimate.height_sd_m.unwrap());
        let [low_m, high_m] = estimate.height_ci95_m.unwrap();
        let error_m = found_m - height_m;
        ((low_m..=high_m).contains(&height_m), error_m / sd_m, error_m / height_m)
    })
}

/// 95 % intervals of 32 trucks. The loads of a truck have their errors in common, so that the share scatters by at most 3.9 % and the
/// mean square of the error divided by its standard deviation by 0.25; the tests are three of these.
#[test]
fn the_intervals_hold_with_an_axle_raised_after_a_calibration_with_it_down() {
    let mut all = Vec::new();
    for name in ["euro.toml", "air.toml"] {
        let file = lifting(name);
        let prior = Belief::prior(&file);
        let logs = [0, 1].map(|k| {
            let Load { trailer_mass_kg, cg_height_m } = load_of(&file, KNOWN[k]);
            let load = KnownLoad::exact(cg_height_m, Some(trailer_mass_kg));
            KnownLog { log: k.to_string(), load }
        });
        let how = CalibrateOptions { force: true, ..CalibrateOptions::default() };
        let calibrator = Calibrator::new(&file, how, &logs).unwrap();
        let mut source = StdRng::seed_from_u64(3);
        let trucks: Vec<Drawn<'_>> = (0..TRUCKS)
            .map(|seed| {
                let deviations = prior.drawn(|| StandardNormal.sample(&mut source));
                Drawn { file: &file, calibrator: &calibrator, deviations, seed }
            })
            .collect();
        let made = drawn::each(&trucks, outcome).concat();
        let rms =
            (made.iter().map(|(.., error)| error * error).sum::<f64>() / made.len() as f64).sqrt();
        let worst = made.iter().map(|(.., error)| error.abs()).fold(0.0, f64::max);
        println!("{name}: {:.1} % rms, {:.1} % at worst", 100.0 * rms, 100.0 * worst);
        all.extend(made);
    }
    let held = all.iter().filter(|(holds, ..)| *holds).count() as f64 / all.len() as f64;
    let square = all.iter().map(|(_, error, _)| error * error).sum::<f64>() / all.len() as f64;
    println!("{:.1} % hold; mean square {square:.2}", 100.0 * held);
    assert!(held >= 0.95 - 3.0 * 0.039, "{held}");
    assert!((0.25..=1.75).contains(&square), "{square}");
}
