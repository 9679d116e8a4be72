//! Processes the rows of a log.

use cg_core::Maneuver;
use cg_core::decide::neighbors::{Neighbors, Together};
use cg_core::{
    AlignSettings, CHANNELS, Design, Measured, Quantity, Sample, SampleError, Signals, Status,
};
use serde::{Deserialize, Serialize};

use super::engine::Engine;
use super::entry::Entry;
use super::felt::felt_mps2;
use super::kept::Kept;
use super::leaning::Leaning;
use super::left_out::LeftOut;
use super::means::SampleSum;
use super::options::EstimateOptions;
use super::positions::{Lift, Truck};
use super::rated::Rated;
use super::recorder::Recorder;
use super::rolls::RollCheck;
use super::row_sample::SignalsSeen;
use super::sensors::SensorCheck;
use super::since_stop::SinceStop;
use super::strong::StrongTurns;
use super::unheard::Unheard;
use super::windward::Windward;
use crate::log::{LogRow, Signal};
use cg_vehicle::Vehicle;
use cg_vehicle::belief::Belief;
use cg_vehicle::error::VehicleError;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::preparation::Preparation;
use cg_vehicle::scales::Scale;

/// The DC ratios identified from a log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Identified {
    /// Mean speed of the maneuvers, m/s.
    pub speed_mps: f64,
    /// Lateral acceleration of its turns, g; `None` if the log has neither it nor yaw rate and speed.
    pub turn_g: Option<f64>,
    /// Trailer mass used, kg.
    pub trailer_mass_kg: f64,
    /// Its standard deviation, kg: that of its scale, or that of any load if it is not known.
    pub trailer_mass_sd_kg: f64,
    /// Whether the mass comes from the log or the options, and not from the vehicle file.
    pub trailer_mass_is_known: bool,
    /// The trailer mass in the log in the last turn, kg, also if an option replaced it.
    pub logged_mass_kg: Option<f64>,
    /// Where the lift axles were.
    pub lift_axle: LiftAxle,
    /// When they moved after a maneuver, s; the ratios are those since then.
    pub lift_moved_s: Option<f64>,
    /// What contradicts their position.
    pub lift_contradiction: Option<&'static str>,
    /// What is not known of it.
    pub lift_unknown: Option<&'static str>,
    /// When the load has changed in the log, s; the ratios are those of the last load.
    pub load_since_s: Option<f64>,
    /// DC ratios in the order of [`Channel::ALL`](cg_core::Channel::ALL), with the standard deviation due to noise.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Whether its roads count as flat because nothing says what they were.
    pub is_assumed_flat: bool,
    /// What is said of strong and tight turns, and of a speed that changes in them.
    pub turns: Vec<String>,
    /// The part of the standard deviations, relative, that this is. It has one sign in all logs of a truck.
    pub turns_sd: [f64; CHANNELS],
    /// What is wrong with a signal, for which an estimate has no height.
    pub wrong_signal: Option<String>,
    /// What is said of the whole log.
    pub notes: Vec<String>,
    /// Messages for the user, these among them.
    pub messages: Vec<String>,
}

/// Estimates the height from one log, row by row. Its memory grows only with the number of
/// maneuvers, up to ten thousand.
///
/// It is serialized with its whole state, so that it goes on to the last bit where it was; a format
/// without NaN, such as JSON, does not do. Another version may have another state.
#[derive(Clone, Serialize, Deserialize)]
pub struct LogEstimator {
    pub(super) design: Design<f64>,
    pub(super) options: EstimateOptions,
    pub(super) settings: AlignSettings<f64>,
    pub(super) lift: Lift,
    pub(super) engine: Engine,
    pub(super) origin_s: Option<f64>,
    previous_us: Option<u64>,
    /// The last speed, m/s.
    known_mps: f64,
    /// The signals of the last sample, and whether any channel has both its roll angle and its input.
    seen_kinds: (u32, bool),
    /// The samples since the last mean, and the state of the estimator after it.
    neighbors: Neighbors<f64, SampleSum>,
    status: Status,
    pub(super) rows: u64,
    pub(super) absent_rows: u64,
    pub(super) seen: SignalsSeen,
    pub(super) trailer_mass_kg: f64,
    pub(super) rolls: RollCheck,
    pub(super) sensors: SensorCheck,
    pub(super) leaning: Leaning,
    pub(super) strong: StrongTurns,
    pub(super) rated: Rated,
    pub(super) windward: Windward,
    pub(super) preparation: Preparation,
    pub(super) left_out: LeftOut,
    pub(super) unheard: Unheard,
    pub(super) entry: Entry,
    pub(super) stop: SinceStop,
    pub(super) maneuvers: Vec<Maneuver<f64>>,
    /// What else is kept of each of them.
    pub(super) kept: Vec<Kept>,
    /// The place of the first maneuver of the last load among them.
    pub(super) first_of_load: usize,
    /// Number of maneuvers that are not kept.
    pub(super) more_maneuvers: u64,
    /// Only while a calibration reads a log.
    #[serde(skip)]
    recorder: Option<Box<Recorder>>,
}

