//! The estimator connects all stages, from samples to the height.
//!
//! A *maneuver* is a part of a drive with at least one turn. It opens when the truck starts to
//! turn. The straight driving before it is included, with a weight that halves every two seconds.
//! It closes after four seconds of straight driving, after forty seconds, when the speed has
//! changed too much, at a gap, or at [`Estimator::finish`]. Each closed maneuver gives a ratio and
//! a height per channel. The heights of all maneuvers are fused.

use core::borrow::Borrow;

use crate::decide::condition::{Conditioner, Row, SampleError};
use crate::decide::consistency::{Inconsistency, Watch};
use crate::decide::height::{Combined, Height};
use crate::decide::lane::Lane;
use crate::decide::load::{LoadWatch, Said, Verdict};
use crate::decide::maneuver::{Maneuver, Outcome, Reject, Status, Step};
use crate::decide::memory::Memory;
use crate::decide::settings::Settings;
use crate::identify::identifier::{Answer, Fit, Identify};
use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::design::{Channel, Design};
use crate::truck::ratio::{HeightError, Measured, RatioLine, solve_height};

/// Least number of rows of a maneuver, including the straight driving before it. Fewer rows are not
/// enough for the unknowns of any identifier.
const LEAST_ROWS: f64 = 12.0;

/// Number of standard deviations that chance exceeds with a probability of 1 %.
const ONCE_IN_A_HUNDRED: f64 = 2.576;
/// Number of standard deviations that chance exceeds with a probability of 0.1 %.
const ONCE_IN_A_THOUSAND: f64 = 3.29;

/// Greatest factor, up or down, between a ratio and the one that follows from the other channel's
/// height. Beyond it, the input of the channel is the cause of an impossible height. It is three
/// times the uncertainty due to the tires.
const ELSEWHERE: f64 = 1.5;

/// The part of the drive whose rows are in the identifiers.
#[derive(Clone, Copy, Debug)]
struct Window<T> {
    start_us: u64,
    last_us: u64,
    last_turn_us: Option<u64>,
    faded_us: u64,
    start_speed_mps: T,
    /// Mean speed of the rows in turns, and their number.
    speed_mps: T,
    rows: T,
    /// Mean trailer mass of all rows, because the load signal oscillates, and their weight.
    trailer_mass_kg: T,
    weight: T,
    /// It starts with the first row, because a dead band shows at the beginning of a turn.
    watch: Option<Watch<T>>,
}

/// The estimator: takes samples and gives the height. It has a fixed size and uses no heap.
///
/// `D` is the type that holds the design: the design itself, or a reference to it, so that it can
/// stay in flash on a microcontroller.
#[derive(Clone, Copy, Debug)]
pub struct Estimator<T: Real, I: Identify<T>, D = Design<T>> {
    design: D,
    settings: Settings<T>,
    options: I::Options,
    /// The trailer mass of the models in the identifiers.
    made_for_kg: T,
    /// Whether any sample so far has had a mass.
    weighed: bool,
    /// Time since which the measured mass differs from `made_for_kg`.
    other_since_us: Option<u64>,
    conditioner: Conditioner<T>,
    lanes: [Lane<T, I>; 2],
    window: Option<Window<T>>,
    load: LoadWatch<T>,
    load_since_us: Option<u64>,
    correlation: T,
}

impl<T: Real, I: Identify<T>, D: Borrow<Design<T>>> Estimator<T, I, D> {
    /// An estimator before its first sample. The design must be [valid](Design::validate).
    #[inline(never)]
    pub fn new(holder: D, settings: Settings<T>, options: I::Options) -> Self {
        let design = holder.borrow();
        Self {
            settings,
            options,
            made_for_kg: T::zero(), // the first row initializes the identifiers
            weighed: false,
            other_since_us: None,
            conditioner: Conditioner::new(design),
            lanes: [Lane::EMPTY; 2],
            window: None,
            load: LoadWatch::new(settings.mass_change),
            load_since_us: None,
            correlation: T::one(),
            design: holder,
        }
    }

    /// The design of the truck.
    pub fn design(&self) -> &Design<T> {
        self.design.borrow()
    }

