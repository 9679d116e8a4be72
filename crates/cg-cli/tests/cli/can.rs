//! CAN logs as they occur in practice: candump formats, several buses, slope sensors with state
//! bits, impossible masses, missing or slow signals.

use std::fmt::Write as _;

use serde_json::Value;

use crate::common::{Run, Scratch, cg, cg_fed, estimate, fixture};
use crate::run::{Drive, drive, events, last_height, lines};

/// The log with some lines changed or removed.
fn changed(drive: &Drive, name: &str, change: impl FnMut(&str) -> Option<String>) -> String {
    let text = std::fs::read_to_string(&drive.candump).unwrap();
    let changed: Vec<String> = text.lines().filter_map(change).collect();
    let path = drive.path(name);
    std::fs::write(&path, changed.join("\n") + "\n").unwrap();
    path
}

fn notices(lines: &[Value], subject: &str) -> Vec<String> {
    let of = |line: &&&Value| line["subject"] == subject;
    let text = |line: &&Value| line["message"].as_str().unwrap().to_owned();
    events(lines, "notice").iter().filter(of).map(text).collect()
}

fn last_status(lines: &[Value]) -> Value {
    (*events(lines, "status").last().unwrap()).clone()
}

/// Time stamp in µs, identifier and data of a compact line.
fn parts(line: &str) -> (u64, &str, &str) {
    let (time, rest) = line[1..].split_once(") can0 ").unwrap();
    let (identifier, data) = rest.split_once('#').unwrap();
    (time.replace('.', "").parse().unwrap(), identifier, data)
}

/// A line in candump's plain form.
fn plain(stamp: &str, line: &str) -> String {
    let (_, identifier, data) = parts(line);
    let bytes: Vec<&str> = (0..data.len() / 2).map(|k| &data[2 * k..2 * k + 2]).collect();
    format!(" {stamp} can0  {identifier}   [{}]  {}", bytes.len(), bytes.join(" "))
}

/// The name of a log, and its time stamps.
type Stamped<'a> = (&'a str, Box<dyn FnMut(u64) -> String>);

/// The drive with the plain time stamps of `-ta`, `-td`, `-tz` and `-tA` gives the same result to
/// the last bit.
#[test]
fn every_form_of_candump_gives_the_same_height() {
    let drive = drive();
    let expected = last_height(&lines(&drive.replay(&drive.candump, &[]).done()));
    let seconds = |us: u64| format!("({:03}.{:06}) ", us / 1_000_000, us % 1_000_000);
    let mut last_us = 0;
    let mut stamps: [Stamped<'_>; 4] = [
        ("a.log", Box::new(move |us| seconds(us + 1_700_000_000_000_000))),
        ("z.log", Box::new(seconds)),
        ("d.log", Box::new(move |us| seconds(us - std::mem::replace(&mut last_us, us)))),
        (
            "A.log",
            Box::new(|us| {
                let (seconds, micros) = (us / 1_000_000, us % 1_000_000);
                format!("(2024-02-29 23:{:02}:{:02}.{micros:06}) ", 50 + seconds / 60, seconds % 60)
            }),
        ),
    ];
    for (name, stamp) in &mut stamps {
        let log = changed(&drive, name, |line| Some(plain(&stamp(parts(line).0), line)));
        let height = last_height(&lines(&drive.replay(&log, &[]).done()));
        assert!((height / expected - 1.0).abs() < 1e-12, "{name}: {height}");
    }
}

#[test]
fn a_log_without_time_stamps_is_refused_with_the_flag_that_mends_it() {
    let drive = drive();
    let log = changed(&drive, "none.log", |line| Some(plain("", line)));
    drive.replay(&log, &[]).told(2, &["none.log", "line 1", "no time stamp", "candump -L"]);
    let estimate = cg(&["estimate", &log, "--vehicle", &drive.truck]);
    estimate.told(2, &["none.log", "line 1", "candump -L"]);
}

