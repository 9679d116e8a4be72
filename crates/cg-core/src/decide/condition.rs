//! From a sample to the two signals of the identification, the expected and the measured roll
//! angle.
//!
//! * The roll angle comes from the roll sensor, or from an inclinometer after its response to the
//!   lateral acceleration is subtracted: `φ = tilt − a_y/g`.
//! * Each input is multiplied by the roll angle that the design expects per unit of it at the
//!   present speed and mass (at the reference height). The scaled input is the expected roll angle
//!   in radians. The ratio identified from it is near one, and slow changes of the speed have no
//!   effect on it.
//! * The steer channel is used at steady speed only. Traction and braking change the response to
//!   steering (by some 60 % per m/s² on the independent truck), but not the roll angle at a given
//!   lateral acceleration.
//! * Values that a quantity cannot have (NaN, infinite, or outside its
//!   [limits](crate::Quantity::limits)) count as absent. The state of the estimator never contains
//!   such a value.
//! * The lateral acceleration, with hysteresis, decides between turning and straight driving.

use core::fmt;

use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::design::Design;

/// Lateral acceleration above which the truck is in a turn.
const TURNING_MPS2: f64 = 0.5;
/// Lateral acceleration below which the truck drives straight again.
const STRAIGHT_MPS2: f64 = 0.3;
/// Lateral acceleration above which the linear model is not accurate.
const LINEAR_MPS2: f64 = 3.5;

/// Longitudinal acceleration above which the steer channel is not used. At the sensitivity given
/// above, it changes the ratio by 3 %.
const STEADY_MPS2: f64 = 0.05;
/// Time constant of the filter of the lateral acceleration that detects turns. It reduces noise of
/// 0.3 m/s² at 100 Hz to 0.04 m/s².
const FELT_FILTER_S: f64 = 0.25;
/// Time constant of the filter that differentiates the speed. Noise of 0.05 m/s becomes 0.025 m/s².
const SPEED_FILTER_S: f64 = 2.0;

/// The reason why the estimator refuses a sample. The state of the estimator is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SampleError {
    /// The time stamp is not greater than the previous one.
    TimeOrder {
        /// Time stamp of the previous sample, µs.
        previous_us: u64,
        /// Time stamp of this sample, µs.
        time_us: u64,
    },
}

impl fmt::Display for SampleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TimeOrder { previous_us, time_us } => {
                write!(f, "time stamp {time_us} µs does not follow {previous_us} µs")
            }
        }
    }
}

impl core::error::Error for SampleError {}

/// One conditioned sample, the input of the identification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Row<T> {
    /// Time stamp, µs.
    pub time_us: u64,
    /// Measured roll angle, rad.
    pub roll_rad: T,
    /// Expected roll angle at the reference height from the input of each channel, rad; NaN if
    /// absent.
    pub expected_rad: [T; 2],
    /// Last known speed, m/s.
    pub speed_mps: T,
    /// Last known trailer mass, kg.
    pub trailer_mass_kg: T,
    /// Lateral acceleration, m/s²: measured, or if absent, expected from the steer angle.
    pub lateral_acceleration_mps2: T,
    /// Whether the truck is in a turn.
    pub turning: bool,
    /// Whether the model of each channel is valid: speed and mass are within the axes of the
    /// design, the lateral acceleration is small enough, and for the steer channel the speed is
    /// steady.
    pub usable: [bool; 2],
}

/// Converts each [`Sample`] to a [`Row`].
#[derive(Clone, Copy, Debug)]
pub struct Conditioner<T> {
    previous_us: Option<u64>,
    speed_mps: T,
    /// The speed after a first-order lag with the time constant [`SPEED_FILTER_S`].
    lagging_mps: Option<T>,
    trailer_mass_kg: T,
    turning: bool,
    /// Time stamp and value of the lateral acceleration after a first-order lag with the time
    /// constant [`FELT_FILTER_S`].
    smooth: Option<(u64, T)>,
    /// Expected roll angle per unit of each input, at the reference height and the present speed
    /// and mass.
    gains: Option<[T; 2]>,
}

impl<T: Real> Conditioner<T> {
    /// A conditioner that has seen no sample.
    pub fn new(design: &Design<T>) -> Self {
        let mut conditioner = Self {
            previous_us: None,
            speed_mps: design.nominal_speed_mps,
            lagging_mps: None,
            trailer_mass_kg: design.nominal_trailer_mass_kg,
            turning: false,
            smooth: None,
            gains: None,
        };
        conditioner.gains = design.gains(conditioner.speed_mps, conditioner.trailer_mass_kg);
        conditioner
    }

