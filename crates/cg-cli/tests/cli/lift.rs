//! Lift axles of the trailer: with one raised, the truck is another one with the same load.

use std::fmt::Write as _;

use serde_json::Value;

use crate::common::{Run, Scratch, cg, estimate, fixture, height_m};
use crate::run::{events, last_height, lines};

const LOAD: [&str; 4] = ["--trailer-mass-kg", "16000", "--height-m", "1.8"];
const EMPTY: [&str; 2] = ["--trailer-mass-kg", "6318"];
const TURN: [&str; 6] = ["--plant", "nonlinear", "--maneuver", "rounded-step", "--snr-db", "30"];

/// The second independent truck, whose first trailer axle can be raised by 10 cm.
struct Lifting {
    scratch: Scratch,
    truck: String,
}

impl Lifting {
    fn new() -> Self {
        Self::of("euro")
    }

    /// The same of another vehicle.
    fn of(vehicle: &str) -> Self {
        let scratch = Scratch::new();
        let truck = scratch.lifting(vehicle);
        Self { scratch, truck }
    }

    /// A turn on the nonlinear plant with the lift axle in a position.
    fn turn(&self, name: &str, position: &str, load: &[&str]) -> String {
        let lift = ["--lift-axle", position];
        self.scratch.simulate(name, &self.truck, &[&TURN[..], &lift, load].concat())
    }

    fn estimate(&self, log: &str, more: &[&str]) -> Value {
        estimate(log, &self.truck, more).done().answer()
    }

    fn run(&self, log: &str, more: &[&str]) -> Run {
        cg(&[&["run", "--csv", log, "--vehicle", &self.truck], more].concat())
    }
}

