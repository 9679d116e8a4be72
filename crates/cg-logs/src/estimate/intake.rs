//! Processes the rows of a log.

use cg_core::Maneuver;
use cg_core::{
    AlignSettings, CHANNELS, Design, Measured, Quantity, Sample, SampleError, Signals, Status,
};
use serde::{Deserialize, Serialize};

use super::engine::Engine;
use super::felt::{add_force, felt_mps2};
use super::known::weighed_mass;
use super::leaning::Leaning;
use super::left_out::LeftOut;
use super::options::EstimateOptions;
use super::recorder::Recorder;
use super::rolls::RollCheck;
use super::sensors::SensorCheck;
use super::since_stop::SinceStop;
use super::strong::StrongTurns;
use super::unheard::Unheard;
use super::weighed::Weighed;
use crate::log::{LogRow, Signal};
use cg_vehicle::Vehicle;
use cg_vehicle::design::design;
use cg_vehicle::error::VehicleError;
use cg_vehicle::scales::Scale;

/// Number of maneuvers of a log that are kept; further ones are only counted. A year of driving has
/// some thousands.
const MOST_MANEUVERS: usize = 10_000;

/// The DC ratios identified from a log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Identified {
    /// Mean speed of the maneuvers, m/s.
    pub speed_mps: f64,
    /// Lateral acceleration of its turns, g; `None` if the log has neither it nor yaw rate and speed.
    pub turn_g: Option<f64>,
    /// Trailer mass used, kg.
    pub trailer_mass_kg: f64,
    /// Its standard deviation, kg: that of its scale, or that of any load if it is not known.
    pub trailer_mass_sd_kg: f64,
    /// Whether the mass comes from the log or the options, and not from the vehicle file.
    pub trailer_mass_is_known: bool,
    /// The trailer mass in the log in the last turn, kg, also if an option replaced it.
    pub logged_mass_kg: Option<f64>,
    /// When the load has changed in the log, s; the ratios are those of the last load.
    pub load_since_s: Option<f64>,
    /// DC ratios in the order of [`Channel::ALL`](cg_core::Channel::ALL), with the standard deviation due to noise.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Messages for the user.
    pub messages: Vec<String>,
}

/// Estimates the height from one log, row by row. Its memory grows only with the number of
/// maneuvers, up to ten thousand.
///
/// It is serialized with its whole state, so that it goes on to the last bit where it was; a format
/// without NaN, such as JSON, does not do. Another version may have another state.
#[derive(Clone, Serialize, Deserialize)]
pub struct LogEstimator {
    pub(super) design: Design<f64>,
    pub(super) options: EstimateOptions,
    pub(super) settings: AlignSettings<f64>,
    pub(super) engine: Engine,
    pub(super) origin_s: Option<f64>,
    pub(super) rows: u64,
    pub(super) absent_rows: u64,
    pub(super) seen: SignalsSeen,
    bus_scale: Option<Scale>,
    pub(super) trailer_mass_kg: f64,
    pub(super) rolls: RollCheck,
    pub(super) sensors: SensorCheck,
    pub(super) leaning: Leaning,
    pub(super) strong: StrongTurns,
    pub(super) left_out: LeftOut,
    pub(super) unheard: Unheard,
    pub(super) stop: SinceStop,
    pub(super) maneuvers: Vec<Maneuver<f64>>,
    /// Whether a signal gave the mass of each of them.
    are_weighed: Vec<bool>,
    /// The place of the first maneuver of the last load among them.
    first_of_load: usize,
    /// Number of maneuvers that are not kept.
    pub(super) more_maneuvers: u64,
    /// Only while a calibration reads a log.
    #[serde(skip)]
    recorder: Option<Box<Recorder>>,
}

/// Which optional signals the log contains.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct SignalsSeen {
    /// When the first speed came, µs.
    pub(super) speed_since_us: Option<u64>,
    /// The last mass in the log, also if an option replaces it.
    pub(super) mass_kg: Option<f64>,
    /// The last standard deviation in the log, kg.
    pub(super) mass_sd_kg: Option<f64>,
    /// Its scale, likewise.
    pub(super) scale: Option<Scale>,
    pub(super) weighed: Weighed,
    /// The quantities that have arrived and are not used, in the order of [`Quantity::ALL`].
    pub(super) unscaled: [bool; Quantity::COUNT],
}

impl LogEstimator {
    /// An estimator for logs of `vehicle`.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle gives no usable design.
    pub fn new(vehicle: &Vehicle, options: EstimateOptions) -> Result<Self, VehicleError> {
        let design = design(vehicle, options.variant)?;
        Ok(Self::from_design(&design, vehicle.align_settings(), options.with_file(vehicle)))
    }

