//! Runs of a calibration whose logs an estimate would not use, or of which it would say something.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{Known, known, vehicle};
use cg_core::{Channel, Measured};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::log::LogRow;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::{Variant, VehicleError};

/// The empty run of the independent truck, and copies of its run with 20 t at a height that is known to 5 cm, whose rows are
/// changed.
fn calibration_of(
    laden: usize,
    options: CalibrateOptions,
    change: impl Fn(usize, &mut LogRow),
) -> Result<Calibration, VehicleError> {
    let truck = vehicle("kraz.toml");
    let all = known();
    let pick = |name: &str| -> &Known { all.iter().find(|one| one.log.starts_with(name)).unwrap() };
    let (empty, full) = (pick("A_p00_v50_L"), pick("A_p20_h190"));
    let height_m = Measured { value: full.load.cg_height_m, sd: 0.05 };
    let mut logs = vec![KnownLog { log: empty.log.clone(), load: KnownLoad::Empty }];
    logs.extend((0..laden).map(|number| KnownLog {
        log: format!("laden {number}"),
        load: KnownLoad::Laden { height_m, trailer_mass: None },
    }));
    calibrate(&truck, options, &logs, |log, estimator| {
        let is_laden = log.log.starts_with("laden");
        let of = if is_laden { full } else { empty };
        for (k, mut row) in of.rows().into_iter().enumerate() {
            row.trailer_mass_kg = of.load.trailer_mass_kg;
            if is_laden {
                change(k, &mut row);
            }
            estimator.push(&row).unwrap();
        }
        Ok(())
    })
}

const ALL: CalibrateOptions = CalibrateOptions {
    variant: Variant::Complete,
    method: cg_logs::estimate::Method::Filtered,
    channel: None,
    procedure: cg_vehicle::calibration::Procedure::MaximumAPosteriori,
    part: cg_vehicle::calibration::Part::Vehicle,
    lift_axle: None,
    force: false,
};

/// Every tenth roll angle is a zero that a logger wrote for a missing one. An estimate has no height, and a calibration that took
/// it would make all later ones too high.
#[test]
fn a_run_that_an_estimate_would_not_use_is_refused() {
    let zeros = |k: usize, row: &mut LogRow| {
        if k.is_multiple_of(10) {
            row.roll_rad = 0.0;
        }
    };
    for force in [false, true] {
        let refused = calibration_of(1, CalibrateOptions { force, ..ALL }, zeros).unwrap_err();
        let told = refused.to_string();
        assert!(told.starts_with("laden 0: ") && told.contains("exactly 0"), "{told}");
        assert!(told.contains("record the run again"), "{told}");
    }
    assert!(calibration_of(1, ALL, |_, _| ()).is_ok());
    let statement_of = |channel: Channel, change: fn(usize, &mut LogRow)| {
        let options = CalibrateOptions { channel: Some(channel), ..ALL };
        calibration_of(1, options, change).unwrap().statement
    };
    // Of one channel it is told.
    let told = statement_of(Channel::LateralAcceleration, zeros);
    assert!(told.iter().any(|line| line.starts_with("laden 0: ") && line.contains("exactly 0")));
    assert!(!statement_of(Channel::Steer, |_, _| ()).iter().any(|line| line.contains("exactly 0")));
    // A signal of another channel does not hinder.
    let zeros = |k: usize, row: &mut LogRow| {
        if k.is_multiple_of(10) {
            row.lateral_acceleration_mps2 = 0.0;
        }
    };
    assert!(calibration_of(1, ALL, zeros).is_err());
    statement_of(Channel::Steer, zeros);
}

/// What an estimate says of a log that it uses is in the statement.
#[test]
fn what_an_estimate_says_of_a_run_is_in_the_statement() {
    let without_speed = |_: usize, row: &mut LogRow| row.speed_mps = f64::NAN;
    let told = |change: fn(usize, &mut LogRow)| {
        let statement = calibration_of(1, ALL, change).unwrap().statement;
        statement
            .into_iter()
            .filter(|line| line.contains("no speed in the log"))
            .collect::<Vec<_>>()
    };
    let told_without = told(without_speed);
    assert!(
        told_without.len() == 1
            && told_without[0].starts_with("laden 0: ")
            && told_without[0].ends_with("add the speed to the log"),
        "{told_without:?}"
    );
    assert!(told(|_, _| ()).is_empty());
}

/// Five drives with a load whose height was measured once do not know it better than one: the laden ratio is as uncertain as the
/// height makes it. As five measurements they would halve it.
#[test]
fn a_height_that_was_measured_once_counts_once() {
    let gain_sd = |laden: usize| {
        let calibration = calibration_of(laden, ALL, |_, _| ()).unwrap();
        let truck = vehicle("kraz.toml");
        let load = truck.reference_load();
        let belief = calibration.belief();
        let speed_mps = truck.nominal_speed_mps;
        let covariance = belief.ratio_covariance(&truck, Variant::Complete, speed_mps, load);
        let place = Channel::LateralAcceleration.index();
        covariance.unwrap()[place][place].sqrt()
    };
    let [one, five] = [1, 5].map(gain_sd);
    // What the model leaves out averages out over runs, what the height does not know does not.
    assert!(five < one && five > 0.8 * one, "{one} {five}");
}
