//! The state file of `cg run` is never lost: one that cannot be read, one that two programs write, and
//! one that is due when standard output fails.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::process::{Command, Stdio};

use crate::common::{Run, Scratch, cg, command, fixture, kraz};
use crate::run::{events, lines};

const EMPTY: &str = "logs/A_p00_v50_L.csv";

/// The arguments of a replay that keeps its state.
fn replay<'a>(log: &'a str, vehicle: &'a str, state: &'a str) -> Vec<&'a str> {
    vec!["run", "--csv", log, "--vehicle", vehicle, "--state", state, "--status-s", "0"]
}

/// The binary without the right of the administrator to read every file.
fn bound(arguments: &[&str]) -> Command {
    let cg = command(arguments);
    // The owner of this process is that of its folder in /proc.
    let is_administrator = fs::metadata("/proc/self").unwrap().uid() == 0;
    let mut program = Command::new(if is_administrator { "setpriv" } else { "env" });
    if is_administrator {
        program.arg("--bounding-set=-dac_override,-dac_read_search");
    }
    program.arg(cg.get_program()).args(cg.get_args()).stdin(Stdio::null());
    program
}

#[test]
fn a_state_that_cannot_be_read_is_not_replaced_even_if_forced() {
    let scratch = Scratch::new();
    let (log, vehicle, state) = (fixture(EMPTY), kraz(), scratch.path("state.json"));
    let run = replay(&log, &vehicle, &state);
    cg(&run).done();
    let before = fs::read(&state).unwrap();
    fs::set_permissions(&state, PermissionsExt::from_mode(0o000)).unwrap();
    for force in [&[][..], &["--force"]] {
        let refused: Run = bound(&[&run, force].concat()).output().unwrap().into();
        assert!(!refused.err.contains("--force"), "{refused:?}");
        refused.refused(&["state.json: cannot be read: Permission denied", "make it readable"]);
        assert_eq!(scratch.names(), ["state.json"]);
    }
    fs::set_permissions(&state, PermissionsExt::from_mode(0o600)).unwrap();
    assert_eq!(fs::read(&state).unwrap(), before);
}

/// The first program has read before the second one has written, and writes after it.
#[test]
fn two_programs_with_one_state_lose_nothing() {
    let scratch = Scratch::new();
    let (log, vehicle, state) = (fixture(EMPTY), kraz(), scratch.path("state.json"));
    let mut first = command(&replay("-", &vehicle, &state))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = first.stdin.take().unwrap();
    let begun = fs::read_to_string(&log).unwrap();
    // The first line of the output says that the state was read; it comes before any row.
    let mut out = first.stdout.take().unwrap();
    let mut byte = [0];
    out.read_exact(&mut byte).unwrap();
    let second = lines(&cg(&replay(&log, &vehicle, &state)).done());
    assert_eq!(events(&second, "learned").len(), 1);
    let learned = fs::read(&state).unwrap();
    for line in begun.split_inclusive('\n').take(5) {
        pipe.write_all(line.as_bytes()).unwrap();
    }
    drop(pipe);
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    assert_eq!(first.wait().unwrap().code(), Some(1));
    assert!(rest.contains("another program has written this file"), "{rest}");
    assert!(rest.contains("state.json.aside-1"), "{rest}");
    assert_eq!(fs::read(scratch.path("state.json.aside-1")).unwrap(), learned);
    assert_eq!(scratch.names(), ["state.json", "state.json.aside-1"]);
}

/// The height of before the start is told as such until a turn of this drive has given one.
#[test]
fn a_height_that_no_turn_has_confirmed_is_told() {
    let scratch = Scratch::new();
    let (log, vehicle, state) = (fixture("logs/A_p20_h190_v50_L.csv"), kraz(), scratch.path("s"));
    let run = ["run", "--csv", &log, "--vehicle", &vehicle, "--state", &state, "--status-s", "1"];
    let statuses = || {
        let found = lines(&cg(&run).done());
        let of = |line: &serde_json::Value| {
            (line["height_m"].is_number(), line["height_restored"].as_bool().unwrap())
        };
        events(&found, "status").into_iter().map(of).collect::<Vec<_>>()
    };
    // The turn of this log ends with it; the last status is that after it.
    for is_restored in [false, true] {
        let found = statuses();
        let (last, before) = found.split_last().unwrap();
        assert_eq!(*last, (true, false), "{found:?}");
        let expected = (is_restored, is_restored);
        assert!(before.len() > 5 && before.iter().all(|one| *one == expected), "{found:?}");
    }
}

