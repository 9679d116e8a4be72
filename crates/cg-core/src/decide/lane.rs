//! The state of one channel: its identifier, the initial steady state, and the fused heights.

use crate::decide::condition::Row;
use crate::decide::consistency::Shown;
use crate::decide::height::Fusion;
use crate::decide::settings::Settings;
use crate::decide::signals::seconds;
use crate::identify::identifier::Identify;
use crate::identify::mean::Mean;
use crate::math::real::Real;
use crate::truck::channel::ROLL_LAG_S;
use crate::truck::design::Design;
use crate::truck::friction::{Friction, FrictionState};
use crate::truck::lags::{LateNoise, RollLags};

/// Time constant of the lag after which measured and expected roll angle of a suspension are compared
/// to find a sensor that stands still: more than the time by which the roll angle comes before the force.
const VIEW_LAG_S: f64 = 0.8;

/// A turn that is noticed within this time after the rest has begun in it: steering needs half a second
/// to more than a second until a truck counts as turning.
const SOON_US: u64 = 1_200_000;

/// Until when a channel rests that started in a turn.
const IN_A_TURN_US: u64 = 0;

/// The state of one channel: its identifier, the time of its last row, and its fused heights.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Lane<T: Real, I> {
    pub(crate) identifier: I,
    /// Time of the last sample of the last row, and the mean of the times of its samples.
    pub(crate) last_us: Option<u64>,
    middle_us: u64,
    settled_us: u64,
    measured_rad: T,
    lags: RollLags<T>,
    noise: LateNoise<T>,
    /// Of the springs of this channel, at the present mass.
    pub(crate) friction: Friction<T>,
    state: FrictionState<T>,
    /// Expected and measured roll angle after [`VIEW_LAG_S`], and the last change of the latter.
    view_rad: [T; 2],
    view_step_rad: T,
    rest: Rest<T>,
    pub(crate) fusion: Fusion<T>,
    /// Whether the last height of this channel is impossible for this trailer, and no other
    /// channel shows that this channel's input is wrong.
    pub(crate) impossible: bool,
}

/// The initial steady state of an identifier and of the lags: the means of expected and measured roll
/// angle of some straight driving. With a single sample, its noise would look like the end of a turn.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Rest<T> {
    until_us: u64,
    samples: T,
    mean_rad: [T; 2],
}

impl<T: Real> Rest<T> {
    const fn new(until_us: u64) -> Self {
        Self { until_us, samples: T::ZERO, mean_rad: [T::ZERO; 2] }
    }

    /// The mean with those of some more samples.
    fn with(&mut self, angles_rad: [T; 2], samples: T) -> [T; 2] {
        self.samples += samples;
        let share = samples / self.samples;
        for (mean, angle) in self.mean_rad.iter_mut().zip(angles_rad) {
            *mean += (angle - *mean) * share;
        }
        self.mean_rad
    }
}

impl<T: Real, I: Identify<T>> Lane<T, I> {
    /// The state before the first row.
    pub(crate) const EMPTY: Self = Self {
        identifier: I::EMPTY,
        last_us: None,
        middle_us: 0,
        settled_us: 0,
        measured_rad: T::ZERO,
        lags: RollLags::at_rest(T::ZERO),
        noise: LateNoise::NONE,
        friction: Friction::NONE,
        state: FrictionState::at_rest(T::ZERO),
        view_rad: [T::ZERO; 2],
        view_step_rad: T::ZERO,
        rest: Rest::new(0),
        fusion: Fusion::new(),
        impossible: false,
    };

