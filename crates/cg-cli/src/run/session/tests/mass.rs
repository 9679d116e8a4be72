//! Heights of loads that are not on the trailer any more.

use cg_core::{HeightError, Reject};

use super::*;

/// Straight driving with a mass, in which nothing is known of the roll angle.
fn weighed(session: &mut Trial, time_us: u64, mass_kg: f64) {
    let mut sample = Sample { trailer_mass_kg: mass_kg, ..sample(time_us) };
    session.samples += 1;
    session.weigh(&mut sample).unwrap();
}

/// The maneuver of a turn of the nominal mass.
pub(super) fn one_turn() -> Maneuver<f64> {
    let mut session = session(Some(nominal_kg()), 0.0);
    turn(&mut session, 0);
    session.estimator.finish().unwrap()
}

/// A session after a restart with a height of 2 m of a load that was weighed.
fn restarted() -> Trial {
    let mut session = session(None, 0.0);
    learn(&mut session, [Some(2.0), Some(2.0)]);
    session.mass_source = MassSource::Kept;
    session
}

/// The first mass of a bus comes after the first samples, and is of the present load as well.
#[test]
fn the_first_mass_of_a_signal_hides_the_height_of_another_load() {
    let mut session = restarted();
    for k in 0..100 {
        weighed(&mut session, k * 10_000, f64::NAN);
    }
    assert!(session.known.height_m.is_some() && events(&mut session).is_empty());
    weighed(&mut session, SECOND_US, 1.2 * nominal_kg());
    assert_eq!(names(&mut session), ["load"]);
    assert!(session.known.height_m.is_none());
    // Later ones vary in a turn.
    let mut session = restarted();
    weighed(&mut session, 0, nominal_kg());
    weighed(&mut session, SECOND_US, 1.2 * nominal_kg());
    assert!(session.known.height_m.is_some() && events(&mut session).is_empty());
}

/// A turn of the load before that closes afterwards changes nothing; the mass of that load does.
#[test]
fn a_height_stays_hidden_until_its_load_is_back() {
    let mut session = restarted();
    weighed(&mut session, 0, 1.2 * nominal_kg());
    assert!(session.known.height_m.is_none());
    session.update(nominal_kg());
    assert!(session.known.height_m.is_none());
    let shown_kg = session.known.trailer_mass_kg;
    assert!((shown_kg - 1.2 * nominal_kg()).abs() < 1e-6, "{shown_kg}");
    weighed(&mut session, SECOND_US, 1.01 * nominal_kg());
    assert!((session.known.height_m.unwrap() - 2.0).abs() < 1e-9);
    assert_eq!(names(&mut session), ["load"]);
}

#[test]
fn a_contradiction_names_a_mass_that_nothing_confirms() {
    for (source, words) in [
        (MassSource::Kept, Some("is from before the restart")),
        (MassSource::Nominal, Some("is from the vehicle file")),
        (MassSource::Signal, None),
    ] {
        let mut session = session(None, 0.0);
        learn(&mut session, [None, Some(2.0)]);
        session.mass_source = source;
        let message = session.contradiction();
        assert_eq!(message.contains("or another load"), words.is_some(), "{message}");
        assert!(words.is_none_or(|words| message.contains(words)), "{message}");
        // There is no steer angle.
        assert!(!message.contains("steer"), "{message}");
        session.seen[Quantity::Steer.index()] = true;
        assert!(session.contradiction().contains("steer channel without a possible height"));
    }
}

/// A turn whose height is impossible at the mass of a load before the restart is of another load. One that is possible shows the
/// height again.
#[test]
fn an_impossible_turn_with_an_old_mass_hides_the_height() {
    let mut one = one_turn();
    let impossible = Reject::Height(HeightError::OutOfRange { height_m: 7.7 });
    // The last mass of a signal may be older than two minutes.
    let weighings = [
        (MassSource::Kept, None, true),
        (MassSource::Signal, Some(0), false),
        (MassSource::Signal, Some(121), true),
    ];
    for (source, age_s, is_hidden) in weighings {
        let mut session = restarted();
        session.mass_source = source;
        if let Some(age_s) = age_s {
            session.weighing.weighed.weigh(0, [nominal_kg(); 2], 15.0);
            (one.start_us, one.end_us) = (age_s * SECOND_US, (age_s + 10) * SECOND_US);
        }
        for outcome in &mut one.outcomes {
            outcome.height_m = Err(impossible);
        }
        session.maneuver(&one).unwrap();
        assert_eq!(session.known.height_m.is_none(), is_hidden, "{source:?}");
        assert_eq!(names(&mut session).contains(&"load".to_owned()), is_hidden);
        // A mass that is given now is doubted after two.
        session.maneuver(&one).unwrap();
        assert!(session.known.height_m.is_none());
        assert_eq!(names(&mut session).contains(&"load".to_owned()), !is_hidden, "told once");
        if is_hidden {
            // A signal confirms that it is another load.
            let mut weighs = restarted();
            weighs.maneuver(&one).unwrap();
            weighed(&mut weighs, SECOND_US, 1.5 * nominal_kg());
            weighs.update(nominal_kg());
            assert!(weighs.known.height_m.is_none());
        }
        one.outcomes[0].height_m = Ok(Measured { value: 2.0, sd: 0.1 });
        session.maneuver(&one).unwrap();
        assert!(session.known.height_m.is_some());
    }
}

