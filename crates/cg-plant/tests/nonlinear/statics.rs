//! V1: loads at rest, settling, offset payload, banked road.

use cg_plant::plant::{Coordinate, PlantOptions, YawRollPlant};
use cg_vehicle::balance::static_balance;
use cg_vehicle::{Load, Vehicle};

use super::{KMH, flatbed, linear, plant, vehicle};

/// Figures 2.1 and 2.2 from the static balance: 1 N is one unit of the last digit.
#[test]
fn straight_running_carries_the_known_loads() {
    let sample = plant(&vehicle("baseline-tables")).start(50.0 * KMH).unwrap().sample();
    let known = [53_934.0, 83_353.0, 83_353.0, 83_358.0, 83_358.0];
    for (axle, known) in sample.axles().iter().zip(known) {
        let load_n = axle.left_load_n + axle.right_load_n;
        assert!((load_n - known).abs() < 1.0, "{load_n} {known}");
        assert!((axle.left_load_n - axle.right_load_n).abs() < 1e-9);
    }
    assert!((sample.hitch_load_n - 140_570.0).abs() < 10.0, "{}", sample.hitch_load_n);
}

/// The given heights are an equilibrium: only rounding moves the vehicle (forces of 1e5 N to 1e-16 on
/// 500 kg give 2e-14 m/s²; with the springs of the tires this is less than 1e-16 m in one second).
#[test]
fn straight_running_stays() {
    let rigid = ["baseline", "baseline-tables", "air", "kraz"].map(vehicle);
    for vehicle in rigid.into_iter().chain([flatbed()]) {
        let plant = plant(&vehicle);
        let mut run = plant.start(50.0 * KMH).unwrap();
        let start = run.state;
        for _ in 0..100 {
            run.push(0.0, 50.0 * KMH, 0.01);
        }
        for c in [
            Coordinate::TractorHeight,
            Coordinate::TractorPitch,
            Coordinate::TractorRoll,
            Coordinate::TrailerPitch,
            Coordinate::TrailerRoll,
            Coordinate::LateralVelocity,
            Coordinate::TractorYawRate,
            Coordinate::TrailerYawRate,
        ] {
            let moved = run.state.get(c) - start.get(c);
            assert!(moved.abs() < 1e-12, "{}, {c:?}: {moved:e}", vehicle.name);
        }
        assert!(
            (plant.trailer_cg_height_m(&start) - vehicle.trailer.reference_cg_height_m).abs()
                < 1e-12
        );
    }
}

/// With a separate design load the body settles, and the load's height is still its height at rest.
#[test]
fn a_lighter_load_lifts_the_body_and_keeps_its_height() {
    for vehicle in [vehicle("baseline"), flatbed()] {
        let design = vehicle.reference_load();
        let load = Load { trailer_mass_kg: design.trailer_mass_kg - 10_000.0, cg_height_m: 1.8 };
        let options = PlantOptions { design_load: Some(design), ..linear() };
        let plant = YawRollPlant::new(&vehicle, load, &options).unwrap();
        let run = plant.start(50.0 * KMH).unwrap();
        // Newton's method stops at accelerations of 1e-7: nanometers on springs of 1 Hz and above.
        assert!((plant.trailer_cg_height_m(&run.state) - 1.8).abs() < 1e-7);
        let balance = static_balance(&vehicle, load).unwrap();
        for (axle, known) in run.sample().axles().iter().zip(&balance.axle_load_n) {
            let ratio = (axle.left_load_n + axle.right_load_n) / known;
            // The frames pitch by up to 1/100 rad, which moves the c.g.s by 1 cm in 5 m.
            assert!((ratio - 1.0).abs() < 3e-3, "{ratio}");
        }
        let lifted = run.state.get(Coordinate::TractorHeight) - vehicle.tractor.cg_height_m;
        assert!(lifted > 0.0 && lifted < 0.05, "{lifted}");
    }
}

/// A payload 0.1 m to the left rolls the trailer to the left; a payload to the right rolls it as much
/// to the right.
#[test]
fn an_offset_payload_leans_to_its_side() {
    let vehicle = vehicle("baseline");
    let roll = |payload_left_m: f64| {
        let options = PlantOptions { payload_left_m, ..linear() };
        let plant = YawRollPlant::new(&vehicle, vehicle.reference_load(), &options).unwrap();
        plant.start(50.0 * KMH).unwrap().sample().trailer.roll_rad
    };
    let (left, right, twice) = (roll(0.1), roll(-0.1), roll(0.2));
    println!("0.1 m to the left: {:.3} degrees", left.to_degrees());
    assert!(left < 0.0);
    // Newton's residual of 1e-7 m/s² on a roll mode of 5 rad/s: 4e-9 rad.
    assert!((left + right).abs() < 1e-8, "{left} {right}");
    // Linear springs: the remaining difference is the square of a roll angle of 2 degrees.
    assert!((twice / left - 2.0).abs() < 5e-3, "{}", twice / left);
}

