//! The sample of a row: what the signals of a log are to the estimator.

use cg_core::{AlignSettings, Design, Quantity, Sample};
use serde::{Deserialize, Serialize};

use super::felt::add_force;
use super::known::weighed_mass;
use super::options::EstimateOptions;
use super::speed_age::SpeedAge;
use super::tilts::Tilts;
use super::weighed::Weighed;
use crate::log::{LogRow, Signal};
use cg_vehicle::scales::Scale;

/// Which optional signals the log contains.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct SignalsSeen {
    /// When the first speed came, µs.
    pub(super) speed_since_us: Option<u64>,
    pub(super) speed_age: SpeedAge,
    /// The last mass in the log, also if an option replaces it.
    pub(super) mass_kg: Option<f64>,
    /// The last standard deviation in the log, kg.
    pub(super) mass_sd_kg: Option<f64>,
    /// Its scale, likewise.
    pub(super) scale: Option<Scale>,
    /// The scale on the bus, if the rows are from frames.
    pub(super) bus_scale: Option<Scale>,
    /// The time of the last sample with a mass, µs, and its masses that are to be [weighed](Weighed::weigh).
    pub(super) to_weigh: Option<(u64, [f64; 2])>,
    pub(super) weighed: Weighed,
    /// The quantities that have arrived and are not used, in the order of [`Quantity::ALL`].
    pub(super) unscaled: [bool; Quantity::COUNT],
    /// The quantities that have arrived when the signals of the log changed, in the same order.
    arrived: [bool; Quantity::COUNT],
}

