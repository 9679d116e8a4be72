//! Samples from CAN frames: decoding, alignment, and a continuous time.

use cg_core::signal::align::Taken;
use cg_core::{AlignSettings, Aligner, Quantity, Sample};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::scales::Scale;

use super::clock::{Clock, Instant};
use super::decoder::Decoder;
use super::frame::Frame;
use super::sources::Sources;
use super::tally::Tally;
use crate::lift_signal::LiftSignal;

/// How long a mass is that of the present load after it has come, µs. Scales on a bus send every ten seconds at least.
pub(crate) const MASS_SERVES_US: u64 = 120_000_000;

/// Converts frames to samples, live and from a log.
#[derive(Clone, Debug)]
pub struct Sampler {
    decoder: Decoder,
    settings: AlignSettings<f64>,
    /// Those of the truck with its lift axles raised, if it has any, or those of before.
    raised: Option<AlignSettings<f64>>,
    lift_axle: LiftAxle,
    lift_signal: LiftSignal,
    unread_lift_axle: f64,
    aligner: Aligner<f64>,
    clock: Clock,
    now_us: u64,
    tally: Tally,
    values_of_other_sources: u64,
    sources: Sources,
}

impl Sampler {
    /// A sampler without frames.
    pub fn new(decoder: Decoder, settings: AlignSettings<f64>) -> Self {
        Self {
            sources: Sources::new(decoder.filters()),
            decoder,
            settings,
            raised: None,
            lift_axle: LiftAxle::Down,
            lift_signal: LiftSignal::default(),
            unread_lift_axle: f64::NAN,
            aligner: Aligner::new(settings),
            clock: Clock::default(),
            now_us: 0,
            tally: Tally::default(),
            values_of_other_sources: 0,
        }
    }

    /// The same for a truck whose lift axles may be raised, too, and the settings that it then has.
    #[must_use]
    pub fn with_raised(self, raised: Option<AlignSettings<f64>>) -> Self {
        Self { raised, ..self }
    }

    /// What has been said since the last call of the position of the lift axles: 0 down, 1 raised, NaN nothing.
    pub fn take_lift_axle(&mut self) -> f64 {
        std::mem::replace(&mut self.unread_lift_axle, f64::NAN)
    }

    #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
    fn now_s(&self) -> f64 {
        self.now_us as f64 * 1e-6
    }

    /// Takes the position of the lift axles; a value that is none is ignored.
    pub fn follow_lift_axle(&mut self, value: f64) {
        let now_s = self.now_s();
        if !value.is_nan() {
            self.unread_lift_axle = value;
        }
        if let Some(position) = self.lift_signal.push(value, now_s, true) {
            self.resume(position);
        }
    }

    /// Begins with the lift axles where they were before a restart.
    pub fn resume(&mut self, position: LiftAxle) {
        let Some(other) = self.raised.as_mut().filter(|_| position != self.lift_axle) else {
            return;
        };
        core::mem::swap(other, &mut self.settings);
        self.lift_axle = position;
        self.aligner.use_settings(self.settings);
    }

