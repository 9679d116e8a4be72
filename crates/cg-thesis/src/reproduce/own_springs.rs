//! Table 5.10 with a plant of this project whose springs differ from the vehicle file.
//!
//! The plant is the complete linear model with scaled springs of drive and trailer axles. Its log of a
//! rounded step goes through the whole estimator, first with the unchanged vehicle file, then with a
//! calibration (`R_c`, one run) on the same truck, as in the thesis.

use cg_core::{AlignSettings, Channel};

use super::baseline::Baseline;
use super::printed::Printed;
use super::row::Row;
use super::solved::bias_percent;
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Procedure;
use cg_vehicle::design::design_with;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Variant, Vehicle};

const RATE_HZ: f64 = 100.0;
const START_S: f64 = 2.0;
const DURATION_S: f64 = 20.0;

/// Rows of one spring deviation, `percent` of the file's stiffness, with the printed biases
/// `[baseline, updated]` of another plant.
pub(super) fn rows(
    table: &'static str,
    base: &Baseline,
    (name, percent): (&str, i32),
    printed: [&Printed; 2],
) -> Result<Vec<Row>, VehicleError> {
    let vehicle = &base.vehicle;
    let truck = with_springs(vehicle, 1.0 + f64::from(percent) / 100.0);
    let truth_m = vehicle.trailer.reference_cg_height_m;
    let estimate = |belief: &Belief| height_m(vehicle, &truck, belief);
    let unaware_m = estimate(&Belief::prior(vehicle))?;
    let load = KnownLoad::Laden { height_m: truth_m, trailer_mass_kg: None };
    let log = KnownLog { log: name.to_owned(), load };
    let options =
        CalibrateOptions { procedure: Procedure::Compensation, ..CalibrateOptions::default() };
    let calibration = calibrate(vehicle, options, &[log], |_, estimator| drive(&truck, estimator))?;
    let aware_m = estimate(&calibration.belief())?;
    let item = |what: &str| format!("{name}: own plant, {what}");
    let beside = |what: &str, printed: &Printed, estimate_m: f64, note: &str| {
        let ours = Row::ours(table, item(what), bias_percent(estimate_m, truth_m), note);
        Row { thesis: Some(printed.value), ..ours }
    };
    let plant = "our plant instead of the Yaw/Roll program: complete linear model with scaled springs of \
                 drive and trailer axles; noise-free log through the whole estimator";
    let [unaware, aware] = printed;
    Ok(vec![
        beside("bias, vehicle file's springs, %", unaware, unaware_m, plant),
        Row::ours(
            table,
            item("R_c, one run"),
            calibration.compensation.steer,
            "calibrated on this truck with its known height",
        ),
        beside("bias, recalibrated, %", aware, aware_m, "the same log with this R_c"),
    ])
}

fn with_springs(vehicle: &Vehicle, factor: f64) -> Vehicle {
    let mut truck = vehicle.clone();
    for axle in truck.tractor.axle.iter_mut().filter(|axle| !axle.steered) {
        axle.axle.spring_stiffness_n_per_m *= factor;
    }
    for axle in &mut truck.trailer.axle {
        axle.axle.spring_stiffness_n_per_m *= factor;
    }
    truck
}

/// Feeds the truck's log to an estimator.
fn drive(truck: &Vehicle, estimator: &mut LogEstimator) -> Result<(), VehicleError> {
    let scenario = Scenario {
        rate_hz: RATE_HZ,
        start_s: START_S,
        duration_s: DURATION_S,
        ..Scenario::of(truck, Maneuver::RoundedStep)
    };
    LogSimulation::new(truck, scenario)?.run(|row| match estimator.push(row) {
        Ok(_) => Ok(()),
        Err(error) => Err(VehicleError::Model(error.to_string())),
    })
}

/// The height that the estimator for `vehicle` finds in the log of `truck`.
fn height_m(vehicle: &Vehicle, truck: &Vehicle, belief: &Belief) -> Result<f64, VehicleError> {
    let mut design = design_with(vehicle, Variant::Complete, belief)?;
    // With springs that are 30 % softer the load seems very high, and the bias is the result.
    design.greatest_height_m *= 2.0;
    let options = EstimateOptions { channel: Some(Channel::Steer), ..EstimateOptions::default() };
    let mut estimator = LogEstimator::from_design(&design, AlignSettings::NONE, options);
    drive(truck, &mut estimator)?;
    let estimate = estimator.finish();
    estimate.height_m.ok_or_else(|| {
        VehicleError::Model(format!("table 5.10: no height ({})", estimate.messages.join("; ")))
    })
}
