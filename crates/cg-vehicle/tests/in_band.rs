//! The reduced models of the channels whose input is an acceleration, in a turn and in a lane change.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, reason = "helpers of tests")]

use crate::common;
use std::f64::consts::TAU;

use cg_core::truck::channel::ROLL_LAG_S;
use cg_core::{Channel, Reduced5};
use cg_vehicle::equations::Equations;
use cg_vehicle::reduction::quality::rounded_step;
use cg_vehicle::reduction::reduce;
use cg_vehicle::response::StateSpace;
use cg_vehicle::system::{Rational, multiplied};
use cg_vehicle::{Variant, Vehicle};

const CHANNELS: [Channel; 3] =
    [Channel::LateralAcceleration, Channel::Suspension, Channel::Tractor];
const INTERVAL_S: f64 = 0.05;
const LANE_CHANGE_HZ: f64 = 0.3;

fn model(vehicle: &Vehicle, payload_kg: f64, speed_mps: f64) -> StateSpace {
    let load = vehicle.usual_load(vehicle.empty_trailer_mass_kg() + payload_kg);
    Equations::new(vehicle, Variant::Complete, speed_mps, load).unwrap().state_space().unwrap()
}

/// A rounded step of 2 1/s that lasts 12 s, and one period of a sine.
fn maneuvers() -> [Vec<f64>; 2] {
    let times = || (0..240).map(|k| f64::from(k) * INTERVAL_S);
    let step = times().map(|t| rounded_step(t, 2.0)).collect();
    let sine =
        |t: f64| if t < 1.0 / LANE_CHANGE_HZ { (TAU * LANE_CHANGE_HZ * t).sin() } else { 0.0 };
    [step, times().map(sine).collect()]
}

