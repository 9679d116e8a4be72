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
        ("30 dB", Sensors { snr_db: Some(30.0), ..perfect }),
        ("10 dB", Sensors { snr_db: Some(10.0), ..perfect }),
        ("5 dB", Sensors { snr_db: Some(5.0), ..perfect }),
        ("noise lag 0.05", Sensors { noise_lag_s: 0.05, ..perfect }),
        ("noise lag 0.3", Sensors { noise_lag_s: 0.3, ..perfect }),
        ("noise lag 1", Sensors { noise_lag_s: 1.0, ..perfect }),
        ("offset", Sensors { roll_offset_rad: 0.0087, ..perfect }),
        ("steer offset", Sensors { steer_offset_rad: 0.0044, ..perfect }),
        ("quantisation", Sensors { quantisation_rad: 0.00087, ..perfect }),
        ("quant 0.5 deg", Sensors { quantisation_rad: 0.0087, ..perfect }),
        ("steer noise 0.1 deg", Sensors { steer_noise_rad: 0.00175, ..perfect }),
        ("lateral noise 0.3", Sensors { lateral_noise_mps2: 0.3, ..perfect }),
        ("play 0.5 deg", Sensors { steer_play_rad: 0.0087, ..perfect }),
        ("delay 0.1", Sensors { delay_s: 0.1, ..perfect }),
        ("delay 0.3", Sensors { delay_s: 0.3, ..perfect }),
        ("inclinometer", Sensors { inclinometer: true, ..perfect }),
        ("jitter", Sensors { jitter_s: 0.004, ..perfect }),
        ("20 % lost", Sensors { drop_out: 0.2, ..perfect }),
        ("saturation 1 deg", Sensors { roll_limit_rad: Some(0.0175), ..perfect }),
    ];
    for channel in [Some(Channel::Steer), Some(Channel::LateralAcceleration), None] {
        for truck in [Truck::OfTheFile, Truck::Drawn] {
            println!("{channel:?} {truck:?}");
            for (name, sensors) in &cases {
                let scenario =
                    Scenario { sensors: *sensors, ..Scenario::of(&vehicle, Maneuver::RoundedStep) };
                let e = Experiment {
                    channel,
                    truck,
                    runs: 200,
                    method: Method::Filtered,
                    ..Experiment::of(scenario)
                };
                print(name, e.score(&vehicle).unwrap());
            }
        }
    }
}
