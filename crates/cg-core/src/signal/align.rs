//! Alignment of signals with different rates and time stamps to samples.
//!
//! A sample is taken at each time stamp of one quantity; no fixed grid is used. It is the trailer's
//! roll angle, or the first quantity of a list of roll angles and levels that a sensor sends. All
//! other signals with a direction or a level are interpolated to that time as soon as their next
//! values have arrived. If these do not arrive, the last values are held. Speed and mass keep their
//! last values. A value that is too old is absent.
//!
//! If several devices send the same quantity, the first one is used until it stops sending or a
//! signal with a better rank appears.

use crate::math::real::Real;
use crate::signal::sample::{Quantity, Sample};
use crate::signal::sensors::AlignSettings;

/// Quantities that may determine the time stamps of the samples: the first one that is alive does.
const PACE: [Quantity; 8] = [
    Quantity::Roll,
    Quantity::RollToGravity,
    Quantity::Tilt,
    Quantity::SuspensionRoll,
    Quantity::LevelLeft,
    Quantity::TractorSuspensionRoll,
    Quantity::TractorLevelLeft,
    Quantity::TractorTilt,
];
/// Maximum number of time stamps that wait for the other signals.
const ROOM: usize = 32;
/// Maximum waiting time. Levels are sent every 100 ms (J1939 ASC3), some of them a little late.
const PATIENCE_US: u64 = 120_000;
/// Time without a value after which a frequently sent signal counts as lost.
const STALE_US: u64 = Quantity::Roll.serves_us();
/// Longest silence of a device after which another device with the same quantity is used.
const GONE_US: u64 = 30_000_000;

/// What the aligner did with a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// The value is used.
    Yes,
    /// The value is ignored because another device with the same quantity is in use.
    OtherSource,
    /// The value is ignored because its time stamp is not later than that of the previous value.
    OutOfOrder,
    /// The value is ignored because the truck [cannot have](AlignSettings::believes) it.
    Implausible,
}

/// The last two values of a quantity.
#[derive(Clone, Copy, Debug)]
struct Track<T> {
    last_us: u64,
    /// The last value and the one before it; the last is NaN before the first.
    last: T,
    before: T,
    /// Number of the sending device.
    source: u32,
    /// Time between the two values (24 bits, zero if there is only one) and the rank of the signal
    /// (8 bits). There is a track for every quantity, so a word less counts on a chip.
    span_and_rank: u32,
}

/// The greatest time between two values that a track can hold, 16.8 s.
const GREATEST_SPAN_US: u32 = 0x00FF_FFFF;

impl<T: Real> Track<T> {
    fn empty() -> Self {
        Self { last_us: 0, last: T::absent(), before: T::absent(), source: 0, span_and_rank: 0 }
    }

    const fn span_us(&self) -> u32 {
        self.span_and_rank >> 8
    }

    fn push(&mut self, (source, rank): (u32, u8), time_us: u64, value: T, gone_us: u64) -> Taken {
        let rank = u32::from(rank);
        let mut span_us = 0;
        if self.last.present() {
            let its_rank = self.span_and_rank & 0xFF;
            let alive = time_us.saturating_sub(self.last_us) <= gone_us;
            let same = source == self.source && rank == its_rank;
            if !same && alive && rank >= its_rank {
                return Taken::OtherSource;
            }
            if same && time_us <= self.last_us {
                return Taken::OutOfOrder;
            }
            if same {
                let passed_us = u32::try_from(time_us - self.last_us).unwrap_or(u32::MAX);
                span_us = passed_us.min(GREATEST_SPAN_US);
            }
        }
        (self.before, self.last) = (self.last, value);
        (self.last_us, self.source) = (time_us, source);
        self.span_and_rank = (span_us << 8) | rank;
        Taken::Yes
    }

    fn age_us(&self, now_us: u64) -> Option<u64> {
        self.last.present().then(|| now_us.saturating_sub(self.last_us))
    }

