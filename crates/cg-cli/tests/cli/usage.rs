//! Wrong arguments: exit status 2, a message with the argument and the remedy, and no output files.

use crate::common::{Scratch, cg, estimate, fixture, kraz};

fn log() -> String {
    fixture("logs/A_p20_h190_v50_L.csv")
}

/// Checks that `cg estimate` of a valid log refuses these arguments.
#[track_caller]
fn refused(more: &[&str], parts: &[&str]) {
    estimate(&log(), &kraz(), more).refused(parts);
}

#[test]
fn no_command_no_log_and_no_vehicle_are_asked_for() {
    cg(&[]).refused(&["Usage: cg <COMMAND>", "estimate", "model", "simulate"]);
    cg(&["estimate", "--vehicle", &kraz()]).refused(&["<LOG>...", "Usage: cg estimate"]);
    cg(&["estimate", &log()]).refused(&["--vehicle <V.toml>", "Usage: cg estimate"]);
    cg(&["model"]).refused(&["--vehicle <V.toml>", "Usage: cg model"]);
    cg(&["simulate", "--vehicle", &kraz()]).refused(&["--maneuver", "--output <LOG.csv>"]);
}

#[test]
fn an_unknown_flag_command_or_choice_is_named_with_what_there_is() {
    refused(&["--metod", "arx"], &["'--metod'", "--method"]);
    cg(&["estimat", &log()]).refused(&["'estimat'", "estimate"]);
    refused(&["--method", "magic"], &["'magic'", "filtered, arx, gain"]);
    refused(&["--channel", "yaw"], &["'yaw'", "auto, steer, lateral-acceleration"]);
    refused(&["--model", "printed"], &["'printed'", "complete, as-printed"]);
}

#[test]
fn an_order_outside_one_to_ten_is_refused_with_the_range() {
    for order in ["0", "11", "-1", "5.5", "five"] {
        let argument = format!("--order={order}");
        refused(&["--method", "arx", &argument], &["--order", order, "from 1 to 10"]);
    }
}

/// The other methods have none, so the user expects something that does not happen.
#[test]
fn an_order_without_the_method_that_has_one_is_refused() {
    let (log, vehicle) = (log(), kraz());
    for (more, method) in
        [(&["--order", "5"][..], "filtered"), (&["--order", "2", "--method", "gain"], "gain")]
    {
        let told = format!("--order {}: the method \"{method}\" has no order", more[1]);
        let parts = [&*told, "give --method arx too"];
        refused(more, &parts);
        let run = ["run", "--vehicle", &vehicle, "--csv", &log];
        cg(&[&run, more].concat()).refused(&parts);
    }
}

#[test]
fn a_speed_or_a_mass_that_is_no_positive_number_is_refused() {
    for option in ["--speed-mps", "--trailer-mass-kg"] {
        for (value, remedy) in [
            ("-1", "must be positive"),
            ("0", "must be positive"),
            ("nan", "expected a number"),
            ("inf", "expected a number"),
            ("fast", "expected a number"),
        ] {
            refused(&[option, value], &[option, &format!("'{value}'"), remedy]);
        }
    }
}

#[test]
fn standard_input_twice_is_refused() {
    cg(&["estimate", "-", "-", "--vehicle", &kraz()]).refused(&["(-)", "only once"]);
}

#[test]
fn a_bad_column_is_refused_with_the_form_it_should_have() {
    let column = |text| ["--column", text];
    refused(&column("roll"), &["`roll` is not of the form", "SIGNAL=NAME[UNIT]"]);
    refused(&column("roll="), &["roll=", "is not of the form"]);
    refused(&column("bank=X[deg]"), &["`bank` is not a signal", "roll, roll_to_gravity, tilt"]);
    refused(&column("roll=X[kmh]"), &["`kmh` is not a unit of roll", "rad, deg"]);
    refused(&column("roll=X_kmh"), &["not a unit of roll", "roll=X_kmh[rad]"]);
    // Only reading the log shows that it has no such column.
    let parts = [&log(), ", line 1:", "no column for --column roll=X", "the columns are time_s"];
    refused(&column("roll=X[deg]"), &parts);
}

#[test]
fn a_bad_flip_is_refused_with_the_reason() {
    refused(&["--flip", "bank"], &["`bank` is not a signal", "roll, roll_to_gravity, tilt"]);
    refused(&["--flip", "roll,bank"], &["`bank` is not a signal"]);
    refused(&["--flip", "time"], &[&log(), "time cannot be flipped", "remove it from --flip"]);
    refused(&["--flip", "tilt"], &[&log(), "no such signal", "remove it from --flip"]);
}

#[test]
fn more_jobs_than_a_machine_can_have_are_refused() {
    for jobs in ["-1", "257", "100000000000", "two"] {
        refused(&[&format!("--jobs={jobs}")], &["--jobs", jobs, "from 0 (all processors) to 256"]);
    }
}

#[test]
fn a_truth_file_that_is_none_is_refused_before_any_log_is_read() {
    let scratch = Scratch::new();
    let missing = scratch.path("truth.json");
    refused(&["--truth", &missing], &[&missing, "check the path given to --truth"]);
    let truth = scratch.file("truth.json", "{\"log\": 1}");
    refused(&["--truth", &truth], &[&truth, "expected a JSON list", "line 1 column"]);
}

#[test]
fn a_simulation_of_nonsense_is_refused_and_leaves_nothing() {
    let scratch = Scratch::new();
    let (out, truth, vehicle) = (scratch.path("log.csv"), scratch.path("truth.json"), kraz());
    let common = ["simulate", "--vehicle", &vehicle, "--maneuver", "sine", "--truth", &truth];
    for (option, value, remedy) in [
        ("--steer-rad", "nan", "expected a number"),
        ("--speed-mps", "-3", "must be positive"),
        ("--rate-hz", "0", "must be positive"),
        ("--rate-hz", "1e7", "must be at most 10000"),
        ("--duration-s", "1e6", "must be at most 86400"),
        ("--speed-mps", "1e300", "must be at most 60"),
        ("--speed-mps", "1e-200", "must be at least 0.001"),
        ("--height-m", "1e9", "must be at most 6"),
        ("--payload-kg", "1e12", "must be at most 200000"),
        ("--trailer-mass-kg", "1e12", "must be at most 200000"),
        ("--steer-rad", "-3", "must lie between -1 and 1"),
        ("--duration-s", "-1", "must be positive"),
        ("--start-s", "-1", "must not be negative"),
        ("--start-s", "30", "must lie between 0 and --duration-s 20"),
        ("--snr-db", "nan", "expected a number"),
        ("--snr-db", "-1e9", "must lie between -300 and 300"),
        ("--payload-kg", "-1", "must not be negative"),
        ("--seed", "one", "invalid digit"),
    ] {
        let run = cg(&[&common[..], &["-o", &out, option, value]].concat());
        run.refused(&[remedy]);
        assert!(scratch.names().is_empty(), "{option} {value}: {:?}", scratch.names());
    }
    let both = ["--payload-kg", "1", "--trailer-mass-kg", "20000", "-o", &out];
    cg(&[&common[..], &both].concat()).refused(&["cannot be used with"]);
    let name = scratch.path("log.txt");
    cg(&[&common[..], &["-o", &name]].concat()).refused(&[&name, "ends in .csv, .csv.gz or .log"]);
    let same = ["simulate", "--vehicle", &vehicle, "--maneuver", "sine", "--truth", &out];
    cg(&[&same[..], &["-o", &out]].concat()).refused(&[&out, "--output and to --truth"]);
    assert!(scratch.names().is_empty());
}
