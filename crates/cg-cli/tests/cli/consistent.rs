//! Channels that contradict each other: no combined height, the heights of both, and the likely
//! cause.

use crate::calibrate::two_runs;
use crate::common::{Scratch, cg, fixture, kraz};
use crate::run::{events, lines};

/// The laden log with a steering angle that is 1.3 times its true value, and the calibration of the
/// truck.
fn faulty(scratch: &Scratch) -> [String; 2] {
    let text = std::fs::read_to_string(fixture("logs/A_p20_h190_v50_L.csv")).unwrap();
    let mut place = None;
    let scaled = text.lines().map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let Some(place) = place {
            let steer: &mut String = &mut cells[place];
            *steer = (1.3 * steer.parse::<f64>().unwrap()).to_string();
        } else if !line.starts_with('#') {
            place = cells.iter().position(|name| name == "steer_rad");
            assert!(place.is_some(), "{line}");
        }
        cells.join(",") + "\n"
    });
    let log = scratch.file("faulty.csv", scaled.collect::<String>());
    [log, calibration(scratch)]
}

fn calibration(scratch: &Scratch) -> String {
    let calibration = scratch.path("calibration.toml");
    let runs = two_runs();
    let arguments = [
        "calibrate",
        "--vehicle",
        &kraz(),
        "--run",
        &runs[0],
        "--run",
        &runs[1],
        "-o",
        &calibration,
    ];
    cg(&arguments).done();
    calibration
}

#[test]
fn a_log_whose_channels_contradict_has_no_height_but_both_of_theirs() {
    let scratch = Scratch::new();
    let [log, calibration] = faulty(&scratch);
    let vehicle = kraz();
    let truck = ["--vehicle", &vehicle, "--calibration", &calibration];
    let run = cg(&[&["estimate", &log, "--format", "json"][..], &truck].concat());
    assert_eq!(run.code, Some(1), "{run:?}");
    let answer = &run.json()[0];
    assert_eq!(answer["status"], "inconsistent");
    assert!(answer["height_m"].is_null() && answer["static_rollover_threshold_g"].is_null());
    let channels = answer["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 2);
    assert!(channels.iter().all(|channel| channel["height_m"].as_f64().is_some()), "{answer}");
    // The lateral acceleration is correct and gives 1.900 m.
    let lateral = channels.iter().find(|one| one["channel"] == "lateral-acceleration").unwrap();
    assert!((lateral["height_m"].as_f64().unwrap() - 1.9).abs() < 0.05, "{answer}");
    let messages = answer["messages"].to_string();
    assert!(messages.contains("inconsistent: steer channel "), "{messages}");
    assert!(messages.contains("likely cause: the steer angle is 1.3"), "{messages}");
    // A single channel can be selected.
    let asked = ["estimate", &log, "--format", "json", "--channel", "lateral-acceleration"];
    let answer = &cg(&[&asked[..], &truck].concat()).done().json()[0];
    assert!((answer["height_m"].as_f64().unwrap() - 1.9).abs() < 0.05, "{answer}");
}

#[test]
fn cg_run_says_so_too() {
    let scratch = Scratch::new();
    let [log, calibration] = faulty(&scratch);
    let run = cg(&["run", "--csv", &log, "--vehicle", &kraz(), "--calibration", &calibration]);
    assert_eq!(run.code, Some(1), "{run:?}");
    let lines = lines(&run);
    let maneuver = events(&lines, "maneuver")[0];
    assert_eq!(maneuver["status"], "inconsistent");
    assert!(maneuver["height_m"].is_null());
    let notices = events(&lines, "notice");
    let told = notices.iter().filter(|line| line["subject"] == "channels").count();
    assert_eq!(told, 1, "{notices:?}");
}

/// An accelerometer on the body measures gravity when it rolls, which only the yaw rate, or a calibration with it, can show.
#[test]
fn a_lateral_acceleration_that_nothing_confirms_is_told() {
    let (scratch, truck) = (Scratch::new(), kraz());
    let text = std::fs::read_to_string(fixture("logs/A_p20_h190_v50_L.csv")).unwrap();
    let alone = scratch.file("alone.csv", text.replace("yaw_rate_radps", "unused"));
    let both = scratch.file("both.csv", text);
    let calibration = ["--calibration", &calibration(&scratch)];
    for (log, more, is_told) in
        [(&alone, &[][..], true), (&both, &[], false), (&alone, &calibration, false)]
    {
        let of = [&["--vehicle", &truck][..], more].concat();
        let estimate = cg(&[&["estimate", log, "--format", "json"], &of[..]].concat()).done();
        let run = cg(&[&["run", "--csv", log], &of[..]].concat()).done();
        for out in [estimate.out, run.out] {
            assert_eq!(out.contains("contains gravity"), is_told, "{log} {more:?}: {out}");
        }
    }
}
