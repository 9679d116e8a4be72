//! Simulation of logs with known truth, and estimation from them.

use serde_json::Value;

use crate::common::{Scratch, baseline, cg, estimate, fixture, height_m, kraz};

const MANEUVERS: [&str; 6] =
    ["rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"];

/// Relative error of the height from the steer channel for each maneuver's noise-free log.
fn errors(vehicle: &str, plant: &str) -> Vec<(&'static str, f64)> {
    let scratch = Scratch::new();
    MANEUVERS
        .map(|maneuver| {
            let truth = scratch.path("truth.json");
            let more = ["--maneuver", maneuver, "--plant", plant, "--truth", &truth];
            let log = scratch.simulate("log.csv", vehicle, &more);
            let truth: Value = serde_json::from_slice(&std::fs::read(truth).unwrap()).unwrap();
            let answer = estimate(&log, vehicle, &["--channel", "steer"]).done().answer();
            assert_eq!(answer["status"], "ok", "{maneuver}: {answer}");
            let error = height_m(&answer) / height_m(&truth) - 1.0;
            println!("{plant} {maneuver}: {:+.6} %", 100.0 * error);
            (maneuver, error)
        })
        .to_vec()
}

#[test]
fn a_log_of_the_linear_plant_gives_back_its_height_within_one_per_cent() {
    for vehicle in [baseline(), kraz()] {
        for (maneuver, error) in errors(&vehicle, "linear") {
            // The requirement. Order 5 does not represent everything that orders 18 and 20 do.
            // Without noise, the free dynamics compensate for this, even in the lane change, which
            // has no steady part.
            assert!(error.abs() < 0.01, "{vehicle} {maneuver}: {error:e}");
        }
    }
}

#[test]
fn a_log_of_the_reduced_plant_gives_back_its_height_almost_exactly() {
    for vehicle in [baseline(), kraz()] {
        for (maneuver, error) in errors(&vehicle, "reduced") {
            // The plant is the model of the prior. The remaining error is due to sampling: (dt w)^2
            // / 12 of the part of the input that a line between means does not follow, with 0.08 s
            // and 1 rad/s.
            assert!(error.abs() < 5.4e-4, "{vehicle} {maneuver}: {error:e}");
        }
    }
}

#[test]
fn the_height_and_mass_that_were_asked_for_are_found() {
    let scratch = Scratch::new();
    let load = ["--height-m", "2.2", "--payload-kg", "20000", "--maneuver", "steady-turn"];
    let log = scratch.simulate("log.csv", &kraz(), &load);
    let answer = estimate(&log, &kraz(), &["--channel", "steer"]).done().answer();
    assert!((height_m(&answer) / 2.2 - 1.0).abs() < 0.01, "{answer}");
    assert_eq!(answer["trailer_mass_kg"], 28_684.0);
}

/// The truth says where the payload stands, by default where the vehicle file says. Farther to the rear
/// the trailer rolls more per steer angle.
#[test]
fn the_payload_stands_where_it_was_asked_for() {
    let scratch = Scratch::new();
    let path = scratch.path("truth.json");
    let truth = |more: &[&str]| -> Value {
        let base = ["--maneuver", "sine", "--payload-kg", "20000", "--truth", &path];
        scratch.simulate("log.csv", &kraz(), &[&base[..], more].concat());
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap()
    };
    let (usual, rear) = (truth(&[]), truth(&["--payload-behind-hitch-m", "6.26"]));
    assert_eq!([&usual["payload_behind_hitch_m"], &usual["payload_left_m"]], [5.96, 0.0]);
    assert_eq!(rear["payload_behind_hitch_m"], 6.26);
    let ratio = |truth: &Value| truth["ratio"].as_f64().unwrap();
    let change = ratio(&rear) / ratio(&usual) - 1.0;
    assert!((0.005..0.015).contains(&change), "{change}");
}

