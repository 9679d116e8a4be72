//! Options for CAN frames: a source address that nobody sends, and options that no log can use.

use serde_json::Value;

use crate::common::{cg, estimate, fixture};
use crate::run::{drive, events, lines};

/// The messages of the notices with a subject.
fn told(lines: &[Value], subject: &str) -> Vec<String> {
    let of = events(lines, "notice").into_iter().filter(|line| line["subject"] == subject);
    of.map(|line| line["message"].as_str().unwrap().to_owned()).collect()
}

/// The address of the simulated roll sensor is 0xE4, that of VDC2 is 0x0B.
#[test]
fn an_address_that_nobody_sends_is_told_and_its_signal_is_missing() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let rolls = text.lines().filter(|line| line.contains("0CF029E4#")).count();
    assert!(rolls > 10_000);
    let wrong = ["--source-of", "roll=0x99"];
    let parts = ["--source-of roll=0x99", "those of 0xE4 are", "--source-of roll=0xE4"];
    let found = lines(&drive.replay(&drive.candump, &wrong).told(1, &[]));
    let notices = told(&found, "roll");
    assert_eq!(notices.len(), 1, "{notices:?}");
    let status = *events(&found, "status").last().unwrap();
    assert!(status["missing"].as_array().unwrap().contains(&"roll".into()), "{status}");
    assert_eq!(status["values_of_other_sources"].as_u64(), Some(rolls as u64));
    // Without a roll angle, the log has no samples.
    let refused = estimate(&drive.candump, &drive.truck, &wrong);
    for part in parts {
        assert!(notices[0].contains(part), "{notices:?}");
    }
    refused.refused(&parts);
    // The lateral acceleration of the same device is enough for a height.
    let wrong = ["--source-of", "steering_wheel=0x99"];
    let whole = lines(&drive.replay(&drive.candump, &wrong).done());
    assert!(told(&whole, "steering_wheel")[0].contains("those of 0x0B are"));
    let status = *events(&whole, "status").last().unwrap();
    assert_eq!(status["missing"].to_string(), "[\"steering_wheel\"]");
    let answer = estimate(&drive.candump, &drive.truck, &wrong).done().answer();
    let message = "--source-of steering_wheel=0x0B";
    assert!(answer["messages"].to_string().contains(message), "{answer}");
    let right = lines(&drive.replay(&drive.candump, &["--source-of", "roll=0xE4"]).done());
    assert!(told(&right, "roll").is_empty());
    assert_eq!(events(&right, "status").last().unwrap()["values_of_other_sources"], 0);
}

/// The address counts for a signal of a DBC file, too.
#[test]
fn a_mapped_signal_of_an_address_that_nobody_sends_is_told() {
    let drive = drive();
    let dbc = fixture("can/j1939.dbc");
    let map = ["--dbc", &dbc, "--signal", "roll_to_gravity=SSI2.RollAngle", "--source-of"];
    let found =
        lines(&drive.replay(&drive.candump, &[&map[..], &["roll=0x99"]].concat()).told(1, &[]));
    let notices = told(&found, "roll");
    assert!(notices[0].contains("those of 0xE4 are not used"), "{notices:?}");
    let status = *events(&found, "status").last().unwrap();
    assert!(status["missing"].as_array().unwrap().contains(&"roll".into()), "{status}");
    drive.replay(&drive.candump, &[&map[..], &["roll=0xE4"]].concat()).done();
}

/// A log of two seconds ends before the devices have had their time.
#[test]
fn a_short_log_tells_it_at_its_end() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let short: String = text
        .lines()
        .take_while(|line| !line.starts_with("(2."))
        .flat_map(|line| [line, "\n"])
        .collect();
    let log = drive.path("short.log");
    std::fs::write(&log, short).unwrap();
    let run = drive.replay(&log, &["--source-of", "roll=0x99"]).told(1, &[]);
    assert_eq!(told(&lines(&run), "roll").len(), 1);
}

/// A mixture of logs may have options for both kinds.
#[test]
fn options_that_no_log_can_use_are_refused() {
    let drive = drive();
    let bus = ["--bus", "can0"];
    let column = ["--column", "speed=speed_mps"];
    estimate(&drive.csv, &drive.truck, &bus).refused(&[
        "--bus is for CAN",
        "no log has any",
        "remove it",
    ]);
    let frames = ["--column is for", "--signal", "remove it"];
    estimate(&drive.candump, &drive.truck, &column).refused(&frames);
    drive.replay(&drive.candump, &column).refused(&frames);
    let flip = ["--flip", "roll,second_roll"];
    let parts = ["--flip second_roll: no CAN frame gives", "--signal"];
    estimate(&drive.candump, &drive.truck, &flip).refused(&parts);
    drive.replay(&drive.candump, &flip).refused(&parts);
    let both = ["estimate", &drive.csv, &drive.candump, "--vehicle", &drive.truck];
    cg(&[&both[..], &bus, &column].concat()).done();
}

