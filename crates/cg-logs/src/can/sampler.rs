//! Frames to samples: decoded, aligned, with a time that never jumps.

use cg_core::signal::align::Taken;
use cg_core::{AlignSettings, Aligner, Quantity, Sample};

use super::clock::{Clock, Instant};
use super::decoder::Decoder;
use super::frame::Frame;
use super::tally::Tally;

/// The way of a frame, live and in a log.
#[derive(Clone, Debug)]
pub struct Sampler {
    decoder: Decoder,
    settings: AlignSettings<f64>,
    aligner: Aligner<f64>,
    clock: Clock,
    now_us: u64,
    tally: Tally,
    values_of_other_sources: u64,
}

impl Sampler {
    /// Before the first frame.
    pub fn new(decoder: Decoder, settings: AlignSettings<f64>) -> Self {
        Self {
            decoder,
            settings,
            aligner: Aligner::new(settings),
            clock: Clock::default(),
            now_us: 0,
            tally: Tally::default(),
            values_of_other_sources: 0,
        }
    }

    /// Takes in a frame that was received about now by the monotonic clock, if it is live; its
    /// stream time. `heard` gets each value that counts. Then ask for [samples](Self::next_sample).
    pub fn push(
        &mut self,
        frame: &Frame,
        monotonic_us: Option<u64>,
        mut heard: impl FnMut(Quantity),
    ) -> Instant {
        let instant = self.clock.stream(frame.time_us, monotonic_us);
        let now_us = instant.stream_us;
        self.now_us = now_us;
        let Self { decoder, aligner, tally, values_of_other_sources, .. } = self;
        let slope = decoder.decode(frame, |quantity, device, value| {
            match aligner.push(quantity, device, now_us, value) {
                Taken::Yes => heard(quantity),
                Taken::OtherSource => *values_of_other_sources += 1,
                Taken::Implausible => tally.implausible(quantity, value, None),
                Taken::OutOfOrder => {}
            }
        });
        if let Some(slope) = slope {
            tally.slope(slope, decoder.compensation());
        }
        instant
    }

    /// Takes in a value that was measured elsewhere than in a frame.
    pub fn push_value(&mut self, quantity: Quantity, time_us: u64, value: f64) -> Instant {
        let instant = self.clock.stream(time_us, None);
        self.now_us = instant.stream_us;
        if self.aligner.push(quantity, (0, 0), self.now_us, value) == Taken::Implausible {
            self.tally.implausible(quantity, value, None);
        }
        instant
    }

    /// What a quantity was at the time of a sample just taken.
    pub fn value(&self, quantity: Quantity, stream_us: u64) -> f64 {
        self.aligner.value(quantity, stream_us)
    }

    /// Lets time pass without a frame; the stream time.
    pub fn idle(&mut self, raw_us: u64, monotonic_us: u64) -> u64 {
        self.now_us = self.clock.stream(raw_us, Some(monotonic_us)).stream_us;
        self.now_us
    }

    /// The next sample that is complete, its time being stream time.
    pub fn next_sample(&mut self) -> Option<Sample<f64>> {
        self.aligner.next(self.now_us)
    }

    /// The next sample that still waits for other signals, at the end of a log.
    pub fn rest(&mut self) -> Option<Sample<f64>> {
        self.aligner.next(u64::MAX)
    }

    /// Values of a device that is not listened to, because another one sends the same.
    pub fn values_of_other_sources(&self) -> u64 {
        self.values_of_other_sources
    }

    /// Whether a quantity is missing that was there before.
    pub fn is_stale(&self, quantity: Quantity) -> bool {
        self.aligner.is_stale(quantity, self.now_us)
    }

    /// Stream time of the last frame.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// How frames are understood.
    pub fn decoder(&self) -> &Decoder {
        &self.decoder
    }

    /// What is wrong with values.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// What is wrong with values that was not told yet: the signal and a sentence.
    pub fn news(&mut self) -> Vec<(&'static str, String)> {
        self.tally.news(&self.settings)
    }

    /// All that was wrong with values, counted.
    pub fn remarks(&self) -> Vec<String> {
        self.tally.remarks(&self.settings)
    }
}
