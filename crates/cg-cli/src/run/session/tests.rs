mod lift;
mod mass;
mod signals;
mod warning;

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::sync::LazyLock;

use cg_core::decide::height::Fusion;
use cg_core::{CHANNELS, Measured, Memory, ThresholdLine};
use cg_logs::learn::Learned;
use cg_logs::state::Owner;
use cg_output::{Files, Kind, Target};
use cg_vehicle::scales::Scale;
use cg_vehicle::{Variant, Vehicle};
use serde_json::Value;

use super::*;
use crate::run::state::{SavedLoad, StateFile};
use crate::run::transmit::CYCLE_US;

type Trial = Session<Vec<u8>>;

const SECOND_US: u64 = 1_000_000;

fn truck() -> Vehicle {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
    Vehicle::load(file).unwrap()
}

/// Its state file.
fn state(folder: &Path) -> StateFile {
    let owner = Owner::of(&truck(), None, &design()).unwrap();
    StateFile::new(target(folder, Kind::State), owner)
}

/// A truck with a threshold of 0.4 g at every height, mass and speed.
fn design() -> Design<f64> {
    static DESIGN: LazyLock<Design<f64>> = LazyLock::new(|| {
        let mut design = cg_vehicle::design::design(&truck(), Variant::Complete).unwrap();
        design.thresholds = [ThresholdLine { threshold_g: [[0.4; 8]; 2] }; 6];
        design
    });
    *DESIGN
}

fn nominal_kg() -> f64 {
    design().nominal_trailer_mass_kg
}

/// Warnings begin at 0.2 and 0.32 g.
fn session_with(mass_kg: Option<f64>, status_s: f64, outputs: Outputs<Vec<u8>>) -> Trial {
    let warner = Warner::new(&[0.5, 0.8], 0.05).unwrap();
    Session::new((&design(), EstimateOptions::default()), warner, mass_kg, status_s, outputs)
}

fn session(mass_kg: Option<f64>, status_s: f64) -> Trial {
    session_with(mass_kg, status_s, Outputs::new(Vec::new(), None, None, None))
}

fn target(folder: &Path, kind: Kind) -> Target {
    Files::new(false).writes("--file", &folder.join("file"), kind).unwrap()
}

/// A session with a state file.
fn kept_in(folder: &Path, mass_kg: Option<f64>) -> Trial {
    session_with(mass_kg, 0.0, Outputs::new(Vec::new(), Some(state(folder)), None, None))
}

