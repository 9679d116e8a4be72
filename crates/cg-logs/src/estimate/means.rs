//! Means of neighboring samples: all that is decided from a log sees the means, as the estimator does.

use cg_core::decide::signals::Averaged;
use cg_core::{Output, Quantity, Sample, Signals};
use serde::{Deserialize, Serialize};

/// Number of signals of which a mean is made.
const COUNT: usize = 11;

/// Least speed at which the mean of the yaw rate is weighed by it, m/s.
const MOVES_MPS: f64 = 0.1;

/// The signals, in this order.
const QUANTITIES: [Quantity; COUNT] = [
    Quantity::Roll,
    Quantity::RollToGravity,
    Quantity::Tilt,
    Quantity::SuspensionRoll,
    Quantity::TractorSuspensionRoll,
    Quantity::LateralSpecificForce,
    Quantity::Steer,
    Quantity::LateralAcceleration,
    Quantity::TractorLateralSpecificForce,
    Quantity::TractorTilt,
    Quantity::YawRate,
];

/// Their [limits](Quantity::limits), least and greatest.
const LIMITS: [[f64; 2]; COUNT] = {
    let mut limits = [[0.0; 2]; COUNT];
    let mut k = 0;
    while k < COUNT {
        let [least, greatest] = QUANTITIES[k].limits();
        #[allow(clippy::cast_lossless, reason = "`From` is not for constants")]
        {
            limits[k] = [least as f64, greatest as f64];
        }
        k += 1;
    }
    limits
};

/// The sum of some samples in which the same signals are present: those that are [plausible](Quantity::plausible).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct SampleSum {
    signals: [f64; COUNT],
    /// Which of them are present.
    kinds: u32,
    /// Number of samples for which a speed holds, and the sum of the last known ones. A speed and a mass hold for a while, so a
    /// mean may be of samples with and without them.
    speeds: u32,
    known_mps: f64,
    /// The sum of the products of yaw rate and speed, m/s².
    turns_mps2: f64,
    /// The last mass, kg.
    trailer_mass_kg: f64,
    /// The roll angle of the last sample, rad.
    roll_rad: f64,
}

impl SampleSum {
    /// The sum of one sample, at the last known speed, m/s, which is that of the sample if it has one, and whether it still holds.
    pub(super) fn of(
        sample: &Sample<f64>,
        (known_mps, holds): (f64, bool),
        gravity_mps2: f64,
    ) -> Self {
        let mut signals = [
            sample.roll_rad,
            sample.roll_to_gravity_rad,
            sample.tilt_rad,
            sample.suspension_roll_rad,
            sample.tractor_suspension_roll_rad,
            sample.lateral_specific_force_mps2,
            sample.steer_rad,
            sample.lateral_acceleration_mps2,
            sample.tractor_lateral_specific_force_mps2,
            sample.tractor_tilt_rad,
            sample.yaw_rate_radps,
        ];
        let mut kinds = 0;
        for (k, (value, [least, greatest])) in signals.iter_mut().zip(LIMITS).enumerate() {
            let is_plausible = (least..=greatest).contains(value);
            kinds |= u32::from(is_plausible) << k;
            *value = if is_plausible { *value } else { f64::NAN };
        }
        let roll_rad = if signals[0].is_nan() {
            Signals::of(&sample.checked(), known_mps, gravity_mps2).output(Output::Roll)
        } else {
            signals[0]
        };
        let [.., yaw_rate_radps] = signals;
        let has_mass = Quantity::TrailerMass.plausible(sample.trailer_mass_kg);
        Self {
            signals,
            kinds,
            speeds: u32::from(holds),
            known_mps,
            turns_mps2: yaw_rate_radps * known_mps,
            trailer_mass_kg: if has_mass { sample.trailer_mass_kg } else { f64::NAN },
            roll_rad,
        }
    }

    /// Which signals are present.
    pub(super) fn kinds(&self) -> u32 {
        self.kinds
    }

    /// Whether a speed holds for any sample.
    pub(super) fn has_speed(&self) -> bool {
        self.speeds > 0
    }