    /// An estimator with an existing design.
    pub fn from_design(
        design: &Design<f64>,
        settings: AlignSettings<f64>,
        options: EstimateOptions,
    ) -> Self {
        Self {
            engine: Engine::new(design, &options),
            design: *design,
            options,
            settings,
            origin_s: None,
            rows: 0,
            absent_rows: 0,
            seen: SignalsSeen::default(),
            bus_scale: None,
            trailer_mass_kg: options.trailer_mass_kg.unwrap_or(design.nominal_trailer_mass_kg),
            rolls: RollCheck::default(),
            sensors: SensorCheck::default(),
            leaning: Leaning::default(),
            strong: StrongTurns::default(),
            left_out: LeftOut::default(),
            unheard: Unheard::default(),
            stop: SinceStop::default(),
            maneuvers: Vec::new(),
            are_weighed: Vec::new(),
            first_of_load: 0,
            more_maneuvers: 0,
            recorder: None,
        }
    }

    /// Records the inputs and roll angles of the next rows.
    pub(crate) fn record(&mut self) {
        self.recorder = Some(Box::new(Recorder::new(&self.design)));
    }

    /// What it has recorded.
    pub(crate) fn recorder(&mut self) -> Option<Box<Recorder>> {
        self.recorder.take()
    }

    /// Processes one row and returns the state of the estimator.
    ///
    /// # Errors
    /// [`SampleError`] if the time is not later than that of the previous row (at a resolution of 1
    /// µs).
    pub fn push(&mut self, row: &LogRow) -> Result<Status, SampleError> {
        let sample = self.sample(row);
        let step = self.engine.push(&sample); // not moved, because of the room for a maneuver in it
        let step = step.as_ref().map_err(|error| *error)?;
        self.rolls.push(row);
        self.sensors.level(|quantity| row.get(Signal::from(quantity)));
        self.sensors.push(&sample, self.design.gravity_mps2);
        self.leaning.push(&sample, step.status, self.design.gravity_mps2);
        self.strong.push(&sample);
        self.stop.push(&sample, &self.engine);
        if let Some(recorder) = &mut self.recorder {
            recorder.push(&self.design, &sample)?;
        }
        self.rows += 1;
        if step.status == Status::Absent {
            self.absent_rows += 1;
        }
        self.keep(step.closed.as_ref());
        Ok(step.status)
    }

    /// Sets the scale on the bus from which the mass of the next rows follows; `None` if the rows are not
    /// from frames, or have the value of the scale itself.
    pub fn weighed_by(&mut self, scale: Option<Scale>) {
        self.bus_scale = scale;
    }

    /// The design of the truck.
    pub fn design(&self) -> &Design<f64> {
        &self.design
    }

    /// Ends the log and returns its maneuvers with the time of their end, s, and whether their mass is
    /// from a signal in the log.
    pub fn maneuvers(mut self) -> impl Iterator<Item = (Maneuver<f64>, f64, bool)> {
        let last = self.engine.finish();
        self.keep(last.as_ref());
        let origin_s = self.origin_s.unwrap_or(0.0);
        self.maneuvers.into_iter().zip(self.are_weighed).map(move |(maneuver, weighed)| {
            #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
            let end_s = origin_s + maneuver.end_us as f64 * 1e-6;
            (maneuver, end_s, weighed)
        })
    }

    /// The maneuvers of the last load.
    pub(super) fn of_load(&self) -> &[Maneuver<f64>] {
        self.maneuvers.get(self.first_of_load..).unwrap_or_default()
    }

    /// The roll angles and inputs that the channels take from a row. A row without a speed has no
    /// lateral acceleration from the yaw rate.
    pub fn signals(&mut self, row: &LogRow) -> Signals<f64> {
        let sample = self.sample(row).checked();
        Signals::of(&sample, sample.speed_mps, self.design.gravity_mps2)
    }

    /// The lateral acceleration that the truck feels in a row at a speed, m/s²; see
    /// [`felt_mps2`](super::felt_mps2). The height is that so far.
    pub fn felt_mps2(&mut self, row: &LogRow, speed_mps: f64) -> f64 {
        let sample = self.sample(row).checked();
        let height = self.engine.combined().and_then(|all| all.height());
        let height_m = height.map_or(self.design.reference_height_m, |all| all.height_m.value);
        felt_mps2(&self.design, &sample, speed_mps, [self.trailer_mass_kg, height_m])
    }

    pub(super) fn keep(&mut self, closed: Option<&Maneuver<f64>>) {
        if let Some(maneuver) = closed {
            let engine = (&mut self.engine, &self.options);
            let is_first_of_load = self.stop.close(maneuver, engine);
            self.sensors.close(is_first_of_load);
            self.unheard.push(maneuver);
            self.strong.close(maneuver, is_first_of_load);
            self.left_out.close(maneuver, &self.engine, is_first_of_load);
            if is_first_of_load {
                self.first_of_load = self.maneuvers.len();
                if self.seen.mass_kg.is_some() {
                    self.seen.weighed.change_load(maneuver.start_us);
                }
            }
        }
        if self.maneuvers.len() < MOST_MANEUVERS {
            let is_of_log = self.options.trailer_mass_kg.is_none();
            let is_weighed =
                |one: &Maneuver<f64>| is_of_log && self.seen.weighed.covers(one.start_us);
            self.are_weighed.extend(closed.map(is_weighed));
            self.maneuvers.extend(closed);
        } else {
            self.more_maneuvers += u64::from(closed.is_some());
        }
    }