fn bytes(path: &str) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let scratch = Scratch::new();
    let noisy = |maneuver: &str, name: &str, seed: &str| {
        let more = ["--maneuver", maneuver, "--snr-db", "20", "--duration-s", "30", "--seed", seed];
        bytes(&scratch.simulate(name, &kraz(), &more))
    };
    for maneuver in ["sine", "drive"] {
        for name in ["log.csv", "log.csv.gz"] {
            assert_eq!(noisy(maneuver, name, "7"), noisy(maneuver, name, "7"));
            assert_ne!(noisy(maneuver, name, "7"), noisy(maneuver, name, "8"));
        }
    }
}

#[test]
fn the_truth_stands_at_the_head_of_the_log_and_is_not_read() {
    let scratch = Scratch::new();
    let truth = scratch.path("truth.json");
    let more = ["--maneuver", "steady-turn", "--snr-db", "20", "--truth", &truth];
    let log = scratch.simulate("log.csv", &kraz(), &more);
    let text = std::fs::read_to_string(&log).unwrap();
    // Compared as text: the digits are the same in both places.
    let json = std::fs::read_to_string(truth).unwrap();
    let truth: Vec<&str> = json.lines().filter_map(|line| line.strip_prefix("  ")).collect();
    assert!(truth.len() >= 7, "{json}");
    for (line, entry) in text.lines().zip(&truth) {
        let (key, value) = entry.trim_end_matches(',').split_once(": ").unwrap();
        assert_eq!(line, format!("# truth {} = {value}", key.trim_matches('"')));
    }
    assert!(text.lines().nth(truth.len()).unwrap().starts_with("time_s,steer_rad,roll_rad"));

    let right = estimate(&log, &kraz(), &[]).done().out;
    let body: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    let lies = "# truth height_m = 9.9\n# truth trailer_mass_kg = 1\n# truth speed_mps = 99\n";
    for head in [lies, ""] {
        scratch.file("log.csv", format!("{head}{}\n", body.join("\n")));
        // The answer has the same bytes, so the comments at the head of the log have no effect.
        assert_eq!(estimate(&log, &kraz(), &[]).done().out, right);
    }
}

#[test]
fn a_simulation_that_cannot_be_written_leaves_nothing() {
    let scratch = Scratch::new();
    let (log, nowhere) = (scratch.path("log.csv"), scratch.path("nowhere/file.csv"));
    let folder = scratch.path("folder");
    std::fs::create_dir(&folder).unwrap();
    let truth = scratch.path("truth.json");
    for (log, truth, parts) in [
        (&nowhere, &truth, ["file.csv", "cannot be written", "check the folder"]),
        (&log, &nowhere, ["file.csv", "cannot be written", "check the folder"]),
        (&log, &folder, ["folder", "is a folder", "give --truth a file"]),
        (&folder, &truth, ["folder", ".csv, .csv.gz or .log", "--output"]),
    ] {
        let vehicle = kraz();
        let simulate = ["simulate", "--vehicle", &vehicle, "--maneuver", "sine"];
        cg(&[&simulate[..], &["-o", log, "--truth", truth]].concat()).refused(&parts);
        assert_eq!(scratch.names(), ["folder"]);
    }
}

#[test]
fn a_simulation_that_fails_keeps_the_log_that_was_there() {
    let scratch = Scratch::new();
    let log = scratch.simulate("log.csv", &kraz(), &["--maneuver", "sine"]);
    let before = bytes(&log);
    let vehicle = kraz();
    let simulate = ["simulate", "--vehicle", &vehicle, "--maneuver", "sine", "-o", &log];
    // The truck rolls over after some seconds.
    let plant = ["--plant", "nonlinear", "--steer-rad", "0.4", "--duration-s", "10"];
    cg(&[&simulate[..], &plant].concat()).refused(&["the vehicle rolled over at"]);
    assert_eq!((scratch.names(), bytes(&log)), (vec!["log.csv".to_owned()], before));
}

