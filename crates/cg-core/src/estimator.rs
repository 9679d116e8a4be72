//! The estimator connects all stages, from samples to the height.
//!
//! A *maneuver* is a part of a drive with at least one turn. It opens when the truck starts to
//! turn. The straight driving before it is included, with a weight that halves every two seconds.
//! It closes after four seconds of straight driving, after forty seconds, when the speed has
//! changed too much, at a gap, or at [`Estimator::finish`]. Each closed maneuver gives a ratio and
//! a height per channel. The heights of all maneuvers are fused.

use core::borrow::Borrow;

use crate::decide::closing::Closing;
use crate::decide::combined::{Combined, Heights};
use crate::decide::condition::{Conditioner, Row, SampleError};
use crate::decide::height::Height;
use crate::decide::lane::{Lane, shown};
use crate::decide::load::{LoadWatch, Said, Verdict};
use crate::decide::maneuver::{Maneuver, Outcome, Reject, Status, Step};
use crate::decide::memory::Memory;
use crate::decide::neighbors::{Most, Neighbors, Together};
use crate::decide::settings::Settings;
use crate::decide::signals::Seen;
use crate::decide::window::Window;
use crate::identify::identifier::Identify;
use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::channel::{CHANNELS, Channel};
use crate::truck::design::Design;
use crate::truck::friction::Friction;

/// Least number of samples of a maneuver, including the straight driving before it. Fewer are not
/// enough for the unknowns of any identifier.
const LEAST_SAMPLES: f64 = 12.0;

/// Time on a straight road after which another mass is used: there a scale does not swing, but it may have noise.
const STRAIGHT_WEIGHING_US: u64 = 2_000_000;

/// Greatest factor, up or down, between a ratio and the one that follows from the height of another
/// channel. Beyond it, the input of the channel is the cause of an impossible height. It is three
/// times the uncertainty due to the tires.
const ELSEWHERE: f64 = 1.5;

/// The estimator: takes samples and gives the height. It has a fixed size and uses no heap.
///
/// `D` is the type that holds the design: the design itself, or a reference to it, so that it can
/// stay in flash on a microcontroller.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, D: serde::Serialize, I::Options: serde::Serialize, [T; C]: serde::Serialize, [Lane<T, I>; C]: serde::Serialize, Window<T, C>: serde::Serialize, Closing<T, I::Work, C>: serde::Serialize, LoadWatch<T, C>: serde::Serialize, [[T; C]; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, D: serde::Deserialize<'de>, I::Options: serde::Deserialize<'de>, [T; C]: serde::Deserialize<'de>, [Lane<T, I>; C]: serde::Deserialize<'de>, Window<T, C>: serde::Deserialize<'de>, Closing<T, I::Work, C>: serde::Deserialize<'de>, LoadWatch<T, C>: serde::Deserialize<'de>, [[T; C]; C]: serde::Deserialize<'de>"
    ))
)]
pub struct Estimator<T: Real, I: Identify<T>, D = Design<T>, const C: usize = CHANNELS> {
    design: D,
    settings: Settings<T>,
    options: I::Options,
    /// The trailer mass of the models in the identifiers.
    made_for_kg: T,
    /// Whether any sample so far has had a mass, and whether a row has been made with it.
    is_weighed: bool,
    was_weighed: bool,
    /// Time since which the measured mass differs from `made_for_kg`.
    other_since_us: Option<u64>,
    conditioner: Conditioner<T, C>,
    neighbors: Neighbors<T, Seen<T>>,
    lanes: [Lane<T, I>; C],
    window: Option<Window<T, C>>,
    /// Solves the lanes of a window that has ended.
    closing: Closing<T, I::Work, C>,
    load: LoadWatch<T, C>,
    load_since_us: Option<u64>,
    correlation: [[T; C]; C],
}

impl<T: Real, I: Identify<T>, D: Borrow<Design<T, C>>, const C: usize> Estimator<T, I, D, C> {
    /// An estimator before its first sample. The design must be [valid](Design::validate).
    #[inline(never)]
    pub fn new(holder: D, settings: Settings<T>, options: I::Options) -> Self {
        let design = holder.borrow();
        Self {
            settings,
            options,
            made_for_kg: T::zero(), // the first row initializes the identifiers
            is_weighed: false,
            was_weighed: false,
            other_since_us: None,
            conditioner: Conditioner::new(design),
            neighbors: Neighbors::NONE,
            lanes: [Lane::EMPTY; C],
            window: None,
            closing: Closing::none(I::NOT_BEGUN),
            load: LoadWatch::new(settings.mass_change),
            load_since_us: None,
            correlation: [[T::one(); C]; C],
            design: holder,
        }
    }

