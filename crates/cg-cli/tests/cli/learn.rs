//! A truck that learns itself from empty driving: events, state file, `--learn`, `--from-state`.

use serde_json::Value;

use crate::common::{Run, Scratch, cg, fixture, kraz};
use crate::run::{events, last_height, lines};

const EMPTY: &str = "logs/A_p00_v50_L.csv";
const LADEN: &str = "logs/A_p20_h190_v50_L.csv";
/// Height of the laden log.
const LADEN_M: f64 = 1.9;

fn drive(log: &str, state: &str, more: &[&str]) -> Run {
    let (log, vehicle) = (fixture(log), kraz());
    let mut arguments =
        vec!["run", "--csv", &log, "--vehicle", &vehicle, "--status-s", "0", "--state", state];
    arguments.extend(more);
    cg(&arguments)
}

fn error(lines: &[Value]) -> f64 {
    (last_height(lines) / LADEN_M - 1.0).abs()
}

fn stored(state: &str) -> Value {
    let text = std::fs::read_to_string(state).unwrap();
    serde_json::from_str(text.lines().next().unwrap()).unwrap()
}

/// The state of a truck that has made one trip with the empty trailer.
fn learned(scratch: &Scratch) -> String {
    let state = scratch.path("state.json");
    let first = lines(&drive(EMPTY, &state, &[]).done());
    let [one] = &events(&first, "learned")[..] else { panic!("{first:?}") };
    assert_eq!((&one["trips"], one["message"].as_str().unwrap().len() > 20), (&1.into(), true));
    state
}

/// An independent truck, 20 t at 1.90 m: 1.9 % off with the vehicle file alone.
#[test]
fn what_is_learned_from_an_empty_trip_is_used_from_the_next_start_on() {
    let scratch = Scratch::new();
    let state = learned(&scratch);
    let fresh = lines(&drive(LADEN, &scratch.path("other.json"), &[]).done());
    assert!(events(&fresh, "learned").is_empty());
    let before = std::fs::read(&state).unwrap();
    let laden = lines(&drive(LADEN, &state, &[]).done());
    let [start] = &events(&laden, "learned")[..] else { panic!("{laden:?}") };
    assert_eq!(start["trips"], 1);
    println!("{:.4} {:.4}", error(&fresh), error(&laden));
    assert!(error(&laden) < 0.5 * error(&fresh) && error(&laden) < 0.01);
    // A laden trip teaches nothing.
    assert_eq!(stored(&state)["learned"]["trips"].as_array().unwrap().len(), 1);
    std::fs::write(&state, before).unwrap();
    let twice = lines(&drive(EMPTY, &state, &[]).done());
    assert_eq!(events(&twice, "learned").last().unwrap()["trips"], 2);
}

/// The heights of a load that were found before the truck knew itself do not contradict those of the same load after it: the
/// design is another one, not the load.
#[test]
fn the_same_load_is_no_other_one_after_learning() {
    let scratch = Scratch::new();
    let state = scratch.path("state.json");
    let rows = |log: &str, after_s: f64| {
        let text = std::fs::read_to_string(fixture(log)).unwrap();
        let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        let shifted = rows.map(|row| {
            let (time, rest) = row.split_once(',').unwrap();
            format!("{:.2},{rest}\n", time.parse::<f64>().unwrap() + after_s)
        });
        shifted.collect::<String>()
    };
    let header = "time_s,steer_rad,roll_rad,speed_mps,lateral_acceleration_mps2,yaw_rate_radps,trailer_mass_kg\n";
    let trip = scratch.path("trip.csv");
    std::fs::write(&trip, format!("{header}{}{}", rows(EMPTY, 0.0), rows(LADEN, 100.0))).unwrap();
    let first =
        cg(&["run", "--csv", &trip, "--vehicle", &kraz(), "--status-s", "0", "--state", &state]);
    assert_eq!(events(&lines(&first.done()), "load_changed").len(), 1);
    let second = lines(&drive(LADEN, &state, &[]).done());
    assert_eq!(events(&second, "learned").len(), 1);
    assert_eq!(events(&second, "load_changed"), Vec::<&Value>::new());
    assert!(error(&second) < 0.01);
}

