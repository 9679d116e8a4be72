//! Processing of samples: estimation, source of the mass, rollover warnings, and outputs.

mod driving;
mod learn;
mod lift;
mod loads;
mod mass;
mod remarks;
mod stall;
mod warning;

use std::collections::BTreeSet;
use std::io::{self, Write};

use cg_core::{AlignSettings, Design, Maneuver, Quantity, Sample, SampleError, Warner};
use cg_logs::can::Instant;
use cg_logs::estimate::{
    Ended, Engine, EstimateOptions, Leaning, LeftOut, Lift, Rated, RoadPart, SensorCheck,
    SinceStop, StrongTurns, Tilts, Unheard, Verdict, Windward, add_force,
};
use cg_logs::log::Signal;
use cg_vehicle::preparation::Preparation;

use crate::flags;

use super::channels;
use super::doubted::DoubtedMass;
use super::events::{Counters, Event, ManeuverLine, MassSource, Result as Known, Status};
use super::learning::Learning;
use super::outputs::Outputs;
use super::pace::{Pace, pacing, too_slow};
use super::request::SpeedRequest;
use super::weighing::Weighing;

/// Time between two writes of the state without an event, in stream time, µs.
const SAVE_US: u64 = 60_000_000;
/// Time between two writes of the metrics, µs.
const METRICS_US: u64 = 5_000_000;
/// Time without a sample after which the state is "no signals", µs.
const SILENT_US: u64 = 1_000_000;

/// Time within which a mass should arrive, µs. After it, the use of the nominal mass is reported.
const WEIGHED_US: u64 = 5_000_000;

/// The processing of samples of one run.
pub(crate) struct Session<W: Write> {
    estimator: Engine,
    options: EstimateOptions,
    /// How the values of sensors in a row become those of a sample.
    pub(crate) settings: AlignSettings<f64>,
    pub(crate) lift: Lift,
    trailer_mass_kg: Option<f64>,
    pub(crate) weighing: Weighing,
    mass_source: MassSource,
    /// Stream time of the first sample; `None` after the nominal mass is reported or not needed.
    unweighed_us: Option<u64>,
    nominal_mass_reported: bool,
    /// The learning from empty driving.
    learning: Option<Learning>,
    /// Number of learned trips in the design.
    pub(crate) trips_in_use: (usize, Option<f64>),
    pace: Pace,
    warner: Warner<f64>,
    pub(crate) request: Option<SpeedRequest>,
    known: Known,
    /// Last speed, m/s; NaN before the first one.
    speed_mps: f64,
    load_since_s: Option<f64>,
    /// The roll angle of this load in straight driving.
    leaning: Leaning,
    strong: StrongTurns,
    left_out: LeftOut,
    unheard: Unheard,
    stop: SinceStop,
    /// Time since which the trailer has another mass than the load of the height, µs.
    other_mass_us: Option<u64>,
    /// The mass in the last turn, kg; NaN before the first one.
    pub(crate) turn_kg: f64,
    /// The speed in the last turn with a height, m/s, and the mass, kg; NaN before the first one.
    height_mps: f64,
    height_kg: f64,
    /// What came or went since, kg.
    part_kg: f64,
    /// What turns of the load before a restart leave uncertain ([`SavedLoad`](super::state::SavedLoad)), m.
    kept_beside_m: f64,
    /// The mass of a load whose height is not shown because the trailer has another mass, kg.
    hidden_kg: Option<f64>,
    doubted: DoubtedMass,
    /// The last mass by a signal, kg.
    weighed_kg: Option<f64>,
    /// The subjects that were reported of this load.
    told: BTreeSet<&'static str>,
    pub(crate) sensors: SensorCheck,
    /// What was wrong with a signal before a restart, until enough driving is known.
    wrong_before: Option<String>,
    roads: RoadPart,
    driving: &'static str,
    /// Time of the last sample with a roll angle and an input, µs.
    heard_us: u64,
    missing: Vec<&'static str>,
    /// The quantities that have arrived, in the order of [`Quantity::ALL`].
    pub(crate) seen: [bool; Quantity::COUNT],
    /// Which roll angles come from inclinometers.
    pub(crate) tilts: Tilts,
    /// The noise of a roll rate whose integral is the roll angle.
    pub(crate) rated: Rated,
    /// What a side wind makes of the ratios.
    pub(crate) windward: Windward,
    pub(crate) preparation: Preparation,
    samples: u64,
    pub(crate) counters: Counters,
    /// Time stamp minus stream time, s.
    offset_s: f64,
    now_us: u64,
    sampled_us: u64,
    /// Whether nothing comes, although it should in real time.
    stalls: bool,
    next: NextTimes,
    status_us: Option<u64>,
    pub(crate) outputs: Outputs<W>,
}