/// The events since the last call.
fn events(session: &mut Trial) -> Vec<Value> {
    let text = String::from_utf8(std::mem::take(&mut session.outputs.lines)).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The names of the events since the last call; a notice is named by its subject.
fn names(session: &mut Trial) -> Vec<String> {
    let name = |event: &Value| {
        let subject = &event["subject"];
        let name = if subject.is_null() { &event["event"] } else { subject };
        name.as_str().unwrap().to_owned()
    };
    events(session).iter().map(name).collect()
}

/// Straight driving; the mass is absent.
fn sample(time_us: u64) -> Sample<f64> {
    let mut sample = Sample::absent(time_us);
    (sample.speed_mps, sample.roll_rad, sample.lateral_acceleration_mps2) = (15.0, 0.0, 0.0);
    sample
}

/// A turn of five seconds.
fn turn(session: &mut Trial, from_us: u64) {
    for k in 0..500 {
        let mut sample = sample(from_us + k * 10_000);
        (sample.roll_rad, sample.lateral_acceleration_mps2) = (0.02, 1.0);
        session.tick(0.0, sample.time_us);
        session.push(sample).unwrap();
    }
}

/// What was learned from maneuvers with these heights (steer angle, lateral acceleration), each with
/// a standard deviation of 0.01 m.
fn memory(heights_m: [Option<f64>; 2], trailer_mass_kg: f64) -> Memory<f64> {
    let mut fused = [Fusion::new(); CHANNELS];
    for (fusion, height_m) in fused.iter_mut().zip(heights_m) {
        fusion.push(Measured { value: height_m.unwrap_or(f64::NAN), sd: 0.01 }, 0.0);
    }
    let correlation = [[0.0; CHANNELS]; CHANNELS];
    Memory { fused, correlation, trailer_mass_kg, load_mass_kg: None, waiting: None }
}

fn learn(session: &mut Trial, heights_m: [Option<f64>; 2]) {
    let memory = memory(heights_m, nominal_kg());
    session.estimator = Engine::restored(&design(), &session.options, &memory).unwrap();
    session.update(nominal_kg());
}

fn near(found: &Value, expected: f64) {
    assert!(found.as_f64().is_some_and(|found| (found - expected).abs() < 1e-9), "{found}");
}

#[test]
fn events_have_the_time_stamp_of_their_cause() {
    let mut session = session(None, 0.0);
    session.tick(1000.5, 2 * SECOND_US);
    session.notice("trial", "text").unwrap();
    near(&events(&mut session)[0]["time_s"], 1000.5);
    assert!((session.time_s(3 * SECOND_US) - 1001.5).abs() < 1e-9);
}

#[test]
fn a_jump_of_the_time_stamps_is_told() {
    let mut session = session(None, 0.0);
    let instant = |jump_us| Instant { stream_us: SECOND_US, jump_us };
    session.at(5.0, instant(0)).unwrap();
    assert!(events(&mut session).is_empty());
    session.at(5.0, instant(-1_500_000)).unwrap();
    let [event] = &events(&mut session)[..] else { panic!("one event") };
    near(&event["time_s"], 5.0);
    assert_eq!(event["subject"], "clock");
    assert_eq!(event["message"], "the time stamps jumped by -1.500 s");
}

#[test]
fn a_given_mass_replaces_that_of_every_sample() {
    let mut session = session(Some(21e3), 0.0);
    for mass_kg in [f64::NAN, 30e3] {
        let mut sample = Sample { trailer_mass_kg: mass_kg, ..sample(0) };
        session.weigh(&mut sample).unwrap();
        assert!((sample.trailer_mass_kg - 21e3).abs() < 1e-9);
    }
    session.tick(0.0, 60 * SECOND_US);
    session.run_periodic(false).unwrap();
    assert!(events(&mut session).is_empty());
    let status = session.status();
    assert!((status.result.trailer_mass_kg - 21e3).abs() < 1e-9);
    assert_eq!(status.result.trailer_mass_source, MassSource::Given);
}

/// Five seconds after the first sample without a mass, and only once.
#[test]
fn the_nominal_mass_is_told_after_a_while() {
    let mut session = session(None, 0.0);
    session.tick(0.0, 60 * SECOND_US);
    session.run_periodic(false).unwrap();
    assert!(events(&mut session).is_empty(), "without a sample there is nothing to weigh");
    for time_us in [60 * SECOND_US, 61 * SECOND_US] {
        session.weigh(&mut sample(time_us)).unwrap();
    }
    for (now_us, expected) in [(64_999_999, 0), (65_000_000, 1), (66_000_000, 0)] {
        session.tick(0.0, now_us);
        session.run_periodic(false).unwrap();
        let all = events(&mut session);
        assert_eq!(all.len(), expected, "{now_us}");
        let named = |event: &Value| event["message"].as_str().unwrap().starts_with("no signal");
        assert!(all.iter().all(named));
    }
    let mut weighed = Sample { trailer_mass_kg: 21e3, ..sample(67 * SECOND_US) };
    session.weigh(&mut weighed).unwrap();
    session.weigh(&mut weighed).unwrap();
    let [event] = &events(&mut session)[..] else { panic!("one event") };
    let message = "a signal gives a trailer mass of 21000 kg, which is used from now on";
    assert_eq!(event["message"], message);
}

#[test]
fn a_mass_that_arrives_in_time_is_not_told() {
    let mut session = session(None, 0.0);
    session.push(sample(0)).unwrap();
    let weighed = Sample { trailer_mass_kg: 21e3, ..sample(10_000) };
    session.push(weighed).unwrap();
    session.tick(0.0, 900_000);
    session.run_periodic(false).unwrap();
    session.report_nominal_mass().unwrap();
    assert_eq!(names(&mut session), ["state"]);
    let status = session.status();
    assert!((status.result.trailer_mass_kg - 21e3).abs() < 1e-9);
    assert_eq!(status.result.trailer_mass_source, MassSource::Signal);
    assert_eq!(status.samples, 2);
}

#[test]
fn a_state_is_told_when_it_changes() {
    let mut session = session(Some(nominal_kg()), 0.0);
    let roll_only = |time_us| Sample { lateral_acceleration_mps2: f64::NAN, ..sample(time_us) };
    let turning = |time_us| Sample { lateral_acceleration_mps2: 3.0, ..sample(time_us) };
    let samples = [sample(0), sample(100_000), turning(200_000), turning(300_000)];
    for one in samples.into_iter().chain([roll_only(1_000_000), roll_only(1_100_000)]) {
        session.push(one).unwrap();
    }
    let states: Vec<Value> =
        events(&mut session).iter().map(|event| event["state"].clone()).collect();
    assert_eq!(states, ["straight", "turning", "no signals"]);
}

#[test]
fn missing_signals_are_told_when_they_change() {
    let mut session = session(None, 0.0);
    session.missing(Vec::new()).unwrap();
    assert!(events(&mut session).is_empty());
    for missing in [vec!["roll"], vec!["roll"], Vec::new()] {
        session.missing(missing).unwrap();
    }
    let missing: Vec<Value> =
        events(&mut session).iter().map(|one| one["missing"].clone()).collect();
    assert_eq!(missing, [serde_json::json!(["roll"]), serde_json::json!([])]);
    session.missing(vec!["speed"]).unwrap();
    session.drive("straight").unwrap();
    let [_, event] = &events(&mut session)[..] else { panic!("two events") };
    assert_eq!((&event["state"], &event["missing"][0]), (&"straight".into(), &"speed".into()));
}

#[test]
fn samples_too_far_apart_are_told_once_and_not_used() {
    for (roll_rad, tilt_rad, subject) in [(0.0, f64::NAN, "roll"), (f64::NAN, 0.0, "tilt")] {
        let mut session = session(None, 0.0);
        for k in 0..10 {
            session.push(Sample { roll_rad, tilt_rad, ..sample(k * SECOND_US) }).unwrap();
        }
        assert_eq!(names(&mut session), [subject]);
        assert_eq!(session.status().samples, 10);
    }
}

#[test]
fn silence_ends_the_maneuver() {
    let mut session = session(Some(nominal_kg()), 0.0);
    session.tick(0.0, 10 * SECOND_US);
    session.run_periodic(false).unwrap();
    assert!(events(&mut session).is_empty(), "before the first sample there is no silence");
    turn(&mut session, 0);
    assert_eq!(names(&mut session), ["state"]);
    for (now_us, expected) in
        [(5_990_000, &[][..]), (5_990_001, &["maneuver", "state"]), (6_990_000, &[])]
    {
        session.tick(0.0, now_us);
        session.run_periodic(false).unwrap();
        assert_eq!(names(&mut session), expected, "{now_us}");
    }
}

#[test]
fn a_maneuver_ends_with_its_result() {
    let mut session = session(None, 0.0);
    turn(&mut session, 0);
    let maneuver = session.estimator.finish().unwrap();
    events(&mut session);
    // Another load is told only if the estimator detects it in this maneuver.
    session.maneuver(&maneuver).unwrap();
    assert_eq!(names(&mut session), ["mass", "maneuver"]);
    learn(&mut session, [Some(1.5), Some(2.0)]);
    session.known.status = Verdict::Ok;
    session.maneuver(&maneuver).unwrap();
    session.maneuver(&maneuver).unwrap();
    assert_eq!(names(&mut session), ["maneuver", "channels", "maneuver"]);
}

#[test]
fn a_contradiction_of_the_channels_is_told_when_it_begins() {
    let mut session = session(Some(nominal_kg()), 0.0);
    learn(&mut session, [Some(1.5), Some(2.0)]);
    assert!(!session.has_height());
    session.compare(Verdict::Inconsistent).unwrap();
    assert!(events(&mut session).is_empty());
    session.compare(Verdict::Rejected).unwrap();
    let [event] = &events(&mut session)[..] else { panic!("one event") };
    let message = "inconsistent, so there is no height: steer channel 1.50 ± 0.01 m, \
                   lateral-acceleration channel 2.00 ± 0.01 m; check the sensors";
    assert_eq!(event["message"], message);
    learn(&mut session, [Some(2.0), Some(2.0)]);
    session.compare(Verdict::Ok).unwrap();
    assert!(events(&mut session).is_empty());
}

#[test]
fn the_result_names_the_channels_it_is_from() {
    for (heights_m, channel) in [
        ([Some(2.0), None], Some("steer")),
        ([None, Some(2.0)], Some("lateral-acceleration")),
        ([Some(2.0), Some(2.0)], Some("combined")),
        ([None, None], None),
    ] {
        let mut session = session(None, 0.0);
        learn(&mut session, heights_m);
        assert_eq!(session.known.channel.as_deref(), channel);
        assert_eq!(session.has_height(), channel.is_some());
    }
}

#[test]
fn status_follows_its_interval() {
    let mut session = session(None, 2.0);
    for (now_us, expected) in [(SECOND_US, 1), (2_999_999, 0), (3 * SECOND_US, 1), (4_999_999, 0)] {
        session.tick(0.0, now_us);
        session.run_periodic(false).unwrap();
        assert_eq!(names(&mut session), vec!["status"; expected], "{now_us}");
    }
}

#[test]
fn without_an_interval_there_is_no_status() {
    let mut session = session(None, 0.0);
    session.tick(0.0, 100 * SECOND_US);
    session.run_periodic(true).unwrap();
    session.stop("end").unwrap();
    assert_eq!(names(&mut session), ["stop"]);
}

#[test]
fn frames_follow_their_cycle() {
    let sent = Rc::new(Cell::new(0));
    let count = Rc::clone(&sent);
    let sender: crate::run::outputs::Sender = Box::new(move |_, _| count.set(count.get() + 1));
    let outputs = Outputs::new(Vec::new(), None, None, Some((sender, 0x80)));
    let mut session = session_with(None, 0.0, outputs);
    let times = [SECOND_US, SECOND_US + CYCLE_US - 1, SECOND_US + CYCLE_US];
    for (now_us, total) in times.into_iter().zip([1, 1, 2]) {
        session.tick(0.0, now_us);
        session.run_periodic(false).unwrap();
        assert_eq!(sent.get(), total, "{now_us}");
    }
    // The requested speed has a frame of its own, if it is asked for.
    session.request = Some(SpeedRequest::new(0.5));
    session.tick(0.0, 3 * SECOND_US);
    session.run_periodic(false).unwrap();
    assert_eq!(sent.get(), 4);
}

/// Whether the file of an output is written at each of these times.
fn written(session: &mut Trial, file: &Path, times_us: &[u64], live: bool) -> Vec<bool> {
    let each = times_us.iter().map(|&now_us| {
        session.tick(0.0, now_us);
        session.run_periodic(live).unwrap();
        std::fs::remove_file(file).is_ok()
    });
    each.collect()
}

#[test]
fn metrics_and_state_are_written_live_at_their_intervals() {
    for (kind, interval_us) in [(Kind::Metrics, METRICS_US), (Kind::State, SAVE_US)] {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        let mut session = if kind == Kind::State {
            kept_in(folder.path(), None)
        } else {
            let metrics = Some(target(folder.path(), kind));
            session_with(None, 0.0, Outputs::new(Vec::new(), None, metrics, None))
        };
        let times_us = [SECOND_US, SECOND_US + interval_us - 1, SECOND_US + interval_us];
        assert_eq!(written(&mut session, &file, &times_us, false), [false; 3]);
        assert_eq!(written(&mut session, &file, &times_us, true), [true, false, true]);
        session.stop("end").unwrap();
        assert!(file.exists());
    }
}

#[test]
fn an_output_that_fails_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("gone");
    std::fs::create_dir(&inside).unwrap();
    let metrics = Some(target(&inside, Kind::Metrics));
    let outputs = Outputs::new(Vec::new(), Some(state(&inside)), metrics, None);
    let mut session = session_with(None, 0.0, outputs);
    std::fs::remove_dir(&inside).unwrap();
    session.stop("end").unwrap();
    assert_eq!(names(&mut session), ["state", "metrics", "stop"]);
}