    /// Adds a frame and returns its stream time. `monotonic_us` is the monotonic clock at
    /// reception, if the frame is live. `heard` is called for each value that is used. Call
    /// [`next_sample`](Self::next_sample) afterwards until it returns `None`.
    pub fn push(
        &mut self,
        frame: &Frame,
        monotonic_us: Option<u64>,
        mut heard: impl FnMut(Quantity),
    ) -> Instant {
        let instant = self.clock.stream(frame.time_us, monotonic_us);
        let now_us = instant.stream_us;
        self.now_us = now_us;
        let lift_axle = self.decoder.lift_axle(frame);
        self.follow_lift_axle(lift_axle.unwrap_or(f64::NAN));
        let Self { decoder, aligner, tally, values_of_other_sources, sources, .. } = self;
        sources.begin(now_us);
        decoder.refused(frame, |quantity, address| {
            sources.refused(quantity, address);
            *values_of_other_sources += 1;
        });
        let slope = decoder.decode(frame, |quantity, device, value| {
            sources.heard(quantity);
            match aligner.push(quantity, device, now_us, value) {
                Taken::Yes => {
                    sources.used(quantity, device);
                    heard(quantity);
                }
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

    /// Adds a value that was not measured by a CAN frame.
    pub fn push_value(&mut self, quantity: Quantity, time_us: u64, value: f64) -> Instant {
        let instant = self.clock.stream(time_us, None);
        self.now_us = instant.stream_us;
        if self.aligner.push(quantity, (0, 0), self.now_us, value) == Taken::Implausible {
            self.tally.implausible(quantity, value, None);
        }
        instant
    }

    /// The sensor settings of the truck.
    pub(crate) fn settings(&self) -> &AlignSettings<f64> {
        &self.settings
    }

    /// Whether its samples have a roll angle of two sensors.
    pub(crate) fn shares_roll(&self) -> bool {
        self.settings.second_roll_share.is_some()
    }

    /// The value of a quantity at the time of the last sample, SI units.
    pub fn value(&self, quantity: Quantity, stream_us: u64) -> f64 {
        self.aligner.value(quantity, stream_us)
    }

    /// The scale from which the trailer mass follows at the time of the last sample.
    pub fn scale(&self, stream_us: u64) -> Option<Scale> {
        let (quantity, _) = self.settings.weighed(|quantity| self.value(quantity, stream_us))?;
        Scale::on_bus(quantity)
    }

    /// When the mass of a sample at this time came, µs; `None` without one.
    pub fn weighed_us(&self, stream_us: u64) -> Option<u64> {
        let (quantity, _) = self.settings.weighed(|quantity| self.value(quantity, stream_us))?;
        let age_us = self.aligner.age_us(quantity, stream_us)?;
        Some(stream_us.saturating_sub(age_us))
    }

    /// Advances the time without a frame and returns the stream time, µs.
    pub fn idle(&mut self, raw_us: u64, monotonic_us: u64) -> u64 {
        self.now_us = self.clock.stream(raw_us, Some(monotonic_us)).stream_us;
        self.now_us
    }

    /// The next complete sample. Its time is stream time.
    pub fn next_sample(&mut self) -> Option<Sample<f64>> {
        self.aligner.next(self.now_us)
    }

    /// The next sample that still waits for other signals, for the end of a log.
    pub fn rest(&mut self) -> Option<Sample<f64>> {
        self.aligner.next(u64::MAX)
    }

    /// Number of values that were ignored because another device sends the same quantity, or because the quantity is
    /// accepted from another source address only.
    pub fn values_of_other_sources(&self) -> u64 {
        self.values_of_other_sources
    }

    /// Stream time of the last frame, µs.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// The decoder of frames.
    pub fn decoder(&self) -> &Decoder {
        &self.decoder
    }

    /// The counts of implausible values.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Findings about values since the last call, each as signal and sentence.
    pub fn news(&mut self) -> Vec<(&'static str, String)> {
        let mut news = self.tally.news(&self.settings);
        if self.sources.has_begun(self.now_us) {
            news.extend(self.sources.news());
        }
        news
    }

    /// Findings at the end of a log that were not part of [`news`](Self::news).
    pub fn last_news(&mut self) -> Vec<(&'static str, String)> {
        self.sources.news()
    }

    /// The quantities that should have come from the only source address from which they are accepted, and have not.
    pub fn unheard(&self) -> Vec<Quantity> {
        if self.sources.has_begun(self.now_us) { self.sources.unheard() } else { Vec::new() }
    }

    /// All findings about values so far, with their counts.
    pub fn remarks(&self) -> Vec<String> {
        let of_sources = self.sources.remarks().into_iter();
        let of_sources = of_sources.map(|(signal, sentence)| format!("{signal}: {sentence}"));
        self.tally.remarks(&self.settings).into_iter().chain(of_sources).collect()
    }
}

#[cfg(test)]
#[cfg(feature = "dbc")]
mod tests {
    use super::*;
    use crate::can::{MappedSignal, SignalMap};

    const DBC: &str = r#"VERSION ""

BU_: TRAILER

BO_ 512 STATE: 8 TRAILER
 SG_ LiftAxle : 0|8@1+ (1,0) [0|1] "" Vector__XXX
 SG_ AxleLoad : 8|16@1+ (1,0) [0|0] "kg" Vector__XXX
 SG_ Roll : 24|16@1- (0.001,0) [0|0] "deg" Vector__XXX

BO_ 2566851100 SLOPE: 8 TRAILER
 SG_ Angle : 0|16@1- (0.01,0) [-90|90] "deg" Vector__XXX
"#;

    /// On two of three axles, 10 t of axle load are another trailer mass than on three.
    #[test]
    fn a_raised_axle_changes_what_a_scale_says() {
        let maps =
            ["lift_axle=STATE.LiftAxle", "trailer_axle_load=STATE.AxleLoad", "roll=STATE.Roll"];
        let maps: Vec<SignalMap> = maps.into_iter().map(|map| map.parse().unwrap()).collect();
        let mapped = MappedSignal::parse("state.dbc", DBC, &maps).unwrap();
        let decoder = Decoder::new(mapped, Vec::new(), Vec::new());
        let settings =
            |slope| AlignSettings { mass_of_axle_load: Some([1e3, slope]), ..AlignSettings::NONE };
        let mut sampler = Sampler::new(decoder, settings(1.5)).with_raised(Some(settings(1.4)));
        let masses_kg = |lift_axle: u8| {
            let mut found = Vec::new();
            for k in 0..60 {
                let load = 10_000_u16.to_le_bytes();
                let data = [lift_axle, load[0], load[1], k, 0];
                let time_us = sampler.now_us() + 20_000;
                sampler.push(&Frame::new(time_us, 512, false, &data).unwrap(), None, |_| {});
                found.extend(std::iter::from_fn(|| sampler.next_sample()));
            }
            found.last().unwrap().trailer_mass_kg
        };
        let found_kg = [0, 1, 7, 0].map(masses_kg).map(f64::to_bits);
        assert_eq!(found_kg, [16e3, 15e3, 15e3, 16e3].map(f64::to_bits));
        let heard = Frame::new(sampler.now_us() + 1, 512, false, &[1, 0, 0, 0, 0]).unwrap();
        sampler.take_lift_axle();
        sampler.push(&heard, None, |_| {});
        assert!(sampler.take_lift_axle() > 0.9 && sampler.take_lift_axle().is_nan());
    }

    /// Two senders of a mapped group, of which one is accepted. Frames with 11-bit identifiers have no address.
    #[test]
    fn a_mapped_signal_comes_from_the_accepted_address_only() {
        let sampler = |map: &str, filter: &str| {
            let mapped = MappedSignal::parse("slope.dbc", DBC, &[map.parse().unwrap()]).unwrap();
            let decoder = Decoder::new(mapped, vec![filter.parse().unwrap()], Vec::new());
            let mut sampler = Sampler::new(decoder, AlignSettings::NONE);
            for k in 0..4 {
                for (identifier, angle) in [(0x18FF_0A55, 100), (0x18FF_0A56, 200), (512, 30)] {
                    let data = [angle, 0, 0, angle, 0, 0, 0, 0];
                    let extended = identifier != 512;
                    let time_us = k * 1_000_000;
                    let frame = Frame::new(time_us, identifier, extended, &data).unwrap();
                    sampler.push(&frame, None, |_| {});
                }
            }
            sampler
        };
        // The siblings of a quantity have one address.
        for filter in ["roll=0x56", "tilt=0x56"] {
            let mut right = sampler("roll=SLOPE.Angle", filter);
            let angle = right.value(Quantity::Roll, right.now_us()).to_degrees();
            assert!((angle - 2.0).abs() < 1e-9, "{angle}");
            assert_eq!(right.values_of_other_sources(), 4);
            assert!(right.unheard().is_empty() && right.news().is_empty());
        }
        let mut wrong = sampler("roll=SLOPE.Angle", "roll=0x99");
        assert!(wrong.value(Quantity::Roll, wrong.now_us()).is_nan());
        assert_eq!((wrong.values_of_other_sources(), wrong.unheard()), (8, vec![Quantity::Roll]));
        let news = wrong.news();
        assert!(news[0].1.contains("those of 0x55, 0x56 are not used"), "{news:?}");
        let short = sampler("roll=STATE.Roll", "roll=0x99");
        assert!(short.value(Quantity::Roll, short.now_us()).is_finite());
        assert!(short.unheard().is_empty());
    }
}
