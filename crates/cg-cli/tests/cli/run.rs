//! `cg run` on recorded drives: results, state file, and notifications of a service manager. `make
//! guest` tests real SocketCAN.

use std::fmt::Write as _;
use std::io::Read;
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::common::{Run, Scratch, cg, cg_fed, command, estimate, fixture, kraz};

/// A truck with a steering ratio, because J1939 has the angle of the steering wheel.
pub(crate) struct Drive {
    folder: TempDir,
    pub(crate) truck: String,
    pub(crate) csv: String,
    pub(crate) candump: String,
}

pub(crate) fn drive() -> Drive {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (truck, csv, candump) = (path("truck.toml"), path("drive.csv"), path("drive.log"));
    let text = std::fs::read_to_string(kraz()).unwrap();
    let text = text.replacen("nominal_speed_mps", "steering_ratio = 20.0\nnominal_speed_mps", 1);
    // A roll angle of the bus is relative to gravity.
    std::fs::write(&truck, format!("{text}\n[road]\nbank_sd_rad = 0.0\n")).unwrap();
    for log in [&csv, &candump] {
        let fixed = ["--maneuver", "drive", "--duration-s", "120", "--seed", "5", "--snr-db", "25"];
        let mut arguments = vec!["simulate", "--vehicle", &truck, "-o", log];
        arguments.extend(fixed);
        cg(&arguments).done();
    }
    Drive { folder, truck, csv, candump }
}

impl Drive {
    pub(crate) fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    pub(crate) fn replay(&self, log: &str, more: &[&str]) -> Run {
        let mut arguments = vec!["run", "--vehicle", &self.truck, "--candump", log];
        arguments.extend(more);
        cg(&arguments)
    }
}

pub(crate) fn lines(run: &Run) -> Vec<Value> {
    run.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

pub(crate) fn events<'a>(lines: &'a [Value], event: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["event"] == event).collect()
}

pub(crate) fn last_height(lines: &[Value]) -> f64 {
    events(lines, "maneuver").last().unwrap()["height_m"].as_f64().unwrap()
}

/// CSV gives the same result to the last bit. J1939 rounds the signals (steer angle 5e-5 rad,
/// acceleration 5e-4 m/s², which is 3e-4 of that in a turn), and thousands of rows average this
/// out.
#[test]
fn a_drive_gives_one_height_however_it_comes() {
    let drive = drive();
    let estimate = cg(&["estimate", "--vehicle", &drive.truck, "--format", "json", &drive.csv]);
    let estimate: Value = serde_json::from_str(&estimate.done().out).unwrap();
    let expected = estimate["height_m"].as_f64().unwrap();
    let csv = lines(&cg(&["run", "--vehicle", &drive.truck, "--csv", &drive.csv]).done());
    assert!((last_height(&csv) - expected).abs() < 1e-12);
    let candump = lines(&drive.replay(&drive.candump, &[]).done());
    assert!((last_height(&candump) / expected - 1.0).abs() < 3e-4, "{}", last_height(&candump));
    assert_eq!(candump[0]["event"], "start");
    assert_eq!(candump.last().unwrap()["event"], "stop");
    let states = events(&candump, "state");
    assert!(states.iter().any(|line| line["state"] == "turning"));
    let status = events(&candump, "status");
    assert!(status.len() >= 120 && status.len() <= 123, "{}", status.len());
    assert_eq!(status.last().unwrap()["malformed"], 0);
    let fed = cg_fed(
        &["run", "--vehicle", &drive.truck, "--candump", "-"],
        &std::fs::read(&drive.candump).unwrap(),
    );
    assert!((last_height(&lines(&fed.done())) - last_height(&candump)).abs() < 1e-15);
}

/// The same samples reach the same identifier, so every method gives its height to the last bit.
#[test]
fn every_method_gives_the_height_of_its_log() {
    let drive = drive();
    let mut heights = Vec::new();
    for method in [
        &["--method", "filtered"][..],
        &["--method", "gain"],
        &["--method", "arx"],
        &["--method", "arx", "--order", "2"],
    ] {
        let fixed = ["estimate", "--vehicle", &drive.truck, "--format", "json", &drive.csv];
        let estimate: Value =
            serde_json::from_str(&cg(&[&fixed, method].concat()).done().out).unwrap();
        let fixed = ["run", "--vehicle", &drive.truck, "--csv", &drive.csv];
        let live = lines(&cg(&[&fixed, method].concat()).done());
        let height_m = last_height(&live);
        assert!((height_m - estimate["height_m"].as_f64().unwrap()).abs() < 1e-12);
        assert_eq!(live[0]["method"], method[1]);
        assert!(!heights.contains(&height_m), "{method:?} is another method");
        heights.push(height_m);
    }
}