    fn lives(&self, now_us: u64, stale_us: u64) -> bool {
        self.age_us(now_us).is_some_and(|age_us| age_us <= stale_us)
    }

    /// The value at a time: interpolated between the last two values, or the last value.
    fn at(&self, time_us: u64, stale_us: u64) -> T {
        let (ago_us, span_us) = (self.last_us.saturating_sub(time_us), self.span_us());
        if ago_us > 0 && span_us > 0 && u64::from(span_us) <= stale_us {
            let ago_us = u32::try_from(ago_us).unwrap_or(u32::MAX).min(span_us);
            let seconds = |us: u32| T::of(f64::from(us));
            let share = seconds(span_us - ago_us) / seconds(span_us);
            self.before + (self.last - self.before) * share
        } else if time_us.abs_diff(self.last_us) <= stale_us {
            self.last // NaN before the first value
        } else {
            T::absent()
        }
    }
}

/// Converts values of single signals to samples. It has a fixed size and uses no heap.
///
/// ```
/// use cg_core::{AlignSettings, Aligner, Quantity};
///
/// let mut aligner = Aligner::<f32>::new(AlignSettings::NONE);
/// let sensor = (0x0B, 0); // source address and rank of the signal
/// aligner.push(Quantity::LateralAcceleration, sensor, 10_000, 1.0);
/// aligner.push(Quantity::Roll, sensor, 15_000, 0.02);
/// assert!(aligner.next(15_000).is_none()); // the next lateral acceleration has not arrived
/// aligner.push(Quantity::LateralAcceleration, sensor, 20_000, 2.0);
/// let sample = aligner.next(20_000).unwrap();
/// assert_eq!((sample.time_us, sample.lateral_acceleration_mps2), (15_000, 1.5));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Aligner<T> {
    settings: AlignSettings<T>,
    tracks: [Track<T>; Quantity::COUNT],
    /// Values of the quantity in [`PACE`] that wait for other signals, with their time stamps (µs).
    waiting: [(u64, T, Quantity); ROOM],
    first: usize,
    count: usize,
    sampled_us: Option<u64>,
}

impl<T: Real> Aligner<T> {
    /// An aligner without values.
    pub fn new(settings: AlignSettings<T>) -> Self {
        Self {
            settings,
            tracks: [Track::empty(); Quantity::COUNT],
            waiting: [(0, T::absent(), Quantity::Roll); ROOM],
            first: 0,
            count: 0,
            sampled_us: None,
        }
    }

    /// Goes on with the settings of another truck, whose sensors have the same values.
    pub fn use_settings(&mut self, settings: AlignSettings<T>) {
        self.settings = settings;
    }

    /// Takes the value of a signal. `device` is the number of the sending device and the rank of
    /// its signal; the smallest rank is preferred. Call [`next`](Self::next) afterwards until it
    /// returns `None`.
    pub fn push(&mut self, quantity: Quantity, device: (u32, u8), time_us: u64, value: T) -> Taken {
        if !value.present() {
            return Taken::Yes;
        }
        if !self.settings.believes(quantity, value) {
            return Taken::Implausible;
        }
        let Some(track) = self.tracks.get_mut(quantity.index()) else { return Taken::OtherSource };
        let gone_us = quantity.serves_us().min(GONE_US);
        let taken = track.push(device, time_us, value, gone_us);
        let lives = |quantity: &Quantity| self.track(*quantity).lives(time_us, STALE_US);
        let paces = taken == Taken::Yes && PACE.iter().find(|one| lives(one)) == Some(&quantity);
        if paces && self.sampled_us.is_none_or(|last| time_us > last) {
            self.wait(time_us, value, quantity);
        }
        taken
    }

