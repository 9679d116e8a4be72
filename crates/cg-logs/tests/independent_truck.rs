//! Estimation on the independent multibody trucks without any calibration: the vehicle files come from
//! their documented data, and the estimates from their logs are compared with their known heights.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common::{known_in, rms, vehicle};
use cg_core::Channel;
use cg_logs::estimate::{EstimateOptions, Method};
use cg_vehicle::Variant;
use cg_vehicle::balance::static_balance;
use cg_vehicle::design::design;

/// The trucks: vehicle file and folder of the logs.
const TRUCKS: [(&str, &str); 2] = [("kraz.toml", "logs"), ("euro.toml", "euro")];

/// Loads of independently sprung axles. They depend on springs, tires and frame pitch. Axles that the
/// vehicle file puts into one load group are compared together.
#[test]
fn static_loads_agree_with_the_multibody_models() {
    for (name, folder) in TRUCKS {
        let vehicle = vehicle(name);
        let axles = vehicle.axles();
        let unit = |i: usize| axles[i].on_trailer;
        let group = |i: usize| (unit(i), axles[i].axle.load_group.ok_or(i));
        let sum = |loads: &[f64], of: &dyn Fn(usize) -> bool| -> f64 {
            (0..axles.len()).filter(|&i| of(i)).map(|i| loads[i]).sum()
        };
        for known in known_in(folder) {
            let ours = static_balance(&vehicle, known.load).unwrap().axle_load_n;
            for i in 0..axles.len() {
                let same = |j: usize| group(j) == group(i);
                let (ours, theirs) = (sum(&ours, &same), sum(&known.axle_load_n, &same));
                // Positions and masses are documented to about 1 cm of 5 m and 10 kg of 10 t. The frame
                // pitches by 0.7 degrees, which moves a c.g. at 1.2 m by 1.5 cm and which the lever arms
                // of the balance do not include: 1 % of a laden axle, and 2.5 cm of 3.8 m of what a unit
                // carries, if its axle carries little.
                let of_unit = sum(&known.axle_load_n, &|j| unit(j) == unit(i));
                let allowed = (0.01 * theirs).max(0.0066 * of_unit);
                assert!((ours - theirs).abs() < allowed, "{}: {ours:.0} {theirs:.0}", known.log);
            }
        }
    }
}

/// Relative error of the height of every log.
fn errors((name, folder): (&str, &'static str), channel: Option<Channel>) -> Vec<f64> {
    let design = design(&vehicle(name), Variant::Complete).unwrap();
    let mut errors = Vec::new();
    for known in known_in(folder) {
        let estimate = known.estimate(&design, channel, known.weighed());
        let (height_m, sd_m) = (estimate.height_m.unwrap(), estimate.height_sd_m.unwrap());
        let truth_m = known.load.cg_height_m;
        let error = height_m / truth_m - 1.0;
        println!(
            "{:28} {channel:20?} {height_m:.3} ± {sd_m:.3} m, known {truth_m:.3} m: {:+.1} %",
            known.log,
            100.0 * error
        );
        // The true height is within two standard deviations, which contain the uncertainty of the
        // uncalibrated model from the vehicle file.
        assert!((height_m - truth_m).abs() <= 2.0 * sd_m, "{}", known.log);
        errors.push(error);
    }
    println!("{name} {channel:?}: {:.2} % rms", 100.0 * rms(&errors));
    errors
}

/// Steady-state gains of the same models give 3.5 % rms and 9.8 % at worst for the first truck (the empty
/// trailer, whose roll angle is a fifth of a degree per m/s²); identification may add half of that. The
/// roll of the second one is within 0.8 % of a quasi-static formula (its data sheet), which is 1 % of the
/// height.
#[test]
fn heights_from_lateral_acceleration_without_calibration() {
    for (truck, most) in TRUCKS.into_iter().zip([0.05, 0.012]) {
        let errors = errors(truck, Some(Channel::LateralAcceleration));
        assert!(rms(&errors) < most, "{truck:?} {:.3}", rms(&errors));
    }
}

/// The result of all channels of the second truck: the target is 1.2 % rms.
#[test]
fn combined_heights_of_the_second_truck_without_calibration() {
    let errors = errors(TRUCKS[1], None);
    assert!(rms(&errors) <= 0.012, "{:.4}", rms(&errors));
}

/// The steer channel depends on the tires. The first vehicle file has those of another manufacturer, and
/// that of the second their slopes at zero slip, which are 7 % greater than those in a turn of 0.17 g
/// (its lateral acceleration per steer angle is 13 to 17 % lower). The error is 15 % rms with steady-state
/// gains. Only calibration reduces it.
#[test]
fn heights_from_steer_without_calibration() {
    for truck in TRUCKS {
        let errors = errors(truck, Some(Channel::Steer));
        assert!(rms(&errors) < 0.18, "{truck:?} {:.3}", rms(&errors));
    }
}

/// The classical ARX of the thesis and the gain-only method on the same logs.
#[test]
fn every_method_answers() {
    for ((name, folder), log) in TRUCKS.into_iter().zip(["A_p20_h190", "A_p16_h170"]) {
        let design = design(&vehicle(name), Variant::Complete).unwrap();
        let known = known_in(folder);
        let laden = known.iter().find(|known| known.log.starts_with(log)).unwrap();
        for method in [Method::Filtered, Method::Gain, Method::Arx] {
            let channel = Some(Channel::LateralAcceleration);
            let options = EstimateOptions { method, ..laden.weighed() };
            let height_m = laden.estimate(&design, channel, options).height_m.unwrap();
            println!("{name} {method:?}: {height_m:.3} m");
            // The error of the model itself is 3 %, and that of the least accurate method is 3 %.
            assert!(
                (height_m / laden.load.cg_height_m - 1.0).abs() < 0.06,
                "{method:?}: {height_m}"
            );
        }
    }
}
