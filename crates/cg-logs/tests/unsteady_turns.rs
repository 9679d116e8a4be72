//! Turns of the second independent truck in which it brakes or goes faster.
#![allow(clippy::unwrap_used)]

use crate::common::{Known, calibrated, known_in, vehicle};
use cg_core::{AlignSettings, Design};
use cg_logs::estimate::LogEstimator;
use cg_vehicle::Variant;
use cg_vehicle::design::design_with;

/// The design of the second independent truck, calibrated on two steps, and its gentle drive.
fn gentle_drive() -> (Design<f64>, Known) {
    let (vehicle, mut known) = (vehicle("euro.toml"), known_in("euro"));
    let pick = |name: &str| known.iter().position(|known| known.log.starts_with(name)).unwrap();
    let steps = ["A_p00", "A_p16_h170"].map(pick);
    let calibration = calibrated(&vehicle, &steps.map(|at| &known[at]));
    let drive = pick("F_drive2");
    let design = design_with(&vehicle, Variant::Complete, &calibration.belief()).unwrap();
    (design, known.swap_remove(drive))
}

/// A drive of one load, in whose turns the truck goes faster by up to 0.1 m/s² or brakes, 7 % less or 2 % more roll per input than at
/// a steady speed. As if they were as accurate as their noise, some of these drives "changed their load".
#[test]
fn turns_of_one_load_at_an_unsteady_speed_do_not_contradict_each_other() {
    let (design, drive) = gentle_drive();
    let truth_m = drive.load.cg_height_m;
    for seed in 0..6 {
        let mut estimator =
            LogEstimator::from_design(&design, AlignSettings::NONE, drive.weighed());
        for row in drive.noisy(seed) {
            estimator.push(&row).unwrap();
        }
        let found = estimator.finish();
        let (height_m, [low_m, high_m]) = (found.height_m.unwrap(), found.height_ci95_m.unwrap());
        println!("{seed}: {:+.2} %, {:?}", 100.0 * (height_m / truth_m - 1.0), found.messages);
        assert!((low_m..=high_m).contains(&truth_m), "{seed}: {low_m} to {high_m} m");
        assert!((height_m / truth_m - 1.0).abs() < 0.01 && high_m - low_m < 0.08 * truth_m);
        let told = |about: &str| found.messages.iter().any(|message| message.contains(about));
        assert!(!told("load changed") && !told("left out"), "{seed}: {:?}", found.messages);
    }
}

/// Twenty seconds that begin in a turn, in which the truck brakes, and end in it. The lateral acceleration changes by a
/// tenth there, and what the braking does to the roll angle passes for the height's: it is 18 % too high.
#[test]
fn braking_counts_for_more_in_a_piece_that_shows_no_straight() {
    let (design, drive) = gentle_drive();
    let truth_m = drive.load.cg_height_m;
    let mut estimator = LogEstimator::from_design(&design, AlignSettings::NONE, drive.weighed());
    for row in drive.rows().iter().filter(|row| (180.0..200.0).contains(&row.time_s)) {
        estimator.push(row).unwrap();
    }
    let found = estimator.finish();
    let (height_m, [low_m, high_m]) = (found.height_m.unwrap(), found.height_ci95_m.unwrap());
    println!("{:+.2} %, {low_m} to {high_m} m", 100.0 * (height_m / truth_m - 1.0));
    assert!((low_m..=high_m).contains(&truth_m) && high_m - low_m < truth_m);
}
