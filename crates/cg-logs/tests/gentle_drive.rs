//! A gentle drive of the second independent truck, whose turns give heights that differ by 1 to 2 %: it has one load.
#![allow(clippy::unwrap_used)]

use cg_core::AlignSettings;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::LogEstimator;
use cg_logs::log::LogRow;
use cg_vehicle::design::design_with;
use cg_vehicle::{Variant, VehicleError};
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

use crate::common::{calibrated, known_in, vehicle};

/// What sensors do to a row.
type Sensors<'a> = &'a mut dyn FnMut(LogRow) -> LogRow;

/// White noise of usual sensors: 30 dB of a roll angle of 2 degrees, 1 mrad of the wheels, 0.05 m/s², 2 mrad/s, 0.05 m/s.
fn noisy(seed: u64) -> impl FnMut(LogRow) -> LogRow {
    let mut source = StdRng::seed_from_u64(seed);
    move |row| {
        let mut white = |sd: f64| -> f64 {
            let one: f64 = StandardNormal.sample(&mut source);
            sd * one
        };
        LogRow {
            roll_rad: row.roll_rad + white(5e-4),
            steer_rad: row.steer_rad + white(1e-3),
            lateral_acceleration_mps2: row.lateral_acceleration_mps2 + white(0.05),
            yaw_rate_radps: row.yaw_rate_radps + white(2e-3),
            speed_mps: row.speed_mps + white(0.05),
            ..row
        }
    }
}

/// With a speed in steps of 1 km/h, and with noise, no message says that the load changed; with noise the drive can be a run of a
/// calibration.
#[test]
fn a_gentle_drive_has_one_load() {
    let vehicle = vehicle("euro.toml");
    let known = known_in("euro");
    let pick = |name: &str| known.iter().find(|known| known.log.starts_with(name)).unwrap();
    let (empty, drive) = (pick("A_p00"), pick("F_drive2"));
    let design = |runs: &[_]| {
        design_with(&vehicle, Variant::Complete, &calibrated(&vehicle, runs).belief()).unwrap()
    };
    let designs = [design(&[empty]), design(&[empty, pick("A_p24")])];
    let mut steps = |row: LogRow| LogRow { speed_mps: (row.speed_mps * 3.6).round() / 3.6, ..row };
    let mut noise = [1, 2, 3, 4].map(noisy);
    let [a, b, c, d] = &mut noise;
    let all: [Sensors<'_>; 5] = [&mut steps, a, b, c, d];
    for (place, sensors) in all.into_iter().enumerate() {
        let rows: Vec<LogRow> = drive.rows().into_iter().map(&mut *sensors).collect();
        for design in &designs {
            let mut estimator =
                LogEstimator::from_design(design, AlignSettings::NONE, drive.weighed());
            rows.iter().for_each(|row| {
                estimator.push(row).unwrap();
            });
            let found = estimator.finish();
            let (height_m, sd_m) = (found.height_m.unwrap(), found.height_sd_m.unwrap());
            let error_m = height_m - drive.load.cg_height_m;
            println!("{place}: {:+.2} %, {:?}", 100.0 * error_m / height_m, found.messages);
            assert!(error_m.abs() < 1.96 * sd_m, "{place}: {height_m:.3} ± {sd_m:.3} m");
            assert!(!found.messages.iter().any(|one| one.contains("load changed")), "{place}");
        }
        let logs = [empty, drive].map(|known| KnownLog {
            log: known.log.clone(),
            load: KnownLoad::exact(known.load.cg_height_m, Some(known.load.trailer_mass_kg)),
        });
        let feed = |log: &KnownLog, estimator: &mut LogEstimator| {
            let of_log = if log.log == drive.log { rows.clone() } else { empty.rows() };
            of_log.iter().for_each(|row| {
                estimator.push(row).unwrap();
            });
            Ok::<_, VehicleError>(())
        };
        let calibration = calibrate(&vehicle, CalibrateOptions::default(), &logs, feed);
        // A speed that is rounded for a whole drive at one speed makes the steer angle's ratio another one.
        assert!(place == 0 || calibration.is_ok(), "{place}: {calibration:?}");
    }
}
