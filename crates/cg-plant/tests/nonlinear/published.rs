//! V10 and the limit of a rigid truck, V11.

use std::f64::consts::TAU;

use cg_plant::plant::{PlantOptions, Progress, YawRollPlant};
use cg_vehicle::Vehicle;

use super::{G, KMH, at_height, peak, plant, rounded, vehicle};

/// Greatest steady lateral acceleration in a slow ramp of steer (1 degree in 12 s), in g.
fn static_rollover_threshold(vehicle: &Vehicle, height_m: f64) -> f64 {
    let load = at_height(vehicle, height_m);
    let plant = YawRollPlant::new(vehicle, load, &PlantOptions::default()).unwrap();
    let speed_mps = 90.0 * KMH;
    let mut run = plant.start(speed_mps).unwrap();
    let mut most = 0.0_f64;
    for k in 1..6000 {
        if run.push(0.0015 * f64::from(k) * 0.01, speed_mps, 0.01) != Progress::Running {
            return most / G;
        }
        most = most.max(run.sample().trailer.lateral_acceleration_mps2);
    }
    f64::INFINITY
}

/// Ervin and others, UMTRI 1986: payload c.g. 83.5, 88.6 and 105 in of an 80 000 lb five-axle
/// combination. The make of springs, tires and fifth wheel moves the threshold by ±0.03 g (the fifth
/// wheel alone, 2.5e5 to 6.5e6 N m/rad: 0.31 to 0.41 g), rounding of the printed digits by 0.01 g.
#[test]
fn static_rollover_thresholds_are_the_published_ones() {
    let vehicle = vehicle("baseline-tables");
    for (height_m, known) in [(2.07, 0.34), (2.19, 0.32), (2.53, 0.24)] {
        let threshold = static_rollover_threshold(&vehicle, height_m);
        println!("sprung c.g. {height_m} m: {threshold:.3} g, published {known}");
        assert!((threshold - known).abs() < 0.04, "{threshold} {known}");
    }
}

/// Five-axle semitrailers have a rearward amplification of about one (0.4 Hz, 88 km/h).
#[test]
fn rearward_amplification_is_about_one() {
    let vehicle = vehicle("baseline-tables");
    let plant = plant(&vehicle);
    let mut run = plant.start(88.0 * KMH).unwrap();
    let mut samples = Vec::new();
    while run.time_s() < 6.0 {
        let time_s = run.time_s() + 1e-3;
        let steer_rad = if time_s < 2.5 { 0.02 * (TAU * 0.4 * time_s).sin() } else { 0.0 };
        run.push(steer_rad, 88.0 * KMH, 1e-3);
        samples.push(run.sample());
    }
    let tractor = peak(&samples, |s| s.tractor.lateral_acceleration_mps2);
    let trailer = peak(&samples, |s| s.trailer.lateral_acceleration_mps2);
    println!("{:.3} g and {:.3} g: {:.2}", tractor / G, trailer / G, trailer / tractor);
    // "About": published values of such combinations differ by a tenth.
    assert!((trailer / tractor - 1.0).abs() < 0.1);
}

/// Load transfer at 0.15 g, from moments alone: `a_y Σ m h` divided by half the load-weighted track,
/// plus the effect of the roll angle itself (a tenth at 2 degrees).
#[test]
fn load_transfer_is_what_moments_say() {
    let vehicle = vehicle("baseline-tables");
    let plant = plant(&vehicle);
    let speed_mps = 50.0 * KMH;
    let mut run = plant.start(speed_mps).unwrap();
    let samples = rounded(&mut run, 0.0427, speed_mps, 15.0);
    let end = samples[samples.len() - 1];
    let lateral_g = end.trailer.lateral_acceleration_mps2 / G;
    println!("{lateral_g:.3} g: {:.3}", end.load_transfer_ratio);
    assert!((lateral_g - 0.15).abs() < 0.005);
    // For all axles: Σ (right − left) y_mean compared with a_y Σ m h at road level.
    let mut resisting = 0.0;
    let mut overturning = vehicle.tractor.sprung_mass_kg * vehicle.tractor.cg_height_m;
    let sprung = vehicle.trailer_sprung_mass(vehicle.reference_load()).unwrap();
    overturning += sprung.mass_kg * sprung.cg_height_m;
    for (placed, seen) in vehicle.axles().iter().zip(end.axles()) {
        let positions = &placed.axle.tyre_positions_m;
        #[allow(clippy::cast_precision_loss)] // one or two
        let mean_m = positions.iter().sum::<f64>() / positions.len() as f64;
        resisting += (seen.right_load_n - seen.left_load_n) * mean_m;
        overturning += placed.axle.unsprung_mass_kg * placed.axle.center_height_m;
    }
    let ratio = resisting / (overturning * end.trailer.lateral_acceleration_mps2);
    println!("moment of the tires divided by that of the masses: {ratio:.3}");
    // The ratio is above one because of the roll angle (m g h φ: φ/a_y = 2.2 degrees per 0.15 g is at
    // most 0.25 of it) and the difference between outer and inner tires (up to 0.05).
    assert!(ratio > 1.0 && ratio < 1.3, "{ratio}");
    assert!((end.load_transfer_ratio - 0.32).abs() < 0.03, "{}", end.load_transfer_ratio);
}

/// A rigid truck on single tires, all at 1 m, lifts its last inner wheel at `T/2 Σ m / Σ m h`.
#[test]
fn a_rigid_truck_lifts_at_half_its_track_over_its_height() {
    let vehicle = crate::common::rigid_truck();
    let sprung = vehicle.trailer_sprung_mass(vehicle.reference_load()).unwrap();
    let tractor = &vehicle.tractor;
    let mut mass = tractor.sprung_mass_kg + sprung.mass_kg;
    let mut moment =
        tractor.sprung_mass_kg * tractor.cg_height_m + sprung.mass_kg * sprung.cg_height_m;
    for placed in vehicle.axles() {
        mass += placed.axle.unsprung_mass_kg;
        moment += placed.axle.unsprung_mass_kg * placed.axle.center_height_m;
    }
    let expected = mass / moment;
    let plant = plant(&vehicle);
    let mut run = plant.start(90.0 * KMH).unwrap();
    let mut steer_rad = 0.0;
    while run.sample().axles().iter().any(|axle| !axle.left_lifted()) {
        steer_rad += 1e-5;
        assert_eq!(run.push(steer_rad, 90.0 * KMH, 0.01), Progress::Running);
    }
    let found = run.sample().trailer.lateral_acceleration_mps2 / vehicle.gravity_mps2;
    println!("{found:.4} g, rigid {expected:.4} g");
    // 80 kN on one side deflect a tire and a spring of 4e7 N/m by 2 mm each. On a track of 2 m this is
    // 0.003 rad of roll, which takes 6 mm of one meter at the c.g. height of 1.8 m. The axles do not
    // lift at the same time, and the first ones have rolled further by then.
    assert!((found / expected - 1.0).abs() < 0.015, "{found} {expected}");
}
