//! `cg run` ends in order: at a signal while its input stalls, and at a log that cannot be read to its end.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;

use crate::common::{Run, cg, command};
use crate::run::{drive, events, lines};

/// Starts `cg run` with a standard input that stays open and with the usual handling of SIGHUP.
fn begin(arguments: &[&str]) -> Child {
    let cg = command(arguments);
    let mut program = Command::new("env");
    program.arg("--default-signal=HUP").arg(cg.get_program()).args(cg.get_args());
    program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Reads events until one has this text.
fn read_until(out: &mut BufReader<ChildStdout>, text: &str) {
    let mut line = String::new();
    while !line.contains(text) {
        line.clear();
        assert!(out.read_line(&mut line).unwrap() > 0, "the output ended before {text}");
    }
}

/// Sends a signal and returns the exit status, which must come while the input still stalls.
fn stopped(child: &mut Child, signal: &str) -> Option<i32> {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
    let until = Instant::now() + Duration::from_secs(60);
    while Instant::now() < until {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    panic!("{signal} had no effect");
}

/// Ends a program that waits in vain, unless what is returned is dropped before.
fn ends_at_last(child: &Child) -> Sender<()> {
    let (watch, dropped) = channel();
    let id = child.id().to_string();
    std::thread::spawn(move || {
        if dropped.recv_timeout(Duration::from_secs(60)) == Err(RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-KILL", &id]).status();
        }
    });
    watch
}

/// The last event of the rest of the output.
fn last_event(mut out: BufReader<ChildStdout>) -> Value {
    let mut rest = String::new();
    out.read_to_string(&mut rest).unwrap();
    serde_json::from_str(rest.lines().last().unwrap()).unwrap()
}

/// Half of a drive with a height, or only half of a header. The last line has not come as a whole.
#[test]
fn a_signal_ends_a_run_in_order_while_its_input_stalls() {
    let drive = drive();
    let first = |path: &str, bytes: usize| fs::read_to_string(path).unwrap()[..bytes].to_owned();
    let frames = first(&drive.candump, fs::read(&drive.candump).unwrap().len() / 2);
    let (head, whole_lines) = (first(&drive.csv, 30), frames.matches('\n').count());
    let cases = [
        ("--candump", frames.as_str(), &[][..], "-TERM", Some(0), whole_lines),
        ("--candump", &frames, &["--serve", "0"], "-INT", Some(0), whole_lines),
        ("--candump", "", &[], "-HUP", Some(1), 0),
        ("--csv", &head, &[], "-TERM", Some(1), 0),
    ];
    for (k, (source, sent, more, signal, code, count)) in cases.into_iter().enumerate() {
        let state = drive.path(&format!("{k}.json"));
        let run = ["run", "--vehicle", &drive.truck, source, "-", "--state", &state];
        let mut child = begin(&[&run, more].concat());
        let mut pipe = child.stdin.take().unwrap();
        pipe.write_all(sent.as_bytes()).unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        read_until(&mut out, if code == Some(0) { "\"height_m\":1." } else { "\"start\"" });
        // Time to read what has been sent.
        std::thread::sleep(Duration::from_secs(1));
        assert_eq!(stopped(&mut child, signal), code, "{source} {signal}");
        let stop = last_event(out);
        assert_eq!((&stop["event"], &stop["reason"]), (&"stop".into(), &"signal".into()));
        assert_eq!(stop["frames"].as_u64(), Some(count as u64), "{source} {signal}");
        assert!(fs::read_to_string(&state).unwrap().contains("crc32 "), "{source} {signal}");
        drop(pipe);
    }
}

/// Opening such a pipe waits for a program that writes to it.
#[test]
fn a_signal_ends_a_run_in_order_before_anything_writes_to_its_pipe() {
    let drive = drive();
    let fifo = drive.path("frames");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    for source in ["--candump", "--csv"] {
        let mut child = begin(&["run", "--vehicle", &drive.truck, source, &fifo]);
        let mut out = BufReader::new(child.stdout.take().unwrap());
        read_until(&mut out, "\"start\"");
        assert_eq!(stopped(&mut child, "-TERM"), Some(1));
        assert_eq!(last_event(out)["reason"], "signal");
    }
}

/// The frames before the damage count, and the state is saved.
#[test]
fn a_log_that_cannot_be_read_to_its_end_ends_with_a_stop_event() {
    let drive = drive();
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(&fs::read(&drive.candump).unwrap()).unwrap();
    let packed = packer.finish().unwrap();
    let (log, state) = (drive.path("cut.log.gz"), drive.path("state.json"));
    fs::write(&log, &packed[..packed.len() / 2]).unwrap();
    let run = drive.replay(&log, &["--state", &state]).told(2, &["cut.log.gz", "cannot be read"]);
    let found = lines(&run);
    let stop = found.last().unwrap();
    assert_eq!((&stop["event"], &stop["reason"]), (&"stop".into(), &"error".into()));
    assert!(stop["frames"].as_u64() > Some(1000), "{stop}");
    let told = events(&found, "notice").into_iter().filter(|line| line["subject"] == "source");
    assert_eq!(told.filter(|line| line["message"].to_string().contains("cut.log.gz")).count(), 1);
    assert!(fs::read_to_string(&state).unwrap().contains("crc32 "));
}

/// A live pipe that stalls after a second of straight driving, of which the rest comes later.
#[test]
fn a_stall_of_a_live_pipe_is_told() {
    let drive = drive();
    for (source, log, most) in [("--csv", &drive.csv, 200), ("--candump", &drive.candump, 2000)] {
        let text = fs::read_to_string(log).unwrap();
        let begun: Vec<&str> = text.lines().take(most).collect();
        let (sent, rest) = begun.split_at(most / 2);
        let run = ["run", "--vehicle", &drive.truck, source, "-", "--realtime", "--status-s", "1"];
        let mut child = begin(&run);
        let mut pipe = child.stdin.take().unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let _watch = ends_at_last(&child);
        pipe.write_all((sent.join("\n") + "\n").as_bytes()).unwrap();
        read_until(&mut out, r#""state":"straight""#);
        read_until(&mut out, r#""state":"no signals""#);
        pipe.write_all((rest.join("\n") + "\n").as_bytes()).unwrap();
        read_until(&mut out, r#""state":"straight""#);
        drop(pipe);
        assert_eq!(last_event(out)["reason"], "end of log", "{source}");
        assert_eq!(child.wait().unwrap().code(), Some(1), "{source}"); // no turn, no height
    }
}

/// A clock that is set while the truck drives, and a program that starts after the one that writes: what comes through a pipe is
/// taken when it comes. The limit leaves room for a busy computer.
#[test]
fn time_stamps_do_not_delay_a_live_pipe() {
    let drive = drive();
    let head = "time_s,roll_rad,lateral_acceleration_mps2,speed_mps\n";
    let mut child =
        begin(&["run", "--vehicle", &drive.truck, "--csv", "-", "--realtime", "--status-s", "1"]);
    let mut pipe = child.stdin.take().unwrap();
    let out = BufReader::new(child.stdout.take().unwrap());
    let began = Instant::now();
    pipe.write_all(head.as_bytes()).unwrap();
    for k in 0..400 {
        let time_s = f64::from(k) * 0.02 + if k < 200 { 0.0 } else { 300.0 };
        writeln!(pipe, "{time_s},0,0,14").unwrap();
    }
    drop(pipe);
    assert_eq!(last_event(out)["frames"], 400);
    assert!(began.elapsed() < Duration::from_secs(100), "{:?}", began.elapsed());
    assert_eq!(child.wait().unwrap().code(), Some(1)); // no turn, no height
}

/// The log ends before its first turn.
#[test]
fn a_replay_without_a_height_ends_with_status_1_whatever_its_speed() {
    let drive = drive();
    let text = fs::read_to_string(&drive.csv).unwrap();
    let begun: Vec<&str> = text.lines().take(100).collect();
    let log = drive.path("short.csv");
    fs::write(&log, begun.join("\n") + "\n").unwrap();
    for more in [&[][..], &["--realtime"]] {
        let run = ["run", "--vehicle", &drive.truck, "--csv", &log];
        let run: Run = cg(&[&run, more].concat()).told(1, &[]);
        assert_eq!(lines(&run).last().unwrap()["reason"], "end of log");
    }
}