/// The text of a log without its last column.
fn without_last_column(text: &str) -> String {
    let cut = |line: &str| match line.rsplit_once(',') {
        Some((before, _)) if !line.starts_with('#') => before.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(|line| cut(line) + "\n").collect()
}

/// Two logs of 20 s, one after the other.
fn one_after_the_other([first, second]: [&str; 2]) -> String {
    let mut both = std::fs::read_to_string(first).unwrap();
    let second = std::fs::read_to_string(second).unwrap();
    let rows = second.lines().filter(|line| !line.starts_with('#')).skip(1);
    for row in rows {
        let (time_s, rest) = row.split_once(',').unwrap();
        let time_s = time_s.parse::<f64>().unwrap() + 25.0;
        writeln!(both, "{time_s},{rest}").unwrap();
    }
    both
}

fn says(answer: &Value, part: &str) -> bool {
    answer["messages"].as_array().unwrap().iter().any(|one| one.as_str().unwrap().contains(part))
}

fn holds(answer: &Value, truth_m: f64) -> bool {
    let [low_m, high_m] = [0, 1].map(|end| answer["height_ci95_m"][end].as_f64().unwrap());
    (low_m..=high_m).contains(&truth_m)
}

fn is_within_a_percent(height_m: f64) {
    assert!((height_m / 1.8 - 1.0).abs() < 0.01, "{height_m}");
}

/// The noise of 30 dB leaves 0.2 %; the rest of a percent is for the plant's tires and friction in the model.
#[test]
fn a_log_says_where_the_lift_axle_is() {
    let truck = Lifting::new();
    for position in ["down", "raised"] {
        let log = truck.turn("log.csv", position, &LOAD);
        let answer = truck.estimate(&log, &[]);
        is_within_a_percent(height_m(&answer));
        assert!(holds(&answer, 1.8) && !says(&answer, "lift axle"), "{answer}");
        assert_eq!(answer["lift_axle"], position);
        let live = lines(&truck.run(&log, &[]).done());
        is_within_a_percent(last_height(&live));
        for kind in ["status", "maneuver"] {
            assert_eq!(events(&live, kind).last().unwrap()["lift_axle"], position, "{kind}");
        }
        assert_eq!(
            events(&live, "notice").iter().any(|one| one["subject"] == "lift_axle"),
            position == "raised"
        );
        // The same position, given beside the log or in place of the column.
        let given = ["--lift-axle", position];
        assert_eq!(height_m(&truck.estimate(&log, &given)).to_bits(), height_m(&answer).to_bits());
        let text = std::fs::read_to_string(&log).unwrap();
        let silent = truck.scratch.file("silent.csv", without_last_column(&text));
        let told = truck.estimate(&silent, &given);
        assert_eq!(height_m(&told).to_bits(), height_m(&answer).to_bits());
        assert_eq!(told["lift_axle"], position);
        let csv = cg(&["estimate", &log, "--vehicle", &truck.truck, "--format", "csv"]).done().out;
        assert!(csv.trim_end().ends_with(&format!(",{position}")), "{csv}");
        assert!(!says(&told, "lift axle"));
    }
}

/// Nothing in the signals shows the position with a load: 12 to 41 % too high is said before anybody uses it.
#[test]
fn an_unknown_or_contradicted_position_is_told() {
    let truck = Lifting::new();
    let log = truck.turn("log.csv", "raised", &LOAD);
    let text = std::fs::read_to_string(&log).unwrap();
    let silent = truck.scratch.file("silent.csv", without_last_column(&text));
    let is_told = "nothing says whether it is raised";
    let answer = truck.estimate(&silent, &[]);
    assert!(height_m(&answer) > 1.12 * 1.8 && says(&answer, is_told), "{answer}");
    let live = lines(&truck.run(&silent, &[]).done());
    let notices = events(&live, "notice");
    let told: Vec<_> = notices.iter().filter(|one| one["subject"] == "lift_axle").collect();
    assert!(told.len() == 1 && told[0]["message"].as_str().unwrap().contains(is_told), "{told:?}");

    let wrong = truck.estimate(&log, &["--lift-axle", "down"]);
    assert!(
        says(&wrong, "was given as down, but the log says that a lift axle is raised"),
        "{wrong}"
    );
    let down = truck.turn("down.csv", "down", &LOAD);
    let wrong = truck.estimate(&down, &["--lift-axle", "raised"]);
    assert!(says(&wrong, "given as raised, but the log says that it is down"), "{wrong}");
    let none = estimate(&log, &fixture("vehicles/euro.toml"), &[]).done().answer();
    assert!(says(&none, "the log says that a lift axle is raised"), "{none}");
    cg(&["estimate", &log, "--vehicle", &fixture("vehicles/euro.toml"), "--lift-axle", "raised"])
        .refused(&["--lift-axle", "no lift axle to raise", "lift_m"]);
}

#[test]
fn an_axle_that_moves_begins_another_height() {
    let truck = Lifting::new();
    let logs = [("down.csv", "down"), ("raised.csv", "raised")];
    let [down, raised] = logs.map(|(name, position)| truck.turn(name, position, &LOAD));
    let both = truck.scratch.file("both.csv", one_after_the_other([&down, &raised]));
    let answer = truck.estimate(&both, &[]);
    is_within_a_percent(height_m(&answer));
    assert!(says(&answer, "the lift axle was raised at 26 s"), "{answer}");
    // The roll angle of the first second is left out.
    let alone = truck.estimate(&raised, &[]);
    assert!((height_m(&alone) / height_m(&answer) - 1.0).abs() < 1e-3);
    let live = lines(&truck.run(&both, &[]).done());
    let changed = events(&live, "load_changed");
    assert!(changed.len() == 1 && changed[0]["message"].as_str().unwrap().contains("was raised"));
    for maneuver in events(&live, "maneuver") {
        is_within_a_percent(maneuver["height_m"].as_f64().unwrap());
    }
    let run = format!("{both}=1.8,16000");
    let of = ["--vehicle", &truck.truck, "--run", &run, "-o", &truck.scratch.path("c.toml")];
    cg(&[&["calibrate"], &of[..]].concat()).refused(&["both.csv", "the lift axle moved at 26 s"]);
}

/// Springs and tires of the axles that stay are those of the calibration, whatever the others did in its runs. The springs of
/// `air` carry half as much again and are stiffer by that.
#[test]
fn a_calibration_holds_in_both_positions() {
    for (vehicle, tare_kg) in [("euro", "6318"), ("air", "6260.78")] {
        calibrated(&Lifting::of(vehicle), tare_kg);
    }
}

fn calibrated(truck: &Lifting, tare_kg: &str) {
    let laden =
        truck.turn("laden.csv", "down", &["--trailer-mass-kg", "24000", "--height-m", "2.0"]);
    for empty in ["down", "raised"] {
        let empty = truck.turn("empty.csv", empty, &["--trailer-mass-kg", tare_kg]);
        let runs = [format!("{empty}=empty"), format!("{laden}=2.0,24000")];
        let calibration = truck.scratch.path("c.toml");
        let of = ["--vehicle", &truck.truck, "-o", &calibration, "--force"];
        cg(&[&["calibrate", "--run", &runs[0], "--run", &runs[1]], &of[..]].concat()).done();
        for position in ["down", "raised"] {
            let log = truck.turn("log.csv", position, &LOAD);
            let answer = truck.estimate(&log, &["--calibration", &calibration]);
            let [low_m, high_m] = [0, 1].map(|end| answer["height_ci95_m"][end].as_f64().unwrap());
            assert!(holds(&answer, 1.8) && high_m - low_m < 0.15, "{answer}");
            is_within_a_percent(height_m(&answer));
        }
    }
}

#[test]
fn a_calibration_of_before_holds_with_the_key() {
    let truck = Lifting::new();
    // The key of an axle that was down in every run is none of the calibration.
    let truck_without = fixture("vehicles/euro.toml");
    let down = truck.turn("empty.csv", "down", &EMPTY);
    let calibration = truck.scratch.path("c.toml");
    let run = format!("{down}=empty");
    let of = ["--vehicle", &truck_without, "--run", &run, "-o", &calibration, "--force"];
    cg(&[&["calibrate"], &of[..]].concat()).done();
    let log = truck.turn("log.csv", "raised", &LOAD);
    is_within_a_percent(height_m(&truck.estimate(&log, &["--calibration", &calibration])));
}

/// A trailer that raises its axle whenever it is empty learns with it raised, and keeps heights over a restart.
#[test]
fn a_truck_learns_and_restarts_with_its_axle_raised() {
    let truck = Lifting::new();
    let state = truck.scratch.path("state.json");
    let kept = ["--state", &state];
    let empty = truck.turn("empty.csv", "raised", &EMPTY);
    let mass = std::fs::read_to_string(&empty).unwrap();
    assert!(mass.contains("trailer_mass_kg"));
    let learned = lines(&truck.run(&empty, &kept).done());
    assert!(events(&learned, "learned").len() == 1, "{learned:?}");
    assert!(std::fs::read_to_string(&state).unwrap().contains("\"lift_axle\":\"raised\""));
    let log = truck.turn("log.csv", "raised", &LOAD);
    let used = lines(&truck.run(&log, &kept).done());
    assert!(events(&used, "learned").iter().any(|one| one["trips"] == 1), "{used:?}");
    is_within_a_percent(last_height(&used));
    // The same turn again: the heights of the load go on.
    let again = lines(&truck.run(&log, &kept).done());
    let first = events(&again, "maneuver")[0];
    assert!(again[0]["restored"] == true && first["maneuvers"] == 2, "{first}");
    // Lowered, the truck is another one.
    let down = truck.turn("down.csv", "down", &LOAD);
    let lowered = lines(&truck.run(&down, &kept).done());
    assert_eq!(events(&lowered, "load_changed").len(), 1);
    is_within_a_percent(last_height(&lowered));
    // Given as raised, the heights with it down are not those of this truck, but what it has learned is.
    let raised = lines(&truck.run(&log, &[&kept[..], &["--lift-axle", "raised"]].concat()).done());
    let notices = events(&raised, "notice");
    assert!(notices.iter().any(|one| {
        one["message"].as_str().unwrap().contains("with the lift axle down and are not used")
    }));
    assert_eq!(events(&raised, "start")[0]["restored"], false);
    assert_eq!(events(&raised, "maneuver")[0]["maneuvers"], 1);
    assert!(events(&raised, "learned").iter().any(|one| one["trips"] == 1), "{raised:?}");
}

/// The trip is that of an empty trailer with its axle raised, which is lower than with it down, and rolls by a third more.
#[test]
fn a_truck_learns_with_a_given_position() {
    let truck = Lifting::new();
    let state = truck.scratch.path("state.json");
    let empty = truck.turn("empty.csv", "raised", &EMPTY);
    let text = std::fs::read_to_string(&empty).unwrap();
    let silent = truck.scratch.file("silent.csv", without_last_column(&text));
    let run = truck.run(&silent, &["--state", &state, "--lift-axle", "raised"]).done();
    let learned = events(&lines(&run), "learned").len();
    let calibration = truck.scratch.path("c.toml");
    let of = ["--vehicle", &truck.truck, "--from-state", &state, "-o", &calibration];
    let told = cg(&[&["calibrate"], &of[..]].concat()).done().out;
    // The file is that of the truck.
    let stiffness =
        told.lines().find(|line| line.contains("trailer suspension roll stiffness")).unwrap();
    let factor = stiffness.split('×').nth(1).unwrap().split_whitespace().next().unwrap();
    assert!(learned == 1 && (factor.parse::<f64>().unwrap() - 1.0).abs() < 0.02, "{told}");
}

/// A gateway's status bits: 0 down, 1 raised, 3 not available.
const DBC: &str = r#"VERSION ""

BU_: GATEWAY

BO_ 2566887761 TRAILER_STATUS: 8 GATEWAY
 SG_ LiftAxle1 : 8|2@1+ (1,0) [0|3] "" Vector__XXX
"#;

/// The frames of a log, with one that says where the lift axle is in each tenth of a second.
fn with_position(frames: &str, bits: u8) -> String {
    let mut text = String::new();
    let mut told_s = 0.0;
    for line in frames.lines() {
        let stamp = line.trim_start_matches('(').split(')').next().unwrap();
        let now_s: f64 = stamp.parse().unwrap();
        if now_s > told_s + 0.1 {
            told_s = now_s;
            writeln!(text, "({stamp}) can0 18FF9951#FF{:02X}FFFFFFFFFFFF", 0xFC | bits).unwrap();
        }
        writeln!(text, "{line}").unwrap();
    }
    text
}

#[test]
fn frames_say_where_the_lift_axle_is() {
    let truck = Lifting::new();
    let text = std::fs::read_to_string(&truck.truck).unwrap();
    let text = text.replacen("nominal_speed_mps", "steering_ratio = 20.0\nnominal_speed_mps", 1);
    let file = truck.scratch.file("truck.toml", text + "\n[road]\nbank_sd_rad = 0.0\n");
    let log = truck.turn("log.log", "raised", &LOAD);
    let frames = std::fs::read_to_string(&log).unwrap();
    let dbc = truck.scratch.file("gateway.dbc", DBC);
    let mapped = ["--dbc", &dbc, "--signal", "lift_axle=TRAILER_STATUS.LiftAxle1"];
    for (bits, is_right) in [(1, true), (0, false), (3, false)] {
        let told = truck.scratch.file("told.log", with_position(&frames, bits));
        let answer = estimate(&told, &file, &mapped).done().answer();
        let live = cg(&[&["run", "--candump", &told, "--vehicle", &file], &mapped[..]].concat());
        let live = last_height(&lines(&live.done()));
        for found_m in [height_m(&answer), live] {
            assert_eq!((found_m / 1.8 - 1.0).abs() < 0.01, is_right, "{bits}: {found_m}");
            assert!(is_right || found_m > 1.12 * 1.8, "{bits}: {found_m}");
        }
        assert_eq!(says(&answer, "nothing says whether it is raised"), bits == 3, "{answer}");
    }
    // Of two, one would be ignored.
    let twice = [&mapped[..], &["--signal", "lift_axle=LiftAxle1*1"]].concat();
    estimate(&log, &file, &twice).refused(&["--signal lift_axle=LiftAxle1*1", "one signal"]);
}

/// A table with a row for each channel's time stamp: the roll angle here, all else two milliseconds later.
#[test]
fn channels_of_different_rasters_keep_the_position() {
    let truck = Lifting::new();
    let log = truck.turn("log.csv", "raised", &LOAD);
    let text = std::fs::read_to_string(&log).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let header = rows.next().unwrap();
    let roll = header.split(',').position(|name| name == "roll_rad").unwrap();
    let mut apart = format!("{header}\n");
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let only = |wanted: &dyn Fn(usize) -> bool, later_s: f64| {
            let time_s = cells[0].parse::<f64>().unwrap() + later_s;
            let rest = (1..cells.len()).map(|k| if wanted(k) { cells[k] } else { "" });
            format!("{time_s:.4},{}\n", rest.collect::<Vec<_>>().join(","))
        };
        apart += &only(&|k| k == roll, 0.0);
        apart += &only(&|k| k != roll, 0.002);
    }
    let apart = truck.scratch.file("apart.csv", apart);
    let answer = truck.estimate(&apart, &[]);
    is_within_a_percent(height_m(&answer));
    assert!(says(&answer, "were aligned") && !says(&answer, "nothing says"), "{answer}");
}