    pub(super) fn sample(&mut self, row: &LogRow) -> Sample<f64> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s);
        // Microseconds since the first row. The cast gives zero for a time before the first row,
        // which the estimator then refuses.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6).round() as u64;
        let mut sample = row.sample(time_us, &self.settings);
        for (quantity, is_used) in [
            (Quantity::SteeringWheel, sample.steer_rad.is_finite()),
            (Quantity::LevelLeft, sample.suspension_roll_rad.is_finite()),
            (Quantity::TractorLevelLeft, sample.tractor_suspension_roll_rad.is_finite()),
            (Quantity::TrailerSuspensionPressure, sample.trailer_mass_kg.is_finite()),
            (Quantity::DrivePressureLeft, sample.trailer_mass_kg.is_finite()),
        ] {
            self.seen.unscaled[quantity.index()] |=
                !is_used && !row.get(Signal::from(quantity)).is_nan();
        }
        if row.trailer_mass_sd_kg >= 0.0 {
            self.seen.mass_sd_kg = Some(row.trailer_mass_sd_kg);
        }
        if sample.speed_mps.is_finite() {
            self.seen.speed_since_us.get_or_insert(time_us);
        }
        if sample.trailer_mass_kg.is_finite() {
            let logged_kg = sample.trailer_mass_kg;
            sample.trailer_mass_kg = weighed_mass(&self.design, logged_kg);
            self.seen.mass_kg = Some(sample.trailer_mass_kg);
            self.seen.scale = self.bus_scale.or_else(|| {
                // Most logs have the mass itself, which is then that of the sample.
                if logged_kg.to_bits() == row.trailer_mass_kg.to_bits() {
                    return Scale::in_log(Quantity::TrailerMass);
                }
                let (quantity, _) = row.weighed(&self.settings)?;
                Scale::in_log(quantity)
            });
            self.seen.weighed.weigh(time_us, [logged_kg, sample.trailer_mass_kg]);
        }
        if let Some(speed_mps) = self.options.speed_mps {
            sample.speed_mps = speed_mps;
        }
        add_force(&mut sample, self.design.gravity_mps2);
        if let Some(mass_kg) = self.options.trailer_mass_kg {
            sample.trailer_mass_kg = mass_kg;
        } else if sample.trailer_mass_kg.is_finite() {
            self.trailer_mass_kg = sample.trailer_mass_kg;
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design, maneuver};

    fn log(settings: AlignSettings<f64>, options: EstimateOptions) -> LogEstimator {
        LogEstimator::from_design(&design(), settings, options)
    }

    fn plain() -> LogEstimator {
        log(AlignSettings::NONE, EstimateOptions::default())
    }

    #[test]
    fn maneuvers_beyond_the_limit_are_counted() {
        let mut log = plain();
        let one = maneuver();
        log.maneuvers = vec![one; MOST_MANEUVERS - 1];
        for (closed, kept, more) in [
            (None, MOST_MANEUVERS - 1, 0),
            (Some(&one), MOST_MANEUVERS, 0),
            (Some(&one), MOST_MANEUVERS, 1),
            (Some(&one), MOST_MANEUVERS, 2),
            (None, MOST_MANEUVERS, 2),
        ] {
            log.keep(closed);
            assert_eq!((log.maneuvers.len(), log.more_maneuvers), (kept, more));
        }
    }

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
        let mut scaled = log(settings, EstimateOptions::default());
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
            let mut log = log(AlignSettings::NONE, options);
            log.sample(&LogRow { time_s: 0.0, ..row });
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
        let mut log = log(AlignSettings::NONE, options);
        let row = LogRow { time_s: 0.0, trailer_mass_kg: 21e3, speed_mps: 12.0, ..LogRow::ABSENT };
        let sample = log.sample(&row);
        let found = [sample.speed_mps, sample.trailer_mass_kg, log.trailer_mass_kg];
        assert_eq!(found.map(f64::to_bits), [13.0, 25e3, 25e3].map(f64::to_bits));
        assert!(log.seen.mass_kg.is_some() && log.seen.speed_since_us.is_some());
    }

    #[test]
    fn rows_without_roll_or_input_are_counted() {
        let mut log = plain();
        let row = |time_s: f64, roll_rad: f64| LogRow {
            time_s,
            roll_rad,
            steer_rad: 0.01,
            speed_mps: 15.0,
            ..LogRow::ABSENT
        };
        assert_eq!(log.push(&row(0.0, f64::NAN)), Ok(Status::Absent));
        assert_eq!(log.push(&row(0.1, f64::NAN)), Ok(Status::Absent));
        assert_eq!(log.push(&row(0.2, 0.01)), Ok(Status::Straight));
        assert!(log.push(&row(0.2, 0.01)).is_err());
        assert_eq!((log.rows, log.absent_rows), (3, 2));
        let turn = LogRow { lateral_acceleration_mps2: 3.0, ..row(0.3, 0.01) };
        assert_eq!(log.push(&turn), Ok(Status::Turning));
    }
}