/// Stream times of the next periodic actions.
#[derive(Default)]
#[allow(clippy::struct_field_names, reason = "names contain units")]
struct NextTimes {
    status_us: u64,
    save_us: u64,
    metrics_us: u64,
    transmit_us: u64,
}

impl<W: Write> Session<W> {
    pub(crate) fn new(
        (design, options): (&Design<f64>, EstimateOptions),
        warner: Warner<f64>,
        trailer_mass_kg: Option<f64>,
        status_s: f64,
        outputs: Outputs<W>,
    ) -> Self {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
        let status_us = (status_s > 0.0).then_some((status_s * 1e6) as u64);
        let mass_kg = trailer_mass_kg.unwrap_or(design.nominal_trailer_mass_kg);
        let mass_source =
            if trailer_mass_kg.is_some() { MassSource::Given } else { MassSource::Nominal };
        Self {
            known: Known::new(None, None, (mass_kg, mass_source)),
            speed_mps: f64::NAN,
            estimator: Engine::new(design, &options),
            options,
            settings: AlignSettings::NONE,
            lift: Lift::default(),
            trailer_mass_kg,
            weighing: Weighing::EXACT,
            mass_source,
            unweighed_us: None,
            learning: None,
            trips_in_use: (0, None),
            nominal_mass_reported: false,
            pace: Pace::default(),
            warner,
            request: None,
            load_since_s: None,
            leaning: Leaning::default(),
            strong: StrongTurns::default(),
            left_out: LeftOut::default(),
            unheard: Unheard::default(),
            stop: SinceStop::default(),
            other_mass_us: None,
            turn_kg: f64::NAN,
            height_mps: f64::NAN,
            height_kg: f64::NAN,
            part_kg: 0.0,
            kept_beside_m: 0.0,
            hidden_kg: None,
            doubted: DoubtedMass::default(),
            weighed_kg: None,
            told: BTreeSet::new(),
            sensors: SensorCheck::default(),
            wrong_before: None,
            roads: RoadPart::default(),
            driving: "waiting",
            heard_us: 0,
            missing: Vec::new(),
            seen: [false; Quantity::COUNT],
            tilts: Tilts::default(),
            rated: Rated::default(),
            windward: Windward::default(),
            preparation: Preparation::at(design.nominal_speed_mps),
            samples: 0,
            counters: Counters::default(),
            offset_s: 0.0,
            now_us: 0,
            sampled_us: 0,
            stalls: false,
            next: NextTimes::default(),
            status_us,
            outputs,
        }
    }

    /// Sets the time stamp and the stream time of a frame or row.
    pub(crate) fn tick(&mut self, stamp_s: f64, stream_us: u64) {
        self.end_stall();
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let stream_s = stream_us as f64 * 1e-6;
        (self.offset_s, self.now_us) = (stamp_s - stream_s, stream_us);
    }

    /// Sets the time from a time stamp and reports a jump of the time stamps.
    pub(crate) fn at(&mut self, stamp_s: f64, instant: Instant) -> io::Result<()> {
        self.tick(stamp_s, instant.stream_us);
        if instant.jump_us == 0 {
            return Ok(());
        }
        #[allow(clippy::cast_precision_loss)]
        let jump_s = instant.jump_us as f64 * 1e-6;
        self.notice("clock", &format!("the time stamps jumped by {jump_s:.3} s"))
    }

    pub(crate) fn write_event(&mut self, event: &Event<'_>) -> io::Result<()> {
        self.outputs.write(self.time_s(self.now_us), event)
    }

    pub(crate) fn notice(&mut self, subject: &'static str, message: &str) -> io::Result<()> {
        self.write_event(&Event::Notice { subject, message: flags::with_flags(message) })
    }

    fn time_s(&self, stream_us: u64) -> f64 {
        self.offset_s + Self::stream_s(stream_us)
    }

    /// Stream time, which no clock sets, s.
    #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
    fn stream_s(stream_us: u64) -> f64 {
        stream_us as f64 * 1e-6
    }

    /// Processes a sample. A sample without another one close to it is not part of a motion and is
    /// not used.
    pub(crate) fn push(&mut self, mut sample: Sample<f64>) -> io::Result<()> {
        self.samples += 1;
        self.sampled_us = sample.time_us;
        let gravity_mps2 = self.estimator.design().gravity_mps2;
        add_force(&mut sample, gravity_mps2);
        let Sample { yaw_rate_radps, lateral_acceleration_mps2, .. } = sample;
        if let Some(of) = &self.options.prepares {
            self.preparation.prepare(&mut sample, of, self.options.may_twist(), gravity_mps2);
        }
        if self.missing.contains(&Signal::Speed.name()) {
            sample.steer_rad = f64::NAN; // means nothing without a speed
        }
        self.weigh(&mut sample)?;
        // The tractor turns before its trailer, so what it measures warns earlier.
        self.warn(&Sample { yaw_rate_radps, lateral_acceleration_mps2, ..sample })?;
        let (samples, slow_s) = self.pace.push(sample);
        if let Some(step_s) = slow_s {
            self.notice(pacing(&sample), &too_slow(step_s))?;
        }
        samples.into_iter().flatten().try_for_each(|sample| self.estimate(&sample))
    }