#[test]
fn the_end_tells_everything_once_more() {
    let mut session = session(None, 2.0);
    turn(&mut session, 0);
    session.counters.frames = 7;
    events(&mut session);
    session.stop("end of file").unwrap();
    let all = events(&mut session);
    let names: Vec<&str> = all.iter().map(|event| event["event"].as_str().unwrap()).collect();
    assert_eq!(names, ["notice", "maneuver", "status", "stop"]);
    assert_eq!((&all[3]["reason"], &all[3]["frames"]), (&"end of file".into(), &7.into()));
}

#[test]
fn without_a_state_nothing_is_restored() {
    assert!(!session(None, 0.0).restore().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut session = kept_in(folder.path(), None);
    assert!(!session.restore().unwrap());
    assert!(events(&mut session).is_empty());
}

#[test]
fn a_state_that_cannot_be_used_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut aside = kept_in(folder.path(), None);
    std::fs::write(folder.path().join("file"), "garbage").unwrap();
    assert!(!aside.restore().unwrap());
    let [event] = &events(&mut aside)[..] else { panic!("one event") };
    let message = event["message"].as_str().unwrap();
    assert!(message.starts_with("not used and renamed to "), "{message}");
    let mut unread = kept_in(folder.path(), None);
    std::fs::create_dir(folder.path().join("file")).unwrap();
    assert!(!unread.restore().unwrap());
    let [event] = &events(&mut unread)[..] else { panic!("one event") };
    let message = event["message"].as_str().unwrap();
    assert!(message.starts_with("cannot be read"), "{message}");
}

