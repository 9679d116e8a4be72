//! Values that are not numbers, or that are impossible for a truck, never remain in the estimator;
//! and a drive can start when the ignition is switched on.
#![allow(clippy::unwrap_used, clippy::cast_precision_loss)] // helpers of tests

use crate::common;
use crate::common::{PAIR, Pair, narrow, rounded_step_response};
use cg_core::truck::channel::ROLL_LAG_S;
use cg_core::truck::simulation::Simulation;
use cg_core::{Estimator, FilteredArx, Prior, Quantity, Reduced5, Sample, Settings};
use proptest::prelude::*;

/// The two lags of the roll angle, `w²/(s + w)²` with `w = 1/0.15 s`, and three poles that cancel.
const LAGS: Reduced5<f64> = {
    const W: f64 = 1.0 / ROLL_LAG_S;
    const SQUARE: f64 = W * W;
    Reduced5 {
        numerator: [SQUARE * SQUARE * W, 3.0 * SQUARE * SQUARE, 3.0 * SQUARE * W, SQUARE, 0.0, 0.0],
        denominator: [
            SQUARE * SQUARE * W,
            5.0 * SQUARE * SQUARE,
            10.0 * SQUARE * W,
            10.0 * SQUARE,
            5.0 * W,
        ],
        speed_slope: [0.0; 5],
    }
};

fn estimator() -> Pair<f32, FilteredArx<f32>> {
    Estimator::new(common::design().cast(), Settings::truck(), Prior::standard())
}

/// A drive without faults, one row every 10 ms: straight, one turn, straight.
fn good_drive() -> Vec<Sample<f32>> {
    let straight = vec![(0.0, 0.0); 200];
    // After the lags of the roll angle, so that the models of both channels are exact.
    let mut felt = Simulation::new(&LAGS, 0.01, 0.0);
    straight
        .into_iter()
        .chain(rounded_step_response(1500, 0.01, 3.0))
        .zip(0_u64..)
        .map(|((steer, roll), k)| {
            let mut sample = Sample::absent(10_000 * k);
            sample.steer_rad = narrow(steer);
            sample.roll_rad = narrow(roll);
            sample.speed_mps = 13.9;
            sample.lateral_acceleration_mps2 = narrow(34.0 * felt.push(steer));
            sample.trailer_mass_kg = 30e3;
            sample
        })
        .collect()
}

/// Heights of both channels after these samples.
fn heights(samples: &[Sample<f32>]) -> [Option<f32>; 2] {
    let mut estimator = estimator();
    for sample in samples {
        let _ = estimator.push(sample);
    }
    estimator.finish();
    PAIR.map(|channel| estimator.height(channel).map(|height| height.height_m.value))
}

/// Values that a quantity cannot have: absent, infinite, huge, just beyond its limits.
fn impossible(quantity: Quantity) -> impl Strategy<Value = f32> {
    let [least, greatest] = quantity.limits();
    prop_oneof![
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(f32::NEG_INFINITY),
        Just(f32::MAX),
        Just(f32::MIN),
        (1.01_f32..1e30).prop_map(move |factor| factor * greatest),
        (1.01_f32..1e30).prop_map(move |factor| least - factor * greatest),
    ]
}

