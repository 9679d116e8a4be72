//! Level sensors, accelerometers and inclinometers on trailer and tractor, and their errors.
//!
//! ```text
//!     level ─ + offset (left) ─ + noise ─ rounded ─►
//!     specific force ─ turned by the mounting angle ─ + offset ─ + noise ─ rounded ─►
//!     tilt ─ + mounting angle ─ + offset (frame) ─ + noise ─ rounded ─►
//! ```
//!
//! The measured suspension roll is the one that the measured levels give.

use rand::SeedableRng;
use rand::rngs::StdRng;
use serde::Serialize;

use crate::random::standard_normal;
use cg_logs::log::{LogRow, Signal};
use cg_vehicle::error::VehicleError;

/// The greatest offset, noise or step of a level.
pub const GREATEST_LEVEL_ERROR_M: f64 = 0.1;
/// The same of an accelerometer.
pub const GREATEST_ACCELEROMETER_ERROR_MPS2: f64 = 10.0;
/// The same of an inclinometer, and the greatest mounting angle.
pub const GREATEST_TILT_ERROR_RAD: f64 = 0.2;

/// The sensors of suspension roll and specific force; perfect by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChassisSensors {
    /// Constant offset of the left level sensors.
    pub level_offset_m: f64,
    /// Standard deviation of white noise on each level.
    pub level_noise_m: f64,
    /// Quantization step of the levels; zero for none.
    pub level_quantisation_m: f64,
    /// Constant offset of the accelerometers.
    pub accelerometer_offset_mps2: f64,
    /// Standard deviation of white noise on the accelerometers.
    pub accelerometer_noise_mps2: f64,
    /// Quantization step of the accelerometers; zero for none.
    pub accelerometer_quantisation_mps2: f64,
    /// Constant offset of the inclinometers on the frames; those on the axles have none.
    pub tilt_offset_rad: f64,
    /// Standard deviation of white noise on each inclinometer.
    pub tilt_noise_rad: f64,
    /// Quantization step of the inclinometers; zero for none.
    pub tilt_quantisation_rad: f64,
    /// Roll angle at which accelerometers and inclinometers are mounted on the frames.
    pub mounting_rad: f64,
}

/// Offset, standard deviation of the noise, and step of one sensor.
type Fault = (f64, f64, f64);

impl ChassisSensors {
    /// The errors of usual sensors on levels and accelerometers (docs/sensors.md); inclinometers have
    /// none.
    pub fn usual() -> Self {
        Self {
            level_noise_m: 0.0005,
            level_quantisation_m: 0.001,
            accelerometer_offset_mps2: 0.05,
            accelerometer_noise_mps2: 0.1,
            ..Self::default()
        }
    }

    /// The columns that these sensors add to a log.
    pub const COLUMNS: [Signal; 15] = [
        Signal::RollToGravity,
        Signal::Tilt,
        Signal::AxleTilt,
        Signal::SuspensionRoll,
        Signal::LevelLeft,
        Signal::LevelRight,
        Signal::LateralSpecificForce,
        Signal::TractorLateralSpecificForce,
        Signal::TractorSuspensionRoll,
        Signal::TractorTilt,
        Signal::TractorAxleTilt,
        Signal::TractorLevelLeft,
        Signal::TractorLevelRight,
        Signal::DrivePressureLeft,
        Signal::DrivePressureRight,
    ];

    /// Checks the values.
    ///
    /// # Errors
    /// [`VehicleError::Model`] with the value and its limits.
    pub fn check(&self) -> Result<(), VehicleError> {
        let [level, force, tilt] =
            [GREATEST_LEVEL_ERROR_M, GREATEST_ACCELEROMETER_ERROR_MPS2, GREATEST_TILT_ERROR_RAD];
        refuse_outside(&[
            ("level offset (m)", self.level_offset_m, -level, level),
            ("level noise (m)", self.level_noise_m, 0.0, level),
            ("level quantisation (m)", self.level_quantisation_m, 0.0, level),
            ("accelerometer offset (m/s²)", self.accelerometer_offset_mps2, -force, force),
            ("accelerometer noise (m/s²)", self.accelerometer_noise_mps2, 0.0, force),
            ("accelerometer quantisation (m/s²)", self.accelerometer_quantisation_mps2, 0.0, force),
            ("tilt offset (rad)", self.tilt_offset_rad, -tilt, tilt),
            ("tilt noise (rad)", self.tilt_noise_rad, 0.0, tilt),
            ("tilt quantisation (rad)", self.tilt_quantisation_rad, 0.0, tilt),
            ("mounting angle (rad)", self.mounting_rad, -tilt, tilt),
        ])
    }

