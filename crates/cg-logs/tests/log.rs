//! The log format: one test for each of its rules.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::float_cmp, reason = "numbers are read exactly")]

use std::io;

use cg_core::AlignSettings;
use cg_logs::log::{LogError, LogOptions, LogReader, LogRow, Signal};

mod files;
mod foreign;
mod options;
#[cfg(feature = "parquet")]
mod parquet;
mod writer;

fn options(columns: &[&str], flip: &[Signal]) -> LogOptions {
    let columns = columns.iter().map(|text| text.parse().unwrap()).collect();
    LogOptions { columns, flip: flip.to_vec(), ..LogOptions::default() }
}

fn open(csv: impl AsRef<[u8]>, options: &LogOptions) -> Result<LogReader, LogError> {
    let bytes = io::Cursor::new(csv.as_ref().to_vec());
    LogReader::from_reader("drive.csv", Box::new(bytes), options)
}

fn read_as(csv: impl AsRef<[u8]>, options: &LogOptions) -> Result<Vec<LogRow>, LogError> {
    open(csv, options)?.collect()
}

fn read(csv: impl AsRef<[u8]>) -> Result<Vec<LogRow>, LogError> {
    read_as(csv, &LogOptions::default())
}

/// Steer and roll of the only row of a log.
fn pair(csv: impl AsRef<[u8]>) -> (f64, f64) {
    let rows = read(csv).unwrap();
    assert_eq!(rows.len(), 1);
    (rows[0].steer_rad, rows[0].roll_rad)
}

#[track_caller]
fn says(error: &LogError, words: &[&str]) {
    let message = error.to_string();
    for word in words.iter().chain(&["drive."]) {
        assert!(message.contains(word), "no `{word}` in: {message}");
    }
}

#[track_caller]
fn refused(csv: impl AsRef<[u8]>, words: &[&str]) {
    says(&read(csv).unwrap_err(), words);
}

const ONE: &str = "time_s,steer_rad,roll_rad\n0,0.1,-0.2\n";

#[test]
fn every_signal_in_si_is_read_as_it_is_and_an_absent_one_is_nan() {
    let names = Signal::ALL.map(Signal::column).join(",");
    let mut next = 0.0;
    let values = Signal::ALL.map(|_| {
        next += 0.5;
        next
    });
    let texts = values.map(|value| value.to_string()).join(",");
    let rows = read(format!("{names}\n{texts}\n")).unwrap();
    assert_eq!(Signal::ALL.map(|s| rows[0].get(s)), values);
    let row = read(ONE).unwrap()[0];
    assert_eq!((row.time_s, row.steer_rad, row.roll_rad), (0.0, 0.1, -0.2));
    assert!(Signal::ALL.iter().filter(|&&s| row.get(s).is_nan()).count() == Signal::COUNT - 3);
}

#[test]
fn every_accepted_suffix_is_converted_to_si() {
    let head = "time_us,steering_wheel_deg,tilt_deg,speed_kmh,lateral_acceleration_g,\
                yaw_rate_degps,trailer_mass_t\n";
    let row = read(format!("{head}1003,180,90,36,0.5,-90,32.5\n")).unwrap()[0];
    let pi = std::f64::consts::PI;
    assert_eq!((row.time_s, row.steering_wheel_rad, row.tilt_rad), (0.001_003, pi, pi / 2.0));
    assert_eq!((row.speed_mps, row.lateral_acceleration_mps2), (10.0, 4.903_325));
    assert_eq!((row.yaw_rate_radps, row.trailer_mass_kg), (-pi / 2.0, 32_500.0));
    assert_eq!(read("time_ms,steer_deg,roll_deg\n1003,0,0\n").unwrap()[0].time_s, 1.003);
}

