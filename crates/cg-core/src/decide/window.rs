//! The part of a drive whose rows are in the identifiers.

use crate::decide::condition::{Row, STRAIGHT_MPS2, is_steady};
use crate::decide::consistency::{RollSensorCheck, Shown};
use crate::math::real::Real;

/// Share of the square of the lateral acceleration that turns usually show: of the turns of 12 s from which the uncertainty of an
/// unsteady speed is (test `unsteady` of cg-plant), eight of ten show 0.34 to 0.40.
const USUAL_SHOWN: f64 = 0.37;
/// The least one; less is what rounding leaves of a constant.
const LEAST_SHOWN: f64 = 1e-3;

/// The longitudinal acceleration in the turns: sums over the samples. An uncertainty needs no more digits
/// than single precision leaves of them.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Acceleration<T> {
    sum: T,
    square: T,
    /// Of the samples at which it is small enough for the steer angle, and their number.
    steady_square: T,
    steady_samples: T,
}

impl<T: Real> Acceleration<T> {
    const NONE: Self =
        Self { sum: T::ZERO, square: T::ZERO, steady_square: T::ZERO, steady_samples: T::ZERO };

    /// Adds a row of this many samples.
    fn push(&mut self, acceleration_mps2: T, samples: T) {
        let weighted = acceleration_mps2 * samples;
        let square = acceleration_mps2 * weighted;
        self.sum += weighted;
        self.square += square;
        if is_steady(acceleration_mps2) {
            self.steady_square += square;
            self.steady_samples += samples;
        }
    }
}

/// The part of the drive whose rows are in the identifiers.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [RollSensorCheck<T>; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [RollSensorCheck<T>; C]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Window<T, const C: usize> {
    pub(crate) start_us: u64,
    pub(crate) last_us: u64,
    pub(crate) last_turn_us: Option<u64>,
    faded_us: u64,
    pub(crate) start_speed_mps: T,
    /// Mean speed of the samples in turns, and their number.
    pub(crate) speed_mps: T,
    turning_samples: T,
    acceleration: Acceleration<T>,
    /// Mean square of the lateral acceleration of the samples in turns that have one, m²/s⁴, their
    /// number, and its mean.
    lateral_square: T,
    lateral_samples: T,
    lateral_mean_mps2: T,
    /// Whether a roll angle in it was relative to gravity.
    pub(crate) to_gravity: bool,
    /// Whether a lateral acceleration in its turns was that of the yaw rate.
    pub(crate) by_yaw_rate: bool,
    /// Whether another mass was there before its first row, and still is.
    pub(crate) inherits_mass: bool,
    /// Mean trailer mass, because the load signal oscillates.
    pub(crate) trailer_mass_kg: T,
    /// The weight of all samples.
    pub(crate) weight: T,
    /// One for each roll angle, at the place of its first channel. It starts with the first row,
    /// because a dead band shows at the beginning of a turn.
    sensor_checks: [RollSensorCheck<T>; C],
}

impl<T: Real, const C: usize> Window<T, C> {
    /// A window before its first row.
    pub(crate) fn new(row: &Row<T, C>) -> Self {
        Self {
            start_us: row.of.first_us,
            last_us: row.time_us,
            last_turn_us: None,
            faded_us: row.time_us,
            start_speed_mps: row.speed_mps,
            speed_mps: T::zero(),
            turning_samples: T::zero(),
            acceleration: Acceleration::NONE,
            lateral_square: T::zero(),
            lateral_samples: T::zero(),
            lateral_mean_mps2: T::zero(),
            to_gravity: false,
            by_yaw_rate: false,
            inherits_mass: true,
            trailer_mass_kg: row.trailer_mass_kg,
            weight: T::zero(),
            sensor_checks: [RollSensorCheck::new(); C],
        }
    }