impl LogEstimator {
    /// An estimator for logs of `vehicle`.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle gives no usable design.
    pub fn new(vehicle: &Vehicle, options: EstimateOptions) -> Result<Self, VehicleError> {
        Self::of_truck(vehicle, &Belief::prior(vehicle), options)
    }

    /// An estimator for logs of `vehicle`, whose parameters have this distribution. Lift axles are where the options say, or
    /// else where the log does.
    ///
    /// # Errors
    /// As [`Truck::positions`].
    pub fn of_truck(
        vehicle: &Vehicle,
        belief: &Belief,
        options: EstimateOptions,
    ) -> Result<Self, VehicleError> {
        let (present, raised) = Truck::positions(vehicle, belief, options)?;
        Ok(Self::of_positions(&present, raised))
    }

    /// An estimator for a truck as it is; if it may have its lift axles raised, the signal `lift_axle` says when, and this is the
    /// truck with them raised.
    pub fn of_positions(present: &Truck, raised: Option<Truck>) -> Self {
        let &Truck { ref design, settings, options } = present;
        let lift = Lift::new(options.lift_axle, raised);
        Self { lift, ..Self::from_design(design, settings, options) }
    }

    /// An estimator with an existing design.
    pub fn from_design(
        design: &Design<f64>,
        settings: AlignSettings<f64>,
        options: EstimateOptions,
    ) -> Self {
        Self {
            engine: Engine::new(design, &options),
            lift: Lift::new(options.lift_axle, None),
            design: *design,
            options,
            settings,
            origin_s: None,
            previous_us: None,
            known_mps: design.nominal_speed_mps,
            seen_kinds: (0, false),
            neighbors: Neighbors::NONE,
            status: Status::Straight,
            rows: 0,
            absent_rows: 0,
            seen: SignalsSeen::default(),
            trailer_mass_kg: options.trailer_mass_kg.unwrap_or(design.nominal_trailer_mass_kg),
            rolls: RollCheck::default(),
            sensors: SensorCheck::default(),
            leaning: Leaning::default(),
            strong: StrongTurns::default(),
            rated: Rated::default(),
            windward: Windward::default(),
            preparation: Preparation::at(design.nominal_speed_mps),
            left_out: LeftOut::default(),
            unheard: Unheard::default(),
            entry: Entry::default(),
            stop: SinceStop::default(),
            maneuvers: Vec::new(),
            kept: Vec::new(),
            first_of_load: 0,
            more_maneuvers: 0,
            recorder: None,
        }
    }

    /// Follows the lift axles. If they have moved, the truck is another one, and the estimator begins again.
    fn follow(&mut self, row: &LogRow) {
        let has_heights = !self.maneuvers.is_empty();
        let Some(position) = self.lift.hear(row.lift_axle, row.time_s, has_heights) else { return };
        self.end();
        let Some(mut there) = self.lift.set(position) else { return };
        core::mem::swap(&mut there.design, &mut self.design);
        core::mem::swap(&mut there.settings, &mut self.settings);
        core::mem::swap(&mut there.options, &mut self.options);
        self.lift.leave(there, (row.time_s, self.maneuvers.len()));
        self.first_of_load = self.maneuvers.len();
        let mass_kg = Some(self.trailer_mass_kg);
        self.engine = self.engine.become_other((&self.design, &self.options), mass_kg);
        (self.neighbors, self.status, self.seen_kinds) =
            (Neighbors::NONE, Status::Straight, (0, false));
        self.sensors.close(true);
        (self.leaning, self.strong) = (Leaning::default(), StrongTurns::default());
        (self.rated, self.left_out) = (Rated::default(), LeftOut::default());
        (self.windward, self.entry) = (Windward::default(), Entry::default());
        (self.unheard, self.stop) = (Unheard::default(), SinceStop::default());
        self.recorder = None;
    }

