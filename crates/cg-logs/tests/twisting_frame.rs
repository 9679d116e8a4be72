//! An independent truck whose frame twists, with a roll sensor over the axles or at the fifth wheel.
#![allow(clippy::unwrap_used)] // helpers of tests

mod common;

use cg_core::Channel;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::EstimateOptions;
use cg_vehicle::belief::Belief;
use cg_vehicle::design::design_with;
use cg_vehicle::{Variant, Vehicle, VehicleError};
use common::{Known, known_in, vehicle};

/// Frame stiffness of the truck's data sheet; the vehicle file's standard deviation of it is 30 %.
const STIFFNESS_NM_PER_RAD: f64 = 3e6;

/// The truck with the place of its roll sensor behind the fifth wheel.
fn van(behind_hitch_m: Option<f64>) -> Vehicle {
    let mut van = vehicle("euro.toml");
    van.trailer.frame_torsional_stiffness_nm_per_rad = Some(STIFFNESS_NM_PER_RAD);
    van.sensors.roll.behind_hitch_m = behind_hitch_m;
    van
}

/// Relative errors of the combined height and of the lateral-acceleration channel. The interval of the
/// former must hold.
fn errors(vehicle: &Vehicle, belief: &Belief, known: &Known) -> [f64; 2] {
    let design = design_with(vehicle, Variant::Complete, belief).unwrap();
    let options = || EstimateOptions {
        trailer_mass_kg: Some(known.load.trailer_mass_kg),
        ..EstimateOptions::default()
    };
    let truth_m = known.load.cg_height_m;
    let combined = known.estimate(&design, None, options());
    let [low, high] = combined.height_ci95_m.unwrap();
    assert!((low..=high).contains(&truth_m), "{}: {low} to {high}", known.log);
    let lateral = known.estimate(&design, Some(Channel::LateralAcceleration), options());
    let errors = [combined, lateral].map(|found| found.height_m.unwrap() / truth_m - 1.0);
    println!("{:28} {:+.2} %, lateral {:+.2} %", known.log, 100.0 * errors[0], 100.0 * errors[1]);
    errors
}

fn calibrated(vehicle: &Vehicle, empty: &Known) -> Belief {
    let log = KnownLog { log: empty.log.clone(), load: KnownLoad::Empty };
    let options = CalibrateOptions::default();
    calibrate::<VehicleError>(vehicle, options, &[log], |_, estimator| {
        empty.feed(estimator);
        Ok(())
    })
    .unwrap()
    .belief()
}

/// With the frame in the file, both sensors are right: uncalibrated the lateral-acceleration channel is
/// within 2 % (with a rigid frame it is 8.6 % low at the rear and 20 % high at the front), and after a
/// calibration with the empty run the laden height is within 1 %.
#[test]
fn the_height_of_a_twisting_trailer_is_known_at_both_ends() {
    let known = known_in("euro-van");
    for (place, behind_hitch_m) in [("rear", None), ("front", Some(0.0))] {
        let van = van(behind_hitch_m);
        let of = |load: &str| {
            known.iter().find(|k| k.log.starts_with(&format!("{place}_{load}"))).unwrap()
        };
        for load in ["p00", "p16"] {
            let [combined, lateral] = errors(&van, &Belief::prior(&van), of(load));
            assert!(combined.abs() < 0.05 && lateral.abs() < 0.02, "{combined} {lateral}");
        }
        let belief = calibrated(&van, of("p00"));
        let [combined, lateral] = errors(&van, &belief, of("p16"));
        assert!(combined.abs() < 0.01 && lateral.abs() < 0.003, "{combined} {lateral}");
    }
}

/// What a rigid frame in the file would do.
#[test]
fn a_frame_that_is_rigid_only_in_the_file_is_wrong_at_both_ends() {
    let (known, rigid) = (known_in("euro-van"), vehicle("euro.toml"));
    let found = known.iter().filter(|k| k.log.contains("p00")).map(|known| {
        let design = cg_vehicle::design::design(&rigid, Variant::Complete).unwrap();
        let channel = Some(Channel::LateralAcceleration);
        let found = known.estimate(
            &design,
            channel,
            EstimateOptions {
                trailer_mass_kg: Some(known.load.trailer_mass_kg),
                ..EstimateOptions::default()
            },
        );
        (known.log.starts_with("front"), found.height_m.unwrap() / known.load.cg_height_m - 1.0)
    });
    for (front, error) in found {
        println!("front {front}: {:+.1} %", 100.0 * error);
        assert!(if front { error > 0.15 } else { error < -0.05 }, "{front} {error}");
    }
}
