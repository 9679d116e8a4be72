//! An independent truck whose frame twists, with a roll sensor over the axles or at the fifth wheel.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common::{Known, known_in, vehicle};
use cg_core::Channel;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;
use cg_vehicle::belief::Belief;
use cg_vehicle::design::design_with;
use cg_vehicle::second_sensor::SecondShare;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

/// Frame stiffness of the truck's data sheet; the vehicle file's standard deviation of it is 30 %.
const STIFFNESS_NM_PER_RAD: f64 = 3e6;

/// Where its roll sensors are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Rear,
    Front,
    Both,
}

/// The truck with its roll sensors; two of them have the best share.
fn van(place: Place) -> Vehicle {
    let mut van = vehicle("euro.toml");
    van.trailer.frame_torsional_stiffness_nm_per_rad = Some(STIFFNESS_NM_PER_RAD);
    let roll = &mut van.sensors.roll;
    [roll.behind_hitch_m, roll.second_behind_hitch_m] = match place {
        Place::Rear => [None, None],
        Place::Front => [Some(0.0), None],
        Place::Both => [Some(0.0), Some(7.7)],
    };
    van.sensors.roll.second_share = SecondShare::best(&van).unwrap().map(|best| best.share);
    van
}

/// The drive with a load, as the sensors at this place saw it.
struct Drive {
    load: Load,
    rows: Vec<LogRow>,
}

impl Drive {
    fn of(known: &[Known], place: Place, load: &str) -> Self {
        let of =
            |end: &str| known.iter().find(|k| k.log.starts_with(&format!("{end}_{load}"))).unwrap();
        let (rear, front) = (of("rear"), of("front"));
        let rows = match place {
            Place::Rear => rear.rows(),
            Place::Front => front.rows(),
            Place::Both => {
                let both = front.rows().into_iter().zip(rear.rows());
                both.map(|(row, rear)| LogRow { second_roll_rad: rear.roll_rad, ..row }).collect()
            }
        };
        Self { load: rear.load, rows }
    }

    fn feed(&self, estimator: &mut LogEstimator) {
        for row in &self.rows {
            estimator.push(row).unwrap();
        }
    }

    fn estimate(
        &self,
        vehicle: &Vehicle,
        belief: &Belief,
        channel: Option<Channel>,
    ) -> LogEstimate {
        let design = design_with(vehicle, Variant::Complete, belief).unwrap();
        let trailer_mass_kg = Some(self.load.trailer_mass_kg);
        let options = EstimateOptions { channel, trailer_mass_kg, ..EstimateOptions::default() };
        let mut estimator = LogEstimator::from_design(&design, vehicle.align_settings(), options);
        self.feed(&mut estimator);
        estimator.finish()
    }
}

/// Relative errors of the combined height and of the lateral-acceleration channel. The interval of the
/// former must hold.
fn errors(vehicle: &Vehicle, belief: &Belief, drive: &Drive) -> [f64; 2] {
    let truth_m = drive.load.cg_height_m;
    let combined = drive.estimate(vehicle, belief, None);
    let [low, high] = combined.height_ci95_m.unwrap();
    assert!((low..=high).contains(&truth_m), "{low} to {high}, {truth_m}");
    let lateral = drive.estimate(vehicle, belief, Some(Channel::LateralAcceleration));
    let errors = [combined, lateral].map(|found| found.height_m.unwrap() / truth_m - 1.0);
    println!("{truth_m:.2} m {:+.2} %, lateral {:+.2} %", 100.0 * errors[0], 100.0 * errors[1]);
    errors
}

fn calibrated(vehicle: &Vehicle, empty: &Drive) -> Belief {
    let log = KnownLog { log: "empty".to_owned(), load: KnownLoad::Empty };
    let options = CalibrateOptions::default();
    calibrate::<VehicleError>(vehicle, options, &[log], |_, estimator| {
        empty.feed(estimator);
        Ok(())
    })
    .unwrap()
    .belief()
}

/// With the frame in the file, all sensors are right: uncalibrated the lateral-acceleration channel is
/// within 2 % (with a rigid frame it is 8.6 % low at the rear and 20 % high at the front), and after a
/// calibration with the empty run the laden height is within 0.7 %, and 0.3 % in that channel.
#[test]
fn the_height_of_a_twisting_trailer_is_known_at_both_ends() {
    let known = known_in("euro-van");
    for place in [Place::Rear, Place::Front, Place::Both] {
        let van = van(place);
        println!("{place:?} {:?}", van.sensors.roll);
        let [empty, laden] = ["p00", "p16"].map(|load| Drive::of(&known, place, load));
        for drive in [&empty, &laden] {
            let [combined, lateral] = errors(&van, &Belief::prior(&van), drive);
            assert!(combined.abs() < 0.05 && lateral.abs() < 0.02, "{combined} {lateral}");
        }
        let [combined, lateral] = errors(&van, &calibrated(&van, &empty), &laden);
        assert!(combined.abs() < 0.007 && lateral.abs() < 0.003, "{combined} {lateral}");
    }
}