    /// Processes one sample.
    ///
    /// # Errors
    /// [`SampleError`] if the sample is refused. The state of the estimator is then unchanged.
    pub fn push(&mut self, sample: &Sample<T>) -> Result<Step<T>, SampleError> {
        let Some(row) = self.conditioner.push(self.design.borrow(), sample)? else {
            return Ok(Step { status: Status::Absent, closed: None });
        };
        self.load.drive(row.time_us, row.speed_mps);
        let first = !self.weighed && sample.trailer_mass_kg.present();
        self.weighed |= first;
        let weighed = self.is_other_mass(&row, first);
        let closed = if weighed || self.must_close(&row) { self.close() } else { None };
        if weighed {
            self.make_for(row.trailer_mass_kg);
        }
        self.identify(&row);
        self.note(&row);
        let status = if row.turning { Status::Turning } else { Status::Straight };
        Ok(Step { status, closed })
    }

    /// Ends the drive: closes the open maneuver and returns its result.
    pub fn finish(&mut self) -> Option<Maneuver<T>> {
        self.close()
    }

    /// The learned state, which [`restored`](Self::restored) takes after a restart.
    pub fn memory(&self) -> Memory<T> {
        Memory {
            fused: self.lanes.each_ref().map(|lane| lane.fusion),
            correlation: self.correlation,
            trailer_mass_kg: self.conditioner.trailer_mass_kg(),
            load_mass_kg: self.load.mass_kg(),
            waiting: self.load.waiting(),
        }
    }

    /// An estimator before its first sample with the learned state of another one that had the same
    /// design. A restart counts as a stop, because the load may have changed.
    ///
    /// `None` if the memory is not [sound](Memory::is_sound).
    #[must_use]
    pub fn restored(
        design: D,
        settings: Settings<T>,
        options: I::Options,
        memory: &Memory<T>,
    ) -> Option<Self> {
        if !memory.is_sound() {
            return None;
        }
        let mut estimator = Self::new(design, settings, options);
        for (lane, fusion) in estimator.lanes.iter_mut().zip(memory.fused) {
            lane.fusion = fusion;
        }
        estimator.correlation = memory.correlation;
        estimator.conditioner.weigh(estimator.design.borrow(), memory.trailer_mass_kg);
        estimator.make_for(memory.trailer_mass_kg);
        estimator.load =
            LoadWatch::resumed(settings.mass_change, memory.load_mass_kg, memory.waiting);
        Some(estimator)
    }

    /// The fused height of one channel; `None` before its first good maneuver.
    pub fn height(&self, channel: Channel) -> Option<Height<T>> {
        self.lanes[channel.index()].fusion.height()
    }

    /// Compares both channels and combines their heights, weighted by their independent
    /// uncertainties. If only one channel has a height, this is the result. `None` before the first
    /// good maneuver.
    pub fn combined(&self) -> Option<Combined<T>> {
        match (self.height(Channel::Steer), self.height(Channel::LateralAcceleration)) {
            (Some(steer), Some(lateral)) => Some(lateral.combined(&steer, self.correlation)),
            (None, None) => None,
            _ if self.lanes.iter().any(|lane| lane.impossible) => Some(Combined::Impossible),
            (steer, lateral) => steer.or(lateral).map(Combined::Agreed),
        }
    }

    /// The combined height of both channels; `None` also if they [contradict](Combined) each other.
    pub fn combined_height(&self) -> Option<Height<T>> {
        self.combined()?.height()
    }

    /// Time stamp of the end of the maneuver that revealed the last change of the load; the heights
    /// are those of the load since then. `None` for the first load.
    pub fn load_since_us(&self) -> Option<u64> {
        self.load_since_us
    }

    /// The channel whose height has the smallest standard deviation.
    pub fn best_channel(&self) -> Option<Channel> {
        let sd = |channel| self.height(channel).map(|height| height.height_m.sd);
        match (sd(Channel::Steer), sd(Channel::LateralAcceleration)) {
            (Some(steer), Some(lateral)) if lateral < steer => Some(Channel::LateralAcceleration),
            (None, Some(_)) => Some(Channel::LateralAcceleration),
            (Some(_), _) => Some(Channel::Steer),
            (None, None) => None,
        }
    }

