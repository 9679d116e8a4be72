//! No file is lost: which files may be written, what an interrupt leaves, and which mode a file
//! gets.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Run, Scratch, cg, command, fixture, kraz};

const LOG: &str = "logs/A_p20_h190_v50_L.csv";

/// A folder with a vehicle file and two logs, and a check that they are unchanged.
struct Inputs {
    scratch: Scratch,
    vehicle: String,
    log: String,
    other: String,
}

impl Inputs {
    fn new() -> Self {
        let scratch = Scratch::new();
        let vehicle = scratch.file("v.toml", fs::read(kraz()).unwrap());
        let log = scratch.file("a.csv", fs::read(fixture(LOG)).unwrap());
        let other = scratch.file("b.csv", fs::read(fixture(LOG)).unwrap());
        Self { scratch, vehicle, log, other }
    }

    /// Checks for exit status 2 with both options named, no output and no change, with and without
    /// `--force`.
    #[track_caller]
    fn clash(&self, arguments: &[&str], flags: [&str; 2]) {
        let before = self.scratch.names();
        for force in [&[][..], &["--force"]] {
            cg(&[arguments, force].concat()).refused(&[flags[0], flags[1], "give"]);
            assert_eq!(self.scratch.names(), before, "{arguments:?}");
            assert_eq!(fs::read(&self.vehicle).unwrap(), fs::read(kraz()).unwrap());
            for log in [&self.log, &self.other] {
                assert_eq!(fs::read(log).unwrap(), fs::read(fixture(LOG)).unwrap());
            }
        }
    }
}

#[test]
fn no_output_replaces_an_input_of_the_same_call_even_if_forced() {
    let inputs = Inputs::new();
    let (v, a) = (inputs.vehicle.as_str(), inputs.log.as_str());
    let run = format!("{a}=1.9");
    let estimate = ["estimate", "--vehicle", v, a];
    inputs.clash(&[&estimate[..], &["--report", a]].concat(), ["LOG", "--report"]);
    inputs.clash(&[&estimate[..], &["--report", v]].concat(), ["--vehicle", "--report"]);
    let truth = ["--truth", &inputs.other, "--report", &inputs.other];
    inputs.clash(&[&estimate[..], &truth].concat(), ["--truth", "--report"]);
    let dbc = inputs.scratch.file("my.dbc", fs::read(fixture("can/j1939.dbc")).unwrap());
    let signal = ["--dbc", &dbc, "--signal", "roll=SSI2.RollAngle", "--report", &dbc];
    inputs.clash(&[&estimate[..], &signal].concat(), ["--dbc", "--report"]);
    assert_eq!(fs::read(&dbc).unwrap(), fs::read(fixture("can/j1939.dbc")).unwrap());
    let calibrate = ["calibrate", "--vehicle", v, "--run", &run, "-o", v];
    inputs.clash(&calibrate, ["--vehicle", "--output"]);
    inputs.clash(&["design", "--vehicle", v, "--emit", "c", "-o", v], ["--vehicle", "--output"]);
    let simulate = ["simulate", "--vehicle", v, "--maneuver", "sine", "-o"];
    let log = inputs.scratch.path("new.csv");
    inputs.clash(&[&simulate[..], &[&log, "--truth", v]].concat(), ["--vehicle", "--truth"]);
    for log in ["--csv", "--candump"] {
        let run = ["run", "--vehicle", v, log, a];
        for output in ["--state", "--metrics"] {
            inputs.clash(&[&run[..], &[output, v]].concat(), ["--vehicle", output]);
            inputs.clash(&[&run[..], &[output, a]].concat(), [log, output]);
        }
    }
    // The table of a study has the name of the study.
    let table = inputs.scratch.path("replay.csv");
    fs::rename(&inputs.other, &table).unwrap();
    fs::copy(&table, &inputs.other).unwrap();
    let folder = inputs.scratch.path("");
    let run = format!("{table}=1.9");
    let study = ["study", "replay", "--vehicle", v, "--run", &run, "-o", &folder];
    inputs.clash(&study, ["--run", "--output"]);
    assert_eq!(fs::read(table).unwrap(), fs::read(fixture(LOG)).unwrap());
}

