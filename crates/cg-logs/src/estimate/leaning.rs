//! Whether the trailer leans in straight driving, so that its height can be wrong and it tips earlier.

use cg_core::{Design, Input, Measured, Output, Sample, Signals, Status};
use cg_vehicle::lean::{Lean, Play};
use serde::{Deserialize, Serialize};

/// Minimum number of rows for a statement.
const LEAST_ROWS: f64 = 100.0;
/// Distance of the reference payload from the middle from which on its lean is reported, and that for play of the springs. At
/// 0.12 m the play of a fifth wheel has no effect; with leaf springs 6 t that stand 0.1 m to a side make a calibrated
/// height 4 % too great, 2.5 standard deviations (docs/limits.md).
const BESIDE_M: f64 = 0.12;
const BESIDE_WITH_PLAY_M: f64 = 0.03;
/// No load stands farther from the middle: half a trailer is 1.2 m wide. A greater lean is an offset of the sensor, which is
/// told from 0.05 rad on.
const FARTHEST_M: f64 = 0.6;
const OFFSET_RAD: f64 = 0.05;
/// Moment of a load about the middle at which the play of springs makes a height uncertain by all of itself, which grows
/// with the square of the moment. On the nonlinear plant with leaf springs, heights of 20 t are at most 4 % too great at
/// 0.13 m, 28 % at 0.2 m and 53 % at 0.3 m, within 1.8 standard deviations (test `payload_place` of cg-plant).
const DOUBLES_KGM: f64 = 10e3;

/// The mean roll angle and suspension roll in straight driving.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leaning {
    roll_rad: Mean,
    suspension_rad: Mean,
    /// The specific force beside the suspension roll.
    force_mps2: Mean,
}

/// A running mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Mean {
    rows: f64,
    value: f64,
}

impl Mean {
    fn push(&mut self, value: f64, rows: f64) {
        self.rows += rows;
        self.value += (value - self.value) * rows / self.rows;
    }
}

/// A load that stands beside the middle, if no sensor has an offset.
struct Beside {
    /// Moment about the middle, to the right, kg m.
    moment_kgm: f64,
    /// The angle that shows it, rad, and its name.
    angle: (f64, &'static str),
    least_m: f64,
}

impl Leaning {
    /// Takes a sample and the state of the estimator after it.
    pub fn push(&mut self, sample: &Sample<f64>, status: Status, gravity_mps2: f64) {
        self.push_mean((sample, 1.0), status, gravity_mps2);
    }

    /// The same for the mean of a number of samples.
    pub(super) fn push_mean(
        &mut self,
        (sample, number): (&Sample<f64>, f64),
        status: Status,
        gravity_mps2: f64,
    ) {
        if status != Status::Straight {
            return;
        }
        if sample.roll_rad.is_finite() {
            self.roll_rad.push(sample.roll_rad, number);
        }
        let signals = Signals::of(sample, sample.speed_mps, gravity_mps2);
        let suspension_roll_rad = signals.output(Output::SuspensionRoll);
        let force_mps2 = signals.input(Input::SpecificForce);
        if suspension_roll_rad.is_finite() && force_mps2.is_finite() {
            self.suspension_rad.push(suspension_roll_rad, number);
            self.force_mps2.push(force_mps2, number);
        }
    }

    /// What the angles say of a load, of a vehicle with this [`Lean`].
    fn beside(&self, lean: Lean, trailer_mass_kg: f64) -> Option<Beside> {
        if self.roll_rad.rows >= LEAST_ROWS {
            return Some(Beside {
                moment_kgm: lean.moment_kgm(self.roll_rad.value),
                angle: (self.roll_rad.value, "roll angle"),
                least_m: if lean.play == Play::Springs { BESIDE_WITH_PLAY_M } else { BESIDE_M },
            });
        }
        let (angle_rad, force_mps2) = (self.suspension_rad.value, self.force_mps2.value);
        (self.suspension_rad.rows >= LEAST_ROWS).then(|| Beside {
            moment_kgm: lean.suspension_moment_kgm(angle_rad, force_mps2, trailer_mass_kg),
            angle: (angle_rad, "suspension roll"),
            // Zeros of levels are known to a few millimeters, which are 0.05 m of 20 t on leaf springs.
            least_m: BESIDE_M,
        })
    }