/// A file and a log with other sensors, and a sensor that is mounted the wrong way round, are told.
#[test]
fn two_sensors_need_a_file_and_a_log_of_both() {
    let known = known_in("euro-van");
    let messages = |vehicle: &Vehicle, drive: &Drive| {
        let estimate = drive.estimate(vehicle, &Belief::prior(vehicle), None);
        (estimate.height_m, estimate.messages.join("; "))
    };
    let both = Drive::of(&known, Place::Both, "p16");
    let (height_m, told) = messages(&van(Place::Front), &both);
    assert!(height_m.is_some() && told.contains("sensors.roll.second_share"), "{told}");
    let (height_m, told) = messages(&van(Place::Both), &Drive::of(&known, Place::Front, "p16"));
    assert!(height_m.is_none() && told.contains("one of the two sensors"), "{told}");
    // Without a share, the file means that the roll angle is the mean of both, which this one is not.
    let mut mean = van(Place::Both);
    mean.sensors.roll.second_share = None;
    let (height_m, told) = messages(&mean, &both);
    assert!(height_m.is_none() && told.contains("add second_share"), "{told}");
    let lateral = Some(Channel::LateralAcceleration);
    assert_eq!(both.estimate(&mean, &Belief::prior(&mean), lateral).height_m, None);
    // Nor is it if the second sensor has a value in some rows only.
    let mut seldom = Drive { load: both.load, rows: both.rows.clone() };
    for row in seldom.rows.iter_mut().skip(100) {
        row.second_roll_rad = f64::NAN;
    }
    let (height_m, told) = messages(&mean, &seldom);
    assert!(height_m.is_none() && told.contains("add second_share"), "{told}");
    // A log with their mean has a height.
    let mut one = Drive { load: both.load, rows: both.rows.clone() };
    for row in &mut one.rows {
        row.roll_rad = 0.5 * (row.roll_rad + row.second_roll_rad);
        row.second_roll_rad = f64::NAN;
    }
    let [combined, _] = errors(&mean, &Belief::prior(&mean), &one);
    assert!(combined.abs() < 0.05, "{combined}");
    let mut reversed = both;
    for row in &mut reversed.rows {
        row.second_roll_rad *= -1.0;
    }
    let (height_m, told) = messages(&van(Place::Both), &reversed);
    assert!(height_m.is_none() && told.contains("flip second_roll"), "{told}");
}

/// Each sensor has a row of the model, so a wrong gain of one of them is told: the rear one cannot roll farther than the
/// front one. Without this, 1.4 times its angle would make the height greater.
#[test]
fn two_sensors_check_each_other() {
    let (known, van) = (known_in("euro-van"), van(Place::Both));
    for load in ["p00", "p16"] {
        let drive = Drive::of(&known, Place::Both, load);
        let with_gain = |gain: f64, vehicle: Option<&Vehicle>| {
            let options = EstimateOptions {
                trailer_mass_kg: Some(drive.load.trailer_mass_kg),
                ..EstimateOptions::default()
            };
            let options = vehicle.map_or(options, |vehicle| options.with_file(vehicle));
            let design = design_with(&van, Variant::Complete, &Belief::prior(&van)).unwrap();
            let mut estimator = LogEstimator::from_design(&design, van.align_settings(), options);
            for mut row in drive.rows.iter().copied() {
                row.second_roll_rad *= gain;
                estimator.push(&row).unwrap();
            }
            let found = estimator.finish();
            (found.height_m, found.messages.join("; "))
        };
        let (right_m, told) = with_gain(1.0, Some(&van));
        assert!(right_m.is_some() && !told.contains("second roll sensor"), "{load} {told}");
        let (wrong_m, told) = with_gain(1.4, Some(&van));
        println!("{load}: {right_m:?} {:?} {told}", with_gain(1.4, None).0);
        if load == "p16" {
            assert!(wrong_m.is_none() && told.contains("on this frame"), "{told}");
            assert!(with_gain(1.4, None).0.unwrap() > 1.05 * right_m.unwrap());
        }
    }
}

/// What a rigid frame in the file would do.
#[test]
fn a_frame_that_is_rigid_only_in_the_file_is_wrong_at_both_ends() {
    let (known, rigid) = (known_in("euro-van"), vehicle("euro.toml"));
    let found = known.iter().filter(|k| k.log.contains("p00")).map(|known| {
        let design = cg_vehicle::design::design(&rigid, Variant::Complete).unwrap();
        let channel = Some(Channel::LateralAcceleration);
        let found = known.estimate(&design, channel, known.weighed());
        (known.log.starts_with("front"), found.height_m.unwrap() / known.load.cg_height_m - 1.0)
    });
    for (front, error) in found {
        println!("front {front}: {:+.1} %", 100.0 * error);
        assert!(if front { error > 0.15 } else { error < -0.05 }, "{front} {error}");
    }
}