fn power(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// What a unit-gain model leaves of the roll angle in both maneuvers, after `lag_s`.
fn left(truck: &StateSpace, channel: Channel, unit: &Rational, lag_s: f64) -> [f64; 2] {
    let (input, output) =
        (truck.to_input(channel.input()).unwrap(), truck.to_output(channel.output()));
    let gain = output.moments(1).unwrap()[0] / input.moments(1).unwrap()[0];
    maneuvers().map(|steer| {
        let mut roll = output.response(&steer, INTERVAL_S);
        if lag_s > 0.0 {
            let a = 1.0 / lag_s;
            let lags = Rational { numerator: vec![a * a], denominator: vec![a * a, 2.0 * a, 1.0] };
            roll = lags.system().response(&roll, INTERVAL_S);
        }
        let expected = unit.system().response(&input.response(&steer, INTERVAL_S), INTERVAL_S);
        let rest: Vec<f64> = roll.iter().zip(expected).map(|(y, e)| y - gain * e).collect();
        (power(&rest) / power(&roll)).sqrt()
    })
}

/// The model at `pace`, with a gain of one.
fn unit(reduced: &Reduced5<f64>, pace: f64) -> Rational {
    let reduced = reduced.at_unit_gain();
    let mut numerator = reduced.numerator.to_vec();
    for (own, slope) in numerator[1..].iter_mut().zip(reduced.speed_slope) {
        *own += pace * slope;
    }
    let mut denominator = reduced.denominator.to_vec();
    denominator.push(1.0);
    Rational { numerator, denominator }
}

/// The model with the first six Taylor coefficients of the exact transfer function.
fn taylor(truck: &StateSpace, channel: Channel, denominator: &[f64]) -> Rational {
    let series = |system: cg_vehicle::system::System| system.moments(6).unwrap();
    let input = series(truck.to_input(channel.input()).unwrap());
    let output = series(truck.to_output(channel.output()));
    let mut quotient: Vec<f64> = Vec::new();
    for k in 0..6 {
        let known: f64 = (0..k).map(|j| quotient[j] * input[k - j]).sum();
        quotient.push((output[k] - known) / input[0]);
    }
    let gain = quotient[0];
    let numerator = multiplied(denominator, &quotient)[..6].iter().map(|a| a / gain).collect();
    Rational { numerator, denominator: denominator.to_vec() }
}

/// A ratio is identified from what the model explains. What it leaves of the roll angle in a step is
/// alike in all turns, so it must be less than the 1 % that the ratio is to be known to, on air springs.
/// The empty baseline truck rolls at 1.8 Hz on stiff leaf springs.
#[test]
fn the_models_explain_turns_and_lane_changes() {
    println!("| truck | payload | channel | step | lane change | Taylor: step | lane change |");
    for file in ["kraz.toml", "euro.toml", "baseline.toml"] {
        let vehicle = common::vehicle(file);
        for payload_kg in [0.0, 12e3, 25e3] {
            let truck = model(&vehicle, payload_kg, vehicle.nominal_speed_mps);
            let models = reduce(&truck, &[]).unwrap();
            for channel in CHANNELS {
                let own = unit(&models.of_channels[channel.index()], 0.0);
                let [step, change] = left(&truck, channel, &own, ROLL_LAG_S);
                let reference = taylor(&truck, channel, &own.denominator);
                let [step_then, change_then] = left(&truck, channel, &reference, 0.0);
                println!(
                    "| {file} | {:.0} t | {channel} | {:.2} | {:.1} | {:.2} | {:.1} |",
                    payload_kg / 1e3,
                    100.0 * step,
                    100.0 * change,
                    100.0 * step_then,
                    100.0 * change_then
                );
                let has_leaf_springs = file == "baseline.toml";
                assert!(step < 0.01 || has_leaf_springs, "{file} {payload_kg} {channel}: {step}");
                // The trailer's own suspension and acceleration move together; the empty one gives up some of
                // a lane change to keep the noise of the sensor out.
                let gives_up = channel == Channel::Suspension && payload_kg == 0.0;
                let most = if gives_up { 1.25 * change_then } else { change_then };
                assert!(change < most, "{file} {payload_kg} {channel}: {change}");
            }
        }
    }
}

/// White noise of an input at 50 Hz, in the expected roll angle after the lags: less than in the input.
/// (A numerator that is only best in the band passes 3 to 5 times its power in the trailer's pair at 12 t.)
#[test]
fn noise_of_the_input_does_not_grow() {
    for file in ["kraz.toml", "euro.toml", "baseline.toml", "air.toml"] {
        let vehicle = common::vehicle(file);
        for payload_kg in [12e3, 25e3] {
            let truck = model(&vehicle, payload_kg, vehicle.nominal_speed_mps);
            let models = reduce(&truck, &[]).unwrap();
            for channel in CHANNELS {
                let own = unit(&models.of_channels[channel.index()], 0.0);
                let system = own.system();
                let square = |k: i32| system.magnitude(0.5 * f64::from(k)).unwrap().powi(2);
                let power = (1..=314).map(square).sum::<f64>() / 314.0;
                println!("{file} {payload_kg} {channel}: {power:.2}");
                assert!(power < 1.0, "{file} {payload_kg} {channel}: {power}");
            }
        }
    }
}

/// At speeds between those to which the slope is fitted, a model with it leaves less than one of a single
/// speed: of the trailer's channels an eighth to a third, of the tractor's channel, whose poles change
/// too, a half to four fifths.
#[test]
fn the_numerators_follow_the_speed() {
    for file in ["kraz.toml", "euro.toml"] {
        let vehicle = common::vehicle(file);
        let nominal_mps = vehicle.nominal_speed_mps;
        for payload_kg in [0.0, 16e3] {
            let at = |pace: f64| model(&vehicle, payload_kg, nominal_mps / (1.0 + pace));
            let others = [1.3, 0.45, -0.27, -0.42].map(|pace| (pace, at(pace)));
            let models = reduce(&at(0.0), &others).unwrap();
            for channel in CHANNELS {
                let reduced = &models.of_channels[channel.index()];
                for pace in [0.8, -0.35] {
                    let truck = at(pace);
                    let [with, _] = left(&truck, channel, &unit(reduced, pace), ROLL_LAG_S);
                    let [without, _] = left(&truck, channel, &unit(reduced, 0.0), ROLL_LAG_S);
                    println!("{file} {payload_kg} {channel} {pace}: {with:.4} for {without:.4}");
                    let share = if channel == Channel::Tractor { 0.85 } else { 0.4 };
                    assert!(with < share * without, "{file} {channel} {pace}: {with} {without}");
                }
            }
        }
    }
}