impl SignalsSeen {
    /// The sample of a row at a time, with speed and mass by the options.
    #[inline]
    pub(super) fn sample(
        &mut self,
        (row, time_us): (&LogRow, u64),
        design: &Design<f64>,
        settings: &AlignSettings<f64>,
        options: &EstimateOptions,
    ) -> Sample<f64> {
        let mut sample = row.sample(time_us, settings);
        self.unscaled(row, &sample);
        // A mass that no trailer can have is not used, but another scale is, of which this says nothing.
        let is_of_row = sample.trailer_mass_kg.to_bits() == row.trailer_mass_kg.to_bits();
        let is_used = is_of_row || row.trailer_mass_kg.is_nan();
        if row.trailer_mass_sd_kg >= 0.0 && is_used {
            self.mass_sd_kg = Some(row.trailer_mass_sd_kg);
        }
        if sample.speed_mps.is_finite() {
            self.speed_since_us.get_or_insert(time_us);
        }
        if sample.trailer_mass_kg.is_finite() {
            let logged_kg = sample.trailer_mass_kg;
            sample.trailer_mass_kg = weighed_mass(design, logged_kg);
            self.mass_kg = Some(sample.trailer_mass_kg);
            self.scale = self.bus_scale.or_else(|| {
                // Most logs have the mass itself, which is then that of the sample.
                if logged_kg.to_bits() == row.trailer_mass_kg.to_bits() {
                    return Scale::in_log(Quantity::TrailerMass);
                }
                let (quantity, _) = row.weighed(settings)?;
                Scale::in_log(quantity)
            });
            self.to_weigh = Some((time_us, [logged_kg, sample.trailer_mass_kg]));
        }
        if let Some(speed_mps) = options.speed_mps {
            sample.speed_mps = speed_mps;
        }
        self.speed_age.push(&mut sample);
        add_force(&mut sample, design.gravity_mps2);
        if let Some(mass_kg) = options.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
        }
        sample
    }

    /// Takes the quantities of a row whose sample has other signals than the one before.
    #[cold]
    pub(super) fn arrive(&mut self, row: &LogRow) {
        for quantity in Quantity::ALL {
            self.arrived[quantity.index()] |= row.get(Signal::from(quantity)).is_finite();
        }
    }

    /// Whether a quantity has come.
    pub(super) fn has(&self, quantity: Quantity) -> bool {
        self.arrived[quantity.index()]
    }

    /// Which roll angles come from inclinometers.
    pub(super) fn tilts(&self) -> Tilts {
        Tilts::of(|quantity| self.arrived[quantity.index()] && !self.unscaled[quantity.index()])
    }

    /// Takes the quantities of a row from which its sample has nothing.
    #[inline]
    fn unscaled(&mut self, row: &LogRow, sample: &Sample<f64>) {
        let rare = [
            row.steering_wheel_rad,
            row.level_left_m,
            row.tractor_level_left_m,
            row.trailer_suspension_pressure_pa,
            row.drive_pressure_left_pa,
        ];
        if rare.iter().all(|value| value.is_nan()) {
            return;
        }
        let is_unweighed = !sample.trailer_mass_kg.is_finite();
        let are_unused = [
            (Quantity::SteeringWheel, !sample.steer_rad.is_finite()),
            (Quantity::LevelLeft, !sample.suspension_roll_rad.is_finite()),
            (Quantity::TractorLevelLeft, !sample.tractor_suspension_roll_rad.is_finite()),
            (Quantity::TrailerSuspensionPressure, is_unweighed),
            (Quantity::DrivePressureLeft, is_unweighed),
        ];
        for (value, (quantity, is_unused)) in rare.into_iter().zip(are_unused) {
            self.unscaled[quantity.index()] |= is_unused && !value.is_nan();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design, log_with, plain};

    #[test]
    fn time_counts_from_the_first_row() {
        let mut log = plain();
        for (time_s, time_us) in
            [(100.0, 0), (101.5, 1_500_000), (101.500_000_6, 1_500_001), (99.0, 0)]
        {
            assert_eq!(log.sample(&LogRow { time_s, ..LogRow::ABSENT }).time_us, time_us);
        }
        assert_eq!(log.origin_s, Some(100.0));
    }

    #[test]
    fn a_steering_wheel_counts_as_unscaled_if_it_gives_no_steer_angle() {
        let row = |steer_rad: f64, steering_wheel_rad: f64| LogRow {
            time_s: 0.0,
            steer_rad,
            steering_wheel_rad,
            ..LogRow::ABSENT
        };
        let (absent, wheel) = (row(f64::NAN, f64::NAN), row(f64::NAN, 2.0));
        for (rows, unscaled) in [
            (vec![absent], false),
            (vec![row(0.1, 2.0)], false),
            (vec![wheel], true),
            (vec![wheel, absent], true),
            (vec![absent, wheel], true),
        ] {
            let mut log = plain();
            for row in &rows {
                log.sample(row);
            }
            assert_eq!(log.seen.unscaled[Quantity::SteeringWheel.index()], unscaled, "{rows:?}");
        }
        let settings = AlignSettings { steering_ratio: Some(20.0), ..AlignSettings::NONE };
        let mut scaled = log_with(settings, EstimateOptions::default());
        assert!((scaled.sample(&wheel).steer_rad - 0.1).abs() < 1e-12);
        assert!(!scaled.seen.unscaled[Quantity::SteeringWheel.index()]);
    }

    #[test]
    fn a_pressure_counts_as_unscaled_if_it_gives_no_mass() {
        let row = |trailer_mass_kg: f64, trailer_suspension_pressure_pa: f64| LogRow {
            time_s: 0.0,
            trailer_mass_kg,
            trailer_suspension_pressure_pa,
            ..LogRow::ABSENT
        };
        let (absent, pressure) = (row(f64::NAN, f64::NAN), row(f64::NAN, 4e5));
        for (rows, unscaled) in [
            (vec![absent], false),
            (vec![row(20e3, 4e5)], false),
            (vec![pressure], true),
            (vec![pressure, absent], true),
            (vec![absent, pressure], true),
        ] {
            let mut log = plain();
            for row in &rows {
                log.sample(row);
            }
            assert_eq!(
                log.seen.unscaled[Quantity::TrailerSuspensionPressure.index()],
                unscaled,
                "{rows:?}"
            );
        }
    }

    /// The column is that of the mass in the log, and an option counts more.
    #[test]
    fn the_log_says_how_exact_its_mass_is() {
        let row = LogRow { trailer_mass_kg: 21e3, trailer_mass_sd_kg: 1500.0, ..LogRow::ABSENT };
        let mass_sd_kg = |row: LogRow, options: EstimateOptions| {
            let mut log = log_with(AlignSettings::NONE, options);
            log.push(&LogRow { time_s: 0.0, ..row }).unwrap();
            log.mass_sd_kg(21e3)
        };
        let usual = EstimateOptions::default();
        let given = EstimateOptions { trailer_mass_sd_kg: Some(300.0), ..usual };
        let other = EstimateOptions { trailer_mass_kg: Some(20e3), ..usual };
        for (row, options, sd_kg) in [
            (row, usual, 1500.0),
            (row, given, 300.0),
            (row, other, 0.0),
            (LogRow { trailer_mass_sd_kg: -1.0, ..row }, usual, 0.0),
            (LogRow { trailer_mass_kg: f64::NAN, ..row }, usual, design().any_load_sd_kg()),
        ] {
            assert!((mass_sd_kg(row, options) - sd_kg).abs() < 1e-9, "{row:?}");
        }
    }

    /// A mass of zero, which this trailer cannot have, leaves what is said of it to no other: the axle load counts, by its own scale.
    #[test]
    fn what_is_not_used_says_nothing_of_the_mass() {
        let settings = AlignSettings {
            mass_of_axle_load: Some([4000.0, 1.0]),
            mass_range_kg: Some([5e3, 40e3]),
            ..AlignSettings::NONE
        };
        let said_kg = |trailer_mass_kg: f64| {
            let mut log = log_with(settings, EstimateOptions::default());
            let row = LogRow { time_s: 0.0, trailer_mass_kg, ..LogRow::ABSENT };
            let row = LogRow { trailer_mass_sd_kg: 300.0, trailer_axle_load_kg: 16e3, ..row };
            log.push(&row).unwrap();
            assert!((log.trailer_mass_kg / 20e3 - 1.0).abs() < 1e-9);
            log.seen.mass_sd_kg
        };
        assert_eq!(said_kg(20e3), Some(300.0));
        assert_eq!(said_kg(0.0), None);
        assert_eq!(said_kg(f64::NAN), Some(300.0), "of what follows from the axle load");
    }

    #[test]
    fn the_last_mass_of_the_log_is_kept() {
        let mut log = plain();
        assert_eq!((log.seen.mass_kg.is_some(), log.seen.speed_since_us.is_some()), (false, false));
        for (mass_kg, speed_mps, kept_kg, seen) in [
            (f64::NAN, f64::NAN, MASS_KG, (false, false)),
            (21e3, f64::NAN, 21e3, (true, false)),
            (f64::NAN, 12.0, 21e3, (true, true)),
            (22e3, f64::NAN, 22e3, (true, true)),
        ] {
            let row = LogRow { time_s: 0.0, trailer_mass_kg: mass_kg, speed_mps, ..LogRow::ABSENT };
            log.sample(&row);
            assert_eq!(log.trailer_mass_kg.to_bits(), kept_kg.to_bits());
            assert_eq!((log.seen.mass_kg.is_some(), log.seen.speed_since_us.is_some()), seen);
        }
    }

    #[test]
    fn speed_and_mass_of_the_options_replace_those_of_the_log() {
        let options = EstimateOptions {
            speed_mps: Some(13.0),
            trailer_mass_kg: Some(25e3),
            ..EstimateOptions::default()
        };
        let mut log = log_with(AlignSettings::NONE, options);
        let row = LogRow { time_s: 0.0, trailer_mass_kg: 21e3, speed_mps: 12.0, ..LogRow::ABSENT };
        let sample = log.sample(&row);
        let found = [sample.speed_mps, sample.trailer_mass_kg, log.trailer_mass_kg];
        assert_eq!(found.map(f64::to_bits), [13.0, 25e3, 25e3].map(f64::to_bits));
        assert!(log.seen.mass_kg.is_some() && log.seen.speed_since_us.is_some());
    }
}