#[test]
fn comments_and_blank_lines_are_skipped_anywhere_and_never_interpreted() {
    let csv = "# time_s,roll_deg \"\n\n#\ntime_s,steer_rad,roll_rad\n# 5\n0,1,2\n  \n\n1,3,4\n#\"";
    let mut log = open(csv, &LogOptions::default()).unwrap();
    assert_eq!((log.next_row().unwrap().unwrap().steer_rad, log.line()), (1.0, 6));
    assert_eq!((log.next_row().unwrap().unwrap().roll_rad, log.line()), (4.0, 9));
    assert!(log.next_row().unwrap().is_none());
}

#[test]
fn unknown_columns_are_ignored_whatever_they_hold() {
    let csv = "note,time_s,pitch_rate_grad,steer_rad,roll_rad,x\n\
               \"a,\"\"b\n# c\",0,?,0.1,-0.2,\n5\" nail,1,\u{fffd},0.1,-0.2,inf\n";
    let rows = read(csv).unwrap();
    assert_eq!((rows.len(), rows[0].roll_rad, rows[1].steer_rad), (2, -0.2, 0.1));
    assert_eq!(pair(b"time_s,steer_rad,roll_rad,x\n0,0.1,-0.2,\xff\xfe\n"), (0.1, -0.2));
}

#[test]
fn one_of_our_columns_in_an_unknown_unit_or_without_one_is_an_error() {
    let words = ["line 2", "column 3 `roll_grad`", "unknown unit", "rad, deg", "⟨columns roll="];
    refused("#\ntime_s,steer_rad,roll_grad\n0,0,0\n", &words);
    refused("time_s,steer_rad,roll_rad,speed\n0,0,0,0\n", &["column 4 `speed`", "mps, kmh"]);
    refused("time_s,steer_kmh,roll_rad\n0,0,0\n", &["column 2 `steer_kmh`", "rad, deg"]);
}

#[test]
fn the_same_signal_twice_is_an_error_that_names_both_columns() {
    let words = ["line 1", "column 1 `time_s`", "column 3 `time_ms`", "remove one"];
    refused("time_s,steer_rad,time_ms,roll_rad\n0,0,0,0\n", &words);
}

#[test]
fn the_delimiter_is_taken_from_the_header() {
    for delimiter in [",", ";", "\t"] {
        assert_eq!(pair(ONE.replace(',', delimiter)), (0.1, -0.2));
    }
    assert_eq!(pair("time_s;steer_rad;roll_rad;\"a,b,c,d,e\"\n0;0.1;-0.2;x,y\n"), (0.1, -0.2));
}

#[test]
fn windows_line_ends_marks_quotes_spaces_and_an_open_last_line_are_tolerated() {
    let quoted = "\"time_s\",\"steer_rad\",\"roll_rad\"\n\"0\",\"0.1\",\"-0.2\"\n";
    let spaced = "time_s , steer_rad, roll_rad \n 0 , +0.1, -0.2 \n";
    let mark = "\u{feff}";
    for csv in [quoted, spaced, &ONE.replace('\n', "\r\n"), &quoted.replace('\n', "\r\n")] {
        for csv in [csv.to_string(), format!("{mark}{csv}"), format!("{mark}# c\r\n\r\n{csv}")] {
            assert_eq!(pair(csv.trim_end_matches('\n')), (0.1, -0.2), "{csv:?}");
        }
    }
    assert_eq!(read(format!("{mark}\n{ONE}")).unwrap().len(), 1);
}

#[test]
fn a_missing_column_is_an_error_that_lists_what_was_found_and_proposes_an_option() {
    let words =
        ["line 1", "roll_rad or tilt_rad", "time_s, steer_rad, a", "⟨columns roll=NAME[deg]"];
    refused("time_s,steer_rad,a\n0,0,0\n", &words);
    refused("t,steer_rad,roll_rad\n0,0,0\n", &["time_s", "⟨columns time=NAME[s]"]);
    refused("time_s,a,roll_rad\n0,0,0\n", &["steer_rad or steering_wheel_rad", "⟨columns steer="]);
}