/// Error frames are counted and reported once.
#[test]
fn error_frames_of_a_log_are_counted() {
    let drive = drive();
    let mut count = 0;
    let log = changed(&drive, "errors.log", |line| {
        count += 1;
        let error = "(1.000000) can0 20000080#0000000000000000\n";
        Some(if count == 100 || count == 200 { error.to_owned() + line } else { line.to_owned() })
    });
    let found = lines(&drive.replay(&log, &[]).done());
    assert_eq!(last_status(&found)["error_frames"], 2);
    let told = notices(&found, "source");
    assert!(told.len() == 1 && told[0].contains("line 100: an error frame"), "{told:?}");
}

/// SSI2 with other compensation bits: 7.5 and 7.6; they are 11 00 1111 in the simulated log.
fn compensated(drive: &Drive, name: &str, byte: &str) -> String {
    changed(drive, name, |line| {
        let Some((head, data)) = line.split_once("0CF029E4#") else { return Some(line.to_owned()) };
        assert_eq!(&data[12..14], "CF");
        Some(format!("{head}0CF029E4#{}{byte}{}", &data[..12], &data[14..]))
    })
}

/// A roll angle that is marked as tilt gives no height. If an option declares it a roll angle, the
/// height is that of the drive.
#[test]
fn the_compensation_bits_of_a_slope_sensor_count() {
    let drive = drive();
    let expected = last_height(&lines(&drive.replay(&drive.candump, &[]).done()));
    let dbc = fixture("can/j1939.dbc");
    let same = |run: Run| (last_height(&lines(&run.done())) / expected - 1.0).abs() < 1e-9;
    let off = compensated(&drive, "off.log", "DF");
    assert_eq!(drive.replay(&off, &[]).code, Some(1));
    assert!(same(drive.replay(&off, &["--roll-compensated", "yes"])));
    assert!(same(drive.replay(&off, &["--roll-compensated", "inverted-bit"])));
    assert!(same(drive.replay(&off, &["--dbc", &dbc, "--signal", "roll=SSI2.RollAngle"])));
    assert_eq!(drive.replay(&drive.candump, &["--roll-compensated", "no"]).code, Some(1));
    // The same roll angle mapped as a tilt: the J1939 roll angle is not used in addition.
    let as_tilt = ["--dbc", &dbc, "--signal", "tilt=SSI2.RollAngle"];
    assert_eq!(drive.replay(&drive.candump, &as_tilt).code, Some(1));

    let unsaid = lines(&drive.replay(&compensated(&drive, "unsaid.log", "FF"), &[]));
    let told = notices(&unsaid, "roll");
    assert!(told.len() == 1 && told[0].contains("--roll-compensated yes"), "{told:?}");
    let unsaid = drive.path("unsaid.log");
    let given = drive.replay(&unsaid, &["--roll-compensated", "yes"]);
    assert!(notices(&lines(&given), "roll").is_empty() && same(given));

    let wrong = lines(&drive.replay(&compensated(&drive, "wrong.log", "8F"), &[]));
    let status = last_status(&wrong);
    assert!(status["values_in_error"].as_u64() > Some(1000) && status["samples"] == 0);
    assert!(status["missing"].as_array().unwrap().contains(&Value::from("roll")));
    let degraded = drive.replay(&compensated(&drive, "degraded.log", "4F"), &[]);
    assert!(last_status(&lines(&degraded))["values_degraded"].as_u64() > Some(1000));
    assert!(same(degraded));
}

#[test]
fn the_nominal_mass_is_told() {
    let drive = drive();
    let weight = |line: &str| line.contains("18FEEAC8#");
    let log = changed(&drive, "unweighed.log", |line| (!weight(line)).then(|| line.to_owned()));
    let found = lines(&drive.replay(&log, &[]));
    let told = notices(&found, "mass");
    assert!(told.len() == 1 && told[0].contains("from the vehicle file"), "{told:?}");
    let status = last_status(&found);
    assert_eq!(status["trailer_mass_source"], "nominal");
    assert_eq!(status["missing"], serde_json::json!(["trailer_mass"]));
    let kg = status["trailer_mass_kg"].as_f64().unwrap();
    assert!(told[0].contains(&format!("{kg:.0} kg")), "{told:?}");
    // It is reported before the first maneuver uses the mass.
    let place = |event: &str| found.iter().position(|line| line["event"] == event).unwrap();
    assert!(place("notice") < place("maneuver"));

    let given = lines(&drive.replay(&log, &["--trailer-mass-kg", "19000"]).done());
    assert!(notices(&given, "mass").is_empty());
    let status = last_status(&given);
    assert_eq!(status["trailer_mass_source"], "given");
    assert_eq!(status["missing"], serde_json::json!([]));
    let weighed = last_status(&lines(&drive.replay(&drive.candump, &[]).done()));
    assert_eq!(weighed["trailer_mass_source"], "signal");
    // A CSV drive without the column.
    let text = std::fs::read_to_string(&drive.csv).unwrap();
    std::fs::write(drive.path("no.csv"), text.replace("trailer_mass_kg", "other")).unwrap();
    let csv = lines(&cg(&["run", "--vehicle", &drive.truck, "--csv", &drive.path("no.csv")]));
    assert_eq!(notices(&csv, "mass").len(), 1);
    assert_eq!(last_status(&csv)["missing"], serde_json::json!(["trailer_mass"]));
}

