//! What is known of a channel before its rows say anything.

use crate::math::real::Real;

/// Prior knowledge that [`FilteredArx`](crate::FilteredArx) starts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior<T> {
    /// Relative standard deviation of each coefficient of the dynamics about the reduced
    /// model: 0 = nominal dynamics, only the gain is free; infinity = no prior.
    pub dynamics_sd: T,
    /// Least standard deviation of the residual, radians: the sensor's resolution. Without
    /// it a clean log would switch the prior off.
    pub noise_floor_rad: T,
    /// Standard deviation of a constant roll offset, radians; 0 = no offset regressor,
    /// infinity = a free one.
    pub offset_sd_rad: T,
    /// Standard deviation of a steady drift of that offset, radians per second; 0 = none.
    pub drift_sd_radps: T,
}

impl<T: Real> Prior<T> {
    /// Dynamics within 20 %, a sensor of 0.01 degrees (2e-4 rad), a free offset that drifts by a
    /// degree a minute (3e-4 rad/s): much for a sensor that is warm, usual while one warms up.
    pub fn standard() -> Self {
        Self {
            dynamics_sd: T::of(0.2),
            noise_floor_rad: T::of(2e-4),
            offset_sd_rad: T::one() / T::zero(),
            drift_sd_radps: T::of(3e-4),
        }
    }
}