    /// Records the inputs and roll angles of the next rows.
    pub(crate) fn record(&mut self) {
        self.recorder = Some(Box::new(Recorder::new(&self.design)));
    }

    /// What it has recorded.
    pub(crate) fn recorder(&mut self) -> Option<Box<Recorder>> {
        self.recorder.take()
    }

    /// Processes one row and returns the state of the estimator.
    ///
    /// # Errors
    /// [`SampleError`] if the time is not later than that of the previous row (at a resolution of 1
    /// µs).
    pub fn push(&mut self, row: &LogRow) -> Result<Status, SampleError> {
        self.follow(row);
        let mut sample = self.sample(row);
        let time_us = sample.time_us;
        if let Some(previous_us) = self.previous_us.filter(|previous_us| time_us <= *previous_us) {
            return Err(SampleError::TimeOrder { previous_us, time_us });
        }
        self.previous_us = Some(time_us);
        if let Some(of) = &self.options.prepares {
            let may_twist = self.options.may_twist();
            self.preparation.hear(row.yaw_rate_on_tractor, row.lateral_acceleration_on_tractor);
            self.preparation.prepare(&mut sample, of, may_twist, self.design.gravity_mps2);
        }
        self.rows += 1;
        self.rolls.push(row);
        self.rated.push(row);
        self.sensors.level(|quantity| row.get(Signal::from(quantity)));
        self.sensors.value(&sample);
        if let Some(recorder) = &mut self.recorder {
            recorder.push(&self.design, &sample)?;
        }
        if Quantity::Speed.plausible(sample.speed_mps) {
            self.known_mps = sample.speed_mps;
        }
        let known = (self.known_mps, self.seen.speed_age.holds(time_us));
        let next = SampleSum::of(&sample, known, self.design.gravity_mps2);
        if self.seen_kinds.0 != next.kinds() {
            let signals = Signals::of(&sample.checked(), self.known_mps, self.design.gravity_mps2);
            self.seen_kinds = (next.kinds(), signals.are_seen_by(&self.design));
            self.seen.arrive(row);
        }
        let (_, is_seen) = self.seen_kinds;
        let take = if is_seen { Self::take } else { Self::take_alone };
        Ok(take(self, time_us, &next))
    }

    /// Takes a sample that is averaged with its neighbors.
    fn take(&mut self, time_us: u64, next: &SampleSum) -> Status {
        let most = self.engine.most();
        let is_next = self.neighbors.ends_before(time_us, next, most);
        if is_next {
            self.take_neighbors();
        }
        self.neighbors.add(time_us, next);
        // As in the estimator, a sample that begins a mean waits for the next one.
        if !is_next && self.neighbors.is_complete(most) {
            self.take_neighbors();
        }
        self.status
    }

    fn take_neighbors(&mut self) {
        let together = self.neighbors.take();
        self.status = self.take_mean(&together);
    }

    /// Takes a sample without a roll angle or without an input, which ends no mean, as in the estimator.
    fn take_alone(&mut self, time_us: u64, next: &SampleSum) -> Status {
        if self.neighbors.ends_by(time_us, self.engine.most()) {
            self.take_neighbors();
        }
        let mut alone = Neighbors::NONE;
        alone.add(time_us, next);
        self.take_mean(&alone.take())
    }