/// A column of a CSV drive that ends is a signal that is missing, as on a bus.
#[test]
fn a_column_that_ends_is_missing() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.csv).unwrap();
    let head = text.lines().find(|line| line.starts_with("time_s")).unwrap();
    let roll = head.split(',').position(|name| name == "roll_rad").unwrap();
    let rows = text.lines().skip_while(|line| !line.starts_with("time_s")).map(|row| {
        let mut cells: Vec<&str> = row.split(',').collect();
        if cells[0].parse::<f64>().is_ok_and(|time_s| time_s > 20.0) {
            cells[roll] = "";
        }
        cells.join(",") + "\n"
    });
    std::fs::write(drive.path("ends.csv"), rows.collect::<String>()).unwrap();
    let found = lines(&cg(&["run", "--vehicle", &drive.truck, "--csv", &drive.path("ends.csv")]));
    let status = last_status(&found);
    assert_eq!(status["missing"], serde_json::json!(["roll"]));
    assert!(!status["present"].as_array().unwrap().contains(&Value::from("roll")), "{status}");
    let states = events(&found, "state");
    assert!(states.iter().any(|one| one["missing"] == serde_json::json!(["roll"])), "{states:?}");
}

/// The weight of the trailer on the bus is a sensor with 5 %, a column of a log is exact, and what the
/// vehicle file and the option say counts more.
#[test]
fn the_mass_has_the_standard_deviation_of_its_scale() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.truck).unwrap();
    let exact = drive.path("exact.toml");
    std::fs::write(&exact, format!("{text}[sensors.mass]\nvehicle_weight_sd = 0.0\n")).unwrap();
    let run = |truck: &str, log: [&str; 2], more: &[&str]| {
        let arguments = [&["run", "--vehicle", truck][..], &log, more].concat();
        last_status(&lines(&cg(&arguments)))
    };
    let (frames, rows) = (["--candump", drive.candump.as_str()], ["--csv", drive.csv.as_str()]);
    let sd = |status: &Value| status["height_sd_m"].as_f64().unwrap();
    let bus = run(&drive.truck, frames, &[]);
    assert_eq!(bus["trailer_mass_source"], "signal");
    assert_eq!(bus["trailer_mass_scale"], "vehicle-weight");
    let expected_kg = 0.05 * bus["trailer_mass_kg"].as_f64().unwrap();
    assert!((bus["trailer_mass_sd_kg"].as_f64().unwrap() - expected_kg).abs() < 1e-6, "{bus}");
    let column = run(&drive.truck, rows, &[]);
    assert_eq!(column["trailer_mass_scale"], "weighed");
    assert_eq!(column["trailer_mass_sd_kg"], 0.0);
    let without = run(&exact, frames, &[]);
    assert_eq!(without["trailer_mass_sd_kg"], 0.0);
    assert!(sd(&bus) > sd(&without), "{bus} {without}");
    let given = run(&drive.truck, frames, &["--trailer-mass-sd-kg", "100"]);
    assert_eq!(given["trailer_mass_sd_kg"], 100.0);
    assert!(sd(&given) < sd(&bus) && sd(&given) > sd(&without), "{given}");

    // The same for recorded frames, with a message.
    let of_log = |truck: &str| estimate(&drive.candump, truck, &[]).done().answer();
    let (bus, without) = (of_log(&drive.truck), of_log(&exact));
    assert!(sd(&bus) > sd(&without), "{bus} {without}");
    let message = format!(
        "from the trailer's weight on the bus; its standard deviation of {expected_kg:.0} kg"
    );
    assert!(bus["messages"].to_string().contains(&message), "{bus}");
    assert!(!without["messages"].to_string().contains("standard deviation of"), "{without}");
}

