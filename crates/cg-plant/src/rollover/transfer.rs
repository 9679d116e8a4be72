//! Load transfer at an instant of the plant.
//!
//! ```text
//!     (Σ F_right − Σ F_left) / (Σ F_right + Σ F_left)
//! ```
//!
//! Over all axles this is the load transfer ratio (Preston-Thomas and Woodrooffe). Without the
//! steered axles, whose wheels leave the road last or never, it is Liu's roll safety factor, which
//! reaches one exactly when every other inner wheel has left the road.

use crate::plant::PlantSample;

/// Standard gravity, the meaning of "g" in measures, whatever gravity the vehicle file has.
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;

/// Both measures at an instant; positive if the right side carries more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transfer {
    /// Over all axles.
    pub load_transfer_ratio: f64,
    /// Over the axles that are not steered.
    pub roll_safety_factor: f64,
}

impl Transfer {
    /// Load transfer of a sample of the plant.
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

    /// For each measure, the one of both that is greater in magnitude.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        let worse = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            load_transfer_ratio: worse(self.load_transfer_ratio, other.load_transfer_ratio),
            roll_safety_factor: worse(self.roll_safety_factor, other.roll_safety_factor),
        }
    }
}