/// Off unless asked for. In the turn of a request the present curve, `U²/a`, would use the share at the
/// requested speed; the threshold of a height changes by less than 3 % between the two speeds.
#[test]
fn a_speed_is_requested_only_if_it_is_asked_for() {
    let drive = drive();
    let silent = lines(&drive.replay(&drive.candump, &["--status-s", "0.1"]).done());
    assert!(events(&silent, "speed_request").is_empty());
    assert!(silent.iter().all(|line| line.get("requested_speed_mps").is_none()));
    let asked = ["--status-s", "0.1", "--speed-request", "0.2"];
    let found = lines(&drive.replay(&drive.candump, &asked).done());
    let requests = events(&found, "speed_request");
    let begins: Vec<bool> =
        requests.iter().map(|one| one["requested_speed_mps"].is_f64()).collect();
    assert!(begins.len() >= 2, "{requests:?}");
    assert!(begins.iter().enumerate().all(|(k, begins)| *begins == (k % 2 == 0)), "{begins:?}");
    // Nothing is requested before the first height.
    let first_m = events(&found, "maneuver")[0]["time_s"].as_f64().unwrap();
    assert!(requests[0]["time_s"].as_f64().unwrap() > first_m);
    let mut seen = 0;
    for status in events(&found, "status") {
        let of = |name: &str| status[name].as_f64();
        let (Some(asked_mps), Some(lateral_g)) =
            (of("requested_speed_mps"), of("lateral_acceleration_g"))
        else {
            continue;
        };
        let threshold_g = of("static_rollover_threshold_g").unwrap();
        // The bound lies between half the threshold and the threshold.
        let used = lateral_g.abs() / threshold_g;
        assert!((0.9 * 0.1..1.0).contains(&used), "{status}");
        assert!(asked_mps > 0.0 && asked_mps < 40.0, "{status}");
        seen += 1;
    }
    assert!(seen > 10, "{seen}");
    // All else is as without it.
    assert!((last_height(&found) - last_height(&silent)).abs() < 1e-15);
}

/// Two halves of a drive with a restart between them give the same result as the whole drive,
/// except for the maneuver that was interrupted.
#[test]
fn a_restart_forgets_nothing() {
    let drive = drive();
    let whole = lines(&drive.replay(&drive.candump, &[]).done());
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let cut = events(&whole, "maneuver")[1]["time_s"].as_f64().unwrap();
    let at = |line: &str| line[1..line.find(')').unwrap()].parse::<f64>().unwrap();
    let state = drive.path("state.json");
    let mut last = Vec::new();
    for (name, first) in [("one.log", true), ("two.log", false)] {
        let half: String = text
            .lines()
            .filter(|line| (at(line) <= cut) == first)
            .flat_map(|line| [line, "\n"])
            .collect();
        std::fs::write(drive.path(name), half).unwrap();
        last = lines(&drive.replay(&drive.path(name), &["--state", &state]));
        assert_eq!(last[0]["restored"], !first);
    }
    let count = |lines: &[Value]| events(lines, "maneuver").last().unwrap()["maneuvers"].as_u64();
    assert_eq!(count(&last), count(&whole));
    // After the cut, the filters start at rest during straight driving, so there is only noise.
    assert!((last_height(&last) / last_height(&whole) - 1.0).abs() < 2e-3);
    assert_eq!(std::fs::read_dir(drive.folder.path()).unwrap().count(), 6);
}

#[test]
fn a_damaged_state_is_said_and_kept() {
    let drive = drive();
    let state = drive.path("state.json");
    std::fs::write(&state, b"{\"format\":\"cg-height st").unwrap();
    let found = lines(&drive.replay(&drive.candump, &["--state", &state]).done());
    assert_eq!(found[0]["event"], "notice");
    assert!(found[0]["message"].as_str().unwrap().contains("state.json.aside-1"));
    assert!(Path::new(&drive.path("state.json.aside-1")).exists());
    let again = lines(&drive.replay(&drive.candump, &["--state", &state]).done());
    assert_eq!(again[0]["restored"], true);
}

