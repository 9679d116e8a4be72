//! `cg vehicle`: from a new vehicle file to a height.

use serde_json::Value;

use crate::common::{Run, Scratch, cg, command, estimate, fixture, height_m, kraz};

const KINDS: [&str; 3] = ["4x2-3axle", "6x4-2axle", "6x4-3axle"];

fn new(scratch: &Scratch, kind: &str) -> String {
    let file = scratch.path("truck.toml");
    let run = cg(&["vehicle", "new", "--kind", kind, "-o", &file]).done();
    assert!(run.out.is_empty(), "{run:?}");
    file
}

fn check(file: &str, more: &[&str]) -> Value {
    cg(&[&["vehicle", "check", file, "--format", "json"], more].concat()).done().answer()
}

/// What a new user does: write the file, check it, drive, estimate.
#[test]
fn a_new_truck_gives_a_height() {
    for kind in KINDS {
        let scratch = Scratch::new();
        let file = new(&scratch, kind);
        assert_eq!(check(&file, &[])["findings"], Value::Array(Vec::new()), "{kind}");
        let drive = ["--maneuver", "drive", "--plant", "nonlinear", "--height-m", "2.2"];
        let more = ["--snr-db", "30", "--duration-s", "120"];
        let log = scratch.simulate("log.csv", &file, &[&drive[..], &more].concat());
        let run = estimate(&log, &file, &[]).done();
        let answer = run.answer();
        // The plant is the truck of the file, so only noise and the plant's nonlinearity differ; the
        // interval contains the uncertainty of the file.
        let height = height_m(&answer);
        assert!((height / 2.2 - 1.0).abs() < 0.02, "{kind}: {height}");
        let sd = answer["height_sd_m"].as_f64().unwrap();
        assert!((0.08..0.4).contains(&sd), "{kind}: ± {sd}");
    }
}

/// The commands of docs/vehicle.md, one after the other in one folder.
#[test]
fn the_steps_of_the_page_lead_to_a_height() {
    let page = cg(&["vehicle", "doc"]).done().out;
    let steps = page.split("```sh\n").nth(1).unwrap().split("```").next().unwrap();
    let scratch = Scratch::new();
    let mut outputs = Vec::new();
    for line in steps.lines().filter_map(|line| line.strip_prefix("cg ")) {
        let arguments: Vec<&str> = line.split(" #").next().unwrap().split_whitespace().collect();
        let mut command = command(&arguments);
        let run = Run::from(command.current_dir(scratch.path("")).output().unwrap()).done();
        outputs.push(run.out);
    }
    assert_eq!(outputs.len(), 4);
    assert!(outputs[1].contains("no findings"), "{outputs:?}");
    let height = outputs[3].split(" ± ").next().unwrap().split_whitespace().last().unwrap();
    let height_m: f64 = height.parse().unwrap();
    // The page simulates 2.2 m, with the truck that it estimates.
    assert!((height_m / 2.2 - 1.0).abs() < 0.02, "{}", outputs[3]);
}

#[test]
fn a_new_file_replaces_no_other() {
    let scratch = Scratch::new();
    let file = new(&scratch, KINDS[0]);
    let again = ["vehicle", "new", "--kind", KINDS[1], "-o", &file];
    cg(&again).refused(&[&file, "exists already", "--output", "--force"]);
    let before = std::fs::read_to_string(&file).unwrap();
    assert!(before.contains("4x2 tractor"), "{before}");
    cg(&[&again[..], &["--force"]].concat()).done();
    assert!(std::fs::read_to_string(&file).unwrap().contains("6x4 tractor"));
    cg(&["vehicle", "new", "--kind", "8x4", "-o", &file]).refused(&["8x4", "4x2-3axle", "--kind"]);
}

