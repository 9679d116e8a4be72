//! Replays of logs that are compressed, of another kind, with negative time stamps, or with long gaps.

use std::io::Write;
use std::process::Stdio;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::common::{Run, Scratch, cg, cg_fed, command, estimate, fixture, kraz};
use crate::run::{ask_to_stop, drive, events, last_height, lines};

fn packed(path: &str) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(&std::fs::read(path).unwrap()).unwrap();
    packer.finish().unwrap()
}

#[test]
fn a_candump_log_is_read_compressed_and_a_log_of_another_kind_is_told() {
    let drive = drive();
    let plain = lines(&drive.replay(&drive.candump, &[]).done());
    let gz = drive.path("drive.log.gz");
    std::fs::write(&gz, packed(&drive.candump)).unwrap();
    let from_file = lines(&drive.replay(&gz, &[]).done());
    let arguments = ["run", "--vehicle", &drive.truck, "--candump", "-"];
    let from_stream = lines(&cg_fed(&arguments, &packed(&drive.candump)).done());
    for found in [from_file, from_stream] {
        assert_eq!(found[1..], plain[1..], "all but the name in the event start");
    }
    let rows = drive.path("rows.gz");
    std::fs::write(&rows, packed(&drive.csv)).unwrap();
    for log in [&drive.csv, &rows] {
        drive.replay(log, &[]).refused(&["contains rows", "with --csv instead of --candump"]);
    }
    let fed = cg_fed(&arguments, &std::fs::read(&drive.csv).unwrap());
    fed.told(2, &["standard input: the log contains rows"]);
    let asc = drive.path("drive.asc");
    std::fs::write(&asc, "date Wed May 1 12:00:00.000 pm 2024\nbase hex  timestamps absolute\n")
        .unwrap();
    drive.replay(&asc, &[]).refused(&["drive.asc: the log is in the format ASC", "cg estimate"]);
}

/// A mass with which the trailer is impossible (28.7 for 28700 kg), and warnings that would never end.
#[test]
fn what_could_never_give_a_height_or_end_a_warning_is_refused() {
    let (log, vehicle) = (fixture("logs/A_p20_h190_v50_L.csv"), kraz());
    let run = ["run", "--csv", &log, "--vehicle", &vehicle];
    let mass = ["--trailer-mass-kg", "28.7"];
    let refused = cg(&[&run[..], &mass].concat());
    assert_eq!(refused.err, estimate(&log, &vehicle, &mass).err, "as cg estimate says");
    refused.refused(&["--trailer-mass-kg"]);
    for warn in [
        &["--warn", "0.6", "--warn-hysteresis", "0.7"][..],
        &["--warn", "0.8,0.6", "--warn-hysteresis", "0.6"],
        &["--warn", "0.04"],
    ] {
        cg(&[&run[..], warn].concat()).refused(&["--warn-hysteresis", "would never end", "below"]);
    }
    cg(&[&run[..], &["--warn", "0.6", "--warn-hysteresis", "0.59"]].concat()).done();
}

/// The log begins 20 s before the origin of its time.
#[test]
fn time_stamps_may_be_negative() {
    let scratch = Scratch::new();
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let text = std::fs::read_to_string(&log).unwrap();
    let moved: Vec<String> = text
        .lines()
        .map(|line| match line.split_once(',').map(|(time, rest)| (time.parse::<f64>(), rest)) {
            Some((Ok(time_s), rest)) => format!("{:.6},{rest}", time_s - 20.0),
            _ => line.to_owned(),
        })
        .collect();
    let replay = |log: &str| {
        lines(&cg(&["run", "--csv", log, "--vehicle", &kraz(), "--status-s", "0"]).done())
    };
    let (there, here) = (replay(&log), replay(&scratch.file("moved.csv", moved.join("\n"))));
    // Time stamps are rounded to a microsecond.
    assert!((last_height(&there) - last_height(&here)).abs() < 1e-9);
    assert!(events(&here, "notice").iter().all(|notice| notice["subject"] != "clock"));
    assert_eq!(there.len(), here.len());
    for (there, here) in there.iter().zip(&here).skip(1) {
        let time_s = |line: &serde_json::Value| line["time_s"].as_f64().unwrap();
        assert!((time_s(there) - 20.0 - time_s(here)).abs() < 1e-5, "{there} {here}");
    }
}

/// The gap lasts ten minutes. The limit leaves room for a busy computer.
#[test]
fn a_replay_in_real_time_can_be_stopped_in_a_gap() {
    let scratch = Scratch::new();
    let head = "time_s,roll_rad,lateral_acceleration_mps2,speed_mps\n";
    let log = scratch.file("gap.csv", format!("{head}0,0,0,14\n0.01,0,0,14\n600,0,0,14\n"));
    let child = command(&["run", "--vehicle", &kraz(), "--csv", &log, "--realtime"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(1));
    let asked = Instant::now();
    ask_to_stop(&child);
    let run: Run = child.wait_with_output().unwrap().into();
    assert!(asked.elapsed() < Duration::from_secs(60), "{:?}", asked.elapsed());
    assert_eq!(lines(&run).last().unwrap()["reason"], "signal");
}

/// A clock that is set after a start without one jumps by decades, and a truck is parked for a night.
#[test]
fn a_replay_in_real_time_does_not_wait_for_a_long_pause() {
    let scratch = Scratch::new();
    let head = "time_s,roll_rad,lateral_acceleration_mps2,speed_mps\n";
    let rows = "0,0,0,14\n0.01,0,0,14\n3600,0,0,14\n3600.01,0,0,14\n1.8e9,0,0,14\n";
    let log = scratch.file("pause.csv", format!("{head}{rows}"));
    let run = cg(&["run", "--vehicle", &kraz(), "--csv", &log, "--realtime"]).told(1, &[]);
    let stop = lines(&run).pop().unwrap();
    assert_eq!((&stop["reason"], &stop["frames"]), (&"end of log".into(), &5.into()));
}