#[test]
fn learning_can_be_off() {
    let scratch = Scratch::new();
    let off = scratch.path("off.json");
    let found = lines(&drive(EMPTY, &off, &["--learn", "off"]).done());
    assert!(events(&found, "learned").is_empty());
    // As a state file without learning always was.
    assert!(stored(&off)["learned"].is_null());
    // What was learned is not used, and not lost.
    let state = learned(&scratch);
    let fresh = lines(&drive(LADEN, &off, &["--learn", "off"]).done());
    let laden = lines(&drive(LADEN, &state, &["--learn", "off"]).done());
    assert!(events(&laden, "learned").is_empty());
    assert!((last_height(&fresh) - last_height(&laden)).abs() < 1e-12);
    assert_eq!(stored(&state)["learned"]["trips"].as_array().unwrap().len(), 1);
}

/// The nominal mass of this vehicle file is that of the empty trailer.
#[test]
fn a_mass_that_is_given_or_unknown_teaches_nothing() {
    let scratch = Scratch::new();
    let given = scratch.path("given.json");
    drive(EMPTY, &given, &["--trailer-mass-kg", "8684"]).done();
    assert!(stored(&given)["learned"].is_null());
    let text = std::fs::read_to_string(kraz()).unwrap();
    let truck = text.replace("reference_mass_kg = 18684.0", "reference_mass_kg = 8684.0");
    assert_ne!(truck, text);
    let truck = scratch.file("truck.toml", truck);
    let text = std::fs::read_to_string(fixture(EMPTY)).unwrap();
    let unweighed: String =
        text.lines().flat_map(|line| [line.rsplit_once(',').unwrap().0, "\n"]).collect();
    for (name, log, trips) in [("no.json", unweighed, None), ("yes.json", text, Some(1))] {
        let (log, state) = (scratch.file("log.csv", log), scratch.path(name));
        cg(&["run", "--csv", &log, "--vehicle", &truck, "--state", &state]).done();
        assert_eq!(stored(&state)["learned"]["trips"].as_array().map(Vec::len), trips, "{name}");
    }
}

/// An interrupted trip counts: it ends when the truck starts again.
#[test]
fn a_trip_that_was_interrupted_counts() {
    let scratch = Scratch::new();
    let state = learned(&scratch);
    let text = std::fs::read_to_string(&state).unwrap();
    let mut content = stored(&state);
    let trip = content["learned"]["trips"].as_array_mut().unwrap().remove(0);
    content["learned"]["open"] = trip;
    let json = content.to_string();
    let sum = crc32(json.as_bytes());
    assert!(text.ends_with(&format!("{:08x}\n", crc32(text.lines().next().unwrap().as_bytes()))));
    std::fs::write(&state, format!("{json}\ncrc32 {sum:08x}\n")).unwrap();
    let laden = lines(&drive(LADEN, &state, &[]).done());
    assert_eq!(events(&laden, "learned").len(), 2);
    assert!(error(&laden) < 0.01);
}

/// The checksum of zip files.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}

#[test]
fn learning_needs_a_state_file_and_begins_with_the_calibration() {
    let scratch = Scratch::new();
    let (log, vehicle) = (fixture(EMPTY), kraz());
    let run = ["run", "--csv", &log, "--vehicle", &vehicle, "--learn", "on"];
    cg(&run).refused(&["--learn on", "--state"]);
    let (calibration, again) = (scratch.path("c.toml"), scratch.path("again.toml"));
    let laden = format!("{}={LADEN_M}", fixture(LADEN));
    cg(&["calibrate", "--vehicle", &vehicle, "--run", &laden, "-o", &calibration]).done();
    let state = scratch.path("state.json");
    let with = ["--calibration", &calibration];
    let off = lines(&drive(EMPTY, &state, &[&with[..], &["--learn", "off"]].concat()).done());
    assert!(events(&off, "learned").is_empty() && stored(&state)["learned"].is_null());
    let other = "logs/A_p10_h170_v50_L.csv";
    let calibrated = lines(&drive(other, &scratch.path("other.json"), &with).done());
    assert!(events(&calibrated, "learned").is_empty());
    assert_eq!(events(&lines(&drive(EMPTY, &state, &with).done()), "learned").len(), 1);
    let moved = lines(&drive(other, &state, &with).done());
    let [start] = &events(&moved, "learned")[..] else { panic!("{moved:?}") };
    let text = std::fs::read_to_string(&calibration).unwrap();
    let date = stored(&state)["learned"]["calibration_date"].as_str().unwrap().to_owned();
    assert!(text.contains(&format!("date = \"{date}\"")), "{date}");
    let message = start["message"].as_str().unwrap();
    assert!(message.ends_with(&format!("its calibration of {date}")), "{message}");
    let sd = |lines: &[Value]| events(lines, "maneuver").last().unwrap()["height_sd_m"].as_f64();
    assert!(sd(&moved).unwrap() < sd(&calibrated).unwrap(), "{moved:?} {calibrated:?}");
    assert!((last_height(&moved) / 1.7 - 1.0).abs() < 0.01);
    // The trip is also a run of a new calibration. Such a calibration contains it.
    cg(&["calibrate", "--vehicle", &vehicle, "--from-state", &state, "-o", &again]).done();
    cg(&["calibrate", "--vehicle", &fixture("vehicles/euro.toml"), "--from-state", &state])
        .refused(&["-o"]);
}