    /// From now on with the [settings for a microcontroller](Settings::spread).
    pub fn lighten(&mut self) {
        self.settings = self.settings.spread();
    }

    /// The design of the truck.
    pub fn design(&self) -> &Design<T, C> {
        self.design.borrow()
    }

    /// Processes one sample.
    ///
    /// # Errors
    /// [`SampleError`] if the sample is refused. The state of the estimator is then unchanged.
    pub fn push(&mut self, sample: &Sample<T>) -> Result<Step<T, C>, SampleError> {
        let Some(seen) = self.conditioner.look(self.design.borrow(), sample)? else {
            return Ok(Step { status: Status::Absent, closed: self.go_on() });
        };
        self.is_weighed |= sample.trailer_mass_kg.present();
        let most = self.most();
        let is_next = self.neighbors.ends_before(sample.time_us, &seen, most);
        if !is_next {
            self.neighbors.add(sample.time_us, &seen);
            if !self.neighbors.is_complete(most) {
                if self.closing.is_open() {
                    return Ok(Step { status: self.status(), closed: self.go_on() });
                }
                return Ok(Step { status: self.status(), closed: None });
            }
        }
        let row = self.row();
        if is_next {
            self.neighbors.add(sample.time_us, &seen);
        }
        Ok(self.take_mean(&row, row.of.number == 1))
    }

    /// How many samples make a mean.
    pub fn most(&self) -> Most {
        Most { samples: I::MOST_TOGETHER, mean_us: self.settings.mean_us }
    }

    /// Processes the mean of some samples, all of them [checked](Sample::checked) and later than those before, by a caller
    /// that makes the means itself.
    pub fn push_mean(&mut self, together: &Together<T, Sample<T>>) -> Step<T, C> {
        let Together { last_us, mean: sample, of } = together;
        let Some(mean) = self.conditioner.see(self.design.borrow(), sample) else {
            return Step { status: Status::Absent, closed: self.go_on() };
        };
        self.is_weighed |= sample.trailer_mass_kg.present();
        let mean = Together { last_us: *last_us, mean, of: *of };
        let row = self.conditioner.row(self.design.borrow(), &mean);
        self.take_mean(&row, true)
    }

    fn status(&self) -> Status {
        if self.conditioner.is_turning() { Status::Turning } else { Status::Straight }
    }

    /// Ends the drive: closes the open maneuver and returns its result. Samples that wait for others to be averaged with are
    /// not in it.
    pub fn finish(&mut self) -> Option<Maneuver<T, C>> {
        if !self.closing.is_open() {
            self.close();
        }
        self.complete()
    }

    /// The row of the last samples.
    #[inline(never)]
    fn row(&mut self) -> Row<T, C> {
        let mean = self.neighbors.take();
        self.conditioner.row(self.design.borrow(), &mean)
    }

    /// Takes the row of a mean. `stages` says that it goes on with a solution; if the samples that wait for others to be
    /// averaged with do that, the one that completes the mean does not.
    #[inline(never)]
    fn take_mean(&mut self, row: &Row<T, C>, stages: bool) -> Step<T, C> {
        self.load.drive(row.time_us, row.speed_mps);
        if self.closing.is_open() {
            self.take_row(row);
            let closed = if stages { self.go_on() } else { None };
            return Step { status: self.status(), closed };
        }
        let first = self.is_weighed && !self.was_weighed;
        self.was_weighed |= first;
        let weighed = self.is_other_mass(row, first);
        if !weighed && !self.must_close(row) {
            self.take_row(row);
            return Step { status: self.status(), closed: None };
        }
        self.close();
        let closed = if self.settings.spreads { None } else { self.complete() };
        // While a solution goes on, the other mass waits for the next row.
        if weighed && !self.closing.is_open() {
            self.make_for(row.trailer_mass_kg);
        }
        self.take_row(row);
        Step { status: self.status(), closed }
    }

