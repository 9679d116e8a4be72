//! What the sensors of a drive cannot be, from their signals alone.

use cg_core::{Channel, Design, Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::agreement::AgreementCheck;
use super::forces::ForceCheck;
use super::frozen::FrozenCheck;
use super::levels::LevelCheck;
use super::options::RoadChoice;
use super::pressures::PressureCheck;
use super::signals::SignalCheck;
use super::values::ValueCheck;
use crate::seldom::SeldomCheck;
use cg_vehicle::filled::FilledCheck;

/// Time of driving after which the mean over a drive that goes on is judged, s.
const KNOWN_S: f64 = 120.0;

/// Checks the signals of a drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct SensorCheck {
    pub(super) signals: SignalCheck,
    agreement: AgreementCheck,
    was_wrong: bool,
    forces: ForceCheck,
    levels: LevelCheck,
    #[serde(default)]
    pressures: PressureCheck,
    values: ValueCheck,
    #[serde(default)]
    frozen: FrozenCheck,
    #[serde(default)]
    seldom: SeldomCheck,
    #[serde(default)]
    filled: FilledCheck,
    coarse_is_told: bool,
    #[serde(default)]
    gravity_mps2: f64,
}

impl SensorCheck {
    /// Takes the next sample; whether a stretch of driving was judged, so that [`disagreement`](Self::disagreement) may be
    /// another one.
    pub fn push(&mut self, sample: &Sample<f64>, design: &Design<f64>) -> bool {
        self.value(sample);
        self.push_mean(sample, design)
    }

    /// Takes what only single samples show.
    pub(super) fn value(&mut self, sample: &Sample<f64>) {
        self.values.push(sample);
        self.seldom.push(sample);
        self.filled.push(sample);
    }

    /// Takes the rest from the mean of some samples, as [`push`](Self::push).
    pub(super) fn push_mean(&mut self, mean: &Sample<f64>, design: &Design<f64>) -> bool {
        self.gravity_mps2 = design.gravity_mps2;
        self.forces.push(mean, design);
        self.signals.push(mean);
        let is_news = self.frozen.push(mean);
        self.agreement.push(mean) || is_news
    }

    /// Forgets the mean over the drive when signals agree again, for a drive that goes on.
    pub fn forget_faults(&mut self) {
        let is_wrong = self.agreement.contradiction().is_some();
        if std::mem::replace(&mut self.was_wrong, is_wrong) && !is_wrong {
            self.signals = SignalCheck::default();
        }
    }

    /// Whether the truck has driven for long enough to judge the mean over a drive that goes on.
    pub fn is_known(&self) -> bool {
        self.signals.seconds() >= KNOWN_S
    }

    /// The signals of turns that contradict each other, at present or in the whole log.
    pub fn disagreement(&self, gravity_mps2: f64, at_present: bool) -> Option<String> {
        let is_known = !at_present || self.is_known();
        let of_all = self.signals.contradiction(gravity_mps2).filter(|_| is_known);
        // That of the whole log knows the likely causes.
        let of_now = self.agreement.contradiction();
        if at_present {
            of_now.or(of_all).or_else(|| self.frozen.message())
        } else {
            of_all.or(of_now)
        }
    }

    /// Takes the levels and pressures at one time, SI units; NaN without a value.
    #[inline]
    pub fn level(&mut self, value: impl Fn(Quantity) -> f64) {
        self.pressures.push(&value);
        self.levels.push(value);
    }

    /// Ends a maneuver; `true` if it is the first of another load, with which the suspension rolls otherwise.
    pub fn close(&mut self, is_of_another_load: bool) {
        if is_of_another_load {
            self.forces = ForceCheck::default();
        }
        self.levels.close();
    }

    /// What is wrong with a level, at present or in the whole log, or with a specific force of a channel that is used, on these
    /// roads.
    pub fn wrong_chassis(
        &self,
        (gravity_mps2, at_present): (f64, bool),
        road: Option<RoadChoice>,
        is_used: impl Fn(Channel) -> bool,
    ) -> Option<String> {
        let of_levels = self
            .levels
            .contradiction(at_present)
            .filter(|_| Channel::ALL.into_iter().any(&is_used));
        let is_flat = road == Some(RoadChoice::FLAT);
        of_levels.or_else(|| self.forces.contradiction(gravity_mps2, is_flat, is_used))
    }

    /// The signal with zeros for missing samples, or that is cut off at the end of a range.
    pub fn lost_values(&self) -> Option<String> {
        self.values.missing().or_else(|| self.values.cut_off())
    }

    /// The signal that is sampled too seldom, that is filled in, that has a dead band, or whose steps are as large as its
    /// motion, pressures that do not belong together, or a lateral acceleration that may also measure gravity.
    pub fn coarse(&self) -> Option<String> {
        let of_values = || self.values.dead().or_else(|| self.values.coarse());
        let of_gravity = || self.signals.may_feel_gravity(self.gravity_mps2);
        let of_single = self.seldom.message().or_else(|| self.filled.message());
        let of_pressures = || self.pressures.message();
        of_single.or_else(of_pressures).or_else(of_values).or_else(of_gravity)
    }

    /// The same, once.
    pub fn news(&mut self) -> Option<String> {
        if self.coarse_is_told {
            return None;
        }
        let found = self.coarse()?;
        self.coarse_is_told = true;
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::design;

    /// A light trailer whose accelerometer also measures gravity, which is told once in a drive that goes on.
    #[test]
    fn gravity_in_the_lateral_acceleration_is_told_beside_a_yaw_rate() {
        let (design, mut news) = (design(), 0);
        let mut check = SensorCheck::default();
        for k in 0..2000_u32 {
            let mut sample = Sample::absent(u64::from(k) * 20_000);
            let turn_mps2 = (f64::from(k) * 0.01).sin();
            (sample.speed_mps, sample.yaw_rate_radps) = (15.0, turn_mps2 / 15.0);
            sample.roll_rad = 0.012 * turn_mps2;
            sample.lateral_acceleration_mps2 =
                turn_mps2 + design.gravity_mps2 * sample.roll_rad + 1e-3 * f64::from(k % 3);
            check.push(&sample, &design);
            news += usize::from(check.news().is_some());
        }
        let message = check.coarse().unwrap();
        assert!(
            message.starts_with("the lateral acceleration is 1.12 times the product"),
            "{message}"
        );
        assert_eq!((news, check.disagreement(design.gravity_mps2, false)), (1, None));
    }
}
