//! Conversion of the values of sensors to the signals of a sample.

use crate::math::real::Real;
use crate::signal::sample::{Quantity, Sample};

/// The vehicle data that convert sensor values to the values of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Share of the second roll sensor in the trailer's roll angle, which then needs both sensors.
    pub second_roll_share: Option<T>,
    /// Whether the roll angle is already the mean of two sensors, so that a log with a roll angle of the
    /// second one contradicts the vehicle: the roll angle is then not used.
    #[cfg_attr(feature = "serde", serde(default))]
    pub roll_is_mean_of_two: bool,
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
        second_roll_share: None,
        roll_is_mean_of_two: false,
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
    #[inline]
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
            roll_rad: match self.second_roll_share {
                Some(share) => {
                    let first_rad = at(Quantity::Roll);
                    first_rad + share * (at(Quantity::SecondRoll) - first_rad)
                }
                None if self.roll_is_mean_of_two && at(Quantity::SecondRoll).present() => {
                    T::absent()
                }
                None => at(Quantity::Roll),
            },
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
    /// order. Values that fail [`believes`](Self::believes) are skipped. The pressures on both sides
    /// of the tractor are judged as their mean, because they differ in a turn.
    pub fn trailer_mass_kg(&self, at: impl Fn(Quantity) -> T) -> T {
        self.weighed(at).map_or_else(T::absent, |(_, mass_kg)| mass_kg)
    }

    /// The [trailer mass](Self::trailer_mass_kg), kg, with the quantity from which it follows, if there
    /// is one. Of the pressures on both sides of the tractor the left one is named.
    #[inline]
    pub fn weighed(&self, at: impl Fn(Quantity) -> T) -> Option<(Quantity, T)> {
        let drive_pressure = || {
            let (left, right) = (at(Quantity::DrivePressureLeft), at(Quantity::DrivePressureRight));
            match (left.present(), right.present()) {
                (true, true) => T::of(0.5) * (left + right),
                (true, false) => left,
                _ => right,
            }
        };
        // Most samples have the first one, and the others are not asked for.
        for quantity in [
            Quantity::TrailerMass,
            Quantity::TrailerAxleLoad,
            Quantity::TrailerSuspensionPressure,
            Quantity::DrivePressureLeft,
        ] {
            let value = match quantity {
                Quantity::DrivePressureLeft => drive_pressure(),
                _ => at(quantity),
            };
            let mass_kg = self.mass_kg(quantity, value);
            if quantity.plausible(value) && mass_kg.present() && self.is_possible(mass_kg) {
                return Some((quantity, mass_kg));
            }
        }
        None
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
    /// it alone, whether the trailer can have that mass. Absent values return `false`.
    pub fn believes(&self, quantity: Quantity, value: T) -> bool {
        let one_side =
            matches!(quantity, Quantity::DrivePressureLeft | Quantity::DrivePressureRight);
        let mass_kg = self.mass_kg(quantity, value);
        let possible = one_side || !mass_kg.present() || self.is_possible(mass_kg);
        possible && quantity.plausible(value)
    }

    fn is_possible(&self, mass_kg: T) -> bool {
        self.mass_range_kg.is_none_or(|[least, greatest]| mass_kg >= least && mass_kg <= greatest)
    }
}