    /// Whether the trailer mass has changed for longer than the load signal oscillates in a turn,
    /// so that another mass applies to the dynamics. The `first` measured mass is used at once,
    /// because the nominal mass before it was an assumption.
    fn is_other_mass(&mut self, row: &Row<T>, first: bool) -> bool {
        let change_kg = (row.trailer_mass_kg - self.made_for_kg).abs();
        if !(change_kg > self.settings.mass_change * self.made_for_kg) {
            self.other_since_us = None;
            return false;
        }
        let since_us = *self.other_since_us.get_or_insert(row.time_us);
        let lasting = row.time_us.saturating_sub(since_us) >= self.settings.weighing_us;
        lasting || first || self.window.is_none()
    }

    /// Initializes the identifiers for the dynamics at this trailer mass.
    #[inline(never)]
    fn make_for(&mut self, trailer_mass_kg: T) {
        self.made_for_kg = trailer_mass_kg;
        self.other_since_us = None;
        for (lane, channel) in self.lanes.iter_mut().zip(Channel::ALL) {
            let model = self.design.borrow().model(channel, trailer_mass_kg);
            lane.identifier.make_for(&model, self.options);
            lane.last_us = None;
        }
    }

    /// Whether this row ends the present window.
    fn must_close(&self, row: &Row<T>) -> bool {
        let Some(window) = &self.window else { return false };
        let since = |time_us: u64| row.time_us.saturating_sub(time_us);
        let speed_change = (row.speed_mps - window.start_speed_mps).abs();
        let too_fast = speed_change > self.settings.speed_spread * window.start_speed_mps;
        since(window.last_us) > self.settings.gap_us
            || too_fast
            || window.last_turn_us.is_some_and(|turn_us| {
                since(turn_us) > self.settings.straight_us
                    || since(window.start_us) > self.settings.longest_us
            })
    }

    fn identify(&mut self, row: &Row<T>) {
        for ((lane, expected_rad), usable) in
            self.lanes.iter_mut().zip(row.expected_rad).zip(row.usable)
        {
            lane.identify(row, expected_rad, usable, &self.settings);
        }
    }

    /// Updates the window with this row.
    fn note(&mut self, row: &Row<T>) {
        let window = self.window.get_or_insert(Window {
            start_us: row.time_us,
            last_us: row.time_us,
            last_turn_us: None,
            faded_us: row.time_us,
            start_speed_mps: row.speed_mps,
            speed_mps: T::zero(),
            rows: T::zero(),
            trailer_mass_kg: T::zero(),
            weight: T::zero(),
            watch: None,
        });
        let [steer_rad, lateral_rad] = row.expected_rad;
        let input_rad = if lateral_rad.present() { lateral_rad } else { steer_rad };
        // The steer channel if it has an input, because its reduced model includes faster motion.
        let awake = |lane: &&Lane<T, I>| lane.last_us == Some(row.time_us);
        if let Some(lane) = self.lanes.iter().find(awake) {
            let (roll_rad, model_rad) = (row.roll_rad, lane.identifier.expected_roll_rad());
            match &mut window.watch {
                Some(watch) => watch.push(row.time_us, roll_rad, input_rad, model_rad),
                None => {
                    window.watch = Some(Watch::new(row.time_us, roll_rad, input_rad, model_rad));
                }
            }
        }
        window.last_us = row.time_us;
        // Means are updated recursively, because sums lose digits in single precision.
        window.weight += T::one();
        let more_kg = row.trailer_mass_kg - window.trailer_mass_kg;
        window.trailer_mass_kg += more_kg / window.weight;
        if row.turning {
            window.last_turn_us = Some(row.time_us);
            window.rows += T::one();
            window.speed_mps += (row.speed_mps - window.speed_mps) / window.rows;
        } else if window.last_turn_us.is_none()
            && row.time_us.saturating_sub(window.faded_us) >= self.settings.fade_us
        {
            window.faded_us = row.time_us;
            window.start_us = row.time_us;
            window.start_speed_mps = row.speed_mps;
            window.weight *= T::of(0.5);
            for lane in &mut self.lanes {
                lane.identifier.forget(T::of(0.5));
            }
        }
    }