/// The text of a log with one column changed, by row.
fn with_column(log: &str, name: &str, value: impl Fn(usize, &str) -> String) -> String {
    let text = std::fs::read_to_string(log).unwrap();
    let mut out = String::new();
    let (mut place, mut row) = (None, 0);
    for line in text.lines() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        match place {
            _ if line.starts_with('#') => {}
            None => place = Some(cells.iter().position(|cell| cell == name).unwrap()),
            Some(place) => {
                cells[place] = value(row, &cells[place]);
                row += 1;
            }
        }
        writeln!(out, "{}", cells.join(",")).unwrap();
    }
    out
}

/// The mass of one cell is that of the load, whatever the axle does afterwards.
#[test]
fn a_mass_that_is_said_once_holds_over_a_move() {
    let truck = Lifting::new();
    let both = ["down", "raised"].map(|one| truck.turn(&format!("{one}.csv"), one, &LOAD));
    let both = truck.scratch.file("both.csv", one_after_the_other([&both[0], &both[1]]));
    let once = |row: usize, cell: &str| if row == 0 { cell.to_owned() } else { String::new() };
    let once = truck.scratch.file("once.csv", with_column(&both, "trailer_mass_kg", once));
    let answer = truck.estimate(&once, &[]);
    is_within_a_percent(height_m(&answer));
    assert!((answer["trailer_mass_kg"].as_f64().unwrap() - 16e3).abs() < 1.0);
    let live = lines(&truck.run(&once, &[]).done());
    is_within_a_percent(last_height(&live));
    // Also if it is from before a restart.
    let state = truck.scratch.path("state.json");
    let kept = ["--state", &state];
    truck.run(&truck.scratch.path("raised.csv"), &kept).done();
    let none =
        with_column(&truck.scratch.path("down.csv"), "trailer_mass_kg", |_, _| String::new());
    let none = truck.scratch.file("none.csv", none);
    is_within_a_percent(last_height(&lines(&truck.run(&none, &kept).done())));
}