/// A scale that shows 0 kg (0 steps of 2 kg) is reported once. The axle load is used instead, or
/// without it the mass of the vehicle file.
#[test]
fn a_scale_that_cannot_be_right_is_not_trusted() {
    let drive = drive();
    let weigh = |name: &str, lines: &'static str| {
        changed(&drive, name, |line| match line.split_once("18FEEAC8#") {
            Some((head, _)) => Some(lines.replace("HEAD", head)),
            None => Some(line.to_owned()),
        })
    };
    for (raw, kg) in [("0000", "0"), ("FAFA", "128500")] {
        let text = format!("HEAD18FEEAC8#FFFFFF{raw}FFFFFF");
        let log = weigh("zero.log", text.leak());
        let found = lines(&drive.replay(&log, &[]));
        let told = notices(&found, "trailer_mass");
        assert!(told.len() == 1, "{told:?}");
        assert!(told[0].contains(&format!("trailer_mass_kg {kg} is impossible")), "{told:?}");
        let status = last_status(&found);
        assert_eq!(status["trailer_mass_source"], "nominal");
        assert!(status["values_implausible"].as_u64() > Some(100));
        assert_eq!(notices(&found, "mass").len(), 1);
    }
    // 7000 steps of 2 kg on the axles.
    let log = weigh("axles.log", "HEAD18FEEAC8#FFFFFF0000FFFFFF\nHEAD18FEC4C8#FFFFFFFF581BFFFF");
    let found = lines(&drive.replay(&log, &[]));
    assert!(notices(&found, "mass").is_empty());
    let status = last_status(&found);
    assert_eq!(status["trailer_mass_source"], "signal");
    assert!(status["trailer_mass_kg"].as_f64() > Some(14_000.0), "{status}");
}

#[test]
fn signals_that_never_come_are_missing() {
    let drive = drive();
    for (group, missing) in [
        ("18FEF100#", "speed"),
        ("0CF029E4#", "roll"),
        ("18F0090B#", "steering_wheel"),
        ("18F0090B#", "lateral_acceleration"),
    ] {
        let log =
            changed(&drive, "less.log", |line| (!line.contains(group)).then(|| line.to_owned()));
        let status = last_status(&lines(&drive.replay(&log, &[])));
        let found = status["missing"].as_array().unwrap();
        assert!(found.contains(&Value::from(missing)), "{status}");
    }
    let whole = last_status(&lines(&drive.replay(&drive.candump, &[]).done()));
    assert_eq!(whole["missing"], serde_json::json!([]));
}

/// One roll angle per second gives one message.
#[test]
fn a_slow_roll_signal_is_diagnosed_once() {
    let drive = drive();
    let mut next_us = 0;
    let log = changed(&drive, "slow.log", |line| {
        let (us, identifier, _) = parts(line);
        if identifier == "0CF029E4" && us < next_us {
            return None;
        }
        if identifier == "0CF029E4" {
            next_us = us + 1_000_000;
        }
        Some(line.to_owned())
    });
    let text = std::fs::read_to_string(&drive.csv).unwrap();
    let data = text.lines().filter(|line| !line.starts_with('#'));
    let rows = data.enumerate().filter(|(k, _)| *k == 0 || *k % 100 == 1);
    let slow: Vec<&str> = rows.map(|(_, line)| line).collect();
    std::fs::write(drive.path("slow.csv"), slow.join("\n") + "\n").unwrap();
    let csv = drive.path("slow.csv");
    let of_csv = cg(&["run", "--vehicle", &drive.truck, "--csv", &csv]);
    for (run, signal) in [(drive.replay(&log, &[]), "roll_to_gravity"), (of_csv, "roll")] {
        assert_eq!(run.code, Some(1));
        let found = lines(&run);
        let told = notices(&found, signal);
        assert!(told.len() == 1 && told[0].contains("every 1.00 s"), "{told:?}");
        let others = found.iter().filter(|line| line["event"] != "status").count();
        assert!(others < 12, "{others}");
    }
}