    /// Gives a row to the identifier of the channel at this `place` of the design. With `lags`, the
    /// measured roll angle passes the two lags that the reduced model of the channel contains. While the rows so far
    /// are being solved, none is added and none deleted.
    pub(crate) fn identify<const C: usize>(
        &mut self,
        row: &Row<T, C>,
        (place, lags): (usize, bool),
        settings: &Settings<T>,
        is_solved: bool,
    ) {
        let (Some(&expected_rad), Some(&measured_rad), Some(&usable)) =
            (row.expected_rad.get(place), row.measured_rad.get(place), row.usable.get(place))
        else {
            return;
        };
        if !expected_rad.present() || !measured_rad.present() {
            return;
        }
        let begins = self.begins(row, [expected_rad, measured_rad], settings);
        let rests = row.time_us < self.rest.until_us && !row.turning;
        // Whoever solves the rows deletes them afterwards.
        if (begins || rests) && !is_solved {
            self.identifier.clear();
        }
        let last_us = self.last_us.replace(row.time_us);
        let middle_us = core::mem::replace(&mut self.middle_us, row.of.middle_us);
        let since = |time_us: u64, past_us: u64| match last_us {
            Some(_) => seconds::<T>(time_us.saturating_sub(past_us)),
            None => T::zero(),
        };
        let interval_s = since(row.of.middle_us, middle_us);
        let change_rad = measured_rad - core::mem::replace(&mut self.measured_rad, measured_rad);
        let late_rad = self.lags.push(measured_rad, interval_s);
        let held_rad = self.friction.acts().then(|| {
            let noise_rad = self.noise.push(change_rad, interval_s);
            self.state.push(&self.friction, late_rad, noise_rad)
        });
        let free = |roll_rad| match held_rad {
            Some(held_rad) => self.state.free_rad(&self.friction, roll_rad, held_rad),
            None => roll_rad,
        };
        let roll_rad = free(if lags { late_rad } else { measured_rad });
        let share = interval_s * T::of(1.0 / VIEW_LAG_S); // a gap ends at 0.5 s
        for (view, signal) in self.view_rad.iter_mut().zip([expected_rad, measured_rad]) {
            self.view_step_rad = (signal - *view) * share; // that of the measured one is the last
            *view += self.view_step_rad;
        }
        if rests {
            let [rest_rad, mean_rad] = self.rest.with([expected_rad, measured_rad], row.of.weight);
            self.lags = RollLags::at_rest(mean_rad);
            self.identifier.restart();
            let roll_rad = if lags { free(mean_rad) } else { roll_rad };
            self.identifier.push(rest_rad, roll_rad, T::zero(), false);
            return;
        }
        self.identifier.push_mean(&Mean {
            input: expected_rad,
            roll_rad,
            interval_s,
            elapsed_s: since(row.time_us, last_us.unwrap_or(0)),
            samples: row.of.number,
            weight: row.of.weight,
            is_used: usable && row.time_us >= self.settled_us && !is_solved,
            // After the lags it says nothing, and the others do not have them.
            scatter: if lags { [T::zero(); 3] } else { row.of.scatter },
        });
    }

    /// Whether the rows before this one do not belong to it: it starts anew, or it shows that what looked like rest was the
    /// begin of a turn.
    fn begins<const C: usize>(
        &mut self,
        row: &Row<T, C>,
        view_rad: [T; 2],
        settings: &Settings<T>,
    ) -> bool {
        let gap_us = self.last_us.map(|last_us| row.of.first_us.saturating_sub(last_us));
        // What started in a turn does not know the roll angle at rest, about which springs bend.
        let rests_at_last = self.rest.until_us == IN_A_TURN_US && !row.turning;
        let starts = gap_us.is_none_or(|gap_us| gap_us > settings.gap_us) || rests_at_last;
        if starts {
            self.start(row, view_rad, settings);
        }
        let soon_us = self.rest.until_us.saturating_add(SOON_US);
        let turns = row.turning && self.settled_us <= self.rest.until_us && row.time_us < soon_us;
        if turns {
            self.settled_us = row.time_us.saturating_add(settings.settle_us);
        }
        starts || turns
    }