/// A mass that nothing has weighed since a turn showed another load is doubted, wherever it is from, but for the vehicle
/// file's, of which a message was given before.
#[test]
fn a_mass_that_stays_the_same_with_another_load_is_told() {
    let mut one = one_turn();
    let cases = [
        (MassSource::Signal, 1.0, true),
        (MassSource::Given, 1.0, true),
        (MassSource::Signal, 1.01, false),
        (MassSource::Nominal, 1.0, false),
    ];
    for (source, times, is_told) in cases {
        let mut session = restarted();
        session.mass_source = source;
        // A scale has weighed the trailer in this turn.
        session.weighing.weighed.weigh(one.end_us, [nominal_kg(); 2], 15.0);
        session.turn_kg = nominal_kg();
        one.trailer_mass_kg = times * nominal_kg();
        session.doubt_held_mass(&one).unwrap();
        let told = events(&mut session);
        let words = "the trailer mass is still";
        assert_eq!(
            told.iter().any(|event| event.to_string().contains(words)),
            is_told,
            "{source:?}"
        );
    }
}

/// A signal that goes on to give the mass of the load before does not show its height again, and neither do turns that are
/// impossible to the other side.
#[test]
fn two_impossible_turns_in_a_row_hide_the_height() {
    let mut one = one_turn();
    let mut shown_after = |heights_m: [f64; 2]| {
        let mut session = restarted();
        session.mass_source = MassSource::Signal;
        for (time_us, height_m) in [SECOND_US, 2 * SECOND_US].into_iter().zip(heights_m) {
            weighed(&mut session, time_us, nominal_kg());
            (one.start_us, one.end_us) = (time_us, time_us);
            for outcome in &mut one.outcomes {
                outcome.height_m = Err(Reject::Height(HeightError::OutOfRange { height_m }));
            }
            session.maneuver(&one).unwrap();
        }
        weighed(&mut session, 3 * SECOND_US, nominal_kg());
        session.update(nominal_kg());
        let told = events(&mut session);
        let is_told = told.iter().any(|event| event.to_string().contains("two turns in a row"));
        assert_eq!(is_told, session.known.height_m.is_none(), "{told:?}");
        session.known.height_m.is_some()
    };
    assert!(!shown_after([7.7, 7.8]) && !shown_after([0.3, 0.3]));
    assert!(shown_after([7.7, 0.3]) && shown_after([0.3, 7.7]));
}

/// At a walking pace a design says nothing of heights, but the mass in the turns before is as uncertain as it was.
#[test]
fn a_truck_that_stands_has_the_interval_of_its_turns() {
    let one = one_turn();
    let mut session = session(None, 0.0);
    learn(&mut session, [Some(2.0), Some(2.0)]);
    let before_m = session.known.height_sd_m.unwrap();
    assert!(before_m > 0.3, "any load: {before_m}");
    session.maneuver(&one).unwrap();
    for speed_mps in [15.0, 1.0, 0.0] {
        session.speed_mps = speed_mps;
        session.update(nominal_kg());
        let found_m = session.known.height_sd_m.unwrap();
        assert!((found_m / before_m - 1.0).abs() < 0.05, "{speed_mps} m/s: {found_m} {before_m}");
    }
}

/// What a mass was given with is not forgotten, whether by an option or beside it in a log.
#[test]
fn a_restart_keeps_how_exact_a_mass_is() {
    for (given_kg, option_kg, logged_kg) in
        [(Some(20e3), Some(1100.0), None), (None, None, Some(1100.0)), (None, Some(1100.0), None)]
    {
        let folder = tempfile::tempdir().unwrap();
        let mut session = kept_in(folder.path(), given_kg);
        (session.weighing.sd_kg, session.weighing.logged_sd_kg) = (option_kg, logged_kg);
        if given_kg.is_none() {
            session.mass_source = MassSource::Signal;
        }
        let memory = memory([Some(2.0), None], 20e3);
        session.estimator = Engine::restored(&design(), &session.options, &memory).unwrap();
        session.update(20e3);
        session.save().unwrap();
        let before_m = session.known.height_sd_m.unwrap();
        // Twice, because what is kept is kept again.
        for _ in 0..2 {
            session = kept_in(folder.path(), None);
            assert!(session.restore().unwrap());
            let known = &session.known;
            assert_eq!(known.trailer_mass_source, MassSource::Kept);
            assert!((known.trailer_mass_sd_kg - 1100.0).abs() < 1e-9);
            let sd_m = known.height_sd_m.unwrap();
            assert!((sd_m / before_m - 1.0).abs() < 1e-6, "{sd_m} {before_m}");
            session.save().unwrap();
        }
    }
}

