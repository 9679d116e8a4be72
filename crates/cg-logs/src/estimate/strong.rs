//! How near to rolling over the turns of a log came, and what that does to its height.

use cg_core::{Channel, Design, Maneuver, Measured, Sample};
use serde::{Deserialize, Serialize};

use super::felt::force_by_roll;

/// Time constant with which the lateral acceleration is smoothed, s.
const SMOOTH_S: f64 = 0.5;
/// Time between samples after which the smoothing begins anew, s.
const GAP_S: f64 = 1.0;
/// Share of the rollover threshold up to which springs and tires are linear.
const LINEAR: f64 = 0.5;
/// Standard deviation of a height over the square of what a turn exceeds that share by. On the nonlinear plant, steps of
/// the files with measured springs leave 1 to 2 % rms at 0.6 of the threshold and 9 % at 0.8 (docs/limits.md).
const ERROR: f64 = 1.5;
/// Greatest lateral acceleration of turns, g. What seems to be more is another unit.
const STRONGEST_G: f64 = 0.5;
/// Share of the threshold from which on it is told.
const TOLD: f64 = 0.6;

/// The greatest lateral acceleration of each maneuver.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct StrongTurns {
    time_us: u64,
    /// Smoothed: that of the path, and the specific force of the trailer or else of the tractor.
    smooth_mps2: [f64; 2],
    /// The greatest sizes since the last maneuver.
    greatest_mps2: [f64; 2],
    of_maneuvers_mps2: Vec<[f64; 2]>,
    /// Sums over time of the square and the cube of that of the path, which is smoothed.
    path_squares: f64,
    path_cubes: f64,
}

impl StrongTurns {
    pub(super) fn push(&mut self, sample: &Sample<f64>) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let passed_s = sample.time_us.saturating_sub(self.time_us) as f64 * 1e-6;
        self.time_us = sample.time_us;
        let or = |first: f64, second: f64| if first.is_nan() { second } else { first };
        let turn_mps2 = sample.yaw_rate_radps * sample.speed_mps;
        let path_mps2 = or(sample.lateral_acceleration_mps2, turn_mps2);
        let force_mps2 =
            or(sample.lateral_specific_force_mps2, sample.tractor_lateral_specific_force_mps2);
        for (place, now_mps2) in [path_mps2, force_mps2].into_iter().enumerate() {
            if now_mps2.is_finite() {
                let smooth_mps2 = &mut self.smooth_mps2[place];
                let share = if passed_s > GAP_S { 1.0 } else { passed_s / (SMOOTH_S + passed_s) };
                *smooth_mps2 += share * (now_mps2 - *smooth_mps2);
                let greatest_mps2 = &mut self.greatest_mps2[place];
                *greatest_mps2 = greatest_mps2.max(smooth_mps2.abs());
            }
        }
        if path_mps2.is_finite() && passed_s <= GAP_S {
            let path_mps2 = self.smooth_mps2[0].abs();
            self.path_squares += passed_s * path_mps2 * path_mps2;
            self.path_cubes += passed_s * path_mps2 * path_mps2 * path_mps2;
        }
    }

    /// The lateral acceleration of one turn in place of all, g: that at which a secant is the one that least squares
    /// find, if it decreases in proportion to the lateral acceleration.
    pub(super) fn usual_g(&self, gravity_mps2: f64) -> Option<f64> {
        let usual_g = self.path_cubes / self.path_squares / gravity_mps2;
        (self.path_squares > 0.0).then(|| usual_g.min(STRONGEST_G))
    }

    /// Ends a maneuver; `true` if it is listed.
    pub(super) fn close(&mut self, is_listed: bool) {
        if is_listed {
            self.of_maneuvers_mps2.push(self.greatest_mps2);
        }
        self.greatest_mps2 = [0.0; 2];
    }

    /// How strong those of the listed maneuvers were that gave the height, m, in a channel, with the mass and the speed of
    /// the best one.
    pub(super) fn strength(
        &self,
        design: &Design<f64>,
        maneuvers: &[Maneuver<f64>],
        best: &Maneuver<f64>,
        (channel, height_m): (Channel, f64),
    ) -> Strength {
        let height = Measured { value: height_m, sd: 0.0 };
        let [speed_mps, mass_kg] = [best.speed_mps, best.trailer_mass_kg];
        let Some(rollover) = design.rollover(height, mass_kg, speed_mps) else {
            return Strength::default();
        };
        let threshold_mps2 = design.gravity_mps2 * rollover.static_rollover_threshold_g.value;
        let by_roll = force_by_roll(design, speed_mps, [mass_kg, height_m]);
        let of_used = maneuvers.iter().zip(&self.of_maneuvers_mps2);
        let of_used = of_used.filter(|(one, _)| one.outcomes[channel.index()].height_m.is_ok());
        let felt_mps2 =
            |[path_mps2, force_mps2]: &[f64; 2]| path_mps2.max(force_mps2 / (1.0 + by_roll));
        let shares: Vec<_> = of_used.map(|(_, peaks)| felt_mps2(peaks) / threshold_mps2).collect();
        Strength::of(&shares)
    }
}