    /// The learned state, which [`restored`](Self::restored) takes after a restart.
    pub fn memory(&self) -> Memory<T, C> {
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
        memory: &Memory<T, C>,
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

    /// The fused height of one channel; `None` before its first good maneuver, or if the design does
    /// not have the channel.
    pub fn height(&self, channel: Channel) -> Option<Height<T>> {
        self.lanes.get(self.design().place(channel)?)?.fusion.height()
    }

    /// Compares the heights of all channels and combines them, weighted by their independent
    /// uncertainties. If only one channel has a height, this is the result. `None` before the first
    /// good maneuver.
    pub fn combined(&self) -> Option<Combined<T>> {
        let mut of_channels = self.lanes.each_ref().map(|lane| lane.fusion.height());
        let alone = of_channels.iter().flatten().count() == 1;
        if alone && self.lanes.iter().any(|lane| lane.impossible) {
            return Some(Combined::Impossible);
        }
        let mut outputs = [None; C];
        for (place, output) in outputs.iter_mut().enumerate() {
            *output = self.design().output(place);
        }
        // Where the bank of the road is not known, channels that do not feel it are used alone. The
        // bank of real roads is systematic, so no Gaussian of it would weigh the others rightly.
        let bank_free = |(place, height): (usize, &Option<Height<T>>)| {
            height.is_some() && !self.design().feels_bank(place)
        };
        if self.settings.bank_sd_rad > T::zero() && of_channels.iter().enumerate().any(bank_free) {
            for (place, height) in of_channels.iter_mut().enumerate() {
                if self.design().feels_bank(place) {
                    *height = None;
                }
            }
        }
        Heights { of_channels, correlation: self.correlation, outputs }.combined()
    }

    /// The combined height of all channels; `None` also if they [contradict](Combined) each other.
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
        let mut best: Option<(usize, T)> = None;
        for (place, lane) in self.lanes.iter().enumerate() {
            let sd_m = lane.fusion.height().map(|height| height.height_m.sd);
            if let Some(sd_m) = sd_m
                && best.is_none_or(|(_, least_m)| sd_m < least_m)
            {
                best = Some((place, sd_m));
            }
        }
        self.design().channel(best?.0)
    }

    /// Whether the trailer mass has changed for longer than the load signal oscillates in a turn, or on a straight
    /// road than its noise lasts, so that another mass applies to the dynamics. It is used at once if it was there
    /// before the window, and if it is the `first` measured one, because the nominal mass was an assumption.
    fn is_other_mass(&mut self, row: &Row<T, C>, first: bool) -> bool {
        let change_kg = (row.trailer_mass_kg - self.made_for_kg).abs();
        if !(change_kg > self.settings.mass_change * self.made_for_kg) {
            self.other_since_us = None;
            return false;
        }
        let since_us = *self.other_since_us.get_or_insert(row.time_us);
        let Some(window) = self.window.as_ref().filter(|one| !one.inherits_mass) else {
            return true;
        };
        let wait_us = match window.last_turn_us {
            Some(_) => self.settings.weighing_us,
            None => STRAIGHT_WEIGHING_US,
        };
        first || row.time_us.saturating_sub(since_us) >= wait_us
    }

    /// Initializes the identifiers for the dynamics at this trailer mass.
    #[inline(never)]
    fn make_for(&mut self, trailer_mass_kg: T) {
        self.made_for_kg = trailer_mass_kg;
        self.other_since_us = None;
        for (place, lane) in self.lanes.iter_mut().enumerate() {
            if let Some(model) = self.design.borrow().model(place, trailer_mass_kg) {
                let lags = self.design.borrow().lags_roll(place);
                lane.identifier.make_for(&model, lags, self.options);
                let friction = self.design.borrow().friction(place, trailer_mass_kg);
                lane.friction = friction.unwrap_or(Friction::NONE);
            }
            lane.last_us = None;
        }
    }