    fn estimate(&mut self, sample: &Sample<f64>) -> io::Result<()> {
        if let Some(page) = &mut self.outputs.page {
            page.remember(sample, self.speed_mps, self.estimator.design().gravity_mps2);
        }
        let step = match self.estimator.push(sample) {
            Ok(step) => step,
            // Clock and aligner prevent decreasing times. If there is one, the sample is not used.
            Err(SampleError::TimeOrder { .. } | _) => return Ok(()),
        };
        let gravity_mps2 = self.estimator.design().gravity_mps2;
        self.leaning.push(sample, step.status, gravity_mps2);
        self.strong.push(sample, self.estimator.design());
        if self.options.side_wind.is_some() {
            self.windward.push(sample, step.status, self.estimator.design());
        }
        self.stop.push(sample, &self.estimator);
        if let Some(maneuver) = step.closed {
            self.maneuver(&maneuver)?;
        }
        self.follow_driving(sample.time_us, step.status)
    }

    fn maneuver(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        self.report_nominal_mass()?;
        self.lift.turn(Self::stream_s(maneuver.end_us));
        let engine = (&mut self.estimator, &self.options);
        let is_of_another_load = self.stop.close(maneuver, engine);
        self.sensors.close(is_of_another_load);
        self.unheard.push(maneuver);
        self.strong.close(maneuver, is_of_another_load);
        self.rated.close(maneuver, is_of_another_load);
        self.windward.close(maneuver, is_of_another_load);
        self.left_out.close(maneuver, &self.estimator, is_of_another_load);
        if is_of_another_load {
            self.load_since_s = Some(self.time_s(maneuver.end_us));
            self.leaning = Leaning::default();
            (self.hidden_kg, self.kept_beside_m) = (None, 0.0);
            self.roads = RoadPart::default();
            self.told.clear();
            let message = "the heights so far belong to another load and were discarded";
            self.write_event(&Event::LoadChanged { message })?;
            self.doubt_held_mass(maneuver)?;
        }
        self.turn_kg = maneuver.trailer_mass_kg;
        if maneuver.outcomes.iter().any(|outcome| outcome.height_m.is_ok()) {
            (self.height_mps, self.height_kg) = (maneuver.speed_mps, maneuver.trailer_mass_kg);
            self.part_kg = 0.0;
        }
        self.roads.push(maneuver);
        self.doubt_mass(maneuver)?;
        let before = self.known.status;
        self.update(maneuver.trailer_mass_kg);
        let result = Known { lift_axle: self.lift.of_truck(), ..self.known.clone() };
        let line = ManeuverLine::new(maneuver, result, self.offset_s);
        self.write_event(&Event::Maneuver(Box::new(line)))?;
        if let Some(page) = &self.outputs.page {
            let times_s = [self.time_s(self.now_us), self.offset_s];
            page.turn(self.estimator.design(), maneuver, &self.known, times_s);
        }
        let is_weighed =
            self.trailer_mass_kg.is_none() && self.weighing.weighed.covers(maneuver.start_us);
        let time_s = self.time_s(maneuver.end_us);
        let ended = Ended { time_s, is_weighed, gust: self.windward.last() };
        self.learn(Some((maneuver, ended)))?;
        self.compare(before)?;
        self.remark(maneuver)?;
        self.save()
    }

    fn update(&mut self, trailer_mass_kg: f64) {
        if let Some(mass_kg) = self.hidden_mass_kg() {
            self.known = Known::new(None, None, (mass_kg, self.mass_source));
            return;
        }
        let channel = channels::alone(&self.estimator);
        let mass = (trailer_mass_kg, self.mass_source);
        let combined = self.combined();
        self.known = self.weighing.of(self.estimator.design(), Known::new(combined, channel, mass));
        self.known.road_share = self.road_share();
        self.known.add_sd(self.host_sd_m());
        let beside_m = self.leaning.beside_m(self.options.lean, self.known.trailer_mass_kg);
        self.known.beside_m = beside_m.unwrap_or(0.0);
        self.known.at_speed(self.estimator.design(), self.speed_mps);
    }

