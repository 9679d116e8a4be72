//! Alignment of signals with different rates and time stamps to samples.
//!
//! A sample is taken at each time stamp of the roll angle (or of the tilt, as long as there is no
//! roll angle); no fixed grid is used. Steer angle, lateral acceleration and yaw rate are
//! interpolated to that time as soon as their next values have arrived. If these do not arrive, the
//! last values are held. Speed and mass keep their last values. A value that is too old is absent.
//!
//! If several devices send the same quantity, the first one is used until it stops sending or a
//! signal with a better rank appears.

use crate::math::real::Real;
use crate::signal::sample::{Quantity, Sample};

/// Maximum number of roll angles that wait for the other signals.
const ROOM: usize = 32;
/// Maximum waiting time of a roll angle.
const PATIENCE_US: u64 = 100_000;
/// Time without a value after which a frequently sent signal counts as lost.
const STALE_US: u64 = Quantity::Roll.serves_us();
/// Longest silence of a device after which another device with the same quantity is used.
const GONE_US: u64 = 30_000_000;

/// The vehicle data that convert sensor values to the values of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignSettings<T> {
    /// Steering-wheel angle divided by the mean road-wheel angle. Without it, the steering-wheel
    /// angle is not used.
    pub steering_ratio: Option<T>,
    /// Trailer mass in kg as a linear function of the axle load: the value at no load (kg), and the
    /// slope (kg/kg). It follows from the trailer's static balance on fifth wheel and axles.
    pub mass_of_axle_load: Option<[T; 2]>,
    /// Trailer mass in kg as a linear function of the gauge pressure in its air suspension: the
    /// value at zero (kg), and the slope (kg/Pa).
    pub mass_of_suspension_pressure: Option<[T; 2]>,
    /// The smallest and the greatest possible mass of the trailer, kg. Masses outside this range
    /// are ignored.
    pub mass_range_kg: Option<[T; 2]>,
}

impl<T: Real> AlignSettings<T> {
    /// No vehicle data.
    pub const NONE: Self = Self {
        steering_ratio: None,
        mass_of_axle_load: None,
        mass_of_suspension_pressure: None,
        mass_range_kg: None,
    };

    /// Mean road-wheel angle, rad: the measured one or, if it is absent, the one that follows from
    /// the steering-wheel angle.
    pub fn steer_rad(&self, steer_rad: T, steering_wheel_rad: T) -> T {
        match self.steering_ratio {
            Some(ratio) if !steer_rad.present() => steering_wheel_rad / ratio,
            _ => steer_rad,
        }
    }

    /// Trailer mass, kg: the measured one or, if it is absent, the one that follows from the axle
    /// load or from the suspension pressure, in this order. Values that fail
    /// [`believes`](Self::believes) are skipped.
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

    /// The trailer mass that follows from a value of this quantity, kg; absent if none follows.
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

    /// Whether the value is [plausible](Quantity::plausible) and, if a trailer mass follows from
    /// it, whether the trailer can have that mass. Absent values return `false`.
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

    /// The value at a time: interpolated between the last two values, or the last value.
    fn at(&self, time_us: u64, stale_us: u64) -> T {
        match (self.before, self.last) {
            (Some((before_us, before)), Some((last_us, last)))
                if time_us < last_us && last_us - before_us <= stale_us =>
            {
                // Waiting times are below one hour, and 32 bits hold such times in microseconds.
                let span = |us: u64| T::of(f64::from(u32::try_from(us).unwrap_or(u32::MAX)));
                let share = span(time_us.saturating_sub(before_us)) / span(last_us - before_us);
                before + (last - before) * share
            }
            (_, Some((last_us, last))) if time_us.abs_diff(last_us) <= stale_us => last,
            _ => T::absent(),
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
    /// Roll angles that wait for other signals: time stamp (µs), value, and whether it is a tilt.
    waiting: [(u64, T, bool); ROOM],
    first: usize,
    count: usize,
    sampled_us: Option<u64>,
}

impl<T: Real> Aligner<T> {
    /// An aligner without values.
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
        let tilt = quantity == Quantity::Tilt;
        let paces = quantity == Quantity::Roll
            || (tilt && !self.track(Quantity::Roll).lives(time_us, STALE_US));
        if taken == Taken::Yes && paces && self.sampled_us.is_none_or(|last| time_us > last) {
            self.wait(time_us, value, tilt);
        }
        taken
    }

    /// The next sample, if all its signals have arrived or the waiting time has passed.
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
            u64::MAX => track.last.map_or(T::absent(), |(_, value)| value),
            serves_us => track.at(time_us, serves_us),
        }
    }

    fn track(&self, quantity: Quantity) -> &Track<T> {
        // `index` is below the number of tracks for every quantity.
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

    /// Whether the next value of an active input is needed for this time stamp and has not arrived.
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
        // Without a speed, steer angle and yaw rate do not determine the lateral acceleration.
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
