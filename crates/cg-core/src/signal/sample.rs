//! Quantities that sensors measure, and one sample of all signals.
//!
//! Axes and signs are defined here for the whole project (ISO 8855): x forward, y left, z up. Steer
//! angle, yaw rate and lateral acceleration are positive to the left. Roll is positive if the right
//! side goes down. In a left turn all of them are positive.

use crate::math::real::Real;
use crate::signal::unit::Dimension;

/// The table of quantities, in the order of [`Quantity::ALL`]. Its columns are: the meaning (also
/// used as documentation); the variant of [`Quantity`]; the field of a row and column of a log; the
/// name; the [`Dimension`]; the smallest and the greatest value that the quantity can physically
/// have on a truck (SI units; values outside this wide range are errors of the sensor, the
/// recording or the unit); whether it has a direction; and for how many microseconds a value is
/// valid.
///
/// `quantities!(build)` passes the table to the macro `build`, which generates code from it: the
/// enumeration here, the rows and signals of logs in `cg_logs::log`.
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
            /// The same from a second sensor, at another place along a trailer whose frame twists.
            SecondRoll second_roll_rad "second_roll" Angle [-1.0, 1.0] directed 500_000;
            /// Roll angle of the trailer's sprung mass to gravity (roll plus the bank of the road),
            /// positive right side down.
            RollToGravity roll_to_gravity_rad "roll_to_gravity" Angle [-1.0, 1.0] directed 500_000;
            /// Tilt shown by an accelerometer-type inclinometer on the trailer's body: its specific
            /// force divided by g.
            Tilt tilt_rad "tilt" Angle [-1.5, 1.5] directed 500_000;
            /// Tilt shown by an accelerometer-type inclinometer on an axle of the trailer.
            AxleTilt axle_tilt_rad "axle_tilt" Angle [-1.5, 1.5] directed 500_000;
            /// Roll angle of the trailer's sprung mass to its axles, positive right side down.
            SuspensionRoll suspension_roll_rad "suspension_roll" Angle [-1.0, 1.0] directed 500_000;
            /// Height of the trailer's body above its axles on the left side.
            LevelLeft level_left_m "level_left" Length [-4.0, 4.0] undirected 500_000;
            /// Height of the trailer's body above its axles on the right side.
            LevelRight level_right_m "level_right" Length [-4.0, 4.0] undirected 500_000;
            /// Forward speed.
            Speed speed_mps "speed" Speed [-20.0, 60.0] directed 2_500_000;
            /// Lateral acceleration of the trailer's sprung mass, positive to the left.
            LateralAcceleration lateral_acceleration_mps2 "lateral_acceleration"
                Acceleration [-30.0, 30.0] directed 500_000;
            /// Reading of an accelerometer fixed to the trailer's body, along its lateral axis,
            /// gravity included, positive to the left.
            LateralSpecificForce lateral_specific_force_mps2 "lateral_specific_force"
                Acceleration [-30.0, 30.0] directed 500_000;
            /// Reading of an accelerometer fixed to the tractor's body, along its lateral axis,
            /// gravity included, positive to the left.
            TractorLateralSpecificForce tractor_lateral_specific_force_mps2
                "tractor_lateral_specific_force" Acceleration [-30.0, 30.0] directed 500_000;
            /// Roll angle of the tractor's sprung mass to its drive axles, positive right side down.
            TractorSuspensionRoll tractor_suspension_roll_rad "tractor_suspension_roll"
                Angle [-1.0, 1.0] directed 500_000;
            /// Tilt shown by an accelerometer-type inclinometer on the tractor's body.
            TractorTilt tractor_tilt_rad "tractor_tilt" Angle [-1.5, 1.5] directed 500_000;
            /// Tilt shown by an accelerometer-type inclinometer on a drive axle of the tractor.
            TractorAxleTilt tractor_axle_tilt_rad "tractor_axle_tilt" Angle [-1.5, 1.5] directed
                500_000;
            /// Height of the tractor's body above its drive axles on the left side.
            TractorLevelLeft tractor_level_left_m "tractor_level_left" Length [-4.0, 4.0] undirected
                500_000;
            /// Height of the tractor's body above its drive axles on the right side.
            TractorLevelRight tractor_level_right_m "tractor_level_right" Length [-4.0, 4.0]
                undirected 500_000;
            /// Yaw rate of the trailer, positive to the left.
            YawRate yaw_rate_radps "yaw_rate" AngularRate [-5.0, 5.0] directed 500_000;
            /// Mass of the whole semitrailer as weighed (sprung mass and axles).
            TrailerMass trailer_mass_kg "trailer_mass" Mass [0.0, 200e3] undirected u64::MAX;
            /// Load of the trailer's axles on the road.
            TrailerAxleLoad trailer_axle_load_kg "trailer_axle_load"
                Mass [0.0, 200e3] undirected u64::MAX;
            /// Gauge pressure in the trailer's air suspension (above atmospheric), mean of both
            /// sides.
            TrailerSuspensionPressure trailer_suspension_pressure_pa "trailer_suspension_pressure"
                Pressure [-101_325.0, 2e6] undirected u64::MAX;
            /// Gauge pressure in the air suspension of the tractor's drive axles, left side.
            DrivePressureLeft drive_pressure_left_pa "drive_pressure_left"
                Pressure [-101_325.0, 2e6] undirected u64::MAX;
            /// Gauge pressure in the air suspension of the tractor's drive axles, right side.
            DrivePressureRight drive_pressure_right_pa "drive_pressure_right"
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
        /// A quantity that a sensor measures. SI units and signs are those of [`Sample`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Quantity {
            $($(#[doc = $meaning])+ $variant),+
        }

        impl Quantity {
            /// All quantities in the order of the table.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$variant),+];

            /// Number of quantities.
            pub const COUNT: usize = [$($name),+].len();

            /// The name without the unit, such as `roll`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// The name with the SI unit, such as `roll_rad`: the column of a log and the field of
            /// a row.
            pub const fn column(self) -> &'static str {
                match self { $(Self::$variant => stringify!($field)),+ }
            }

            /// The meaning of the quantity in one sentence.
            pub const fn meaning(self) -> &'static str {
                match self { $(Self::$variant => concat!($($meaning),+).trim_ascii()),+ }
            }

            /// The dimension, which determines the possible units.
            pub const fn dimension(self) -> Dimension {
                match self { $(Self::$variant => Dimension::$dimension),+ }
            }

            /// The smallest and the greatest value that is physically possible on a truck, SI
            /// units.
            #[inline]
            pub const fn limits(self) -> [f32; 2] {
                match self { $(Self::$variant => $limits),+ }
            }

            /// Whether the sign depends on how the sensor is mounted.
            pub const fn is_directed(self) -> bool {
                match self { $(Self::$variant => directed!($direction)),+ }
            }

            /// For how long a value is valid if no newer one arrives, microseconds.
            pub const fn serves_us(self) -> u64 {
                match self { $(Self::$variant => $serves_us),+ }
            }
        }

        words!(Quantity { $($variant => $name, Self::$variant.meaning();)+ });
    };
}