    /// The next sample, if all its signals have arrived or the waiting time has passed.
    pub fn next(&mut self, now_us: u64) -> Option<Sample<T>> {
        loop {
            let (time_us, value, quantity) =
                *self.waiting.get(self.first).filter(|_| self.count > 0)?;
            let patient = now_us.saturating_sub(time_us) < PATIENCE_US && self.count < ROOM;
            if patient && self.is_awaited(time_us, now_us) {
                return None;
            }
            self.first = (self.first + 1) % ROOM;
            self.count -= 1;
            if self.sampled_us.is_none_or(|last_us| time_us > last_us) {
                self.sampled_us = Some(time_us);
                return Some(self.sample(time_us, value, quantity));
            }
        }
    }

    /// Time since the last value of a quantity, microseconds; `None` if there was none.
    pub fn age_us(&self, quantity: Quantity, now_us: u64) -> Option<u64> {
        self.track(quantity).age_us(now_us)
    }

    /// Whether the last value of a quantity is older than [`serves_us`](Quantity::serves_us).
    pub fn is_stale(&self, quantity: Quantity, now_us: u64) -> bool {
        self.age_us(quantity, now_us).is_some_and(|age_us| age_us > quantity.serves_us())
    }

    /// The value of a quantity at the time of a sample, SI units: interpolated between its last two
    /// values, or its last value as long as it is [valid](Quantity::serves_us).
    pub fn value(&self, quantity: Quantity, time_us: u64) -> T {
        let track = self.track(quantity);
        match quantity.serves_us() {
            u64::MAX => track.last,
            serves_us => track.at(time_us, serves_us),
        }
    }

    fn track(&self, quantity: Quantity) -> &Track<T> {
        // `index` is below the number of tracks for every quantity.
        let [first, ..] = &self.tracks;
        self.tracks.get(quantity.index()).unwrap_or(first)
    }

    fn wait(&mut self, time_us: u64, value: T, quantity: Quantity) {
        let place = (self.first + self.count) % ROOM;
        if let Some(slot) = self.waiting.get_mut(place) {
            *slot = (time_us, value, quantity);
        }
        if self.count == ROOM {
            self.first = (self.first + 1) % ROOM; // the oldest one is overwritten
        } else {
            self.count += 1;
        }
    }

    /// Whether the next value of an active signal is needed for this time stamp and has not arrived.
    fn is_awaited(&self, time_us: u64, now_us: u64) -> bool {
        let fast = |quantity: &Quantity| quantity.serves_us() == STALE_US;
        Quantity::ALL.into_iter().filter(fast).any(|quantity| {
            let track = self.track(quantity);
            track.last_us < time_us && track.lives(now_us, STALE_US)
        })
    }

