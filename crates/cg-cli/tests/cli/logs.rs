//! Files that are not logs, and logs without a result.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;

use crate::common::{Scratch, baseline, cg, estimate, fixture, height_m, kraz};

const HEADER: &str = "time_s,steer_rad,roll_rad";

/// Checks that the log is refused with these words in every format, and that no other file is left.
#[track_caller]
fn refused(name: &str, content: impl AsRef<[u8]>, parts: &[&str]) {
    let scratch = Scratch::new();
    let log = scratch.file(name, content);
    let mut all = vec![log.as_str()];
    all.extend(parts);
    for format in ["json", "table", "csv"] {
        cg(&["estimate", &log, "--vehicle", &kraz(), "--format", format]).refused(&all);
    }
    assert_eq!(scratch.names(), [name]);
}

#[test]
fn a_missing_column_is_named_with_what_was_found_and_how_to_map_it() {
    let text = "# recorded yesterday\ntime_s,steer_rad,Lean_deg\n0,0,0\n";
    let (line, remedy) = (", line 2:", "--column roll=");
    refused("log.csv", text, &[line, "no column for roll", "Lean_deg", remedy]);
}

#[test]
fn an_unknown_unit_is_named_with_its_column_and_the_units_there_are() {
    let text = "time_s,steer_rad,roll_grad\n0,0,0\n";
    let place = ", line 1, column 3 `roll_grad`";
    refused("log.csv", text, &[place, "unknown unit", "rad, deg", "--column roll=NAME[deg]"]);
}

#[test]
fn time_that_runs_backwards_is_named_with_both_times() {
    let text = format!("{HEADER}\n0.00,0,0\n0.02,0,0\n0.01,0,0\n");
    let place = ", line 4, column 1 `time_s`";
    refused("log.csv", text, &[place, "0.01 s does not come after 0.02 s", "sort the log by time"]);
}

#[test]
fn a_time_of_day_that_passes_midnight_needs_its_date() {
    let text = format!("{HEADER}\n23:59:59.99,0,0\n00:00:00.01,0,0\n");
    let place = ", line 3, column 1 `time_s`";
    refused("log.csv", text, &[place, "0.01 s does not come after", "write the date before it"]);
}

#[test]
fn a_date_that_has_two_meanings_is_refused_with_one_that_has_not() {
    let text = format!("{HEADER}\n05/01/2024 12:00:00,0,0\n05/01/2024 12:00:01,0,0\n");
    refused("log.csv", text, &[", line 2, column 1 `time_s`", "2024-05-01 12:00:00.02"]);
}

#[test]
fn lines_above_the_header_are_to_be_comments() {
    let text = format!("Vehicle: 12\n{HEADER}\n0,0,0\n");
    refused("log.csv", text, &[", line 1:", "the columns are Vehicle: 12;", "put # before"]);
}

#[test]
fn time_that_steps_by_less_than_a_microsecond_is_named_with_its_line() {
    let text = format!("{HEADER}\n0,0,0\n0.0000001,0,0\n");
    refused("log.csv", text, &[", line 3:", "at least a microsecond apart", "time=NAME[d]"]);
}

/// The points in time of a spreadsheet: days since 1900.
#[test]
fn days_of_a_spreadsheet_are_a_unit_of_the_time() {
    let scratch = Scratch::new();
    let log = std::fs::read_to_string(fixture("logs/A_p00_v50_L.csv")).unwrap();
    let days: String = (log.lines().enumerate())
        .map(|(k, line)| match line.split_once(',') {
            Some((time_s, rest)) if k > 0 && !line.starts_with('#') => {
                let days = 46_353.5 + time_s.parse::<f64>().unwrap() / 86_400.0;
                format!("{days:.9},{rest}\n")
            }
            _ => format!("{line}\n"),
        })
        .collect();
    let with_days = scratch.file("days.csv", days);
    let height_of = |log: &str, more: &[&str]| height_m(&estimate(log, &kraz(), more).answer());
    let of_days = height_of(&with_days, &["--column", "time=time_s[d]"]);
    let of_seconds = height_of(&fixture("logs/A_p00_v50_L.csv"), &[]);
    // A day with nine decimals is exact to 0.1 ms, a hundredth of the sampling interval.
    assert!((of_days - of_seconds).abs() < 1e-3 * of_seconds, "{of_days} {of_seconds}");
}

#[test]
fn text_in_a_number_is_named_with_line_and_column() {
    let text = format!("{HEADER}\n0.00,0,0\n0.01,0,abc\n");
    let place = ", line 3, column 3 `roll_rad`";
    refused("log.csv", text, &[place, "`abc` is not a number", "leave the cell empty"]);
}

#[test]
fn an_empty_file_is_refused_with_the_header_it_needs() {
    refused("log.csv", "", &["the log is empty", HEADER]);
}

#[test]
fn a_header_without_rows_is_refused() {
    refused("log.csv", format!("{HEADER}\n"), &[", line 1:", "no rows", "export it again"]);
}

#[test]
fn binary_garbage_is_refused() {
    let garbage: Vec<u8> =
        (0..4096_u32).map(|k| k.wrapping_mul(2_654_435_761).to_be_bytes()[1]).collect();
    refused("log.csv", garbage, &[", line 1:", "not UTF-8", "export the log as CSV"]);
}

