//! Eigenvalues and zeros of the models of every vehicle, judged by what they are solutions of.
#![allow(clippy::unwrap_used, clippy::cast_precision_loss)] // helpers of tests; small numbers of states

use cg_core::Output;
use cg_vehicle::equations::Equations;
use cg_vehicle::matrix::eigenvalues;
use cg_vehicle::response::StateSpace;
use cg_vehicle::{Load, Variant, Vehicle};
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, ComplexField, DMatrix};

/// The linear models of all vehicles that have one, slow and fast, low and high.
fn models() -> Vec<(String, StateSpace)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
    let mut models = Vec::new();
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let vehicle = Vehicle::load(path.to_str().unwrap()).unwrap();
        for (speed_mps, cg_height_m) in [(3.0, 2.6), (14.0, 1.2), (30.0, 2.6)] {
            let load = Load { cg_height_m, ..vehicle.reference_load() };
            let equations = Equations::new(&vehicle, Variant::Complete, speed_mps, load).unwrap();
            let name = format!("{} at {speed_mps} m/s, {cg_height_m} m", path.display());
            models.push((name, equations.state_space().unwrap()));
        }
    }
    models
}

fn shifted(matrix: &DMatrix<f64>, by: Complex<f64>) -> DMatrix<Complex<f64>> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
        Complex::new(matrix[(i, j)], 0.0) - if i == j { by } else { Complex::new(0.0, 0.0) }
    })
}

/// The QR algorithm gives the eigenvalues of a matrix that differs by a small multiple of nε, relative
/// to the norm of the balanced matrix (Golub and Van Loan, Matrix Computations, 7.5.6). The least
/// singular value of `A − λ` is the least such difference.
#[test]
fn eigenvalues_are_those_of_a_matrix_that_differs_by_rounding() {
    for (name, model) in models() {
        let n = model.a.nrows();
        let mut balanced = model.a.clone();
        balance_parlett_reinsch(&mut balanced);
        let values = eigenvalues(&model.a).unwrap();
        let values: Vec<_> = values.iter().map(|(re, im)| Complex::new(*re, *im)).collect();
        assert_eq!(values.len(), n);
        let mut worst = 0.0_f64;
        for value in &values {
            let least = shifted(&balanced, *value).singular_values().min();
            worst = worst.max(least / (balanced.norm() * n as f64 * f64::EPSILON));
        }
        assert!(worst < 10.0, "{name}: {worst} n ε");
        // Each value once: their sum is the trace.
        let sum: Complex<f64> = values.iter().sum();
        let error = (sum - model.a.trace()).modulus() / balanced.norm();
        assert!(error < 100.0 * n as f64 * f64::EPSILON, "{name}: {error}");
    }
}

/// The zeros are `σ + 1/μ` for a point σ as far out as the fastest pole, so that rounding moves them by
/// `κ ε |s − σ|²/σ`. The condition κ of these eigenvalues was found to be up to 1.2e5, where two zeros are
/// almost equal. Ten times that is allowed: one part in 1e8 of the slowest zeros.
#[test]
fn the_transfer_function_vanishes_at_its_zeros() {
    let (mut judged, mut cancelled) = (0, 0);
    for (name, model) in models() {
        for output in Output::ALL {
            let system = model.to_output(output);
            let function = system.transfer_function().unwrap();
            let b = system.b.map(|value| Complex::new(value, 0.0));
            let c = system.c.map(|value| Complex::new(value, 0.0));
            let fastest = function.poles.iter().map(|(re, im)| re.hypot(*im)).fold(0.0, f64::max);
            for &(re, im) in &function.zeros {
                let zero = Complex::new(re, im);
                // A pole in the same place: the mode is not in this response, and the model is singular there.
                let near = |&(re, im): &(f64, f64)| (Complex::new(re, im) - zero).modulus();
                if function.poles.iter().map(near).fold(f64::INFINITY, f64::min)
                    < 1e-6 * zero.modulus()
                {
                    cancelled += 1;
                    continue;
                }
                let lu = (-shifted(&system.a, zero)).lu();
                let state = lu.solve(&b).unwrap();
                let slope = -c.dot(&lu.solve(&state).unwrap());
                // What one step of Newton's method would still move.
                let off = ((c.dot(&state) + system.d) / slope).modulus();
                let from_point = (zero - fastest).modulus();
                let most = 1e6 * f64::EPSILON * from_point * from_point / fastest;
                assert!(off < most, "{name} {output:?}: {zero} is off by {off}, at most {most}");
                judged += 1;
            }
        }
    }
    assert!(judged > 10 * cancelled, "{judged} {cancelled}");
}
