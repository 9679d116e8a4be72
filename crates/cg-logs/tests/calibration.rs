//! Calibration on the independent truck and on simulated trucks with known parameters, and the
//! calibration file.
#![allow(clippy::unwrap_used)] // helpers of tests

mod common;

use cg_core::{CHANNELS, Channel};
use cg_logs::estimate::EstimateOptions;
use cg_vehicle::belief::{Belief, Deviations, PARAMETERS, Parameter};
use cg_vehicle::calibration::{Calibration, Run, fit};
use cg_vehicle::design::design_with;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Load, Variant, Vehicle};
use common::{calibrated, known, largest, rms, vehicle};

use cg_core::Measured;

/// Calibration with the empty and one laden run. All other runs are estimated: payload 0–20 t,
/// 40–67 km/h, both sides, slow steering, a banked road, a whole drive. The targets for the final
/// estimate (both channels combined) are 0.7 % rms and 1.5 % at worst, for every choice of the
/// laden run.
#[test]
fn two_runs_calibrate_the_independent_truck() {
    let vehicle = vehicle("kraz.toml");
    let known = known();
    let pick = |name: &str| known.iter().find(|known| known.log.starts_with(name)).unwrap();
    for laden in ["A_p20_h190", "A_p10_h170", "A_p20_h150", "A_p20_h220"] {
        let calibration = calibrated(&vehicle, &[pick("A_p00"), pick(laden)]);
        let design = design_with(&vehicle, Variant::Complete, &calibration.belief()).unwrap();
        let others =
            known.iter().filter(|k| !k.log.starts_with("A_p00") && !k.log.starts_with(laden));
        let mut errors = [Vec::new(), Vec::new(), Vec::new()];
        println!("calibrated on A_p00 and {laden}");
        for known in others {
            let truth_m = known.load.cg_height_m;
            print!("  {:28} {truth_m:.3} m", known.log);
            let channels = [Some(Channel::Steer), Some(Channel::LateralAcceleration), None];
            for (errors, channel) in errors.iter_mut().zip(channels) {
                let estimate = known.estimate(&design, channel, EstimateOptions::default());
                let (h, sd) = (estimate.height_m.unwrap(), estimate.height_sd_m.unwrap());
                let error = h / truth_m - 1.0;
                print!("  {:+.2} ± {:.2} %", 100.0 * error, 100.0 * sd / truth_m);
                // The drive has low speeds and load changes of the drive line in its steer channel,
                // which no calibration at 50 km/h contains: three standard deviations.
                assert!((h - truth_m).abs() <= 3.0 * sd, "{}: {h:.3} ± {sd:.3} m", known.log);
                errors.push(error);
            }
            println!();
        }
        for (name, errors) in ["steer", "lateral acceleration", "combined"].iter().zip(&errors) {
            let (rms, most) = (100.0 * rms(errors), 100.0 * largest(errors));
            println!("  {name}: {rms:.2} % rms, {most:.2} % at worst");
        }
        let [_, lateral, combined] = &errors;
        assert!(rms(combined) <= 0.007 && largest(combined) <= 0.015, "{laden}");
        // Steady-state gains calibrated with four parameters give 1.2 % rms and 2.4 % at worst.
        assert!(rms(lateral) <= 0.02 && largest(lateral) <= 0.03, "{laden}");
    }
}

/// Runs of a truck whose parameters differ from its file, as exact ratios at some loads and speeds.
fn runs_of(vehicle: &Vehicle, truth: &Deviations, loads: &[(f64, f64, f64)]) -> Vec<Run> {
    let belief = Belief { mean: *truth, ..Belief::prior(vehicle) };
    let truck = belief.applied_to(vehicle);
    loads
        .iter()
        .map(|&(trailer_mass_kg, cg_height_m, speed_mps)| {
            let load = Load { trailer_mass_kg, cg_height_m };
            let lines = ratio_line(&truck, Variant::Complete, speed_mps, load).unwrap();
            let ratio = Channel::ALL.map(|channel| {
                let gain = belief.gain(channel);
                let value = gain * lines[channel.index()].ratio_at(cg_height_m);
                Some(Measured { value, sd: 1e-4 * value })
            });
            Run { log: format!("{trailer_mass_kg} kg"), load, speed_mps, ratio }
        })
        .collect()
}

/// The posterior is correct: over trucks drawn from the prior, the mean square of the error of a
/// predicted ratio, divided by its standard deviation, is one.
#[test]
fn the_posterior_covers_trucks_drawn_from_the_prior() {
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, Normal};
    let mut vehicle = vehicle("kraz.toml");
    vehicle.uncertainty.residual_sd = 0.0; // ratios below are exact
    let prior = Belief::prior(&vehicle);
    let mut rng = StdRng::seed_from_u64(7);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let loads = [(8_684.0, 1.33, 13.9), (28_684.0, 1.9, 13.9), (18_684.0, 1.7, 18.0)];
    let (mut squares, mut improved, trucks) = ([0.0; CHANNELS], [0.0; CHANNELS], 60);
    for _ in 0..trucks {
        let truth =
            Deviations::from_fn(|k, _| prior.covariance[(k, k)].sqrt() * normal.sample(&mut rng));
        let runs = runs_of(&vehicle, &truth, &loads);
        let fitted = fit(&vehicle, Variant::Complete, &runs[..2]).unwrap();
        let probe = &runs[2];
        let moved = fitted.belief.applied_to(&vehicle);
        let lines = ratio_line(&moved, Variant::Complete, probe.speed_mps, probe.load).unwrap();
        let covariance = |belief: &Belief| {
            belief
                .ratio_covariance(&vehicle, Variant::Complete, probe.speed_mps, probe.load)
                .unwrap()
        };
        let (before, after) = (covariance(&prior), covariance(&fitted.belief));
        for channel in Channel::ALL {
            let c = channel.index();
            let predicted = fitted.belief.gain(channel) * lines[c].ratio_at(probe.load.cg_height_m);
            let error = (probe.ratio[c].unwrap().value / predicted).ln();
            squares[c] += error * error / after[c][c] / f64::from(trucks);
            improved[c] += (after[c][c] / before[c][c]).sqrt() / f64::from(trucks);
        }
    }
    println!("mean square of error over sd {squares:?}, sd after over before {improved:?}");
    for c in 0..CHANNELS {
        // χ² of 60 draws: 1 ± √(2/60) = 0.18. Three times this, and as much again for the
        // nonlinearity of the model over 15 % of cornering stiffness.
        assert!((0.45..=1.9).contains(&squares[c]), "{squares:?}");
        assert!(improved[c] < 0.5, "{improved:?}");
    }
}

