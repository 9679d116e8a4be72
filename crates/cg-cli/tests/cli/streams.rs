//! Endless lines, standard input, closed pipes.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Stdio};

use crate::common::{Run, Scratch, cg_fed, command, estimate, fixture, kraz};

/// 2 GiB.
const ENDLESS_BYTES: usize = 2 << 30;

/// The binary with less memory than a quarter of such a line (`ulimit -v` is in kilobytes).
fn cramped(arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v 524288 && exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_cg")]);
    command.args(arguments).args(["--vehicle", &kraz(), "--format", "json", "--jobs", "1"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
#[cfg(target_os = "linux")]
fn a_line_of_two_gigabytes_on_standard_input_is_refused_at_once() {
    let mut child = cramped(&["estimate", "-"]).spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || {
        let block = vec![b'1'; 1 << 16];
        let mut taken_bytes = 0;
        while taken_bytes < ENDLESS_BYTES && pipe.write_all(&block).is_ok() {
            taken_bytes += block.len();
        }
        taken_bytes
    });
    let run: Run = child.wait_with_output().unwrap().into();
    run.refused(&["standard input, line 1: the line is longer than 65536 bytes", "line feeds"]);
    // The line needs at most this much memory, because the rest is not read.
    let taken_bytes = writer.join().unwrap();
    assert!(taken_bytes < 4 << 20, "{taken_bytes} bytes were taken");
}

#[test]
#[cfg(target_os = "linux")]
fn a_sparse_file_of_two_gigabytes_is_refused_at_once() {
    let scratch = Scratch::new();
    let log = scratch.path("sparse.csv");
    std::fs::File::create(&log).unwrap().set_len(ENDLESS_BYTES as u64).unwrap();
    let run: Run = cramped(&["estimate", &log]).output().unwrap().into();
    let place = format!("{log}, line 1: the line is longer than 65536 bytes");
    run.refused(&[&place, "line feeds"]);
    assert_eq!(scratch.names(), ["sparse.csv"]);
}

#[test]
fn standard_input_gives_the_answer_of_the_file() {
    let scratch = Scratch::new();
    for name in ["log.csv", "log.csv.gz"] {
        let log = scratch.simulate(name, &kraz(), &["--maneuver", "steady-turn"]);
        let mut from_file = estimate(&log, &kraz(), &[]).done().answer();
        let arguments = ["estimate", "-", "--vehicle", &kraz(), "--format", "json"];
        let run = cg_fed(&arguments, &std::fs::read(&log).unwrap()).done();
        from_file["log"] = "-".into();
        assert_eq!(run.answer(), from_file);
    }
}

#[test]
fn what_is_wrong_on_standard_input_is_called_by_that_name() {
    let arguments = ["estimate", "-", "--vehicle", &kraz()];
    let run = cg_fed(&arguments, b"time_s,steer_rad,roll_rad\n0,x,0\n");
    run.refused(&["standard input, line 2, column 2 `steer_rad`: `x` is not a number"]);
}

/// Reads one line of the output, closes the stream, and returns exit status and standard error.
fn head(arguments: &[&str]) -> (String, Option<i32>, String) {
    let mut child = command(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::with_capacity(64, child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let mut complaints = String::new();
    child.stderr.take().unwrap().read_to_string(&mut complaints).unwrap();
    (line, child.wait().unwrap().code(), complaints)
}

#[test]
fn a_pipe_closed_by_its_reader_is_no_error() {
    let scratch = Scratch::new();
    let log = scratch.simulate("log.csv", &kraz(), &["--maneuver", "steady-turn"]);
    // More answers than a pipe holds (64 KiB), so that some of them find it closed.
    let mut arguments = vec!["estimate", "--vehicle"];
    let vehicle = kraz();
    arguments.extend([&vehicle, "--format", "json"]);
    arguments.extend([log.as_str(); 200]);
    let (line, code, complaints) = head(&arguments);
    assert!(line.starts_with("{\"log\":") && line.ends_with("}\n"), "{line}");
    assert!(200 * line.len() > 2 << 16, "{line}");
    assert_eq!((code, complaints.as_str()), (Some(0), ""));

    let simulate = ["simulate", "--vehicle", &vehicle, "--maneuver", "sine", "-o", "-"];
    let (line, code, complaints) = head(&[&simulate[..], &["--duration-s", "300"]].concat());
    assert!(line.starts_with("# truth "), "{line}");
    assert_eq!((code, complaints.as_str()), (Some(0), ""));
}

/// What was asked for is written, and the status is that of the logs.
#[test]
fn a_closed_pipe_changes_neither_the_report_nor_the_status() {
    let scratch = Scratch::new();
    let straight = ["--maneuver", "sine", "--steer-rad", "0"];
    let none = scratch.simulate("straight.csv", &kraz(), &straight);
    let bad = scratch.file("bad.csv", "time_s,steer_rad,roll_rad\n0,x,0\n");
    let (vehicle, good) = (kraz(), fixture("logs/A_p20_h190_v50_L.csv"));
    for format in ["json", "csv", "table"] {
        for (logs, code) in
            [(&[&good][..], 0), (&[&good, &none], 1), (&[&good, &bad], 2), (&[&bad], 2)]
        {
            let page = scratch.path(&format!("{format}-{code}-{}.html", logs.len()));
            let mut arguments = vec!["estimate", "--vehicle", &vehicle, "--format", format];
            arguments.extend(["--report", &page]);
            arguments.extend(logs.iter().map(|log| log.as_str()));
            let (reader, writer) = std::io::pipe().unwrap();
            drop(reader);
            let run = command(&arguments).stdin(Stdio::null()).stdout(writer).output().unwrap();
            let run = Run::from(run);
            assert_eq!(run.code, Some(code), "{arguments:?} {run:?}");
            assert_eq!(run.err.contains("`x` is not a number"), code == 2, "{run:?}");
            let text = std::fs::read_to_string(&page).unwrap();
            assert!(logs.iter().all(|log| text.contains(log.as_str())), "{arguments:?}");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_standard_output_is_an_error_that_says_so() {
    let vehicle = kraz();
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for arguments in [
        &["estimate", "-", "--vehicle", &vehicle, "--format", "csv"][..],
        &["model", "--vehicle", &vehicle],
        &["simulate", "--vehicle", &vehicle, "--maneuver", "sine", "-o", "-"],
    ] {
        let log = "time_s,steer_rad,roll_rad\n0,0,0\n";
        let mut child = command(arguments)
            .stdin(Stdio::piped())
            .stdout(full())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Commands that do not read standard input close the pipe.
        let _ = child.stdin.take().unwrap().write_all(log.as_bytes());
        let run: Run = child.wait_with_output().unwrap().into();
        run.refused(&["standard output", "No space left on device"]);
    }
}
