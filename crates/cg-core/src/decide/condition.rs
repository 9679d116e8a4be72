//! From the signals of a sample, or from the mean of some, to the two roll angles of each channel: the expected and the
//! measured one.
//!
//! * Each input is multiplied by the roll angle that the design expects per unit of it at the
//!   present speed and mass (at the reference height). The scaled input is the expected roll angle
//!   in radians. The ratio identified from it is near one, and slow changes of the speed have no
//!   effect on it.
//! * The steer angle is used at steady speed only. Traction and braking change the response to
//!   steering (by 60 and 100 % per m/s² on the two independent trucks), but hardly the roll angle at a given
//!   lateral acceleration.
//! * Values that a quantity cannot have (NaN, infinite, or outside its
//!   [limits](crate::Quantity::limits)) count as absent. The state of the estimator never contains
//!   such a value.
//! * The lateral acceleration, with hysteresis, decides between turning and straight driving.

use core::fmt;

use crate::decide::neighbors::{Neighbors, Samples, Together};
use crate::decide::signals::{Seen, Signals, seconds};
use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::channel::{CHANNELS, Channel, Input};
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

/// Longitudinal acceleration above which the steer channel is not used. At the sensitivities given
/// above, it changes the ratio by 3 to 5 %.
const STEADY_MPS2: f64 = 0.05;
/// Time constant of the filter of the lateral acceleration that detects turns. It reduces noise of
/// 0.3 m/s² at 100 Hz to 0.04 m/s².
const FELT_FILTER_S: f64 = 0.25;
/// Time constant of each of the two lags whose difference is the longitudinal acceleration. Noise of
/// 0.05 m/s at 50 Hz becomes 0.0035 m/s², and a step of 1 km/h shows as 0.1 m/s² for a moment.
const SPEED_FILTER_S: f64 = 1.0;

/// Whether the steer angle is used at this longitudinal acceleration.
pub(crate) fn is_steady<T: Real>(acceleration_mps2: T) -> bool {
    acceleration_mps2.abs() < T::of(STEADY_MPS2)
}

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

/// One conditioned sample, or the mean of some, the input of the identification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Row<T, const C: usize = CHANNELS> {
    /// Time stamp of the last sample, µs.
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
    /// Last known speed, m/s; the mean of those at the samples.
    pub speed_mps: T,
    /// Longitudinal acceleration by the change of the filtered speed, m/s².
    pub acceleration_mps2: T,
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
    /// What it is the mean of.
    pub(crate) of: Samples<T>,
}

