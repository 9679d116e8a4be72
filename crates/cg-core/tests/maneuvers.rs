//! Tests of the start, the end and the contents of maneuvers.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // values that are passed on are unchanged

use crate::common::told::{ROLL_RAD, Road, Says};
use cg_core::Status;

fn road() -> Road {
    Road::new(Says::WELL)
}

#[test]
fn four_seconds_of_straight_driving_close_a_maneuver() {
    let mut road = road();
    road.hold(100, 0.0);
    road.turn();
    let turned_us = road.last_turn_us;
    while road.time_us < turned_us + 4_000_000 {
        road.hold(1, 0.0);
    }
    assert!(road.closed.is_empty());
    road.hold(1, 0.0);
    assert_eq!(road.closed[0].end_us, turned_us + 4_000_000);
    road.hold(6000, 0.0);
    assert_eq!(road.closed.len(), 1); // no maneuver opens without a turn
}

#[test]
fn a_turn_is_cut_after_forty_seconds() {
    let mut road = road();
    road.hold(4001, ROLL_RAD);
    assert!(road.closed.is_empty());
    road.hold(1, ROLL_RAD);
    assert_eq!((road.closed[0].start_us, road.closed[0].end_us), (10_000, 40_010_000));
}

/// Straight rows are used from 0.3 s on, and their weight halves every 2 s: 171 rows, then 200,
/// then 200.
#[test]
fn straight_driving_before_a_turn_fades() {
    let mut road = road();
    road.hold(600, 0.0);
    road.turn(); // the turn is detected after 1 s
    let maneuver = road.finish();
    assert_eq!(maneuver.start_us, 6_010_000);
    let before = 171.0 / 8.0 + 200.0 / 4.0 + 200.0 / 2.0;
    for outcome in maneuver.outcomes {
        let fit = outcome.fit.unwrap();
        assert_eq!(fit.snr_db, before + 800.0);
    }
}

#[test]
fn a_hole_of_more_than_half_a_second_closes_a_maneuver() {
    let mut road = road();
    road.hold(100, ROLL_RAD);
    road.time_us += 490_000;
    road.hold(1, ROLL_RAD);
    assert!(road.closed.is_empty());
    let end_us = road.time_us;
    road.time_us += 490_001;
    road.hold(1, ROLL_RAD);
    assert_eq!(road.closed[0].end_us, end_us);
}

#[test]
fn a_speed_that_changes_by_more_than_three_tenths_closes_a_maneuver() {
    for (within, beyond) in [(13.0, 13.01), (7.0, 6.99)] {
        let mut road = road();
        road.hold(100, ROLL_RAD);
        road.speed_mps = within;
        road.hold(100, ROLL_RAD);
        assert!(road.closed.is_empty(), "{within}");
        road.speed_mps = beyond;
        road.hold(1, ROLL_RAD);
        assert_eq!(road.closed[0].end_us, 2_000_000, "{beyond}");
        let mean = f64::midpoint(10.0, within);
        assert!((road.closed[0].speed_mps - mean).abs() < 1e-12);
    }
}

/// During straight driving the reference speed of the next maneuver follows the speed.
#[test]
fn the_speed_of_straight_driving_long_ago_does_not_count() {
    let mut road = road();
    for k in 0..2000 {
        road.speed_mps = 10.0 + 0.0025 * f64::from(k);
        road.hold(1, 0.0);
    }
    road.turn();
    assert_eq!(road.finish().start_us, 20_010_000);
}

/// The mass is the weighted mean of all rows, the speed the mean of the rows in the turn.
#[test]
fn a_maneuver_has_the_mean_mass_of_its_rows() {
    let mut road = road();
    road.trailer_mass_kg = 31e3;
    road.hold(201, 0.0); // their weight has just been halved
    (road.trailer_mass_kg, road.speed_mps) = (32e3, 11.0);
    road.turn();
    let maneuver = road.finish();
    let mean = (100.5 * 31e3 + 801.0 * 32e3) / 901.5;
    assert!((maneuver.trailer_mass_kg - mean).abs() < 1e-8);
    assert!((maneuver.speed_mps - 11.0).abs() < 1e-12);
}

#[test]
fn a_dozen_rows_are_too_few() {
    for (rows, told) in [(12, false), (13, true)] {
        let mut road = road();
        road.hold(rows, ROLL_RAD);
        assert_eq!(road.estimator.finish().is_some(), told, "{rows}");
    }
}