/// The path may also be a link, lead through another folder, or come from a redirection by the
/// shell.
#[test]
fn a_file_is_known_under_all_its_names() {
    let inputs = Inputs::new();
    let (v, a) = (inputs.vehicle.as_str(), inputs.log.as_str());
    let hard = inputs.scratch.path("hard.csv");
    fs::hard_link(a, &hard).unwrap();
    let soft = inputs.scratch.path("soft.csv");
    symlink("a.csv", &soft).unwrap();
    fs::create_dir(inputs.scratch.path("folder")).unwrap();
    let round = inputs.scratch.path("folder/../a.csv");
    for name in [&hard, &soft, &round] {
        let arguments = ["estimate", "--vehicle", v, a, "--report", name];
        inputs.clash(&arguments, ["LOG", "--report"]);
    }
    let fed = command(&["estimate", "--vehicle", v, "-", "--report", a, "--force"])
        .stdin(fs::File::open(a).unwrap())
        .output();
    Run::from(fed.unwrap()).refused(&["LOG", "--report"]);
    assert_eq!(fs::read(a).unwrap(), fs::read(fixture(LOG)).unwrap());
}

#[test]
fn two_outputs_of_a_call_are_two_files() {
    let inputs = Inputs::new();
    let (v, a) = (inputs.vehicle.as_str(), inputs.log.as_str());
    let x = inputs.scratch.path("x.csv");
    // A link to a file that does not exist yet.
    let link = inputs.scratch.path("link");
    symlink("x.csv", &link).unwrap();
    for other in [&x, &link] {
        let run = ["run", "--vehicle", v, "--csv", a, "--metrics", &x, "--state", other];
        inputs.clash(&run, ["--metrics", "--state"]);
        let simulate = ["simulate", "--vehicle", v, "--maneuver", "sine", "-o", &x];
        inputs.clash(&[&simulate[..], &["--truth", other]].concat(), ["--output", "--truth"]);
    }
    // A device can be given several times.
    let null = inputs.scratch.path("null.csv");
    symlink("/dev/null", &null).unwrap();
    let null = ["--maneuver", "sine", "-o", &null, "--truth", "/dev/null"];
    cg(&[&["simulate", "--vehicle", v][..], &null].concat()).told(0, &[]);
}

/// `/dev/stdout` is the file that the shell has opened. A new file is filled, an existing one is
/// kept.
#[test]
fn standard_output_is_a_file_like_any_other() {
    let inputs = Inputs::new();
    let page = inputs.scratch.path("page.html");
    let run = |report: &str, stdout: fs::File| {
        let arguments = ["estimate", "--vehicle", &inputs.vehicle, &inputs.log, "--report", report];
        Run::from(command(&arguments).stdout(stdout).output().unwrap())
    };
    run("/dev/stdout", fs::File::create(&page).unwrap()).done();
    assert!(fs::read_to_string(&page).unwrap().starts_with("<!doctype html>"));
    run(&page, fs::File::create(&page).unwrap()).refused(&["standard output", "--report"]);
    fs::write(&page, "precious").unwrap();
    let append = || fs::File::options().append(true).open(&page).unwrap();
    run("/dev/stdout", append()).refused(&["not a report written by cg-height"]);
    assert_eq!(fs::read_to_string(&page).unwrap(), "precious");
}

/// A redirection that adds to an input, or overwrites its beginning.
#[test]
fn standard_output_is_no_input_of_the_same_call() {
    let inputs = Inputs::new();
    let (v, a) = (inputs.vehicle.as_str(), inputs.log.as_str());
    let run = format!("{a}=1.9");
    let calibration = inputs.scratch.path("c.toml");
    let cases: [(&[&str], &str, &str); 8] = [
        (&["estimate", a, "--vehicle", v], a, "LOG"),
        (&["estimate", a, "--vehicle", v, "--report", "/dev/stdout"], a, "LOG"),
        (&["estimate", a, "--vehicle", v], v, "--vehicle"),
        (&["calibrate", "--vehicle", v, "--run", &run, "-o", &calibration], a, "--run"),
        (&["run", "--csv", a, "--vehicle", v], a, "--csv"),
        (&["simulate", "--vehicle", v, "--maneuver", "sine", "-o", "-"], v, "--vehicle"),
        (&["model", "--vehicle", v], v, "--vehicle"),
        (&["vehicle", "check", v], v, "V.toml"),
    ];
    for (arguments, printed, flag) in cases {
        for append in [true, false] {
            let before = fs::read(printed).unwrap();
            let stdout = fs::File::options().append(append).write(true).open(printed).unwrap();
            let run = Run::from(command(arguments).stdout(stdout).output().unwrap());
            run.refused(&[printed, &format!("is given to {flag} and is standard output")]);
            assert_eq!(fs::read(printed).unwrap(), before, "{arguments:?}");
        }
    }
}

