//! A semitrailer whose frame twists, in the linear model.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Channel;
use cg_vehicle::assumptions::Assumption;
use cg_vehicle::belief::{Belief, Parameter};
use cg_vehicle::equations::Equations;
use cg_vehicle::linear::{LinearModel, SteadyLines};
use cg_vehicle::second_sensor::SecondShare;
use cg_vehicle::twisting::RIGID_NM_PER_RAD;
use cg_vehicle::wind::Wind;
use cg_vehicle::{Load, Variant, Vehicle};
use nalgebra::ComplexField;

const SPEED_MPS: f64 = 13.9;
const BOX: Wind = Wind { side_area_m2: 36.0, side_height_m: 2.4, speed_mps: 3.0 };

fn euro(stiffness: Option<f64>) -> Vehicle {
    let mut vehicle = common::vehicle("euro.toml");
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = stiffness;
    // Of which nothing is then noted.
    (vehicle.trailer.axle[0].lift_m, vehicle.wind) = (Some(0.1), Some(BOX));
    vehicle
}

fn load(payload_kg: f64, cg_height_m: f64) -> Load {
    Load { trailer_mass_kg: 6318.0 + payload_kg, cg_height_m }
}

/// DC ratios of all channels of the state-space model.
fn exact(vehicle: &Vehicle, load: Load) -> [f64; 4] {
    let model =
        Equations::new(vehicle, Variant::Complete, SPEED_MPS, load).unwrap().state_space().unwrap();
    Channel::ALL.map(|channel| {
        let dc = |system: cg_vehicle::system::System| system.moments(1).unwrap()[0];
        let input = model.to_input(channel.input()).map_or(1.0, dc);
        dc(model.to_output(channel.output())) / input
    })
}

/// A very stiff frame is a rigid one, statically and in every pole of the rigid model.
#[test]
fn a_very_stiff_frame_is_rigid() {
    let load = load(16e3, 1.7);
    let (rigid, stiff) = (euro(Some(RIGID_NM_PER_RAD)), euro(Some(1e9)));
    for (a, b) in exact(&rigid, load).into_iter().zip(exact(&stiff, load)) {
        // Half the roll moment, 1e5 N m, over the stiffness, relative to 0.03 rad.
        assert!((a / b - 1.0).abs() < 3e-3, "{a} {b}");
    }
    let poles = |vehicle: &Vehicle| {
        LinearModel::new(vehicle, Variant::Complete, SPEED_MPS, load)
            .unwrap()
            .state_space
            .a
            .complex_eigenvalues()
    };
    let twisting = poles(&stiff);
    // The stiff fifth wheel has a pole beyond every motion of a truck.
    for pole in poles(&rigid).iter().filter(|pole| pole.modulus() < 200.0) {
        let nearest =
            twisting.iter().map(|other| (other - pole).modulus()).fold(f64::MAX, f64::min);
        assert!(nearest < 0.02 * pole.modulus(), "{pole} {nearest}");
    }
}

/// The lines of every pair against the DC ratio of the state-space model. They are exact at the height
/// of the load; elsewhere the quotient of two parabolas differs from that of two lines.
#[test]
fn the_lines_are_nearly_those_of_the_twisting_model() {
    let mut worst = [0.0_f64; 2];
    for (k, stiffness) in [3e6, 6e5].into_iter().enumerate() {
        let vehicle = euro(Some(stiffness));
        for payload_kg in [0.0, 8e3, 24e3] {
            let at = load(payload_kg, 1.7);
            let steady = SteadyLines::new(&vehicle, Variant::Complete, SPEED_MPS, at).unwrap();
            for step in 0..=14 {
                let height_m = 1.0 + 0.1 * f64::from(step);
                let exact = exact(&vehicle, Load { cg_height_m: height_m, ..at });
                for channel in Channel::ALL {
                    let error =
                        steady.channel(channel).ratio_at(height_m) / exact[channel.index()] - 1.0;
                    worst[k] = worst[k].max(error.abs());
                    let here = (height_m - 1.7).abs() < 1e-9;
                    assert!(!here || error.abs() < 1e-9, "{channel} {error:e}");
                }
            }
        }
        println!("{stiffness:e}: {:.4} %", 100.0 * worst[k]);
    }
    assert!(worst[0] < 1e-3 && worst[1] < 5e-3, "{worst:?}");
}

/// A rigid frame is certain, and one in the file has the file's standard deviation.
#[test]
fn the_stiffness_of_a_frame_is_a_parameter() {
    let k = Parameter::FrameTorsionalStiffness as usize;
    let rigid = euro(Some(RIGID_NM_PER_RAD));
    assert!(Belief::prior(&rigid).covariance[(k, k)].abs() < f64::EPSILON);
    assert_eq!(Belief::prior(&rigid).applied_to(&rigid).trailer.frame_nm_per_rad(), None);
    let vehicle = euro(Some(3e6));
    let mut belief = Belief::prior(&vehicle);
    assert!((belief.covariance[(k, k)] - 0.09).abs() < 1e-12);
    belief.mean[k] = 2.0_f64.ln();
    let applied = belief.applied_to(&vehicle).trailer.frame_torsional_stiffness_nm_per_rad;
    assert!((applied.unwrap() - 6e6).abs() < 1e-3);
}