/// A candump log contains the frames of the same drive as the CSV log. Its truth is only in the
/// JSON file.
#[test]
fn a_log_of_can_frames_is_the_same_drive() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(kraz()).unwrap();
    let vehicle = scratch.file("v.toml", format!("steering_ratio = 20.0\n{text}"));
    let truth = scratch.path("truth.json");
    let more = ["--maneuver", "rounded-step", "--truth", &truth, "--duration-s", "10"];
    let csv = scratch.simulate("drive.csv", &vehicle, &more[..2]);
    let log = scratch.simulate("drive.log", &vehicle, &more);
    let frames = std::fs::read_to_string(log).unwrap();
    let of = |group: &str| frames.lines().filter(|line| line.contains(group)).count();
    // 1001 samples at 100 Hz; the speed ten times per second, the trailer mass once.
    assert_eq!((of("18F0090B#"), of("0CF029E4#")), (1001, 1001));
    assert_eq!((of("18FEF100#"), of("18FEEAC8#")), (101, 11));
    assert!(frames.lines().all(|line| line.starts_with('(') && line.contains(" can0 ")));
    assert!(std::fs::read_to_string(truth).unwrap().contains("height_m"));
    // The last roll angle of the frames equals that of the CSV log at ten seconds, to half a bit.
    let last = frames.lines().rev().find(|line| line.contains("0CF029E4#")).unwrap();
    let bytes = &last[last.len() - 16..];
    let byte = |k: usize| u32::from_str_radix(&bytes[2 * k..2 * k + 2], 16).unwrap();
    let raw = byte(3) | (byte(4) << 8) | (byte(5) << 16);
    let roll_rad = (f64::from(raw) / 32768.0 - 250.0).to_radians();
    let rows = std::fs::read_to_string(csv).unwrap();
    let row = rows.lines().find(|line| line.starts_with("10,")).unwrap();
    let expected: f64 = row.split(',').nth(2).unwrap().parse().unwrap();
    assert!((roll_rad - expected).abs() <= (0.5_f64 / 32768.0).to_radians(), "{roll_rad} {row}");
}

/// Without a steering ratio, the other signals are written, and a message reports it.
#[test]
fn a_log_of_can_frames_without_a_steering_ratio_says_so() {
    let scratch = Scratch::new();
    let log = scratch.path("drive.log");
    let arguments = ["simulate", "--vehicle", &kraz(), "--maneuver", "sine", "-o", &log];
    cg(&arguments).told(0, &["no steering angle", "no steering_ratio"]);
    assert_eq!(scratch.names(), ["drive.log"]);
}

#[test]
fn a_driver_follows_a_path_and_the_truth_tells_everything_added() {
    let scratch = Scratch::new();
    let truth = scratch.path("truth.json");
    for more in [
        &["--maneuver", "steady-turn", "--turn-deg", "-60", "--radius-m", "120"][..],
        &["--maneuver", "lane-change", "--gate-m", "30", "--speed-mps", "20"],
        &["--maneuver", "ramp", "--to-rollover"],
        &["--maneuver", "drive", "--duration-s", "60", "--speed-change", "0.2"],
        &["--maneuver", "rounded-step", "--step-rate", "1", "--duration-s", "8"],
    ] {
        let sensors = [
            "--plant",
            "nonlinear",
            "--truth",
            &truth,
            "--snr-db",
            "20",
            "--roll-offset-rad",
            "0.01",
            "--steer-offset-rad",
            "-0.001",
            "--quantisation-rad",
            "0.00087",
            "--delay-s",
            "0.05",
            "--inclinometer",
            "--jitter-s",
            "0.002",
            "--drop-out",
            "0.1",
        ];
        let place = ["--payload-behind-hitch-m", "5.8", "--payload-left-m", "-0.1"];
        let log = scratch.simulate("log.csv", &kraz(), &[more, &sensors[..], &place].concat());
        let text = std::fs::read_to_string(&log).unwrap();
        assert!(text.contains("\ntime_s,steer_rad,tilt_rad,"), "{more:?}");
        let truth: Value = serde_json::from_slice(&std::fs::read(&truth).unwrap()).unwrap();
        for (key, value) in [
            ("snr_db", 20.0),
            ("roll_offset_rad", 0.01),
            ("steer_offset_rad", -0.001),
            ("quantisation_rad", 0.00087),
            ("delay_s", 0.05),
            ("jitter_s", 0.002),
            ("drop_out", 0.1),
            ("payload_behind_hitch_m", 5.8),
            ("payload_left_m", -0.1),
        ] {
            assert_eq!(truth[key], value, "{key}");
        }
        assert_eq!(truth["inclinometer"], true);
        assert_eq!(truth["rolled_over_s"].is_f64(), more.contains(&"--to-rollover"), "{truth}");
    }
}

