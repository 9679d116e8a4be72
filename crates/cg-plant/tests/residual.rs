//! What the equations of a vehicle leave out.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_core::Channel;
use cg_plant::residual::model_residual;
use cg_vehicle::belief::{Deviations, Parameter, adjusted};

/// Linear tires and springs leave next to nothing; no file promises less than its plant shows.
#[test]
fn files_have_the_residual_that_their_plant_shows() {
    for name in ["kraz", "baseline-tables", "air"] {
        let vehicle = common::vehicle(&format!("{name}.toml"));
        let found = model_residual(&vehicle).unwrap();
        assert!(found.runs >= 40 && found.channels.len() == 2, "{name}: {found:?}");
        let file = vehicle.uncertainty.residual_sd;
        assert!(found.residual_sd() <= file, "{name}: {file}, {found:?}");
        // What intervals have without a residual must not hide one as great as that of the file. That of measured springs does.
        let is_hidden = found.channels.iter().any(|one| one.explained > file);
        assert!(!is_hidden || !vehicle.spring.is_empty(), "{name}: {file}, {found:?}");
        // Rows that repeated the equations would not differ from them.
        assert!(found.channels.iter().all(|one| one.spread > 1e-4), "{name}: {found:?}");
    }
}

/// In a truck that oversteers, the steer angle of a turn is a small difference of slip angles. What its tires change
/// from turn to turn then moves the ratio by more than a percent, and an interval says so; without the tires it would have
/// the noise of perfect sensors, some tenths of a percent.
#[test]
fn tires_in_turns_explain_what_an_oversteering_truck_shows() {
    let file = common::vehicle("kraz.toml");
    let mut deviations = Deviations::zeros();
    deviations[Parameter::SteeredCorneringStiffness as usize] = 0.2;
    deviations[Parameter::DriveCorneringStiffness as usize] = -0.2;
    let found = model_residual(&adjusted(&file, &deviations)).unwrap();
    let steer = found.channels.iter().find(|one| one.channel == Channel::Steer).unwrap();
    println!("{found:?}");
    let shown = steer.mean.hypot(steer.spread);
    assert!(steer.spread > 0.01, "{steer:?}");
    // The standard deviation of what was found is known to 6.2 % (1/√(2·130), of 130 runs); three of them, and as much for the
    // three turns that stand for all.
    assert!((0.63..1.37).contains(&(steer.explained / shown)), "{steer:?}");
}