    #[inline(never)]
    fn close(&mut self) -> Option<Maneuver<T>> {
        let window = self.window.take()?;
        let told = window.last_turn_us.is_some() && window.weight > T::of(LEAST_ROWS);
        let maneuver = told.then(|| self.judge(&window));
        for lane in &mut self.lanes {
            lane.identifier.clear();
        }
        let maneuver = maneuver?;
        self.fuse(&maneuver);
        Some(maneuver)
    }

    fn judge(&mut self, window: &Window<T>) -> Maneuver<T> {
        let Window { speed_mps, trailer_mass_kg, .. } = *window;
        let mut outcomes = Channel::ALL.map(|channel| self.outcome(channel, window));
        // A faulty roll sensor affects both channels.
        let fault = outcomes.iter().find_map(|outcome| match outcome.height_m {
            Err(Reject::Inconsistent(Inconsistency::Misfit { .. })) => None,
            Err(Reject::Inconsistent(reason)) => Some(reason),
            _ => None,
        });
        if let Some(reason) = fault {
            for outcome in outcomes.iter_mut().filter(|outcome| outcome.height_m.is_ok()) {
                outcome.height_m = Err(Reject::Inconsistent(reason));
            }
        }
        Maneuver {
            start_us: window.start_us,
            end_us: window.last_us,
            speed_mps,
            trailer_mass_kg,
            outcomes,
            correlation: self
                .design()
                .spread(speed_mps, trailer_mass_kg)
                .map_or(T::one(), |spread| spread.correlation),
        }
    }

    #[inline(never)]
    fn outcome(&mut self, channel: Channel, window: &Window<T>) -> Outcome<T> {
        let rejected =
            |fit, reject| Outcome { fit, height_m: Err(reject), systematic_sd_m: T::zero() };
        let Window { speed_mps, trailer_mass_kg, .. } = *window;
        let (Some(line), Some(spread)) = (
            self.design().line(channel, speed_mps, trailer_mass_kg),
            self.design().spread(speed_mps, trailer_mass_kg),
        ) else {
            return rejected(None, Reject::OutsideDesign { speed_mps, trailer_mass_kg });
        };
        let lane = &mut self.lanes[channel.index()];
        if lane.last_us.is_none() {
            return rejected(None, Reject::Absent);
        }
        let mut fit = match lane.identifier.fit() {
            Answer::Ready(fit) => fit,
            Answer::Unexcited(reason) => return rejected(None, Reject::Unexcited(reason)),
        };
        let compensation = self.design().channels[channel.index()].compensation;
        let expected = line.ratio_at(self.design().reference_height_m) * compensation;
        let steps = window.watch.map_or(T::zero(), |watch| watch.step_share(fit.noise_sd_rad));
        let ratio_sd_relative =
            ((fit.ratio.sd * fit.ratio.sd + steps * steps).root() / fit.ratio.value).abs();
        fit.ratio.sd = ratio_sd_relative * fit.ratio.value.abs();
        fit.ratio.value *= expected;
        fit.ratio.sd *= expected;
        if !(ratio_sd_relative <= self.settings.ratio_sd_relative) {
            return rejected(Some(fit), Reject::Imprecise { ratio_sd_relative });
        }
        if let Some(reason) = self.inconsistency(&fit, window) {
            return rejected(Some(fit), Reject::Inconsistent(reason));
        }
        let compensation = Measured::exact(compensation);
        let height = solve_height(&line, fit.ratio, compensation, T::zero());
        let exact = Measured::exact(fit.ratio.value);
        let [steer_sd, lateral_sd] = spread.sd;
        let model_sd = match channel {
            Channel::Steer => steer_sd,
            Channel::LateralAcceleration => lateral_sd,
        };
        let systematic = solve_height(&line, exact, compensation, model_sd);
        let ratio = fit.ratio.value / compensation.value;
        let far = self.is_far(
            &line,
            ratio,
            (ratio_sd_relative * ratio_sd_relative + model_sd * model_sd).root(),
        );
        self.lanes[channel.index()].impossible = far;
        match (height, systematic) {
            (Ok(height), Ok(systematic)) if self.is_possible(height.value) => {
                Outcome { fit: Some(fit), height_m: Ok(height), systematic_sd_m: systematic.sd }
            }
            (Ok(height), _) => {
                let height_m = height.value;
                rejected(Some(fit), Reject::Height(HeightError::OutOfRange { height_m }))
            }
            (Err(error), _) => rejected(Some(fit), Reject::Height(error)),
        }
    }