    fn sample(&self, time_us: u64, value: T, pace: Quantity) -> Sample<T> {
        let at = |quantity: Quantity| {
            if quantity == pace { value } else { self.value(quantity, time_us) }
        };
        let mut sample = self.settings.sample(time_us, at);
        // Without a speed, steer angle and yaw rate do not determine the lateral acceleration.
        if !sample.speed_mps.present() {
            (sample.steer_rad, sample.yaw_rate_radps) = (T::absent(), T::absent());
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aligner() -> Aligner<f64> {
        let settings = AlignSettings {
            steering_ratio: Some(20.0),
            mass_of_axle_load: Some([4000.0, 1.5]),
            mass_of_suspension_pressure: Some([3000.0, 0.05]),
            mass_range_kg: Some([5000.0, 60_000.0]),
            ..AlignSettings::NONE
        };
        Aligner::new(settings)
    }

    /// There is a track for every quantity, so each word counts on a chip.
    #[test]
    fn a_track_in_single_precision_has_six_words() {
        assert_eq!(size_of::<Track<f32>>(), 24);
        assert_eq!(size_of::<Track<f64>>(), 32);
    }

    /// Devices: the roll sensor and the brake controller.
    const ROLL_SENSOR: (u32, u8) = (0xE4, 0);
    const BRAKES: (u32, u8) = (0x0B, 0);

    /// The same ramp is sent every 7 ms by one device and every 10 ms by another.
    #[test]
    fn signals_of_different_rates_meet_at_the_roll_angle() {
        let mut aligner = aligner();
        let mut samples = 0;
        for us in (0..2_000_000_u64).step_by(1000) {
            #[allow(clippy::cast_precision_loss)]
            let ramp = us as f64 * 0.4e-6;
            if us % 100_000 == 0 {
                aligner.push(Quantity::Speed, BRAKES, us, 14.0);
                aligner.push(Quantity::TrailerAxleLoad, BRAKES, us, 10_000.0);
            }
            if us % 7000 == 0 {
                aligner.push(Quantity::SteeringWheel, BRAKES, us, 20.0 * ramp);
            }
            if us % 10_000 == 3000 {
                aligner.push(Quantity::Roll, ROLL_SENSOR, us, ramp);
            }
            while let Some(sample) = aligner.next(us) {
                samples += 1;
                assert!((sample.steer_rad - sample.roll_rad).abs() < 1e-12, "{sample:?}");
                assert!((sample.trailer_mass_kg - 19_000.0).abs() < 1e-9);
            }
        }
        assert_eq!(samples, 200);
    }

    #[test]
    fn a_signal_that_stops_is_held_for_a_moment_and_then_absent() {
        let mut aligner = aligner();
        aligner.push(Quantity::LateralAcceleration, BRAKES, 0, 1.0);
        let mut values = [0.0; 3];
        for (value, us) in values.iter_mut().zip([200_000, 450_000, 700_000]) {
            aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
            assert_eq!(aligner.next(us).is_none(), us < STALE_US); // waits while it is active
            *value =
                aligner.next(us + PATIENCE_US).map_or(f64::NAN, |s| s.lateral_acceleration_mps2);
        }
        assert_eq!(values[..2], [1.0, 1.0]);
        assert!(values[2].is_nan());
        assert!(aligner.is_stale(Quantity::LateralAcceleration, 700_000));
        assert!(!aligner.is_stale(Quantity::YawRate, 700_000)); // never received
    }

    #[test]
    fn one_device_is_listened_to_until_it_dies_or_a_better_one_speaks() {
        let mut aligner = aligner();
        let speed = |aligner: &mut Aligner<f64>, device, us| {
            aligner.push(Quantity::Speed, device, us, 10.0)
        };
        assert_eq!(speed(&mut aligner, (1, 1), 0), Taken::Yes);
        assert_eq!(speed(&mut aligner, (2, 1), 100_000), Taken::OtherSource);
        assert_eq!(speed(&mut aligner, (1, 1), 200_000), Taken::Yes);
        assert_eq!(speed(&mut aligner, (1, 1), 200_000), Taken::OutOfOrder);
        assert_eq!(speed(&mut aligner, (2, 0), 300_000), Taken::Yes); // preferred
        assert_eq!(speed(&mut aligner, (1, 1), 400_000), Taken::OtherSource);
        assert_eq!(speed(&mut aligner, (1, 1), 3_000_000), Taken::Yes); // the other one is silent
    }

    #[test]
    fn without_a_speed_there_is_no_steer_angle() {
        let mut aligner = aligner();
        aligner.push(Quantity::Steer, BRAKES, 0, 0.1);
        aligner.push(Quantity::Roll, ROLL_SENSOR, 0, 0.0);
        assert!(aligner.next(0).unwrap().steer_rad.is_nan());
        aligner.push(Quantity::Speed, BRAKES, 1000, 10.0);
        aligner.push(Quantity::Steer, BRAKES, 10_000, 0.1);
        aligner.push(Quantity::Roll, ROLL_SENSOR, 10_000, 0.0);
        assert!((aligner.next(10_000).unwrap().steer_rad - 0.1).abs() < 1e-15);
    }

    #[test]
    fn the_best_scale_tells_the_mass() {
        let mut aligner = aligner();
        let mut mass_kg = |quantity, value, us| {
            aligner.push(quantity, BRAKES, us, value);
            aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
            aligner.next(us).unwrap().trailer_mass_kg
        };
        let close = |found: f64, known: f64| assert!((found - known).abs() < 1e-9, "{found}");
        close(mass_kg(Quantity::TrailerSuspensionPressure, 3e5, 1000), 18_000.0);
        close(mass_kg(Quantity::TrailerAxleLoad, 10_000.0, 2000), 19_000.0);
        close(mass_kg(Quantity::TrailerMass, 19_500.0, 3000), 19_500.0);
        close(mass_kg(Quantity::TrailerSuspensionPressure, 4e5, 4000), 19_500.0);
    }

    /// A scale with an impossible value is skipped, no matter if it is the first value or a later
    /// one.
    #[test]
    fn the_next_scale_serves_where_one_is_not_believed() {
        let mut aligner = aligner();
        let mut mass_kg = |quantity, value, us, taken| {
            assert_eq!(aligner.push(quantity, BRAKES, us, value), taken, "{value}");
            aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
            aligner.next(us).unwrap().trailer_mass_kg
        };
        let (mass, load) = (Quantity::TrailerMass, Quantity::TrailerAxleLoad);
        assert!(mass_kg(mass, 0.0, 1000, Taken::Implausible).is_nan());
        let of_load = mass_kg(load, 10_000.0, 2000, Taken::Yes);
        assert!((of_load - 19_000.0).abs() < 1e-9);
        for (us, bad) in [(3000, 4999.0), (4000, 60_001.0), (5000, 1e308)] {
            assert!((mass_kg(mass, bad, us, Taken::Implausible) - of_load).abs() < 1e-9);
        }
        assert!((mass_kg(mass, 20_000.0, 6000, Taken::Yes) - 20_000.0).abs() < 1e-9);
        // With no axle load the mass would be 4 t, which is below the minimum.
        assert!((mass_kg(load, 0.0, 7000, Taken::Implausible) - 20_000.0).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_is_absent() {
        let mut aligner = aligner();
        let brakes = |aligner: &mut Aligner<f64>, us, value| {
            aligner.push(Quantity::LateralAcceleration, BRAKES, us, value)
        };
        assert_eq!(brakes(&mut aligner, 1000, 1.0), Taken::Yes);
        assert_eq!(brakes(&mut aligner, 2000, 900.0), Taken::Implausible);
        assert_eq!(aligner.push(Quantity::Roll, ROLL_SENSOR, 2000, 1e30), Taken::Implausible);
        assert_eq!(brakes(&mut aligner, 3000, 3.0), Taken::Yes);
        aligner.push(Quantity::Roll, ROLL_SENSOR, 2000, 0.1);
        let sample = aligner.next(3000).unwrap();
        assert!((sample.lateral_acceleration_mps2 - 2.0).abs() < 1e-12);
        assert!(aligner.next(u64::MAX).is_none());
    }

    #[test]
    fn tilt_sets_the_pace_only_without_a_roll_sensor() {
        let mut aligner = aligner();
        aligner.push(Quantity::Tilt, ROLL_SENSOR, 1000, 0.1);
        assert!((aligner.next(1000).unwrap().tilt_rad - 0.1).abs() < 1e-15);
        aligner.push(Quantity::Roll, ROLL_SENSOR, 2000, 0.1);
        aligner.push(Quantity::Tilt, ROLL_SENSOR, 3000, 0.1);
        assert_eq!(aligner.next(4000).unwrap().time_us, 2000);
        assert!(aligner.next(1_000_000).is_none());
    }

    #[test]
    fn a_flood_of_roll_angles_loses_the_oldest_only() {
        let mut aligner = aligner();
        aligner.push(Quantity::YawRate, BRAKES, 0, 0.0);
        for us in 1..=40 {
            aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
        }
        let mut times = (0..).map_while(|_| aligner.next(40)).map(|sample| sample.time_us);
        assert_eq!(times.next(), Some(9));
    }
}