    /// The same, if it is to be reported, with the distance from the middle, m.
    fn harmful(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<(Beside, f64)> {
        let lean = lean?;
        let found = self.beside(lean, trailer_mass_kg)?;
        let moment_kgm = found.moment_kgm.abs();
        let leans = moment_kgm > found.least_m * lean.reference_payload_kg
            && trailer_mass_kg > 1.1 * lean.empty_kg;
        let beside_m = moment_kgm / (trailer_mass_kg - lean.empty_kg);
        (leans && beside_m <= FARTHEST_M).then_some((found, beside_m))
    }

    /// What is said of an angle that no load makes.
    fn offset(&self, lean: Lean, trailer_mass_kg: f64) -> Option<String> {
        let Beside { angle: (angle_rad, name), moment_kgm, .. } =
            self.beside(lean, trailer_mass_kg)?;
        let payload_kg = (trailer_mass_kg - lean.empty_kg).max(0.0);
        let is_offset = angle_rad.abs() > OFFSET_RAD && moment_kgm.abs() > FARTHEST_M * payload_kg;
        is_offset.then(|| {
            format!(
                "in straight driving the {name} is {:.1} degrees, which no load makes: its sensor is mounted askew, or it is \
                 another signal",
                angle_rad.to_degrees()
            )
        })
    }

    /// How far, m, the load stands beside the middle if the sensor has no offset, of a vehicle with this [`Lean`]; `None` if it
    /// is near the middle.
    pub fn beside_m(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<f64> {
        self.harmful(lean, trailer_mass_kg).map(|(_, beside_m)| beside_m)
    }

    /// Relative standard deviation of the height due to a load beside the middle.
    pub fn height_sd(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> f64 {
        let has_play = lean.is_some_and(|lean| lean.play != Play::None);
        let found = self.harmful(lean, trailer_mass_kg).filter(|_| has_play);
        let Some((Beside { moment_kgm, .. }, _)) = found else { return 0.0 };
        let share = moment_kgm / DOUBLES_KGM;
        (share * share).min(1.0)
    }

    /// What is said of a lean, of a vehicle with this [`Lean`].
    pub fn message(&self, lean: Option<Lean>, trailer_mass_kg: f64) -> Option<String> {
        let Some((Beside { moment_kgm, angle: (angle_rad, name), .. }, beside_m)) =
            self.harmful(lean, trailer_mass_kg)
        else {
            return self.offset(lean?, trailer_mass_kg);
        };
        let [heavy, away] = if moment_kgm > 0.0 { ["right", "left"] } else { ["left", "right"] };
        let because = match lean?.play {
            Play::None => format!("In the second case the truck tips over in turns to the {away}"),
            Play::FifthWheel | Play::Springs => format!(
                "In the second case springs and fifth wheel with play make the height too great in turns to the {away}, \
                 and the truck tips over there"
            ),
        };
        Some(format!(
            "in straight driving the {name} is {:.1} degrees: its sensor has that offset, or the load stands \
             about {beside_m:.1} m to the {heavy}, or the road is banked. {because} at a smaller lateral acceleration than is \
             stated. The intervals contain the first two cases",
            angle_rad.to_degrees(),
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
            leaning.push(&Sample { roll_rad, ..Sample::absent(0) }, Status::Straight, 9.81);
            leaning.push(&turning, Status::Turning, 9.81);
            leaning.push(&Sample::absent(0), Status::Straight, 9.81);
        }
        leaning
    }

    /// At 1e-5 rad/(kg m), 0.12 m of 20 t are 24 mrad and 0.03 m are 6 mrad.
    #[test]
    fn a_lean_is_told_with_its_side() {
        let with_play = |play| Some(Lean::from_parts([1e-5, 20e3, 7e3], play));
        let truck = || with_play(Play::FifthWheel);
        let found = |rad: f64, mass_kg: f64| straight(100, rad).message(truck(), mass_kg);
        for (rad, is_told) in [(0.005, false), (0.007, true)] {
            assert_eq!(
                straight(100, rad).message(with_play(Play::Springs), 27e3).is_some(),
                is_told
            );
        }
        let message = found(0.026, 27e3).unwrap();
        assert!(message.contains("0.1 m to the right") && message.contains("turns to the left"));
        assert!(found(-0.03, 27e3).unwrap().contains("to the left"));
        assert!(found(0.022, 27e3).is_none() && found(0.03, 7.1e3).is_none());
        assert!(straight(99, 0.03).message(truck(), 27e3).is_none());
        assert!(straight(100, 0.03).message(None, 27e3).is_none());
        // Without play the height is right, and the truck tips earlier all the same.
        let linear = straight(100, 0.03);
        assert!(linear.height_sd(with_play(Play::None), 27e3) < 1e-12);
        assert!((linear.beside_m(with_play(Play::None), 27e3).unwrap() - 0.15).abs() < 1e-9);
        let message = linear.message(with_play(Play::None), 27e3).unwrap();
        assert!(message.contains("tips over in turns to the left") && !message.contains("play"));
        // 15 mrad of the suspension are 3000 kg m, too; 0.12 m of 20 t are 12 mrad.
        let by_levels = |suspension_roll_rad: f64, force_mps2: f64| {
            let mut leaning = Leaning::default();
            let sample = Sample {
                suspension_roll_rad,
                lateral_specific_force_mps2: force_mps2,
                ..Sample::absent(0)
            };
            (0..100).for_each(|_| leaning.push(&sample, Status::Straight, 9.81));
            leaning
        };
        let message = by_levels(0.015, 0.0).message(with_play(Play::Springs), 27e3).unwrap();
        assert!(message.contains("suspension roll is 0.9 degrees"), "{message}");
        assert!(message.contains("0.1 m to the right"), "{message}");
        assert!(by_levels(0.0119, 0.0).message(with_play(Play::Springs), 27e3).is_none());
        assert!(by_levels(0.015, f64::NAN).message(with_play(Play::Springs), 27e3).is_none());
        // On a road with a bank that adds 4 mrad.
        let mut banked = with_play(Play::Springs).unwrap();
        banked.suspension_rad_per_mps2 = 0.02;
        assert!(by_levels(0.015, 0.2).message(Some(banked), 27e3).is_none());
        assert!(by_levels(0.017, 0.2).message(Some(banked), 27e3).is_some());
        // 30 mrad are 3000 kg m of 10 000; a light load would have to stand outside the trailer.
        let sd = |rad: f64| straight(100, rad).height_sd(truck(), 27e3);
        assert!((sd(0.03) - 0.09).abs() < 1e-9 && (sd(-0.03) - 0.09).abs() < 1e-9);
        assert!(sd(0.022) < 1e-12 && straight(99, 0.03).height_sd(truck(), 27e3) < 1e-12);
        assert!(found(0.03, 12.1e3).is_some() && found(0.03, 11.9e3).is_none());
        // 0.13 rad are 0.65 m of 20 t, and 0.049 rad are 1 m of 4.9 t.
        assert!(found(0.11, 27e3).unwrap().contains("load stands"));
        assert!(found(-0.13, 27e3).unwrap().contains("-7.4 degrees, which no load makes"));
        assert!(found(0.049, 11.9e3).is_none() && found(0.051, 11.9e3).is_some());
        assert!(sd(0.13) < 1e-12);
    }
}
