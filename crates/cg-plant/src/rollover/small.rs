//! Measures from the linear model: rearward amplification over frequency, damping of the yaw modes.

use std::f64::consts::TAU;

use cg_vehicle::eigen::participation;
use cg_vehicle::equations::w;
use cg_vehicle::error::VehicleError;
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
        -self.pole_radps.0 / self.pole_radps.0.hypot(self.pole_radps.1)
    }
}

/// The modes of a linear model of [`Equations`](cg_vehicle::equations::Equations), slowest decay first.
///
/// By the states' [`participation`], lateral velocity, yaw rates and articulation are yaw.
///
/// # Errors
/// If the eigenvalues do not converge.
pub fn modes(model: &StateSpace) -> Result<Vec<Mode>, VehicleError> {
    let articulation = model.articulation.iter().position(|share| *share != 0.0);
    let mut modes: Vec<Mode> = participation(&model.a)?
        .iter()
        .filter(|mode| mode.value.im >= 0.0)
        .map(|mode| {
            let part = |k: usize| mode.factors[k].norm();
            let yaw: f64 =
                [w::LATERAL, w::YAW_1, w::YAW_2].into_iter().chain(articulation).map(part).sum();
            Mode {
                pole_radps: (mode.value.re, mode.value.im),
                yaw_share: yaw / (0..mode.factors.len()).map(part).sum::<f64>(),
            }
        })
        .collect();
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
