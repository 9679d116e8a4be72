//! Tables as other programs write them: units in the header, decimal commas, Latin-1, points in time.

use super::*;

/// 90 degrees in radians, as the reader converts them.
const RIGHT: f64 = std::f64::consts::FRAC_PI_2;

#[test]
fn units_may_stand_in_brackets_or_in_a_row_of_their_own() {
    let brackets = "Time [ms],Steer [deg],Roll (°),Speed [km/h],Speed (rpm)\n500,90,90,36,9\n";
    let row = "Time;steer;Roll;Speed;Note\n[ms];[deg];°;km/h;-\n500;90;90;36;x\n";
    let named = "time_ms,steer_deg,roll_deg,speed_kmh\n[ms],deg,°,km/h\n500,90,90,36\n";
    for csv in [brackets, row, named] {
        let mut log = open(csv, &LogOptions::default()).unwrap();
        let row = log.next_row().unwrap().unwrap();
        assert_eq!((row.time_s, row.steer_rad, row.roll_rad), (0.5, RIGHT, RIGHT), "{csv}");
        assert_eq!(row.speed_mps, 10.0, "{csv}");
        assert!(log.has(Signal::Speed) && log.next_row().unwrap().is_none());
    }
}

/// Also one whose name begins with that of another signal, as `roll_rate`.
#[test]
fn every_signal_may_have_its_unit_beside_its_name() {
    let units = Signal::ALL.map(|signal| {
        let column = signal.column();
        column[signal.name().len() + 1..].to_owned()
    });
    let names = Signal::ALL.map(Signal::name);
    let brackets = names.iter().zip(&units).map(|(name, unit)| format!("{name} [{unit}]"));
    let brackets = brackets.collect::<Vec<_>>().join(",");
    let below = format!("{}\n{}", names.join(","), units.join(","));
    let values = ["1"; Signal::COUNT].join(",");
    for header in [brackets, below] {
        let mut log = open(format!("{header}\n{values}\n"), &LogOptions::default()).unwrap();
        let row = log.next_row().unwrap().unwrap();
        for signal in Signal::ALL {
            assert!(log.has(signal) && row.get(signal) == 1.0, "{signal}: {header}");
        }
    }
    refused("time_s,steer_rad,roll_rad,roll_rate\n0,0,0,0\n", &["`roll_rate`", "radps, degps"]);
    refused("time_s,steer_rad,roll_rate [kg]\n0,0,0\n", &["`roll_rate [kg]`", "radps, degps"]);
}

#[test]
fn the_unit_of_the_file_holds_for_a_named_column_unless_another_is_given() {
    let csv = "Clock;Wheel;Gyro\nms;deg;deg\n500;90;90\n";
    let row = read_as(csv, &options(&["time=Clock", "steer=Wheel", "roll=Gyro"], &[])).unwrap()[0];
    assert_eq!((row.time_s, row.steer_rad, row.roll_rad), (0.5, RIGHT, RIGHT));
    let maps = ["time=Clock", "steer=Wheel", "roll=Gyro[rad]"];
    assert_eq!(read_as(csv, &options(&maps, &[])).unwrap()[0].roll_rad, 90.0);
    let brackets = csv.replace("\nms;deg;deg", "").replace("Gyro", "Gyro [deg]");
    let maps = ["time=Clock[ms]", "steer=Wheel[deg]", "roll=Gyro"];
    let row = read_as(&brackets, &options(&maps, &[])).unwrap()[0];
    assert_eq!((row.time_s, row.roll_rad), (0.5, RIGHT));
    // Two units of one column, and one that the signal cannot have.
    refused("time_s,steer_rad,roll_deg\ns,rad,rad\n0,0,0\n", &["column 3 `roll_deg`", "unit"]);
    let error = read_as(csv, &options(&["speed=Gyro"], &[])).unwrap_err();
    says(&error, &["column 3 `Gyro`", "the units of speed are mps, kmh"]);
}

/// A known name with a unit that nobody knows, which is not what a note in parentheses is.
#[test]
fn a_unit_that_is_not_understood_is_an_error() {
    for (name, units) in [("YawRate [1/s]", "radps, degps"), ("TrailerMass [kN]", "kg, t")] {
        let csv = format!("time_s,steer_rad,roll_rad,{name}\n0,0.1,0,0\n");
        refused(&csv, &[&format!("column 4 `{name}`"), "unknown unit", units]);
    }
    for name in ["YawRate (filtered)", "Temperature [1/s]", "Roll [V]"] {
        let row = read(format!("time_s,steer_rad,roll_rad,{name}\n0,0.1,0,0\n")).unwrap()[0];
        assert_eq!((row.steer_rad, row.yaw_rate_radps.is_nan()), (0.1, true), "{name}");
    }
}

#[test]
fn units_may_have_their_usual_spelling() {
    let csv = "time_s,steer_rad,roll_rad,v\n0,0,0,36\n";
    for unit in ["km/h", "kmh", "KM/H", "kph"] {
        let row = read_as(csv, &options(&[&format!("speed=v[{unit}]")], &[])).unwrap()[0];
        assert_eq!(row.speed_mps, 10.0, "{unit}");
    }
}