/// A file that says nothing of the frame allows for all of them, at both ends of the trailer.
#[test]
fn an_unknown_frame_may_be_any_usual_one() {
    let k = Parameter::FrameTorsionalStiffness as usize;
    let sd = Belief::prior(&euro(None)).covariance[(k, k)].sqrt();
    let mean = euro(None).trailer.frame_nm_per_rad().unwrap();
    for (place_m, at) in [(0.5, load(0.0, 1.275)), (0.5, load(24e3, 2.0)), (8.0, load(0.0, 1.275))]
    {
        let logarithm = |stiffness: f64| {
            let mut vehicle = euro(Some(stiffness));
            vehicle.sensors.roll.behind_hitch_m = Some(place_m);
            exact(&vehicle, at)[Channel::LateralAcceleration.index()].ln()
        };
        let of_sd = sd * (logarithm(1.001 * mean) - logarithm(mean)) / 1.001_f64.ln();
        let deviations = [4e5, 6e5, 3e6, RIGID_NM_PER_RAD]
            .map(|stiffness| (logarithm(stiffness) - logarithm(mean)) / of_sd);
        println!("{place_m} m: {deviations:+.2?} standard deviations");
        assert!(deviations.iter().all(|deviation| deviation.abs() < 2.3), "{deviations:?}");
    }
}

/// The soft frame is uncertain by 30 %, and moves the roll of both halves in opposite directions. With the
/// best share of the second sensor the height is as certain as with a rigid frame, within a tenth.
#[test]
fn two_sensors_know_the_height_as_if_the_frame_were_certain() {
    let mut flatbed = euro(Some(6e5));
    flatbed.uncertainty.frame_torsional_stiffness_sd = 0.3;
    let roll = &mut flatbed.sensors.roll;
    [roll.behind_hitch_m, roll.second_behind_hitch_m] = [Some(0.5), Some(8.0)];
    let best = SecondShare::best(&flatbed).unwrap().unwrap();
    let of = |share: f64| SecondShare::of(&flatbed, share).unwrap().height_sd;
    let mut certain = flatbed.clone();
    certain.uncertainty.frame_torsional_stiffness_sd = 0.0;
    let least = SecondShare::of(&certain, best.share).unwrap().height_sd;
    println!(
        "share {:.2}: {:.2?} %; first, second, mean: {:.2?} %; frame certain: {:.2?} %",
        best.share,
        best.height_sd.map(|sd| 100.0 * sd),
        [0.0, 1.0, 0.5].map(|share| of(share).map(|sd| 100.0 * sd)),
        least.map(|sd| 100.0 * sd)
    );
    for load in 0..2 {
        assert!(best.height_sd[load] < 1.1 * least[load], "{best:?} {least:?}");
        assert!(best.height_sd[load] < of(0.0)[load], "the front sensor alone");
    }
    flatbed.trailer.frame_torsional_stiffness_nm_per_rad = Some(RIGID_NM_PER_RAD);
    assert_eq!(SecondShare::best(&flatbed).unwrap(), None);
}

/// A sensor at the fifth wheel sees the front half, one over the axles the rear half, and two see the
/// mean. The front half leans more, because only the frame and the tractor hold it.
#[test]
fn a_roll_sensor_has_a_place() {
    let at = load(16e3, 1.7);
    let ratio = |places: [Option<f64>; 2]| {
        let mut vehicle = euro(Some(6e5));
        [vehicle.sensors.roll.behind_hitch_m, vehicle.sensors.roll.second_behind_hitch_m] = places;
        exact(&vehicle, at)[Channel::LateralAcceleration.index()]
    };
    let [front, rear, both] = [[Some(0.5), None], [None, None], [Some(0.5), Some(8.0)]].map(ratio);
    assert!((both / (0.5 * (front + rear)) - 1.0).abs() < 1e-12, "{front} {rear} {both}");
    let shared = {
        let mut vehicle = euro(Some(6e5));
        let roll = &mut vehicle.sensors.roll;
        [roll.behind_hitch_m, roll.second_behind_hitch_m] = [Some(0.5), Some(8.0)];
        roll.second_share = Some(0.3);
        exact(&vehicle, at)[Channel::LateralAcceleration.index()]
    };
    assert!((shared / (0.7 * front + 0.3 * rear) - 1.0).abs() < 1e-12, "{shared}");
    assert!(front > 1.05 * rear, "{front} {rear}");
}

/// The thesis's printed model has a rigid frame.
#[test]
fn the_printed_model_refuses_a_twisting_frame() {
    let mut vehicle = common::vehicle("baseline.toml");
    let load = vehicle.reference_load();
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = Some(1e6);
    let error = Equations::new(&vehicle, Variant::AsPrinted, SPEED_MPS, load).unwrap_err();
    assert!(error.to_string().contains("frame_torsional_stiffness_nm_per_rad"), "{error}");
}

