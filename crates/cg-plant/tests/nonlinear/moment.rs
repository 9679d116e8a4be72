//! A run that goes on from a moment of another one.

use super::*;
use cg_plant::plant::{Driver, DriverSettings, Path};
use cg_plant::simulate::{PlantInput, PlantRun, PlantStart};

const STEP_S: f64 = 0.01;

/// The driver of the first run steers; the second one goes on from it after so many steps.
fn goes_on(vehicle: &Vehicle, settings: DriverSettings, start: &PlantStart, steps: usize) {
    let begin = || {
        let run = PlantRun::new(vehicle, start).unwrap();
        let driver = run.driver(Path::turn(5.0, 100.0, 1.0), settings).unwrap();
        (run, driver)
    };
    let follow = |(run, driver): &mut (PlantRun, Driver), steps: usize| {
        let mut seen = Vec::new();
        for _ in 0..steps {
            let ground = run.simulation().control().ground;
            run.follow(driver, ground, STEP_S).unwrap();
            seen.push((run.simulation().time_s(), run.simulation().state, run.sample()));
        }
        seen
    };
    let mut first = begin();
    follow(&mut first, steps);
    let mut second = begin();
    second.0.go_on_from(&first.0.simulation().moment()).unwrap();
    second.1.go_on_from(&first.1.moment()).unwrap();
    assert_eq!(first.0.simulation().moment(), second.0.simulation().moment());
    assert_eq!(first.1.moment(), second.1.moment());
    // Bit for bit: the state, what was kept of earlier steps, and what the driver has in mind.
    assert_eq!(follow(&mut first, 100), follow(&mut second, 100));
}

/// Rigid and twisting frames, springs with friction and lash, and before and after the integration has its four
/// earlier rates.
#[test]
fn a_run_goes_on_from_a_moment_to_the_last_bit() {
    let slow = DriverSettings { delay_s: 0.1, lag_s: 0.2, ..DriverSettings::default() };
    for vehicle in [vehicle("baseline"), vehicle("air"), vehicle("kraz"), flatbed()] {
        let start = PlantStart { bank_rad: 0.02, payload_left_m: 0.05, ..PlantStart::of(&vehicle) };
        for steps in [0, 1, 300] {
            goes_on(&vehicle, slow, &start, steps);
        }
    }
}

#[test]
fn a_vehicle_that_lies_on_its_side_remains_there() {
    let vehicle = vehicle("baseline");
    let start = PlantStart { speed_mps: 25.0, ..PlantStart::of(&vehicle) };
    let mut first = PlantRun::new(&vehicle, &start).unwrap();
    let mut second = first.clone();
    let ground = first.simulation().control().ground;
    let input = PlantInput { steer_rad: 0.15, speed_mps: 25.0, ground };
    first.step(&input, 10.0).unwrap();
    assert!(first.simulation().upright().is_err());
    second.go_on_from(&first.simulation().moment()).unwrap();
    assert_eq!(second.simulation().progress(), first.simulation().progress());
    second.step(&input, 1.0).unwrap();
    assert_eq!(second.simulation().state, first.simulation().state);
}

#[test]
fn the_moment_of_another_vehicle_or_driver_is_refused() {
    let (three, two) = (vehicle("euro"), vehicle("kraz"));
    assert_ne!(three.axles().len(), two.axles().len());
    let moment = PlantRun::new(&three, &PlantStart::of(&three)).unwrap().simulation().moment();
    let mut run = PlantRun::new(&two, &PlantStart::of(&two)).unwrap();
    let before = run.simulation().moment();
    assert!(run.go_on_from(&moment).unwrap_err().to_string().contains("number of axles"));
    assert_eq!(run.simulation().moment(), before);
    let driver = |delay_s| {
        let settings = DriverSettings { delay_s, ..DriverSettings::default() };
        run.driver(Path::turn(5.0, 100.0, 1.0), settings).unwrap()
    };
    let error = driver(0.0).go_on_from(&driver(0.1).moment()).unwrap_err().to_string();
    assert!(error.contains("the delay is another one"), "{error}");
}
