//! The trailer mass is a measurement: intervals of heights whose mass comes from a scale with an error.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_core::Design;
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::design::design;
use cg_vehicle::scales::{Scale, Scales};
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of the axle scale, relative.
const SCALE_SD: f64 = 0.05;
const LOADS: [Load; 4] = [
    Load { trailer_mass_kg: 14e3, cg_height_m: 1.5 },
    Load { trailer_mass_kg: 20e3, cg_height_m: 1.8 },
    Load { trailer_mass_kg: 26e3, cg_height_m: 1.9 },
    Load { trailer_mass_kg: 32e3, cg_height_m: 2.1 },
];

/// A truck whose file is known to 0.2 %, except for its scale, and whose load stands where the file says.
/// Then almost only the mass makes the interval.
fn truck() -> Vehicle {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let mut table = "";
    let lines = text.lines().map(|line| {
        table = if line.starts_with('[') { line } else { table };
        match line.split_once(" = ") {
            Some(("payload_place_sd_m", _)) => line.to_owned(),
            Some((key, _)) if table.starts_with("[uncertainty]") => format!("{key} = 0.002"),
            _ => line.to_owned(),
        }
    });
    let scale = format!("[sensors.mass]\naxle_load_sd = {SCALE_SD}\n");
    let exact = lines.chain([scale]).collect::<Vec<_>>().join("\n");
    Vehicle::parse(&exact, "exact.toml").unwrap()
}

/// A drive with one turn.
fn rows(vehicle: &Vehicle, load: Load) -> Vec<LogRow> {
    let scenario = Scenario {
        load,
        rate_hz: 50.0,
        duration_s: 12.0,
        ..Scenario::of(vehicle, Maneuver::RoundedStep)
    };
    let mut rows = Vec::new();
    let keep = |row: &LogRow| {
        rows.push(*row);
        Ok::<(), VehicleError>(())
    };
    LogSimulation::new(vehicle, scenario).unwrap().run_true(keep).unwrap();
    rows
}

/// The result with other scales in the log.
fn weighed(
    (vehicle, design): (&Vehicle, &Design<f64>),
    rows: &[LogRow],
    options: EstimateOptions,
    scales: LogRow,
) -> LogEstimate {
    let options = options.with_file(vehicle);
    let mut estimator = LogEstimator::from_design(design, vehicle.align_settings(), options);
    for row in rows {
        let LogRow { trailer_mass_kg, trailer_axle_load_kg, .. } = scales;
        estimator.push(&LogRow { trailer_mass_kg, trailer_axle_load_kg, ..*row }).unwrap();
    }
    estimator.finish()
}

fn axle_load(trailer_axle_load_kg: f64) -> LogRow {
    LogRow { trailer_axle_load_kg, ..LogRow::ABSENT }
}

/// An axle scale with a drawn error of 5 %, stated as 5 %: 95 % of the intervals hold the height.
#[test]
fn a_scale_with_the_stated_error_is_covered() {
    const DRAWS: u32 = 250;
    let vehicle = truck();
    let design = design(&vehicle, Variant::Complete).unwrap();
    let [at_zero_kg, slope] = vehicle.mass_of_axle_load().unwrap();
    let mut rng = StdRng::seed_from_u64(3);
    let (mut held, mut exact, mut given) = (0, 0, 0);
    for load in LOADS {
        let rows = rows(&vehicle, load);
        let axle_load_kg = (load.trailer_mass_kg - at_zero_kg) / slope;
        for _ in 0..DRAWS {
            let error: f64 = StandardNormal.sample(&mut rng);
            let scale = axle_load(axle_load_kg * (1.0 + SCALE_SD * error));
            let holds = |trailer_mass_sd_kg| {
                let options = EstimateOptions { trailer_mass_sd_kg, ..EstimateOptions::default() };
                let estimate = weighed((&vehicle, &design), &rows, options, scale);
                let [low, high] = estimate.height_ci95_m.unwrap();
                u32::from((low..=high).contains(&load.cg_height_m))
            };
            given += 1;
            held += holds(None);
            exact += holds(Some(0.0)); // the option beats the scale's
        }
    }
    let share = |n: u32| f64::from(n) / f64::from(given);
    println!("{:.1} % hold, {:.1} % if exact", 100.0 * share(held), 100.0 * share(exact));
    // The interval is as wide on both sides as on the wider one, that of a lighter trailer, so it contains
    // mass errors up to 1.96 · 2/1.77 = 2.2 standard deviations (below): 97.2 %. Of 1000 draws, ±1.6 % are
    // three standard deviations.
    assert!((0.956..=0.988).contains(&share(held)), "{held} of {given}");
    assert!(share(exact) < 0.5, "{exact} of {given}");
}

