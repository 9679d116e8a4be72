//! Tests of the decisions on a maneuver and on the agreement of the two channels.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // values that are passed on are unchanged

use crate::common;
use crate::common::told::{ROLL_RAD, Road, Says};
use cg_core::Reject;
use cg_core::{
    Channel, Combined, Estimator, HeightError, Inconsistency, Measured, Settings, Unexcited,
};

/// The reason why each channel has no height, for one maneuver at the reference height.
fn reasons(says: Says) -> [Option<Reject<f64>>; 2] {
    Road::new(says).maneuver([1.973; 2]).map(|outcome| outcome.height_m.err())
}

/// The heights are those of the maneuver, and the error of the ratio is propagated with the ratio
/// line.
#[test]
fn a_maneuver_gives_the_height_that_made_it() {
    let outcomes = Road::new(Says::WELL).maneuver([1.7, 2.3]);
    for (outcome, height_m) in outcomes.into_iter().zip([1.7, 2.3]) {
        let found = outcome.height_m.unwrap();
        assert!((found.value - height_m).abs() < 1e-9, "{found:?}");
        let line = common::design().channels[0].lines[0][0];
        let at = |h: f64| line.ratio_at(h);
        let slope = (at(height_m + 1e-4) - at(height_m - 1e-4)) / 2e-4;
        // The ratio has a standard deviation of 0.01 of the expected one; that of the design is 1.3
        // %.
        let random = 0.01 * at(1.973) / slope;
        assert!((found.sd / random - 1.0).abs() < 1e-3, "{found:?} {random}");
        let systematic = 0.013 * at(height_m) / slope;
        assert!((outcome.systematic_sd_m / systematic - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_ratio_is_in_units_of_its_input() {
    let outcomes = Road::new(Says::WELL).maneuver([1.973; 2]);
    let [steer, lateral] = outcomes.map(|outcome| outcome.fit.unwrap().ratio);
    let design = common::design();
    let expected = design.channels[0].lines[0][0].ratio_at(1.973) * 1.489_6;
    assert!((steer.value - expected).abs() < 1e-9);
    assert!((lateral.value - expected / 34.0).abs() < 1e-9);
    assert!((steer.sd / (0.01 * expected) - 1.0).abs() < 1e-3);
}

#[test]
fn a_channel_without_its_signal_is_absent() {
    let mut road = Road::new(Says::WELL);
    let [steer, lateral] = road.maneuver([f64::NAN, 1.973]);
    assert_eq!(steer.height_m, Err(Reject::Absent));
    assert!(lateral.height_m.is_ok());
    assert_eq!(road.estimator.best_channel(), Some(Channel::LateralAcceleration));
}

#[test]
fn a_turn_that_the_filters_do_not_know_tells_nothing() {
    let mut road = Road::new(Says::WELL);
    road.hold(300, ROLL_RAD); // the filters need 3 s
    for outcome in road.finish().outcomes {
        assert_eq!(outcome.height_m, Err(Reject::Unexcited(Unexcited::Input)));
    }
}

#[test]
fn a_ratio_uncertain_by_a_fifth_is_imprecise() {
    let says = Says { ratio_sd: [0.199, 0.201], ..Says::WELL };
    let [steer, lateral] = reasons(says);
    assert_eq!(steer, None);
    let Some(Reject::Imprecise { ratio_sd_relative }) = lateral else { unreachable!() };
    assert!((ratio_sd_relative - 0.201).abs() < 1e-4);
}

#[test]
fn a_speed_beyond_the_design_is_named() {
    let mut road = Road::new(Says::WELL);
    road.speed_mps = 31.0;
    for outcome in road.maneuver([1.973; 2]) {
        let Err(Reject::OutsideDesign { speed_mps, trailer_mass_kg }) = outcome.height_m else {
            unreachable!()
        };
        assert!((speed_mps - 31.0).abs() < 1e-12 && (trailer_mass_kg - 31.3e3).abs() < 1e-8);
    }
}

/// A misfit may be due to the input, so the other channel is used.
#[test]
fn a_misfit_of_more_than_035_is_its_channels_own() {
    let misfit = Some(Reject::Inconsistent(Inconsistency::Misfit { share: 0.351 }));
    assert_eq!(reasons(Says { misfit: [0.351, 0.35], ..Says::WELL }), [misfit, None]);
    assert_eq!(reasons(Says { misfit: [0.0, 0.351], ..Says::WELL }), [None, misfit]);
    assert!(reasons(Says { misfit: [f64::NAN; 2], ..Says::WELL })[0].is_some());
}

/// A roll angle that falls behind is rejected in both channels if the bend exceeds chance (3.29
/// standard deviations) and the angle itself.
#[test]
fn a_roll_angle_that_falls_behind_is_the_roll_sensors() {
    let bent = |value, sd| Measured { value, sd };
    let says = Says { bend: [Measured::exact(0.0), bent(-1.01, 1.01 / 3.3)], ..Says::WELL };
    let reject = Some(Reject::Inconsistent(Inconsistency::Bent { share: 1.01 }));
    assert_eq!(reasons(says), [reject; 2]);
    // A bend explained by chance, a bend that is too small, and a positive one, as with a late
    // sensor.
    for good in [bent(-1.01, 1.01 / 3.28), bent(-0.99, 0.0), bent(1.01, 0.0)] {
        assert_eq!(reasons(Says { bend: [good; 2], ..Says::WELL }), [None; 2]);
    }
}

#[test]
fn a_roll_angle_that_stands_still_is_seen_in_both_channels() {
    let mut road = Road::new(Says { misfit: [1.0, 0.0], ..Says::WELL });
    road.hold(100, 0.0);
    for k in 0..=400 {
        let roll_rad = ROLL_RAD * f64::from(k) / 400.0;
        road.row(roll_rad.min(0.02), roll_rad);
    }
    let still = Reject::Inconsistent(Inconsistency::Standstill { roll_rad: 0.02 });
    assert_eq!(road.finish().outcomes.map(|outcome| outcome.height_m), [Err(still); 2]);
}

/// A sensor with steps: 1/12 of the squared step is added to the variance of the ratio.
#[test]
fn a_coarse_sensor_makes_a_ratio_less_certain() {
    let mut road = Road::new(Says::WELL);
    road.hold(100, 0.0);
    let step_rad = ROLL_RAD / 8.0;
    for k in 0..=400 {
        let roll_rad = ROLL_RAD * f64::from(k) / 400.0;
        road.row((roll_rad / step_rad).round() * step_rad, roll_rad);
    }
    let maneuver = road.finish();
    let fit = maneuver.outcomes[0].fit.unwrap();
    let share = fit.ratio.sd / fit.ratio.value;
    let steps = (share * share - 1e-4).sqrt() * 12.0_f64.sqrt() * 8.0;
    // The motion is seen after a lag of half a second, so an eighth of its four seconds is missing.
    assert!((steps * 7.0 / 8.0 - 1.0).abs() < 0.01, "{steps}");
}

#[test]
fn a_height_that_this_trailer_cannot_have_is_none() {
    for (height_m, possible) in [(2.99, true), (3.01, false), (1.01, true), (0.99, false)] {
        let mut road = Road::new(Says::WELL);
        let [steer, _] = road.maneuver([height_m, 1.973]);
        match steer.height_m {
            Ok(found) => assert!(possible && (found.value - height_m).abs() < 1e-9),
            Err(Reject::Height(HeightError::OutOfRange { height_m: found })) => {
                assert!(!possible && (found - height_m).abs() < 1e-9);
                // Near the limit, the uncertainty of the ratio explains it, so the other channel is
                // used.
                assert!(matches!(road.estimator.combined(), Some(Combined::Agreed(_))));
            }
            Err(other) => unreachable!("{other}"),
        }
    }
}

/// The steer channel gives 3.2 m with a ratio of 1.0128 (0.8 m: 0.2176), far beyond the limits of 3
/// m and 1 m. If the other channel gives 2.6 m, this is 1.29 times the ratio of that height (1.1 m:
/// 1/1.38), so the roll angle may be wrong. If it gives 2.0 m, it is 1.76 times (1.2 m: 1/1.52), so
/// the steer angle is wrong.
#[test]
fn a_height_far_beyond_the_trailers_is_blamed_on_what_is_at_fault() {
    let cases = [(3.2, 2.6, true), (3.2, 2.0, false), (0.8, 1.1, true), (0.8, 1.2, false)];
    for (beyond, beside, impossible) in cases {
        for heights_m in [[beyond, beside], [beside, beyond]] {
            let mut road = Road::new(Says::WELL);
            road.maneuver(heights_m);
            let combined = road.estimator.combined().unwrap();
            assert_eq!(combined == Combined::Impossible, impossible, "{heights_m:?}");
            assert_eq!(road.estimator.combined_height().is_none(), impossible);
            // A good maneuver ends the doubt.
            road.maneuver([beside; 2]);
            assert!(road.estimator.combined_height().is_some());
        }
    }
    let mut alone = Road::new(Says::WELL);
    alone.maneuver([f64::NAN, 2.0]);
    alone.maneuver([f64::NAN, 3.2]);
    assert_eq!(alone.estimator.combined(), Some(Combined::Impossible));
}

/// The limit is 2.576 √(0.01² + 0.013²) = 0.0422 of the ratio at 3 m, which is reached at 3.1007 m.
/// With the standard deviation relative to the ratio itself, 0.0096, it is reached at 3.0998 m.
#[test]
fn chance_explains_a_ratio_a_little_beyond() {
    let combined = |height_m: f64| {
        let mut road = Road::new(Says::WELL);
        road.maneuver([height_m, 2.6]);
        road.estimator.combined().unwrap()
    };
    assert!(matches!(combined(3.05), Combined::Agreed(_)));
    assert_eq!(combined(3.13), Combined::Impossible);
}

#[test]
fn the_channel_that_knows_more_is_the_best() {
    for (ratio_sd, best) in [
        ([0.01, 0.02], Channel::Steer),
        ([0.02, 0.01], Channel::LateralAcceleration),
        ([0.01, 0.010_1], Channel::Steer),
    ] {
        let mut road = Road::new(Says { ratio_sd, ..Says::WELL });
        assert_eq!(road.estimator.best_channel(), None);
        assert_eq!(road.estimator.combined(), None);
        road.maneuver([1.973; 2]);
        assert_eq!(road.estimator.best_channel(), Some(best));
    }
    let mut road = Road::new(Says::WELL);
    road.maneuver([1.973, 4.0]);
    assert_eq!(road.estimator.best_channel(), Some(Channel::Steer));
}

/// Two successive maneuvers that contradict the earlier ones but agree with each other mean another
/// load.
#[test]
fn another_load_is_told_from_the_maneuver_that_shows_it() {
    let mut road = Road::new(Says::WELL);
    for _ in 0..3 {
        road.maneuver([1.8; 2]);
    }
    let steer = road.estimator.height(Channel::Steer).unwrap();
    assert_eq!((steer.maneuvers, road.estimator.load_since_us()), (3, None));
    road.maneuver([2.4; 2]);
    assert_eq!(road.estimator.height(Channel::Steer), Some(steer));
    assert_eq!(road.estimator.load_since_us(), None);
    road.maneuver([2.4; 2]);
    assert_eq!(road.estimator.load_since_us(), Some(road.time_us));
    for channel in common::PAIR {
        let height = road.estimator.height(channel).unwrap();
        assert!((height.height_m.value - 2.4).abs() < 1e-9);
        assert_eq!(height.maneuvers, 2);
    }
}

#[test]
fn what_a_memory_holds_comes_back() {
    let mut road = Road::new(Says::WELL);
    (road.trailer_mass_kg, road.speed_mps) = (20e3, 14.0);
    road.maneuver([1.8; 2]);
    let memory = road.estimator.memory();
    assert_eq!((memory.trailer_mass_kg, memory.correlation), (20e3, [[1.0, 0.5], [0.5, 1.0]]));
    let (settings, design) = (Settings::truck(), common::design());
    let restored = Estimator::restored(design, settings, Says::WELL, &memory).unwrap();
    assert_eq!(restored.memory(), memory);
    assert_eq!(restored.combined(), road.estimator.combined());
    // The restored estimator uses the same mass, so nothing restarts in the first maneuver.
    let mut on = Road::on(restored);
    on.hold(400, ROLL_RAD);
    assert!((on.finish().trailer_mass_kg - 20e3).abs() < 1e-8);
}

#[test]
fn a_reason_says_what_to_look_at() {
    let inconsistent = |reason| Reject::Inconsistent(reason).to_string();
    let says = |text: String, parts: &[&str]| {
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    };
    says(Reject::<f64>::Absent.to_string(), &["absent"]);
    says(Reject::<f64>::Unexcited(Unexcited::Input).to_string(), &["no turn"]);
    let vast: Reject<f64> = Reject::Imprecise { ratio_sd_relative: 1.8e13 };
    assert_eq!(vast.to_string(), "the ratio is uncertain by more than 1000 %");
    assert!(Unexcited::TooFewRows { rows: 0 }.to_string().starts_with("no row can be used"));
    let few = Unexcited::TooFewRows { rows: 7 };
    says(few.to_string(), &["only 7 rows"]);
    says(Unexcited::Direction { unknown: 4 }.to_string(), &["unknown 4"]);
    says(Reject::Imprecise { ratio_sd_relative: 0.25 }.to_string(), &["by 25 %"]);
    let outside = Reject::OutsideDesign { speed_mps: 31.0, trailer_mass_kg: 5e3 };
    says(outside.to_string(), &["31.0 m/s", "5000 kg"]);
    let range = HeightError::OutOfRange { height_m: 3.2 };
    says(Reject::Height(range).to_string(), &["3.20 m"]);
    says(HeightError::NoSolution { ratio: 0.5 }.to_string(), &["0.5000"]);
    says(inconsistent(Inconsistency::Misfit { share: 0.4 }), &["40 % of the roll angle"]);
    says(inconsistent(Inconsistency::Bent { share: 1.4 }), &["behind", "end of its range"]);
    says(inconsistent(Inconsistency::Standstill { roll_rad: 0.1 }), &["0.1000 rad"]);
}
