//! Conversion of CAN frames to samples, and detection of missing signals.

use std::io::{self, Write};
use std::time::Duration;

use cg_core::{AlignSettings, Quantity, Sample};
use cg_logs::can::{Decoder, Frame, Sampler};
use cg_logs::log::Signal;
use cg_vehicle::lift::LiftAxle;

use super::pace::too_slow;
use super::presence::Presence;
use super::session::Session;

/// Time between two checks for missing signals, µs.
const LOOK_US: u64 = 100_000;

/// Converts frames to samples for a session.
pub(crate) struct Frames {
    sampler: Sampler,
    presence: Presence,
    received: Vec<Quantity>,
    looked_us: u64,
    /// Whether frames arrive in real time, and not as fast as a log is read.
    live: bool,
}

impl Frames {
    pub(crate) fn new(
        decoder: Decoder,
        (settings, raised): (AlignSettings<f64>, Option<AlignSettings<f64>>),
        mass_is_given: bool,
        live: bool,
    ) -> Self {
        let mapped: Vec<Quantity> = decoder.mapped().collect();
        let presence = Presence::new(&settings, mass_is_given, &mapped);
        let sampler = Sampler::new(decoder, settings).with_raised(raised);
        Self { sampler, presence, received: Vec::new(), looked_us: 0, live }
    }

    /// Begins with the lift axles where they were before a restart.
    pub(crate) fn resume(&mut self, position: LiftAxle) {
        self.sampler.resume(position);
    }

    /// Adds a frame and returns its stream time. `monotonic_us` is the monotonic clock at
    /// reception, if the frame is live.
    pub(crate) fn take<W: Write>(
        &mut self,
        frame: &Frame,
        monotonic_us: Option<u64>,
        session: &mut Session<W>,
    ) -> io::Result<u64> {
        let received = &mut self.received;
        received.clear();
        let instant = self.sampler.push(frame, monotonic_us, |quantity| received.push(quantity));
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        session.at(frame.time_us as f64 * 1e-6, instant)?;
        session.counters.frames += 1;
        for &quantity in &self.received {
            if let Some(step_s) = self.presence.received(quantity, instant.stream_us) {
                session.notice(Signal::from(quantity).name(), &too_slow(step_s))?;
            }
        }
        for (signal, message) in self.sampler.news() {
            session.notice(signal, &message)?;
        }
        session.counters.values_of_other_sources = self.sampler.values_of_other_sources();
        let tally = self.sampler.tally();
        session.counters.values_implausible = tally.implausible_values();
        session.counters.values_degraded = tally.degraded_values();
        session.counters.values_in_error = tally.faulty_values();
        self.pass(session)?;
        Ok(instant.stream_us)
    }

    /// Passes complete samples to the session and performs what is due.
    fn pass<W: Write>(&mut self, session: &mut Session<W>) -> io::Result<()> {
        session.follow_lift_axle(self.sampler.take_lift_axle())?;
        while let Some(sample) = self.sampler.next_sample() {
            self.push(sample, session)?;
        }
        let now_us = self.sampler.now_us();
        if now_us.saturating_sub(self.looked_us) >= LOOK_US {
            self.looked_us = now_us;
            session.seen = self.presence.seen;
            session.tilts = self.presence.tilts();
            self.presence.unheard = self.sampler.unheard();
            session.missing(self.presence.missing(now_us))?;
            for (signal, message) in self.presence.unscaled(now_us) {
                session.notice(signal, message)?;
            }
        }
        session.run_periodic(self.live)
    }

    fn push<W: Write>(&self, sample: Sample<f64>, session: &mut Session<W>) -> io::Result<()> {
        let (sampler, stream_us) = (&self.sampler, sample.time_us);
        session.weighing.scale = sampler.scale(stream_us).or(session.weighing.scale);
        let decoder = sampler.decoder();
        session.preparation.has_tractor_yaw = decoder.has_tractor_yaw();
        session.preparation.has_tractor_acceleration = decoder.has_tractor_acceleration();
        session.weighing.heard_us = sampler.weighed_us(stream_us);
        session.sensors.level(|level| sampler.value(level, stream_us));
        session.push(sample)
    }

    /// Advances the time without a frame.
    pub(crate) fn idle<W: Write>(
        &mut self,
        raw_us: u64,
        monotonic_us: u64,
        session: &mut Session<W>,
    ) -> io::Result<()> {
        let stream_us = self.sampler.idle(raw_us, monotonic_us);
        #[allow(clippy::cast_precision_loss)]
        session.tick(raw_us as f64 * 1e-6, stream_us);
        self.pass(session)
    }

    /// Follows that no frame has come for this time, although they should in real time.
    pub(crate) fn stall<W: Write>(
        &mut self,
        silence: Duration,
        session: &mut Session<W>,
    ) -> io::Result<()> {
        session.stall(silence, |now_us| self.presence.missing(now_us))
    }

    /// Passes on the samples that still wait for other signals, at the end of a log.
    pub(crate) fn flush<W: Write>(&mut self, session: &mut Session<W>) -> io::Result<()> {
        while let Some(sample) = self.sampler.rest() {
            self.push(sample, session)?;
        }
        for (signal, message) in self.sampler.last_news() {
            session.notice(signal, &message)?;
        }
        Ok(())
    }

    /// Identifiers and masks of the frames that a kernel filter must pass.
    pub(crate) fn filters(&self) -> Vec<(u32, bool, u32)> {
        self.sampler.decoder().frames()
    }
}
