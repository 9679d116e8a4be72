//! The place of the payload: axle loads, leveled springs, and the uncertainty of the ratios.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::CHANNELS;
use cg_vehicle::balance::static_balance;
use cg_vehicle::belief::{Belief, Covariance};
use cg_vehicle::linear::ratio_line;
use cg_vehicle::scales::{Scale, Scales};
use cg_vehicle::{Load, Variant, Vehicle};

const SPEED_MPS: f64 = 13.9;
/// Scales of `sensors.mass` whose own errors are zero.
const EXACT_SCALES: &str = r#"{ "vehicle_weight_sd": 0, "axle_load_sd": 0, "pressure_sd": 0 }"#;

fn laden(vehicle: &Vehicle, payload_kg: f64) -> Load {
    let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
    Load { trailer_mass_kg, ..vehicle.reference_load() }
}

/// The trailer of "euro" by hand: 20 t at 5.2 m and 4.4 t of tare at 5.6 m behind the fifth wheel stand
/// on it and on three axles with the same load, in the middle 7.7 m behind it. Half a meter to the
/// front, 20 t · 0.5/7.7 go from the axles to the fifth wheel, and further to the tractor's axles as
/// their levers divide it.
#[test]
fn a_payload_farther_to_the_front_loads_the_fifth_wheel() {
    let vehicle = common::vehicle("euro.toml");
    let load = laden(&vehicle, 20e3);
    let moved = vehicle.with_payload_at(load, 4.7).unwrap();
    let [usual, front] = [&vehicle, &moved].map(|truck| static_balance(truck, load).unwrap());
    let g = vehicle.gravity_mps2;
    let on_axles_n = |payload_m: f64| g * (20e3 * payload_m + 4.4e3 * 5.6) / 7.7;
    let close = |value: f64, known: f64| assert!((value / known - 1.0).abs() < 1e-9, "{value}");
    close(usual.hitch_load_n, 24.4e3 * g - on_axles_n(5.2));
    close(front.hitch_load_n, 24.4e3 * g - on_axles_n(4.7));
    let change_n = 20e3 * g * 0.5 / 7.7;
    let tractor = &vehicle.tractor;
    let of_hitch = |i: usize| tractor.axle[i].ahead_of_cg_m + tractor.hitch_behind_cg_m;
    let wheelbase_m = of_hitch(0) - of_hitch(1);
    for i in 0..5 {
        let change = front.axle_load_n[i] - usual.axle_load_n[i];
        match i {
            0 => close(change, -change_n * of_hitch(1) / wheelbase_m),
            1 => close(change, change_n * of_hitch(0) / wheelbase_m),
            _ => close(change, -change_n / 3.0),
        }
    }
}

/// A mass from axle loads assumes the place in the file: with 20 t of payload 0.3 m farther to the rear
/// the trailer's axles show 0.3/5.2 of the payload too much, and the drive axle 0.3/2.5 too little. With
/// 0.3 m as the standard deviation of the place, these are those of the mass, to the second order of 0.3 m:
/// (0.3/5.2)² and (0.3/2.5)² of them.
#[test]
fn a_mass_from_axle_loads_is_wrong_with_the_place() {
    let mut vehicle = common::vehicle("euro.toml");
    vehicle.uncertainty.payload_place_sd_m = 0.3;
    let load = laden(&vehicle, 20e3);
    let moved = vehicle.with_payload_at(load, 5.5).unwrap();
    let shown_kg = |[at_zero_kg, slope]: [f64; 2], axles: std::ops::Range<usize>| {
        let load_n: f64 = static_balance(&moved, load).unwrap().axle_load_n[axles].iter().sum();
        at_zero_kg + slope * load_n / vehicle.gravity_mps2
    };
    let of_trailer = shown_kg(vehicle.mass_of_axle_load().unwrap(), 2..5) - load.trailer_mass_kg;
    let of_drive = shown_kg(vehicle.mass_of_drive_load().unwrap(), 1..2) - load.trailer_mass_kg;
    println!(
        "mass from the trailer's axles {of_trailer:+.0} kg, from the drive axle {of_drive:+.0} kg"
    );
    assert!((of_trailer - 20e3 * 0.3 / 5.2).abs() < 1e-3, "{of_trailer}");
    assert!((of_drive + 20e3 * 0.3 / 2.5).abs() < 1e-3, "{of_drive}");

    vehicle.sensors.mass = Some(serde_json::from_str(EXACT_SCALES).unwrap());
    let scales = Scales::of(&vehicle);
    let of = |scale, mass_kg: f64| scales.sd_kg(scale, mass_kg);
    for (scale, known_kg, lever_m) in [
        (Scale::AxleLoad, of_trailer, 5.2),
        (Scale::SuspensionPressure, of_trailer, 5.2),
        (Scale::DrivePressure, of_drive, 2.5),
    ] {
        let found_kg = of(scale, load.trailer_mass_kg);
        let second_order = (0.3_f64 / lever_m).powi(2);
        let ratio = found_kg / known_kg.abs();
        assert!((ratio - 1.0).abs() < 1.1 * second_order, "{scale}: {ratio}");
        // An empty trailer has no payload that could stand elsewhere.
        assert!(of(scale, vehicle.empty_trailer_mass_kg()) < 1e-6, "{scale}");
    }
    assert!(of(Scale::VehicleWeight, load.trailer_mass_kg) < 1e-12);
}

