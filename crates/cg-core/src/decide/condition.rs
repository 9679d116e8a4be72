//! From a sample to the two signals of each channel, the expected and the measured roll angle.
//!
//! * The roll angle comes from a roll sensor: relative to the road, or else relative to gravity
//!   (`φ + β`; on a banked road this is another angle, see [`Row::to_gravity`]). An inclinometer
//!   shows the specific force divided by g. With a known lateral acceleration it gives the roll
//!   angle relative to gravity, `(f − a_y)/g`.
//! * The lateral acceleration is measured, or it is the yaw rate times the speed, or the specific
//!   force without its gravity, `f − g (φ + β)`.
//! * Each input is multiplied by the roll angle that the design expects per unit of it at the
//!   present speed and mass (at the reference height). The scaled input is the expected roll angle
//!   in radians. The ratio identified from it is near one, and slow changes of the speed have no
//!   effect on it.
//! * The steer angle is used at steady speed only. Traction and braking change the response to
//!   steering (by some 60 % per m/s² on the independent truck), but not the roll angle at a given
//!   lateral acceleration.
//! * Values that a quantity cannot have (NaN, infinite, or outside its
//!   [limits](crate::Quantity::limits)) count as absent. The state of the estimator never contains
//!   such a value.
//! * The lateral acceleration, with hysteresis, decides between turning and straight driving.

use core::fmt;

use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::channel::{CHANNELS, Channel, Input, Output};
use crate::truck::design::Design;
use crate::truck::gains::Gains;

/// Lateral acceleration above which the truck is in a turn.
const TURNING_MPS2: f64 = 0.5;
/// Roll angle of a high load at 1 g, used for the lateral acceleration that a steer angle causes if the
/// design does not have the channel from lateral acceleration to roll angle. It is at the upper end,
/// so that the bank of the road counts for more.
const MOST_ROLL_RAD_PER_G: f64 = 0.2;
/// Lateral acceleration below which the truck drives straight again.
pub(crate) const STRAIGHT_MPS2: f64 = 0.3;
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
pub struct Row<T, const C: usize = CHANNELS> {
    /// Time stamp, µs.
    pub time_us: u64,
    /// Measured roll angle of each channel, rad; NaN if absent. The order is that of
    /// [`Design::channels`].
    pub measured_rad: [T; C],
    /// Expected roll angle at the reference height from the input of each channel, rad; NaN if
    /// absent.
    pub expected_rad: [T; C],
    /// Whether the trailer's roll angle is relative to gravity and thus contains the bank of the
    /// road.
    pub to_gravity: bool,
    /// Whether the lateral acceleration is that of the yaw rate.
    pub by_yaw_rate: bool,
    /// Last known speed, m/s.
    pub speed_mps: T,
    /// Last known trailer mass, kg.
    pub trailer_mass_kg: T,
    /// Lateral acceleration, m/s²: measured, or if absent, expected from the steer angle or from a
    /// specific force.
    pub lateral_acceleration_mps2: T,
    /// Whether the truck is in a turn.
    pub turning: bool,
    /// Whether the model of each channel is valid: speed and mass are within the axes of the
    /// design, the lateral acceleration is small enough, and for the steer angle the speed is
    /// steady.
    pub usable: [bool; C],
}

/// Converts each [`Sample`] to a [`Row`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; C]: serde::Deserialize<'de>"
    ))
)]
pub struct Conditioner<T, const C: usize = CHANNELS> {
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
    gains: Option<[T; C]>,
    /// The same as functions of the speed, as long as they hold.
    #[cfg_attr(feature = "serde", serde(skip))]
    curves: Option<Gains<T, C>>,
}

impl<T: Real, const C: usize> Conditioner<T, C> {
    /// A conditioner that has seen no sample.
    pub fn new(design: &Design<T, C>) -> Self {
        let mut conditioner = Self {
            previous_us: None,
            speed_mps: design.nominal_speed_mps,
            lagging_mps: None,
            trailer_mass_kg: design.nominal_trailer_mass_kg,
            turning: false,
            smooth: None,
            gains: None,
            curves: None,
        };
        conditioner.update_gains(design);
        conditioner
    }

    /// Last known trailer mass.
    pub(crate) fn trailer_mass_kg(&self) -> T {
        self.trailer_mass_kg
    }

    /// Sets the trailer mass if it is known before the first sample.
    pub(crate) fn weigh(&mut self, design: &Design<T, C>, trailer_mass_kg: T) {
        self.trailer_mass_kg = trailer_mass_kg;
        self.update_gains(design);
    }

    /// Computes the gains at the present speed and mass.
    fn update_gains(&mut self, design: &Design<T, C>) {
        let (speed_mps, mass_kg) = (self.speed_mps, self.trailer_mass_kg);
        let at = |curves: &Gains<T, C>| curves.at(design, speed_mps, mass_kg);
        self.gains = self.curves.as_ref().and_then(at);
        if self.gains.is_none() {
            self.curves = Gains::around(design, speed_mps, mass_kg);
            self.gains = self.curves.as_ref().and_then(at);
        }
    }

