//! The channel from lateral acceleration to roll on the linear plant: a noisy accelerometer at the
//! speeds of city and motorway, and a roll sensor whose range is too small.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::{AlignSettings, Channel, Design};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::design;
use cg_vehicle::{Load, Variant, Vehicle};

const SEEDS: u32 = 100;

/// The estimate of the channel from a turn of 18 s at 50 Hz. No row has a steer angle.
fn turn(vehicle: &Vehicle, design: &Design<f64>, scenario: Scenario) -> LogEstimate {
    let channel = Some(Channel::LateralAcceleration);
    let options = EstimateOptions { channel, ..EstimateOptions::default() };
    let mut estimator = LogEstimator::from_design(design, AlignSettings::NONE, options);
    let scenario = Scenario { rate_hz: 50.0, duration_s: 20.0, ..scenario };
    LogSimulation::new(vehicle, scenario)
        .unwrap()
        .run(|row| {
            let mut row = *row;
            row.steer_rad = f64::NAN;
            estimator.push(&row).map(drop)
        })
        .unwrap();
    estimator.finish()
}

/// Noise of the input lowers the identified ratio unless the expected products of the filtered noise are
/// subtracted; they change with the speed. A bias of 0.3 of the scatter would widen no interval
/// noticeably, and the mean of 100 errors has another 0.3 at three standard deviations. Without the
/// correction the bias is 3.6 of the scatter (kraz, 7 m/s). The noise must also not look like a truck
/// that rolls on while the roll angle of the steady turn is constant.
#[test]
fn noise_of_the_accelerometer_moves_no_height_at_any_speed() {
    let (noise_mps2, n) = (0.2, f64::from(SEEDS));
    for name in ["kraz.toml", "euro.toml"] {
        let vehicle = common::vehicle(name);
        let design = design(&vehicle, Variant::Complete).unwrap();
        for speed_mps in [7.0, 10.0, 20.0] {
            let error = |seed: u32, lateral_noise_mps2: f64| {
                let sensors =
                    Sensors { lateral_noise_mps2, snr_db: Some(40.0), ..Sensors::default() };
                let scenario = Scenario {
                    speed_mps,
                    seed: u64::from(seed),
                    sensors,
                    ..Scenario::of(&vehicle, Maneuver::RoundedStep)
                };
                let height_m = turn(&vehicle, &design, scenario).height_m.unwrap();
                height_m / scenario.load.cg_height_m - 1.0
            };
            let by_noise = |seed: u32| error(seed, noise_mps2) - error(seed, 0.0);
            let errors: Vec<f64> = (0..SEEDS).map(by_noise).collect();
            let bias = errors.iter().sum::<f64>() / n;
            let scatter = (errors.iter().map(|e| (e - bias).powi(2)).sum::<f64>() / n).sqrt();
            println!("{name}, {speed_mps} m/s: bias {bias:+.4}, scatter {scatter:.4}");
            assert!(bias.abs() < 0.6 * scatter, "{name} {speed_mps}: {bias} of {scatter}");
            // 1 m/s² of true acceleration with 0.2 m/s² of noise on 900 rows, a few of them a degree
            // of freedom of the filters: a percent or a few.
            assert!((0.002..0.05).contains(&scatter), "{name} {speed_mps}: {scatter}");
        }
    }
}

/// Light and heavy loads, whose gain is far from the nominal one: strong noise moves no height, and what is stated is
/// not too small (the mean of 60 squares of a normal variable is below 1.55, three standard deviations of √(2/60)), nor
/// more than twice too great. The bounds of the bias are those above, for 60 draws.
#[test]
fn loads_far_from_the_nominal_one_have_right_intervals_in_noise() {
    const DRAWS: u32 = 60;
    for name in ["kraz.toml", "euro.toml"] {
        let vehicle = common::vehicle(name);
        let design = design(&vehicle, Variant::Complete).unwrap();
        for (trailer_mass_kg, cg_height_m) in [(14e3, 1.3), (26e3, 2.3)] {
            let height = |seed: u32, lateral_noise_mps2: f64| {
                let sensors =
                    Sensors { lateral_noise_mps2, snr_db: Some(40.0), ..Sensors::default() };
                let usual = Scenario::of(&vehicle, Maneuver::RoundedStep);
                let load = Load { trailer_mass_kg, cg_height_m };
                let scenario = Scenario { load, seed: u64::from(seed), sensors, ..usual };
                turn(&vehicle, &design, scenario)
            };
            let [mut bias, mut square, mut normal] = [0.0; 3];
            for seed in 0..DRAWS {
                let [clean, noisy] = [0.0, 0.2].map(|noise_mps2| height(seed, noise_mps2));
                let error_m = noisy.height_m.unwrap() - clean.height_m.unwrap();
                bias += error_m / f64::from(DRAWS);
                square += error_m * error_m / f64::from(DRAWS);
                normal += (error_m / noisy.height_random_sd_m.unwrap()).powi(2) / f64::from(DRAWS);
            }
            println!("{name} {trailer_mass_kg}: {bias:+.4} of {:.4} m, {normal:.2}", square.sqrt());
            assert!(bias.abs() < 0.7 * square.sqrt(), "{name} {trailer_mass_kg}: {bias}");
            assert!((0.25..1.55).contains(&normal), "{name} {trailer_mass_kg}: {normal}");
        }
    }
}

/// Without a steer angle nothing but the lateral acceleration shows that the truck rolls on.
#[test]
fn a_roll_angle_that_ends_at_one_degree_is_seen_by_this_channel_alone() {
    for name in ["kraz.toml", "euro.toml"] {
        let vehicle = common::vehicle(name);
        let design = design(&vehicle, Variant::Complete).unwrap();
        for (limit_rad, rejected) in [(1_f64.to_radians(), true), (20_f64.to_radians(), false)] {
            let sensors = Sensors { roll_limit_rad: Some(limit_rad), ..Sensors::default() };
            let usual = Scenario::of(&vehicle, Maneuver::RoundedStep);
            let found = turn(&vehicle, &design, Scenario { sensors, ..usual });
            assert_eq!(found.height_m.is_none(), rejected, "{name}: {:?}", found.messages);
            let says = |words: &str| found.messages.iter().any(|message| message.contains(words));
            assert_eq!(says("inconsistent"), rejected, "{name}: {:?}", found.messages);
        }
    }
}
