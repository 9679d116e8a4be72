//! The first seconds of turns of the first independent truck, with noise.
#![allow(clippy::unwrap_used)]

use crate::common::{calibrated, known, vehicle};
use cg_core::{AlignSettings, Channel};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_vehicle::Variant;
use cg_vehicle::design::design_with;

/// Four seconds of a turn from the noisy steer angle alone. Its noise passes the truck's model and is slow then, so that it looks like a
/// drift of the roll sensor. When only the noise of the roll angle counted, 24 of 35 such logs were told a drift, 8 intervals missed,
/// and the error was 3.9 % rms at a stated 1.9 %. Now both are alike: the mean square of the error over the stated deviation is
/// between 0.1 (the rest is what calibration and model leave) and 1 plus three of its standard deviations, √(2/35).
#[test]
fn noise_of_the_steer_angle_is_no_drift_of_the_roll_angle() {
    let vehicle = vehicle("kraz.toml");
    let known = known();
    let pick = |name: &str| known.iter().find(|known| known.log.starts_with(name)).unwrap();
    let runs = ["A_p00", "A_p20_h190"];
    let calibration = calibrated(&vehicle, &runs.map(pick));
    let design = design_with(&vehicle, Variant::Complete, &calibration.belief()).unwrap();
    let (mut squares, mut errors, mut logs) = (0.0, 0.0, 0.0);
    for other in known.iter().filter(|one| {
        !one.log.starts_with("F_") && !runs.iter().any(|run| one.log.starts_with(run))
    }) {
        for seed in 0..5 {
            let options = EstimateOptions { channel: Some(Channel::Steer), ..other.weighed() };
            let mut estimator = LogEstimator::from_design(&design, AlignSettings::NONE, options);
            for row in other.noisy(seed).iter().filter(|row| row.time_s <= 6.0) {
                estimator.push(row).unwrap();
            }
            let found = estimator.finish();
            let (height_m, sd_m) = (found.height_m.unwrap(), found.height_sd_m.unwrap());
            let error_m = height_m - other.load.cg_height_m;
            let told = found.messages.iter().any(|message| message.contains("drifts"));
            assert!(!told, "{} {seed}: {:?}", other.log, found.messages);
            squares += (error_m / sd_m).powi(2);
            errors += (error_m / other.load.cg_height_m).powi(2);
            logs += 1.0;
        }
    }
    let (square, error) = (squares / logs, (errors / logs).sqrt());
    println!("{logs} logs: {:.1} % rms, mean square {square:.2}", 100.0 * error);
    assert!((0.1..1.0 + 3.0 * (2.0 / logs).sqrt()).contains(&square), "{square}");
}