/// A calibration reads each log twice, says what is wrong once, and keeps the file that is there.
#[test]
fn a_calibration_refuses_them_too() {
    let drive = drive();
    let (run, of) = (format!("{}=1.9", drive.candump), drive.path("c.toml"));
    let calibrate = ["calibrate", "--vehicle", &drive.truck, "--run", &run, "-o", &of];
    let column = ["--column", "speed=speed_mps"];
    cg(&[&calibrate[..], &column].concat()).refused(&["--column is for", "remove it"]);
    assert!(!std::path::Path::new(&of).exists());
    let wrong = ["--source-of", "steering_wheel=0x99"];
    let told = cg(&[&calibrate[..], &wrong].concat()).told(0, &["those of 0x0B are"]);
    assert_eq!(told.err.matches("those of 0x0B are").count(), 1, "{told:?}");
    let csv = format!("{}=1.9", drive.csv);
    let calibrate = ["calibrate", "--vehicle", &drive.truck, "--run", &csv, "-o", &of];
    cg(&[&calibrate[..], &["--bus", "can0"]].concat())
        .refused(&["--bus is for CAN", "no log has any"]);
}

/// A second roll sensor, at 0xE5, takes over when the first one falls silent.
#[test]
fn a_device_that_takes_over_is_told() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let changed: String = text
        .lines()
        .map(|line| {
            let address = if line.starts_with("(6") { "0CF029E5#" } else { "0CF029E4#" };
            line.replace("0CF029E4#", address) + "\n"
        })
        .collect();
    let log = drive.path("second.log");
    std::fs::write(&log, changed).unwrap();
    let found = lines(&drive.replay(&log, &[]).done());
    let notices = told(&found, "roll_to_gravity");
    assert_eq!(notices.len(), 1, "{notices:?}");
    let parts =
        ["0xE4 paused, and the values come from 0xE5", "--source-of roll_to_gravity=ADDRESS"];
    for part in parts {
        assert!(notices[0].contains(part), "{notices:?}");
    }
    let one = lines(&drive.replay(&log, &["--source-of", "roll_to_gravity=0xE4"]).done());
    assert!(told(&one, "roll_to_gravity").is_empty());
    let answer = estimate(&log, &drive.truck, &[]).done().answer();
    assert!(answer["messages"].to_string().contains("0xE4 paused"), "{answer}");
}

/// A scale that falls silent says nothing of the load of half an hour later, 6 t less: the interval contains any load.
#[test]
fn a_mass_that_no_longer_comes_is_not_that_of_the_next_load() {
    let drive = drive();
    let lighter = drive.path("lighter.log");
    let fixed = ["--maneuver", "drive", "--duration-s", "120", "--seed", "6", "--snr-db", "25"];
    let load = ["--payload-kg", "4000", "--height-m", "1.6", "-o", &lighter];
    let mut arguments = vec!["simulate", "--vehicle", &drive.truck];
    arguments.extend(fixed.iter().chain(&load));
    cg(&arguments).done();
    let later = |line: &str| {
        let (time, rest) = line.strip_prefix('(')?.split_once(')')?;
        Some(format!("({:.6}){rest}", time.parse::<f64>().ok()? + 1800.0))
    };
    let [first, second] =
        [&drive.candump, &lighter].map(|log| std::fs::read_to_string(log).unwrap());
    let joined = |with_mass: bool| {
        let kept = second.lines().filter(|line| with_mass || !line.contains("18FEEAC8#"));
        let text = first.clone() + &kept.filter_map(later).collect::<Vec<_>>().join("\n") + "\n";
        let log = drive.path("joined.log");
        std::fs::write(&log, text).unwrap();
        let found = lines(&drive.replay(&log, &[]).done());
        events(&found, "status").last().map(|status| (*status).clone()).unwrap()
    };
    let sd_kg = |status: &Value| status["trailer_mass_sd_kg"].as_f64().unwrap();
    let (weighed, silent) = (joined(true), joined(false));
    assert!(sd_kg(&weighed) < 1000.0, "{weighed}");
    assert!(silent["height_m"].is_null() || sd_kg(&silent) > 4000.0, "{silent}");
}
