//! Samples to events: the estimator, what is known of the load, warnings, and what goes out.

use std::io::{self, Write};

use cg_core::SampleError;
use cg_core::{
    Channel, Design, Estimator, FilteredArx, Maneuver, Prior, Sample, Settings, Status as Driving,
    Warner,
};
use cg_logs::can::Instant;
use cg_logs::estimate::{ManeuverEstimate, Verdict};

use crate::flags;

use super::events::{self, Counters, Event, ManeuverLine, MassSource, Result as Known, Status};
use super::outputs::Outputs;
use super::pace::{Pace, too_slow};
use super::state::Found;

/// Between two writes of the state while nothing happens, stream time.
const SAVE_US: u64 = 60_000_000;
/// Between two writes of the metrics.
const METRICS_US: u64 = 5_000_000;
/// Without a sample for this long there are no signals.
const SILENT_US: u64 = 1_000_000;

/// A weight should have come by then; else the nominal mass is told to be taken.
const WEIGHED_US: u64 = 5_000_000;

/// What is on the way from the signals to the answers.
pub(crate) struct Session<W: Write> {
    estimator: Estimator<f64, FilteredArx<f64>>,
    trailer_mass_kg: Option<f64>,
    mass_source: MassSource,
    /// Stream time since which samples come; `None` once the nominal mass is told or not taken.
    unweighed_us: Option<u64>,
    told_nominal: bool,
    pace: Pace,
    warner: Warner<f64>,
    known: Known,
    /// The last speed; NaN before there is one.
    speed_mps: f64,
    load_since_s: Option<f64>,
    driving: &'static str,
    missing: Vec<&'static str>,
    samples: u64,
    pub(crate) counters: Counters,
    /// Time stamp less stream time, s.
    offset_s: f64,
    now_us: u64,
    sampled_us: u64,
    due: Due,
    status_us: Option<u64>,
    pub(crate) outputs: Outputs<W>,
}

/// When things are done next, stream time.
#[derive(Default)]
#[allow(clippy::struct_field_names, reason = "units stand in names")]
struct Due {
    status_us: u64,
    save_us: u64,
    metrics_us: u64,
    transmit_us: u64,
}

