//! What is done to samples before they are used, in `cg estimate` and `cg run` alike: road twist, which the drive shows, is taken
//! away, and the path of the tractor becomes that of its trailer.

use std::fmt::Write as _;

use crate::common::{Scratch, cg, fixture, height_m};
use crate::run::{last_height, lines};

const HEIGHT_M: f64 = 1.9;

/// A road with curves whose superelevation of 4 % begins 60 m before them and ends with them.
fn road() -> String {
    const STRAIGHT_M: f64 = 110.0;
    const SPIRAL_M: f64 = 40.0;
    const CURVE_M: f64 = 2.0 * SPIRAL_M + 100.0;
    const RAMP_M: f64 = 60.0;
    let mut table = String::from("distance_m,curvature_per_m,bank_rad,speed_mps\n");
    let mut at_m = 0.0;
    for radius_m in [150.0_f64, -240.0, -190.0, 320.0, -130.0] {
        let speed_mps = (1.7 * radius_m.abs()).sqrt().min(22.0);
        for k in 0..80_u32 {
            let along_m = 5.0 * f64::from(k);
            let [into_m, left_m] = [along_m - STRAIGHT_M, STRAIGHT_M + CURVE_M - along_m];
            let share = |from_m: f64, over_m: f64| (from_m.min(left_m) / over_m).clamp(0.0, 1.0);
            let curvature_per_m = share(into_m, SPIRAL_M) / radius_m;
            let bank_rad = -radius_m.signum() * 0.04 * share(into_m + RAMP_M, RAMP_M);
            let at_m = at_m + along_m;
            writeln!(table, "{at_m},{curvature_per_m},{bank_rad},{speed_mps}").unwrap();
        }
        at_m += 400.0;
    }
    table
}

/// A log whose other columns are those of nobody.
fn only(log: &str, kept: &[&str]) -> String {
    let renamed = |line: &str| {
        let name =
            |name: &str| if kept.contains(&name) { name.to_owned() } else { format!("no_{name}") };
        let is_head = line.starts_with("time_s,");
        let names = || line.split(',').map(name).collect::<Vec<_>>().join(",");
        if is_head { names() } else { line.to_owned() }
    };
    log.lines().map(renamed).collect::<Vec<_>>().join("\n") + "\n"
}

/// Errors of the height in `cg estimate` and in `cg run`, %.
fn errors(log: &str, truck: &str) -> [f64; 2] {
    let estimate = cg(&["estimate", log, "--format", "json", "--vehicle", truck]).answer();
    let run = lines(&cg(&["run", "--csv", log, "--vehicle", truck]));
    [height_m(&estimate), last_height(&run)].map(|height_m| 100.0 * (height_m / HEIGHT_M - 1.0))
}

/// The trailer's pair is 5 % too great without a yaw rate, which shows the bank.
#[test]
fn a_yaw_rate_takes_road_twist_away() {
    const PAIR: [&str; 5] = [
        "time_s",
        "speed_mps",
        "trailer_mass_kg",
        "suspension_roll_rad",
        "lateral_specific_force_mps2",
    ];
    let (scratch, truck) = (Scratch::new(), fixture("vehicles/kraz.toml"));
    let road = scratch.file("road.csv", road());
    let load = ["--payload-kg", "14000", "--height-m", "1.9", "--rate-hz", "50"];
    let drive = [&["--road", &road, "--road-twist"], &load[..]].concat();
    let log = std::fs::read_to_string(scratch.simulate("log.csv", &truck, &drive)).unwrap();
    let [without, with] = [&PAIR[..], &[&PAIR[..], &["yaw_rate_radps"]].concat()]
        .map(|kept| errors(&scratch.file("pair.csv", only(&log, kept)), &truck));
    assert!(without.iter().all(|error| *error > 4.0), "{without:?}");
    assert!(with.iter().all(|error| error.abs() < 2.5), "{with:?}");
    assert!((with[0] - with[1]).abs() < 0.5, "{with:?}");
}

/// A lane change on a bus, which has the yaw rate of the tractor in VDC2 and no other lateral motion, and in a log of it, of which
/// the vehicle file or a column must say it. As that of the trailer it gives no height.
#[test]
fn the_yaw_rate_of_the_tractor_serves_the_trailer() {
    const LOG: [&str; 5] = ["time_s", "roll_rad", "speed_mps", "yaw_rate_radps", "trailer_mass_kg"];
    let (scratch, plain) = (Scratch::new(), fixture("vehicles/kraz.toml"));
    let text = std::fs::read_to_string(&plain).unwrap();
    // Without the ratio, the angle of the steering wheel is not used.
    let steered = scratch.file("steered.toml", format!("steering_ratio = 20.0\n{text}"));
    let text = text + "\n[sensors.yaw_rate]\non_tractor = true\n";
    let truck = scratch.file("truck.toml", text);
    let change = ["--plant", "nonlinear", "--maneuver", "lane-change", "--rate-hz", "50"];
    let change = [&change[..], &["--height-m", "1.9", "--payload-kg", "14000"]].concat();
    let frames = scratch.simulate("bus.log", &steered, &change);
    let log = std::fs::read_to_string(scratch.simulate("log.csv", &truck, &change)).unwrap();
    let log = scratch.file("yaw.csv", only(&log, &LOG));
    let by_log = errors(&log, &truck);
    let text = std::fs::read_to_string(&log).unwrap();
    let said = |what: &str| {
        let is_head = |line: &str| line.starts_with("time_s,");
        let more = |line| if is_head(line) { "yaw_rate_on_tractor" } else { what };
        let rows = text.lines().skip_while(|line| line.starts_with('#'));
        rows.map(|line| [line, ",", more(line), "\n"].concat()).collect::<String>()
    };
    let by_column = errors(&scratch.file("said.csv", said("true")), &plain);
    assert_eq!(by_column.map(f64::to_bits), by_log.map(f64::to_bits));
    let flat = ["--vehicle", &plain, "--road", "flat"];
    let frames_of = |command: &[&str]| cg(&[command, &flat[..]].concat());
    let by_frames = height_m(&frames_of(&["estimate", &frames, "--format", "json"]).answer());
    let by_run = last_height(&lines(&frames_of(&["run", "--candump", &frames])));
    let by_bus = [by_frames, by_run].map(|height_m| 100.0 * (height_m / HEIGHT_M - 1.0));
    for error in [by_log, by_bus].concat() {
        assert!(error.abs() < 2.0, "{by_log:?} {by_bus:?}");
    }
    for log in [log, scratch.file("denied.csv", said("0"))] {
        let answer = cg(&["estimate", &log, "--format", "json", "--vehicle", &plain]).answer();
        assert!(answer["height_m"].is_null(), "{answer}");
        assert!(
            answer["messages"].to_string().contains("or the yaw rate is that of the tractor"),
            "{answer}"
        );
    }
}