/// The nominal mass means that the load was not weighed.
#[test]
fn heights_and_a_weighed_mass_are_kept_over_a_restart() {
    for (mass_kg, given_kg, source) in [
        (nominal_kg(), None, MassSource::Nominal),
        (nominal_kg() * (1.0 + 1e-7), None, MassSource::Nominal),
        (nominal_kg() * (1.0 + 1e-5), None, MassSource::Kept),
        (nominal_kg() * 0.9, None, MassSource::Kept),
        (nominal_kg() * 0.9, Some(20e3), MassSource::Given),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut session = kept_in(folder.path(), given_kg);
        let memory = memory([Some(2.0), None], mass_kg);
        let load =
            SavedLoad { since_s: Some(0.3), scale: Some(Scale::AxleLoad), ..SavedLoad::default() };
        session.outputs.save(&memory, 5.0, load, Learned::default());
        assert!(session.restore().unwrap());
        assert!(session.has_height());
        let status = session.status();
        assert!(status.height_restored);
        assert_eq!(status.result.trailer_mass_source, source, "{mass_kg} kg");
        let scale = status.result.trailer_mass_scale;
        assert_eq!(scale == Some(Scale::AxleLoad), source == MassSource::Kept, "{mass_kg} kg");
        assert_eq!(status.load_since_s, Some(0.3));
        assert!((session.known.trailer_mass_kg - mass_kg).abs() < 1e-9);
    }
}

