//! A side wind on the body that the vehicle file describes.

use serde_json::Value;

use crate::common::{Scratch, cg, estimate, fixture};
use crate::run::{events, lines};

const SIDE: &str = "\n[wind]\nside_area_m2 = 34.0\nside_height_m = 2.4\n";
const STEP: [&str; 10] = [
    "--maneuver",
    "rounded-step",
    "--plant",
    "nonlinear",
    "--payload-kg",
    "12000",
    "--height-m",
    "1.9",
    "--rate-hz",
    "50",
];

/// A vehicle file without `[wind]`.
fn windless(name: &str) -> String {
    let text = std::fs::read_to_string(fixture(&format!("vehicles/{name}.toml"))).unwrap();
    text.split_once("[wind]").unwrap().0.to_owned()
}

/// Calibrates a truck on an empty and a laden step in a calm, and returns what is printed.
fn calibrate(scratch: &Scratch, truck: &str, file: &str) -> String {
    let step = |name: &str, load: &[&str]| {
        let turn = [&STEP[..4], &STEP[8..], &["--snr-db", "35"], load].concat();
        scratch.simulate(name, truck, &turn)
    };
    let empty = step("empty.csv", &["--payload-kg", "0"]) + "=empty";
    let laden = step("laden.csv", &["--payload-kg", "18000", "--height-m", "1.9"]) + "=1.9";
    cg(&["calibrate", "--vehicle", truck, "--run", &empty, "--run", &laden, "-o", file]).done().out
}

/// `cg estimate` and `cg run` have the same interval, which contains the wind, and say so; a restart keeps it. Calibrations and
/// trips are those of Python's tests.
#[test]
fn a_side_wind_is_in_the_interval_of_estimates_and_runs() {
    let scratch = Scratch::new();
    let [plain, boxed] =
        [("plain.toml", windless("euro")), ("boxed.toml", windless("euro") + SIDE)]
            .map(|(name, text)| scratch.file(name, text));
    let wind = ["--wind-mps", "3", "--wind-from-rad", "1.2"];
    let log = scratch.simulate("log.csv", &boxed, &[&STEP[..], &wind].concat());
    let answers = [&plain, &boxed].map(|truck| estimate(&log, truck, &["--road", "flat"]).answer());
    let sd_m = answers.each_ref().map(|answer| answer["height_sd_m"].as_f64().unwrap());
    assert!(sd_m[1] > 1.005 * sd_m[0], "{sd_m:?}");
    // A calibration leaves less, of which the wind is a large part.
    let (file, state) = (scratch.path("calibration.toml"), scratch.path("state.json"));
    let printed = calibrate(&scratch, &boxed, &file);
    assert!(!printed.contains("[wind]"), "{printed}");
    let known = ["--calibration", &file, "--road", "flat"];
    let answer = estimate(&log, &boxed, &known).answer();
    assert!(answer["messages"].to_string().contains("a side wind as strong as wind.speed_mps"));
    let expected_m = answer["height_sd_m"].as_f64().unwrap();
    let replay = |log: &str| {
        let run = ["run", "--vehicle", &boxed, "--csv", log, "--state", &state, "--status-s", "1"];
        lines(&cg(&[&run[..], &known].concat()))
    };
    let found = replay(&log);
    let mut notices = events(&found, "notice").into_iter();
    assert!(notices.any(|line| line["subject"] == "wind"), "{found:?}");
    let last = events(&found, "maneuver").pop().unwrap()["height_sd_m"].as_f64().unwrap();
    assert!((last / expected_m - 1.0).abs() < 0.02, "{last} {expected_m}");
    // Before its first turn, the next start knows what was.
    let again = replay(&log);
    let first = events(&again, "status").remove(0)["height_sd_m"].as_f64().unwrap();
    assert!((first / last - 1.0).abs() < 0.02, "{first} {last}");
}

/// Without `[wind]` no interval contains one. Where it would be a large part, an answer, `cg run` and a calibration say so.
#[test]
fn a_file_that_says_nothing_of_the_wind_is_told() {
    let scratch = Scratch::new();
    let truck = scratch.file("truck.toml", windless("euro"));
    let calm = scratch.file("calm.toml", windless("euro") + SIDE + "speed_mps = 0.0\n");
    let log = scratch.simulate("log.csv", &calm, &STEP);
    let file = scratch.path("calibration.toml");
    let printed = calibrate(&scratch, &truck, &file);
    assert!(printed.contains("because the vehicle file has no [wind]"), "{printed}");
    let known = ["--calibration", &file, "--road", "flat"];
    let [silent, told] = [&calm, &truck].map(|truck| estimate(&log, truck, &known).answer());
    assert_eq!(silent["height_sd_m"], told["height_sd_m"]);
    let said = [&silent, &told].map(|one| one["messages"].to_string().contains("[wind]"));
    assert_eq!(said, [false, true], "{told}");
    let run = ["run", "--vehicle", &truck, "--csv", &log];
    let found = lines(&cg(&[&run[..], &known].concat()));
    let mut notices = events(&found, "notice").into_iter();
    assert!(notices.any(|line| line["subject"] == "wind"), "{found:?}");
}

/// The trip that `cg run` learns has the wind in its ratios, too.
#[test]
fn a_side_wind_is_in_the_ratios_of_a_trip() {
    let scratch = Scratch::new();
    let calm = std::fs::read_to_string(fixture("vehicles/kraz.toml")).unwrap();
    let log = fixture("logs/A_p00_v50_L.csv");
    let sd = [("calm", calm), ("boxed", windless("kraz") + SIDE)].map(|(name, text)| {
        let truck = scratch.file(&format!("{name}.toml"), text);
        let state = scratch.path(&format!("{name}.json"));
        cg(&["run", "--csv", &log, "--vehicle", &truck, "--state", &state]).done();
        let text = std::fs::read_to_string(&state).unwrap();
        let state: Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
        // In a calm, state files remain those that an older program reads.
        assert_eq!(state.get("gusts").is_some(), name == "boxed", "{state}");
        let ratio = &state["learned"]["trips"][0]["ratio"][1];
        ratio["sd"].as_f64().unwrap() / ratio["value"].as_f64().unwrap()
    });
    assert!(sd[1] * sd[1] - sd[0] * sd[0] > 0.02 * 0.02, "{sd:?}");
}

#[test]
fn a_wind_needs_a_body_and_the_nonlinear_plant() {
    let scratch = Scratch::new();
    let [plain, boxed] =
        [("plain.toml", windless("euro")), ("boxed.toml", windless("euro") + SIDE)]
            .map(|(name, text)| scratch.file(name, text));
    let log = scratch.path("log.csv");
    for (truck, plant, wind_mps, reason) in [
        (&plain, "nonlinear", "3", "the vehicle file has no [wind]"),
        (&boxed, "linear", "3", "--wind-mps needs --plant nonlinear"),
        (&boxed, "nonlinear", "31", "--wind-mps 31 must lie between 0 and 30"),
    ] {
        let how = ["--plant", plant, "--wind-mps", wind_mps, "-o", &log];
        let step = ["simulate", "--vehicle", truck, "--maneuver", "rounded-step"];
        cg(&[&step[..], &how].concat()).refused(&[reason]);
        assert!(!scratch.names().contains(&"log.csv".to_owned()));
    }
}
