//! x
#![allow(clippy::unwrap_used)]
mod common;
use cg_core::Channel;
use cg_vehicle::accuracy::{Experiment, Score, Truck};
use cg_vehicle::estimate::Method;
use cg_vehicle::maneuver::Maneuver;
use cg_vehicle::sensors::Sensors;
use cg_vehicle::simulate::Scenario;

fn print(name: &str, s: Score) {
    println!(
        "{name:40} n {:4} bias {:+.2} rmse {:.2} stated {:.2} bound {:.2} % cover {:.1}",
        s.answered,
        100.0 * s.bias,
        100.0 * s.rmse,
        100.0 * s.stated_sd,
        100.0 * s.bound,
        100.0 * s.coverage
    );
}

#[test]
fn explore() {
    let vehicle = common::vehicle("baseline.toml");
    let perfect = Sensors { snr_db: Some(20.0), ..Sensors::default() };
    let cases: Vec<(&str, Sensors)> = vec![
        ("20 dB", perfect),
        ("lateral noise 0.1", Sensors { lateral_noise_mps2: 0.1, ..perfect }),
        ("lateral noise 0.3", Sensors { lateral_noise_mps2: 0.3, ..perfect }),
        ("s noise 0.3 deg", Sensors { steer_noise_rad: 0.0052, ..perfect }),
    ];
    for channel in [Some(Channel::Steer), Some(Channel::LateralAcceleration)] {
        for truck in [Truck::OfTheFile] {
            println!("{channel:?} {truck:?}");
            for (name, sensors) in &cases {
                let scenario =
                    Scenario { sensors: *sensors, ..Scenario::of(&vehicle, Maneuver::RoundedStep) };
                let e = Experiment {
                    channel,
                    truck,
                    runs: 200,
                    method: if std::env::var("GAIN").is_ok() {
                        Method::Gain
                    } else {
                        Method::Filtered
                    },
                    ..Experiment::of(scenario)
                };
                print(name, e.score(&vehicle).unwrap());
            }
        }
    }
}
