//! What strong turns, braking and accelerating of a load make of its height.

use serde::{Deserialize, Serialize};

/// Share of the rollover threshold up to which springs and tires are linear.
const LINEAR: f64 = 0.5;
/// Standard deviation of a height over the square of what a turn exceeds that share by. On the nonlinear plant, steps of
/// the files with measured springs leave 1 to 2 % rms at 0.6 of the threshold and 9 % at 0.8 (docs/limits.md).
const ERROR: f64 = 1.5;
/// Share of the threshold from which on it is told.
const TOLD: f64 = 0.6;

/// Mean braking in turns that has no effect, m/s², and that from which on it is told.
const FREE_MPS2: f64 = 0.1;
const TOLD_MPS2: f64 = 0.2;
/// Relative standard deviation of a height for each m/s² beyond. A tractor that brakes alone pushes the articulated trailer
/// less to the outside: on the nonlinear plant, 72 turns each with a mean of 0.3, 0.5 and 0.75 m/s² have heights that are
/// too great by 1.9, 3.2 and 4.0 % in the mean, and up to 15 % with a light load (docs/limits.md).
const BRAKING_S2_PER_M: f64 = 0.1;
/// The same of accelerating, if the lateral acceleration is yaw rate times speed. On the nonlinear plant, 18 turns each that go
/// faster by 0.2, 0.3 and 0.5 m/s² have heights that are too low by 2.5, 2.9 and 4.0 % in the mean, and up to 8 %
/// (docs/limits.md); with a measured lateral acceleration, 1.4 % at 0.5 m/s².
const SPEEDING_S2_PER_M: f64 = 0.1;
/// Mean acceleration in turns that is told, m/s².
const TOLD_SPEEDING_MPS2: f64 = 0.1;
/// Relative standard deviation from which on that is told: 0.25 m/s² of a truck without friction.
const TOLD_UNSTEADY: f64 = 0.0125;

/// What the turns of a load came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strength {
    /// The greatest share of the rollover threshold.
    pub greatest: f64,
    /// Mean braking in the turns, m/s². Older state files do not have it.
    #[serde(default)]
    pub braking_mps2: f64,
    /// Mean acceleration in turns whose lateral acceleration is yaw rate times speed, m/s². Older state files do not have it.
    #[serde(default)]
    pub speeding_mps2: f64,
    /// Standard deviation of the acceleration within the turns, m/s²; with friction in the springs the root mean square in and
    /// before them, if that is more. Older state files do not have it.
    #[serde(default)]
    pub unsteady_mps2: f64,
    /// Relative standard deviation that this alone adds. Older state files do not have it.
    #[serde(default)]
    pub unsteady_sd: f64,
    /// Relative standard deviation that this adds to the height.
    pub sd: f64,
}

impl Strength {
    /// Of turns with these shares of the threshold, decelerations and accelerations, m/s². Their errors have one sign, so they do
    /// not average out.
    pub(super) fn of(
        shares: &[f64],
        braking_mps2: &[f64],
        speeding_mps2: &[f64],
        unsteady: &[[f64; 2]],
    ) -> Self {
        let beyond = shares.iter().map(|share| (share - LINEAR).max(0.0));
        let strong: Vec<_> = beyond.map(|share| ERROR * share * share).collect();
        let braking =
            braking_mps2.iter().map(|mps2| BRAKING_S2_PER_M * (mps2 - FREE_MPS2).max(0.0));
        let greatest = shares.iter().copied().fold(0.0, f64::max);
        // Turns in which the truck goes slower have the opposite error.
        let speeding_mps2 = mean(speeding_mps2).max(0.0);
        let speeding = SPEEDING_S2_PER_M * speeding_mps2;
        let sd = libm::hypot(mean(&strong), mean(&braking.collect::<Vec<_>>()) + speeding);
        let of_unsteady = |k: usize| mean(&unsteady.iter().map(|one| one[k]).collect::<Vec<_>>());
        let (unsteady_mps2, unsteady_sd) = (of_unsteady(0), of_unsteady(1));
        let (braking_mps2, sd) = (mean(braking_mps2), libm::hypot(sd, unsteady_sd));
        Self { greatest, braking_mps2, speeding_mps2, unsteady_mps2, unsteady_sd, sd }
    }

