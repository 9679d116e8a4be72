//! From signals that arrive each at its own rate to samples.
//!
//! A sample is taken at each time stamp of the roll angle (of the tilt, while there is no roll):
//! nothing is put on a grid. Steer angle, lateral acceleration and yaw rate are interpolated to
//! that instant as soon as their next values are there, or held when those do not come; speed and
//! mass hold their last values. A value that is too old is absent.
//!
//! Several devices may send the same quantity: the first one seen is kept for as long as it lives,
//! unless a preferred signal appears.

use crate::math::real::Real;
use crate::signal::sample::{Quantity, Sample};

/// Roll angles that may wait for the other signals.
const ROOM: usize = 32;
/// How long they wait.
const PATIENCE_US: u64 = 100_000;
/// After this time without a value, a signal that comes many times a second is gone.
const STALE_US: u64 = Quantity::Roll.serves_us();
/// After this time without a value of its device, another one is listened to at last.
const GONE_US: u64 = 30_000_000;

/// What turns sensor values into those of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignSettings<T> {
    /// Steering-wheel angle over road-wheel angle; without it the wheel's angle says nothing.
    pub steering_ratio: Option<T>,
    /// Trailer mass at no axle load, and its growth with the axle load: the trailer's balance on
    /// fifth wheel and axles.
    pub mass_of_axle_load: Option<[T; 2]>,
    /// The same over the pressure in its air suspension.
    pub mass_of_suspension_pressure: Option<[T; 2]>,
    /// The least and the greatest mass that the trailer can have: a scale that says another one is
    /// not believed.
    pub mass_range_kg: Option<[T; 2]>,
}

impl<T: Real> AlignSettings<T> {
    /// Nothing is known.
    pub const NONE: Self = Self {
        steering_ratio: None,
        mass_of_axle_load: None,
        mass_of_suspension_pressure: None,
        mass_range_kg: None,
    };

    /// Mean road-wheel angle: as measured, or else of the steering wheel's.
    pub fn steer_rad(&self, steer_rad: T, steering_wheel_rad: T) -> T {
        match self.steering_ratio {
            Some(ratio) if !steer_rad.present() => steering_wheel_rad / ratio,
            _ => steer_rad,
        }
    }

    /// Trailer mass: as weighed, or else of its axle load, or else of the pressure in its
    /// suspension. What is not [believed](Self::believes) is passed over.
    pub fn trailer_mass_kg(&self, trailer_mass_kg: T, axle_load_kg: T, pressure_pa: T) -> T {
        [
            (Quantity::TrailerMass, trailer_mass_kg),
            (Quantity::TrailerAxleLoad, axle_load_kg),
            (Quantity::TrailerSuspensionPressure, pressure_pa),
        ]
        .into_iter()
        .filter(|(quantity, value)| self.believes(*quantity, *value))
        .map(|(quantity, value)| self.mass_kg(quantity, value))
        .find(|mass_kg| mass_kg.present())
        .unwrap_or_else(T::absent)
    }

    /// The trailer mass that a value means; absent if it says none.
    pub fn mass_kg(&self, quantity: Quantity, value: T) -> T {
        let along = |line: Option<[T; 2]>| match line {
            Some([at_zero, slope]) => at_zero + slope * value,
            None => T::absent(),
        };
        match quantity {
            Quantity::TrailerMass => value,
            Quantity::TrailerAxleLoad => along(self.mass_of_axle_load),
            Quantity::TrailerSuspensionPressure => along(self.mass_of_suspension_pressure),
            _ => T::absent(),
        }
    }

    /// Whether this truck can have this value: [plausible](Quantity::plausible), and of what
    /// weighs the trailer a mass that it can have. Absent values are not believed.
    pub fn believes(&self, quantity: Quantity, value: T) -> bool {
        let mass_kg = self.mass_kg(quantity, value);
        let possible = match self.mass_range_kg {
            Some([least, greatest]) if mass_kg.present() => mass_kg >= least && mass_kg <= greatest,
            _ => true,
        };
        possible && quantity.plausible(value)
    }
}

impl<T: Real> Default for AlignSettings<T> {
    fn default() -> Self {
        Self::NONE
    }
}

/// What became of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It counts.
    Yes,
    /// Another device that sends the same quantity is listened to.
    OtherSource,
    /// Its time does not follow that of the value before.
    OutOfOrder,
    /// The truck [cannot have](AlignSettings::believes) this value: it counts as absent.
    Implausible,
}

