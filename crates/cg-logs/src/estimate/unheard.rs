//! Turns that give no height, one after the other.
//!
//! A sensor that dies in the course of a drive gives turns whose ratio means nothing. They are rightly not used, but the height
//! of the turns before them then stays for ever.

use cg_core::{Channel, Design, HeightError, Maneuver, Reject};
use serde::{Deserialize, Serialize};

use super::reason::reason;

/// Number of such turns in a row that are no chance.
const MANY: u32 = 3;
/// Relative standard deviation of a ratio above which it means nothing. Weak turns and noise leave less.
const MEANINGLESS: f64 = 1.0;

/// The turns since the last height.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Unheard {
    turns: u32,
    last: Option<Reject<f64>>,
    is_told: bool,
    /// Whether any turn has given a height.
    #[serde(default)]
    had_height: bool,
}

impl Unheard {
    /// Those since a restart, after turns that gave a height or not.
    pub fn kept(had_height: bool) -> Self {
        Self { had_height, ..Self::default() }
    }

    /// Takes a maneuver.
    pub fn push(&mut self, maneuver: &Maneuver<f64>) {
        if maneuver.outcomes.iter().any(|one| one.height_m.is_ok()) {
            *self = Self::kept(true);
            return;
        }
        // A bank that changes along the truck makes a suspension roll inconsistent, too.
        let is_first = !self.had_height;
        let is_of_sensor = |(channel, reject): &(Channel, Reject<f64>)| match reject {
            // After a height, a height that is impossible is one of another mass, of which another message tells.
            Reject::Height(_) if is_first => true,
            Reject::Imprecise { ratio_sd_relative } => !(*ratio_sd_relative <= MEANINGLESS),
            Reject::Inconsistent(_) => channel.feels_bank(),
            reject => is_reversed(reject),
        };
        let outcomes = Channel::ALL.into_iter().zip(&maneuver.outcomes);
        let mut rejects =
            outcomes.filter_map(|(one, outcome)| Some((one, outcome.height_m.err()?)));
        if let Some((_, reject)) = rejects.find(is_of_sensor) {
            (self.turns, self.last) = (self.turns + 1, Some(reject));
        }
    }

    /// What is said of many of them.
    pub fn message(&self, design: &Design<f64>) -> Option<String> {
        let last = self.last.filter(|_| self.turns >= MANY)?;
        let advice = if is_reversed(&last) {
            "a sensor is reversed (⟨flip roll⟩, or that of the input)"
        } else if matches!(last, Reject::Height(_)) {
            "check the mass, the sensors and the vehicle file"
        } else {
            "check the sensors"
        };
        let so = if self.had_height {
            ", so a height that is shown is of the turns before them and a change of the load is not noticed"
        } else {
            ", and none before them did"
        };
        let (turns, reason) = (self.turns, reason(design, &last));
        Some(format!("the last {turns} turns gave no height{so}: {reason}; {advice}"))
    }

    /// The same, once for each time.
    pub fn news(&mut self, design: &Design<f64>) -> Option<String> {
        let found = self.message(design).filter(|_| !self.is_told)?;
        self.is_told = true;
        Some(found)
    }
}

/// Whether the roll angle had the opposite sign of what every load has.
fn is_reversed(reject: &Reject<f64>) -> bool {
    match reject {
        Reject::Height(HeightError::OutOfRange { height_m }) => *height_m < 0.0,
        Reject::Height(HeightError::NoSolution { ratio }) => *ratio < 0.0,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{design, maneuver};
    use cg_core::{Inconsistency, Measured};

    fn after(rejects: &[Option<Reject<f64>>]) -> Unheard {
        let mut unheard = Unheard::default();
        for reject in rejects {
            let mut one = maneuver();
            let outcome = &mut one.outcomes[Channel::Steer.index()];
            outcome.height_m = reject.map_or(Ok(Measured { value: 2.0, sd: 0.1 }), Err);
            unheard.push(&one);
        }
        unheard
    }

    #[test]
    fn three_turns_without_a_meaning_are_told_once() {
        let nothing = Some(Reject::Imprecise { ratio_sd_relative: 40.0 });
        let weak = Some(Reject::Imprecise { ratio_sd_relative: 0.9 });
        let too_fast = Some(Reject::OutsideDesign { speed_mps: 40.0, trailer_mass_kg: 20e3 });
        let design = design();
        for quiet in [
            &[None, nothing, nothing][..],
            &[nothing, nothing, None, nothing],
            &[nothing, nothing, weak],
            &[too_fast; 5],
        ] {
            assert_eq!(after(quiet).message(&design), None, "{quiet:?}");
        }
        let negative = Some(Reject::Height(HeightError::OutOfRange { height_m: -2.0 }));
        let told = after(&[negative; 3]).message(&design).unwrap();
        assert!(
            told.ends_with("a sensor is reversed (⟨flip roll⟩, or that of the input)"),
            "{told}"
        );
        let high = Some(Reject::Height(HeightError::OutOfRange { height_m: 6.0 }));
        assert_eq!(after(&[None, high, high, high]).message(&design), None);
        let told = after(&[high; 3]).message(&design).unwrap();
        assert!(
            told.starts_with("the last 3 turns gave no height, and none before them did"),
            "{told}"
        );
        assert!(told.ends_with("check the mass, the sensors and the vehicle file"), "{told}");
        // Of a suspension it may be the bank.
        let stood = Reject::Inconsistent(Inconsistency::Standstill { roll_rad: 0.0 });
        for (channel, is_told) in [(Channel::Steer, true), (Channel::Suspension, false)] {
            let mut unheard = Unheard::default();
            let mut one = maneuver();
            one.outcomes[channel.index()].height_m = Err(stood);
            (0..3).for_each(|_| unheard.push(&one));
            assert_eq!(unheard.message(&design).is_some(), is_told);
        }
        let mut unheard = after(&[None, nothing, weak, nothing, nothing]);
        let message = unheard.news(&design).unwrap();
        assert!(
            message.starts_with("the last 3 turns gave no height") && message.contains("1000 %")
        );
        assert_eq!(unheard.news(&design), None);
    }
}
