//! Column names of other programs, and sensors with reversed signs.

use cg_logs::log::ColumnMap;

use super::*;

const FOREIGN: &str = "Clock,Wheel [deg],Gyro_deg,roll_rad,roll_grad\n2,90,180,9,8\n";

#[test]
fn foreign_names_are_read_with_the_unit_given_or_meant_by_the_name() {
    let maps = ["time=Clock", "steer=Wheel [deg]", "roll=Gyro_deg"];
    let row = read_as(FOREIGN, &options(&maps, &[])).unwrap()[0];
    let pi = std::f64::consts::PI;
    assert_eq!((row.time_s, row.steer_rad, row.roll_rad), (2.0, pi / 2.0, pi));
    let maps = ["time=Clock[ms]", "steer=Wheel [deg][rad]", "roll=Gyro_deg[rad]"];
    let row = read_as(FOREIGN, &options(&maps, &[])).unwrap()[0];
    assert_eq!((row.time_s, row.steer_rad, row.roll_rad), (0.002, 90.0, 180.0));
}

#[test]
fn a_column_asked_for_that_is_not_there_is_an_error_with_the_nearest_name() {
    let error = read_as(FOREIGN, &options(&["time=Cloak"], &[])).unwrap_err();
    says(&error, &["line 1", "time=Cloak", "Gyro_deg", "⟨columns time=Clock[s]"]);
}

#[test]
fn options_that_claim_one_column_or_one_signal_twice_are_an_error() {
    let error = read_as(FOREIGN, &options(&["time=Clock", "steer=Clock"], &[])).unwrap_err();
    says(&error, &["column 1 `Clock`", "time", "steer", "remove one"]);
    let error = read_as(FOREIGN, &options(&["roll=Gyro_deg", "roll=roll_rad"], &[])).unwrap_err();
    says(&error, &["column 3 `Gyro_deg`", "column 4 `roll_rad`"]);
    let twins = "Clock,Clock,steer_rad,roll_rad\n0,0,0,0\n";
    let error = read_as(twins, &options(&["time=Clock"], &[])).unwrap_err();
    says(&error, &["column 1 `Clock`", "column 2 `Clock`"]);
}

#[test]
fn a_flipped_sensor_changes_sign_and_no_other_does() {
    let flipped = options(&[], &[Signal::Roll, Signal::Roll]);
    let row = read_as(ONE, &flipped).unwrap()[0];
    assert_eq!((row.steer_rad, row.roll_rad), (0.1, 0.2));
}

#[test]
fn flipping_what_is_not_there_or_has_no_direction_is_an_error() {
    let error = read_as(ONE, &options(&[], &[Signal::Tilt])).unwrap_err();
    says(&error, &["tilt cannot be flipped", "no such signal", "⟨flip⟩"]);
    let error = read_as(ONE, &options(&[], &[Signal::Time])).unwrap_err();
    says(&error, &["time cannot be flipped", "no direction"]);
}

#[test]
fn the_log_says_which_signals_it_has() {
    let log = open("roll_deg,x,time_s,steer_rad\n0,0,0,0\n", &LogOptions::default()).unwrap();
    assert_eq!(log.signals(), [Signal::Time, Signal::Steer, Signal::Roll]);
    assert!(log.has(Signal::Roll) && !log.has(Signal::Tilt));
}

#[test]
fn a_malformed_option_is_an_error_that_says_how_to_write_it() {
    for (text, words) in [
        ("roll", "SIGNAL=NAME[UNIT]"),
        ("roll=", "SIGNAL=NAME[UNIT]"),
        ("roll=[deg]", "SIGNAL=NAME[UNIT]"),
        ("rol=Gyro[deg]", "the signals are time, steer"),
        ("roll=Gyro[km/h]", "`km/h` is not a unit of roll; the units are rad, deg"),
        ("roll=Gyro[kmh]", "`kmh` is not a unit of roll; the units are rad, deg"),
        ("roll=Gyro_kmh", "give the unit: roll=Gyro_kmh[rad]"),
    ] {
        let message = text.parse::<ColumnMap>().unwrap_err().to_string();
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn every_signal_is_written_as_it_is_read() {
    for signal in Signal::ALL {
        assert_eq!(signal.to_string().parse(), Ok(signal));
    }
}
