//! Whether the trailer leans in straight driving, so that its height can be wrong.

use cg_core::{Design, Measured, Sample, Status};
use cg_vehicle::lean::Lean;
use serde::{Deserialize, Serialize};

/// Minimum number of rows for a statement.
const LEAST_ROWS: f64 = 100.0;
/// Distance of the reference payload from the middle from which on its lean is reported, for play of the fifth wheel
/// alone and for play of the springs. At 0.12 m the play of a fifth wheel has no effect; with leaf springs 6 t that stand
/// 0.1 m to a side make a calibrated height 4 % too great, 2.5 standard deviations (docs/limits.md).
const BESIDE_M: [f64; 2] = [0.12, 0.03];
/// No load stands farther from the middle: half a trailer is 1.2 m wide. A greater lean is an offset of the sensor.
const FARTHEST_M: f64 = 0.6;
/// Moment of a load about the middle at which the play of springs makes a height uncertain by all of itself, which grows
/// with the square of the moment. On the nonlinear plant with leaf springs, heights of 20 t are at most 4 % too great at
/// 0.13 m, 28 % at 0.2 m and 53 % at 0.3 m, within 1.8 standard deviations (test `payload_place` of cg-plant).
const DOUBLES_KGM: f64 = 10e3;

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

    /// How far, m, the load stands beside the middle if the roll sensor has no offset, of a vehicle with this [`Lean`];
    /// `None` if that cannot make the height wrong.
    pub fn beside_m(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<f64> {
        let lean = lean?;
        let beside_m = BESIDE_M[usize::from(lean.of_springs)];
        let least_rad = beside_m * lean.rad_per_kgm * lean.reference_payload_kg;
        let leans = self.rows >= LEAST_ROWS
            && self.mean_rad.abs() > least_rad
            && trailer_mass_kg > 1.1 * lean.empty_kg;
        let beside_m = lean.beside_m(self.mean_rad, trailer_mass_kg).abs();
        (leans && beside_m <= FARTHEST_M).then_some(beside_m)
    }

    /// Relative standard deviation of the height due to a load beside the middle.
    pub fn height_sd(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> f64 {
        let (Some(beside_m), Some(lean)) = (self.beside_m(lean, trailer_mass_kg), lean) else {
            return 0.0;
        };
        let share = beside_m * (trailer_mass_kg - lean.empty_kg) / DOUBLES_KGM;
        (share * share).min(1.0)
    }

    /// What is said of a lean that can make the height wrong, of a vehicle with this [`Lean`].
    pub fn message(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<String> {
        let beside_m = self.beside_m(lean, trailer_mass_kg)?;
        let [heavy, away] = if self.mean_rad > 0.0 { ["right", "left"] } else { ["left", "right"] };
        Some(format!(
            "in straight driving the roll angle is {:.1} degrees: the roll sensor has that offset, or the load stands \
             about {beside_m:.1} m to the {heavy}. In the second case springs and fifth wheel with play make the \
             height too great in turns to the {away}, and the truck tips over there at a smaller lateral acceleration \
             than is stated. The intervals contain both cases",
            self.mean_rad.to_degrees(),
        ))
    }
}

/// Rollover threshold, g, of a height, m, at a trailer mass, kg, and a speed, m/s, of a load that may stand as far beside
/// the middle, m, as its [lean](Leaning::beside_m) says.
pub fn threshold_g(
    design: &Design<f64>,
    height: Measured<f64>,
    [trailer_mass_kg, speed_mps]: [f64; 2],
    beside_m: f64,
) -> Option<Measured<f64>> {
    let rollover = design.rollover(height, trailer_mass_kg, speed_mps)?;
    let Measured { value, sd } = rollover.static_rollover_threshold_g;
    let earlier_g = design.earlier_g(&rollover, trailer_mass_kg, beside_m);
    Some(Measured { value, sd: libm::hypot(sd, earlier_g) })
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

    /// At 1e-5 rad/(kg m), 0.12 m of 20 t are 24 mrad and 0.03 m are 6 mrad.
    #[test]
    fn a_lean_is_told_with_its_side() {
        let with_play = |of_springs: bool| Some(Lean::from_parts([1e-5, 20e3, 7e3], of_springs));
        let truck = || with_play(false);
        let found = |rad: f64, mass_kg: f64| straight(100, rad).message(truck(), mass_kg);
        for (rad, is_told) in [(0.005, false), (0.007, true)] {
            assert_eq!(straight(100, rad).message(with_play(true), 27e3).is_some(), is_told);
        }
        let message = found(0.026, 27e3).unwrap();
        assert!(message.contains("0.1 m to the right") && message.contains("turns to the left"));
        assert!(found(-0.03, 27e3).unwrap().contains("to the left"));
        assert!(found(0.022, 27e3).is_none() && found(0.03, 7.1e3).is_none());
        assert!(straight(99, 0.03).message(truck(), 27e3).is_none());
        assert!(straight(100, 0.03).message(None, 27e3).is_none());
        // 30 mrad are 3000 kg m of 10 000; a light load would have to stand outside the trailer.
        let sd = |rad: f64| straight(100, rad).height_sd(truck(), 27e3);
        assert!((sd(0.03) - 0.09).abs() < 1e-9 && (sd(-0.03) - 0.09).abs() < 1e-9);
        assert!(sd(0.022) < 1e-12 && straight(99, 0.03).height_sd(truck(), 27e3) < 1e-12);
        assert!(found(0.03, 12.1e3).is_some() && found(0.03, 11.9e3).is_none());
    }
}