#[test]
fn a_wrong_value_is_no_move_and_a_signal_that_stops_is_told() {
    let truck = Lifting::new();
    let log = truck.turn("log.csv", "raised", &LOAD);
    let right = truck.estimate(&log, &[]);
    let glitch =
        |row: usize, cell: &str| if row % 400 == 399 { "0".to_owned() } else { cell.to_owned() };
    let glitches =
        truck.scratch.file("glitches.csv", with_column(&log, "lift_axle_raised", glitch));
    let answer = truck.estimate(&glitches, &[]);
    assert_eq!(height_m(&answer).to_bits(), height_m(&right).to_bits());
    assert!(!says(&answer, "lift axle"), "{answer}");

    let drive =
        ["--plant", "nonlinear", "--maneuver", "drive", "--duration-s", "120", "--rate-hz", "20"];
    let raised = ["--snr-db", "30", "--lift-axle", "raised"];
    let drive = [&drive[..], &raised, &LOAD].concat();
    let long = truck.scratch.simulate("long.csv", &truck.truck, &drive);
    let stops = |row: usize, _: &str| if row < 40 { "0".to_owned() } else { String::new() };
    let stops = truck.scratch.file("stops.csv", with_column(&long, "lift_axle_raised", stops));
    let told = "the signal of the lift axle has stopped";
    assert!(says(&truck.estimate(&stops, &[]), told));
    let live = lines(&truck.run(&stops, &[]).done());
    assert!(
        events(&live, "notice").iter().any(|one| one["message"].as_str().unwrap().contains(told))
    );
    // Written at the beginning only, it has not.
    let once = |row: usize, _: &str| if row == 0 { "1".to_owned() } else { String::new() };
    let once = truck.scratch.file("once.csv", with_column(&long, "lift_axle_raised", once));
    assert!(!says(&truck.estimate(&once, &[]), "lift axle"));
    // What is said after some turns says nothing of these.
    let late = |row: usize, _: &str| if row == 1200 { "0".to_owned() } else { String::new() };
    let late = truck.scratch.file("late.csv", with_column(&long, "lift_axle_raised", late));
    assert!(says(
        &truck.estimate(&late, &[]),
        "turns ended before anything said where the lift axle was"
    ));
    // A move within a turn contradicts nothing.
    let moves = |row: usize, _: &str| if row > 200 { "1".to_owned() } else { "0".to_owned() };
    let moves = truck.scratch.file("moves.csv", with_column(&long, "lift_axle_raised", moves));
    let live = lines(&truck.run(&moves, &[]).done());
    let notices = events(&live, "notice");
    assert!(notices.iter().all(|one| one["subject"] != "lift_axle"), "{notices:?}");
    assert_eq!(events(&live, "load_changed").len(), 1);
    is_within_a_percent(last_height(&live));
    // Said wherever in the log, another position than the given one contradicts it.
    let late = truck.scratch.file(
        "late.csv",
        with_column(&long, "lift_axle_raised", |row, _| {
            if row > 2300 { "0".to_owned() } else { "1".to_owned() }
        }),
    );
    let none = estimate(&late, &truck.truck, &[]).told(1, &[]).answer();
    assert!(says(&none, "no turn has given a height since the lift axle moved at 116 s"), "{none}");
    let late = |row: usize, cell: &str| if row > 2000 { "0".to_owned() } else { cell.to_owned() };
    let late = truck.scratch.file("late.csv", with_column(&long, "lift_axle_raised", late));
    assert!(says(
        &truck.estimate(&late, &["--lift-axle", "raised"]),
        "was given as raised, but the log says"
    ));
    let early = |row: usize, _: &str| if row > 200 { "1".to_owned() } else { "0".to_owned() };
    let early = truck.scratch.file("early.csv", with_column(&long, "lift_axle_raised", early));
    assert!(says(
        &truck.estimate(&early, &["--lift-axle", "raised"]),
        "was given as raised, but the log says"
    ));
}

