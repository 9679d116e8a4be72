//! The prior of the identification.

use crate::math::real::Real;

/// Prior knowledge of [`FilteredArx`](crate::FilteredArx).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior<T> {
    /// Relative standard deviation of each coefficient of the dynamics about the reduced model. 0
    /// fixes the dynamics to the model and leaves only the gain free; infinity means no prior.
    pub dynamics_sd: T,
    /// Lower limit of the residual's standard deviation, radians: the resolution of the sensor.
    /// Without it, a log without noise would give the prior no weight.
    pub noise_floor_rad: T,
    /// Standard deviation of a constant roll offset, radians. 0 means no offset regressor; infinity
    /// leaves the offset free.
    pub offset_sd_rad: T,
    /// Standard deviation of a linear drift of that offset, radians per second; 0 means no drift.
    pub drift_sd_radps: T,
}

impl<T: Real> Prior<T> {
    /// Dynamics within 20 %, a sensor resolution of 0.01 degrees (2e-4 rad), and a free offset that
    /// drifts by about one degree per minute (3e-4 rad/s). This is a large drift for a warm sensor
    /// and a usual one during warm-up.
    pub fn standard() -> Self {
        Self {
            dynamics_sd: T::of(0.2),
            noise_floor_rad: T::of(2e-4),
            offset_sd_rad: T::one() / T::zero(),
            drift_sd_radps: T::of(3e-4),
        }
    }
}