/// The last two values of a quantity.
#[derive(Clone, Copy, Debug)]
struct Track<T> {
    last: Option<(u64, T)>,
    before: Option<(u64, T)>,
    source: u32,
    rank: u8,
}

impl<T: Real> Track<T> {
    const EMPTY: Self = Self { last: None, before: None, source: 0, rank: u8::MAX };

    fn push(&mut self, (source, rank): (u32, u8), time_us: u64, value: T, gone_us: u64) -> Taken {
        if let Some((last_us, _)) = self.last {
            let alive = time_us.saturating_sub(last_us) <= gone_us;
            let same = source == self.source && rank == self.rank;
            if !same && alive && rank >= self.rank {
                return Taken::OtherSource;
            }
            if same && time_us <= last_us {
                return Taken::OutOfOrder;
            }
            self.before = if same { self.last } else { None };
        }
        (self.last, self.source, self.rank) = (Some((time_us, value)), source, rank);
        Taken::Yes
    }

    fn age_us(&self, now_us: u64) -> Option<u64> {
        self.last.map(|(last_us, _)| now_us.saturating_sub(last_us))
    }

    fn lives(&self, now_us: u64, stale_us: u64) -> bool {
        self.age_us(now_us).is_some_and(|age_us| age_us <= stale_us)
    }

    /// The value at an instant: between the last two, or the last one held.
    fn at(&self, time_us: u64, stale_us: u64) -> T {
        match (self.before, self.last) {
            (Some((before_us, before)), Some((last_us, last)))
                if time_us < last_us && last_us - before_us <= stale_us =>
            {
                // Waiting takes less than an hour: 32 bits hold microseconds exactly.
                let span = |us: u64| T::of(f64::from(u32::try_from(us).unwrap_or(u32::MAX)));
                let share = span(time_us.saturating_sub(before_us)) / span(last_us - before_us);
                before + (last - before) * share
            }
            (_, Some((last_us, last))) if time_us.abs_diff(last_us) <= stale_us => last,
            _ => T::absent(),
        }
    }
}

/// Values of single signals in, samples out. Fixed size, no heap.
///
/// ```
/// use cg_core::{AlignSettings, Aligner, Quantity};
///
/// let mut aligner = Aligner::<f32>::new(AlignSettings::NONE);
/// let sensor = (0x0B, 0); // a source address, and the rank of the signal
/// aligner.push(Quantity::LateralAcceleration, sensor, 10_000, 1.0);
/// aligner.push(Quantity::Roll, sensor, 15_000, 0.02);
/// assert!(aligner.next(15_000).is_none()); // the next lateral acceleration is still to come
/// aligner.push(Quantity::LateralAcceleration, sensor, 20_000, 2.0);
/// let sample = aligner.next(20_000).unwrap();
/// assert_eq!((sample.time_us, sample.lateral_acceleration_mps2), (15_000, 1.5));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Aligner<T> {
    settings: AlignSettings<T>,
    tracks: [Track<T>; Quantity::COUNT],
    /// Roll angles that wait: time stamp, value, whether it is a tilt.
    waiting: [(u64, T, bool); ROOM],
    first: usize,
    count: usize,
    sampled_us: Option<u64>,
}

impl<T: Real> Aligner<T> {
    /// Before the first value.
    pub fn new(settings: AlignSettings<T>) -> Self {
        Self {
            settings,
            tracks: [Track::EMPTY; Quantity::COUNT],
            waiting: [(0, T::absent(), false); ROOM],
            first: 0,
            count: 0,
            sampled_us: None,
        }
    }

