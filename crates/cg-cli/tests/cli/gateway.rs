//! A gateway repeats the signals of the trailer's bus on that of the tractor, described by
//! `fixtures/can/trailer_gateway.dbc`.

use std::fmt::Write as _;

use crate::common::{Scratch, cg, estimate, fixture, height_m};
use crate::run::{last_height, lines};

const SIGNALS: [&str; 4] = [
    "level_left=TRAILER_CHASSIS.LevelLeft",
    "level_right=TRAILER_CHASSIS.LevelRight",
    "trailer_suspension_pressure=TRAILER_CHASSIS.BellowsPressure",
    "lateral_specific_force=TRAILER_CHASSIS.LateralAcceleration",
];
/// A gauge in the air suspension that shows 0.7 bar at 4.8 t on the axles and 4.6 bar at 23.5 t.
const GAUGE: &str = "
[trailer.suspension_pressure]
gauge_pa = [0.7e5, 4.6e5]
axle_load_kg = [4800.0, 23500.0]
";
/// What it shows under 16 t in the truck `euro`. The axles, 7.70 m behind the hitch, carry their
/// own 1918.2 kg, and of 4400 kg at 5.60 m and 16 t at 5.20 m what the hitch does not carry.
const PRESSURE_KPA: f64 = 70.0 + (15_923.4 - 4800.0) / (23_500.0 - 4800.0) * 390.0;

/// The frames of the tractor alone (VDC2, ASC3, CCVS1), and the message of the gateway for every
/// row of the same drive.
fn bus(tractor: &str, rows: &str) -> String {
    let is_of_tractor =
        |line: &&str| ["18F0090B#", "18FE592F#", "18FEF100#"].iter().any(|id| line.contains(id));
    let mut frames: Vec<String> =
        tractor.lines().filter(is_of_tractor).map(str::to_owned).collect();
    let mut rows = rows.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    for row in rows {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let value = |name: &str| cells[names.iter().position(|one| *one == name).unwrap()];
        let raw = [
            (1e3 * value("level_left_m") + 3200.0) / 0.1,
            (1e3 * value("level_right_m") + 3200.0) / 0.1,
            PRESSURE_KPA / 0.1,
            (value("lateral_specific_force_mps2") + 15.687) * 2048.0,
        ];
        let mut frame = format!("({:.6}) can0 18FF2080#", value("time_s"));
        for raw in raw {
            assert!((0.0..64_256.0).contains(&raw.round()), "{raw}");
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // asserted
            let [low, high] = (raw.round() as u16).to_le_bytes();
            write!(frame, "{low:02X}{high:02X}").unwrap();
        }
        frames.push(frame);
    }
    // In the order of their time stamps.
    let time_s = |frame: &str| frame[1..].split_once(')').unwrap().0.parse::<f64>().unwrap();
    frames.sort_by(|a, b| time_s(a).total_cmp(&time_s(b)));
    frames.join("\n") + "\n"
}

/// A drive on a banked road whose only sensors of the trailer are those that the gateway repeats.
/// Their frames, one every 20 ms, give the height and the mass.
#[test]
fn signals_of_a_trailer_gateway_give_the_height_on_a_banked_road() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(fixture("vehicles/euro.toml")).unwrap();
    // J1939 has the angle of the steering wheel.
    let truck = scratch.file("truck.toml", format!("steering_ratio = 20.0\n{text}{GAUGE}"));
    let road = ["--road", "rural", "--rate-hz", "50", "--height-m", "1.9", "--payload-kg", "16000"];
    let csv = scratch.simulate("drive.csv", &truck, &road);
    let tractor = scratch.simulate("tractor.log", &truck, &road);
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let log = scratch.file("bus.log", bus(&read(&tractor), &read(&csv)));
    let dbc = fixture("can/trailer_gateway.dbc");
    let mut options = vec!["--dbc", dbc.as_str()];
    options.extend(SIGNALS.iter().flat_map(|signal| ["--signal", signal]));

    let answer = estimate(&log, &truck, &options).done().answer();
    assert_eq!(answer["channel"], "suspension");
    let height_m = height_m(&answer);
    // The pair is 0.7 % off at worst in the table of docs/sensors.md. That the levels are rounded
    // (0.03 mm rms, next to a difference of 17 mm in curves) averages out over the drive.
    assert!((height_m / 1.9 - 1.0).abs() < 0.01, "{answer}");
    let interval_m = answer["height_ci95_m"].as_array().unwrap();
    let [low_m, high_m] = [0, 1].map(|end| interval_m[end].as_f64().unwrap());
    assert!(low_m < 1.9 && 1.9 < high_m, "{answer}");
    // Half a step of the pressure is 2.4 kg on the axles, which are two thirds of the load.
    let mass_kg = answer["trailer_mass_kg"].as_f64().unwrap();
    assert!((mass_kg - 22_318.2).abs() < 2.4 * 1.5, "{mass_kg}");
    let run = [&["run", "--vehicle", &truck, "--candump", &log][..], &options].concat();
    assert!((last_height(&lines(&cg(&run).done())) - height_m).abs() < 1e-12);
    // The tractor alone has no level sensors that the vehicle file describes.
    assert_eq!(estimate(&log, &truck, &[]).code, Some(1));
}
