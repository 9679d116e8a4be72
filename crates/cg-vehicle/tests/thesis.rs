//! The printed numbers of the source, from `fixtures/vehicles/baseline.toml`.
#![allow(clippy::unreadable_literal, clippy::unwrap_used)] // printed numbers; helpers of tests

use cg_core::{Measured, ratio::solve_height};
use cg_vehicle::linear::{Equations, ratio_line};
use cg_vehicle::{LinearModel, Load, Variant, Vehicle};

const METRES_PER_INCH: f64 = 0.0254;

fn baseline() -> Vehicle {
    Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml"))
        .unwrap()
}

fn as_printed(vehicle: &Vehicle) -> LinearModel {
    LinearModel::new(
        vehicle,
        Variant::AsPrinted,
        vehicle.nominal_speed_mps,
        vehicle.reference_load(),
    )
    .unwrap()
}

/// Table 4.1: all 35 coefficients to 1.2e-4 (A16 is printed with three digits: 1.1e-4 of
/// rounding; the others with five).
#[test]
fn table_4_1() {
    let a = [
        -4.5839e25, -3.1469e24, -5.4802e24, -8.4501e23, -1.2374e23, -4.2398e21, -1.4943e20,
        -3.0392e18, -6.1256e16, -8.1600e14, -1.0676e13, -9.0020e10, -7.5645e8, -3.1832e6,
        -1.4555e4, 16.6094, 0.0691,
    ];
    let b = [
        8.0754e25, 9.4037e25, 5.5958e25, 1.5906e25, 2.9831e24, 3.8434e23, 2.7942e22, 1.1477e21,
        4.0993e19, 1.0346e18, 2.3719e16, 4.1120e14, 6.5492e12, 7.9242e10, 8.8552e8, 7.1043e6,
        5.3241e4, 230.9788, 1.0,
    ];
    let model = as_printed(&baseline()).state_space;
    let found = model.to_trailer_roll().transfer_function().unwrap();
    assert_eq!((found.numerator.len(), found.denominator.len()), (17, 19));
    for (k, printed) in a.iter().enumerate() {
        // The source's signs: steer to the right positive, roll as ours.
        let ours = -found.numerator[16 - k];
        assert!((ours / printed - 1.0).abs() <= 1.2e-4, "A{k}: {ours:e} {printed:e}");
    }
    for (k, printed) in b.iter().enumerate() {
        let ours = found.denominator[18 - k];
        assert!((ours / printed - 1.0).abs() <= 1.2e-4, "B{k}: {ours:e} {printed:e}");
    }
}

/// Table 4.2: poles and zeros to 1e-4 (half a unit of the last printed digit is 0.5e-4, of
/// each part).
#[test]
fn table_4_2() {
    let poles = [
        (-24.2492, 87.2522),
        (-22.1080, 85.3078),
        (-24.9767, 62.2282),
        (-20.5391, 60.6393),
        (-7.6665, 60.6146),
        (-5.0701, 51.9695),
        (-10.1493, 0.0),
        (-1.3959, 5.5499),
        (-6.2942, 0.0),
        (-1.2621, 1.2798),
    ];
    let zeros = [
        (-532.7544, 0.0),
        (493.8908, 0.0),
        (-24.2487, 87.2532),
        (-23.6844, 86.2743),
        (-0.0009, 63.4241),
        (-25.0791, 62.2382),
        (-24.2174, 61.3193),
        (-3.9795, 6.3251),
        (0.4710, 2.9178),
    ];
    let model = as_printed(&baseline()).state_space;
    let found = model.to_trailer_roll().transfer_function().unwrap();
    for (printed, ours) in [(&poles[..], &found.poles), (&zeros[..], &found.zeros)] {
        for &(re, im) in printed {
            let nearest = ours
                .iter()
                .map(|root| (root.0 - re).hypot(root.1 - im))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest <= 1e-4, "{re} ± {im}i: {nearest:e} away");
        }
    }
    assert!((found.gain.abs() - 0.0691).abs() < 1e-4);
}

/// Eq. 5.17, in metres here and inches there.
#[test]
fn equation_5_17() {
    let (a0, a1, b0, b1) = (-1.9772e270, -1.0268e270, 1.6703e272, -2.9656e269);
    let line = as_printed(&baseline()).ratio[0];
    for (ours, printed) in [
        (line.a1 / line.a0, a1 / a0 / METRES_PER_INCH),
        (line.b1 / line.b0, b1 / b0 / METRES_PER_INCH),
        (-line.a0 / line.b0, a0 / b0),
    ] {
        assert!((ours / printed - 1.0).abs() <= 1e-4, "{ours} {printed}");
    }
}

#[test]
fn the_ratio_is_exactly_linear_over_linear_in_height() {
    let vehicle = baseline();
    for variant in [Variant::Complete, Variant::AsPrinted] {
        let lines = ratio_line(&vehicle, variant, 17.0, vehicle.reference_load()).unwrap();
        for cg_height_m in [1.2, 1.7, 2.7] {
            let load = Load { cg_height_m, ..vehicle.reference_load() };
            let model =
                Equations::new(&vehicle, variant, 17.0, load).unwrap().state_space().unwrap();
            let roll = model.steady(&model.trailer_roll, 0.0).unwrap();
            let lateral =
                model.steady(&model.lateral_acceleration, model.lateral_feedthrough).unwrap();
            // Rounding of two 10 × 10 solutions with condition numbers near 1e5.
            assert!((lines[0].ratio_at(cg_height_m) / roll - 1.0).abs() < 1e-9);
            assert!((lines[1].ratio_at(cg_height_m) / (roll / lateral) - 1.0).abs() < 1e-9);
        }
    }
}

/// The fifth wheel's moment makes one calibration good over the whole range: the source's own
/// eight measured gains (Table 5.11 through eq. 5.17), `R_c` fixed at 1.973 m.
#[test]
fn the_complete_model_recovers_the_eight_heights() {
    let heights = [1.854, 1.905, 1.973, 2.007, 2.057, 2.108, 2.159, 2.210];
    let measured = [0.7610, 0.7972, 0.8454, 0.8699, 0.9064, 0.9454, 0.9849, 1.0245];
    let complete = [0.7655, 0.8014, 0.8503, 0.8751, 0.9121, 0.9505, 0.9896, 1.0294];
    let printed = [0.5291, 0.5455, 0.5676, 0.5788, 0.5953, 0.6122, 0.6293, 0.6466];
    let vehicle = baseline();
    let line = |variant| {
        ratio_line(&vehicle, variant, vehicle.nominal_speed_mps, vehicle.reference_load()).unwrap()
            [0]
    };
    let (ours, theirs) = (line(Variant::Complete), line(Variant::AsPrinted));
    let compensation = measured[2] / ours.ratio_at(1.973);
    for k in 0..8 {
        // Four digits: one unit of the fourth.
        assert!(
            (ours.ratio_at(heights[k]) - complete[k]).abs() < 1e-4,
            "{}",
            ours.ratio_at(heights[k])
        );
        assert!((theirs.ratio_at(heights[k]) - printed[k]).abs() < 1e-4);
        let ratio = Measured::exact(measured[k]);
        let found = solve_height(&ours, ratio, Measured::exact(compensation), 0.0).unwrap().value;
        let error = found / heights[k] - 1.0;
        println!("{:.3} m: {found:.4} m, {:+.3} %", heights[k], 100.0 * error);
        assert!(error.abs() <= 1.0e-3);
    }
}
