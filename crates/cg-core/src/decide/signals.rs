//! The roll angles and inputs of all channels in a sample.
//!
//! * The roll angle comes from a roll sensor: relative to the road, or else relative to gravity
//!   (`φ + β`; on a banked road this is another angle). An inclinometer
//!   shows the specific force divided by g. With a known lateral acceleration it gives the roll
//!   angle relative to gravity, `(f − a_y)/g`.
//! * The lateral acceleration is measured, or it is the yaw rate times the speed, or the specific
//!   force without its gravity, `f − g (φ + β)`.

use crate::math::real::Real;
use crate::signal::sample::Sample;
use crate::truck::channel::{Input, Output};
use crate::truck::design::Design;

/// The roll angles and inputs of all channels in a sample; NaN if absent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Signals<T> {
    /// In the order of [`Output`] and of [`Input`].
    outputs: [T; 3],
    inputs: [T; 4],
    to_gravity: bool,
    by_yaw_rate: bool,
}

impl<T: Real> Signals<T> {
    /// All values are zero.
    pub(crate) const ZERO: Self =
        Self { outputs: [T::ZERO; 3], inputs: [T::ZERO; 4], to_gravity: false, by_yaw_rate: false };

    /// The signals of a [checked](Sample::checked) sample at a speed.
    pub fn of(sample: &Sample<T>, speed_mps: T, gravity_mps2: T) -> Self {
        let or = |first: T, second: T| if first.present() { first } else { second };
        let force_mps2 = or(sample.lateral_specific_force_mps2, gravity_mps2 * sample.tilt_rad);
        let measured = or(sample.lateral_acceleration_mps2, sample.yaw_rate_radps * speed_mps);
        let lateral_mps2 = or(measured, force_mps2 - gravity_mps2 * sample.roll_to_gravity_rad);
        let to_gravity_rad =
            or(sample.roll_to_gravity_rad, (force_mps2 - lateral_mps2) / gravity_mps2);
        let tractor_force_mps2 =
            or(sample.tractor_lateral_specific_force_mps2, gravity_mps2 * sample.tractor_tilt_rad);
        Self {
            outputs: [
                or(sample.roll_rad, to_gravity_rad),
                sample.suspension_roll_rad,
                sample.tractor_suspension_roll_rad,
            ],
            inputs: [sample.steer_rad, lateral_mps2, force_mps2, tractor_force_mps2],
            to_gravity: !sample.roll_rad.present() && to_gravity_rad.present(),
            by_yaw_rate: measured.present() && !sample.lateral_acceleration_mps2.present(),
        }
    }

    /// Whether any channel of a design has both its roll angle and its input.
    pub fn are_seen_by<const C: usize>(&self, design: &Design<T, C>) -> bool {
        (0..C).filter_map(|place| design.channel(place)).any(|channel| {
            self.output(channel.output()).present() && self.input(channel.input()).present()
        })
    }

    /// Whether the trailer's roll angle is relative to gravity.
    pub fn to_gravity(&self) -> bool {
        self.to_gravity
    }

    /// Whether the lateral acceleration is that of the yaw rate.
    pub(crate) fn by_yaw_rate(&self) -> bool {
        self.by_yaw_rate
    }

    /// A roll angle, rad.
    pub fn output(&self, output: Output) -> T {
        let [roll_rad, suspension_rad, tractor_suspension_rad] = self.outputs;
        match output {
            Output::Roll => roll_rad,
            Output::SuspensionRoll => suspension_rad,
            Output::TractorSuspensionRoll => tractor_suspension_rad,
        }
    }

    /// An input, rad or m/s².
    pub fn input(&self, input: Input) -> T {
        let [steer_rad, lateral_mps2, force_mps2, tractor_force_mps2] = self.inputs;
        match input {
            Input::Steer => steer_rad,
            Input::LateralAcceleration => lateral_mps2,
            Input::SpecificForce => force_mps2,
            Input::TractorSpecificForce => tractor_force_mps2,
        }
    }

    /// Whether the same signals are present in both, from the same sensors.
    pub(crate) fn has_kinds_of(&self, other: &Self) -> bool {
        let same = |(a, b): (&T, &T)| a.present() == b.present();
        self.to_gravity == other.to_gravity
            && self.by_yaw_rate == other.by_yaw_rate
            && self.outputs.iter().zip(&other.outputs).all(same)
            && self.inputs.iter().zip(&other.inputs).all(same)
    }

    /// Adds the values of another sample with the same [kinds](Self::kinds).
    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, value) in self.outputs.iter_mut().zip(other.outputs) {
            *sum += value;
        }
        for (sum, value) in self.inputs.iter_mut().zip(other.inputs) {
            *sum += value;
        }
    }

    /// All values multiplied by a factor.
    pub(crate) fn scaled(&self, factor: T) -> Self {
        let (outputs, inputs) =
            (self.outputs.map(|value| value * factor), self.inputs.map(|value| value * factor));
        Self { outputs, inputs, ..*self }
    }
}

/// What samples have of which a mean can be made.
pub trait Averaged<T>: Copy {
    /// A value before the first sample.
    const NONE: Self;

    /// The roll angle of the trailer, rad, whose scatter about the mean is kept; NaN if it is absent.
    fn roll_rad(&self) -> T;

    /// Whether the same signals are present in both, from the same sensors.
    fn has_kinds_of(&self, other: &Self) -> bool;

    /// Adds the values of another sample of the same kinds.
    fn add(&mut self, other: &Self);

    /// All sums multiplied by a factor.
    #[must_use]
    fn scaled(&self, factor: T) -> Self;
}

/// The signals of one sample, with the last known speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Seen<T> {
    pub(crate) signals: Signals<T>,
    pub(crate) speed_mps: T,
}

impl<T: Real> Averaged<T> for Seen<T> {
    const NONE: Self = Self { signals: Signals::ZERO, speed_mps: T::ZERO };

    fn roll_rad(&self) -> T {
        self.signals.output(Output::Roll)
    }

    fn has_kinds_of(&self, other: &Self) -> bool {
        self.signals.has_kinds_of(&other.signals)
    }

    fn add(&mut self, other: &Self) {
        self.signals.add(&other.signals);
        self.speed_mps += other.speed_mps;
    }

    fn scaled(&self, factor: T) -> Self {
        Self { signals: self.signals.scaled(factor), speed_mps: self.speed_mps * factor }
    }
}

/// Microseconds to seconds.
pub(crate) fn seconds<T: Real>(interval_us: u64) -> T {
    // An interval of more than an hour is a gap of any length. Shorter intervals fit into 32 bits.
    T::of(f64::from(u32::try_from(interval_us).unwrap_or(u32::MAX))) * T::of(1e-6)
}