#[test]
fn any_input_will_do() {
    for name in ["steer_rad", "steering_wheel_rad", "lateral_acceleration_mps2", "yaw_rate_radps"] {
        assert_eq!(read(format!("time_s,{name},roll_rad\n0,0,0\n")).unwrap().len(), 1, "{name}");
    }
}

#[test]
fn the_nearest_name_is_proposed_for_the_signal_it_is_near_to() {
    refused("time_s,steer_rad,Rol_rad\n0,0,0\n", &["⟨columns roll=Rol_rad[rad]"]);
    refused("time_s,steer_rad,Trailer Tilt\n0,0,0\n", &["⟨columns tilt=Trailer Tilt[deg]⟩"]);
    refused("time_s,SteeringWheelAngle,roll_rad\n0,0,0\n", &["steering_wheel=SteeringWheelAngle"]);
    refused("Timestamp,steer_rad,roll_rad\n0,0,0\n", &["⟨columns time=Timestamp[s]"]);
}

#[test]
fn an_empty_cell_or_na_is_absent_except_in_time() {
    for absent in ["", " ", "NaN", "nan", "NA", "na", "-nan", "\"\"", "\"NaN\""] {
        assert!(pair(format!("time_s,roll_rad,steer_rad\n0,-0.2,{absent}\n")).0.is_nan());
        let words = ["line 2", "column 1 `time_s`", "missing", "remove the row"];
        refused(format!("time_s,roll_rad,steer_rad\n{absent},-0.2,1\n"), &words);
    }
}

#[test]
fn text_in_a_number_is_an_error_that_shows_it_shortened_and_escaped() {
    let words = ["line 4", "column 3 `roll_rad`", "`err\\u{7}", "not a number", "correct it"];
    refused(format!("{ONE}#\n1,0,err\u{7}\n"), &words);
    refused(format!("{ONE}1,0,\"err\u{7}\"\n"), &["line 3", "column 3 `roll_rad`", "`err\\u{7}`"]);
    refused(format!("{ONE}1,0,{}\n", "y".repeat(999)), &[&format!("`{}…`", "y".repeat(40))]);
    refused(format!("{ONE}1,0,1.5x\n"), &["`1.5x`"]);
    refused(b"time_s,steer_rad,roll_rad\n0,0,\xff\0\n", &["`\u{fffd}\\u{0}`"]);
    let quoted = format!("{ONE}1,0,\"0,1\"\n");
    refused(quoted, &["`0,1`", "decimals with a point"]);
}

#[test]
fn infinity_is_an_error_also_by_overflow() {
    for cell in ["inf", "-Infinity", "1e999", "\"inf\""] {
        refused(format!("{ONE}1,0,{cell}\n"), &["line 3", "column 3 `roll_rad`", "not finite"]);
    }
    refused("time_s,steer_rad,roll_rad,speed_mps,trailer_mass_t\n0,0,0,0,1e308", &["not finite"]);
}

/// Otherwise a mass that somebody knows to be inexact would count as exact.
#[test]
fn a_negative_standard_deviation_is_an_error() {
    let header = "time_s,steer_rad,roll_rad,speed_mps,trailer_mass_kg,trailer_mass_sd_t";
    let words =
        ["line 3", "column 6 `trailer_mass_sd_t`", "-500 kg is negative", "leave the cell empty"];
    refused(format!("{header}\n0,0,0,20,3e4,0.5\n1,0,0,20,3e4,-0.5\n"), &words);
}

#[test]
fn a_row_with_too_few_or_too_many_fields_is_an_error_with_both_counts() {
    for (row, found) in [("1,0", 2), ("1,0,0,0", 4), ("1,\"0\"", 2), ("1,0,0,,,", 6), ("x", 1)] {
        let error = read(format!("{ONE}{row}\n")).unwrap_err();
        if row == "x" {
            says(&error, &["`x` is not a number"]);
        } else {
            says(&error, &["line 3", &format!("{found} fields"), "3 columns"]);
        }
    }
}