    /// Whether no turn came so near that it is kept over a restart.
    pub fn is_none(&self) -> bool {
        self.sd <= 0.0
            && self.greatest <= TOLD
            && self.braking_mps2 <= TOLD_MPS2
            && self.speeding_mps2 <= TOLD_SPEEDING_MPS2
            && self.unsteady_sd <= TOLD_UNSTEADY
    }

    /// Whether these are numbers that turns can come to.
    pub(crate) fn is_sound(self) -> bool {
        let Self { greatest, braking_mps2, speeding_mps2, unsteady_mps2, unsteady_sd, sd } = self;
        [greatest, braking_mps2, speeding_mps2, unsteady_mps2, unsteady_sd, sd]
            .iter()
            .all(|number| number.is_finite() && *number >= 0.0)
    }

    /// What is said of turns that came near to rolling over, and of braking in turns.
    pub fn messages(self) -> Vec<String> {
        let strong = (self.greatest > TOLD).then(|| {
            format!(
                "the strongest turn came to {:.0} % of the rollover threshold, where springs and tires are not linear: \
                 the height can be several percent wrong, mostly too great, and the interval was made wider; estimate \
                 from gentler turns",
                100.0 * self.greatest
            )
        });
        let braking = (self.braking_mps2 > TOLD_MPS2).then(|| {
            format!(
                "the truck braked in turns, with {:.1} m/s² in the mean: the height can be several percent too great, \
                 and the interval was made wider; estimate from turns at a steady speed",
                self.braking_mps2
            )
        });
        let speeding = (self.speeding_mps2 > TOLD_SPEEDING_MPS2).then(|| {
            format!(
                "the truck went faster in turns, by {:.1} m/s² in the mean, and its lateral acceleration is yaw rate times speed: \
                 the height can be several percent too low, and the interval was made wider; estimate from turns at a steady \
                 speed, or record the lateral acceleration",
                self.speeding_mps2
            )
        });
        let is_told = braking.is_some() || speeding.is_some();
        let unsteady = (!is_told && self.unsteady_sd > TOLD_UNSTEADY).then(|| {
            format!(
                "the truck braked and accelerated in turns, or before them, by {:.1} m/s²: the height can be some percent \
                 wrong, and the interval was made wider; estimate from turns at a steady speed",
                self.unsteady_mps2
            )
        });
        strong.into_iter().chain(braking).chain(speeding).chain(unsteady).collect()
    }
}

/// The mean; zero of no numbers.
#[allow(clippy::cast_precision_loss)] // a count
pub(super) fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / (numbers.len() as f64).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two turns at 0.7 of the threshold leave 1.5·0.2² = 6 %, beside two gentle ones the half.
    #[test]
    fn strong_turns_widen_the_interval() {
        let strong = Strength::of(&[0.7, 0.7], &[0.0, 0.0], &[], &[]);
        assert!((strong.sd - 0.06).abs() < 1e-12 && strong.messages()[0].contains("70 %"));
        assert!((Strength::of(&[0.7, 0.7, 0.3, 0.5], &[], &[], &[]).sd - 0.03).abs() < 1e-12);
        let gentle = Strength { greatest: 0.5, ..Strength::default() };
        assert_eq!(Strength::of(&[0.5, 0.2], &[], &[], &[]), gentle);
        assert!(gentle.is_none() && Strength::of(&[], &[], &[], &[]).messages().is_empty());
    }

    /// A mean of 0.5 m/s² adds 10 % of the 0.4 m/s² that are not free.
    #[test]
    fn braking_in_turns_widens_the_interval() {
        let braked = Strength::of(&[0.3, 0.3], &[0.5, 0.5], &[], &[]);
        assert!((braked.sd - 0.04).abs() < 1e-12 && braked.messages()[0].contains("0.5 m/s²"));
        assert!(!braked.is_none() && Strength::of(&[0.3], &[0.1], &[], &[]).is_none());
    }
}