/// A reader that goes away after the first line, and a full disk. The state is that of a run that was
/// stopped there.
#[test]
fn the_state_is_saved_if_standard_output_fails() {
    let scratch = Scratch::new();
    let (log, vehicle) = (fixture(EMPTY), kraz());
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    for (name, code) in [("closed.json", 0), ("full.json", 2)] {
        let state = scratch.path(name);
        let mut program = command(&replay("-", &vehicle, &state));
        program.stdin(Stdio::piped()).stderr(Stdio::piped());
        let is_full = code == 2;
        program.stdout(if is_full { full.try_clone().unwrap().into() } else { Stdio::piped() });
        let mut child = program.spawn().unwrap();
        let mut pipe = child.stdin.take().unwrap();
        if let Some(out) = child.stdout.take() {
            let mut first = String::new();
            BufReader::new(out).read_line(&mut first).unwrap();
            assert!(first.contains("\"event\":\"start\""), "{first}");
        }
        // The pipe remains open, so that the program does not end because the log has ended.
        std::thread::scope(|scope| {
            let rows = fs::read_to_string(&log).unwrap();
            // Programs that other tests start have the closed pipe, too, until they run. So more rows follow until a
            // line fails.
            let writer = scope.spawn(move || {
                let (time_s, others) = rows.lines().last().unwrap().split_once(',').unwrap();
                let time_s: f64 = time_s.parse().unwrap();
                let mut ended = pipe.write_all(rows.as_bytes()).is_err();
                for k in 1_u32.. {
                    if ended {
                        break;
                    }
                    let row = format!("{},{others}\n", time_s + 0.01 * f64::from(k));
                    ended = pipe.write_all(row.as_bytes()).is_err();
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
                pipe
            });
            let run: Run = child.wait_with_output().unwrap().into();
            let complaint = ["standard output: cannot be written", "No space left on device"];
            let said = if is_full { &complaint[..] } else { &[] };
            run.told(code, said);
            drop(writer.join().unwrap());
        });
        let text = fs::read_to_string(&state).unwrap();
        assert!(text.starts_with("{\"format\":\"cg-height state\"") && text.contains("crc32 "));
    }
}

/// The rows of a log until a time, s, with or without the mass.
fn part(log: &str, until_s: f64, has_mass: bool) -> String {
    let text = fs::read_to_string(log).unwrap();
    let (head, rows) = text.split_once("time_s,").unwrap();
    let is_early = |row: &&str| {
        let time_s: Option<f64> = row.split(',').next().unwrap().parse().ok();
        time_s.is_none_or(|time_s| time_s < until_s)
    };
    let rows = format!("time_s,{rows}");
    let mut rows: Vec<_> = rows.lines().filter(is_early).map(str::to_owned).collect();
    if !has_mass {
        rows[0] = rows[0].replace("trailer_mass_kg", "no_mass");
    }
    format!("{head}{}\n", rows.join("\n"))
}

/// A height that the mass of another load, or a turn, has hidden stays hidden over a restart, although nothing else says then
/// that the load is another one. Without a restart, too, the next turn is the first that gives a height again.
#[test]
fn a_hidden_height_stays_hidden_after_a_restart() {
    let (scratch, vehicle) = (Scratch::new(), kraz());
    let step = |name: &str, load: [&str; 2]| {
        let more = ["--maneuver", "rounded-step", "--plant", "nonlinear", "--payload-kg", load[0]];
        scratch.simulate(name, &vehicle, &[&more[..], &["--height-m", load[1]]].concat())
    };
    let (light, heavy) = (step("light.csv", ["6000", "1.6"]), step("heavy.csv", ["20000", "2.2"]));
    let whole = scratch.file("whole.csv", part(&heavy, f64::MAX, false));
    // The turn begins after two seconds.
    let straight = scratch.file("straight.csv", part(&heavy, 1.5, true));
    for (name, second) in [("weighed.json", &straight), ("turned.json", &whole)] {
        let state = scratch.path(name);
        let trip = |log: &str| {
            let mut arguments = replay(log, &vehicle, &state);
            *arguments.last_mut().unwrap() = "0.5";
            let lines = lines(&cg(&arguments));
            let all = |event: &str, key: &str| -> Vec<_> {
                events(&lines, event).iter().map(|line| line[key].clone()).collect()
            };
            (all("status", "height_m"), all("notice", "subject"))
        };
        let (heights, _) = trip(&light);
        assert!((heights.last().unwrap().as_f64().unwrap() - 1.6).abs() < 0.3, "{heights:?}");
        let (heights, told) = trip(second);
        assert!(heights.last().unwrap().is_null() && told.contains(&"load".into()), "{told:?}");
        let (heights, told) = trip(&whole);
        assert!(
            heights.len() > 20 && heights[..4].iter().all(serde_json::Value::is_null),
            "{heights:?}"
        );
        assert!(told.contains(&"load".into()), "{told:?}");
    }
}

/// The height is in the state, the scale shows another load, and the power fails before the next minute has passed: the next start has
/// no mass yet, and must not show the height of the load before.
#[test]
fn a_height_that_is_hidden_stays_hidden_after_a_power_cut() {
    let (scratch, vehicle) = (Scratch::new(), kraz());
    let (log, state) = (scratch.path("drive.csv"), scratch.path("state.json"));
    let drive = ["--maneuver", "rounded-step", "--duration-s", "25", "--payload-kg", "15000"];
    cg(&[&["simulate", "--vehicle", &vehicle, "-o", &log], &drive[..]].concat()).done();
    let head = "time_s,roll_rad,lateral_acceleration_mps2,speed_mps,trailer_mass_kg";
    let text = fs::read_to_string(&log).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let place = |name: &str| names.iter().position(|known| *known == name).unwrap();
    let places: Vec<usize> = head.split(',').map(place).collect();
    let kept = |row: &str| {
        let cells: Vec<&str> = row.split(',').collect();
        places.iter().map(|&place| cells[place]).collect::<Vec<_>>().join(",")
    };
    let turn: Vec<String> = rows.map(kept).collect();
    let mass_kg = turn.last().unwrap().split(',').next_back().unwrap();
    let straight = |from_s: u32, to_s: u32, mass_kg: &str| -> Vec<String> {
        let row = |k: u32| format!("{},0,0,14,{mass_kg}", f64::from(from_s) + 0.02 * f64::from(k));
        (0..50 * (to_s - from_s)).map(row).collect()
    };
    let run = ["run", "--csv", "-", "--realtime", "--vehicle", &vehicle, "--state", &state];
    let begin = |parts: &[&[String]]| {
        let mut child = command(&run).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut pipe = child.stdin.take().unwrap();
        writeln!(pipe, "{head}\n{}", parts.concat().join("\n")).unwrap();
        (child, pipe)
    };
    // A minute after the turn, its height is in the state.
    let parts = [&turn, &straight(26, 100, mass_kg), &straight(100, 130, "12000")];
    let (mut first, pipe) = begin(&parts.map(Vec::as_slice));
    let mut lines_of_first = BufReader::new(first.stdout.take().unwrap()).lines();
    assert!(lines_of_first.any(|line| line.unwrap().contains("is no longer shown")));
    // It is saved after the row of the notice, of which the second status from now on is a later one.
    for _ in 0..2 {
        assert!(lines_of_first.any(|line| line.unwrap().contains("\"status\"")));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    drop(pipe);
    assert!(!fs::read_to_string(&state).unwrap().contains("\"load_mass_kg\":null"));
    let (again, pipe) = begin(&[&straight(140, 170, "")]);
    drop(pipe);
    let run: Run = again.wait_with_output().unwrap().into();
    let found = lines(&run);
    let statuses = events(&found, "status");
    assert!(statuses.len() > 3);
    assert!(statuses.iter().all(|status| status["height_m"].is_null()), "{statuses:?}");
}

/// Logs one after the other, with half a minute between them; without the rows from a time on in each, s.
fn joined(logs: &[&String], until_s: f64) -> String {
    use std::fmt::Write;

    let (mut text, mut from_s) = (String::new(), 0.0);
    for log in logs {
        let part = part(log, until_s, true);
        let (_, rows) = part.split_once("time_s,").unwrap();
        let (names, rows) = rows.split_once('\n').unwrap();
        if text.is_empty() {
            text = format!("time_s,{names}\n");
        }
        let mut last_s = 0.0;
        for row in rows.lines() {
            let (time_s, rest) = row.split_once(',').unwrap();
            last_s = time_s.parse::<f64>().unwrap();
            writeln!(text, "{:.4},{rest}", from_s + last_s).unwrap();
        }
        from_s += last_s + 30.0;
    }
    text
}

/// What a drive on straight roads after a restart shows of the height: its standard deviation in the first and in the last status, and
/// the subjects of notices.
fn restarted(log: &str, state: &str, more: &[&str]) -> ([Option<f64>; 2], Vec<String>) {
    let vehicle = kraz();
    let mut arguments = replay(log, &vehicle, state);
    *arguments.last_mut().unwrap() = "0.5";
    arguments.extend(more);
    let lines = lines(&cg(&arguments));
    let statuses = events(&lines, "status");
    let sd_m = |place: usize| statuses[place]["height_sd_m"].as_f64();
    let notices = events(&lines, "notice");
    let told = notices.iter().map(|line| line["subject"].as_str().unwrap().to_owned());
    ([sd_m(0), sd_m(statuses.len() - 1)], told.collect())
}

/// One of four turns contradicts the others and is left out, which makes the interval wider. After a restart nothing says it but the
/// state; and a mass that is given and is a little other one than that of the turns is that of another part of the load.
#[test]
fn an_interval_is_as_wide_after_a_restart() {
    let (scratch, vehicle) = (Scratch::new(), kraz());
    let step = |name: &str, height_m: &str| {
        let more = ["--maneuver", "rounded-step", "--duration-s", "20", "--payload-kg", "15000"];
        scratch.simulate(name, &vehicle, &[&more[..], &["--height-m", height_m]].concat())
    };
    let (one, other) = (step("one.csv", "1.9"), step("other.csv", "2.4"));
    let drive = scratch.file("drive.csv", joined(&[&one, &one, &other, &one], f64::MAX));
    let straight = scratch.file("straight.csv", joined(&[&one, &one], 1.5));
    let states = [scratch.path("left_out.json"), scratch.path("alone.json")];
    let ([_, before_m], told) = restarted(&drive, &states[0], &[]);
    assert!(told.contains(&"left_out".to_owned()), "{told:?}");
    let ([_, alone_m], _) = restarted(&one, &states[1], &[]);
    let (before_m, alone_m) = (before_m.unwrap(), alone_m.unwrap());
    assert!(before_m > 1.2 * alone_m, "{before_m} {alone_m}");
    for _ in 0..2 {
        let (sds_m, _) = restarted(&straight, &states[0], &[]);
        for sd_m in sds_m {
            assert!((sd_m.unwrap() / before_m - 1.0).abs() < 0.01, "{sds_m:?} {before_m}");
        }
    }
    // 3 % of 23684 kg may be anywhere in the range of heights, of which the standard deviation is 0.29 of its width.
    let (sds_m, _) = restarted(&straight, &states[1], &["--trailer-mass-kg", "24395"]);
    for sd_m in sds_m {
        let part_m = (sd_m.unwrap().powi(2) - alone_m.powi(2)).sqrt();
        assert!((0.01..0.03).contains(&part_m), "{sds_m:?} {alone_m}");
    }
}

/// Heights that assume a flat road are no heights of one that may be banked; the other way around they are.
#[test]
fn a_height_of_flat_roads_is_not_one_of_banked_roads() {
    let (scratch, log) = (Scratch::new(), fixture("logs/A_p20_h190_v50_L.csv"));
    let straight = scratch.file("straight.csv", joined(&[&log, &log], 1.5));
    for (first, then, is_kept) in [("flat", "public", false), ("public", "flat", true)] {
        let state = scratch.path(first);
        let ([_, before_m], _) = restarted(&log, &state, &["--road", first]);
        let ([after_m, _], told) = restarted(&straight, &state, &["--road", then]);
        assert!(before_m.is_some(), "{first}");
        assert_eq!((after_m.is_some(), told.contains(&"state".to_owned())), (is_kept, !is_kept));
    }
}