#[test]
fn time_that_does_not_increase_is_an_error_with_both_times() {
    refused(format!("{ONE}1.5,0,0\n1.25,0,0\n"), &["line 4", "1.25 s", "1.5 s", "sort the log"]);
    refused(format!("{ONE}0,0,0\n"), &["line 3", "column 1 `time_s`", "remove the duplicate"]);
}

#[test]
fn after_a_bad_row_the_next_call_goes_on_with_the_row_after_it() {
    let log = open(format!("{ONE}1,x,0\n2,0\n1,0,0\n-1,0,0\n3,7,7"), &LogOptions::default());
    let rows: Vec<_> = log.unwrap().filter_map(Result::ok).map(|row| row.time_s).collect();
    // The clock was set back at −1 s. The rows after it are in order again.
    assert_eq!(rows, [0.0, 1.0, 3.0]);
}

/// A wrong cell or a clock that was set loses only its own row.
#[test]
fn a_number_that_cannot_be_is_absent_and_told() {
    let csv = format!("{ONE}1,0.1,1e308\n2,0.1,0.02\n3,-45,0.02\n4,0.1,1.5\n");
    let settings = Some(AlignSettings::NONE);
    let options = LogOptions { settings, ..LogOptions::default() };
    // Without the truck's settings, the values are unchanged.
    assert!(read_as(&csv, &LogOptions::default()).unwrap()[1].roll_rad >= 1e308);
    let mut log = open(csv, &options).unwrap();
    let rows: Vec<_> = log.by_ref().map(Result::unwrap).collect();
    let roll: Vec<bool> = rows.iter().map(|row| row.roll_rad.is_nan()).collect();
    assert_eq!(roll, [false, true, false, false, true]);
    assert!(rows[3].steer_rad.is_nan() && (rows[1].steer_rad - 0.1).abs() < 1e-15);
    assert_eq!(log.implausible_values(), 3);
    let remarks = log.remarks();
    assert!(remarks[0].contains("line 5: steer_rad -45 is impossible"), "{remarks:?}");
    assert!(remarks[1].contains("line 3: roll_rad 1") && remarks[1].contains("2 in all"));
    assert_eq!(log.news().len(), 2);
    assert!(log.news().is_empty());
}

/// The remarks about a table of two seconds with this header, whose rows have these values in turn.
fn remarks_of(header: &str, rows: &[&str]) -> Vec<String> {
    remarks_with(&LogOptions::default(), header, rows)
}

fn remarks_with(options: &LogOptions, header: &str, rows: &[&str]) -> Vec<String> {
    let rows = rows.iter().cycle().take(200).enumerate();
    let rows = rows.map(|(k, row)| format!("{},{row}\n", k * 10));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, format!("time_ms,{header}\n{}", rows.collect::<String>())).unwrap();
    let mut log = LogReader::open(&path, options).unwrap();
    assert!(log.by_ref().map(Result::unwrap).count() >= 99, "{header}");
    log.remarks()
}

/// A rate refines a roll angle only; beside another angle it is not used, which is told.
#[test]
fn a_roll_rate_is_used_or_told_not_to_be() {
    let inputs = "steer_rad,lateral_specific_force_mps2,tractor_lateral_specific_force_mps2";
    for other in ["tilt_rad", "suspension_roll_rad", "tractor_suspension_roll_rad"] {
        let remarks = remarks_of(&format!("{inputs},{other},roll_rate_radps"), &["0,0,0,0.01,0"]);
        let name = other.strip_suffix("_rad").unwrap();
        let told = |text: &String| {
            text.starts_with("roll_rate is not used")
                && text.contains(&format!("has {name} instead"))
        };
        assert!(remarks.len() == 1 && told(&remarks[0]), "{other}: {remarks:?}");
        assert_eq!(remarks_of(&format!("{inputs},{other}"), &["0,0,0,0.01"]), [""; 0], "{other}");
    }
    for used in ["roll_rad", "tilt_rad,roll_to_gravity_rad"] {
        let header = format!("{inputs},{used},roll_rate_radps");
        let zeros = vec!["0"; header.split(',').count()].join(",");
        let remarks = remarks_of(&header, &[&zeros]);
        assert!(!remarks.iter().any(|text| text.contains("not used")), "{used}: {remarks:?}");
    }
    // A row has a roll angle or an input.
    let remarks = remarks_of("roll_rad,roll_rate_radps,steer_rad", &["0,0,", ",,0"]);
    assert!(remarks[1].contains("roll_rate is not used: it needs a table"), "{remarks:?}");
}