    /// The sample with the mean, which [`scaled`](Averaged::scaled) gives, and the last known speed.
    pub(super) fn sample(&self, time_us: u64) -> Sample<f64> {
        let [
            roll_rad,
            roll_to_gravity_rad,
            tilt_rad,
            suspension_roll_rad,
            tractor_suspension_roll_rad,
            lateral_specific_force_mps2,
            steer_rad,
            lateral_acceleration_mps2,
            tractor_lateral_specific_force_mps2,
            tractor_tilt_rad,
            plain_radps,
        ] = self.signals;
        let speed_mps = self.known_mps;
        // Yaw rate times speed is an acceleration, of which the mean is to be right.
        let is_turn = speed_mps.abs() > MOVES_MPS && !self.turns_mps2.is_nan();
        let yaw_rate_radps = if is_turn { self.turns_mps2 / speed_mps } else { plain_radps };
        Sample {
            time_us,
            steer_rad,
            roll_rad,
            roll_to_gravity_rad,
            tilt_rad,
            suspension_roll_rad,
            speed_mps,
            lateral_acceleration_mps2,
            lateral_specific_force_mps2,
            tractor_suspension_roll_rad,
            tractor_lateral_specific_force_mps2,
            tractor_tilt_rad,
            yaw_rate_radps,
            trailer_mass_kg: self.trailer_mass_kg,
        }
    }
}

impl Averaged<f64> for SampleSum {
    const NONE: Self = Self {
        signals: [f64::NAN; COUNT],
        kinds: 0,
        speeds: 0,
        known_mps: 0.0,
        turns_mps2: f64::NAN,
        trailer_mass_kg: f64::NAN,
        roll_rad: f64::NAN,
    };

    fn roll_rad(&self) -> f64 {
        self.roll_rad
    }

    fn has_kinds_of(&self, other: &Self) -> bool {
        self.kinds == other.kinds
    }