#[test]
fn a_proposal_has_the_unit_of_the_file_and_no_rate_is_proposed_as_an_angle() {
    let ms = "Time stamp [ms],steer_rad,roll_rad\n0,0,0\n";
    refused(ms, &["⟨columns time=Time stamp[ms]⟩"]);
    for rate in ["Rollrate_degps", "Roll velocity [deg/s]", "RollRate"] {
        let error = read(format!("time_s,steer_rad,{rate}\n0,0,0\n")).unwrap_err().to_string();
        assert!(error.contains("⟨columns roll=NAME[deg]⟩"), "{error}");
    }
}

#[test]
fn decimals_may_have_a_comma_where_it_separates_no_fields() {
    for delimiter in [";", "\t"] {
        let csv =
            "time_s;steer_rad;roll_rad\n0,5;1,5e-1;\"-0,25\"\n1;0;-1,25\n".replace(';', delimiter);
        let rows = read(&csv).unwrap();
        assert_eq!((rows[0].time_s, rows[0].steer_rad, rows[0].roll_rad), (0.5, 0.15, -0.25));
        assert_eq!((rows[1].time_s, rows[1].roll_rad), (1.0, -1.25));
    }
    // 25,000 kg are 25 t or 25 kg: nobody knows, if other numbers have a point.
    let words = ["column 3 `roll_rad`", "another decimal sign", "without thousands separators"];
    refused("time_s;steer_rad;roll_rad\n0.5;0;0\n1.5;0;25,000\n", &words);
    refused("time_s;steer_rad;roll_rad\n0,5;0;0\n1,5;0;0.25\n", &words);
    refused("time_s;steer_rad;roll_rad\n0;0;1,000,000\n", &["`1,000,000`", "not a number"]);
}

#[test]
fn a_header_in_latin_1_is_read() {
    let csv = b"time_s;steer_rad;Neigung [\xb0]\n0;0,5;90\n";
    let row = read_as(csv, &options(&["roll=Neigung"], &[])).unwrap()[0];
    assert_eq!((row.steer_rad, row.roll_rad), (0.5, RIGHT));
}

#[test]
#[allow(clippy::float_cmp, reason = "eighths of a second are exact")]
fn points_in_time_are_unix_time_whatever_the_column_is_called() {
    // date -u -d "2024-05-01 12:00:00" +%s
    let noon_s = 1_714_564_800.0;
    for (name, early, late) in [
        ("Time", "2024-05-01 12:00:00.125", "2024-05-01 12:00:00.25"),
        ("", "2024-05-01 14:00:00.125+02:00", "2024-05-01 14:00:00.250+02:00"),
        ("recorded", "\"2024-05-01T12:00:00.125Z\"", "\"2024-05-01T12:00:00.25Z\""),
        ("Zeit", "01.05.2024 12:00:00.125", "01.05.2024 12:00:00.250"),
    ] {
        let csv = format!("{name},steer_rad,roll_rad\n{early},1,2\n{late},3,4\n");
        let rows = read(&csv).unwrap();
        let times: Vec<f64> = rows.iter().map(|row| row.time_s - noon_s).collect();
        assert_eq!((times, rows[1].roll_rad), (vec![0.125, 0.25], 4.0), "{csv}");
    }
    let german = "Zeit;steer;roll\n-;deg;deg\n12:00:00,125;1,5;90\n";
    let row = read(german).unwrap()[0];
    assert_eq!((row.time_s, row.roll_rad), (43_200.125, RIGHT));
    let two = "begin,end,steer_rad,roll_rad\n12:00:00,12:00:01,0,0\n";
    refused(two, &["no column for time_s"]);
    let maps = options(&["time=end"], &[]);
    assert_eq!(read_as(two, &maps).unwrap()[0].time_s, 43_201.0);
    let first = "Time,steer_rad,roll_rad\n12:00:00,1,2\nnoon,3,4\n";
    refused(first, &["line 3", "column 1 `Time`", "`noon`"]);
}

#[test]
fn other_formats_are_named_with_what_to_do() {
    let python = "Python package reads it";
    for (head, words) in [
        (&b"LOGG\x90\0\0\0"[..], ["BLF", python]),
        (b"MDF     4.10    ", ["MF4", python]),
        (b"MATLAB 5.0 MAT-file", ["MATLAB", python]),
        (b"\x89HDF\r\n\x1a\n", ["HDF5", python]),
        (b"ARROW1\0\0", ["Feather", python]),
        (b";$FILEVERSION=2.1\n", ["TRC", python]),
        (b"PK\x03\x04\x14\0", ["Excel", "save it as CSV"]),
    ] {
        refused(head, &words);
    }
}

/// A unit in brackets and another one in the row below: neither is used.
#[test]
fn two_units_of_a_column_must_be_the_same() {
    let log = |unit: &str| {
        format!(
            "time_s,steer_rad,roll_rad,Speed [km/h],v [km/h]\ns,rad,rad,{unit},{unit}\n0,0,0,36,72\n"
        )
    };
    for same in ["km/h", "kmh", "-"] {
        assert!((read(log(same)).unwrap()[0].speed_mps - 10.0).abs() < 1e-9, "{same}");
    }
    let reasons =
        ["line 2, column 4 `Speed [km/h]`", "two different ones", "⟨columns speed=NAME[kmh]⟩"];
    refused(log("mph"), &reasons);
    let told = read_as(log("mph"), &options(&["speed=v"], &[])).unwrap_err().to_string();
    assert!(told.contains("two different ones"), "{told}");
    let given = read_as(log("mph"), &options(&["speed=v[kmh]"], &[])).unwrap();
    assert!((given[0].speed_mps - 20.0).abs() < 1e-9);
}