/// Numbers that stand for no value between those of a slower channel do not give it the raster of the roll angle.
#[test]
fn a_number_that_cannot_be_belongs_to_no_raster() {
    let (header, rows) = ("steer_rad,roll_rad", ["0.1,0.02", "-45,0.02", "-45,0.02"]);
    let settings = Some(AlignSettings::NONE);
    let aligned = |options: &LogOptions| {
        let remarks = remarks_with(options, header, &rows);
        remarks.iter().any(|remark| remark.contains("time stamps of their own"))
    };
    assert!(aligned(&LogOptions { settings, ..LogOptions::default() }));
    assert!(!aligned(&LogOptions::default()));
}

/// What a table says of its signals in some rows holds when its channels are aligned: how exact the mass is, and what is measured on
/// the tractor.
#[test]
fn what_a_table_says_of_its_channels_stays_when_they_are_aligned() {
    let what = "trailer_mass_sd_kg,yaw_rate_on_tractor,lateral_acceleration_on_tractor";
    let rows = (1..200).map(|k| {
        let values = if k % 2 == 0 { "0.01," } else { ",0.1" };
        [(f64::from(k) * 0.01).to_string().as_str(), ",", values, ",,,\n"].concat()
    });
    let head = format!("time_s,roll_rad,steer_rad,{what}\n0,,,300,true,0\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, head + &rows.collect::<String>()).unwrap();
    let mut log = LogReader::open(&path, &LogOptions::default()).unwrap();
    let last = log.by_ref().map(Result::unwrap).last().unwrap();
    assert!(log.remarks()[0].contains("time stamps of their own"), "{:?}", log.remarks());
    assert!(!last.roll_rad.is_nan() && !last.steer_rad.is_nan(), "{last:?}");
    let said =
        [last.trailer_mass_sd_kg, last.yaw_rate_on_tractor, last.lateral_acceleration_on_tractor];
    assert_eq!(said.map(f64::to_bits), [300.0, 1.0, 0.0].map(f64::to_bits));
}

/// The vehicle file's range of masses detects an impossible value of a scale.
#[test]
fn a_mass_that_the_trailer_cannot_have_is_absent() {
    let settings = AlignSettings { mass_range_kg: Some([5400.0, 51_000.0]), ..AlignSettings::NONE };
    let options = LogOptions { settings: Some(settings), ..LogOptions::default() };
    let csv = "time_s,steer_rad,roll_rad,trailer_mass_kg\n0,0,0,0\n1,0,0,20000\n2,0,0,90000\n";
    let mut log = open(csv, &options).unwrap();
    let masses: Vec<f64> = log.by_ref().map(|row| row.unwrap().trailer_mass_kg).collect();
    assert!(masses[0].is_nan() && masses[1].eq(&2e4) && masses[2].is_nan(), "{masses:?}");
    assert!(
        log.remarks()[0]
            .contains("trailer_mass_kg 0 is impossible (the vehicle file allows 5400 to 51000 kg)")
    );
}

#[test]
fn a_log_without_header_or_rows_is_an_error() {
    for csv in ["", "# only\n\n", "\u{feff}"] {
        refused(csv, &["empty", "time_s,steer_rad,roll_rad"]);
    }
    refused("time_s,steer_rad,roll_rad\n# end\n", &["no rows", "export it again"]);
    refused("0,0.1,0.2\n", &["line 1", "numbers instead of a header"]);
}