#[test]
fn garbage_after_good_rows_is_named_with_its_line() {
    let mut bytes = format!("{HEADER}\n0.00,0,0\n").into_bytes();
    bytes.extend([0xff, 0x00, 0x80, b'\n']);
    let place = ", line 3, column 1 `time_s`";
    refused("log.csv", bytes, &[place, "is not a number", "correct it"]);
}

#[test]
fn a_truncated_gzip_is_refused_with_the_way_to_save_what_is_whole() {
    let scratch = Scratch::new();
    let log = scratch.simulate("plain.csv", &kraz(), &["--maneuver", "sine"]);
    let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
    gzip.write_all(&std::fs::read(log).unwrap()).unwrap();
    let packed = gzip.finish().unwrap();
    let parts = [", line ", "truncated or corrupt", "copy it again", "gzip -dc"];
    refused("log.csv.gz", &packed[..packed.len() / 2], &parts);
    // The name of the file has no effect. A missing end is detected although it contains no data.
    refused("log.csv", &packed[..packed.len() - 4], &parts);
}

/// Sets the cells of one column to absent in some rows of the simulated log.
fn emptied(text: &str, column: usize, rows: std::ops::Range<usize>) -> String {
    let mut row = 0;
    let mut out = String::new();
    for line in text.lines() {
        let is_row = line.starts_with(|c: char| c.is_ascii_digit());
        let mut cells: Vec<&str> = line.split(',').collect();
        if is_row && rows.contains(&row) {
            cells[column] = if row % 2 == 0 { "NaN" } else { "" };
        }
        row += usize::from(is_row);
        out += &cells.join(",");
        out.push('\n');
    }
    out
}

fn messages(answer: &Value) -> String {
    answer["messages"].to_string()
}

#[test]
fn a_stretch_without_roll_angle_is_left_out_and_counted() {
    let scratch = Scratch::new();
    let log = scratch.simulate("whole.csv", &baseline(), &["--maneuver", "steady-turn"]);
    let text = std::fs::read_to_string(log).unwrap();
    // A gap of 0.3 s is bridged by a straight line; a gap of 2 s ends one maneuver and begins
    // another.
    for (rows, count) in [(800..830, 30), (800..1000, 200)] {
        let log = scratch.file("holed.csv", emptied(&text, 2, rows));
        let answer = estimate(&log, &baseline(), &["--channel", "steer"]).done().answer();
        assert_eq!(answer["status"], "ok");
        let said = format!("{count} of 2001 rows have no roll angle or no input and were left out");
        assert!(messages(&answer).contains(&said), "{answer}");
        // At least half of the log is unchanged and free of noise, so the height is as accurate as
        // from the whole log.
        assert!((height_m(&answer) / 1.973_072 - 1.0).abs() < 0.01, "{answer}");
    }
}

#[test]
fn a_log_without_any_roll_angle_is_rejected_and_says_why() {
    let scratch = Scratch::new();
    let log = scratch.simulate("whole.csv", &baseline(), &["--maneuver", "steady-turn"]);
    let text = std::fs::read_to_string(log).unwrap();
    let log = scratch.file("empty.csv", emptied(&text, 2, 0..usize::MAX));
    let run = estimate(&log, &baseline(), &[]).told(1, &[]);
    let answer = run.answer();
    assert_eq!((&answer["status"], &answer["height_m"]), (&"rejected".into(), &Value::Null));
    assert!(messages(&answer).contains("rejected: no row has a roll angle and an input"));
    assert!(messages(&answer).contains("2001 of 2001 rows"), "{answer}");
}

#[test]
fn straight_driving_is_rejected_and_told_to_drive_a_curve() {
    let scratch = Scratch::new();
    for steer_rad in ["0", "0.001"] {
        let more = ["--maneuver", "steady-turn", "--steer-rad", steer_rad];
        let log = scratch.simulate("straight.csv", &kraz(), &more);
        let answer = estimate(&log, &kraz(), &[]).told(1, &[]).answer();
        assert_eq!((&answer["status"], &answer["height_m"]), (&"rejected".into(), &Value::Null));
        assert!(messages(&answer).contains("rejected: unexcited"), "{answer}");
        assert!(messages(&answer).contains("record a drive with turns"), "{answer}");
    }
}

#[test]
fn a_folder_or_a_missing_log_does_not_keep_the_others_from_being_answered() {
    let scratch = Scratch::new();
    let good = fixture("logs/A_p20_h190_v50_L.csv");
    let (missing, folder) = (scratch.path("missing.csv"), scratch.path("folder"));
    std::fs::create_dir(&folder).unwrap();
    let alone = estimate(&good, &kraz(), &[]).answer();
    for jobs in ["1", "2"] {
        let logs = ["estimate", &missing, &good, &folder, &good, "--vehicle", &kraz()];
        let run = cg(&[&logs[..], &["--format", "json", "--jobs", jobs]].concat());
        let run = run.told(2, &["check the path and its permissions", "Is a directory"]);
        assert!(run.err.contains(&format!("{missing}: cannot be opened")), "{run:?}");
        assert!(run.err.contains(&format!("{folder}: cannot be read")), "{run:?}");
        assert_eq!(run.err.lines().count(), 2, "{run:?}");
        assert_eq!(run.json(), [alone.clone(), alone.clone()]);
    }
    assert_eq!(scratch.names(), ["folder"]);
}