/// Air springs follow the load that they carry. Their stiffness in the file is that under the reference
/// load at the file's place, also for a payload that stands elsewhere.
#[test]
fn leveled_springs_follow_the_place_of_the_payload() {
    let vehicle = common::vehicle("air.toml");
    let load = vehicle.reference_load();
    let place_m = vehicle.trailer.payload.behind_hitch_m;
    let moved = vehicle.with_payload_at(load, place_m + 0.5).unwrap();
    let sprung_n = |truck: &Vehicle| {
        let axles = truck.axles();
        let last = axles.last().unwrap();
        assert!(last.on_trailer);
        let load_n = static_balance(truck, load).unwrap().axle_load_n[axles.len() - 1];
        load_n - last.axle.unsprung_mass_kg * truck.gravity_mps2
    };
    let stiffness = |truck: &Vehicle| truck.trailer.axle[1].axle.spring_stiffness_n_per_m;
    let (by_load, by_stiffness) =
        (sprung_n(&moved) / sprung_n(&vehicle), stiffness(&moved) / stiffness(&vehicle));
    assert!(by_load > 1.02, "{by_load}");
    assert!((by_stiffness / by_load - 1.0).abs() < 1e-9, "{by_stiffness} {by_load}");
    // Once more under the same load changes nothing.
    assert_eq!(*moved.with_springs_at(load).unwrap(), moved);
}

/// What a place adds to the covariance of the ratios is the change that it makes, in all channels at
/// once; nothing for the empty trailer.
#[test]
fn the_place_is_in_the_covariance_of_the_ratios() {
    for name in ["kraz.toml", "euro.toml", "baseline.toml", "air.toml"] {
        let vehicle = common::vehicle(name);
        let place_m = vehicle.trailer.payload.behind_hitch_m;
        for payload_kg in [0.0, 10e3, 25e3] {
            let load = laden(&vehicle, payload_kg);
            let ratios = |behind_m: f64| {
                let moved = vehicle.with_payload_at(load, behind_m).unwrap();
                let lines = ratio_line(&moved, Variant::Complete, SPEED_MPS, load).unwrap();
                lines.map(|line| line.ratio_at(load.cg_height_m))
            };
            let (front, rear) = (ratios(place_m - 0.3), ratios(place_m + 0.3));
            let belief = Belief {
                covariance: Covariance::zeros(),
                residual_sd: 0.0,
                ..Belief::prior(&vehicle)
            };
            let covariance = |sd_m: f64| {
                let mut vehicle = vehicle.clone();
                vehicle.uncertainty.payload_place_sd_m = sd_m;
                belief.ratio_covariance(&vehicle, Variant::Complete, SPEED_MPS, load).unwrap()
            };
            let (without, with) = (covariance(0.0), covariance(0.3));
            let change: [f64; CHANNELS] = std::array::from_fn(|i| 0.5 * (rear[i] / front[i]).ln());
            println!("{name} {:2.0} t: {:+.2?} %", payload_kg / 1e3, change.map(|by| 100.0 * by));
            for i in 0..CHANNELS {
                for j in 0..CHANNELS {
                    let added = with[i][j] - without[i][j];
                    // Measured springs alone have variances of up to 1e-2.
                    assert!((added - change[i] * change[j]).abs() < 1e-15, "{name} {i} {j}");
                }
            }
            assert!(payload_kg > 0.0 || change.iter().all(|change| change.abs() < 1e-9));
        }
    }
}