impl<W: Write> Session<W> {
    pub(crate) fn new(
        design: &Design<f64>,
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
            estimator: Estimator::new(*design, Settings::truck(), Prior::standard()),
            trailer_mass_kg,
            mass_source,
            unweighed_us: None,
            told_nominal: false,
            pace: Pace::default(),
            warner,
            load_since_s: None,
            driving: "waiting",
            missing: Vec::new(),
            samples: 0,
            counters: Counters::default(),
            offset_s: 0.0,
            now_us: 0,
            sampled_us: 0,
            due: Due::default(),
            status_us,
            outputs,
        }
    }

    /// Takes up what was learnt before a restart, if there is something.
    pub(crate) fn restore(&mut self) -> io::Result<bool> {
        match self.outputs.load() {
            Some(Ok(Found::State(state))) => {
                let design = *self.estimator.design();
                let (settings, prior) = (Settings::truck(), Prior::standard());
                let restored = Estimator::restored(design, settings, prior, &state.memory);
                let Some(estimator) = restored else { return Ok(false) };
                self.estimator = estimator;
                self.load_since_s = state.load_since_s;
                // The nominal mass itself says that nobody has weighed the load.
                let nominal_kg = self.estimator.design().nominal_trailer_mass_kg;
                let weighed = (state.memory.trailer_mass_kg - nominal_kg).abs() > 1e-6 * nominal_kg;
                if weighed && self.mass_source == MassSource::Nominal {
                    self.mass_source = MassSource::Kept;
                }
                self.update(state.memory.load_mass_kg.unwrap_or(state.memory.trailer_mass_kg));
                Ok(true)
            }
            Some(Ok(Found::PutAside(path, reason))) => {
                let message = format!("put aside as {}: {reason}", path.display());
                self.notice("state", message).map(|()| false)
            }
            Some(Err(error)) => {
                self.notice("state", format!("cannot be read: {error}")).map(|()| false)
            }
            Some(Ok(Found::Nothing)) | None => Ok(false),
        }
    }

    /// The time of a frame or row: its time stamp and stream time.
    pub(crate) fn tick(&mut self, stamp_s: f64, stream_us: u64) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let stream_s = stream_us as f64 * 1e-6;
        (self.offset_s, self.now_us) = (stamp_s - stream_s, stream_us);
    }

    /// The same, and whether the time stamps have jumped.
    pub(crate) fn at(&mut self, stamp_us: u64, instant: Instant) -> io::Result<()> {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        self.tick(stamp_us as f64 * 1e-6, instant.stream_us);
        if instant.jump_us == 0 {
            return Ok(());
        }
        #[allow(clippy::cast_precision_loss)]
        let jump_s = instant.jump_us as f64 * 1e-6;
        self.notice("clock", format!("the time stamps have jumped by {jump_s:.3} s"))
    }

    pub(crate) fn say(&mut self, event: Event<'_>) -> io::Result<()> {
        let time_s = self.time_s(self.now_us);
        events::write(&mut self.outputs.lines, time_s, event)
    }

    pub(crate) fn notice(&mut self, subject: &'static str, message: String) -> io::Result<()> {
        self.say(Event::Notice { subject, message: flags::told(&message) })
    }

    #[allow(clippy::cast_precision_loss)]
    fn time_s(&self, stream_us: u64) -> f64 {
        self.offset_s + stream_us as f64 * 1e-6
    }

    /// Takes in a sample. One that has no other near it says nothing of a motion and is left out.
    pub(crate) fn push(&mut self, mut sample: Sample<f64>) -> io::Result<()> {
        self.samples += 1;
        self.sampled_us = sample.time_us;
        self.weigh(&mut sample)?;
        self.warn(&sample)?;
        let (samples, slow_s) = self.pace.push(sample);
        if let Some(step_s) = slow_s {
            let signal = if sample.roll_rad.is_nan() { "tilt" } else { "roll" };
            self.notice(signal, too_slow(step_s))?;
        }
        samples.into_iter().flatten().try_for_each(|sample| self.estimate(&sample))
    }

    fn estimate(&mut self, sample: &Sample<f64>) -> io::Result<()> {
        let step = match self.estimator.push(sample) {
            Ok(step) => step,
            // The clock and the aligner let no time go back; should one, it is passed over.
            Err(SampleError::TimeOrder { .. } | _) => return Ok(()),
        };
        if let Some(maneuver) = step.closed {
            self.maneuver(&maneuver)?;
        }
        self.drive(match step.status {
            Driving::Absent => "no signals",
            Driving::Straight => "straight",
            Driving::Turning => "turning",
        })
    }

    /// Gives the sample the mass that counts, and tells where it comes from.
    fn weigh(&mut self, sample: &mut Sample<f64>) -> io::Result<()> {
        if let Some(mass_kg) = self.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
        } else if sample.trailer_mass_kg.is_nan() {
            self.unweighed_us.get_or_insert(sample.time_us);
        } else if self.mass_source != MassSource::Signal {
            self.mass_source = MassSource::Signal;
            if self.told_nominal {
                let message = format!(
                    "the trailer weighs {:.0} kg by its signals: from now on that counts",
                    sample.trailer_mass_kg
                );
                return self.notice("mass", message);
            }
        }
        Ok(())
    }

    /// Tells once that the vehicle file's mass is taken for that of the trailer.
    fn tell_nominal(&mut self) -> io::Result<()> {
        let nominal = self.mass_source == MassSource::Nominal && self.unweighed_us.is_some();
        if !nominal || std::mem::replace(&mut self.told_nominal, true) {
            return Ok(());
        }
        let nominal_kg = self.estimator.design().nominal_trailer_mass_kg;
        let message = format!(
            "no signal tells the trailer's mass: {nominal_kg:.0} kg of the vehicle file are taken; \
             mass and height are confounded, so give --trailer-mass-kg or a weight"
        );
        self.notice("mass", message)
    }

    fn warn(&mut self, sample: &Sample<f64>) -> io::Result<()> {
        let lateral_mps2 = if sample.lateral_acceleration_mps2.is_nan() {
            sample.yaw_rate_radps * sample.speed_mps
        } else {
            sample.lateral_acceleration_mps2
        };
        let gravity_mps2 = self.estimator.design().gravity_mps2;
        // Without a speed the last one counts.
        if sample.speed_mps.is_finite() {
            self.speed_mps = sample.speed_mps;
            self.known.at_speed(self.estimator.design(), self.speed_mps);
        }
        let threshold_g = self.known.threshold_g;
        let level = self.warner.push(sample.time_us, lateral_mps2, threshold_g, gravity_mps2);
        let Some(level) = level else { return Ok(()) };
        let margin_g = self.known.margin_g(self.lateral_g());
        self.say(Event::Warning { level, margin_g })
    }

    fn lateral_g(&self) -> Option<f64> {
        Some(self.warner.lateral_mps2()? / self.estimator.design().gravity_mps2)
    }

    fn drive(&mut self, state: &'static str) -> io::Result<()> {
        if state == self.driving {
            return Ok(());
        }
        self.driving = state;
        let missing = self.missing.clone();
        self.say(Event::State { state, missing })
    }

    /// What is missing now that was there before.
    pub(crate) fn missing(&mut self, missing: Vec<&'static str>) -> io::Result<()> {
        if missing == self.missing {
            return Ok(());
        }
        self.missing.clone_from(&missing);
        self.say(Event::State { state: self.driving, missing })
    }

    fn maneuver(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        self.tell_nominal()?;
        let since_us = self.estimator.load_since_us();
        let since_s = since_us.map(|us| self.time_s(us));
        if since_us == Some(maneuver.end_us) {
            self.load_since_s = since_s;
            let message = "the heights so far were of another load and are forgotten";
            self.say(Event::LoadChanged { message })?;
        }
        let before = self.known.status;
        self.update(maneuver.trailer_mass_kg);
        let of = |channel: Channel| {
            ManeuverEstimate::new(maneuver, &maneuver.outcomes[channel.index()], self.offset_s)
        };
        let line = ManeuverLine {
            speed_mps: maneuver.speed_mps,
            steer: of(Channel::Steer),
            lateral_acceleration: of(Channel::LateralAcceleration),
            result: self.known.clone(),
        };
        self.say(Event::Maneuver(Box::new(line)))?;
        self.compare(before)?;
        self.save()
    }

    /// Looks up what the estimator knows.
    fn update(&mut self, trailer_mass_kg: f64) {
        let heights = Channel::ALL.map(|channel| self.estimator.height(channel));
        let channel = match heights {
            [Some(_), None] => Some(Channel::Steer),
            [None, Some(_)] => Some(Channel::LateralAcceleration),
            _ => None,
        };
        let mass = (trailer_mass_kg, self.mass_source);
        let combined = self.estimator.combined();
        self.known = Known::new(combined, channel, mass);
        self.known.at_speed(self.estimator.design(), self.speed_mps);
    }

    /// Tells that the channels begin to contradict each other.
    fn compare(&mut self, before: Verdict) -> io::Result<()> {
        if self.known.status != Verdict::Inconsistent || before == Verdict::Inconsistent {
            return Ok(());
        }
        let told = Channel::ALL.map(|channel| match self.estimator.height(channel) {
            Some(height) => {
                format!("{channel} says {:.2} ± {:.2} m", height.height_m.value, height.height_m.sd)
            }
            None => format!("{channel} has no possible height"),
        });
        self.notice(
            "channels",
            format!(
                "inconsistent, so there is no height: {}; a sensor is at fault",
                told.join(", ")
            ),
        )
    }

    fn status(&self) -> Status {
        let lateral_g = self.lateral_g();
        let trailer_mass_kg = self.estimator.memory().trailer_mass_kg;
        Status {
            state: self.driving,
            missing: self.missing.clone(),
            result: Known {
                trailer_mass_kg: self.trailer_mass_kg.unwrap_or(trailer_mass_kg),
                trailer_mass_source: self.mass_source,
                ..self.known.clone()
            },
            load_since_s: self.load_since_s,
            lateral_acceleration_g: lateral_g,
            margin_g: self.known.margin_g(lateral_g),
            warning_level: self.warner.level(),
            samples: self.samples,
            counters: self.counters,
        }
    }

    /// What is due by now: silence noticed, status, metrics, frames, the state file.
    pub(crate) fn due(&mut self, live: bool) -> io::Result<()> {
        let now_us = self.now_us;
        if self.unweighed_us.is_some_and(|since| now_us.saturating_sub(since) >= WEIGHED_US) {
            self.tell_nominal()?;
        }
        if self.driving != "waiting" && now_us.saturating_sub(self.sampled_us) > SILENT_US {
            // The hole ends the maneuver in any case; whoever parks now has its height at once.
            if let Some(maneuver) = self.estimator.finish() {
                self.maneuver(&maneuver)?;
            }
            self.drive("no signals")?;
        }
        if let Some(cycle_us) = self.status_us
            && now_us >= self.due.status_us
        {
            self.due.status_us = now_us + cycle_us;
            let status = self.status();
            self.say(Event::Status(Box::new(status)))?;
        }
        if self.outputs.transmits() && now_us >= self.due.transmit_us {
            self.due.transmit_us = now_us + super::transmit::CYCLE_US;
            let status = self.status();
            self.outputs.transmit(&status);
        }
        // A replay at log speed writes them at its end.
        if live && now_us >= self.due.metrics_us {
            self.due.metrics_us = now_us + METRICS_US;
            self.measure()?;
        }
        if live && now_us >= self.due.save_us {
            self.save()?;
        }
        Ok(())
    }

    fn measure(&mut self) -> io::Result<()> {
        let status = self.status();
        match self.outputs.measure(&status) {
            Some(message) => self.notice("metrics", message),
            None => Ok(()),
        }
    }

    fn save(&mut self) -> io::Result<()> {
        self.due.save_us = self.now_us + SAVE_US;
        let memory = self.estimator.memory();
        let (saved_s, since_s) = (self.time_s(self.now_us), self.load_since_s);
        match self.outputs.save(&memory, saved_s, since_s) {
            Some(message) => self.notice("state", message),
            None => Ok(()),
        }
    }

    /// Ends the last maneuver, keeps everything, says so.
    pub(crate) fn stop(&mut self, reason: &str) -> io::Result<()> {
        if let Some(maneuver) = self.estimator.finish() {
            self.maneuver(&maneuver)?;
        }
        self.tell_nominal()?;
        self.save()?;
        self.measure()?;
        if self.status_us.is_some() {
            let status = self.status();
            self.say(Event::Status(Box::new(status)))?;
        }
        let Counters { frames, frames_lost, .. } = self.counters;
        let latency_ms = self.outputs.latency.summary();
        self.say(Event::Stop { reason, frames, frames_lost, latency_ms })
    }

    /// Whether any maneuver has given a height.
    pub(crate) fn has_height(&self) -> bool {
        self.known.height_m.is_some()
    }
}