/// A second bus carries the roll angle of another truck.
#[test]
fn a_log_of_two_buses_is_narrowed_to_one() {
    let drive = drive();
    let expected = last_height(&lines(&drive.replay(&drive.candump, &[]).done()));
    let log = changed(&drive, "two.log", |line| {
        let other = line.replace(") can0 ", ") can1 ");
        let still = match line.split_once("0CF029E4#") {
            // Raw 8192000 means a roll angle of zero.
            Some((head, _)) => format!("{head}0CF029E4#FFFFFF00007DCFFF"),
            None => line.to_owned(),
        };
        Some(format!("{still}\n{other}"))
    });
    let one = lines(&drive.replay(&log, &["--bus", "can1"]).done());
    assert!((last_height(&one) / expected - 1.0).abs() < 1e-12);
    assert!(notices(&one, "source").is_empty());
    let both = lines(&drive.replay(&log, &[]));
    let told = notices(&both, "source");
    assert!(told.len() == 1 && told[0].contains("can0, can1") && told[0].contains("--bus"));
    assert!(last_status(&both)["values_of_other_sources"].as_u64() > Some(10_000));
    drive.replay(&log, &["--bus", "can7"]).told(2, &["`can7`", "can0, can1", "--bus"]);
    let estimate = |more: &[&str]| {
        let fixed = ["estimate", &log, "--vehicle", &drive.truck, "--format", "json"];
        cg(&[&fixed, more].concat())
    };
    let answer = estimate(&["--bus", "can1"]).done().answer();
    assert!((answer["height_m"].as_f64().unwrap() / expected - 1.0).abs() < 1e-12);
    let messages = estimate(&[]).answer()["messages"].to_string();
    assert!(messages.contains("can0, can1"), "{messages}");
}

/// `cg estimate` and `cg calibrate` accept a candump log instead of CSV and process it like `cg
/// run`.
#[test]
fn candump_logs_are_estimated_and_calibrated_from() {
    let drive = drive();
    let expected = last_height(&lines(&drive.replay(&drive.candump, &[]).done()));
    let estimate = |log: &str| {
        ["estimate", log, "--vehicle", &drive.truck, "--format", "json"].map(str::to_owned)
    };
    let arguments = estimate(&drive.candump);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let answer = cg(&arguments).done().answer();
    assert!((answer["height_m"].as_f64().unwrap() / expected - 1.0).abs() < 1e-12, "{answer}");
    let arguments = estimate("-");
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let fed = cg_fed(&arguments, &std::fs::read(&drive.candump).unwrap()).done().answer();
    assert_eq!(fed["height_m"], answer["height_m"]);
    // The options for frames are those of `cg run`.
    let off = compensated(&drive, "off.log", "DF");
    let arguments = estimate(&off);
    let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    assert_eq!(cg(&arguments).code, Some(1));
    arguments.extend(["--roll-compensated", "yes"]);
    assert_eq!(cg(&arguments).done().answer()["height_m"], answer["height_m"]);

    let output = drive.path("c.toml");
    let run = format!("{}=1.9", drive.candump);
    let calibrate = ["calibrate", "--vehicle", &drive.truck, "--run", &run, "-o", &output];
    let calibrated = cg(&calibrate).done();
    assert!(calibrated.out.contains("lateral"), "{}", calibrated.out);
}

/// Invalid rows among valid ones, also in a gzip log. They are reported with line and column and
/// counted, and the height is that of the valid rows.
#[test]
fn bad_rows_do_not_end_a_drive() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.csv).unwrap();
    let replay = |log: &str| cg(&["run", "--vehicle", &drive.truck, "--csv", log]);
    let expected = last_height(&lines(&replay(&drive.csv).done()));
    let fields = text.lines().last().unwrap().split(',').count();
    let mut bad = String::new();
    for (k, line) in text.lines().enumerate() {
        writeln!(bad, "{line}").unwrap();
        if k % 1000 == 500 {
            writeln!(bad, "{}", vec!["x"; fields].join(",")).unwrap();
            writeln!(bad, "1.0").unwrap();
        }
    }
    let count = 2 * (text.lines().count() as u64 - 500).div_ceil(1000);
    std::fs::write(drive.path("bad.csv"), bad).unwrap();
    let found = lines(&replay(&drive.path("bad.csv")).done());
    assert!((last_height(&found) / expected - 1.0).abs() < 1e-12);
    let told = notices(&found, "source");
    assert!(told.len() == 1 && told[0].contains("line 502, column 1 `time_s`"), "{told:?}");
    assert_eq!(last_status(&found)["malformed"], count);
    // A header that cannot be read is an error.
    std::fs::write(drive.path("head.csv"), "what,is,this\n1,2,3\n").unwrap();
    replay(&drive.path("head.csv")).told(2, &["head.csv", "time_s"]);
}