#[test]
fn paths_without_their_maneuver_or_plant_are_refused() {
    let scratch = Scratch::new();
    let (log, vehicle) = (scratch.path("log.csv"), kraz());
    let refused = |more: &[&str], parts: &[&str]| {
        let base = ["simulate", "--vehicle", &vehicle, "-o", &log];
        cg(&[&base[..], more].concat()).refused(parts);
    };
    refused(&["--maneuver", "sine", "--gate-m", "20"], &["--gate-m for lane-change"]);
    refused(&["--maneuver", "lane-change", "--turn-deg", "60"], &["for --maneuver steady-turn"]);
    refused(&["--maneuver", "lane-change", "--gate-m", "20"], &["need --plant nonlinear"]);
    // What would change nothing.
    let turn = ["--maneuver", "steady-turn", "--plant", "nonlinear", "--turn-deg", "60"];
    let gate = ["--maneuver", "lane-change", "--plant", "nonlinear", "--gate-m", "20"];
    for path in [turn, gate] {
        refused(&[&path[..], &["--steer-rad", "0.1"]].concat(), &["--steer-rad", "remove it"]);
        refused(&[&path[..], &["--step-rate", "9"]].concat(), &["--step-rate", "remove it"]);
    }
    for maneuver in ["lane-change", "sine", "ramp", "drive"] {
        let step = ["--maneuver", maneuver, "--step-rate", "9"];
        refused(&step, &["--step-rate is for --maneuver rounded-step"]);
    }
    refused(&["--maneuver", "steady-turn", "--turn-deg", "0"], &["at least 1 or at most -1"]);
    refused(&["--maneuver", "sine", "--to-rollover"], &["need --plant nonlinear"]);
    let printed = ["--maneuver", "sine", "--model", "as-printed", "--payload-left-m", "0.1"];
    refused(&printed, &["--payload-left-m needs --model complete"]);
    for plant in ["linear", "reduced", "nonlinear"] {
        let beside = ["--maneuver", "sine", "--plant", plant, "--payload-left-m", "-1.3"];
        refused(&beside, &["--payload-left-m -1.3 must lie between -1.2 and 1.2"]);
    }
    refused(&["--maneuver", "sine", "--payload-behind-hitch-m", "0"], &["must be positive"]);
    refused(&["--maneuver", "sine", "--steering-wheel"], &["no steering_ratio"]);
    refused(&["--maneuver", "sine", "--jitter-s", "0.1"], &["jitter (s) 0.1", "0.0049"]);
    refused(&["--maneuver", "sine", "--drop-out", "1"], &["between 0 and 0.95"]);
    assert!(scratch.names().is_empty());
}

