//! V7, V8, V9: figures of the thesis from its own nonlinear programs.

use std::f64::consts::FRAC_PI_2;

use cg_plant::plant::{Driver, DriverSettings, Path, PlantOptions, PlantSample, YawRollPlant};
use cg_vehicle::Vehicle;

use super::{G, KMH, at_height, peak, plant, rounded, vehicle};

/// Trailer c.g. heights of Table 5.11 and the steady-state ratios of roll to steer measured there.
const HEIGHTS_M: [f64; 8] = [1.854, 1.905, 1.973, 2.007, 2.057, 2.108, 2.159, 2.210];
const RATIOS: [f64; 8] = [0.7610, 0.7972, 0.8454, 0.8699, 0.9064, 0.9454, 0.9849, 1.0245];

fn ratios(vehicle: &Vehicle) -> Vec<f64> {
    let steer_rad = 3.3_f64.to_radians();
    HEIGHTS_M
        .iter()
        .map(|&height_m| {
            let load = at_height(vehicle, height_m);
            let plant = YawRollPlant::new(vehicle, load, &PlantOptions::default()).unwrap();
            let mut run = plant.start(50.0 * KMH).unwrap();
            let samples = rounded(&mut run, steer_rad, 50.0 * KMH, 15.0);
            samples[samples.len() - 1].trailer.roll_rad / steer_rad
        })
        .collect()
}

/// Table 5.11 through eq. 5.17, with measured springs. The thesis's data of friction, fifth wheel and
/// springs leave an uncertainty of 10 % (a fifth wheel of 3e5 instead of 4e5 N m/rad alone is 3 %, and friction within
/// 4.5 instead of 5.6 mm another 3 %).
#[test]
fn steady_roll_over_height_with_measured_springs() {
    for (k, ratio) in ratios(&vehicle("baseline-tables")).iter().enumerate() {
        println!("{:.3} m: {ratio:.4}, source {:.4}", HEIGHTS_M[k], RATIOS[k]);
        assert!((ratio / RATIOS[k] - 1.0).abs() < 0.10, "{ratio} {}", RATIOS[k]);
    }
}

/// The same with the linear springs that were recovered from the thesis's linear model: its gains agree
/// within 1 %, plus 1 % for the nonlinearity at 3.3 degrees.
#[test]
fn steady_roll_over_height_with_recovered_springs() {
    for (k, ratio) in ratios(&vehicle("baseline")).iter().enumerate() {
        println!("{:.3} m: {ratio:.4}, source {:.4}", HEIGHTS_M[k], RATIOS[k]);
        assert!((ratio / RATIOS[k] - 1.0).abs() < 0.02, "{ratio} {}", RATIOS[k]);
    }
}

fn drive(
    vehicle: &Vehicle,
    height_m: f64,
    path: Path,
    speed_mps: f64,
    end_s: f64,
) -> Vec<PlantSample> {
    let load = at_height(vehicle, height_m);
    let plant = YawRollPlant::new(vehicle, load, &PlantOptions::default()).unwrap();
    let mut run = plant.start(speed_mps).unwrap();
    let mut driver = Driver::new(&plant, path, speed_mps, DriverSettings::default()).unwrap();
    let mut samples = Vec::new();
    while run.time_s() < end_s {
        for _ in 0..10 {
            driver.drive(&mut run);
        }
        samples.push(run.sample());
    }
    samples
}

fn peak_roll_deg(vehicle: &Vehicle, height_m: f64) -> f64 {
    let path = Path::turn(40.0, 100.0, FRAC_PI_2);
    let samples = drive(vehicle, height_m, path, 50.0 * KMH, 18.0);
    peak(&samples, |s| s.trailer.roll_rad).to_degrees()
}

/// Figure 2.26: 4.1 degrees per meter from 1.85 to 2.25 m in a turn of 100 m at 50 km/h. Its curve
/// bends upward, as here. The numbers of the figure are not printed, so a tenth of a degree at either
/// end (0.35 degrees per meter) is allowed.
#[test]
fn peak_roll_in_a_turn_grows_by_four_degrees_per_meter() {
    let vehicle = vehicle("baseline-tables");
    let heights_m = [1.85, 1.95, 2.05, 2.15, 2.25];
    let peaks = heights_m.map(|height_m| peak_roll_deg(&vehicle, height_m));
    println!("{peaks:.2?}");
    let slope = (peaks[4] - peaks[0]) / 0.4;
    assert!((slope - 4.1).abs() < 0.35, "{slope}");
    let low = (peaks[3] - peaks[0]) / 0.3;
    assert!((3.0..4.5).contains(&low), "{low}");
    assert!(peaks.windows(3).all(|p| p[2] - p[1] > p[1] - p[0]), "{peaks:?}");
}

