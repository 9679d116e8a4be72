//! Load transfer of an instant of the plant.
//!
//! ```text
//!     (Σ F_right − Σ F_left) / (Σ F_right + Σ F_left)
//! ```
//!
//! over all axles it is the load transfer ratio (Preston-Thomas and Woodrooffe); without the
//! steered ones, whose wheels leave the road last or never, it is Liu's roll safety factor, which
//! reaches one exactly when every other inner wheel is off the road.

use crate::plant::PlantSample;

/// Standard gravity: what "g" means in measures, whatever the vehicle file's own is.
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;

/// Both measures at an instant; positive when the right side carries more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transfer {
    /// Over all axles.
    pub load_transfer_ratio: f64,
    /// Over the axles that are not steered.
    pub roll_safety_factor: f64,
}

impl Transfer {
    /// Of a sample of the plant.
    pub fn of(sample: &PlantSample) -> Self {
        let (mut difference, mut sum) = (0.0, 0.0);
        for axle in sample.axles() {
            difference += axle.right_load_n - axle.left_load_n;
            sum += axle.right_load_n + axle.left_load_n;
        }
        Self {
            load_transfer_ratio: if sum > 0.0 { difference / sum } else { 0.0 },
            roll_safety_factor: sample.load_transfer_ratio,
        }
    }

    /// The greater of both in each measure, by size.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            load_transfer_ratio: worse(self.load_transfer_ratio, other.load_transfer_ratio),
            roll_safety_factor: worse(self.roll_safety_factor, other.roll_safety_factor),
        }
    }
}
