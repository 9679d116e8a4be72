//! A recorded drive that begins with the ignition key, as CSV, as CAN frames and in single
//! precision.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use std::path::Path;

use cg_core::{AlignSettings, Estimator, FilteredArx, Prior, Sample, Settings};
use cg_logs::estimate::{
    ChannelEstimate, EstimateOptions, LogEstimate, LogEstimator, RoadChoice, Verdict,
};
use cg_logs::log::{CandumpWriter, LogOptions, LogReader, LogRow, LogWriter, Signal};
use cg_output::{Files, Kind};
use cg_vehicle::design::design;
use cg_vehicle::{Variant, Vehicle};

const STEERING_RATIO: f64 = 20.0;
/// Duration of standing before the drive.
const STANDING_S: f64 = 30.0;

fn truck() -> Vehicle {
    let mut truck = common::vehicle("kraz.toml");
    truck.steering_ratio = Some(STEERING_RATIO);
    truck
}

/// The truck stands while the sensors start one after the other and the steering angle increases.
/// It then accelerates for half a minute, and the recorded drive follows.
fn from_the_key_on(drive: &[LogRow]) -> Vec<LogRow> {
    let first = drive[0];
    let standing = (0..3000).map(|k| {
        let time_s = f64::from(k) * 0.01;
        let seen = |from_s: f64, value: f64| if time_s >= from_s { value } else { f64::NAN };
        LogRow {
            time_s,
            roll_rad: seen(1.0, first.roll_rad),
            steer_rad: seen(2.0, first.steer_rad + 0.2 - 0.2 * ((time_s - 2.0) / 8.0).min(1.0)),
            speed_mps: seen(4.0, 0.0),
            yaw_rate_radps: seen(6.0, 0.0),
            lateral_acceleration_mps2: seen(9.0, 0.0),
            trailer_mass_kg: f64::NAN,
            ..LogRow::ABSENT
        }
    });
    let away = (0..2000).map(|k| LogRow {
        time_s: STANDING_S + f64::from(k) * 0.01,
        speed_mps: first.speed_mps * f64::from(k) / 2000.0,
        yaw_rate_radps: 0.0,
        lateral_acceleration_mps2: 0.0,
        ..first
    });
    let recorded = drive
        .iter()
        .map(|row| LogRow { time_s: STANDING_S + 20.0 + row.time_s - first.time_s, ..*row });
    standing.chain(away).chain(recorded).collect()
}

fn estimate(rows: &[LogRow]) -> LogEstimate {
    // The roll angle of a bus is relative to gravity.
    let options = EstimateOptions { road: Some(RoadChoice::FLAT), ..EstimateOptions::default() };
    let mut estimator = LogEstimator::new(&truck(), options).unwrap();
    for row in rows {
        estimator.push(row).unwrap();
    }
    estimator.finish()
}

/// A row as a sample in single precision, as on a microcontroller.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn single(row: &LogRow) -> Sample<f32> {
    let wide = row.sample((row.time_s * 1e6).round() as u64, &AlignSettings::NONE);
    Sample {
        time_us: wide.time_us,
        steer_rad: wide.steer_rad as f32,
        roll_rad: wide.roll_rad as f32,
        tilt_rad: wide.tilt_rad as f32,
        speed_mps: wide.speed_mps as f32,
        lateral_acceleration_mps2: wide.lateral_acceleration_mps2 as f32,
        yaw_rate_radps: wide.yaw_rate_radps as f32,
        trailer_mass_kg: wide.trailer_mass_kg as f32,
        ..Sample::absent(wide.time_us)
    }
}