    /// Starts anew at a row.
    fn start<const C: usize>(&mut self, row: &Row<T, C>, view_rad: [T; 2], settings: &Settings<T>) {
        self.identifier.restart();
        // In a turn the filters start from a wrong steady state.
        let wait = if row.turning { settings.settle_us } else { 0 };
        self.settled_us = row.time_us.saturating_add(wait);
        let rest_us = row.time_us.saturating_add(settings.rest_us);
        self.rest = Rest::new(if row.turning { IN_A_TURN_US } else { rest_us });
        let [_, measured_rad] = view_rad;
        self.lags = RollLags::at_rest(measured_rad);
        self.measured_rad = measured_rad;
        self.noise = LateNoise::NONE;
        self.state = FrictionState::at_rest(measured_rad);
        self.view_rad = view_rad;
    }

    /// What shows a roll angle that stands still: the measured one, and two views of the motion that
    /// is expected, by the input and by the reduced model. The roll angle of a suspension (which does
    /// not feel the bank) comes before its specific force; the same lag for both makes up for it.
    pub(crate) fn shows<const C: usize>(
        &self,
        row: &Row<T, C>,
        input_rad: T,
        [feels_bank, lags]: [bool; 2],
    ) -> Shown<T> {
        let time_us = row.time_us;
        if feels_bank {
            let model_rad = self.identifier.expected_roll_rad();
            let (roll_rad, step_rad) = (self.measured_rad, row.of.step_rad);
            let late_s = if lags { T::of(2.0 * ROLL_LAG_S) } else { T::zero() };
            return Shown { time_us, roll_rad, step_rad, input_rad, model_rad, late_s };
        }
        let [model_rad, roll_rad] = self.view_rad;
        let step_rad = self.view_step_rad.abs();
        let step_rad = (step_rad > T::zero()).then_some(step_rad);
        Shown { time_us, roll_rad, step_rad, input_rad, model_rad, late_s: T::zero() }
    }

    /// Deletes the heights after a change of the load.
    pub(crate) fn unload(&mut self) {
        self.fusion = Fusion::new();
        self.impossible = false;
    }
}

