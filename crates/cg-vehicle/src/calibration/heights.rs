//! Runs of unknown height: what their ratios tell apart from the height.
//!
//! Each of these heights is an unknown with a flat prior. With the slopes `D` of the ratios over the
//! heights, the linearized ratios and their covariance are
//!
//! ```text
//!     z = H x + D h + e,     S = H P0 Hᵀ + R,     h = (Dᵀ S⁻¹ D)⁻¹ Dᵀ S⁻¹ z
//! ```
//!
//! The parameters follow from what the heights leave of `z`, so `S⁻¹` is replaced by
//! `S⁻¹ − S⁻¹ D (Dᵀ S⁻¹ D)⁻¹ Dᵀ S⁻¹`. A run with one ratio then tells nothing.
//!
//! **Reference.** Rasmussen and Williams, *Gaussian Processes for Machine Learning*, §2.7, eq. 2.42.

use cg_core::Measured;
use nalgebra::allocator::Allocator;
use nalgebra::{Cholesky, DMatrix, DVector, DefaultAllocator, Dim, Dyn, OMatrix};

use super::ratios::{Ratios, Run};
use crate::belief::Deviations;
use crate::error::VehicleError;
use crate::vehicle::Vehicle;

/// The heights that are not known, each with the index of its run.
pub(super) struct Heights {
    run: Vec<usize>,
    /// Standard deviations, m.
    sd_m: Vec<f64>,
    /// Possible heights, m.
    range_m: [f64; 2],
}

impl Heights {
    /// The unknown heights of runs.
    pub(super) fn of(vehicle: &Vehicle, runs: &[Run]) -> Self {
        let run: Vec<usize> = (0..runs.len()).filter(|&i| !runs[i].height_is_known()).collect();
        let range_m = [vehicle.height.least_m, vehicle.height.greatest_m];
        Self { sd_m: vec![f64::INFINITY; run.len()], run, range_m }
    }

    /// Number of unknown heights.
    pub(super) fn count(&self) -> usize {
        self.run.len()
    }

    /// Slopes of the logarithms of the ratios over the unknown heights, 1/m.
    pub(super) fn slopes(
        &self,
        ratios: &Ratios<'_>,
        mean: &Deviations,
    ) -> Result<DMatrix<f64>, VehicleError> {
        let mut slopes = DMatrix::zeros(ratios.observations.len(), self.count());
        for (j, &run) in self.run.iter().enumerate() {
            let of_channels = ratios.height_slopes(run, mean)?;
            for (k, observation) in ratios.observations.iter().enumerate() {
                if observation.run == run {
                    slopes[(k, j)] = of_channels[observation.channel.index()];
                }
            }
        }
        Ok(slopes)
    }

    /// Moves the heights of the runs to what is `left` of the ratios says. Returns the greatest change, m.
    pub(super) fn step(
        &mut self,
        runs: &mut [Run],
        (innovation, left): (&Innovation, &DVector<f64>),
    ) -> f64 {
        let Some(of_heights) = &innovation.of_heights else { return 0.0 };
        let by_m = of_heights.gain.transpose() * left;
        let [least_m, greatest_m] = self.range_m;
        let mut greatest_step_m = 0.0_f64;
        for (j, &i) in self.run.iter().enumerate() {
            let height_m = &mut runs[i].load.cg_height_m;
            let before_m = *height_m;
            *height_m = (before_m + by_m[j]).clamp(least_m, greatest_m);
            greatest_step_m = greatest_step_m.max((*height_m - before_m).abs());
            self.sd_m[j] = of_heights.covariance[(j, j)].sqrt();
        }
        greatest_step_m
    }

    /// The heights found, one for each run; `None` if it was known.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if a height is at the end of the possible range.
    pub(super) fn found(&self, runs: &[Run]) -> Result<Vec<Option<Measured<f64>>>, VehicleError> {
        let mut found = vec![None; runs.len()];
        let [least_m, greatest_m] = self.range_m;
        for (&i, &sd) in self.run.iter().zip(&self.sd_m) {
            let Run { log, load, .. } = &runs[i];
            let value = load.cg_height_m;
            if !(least_m < value && value < greatest_m) {
                return Err(VehicleError::Model(format!(
                    "{log}: no height between {least_m} m and {greatest_m} m, the vehicle file's range, \
                     gives its ratios: check its mass and its sensors"
                )));
            }
            found[i] = Some(Measured { value, sd });
        }
        Ok(found)
    }
}

/// What the unknown heights take from the ratios.
struct OfHeights {
    slopes: DMatrix<f64>,
    /// `S⁻¹ D (Dᵀ S⁻¹ D)⁻¹`.
    gain: DMatrix<f64>,
    /// `(Dᵀ S⁻¹ D)⁻¹`.
    covariance: DMatrix<f64>,
}

/// The inverse covariance of the ratios before they are used, without what the unknown heights take.
pub(super) struct Innovation {
    cholesky: Cholesky<f64, Dyn>,
    of_heights: Option<OfHeights>,
}

impl Innovation {
    /// From the covariance of the ratios and their slopes over the unknown heights; `None` if it is
    /// singular.
    pub(super) fn new(covariance: DMatrix<f64>, slopes: DMatrix<f64>) -> Option<Self> {
        let cholesky = covariance.cholesky()?;
        if slopes.ncols() == 0 {
            return Some(Self { cholesky, of_heights: None });
        }
        let solved = cholesky.solve(&slopes);
        let covariance = (slopes.transpose() * &solved).cholesky()?.inverse();
        let gain = solved * &covariance;
        Some(Self { cholesky, of_heights: Some(OfHeights { slopes, gain, covariance }) })
    }

    /// The product with some columns.
    pub(super) fn solve<C: Dim>(&self, columns: &OMatrix<f64, Dyn, C>) -> OMatrix<f64, Dyn, C>
    where
        DefaultAllocator: Allocator<Dyn, C> + Allocator<Dyn, C>,
    {
        let solved = self.cholesky.solve(columns);
        match &self.of_heights {
            None => solved,
            Some(OfHeights { slopes, gain, .. }) => &solved - gain * (slopes.transpose() * &solved),
        }
    }
}
