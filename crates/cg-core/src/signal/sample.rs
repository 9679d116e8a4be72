//! One row of sensors.
//!
//! Axes and signs, stated here once for the whole project (ISO 8855): x forward,
//! y left, z up. Steer angle, yaw rate and lateral acceleration are positive to
//! the left; roll is positive right side down. A left turn gives all positive.

use crate::math::real::Real;
use crate::signal::unit::Dimension;

/// The table of quantities: a line for each, in the order of [`Quantity::ALL`]. Its columns are the
/// meaning (also the documentation), the variant of [`Quantity`], the field of a row and column of a
/// log, the name, the [`Dimension`], the least and the greatest value that the quantity can physically
/// have on a truck (SI; wide: beyond them a number is a slip of the sensor, the recording or its
/// unit), whether it has a direction, and for how many microseconds a value serves.
///
/// `quantities!(build)` hands the table to a macro `build`, so that all else is made of it: here the
/// enumeration, in `cg_logs::log` the rows and signals of logs.
#[macro_export]
macro_rules! quantities {
    ($build:ident) => {
        $build! {
            /// Mean road-wheel angle of the steered axle, positive to the left.
            Steer steer_rad "steer" Angle [-1.5, 1.5] directed 500_000;
            /// Steering-wheel angle, positive to the left.
            SteeringWheel steering_wheel_rad "steering_wheel" Angle [-60.0, 60.0] directed 500_000;
            /// Roll angle of the trailer's sprung mass to the road, positive right side down.
            Roll roll_rad "roll" Angle [-1.0, 1.0] directed 500_000;
            /// Tilt shown by an accelerometer inclinometer on the trailer: roll plus lateral
            /// acceleration over g.
            Tilt tilt_rad "tilt" Angle [-1.5, 1.5] directed 500_000;
            /// Forward speed.
            Speed speed_mps "speed" Speed [-20.0, 60.0] directed 2_500_000;
            /// Lateral acceleration of the trailer's sprung mass, positive to the left.
            LateralAcceleration lateral_acceleration_mps2 "lateral_acceleration"
                Acceleration [-30.0, 30.0] directed 500_000;
            /// Yaw rate of the trailer, positive to the left.
            YawRate yaw_rate_radps "yaw_rate" AngularRate [-5.0, 5.0] directed 500_000;
            /// Mass of the whole semitrailer as weighed (sprung mass and axles).
            TrailerMass trailer_mass_kg "trailer_mass" Mass [0.0, 200e3] undirected u64::MAX;
            /// Load of the trailer's axles on the road.
            TrailerAxleLoad trailer_axle_load_kg "trailer_axle_load"
                Mass [0.0, 200e3] undirected u64::MAX;
            /// Pressure in the trailer's air suspension, mean of both sides, against the air outside.
            TrailerSuspensionPressure trailer_suspension_pressure_pa "trailer_suspension_pressure"
                Pressure [-101_325.0, 2e6] undirected u64::MAX;
        }
    };
}

macro_rules! directed {
    (directed) => {
        true
    };
    (undirected) => {
        false
    };
}

macro_rules! enumeration {
    ($(
        $(#[doc = $meaning:literal])+
        $variant:ident $field:ident $name:literal $dimension:ident $limits:tt $direction:ident $serves_us:expr;
    )+) => {
        /// What a sensor measures. SI units and signs are those of [`Sample`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Quantity {
            $($(#[doc = $meaning])+ $variant),+
        }

        impl Quantity {
            /// All of them, in their own order.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$variant),+];

            /// How many there are.
            pub const COUNT: usize = [$($name),+].len();

            /// The name without a unit: `roll`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// The name of a column with it in SI, and of the field in a row: `roll_rad`.
            pub const fn column(self) -> &'static str {
                match self { $(Self::$variant => stringify!($field)),+ }
            }

            /// What it is, in a sentence.
            pub const fn meaning(self) -> &'static str {
                match self { $(Self::$variant => concat!($($meaning),+).trim_ascii()),+ }
            }

            /// Which units it may come in.
            pub const fn dimension(self) -> Dimension {
                match self { $(Self::$variant => Dimension::$dimension),+ }
            }

            /// The least and the greatest value that it can physically have on a truck, SI units.
            #[inline]
            pub const fn limits(self) -> [f32; 2] {
                match self { $(Self::$variant => $limits),+ }
            }

            /// Whether it has a direction, so that its sensor can be mounted the other way round.
            pub const fn is_directed(self) -> bool {
                match self { $(Self::$variant => directed!($direction)),+ }
            }

            /// For how long a value serves while no newer one comes, microseconds.
            pub const fn serves_us(self) -> u64 {
                match self { $(Self::$variant => $serves_us),+ }
            }
        }

        words!(Quantity { $($variant => $name, Self::$variant.meaning();)+ });
    };
}