    /// Conditions one sample; `None` if no channel has both a roll angle and an input.
    ///
    /// # Errors
    /// [`SampleError::TimeOrder`] if the time stamp is not greater than the previous one.
    pub fn push(
        &mut self,
        design: &Design<T, C>,
        sample: &Sample<T>,
    ) -> Result<Option<Row<T, C>>, SampleError> {
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

        let signals = Signals::of(sample, self.speed_mps, design.gravity_mps2);
        let gains = self.gains.unwrap_or([T::absent(); C]);
        let (mut measured_rad, mut expected_rad) = ([T::absent(); C], [T::absent(); C]);
        let mut absent = true;
        for (place, (measured, expected)) in
            measured_rad.iter_mut().zip(&mut expected_rad).enumerate()
        {
            let (Some(channel), Some(gain)) = (design.channel(place), gains.get(place)) else {
                continue;
            };
            let input = signals.input(channel.input());
            *measured = signals.output(channel.output());
            *expected = *gain * input;
            absent &= !(measured.present() && input.present());
        }
        if absent {
            return Ok(None);
        }
        let felt = self.felt_mps2(design, &signals);
        let smooth_mps2 = self.smooth_mps2(time_us, felt);
        let limit = if self.turning { STRAIGHT_MPS2 } else { TURNING_MPS2 };
        self.turning = smooth_mps2.abs() > T::of(limit);
        let linear = self.gains.is_some() && smooth_mps2.abs() < T::of(LINEAR_MPS2);
        let mut usable = [linear; C];
        if let Some(place) = design.place(Channel::Steer)
            && let Some(usable) = usable.get_mut(place)
        {
            *usable = linear && steady;
        }
        Ok(Some(Row {
            time_us,
            measured_rad,
            expected_rad,
            to_gravity: signals.to_gravity,
            by_yaw_rate: signals.by_yaw_rate,
            speed_mps: self.speed_mps,
            trailer_mass_kg: self.trailer_mass_kg,
            lateral_acceleration_mps2: felt,
            turning: self.turning,
            usable,
        }))
    }

    /// The lateral acceleration: measured, or if absent, expected from the steer angle or else from
    /// a specific force.
    fn felt_mps2(&self, design: &Design<T, C>, signals: &Signals<T>) -> T {
        if signals.lateral_mps2.present() {
            return signals.lateral_mps2;
        }
        let gain = |channel: Channel| {
            let gain = self.gains.as_ref().and_then(|gains| gains.get(design.place(channel)?));
            gain.copied().unwrap_or(T::absent())
        };
        let roll = gain(Channel::LateralAcceleration);
        let usual = T::of(MOST_ROLL_RAD_PER_G) / design.gravity_mps2;
        let by_roll = if roll.present() { roll } else { usual };
        let steered = gain(Channel::Steer) * signals.steer_rad / by_roll;
        if steered.present() {
            return steered;
        }
        let force = if signals.force_mps2.present() {
            signals.force_mps2
        } else {
            signals.tractor_force_mps2
        };
        // f = a_y (1 + g R); without R the lateral acceleration appears a little too large.
        let roll = if roll.present() { roll } else { T::zero() };
        force / (T::one() + design.gravity_mps2 * roll)
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
    fn schedule(&mut self, design: &Design<T, C>, sample: &Sample<T>) {
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
            self.update_gains(design);
        }
    }
}

/// The roll angles and inputs of all channels in a sample; NaN if absent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signals<T> {
    steer_rad: T,
    lateral_mps2: T,
    force_mps2: T,
    tractor_force_mps2: T,
    roll_rad: T,
    to_gravity: bool,
    by_yaw_rate: bool,
    suspension_rad: T,
    tractor_suspension_rad: T,
}

impl<T: Real> Signals<T> {
    /// The signals of a [checked](Sample::checked) sample at a speed.
    pub fn of(sample: &Sample<T>, speed_mps: T, gravity_mps2: T) -> Self {
        let or = |first: T, second: T| if first.present() { first } else { second };
        let force_mps2 = or(sample.lateral_specific_force_mps2, gravity_mps2 * sample.tilt_rad);
        let measured = or(sample.lateral_acceleration_mps2, sample.yaw_rate_radps * speed_mps);
        let lateral_mps2 = or(measured, force_mps2 - gravity_mps2 * sample.roll_to_gravity_rad);
        let to_gravity_rad =
            or(sample.roll_to_gravity_rad, (force_mps2 - lateral_mps2) / gravity_mps2);
        Self {
            steer_rad: sample.steer_rad,
            lateral_mps2,
            force_mps2,
            tractor_force_mps2: or(
                sample.tractor_lateral_specific_force_mps2,
                gravity_mps2 * sample.tractor_tilt_rad,
            ),
            roll_rad: or(sample.roll_rad, to_gravity_rad),
            to_gravity: !sample.roll_rad.present() && to_gravity_rad.present(),
            by_yaw_rate: measured.present() && !sample.lateral_acceleration_mps2.present(),
            suspension_rad: sample.suspension_roll_rad,
            tractor_suspension_rad: sample.tractor_suspension_roll_rad,
        }
    }

    /// Whether the trailer's roll angle is relative to gravity.
    pub fn to_gravity(&self) -> bool {
        self.to_gravity
    }

    /// A roll angle, rad.
    pub fn output(&self, output: Output) -> T {
        match output {
            Output::Roll => self.roll_rad,
            Output::SuspensionRoll => self.suspension_rad,
            Output::TractorSuspensionRoll => self.tractor_suspension_rad,
        }
    }

    /// An input, rad or m/s².
    pub fn input(&self, input: Input) -> T {
        match input {
            Input::Steer => self.steer_rad,
            Input::LateralAcceleration => self.lateral_mps2,
            Input::SpecificForce => self.force_mps2,
            Input::TractorSpecificForce => self.tractor_force_mps2,
        }
    }
}

/// Microseconds to seconds.
pub(crate) fn seconds<T: Real>(interval_us: u64) -> T {
    // An interval of more than an hour is a gap of any length. Shorter intervals fit into 32 bits.
    T::of(f64::from(u32::try_from(interval_us).unwrap_or(u32::MAX))) * T::of(1e-6)
}