#[test]
fn a_sample_is_absent_straight_or_turning() {
    let mut road = road();
    assert_eq!(road.row(f64::NAN, 0.0), Status::Absent);
    assert_eq!(road.row(0.0, 0.0), Status::Straight);
    road.hold(100, ROLL_RAD);
    assert_eq!(road.row(ROLL_RAD, ROLL_RAD), Status::Turning);
}

/// A mass signal that oscillates for less than 10 s, or that changes by up to 5 %, is not another
/// mass.
#[test]
fn another_mass_must_last() {
    let weighed = || {
        let mut road = road();
        road.trailer_mass_kg = 20e3;
        road.hold(100, ROLL_RAD);
        road
    };
    let mut road = weighed();
    for mass_kg in [23e3, 17e3] {
        road.trailer_mass_kg = mass_kg;
        road.hold(1000, ROLL_RAD);
        road.trailer_mass_kg = 20e3;
        road.hold(1, ROLL_RAD);
        assert!(road.closed.is_empty(), "{mass_kg}");
    }
    road = weighed();
    road.trailer_mass_kg = 21e3;
    road.hold(1100, ROLL_RAD);
    assert!(road.closed.is_empty());
    for mass_kg in [21.1e3, 18.9e3] {
        let mut road = weighed();
        road.trailer_mass_kg = mass_kg;
        road.hold(1000, ROLL_RAD);
        assert!(road.closed.is_empty());
        road.hold(400, ROLL_RAD);
        assert!(
            (road.finish().trailer_mass_kg - mass_kg).abs() < 1e-8,
            "it begins with the next row"
        );
    }
}

/// No truck is loaded in a turn: the mass that was there before came too late, or the one after it is wrong. If the turn ends before
/// the other mass lasts, it has neither, and the next turn has its own.
#[test]
fn a_turn_with_two_masses_tells_nothing() {
    for (rows, is_told) in [(1400, true), (900, false)] {
        let mut road = road();
        road.trailer_mass_kg = 28e3;
        road.hold(500, ROLL_RAD);
        road.trailer_mass_kg = 9e3;
        road.hold(rows, ROLL_RAD);
        assert!(road.closed.is_empty());
        let left = road.estimator.finish();
        assert_eq!(left.is_some(), is_told, "{rows}");
        assert!(left.is_none_or(|turn| (turn.trailer_mass_kg - 9e3).abs() < 1e-8));
        road.hold(400, ROLL_RAD);
        assert!((road.finish().trailer_mass_kg - 9e3).abs() < 1e-8);
    }
}

/// On a straight road a scale does not swing: what it shows for two seconds is used, and the turn has that mass. If it has shown it for
/// less, the turn has two.
#[test]
fn another_mass_on_a_straight_road_is_believed_after_two_seconds() {
    for (rows, is_used) in [(100, false), (250, true)] {
        let mut road = road();
        road.trailer_mass_kg = 9e3;
        road.hold(650, 0.0);
        road.trailer_mass_kg = 28e3;
        road.hold(rows, 0.0);
        road.hold(400, ROLL_RAD);
        assert!(road.closed.is_empty());
        let found_kg = road.estimator.finish().map(|maneuver| maneuver.trailer_mass_kg);
        assert_eq!(found_kg.is_some(), is_used, "{found_kg:?}");
        assert!(found_kg.is_none_or(|found_kg| (found_kg - 28e3).abs() < 1e-8), "{found_kg:?}");
    }
}

/// Noise of a scale does not begin anew on a straight road: the turn has all rows.
#[test]
fn noise_of_a_scale_on_a_straight_road_changes_nothing() {
    let rows = |noise_kg: f64| {
        let mut road = road();
        for k in 0..600 {
            road.trailer_mass_kg = 20e3 + if k % 2 == 0 { 0.0 } else { noise_kg };
            road.hold(1, 0.0);
        }
        road.trailer_mass_kg = 20e3;
        road.turn();
        road.finish().outcomes[0].fit.unwrap().rows
    };
    assert_eq!(rows(2e3), rows(0.0));
}

/// The first measured mass is used at once, and so is any mass between two maneuvers.
#[test]
fn a_mass_is_believed_at_once_before_a_maneuver() {
    let mut road = road();
    road.hold(100, ROLL_RAD);
    road.trailer_mass_kg = 20e3;
    road.hold(1, ROLL_RAD);
    assert_eq!(road.closed.len(), 1);
    road.hold(50, ROLL_RAD);
    road.estimator.finish();
    road.trailer_mass_kg = 25e3;
    road.hold(400, ROLL_RAD);
    let outcomes = road.estimator.finish().unwrap().outcomes;
    // The identifiers were restarted in a turn, so rows are used after 3 s.
    assert_eq!(outcomes[0].fit.unwrap().rows, 100);
}