    /// Takes in a value of a device (any number that tells it from others) with the rank of its
    /// signal, the least being preferred. Then ask for [samples](Self::next) until there is none.
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
        let tilt = quantity == Quantity::Tilt;
        let paces = quantity == Quantity::Roll
            || (tilt && !self.track(Quantity::Roll).lives(time_us, STALE_US));
        if taken == Taken::Yes && paces && self.sampled_us.is_none_or(|last| time_us > last) {
            self.wait(time_us, value, tilt);
        }
        taken
    }

    /// The next sample, if all its signals are there or no longer waited for at this time.
    pub fn next(&mut self, now_us: u64) -> Option<Sample<T>> {
        loop {
            let (time_us, value, tilt) =
                *self.waiting.get(self.first).filter(|_| self.count > 0)?;
            let patient = now_us.saturating_sub(time_us) < PATIENCE_US && self.count < ROOM;
            if patient && self.is_awaited(time_us, now_us) {
                return None;
            }
            self.first = (self.first + 1) % ROOM;
            self.count -= 1;
            if self.sampled_us.is_none_or(|last_us| time_us > last_us) {
                self.sampled_us = Some(time_us);
                return Some(self.sample(time_us, value, tilt));
            }
        }
    }

    /// How long ago a quantity was last heard of; `None` if never.
    pub fn age_us(&self, quantity: Quantity, now_us: u64) -> Option<u64> {
        self.track(quantity).age_us(now_us)
    }

    /// Whether a quantity is missing that was there before.
    pub fn is_stale(&self, quantity: Quantity, now_us: u64) -> bool {
        self.age_us(quantity, now_us).is_some_and(|age_us| age_us > quantity.serves_us())
    }

    /// What a quantity was at the time of a sample just taken: between its last two values, or the
    /// last one as long as it [serves](Quantity::serves_us).
    pub fn value(&self, quantity: Quantity, time_us: u64) -> T {
        let track = self.track(quantity);
        match quantity.serves_us() {
            u64::MAX => track.last.map_or(T::absent(), |(_, value)| value),
            serves_us => track.at(time_us, serves_us),
        }
    }

    fn track(&self, quantity: Quantity) -> &Track<T> {
        // The index is that of the quantity itself: in range.
        self.tracks.get(quantity.index()).unwrap_or(&Track::EMPTY)
    }

    fn wait(&mut self, time_us: u64, value: T, tilt: bool) {
        let place = (self.first + self.count) % ROOM;
        if let Some(slot) = self.waiting.get_mut(place) {
            *slot = (time_us, value, tilt);
        }
        if self.count == ROOM {
            self.first = (self.first + 1) % ROOM; // the oldest one is overwritten
        } else {
            self.count += 1;
        }
    }

    /// Whether a living input has yet to come past this instant.
    fn is_awaited(&self, time_us: u64, now_us: u64) -> bool {
        const INPUTS: [Quantity; 4] = [
            Quantity::Steer,
            Quantity::SteeringWheel,
            Quantity::LateralAcceleration,
            Quantity::YawRate,
        ];
        INPUTS.into_iter().any(|quantity| {
            let track = self.track(quantity);
            track.lives(now_us, STALE_US) && track.last.is_some_and(|(last, _)| last < time_us)
        })
    }

    fn sample(&self, time_us: u64, value: T, tilt: bool) -> Sample<T> {
        let at = |quantity: Quantity| self.value(quantity, time_us);
        let speed_mps = at(Quantity::Speed);
        let settings = &self.settings;
        let steer_rad = settings.steer_rad(at(Quantity::Steer), at(Quantity::SteeringWheel));
        let trailer_mass_kg = settings.trailer_mass_kg(
            at(Quantity::TrailerMass),
            at(Quantity::TrailerAxleLoad),
            at(Quantity::TrailerSuspensionPressure),
        );
        let roll = |wanted: bool| if tilt == wanted { value } else { T::absent() };
        // Without a speed neither steer angle nor yaw rate say how fast the truck turns.
        let with_speed = |x: T| if speed_mps.present() { x } else { T::absent() };
        Sample {
            time_us,
            steer_rad: with_speed(steer_rad),
            roll_rad: roll(false),
            tilt_rad: roll(true),
            speed_mps,
            lateral_acceleration_mps2: at(Quantity::LateralAcceleration),
            yaw_rate_radps: with_speed(at(Quantity::YawRate)),
            trailer_mass_kg,
        }
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
        };
        Aligner::new(settings)
    }

    /// Devices: roll sensor and brakes.
    const ROLL_SENSOR: (u32, u8) = (0xE4, 0);
    const BRAKES: (u32, u8) = (0x0B, 0);

    /// A ramp sent every 7 ms by one device and every 10 ms by another is one ramp.
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
            assert_eq!(aligner.next(us).is_none(), us < STALE_US); // waited for while it lives
            *value =
                aligner.next(us + PATIENCE_US).map_or(f64::NAN, |s| s.lateral_acceleration_mps2);
        }
        assert_eq!(values[..2], [1.0, 1.0]);
        assert!(values[2].is_nan());
        assert!(aligner.is_stale(Quantity::LateralAcceleration, 700_000));
        assert!(!aligner.is_stale(Quantity::YawRate, 700_000)); // never there
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

    /// A scale that says nothing possible is passed over, be it the first value or a later one.
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
        // An empty load of the axles is a mass of 4 t: below the least.
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