/// As if the scale were wrong: the mass of the option is used, not that of the bus.
#[test]
fn a_given_mass_is_taken_whatever_the_bus_says() {
    let drive = drive();
    let told = lines(&drive.replay(&drive.candump, &[]).done());
    let given = lines(&drive.replay(&drive.candump, &["--trailer-mass-kg", "25000"]).done());
    let last = |lines: &[Value], key: &str| {
        events(lines, "maneuver").last().unwrap()[key].as_f64().unwrap()
    };
    assert!((last(&given, "trailer_mass_kg") - 25e3).abs() < 1e-9);
    // A mass that is too large gives a height that is too small.
    assert!(last(&told, "trailer_mass_kg") < 20e3);
    assert!(last(&given, "height_m") < 0.95 * last(&told, "height_m"));
}

/// A disk without room prevents writing the files but not the estimation: here no file may have a byte. It is reported once, and a
/// state that is lost at the end is an error.
#[test]
fn a_full_disk_stops_nothing() {
    let drive = drive();
    let cg = command(&["run", "--vehicle", &drive.truck, "--candump", &drive.candump]);
    let (state, metrics) = (drive.path("state.json"), drive.path("cg.prom"));
    let mut program = Command::new("sh");
    program.args(["-c", "trap '' XFSZ && ulimit -f 0 && exec \"$0\" \"$@\""]);
    program.arg(cg.get_program()).args(cg.get_args());
    program.args(["--state", &state, "--metrics", &metrics]);
    let run: Run = program.stdin(Stdio::null()).output().unwrap().into();
    let run = run.told(2, &["state.json: could not be written, so what this run has learned"]);
    let found = lines(&run);
    for subject in ["state", "metrics"] {
        let told: Vec<_> = events(&found, "notice")
            .into_iter()
            .filter(|line| line["subject"] == subject)
            .collect();
        assert!(told.len() == 1 && told[0]["message"].to_string().contains("File too large"));
    }
    assert!(!Path::new(&state).exists() && !Path::new(&metrics).exists());
    assert!(last_height(&found) > 1.0);
}

#[test]
fn metrics_hold_the_result() {
    let drive = drive();
    let metrics = drive.path("cg.prom");
    let found = lines(&drive.replay(&drive.candump, &["--metrics", &metrics]).done());
    let text = std::fs::read_to_string(&metrics).unwrap();
    let value = |name: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap();
        line.rsplit(' ').next().unwrap().parse::<f64>().unwrap()
    };
    assert!((value("cg_height_metres") - last_height(&found)).abs() < 1e-12);
    let frames = std::fs::read_to_string(&drive.candump).unwrap().lines().count();
    assert_eq!(value("cg_frames_total").to_string(), frames.to_string());
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        assert!(text.contains(&format!("# TYPE {} ", line.split(' ').next().unwrap())));
    }
}

/// Invalid lines, and a clock set back by an hour and forward again. All are reported, and the
/// height is the same.
#[test]
fn garbage_and_clock_jumps_are_survived() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let mut bad = String::new();
    for (k, line) in text.lines().enumerate() {
        let (time, rest) = line[1..].split_once(')').unwrap();
        let jumped = 1e6 + time.parse::<f64>().unwrap() - if k > 13_000 { 3600.0 } else { 0.0 };
        writeln!(bad, "({jumped:.6}){rest}").unwrap();
        if k % 1000 == 500 {
            bad += "(((( no line\n(1.000000) can0 18F0090B#GG\n\u{fffd}\n";
        }
    }
    std::fs::write(drive.path("bad.log"), bad).unwrap();
    let found = lines(&drive.replay(&drive.path("bad.log"), &[]).done());
    let notices = events(&found, "notice");
    let told = |words: &str| {
        notices.iter().filter(|line| line["message"].as_str().unwrap().contains(words)).count()
    };
    assert_eq!((told("line 502"), told("jumped by -3599")), (1, 1));
    let malformed = events(&found, "status").last().unwrap()["malformed"].as_u64().unwrap();
    assert_eq!(malformed, 3 * (text.lines().count() as u64 - 500).div_ceil(1000));
    let whole = lines(&drive.replay(&drive.candump, &[]).done());
    // The jump ends a maneuver early, possibly in a turn. Only this maneuver differs.
    assert!((last_height(&found) / last_height(&whole) - 1.0).abs() < 5e-3);
}

