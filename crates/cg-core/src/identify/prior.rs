//! The prior of the identification.

use crate::identify::equations::Equations;
use crate::identify::pending::{BLOCK, Pending};
use crate::identify::unknowns::{DRIFT, DRIFT_S, GAIN, OFFSET, REGRESSORS, UNKNOWNS};
use crate::math::real::Real;
use crate::truck::reduced::{ORDER, Reduced5};

/// Weight of prior rows that fix the dynamics to those of the model. The weight of the data is the
/// roll angle times the root of the number of rows, which is about 3.
const HELD: f64 = 1e3;

/// Prior knowledge of [`FilteredArx`](crate::FilteredArx).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// No prior.
    pub(crate) const NONE: Self = Self {
        dynamics_sd: T::ZERO,
        noise_floor_rad: T::ZERO,
        offset_sd_rad: T::ZERO,
        drift_sd_radps: T::ZERO,
    };

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

    /// Adds the prior rows for a residual of standard deviation `noise_sd`. If `held` is true, the
    /// dynamics are fixed to those of the model.
    #[inline(never)]
    pub(crate) fn add_to(
        &self,
        triangle: &mut Equations<T>,
        model: &Reduced5<T>,
        noise_sd: T,
        held: bool,
    ) {
        let mut pending = Pending::<T, REGRESSORS, BLOCK>::new();
        for k in 0..UNKNOWNS {
            if let Some(weight) = self.weight(model, k, noise_sd) {
                let mut row = [T::zero(); REGRESSORS];
                row[k] = if held && k < OFFSET { T::of(HELD) } else { weight };
                pending.push_into(triangle, row, T::zero());
            }
        }
        pending.fold_into(triangle);
    }

    /// Weight of the prior row of unknown `k`; the gain has no prior.
    pub(crate) fn weight(&self, model: &Reduced5<T>, k: usize, noise_sd: T) -> Option<T> {
        let size =
            |coefficients: &[T], k: usize| coefficients.get(k).copied().unwrap_or(T::zero()).abs();
        let sd = match k {
            GAIN => return None,
            OFFSET => self.offset_sd_rad,
            DRIFT => self.drift_sd_radps * T::of(DRIFT_S),
            _ if k < ORDER => self.dynamics_sd * size(&model.denominator, k),
            // A numerator coefficient that happens to be small is not known more accurately.
            _ => {
                let least = model.dc_gain().abs() * T::of(0.2);
                self.dynamics_sd * size(&model.numerator, k - GAIN).max(least)
            }
        };
        // The column of a fixed unknown is zero. Any weight keeps it at zero; a large one makes its
        // variance negligible.
        Some(if sd > T::zero() { noise_sd / sd } else { T::of(HELD) })
    }
}