quantities!(enumeration);

impl Quantity {
    /// The index in [`Quantity::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Whether the value is within the [limits](Self::limits). Values outside them, and NaN, are to
    /// be treated as absent.
    #[inline]
    pub fn plausible<T: Real>(self, value: T) -> bool {
        let [least, greatest] = self.limits().map(|limit| T::of(f64::from(limit)));
        value >= least && value <= greatest
    }
}

/// The values of all signals at one time, in SI units with the signs of ISO 8855. An absent signal
/// is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// Time stamp in microseconds from any origin, strictly increasing.
    pub time_us: u64,
    /// Mean road-wheel angle of the steered axle, rad, positive to the left.
    pub steer_rad: T,
    /// Roll angle of the trailer's sprung mass relative to the road, rad, positive right side down.
    pub roll_rad: T,
    /// Roll angle of the trailer's sprung mass relative to gravity, rad. It is used if `roll_rad` is
    /// absent.
    pub roll_to_gravity_rad: T,
    /// Angle shown by an accelerometer-type inclinometer on the trailer's body, rad: the specific
    /// force divided by g, which replaces an absent `lateral_specific_force_mps2`.
    pub tilt_rad: T,
    /// Roll angle of the trailer's sprung mass relative to its axles, rad.
    pub suspension_roll_rad: T,
    /// Forward speed, m/s.
    pub speed_mps: T,
    /// Lateral acceleration of the trailer's sprung mass, m/s², positive to the left.
    pub lateral_acceleration_mps2: T,
    /// Lateral specific force of the trailer's body (accelerometer fixed to it, gravity included),
    /// m/s², positive to the left.
    pub lateral_specific_force_mps2: T,
    /// Roll angle of the tractor's sprung mass relative to its drive axles, rad.
    pub tractor_suspension_roll_rad: T,
    /// Lateral specific force of the tractor's body, m/s², positive to the left.
    pub tractor_lateral_specific_force_mps2: T,
    /// Angle shown by an accelerometer-type inclinometer on the tractor's body, rad: the specific
    /// force divided by g, which replaces an absent `tractor_lateral_specific_force_mps2`.
    pub tractor_tilt_rad: T,
    /// Yaw rate of the trailer, rad/s, positive to the left. Yaw rate times speed replaces an
    /// absent lateral acceleration.
    pub yaw_rate_radps: T,
    /// Mass of the whole semitrailer as weighed (sprung mass and axles), kg.
    pub trailer_mass_kg: T,
}