    /// Adds a row; `is_of_load` says that its mass is that of the window's load, and not another one that may last.
    /// Returns `true` if the window is still straight and the weight of its rows is to be halved.
    pub(crate) fn push(&mut self, row: &Row<T, C>, is_of_load: bool, fade_us: u64) -> bool {
        self.last_us = row.time_us;
        // Means are updated recursively, because sums lose digits in single precision.
        let samples = row.of.weight;
        self.weight += samples;
        let share = samples / self.weight;
        self.trailer_mass_kg += (row.trailer_mass_kg - self.trailer_mass_kg) * share;
        self.inherits_mass &= !is_of_load;
        if row.turning {
            self.last_turn_us = Some(row.time_us);
            self.turning_samples += samples;
            self.speed_mps += (row.speed_mps - self.speed_mps) * samples / self.turning_samples;
            self.acceleration.push(row.acceleration_mps2, samples);
            let lateral = row.lateral_acceleration_mps2;
            if lateral.present() {
                self.lateral_samples += samples;
                let share = samples / self.lateral_samples;
                self.lateral_square += (lateral * lateral - self.lateral_square) * share;
                self.lateral_mean_mps2 += (lateral - self.lateral_mean_mps2) * share;
            }
            self.to_gravity |= row.to_gravity;
            self.by_yaw_rate |= row.by_yaw_rate;
            return false;
        }
        let fades =
            self.last_turn_us.is_none() && row.time_us.saturating_sub(self.faded_us) >= fade_us;
        if fades {
            self.faded_us = row.time_us;
            self.start_us = row.of.first_us;
            self.start_speed_mps = row.speed_mps;
            self.weight *= T::of(0.5);
        }
        fades
    }

    /// Root mean square of the lateral acceleration in the turns, m/s². It is at least the one below
    /// which a turn ends, also if no row of the turns has a lateral acceleration.
    pub(crate) fn lateral_mps2(&self) -> T {
        self.lateral_square.root().max(T::of(STRAIGHT_MPS2))
    }

    /// How unsteady the speed was in the turns: the mean square of the longitudinal acceleration as far
    /// as the steer angle is used, and its variance, m²/s⁴. The variance is greater if less than usual
    /// is [shown](Self::shown_share).
    pub(crate) fn unsteady_square(&self) -> [T; 2] {
        let Acceleration { sum, square, steady_square, steady_samples } = self.acceleration;
        let all = self.turning_samples.max(T::one());
        let mean = sum / all;
        let within = square / all - mean * mean;
        let beyond_usual = (self.shown_share().recip() - T::of(USUAL_SHOWN.recip())).max(T::zero());
        let within = within.max(T::zero()) * (T::one() + beyond_usual);
        [steady_square / steady_samples.max(T::one()), within]
    }

    /// Which share of the square of the lateral acceleration in the turns remains if the mean of all rows is taken
    /// off, with none on the straight. A ratio comes from what changes. An error in proportion to the lateral
    /// acceleration, which changes with the speed, therefore counts for more where the lateral acceleration itself hardly
    /// changes, as in a piece of a drive that begins and ends in a turn. All of it, if no row has one.
    fn shown_share(&self) -> T {
        let turning = self.turning_samples / self.weight;
        let mean_square = self.lateral_mean_mps2 * self.lateral_mean_mps2;
        let shown = T::one() - turning * mean_square / self.lateral_square;
        shown.min(T::one()).max(T::of(LEAST_SHOWN))
    }

    /// Adds a measured roll angle to the check at this place.
    pub(crate) fn look(&mut self, place: usize, shown: &Shown<T>) {
        if let Some(check) = self.sensor_checks.get_mut(place) {
            check.push(shown);
        }
    }

