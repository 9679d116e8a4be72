//! The end of a maneuver: the identifiers of all channels are solved one after the other, in stages.

use crate::decide::judge::{Judge, share_faults};
use crate::decide::lane::Lane;
use crate::decide::maneuver::{Maneuver, Outcome, Reject};
use crate::decide::settings::Settings;
use crate::decide::window::Window;
use crate::identify::identifier::{Answer, Identify, Unexcited};
use crate::math::real::Real;
use crate::truck::design::Design;

/// Stages that a sample does if the solution is spread. On a Cortex-M4F one costs up to 29 000 instructions.
const STAGES: usize = 2;

/// Solutions on their way.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, W: serde::Serialize, [Option<Answer<T>>; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, W: serde::Deserialize<'de>, [Option<Answer<T>>; C]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Closing<T, W, const C: usize> {
    /// The place of the channel that is solved; `None` if no maneuver ends.
    place: Option<usize>,
    work: W,
    /// Of the channels that had signals when it began; any answer before they are solved.
    answers: [Option<Answer<T>>; C],
}

impl<T: Real, W: Copy, const C: usize> Closing<T, W, C> {
    /// No maneuver ends.
    pub(crate) const fn none(not_begun: W) -> Self {
        Self { place: None, work: not_begun, answers: [None; C] }
    }

    /// Whether a maneuver ends.
    pub(crate) fn is_open(&self) -> bool {
        self.place.is_some()
    }

    /// Begins with the first channel.
    pub(crate) fn begin<I: Identify<T, Work = W>>(&mut self, lanes: &[Lane<T, I>; C]) {
        self.place = Some(0);
        for (answer, lane) in self.answers.iter_mut().zip(lanes) {
            *answer = lane.last_us.map(|_| Answer::Unexcited(Unexcited::Input));
        }
    }

    /// Does the next [`STAGES`]. Returns whether all channels have their answers, which is a stage of its own.
    #[inline(never)]
    pub(crate) fn advance<I: Identify<T, Work = W>>(
        &mut self,
        lanes: &mut [Lane<T, I>; C],
    ) -> bool {
        (0..STAGES).any(|_| self.stage(lanes))
    }

    fn stage<I: Identify<T, Work = W>>(&mut self, lanes: &mut [Lane<T, I>; C]) -> bool {
        let Some(place) = &mut self.place else { return false };
        while let (Some(lane), Some(answer)) = (lanes.get_mut(*place), self.answers.get_mut(*place))
        {
            if let Some(answer) = answer {
                if let Some(found) = lane.identifier.fit_stage(&mut self.work) {
                    (*answer, self.work) = (found, I::NOT_BEGUN);
                    *place += 1;
                }
                return false;
            }
            *place += 1;
        }
        self.place = None;
        true
    }

    /// The maneuver of the window, from the answers of all channels.
    pub(crate) fn judge<I: Identify<T, Work = W>>(
        &self,
        design: &Design<T, C>,
        settings: &Settings<T>,
        window: &Window<T, C>,
        lanes: &mut [Lane<T, I>; C],
    ) -> Maneuver<T, C> {
        let bank_free = self.answers.iter().enumerate().any(|(place, answer)| {
            answer.is_some() && design.channel(place).is_some_and(|c| !c.feels_bank())
        });
        let judge = Judge::new(design, settings, window, bank_free);
        let mut outcomes = [Outcome::rejected(None, Reject::Absent); C];
        let mut noise_rad2_s = [T::zero(); C]; // of all inputs that a roll angle is compared with
        for (place, lane) in lanes.iter().enumerate() {
            if let Some(noise) = noise_rad2_s.get_mut(design.first_with_output(place)) {
                *noise = noise.max(lane.identifier.input_noise_rad2_s());
            }
        }
        let lanes = lanes.iter_mut().zip(&self.answers).zip(&mut outcomes);
        for (place, ((lane, answer), outcome)) in lanes.enumerate() {
            let noise = noise_rad2_s.get(design.first_with_output(place));
            let (judged, far) = judge.outcome(place, *answer, noise.copied().unwrap_or(T::zero()));
            *outcome = judged;
            lane.impossible = far.unwrap_or(lane.impossible);
        }
        share_faults(design, &mut outcomes);
        Maneuver {
            start_us: window.start_us,
            end_us: window.last_us,
            speed_mps: window.speed_mps,
            trailer_mass_kg: window.trailer_mass_kg,
            to_gravity: window.to_gravity,
            outcomes,
            correlation: judge.correlation(),
        }
    }
}
