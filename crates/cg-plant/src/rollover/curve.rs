//! The speed at which a curve keeps a margin to the rollover threshold.

use cg_core::{Measured, curve_speed_mps};
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Variant, Vehicle};

/// A level curve and the margin in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Radius of the trailer's path.
    pub radius_m: f64,
    /// Share of the lower bound of the threshold that the curve may use.
    pub share: f64,
    /// Standard deviation of the height, from which the bound follows; 0 for a height that is known.
    pub height_sd_m: f64,
}

impl Curve {
    /// The greatest speed that keeps the margin, with the threshold as the estimator on board has it;
    /// `None` if the mass is outside its design.
    ///
    /// # Errors
    /// [`VehicleError`] if a number is impossible, or if the vehicle has no design.
    pub fn speed_mps(&self, vehicle: &Vehicle, load: Load) -> Result<Option<f64>, VehicleError> {
        let Self { radius_m, share, height_sd_m } = *self;
        let is_possible = radius_m > 0.0
            && share > 0.0
            && share <= 1.0
            && (0.0..f64::INFINITY).contains(&height_sd_m);
        if !is_possible {
            return Err(VehicleError::Model(format!(
                "a curve of {radius_m} m, share {share}, height known to {height_sd_m} m: the radius must \
                 be positive, the share above 0 and at most 1, and the standard deviation not negative"
            )));
        }
        let design = design(vehicle, Variant::Complete)?;
        let height = Measured { value: load.cg_height_m, sd: height_sd_m };
        Ok(curve_speed_mps(design, height, load.trailer_mass_kg, radius_m, share))
    }

    pub(super) fn meaning(&self) -> String {
        let Self { radius_m, share, height_sd_m } = self;
        format!(
            "Greatest speed in a level curve of {radius_m} m that uses {:.0} % of the lower bound (95 %) of \
             the threshold on board, for a height that is known to {height_sd_m} m (standard deviation).",
            100.0 * share
        )
    }
}