    fn add(&mut self, other: &Self) {
        for (sum, value) in self.signals.iter_mut().zip(other.signals) {
            *sum += value;
        }
        self.known_mps += other.known_mps;
        self.speeds += other.speeds;
        self.turns_mps2 += other.turns_mps2;
        if !other.trailer_mass_kg.is_nan() {
            self.trailer_mass_kg = other.trailer_mass_kg;
        }
        self.roll_rad = other.roll_rad;
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            signals: self.signals.map(|sum| sum * factor),
            known_mps: self.known_mps * factor,
            turns_mps2: self.turns_mps2 * factor,
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use cg_core::AlignSettings;

    use super::*;

    /// The quantities that are fields of a sample.
    const FIELDS: [Quantity; 13] = [
        Quantity::Steer,
        Quantity::Roll,
        Quantity::RollToGravity,
        Quantity::Tilt,
        Quantity::SuspensionRoll,
        Quantity::Speed,
        Quantity::LateralAcceleration,
        Quantity::LateralSpecificForce,
        Quantity::TractorSuspensionRoll,
        Quantity::TractorLateralSpecificForce,
        Quantity::TractorTilt,
        Quantity::YawRate,
        Quantity::TrailerMass,
    ];

    /// With `at` for each of them, and nothing computed from others.
    fn sample(at: impl Fn(Quantity) -> f64) -> Sample<f64> {
        let direct = |quantity| if FIELDS.contains(&quantity) { at(quantity) } else { f64::NAN };
        AlignSettings::NONE.sample(7, direct)
    }

    /// Its last known speed is 10 m/s if it has none.
    fn sum(sample: &Sample<f64>) -> SampleSum {
        let known_mps = if sample.speed_mps.is_nan() { 10.0 } else { sample.speed_mps };
        let holds = Quantity::Speed.plausible(sample.speed_mps);
        SampleSum::of(sample, (known_mps, holds), 9.81)
    }

    /// Every field comes back at its own place: sample `n` has `n` times a number of its own. The mass is the last one.
    #[test]
    fn the_mean_of_each_field_is_at_its_place() {
        let times = |n: f64| {
            sample(|quantity| n * 0.001 * f64::from(u8::try_from(quantity.index()).unwrap() + 1))
        };
        let mut all = sum(&times(1.0));
        for n in [2.0, 6.0] {
            all.add(&sum(&times(n)));
        }
        let mean = all.scaled(1.0 / 3.0).sample(9);
        let expected = Sample { trailer_mass_kg: times(6.0).trailer_mass_kg, ..times(3.0) };
        let text = |sample: &Sample<f64>| {
            let rounded = |x: f64| (x * 1e12).round();
            let Sample { time_us, .. } = *sample;
            let fields = signals_of(sample).map(rounded);
            (time_us, fields)
        };
        assert_eq!(text(&mean), text(&Sample { time_us: 9, ..expected }));
    }

    /// All fields of a sample.
    fn signals_of(sample: &Sample<f64>) -> [f64; 13] {
        let sum = sum(sample);
        let signals = sum.signals;
        std::array::from_fn(|k| match k {
            11 => sample.speed_mps,
            12 => sample.trailer_mass_kg,
            _ => signals[k],
        })
    }

    /// By hand: 0.1 rad/s at 10 m/s and 0.2 rad/s at 20 m/s are 1 and 4 m/s², in the mean 2.5.
    #[test]
    fn yaw_rate_times_speed_is_the_mean_acceleration() {
        let mean = |speeds_mps: [f64; 2]| {
            let one = |speed_mps: f64, yaw_rate_radps: f64| {
                sum(&Sample { speed_mps, yaw_rate_radps, ..Sample::absent(0) })
            };
            let mut all = one(speeds_mps[0], 0.1);
            all.add(&one(speeds_mps[1], 0.2));
            all.scaled(0.5).sample(0)
        };
        let found = mean([10.0, 20.0]);
        assert!((found.yaw_rate_radps * found.speed_mps - 2.5).abs() < 1e-12);
        // The second one at the last known speed, and both standing.
        assert!((mean([10.0, f64::NAN]).yaw_rate_radps - 0.15).abs() < 1e-12);
        assert!((mean([0.0, 0.0]).yaw_rate_radps - 0.15).abs() < 1e-12);
    }

    #[test]
    fn values_that_a_truck_cannot_have_are_absent() {
        for wrong in FIELDS {
            let limit = f64::from(wrong.limits()[1]);
            let with = |value: f64| sample(|quantity| if quantity == wrong { value } else { 0.5 });
            let found = [limit, 1.01 * limit, f64::INFINITY, f64::NAN].map(|value| {
                let sum = sum(&with(value));
                !sum.has_speed() || signals_of(&sum.sample(0)).iter().any(|x| x.is_nan())
            });
            assert_eq!(found, [false, true, true, true], "{wrong:?}");
        }
    }

    /// A speed or a mass may be missing in between; any other signal makes another kind.
    #[test]
    fn only_speed_and_mass_may_be_missing_within_a_mean() {
        let whole = sample(|_| 0.5);
        for missing in FIELDS {
            let part = sample(|quantity| if quantity == missing { f64::NAN } else { 0.5 });
            let holds = matches!(missing, Quantity::Speed | Quantity::TrailerMass);
            assert_eq!(sum(&part).has_kinds_of(&sum(&whole)), holds, "{missing:?}");
        }
        let with = |speed_mps: f64, trailer_mass_kg: f64| {
            sum(&Sample { speed_mps, trailer_mass_kg, ..Sample::absent(0) })
        };
        let mut all = with(f64::NAN, 9e3);
        for (speed_mps, mass_kg) in [(12.0, f64::NAN), (f64::NAN, 8e3), (13.0, f64::NAN)] {
            all.add(&with(speed_mps, mass_kg));
        }
        let mean = all.scaled(0.25).sample(0);
        assert!((mean.speed_mps - (10.0 + 12.0 + 10.0 + 13.0) / 4.0).abs() < 1e-12);
        assert!((mean.trailer_mass_kg - 8e3).abs() < 1e-9 && all.has_speed());
        let none = with(f64::NAN, f64::NAN);
        assert!(none.sample(0).trailer_mass_kg.is_nan() && !none.has_speed());
    }

    /// Of the trailer's roll angle the scatter about the mean is kept, whatever sensor it comes from.
    #[test]
    fn the_roll_angle_is_that_of_the_estimator() {
        // (f − a_y)/g.
        let by_force =
            Sample { lateral_specific_force_mps2: 1.5, yaw_rate_radps: 0.1, ..Sample::absent(0) };
        assert!((sum(&by_force).roll_rad() - 0.5 / 9.81).abs() < 1e-12);
        let roll = Sample { roll_rad: 0.03, roll_to_gravity_rad: 0.05, ..by_force };
        assert!((sum(&roll).roll_rad() - 0.03).abs() < 1e-15);
    }
}
