//! Frames to samples: decoded, aligned, with a time that never jumps.

use std::io::{self, Write};

use cg_core::align::Taken;
use cg_core::{AlignSettings, Aligner};
use cg_vehicle::can::{Decoder, Frame};

use super::clock::Clock;
use super::session::{Session, stale};

/// Between two looks for missing signals, µs.
const LOOK_US: u64 = 100_000;

/// The way of a frame.
pub(crate) struct Frames {
    decoder: Decoder,
    aligner: Aligner<f64>,
    clock: Clock,
    looked_us: u64,
    now_us: u64,
    /// Whether time passes while frames come in, or as fast as a log is read.
    live: bool,
}

impl Frames {
    pub(crate) fn new(decoder: Decoder, settings: AlignSettings<f64>, live: bool) -> Self {
        let aligner = Aligner::new(settings);
        Self { decoder, aligner, clock: Clock::default(), looked_us: 0, now_us: 0, live }
    }

    /// Takes in a frame that was received about now by the monotonic clock, if it is live; gives its
    /// stream time.
    pub(crate) fn take<W: Write>(
        &mut self,
        frame: &Frame,
        monotonic_us: Option<u64>,
        session: &mut Session<W>,
    ) -> io::Result<u64> {
        let instant = self.clock.stream(frame.time_us, monotonic_us);
        let now_us = instant.stream_us;
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        session.tick(frame.time_us as f64 * 1e-6, now_us);
        if instant.jump_us != 0 {
            #[allow(clippy::cast_precision_loss)]
            let jump_s = instant.jump_us as f64 * 1e-6;
            session.notice("clock", format!("the time stamps have jumped by {jump_s:.3} s"))?;
        }
        session.counters.frames += 1;
        let aligner = &mut self.aligner;
        self.decoder.decode(frame, |quantity, device, value| {
            if aligner.push(quantity, device, now_us, value) == Taken::OtherSource {
                session.counters.values_of_other_sources += 1;
            }
        });
        self.now_us = now_us;
        self.pass(session)?;
        Ok(now_us)
    }

    /// Hands on the samples that are complete, and does what is due.
    fn pass<W: Write>(&mut self, session: &mut Session<W>) -> io::Result<()> {
        while let Some(sample) = self.aligner.next(self.now_us) {
            session.push(sample)?;
        }
        if self.now_us.saturating_sub(self.looked_us) >= LOOK_US {
            self.looked_us = self.now_us;
            let (aligner, now_us) = (&self.aligner, self.now_us);
            session.missing(stale(|quantity| aligner.is_stale(quantity, now_us)))?;
        }
        session.due(self.live)
    }

    /// Lets time pass without a frame.
    pub(crate) fn idle<W: Write>(
        &mut self,
        raw_us: u64,
        monotonic_us: u64,
        session: &mut Session<W>,
    ) -> io::Result<()> {
        self.now_us = self.clock.stream(raw_us, Some(monotonic_us)).stream_us;
        #[allow(clippy::cast_precision_loss)]
        session.tick(raw_us as f64 * 1e-6, self.now_us);
        self.pass(session)
    }

    /// Hands on the samples that still wait for other signals, at the end of a log.
    pub(crate) fn flush<W: Write>(&mut self, session: &mut Session<W>) -> io::Result<()> {
        while let Some(sample) = self.aligner.next(u64::MAX) {
            session.push(sample)?;
        }
        Ok(())
    }

    /// What a kernel filter must let pass.
    pub(crate) fn wanted(&self) -> Vec<(u32, bool, u32)> {
        self.decoder.frames()
    }
}