    fn take_mean(&mut self, together: &Together<f64, SampleSum>) -> Status {
        let Together { last_us, mean, of } = together;
        let (last_us, of) = (*last_us, *of);
        let together = Together { last_us, mean: mean.sample(last_us), of };
        let mut sample = together.mean;
        if !mean.has_speed() {
            sample.speed_mps = f64::NAN;
        }
        // Its own time, because that of the sample after a gap may be in it.
        if let Some((time_us, masses_kg)) = self.seen.to_weigh.take() {
            self.seen.weighed.weigh(time_us, masses_kg, sample.speed_mps);
        }
        let step = self.engine.push_mean(&together); // not moved, because of the room for a maneuver in it
        let (sample, gravity_mps2) = (&sample, self.design.gravity_mps2);
        self.sensors.push_mean(sample, &self.design);
        self.leaning.push_mean((sample, f64::from(of.number)), step.status, gravity_mps2);
        self.strong.push(sample, &self.design);
        if self.options.side_wind.is_some() {
            self.windward.push(sample, step.status, &self.design);
        }
        self.stop.push(sample, &self.engine);
        self.entry.push(last_us, step.status);
        if step.status == Status::Absent {
            self.absent_rows += u64::from(of.number);
        }
        self.keep(step.closed.as_ref());
        step.status
    }

    /// Ends the log and closes the last maneuver, without the samples that wait for others to be averaged with.
    pub(super) fn end(&mut self) {
        let last = self.engine.finish();
        self.keep(last.as_ref());
    }

    /// Sets the scale on the bus from which the mass of the next rows follows; `None` if the rows are not
    /// from frames, or have the value of the scale itself.
    pub fn weighed_by(&mut self, scale: Option<Scale>) {
        self.seen.bus_scale = scale;
    }

    /// The time of the log, s, of microseconds since its first row.
    #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
    pub(super) fn time_s(&self, time_us: u64) -> f64 {
        self.origin_s.unwrap_or(0.0) + time_us as f64 * 1e-6
    }

    /// The design of the truck.
    pub fn design(&self) -> &Design<f64> {
        &self.design
    }

    /// Where the lift axles are.
    pub fn lift_axle(&self) -> LiftAxle {
        self.lift.position()
    }