/// The slopes of a file that are not the secants of its slip table are noted, with the tire and by how much.
#[test]
fn slopes_at_zero_slip_are_noted() {
    let mut vehicle = common::vehicle("kraz.toml");
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = Some(3e6);
    vehicle.trailer.axle[0].lift_m = Some(0.1);
    vehicle.wind = Some(BOX);
    (vehicle.sensors.roll.behind_hitch_m, vehicle.sensors.accelerometer.behind_hitch_m) =
        (Some(7.7), Some(7.7));
    let noted = |vehicle: &Vehicle| -> Vec<_> {
        Assumption::of(vehicle).into_iter().map(|one| (one.key, one.note)).collect()
    };
    let [(key, note)] = &noted(&vehicle)[..] else { panic!("{:?}", noted(&vehicle)) };
    assert_eq!(*key, "tyre.cornering_stiffness_n_per_rad");
    assert!(note.contains("\"trailer\" differ by up to +8 %"), "{note}");
    // The secants themselves are not, and neither are tires without a table.
    for tyre in &mut vehicle.tyre {
        let table = tyre.lateral_force.as_ref().unwrap();
        let secant = |n: &f64| table.slopes_n_per_rad(*n, 0.15).unwrap()[1];
        tyre.cornering_stiffness_n_per_rad = tyre.load_n.iter().map(secant).collect();
    }
    assert!(noted(&vehicle).is_empty());
    for tyre in &mut vehicle.tyre {
        tyre.cornering_stiffness_n_per_rad[1] *= 1.5;
        tyre.lateral_force = None;
    }
    assert!(noted(&vehicle).is_empty());
}

/// The wind is in no interval of a file without `[wind]`.
#[test]
fn a_file_that_says_nothing_of_the_wind_has_a_note() {
    let mut vehicle = euro(None);
    let keys = |vehicle: &Vehicle| -> Vec<_> {
        Assumption::of(vehicle).into_iter().map(|one| one.key).collect()
    };
    assert!(!keys(&vehicle).contains(&"wind"));
    vehicle.wind = None;
    assert!(keys(&vehicle).contains(&"wind"));
}

/// A note stands on what would change the height if it were otherwise, and on nothing else.
#[test]
fn what_nothing_contradicts_is_noted() {
    const AT_FRONT: Option<f64> = Some(0.5);
    let keys = |vehicle: &Vehicle| -> Vec<_> {
        Assumption::of(vehicle).into_iter().map(|one| one.key).collect()
    };
    let of = |stiffness: Option<f64>, place_m: Option<f64>| {
        let mut vehicle = euro(stiffness);
        vehicle.sensors.roll.behind_hitch_m = place_m;
        let ratio = exact(&vehicle, load(16e3, 1.7))[Channel::LateralAcceleration.index()];
        (keys(&vehicle), ratio)
    };
    let (rigid, over_axles) = of(Some(RIGID_NM_PER_RAD), None);
    assert_eq!(rigid, ["trailer.frame_torsional_stiffness_nm_per_rad"]);
    let (with_place, at_front) = of(Some(RIGID_NM_PER_RAD), AT_FRONT);
    assert_eq!(with_place, rigid);
    // A rigid frame rolls alike everywhere; 1e-9 is rounding.
    assert!((at_front / over_axles - 1.0).abs() < 1e-9, "{at_front} {over_axles}");
    for stiffness in [None, Some(3e6), Some(6e5)] {
        // The accelerometer of the pair of the trailer, too.
        let pair = |place_m: Option<f64>| {
            let mut vehicle = euro(stiffness);
            vehicle.sensors.roll.behind_hitch_m = Some(7.7);
            vehicle.sensors.accelerometer.behind_hitch_m = place_m;
            let ratio = exact(&vehicle, load(16e3, 1.7))[Channel::Suspension.index()];
            (keys(&vehicle), ratio)
        };
        let ((unplaced, usual), (placed, at_front)) = (pair(None), pair(AT_FRONT));
        assert_eq!(unplaced, ["sensors.accelerometer.behind_hitch_m"]);
        assert!(placed.is_empty(), "{placed:?}");
        println!("{stiffness:?}: force at the front {:.3}", at_front / usual);
        assert!((at_front / usual - 1.0).abs() > 0.01, "{stiffness:?} {at_front} {usual}");
        let (absent, twisting_over_axles) = of(stiffness, None);
        let (given, twisting_at_front) = of(stiffness, AT_FRONT);
        assert_eq!(absent, ["sensors.roll.behind_hitch_m"], "{stiffness:?}");
        assert!(given.is_empty(), "{stiffness:?} {given:?}");
        // The height follows the ratio; 1 % of it matters beside the errors in README.md.
        let by = [twisting_over_axles / over_axles, twisting_at_front / twisting_over_axles];
        println!("{stiffness:?}: twisted {:.3}, at the front {:.3}", by[0], by[1]);
        assert!(by.iter().all(|by| (by - 1.0).abs() > 0.01), "{stiffness:?} {by:?}");
    }
}
