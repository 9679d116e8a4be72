//! Sensors that fail while the truck drives.

use super::mass::one_turn;
use super::*;
use cg_core::Channel;
use cg_logs::log::LogRow;

/// A minute of weaving at 15 m/s from a time on, s, with what sensors make of it.
fn weave(session: &mut Trial, from_s: u64, sensors: impl Fn(&mut Sample<f64>)) {
    for k in 0..3000_u32 {
        let lateral_mps2 = 1.5 * (f64::from(k) * 0.02 * 0.5).sin();
        let time_us = from_s * SECOND_US + u64::from(k) * 20_000;
        let mut sample = Sample { trailer_mass_kg: nominal_kg(), ..sample(time_us) };
        (sample.lateral_acceleration_mps2, sample.yaw_rate_radps) =
            (lateral_mps2, lateral_mps2 / 15.0);
        sample.roll_rad = 0.02 * lateral_mps2;
        sensors(&mut sample);
        session.tick(0.0, time_us);
        session.push(sample).unwrap();
    }
}

/// The height comes back with the signal.
#[test]
fn a_lateral_acceleration_that_dies_hides_the_height() {
    let mut session = session(None, 0.0);
    weave(&mut session, 0, |_| {});
    learn(&mut session, [Some(2.0), Some(2.0)]);
    events(&mut session);
    weave(&mut session, 60, |sample| sample.lateral_acceleration_mps2 = 0.0);
    assert_eq!(session.known.status, Verdict::Inconsistent);
    assert!(session.known.height_m.is_none());
    let told = events(&mut session);
    let told: Vec<_> = told.iter().filter(|event| event["subject"] == "channels").collect();
    let [event] = &told[..] else { panic!("{told:?}") };
    let message = event["message"].as_str().unwrap();
    // The first half minute may begin before it, and the roll angle shows it, too.
    let told = ["stood still in turns", "times the product", "has been 0.000 m/s² for 30 s"];
    assert!(told.iter().any(|words| message.contains(words)), "{message}");
    assert!(session.wrong_signal().unwrap().contains("lateral_acceleration stood still in turns"));
    weave(&mut session, 120, |_| {});
    assert_ne!(session.known.status, Verdict::Inconsistent);
}

/// Before there is any height, too.
#[test]
fn signals_that_never_agree_are_told() {
    let mut session = session(None, 0.0);
    weave(&mut session, 0, |sample| sample.speed_mps = 0.0);
    assert_eq!(session.known.status, Verdict::Inconsistent);
    assert!(names(&mut session).contains(&"channels".to_owned()));
}

/// A gain that one stretch does not show is known after two minutes.
#[test]
fn a_wrong_gain_of_the_lateral_acceleration_is_told() {
    let mut session = session(None, 0.0);
    let wrong = |sample: &mut Sample<f64>| sample.lateral_acceleration_mps2 *= 1.3;
    weave(&mut session, 0, wrong);
    assert!(session.wrong_signal().is_none());
    weave(&mut session, 60, wrong);
    weave(&mut session, 120, wrong);
    assert!(session.wrong_signal().unwrap().contains("1.30 times the product"));
}

#[test]
fn a_roll_sensor_that_dies_is_told_after_three_turns() {
    let mut session = session(None, 0.0);
    learn(&mut session, [Some(2.0), Some(2.0)]);
    let stuck = |sample: &mut Sample<f64>| sample.roll_rad = 0.003;
    for k in 0..4 {
        // Straight driving ends each maneuver.
        weave(&mut session, 100 * k, stuck);
        weave(&mut session, 100 * k + 60, |sample| {
            stuck(sample);
            (sample.lateral_acceleration_mps2, sample.yaw_rate_radps) = (0.0, 0.0);
        });
    }
    let told = events(&mut session);
    let told: Vec<_> = told.iter().filter(|event| event["subject"] == "turns").collect();
    let [event] = &told[..] else { panic!("{told:?}") };
    assert!(event["message"].as_str().unwrap().starts_with("the last 3 turns gave no height"));
}

/// Single rows may lack a roll angle; after half a second without one there are no signals.
#[test]
fn a_single_row_without_a_roll_angle_changes_no_state() {
    let mut session = session(None, 0.0);
    let mut drive = |from_us: u64, rows: u64, roll_rad: f64| {
        for k in 0..rows {
            let sample = Sample { roll_rad, ..sample(from_us + k * 10_000) };
            session.tick(0.0, sample.time_us);
            session.push(sample).unwrap();
        }
        let states = events(&mut session).into_iter().filter(|event| event["event"] == "state");
        states.map(|event| event["state"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(drive(0, 200, 0.0), ["straight"]);
    assert_eq!(drive(2_000_000, 1, f64::NAN), [""; 0]);
    assert_eq!(drive(2_010_000, 100, 0.0), [""; 0]);
    assert_eq!(drive(3_010_000, 45, f64::NAN), [""; 0]);
    assert_eq!(drive(3_460_000, 10, f64::NAN), ["no signals"]);
    assert_eq!(drive(3_560_000, 100, 0.0), ["straight"]);
}

/// The noise of a roll rate whose integral is the roll angle is in the interval, as in `cg estimate`.
#[test]
fn the_noise_of_a_roll_rate_widens_the_interval() {
    let mut one = one_turn();
    one.outcomes[1].height_m = Ok(Measured { value: 2.0, sd: 0.01 });
    let mut session = session(None, 0.0);
    learn(&mut session, [None, Some(2.0)]);
    let before_m = session.host_sd_m();
    for k in 0..1000_u32 {
        let roll_rate_radps = if k % 2 == 0 { 2e-3 } else { -2e-3 };
        let angle = LogRow { roll_to_gravity_rad: 0.03, ..LogRow::ABSENT };
        session.rated.push(&LogRow { time_s: f64::from(k) * 0.02, roll_rate_radps, ..angle });
    }
    session.maneuver(&one).unwrap();
    let by_rate = session.rated.ratio_sd(Channel::LateralAcceleration);
    assert!(by_rate > 0.01, "{by_rate}");
    let (design, height) = (session.estimator.design(), (Channel::LateralAcceleration, 2.0));
    let turn = [one.speed_mps, session.known.trailer_mass_kg];
    let by_rate_m = session.rated.height_sd_m(design, height, turn);
    let after_m = session.host_sd_m();
    assert!((after_m - before_m.hypot(by_rate_m)).abs() < 1e-9, "{before_m} {by_rate_m} {after_m}");
}

/// A restart knows nothing of the signals, but that they were wrong, until it has seen as much as it takes to know a gain.
#[test]
fn a_restart_keeps_that_signals_were_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = kept_in(folder.path(), None);
    learn(&mut session, [Some(2.0), Some(2.0)]);
    let wrong = |sample: &mut Sample<f64>| sample.lateral_acceleration_mps2 *= 1.3;
    for minute in 0..3 {
        weave(&mut session, 60 * minute, wrong);
    }
    assert_eq!(session.known.status, Verdict::Inconsistent);
    session.save().unwrap();
    for is_wrong in [true, false] {
        let mut session = kept_in(folder.path(), None);
        assert!(session.restore().unwrap());
        assert_eq!(session.known.status, Verdict::Inconsistent);
        for minute in 0..3 {
            weave(&mut session, 60 * minute, |sample| {
                if is_wrong {
                    wrong(sample);
                }
            });
            let found = session.wrong_signal();
            assert_eq!(found.is_some(), is_wrong || minute < 2, "minute {minute}: {found:?}");
        }
    }
}
