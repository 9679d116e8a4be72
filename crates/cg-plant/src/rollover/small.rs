//! Measures from the linear model: rearward amplification over frequency, damping of the yaw modes.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use cg_vehicle::equations::w;
use cg_vehicle::error::VehicleError;
use cg_vehicle::matrix::eigenvalues;
use cg_vehicle::response::StateSpace;
use cg_vehicle::system::System;

/// The system from steer to the lateral acceleration of the tractor's sprung c.g.
pub fn to_tractor_lateral_acceleration(model: &StateSpace, speed_mps: f64) -> System {
    let v = &model.tractor_lateral_velocity;
    // v̇ + U r
    let row = model.a.tr_mul(v) + &model.tractor_yaw_rate * speed_mps;
    model.to(&row, v.dot(&model.b))
}

/// `|a_y2/a_y1|` at a frequency.
///
/// # Errors
/// If there is a pole at this frequency.
pub fn rearward_amplification(
    model: &StateSpace,
    speed_mps: f64,
    frequency_hz: f64,
) -> Result<f64, VehicleError> {
    let omega = TAU * frequency_hz;
    let trailer = model.to_lateral_acceleration().magnitude(omega)?;
    Ok(trailer / to_tractor_lateral_acceleration(model, speed_mps).magnitude(omega)?)
}

/// A mode of the linear model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mode {
    /// Pole, rad/s: real and imaginary part, the latter not negative.
    pub pole_radps: (f64, f64),
    /// Share of lateral and yaw motion in the mode (participation factors; the rest is roll).
    pub yaw_share: f64,
}

impl Mode {
    /// `−Re/|pole|`: one if the mode does not oscillate, negative if it grows.
    pub fn damping_ratio(&self) -> f64 {
        -self.pole_radps.0 / libm::hypot(self.pole_radps.0, self.pole_radps.1)
    }
}

/// The participation of the states in the mode of an eigenvalue, up to a common factor: `|x_k y_k|` with its right and left
/// eigenvectors, by inverse iteration.
fn participation(a: &DMatrix<f64>, pole: (f64, f64)) -> Result<DVector<f64>, VehicleError> {
    /// Distance from the eigenvalue, as a share of the matrix, at which the equations can still be solved. Each of the
    /// [`STEPS`] divides the share of other eigenvectors by their distance over this one.
    const BESIDE: f64 = 1e-9;
    const STEPS: usize = 3;
    let n = a.nrows();
    let beside = Complex::new(pole.0 + BESIDE * a.norm(), pole.1);
    let shifted = DMatrix::from_fn(n, n, |i, j| {
        Complex::new(a[(i, j)], 0.0) - if i == j { beside } else { Complex::new(0.0, 0.0) }
    });
    let vector = |matrix: DMatrix<Complex<f64>>| {
        let lu = matrix.lu();
        let mut vector = DVector::from_element(n, Complex::new(1.0, 0.5));
        for _ in 0..STEPS {
            vector = lu.solve(&vector)?;
            vector.unscale_mut(vector.norm());
        }
        Some(vector)
    };
    let (right, left) = (vector(shifted.clone()), vector(shifted.transpose()));
    let (Some(right), Some(left)) = (right, left) else {
        return Err(VehicleError::Model("a mode of the linear model has no shape".to_owned()));
    };
    Ok(DVector::from_fn(n, |k, _| {
        let product = right[k] * left[k];
        libm::hypot(product.re, product.im)
    }))
}

/// The modes of a linear model of [`Equations`](cg_vehicle::equations::Equations), slowest decay first.
///
/// The participation of state `k` in mode `i` is `V_ki (V⁻¹)_ik` (Pérez-Arriaga, Verghese and
/// Schweppe, IEEE Trans. PAS 101, 1982); lateral velocity, yaw rates and articulation are yaw.
///
/// # Errors
/// If the eigenvalues do not converge.
pub fn modes(model: &StateSpace) -> Result<Vec<Mode>, VehicleError> {
    let n = model.a.nrows();
    let articulation = (0..n).find(|&k| model.articulation[k] != 0.0);
    let mut modes = Vec::with_capacity(n);
    for pole in eigenvalues(&model.a)?.into_iter().filter(|pole| pole.1 >= 0.0) {
        let part = participation(&model.a, pole)?;
        let yaw: f64 = [w::LATERAL, w::YAW_1, w::YAW_2]
            .into_iter()
            .chain(articulation)
            .map(|state| part[state])
            .sum();
        modes.push(Mode { pole_radps: pole, yaw_share: yaw / part.sum() });
    }
    modes.sort_by(|a, b| b.pole_radps.0.total_cmp(&a.pole_radps.0));
    Ok(modes)
}

/// The least damping ratio of the modes that are mostly yaw.
///
/// # Errors
/// As [`modes`].
pub fn yaw_damping_ratio(model: &StateSpace) -> Result<Option<f64>, VehicleError> {
    let ratios = modes(model)?.into_iter().filter(|mode| mode.yaw_share > 0.5);
    Ok(ratios.map(|mode| mode.damping_ratio()).min_by(f64::total_cmp))
}