/// Sections 2.7.4, 2.7.5: air suspensions roll more, worn (stiffer) tires less, at about the same
/// slope: air suspensions over the range of heights, worn tires as long as no spring loses its load.
#[test]
fn air_suspensions_roll_more_and_worn_tyres_less() {
    let [base, air, third, half] =
        ["baseline-tables", "air", "worn-tyres-third", "worn-tyres-half"].map(|name| {
            let vehicle = vehicle(name);
            [1.85, 2.05, 2.25].map(|height_m| peak_roll_deg(&vehicle, height_m))
        });
    println!("measured {base:.3?}, air {air:.3?}, 1/3 tread {third:.3?}, 1/2 tread {half:.3?}");
    for k in 0..3 {
        assert!(air[k] > base[k] && third[k] < half[k] && half[k] < base[k]);
    }
    // "About the same" allows a quarter, "does not vary" a tenth.
    let ratio = (air[2] - air[0]) / (base[2] - base[0]);
    assert!((ratio - 1.0).abs() < 0.25, "{ratio}");
    for worn in [third, half] {
        let ratio = (worn[1] - worn[0]) / (base[1] - base[0]);
        assert!((ratio - 1.0).abs() < 0.10, "{ratio}");
    }
}

/// The files with worn tires differ from the measured baseline in one number only.
#[test]
fn worn_tyres_differ_in_vertical_stiffness_only() {
    let base = vehicle("baseline-tables");
    for (name, stiffness) in [("worn-tyres-third", 874_408.3), ("worn-tyres-half", 864_250.9)] {
        let mut worn = vehicle(name);
        assert!((worn.tyre[0].vertical_stiffness_n_per_m - stiffness).abs() < 1e-9);
        worn.tyre[0].vertical_stiffness_n_per_m = base.tyre[0].vertical_stiffness_n_per_m;
        worn.name.clone_from(&base.name);
        assert_eq!(worn, base);
    }
}

/// Figure 2.24: a lane change of 20 m gate length gives "about 0.2 g" (a tenth of it is allowed) and
/// more at a higher speed.
#[test]
fn a_lane_change_gives_about_two_tenths_of_g() {
    let vehicle = vehicle("baseline-tables");
    let peaks = [70.0, 80.0, 90.0, 120.0].map(|kmh| {
        let path = Path::lane_change(15.0, 20.0, 3.65);
        let samples = drive(&vehicle, 1.973, path, kmh * KMH, 8.0);
        let offset_m = samples[samples.len() - 1].position_m[1];
        // Settled on the new lane within 0.1 m.
        assert!((offset_m - 3.65).abs() < 0.1, "{offset_m}");
        peak(&samples, |s| s.trailer.lateral_acceleration_mps2) / G
    });
    println!("peak lateral acceleration at 70, 80, 90, 120 km/h: {peaks:.3?} g");
    assert!(peaks[..3].iter().all(|peak| (0.18..0.22).contains(peak)), "{peaks:?}");
    assert!(peaks.windows(2).all(|pair| pair[0] < pair[1]));
}

/// The model of `MacAdam`'s driver is valid at small slip only, which costs decimeters on a circle.
#[test]
fn the_driver_keeps_to_a_circle() {
    let vehicle = vehicle("baseline-tables");
    let plant = plant(&vehicle);
    let mut run = plant.start(50.0 * KMH).unwrap();
    let path = Path::turn(40.0, 100.0, FRAC_PI_2);
    let mut driver = Driver::new(&plant, path, 50.0 * KMH, DriverSettings::default()).unwrap();
    while run.time_s() < 10.0 {
        driver.drive(&mut run);
    }
    let [x, y] = run.sample().position_m;
    let radius_m = (x - 40.0).hypot(y - 100.0);
    println!("radius {radius_m:.2} m");
    assert!((radius_m - 100.0).abs() < 0.5, "{radius_m}");
}
