//! Arguments for the sensor errors of a simulated log.

use cg_plant::sensors::{ChassisSensors, Sensors};
use clap::Args;

use crate::numbers::{
    decibels, delay_s, jitter_s, not_negative, number, offset_rad, quantisation_rad, share,
};

#[derive(Debug, Args)]
#[command(next_help_heading = "Sensors")]
pub(crate) struct SensorArgs {
    /// Signal-to-noise ratio of the roll angle, dB [default: no noise]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = decibels)]
    snr_db: Option<f64>,
    /// Time constant of that noise, s, as from a rough road; 0 for white noise
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    noise_lag_s: f64,
    /// Standard deviation of white noise on the steer angle, at the road wheels, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    steer_noise_rad: f64,
    /// Standard deviation of white noise on the lateral acceleration, m/s²
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    lateral_noise_mps2: f64,
    /// Play between the measured steer angle and the road wheels, from end to end, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    steer_play_rad: f64,
    /// Greatest angle of the roll sensor in both directions, rad [default: unlimited]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = not_negative)]
    roll_limit_rad: Option<f64>,
    /// Constant offset of the roll sensor, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = offset_rad)]
    roll_offset_rad: f64,
    /// Constant offset of the steer angle, at the road wheels, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = offset_rad)]
    steer_offset_rad: f64,
    /// Resolution of the roll sensor, rad (0.05 degrees are 0.00087); 0 for unlimited
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = quantisation_rad)]
    quantisation_rad: f64,
    /// Delay of the roll sensor, s
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = delay_s)]
    delay_s: f64,
    /// Simulate an inclinometer instead of the roll sensor; its column `tilt_rad` is the roll angle
    /// plus the lateral acceleration divided by g
    #[arg(long)]
    inclinometer: bool,
    /// Greatest random error of the time stamps, s; less than half a sampling interval
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = jitter_s)]
    jitter_s: f64,
    /// Share of the rows whose roll angle is lost at random (an empty cell), from 0 to 0.95
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_negative_numbers = true, value_parser = share)]
    drop_out: f64,
    /// Write the steering-wheel angle instead of the road-wheel angle, with the vehicle file's
    /// ratio
    #[arg(long)]
    steering_wheel: bool,
}

impl From<&SensorArgs> for Sensors {
    fn from(arguments: &SensorArgs) -> Self {
        Self {
            snr_db: arguments.snr_db,
            noise_lag_s: arguments.noise_lag_s,
            steer_noise_rad: arguments.steer_noise_rad,
            lateral_noise_mps2: arguments.lateral_noise_mps2,
            steer_play_rad: arguments.steer_play_rad,
            roll_limit_rad: arguments.roll_limit_rad,
            roll_offset_rad: arguments.roll_offset_rad,
            steer_offset_rad: arguments.steer_offset_rad,
            quantisation_rad: arguments.quantisation_rad,
            delay_s: arguments.delay_s,
            inclinometer: arguments.inclinometer,
            jitter_s: arguments.jitter_s,
            drop_out: arguments.drop_out,
            steering_wheel: arguments.steering_wheel,
        }
    }
}

/// Errors of the sensors on frames and axles.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sensors of the chassis (with --road)")]
pub(crate) struct ChassisArgs {
    /// Constant offset of the left level sensors, m
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    level_offset_m: f64,
    /// Standard deviation of white noise on each level, m
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    level_noise_m: f64,
    /// Resolution of the levels, m; 0 for unlimited
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    level_quantisation_m: f64,
    /// Constant offset of the accelerometers, m/s²
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    accelerometer_offset_mps2: f64,
    /// Standard deviation of white noise on the accelerometers, m/s²
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    accelerometer_noise_mps2: f64,
    /// Resolution of the accelerometers, m/s²; 0 for unlimited
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    accelerometer_quantisation_mps2: f64,
    /// Constant offset of the inclinometers on the frames, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    tilt_offset_rad: f64,
    /// Standard deviation of white noise on each inclinometer, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    tilt_noise_rad: f64,
    /// Resolution of the inclinometers, rad; 0 for unlimited
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    tilt_quantisation_rad: f64,
    /// Roll angle at which accelerometers and inclinometers are mounted on the frames, rad
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    mounting_rad: f64,
}

impl From<&ChassisArgs> for ChassisSensors {
    fn from(arguments: &ChassisArgs) -> Self {
        Self {
            level_offset_m: arguments.level_offset_m,
            level_noise_m: arguments.level_noise_m,
            level_quantisation_m: arguments.level_quantisation_m,
            accelerometer_offset_mps2: arguments.accelerometer_offset_mps2,
            accelerometer_noise_mps2: arguments.accelerometer_noise_mps2,
            accelerometer_quantisation_mps2: arguments.accelerometer_quantisation_mps2,
            tilt_offset_rad: arguments.tilt_offset_rad,
            tilt_noise_rad: arguments.tilt_noise_rad,
            tilt_quantisation_rad: arguments.tilt_quantisation_rad,
            mounting_rad: arguments.mounting_rad,
        }
    }
}