/// Channels that contradict each other give no height, but a restart must still know how strong the turns were.
#[test]
fn strong_turns_are_kept_while_there_is_no_height() {
    let mut session = session(None, 0.0);
    let strength = cg_logs::estimate::Strength { greatest: 0.75, sd: 0.09, ..Default::default() };
    session.strong = StrongTurns::kept(strength);
    learn(&mut session, [Some(1.5), Some(2.0)]);
    assert!(!session.has_height());
    assert_eq!(session.strength(), strength);
}

/// A trailer that was never weighed may have any load, after a restart as before it.
#[test]
fn the_interval_of_any_load_is_kept_over_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let mut before = kept_in(folder.path(), None);
    before.speed_mps = design().nominal_speed_mps;
    learn(&mut before, [Some(2.0), None]);
    let memory = memory([Some(2.0), None], nominal_kg());
    before.outputs.save(&memory, 5.0, SavedLoad::default(), Learned::default());
    let mut after = kept_in(folder.path(), None);
    assert!(after.restore().unwrap());
    let [before, after] = [&before, &after].map(|one| one.status().result.height_sd_m.unwrap());
    assert!(before > 0.1 && (after / before - 1.0).abs() < 1e-9, "{before} {after}");
}

/// A mass that arrives for the first time is not shown beside the height of another one.
#[test]
fn a_first_mass_hides_the_height_of_the_nominal_one_at_once() {
    let mut session = session(None, 0.0);
    session.samples = 1000;
    learn(&mut session, [Some(2.0), None]);
    assert!(session.has_height());
    let mut weighed = sample(1_000_000);
    weighed.trailer_mass_kg = 1.2 * nominal_kg();
    session.tick(0.0, weighed.time_us);
    session.push(weighed).unwrap();
    assert!(!session.has_height());
}