    /// The reason why the roll angle cannot be true, if there is one.
    fn inconsistency(&self, fit: &Fit<T>, window: &Window<T>) -> Option<Inconsistency<T>> {
        let Settings { standstill, misfit, bend, .. } = self.settings;
        if let Some(stood) = window.watch.and_then(|watch| watch.standstill(standstill)) {
            return Some(stood);
        }
        if !(fit.misfit <= misfit) {
            return Some(Inconsistency::Misfit { share: fit.misfit });
        }
        // A positive bend is not used, because a delayed sensor has the same effect.
        let short = -fit.bend.value;
        (short > bend && short > T::of(ONCE_IN_A_THOUSAND) * fit.bend.sd)
            .then_some(Inconsistency::Bent { share: short })
    }

    /// Whether a ratio is outside the range of all heights that this trailer can have, by more than
    /// its relative uncertainty explains (probability 1 %).
    fn is_far(&self, line: &RatioLine<T>, ratio: T, sd_relative: T) -> bool {
        let above = ratio / line.ratio_at(self.design().greatest_height_m) - T::one();
        let below = T::one() - ratio / line.ratio_at(self.design().least_height_m);
        above.max(below) > T::of(ONCE_IN_A_HUNDRED) * sd_relative
    }

    fn is_possible(&self, height_m: T) -> bool {
        height_m >= self.design().least_height_m && height_m <= self.design().greatest_height_m
    }

    fn fuse(&mut self, maneuver: &Maneuver<T>) {
        self.correlation = maneuver.correlation;
        let said = maneuver.outcomes.map(|o| Some((o.height_m.ok()?, o.systematic_sd_m)));
        let fused = Channel::ALL.map(|channel| self.height(channel));
        match self.load.judge(maneuver.trailer_mass_kg, said, fused) {
            Verdict::Same => {}
            Verdict::Wait => return,
            Verdict::Changed { waited } => {
                self.load_since_us = Some(maneuver.end_us);
                for lane in &mut self.lanes {
                    lane.unload();
                }
                self.take(waited);
            }
        }
        self.take(said);
        for channel in Channel::ALL {
            let unexplained = self.is_unexplained(channel, maneuver);
            self.lanes[channel.index()].impossible &= unexplained;
        }
    }

    /// Whether the height of a channel is impossible and its input is not the cause: the ratio
    /// agrees roughly with the other channel's height, or the other channel has no height.
    fn is_unexplained(&self, channel: Channel, maneuver: &Maneuver<T>) -> bool {
        let Outcome { fit: Some(fit), height_m: Err(Reject::Height(_)), .. } =
            &maneuver.outcomes[channel.index()]
        else {
            return false;
        };
        let Some(other) = self.height(channel.other()) else { return true };
        let line = self.design().line(channel, maneuver.speed_mps, maneuver.trailer_mass_kg);
        let compensation = self.design().channels[channel.index()].compensation;
        line.is_none_or(|line| {
            let factor = fit.ratio.value / (line.ratio_at(other.height_m.value) * compensation);
            factor < T::of(ELSEWHERE) && factor > T::one() / T::of(ELSEWHERE)
        })
    }

    /// Adds the heights of one maneuver to the fused heights.
    fn take(&mut self, said: [Said<T>; 2]) {
        for (lane, said) in self.lanes.iter_mut().zip(said) {
            if let Some((height_m, systematic_sd_m)) = said {
                lane.fusion.push(height_m, systematic_sd_m);
            }
        }
    }
}