/// What the turns of a log came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Strength {
    /// The greatest share of the rollover threshold.
    pub(super) greatest: f64,
    /// Relative standard deviation that this adds to the height.
    pub(super) sd: f64,
}

impl Strength {
    /// Of turns with these shares of the threshold. Their errors have one sign, so they do not average out.
    #[allow(clippy::cast_precision_loss)] // a count
    fn of(shares: &[f64]) -> Self {
        let beyond = shares.iter().map(|share| (share - LINEAR).max(0.0));
        let sum: f64 = beyond.map(|share| ERROR * share * share).sum();
        let greatest = shares.iter().copied().fold(0.0, f64::max);
        Self { greatest, sd: sum / (shares.len() as f64).max(1.0) }
    }

    pub(super) fn message(self) -> Option<String> {
        (self.greatest > TOLD).then(|| {
            format!(
                "the strongest turn came to {:.0} % of the rollover threshold, where springs and tires are not linear: \
                 the height can be several percent wrong, mostly too great, and the interval was made wider; estimate \
                 from gentler turns",
                100.0 * self.greatest
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reached(rate_hz: u32, seconds: u32, lateral_mps2: impl Fn(f64) -> f64) -> StrongTurns {
        let mut turns = StrongTurns::default();
        for k in 0..rate_hz * seconds {
            let time_s = f64::from(k) / f64::from(rate_hz);
            let mut sample = Sample::absent(u64::from(k) * 1_000_000 / u64::from(rate_hz));
            sample.lateral_acceleration_mps2 = lateral_mps2(time_s);
            turns.push(&sample);
        }
        turns
    }

    /// A step is as strong as it is, with straight driving before it or not; a sine is as strong as its describing
    /// function says, 8/(3π). The smoothing takes 2 % of this sine and a little of the step's beginning.
    #[test]
    fn one_turn_stands_for_all() {
        assert_eq!(reached(50, 6, |_| f64::NAN).usual_g(9.81), None);
        assert_eq!(reached(50, 6, |_| 0.0).usual_g(9.81), None);
        let step = reached(50, 40, |time_s| if time_s < 20.0 { 0.0 } else { -0.15 * 9.81 });
        let sine = reached(50, 60, |time_s| 0.2 * 9.81 * (0.4 * time_s).sin());
        let [step_g, sine_g] = [step, sine].map(|turns| turns.usual_g(9.81).unwrap());
        assert!((step_g / 0.15 - 1.0).abs() < 0.02, "{step_g}");
        let expected_g = 0.2 * 8.0 / (3.0 * std::f64::consts::PI);
        assert!((sine_g / expected_g - 1.0).abs() < 0.04, "{sine_g} {expected_g}");
        assert_eq!(reached(50, 6, |_| 17.0).usual_g(9.81), Some(STRONGEST_G));
    }

    /// A step of some seconds counts whole, one sample hardly, and each maneuver begins anew.
    #[test]
    fn a_turn_counts_and_a_spike_does_not() {
        let mut turns = reached(50, 6, |time_s| if time_s < 1.0 { 0.0 } else { -2.0 });
        turns.close(true);
        let [path_mps2, force_mps2] = turns.of_maneuvers_mps2[0];
        assert!((path_mps2 - 2.0).abs() < 1e-3 && force_mps2 == 0.0, "{path_mps2}");
        turns.close(false);
        assert_eq!((turns.of_maneuvers_mps2.len(), turns.greatest_mps2), (1, [0.0; 2]));
        let spike = reached(50, 4, |time_s| if (time_s - 2.0).abs() < 0.01 { 5.0 } else { 1.0 });
        assert!((1.0..1.2).contains(&spike.greatest_mps2[0]), "{:?}", spike.greatest_mps2);
    }

    /// Two turns at 0.7 of the threshold leave 1.5·0.2² = 6 %, beside two gentle ones the half.
    #[test]
    fn strong_turns_widen_the_interval() {
        let strong = Strength::of(&[0.7, 0.7]);
        assert!((strong.sd - 0.06).abs() < 1e-12 && strong.message().unwrap().contains("70 %"));
        assert!((Strength::of(&[0.7, 0.7, 0.3, 0.5]).sd - 0.03).abs() < 1e-12);
        assert_eq!(Strength::of(&[0.5, 0.2]), Strength { greatest: 0.5, sd: 0.0 });
        assert_eq!(Strength::of(&[]).message(), None);
    }
}