quantities!(enumeration);

impl Quantity {
    /// Its place in [`Quantity::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Whether it can have this value. What cannot be is to be taken for absent; so is NaN, which
    /// is not plausible either.
    #[inline]
    pub fn plausible<T: Real>(self, value: T) -> bool {
        let [least, greatest] = self.limits().map(|limit| T::of(f64::from(limit)));
        value >= least && value <= greatest
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

    /// The same row with every value absent that its quantity [cannot have](Quantity::plausible):
    /// behind this door every number is finite and of a size that a truck knows.
    #[must_use]
    pub fn checked(&self) -> Self {
        let or_absent =
            |quantity: Quantity, x: T| if quantity.plausible(x) { x } else { T::absent() };
        Self {
            time_us: self.time_us,
            steer_rad: or_absent(Quantity::Steer, self.steer_rad),
            roll_rad: or_absent(Quantity::Roll, self.roll_rad),
            tilt_rad: or_absent(Quantity::Tilt, self.tilt_rad),
            speed_mps: or_absent(Quantity::Speed, self.speed_mps),
            lateral_acceleration_mps2: or_absent(
                Quantity::LateralAcceleration,
                self.lateral_acceleration_mps2,
            ),
            yaw_rate_radps: or_absent(Quantity::YawRate, self.yaw_rate_radps),
            trailer_mass_kg: or_absent(Quantity::TrailerMass, self.trailer_mass_kg),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table: a column is the name and the SI unit, and the meaning has no double space of the
    /// lines that it is written in.
    #[test]
    fn a_column_is_the_name_and_its_si_unit() {
        for (place, quantity) in Quantity::ALL.into_iter().enumerate() {
            let (name, column) = (quantity.name(), quantity.column());
            let suffix = column.strip_prefix(name).and_then(|rest| rest.strip_prefix('_'));
            assert_eq!(suffix, Some(quantity.dimension().si().suffix), "{column}");
            assert_eq!(quantity.index(), place);
            assert!(!quantity.meaning().contains("  "), "{}", quantity.meaning());
        }
    }

    #[test]
    fn limits_are_inclusive_and_every_number_outside_is_implausible() {
        for quantity in Quantity::ALL {
            let [least, greatest] = quantity.limits();
            assert!(least < greatest && quantity.plausible(0.0), "{quantity:?}");
            assert!(quantity.plausible(least) && quantity.plausible(f64::from(greatest)));
            for beyond in [least.next_down(), greatest.next_up(), f32::MAX, f32::NAN] {
                assert!(!quantity.plausible(beyond), "{quantity:?} {beyond}");
                assert!(!quantity.plausible(f64::from(beyond)), "{quantity:?} {beyond}");
            }
            assert!(!quantity.plausible(1e308) && !quantity.plausible(f64::NEG_INFINITY));
        }
    }

    /// What trucks do lies well inside: a full lock of a steering wheel (6.5 turns either way), a
    /// tilt in the turn that tips it, a heavy load. Degrees and grams in place of SI do not.
    #[test]
    fn what_trucks_do_is_plausible() {
        for (quantity, usual, wrong) in [
            (Quantity::Steer, 0.8, 45.0),
            (Quantity::SteeringWheel, 41.0, 750.0),
            (Quantity::Roll, 0.35, 8.0),
            (Quantity::Tilt, 1.2, 20.0),
            (Quantity::Speed, 30.0, 90.0),
            (Quantity::LateralAcceleration, -9.0, 900.0),
            (Quantity::YawRate, 0.8, 20.0),
            (Quantity::TrailerMass, 60e3, 20e6),
            (Quantity::TrailerAxleLoad, 40e3, 20e6),
            (Quantity::TrailerSuspensionPressure, 9e5, 9e8),
        ] {
            assert!(quantity.plausible(usual) && !quantity.plausible(wrong), "{quantity:?}");
        }
    }
}