/// As in `cg estimate`, once for each load.
#[test]
fn a_height_that_no_load_has_is_told() {
    let one = one_turn();
    for (height_m, is_told) in [(2.4, false), (2.7, true)] {
        let mut session = restarted();
        learn(&mut session, [Some(height_m), Some(height_m)]);
        session.maneuver(&one).unwrap();
        session.maneuver(&one).unwrap();
        let told = names(&mut session);
        let count = told.iter().filter(|name| *name == "height").count();
        assert_eq!(count, usize::from(is_told), "{height_m} m: {told:?}");
    }
}

/// On a bus a mass is held in every sample. It confirms a load for two minutes after it came, and not for ever, and one that is held says
/// nothing new of a load that a turn doubts.
#[test]
fn a_mass_that_is_held_on_a_bus_grows_old() {
    let mut session = restarted();
    session.mass_source = MassSource::Signal;
    let held = |session: &mut Trial, time_us: u64| {
        session.weighing.heard_us = Some(SECOND_US);
        weighed(session, time_us, nominal_kg());
    };
    for s in 1..=300 {
        held(&mut session, s * SECOND_US);
    }
    let fresh = [120, 121, 122].map(|s| session.weighing.weighed.covers(s * SECOND_US));
    assert_eq!(fresh, [true, true, false]);
    let mut one = one_turn();
    (one.start_us, one.end_us) = (290 * SECOND_US, 300 * SECOND_US);
    for outcome in &mut one.outcomes {
        outcome.height_m = Err(Reject::Height(HeightError::OutOfRange { height_m: 7.7 }));
    }
    for s in [300, 310] {
        session.maneuver(&one).unwrap();
        held(&mut session, s * SECOND_US);
    }
    let told = names(&mut session).into_iter().filter(|name| name == "load").count();
    assert!(told == 1 && session.doubted.hides && session.known.height_m.is_none(), "{told}");
}

/// A scale that sends once after loading, as one that sends on change does.
#[test]
fn a_mass_that_came_once_hides_the_height_of_another_load() {
    let mut session = restarted();
    session.mass_source = MassSource::Signal;
    weighed(&mut session, SECOND_US, nominal_kg());
    weighed(&mut session, 2 * SECOND_US, 1.2 * nominal_kg());
    for s in 3..12 {
        weighed(&mut session, s * SECOND_US, f64::NAN);
    }
    assert!(session.known.height_m.is_some());
    weighed(&mut session, 12 * SECOND_US, f64::NAN);
    assert!(session.known.height_m.is_none());
    assert_eq!(names(&mut session), ["load"]);
}

/// A mass below that of the empty trailer, which counts instead, is neither old nor of before.
#[test]
fn a_light_mass_is_not_told_as_an_old_one() {
    let mut session = session(None, 0.0);
    session.mass_source = MassSource::Signal;
    session.weighing.weighed.weigh(0, [6e3, 6.3e3], 15.0);
    let mut one = one_turn();
    for outcome in &mut one.outcomes {
        outcome.height_m = Err(Reject::Height(HeightError::OutOfRange { height_m: 6.6 }));
    }
    session.maneuver(&one).unwrap();
    assert!(!names(&mut session).contains(&"load".to_owned()));
}

/// What came off may have stood anywhere in the range of heights. The next turn shows the height of the rest; what a scale may do by
/// itself does not count.
#[test]
fn a_part_of_the_load_that_is_gone_makes_the_interval_wider() {
    for (share, is_part) in [(1.005, false), (0.96, true), (1.03, true)] {
        let weighed_after = |turn_kg: f64| {
            let mut session = restarted();
            session.mass_source = MassSource::Signal;
            session.height_kg = turn_kg;
            session.update(nominal_kg());
            for s in 0..60 {
                weighed(&mut session, s * SECOND_US, share * nominal_kg());
            }
            session
        };
        let sd_m = |session: &Trial| session.known.height_sd_m.unwrap();
        let before_m = sd_m(&weighed_after(share * nominal_kg()));
        let mut session = weighed_after(nominal_kg());
        let range_m = design().greatest_height_m - design().least_height_m;
        let part_m = (share - 1.0_f64).abs() * range_m / 12.0_f64.sqrt();
        let expected_m = before_m.hypot(if is_part { part_m } else { 0.0 });
        assert!((sd_m(&session) / expected_m - 1.0).abs() < 1e-9, "{share}: {expected_m}");
        // A turn without a height says nothing of the rest.
        let mut turn = one_turn();
        turn.trailer_mass_kg = share * nominal_kg();
        let mut without = turn;
        for outcome in &mut without.outcomes {
            outcome.height_m = Err(Reject::Absent);
        }
        turn.outcomes[0].height_m = Ok(Measured { value: 2.0, sd: 0.1 });
        for (s, one, left_m) in
            [(60, without, if is_part { part_m / share } else { 0.0 }), (61, turn, 0.0)]
        {
            session.maneuver(&one).unwrap();
            weighed(&mut session, s * SECOND_US, share * nominal_kg());
            assert!((session.part_sd_m() - left_m).abs() < 1e-3 * part_m, "{share} {s}");
        }
    }
}