/// What is not known of the position must not become what is known of the truck.
#[test]
fn an_unknown_position_is_neither_learned_nor_calibrated_silently() {
    let truck = Lifting::new();
    let empty = truck.turn("empty.csv", "raised", &EMPTY);
    let text = std::fs::read_to_string(&empty).unwrap();
    let silent = truck.scratch.file("silent.csv", without_last_column(&text));
    let state = truck.scratch.path("state.json");
    for more in [&[][..], &["--lift-axle", "down"]] {
        let log = if more.is_empty() { &silent } else { &empty };
        let run = truck.run(log, &[&["--state", &state], more].concat()).done();
        assert!(events(&lines(&run), "learned").is_empty(), "{run:?}");
    }
    let calibrate = |log: &str, more: &[&str]| {
        let run = format!("{log}=empty");
        let of = [
            "--vehicle",
            &truck.truck,
            "--run",
            &run,
            "-o",
            &truck.scratch.path("c.toml"),
            "--force",
        ];
        cg(&[&["calibrate"], &of[..], more].concat())
    };
    assert!(calibrate(&silent, &[]).done().out.contains("nothing says whether it is raised"));
    calibrate(&empty, &["--lift-axle", "down"])
        .refused(&["empty.csv", "was given as down, but the log says"]);
}