/// Roll angles of tractor and trailer under a roll moment on the trailer, from the potential energy in
/// docs/model.md: springs and tires of each axle in series, and loads on growing lever arms.
fn linear_lean_rad(vehicle: &Vehicle, load: Load, moment_nm: f64) -> [f64; 2] {
    let balance = static_balance(vehicle, load).unwrap();
    let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
    let heights_m = [tractor.cg_height_m, load.cg_height_m];
    let mut stiffness = [0.0; 2];
    for (placed, load_n) in vehicle.axles().iter().zip(&balance.axle_load_n) {
        let (axle, unit) = (placed.axle, usize::from(placed.on_trailer));
        let sprung_n = load_n - axle.unsprung_mass_kg * vehicle.gravity_mps2;
        let springs = placed.suspension_roll_stiffness_nm_per_rad();
        let tyres = placed.tyre_roll_stiffness_nm_per_rad()
            - load_n * axle.center_height_m
            - sprung_n * (axle.roll_center_height_m - axle.center_height_m);
        stiffness[unit] += springs * tyres / (springs + tyres)
            - sprung_n * (heights_m[unit] - axle.roll_center_height_m);
    }
    stiffness[0] += balance.hitch_load_n * (tractor.cg_height_m - hitch.height_m);
    stiffness[1] -= balance.hitch_load_n * (load.cg_height_m - hitch.height_m);
    let coupling = hitch.roll_stiffness_nm_per_rad;
    let trailer_rad =
        moment_nm / (stiffness[1] + coupling * stiffness[0] / (stiffness[0] + coupling));
    [trailer_rad * coupling / (stiffness[0] + coupling), trailer_rad]
}

/// The lean under a payload beside the middle, against linear statics.
#[test]
fn the_lean_is_that_of_the_roll_stiffness() {
    for name in ["baseline", "euro", "kraz"] {
        let vehicle = vehicle(name);
        let payload_kg = 20e3;
        let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
        let load = Load { trailer_mass_kg, cg_height_m: 1.9 };
        let lean = |payload_left_m: f64| {
            let options = PlantOptions { payload_left_m, ..linear() };
            let plant = YawRollPlant::new(&vehicle, load, &options).unwrap();
            let sample = plant.start(50.0 * KMH).unwrap().sample();
            [sample.tractor.roll_rad, sample.trailer.roll_rad]
        };
        let moment_nm = payload_kg * vehicle.gravity_mps2 * 0.05;
        let expected = linear_lean_rad(&vehicle, load, moment_nm);
        let (left, right) = (lean(0.05), lean(-0.05));
        for unit in 0..2 {
            // The mean of both sides has no second order; the third is the square of 5e-3 rad.
            let mean = 0.5 * (right[unit] - left[unit]);
            println!("{name} {:.4} {:.4} degrees", mean.to_degrees(), expected[unit].to_degrees());
            assert!((mean / expected[unit] - 1.0).abs() < 1e-3, "{name} {mean} {expected:?}");
        }
    }
}

/// On a banked road with the right side lower, gravity pulls to the right: the body rolls to the right,
/// the steer angle is to the left, and the lateral acceleration is zero.
#[test]
fn a_bank_is_held_by_steering_up_it() {
    for vehicle in [vehicle("baseline-tables"), flatbed()] {
        let options = PlantOptions { bank_rad: 0.035, ..PlantOptions::default() };
        let plant = YawRollPlant::new(&vehicle, vehicle.reference_load(), &options).unwrap();
        let mut run = plant.start(50.0 * KMH).unwrap();
        let start = run.sample();
        println!(
            "bank of 2 degrees: roll {:.3}, steer {:.3} degrees",
            start.trailer.roll_rad.to_degrees(),
            start.steer_rad.to_degrees()
        );
        assert!(start.trailer.roll_rad > 0.0);
        for _ in 0..500 {
            run.push(start.steer_rad, 50.0 * KMH, 0.01);
        }
        let end = run.sample();
        assert!((end.trailer.roll_rad - start.trailer.roll_rad).abs() < 1e-6);
        assert!(end.trailer.lateral_acceleration_mps2.abs() < 1e-5);
        let to_gravity_rad = end.trailer.roll_to_gravity_rad - end.trailer.roll_rad;
        assert!((to_gravity_rad / 0.035 - 1.0).abs() < 1e-3, "{to_gravity_rad}");
    }
}