#[test]
fn the_check_has_loads_thresholds_and_the_parameters_that_matter_most() {
    let answer = check(&kraz(), &["--payload-kg", "15000", "--height-m", "1.9"]);
    let number = |value: &Value| value.as_f64().unwrap();
    let (empty, laden) = (&answer["empty"], &answer["laden"]);
    // The masses of the file: sprung masses and axles.
    let tractor_kg = 10_000.0 + 996.0 + 2.0 * 1226.0;
    for (loaded, trailer_kg) in [(empty, 8684.0), (laden, 23_684.0)] {
        assert!((number(&loaded["trailer_mass_kg"]) - trailer_kg).abs() < 1e-6);
        let axles = loaded["axle_load_kg"].as_array().unwrap();
        let all_kg: f64 = axles.iter().map(number).sum();
        assert!((all_kg / (tractor_kg + trailer_kg) - 1.0).abs() < 1e-9, "{all_kg}");
    }
    assert!((number(&laden["height_m"]) - 1.9).abs() < 1e-12);
    assert!(number(&laden["rollover_threshold_g"]) < number(&empty["rollover_threshold_g"]));
    let parameters = answer["parameters"].as_array().unwrap();
    assert_eq!(parameters.len(), cg_vehicle::belief::PARAMETERS);
    assert_eq!(parameters[0]["parameter"], "trailer_roll_stiffness");
    for channel in ["steer", "lateral-acceleration", "suspension", "tractor"] {
        let squares: f64 =
            parameters.iter().map(|one| number(&one["height_relative_sd"][channel]).powi(2)).sum();
        let all = number(&answer["height_relative_sd"][channel]);
        // The parameters are independent; the rest of the model is added.
        assert!(squares.sqrt() < all && squares.sqrt() > 0.9 * all, "{channel}: {squares} {all}");
    }
    let run = cg(&["vehicle", "check", &kraz()]).done();
    for part in ["no findings", "tractor axle 1, steered", "rollover threshold", "matter most"] {
        assert!(run.out.contains(part), "{part}");
    }
}

/// Nothing gets lighter: what the raised axle carried is on the other axles.
#[test]
fn the_check_has_the_loads_with_the_axle_raised() {
    let scratch = Scratch::new();
    let truck = scratch.lifting("euro");
    let answer = check(&truck, &["--trailer-mass-kg", "16000", "--height-m", "1.8"]);
    for load in ["empty", "laden"] {
        let of = |name: &str| answer[name]["axle_load_kg"].as_array().unwrap().clone();
        let kg = |name: &str| of(name).iter().map(|one| one.as_f64().unwrap()).collect::<Vec<_>>();
        let (down, raised) = (kg(load), kg(&format!("{load}_raised")));
        let sum = |loads_kg: &[f64]| loads_kg.iter().sum::<f64>();
        assert!((sum(&raised) / sum(&down) - 1.0).abs() < 1e-9, "{raised:?} {down:?}");
        // The first of the last three is the lift axle.
        let lifted = down.len() - 3;
        assert!(down[lifted] > 0.0 && raised[lifted].to_bits() == 0.0_f64.to_bits(), "{raised:?}");
        assert!(raised[lifted + 1] > 1.2 * down[lifted + 1], "{raised:?} {down:?}");
    }
    let table = cg(&["vehicle", "check", &truck]).done().out;
    assert!(table.contains("empty, raised") && table.contains("laden, raised"), "{table}");
    let without = cg(&["vehicle", "check", &fixture("vehicles/euro.toml")]).done().out;
    assert!(!without.contains("empty, raised"), "{without}");
}

/// The frame of kraz is rigid in its file, and its tires have slopes at zero slip; a template says nothing of frame
/// and sensor.
#[test]
fn the_check_notes_what_nothing_else_tells() {
    const PLACES: &str = "
[sensors.roll]
behind_hitch_m = 7.7
[sensors.accelerometer]
behind_hitch_m = 7.7
";
    let scratch = Scratch::new();
    let template = new(&scratch, KINDS[0]);
    let known = std::fs::read_to_string(&template).unwrap();
    let known = known.replacen("#lift_m", "lift_m", 1);
    let known = scratch.file("known.toml", known + PLACES);
    let windless = std::fs::read_to_string(kraz()).unwrap();
    let windless = windless.split_once("[wind]").unwrap().0;
    let windless = scratch.file("windless.toml", windless);
    for (file, place, count, key, part) in [
        (&kraz(), 0, 3, "trailer.frame_torsional_stiffness_nm_per_rad", "1e10 is a rigid frame"),
        (
            &kraz(),
            2,
            3,
            "tyre.cornering_stiffness_n_per_rad",
            "differ by up to +8 % from the secants",
        ),
        (&kraz(), 1, 3, "trailer.axle.lift_m", "none of the 3 axles has it"),
        (&windless, 2, 4, "wind", "no interval contains a side wind"),
        (&template, 0, 3, "sensors.roll.behind_hitch_m", "counts as over the axles"),
        (&template, 1, 3, "sensors.accelerometer.behind_hitch_m", "as over the trailer's axles"),
    ] {
        let answer = check(file, &[]);
        let notes = answer["notes"].as_array().unwrap();
        assert_eq!((notes.len(), &notes[place]["key"]), (count, &key.into()), "{answer}");
        let note = &notes[place]["note"];
        assert!(note.as_str().unwrap().contains(part), "{note}");
        let run = cg(&["vehicle", "check", file]).done();
        assert!(run.out.contains(&format!("Note on {key}: ")), "{}", run.out);
    }
    assert_eq!(check(&known, &[])["notes"], Value::Array(Vec::new()));
    assert!(!cg(&["vehicle", "check", &known]).done().out.contains("Note on"));
}