    fn level(&self, offset_m: f64) -> Fault {
        (offset_m, self.level_noise_m, self.level_quantisation_m)
    }

    fn tilt(&self, offset_rad: f64) -> Fault {
        (offset_rad, self.tilt_noise_rad, self.tilt_quantisation_rad)
    }
}

/// Refuses the first value that is not within its limits; in a row: name, value, limits.
pub(super) fn refuse_outside(rows: &[(&str, f64, f64, f64)]) -> Result<(), VehicleError> {
    match rows.iter().find(|(_, value, least, greatest)| !(least..=greatest).contains(&value)) {
        None => Ok(()),
        Some((name, value, least, greatest)) => Err(VehicleError::Model(format!(
            "{name} {value} must lie between {least} and {greatest}"
        ))),
    }
}

/// Turns the chassis signals of true rows into measured ones, with random numbers of their own.
#[derive(Clone, Debug)]
pub(super) struct ChassisInstruments {
    sensors: ChassisSensors,
    gravity_mps2: f64,
    /// Suspension roll per difference of the levels: trailer, tractor.
    roll_per_difference: [f64; 2],
    chance: StdRng,
}

impl ChassisInstruments {
    pub(super) fn new(
        sensors: ChassisSensors,
        gravity_mps2: f64,
        roll_per_difference: [f64; 2],
        seed: u64,
    ) -> Self {
        let chance = StdRng::seed_from_u64(seed.rotate_left(32) ^ 2);
        Self { sensors, gravity_mps2, roll_per_difference, chance }
    }

    pub(super) fn measure(&mut self, truth: &LogRow, row: &mut LogRow) {
        let sensors = self.sensors;
        let left = sensors.level(sensors.level_offset_m);
        let right = sensors.level(0.0);
        row.level_left_m = self.measured(truth.level_left_m, left);
        row.level_right_m = self.measured(truth.level_right_m, right);
        row.tractor_level_left_m = self.measured(truth.tractor_level_left_m, left);
        row.tractor_level_right_m = self.measured(truth.tractor_level_right_m, right);
        let error_m = |left: f64, true_left: f64, right: f64, true_right: f64| {
            (left - true_left) - (right - true_right)
        };
        let [trailer, tractor] = self.roll_per_difference;
        row.suspension_roll_rad += trailer
            * error_m(row.level_left_m, truth.level_left_m, row.level_right_m, truth.level_right_m);
        row.tractor_suspension_roll_rad += tractor
            * error_m(
                row.tractor_level_left_m,
                truth.tractor_level_left_m,
                row.tractor_level_right_m,
                truth.tractor_level_right_m,
            );
        row.lateral_specific_force_mps2 = self.force(truth.lateral_specific_force_mps2);
        row.tractor_lateral_specific_force_mps2 =
            self.force(truth.tractor_lateral_specific_force_mps2);
        let frame = sensors.tilt(sensors.tilt_offset_rad);
        let axle = sensors.tilt(0.0);
        row.tilt_rad = self.measured(truth.tilt_rad + sensors.mounting_rad, frame);
        row.axle_tilt_rad = self.measured(truth.axle_tilt_rad, axle);
        row.tractor_tilt_rad = self.measured(truth.tractor_tilt_rad + sensors.mounting_rad, frame);
        row.tractor_axle_tilt_rad = self.measured(truth.tractor_axle_tilt_rad, axle);
    }

    /// The reading of an accelerometer. Vertically it feels gravity.
    fn force(&mut self, true_mps2: f64) -> f64 {
        let sensors = self.sensors;
        let (sin, cos) = libm::sincos(sensors.mounting_rad);
        let fault = (
            sensors.accelerometer_offset_mps2,
            sensors.accelerometer_noise_mps2,
            sensors.accelerometer_quantisation_mps2,
        );
        self.measured(true_mps2 * cos + self.gravity_mps2 * sin, fault)
    }

    fn measured(&mut self, value: f64, (offset, sd, step): Fault) -> f64 {
        let mut measured = value + offset;
        if sd > 0.0 {
            measured += sd * standard_normal(&mut self.chance);
        }
        if step > 0.0 { (measured / step).round() * step } else { measured }
    }
}