/// A scale that is wrong by 10 %, twice its stated standard deviation: the interval still holds the height.
/// Half of the change that 10 % make on the wider side is the standard deviation. Seen from the true mass,
/// they make less on that side, and on the other side less anyway.
#[test]
fn a_scale_that_is_wrong_by_two_standard_deviations_is_covered() {
    let vehicle = truck();
    let design = design(&vehicle, Variant::Complete).unwrap();
    let [at_zero_kg, slope] = vehicle.mass_of_axle_load().unwrap();
    for load in LOADS {
        let rows = rows(&vehicle, load);
        let axle_load_kg = (load.trailer_mass_kg - at_zero_kg) / slope;
        for sds in [-2.0_f64, 0.0, 2.0] {
            let options = EstimateOptions::default();
            let scale = axle_load((1.0 + sds * SCALE_SD) * axle_load_kg);
            let estimate = weighed((&vehicle, &design), &rows, options, scale);
            let (h, sd) = (estimate.height_m.unwrap(), estimate.height_sd_m.unwrap());
            let distance = (h - load.cg_height_m).abs() / sd;
            println!("{load:?} {sds:+}: {h:.3} ± {sd:.3} m, {distance:.2}");
            let expected = if sds.abs() < 1.0 { 0.0..0.1 } else { 1.6..1.96 };
            assert!(expected.contains(&distance), "{load:?} {sds:+}: {distance}");
        }
    }
}

/// A column of the trailer mass is exact, as before, if the vehicle file does not say otherwise; the
/// answer names a scale that is not.
#[test]
fn each_scale_has_its_own_standard_deviation() {
    let mut vehicle = truck();
    let design = design(&vehicle, Variant::Complete).unwrap();
    let (load, options) = (LOADS[2], EstimateOptions::default());
    let rows = rows(&vehicle, load);
    let [at_zero_kg, slope] = vehicle.mass_of_axle_load().unwrap();
    let axle_load_kg = (load.trailer_mass_kg - at_zero_kg) / slope;
    let column = LogRow { trailer_mass_kg: load.trailer_mass_kg, ..LogRow::ABSENT };

    let exact = weighed((&vehicle, &design), &rows, options, column);
    let plain = {
        let mut estimator = LogEstimator::from_design(&design, vehicle.align_settings(), options);
        for row in &rows {
            estimator.push(row).unwrap();
        }
        estimator.finish()
    };
    assert_eq!(exact, plain);
    let names = |estimate: &LogEstimate, part: &str| estimate.messages.join("; ").contains(part);
    assert!(!names(&exact, "standard deviation"), "{:?}", exact.messages);

    let axles = weighed((&vehicle, &design), &rows, options, axle_load(axle_load_kg));
    assert!((axles.height_m.unwrap() - exact.height_m.unwrap()).abs() < 1e-9);
    assert!(axles.height_sd_m > exact.height_sd_m);
    let sd_kg = SCALE_SD * slope * axle_load_kg;
    let message = format!(
        "the trailer mass of 26000 kg is from the load of the trailer's axles; its standard deviation of \
         {sd_kg:.0} kg is part of the interval"
    );
    assert!(names(&axles, &message), "{message}: {:?}", axles.messages);

    // As given by an option, with the same standard deviation.
    let given = EstimateOptions {
        trailer_mass_kg: Some(load.trailer_mass_kg),
        trailer_mass_sd_kg: Some(sd_kg),
        ..options
    };
    let given = weighed((&vehicle, &design), &rows, given, LogRow::ABSENT);
    assert!((given.height_sd_m.unwrap() - axles.height_sd_m.unwrap()).abs() < 1e-9);
    assert!(names(&given, "is from a weighbridge"), "{:?}", given.messages);

    let mut sd = vehicle.sensors.mass.unwrap();
    sd.weighed_sd_kg = 300.0;
    vehicle.sensors.mass = Some(sd);
    let scales = Scales::of(&vehicle);
    let close = |scale, expected: f64| {
        let found = scales.sd_kg(scale, load.trailer_mass_kg);
        assert!((found - expected).abs() < 1e-9, "{scale}: {found} {expected}");
    };
    close(Scale::Weighed, 300.0);
    close(Scale::VehicleWeight, 0.05 * 26e3);
    close(Scale::AxleLoad, sd_kg);
    close(Scale::SuspensionPressure, sd_kg); // 5 % too
    let [at_zero_kg, _] = vehicle.mass_of_drive_load().unwrap();
    close(Scale::DrivePressure, 0.05 * (26e3 - at_zero_kg));
    let weighbridge = weighed((&vehicle, &design), &rows, options, column);
    assert!(names(&weighbridge, "300 kg is part of the interval"), "{:?}", weighbridge.messages);
    assert!(weighbridge.height_sd_m > exact.height_sd_m);
}