/// Each command with the files that it writes.
fn writers(inputs: &Inputs) -> Vec<(Vec<String>, Vec<String>)> {
    let path = |name: &str| inputs.scratch.path(name);
    let run = format!("{}=1.9", inputs.log);
    let rows: [(&str, &[&str]); 11] = [
        ("estimate A --vehicle V --report", &["report.html"]),
        ("calibrate --vehicle V --run R -o", &["c.toml"]),
        ("design --vehicle V --emit rust -o", &["d.rs"]),
        ("design --vehicle V --emit c -o", &["d.h"]),
        ("design --vehicle V --emit json -o", &["d.json"]),
        ("simulate --vehicle V --maneuver sine --truth T -o", &["s.csv", "truth.json"]),
        ("simulate --vehicle V --maneuver sine -o", &["s.csv.gz"]),
        ("simulate --vehicle V --maneuver sine -o", &["s.log"]),
        ("run --vehicle V --csv A --metrics M --state", &["state.json", "cg.prom"]),
        ("study height-lane-change -o .", &["height-lane-change.csv", "height-lane-change.svg"]),
        ("study replay --vehicle V --run R -o .", &["replay.csv", "replay.svg"]),
    ];
    let word = |word: &str| match word {
        "V" => inputs.vehicle.clone(),
        "A" => inputs.log.clone(),
        "R" => run.clone(),
        "T" => path("truth.json"),
        "M" => path("cg.prom"),
        "." => path(""),
        word => word.to_owned(),
    };
    let writers = rows.map(|(line, files)| {
        let mut arguments: Vec<String> = line.split(' ').map(word).collect();
        if !line.ends_with('.') {
            arguments.push(path(files[0]));
        }
        (arguments, files.iter().map(|name| path(name)).collect())
    });
    writers.into()
}

fn call(arguments: &[String], more: &[&str]) -> Run {
    cg(&arguments.iter().map(String::as_str).chain(more.iter().copied()).collect::<Vec<_>>())
}

/// A file written by cg is replaced and keeps its mode. Another file is kept unless `--force` is
/// given.
#[test]
fn a_foreign_file_is_replaced_only_if_forced_and_ours_keeps_its_mode() {
    let inputs = Inputs::new();
    for (arguments, files) in writers(&inputs) {
        let (last, name) = (files.last().unwrap(), arguments.join(" "));
        let foreign = fs::read(&inputs.vehicle).unwrap();
        fs::write(last, &foreign).unwrap();
        // CAN frames look like recorded ones.
        let are_frames = Path::new(last).extension().is_some_and(|end| end == "log");
        let says = if are_frames { "exists already; give" } else { "written by cg-height" };
        call(&arguments, &[]).refused(&["exists already", says, "--force"]);
        assert_eq!(fs::read(last).unwrap(), foreign, "{name}");
        assert!(files.len() == 1 || !fs::exists(&files[0]).unwrap(), "{name}");

        let replaced = |run: Run| {
            assert_eq!(run.code, Some(0), "{name}: {run:?}");
            for file in &files {
                assert_ne!(fs::read(file).unwrap(), foreign, "{name}");
            }
        };
        replaced(call(&arguments, &["--force"]));
        for (mode, empty) in [(0o600, false), (0o640, true)] {
            for file in &files {
                // An empty state file is damaged and is renamed.
                if empty && !file.ends_with("state.json") {
                    fs::write(file, "").unwrap();
                }
                fs::set_permissions(file, PermissionsExt::from_mode(mode)).unwrap();
            }
            if are_frames && !empty {
                call(&arguments, &[]).refused(&["exists already", "--force"]);
                replaced(call(&arguments, &["--force"]));
            } else {
                replaced(call(&arguments, &[]));
            }
            for file in &files {
                assert_eq!(fs::metadata(file).unwrap().mode() & 0o7777, mode, "{name}: {file}");
            }
        }
    }
    let names = inputs.scratch.names();
    assert!(!names.iter().any(|name| name.contains(".part")), "{names:?}");
}