/// A template says nothing of frame and sensor. With the place of the sensor nothing is left to say.
#[test]
fn a_roll_sensor_without_a_place_is_told_once() {
    const SUBJECT: &str = "the vehicle file does not say where the roll sensor is";
    let scratch = Scratch::new();
    let template = new(&scratch, KINDS[0]);
    let log =
        scratch.simulate("log.csv", &template, &["--maneuver", "drive", "--duration-s", "120"]);
    let text = std::fs::read_to_string(&template).unwrap();
    let known = scratch.file("known.toml", text + "\n[sensors.roll]\nbehind_hitch_m = 7.7\n");
    for (file, times) in [(&template, 1), (&known, 0)] {
        let answer = estimate(&log, file, &[]).done().answer();
        let messages = answer["messages"].as_array().unwrap().iter();
        let told = messages.filter(|one| one.as_str().unwrap().starts_with(SUBJECT));
        assert_eq!(told.count(), times, "{answer}");
        let run = cg(&["run", "--vehicle", file, "--csv", &log]).told(0, &[]).out;
        assert!(run.matches("\"event\":\"maneuver\"").count() > 2, "{run}");
        assert_eq!(run.matches(SUBJECT).count(), times, "{run}");
        assert_eq!(run.matches("\"subject\":\"roll_sensor\"").count(), times, "{run}");
    }
}

#[test]
fn the_check_shows_warnings_and_refuses_errors() {
    let scratch = Scratch::new();
    let file = new(&scratch, KINDS[0]);
    let text = std::fs::read_to_string(&file).unwrap();
    let odd = text.replacen("spring_spread_m = 0.82", "spring_spread_m = 0.41", 1);
    let odd = scratch.file("odd.toml", odd);
    let key = "tractor.axle[0].spring_spread_m";
    let run = cg(&["vehicle", "check", &odd, "--format", "json"]).told(0, &[key, "warning"]);
    let answer = run.answer();
    assert_eq!(answer["findings"][0]["key"], key);
    assert_eq!(answer["findings"][0]["severity"], "warning");
    let run = cg(&["vehicle", "check", &odd]).told(0, &[key]);
    assert!(run.out.contains("warning"), "{}", run.out);
    let wrong = text.replacen("spring_spread_m = 0.82", "spring_spread_m = 820", 1);
    let wrong = scratch.file("wrong.toml", wrong);
    cg(&["vehicle", "check", &wrong]).refused(&[key, "820 mm would be usual"]);
    cg(&["vehicle", "check", &file, "--trailer-mass-kg", "1000"]).refused(&["1000 kg", "empty"]);
}

#[test]
fn schema_and_page_are_printed() {
    let schema = cg(&["vehicle", "schema"]).done();
    assert!(serde_json::from_str::<Value>(&schema.out).unwrap()["properties"]["hitch"].is_object());
    let page = cg(&["vehicle", "doc"]).done();
    assert!(page.out.starts_with("# Vehicle files\n"));
}

/// A template promises no less than its plant shows.
#[test]
fn the_residual_is_that_of_the_plant() {
    let scratch = Scratch::new();
    let file = new(&scratch, KINDS[0]);
    let answer = cg(&["vehicle", "residual", &file, "--format", "json"]).done().answer();
    let number = |key: &str| answer[key].as_f64().unwrap();
    assert!(number("runs") >= 40.0 && number("residual_sd") <= number("residual_sd_of_file"));
    let steer = &answer["channels"][0];
    assert_eq!(steer["channel"], "steer");
    // Its tires get softer in turns, which linear equations do not know, and an interval contains it.
    let [spread, explained] = ["spread", "explained"].map(|key| steer[key].as_f64().unwrap());
    assert!(spread > 5e-4 && spread < explained, "{answer}");
    cg(&["vehicle", "residual", &scratch.path("none.toml")]).refused(&["none.toml"]);
}