/// A drive on a road: the sensors of the chassis are columns, truth and comments say which road it
/// was, and the truth file has the bank on the way.
#[test]
fn a_road_brings_the_sensors_of_the_chassis_and_its_bank() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(kraz()).unwrap();
    let vehicle = scratch.file("v.toml", format!("steering_ratio = 20.0\n{text}"));
    let truth_file = scratch.path("truth.json");
    let drive = |name: &str, more: &[&str]| {
        let road = ["--road", "roundabouts", "--duration-s", "20", "--truth", &truth_file];
        let path = scratch.simulate(name, &vehicle, &[&road, more].concat());
        std::fs::read_to_string(path).unwrap()
    };
    let text = drive("log.csv", &["--level-noise-m", "0.0005"]);
    let named = ["--level-noise-m", "0.0005", "--plant", "nonlinear"];
    assert_eq!(drive("named.csv", &named), text);
    let truth: Value = serde_json::from_slice(&std::fs::read(&truth_file).unwrap()).unwrap();
    assert_eq!(truth["road"]["name"], "roundabouts");
    assert_eq!(truth["level_noise_m"], 0.0005);
    let banks = truth["track"]["bank_rad"].as_array().unwrap();
    assert_eq!(banks.len(), 201);
    assert_eq!(banks[0], 0.02);
    assert_eq!(truth["road"]["bank_rad"][1], 0.02);
    assert!(text.contains("# truth road = {") && !text.contains("track"));
    let header = text.lines().find(|line| !line.starts_with('#')).unwrap();
    assert!(header.starts_with("time_s,steer_rad,roll_rad,speed_mps,lateral_acceleration_mps2"));
    for column in ["roll_to_gravity_rad", "suspension_roll_rad", "tractor_level_left_m", "tilt_rad"]
    {
        assert!(header.split(',').any(|name| name == column), "{header}");
    }
    // The readings of the gauge on the drive axles are not in this vehicle file.
    assert!(!header.contains("drive_pressure"), "{header}");
    assert_eq!(text, drive("again.csv", &["--level-noise-m", "0.0005"]));
    assert_ne!(text, drive("other.csv", &["--level-noise-m", "0.0005", "--seed", "2"]));

    assert_ne!(text, drive("twist.csv", &["--level-noise-m", "0.0005", "--road-twist"]));
    let truth: Value = serde_json::from_slice(&std::fs::read(&truth_file).unwrap()).unwrap();
    assert_eq!(truth["road"]["is_twisted"], true);

    let frames = drive("drive.log", &[]);
    let first = |group: &str| frames.lines().find(|line| line.contains(group)).unwrap();
    // Levels of the rear axle about 0.25 m: (0.25 + 3.2)/0.0001 is 0x86C4; the front axle is absent.
    assert!(first("18FE592F#").contains("#FFFFFFFF"), "{}", first("18FE592F#"));
    let specific_force = &first("18F0090B#").split_once('#').unwrap().1[8..];
    assert!(!specific_force.starts_with("FFFF"), "{specific_force}");
}

#[test]
fn a_road_is_a_kind_or_a_file_and_excludes_maneuvers() {
    let scratch = Scratch::new();
    let log = scratch.path("log.csv");
    let simulate = |more: &[&str]| {
        let vehicle = kraz();
        cg(&[&["simulate", "--vehicle", &vehicle, "-o", &log][..], more].concat())
    };
    simulate(&["--road", "rurla"]).refused(&["rurla", "rural, motorway, roundabouts"]);
    let bad = scratch.file("bad.csv", "distance_m,curvature_per_m,bank_rad\n0,0,0\n9,0,x\n");
    simulate(&["--road", &bad]).refused(&["bad.csv: line 3, column 3 `bank_rad`"]);
    simulate(&["--road", "rural", "--maneuver", "sine"]).refused(&["--maneuver", "--road"]);
    simulate(&["--road", "rural", "--plant", "linear"]).refused(&["--plant linear", "nonlinear"]);
    simulate(&["--road", "rural", "--inclinometer"]).refused(&["--inclinometer"]);
    simulate(&["--maneuver", "sine", "--level-noise-m", "0.001"]).refused(&["--road"]);
    simulate(&[]).refused(&["--maneuver"]);
    simulate(&["--maneuver", "sine", "--road-twist"]).refused(&["--road"]);
    let road = "distance_m,curvature_per_m,bank_rad\n0,0,0.02\n100,0,0.02\n";
    let short = scratch.file("short.csv", road);
    let limited = ["--road", &short, "--speed-mps", "10", "--duration-s"];
    simulate(&[&limited[..], &["12"]].concat())
        .refused(&["the road ends after 10.0 s", "--duration-s"]);
    simulate(&[&limited[..], &["8"]].concat()).done();
}

/// Sum of the squares of a column of a log.
fn sum_of_squares(log: &str, column: usize) -> f64 {
    let text = std::fs::read_to_string(log).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|row| row.split(',').nth(column).unwrap().parse::<f64>().unwrap().powi(2)).sum()
}