impl<T: Real> Sample<T> {
    /// A sample in which every signal is absent.
    pub fn absent(time_us: u64) -> Self {
        let nan = T::absent();
        Self {
            time_us,
            steer_rad: nan,
            roll_rad: nan,
            roll_to_gravity_rad: nan,
            tilt_rad: nan,
            suspension_roll_rad: nan,
            speed_mps: nan,
            lateral_acceleration_mps2: nan,
            lateral_specific_force_mps2: nan,
            tractor_suspension_roll_rad: nan,
            tractor_lateral_specific_force_mps2: nan,
            tractor_tilt_rad: nan,
            yaw_rate_radps: nan,
            trailer_mass_kg: nan,
        }
    }

    /// A copy in which every value that its quantity [cannot have](Quantity::plausible) is absent.
    /// All other values are finite and within the limits of their quantities.
    #[must_use]
    pub fn checked(&self) -> Self {
        let or_absent =
            |quantity: Quantity, x: T| if quantity.plausible(x) { x } else { T::absent() };
        Self {
            time_us: self.time_us,
            steer_rad: or_absent(Quantity::Steer, self.steer_rad),
            roll_rad: or_absent(Quantity::Roll, self.roll_rad),
            roll_to_gravity_rad: or_absent(Quantity::RollToGravity, self.roll_to_gravity_rad),
            tilt_rad: or_absent(Quantity::Tilt, self.tilt_rad),
            suspension_roll_rad: or_absent(Quantity::SuspensionRoll, self.suspension_roll_rad),
            speed_mps: or_absent(Quantity::Speed, self.speed_mps),
            lateral_acceleration_mps2: or_absent(
                Quantity::LateralAcceleration,
                self.lateral_acceleration_mps2,
            ),
            lateral_specific_force_mps2: or_absent(
                Quantity::LateralSpecificForce,
                self.lateral_specific_force_mps2,
            ),
            tractor_suspension_roll_rad: or_absent(
                Quantity::TractorSuspensionRoll,
                self.tractor_suspension_roll_rad,
            ),
            tractor_lateral_specific_force_mps2: or_absent(
                Quantity::TractorLateralSpecificForce,
                self.tractor_lateral_specific_force_mps2,
            ),
            tractor_tilt_rad: or_absent(Quantity::TractorTilt, self.tractor_tilt_rad),
            yaw_rate_radps: or_absent(Quantity::YawRate, self.yaw_rate_radps),
            trailer_mass_kg: or_absent(Quantity::TrailerMass, self.trailer_mass_kg),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column is the name and the SI unit. The meaning is one line: the line breaks of the table
    /// leave no double spaces in it.
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

    /// Values that trucks reach are well inside the limits: full lock of a steering wheel (6.5
    /// turns to either side), the tilt in a turn with rollover, a heavy load. Degrees or grams
    /// instead of SI units are outside.
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
            (Quantity::LevelLeft, 0.4, 400.0),
            (Quantity::TractorLateralSpecificForce, -11.0, 900.0),
        ] {
            assert!(quantity.plausible(usual) && !quantity.plausible(wrong), "{quantity:?}");
        }
    }
}