/// Converts samples to rows.
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
    /// Time stamp of the last sample, and of the last row.
    previous_us: Option<u64>,
    row_us: Option<u64>,
    /// The last known speed.
    known_mps: T,
    /// The speed of the last row, at which the gains are.
    speed_mps: T,
    /// The speed after one and after two lags with the time constant [`SPEED_FILTER_S`].
    lagging_mps: Option<[T; 2]>,
    trailer_mass_kg: T,
    /// Whether the gains are not those of the mass.
    is_other_mass: bool,
    turning: bool,
    /// The lateral acceleration after a first-order lag with the time constant [`FELT_FILTER_S`].
    smooth: Option<T>,
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
            row_us: None,
            known_mps: design.nominal_speed_mps,
            speed_mps: design.nominal_speed_mps,
            lagging_mps: None,
            trailer_mass_kg: design.nominal_trailer_mass_kg,
            is_other_mass: false,
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

    /// Whether the truck is in a turn.
    pub(crate) fn is_turning(&self) -> bool {
        self.turning
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
        let seen = self.look(design, sample)?;
        Ok(seen.map(|seen| {
            let mut alone = Neighbors::NONE;
            alone.add(sample.time_us, &seen);
            self.row(design, &alone.take())
        }))
    }

    /// The signals of one sample; `None` if no channel has both a roll angle and an input.
    ///
    /// # Errors
    /// [`SampleError::TimeOrder`] if the time stamp is not greater than the previous one.
    pub(crate) fn look(
        &mut self,
        design: &Design<T, C>,
        sample: &Sample<T>,
    ) -> Result<Option<Seen<T>>, SampleError> {
        let time_us = sample.time_us;
        if let Some(previous_us) = self.previous_us
            && time_us <= previous_us
        {
            return Err(SampleError::TimeOrder { previous_us, time_us });
        }
        self.previous_us = Some(time_us);
        Ok(self.see(design, &sample.checked()))
    }

    /// The signals of a [checked](Sample::checked) sample, or of the mean of some; `None` if no channel has both a roll angle
    /// and an input.
    pub(crate) fn see(&mut self, design: &Design<T, C>, sample: &Sample<T>) -> Option<Seen<T>> {
        let (speed_mps, mass_kg) = (sample.speed_mps, sample.trailer_mass_kg);
        if speed_mps.present() {
            self.known_mps = speed_mps;
        }
        // A scale that shows zero has not measured yet.
        if mass_kg > T::zero() && mass_kg != self.trailer_mass_kg {
            (self.trailer_mass_kg, self.is_other_mass) = (mass_kg, true);
        }
        let signals = Signals::of(sample, self.known_mps, design.gravity_mps2);
        signals.are_seen_by(design).then_some(Seen { signals, speed_mps: self.known_mps })
    }

    /// The row of a mean of some samples.
    #[inline(never)] // one copy in the firmware image, and its memory is free when a maneuver ends
    pub(crate) fn row(&mut self, design: &Design<T, C>, mean: &Together<T, Seen<T>>) -> Row<T, C> {
        let Together { last_us: time_us, mean: Seen { signals, speed_mps }, of } = mean;
        let (time_us, speed_mps) = (*time_us, *speed_mps);
        if speed_mps != self.speed_mps || self.is_other_mass {
            (self.speed_mps, self.is_other_mass) = (speed_mps, false);
            self.update_gains(design);
        }
        let interval_us = self.row_us.map_or(0, |row_us| time_us.saturating_sub(row_us));
        let interval_s = seconds(interval_us);
        self.row_us = Some(time_us);
        let acceleration_mps2 = self.acceleration_mps2(interval_s);
        let steady = is_steady(acceleration_mps2);
        let gains = self.gains.unwrap_or([T::absent(); C]);
        let (mut measured_rad, mut expected_rad) = ([T::absent(); C], [T::absent(); C]);
        for (place, (measured, expected)) in
            measured_rad.iter_mut().zip(&mut expected_rad).enumerate()
        {
            let (Some(channel), Some(gain)) = (design.channel(place), gains.get(place)) else {
                continue;
            };
            *measured = signals.output(channel.output());
            *expected = *gain * signals.input(channel.input());
        }
        let felt = self.felt_mps2(design, signals);
        let smooth_mps2 = self.smooth_mps2(interval_s, felt);
        let limit = if self.turning { STRAIGHT_MPS2 } else { TURNING_MPS2 };
        self.turning = smooth_mps2.abs() > T::of(limit);
        let linear = self.gains.is_some() && smooth_mps2.abs() < T::of(LINEAR_MPS2);
        let mut usable = [linear; C];
        if let Some(place) = design.place(Channel::Steer)
            && let Some(usable) = usable.get_mut(place)
        {
            *usable = linear && steady;
        }
        Row {
            time_us,
            measured_rad,
            expected_rad,
            to_gravity: signals.to_gravity(),
            by_yaw_rate: signals.by_yaw_rate(),
            speed_mps,
            acceleration_mps2,
            trailer_mass_kg: self.trailer_mass_kg,
            lateral_acceleration_mps2: felt,
            turning: self.turning,
            usable,
            of: *of,
        }
    }

    /// The lateral acceleration: measured, or if absent, expected from the steer angle or else from
    /// a specific force.
    fn felt_mps2(&self, design: &Design<T, C>, signals: &Signals<T>) -> T {
        let lateral_mps2 = signals.input(Input::LateralAcceleration);
        if lateral_mps2.present() {
            return lateral_mps2;
        }
        let gain = |channel: Channel| {
            let gain = self.gains.as_ref().and_then(|gains| gains.get(design.place(channel)?));
            gain.copied().unwrap_or(T::absent())
        };
        let roll = gain(Channel::LateralAcceleration);
        let usual = T::of(MOST_ROLL_RAD_PER_G) / design.gravity_mps2;
        let by_roll = if roll.present() { roll } else { usual };
        let steered = gain(Channel::Steer) * signals.input(Input::Steer) / by_roll;
        if steered.present() {
            return steered;
        }
        let (trailer, tractor) = (Input::SpecificForce, Input::TractorSpecificForce);
        let force = signals.input(trailer);
        let force = if force.present() { force } else { signals.input(tractor) };
        // f = a_y (1 + g R); without R the lateral acceleration appears a little too large.
        let roll = if roll.present() { roll } else { T::zero() };
        force / (T::one() + design.gravity_mps2 * roll)
    }

    /// The filtered lateral acceleration: the last one if the sample has none, and zero before the
    /// first.
    fn smooth_mps2(&mut self, interval_s: T, felt: T) -> T {
        if felt.present() {
            let last = self.smooth.unwrap_or(felt);
            let share = interval_s / (T::of(FELT_FILTER_S) + interval_s);
            self.smooth = Some(last + (felt - last) * share);
        }
        self.smooth.unwrap_or(T::zero())
    }

    /// The filtered longitudinal acceleration; zero while the speed is not known.
    fn acceleration_mps2(&mut self, interval_s: T) -> T {
        let filter_s = T::of(SPEED_FILTER_S);
        let share = interval_s / (filter_s + interval_s);
        let [once, twice] = self.lagging_mps.get_or_insert([self.speed_mps; 2]);
        *once += (self.speed_mps - *once) * share;
        *twice += (*once - *twice) * share;
        (*once - *twice) / filter_s
    }
}
