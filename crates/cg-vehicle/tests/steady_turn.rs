//! Rollover thresholds in steady turns, over the height of the load. (The plant's own are compared with them
//! in cg-plant.)
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::vehicle;
use cg_vehicle::steady_turn::steady_turn_threshold_g;
use cg_vehicle::{Load, Vehicle};

const STEP_M: f64 = 0.05;

/// Heights and thresholds of a load, from a low to a high one.
fn thresholds(vehicle: &Vehicle, payload_kg: f64, speed_mps: f64) -> Vec<(f64, f64)> {
    let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
    let at = |step: u32| {
        let cg_height_m = 1.2 + STEP_M * f64::from(step);
        let load = Load { trailer_mass_kg, cg_height_m };
        (cg_height_m, steady_turn_threshold_g(vehicle, load, speed_mps).unwrap())
    };
    (0..=26).map(at).collect()
}

/// The threshold falls as the load rises, and without a jump where the vehicle tips. Of a rigid
/// vehicle of threshold `T/2h` the second difference is `2 (STEP/h)²`, 0.35 % for the lowest load; the
/// search misses up to 0.25 % in each of the three values (`steady_turn::path`), which count four times.
/// A low load slides before it tips, at a lateral acceleration that hardly depends on the height: 3 % up or down, and 5 %
/// at 40 km/h near the tightest turn, where the lateral acceleration stays the same from the first axle that lifts to the last. Where
/// another axle lifts first in a tight turn, the threshold really jumps by up to 4 %.
#[test]
fn a_higher_load_has_a_lower_threshold() {
    for name in ["kraz.toml", "euro.toml", "baseline.toml", "baseline-tables.toml", "air.toml"] {
        let vehicle = vehicle(name);
        for payload_kg in [0.0, 5_000.0, 12_000.0, 25_000.0] {
            let cases = [(40.0 / 3.6, 0.45, (1.05, 0.09)), (90.0 / 3.6, 0.6, (1.03, 0.06))];
            for (speed_mps, tips_below_g, sliding) in cases {
                for near in thresholds(&vehicle, payload_kg, speed_mps).windows(3) {
                    let [(_, below), (height_m, here), (_, above)] = near.try_into().unwrap();
                    let (rise, greatest_bend) =
                        if here < tips_below_g { (1.0, 0.0135) } else { sliding };
                    let bend = (below + above - 2.0 * here).abs() / here;
                    assert!(
                        here < rise * below && above < rise * here && bend < greatest_bend,
                        "{name} {payload_kg} kg, {height_m:.2} m, {speed_mps:.1} m/s: {near:.4?}"
                    );
                }
            }
        }
    }
}

/// A fifth wheel of 10⁷ N m/rad twists by 3 mrad until its plates separate at 30 kN m, where the trailer rolls by a tenth
/// of a radian. A rigid one differs from it by less than a third of that, because the trailer's own axles carry most.
#[test]
fn a_rigid_fifth_wheel_is_the_limit_of_stiff_ones() {
    for name in ["baseline-tables.toml", "air.toml", "euro.toml"] {
        let mut vehicle = vehicle(name);
        vehicle.hitch.separation_moment_nm.get_or_insert(30e3);
        vehicle.hitch.lash_rad = 0.02;
        let mut threshold_g = |stiffness_nm_per_rad: f64, speed_mps: f64| {
            vehicle.hitch.roll_stiffness_nm_per_rad = stiffness_nm_per_rad;
            steady_turn_threshold_g(&vehicle, vehicle.reference_load(), speed_mps).unwrap()
        };
        for speed_mps in [40.0 / 3.6, 90.0 / 3.6] {
            let stiff_g = threshold_g(1e7, speed_mps);
            for stiffness_nm_per_rad in [1e8, 1e9, 1e10] {
                let rigid_g = threshold_g(stiffness_nm_per_rad, speed_mps);
                assert!((rigid_g / stiff_g - 1.0).abs() < 0.01, "{name}: {rigid_g} {stiff_g}");
            }
        }
    }
}

/// The slip tables end at 0.79 of the load at the 20 kN that a tire of the laden trailer carries, and at less under more
/// load, so that load transfer only takes from it.
#[test]
fn the_tires_hold_no_more_than_their_grip() {
    for name in ["baseline-tables.toml", "air.toml"] {
        let vehicle = vehicle(name);
        let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + 25_000.0;
        for cg_height_m in [1.0, 1.1] {
            let load = Load { trailer_mass_kg, cg_height_m };
            let found_g = steady_turn_threshold_g(&vehicle, load, 40.0 / 3.6).unwrap();
            assert!(found_g < 0.79, "{name} {cg_height_m} m: {found_g} g");
        }
    }
}