    /// Whether this row ends the present window.
    fn must_close(&self, row: &Row<T, C>) -> bool {
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

    #[inline(never)]
    fn take_row(&mut self, row: &Row<T, C>) {
        let is_solved = self.closing.is_open();
        let design = self.design.borrow();
        let pace = design.pace(row.speed_mps);
        for (place, lane) in self.lanes.iter_mut().enumerate() {
            if !is_solved {
                let lead_s = if row.by_yaw_rate { design.lead_s(place, pace) } else { T::zero() };
                lane.identifier.at_speed(pace, lead_s);
            }
            let place = (place, design.lags_roll(place));
            lane.identify(row, place, &self.settings, is_solved);
        }
        if !is_solved {
            self.note(row);
        }
    }

    /// Updates the window with this row.
    fn note(&mut self, row: &Row<T, C>) {
        let shown = shown(self.design.borrow(), &self.lanes, row);
        let window = self.window.get_or_insert_with(|| Window::new(row));
        for (place, shown) in shown.iter().enumerate() {
            if let Some(shown) = shown {
                window.look(place, shown);
            }
        }
        if window.push(row, self.other_since_us.is_none(), self.settings.fade_us) {
            for lane in &mut self.lanes {
                lane.identifier.forget(T::of(0.5));
            }
        }
    }

    /// Ends the window. If it has anything to tell, its solution begins. No truck is loaded in a turn, so if another mass has come
    /// within the window, that before it was of another load, and nothing follows from the rows. (The last row may have the mass
    /// of the sample after it.)
    fn close(&mut self) {
        let other_since_us = self.other_since_us;
        let tells = |window: &Window<T, C>| {
            window.last_turn_us.is_some()
                && window.weight > T::of(LEAST_SAMPLES)
                && other_since_us
                    .is_none_or(|since_us| window.inherits_mass || since_us >= window.last_us)
        };
        if self.window.as_ref().is_some_and(tells) {
            self.closing.begin(&self.lanes);
        } else {
            self.leave();
        }
    }

    /// Forgets the window and its rows.
    fn leave(&mut self) {
        self.window = None;
        for lane in &mut self.lanes {
            lane.identifier.clear();
        }
    }

    /// Does all stages of a solution that are left.
    #[inline(never)]
    fn complete(&mut self) -> Option<Maneuver<T, C>> {
        let mut closed = None;
        while self.closing.is_open() {
            closed = self.go_on();
        }
        closed
    }

    /// Goes on with a solution, if there is one; the last stage returns the maneuver.
    #[inline(never)]
    fn go_on(&mut self) -> Option<Maneuver<T, C>> {
        if self.closing.advance(&mut self.lanes) { self.judge() } else { None }
    }

    /// The maneuver of the window whose lanes are solved.
    #[inline(never)]
    fn judge(&mut self) -> Option<Maneuver<T, C>> {
        let (design, settings) = (self.design.borrow(), &self.settings);
        let judged = self
            .window
            .as_ref()
            .map(|one| self.closing.judge(design, settings, one, &mut self.lanes));
        self.leave();
        let maneuver = judged?;
        self.fuse(&maneuver);
        Some(maneuver)
    }

    fn fuse(&mut self, maneuver: &Maneuver<T, C>) {
        self.correlation = maneuver.correlation;
        let said = maneuver.outcomes.map(|o| Some((o.height_m.ok()?, o.systematic_sd_m)));
        let fused = self.lanes.each_ref().map(|lane| lane.fusion.height());
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
        for place in 0..C {
            let unexplained = self.is_unexplained(place, maneuver);
            if let Some(lane) = self.lanes.get_mut(place) {
                lane.impossible &= unexplained;
            }
        }
    }

    /// Whether the height of the channel at this place is impossible and its input is not the
    /// cause: the ratio agrees roughly with the height of another channel with the same roll angle,
    /// or no other channel has a height.
    fn is_unexplained(&self, place: usize, maneuver: &Maneuver<T, C>) -> bool {
        let design = self.design();
        let Some(channel) = design.channel(place) else { return false };
        let Some(Outcome { fit: Some(fit), height_m: Err(Reject::Height(_)), .. }) =
            maneuver.outcomes.get(place)
        else {
            return false;
        };
        let others = || {
            self.lanes
                .iter()
                .enumerate()
                .filter(move |(other, _)| *other != place)
                .filter_map(|(other, lane)| Some((design.output(other), lane.fusion.height()?)))
        };
        let same = others().find(|(output, _)| *output == design.output(place));
        let Some((_, height)) = same else { return others().next().is_none() };
        let line = design.line(channel, maneuver.speed_mps, maneuver.trailer_mass_kg);
        line.is_none_or(|line| {
            let expected = line.ratio_at(height.height_m.value) * design.compensation(channel);
            let factor = fit.ratio.value / expected;
            factor < T::of(ELSEWHERE) && factor > T::one() / T::of(ELSEWHERE)
        })
    }

    /// Adds the heights of one maneuver to the fused heights.
    fn take(&mut self, said: [Said<T>; C]) {
        for (lane, said) in self.lanes.iter_mut().zip(said) {
            if let Some((height_m, systematic_sd_m)) = said {
                lane.fusion.push(height_m, systematic_sd_m);
            }
        }
    }
}