/// The rows, written as CSV and read back.
fn through_csv(folder: &Path, files: &mut Files, rows: &[LogRow]) -> Vec<LogRow> {
    let csv = folder.join("drive.csv");
    let columns = [
        Signal::Time,
        Signal::Steer,
        Signal::Roll,
        Signal::Speed,
        Signal::LateralAcceleration,
        Signal::YawRate,
        Signal::TrailerMass,
    ];
    let target = files.writes("--output", &csv, Kind::Log).unwrap();
    let mut writer = LogWriter::create(&target, &[], &columns).unwrap();
    for row in rows {
        writer.write_row(row).unwrap();
    }
    writer.finish().unwrap();
    LogReader::open(&csv, &LogOptions::default()).unwrap().map(Result::unwrap).collect()
}

#[test]
fn the_height_is_that_of_the_drive() {
    let known = common::known();
    let known = known.iter().find(|known| known.log.contains("drive1")).unwrap();
    let drive = known.rows();
    let plain = estimate(&drive);
    let rows = from_the_key_on(&drive);
    let expected_m = plain.height_m.unwrap();
    let same = |name: &str, found_m: f64, share: f64| {
        println!("{name}: {found_m:.5} m for {expected_m:.5} m");
        assert!((found_m / expected_m - 1.0).abs() < share, "{name}: {found_m} for {expected_m}");
    };
    let whole = estimate(&rows);
    // The increasing steering angle of the standing truck is not a turn.
    let good = |answer: &LogEstimate| {
        answer.maneuvers.iter().filter(|one| one.status == Verdict::Ok).count()
    };
    assert_eq!(good(&whole), good(&plain));
    // Of the beginning, only two seconds of straight driving are part of a maneuver. They say a little more of the
    // offset of the steer angle, which moves the height by less than a quarter of its random error. The lateral acceleration has
    // none; but the means begin at other samples, and a line between them misses (ω τ)²/12 of the motion, 3e-4 at
    // 1.5 rad/s.
    let random_sd_m = plain.height_random_sd_m.unwrap();
    same("in memory", whole.height_m.unwrap(), 0.25 * random_sd_m / expected_m);
    let [before_m, after_m] = [&plain, &whole].map(|answer| {
        let of_channel = |one: &&ChannelEstimate| one.channel == "lateral-acceleration";
        answer.channels.iter().find(of_channel).unwrap().height_m.unwrap()
    });
    assert!((after_m / before_m - 1.0).abs() < 3e-4, "{after_m} {before_m}");

    // CSV: the numbers are read back unchanged.
    let folder = tempfile::tempdir().unwrap();
    let mut files = Files::new(false);
    let of_csv = estimate(&through_csv(folder.path(), &mut files, &rows)).height_m.unwrap();
    assert!((of_csv / whole.height_m.unwrap() - 1.0).abs() < 1e-9);

    // CAN frames: each signal has its own time stamps and is rounded to its resolution.
    let log = folder.path().join("drive.log");
    let target = files.writes("--output", &log, Kind::Frames).unwrap();
    let mut writer = CandumpWriter::create(&target, STEERING_RATIO).unwrap();
    for row in &rows {
        writer.write_row(row).unwrap();
    }
    writer.finish().unwrap();
    let options = LogOptions { settings: Some(truck().align_settings()), ..LogOptions::default() };
    // The drive has the yaw rate of the trailer.
    let of_trailer = |row: LogRow| LogRow { yaw_rate_on_tractor: 0.0, ..row };
    let frames = LogReader::open(&log, &options).unwrap();
    let read: Vec<LogRow> = frames.map(|row| of_trailer(row.unwrap())).collect();
    same("as CAN frames", estimate(&read).height_m.unwrap(), 1e-2);

    // As on the microcontroller.
    let design = design(&truck(), Variant::Complete).unwrap().cast::<f32>();
    let mut chip: Estimator<f32, FilteredArx<f32>> =
        Estimator::new(design, Settings::truck(), Prior::standard());
    for row in &rows {
        chip.push(&single(row)).unwrap();
    }
    chip.finish();
    let chip_m = f64::from(chip.combined_height().unwrap().height_m.value);
    let whole_m = whole.height_m.unwrap();
    assert!((chip_m / whole_m - 1.0).abs() < 1e-3, "in single precision: {chip_m} for {whole_m}");
}