    /// What is not known of their position, or contradicts it.
    pub fn lift_doubt(&self) -> Option<&'static str> {
        self.lift.doubt()
    }

    /// The sample of a row.
    #[inline]
    pub(super) fn sample(&mut self, row: &LogRow) -> Sample<f64> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s);
        // Microseconds since the first row. The cast gives zero for a time before the first row,
        // which is then refused.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6 + 0.5) as u64;
        let of = (row, time_us);
        let sample = self.seen.sample(of, &self.design, &self.settings, &self.options);
        if sample.trailer_mass_kg.is_finite() {
            self.trailer_mass_kg = sample.trailer_mass_kg;
        }
        sample
    }

    /// The maneuvers of the last load.
    pub(super) fn of_load(&self) -> &[Maneuver<f64>] {
        self.maneuvers.get(self.first_of_load..).unwrap_or_default()
    }

    /// The roll angles and inputs that the channels take from a row. A row without a speed has no
    /// lateral acceleration from the yaw rate.
    pub fn signals(&mut self, row: &LogRow) -> Signals<f64> {
        let sample = self.sample(row).checked();
        Signals::of(&sample, sample.speed_mps, self.design.gravity_mps2)
    }

    /// The lateral acceleration that the truck feels in a row at a speed, m/s²; see
    /// [`felt_mps2`](super::felt_mps2). The height is that so far.
    pub fn felt_mps2(&mut self, row: &LogRow, speed_mps: f64) -> f64 {
        let sample = self.sample(row).checked();
        let height = self.engine.combined().and_then(|all| all.height());
        let height_m = height.map_or(self.design.reference_height_m, |all| all.height_m.value);
        felt_mps2(&self.design, &sample, speed_mps, [self.trailer_mass_kg, height_m])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, SPEED_MPS, design, plain};
    use cg_core::Channel;

    /// The means of a log are those that the estimator makes of its samples, although cells are missing: speeds in two rows of
    /// three, roll angles here and there, the lateral acceleration for a while, and all of some seconds; times jitter.
    #[test]
    fn a_log_with_missing_cells_has_the_maneuvers_of_its_samples() {
        let (mut log, mut theirs) = (plain(), Vec::new());
        let mut engine = Engine::new(&design(), &EstimateOptions::default());
        for k in (0..29_990_u32).filter(|k| k % 4000 < 3900) {
            let time_s = 0.01 * f64::from(k) + 1e-4 * f64::from(k * 7 % 41);
            let some = |present, x| if present { x } else { f64::NAN };
            let turn = (0.4 * time_s).sin();
            let path_mps2 = if (k / 1600) % 2 == 0 { 2.0 * turn * turn * turn } else { 0.0 };
            let row = LogRow {
                time_s,
                speed_mps: some(k % 3 == 0, SPEED_MPS + turn),
                roll_rad: some(k % 53 > 2, 0.04 * path_mps2 + 1e-4 * f64::from(k * k % 7)),
                yaw_rate_radps: path_mps2 / (SPEED_MPS + turn),
                lateral_acceleration_mps2: some((k / 6000) % 2 == 0, path_mps2),
                trailer_mass_kg: some(k % 100 == 50, MASS_KG + f64::from(k % 900)),
                ..LogRow::ABSENT
            };
            let sample = log.sample(&row);
            theirs.extend(engine.push(&sample).unwrap().closed);
            log.push(&row).unwrap();
        }
        theirs.extend(engine.finish());
        log.end();
        assert!(theirs.len() > 8 && theirs.len() == log.maneuvers.len());
        let (mut heights, place) = (0, Channel::LateralAcceleration.index());
        for (ours, theirs) in log.maneuvers.iter().zip(&theirs) {
            assert_eq!((ours.start_us, ours.end_us), (theirs.start_us, theirs.end_us));
            let [ours, theirs] = [ours, theirs].map(|one| one.outcomes[place]);
            match (ours.height_m, theirs.height_m) {
                (Ok(ours), Ok(theirs)) => {
                    heights += 1;
                    // A mean of a hundred numbers is rounded by 1e-14, which the conditions of the fit multiply.
                    assert!((ours.value / theirs.value - 1.0).abs() < 1e-9, "{ours:?} {theirs:?}");
                }
                (ours, theirs) => assert_eq!(ours, theirs),
            }
        }
        assert!(heights > 4, "{heights} of {}", theirs.len());
    }

    /// A speed holds until the next one, so one a second shows strong turns and changes of speed as one in every row does.
    #[test]
    fn a_speed_once_a_second_shows_what_one_in_every_row_does() {
        let strength = |every: u32| {
            let mut log = plain();
            for k in 0..9000_u32 {
                let time_s = 0.02 * f64::from(k);
                let turn = (0.3 * time_s).sin();
                let path_mps2 = 2.5 * turn * turn * turn;
                let speed_mps = SPEED_MPS + (0.4 * time_s).sin();
                let row = LogRow {
                    time_s,
                    roll_rad: 0.04 * path_mps2,
                    yaw_rate_radps: path_mps2 / speed_mps,
                    speed_mps: if k % every == 0 { speed_mps } else { f64::NAN },
                    trailer_mass_kg: MASS_KG,
                    ..LogRow::ABSENT
                };
                log.push(&row).unwrap();
            }
            log.end();
            log.strong.strength(&log.design, (Channel::LateralAcceleration, 2.0))
        };
        let (all, seldom) = (strength(1), strength(50));
        assert!(all.greatest > 0.55 && all.unsteady_mps2 > 0.1, "{all:?}");
        assert!((seldom.greatest / all.greatest - 1.0).abs() < 0.03, "{seldom:?} {all:?}");
        assert!((seldom.unsteady_mps2 / all.unsteady_mps2 - 1.0).abs() < 0.2, "{seldom:?} {all:?}");
    }

    #[test]
    fn rows_without_roll_or_input_are_counted() {
        let mut log = plain();
        let row = |time_s: f64, roll_rad: f64| LogRow {
            time_s,
            roll_rad,
            steer_rad: 0.01,
            speed_mps: 15.0,
            ..LogRow::ABSENT
        };
        assert_eq!(log.push(&row(0.0, f64::NAN)), Ok(Status::Absent));
        assert_eq!(log.push(&row(0.1, f64::NAN)), Ok(Status::Absent));
        assert_eq!(log.push(&row(0.2, 0.01)), Ok(Status::Straight));
        assert!(log.push(&row(0.2, 0.01)).is_err());
        assert_eq!((log.rows, log.absent_rows), (3, 2));
        let turn = LogRow { lateral_acceleration_mps2: 3.0, ..row(0.3, 0.01) };
        assert_eq!(log.push(&turn), Ok(Status::Turning));
    }
}
