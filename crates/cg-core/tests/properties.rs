//! Properties that hold for any input.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;
use crate::common::{Pair, rounded_step_response, with_noise};
use cg_core::{Answer, Arx, Channel, Estimator, FilteredArx, Memory, Prior, Sample, Settings};
use proptest::prelude::*;

fn estimator() -> Pair<f32, FilteredArx<f32>> {
    Estimator::new(common::design().cast(), Settings::truck(), Prior::standard())
}

/// The samples of a log with one turn that starts at `origin_us`.
fn one_turn(origin_us: u64) -> Vec<Sample<f32>> {
    let straight = vec![(0.0, 0.0); 200];
    let turn = rounded_step_response(1500, 0.01, 3.0);
    straight
        .into_iter()
        .chain(turn)
        .zip(0_u64..)
        .map(|((u, y), k)| {
            let mut sample = Sample::absent(origin_us + 10_000 * k);
            sample.steer_rad = common::narrow(u);
            sample.roll_rad = common::narrow(y);
            sample.speed_mps = 13.9;
            sample
        })
        .collect()
}

fn height_of(samples: &[Sample<f32>]) -> Option<f32> {
    let mut estimator = estimator();
    for sample in samples {
        estimator.push(sample).unwrap();
    }
    estimator.finish();
    estimator.height(Channel::Steer).map(|height| height.height_m.value)
}

proptest! {
    /// Any bits in any field and any order of time: a row whose time does not follow is refused, every
    /// other one is taken, and none panics. A clean turn afterwards gives the height that it gives alone.
    #[test]
    fn push_survives_anything(fields in prop::collection::vec((0..1_u64 << 50, any::<[u32; 13]>()), 1..60)) {
        let design = common::full_design().cast();
        let mut estimator: Estimator<f32, FilteredArx<f32>> =
            Estimator::new(design, Settings::truck(), Prior::standard());
        let mut latest_us = None;
        for (time_us, bits) in fields {
            let [steer, roll, tilt, speed, lateral, yaw, mass, more @ ..] =
                bits.map(f32::from_bits);
            let [to_gravity, force, suspension, tractor, tractor_force, tractor_tilt] = more;
            let sample = Sample {
                time_us,
                steer_rad: steer,
                roll_rad: roll,
                roll_to_gravity_rad: to_gravity,
                tilt_rad: tilt,
                suspension_roll_rad: suspension,
                speed_mps: speed,
                lateral_acceleration_mps2: lateral,
                lateral_specific_force_mps2: force,
                tractor_suspension_roll_rad: tractor,
                tractor_lateral_specific_force_mps2: tractor_force,
                tractor_tilt_rad: tractor_tilt,
                yaw_rate_radps: yaw,
                trailer_mass_kg: mass,
            };
            let follows = latest_us.is_none_or(|latest_us| time_us > latest_us);
            prop_assert_eq!(estimator.push(&sample).is_ok(), follows);
            if follows {
                latest_us = Some(time_us);
            }
        }
        let turn = |origin_us| {
            let mass_kg = estimator.design().nominal_trailer_mass_kg;
            one_turn(origin_us).into_iter().map(move |row| Sample { trailer_mass_kg: mass_kg, ..row })
        };
        let alone = height_of(&turn(0).collect::<Vec<_>>()).unwrap();
        for sample in turn(1 << 51).collect::<Vec<_>>() {
            prop_assert!(estimator.push(&sample).is_ok());
        }
        estimator.finish();
        let after = estimator.height(Channel::Steer).unwrap().height_m.value;
        prop_assert!((after - alone).abs() < 1e-3 * alone, "{} {}", after, alone);
    }

    /// The origin of time does not matter.
    #[test]
    fn time_has_no_origin(origin_us in 0_u64..1_000_000_000_000_000) {
        prop_assert_eq!(height_of(&one_turn(0)), height_of(&one_turn(origin_us)));
    }

    /// The roll angle in another unit gives the ratio in that unit.
    #[test]
    fn the_ratio_scales_with_the_roll(scale in 0.01_f64..100.0, seed in any::<u64>()) {
        let data = with_noise(&rounded_step_response(201, 0.05, 3.0), 30.0, seed);
        let ratio = |scale: f64| {
            let mut arx = Arx::<f64, 6>::new(3, 3, 1).unwrap();
            for &(u, y) in &data {
                arx.push(u, scale * y, true);
            }
            let Answer::Ready(fit) = arx.fit() else { panic!("excited") };
            fit.ratio.value
        };
        // A condition number near 1e4, multiplied by the scale by which the columns differ.
        prop_assert!((ratio(scale) / scale / ratio(1.0) - 1.0).abs() < 1e-8);
    }
}

#[test]
fn without_a_turn_there_is_no_answer() {
    let mut straight = one_turn(0);
    straight.truncate(200);
    assert_eq!(height_of(&straight), None);
}