/// A roll sensor that is not a J1939 device and is mounted the other way round.
#[test]
fn a_sensor_of_a_dbc_file_takes_the_place_of_j1939() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let mut moved = String::new();
    for line in text.lines() {
        let Some((head, data)) = line.split_once("0CF029E4#") else {
            writeln!(moved, "{line}").unwrap();
            continue;
        };
        let bytes: Vec<u8> =
            (0..3).map(|k| u8::from_str_radix(&data[6 + 2 * k..8 + 2 * k], 16).unwrap()).collect();
        let raw = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], 0]);
        let degrees = f64::from(raw) / 32768.0 - 250.0;
        #[allow(clippy::cast_possible_truncation)] // some degrees
        let [low, high] = ((-degrees * 1000.0).round() as i16).to_le_bytes();
        writeln!(moved, "{head}123#{low:02X}{high:02X}").unwrap();
    }
    std::fs::write(drive.path("moved.log"), moved).unwrap();
    std::fs::write(
        drive.path("tilt.dbc"),
        "VERSION \"\"\n\nBU_: S\n\nBO_ 291 TILT: 2 S\n SG_ Angle : 0|16@1- (0.001,0) [-30|30] \"deg\" X\n",
    )
    .unwrap();
    let log = drive.path("moved.log");
    let dbc = drive.path("tilt.dbc");
    let signal = ["--dbc", &dbc, "--signal", "roll=TILT.Angle"];
    let whole = lines(&drive.replay(&drive.candump, &[]).done());
    for turn in [&["--flip", "roll"][..], &[]] {
        let mut more = signal.to_vec();
        more.extend(turn);
        let run = drive.replay(&log, &more);
        if turn.is_empty() {
            assert_eq!(run.code, Some(1), "a roll sensor the wrong way round gives no height");
        } else {
            // Rounded to a thousandth of a degree, which is 1e-4 of the roll angle.
            let height = last_height(&lines(&run.done()));
            assert!((height / last_height(&whole) - 1.0).abs() < 1e-3);
        }
    }
}

