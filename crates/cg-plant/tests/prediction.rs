//! The model's prediction of a drive, compared with the reduced plant.

use cg_core::{Channel, SampleError};
use cg_logs::estimate::{EstimateOptions, Prediction};
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::design::design;
use cg_vehicle::{Variant, Vehicle};

/// The reduced plant is the model of the prediction: they agree except for the interpolation of the
/// ratio over speed and mass.
#[test]
fn the_reduced_plant_rolls_as_predicted() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
    let vehicle = Vehicle::load(path).unwrap();
    let design = design(&vehicle, Variant::Complete).unwrap();
    let scenario =
        Scenario { plant: Plant::Reduced, ..Scenario::of(&vehicle, Maneuver::LaneChange) };
    let simulation = LogSimulation::new(&vehicle, scenario).unwrap();
    let mut prediction = Prediction::new(
        &design,
        vehicle.align_settings(),
        EstimateOptions::default(),
        Channel::Steer,
        scenario.load.cg_height_m,
    );
    let (mut worst_rad, mut greatest_rad) = (0.0_f64, 0.0_f64);
    simulation
        .run_true(|row| {
            let expected_rad = prediction.push(row).unwrap();
            worst_rad = worst_rad.max((expected_rad - row.roll_rad).abs());
            greatest_rad = greatest_rad.max(row.roll_rad.abs());
            Ok::<(), SampleError>(())
        })
        .unwrap();
    // The error between the points of the design's grid is 1e-3 of the ratio. The shapes of
    // neighboring masses differ by a few percent, and interpolation leaves less than one percent.
    assert!(worst_rad < 0.01 * greatest_rad, "{worst_rad} of {greatest_rad}");
}