/// The trips of state files make a calibration, alone or with logs.
#[test]
fn state_files_become_a_calibration() {
    let scratch = Scratch::new();
    let (state, vehicle) = (learned(&scratch), kraz());
    let calibration = scratch.path("c.toml");
    let run = format!("{}={LADEN_M}", fixture("logs/A_p20_h220_v50_L.csv"));
    let calibrate = ["calibrate", "--vehicle", &vehicle, "--from-state", &state];
    let alone = cg(&[&calibrate[..], &["-o", &calibration]].concat()).done();
    assert!(alone.out.contains("state.json, trip 1"), "{}", alone.out);
    let log = fixture(LADEN);
    let estimate = ["estimate", &log, "--vehicle", &vehicle, "--calibration", &calibration];
    let found = cg(&[&estimate[..], &["--format", "json"]].concat()).done().answer();
    assert!((found["height_m"].as_f64().unwrap() / LADEN_M - 1.0).abs() < 0.01, "{found}");
    // A wrong height contradicts what was learned.
    cg(&[&calibrate[..], &["--run", &run, "-o", &scratch.path("d.toml")]].concat())
        .refused(&["no calibration is made"]);
    let right = format!("{}=2.2", fixture("logs/A_p20_h220_v50_L.csv"));
    cg(&[&calibrate[..], &["--run", &right, "-o", &scratch.path("e.toml")]].concat()).done();
    // Of another truck, and without a trip.
    let other = fixture("vehicles/euro.toml");
    cg(&["calibrate", "--vehicle", &other, "--from-state", &state, "-o", &calibration])
        .refused(&["another vehicle file"]);
    let nothing = scratch.path("nothing.json");
    drive(LADEN, &nothing, &[]).done();
    cg(&["calibrate", "--vehicle", &vehicle, "--from-state", &nothing, "-o", &calibration])
        .refused(&["contains no trip"]);
}

/// A log that is given and from which the truck has learned is one run.
#[test]
fn a_log_of_which_the_truck_has_learned_counts_once_in_a_calibration() {
    let scratch = Scratch::new();
    let state = learned(&scratch);
    let known = fixture(EMPTY) + "=empty";
    let calibrate = |name: &str, more: &[&str]| {
        let file = scratch.path(name);
        let given = ["calibrate", "--vehicle", &kraz(), "--run", &known, "-o", &file];
        let printed = cg(&[&given[..], more].concat()).done().out;
        let sd = |line: &&str| line.contains("steer ratio to");
        (printed.lines().find(sd).unwrap().to_owned(), printed)
    };
    let (alone, _) = calibrate("alone.toml", &[]);
    let (both, printed) = calibrate("both.toml", &["--from-state", &state]);
    assert_eq!(alone, both);
    assert!(printed.contains("1 of the trips in state files are logs of this calibration"));
}

/// The drive of the calibration, recorded again on board, is not a second one.
#[test]
fn a_trip_that_is_a_run_of_the_calibration_does_not_count_again() {
    let scratch = Scratch::new();
    let (file, state) = (scratch.path("calibration.toml"), scratch.path("state.json"));
    let known = fixture(EMPTY) + "=empty";
    cg(&["calibrate", "--vehicle", &kraz(), "--run", &known, "-o", &file]).done();
    let height_m =
        |state: &str| last_height(&lines(&drive(LADEN, state, &["--calibration", &file]).done()));
    let expected_m = height_m(&scratch.path("other.json"));
    let taken = lines(&drive(EMPTY, &state, &["--calibration", &file]).done());
    assert_eq!(events(&taken, "learned").len(), 1);
    let found_m = height_m(&state);
    assert!((found_m / expected_m - 1.0).abs() < 1e-9, "{found_m} {expected_m}");
}
