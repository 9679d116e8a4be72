//! Conversion of the values of sensors to the signals of a sample.

use crate::math::real::Real;
use crate::signal::sample::{Quantity, Sample};

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
    /// Trailer mass in kg as a linear function of the gauge pressure in the air suspension of the
    /// tractor's drive axles: the value at zero (kg), and the slope (kg/Pa). It follows from the
    /// load of the fifth wheel, for a payload in the middle of the trailer.
    pub mass_of_drive_pressure: Option<[T; 2]>,
    /// The smallest and the greatest possible mass of the trailer, kg. Masses outside this range
    /// are ignored.
    pub mass_range_kg: Option<[T; 2]>,
    /// Suspension roll angle of the trailer per difference of its left and right level, rad/m: the
    /// gain of the level sensors divided by their lateral distance.
    pub suspension_roll_of_level: Option<T>,
    /// The same for the level sensors at the drive axles of the tractor.
    pub tractor_suspension_roll_of_level: Option<T>,
}

impl<T: Real> AlignSettings<T> {
    /// No vehicle data.
    pub const NONE: Self = Self {
        steering_ratio: None,
        mass_of_axle_load: None,
        mass_of_suspension_pressure: None,
        mass_of_drive_pressure: None,
        mass_range_kg: None,
        suspension_roll_of_level: None,
        tractor_suspension_roll_of_level: None,
    };

    /// Mean road-wheel angle, rad: the measured one or, if it is absent, the one that follows from
    /// the steering-wheel angle.
    pub fn steer_rad(&self, steer_rad: T, steering_wheel_rad: T) -> T {
        match self.steering_ratio {
            Some(ratio) if !steer_rad.present() => steering_wheel_rad / ratio,
            _ => steer_rad,
        }
    }

    /// One sample of all signals at a time. `at` returns the value of a quantity at this time, NaN if
    /// it is absent. This is the only place where the values of sensors become those of a sample.
    pub fn sample(&self, time_us: u64, at: impl Fn(Quantity) -> T) -> Sample<T> {
        let or = |first: T, second: T| if first.present() { first } else { second };
        let roll_of_levels = |per_m: Option<T>, left: Quantity, right: Quantity| {
            per_m.map_or(T::absent(), |per_m| (at(left) - at(right)) * per_m)
        };
        let (tilt_rad, tractor_tilt_rad) = (at(Quantity::Tilt), at(Quantity::TractorTilt));
        let levels_rad = roll_of_levels(
            self.suspension_roll_of_level,
            Quantity::LevelLeft,
            Quantity::LevelRight,
        );
        let tractor_levels_rad = roll_of_levels(
            self.tractor_suspension_roll_of_level,
            Quantity::TractorLevelLeft,
            Quantity::TractorLevelRight,
        );
        Sample {
            time_us,
            steer_rad: self.steer_rad(at(Quantity::Steer), at(Quantity::SteeringWheel)),
            roll_rad: at(Quantity::Roll),
            roll_to_gravity_rad: at(Quantity::RollToGravity),
            tilt_rad,
            suspension_roll_rad: or(
                at(Quantity::SuspensionRoll),
                or(levels_rad, tilt_rad - at(Quantity::AxleTilt)),
            ),
            speed_mps: at(Quantity::Speed),
            lateral_acceleration_mps2: at(Quantity::LateralAcceleration),
            lateral_specific_force_mps2: at(Quantity::LateralSpecificForce),
            tractor_suspension_roll_rad: or(
                at(Quantity::TractorSuspensionRoll),
                or(tractor_levels_rad, tractor_tilt_rad - at(Quantity::TractorAxleTilt)),
            ),
            tractor_lateral_specific_force_mps2: at(Quantity::TractorLateralSpecificForce),
            tractor_tilt_rad,
            yaw_rate_radps: at(Quantity::YawRate),
            trailer_mass_kg: self.trailer_mass_kg(&at),
        }
    }

    /// Trailer mass, kg: the measured one or, if it is absent, the one that follows from the axle
    /// load, from the pressure in the trailer's suspension, or from that in the tractor's, in this
    /// order. Values that fail [`believes`](Self::believes) are skipped.
    pub fn trailer_mass_kg(&self, at: impl Fn(Quantity) -> T) -> T {
        let (left, right) = (at(Quantity::DrivePressureLeft), at(Quantity::DrivePressureRight));
        let mean = match (left.present(), right.present()) {
            (true, true) => T::of(0.5) * (left + right),
            (true, false) => left,
            _ => right,
        };
        [
            (Quantity::TrailerMass, at(Quantity::TrailerMass)),
            (Quantity::TrailerAxleLoad, at(Quantity::TrailerAxleLoad)),
            (Quantity::TrailerSuspensionPressure, at(Quantity::TrailerSuspensionPressure)),
            (Quantity::DrivePressureLeft, mean),
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
            Quantity::DrivePressureLeft | Quantity::DrivePressureRight => {
                along(self.mass_of_drive_pressure)
            }
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
