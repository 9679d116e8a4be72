//! Faults of trucks in service that were once silent: a height that misses the truth has a message that
//! names what is wrong.

use serde_json::Value;

use crate::common::{Scratch, cg, estimate, fixture, height_m, kraz};
use crate::run::{events, lines};

const DRIVE: [&str; 8] =
    ["--maneuver", "drive", "--plant", "nonlinear", "--rate-hz", "50", "--duration-s", "120"];

/// A log with the cells of one column replaced, `None` leaves the column empty; of the other columns only
/// these.
fn changed(log: &str, keep: &[&str], column: &str, value: Option<&str>) -> String {
    let text = std::fs::read_to_string(log).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let kept: Vec<usize> =
        keep.iter().map(|name| header.iter().position(|one| one == name).unwrap()).collect();
    let mut text = keep.join(",") + "\n";
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let cell = |&k: &usize| if header[k] == column { value.unwrap_or("") } else { cells[k] };
        text += &(kept.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

fn messages(answer: &Value) -> String {
    answer["messages"].to_string()
}

#[test]
fn a_dead_level_is_named() {
    let scratch = Scratch::new();
    let truck = fixture("vehicles/euro.toml");
    let load = ["--payload-kg", "16000", "--height-m", "1.85"];
    let log = scratch.simulate("log.csv", &truck, &[&["--road", "rural"][..], &load].concat());
    let keep = [
        "time_s",
        "speed_mps",
        "yaw_rate_radps",
        "trailer_mass_kg",
        "level_left_m",
        "level_right_m",
        "lateral_specific_force_mps2",
    ];
    let sound = scratch.file("sound.csv", changed(&log, &keep, "", None));
    let answer = estimate(&sound, &truck, &[]).told(0, &[]).answer();
    assert!((height_m(&answer) / 1.85 - 1.0).abs() < 0.02, "{answer}");
    assert!(!messages(&answer).contains("stood still"), "{answer}");
    for (column, side) in [("level_left_m", "left"), ("level_right_m", "right")] {
        let dead = scratch.file("dead.csv", changed(&log, &keep, column, Some("0.01")));
        let answer = estimate(&dead, &truck, &[]).told(1, &[]).answer();
        assert_eq!(answer["status"], "inconsistent");
        let said = format!("the {side} level of the trailer stood still");
        assert!(messages(&answer).contains(&said), "{answer}");
        let run = lines(&cg(&["run", "--csv", &dead, "--vehicle", &truck]).told(1, &[]));
        let last = run.iter().rfind(|line| line["event"] == "status").unwrap();
        assert_eq!(last["status"], "inconsistent");
        assert!(run_notices(&run).contains(&said), "{run:?}");
    }
}

/// The columns of a CSV log with this name, as numbers.
fn column(log: &str, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(log).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let place = rows.next().unwrap().split(',').position(|one| one == name).unwrap();
    rows.map(|row| row.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// A compensated accelerometer of the tractor shows yaw rate times speed. Both commands say so, and have no
/// height; with the sensor itself they have one.
#[test]
fn a_specific_force_without_gravity_is_named() {
    let scratch = Scratch::new();
    let truck = fixture("vehicles/euro.toml");
    let load = ["--road", "rural", "--payload-kg", "16000", "--height-m", "1.85"];
    let log = scratch.simulate("log.csv", &truck, &load);
    let force = "tractor_lateral_specific_force_mps2";
    let names = ["time_s", "speed_mps", "yaw_rate_radps", "tractor_suspension_roll_rad", force];
    let sound = names.map(|name| column(&log, name));
    let mut compensated = sound.clone();
    compensated[4] = sound[1].iter().zip(&sound[2]).map(|(speed, rate)| speed * rate).collect();
    let mass = ["--trailer-mass-kg", "22318"];
    for (columns, is_sound) in [(sound, true), (compensated, false)] {
        let row = |k: usize| columns.each_ref().map(|column| column[k].to_string()).join(",");
        let rows: Vec<String> = (0..columns[0].len()).map(row).collect();
        let log = scratch.file("log.csv", names.join(",") + "\n" + &rows.join("\n") + "\n");
        let code = i32::from(!is_sound);
        let answer = estimate(&log, &truck, &mass).told(code, &[]).answer();
        let run = cg(&[&["run", "--csv", &log, "--vehicle", &truck][..], &mass].concat());
        let run = lines(&run.told(code, &[]));
        let last = run.iter().rfind(|line| line["event"] == "status").unwrap();
        for (said, of) in [(messages(&answer), &answer), (run_notices(&run), last)] {
            assert_eq!(of["status"], if is_sound { "ok" } else { "inconsistent" }, "{said}");
            assert_eq!(of["height_m"].is_null(), !is_sound);
            assert_eq!(said.contains("specific force of the tractor"), !is_sound, "{said}");
            assert_eq!(said.contains("--vdc2 acceleration"), !is_sound, "{said}");
        }
    }
}

/// A bus sends levels and pressures for which the vehicle file has no numbers: both commands say which
/// tables are missing, and nothing of what the file has.
#[test]
fn signals_without_their_numbers_are_named() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(fixture("vehicles/euro.toml")).unwrap();
    let text = "steering_ratio = 20.0\n".to_owned() + &text;
    let truck = scratch.file("truck.toml", &text);
    let numbers = "
[sensors.tractor_level]
spread_m = 0.9
[sensors.drive_pressure]
gauge_pa = [1e5, 5e5]
axle_load_kg = [5000.0, 20000.0]
";
    let full = scratch.file("full.toml", text + numbers);
    let log = scratch.simulate("log.log", &full, &["--road", "rural"]);
    let frames = std::fs::read_to_string(&log).unwrap();
    let without_mass = frames.lines().filter(|line| !line.contains("18FEEAC8#"));
    let log = scratch.file("log.log", without_mass.collect::<Vec<_>>().join("\n") + "\n");
    for (vehicle, is_told) in [(&truck, true), (&full, false)] {
        let answer = estimate(&log, vehicle, &[]).told(i32::from(is_told), &[]).answer();
        let run = cg(&["run", "--candump", &log, "--vehicle", vehicle]);
        for said in [messages(&answer), run_notices(&lines(&run))] {
            for table in ["no sensors.tractor_level", "no sensors.drive_pressure"] {
                assert_eq!(said.contains(table), is_told, "{said}");
            }
        }
    }
}

/// A bank of 0.01 rad makes more than a quarter of the variance: both commands say how much, and which sensors
/// would help. On a flat road it makes nothing.
#[test]
fn the_share_of_the_road_is_told_live_too() {
    let scratch = Scratch::new();
    let truck = kraz();
    let log = scratch.simulate("log.csv", &truck, &DRIVE);
    for (road, is_told) in [("0.01", true), ("flat", false)] {
        let answer = estimate(&log, &truck, &["--road", road]).done().answer();
        let run = cg(&["run", "--csv", &log, "--vehicle", &truck, "--road", road]);
        let run = lines(&run.done());
        let status = run.iter().rfind(|line| line["event"] == "status").unwrap();
        for (said, of) in [(messages(&answer), &answer), (run_notices(&run), status)] {
            let share = of["road_share"].as_f64().unwrap();
            assert_eq!(share > 0.25, is_told, "{share}");
            let text = format!("it makes up {:.0} % of the variance", 100.0 * share);
            assert_eq!(said.contains("makes up"), is_told, "{said}");
            assert!(!is_told || said.contains("level sensors and an accelerometer"), "{said}");
            assert!(!is_told || of == status || said.contains(&text), "{said}");
        }
        let [of_log, live] =
            [&answer, status].map(|of| (of["road_share"].as_f64(), of["height_m"].as_f64()));
        assert_eq!(of_log, live);
    }
}

/// The messages of all notices.
fn run_notices(lines: &[Value]) -> String {
    events(lines, "notice").iter().map(|notice| notice["message"].to_string()).collect()
}

const SIGNALS: [&str; 7] = [
    "time_s",
    "steer_rad",
    "roll_rad",
    "speed_mps",
    "lateral_acceleration_mps2",
    "yaw_rate_radps",
    "trailer_mass_kg",
];

/// The logs of two loads, and a calibration of this truck.
fn two_loads(scratch: &Scratch) -> [String; 3] {
    let truck = kraz();
    let drive = |name: &str, maneuver: &[&str], payload_kg: &str, height_m: &str| {
        let load = ["--payload-kg", payload_kg, "--height-m", height_m];
        scratch.simulate(name, &truck, &[maneuver, &load].concat())
    };
    let step = ["--maneuver", "rounded-step", "--plant", "nonlinear", "--rate-hz", "50"];
    let calibration = scratch.path("calibration.toml");
    let empty = drive("empty.csv", &step, "0", "1.33") + "=1.33";
    let laden = drive("laden.csv", &step, "16000", "1.85") + "=1.85";
    let runs = ["--run", &empty, "--run", &laden, "-o", &calibration];
    cg(&[&["calibrate", "--vehicle", &truck][..], &runs].concat()).done();
    let first = drive("a.csv", &DRIVE, "14000", "1.55");
    [first, drive("b.csv", &DRIVE, "7000", "1.5"), calibration]
}

/// Whether the interval contains the height of the second load.
fn holds(answer: &Value) -> bool {
    let [low, high] = [0, 1].map(|k| answer["height_ci95_m"][k].as_f64().unwrap());
    (low..high).contains(&1.5)
}

/// Two loads in one drive, of which only the first has a mass: the interval allows for any, until a mass
/// comes. If the mass of the first is held, it counts, and a message doubts it.
#[test]
fn the_mass_of_another_load_is_not_that_of_this_one() {
    const NONE: &str = "no trailer mass in the log is of the last load";
    const HELD: &str = "the trailer mass is the same as before";
    let scratch = Scratch::new();
    let truck = kraz();
    let [first, second, calibration] = two_loads(&scratch);
    let calibrated = ["--calibration", &calibration];
    let mass = "trailer_mass_kg";
    // Whether it is said that there is no mass of the load, and that it is the one before.
    let cases = [
        ("", None, [false, false]),
        (mass, None, [true, true]),
        (mass, Some("22684.0"), [false, true]),
    ];
    for (replaced, mass_kg, told) in cases {
        let mut both = changed(&first, &SIGNALS, "", None);
        for row in changed(&second, &SIGNALS, replaced, mass_kg).lines().skip(1) {
            let (time_s, rest) = row.split_once(',').unwrap();
            let time_s = time_s.parse::<f64>().unwrap() + 2000.0;
            both.extend([&time_s.to_string(), ",", rest, "\n"]);
        }
        let log = scratch.file("both.csv", both);
        let answer = estimate(&log, &truck, &calibrated).told(0, &[]).answer();
        let said = [NONE, HELD].map(|known| messages(&answer).contains(known));
        assert_eq!(said, told, "{answer}");
        // A height that follows from a wrong mass is wrong.
        assert_eq!(holds(&answer), mass_kg.is_none(), "{answer}");
        let run = cg(&[&["run", "--vehicle", &truck, "--csv", &log][..], &calibrated].concat());
        let found = lines(&run.told(0, &[]));
        let mut notices = events(&found, "notice").into_iter();
        let is_told = notices.any(|line| line["subject"] == "mass");
        assert_eq!(is_told, told[1], "{told:?}");
    }
}

/// The same after a restart, and after one more.
#[test]
fn the_mass_of_another_load_is_not_kept() {
    let scratch = Scratch::new();
    let [first, second, calibration] = two_loads(&scratch);
    let state = scratch.path("state.json");
    let resumed = |log: &str| {
        let more = ["--calibration", &calibration, "--csv", log, "--state", &state];
        lines(&cg(&[&["run", "--vehicle", &kraz()][..], &more].concat()).told(0, &[]))
    };
    let unweighed = scratch.file("b2.csv", changed(&second, &SIGNALS, "trailer_mass_kg", None));
    resumed(&first);
    for _ in 0..2 {
        let found = resumed(&unweighed);
        let last = events(&found, "status").pop().unwrap().clone();
        assert_eq!(last["trailer_mass_source"], "kept");
        assert!(last["trailer_mass_sd_kg"].as_f64().unwrap() > 5e3 && holds(&last), "{last}");
    }
}

/// A steer angle with a wrong gain, beside a yaw rate that agrees with the lateral acceleration: the steer angle is named,
/// and not an accelerometer that is fixed to the body, whose ratio would be the same.
#[test]
fn a_yaw_rate_clears_the_lateral_acceleration() {
    let scratch = Scratch::new();
    let [first, _, calibration] = two_loads(&scratch);
    for (gain, cause) in [(1.0, None), (0.83, Some("the steer angle is 0.8"))] {
        let log = scratch.file("gain.csv", altered(&first, "steer_rad", |_, rad| gain * rad));
        let answer = estimate(&log, &kraz(), &["--calibration", &calibration]).answer();
        let said = messages(&answer);
        assert!(!said.contains("fixed to the body"), "{said}");
        assert!(cause.is_none_or(|cause| said.contains(cause)), "{said}");
    }
}

/// A trailer that was loaded while `cg run` did not run: the height of the empty one is not shown beside the new mass.
#[test]
fn a_height_of_another_mass_is_not_shown() {
    let scratch = Scratch::new();
    let step = |name: &str, payload_kg: &str, height_m: &str| {
        let load = ["--payload-kg", payload_kg, "--height-m", height_m];
        scratch.simulate(name, &kraz(), &[&["--maneuver", "rounded-step"][..], &load].concat())
    };
    let [empty, laden] = [step("empty.csv", "0", "1.33"), step("laden.csv", "20000", "1.9")];
    let state = scratch.path("state.json");
    let run = |log: &str| {
        let more = ["--csv", log, "--state", &state, "--status-s", "3", "--learn", "off"];
        lines(&cg(&[&["run", "--vehicle", &kraz()][..], &more].concat()).told(0, &[]))
    };
    assert!(run(&empty).iter().any(|line| line["height_m"].is_number()));
    let found = run(&laden);
    let mut notices = events(&found, "notice").into_iter();
    assert!(notices.any(|line| line["subject"] == "load"), "{found:?}");
    let turned = found.iter().position(|line| line["event"] == "maneuver").unwrap();
    for line in found[..turned].iter().filter(|line| line["event"] == "status") {
        assert!(line["height_m"].is_null() && line["margin_g"].is_null(), "{line}");
        assert_eq!(line["trailer_mass_kg"], 28684.0);
    }
    assert!(turned > 2 && found[turned]["height_m"].is_number());
}

/// A roll sensor that measures turns to one side a third too great, in turns that alternate: the first height would
/// stand with a narrow interval, because no two maneuvers in a row contradict it. The ratio of a calibration's run is
/// as uncertain.
#[test]
fn maneuvers_that_contradict_each_other_are_told() {
    let scratch = Scratch::new();
    let truck = kraz();
    let turn = ["--maneuver", "steady-turn", "--plant", "nonlinear", "--rate-hz", "50"];
    let load = ["--payload-kg", "12000", "--height-m", "1.7", "--duration-s", "30"];
    let log = scratch.simulate("turn.csv", &truck, &[&turn[..], &load].concat());
    let rows = changed(&log, &SIGNALS, "", None);
    let both = |gain: f64| {
        let mut text = SIGNALS.join(",") + "\n";
        for (start_s, gain) in [(0.0, 1.0), (30.02, gain), (60.04, 1.0), (90.06, gain)] {
            for row in rows.lines().skip(1) {
                let mut cells: Vec<f64> = row.split(',').map(|one| one.parse().unwrap()).collect();
                cells[0] += start_s;
                cells[2] *= gain;
                let cells: Vec<String> = cells.iter().map(ToString::to_string).collect();
                text += &(cells.join(",") + "\n");
            }
        }
        scratch.file("both.csv", text)
    };
    for (gain, is_told) in [(1.0, false), (1.3, true)] {
        let log = both(gain);
        let answer = estimate(&log, &truck, &[]).told(0, &[]).answer();
        assert_eq!(messages(&answer).contains("2 of 4 maneuvers"), is_told, "{answer}");
        let run = lines(&cg(&["run", "--vehicle", &truck, "--csv", &log]).told(0, &[]));
        let mut notices = events(&run, "notice").into_iter();
        assert_eq!(notices.any(|line| line["subject"] == "left_out"), is_told, "{run:?}");
        let sd_m = events(&run, "maneuver").pop().unwrap()["height_sd_m"].as_f64().unwrap();
        assert!((sd_m / answer["height_sd_m"].as_f64().unwrap() - 1.0).abs() < 0.02, "{run:?}");
        let [known, file] = [log + "=1.7", scratch.path("calibration.toml")];
        let runs = ["calibrate", "--vehicle", &truck, "--run", &known, "-o", &file, "--force"];
        cg(&runs).done();
        let text = std::fs::read_to_string(&file).unwrap();
        let sd = text.lines().find_map(|line| line.strip_prefix("ratio_sd = ")).unwrap();
        assert_eq!(sd.parse::<f64>().unwrap() > 0.05, is_told, "{sd}");
    }
}

/// A truck that was weighed together with its trailer.
#[test]
fn a_load_below_its_floor_is_told() {
    let scratch = Scratch::new();
    let truck = kraz();
    let load = ["--payload-kg", "14000", "--height-m", "1.75"];
    let log = scratch.simulate("log.csv", &truck, &[&DRIVE[..], &load].concat());
    for (mass_kg, is_told) in [("22684", false), ("36000", true)] {
        let given = ["--trailer-mass-kg", mass_kg];
        let answer = estimate(&log, &truck, &given).told(0, &[]).answer();
        assert_eq!(messages(&answer).contains("below the floor at 1.27 m"), is_told, "{answer}");
    }
}

/// A step at three quarters of the rollover threshold: `cg estimate` and `cg run` have the same interval, which a restart
/// and a gentle turn of the same load do not make narrow again.
#[test]
fn a_turn_near_the_rollover_threshold_widens_the_interval() {
    let scratch = Scratch::new();
    let truck = kraz();
    let step = |name: &str, steer_rad: &str| {
        let load = ["--payload-kg", "20000", "--height-m", "2.2", "--rate-hz", "50"];
        let plant =
            ["--maneuver", "rounded-step", "--plant", "nonlinear", "--steer-rad", steer_rad];
        scratch.simulate(name, &truck, &[&load[..], &plant].concat())
    };
    let [gentle, strong] =
        [("gentle.csv", "0.03"), ("strong.csv", "0.085")].map(|(a, b)| step(a, b));
    let widths = [&gentle, &strong].map(|log| {
        let answer = estimate(log, &truck, &[]).told(0, &[]).answer();
        let is_told = messages(&answer).contains("the strongest turn came to");
        assert_eq!(is_told, log == &strong, "{answer}");
        answer["height_sd_m"].as_f64().unwrap()
    });
    assert!(widths[1] > 1.1 * widths[0], "{widths:?}");
    let state = scratch.path("state.json");
    for log in [&strong, &gentle] {
        let run = ["run", "--vehicle", &truck, "--csv", log, "--state", &state];
        let found = lines(&cg(&run).told(0, &[]));
        let mut notices = events(&found, "notice").into_iter();
        assert!(notices.any(|line| line["subject"] == "strong_turn"), "{found:?}");
        let sd_m = events(&found, "maneuver").pop().unwrap()["height_sd_m"].as_f64().unwrap();
        assert!((sd_m / widths[1] - 1.0).abs() < 0.01, "{sd_m} {widths:?}");
    }
}

/// The end of the range of a roll sensor, which the smaller turns do not reach plainly.
#[test]
fn turns_in_which_the_roll_angle_stood_still_are_told() {
    let scratch = Scratch::new();
    let truck = kraz();
    let drive = |name: &str, more: &[&str]| {
        let load = ["--payload-kg", "14000", "--height-m", "1.75", "--snr-db", "30", "--seed", "2"];
        scratch.simulate(name, &truck, &[&DRIVE[..], &load, more].concat())
    };
    let said = |log: &str| {
        let answer = estimate(log, &truck, &[]).answer();
        (messages(&answer).contains("stood still"), answer)
    };
    let (told, answer) = said(&drive("sound.csv", &[]));
    assert!(!told, "{answer}");
    for limit_rad in ["0.0144", "0.012", "0.01"] {
        let (told, answer) = said(&drive("clipped.csv", &["--roll-limit-rad", limit_rad]));
        assert!(told, "{limit_rad}: {answer}");
    }
}

/// A column of a log after a change that also knows the number of the row.
fn altered(log: &str, column: &str, change: impl Fn(usize, f64) -> f64) -> String {
    let text = changed(log, &SIGNALS, "", None);
    let mut rows = text.lines();
    let header = rows.next().unwrap();
    let place = header.split(',').position(|one| one == column).unwrap();
    let altered = rows.enumerate().map(|(number, row)| {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        cells[place] = change(number, cells[place].parse().unwrap()).to_string();
        cells.join(",")
    });
    header.to_owned() + "\n" + &altered.collect::<Vec<_>>().join("\n") + "\n"
}

/// A logger that writes 0 for missing samples, and sensors with steps as large as the signal: both commands say so.
/// Those of usual sensors are none: a level of 1 mm is a milliradian of roll.
#[test]
fn zeros_for_missing_samples_and_coarse_steps_are_told() {
    let scratch = Scratch::new();
    let truck = kraz();
    let load = ["--payload-kg", "14000", "--height-m", "1.75", "--snr-db", "30", "--seed", "3"];
    let log = scratch.simulate("log.csv", &truck, &[&DRIVE[..], &load].concat());
    let zeros =
        |every: usize| move |row: usize, x: f64| if (row * 7919) % 101 < every { 0.0 } else { x };
    let steps = |step: f64| move |_: usize, x: f64| (x / step).round() * step;
    let roll = |change: &dyn Fn(usize, f64) -> f64| altered(&log, "roll_rad", change);
    let lateral =
        |change: &dyn Fn(usize, f64) -> f64| altered(&log, "lateral_acceleration_mps2", change);
    for (text, said) in [
        (roll(&|_, x| x), ""),
        (roll(&zeros(5)), "of the roll is exactly 0"),
        (lateral(&zeros(20)), "of the lateral_acceleration is exactly 0"),
        (roll(&steps(1e-3)), ""),
        (lateral(&steps(0.02)), ""),
        (lateral(&steps(0.5)), "lateral_acceleration comes in steps of 5.00e-1 mps2"),
    ] {
        let faulty = scratch.file("faulty.csv", text);
        let answer = estimate(&faulty, &truck, &[]).answer();
        let run = lines(&cg(&["run", "--csv", &faulty, "--vehicle", &truck]));
        let last = run.iter().rfind(|line| line["event"] == "status").unwrap();
        for (all, of) in [(messages(&answer), &answer), (run_notices(&run), last)] {
            let is_told = ["exactly 0", "comes in steps"].iter().any(|one| all.contains(one));
            assert!(is_told != said.is_empty() && all.contains(said), "{said}: {all}");
            let has_no_height = said.contains("exactly 0");
            assert_eq!(of["status"], if has_no_height { "inconsistent" } else { "ok" }, "{all}");
        }
    }
}

/// Of a lane change within three seconds.
#[test]
fn rows_too_seldom_for_a_lane_change_are_told() {
    let (scratch, truck) = (Scratch::new(), kraz());
    for (rate_hz, is_told) in [("2.5", true), ("10", false)] {
        let log = scratch.path(&format!("{rate_hz}.csv"));
        let of = ["--maneuver", "lane-change", "--payload-kg", "12000", "--rate-hz", rate_hz];
        cg(&[&["simulate", "--vehicle", &truck, "-o", &log], &of[..]].concat()).done();
        let answer = estimate(&log, &truck, &[]).answer();
        let run = lines(&cg(&["run", "--csv", &log, "--vehicle", &truck]));
        for all in [messages(&answer), run_notices(&run)] {
            assert_eq!(all.contains("changes so fast"), is_told, "{rate_hz}: {all}");
            assert!(!all.contains("comes in steps"), "{all}");
        }
    }
}

/// Fourteen curves are hardly a test track; one step may be, and who says so knows it.
#[test]
fn roads_of_which_nothing_is_said_count_as_flat_and_that_is_told() {
    let told = |log: &str, more: &[&str]| {
        let answer = estimate(&fixture(log), &kraz(), more).answer();
        assert_eq!(answer["status"], "ok", "{answer}");
        messages(&answer).contains("nothing says on which roads")
    };
    let drive = "logs/F_drive1_p15_h155.csv.gz";
    assert!(told(drive, &[]));
    assert!(!told(drive, &["--road", "flat"]));
    assert!(!told("logs/A_p20_h190_v50_L.csv", &[]));
    // Where a bank of the road is in the interval there is nothing to assume.
    let answer = estimate(&fixture(drive), &kraz(), &["--road", "public"]).answer();
    assert!(!messages(&answer).contains("nothing says"), "{answer}");
}

/// 20 t in place of the 28.7 t of the log; 28 t differ by less than a load does.
#[test]
fn a_mass_that_is_given_and_not_that_of_the_log_is_told() {
    for (given_kg, is_told) in [("20000", true), ("28000", false)] {
        let more = ["--trailer-mass-kg", given_kg];
        let answer = estimate(&fixture("logs/A_p20_h190_v50_L.csv"), &kraz(), &more).answer();
        let expected = format!("{given_kg} kg, but the log has 28684 kg");
        assert_eq!(messages(&answer).contains(&expected), is_told, "{answer}");
    }
}