#[test]
fn one_run_fixes_the_compensation_and_nothing_else() {
    let vehicle = vehicle("baseline.toml");
    let mut truth = Deviations::zeros();
    truth[Parameter::TrailerRollStiffness as usize] = (0.7_f64).ln();
    let load = vehicle.reference_load();
    let loads = [(load.trailer_mass_kg, load.cg_height_m, vehicle.nominal_speed_mps)];
    let runs = runs_of(&vehicle, &truth, &loads);
    let fitted = fit(&vehicle, Variant::Complete, &runs).unwrap();
    for k in 0..PARAMETERS {
        let is_sensor =
            cg_core::Input::ALL.into_iter().any(|input| k == Parameter::of_input(input) as usize);
        assert!(is_sensor || fitted.belief.mean[k].abs() < 1e-15);
    }
    for (residual, channel) in fitted.residuals.iter().zip(Channel::ALL) {
        assert!(residual.after.abs() < 1e-12);
        let ratio = fitted.belief.gain(channel).ln();
        assert!((ratio - residual.before).abs() < 1e-12);
    }
    // At the run itself, noise and residual determine the uncertainty of the ratio, and the priors
    // have no effect.
    let after =
        fitted.belief.ratio_covariance(&vehicle, Variant::Complete, loads[0].2, load).unwrap();
    // Residual of the run plus residual of the prediction.
    let expected = 2.0 * vehicle.uncertainty.residual_sd.powi(2) + 1e-8;
    assert!((after[0][0] / expected - 1.0).abs() < 1e-6, "{} {expected}", after[0][0]);
}

#[test]
fn the_file_gives_the_same_belief_back() {
    let vehicle = vehicle("kraz.toml");
    let truth = Deviations::from_fn(|k, _| if k % 3 == 1 { 0.01 } else { -0.02 });
    let runs = runs_of(&vehicle, &truth, &[(8_684.0, 1.33, 13.9), (28_684.0, 1.9, 13.9)]);
    let fitted = fit(&vehicle, Variant::Complete, &runs).unwrap();
    let calibration = Calibration::new(&vehicle, Variant::Complete, &runs, &fitted).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c.toml");
    std::fs::write(&path, calibration.to_toml().unwrap()).unwrap();
    let read = Calibration::load(&path, &vehicle).unwrap();
    assert_eq!(read, calibration);
    // A factor is converted to its logarithm and back, so there is only rounding.
    assert!((read.belief().mean - fitted.belief.mean).amax() < 1e-15);
    assert_eq!(read.belief().covariance, fitted.belief.covariance);

    let mut stiffer = vehicle.clone();
    stiffer.trailer.axle[0].axle.spring_stiffness_n_per_m *= 1.01;
    let error = Calibration::load(&path, &stiffer).unwrap_err().to_string();
    assert!(error.contains("the vehicle file has changed since this calibration"), "{error}");
    let error = Calibration::load(&path, &common::vehicle("baseline.toml")).unwrap_err();
    assert!(error.to_string().contains("belongs to the vehicle \"kraz\""), "{error}");
}

/// In a drive, the two channels use different turns. Both ratios refer to one speed, at which each
/// of them corresponds to its own height.
#[test]
fn both_ratios_of_a_drive_are_told_at_one_speed() {
    let vehicle = vehicle("kraz.toml");
    let design = design_with(&vehicle, Variant::Complete, &Belief::prior(&vehicle)).unwrap();
    let known = known();
    let drive = known.iter().find(|known| known.log.starts_with("F_")).unwrap();
    let estimator = || {
        let mut estimator = cg_logs::estimate::LogEstimator::from_design(
            &design,
            cg_core::AlignSettings::NONE,
            EstimateOptions::default(),
        );
        drive.feed(&mut estimator);
        estimator
    };
    let identified = estimator().identified();
    for channel in [Channel::Steer, Channel::LateralAcceleration] {
        let options = EstimateOptions::default();
        let height_m = drive.estimate(&design, Some(channel), options).height_m.unwrap();
        let mass_kg = identified.trailer_mass_kg;
        let line = design.line(channel, identified.speed_mps, mass_kg).unwrap();
        let expected = design.compensation(channel) * line.ratio_at(height_m);
        let ratio = identified.ratio[channel.index()].unwrap().value;
        assert!((ratio / expected - 1.0).abs() < 1e-12, "{channel}: {ratio} {expected}");
    }
}
