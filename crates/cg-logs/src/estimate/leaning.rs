//! Whether the trailer leans in straight driving, so that its height can be wrong.

use cg_core::{Sample, Status};
use cg_vehicle::lean::Lean;
use serde::{Deserialize, Serialize};

/// Minimum number of rows for a statement.
const LEAST_ROWS: f64 = 100.0;
/// Distance of the reference payload from the middle from which on its lean is reported. At 0.1 m the
/// height is at most 3 % too great, which is within the interval of every vehicle file (docs/limits.md).
const BESIDE_M: f64 = 0.12;

/// The mean roll angle in straight driving.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leaning {
    rows: f64,
    mean_rad: f64,
}

impl Leaning {
    /// Takes a sample and the state of the estimator after it.
    pub fn push(&mut self, sample: &Sample<f64>, status: Status) {
        if status == Status::Straight && sample.roll_rad.is_finite() {
            self.rows += 1.0;
            self.mean_rad += (sample.roll_rad - self.mean_rad) / self.rows;
        }
    }

    /// What is said of a lean that can make the height wrong, of a vehicle with this [`Lean`].
    pub fn message(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<String> {
        let lean = lean?;
        let least_rad = BESIDE_M * lean.rad_per_kgm * lean.reference_payload_kg;
        let beside_m = lean.beside_m(self.mean_rad, trailer_mass_kg);
        let told = self.rows >= LEAST_ROWS
            && self.mean_rad.abs() > least_rad
            && trailer_mass_kg > 1.1 * lean.empty_kg;
        told.then(|| {
            let [heavy, away] =
                if self.mean_rad > 0.0 { ["right", "left"] } else { ["left", "right"] };
            format!(
                "in straight driving the roll angle is {:.1} degrees: the roll sensor has that offset, or \
                 the load stands about {:.1} m to the {heavy}. In the second case springs and fifth wheel \
                 with play make the height too great in turns to the {away}, also beyond the interval, and \
                 the truck tips over there at a smaller lateral acceleration than is stated",
                self.mean_rad.to_degrees(),
                beside_m.abs(),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(rows: u32, roll_rad: f64) -> Leaning {
        let mut leaning = Leaning::default();
        let turning = Sample { roll_rad: 1.0, ..Sample::absent(0) };
        for _ in 0..rows {
            leaning.push(&Sample { roll_rad, ..Sample::absent(0) }, Status::Straight);
            leaning.push(&turning, Status::Turning);
            leaning.push(&Sample::absent(0), Status::Straight);
        }
        leaning
    }

    /// 0.12 m of 20 t are 24 mrad at 1e-5 rad/(kg m).
    #[test]
    fn a_lean_is_told_with_its_side() {
        let truck = || Some(Lean::from_parts([1e-5, 20e3, 7e3]));
        let found = |rad: f64, mass_kg: f64| straight(100, rad).message(truck(), mass_kg);
        let message = found(0.026, 27e3).unwrap();
        assert!(message.contains("0.1 m to the right") && message.contains("turns to the left"));
        assert!(found(-0.03, 27e3).unwrap().contains("to the left"));
        assert!(found(0.022, 27e3).is_none() && found(0.03, 7.1e3).is_none());
        assert!(straight(99, 0.03).message(truck(), 27e3).is_none());
        assert!(straight(100, 0.03).message(None, 27e3).is_none());
    }
}
