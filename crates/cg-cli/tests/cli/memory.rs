//! Long logs need no more memory than short ones.
#![cfg(target_os = "linux")]

use std::io::Write;
use std::process::Stdio;

use crate::common::{Scratch, command, kraz};

/// The memory that a process has allocated and used (`RssAnon`), in kB. The pages of its program are
/// not counted: how many of them the kernel maps at a time depends on what else the computer does
/// and varies by half a megabyte.
fn memory_kb(id: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// The memory when all of a log except the content of the pipe (64 KiB) has been read. The process
/// cannot end before the pipe is closed, so it still exists.
fn memory_of_reading_kb(log: &str) -> u64 {
    let vehicle = kraz();
    let arguments = ["estimate", "-", "--vehicle", &vehicle, "--format", "json", "--jobs", "1"];
    // With one arena of the C library, it does not depend on which thread is first on a busy computer.
    let mut child = command(&arguments)
        .env("MALLOC_ARENA_MAX", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    pipe.write_all(&std::fs::read(log).unwrap()).unwrap();
    let memory_kb = memory_kb(child.id());
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    memory_kb
}

#[test]
fn memory_does_not_grow_with_the_log() {
    let scratch = Scratch::new();
    let drive = |name: &str, duration_s: &str| {
        let more = ["--maneuver", "drive", "--rate-hz", "100", "--duration-s", duration_s];
        scratch.simulate(name, &kraz(), &more)
    };
    let (short, long) = (drive("short.csv", "360"), drive("long.csv", "1800"));
    let [short_bytes, long_bytes] =
        [&short, &long].map(|log| std::fs::metadata(log).unwrap().len());
    let [short_kb, long_kb] = [&short, &long].map(|log| memory_of_reading_kb(log));
    println!("{short_bytes} bytes: {short_kb} kB, {long_bytes} bytes: {long_kb} kB");
    // Fewer than 200 more maneuvers of less than 1 kB each, and 128 kB, by which the C library's heap grows.
    assert!(long_kb < short_kb + 200 + 128, "{short_kb} kB, then {long_kb} kB");
    assert!(long_bytes - short_bytes > 20 * 400 * 1024, "{short_bytes} {long_bytes}");
}

/// Two million rows at intervals of one second, with turns. They give no maneuvers and need little
/// memory.
#[test]
fn two_million_rows_a_second_apart_take_little() {
    let vehicle = kraz();
    let arguments = ["estimate", "-", "--vehicle", &vehicle, "--format", "json", "--jobs", "1"];
    let mut child = command(&arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = std::io::BufWriter::new(child.stdin.take().unwrap());
    writeln!(pipe, "time_s,steer_rad,roll_rad,speed_mps").unwrap();
    for second in 0..2_000_000_u32 {
        let steer = 0.05 * (f64::from(second) / 5.0).sin();
        writeln!(pipe, "{second},{steer:.4},{:.4},13.9", 0.5 * steer).unwrap();
    }
    pipe.flush().unwrap();
    let memory_kb = memory_kb(child.id());
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    println!("{memory_kb} kB, {} bytes of answer", output.stdout.len());
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(memory_kb < 50_000 && output.stdout.len() < 5000, "{memory_kb} kB");
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(answer["messages"].to_string().contains("most rows are more than 0.5 s apart"));
}

/// Thirty days, each with some drives of two minutes and parking in between. At the end, `cg run`
/// is as large as after the first day, except for the 128 kB by which the C library's heap grows. `make soak` drives
/// one hour per day.
#[test]
fn a_month_in_the_memory_of_a_day() {
    let scratch = Scratch::new();
    let drives: u32 = std::env::var("CG_SOAK_DRIVES").map_or(2, |drives| drives.parse().unwrap());
    let text = std::fs::read_to_string(kraz()).unwrap();
    let text = text.replacen("nominal_speed_mps", "steering_ratio = 20.0\nnominal_speed_mps", 1);
    let text = format!("{text}\n[road]\nbank_sd_rad = 0.0\n");
    let truck = scratch.file("truck.toml", text.as_bytes());
    let more = ["--maneuver", "drive", "--duration-s", "120", "--snr-db", "25"];
    let drive = std::fs::read_to_string(scratch.simulate("drive.log", &truck, &more)).unwrap();
    let lines: Vec<(f64, &str)> = drive
        .lines()
        .map(|line| {
            let (time, rest) = line[1..].split_once(')').unwrap();
            (time.parse().unwrap(), rest)
        })
        .collect();
    let state = scratch.path("state.json");
    let arguments = ["run", "--vehicle", &truck, "--candump", "-", "--state", &state];
    let mut child = command(&arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = std::io::BufWriter::new(child.stdin.take().unwrap());
    let mut days_kb = Vec::new();
    for day in 0..30_u32 {
        for drive in 0..drives {
            let start_s =
                f64::from(day) * 86_400.0 + f64::from(drive) * 86_400.0 / f64::from(drives);
            for (time_s, rest) in &lines {
                writeln!(pipe, "({:.6}){rest}", 1.7e9 + start_s + time_s).unwrap();
            }
        }
        pipe.flush().unwrap();
        days_kb.push(memory_kb(child.id()));
    }
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    println!(
        "{} lines; after day 1 {} kB, after day 30 {} kB",
        30 * u64::from(drives) * lines.len() as u64,
        days_kb[0],
        days_kb[29]
    );
    assert!(days_kb[29] <= days_kb[0] + 128, "{days_kb:?}");
}