    /// The check of the roll angle at this place.
    pub(crate) fn watch(&self, place: usize) -> Option<&RollSensorCheck<T>> {
        self.sensor_checks.get(place).filter(|check| check.has_begun())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decide::neighbors::Samples;

    /// The lateral acceleration of a row on the straight.
    const STRAIGHT: f64 = 0.01;

    /// Rows with these lateral and longitudinal accelerations.
    fn turn(rows: impl IntoIterator<Item = (f64, f64)>) -> Window<f64, 1> {
        let mut window: Option<Window<f64, 1>> = None;
        for (time_us, (lateral, acceleration)) in (0..).zip(rows) {
            let row = Row {
                time_us,
                measured_rad: [0.0],
                expected_rad: [0.0],
                to_gravity: false,
                by_yaw_rate: false,
                speed_mps: 10.0,
                acceleration_mps2: acceleration,
                trailer_mass_kg: 2e4,
                lateral_acceleration_mps2: lateral,
                turning: lateral.total_cmp(&STRAIGHT).is_ne(),
                usable: [true],
                of: Samples::single(time_us),
            };
            window.get_or_insert_with(|| Window::new(&row)).push(&row, true, 2_000_000);
        }
        window.unwrap()
    }

    /// The root mean square that remains of rows in a turn with these lateral accelerations.
    fn lateral_mps2(rows: &[f64]) -> f64 {
        turn(rows.iter().map(|lateral| (*lateral, 0.0))).lateral_mps2()
    }

    /// The steer angle is used at all but 0.4 m/s². The four have a mean of 0.1 and a variance of
    /// (0.06² + 0.13² + 0.3² + 0.11²)/4.
    #[test]
    fn an_unsteady_speed_is_the_variance_of_the_acceleration() {
        let window = turn([0.04, -0.03, 0.4, -0.01].map(|acceleration| (1.0, acceleration)));
        let [steered, within] = window.unsteady_square();
        assert!(
            (steered - (0.04_f64.powi(2) + 0.03_f64.powi(2) + 0.01_f64.powi(2)) / 3.0).abs()
                < 1e-15
        );
        let variance: f64 = [0.06, 0.13, 0.3, 0.11].iter().map(|off| off * off / 4.0).sum();
        // A constant lateral acceleration shows nothing, and turns to both sides show more than usual, which adds nothing.
        let beyond_usual = 1.0 / LEAST_SHOWN - 1.0 / USUAL_SHOWN;
        assert!((within / (variance * (1.0 + beyond_usual)) - 1.0).abs() < 1e-12);
        let sides = [(1.0, 0.04), (-1.0, -0.03), (-1.0, 0.4), (1.0, -0.01)];
        let [_, within] = turn(sides).unsteady_square();
        assert!((within - variance).abs() < 1e-15);
        let [steered, within] = turn([(1.0, 0.4); 3]).unsteady_square();
        assert!(steered.abs() < 1e-15 && within.abs() < 1e-15);
    }

    /// A mean of zero takes nothing off; the means of 1 in a half and three quarters of the rows leave the others' share. What is
    /// absent cannot be uncertain.
    #[test]
    fn what_hardly_changes_shows_a_small_share_of_the_turns() {
        for (rows, share) in [
            (&[0.5, -0.5, 0.5, -0.5][..], 1.0),
            (&[1.0, STRAIGHT, 1.0, STRAIGHT], 0.5),
            (&[1.0, 1.0, STRAIGHT, 1.0], 0.25),
            (&[f64::NAN, STRAIGHT], 1.0),
        ] {
            let found = turn(rows.iter().map(|lateral| (*lateral, 0.0))).shown_share();
            assert!((found - share).abs() < 1e-12, "{rows:?}: {found}");
        }
    }

    /// √((1.2² + 1.6²)/2) = √2.
    #[test]
    fn rows_without_a_lateral_acceleration_do_not_count() {
        let found = lateral_mps2(&[1.2, f64::NAN, -1.6, f64::NAN, f64::NAN]);
        assert!((found - 2.0_f64.sqrt()).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_turn_without_a_lateral_acceleration_has_the_least_one() {
        for rows in [&[f64::NAN; 3], &[0.0; 3], &[0.1; 3]] {
            assert!((lateral_mps2(rows) - 0.3).abs() < 1e-12);
        }
    }
}