#[test]
fn a_turn_gives_the_height_that_made_it() {
    // R_c R_a(h) = 0.8456 on the design's line: h = 1.9729 m.
    let height = height_of(&one_turn(0)).unwrap();
    assert!((height - 1.973).abs() < 0.002, "{height}");
}

#[test]
fn a_sample_out_of_order_is_refused_and_changes_nothing() {
    let samples = one_turn(0);
    let mut estimator = estimator();
    for (k, sample) in samples.iter().enumerate() {
        estimator.push(sample).unwrap();
        if k == 700 {
            assert!(estimator.push(&samples[300]).is_err());
        }
    }
    estimator.finish();
    let height = estimator.height(Channel::Steer).map(|height| height.height_m.value);
    assert_eq!(height, height_of(&samples));
}

#[test]
fn a_hole_in_the_middle_of_a_turn_costs_accuracy_but_not_the_answer() {
    let mut samples = one_turn(0);
    samples.drain(600..700); // one second, too long for interpolation
    let height = height_of(&samples).unwrap();
    assert!((height - 1.973).abs() < 0.02, "{height}");
}

/// Drives a turn with the roll angle multiplied by `scale`, which means another load.
fn drive(estimator: &mut Pair<f32, FilteredArx<f32>>, origin_us: u64, scale: f32) {
    for mut sample in one_turn(origin_us) {
        sample.roll_rad *= scale;
        estimator.push(&sample).unwrap();
    }
    estimator.finish();
}

fn resumed(from: &Pair<f32, FilteredArx<f32>>) -> Pair<f32, FilteredArx<f32>> {
    let (settings, prior) = (Settings::truck(), Prior::standard());
    Estimator::restored(*from.design(), settings, prior, &from.memory()).unwrap()
}

#[test]
fn a_restart_between_two_maneuvers_changes_no_bit() {
    let mut kept = estimator();
    drive(&mut kept, 0, 1.0);
    let mut restarted = resumed(&kept);
    assert_eq!(restarted.height(Channel::Steer), kept.height(Channel::Steer));
    for (turn, estimator) in [(40_000_000, &mut kept), (7_000_000, &mut restarted)] {
        drive(estimator, turn, 1.0);
    }
    let height = restarted.height(Channel::Steer);
    assert_eq!(height.unwrap().maneuvers, 2);
    assert_eq!(height, kept.height(Channel::Steer));
    assert_eq!(restarted.memory(), kept.memory());
}

/// After a restart one contradicting maneuver means another load; otherwise it waits for a second
/// one.
#[test]
fn a_restart_counts_as_a_stop() {
    let mut kept = estimator();
    drive(&mut kept, 0, 1.0);
    let mut restarted = resumed(&kept);
    drive(&mut kept, 40_000_000, 0.8);
    drive(&mut restarted, 40_000_000, 0.8);
    let value =
        |from: &Pair<f32, FilteredArx<f32>>| from.height(Channel::Steer).unwrap().height_m.value;
    assert!((value(&kept) - 1.973).abs() < 0.002);
    assert!(value(&restarted) < 1.9);
    // The waiting maneuver is also kept over a restart.
    let mut again = resumed(&kept);
    drive(&mut again, 0, 0.8);
    assert!((value(&again) - value(&restarted)).abs() < 1e-3, "{}", value(&again));
}

#[test]
fn a_memory_that_cannot_be_is_refused() {
    let mut taught = estimator();
    drive(&mut taught, 0, 1.0);
    let good = taught.memory();
    let (settings, prior) = (Settings::truck(), Prior::standard());
    let with = |change: &dyn Fn(&mut Memory<f32, 2>)| {
        let mut memory = good;
        change(&mut memory);
        Pair::<f32, FilteredArx<f32>>::restored(*taught.design(), settings, prior, &memory)
    };
    assert!(with(&|_| {}).is_some());
    assert!(with(&|memory| memory.trailer_mass_kg = f32::NAN).is_none());
    assert!(with(&|memory| memory.correlation[0][1] = 1.5).is_none());
    assert!(with(&|memory| memory.load_mass_kg = Some(-1.0)).is_none());
    let nothing = cg_core::Measured { value: 0.0, sd: 0.0 };
    assert!(with(&|memory| memory.waiting = Some([Some((nothing, 0.0)), None])).is_none());
}

/// The first mass arrives a second after the other signals. The turn that follows is one maneuver
/// and has this mass.
#[test]
fn a_first_weight_that_comes_late_splits_no_turn() {
    let mut estimator = estimator();
    let mut closed = Vec::new();
    for (k, mut sample) in one_turn(0).into_iter().enumerate() {
        if k >= 100 {
            sample.trailer_mass_kg = 20e3;
        }
        closed.extend(estimator.push(&sample).unwrap().closed);
    }
    closed.extend(estimator.finish());
    assert_eq!(closed.len(), 1);
    assert!((closed[0].trailer_mass_kg - 20e3).abs() < 1.0);
}