prop_compose! {
    /// A sample with impossible values only, a number of microseconds after the row with a given
    /// index.
    fn damaged()(
        after in 0_usize..1700,
        late_us in 1_u64..10_000,
        steer_rad in impossible(Quantity::Steer),
        roll_rad in impossible(Quantity::Roll),
        roll_to_gravity_rad in impossible(Quantity::RollToGravity),
        tilt_rad in impossible(Quantity::Tilt),
        suspension_roll_rad in impossible(Quantity::SuspensionRoll),
        tractor in [
            impossible(Quantity::TractorSuspensionRoll),
            impossible(Quantity::TractorLateralSpecificForce),
            impossible(Quantity::TractorTilt),
        ],
        lateral_specific_force_mps2 in impossible(Quantity::LateralSpecificForce),
        speed_mps in impossible(Quantity::Speed),
        lateral_acceleration_mps2 in impossible(Quantity::LateralAcceleration),
        yaw_rate_radps in impossible(Quantity::YawRate),
        trailer_mass_kg in impossible(Quantity::TrailerMass),
    ) -> Sample<f32> {
        let [tractor_suspension_roll_rad, tractor_lateral_specific_force_mps2, tractor_tilt_rad] =
            tractor;
        Sample {
            time_us: 10_000 * after as u64 + late_us,
            steer_rad,
            roll_rad,
            roll_to_gravity_rad,
            tilt_rad,
            suspension_roll_rad,
            speed_mps,
            lateral_acceleration_mps2,
            lateral_specific_force_mps2,
            tractor_suspension_roll_rad,
            tractor_lateral_specific_force_mps2,
            tractor_tilt_rad,
            yaw_rate_radps,
            trailer_mass_kg,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Impossible samples before and between the samples of a good drive change its heights by less
    /// than 1e-3.
    #[test]
    fn the_impossible_does_no_harm(damage in prop::collection::vec(damaged(), 1..200)) {
        let good = good_drive();
        let mut all: Vec<Sample<f32>> = good.iter().chain(&damage).copied().collect();
        all.sort_by_key(|sample| sample.time_us);
        for (found, known) in heights(&all).into_iter().zip(heights(&good)) {
            let (found, known) = (found.unwrap(), known.unwrap());
            prop_assert!((found / known - 1.0).abs() < 1e-3, "{found} for {known}");
        }
    }

    /// An impossible value affects only its own row.
    #[test]
    fn one_impossible_value_costs_its_row(places in prop::collection::vec((0_usize..1700, 0_usize..5), 1..40)) {
        let good = good_drive();
        let mut harmed = good.clone();
        for (place, field) in places {
            let sample = &mut harmed[place];
            *[
                &mut sample.steer_rad,
                &mut sample.roll_rad,
                &mut sample.speed_mps,
                &mut sample.lateral_acceleration_mps2,
                &mut sample.trailer_mass_kg,
            ][field] = 1e30;
        }
        for (found, known) in heights(&harmed).into_iter().zip(heights(&good)) {
            let (found, known) = (found.unwrap(), known.unwrap());
            prop_assert!((found / known - 1.0).abs() < 1e-3, "{found} for {known}");
        }
    }
}

/// From switching on the ignition: the truck stands, the steer angle ramps up to its true value,
/// sensors appear one after the other, there is no mass yet, and the first rows have no lateral
/// acceleration.
#[test]
fn a_drive_begins_with_the_ignition_key() {
    let standing = (0..3000_u64).map(|k| {
        let time_s = k as f32 * 0.01;
        let seen = |from_s: f32, value: f32| if time_s >= from_s { value } else { f32::NAN };
        let mut sample = Sample::absent(10_000 * k);
        sample.roll_rad = seen(1.0, 0.004);
        sample.steer_rad = seen(2.0, 0.3 * ((time_s - 2.0) / 5.0).min(1.0));
        sample.speed_mps = seen(4.0, 0.0);
        sample.yaw_rate_radps = seen(6.0, 0.0);
        sample.lateral_acceleration_mps2 = seen(9.0, 0.02);
        sample
    });
    // The truck accelerates at 1 m/s² with straight wheels and then drives at a steady speed for
    // ten seconds. The mass is known after some time.
    let away = (0..2400_u64).map(|k| {
        let mut sample = Sample::absent(30_000_000 + 10_000 * k);
        sample.roll_rad = 0.004;
        sample.steer_rad = 0.0;
        sample.speed_mps = (k as f32 * 0.01).min(13.9);
        sample.lateral_acceleration_mps2 = 0.0;
        sample.trailer_mass_kg = if k > 700 { 30e3 } else { f32::NAN };
        sample
    });
    let driving = good_drive().into_iter().map(|sample| Sample {
        time_us: sample.time_us + 54_000_000,
        roll_rad: sample.roll_rad + 0.004,
        ..sample
    });
    let all: Vec<Sample<f32>> = standing.chain(away).chain(driving).collect();
    for (found, known) in heights(&all).into_iter().zip(heights(&good_drive())) {
        let (found, known) = (found.unwrap(), known.unwrap());
        assert!((found / known - 1.0).abs() < 1e-3, "{found} for {known}");
    }
}

/// Rows with gaps that are too long for interpolation do not form maneuvers.
#[test]
fn a_log_of_one_row_a_second_has_no_maneuvers() {
    let mut estimator = estimator();
    let mut closed = 0;
    for k in 0..2000_u64 {
        let mut sample = Sample::absent(1_000_000 * k);
        sample.steer_rad = narrow(0.05 * (k as f64 / 5.0).sin());
        sample.roll_rad = 0.85 * sample.steer_rad;
        sample.speed_mps = 13.9;
        closed += u32::from(estimator.push(&sample).unwrap().closed.is_some());
    }
    assert_eq!(closed, 0);
    assert_eq!(estimator.finish(), None);
}
