//! The arguments that say what sensors make of a simulated log.

use cg_plant::sensors::Sensors;
use clap::Args;

use crate::numbers::{
    decibels, delay_s, jitter_s, not_negative, offset_rad, quantisation_rad, share,
};

#[derive(Debug, Args)]
#[command(next_help_heading = "Sensors")]
pub(crate) struct SensorArgs {
    /// Noise on the roll angle, decibels below its mean square
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = decibels)]
    snr_db: Option<f64>,
    /// Time constant of that noise, as a rough road makes it; 0 for white noise
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    noise_lag_s: f64,
    /// Standard deviation of white noise on the steer angle, at the road wheels
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    steer_noise_rad: f64,
    /// Standard deviation of white noise on the lateral acceleration
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    lateral_noise_mps2: f64,
    /// Play between the measured steer angle and the road wheels, from end to end
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    steer_play_rad: f64,
    /// Greatest angle that the roll sensor can show, either way [default: any]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = not_negative)]
    roll_limit_rad: Option<f64>,
    /// Constant offset of the roll sensor
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = offset_rad)]
    roll_offset_rad: f64,
    /// Constant offset of the steer angle, at the road wheels
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = offset_rad)]
    steer_offset_rad: f64,
    /// Step of the roll sensor (0.05 degrees are 0.00087); 0 for none
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = quantisation_rad)]
    quantisation_rad: f64,
    /// By how much the roll sensor is late
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = delay_s)]
    delay_s: f64,
    /// An inclinometer that feels lateral acceleration, in place of the roll sensor: column
    /// `tilt_rad`, roll plus lateral acceleration over g
    #[arg(long)]
    inclinometer: bool,
    /// Time stamps lie up to this much beside the sample, at random; less than half an interval
    #[arg(long, value_name = "T", default_value_t = 0.0, allow_negative_numbers = true, value_parser = jitter_s)]
    jitter_s: f64,
    /// Share of the rows whose roll angle is lost (an empty cell), at random
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_negative_numbers = true, value_parser = share)]
    drop_out: f64,
    /// The steering-wheel angle in place of that of the road wheels, by the vehicle file's ratio
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
