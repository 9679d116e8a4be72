//! Inputs of `cg run` that stop, freeze or are wrong from the first turn on, in logs in which nothing else shows it.

use std::cell::{Cell, RefCell};

use serde_json::Value;

use crate::common::{Scratch, cg, kraz};

/// A log without a yaw rate and a steer angle.
const LATERAL: [&str; 5] =
    ["time_s", "roll_rad", "lateral_acceleration_mps2", "speed_mps", "trailer_mass_kg"];

/// A drive of a laden truck, 2.0 m, with these columns. `change` changes the value of a column at a time, s, or leaves it out.
fn drive(
    scratch: &Scratch,
    columns: &[&str],
    change: impl Fn(&str, f64, f64) -> Option<f64>,
) -> String {
    let more = [
        "--maneuver",
        "drive",
        "--duration-s",
        "300",
        "--payload-kg",
        "15000",
        "--height-m",
        "2.0",
    ];
    let log = scratch.simulate("drive.csv", &kraz(), &more);
    let text = std::fs::read_to_string(log).unwrap();
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let place = |name: &&str| names.iter().position(|known| known == name).unwrap();
    let mut kept = columns.join(",") + "\n";
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let time_s: f64 = cells[place(&"time_s")].parse().unwrap();
        let cell = |name: &&str| {
            let value = change(name, time_s, cells[place(name)].parse().unwrap());
            value.map(|value| value.to_string()).unwrap_or_default()
        };
        kept += &(columns.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    scratch.file("changed.csv", kept)
}

fn run(log: &str) -> Vec<Value> {
    let vehicle = kraz();
    cg(&["run", "--vehicle", &vehicle, "--road", "flat", "--csv", log]).json()
}

fn last_status(events: &[Value]) -> &Value {
    events.iter().rfind(|event| event["event"] == "status").unwrap()
}

fn notices<'a>(events: &'a [Value], subject: &str) -> Vec<&'a str> {
    let of = |event: &&Value| event["event"] == "notice" && event["subject"] == subject;
    events.iter().filter(of).map(|event| event["message"].as_str().unwrap()).collect()
}

/// Between two speeds the last one holds for 2.5 s, as on a bus. With a lost one, the turns after it give nothing, and the height
/// is that of the turns before.
#[test]
fn a_lost_speed_is_not_kept() {
    let scratch = Scratch::new();
    let columns = ["time_s", "roll_rad", "yaw_rate_radps", "speed_mps", "trailer_mass_kg"];
    let lost = drive(&scratch, &columns, |name, time_s, value| {
        (name != "speed_mps" || time_s < 150.0).then_some(value)
    });
    let events = run(&lost);
    let after = last_status(&events);
    assert!(after["missing"].as_array().unwrap().contains(&"speed".into()), "{after}");
    let before = events
        .iter()
        .rfind(|event| event["event"] == "status" && event["time_s"].as_f64().unwrap() < 152.0);
    let of = |status: &Value| (status["height_m"].clone(), status["maneuvers"].clone());
    let (height, maneuvers) = of(before.unwrap());
    let later = after["maneuvers"].as_u64().unwrap() - maneuvers.as_u64().unwrap();
    assert!(height.is_f64() && later <= 1, "{before:?} {after}"); // a turn in which it was lost
    assert_eq!(notices(&events, "load"), [""; 0]);
}

/// The roll angle shows the turns in which a lateral acceleration repeats one value.
#[test]
fn a_frozen_lateral_acceleration_is_told() {
    let scratch = Scratch::new();
    let frozen = drive(&scratch, &LATERAL, |name, time_s, value| {
        Some(if name == "lateral_acceleration_mps2" && time_s > 150.0 { 0.02 } else { value })
    });
    let events = run(&frozen);
    let told = notices(&events, "channels");
    assert!(
        told.len() == 1 && told[0].contains("lateral_acceleration has been 0.020 m/s² for"),
        "{told:?}"
    );
    assert_eq!(last_status(&events)["status"], "inconsistent");
    let moving = run(&drive(&scratch, &LATERAL, |_, _, value| Some(value)));
    assert_eq!(notices(&moving, "channels"), [""; 0]);
}

/// With half of its mass, the truck rolls as no load does.
#[test]
fn turns_that_are_impossible_from_the_first_one_on_are_told() {
    let scratch = Scratch::new();
    let half = drive(&scratch, &LATERAL, |name, _, value| {
        Some(if name == "trailer_mass_kg" { 0.5 * value } else { value })
    });
    let events = run(&half);
    let told = notices(&events, "turns");
    assert!(
        told.len() == 1 && told[0].starts_with("the last 3 turns gave no height, and none before"),
        "{told:?}"
    );
    assert!(last_status(&events)["height_m"].is_null());
}

/// A lateral acceleration of 2 Hz in rows of 50 Hz, as lines between its values and as values that are held; one of 10 Hz is no fault.
#[test]
fn an_input_that_an_export_has_filled_in_is_told() {
    let scratch = Scratch::new();
    let all = RefCell::new(Vec::new());
    let measured = drive(&scratch, &LATERAL, |name, _, value| {
        if name == "lateral_acceleration_mps2" {
            all.borrow_mut().push(value);
        }
        Some(value)
    });
    assert_eq!(notices(&run(&measured), "signal"), [""; 0]);
    let all = all.into_inner();
    let filled = |every: usize, is_line: bool| {
        let row = Cell::new(0);
        drive(&scratch, &LATERAL, |name, _, value| {
            if name != "lateral_acceleration_mps2" {
                return Some(value);
            }
            let k = row.replace(row.get() + 1);
            let (from, to) = (k - k % every, (k - k % every + every).min(all.len() - 1));
            #[allow(clippy::cast_precision_loss)]
            let share = if is_line { (k - from) as f64 / every as f64 } else { 0.0 };
            Some(all[from] + share * (all[to] - all[from]))
        })
    };
    for (is_line, how) in [(true, "along a straight line"), (false, "stays at one value and then")]
    {
        let log = filled(25, is_line);
        let answer = cg(&["estimate", &log, "--vehicle", &kraz(), "--format", "json"]).json();
        let messages = answer[0]["messages"].to_string();
        let told = notices(&run(&log), "signal").join("; ");
        for said in [messages, told] {
            assert!(said.contains("lateral_acceleration") && said.contains(how), "{said}");
        }
        assert_eq!(notices(&run(&filled(5, is_line)), "signal"), [""; 0]);
    }
}