#[test]
fn a_new_file_has_the_usual_mode_and_a_protected_one_stays() {
    let inputs = Inputs::new();
    let usual = fs::metadata(inputs.scratch.file("usual", "")).unwrap().mode();
    let log = inputs.scratch.simulate("new.csv", &inputs.vehicle, &["--maneuver", "sine"]);
    assert_eq!(fs::metadata(&log).unwrap().mode(), usual);
    let before = fs::read(&log).unwrap();
    fs::set_permissions(&log, PermissionsExt::from_mode(0o444)).unwrap();
    let simulate =
        ["simulate", "--vehicle", &inputs.vehicle, "--maneuver", "ramp", "-o", log.as_str()];
    cg(&simulate).refused(&["new.csv", "write-protected", "--force"]);
    assert_eq!(fs::read(&log).unwrap(), before);
    cg(&[&simulate[..], &["--force"]].concat()).done();
    assert_ne!(fs::read(&log).unwrap(), before);
    assert_eq!(fs::metadata(&log).unwrap().mode() & 0o7777, 0o444);
}

#[test]
fn a_state_that_is_none_is_refused_at_the_start_and_stays_where_it_is() {
    let inputs = Inputs::new();
    let run = ["run", "--vehicle", &inputs.vehicle, "--csv", &inputs.log, "--state"];
    cg(&[&run[..], &[&inputs.other]].concat()).refused(&["b.csv", "not a state file", "--force"]);
    assert_eq!(inputs.scratch.names(), ["a.csv", "b.csv", "v.toml"]);
    cg(&[&run[..], &[&inputs.other, "--force"]].concat()).told(0, &[]);
    let aside = fs::read(inputs.scratch.path("b.csv.aside-1")).unwrap();
    assert_eq!(aside, fs::read(fixture(LOG)).unwrap(), "renamed, not lost");
    cg(&[&run[..], &[&inputs.scratch.path("")]].concat()).refused(&["is a folder", "--state"]);
    // A mistyped name of a device.
    cg(&[&run[..], &["/dev/nul"]].concat()).refused(&[
        "/dev/nul",
        "not an existing device",
        "--state",
    ]);
}