impl<T: Real> Default for AlignSettings<T> {
    fn default() -> Self {
        Self::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of a sample.
    type Field = fn(&Sample<f64>) -> f64;

    const SETTINGS: AlignSettings<f64> = AlignSettings {
        suspension_roll_of_level: Some(1.25), // level sensors 0.8 m apart
        tractor_suspension_roll_of_level: Some(2.0),
        mass_of_drive_pressure: Some([3000.0, 0.05]),
        ..AlignSettings::NONE
    };

    /// The sample of these values; all other quantities are absent.
    fn sample(settings: AlignSettings<f64>, values: &[(Quantity, f64)]) -> Sample<f64> {
        settings.sample(7, |quantity| {
            let value = values.iter().find(|(one, _)| *one == quantity);
            value.map_or(f64::NAN, |(_, value)| *value)
        })
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    /// Every quantity that is a signal of a sample arrives in its own field.
    #[test]
    fn a_quantity_becomes_its_own_field() {
        use Quantity as Q;
        let fields: [(Quantity, Field); 13] = [
            (Q::Steer, |s| s.steer_rad),
            (Q::Roll, |s| s.roll_rad),
            (Q::RollToGravity, |s| s.roll_to_gravity_rad),
            (Q::Tilt, |s| s.tilt_rad),
            (Q::SuspensionRoll, |s| s.suspension_roll_rad),
            (Q::Speed, |s| s.speed_mps),
            (Q::LateralAcceleration, |s| s.lateral_acceleration_mps2),
            (Q::LateralSpecificForce, |s| s.lateral_specific_force_mps2),
            (Q::TractorSuspensionRoll, |s| s.tractor_suspension_roll_rad),
            (Q::TractorLateralSpecificForce, |s| s.tractor_lateral_specific_force_mps2),
            (Q::TractorTilt, |s| s.tractor_tilt_rad),
            (Q::YawRate, |s| s.yaw_rate_radps),
            (Q::TrailerMass, |s| s.trailer_mass_kg),
        ];
        for (quantity, its) in fields {
            let sample = sample(SETTINGS, &[(quantity, 0.25)]);
            let present = fields.iter().filter(|(_, field)| field(&sample).present()).count();
            assert_eq!((sample.time_us, its(&sample), present), (7, 0.25, 1), "{quantity:?}");
        }
    }

    /// The left side is 30 mm and 10 mm higher: 0.03 · 1.25 and 0.01 · 2.
    #[test]
    fn levels_give_the_roll_of_the_suspension() {
        let levels = [
            (Quantity::LevelLeft, 0.32),
            (Quantity::LevelRight, 0.29),
            (Quantity::TractorLevelLeft, 0.11),
            (Quantity::TractorLevelRight, 0.10),
        ];
        let found = sample(SETTINGS, &levels);
        close(found.suspension_roll_rad, 0.0375);
        close(found.tractor_suspension_roll_rad, 0.02);
        // One side alone gives nothing, and neither do levels without their distance.
        let one = sample(SETTINGS, &[levels[0], levels[3]]);
        assert!(one.suspension_roll_rad.is_nan() && one.tractor_suspension_roll_rad.is_nan());
        let bare = sample(AlignSettings::NONE, &levels);
        assert!(bare.suspension_roll_rad.is_nan() && bare.tractor_suspension_roll_rad.is_nan());
    }

    /// A quarter of 0.06 rad and three quarters of 0.02 rad. One sensor alone gives nothing.
    #[test]
    fn two_roll_sensors_give_one_roll_angle() {
        let settings = AlignSettings { second_roll_share: Some(0.25), ..AlignSettings::NONE };
        let both = [(Quantity::Roll, 0.02), (Quantity::SecondRoll, 0.06)];
        close(sample(settings, &both).roll_rad, 0.03);
        for one in both {
            assert!(sample(settings, &[one]).roll_rad.is_nan());
        }
        close(sample(AlignSettings::NONE, &both).roll_rad, 0.02);
        // The mean of both has no column beside it.
        let mean = AlignSettings { roll_is_mean_of_two: true, ..AlignSettings::NONE };
        close(sample(mean, &both[..1]).roll_rad, 0.02);
        assert!(sample(mean, &both).roll_rad.is_nan());
    }

    /// The body tilts more than the axle: 0.25 − 0.20 and 0.23 − 0.21.
    #[test]
    fn two_inclinometers_give_the_roll_of_the_suspension() {
        let found = sample(
            AlignSettings::NONE,
            &[
                (Quantity::Tilt, 0.25),
                (Quantity::AxleTilt, 0.20),
                (Quantity::TractorTilt, 0.23),
                (Quantity::TractorAxleTilt, 0.21),
            ],
        );
        close(found.suspension_roll_rad, 0.05);
        close(found.tractor_suspension_roll_rad, 0.02);
        assert_eq!((found.tilt_rad, found.tractor_tilt_rad), (0.25, 0.23));
    }

    #[test]
    fn a_measured_roll_comes_before_levels_and_levels_before_tilts() {
        let trailer = [
            (Quantity::Tilt, 0.25),
            (Quantity::AxleTilt, 0.20),
            (Quantity::LevelLeft, 0.32),
            (Quantity::LevelRight, 0.29),
            (Quantity::SuspensionRoll, 0.03),
        ];
        let tractor = [
            (Quantity::TractorTilt, 0.25),
            (Quantity::TractorAxleTilt, 0.20),
            (Quantity::TractorLevelLeft, 0.32),
            (Quantity::TractorLevelRight, 0.29),
            (Quantity::TractorSuspensionRoll, 0.03),
        ];
        for (count, of_trailer, of_tractor) in [(2, 0.05, 0.05), (4, 0.0375, 0.06), (5, 0.03, 0.03)]
        {
            close(sample(SETTINGS, &trailer[..count]).suspension_roll_rad, of_trailer);
            close(sample(SETTINGS, &tractor[..count]).tractor_suspension_roll_rad, of_tractor);
        }
    }

    /// 3000 kg + 0.05 kg/Pa: both sides 4 bar and 5 bar, then one of them.
    #[test]
    fn the_pressure_of_the_drive_axles_is_the_mean_of_both_sides() {
        let (left, right) =
            ((Quantity::DrivePressureLeft, 4e5), (Quantity::DrivePressureRight, 5e5));
        close(sample(SETTINGS, &[left, right]).trailer_mass_kg, 25_500.0);
        close(sample(SETTINGS, &[left]).trailer_mass_kg, 23_000.0);
        close(sample(SETTINGS, &[right]).trailer_mass_kg, 28_000.0);
        assert!(sample(AlignSettings::NONE, &[left, right]).trailer_mass_kg.is_nan());
    }

    /// In a turn the sides differ by more than the mass may change: 2 bar and 6 bar are 13 t and 33 t,
    /// of which neither is possible, but their mean of 23 t is.
    #[test]
    fn the_sides_of_the_drive_axles_are_judged_by_their_mean() {
        let settings = AlignSettings { mass_range_kg: Some([15e3, 30e3]), ..SETTINGS };
        let (left, right) = (Quantity::DrivePressureLeft, Quantity::DrivePressureRight);
        for value in [2e5, 6e5] {
            assert!(settings.believes(left, value) && settings.believes(right, value));
            assert!(sample(settings, &[(left, value)]).trailer_mass_kg.is_nan());
        }
        close(sample(settings, &[(left, 2e5), (right, 6e5)]).trailer_mass_kg, 23_000.0);
        assert!(sample(settings, &[(left, 6e5), (right, 6e5)]).trailer_mass_kg.is_nan());
        assert!(!settings.believes(left, 3e6) && !settings.believes(right, f64::NAN));
    }

    /// Each scale gives another mass, and the best one that is present counts.
    #[test]
    fn the_trailers_own_scales_come_before_the_tractors() {
        let settings = AlignSettings {
            mass_of_axle_load: Some([4000.0, 1.5]),
            mass_of_suspension_pressure: Some([2000.0, 0.06]),
            mass_range_kg: Some([5000.0, 40_000.0]),
            ..SETTINGS
        };
        let scales = [
            (Quantity::TrailerMass, 20_000.0),
            (Quantity::TrailerAxleLoad, 12_000.0),
            (Quantity::TrailerSuspensionPressure, 4e5),
            (Quantity::DrivePressureLeft, 4e5),
        ];
        for (skipped, mass_kg) in [20_000.0, 22_000.0, 26_000.0, 23_000.0].into_iter().enumerate() {
            close(sample(settings, &scales[skipped..]).trailer_mass_kg, mass_kg);
            let at = |quantity| {
                let value = scales[skipped..].iter().find(|(one, _)| *one == quantity);
                value.map_or(f64::NAN, |(_, value)| *value)
            };
            assert_eq!(settings.weighed(at), Some((scales[skipped].0, mass_kg)));
        }
        assert_eq!(settings.weighed(|_| f64::NAN), None);
        let mut broken = scales;
        broken[0].1 = 41_000.0;
        close(sample(settings, &broken).trailer_mass_kg, 22_000.0);
    }
}
