//! The changes of a truck in service: springs and tires wear, sensors age.
//!
//! Each factor of [`crate::belief`] makes a random walk from the oldest run on, or from the time of a
//! calibration before. The prior holds at that time, so whatever changes later is wear, which leaves the roll centers where they are:
//!
//! ```text
//!     x(t) = x₀ + w(t),     cov(w(s), w(t)) = Q min(s, t),     y(t) = f(x(t)) + e
//! ```
//!
//! The fit determines `x₀`, with the walk as a part of the noise. The same Gaussian then gives the
//! truck of today, `x(T)`, whose uncertainty grows with the time since the newest run.
//!
//! **Reference.** Rasmussen and Williams, *Gaussian Processes for Machine Learning*, §2.2 (prediction).

use nalgebra::{DMatrix, DVector};

use super::heights::Innovation;
use crate::belief::{Belief, Covariance, Deviations, Parameter};
use crate::vehicle::Vehicle;

/// Time in which a factor wanders as far as the vehicle file's `[uncertainty]` leaves it open, s: four
/// years. With 10 % that is 5 % in a year. Springs that lose 15 % in a year are followed nevertheless,
/// because trips with the empty trailer are more exact than the walk.
const WALK_S: f64 = 4.0 * 365.25 * 86_400.0;

/// The walk since the oldest run.
pub(super) struct Walk {
    /// Variance of the walk of each parameter in [`WALK_S`].
    variance: DVector<f64>,
    /// Time of each ratio since the oldest run, in units of [`WALK_S`].
    since: Vec<f64>,
    /// The present time in the same way.
    now: f64,
}

impl Walk {
    /// The walk of a vehicle from the age of the prior and the ages of all ratios, s.
    pub(super) fn new(vehicle: &Vehicle, prior_age_s: f64, ages_s: &[f64]) -> Self {
        let file = Belief::prior(vehicle);
        let mut variance = DVector::from_column_slice(file.covariance.diagonal().as_slice());
        for parameter in Parameter::ALL.into_iter().filter(|parameter| !parameter.is_factor()) {
            variance[parameter as usize] = 0.0;
        }
        let oldest_s = ages_s.iter().copied().fold(prior_age_s.max(0.0), f64::max);
        let since = ages_s.iter().map(|age_s| (oldest_s - age_s) / WALK_S).collect();
        Self { variance, since, now: oldest_s / WALK_S }
    }

    /// Whether any time has passed.
    pub(super) fn is_some(&self) -> bool {
        self.now > 0.0
    }

    /// The covariance of the ratios at the truck of the oldest run: their own noise and the walk.
    pub(super) fn added_to(&self, noise: &DMatrix<f64>, slopes: &DMatrix<f64>) -> DMatrix<f64> {
        if !self.is_some() {
            return noise.clone();
        }
        let walked = slopes * DMatrix::from_diagonal(&self.variance) * slopes.transpose();
        DMatrix::from_fn(self.since.len(), self.since.len(), |i, j| {
            noise[(i, j)] + self.since[i].min(self.since[j]) * walked[(i, j)]
        })
    }

    /// The truck of today: mean relative to that of the prior, and covariance. `slopes` and `left` are the linearized ratios
    /// (`y − f(x₀) + H x₀`, from the prior's mean), `innovation` is of the truck of the oldest run.
    pub(super) fn carried(
        &self,
        prior: &DMatrix<f64>,
        (slopes, left): (&DMatrix<f64>, &DVector<f64>),
        innovation: &Innovation,
    ) -> (Deviations, Covariance) {
        let mut shared = prior * slopes.transpose();
        for (k, since) in self.since.iter().enumerate() {
            let walked = self.variance.component_mul(&slopes.row(k).transpose()) * *since;
            let mut column = shared.column_mut(k);
            column += walked;
        }
        let mean = &shared * innovation.solve(left);
        let today = prior + DMatrix::from_diagonal(&(&self.variance * self.now));
        let covariance = today - &shared * innovation.solve(&shared.transpose());
        let covariance = Covariance::from_fn(|i, j| covariance[(i, j)]);
        (Deviations::from_column_slice(mean.as_slice()), covariance)
    }
}