    /// Reports the beginning of a contradiction between the channels.
    fn compare(&mut self, before: Verdict) -> io::Result<()> {
        if self.known.status != Verdict::Inconsistent || before == Verdict::Inconsistent {
            return Ok(());
        }
        let message = self.wrong_signal().unwrap_or_else(|| self.contradiction());
        self.notice("channels", &message)
    }

    /// Names of the signals that have arrived and are not missing.
    fn present(&self) -> Vec<&'static str> {
        let seen = Quantity::ALL.into_iter().filter(|quantity| self.seen[quantity.index()]);
        let names = seen.map(|quantity| Signal::from(quantity).name());
        names.filter(|name| !self.missing.contains(name)).collect()
    }

    fn status(&self) -> Status {
        let lateral_g = self.lateral_g();
        Status {
            state: self.driving,
            present: self.present(),
            missing: self.missing.clone(),
            result: self.weighing.of(
                self.estimator.design(),
                Known {
                    trailer_mass_kg: self.present_mass_kg(),
                    trailer_mass_source: self.mass_source,
                    lift_axle: self.lift.of_truck(),
                    ..self.known.clone()
                },
            ),
            load_since_s: self.load_since_s,
            height_restored: self.has_height() && self.height_mps.is_nan(),
            lateral_acceleration_g: lateral_g,
            margin_g: self.known.margin_g(lateral_g),
            warning_level: self.warner.level(),
            requests_speed: self.request.is_some(),
            requested_speed_mps: self.request.and_then(|request| request.speed_mps),
            samples: self.samples,
            counters: self.counters,
        }
    }

    /// Performs what is due: detection of silence, status, metrics, frames, state file.
    pub(crate) fn run_periodic(&mut self, live: bool) -> io::Result<()> {
        let now_us = self.now_us;
        if self.unweighed_us.is_some_and(|since| now_us.saturating_sub(since) >= WEIGHED_US) {
            self.report_nominal_mass()?;
        }
        let is_silent = now_us.saturating_sub(self.sampled_us) > SILENT_US;
        if is_silent {
            self.follow(now_us, f64::NAN)?;
        }
        if self.driving != "waiting" && is_silent {
            // The gap would end the maneuver anyway. Ending it now gives a parking truck its height
            // at once.
            if let Some(maneuver) = self.estimator.finish() {
                self.maneuver(&maneuver)?;
            }
            self.drive("no signals")?;
        }
        self.report(now_us, live)?;
        if live && now_us >= self.next.save_us {
            self.save()?;
        }
        Ok(())
    }

    /// Writes the status, the metrics and the frames that are due.
    fn report(&mut self, now_us: u64, live: bool) -> io::Result<()> {
        if let Some(cycle_us) = self.status_us
            && now_us >= self.next.status_us
        {
            self.next.status_us = now_us + cycle_us;
            self.write_event(&Event::Status(Box::new(self.status())))?;
        }
        if self.outputs.transmits() && now_us >= self.next.transmit_us {
            self.next.transmit_us = now_us + super::transmit::CYCLE_US;
            self.outputs.transmit(&self.status());
        }
        if self.outputs.page.as_mut().is_some_and(|page| page.is_due(now_us)) {
            self.show();
        }
        // A replay as fast as possible writes them only at its end.
        if live && now_us >= self.next.metrics_us {
            self.next.metrics_us = now_us + METRICS_US;
            self.measure()?;
        }
        Ok(())
    }

    /// Shows the present values on the page.
    fn show(&self) {
        if let Some(page) = &self.outputs.page {
            page.snapshot(self.time_s(self.now_us), self.status());
        }
    }

    fn measure(&mut self) -> io::Result<()> {
        let status = self.status();
        match self.outputs.measure(&status) {
            Some(message) => self.notice("metrics", &message),
            None => Ok(()),
        }
    }

    /// Ends the last maneuver, writes all outputs, and reports the end.
    pub(crate) fn stop(&mut self, reason: &str) -> io::Result<()> {
        if let Some(maneuver) = self.estimator.finish() {
            self.maneuver(&maneuver)?;
        }
        self.report_nominal_mass()?;
        self.learn(None)?;
        self.save()?;
        self.measure()?;
        self.show();
        if self.status_us.is_some() {
            self.write_event(&Event::Status(Box::new(self.status())))?;
        }
        let Counters { frames, frames_lost, .. } = self.counters;
        let latency_ms = self.outputs.latency.summary();
        self.write_event(&Event::Stop { reason, frames, frames_lost, latency_ms })
    }

    /// Whether any maneuver has given a height.
    pub(crate) fn has_height(&self) -> bool {
        self.known.height_m.is_some()
    }
}

#[cfg(test)]
mod tests;
