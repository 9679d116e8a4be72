//! One row of sensors.
//!
//! Axes and signs, stated here once for the whole project (ISO 8855): x forward,
//! y left, z up. Steer angle, yaw rate and lateral acceleration are positive to
//! the left; roll is positive right side down. A left turn gives all positive.

use crate::real::Real;

/// What a sensor measures. SI units and signs are those of [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Mean road-wheel angle of the steered axle, rad.
    Steer,
    /// Steering-wheel angle, rad.
    SteeringWheel,
    /// Roll angle of the trailer, rad.
    Roll,
    /// Tilt shown by an accelerometer inclinometer on the trailer, rad.
    Tilt,
    /// Forward speed, m/s.
    Speed,
    /// Lateral acceleration, m/s².
    LateralAcceleration,
    /// Yaw rate, rad/s.
    YawRate,
    /// Mass of the whole semitrailer, kg.
    TrailerMass,
    /// Load of the trailer's axles on the road, kg.
    TrailerAxleLoad,
    /// Pressure in the trailer's air suspension, Pa.
    TrailerSuspensionPressure,
}

impl Quantity {
    /// How many there are.
    pub const COUNT: usize = 10;

    /// All of them, in their own order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Steer,
        Self::SteeringWheel,
        Self::Roll,
        Self::Tilt,
        Self::Speed,
        Self::LateralAcceleration,
        Self::YawRate,
        Self::TrailerMass,
        Self::TrailerAxleLoad,
        Self::TrailerSuspensionPressure,
    ];

    /// Its place in [`Quantity::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// One row of sensors, SI units, ISO 8855 signs. A signal that is not there is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// Time stamp, microseconds from any origin, strictly increasing.
    pub time_us: u64,
    /// Mean road-wheel angle of the steered axle, positive to the left.
    pub steer_rad: T,
    /// Roll angle of the trailer's sprung mass to the road, positive right side down.
    pub roll_rad: T,
    /// What an accelerometer inclinometer shows: roll plus lateral acceleration over g.
    /// Used when `roll_rad` is absent.
    pub tilt_rad: T,
    /// Forward speed.
    pub speed_mps: T,
    /// Lateral acceleration of the trailer's sprung mass, positive to the left.
    pub lateral_acceleration_mps2: T,
    /// Trailer yaw rate, positive to the left; times speed it stands in for an absent
    /// lateral acceleration.
    pub yaw_rate_radps: T,
    /// Mass of the whole semitrailer as weighed (sprung mass and axles).
    pub trailer_mass_kg: T,
}

impl<T: Real> Sample<T> {
    /// A row with every signal absent.
    pub fn absent(time_us: u64) -> Self {
        let nan = T::absent();
        Self {
            time_us,
            steer_rad: nan,
            roll_rad: nan,
            tilt_rad: nan,
            speed_mps: nan,
            lateral_acceleration_mps2: nan,
            yaw_rate_radps: nan,
            trailer_mass_kg: nan,
        }
    }
}