#[test]
fn a_log_of_a_truck_with_two_roll_sensors_has_the_column_of_the_second() {
    let scratch = Scratch::new();
    let rigid = std::fs::read_to_string(kraz()).unwrap();
    let frame = "frame_torsional_stiffness_nm_per_rad = 1e10";
    assert!(rigid.contains(frame));
    let twists = rigid.replace(frame, "frame_torsional_stiffness_nm_per_rad = 3e6");
    let places = "\n[sensors.roll]\nbehind_hitch_m = 0.5\nsecond_behind_hitch_m = 7.0\n";
    let mean = twists + places;
    let both = scratch.file("both.toml", format!("{mean}second_share = 0.6\n"));
    let mean = scratch.file("mean.toml", mean);
    let head = |log: &str| {
        let text = std::fs::read_to_string(log).unwrap();
        text.lines().find(|line| !line.starts_with('#')).unwrap().to_owned()
    };
    let names = "time_s,steer_rad,roll_rad,second_roll_rad,speed_mps,";
    for plant in ["linear", "nonlinear"] {
        let load = ["--height-m", "2.0", "--maneuver", "drive", "--plant", plant];
        let log = scratch.simulate("both.csv", &both, &load);
        assert!(head(&log).starts_with(names), "{}", head(&log));
        // The rear half leans less, by a tenth with this load, in both plants.
        let [front, rear] = [2, 3].map(|column| sum_of_squares(&log, column).sqrt());
        assert!((0.85..0.95).contains(&(rear / front)), "{plant}: {}", rear / front);
        let answer = estimate(&log, &both, &[]).done().answer();
        println!("{plant}: {answer}");
        assert!((height_m(&answer) / 2.0 - 1.0).abs() < 0.02, "{plant}: {answer}");
        // A file with the same places, but without a share, has the mean of both in one column.
        let one = scratch.simulate("mean.csv", &mean, &load);
        assert!(!head(&one).contains("second_roll"), "{}", head(&one));
        let answer = estimate(&one, &mean, &[]).done().answer();
        assert!((height_m(&answer) / 2.0 - 1.0).abs() < 0.02, "{plant}: {answer}");
        // It does not fit a log with both.
        estimate(&log, &mean, &[]).told(1, &[]).answer();
    }
    // Both have the same sensor: noise of their own, and the same quantisation.
    let coarse = ["--maneuver", "sine", "--quantisation-rad", "0.001", "--snr-db", "30"];
    let log = scratch.simulate("both.csv", &both, &coarse);
    let text = std::fs::read_to_string(log).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let angles = rows.map(|row| {
        let mut values = row.split(',').skip(2).map(|value| value.parse::<f64>().unwrap());
        [values.next().unwrap(), values.next().unwrap()]
    });
    let mut differ = 0;
    for [first_rad, second_rad] in angles {
        for angle_rad in [first_rad, second_rad] {
            let steps = angle_rad / 0.001;
            assert!((steps - steps.round()).abs() < 1e-6, "{angle_rad}");
        }
        differ += usize::from((first_rad - second_rad).abs() > 1e-9);
    }
    assert!(differ > 20, "{differ}");
}

/// Without a payload the trailer is empty, and its c.g. is where that of the empty trailer is.
#[test]
fn an_empty_trailer_has_its_own_height() {
    let scratch = Scratch::new();
    let truck = fixture("vehicles/kraz.toml");
    let height_of = |payload_kg: &str| {
        let (log, truth) = (scratch.path(&format!("{payload_kg}.csv")), scratch.path("truth.json"));
        let base = ["simulate", "--vehicle", &truck, "--maneuver", "sine", "--duration-s", "5"];
        let more = ["--payload-kg", payload_kg, "--truth", &truth, "--force", "-o", &log];
        cg(&[&base[..], &more].concat()).done();
        let truth: Value = serde_json::from_slice(&std::fs::read(truth).unwrap()).unwrap();
        height_m(&truth)
    };
    let vehicle = cg_vehicle::Vehicle::load(&truck).unwrap();
    assert!((height_of("0") - vehicle.trailer.tare.cg_height_m).abs() < 1e-12);
    assert!((height_of("1000") - vehicle.reference_load().cg_height_m).abs() < 1e-12);
}