/// Nothing can be read back from a device, and the reading of a pipe would wait for ever.
#[test]
fn a_state_is_kept_in_a_file_and_nowhere_else() {
    let inputs = Inputs::new();
    let (fifo, link) = (inputs.scratch.path("fifo"), inputs.scratch.path("loop"));
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    symlink("loop", &link).unwrap();
    let (pipe, itself) = ("is a device or a pipe", "is a link that leads back to itself");
    for (state, what) in [("/dev/null", pipe), (&fifo, pipe), (&link, itself)] {
        let run = ["run", "--vehicle", &inputs.vehicle, "--csv", &inputs.log, "--state", state];
        for force in [&[][..], &["--force"]] {
            cg(&[&run[..], force].concat()).refused(&[state, what, "give --state a file"]);
        }
    }
    let report = ["estimate", "--vehicle", &inputs.vehicle, &inputs.log, "--report", &link];
    cg(&report).refused(&[itself, "give --report a file"]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}

/// Starts `cg` with the usual handling of SIGHUP: `nohup make test` would have it ignored.
fn begin(arguments: &[&str]) -> Child {
    let cg = command(arguments);
    let mut program = Command::new("env");
    program.arg("--default-signal=HUP").arg(cg.get_program()).args(cg.get_args());
    program.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
}

/// Starts the simulation of a day; returns the name of the draft that it writes.
fn begun(scratch: &Scratch, log: &str) -> (Child, String) {
    let before = scratch.names();
    let day = ["--maneuver", "drive", "--duration-s", "86400", "-o", log];
    let mut child = begin(&[&["simulate", "--vehicle", &kraz()][..], &day].concat());
    let until = Instant::now() + Duration::from_secs(60);
    while Instant::now() < until {
        let mut names = scratch.names();
        names.retain(|name| !before.contains(name));
        if let Some(part) = names.pop() {
            return (child, part);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    panic!("no draft appeared");
}

#[test]
fn nine_interrupts_leave_no_file_and_the_status_of_the_signal() {
    let scratch = Scratch::new();
    let names = ["day.csv", "day.csv.gz", "day.log"];
    let signals = [("-INT", 2), ("-TERM", 15), ("-HUP", 1)];
    for k in 0..9_u32 {
        let (signal, number) = signals[k as usize % 3];
        let (mut child, part) = begun(&scratch, &scratch.path(names[k as usize / 3]));
        assert!(part.starts_with('.') && part.contains(".part"), "{part}");
        std::thread::sleep(Duration::from_millis(15) * k);
        send(signal, &child);
        let status: ExitStatus = child.wait().unwrap();
        assert_eq!((status.signal(), status.code()), (Some(number), None), "{signal}");
        assert!(scratch.names().is_empty(), "{signal}: {:?}", scratch.names());
    }
}

#[test]
fn what_a_killed_run_left_is_removed_by_the_next_and_what_a_living_one_writes_is_not() {
    let scratch = Scratch::new();
    let log = scratch.path("day.csv");
    let (mut killed, left) = begun(&scratch, &log);
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(scratch.names(), [left.as_str()]);
    let (mut living, part) = begun(&scratch, &log);
    assert_eq!(scratch.names(), [part.as_str()]);
    // A draft of another file, and a file that is not a draft, must be kept.
    let others = [".day.log.999999999-a.part", ".day.csv.notes.part"];
    for other in others {
        scratch.file(other, "precious");
    }
    scratch.simulate("day.csv", &kraz(), &["--maneuver", "sine"]);
    let names = scratch.names();
    assert_eq!(names.len(), 4, "{names:?}");
    assert!(names.contains(&part) && names.contains(&"day.csv".to_owned()), "{names:?}");
    send("-TERM", &living);
    living.wait().unwrap();
    let mut expected: Vec<&str> = [&others[..], &["day.csv"]].concat();
    expected.sort_unstable();
    assert_eq!(scratch.names(), expected);
}

/// The second signal ends `cg run` at once and leaves no draft.
#[test]
fn a_second_signal_ends_a_run_at_once() {
    let inputs = Inputs::new();
    let before = inputs.scratch.names();
    // Nobody reads the events, which are more than a pipe holds, so that the first signal has no effect yet.
    let run = ["run", "--vehicle", &inputs.vehicle, "--csv", &inputs.log, "--status-s", "0.001"];
    let mut child = command(&run).stdout(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::with_capacity(1, child.stdout.take().unwrap());
    let mut first = String::new();
    out.read_line(&mut first).unwrap();
    assert!(first.contains("\"event\":\"start\""), "{first}");
    std::thread::sleep(Duration::from_secs(1));
    send("-TERM", &child);
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none());
    send("-TERM", &child);
    assert_eq!(child.wait().unwrap().signal(), Some(15));
    assert_eq!(inputs.scratch.names(), before);
}

#[test]
fn every_subcommand_tells_of_force() {
    let help = cg(&["--help"]).done().out;
    let commands = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = commands.lines().filter_map(|line| line.split_whitespace().next());
    let names: Vec<&str> = names.filter(|name| *name != "help").collect();
    assert!(names.len() >= 9, "{names:?}");
    for name in names {
        let help = cg(&[name, "--help"]).done().out;
        // Long help breaks its lines.
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(help.contains("--force") && help.contains("did not write"), "{name}");
    }
}

/// Where nothing is written to standard output, no file of this name is made by mistake.
#[test]
fn a_dash_is_no_file() {
    let scratch = Scratch::new();
    let log = fixture(LOG);
    for (arguments, flag) in [
        (&["estimate", &log, "--vehicle", &kraz(), "--report", "-"][..], "--report -"),
        (&["vehicle", "new", "--kind", "4x2-3axle", "-o", "-"], "--output -"),
        (&["design", "--vehicle", &kraz(), "--emit", "c", "-o", "-"], "--output -"),
    ] {
        let run: Run = command(arguments).current_dir(scratch.path("")).output().unwrap().into();
        run.refused(&[flag, "name a file"]);
        assert!(scratch.names().is_empty(), "{arguments:?}");
    }
}