/// The springs and the fifth wheel of this truck have play. 20 t that stand 0.3 m to the right lean all the time, and
/// then 14 t to the left, which is another load. The digits are those of the whole log for `cg estimate`, and those up
/// to the first turn for `cg run`.
#[test]
fn a_lean_is_told_once_for_each_load() {
    let folder = Scratch::new();
    let truck = fixture("vehicles/baseline-tables.toml");
    let drive = |name: &str, payload_kg: &str, left_m: &str| {
        let load = ["--payload-kg", payload_kg, "--height-m", "1.9", "--payload-left-m", left_m];
        let maneuver = ["--maneuver", "drive", "--plant", "nonlinear", "--duration-s", "120"];
        folder.simulate(name, &truck, &[&maneuver[..], &["--rate-hz", "50"], &load].concat())
    };
    let told = |log: &str| {
        let found = lines(&cg(&["run", "--vehicle", &truck, "--csv", log]).told(0, &[]));
        assert!(events(&found, "maneuver").len() > 2);
        let leans = events(&found, "notice").into_iter().filter(|line| line["subject"] == "lean");
        leans.map(|line| line["message"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let right = drive("right.csv", "20000", "-0.3");
    let answer = estimate(&right, &truck, &[]).told(0, &[]).answer();
    let messages = answer["messages"].as_array().unwrap().iter().map(|one| one.as_str().unwrap());
    let whole: Vec<&str> = messages.filter(|one| one.starts_with("in straight driving")).collect();
    let without_digits = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "");
    let found = told(&right);
    assert_eq!((found.len(), whole.len()), (1, 1), "{found:?} {answer}");
    assert_eq!(without_digits(&found[0]), without_digits(whole[0]));
    assert!(found[0].contains("to the right"), "{found:?}");
    assert!(told(&drive("middle.csv", "20000", "0")).is_empty());
    let (first, second) = (std::fs::read_to_string(&right), drive("left.csv", "14000", "0.3"));
    let mut both = first.unwrap();
    for line in std::fs::read_to_string(&second).unwrap().lines() {
        if let Some((Ok(time_s), rest)) =
            line.split_once(',').map(|(t, rest)| (t.parse::<f64>(), rest))
        {
            writeln!(both, "{},{rest}", time_s + 200.0).unwrap();
        }
    }
    let found = told(&folder.file("both.csv", both));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("to the right") && found[1].contains("to the left"), "{found:?}");
}

#[test]
fn mistakes_are_refused_before_anything_runs() {
    let drive = drive();
    let log = drive.candump.as_str();
    let truck = drive.truck.as_str();
    let kept = drive.path("state.json");
    let (folder, head) = (drive.path(""), drive.path("head.csv"));
    std::fs::write(&head, "what,is,this\n1,2,3\n").unwrap();
    let cases: [(&[&str], &[&str]); 15] = [
        (&["run", "--vehicle", truck], &["--can <IFACE>", "--candump <FILE>"]),
        (&["run", "--vehicle", "none.toml", "--candump", log], &["none.toml"]),
        (&["run", "--vehicle", truck, "--candump", "none.log"], &["none.log: cannot be read"]),
        (&["run", "--vehicle", truck, "--csv", "none.csv"], &["none.csv: cannot be opened"]),
        (&["run", "--vehicle", truck, "--candump", &folder], &[&folder, "is a folder"]),
        (&["run", "--vehicle", truck, "--csv", &head], &["head.csv", "time_s"]),
        (&["run", "--vehicle", truck, "--csv", log], &["--candump instead of --csv"]),
        (
            &["run", "--vehicle", truck, "--candump", log, "--warn", "1.5"],
            &["share of the threshold"],
        ),
        (&["run", "--vehicle", truck, "--candump", log, "--signal", "roll=A.B"], &["--dbc <FILE>"]),
        (
            &["run", "--vehicle", truck, "--candump", log, "--source-of", "rol=1"],
            &["no quantity `rol`"],
        ),
        (
            &["run", "--vehicle", truck, "--candump", log, "--method", "arx", "--state", &kept],
            &["--method arx: --state is for", "remove one of the two options"],
        ),
        (
            &["run", "--vehicle", truck, "--candump", log, "--speed-request", "0"],
            &["share of the threshold"],
        ),
        (
            &["run", "--vehicle", truck, "--can", "none0", "--method", "gain", "--transmit"],
            &["--method gain: --transmit is for"],
        ),
        (
            &["run", "--vehicle", truck, "--candump", log, "--transmit-address", "5"],
            &["--transmit-address", "cannot be used with"],
        ),
        (
            // Without that mistake it would wait for the interface.
            &[
                "run",
                "--vehicle",
                truck,
                "--can",
                "none0",
                "--learn",
                "on",
                "--transmit-address",
                "5",
            ],
            &["--transmit\n"],
        ),
    ];
    for (arguments, parts) in cases {
        cg(arguments).refused(parts);
    }
}

pub(crate) fn ask_to_stop(child: &Child) {
    let kill = Command::new("kill").args(["-15", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}

/// The program waits for a missing interface. It notifies systemd that it is ready, alive, and
/// stopping. SIGTERM ends it normally.
#[test]
fn a_service_manager_sees_a_living_program() {
    let folder = tempfile::tempdir().unwrap();
    let address = folder.path().join("notify");
    let socket = UnixDatagram::bind(&address).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let mut child = command(&["run", "--vehicle", &kraz(), "--can", "can77", "--status-s", "0"])
        .env("NOTIFY_SOCKET", &address)
        .env("WATCHDOG_USEC", "400000")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut heard = String::new();
    let mut buffer = [0; 256];
    while !heard.contains("READY=1") || heard.matches("WATCHDOG=1").count() < 3 {
        let length = socket.recv(&mut buffer).unwrap();
        heard += &String::from_utf8_lossy(&buffer[..length]);
    }
    ask_to_stop(&child);
    assert!(child.wait().unwrap().success());
    let length = socket.recv(&mut buffer).unwrap();
    heard += &String::from_utf8_lossy(&buffer[..length]);
    assert!(heard.contains("STOPPING=1"), "{heard}");
    let mut out = String::new();
    child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
    assert!(out.contains("can77") && out.contains("waiting for it"), "{out}");
    assert!(out.lines().last().unwrap().contains("\"event\":\"stop\""), "{out}");
}

/// `--realtime` takes as long as the log, and can be stopped.
#[test]
fn a_replay_in_real_time_can_be_stopped() {
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let child = command(&["run", "--vehicle", &kraz(), "--csv", &log, "--realtime"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(2));
    ask_to_stop(&child);
    let run: Run = child.wait_with_output().unwrap().into();
    let found = lines(&run);
    let stop = found.last().unwrap();
    assert_eq!(stop["reason"], "signal");
    // The number of rows is not larger than the elapsed time allows (17 s in all).
    assert!(stop["frames"].as_u64().unwrap() < 1700, "{stop}");
}