    /// Last known trailer mass.
    pub(crate) fn trailer_mass_kg(&self) -> T {
        self.trailer_mass_kg
    }

    /// Sets the trailer mass if it is known before the first sample.
    pub(crate) fn weigh(&mut self, design: &Design<T>, trailer_mass_kg: T) {
        self.trailer_mass_kg = trailer_mass_kg;
        self.gains = design.gains(self.speed_mps, self.trailer_mass_kg);
    }

    /// Conditions one sample; `None` if it has no roll angle or no input.
    ///
    /// # Errors
    /// [`SampleError::TimeOrder`] if the time stamp is not greater than the previous one.
    pub fn push(
        &mut self,
        design: &Design<T>,
        sample: &Sample<T>,
    ) -> Result<Option<Row<T>>, SampleError> {
        let sample = &sample.checked();
        let time_us = sample.time_us;
        if let Some(previous_us) = self.previous_us
            && time_us <= previous_us
        {
            return Err(SampleError::TimeOrder { previous_us, time_us });
        }
        let interval_us = self.previous_us.map_or(0, |previous_us| time_us - previous_us);
        self.previous_us = Some(time_us);
        self.schedule(design, sample);
        let steady = self.acceleration_mps2(seconds(interval_us)).abs() < T::of(STEADY_MPS2);

        let lateral = if sample.lateral_acceleration_mps2.present() {
            sample.lateral_acceleration_mps2
        } else {
            sample.yaw_rate_radps * self.speed_mps
        };
        let roll_rad = if sample.roll_rad.present() {
            sample.roll_rad
        } else {
            sample.tilt_rad - lateral / design.gravity_mps2
        };
        if !roll_rad.present() || !(sample.steer_rad.present() || lateral.present()) {
            return Ok(None);
        }
        let gains = self.gains.unwrap_or([T::absent(); 2]);
        let expected_rad = [gains[0] * sample.steer_rad, gains[1] * lateral];
        let felt = if lateral.present() { lateral } else { expected_rad[0] / gains[1] };
        let smooth_mps2 = self.smooth_mps2(time_us, felt);
        let limit = if self.turning { STRAIGHT_MPS2 } else { TURNING_MPS2 };
        self.turning = smooth_mps2.abs() > T::of(limit);
        let linear = self.gains.is_some() && smooth_mps2.abs() < T::of(LINEAR_MPS2);
        Ok(Some(Row {
            time_us,
            roll_rad,
            expected_rad,
            speed_mps: self.speed_mps,
            trailer_mass_kg: self.trailer_mass_kg,
            lateral_acceleration_mps2: felt,
            turning: self.turning,
            usable: [linear && steady, linear],
        }))
    }

    /// The filtered lateral acceleration: the last one if the sample has none, and zero before the
    /// first.
    fn smooth_mps2(&mut self, time_us: u64, felt: T) -> T {
        if felt.present() {
            let (last_us, last) = self.smooth.unwrap_or((time_us, felt));
            let interval_s: T = seconds(time_us - last_us);
            let share = interval_s / (T::of(FELT_FILTER_S) + interval_s);
            self.smooth = Some((time_us, last + (felt - last) * share));
        }
        self.smooth.map_or(T::zero(), |(_, smooth)| smooth)
    }

    /// The filtered longitudinal acceleration; zero while the speed is not known.
    fn acceleration_mps2(&mut self, interval_s: T) -> T {
        let filter_s = T::of(SPEED_FILTER_S);
        let lagging = self.lagging_mps.get_or_insert(self.speed_mps);
        *lagging += (self.speed_mps - *lagging) * interval_s / (filter_s + interval_s);
        (self.speed_mps - *lagging) / filter_s
    }

    /// Stores the last known speed and mass, and the gains for them.
    fn schedule(&mut self, design: &Design<T>, sample: &Sample<T>) {
        let (speed, mass) = (sample.speed_mps, sample.trailer_mass_kg);
        let new_speed = speed.present() && speed != self.speed_mps;
        // A scale that shows zero has not measured yet.
        let new_mass = mass > T::zero() && mass != self.trailer_mass_kg;
        if new_speed {
            self.speed_mps = speed;
        }
        if new_mass {
            self.trailer_mass_kg = mass;
        }
        if new_speed || new_mass {
            self.gains = design.gains(self.speed_mps, self.trailer_mass_kg);
        }
    }
}

/// Microseconds to seconds.
pub(crate) fn seconds<T: Real>(interval_us: u64) -> T {
    // An interval of more than an hour is a gap of any length. Shorter intervals fit into 32 bits.
    T::of(f64::from(u32::try_from(interval_us).unwrap_or(u32::MAX))) * T::of(1e-6)
}