/// What the row shows of each roll angle, at the place of its first channel. Among several channels with this roll angle,
/// the input is that of the last, because the lateral acceleration does not depend on the tires, and
/// the others are those of the first, because the model of the steer angle includes faster motion.
pub(crate) fn shown<T: Real, I: Identify<T>, const C: usize>(
    design: &Design<T, C>,
    lanes: &[Lane<T, I>; C],
    row: &Row<T, C>,
) -> [Option<Shown<T>>; C] {
    let mut all = [None; C];
    for (place, lane) in lanes.iter().enumerate() {
        if let Some(first) = all.get_mut(design.first_with_output(place))
            && lane.last_us == Some(row.time_us)
        {
            let input_rad = row.expected_rad.get(place).copied().unwrap_or(T::absent());
            let of = [design.feels_bank(place), design.lags_roll(place)];
            match first {
                Some(Shown { input_rad: last, .. }) => *last = input_rad,
                None => *first = Some(lane.shows(row, input_rad, of)),
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decide::neighbors::Samples;
    use crate::identify::identifier::{Answer, Unexcited};
    use crate::truck::ratio::Measured;
    use crate::truck::reduced::Reduced5;

    /// Records the last input of `push`, and the number of restarts.
    #[derive(Clone, Copy)]
    struct Recorder {
        last: (f64, f64, bool),
        restarts: u32,
    }

    impl Identify<f64> for Recorder {
        type Options = ();
        type Work = ();
        const NOT_BEGUN: () = ();
        const MOST_TOGETHER: u32 = 1;
        const EMPTY: Self = Self { last: (0.0, 0.0, false), restarts: 0 };
        fn make_for(&mut self, _: &Reduced5<f64>, _: bool, (): ()) {}
        fn push_mean(&mut self, mean: &Mean<f64>) {
            self.last = (mean.input, mean.interval_s, mean.is_used);
        }
        fn clear(&mut self) {}
        fn restart(&mut self) {
            self.restarts += 1;
        }
        fn expected_roll_rad(&self) -> f64 {
            self.last.0
        }
        fn forget(&mut self, _: f64) {}
        fn fit_stage(&mut self, (): &mut ()) -> Option<Answer<f64>> {
            Some(Answer::Unexcited(Unexcited::Input))
        }
    }

    /// Gives a usable row to a lane and returns what its identifier received.
    fn push(
        lane: &mut Lane<f64, Recorder>,
        time_us: u64,
        turning: bool,
        expected: f64,
    ) -> (f64, f64, bool) {
        let row = Row {
            time_us,
            measured_rad: [0.1; 2],
            expected_rad: [expected; 2],
            to_gravity: false,
            by_yaw_rate: false,
            speed_mps: 10.0,
            acceleration_mps2: 0.0,
            trailer_mass_kg: 2e4,
            lateral_acceleration_mps2: 0.0,
            turning,
            usable: [true; 2],
            of: Samples::single(time_us),
        };
        lane.identify(&row, (1, false), &Settings::truck(), false);
        lane.identifier.last
    }

    #[test]
    fn the_mean_of_a_third_of_a_second_is_the_state_of_rest() {
        let mut lane = Lane::EMPTY;
        assert_eq!(push(&mut lane, 1_000_000, false, 1.0), (1.0, 0.0, false));
        assert_eq!(push(&mut lane, 1_100_000, false, 2.0), (1.5, 0.0, false));
        assert_eq!(push(&mut lane, 1_299_999, false, 6.0), (3.0, 0.0, false));
        let restarts = lane.identifier.restarts;
        assert_eq!(push(&mut lane, 1_300_000, false, 7.0), (7.0, 1e-6, true));
        assert_eq!(lane.identifier.restarts, restarts);
        // A turn ends the averaging of the steady state.
        let mut lane = Lane::EMPTY;
        push(&mut lane, 0, false, 1.0);
        assert_eq!(push(&mut lane, 250_000, true, 5.0), (5.0, 0.25, false));
    }

    /// Steering begins before a truck counts as turning, so that what looks like rest may be part of a turn.
    #[test]
    fn a_turn_within_the_first_second_and_a_half_has_begun_before_the_first_row() {
        for (turns_us, first_us) in [(1_400_000, 4_400_000), (1_500_000, 1_500_000)] {
            let mut lane = Lane::EMPTY;
            let counts = (0..50_u64)
                .map(|k| k * 100_000)
                .find(|&us| push(&mut lane, us, us >= turns_us, 1.0).2 && us >= turns_us);

            assert_eq!(counts, Some(first_us));
        }
    }

    #[test]
    fn begun_in_a_turn_rows_count_after_three_seconds() {
        let mut lane = Lane::EMPTY;
        let mut counts = false;
        for k in 0..=30 {
            let (input, _, use_row) = push(&mut lane, k * 100_000, true, 2.0);
            assert!((input - 2.0).abs() < 1e-15 && !counts);
            counts = use_row;
        }
        assert!(counts);
        assert_eq!(lane.identifier.restarts, 1);
    }

    #[test]
    fn a_hole_of_more_than_half_a_second_begins_anew() {
        let mut lane = Lane::EMPTY;
        push(&mut lane, 0, true, 1.0);
        assert_eq!(push(&mut lane, 500_000, true, 1.0), (1.0, 0.5, false));
        assert_eq!(lane.identifier.restarts, 1);
        push(&mut lane, 1_000_001, true, 1.0);
        assert_eq!(lane.identifier.restarts, 2);
        // An absent input also counts as a gap.
        push(&mut lane, 1_300_000, true, f64::NAN);
        push(&mut lane, 1_600_000, true, 1.0);
        assert_eq!((lane.identifier.restarts, lane.last_us), (3, Some(1_600_000)));
    }

    #[test]
    fn another_load_forgets_heights_and_doubts() {
        let mut lane = Lane::<f64, Recorder>::EMPTY;
        lane.fusion.push(Measured { value: 2.0, sd: 0.1 }, 0.1);
        lane.impossible = true;
        lane.unload();
        assert!(lane.fusion.height().is_none() && !lane.impossible);
    }
}