/// A cell of 1e308 loses only its own value: it is reported, counted and absent.
#[test]
fn an_impossible_number_costs_its_own_cell() {
    let drive = drive();
    let text = std::fs::read_to_string(&drive.csv).unwrap();
    let header = text.lines().find(|line| !line.starts_with('#')).unwrap();
    let roll = header.split(',').position(|name| name == "roll_rad").unwrap();
    let damaged: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if k == 2000 {
                cells[roll] = "1e308";
            }
            cells.join(",")
        })
        .collect();
    let log = drive.path("damaged.csv");
    std::fs::write(&log, damaged.join("\n") + "\n").unwrap();
    let run = |log: &str| lines(&cg(&["run", "--vehicle", &drive.truck, "--csv", log]).done());
    let (whole, found) = (run(&drive.csv), run(&log));
    // One row of 12 000.
    assert!((last_height(&found) / last_height(&whole) - 1.0).abs() < 1e-3);
    let told = notices(&found, "roll");
    assert!(told.len() == 1 && told[0].contains("line 2001: roll_rad 1"), "{told:?}");
    assert_eq!(last_status(&found)["values_implausible"], 1);
    let estimate = ["estimate", &log, "--vehicle", &drive.truck, "--format", "json"];
    let answer = cg(&estimate).done().answer();
    assert!(answer["messages"].to_string().contains("line 2001: roll_rad 1"), "{answer}");
}

#[test]
fn flags_of_frames_are_refused_where_there_are_none() {
    let drive = drive();
    let dbc = fixture("can/j1939.dbc");
    let csv = ["run", "--vehicle", &drive.truck, "--csv", &drive.csv];
    for (more, parts) in [
        (
            &["--dbc", &dbc, "--signal", "roll=SSI2.RollAngle"][..],
            ["--dbc is for CAN", "--candump"],
        ),
        (&["--source-of", "roll=1"], ["--source-of is for CAN", "--candump"]),
        (&["--bus", "can0"], ["--bus is for CAN", "--candump"]),
        (&["--roll-compensated", "yes"], ["--roll-compensated is for CAN", "--candump"]),
        (&["--roll-compensated", "maybe"], ["maybe", "inverted-bit"]),
    ] {
        cg(&[&csv, more].concat()).told(2, &parts);
    }
    let can = ["run", "--vehicle", &drive.truck, "--can", "can0", "--bus", "can1"];
    cg(&can).told(2, &["--bus selects a bus of a log", "--can"]);
    let swapped = ["run", "--vehicle", &drive.truck, "--csv", &drive.candump];
    cg(&swapped).told(2, &["CAN frames", "--candump instead of --csv"]);
}

/// The lateral acceleration of VDC2 is another quantity if its device compensates gravity.
#[test]
fn vdc2_is_what_one_says() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(fixture("vehicles/euro.toml")).unwrap();
    let truck = scratch.file("truck.toml", "steering_ratio = 20.0\n".to_owned() + &text);
    let log = scratch.simulate("drive.log", &truck, &["--road", "rural"]);
    for (word, quantity) in [
        ("specific-force", "tractor_lateral_specific_force"),
        ("acceleration", "lateral_acceleration"),
    ] {
        let run = cg(&["run", "--candump", &log, "--vehicle", &truck, "--vdc2", word]);
        let status = last_status(&lines(&run));
        let present: Vec<&str> =
            status["present"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        let of_vdc2 = |one: &&&str| one.contains("lateral_");
        assert_eq!(present.iter().filter(of_vdc2).collect::<Vec<_>>(), [&quantity], "{word}");
    }
}
