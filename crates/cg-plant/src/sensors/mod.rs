//! Sensor errors added to the truth: offsets, noise, quantization, delay, jitter, dropouts.
//!
//! ```text
//!     roll ─ delayed ─ + a_y/g if inclinometer ─ + offset ─ + noise ─ limited ─ rounded ─ lost ─► roll or tilt
//!     steer ─ through the play ─ + offset ─ + noise ─ × steering ratio if steering wheel ─► steer or steering wheel
//!     lateral acceleration ─ + noise ─►
//!     time ─ + jitter ─► time stamp
//! ```
//!
//! A roll angle relative to gravity is measured like the roll angle, by the same sensor. `chassis`
//! has the sensors of suspension roll and specific force.

mod chassis;

pub use chassis::{
    ChassisSensors, GREATEST_ACCELEROMETER_ERROR_MPS2, GREATEST_LEVEL_ERROR_M,
    GREATEST_TILT_ERROR_RAD,
};

use std::collections::VecDeque;

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use serde::Serialize;

use chassis::{ChassisInstruments, refuse_outside};

use crate::random::standard_normal;
use cg_logs::log::{LogRow, Signal};
use cg_vehicle::error::VehicleError;

/// The greatest signal-to-noise ratio, and the greatest ratio of noise to signal.
pub const GREATEST_SNR_DB: f64 = 300.0;
/// The greatest offset of roll and steer.
pub const GREATEST_OFFSET_RAD: f64 = 0.2;
/// The greatest step of quantization.
pub const GREATEST_QUANTISATION_RAD: f64 = 0.1;
/// The greatest delay.
pub const GREATEST_DELAY_S: f64 = 2.0;
/// The greatest standard deviation of the steer noise.
pub const GREATEST_STEER_NOISE_RAD: f64 = 0.1;
/// The greatest standard deviation of the noise of the lateral acceleration.
pub const GREATEST_LATERAL_NOISE_MPS2: f64 = 10.0;
/// The greatest time constant of noise.
pub const GREATEST_NOISE_LAG_S: f64 = 10.0;
/// The greatest share of lost rows.
pub const GREATEST_DROP_OUT: f64 = 0.95;

/// The sensors of a simulated log; perfect by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sensors {
    /// Noise on the roll angle, decibels below its mean square.
    pub snr_db: Option<f64>,
    /// Time constant of that noise (rough road); zero means white noise.
    pub noise_lag_s: f64,
    /// Standard deviation of white noise on the steer angle, at the road wheels.
    pub steer_noise_rad: f64,
    /// Standard deviation of white noise on the lateral acceleration.
    pub lateral_noise_mps2: f64,
    /// Play between the steer sensor and the road wheels, from end to end.
    pub steer_play_rad: f64,
    /// Greatest angle that the roll sensor can show to either side; `None` for no limit.
    pub roll_limit_rad: Option<f64>,
    /// Constant offset of the roll sensor.
    pub roll_offset_rad: f64,
    /// Constant offset of the steer angle, at the road wheels.
    pub steer_offset_rad: f64,
    /// Quantization step of the roll sensor; zero for none.
    pub quantisation_rad: f64,
    /// Delay of the roll sensor.
    pub delay_s: f64,
    /// An inclinometer in place of the roll sensor. It also feels lateral acceleration: roll + `a_y/g`.
    pub inclinometer: bool,
    /// Time stamps differ from the instant of the sample by up to this much, uniformly distributed.
    pub jitter_s: f64,
    /// Share of the rows whose roll angle is randomly lost.
    pub drop_out: f64,
    /// The angle of the steering wheel in place of the road wheels.
    pub steering_wheel: bool,
}

impl Sensors {
    /// Checks the values at a sampling rate.
    ///
    /// # Errors
    /// [`VehicleError::Model`] with the value and its limits.
    pub fn check(&self, rate_hz: f64) -> Result<(), VehicleError> {
        let half_s = 0.5 / rate_hz;
        refuse_outside(&[
            (
                "signal-to-noise ratio (dB)",
                self.snr_db.unwrap_or(0.0),
                -GREATEST_SNR_DB,
                GREATEST_SNR_DB,
            ),
            ("roll offset (rad)", self.roll_offset_rad, -GREATEST_OFFSET_RAD, GREATEST_OFFSET_RAD),
            (
                "steer offset (rad)",
                self.steer_offset_rad,
                -GREATEST_OFFSET_RAD,
                GREATEST_OFFSET_RAD,
            ),
            ("quantisation (rad)", self.quantisation_rad, 0.0, GREATEST_QUANTISATION_RAD),
            ("noise lag (s)", self.noise_lag_s, 0.0, GREATEST_NOISE_LAG_S),
            ("steer noise (rad)", self.steer_noise_rad, 0.0, GREATEST_STEER_NOISE_RAD),
            ("lateral noise (m/s²)", self.lateral_noise_mps2, 0.0, GREATEST_LATERAL_NOISE_MPS2),
            ("steer play (rad)", self.steer_play_rad, 0.0, GREATEST_OFFSET_RAD),
            ("roll limit (rad)", self.roll_limit_rad.unwrap_or(1.0), 0.001, 1.0),
            ("delay (s)", self.delay_s, 0.0, GREATEST_DELAY_S),
            ("drop-out (share)", self.drop_out, 0.0, GREATEST_DROP_OUT),
            // Less than half an interval, so that time increases.
            ("jitter (s)", self.jitter_s, 0.0, 0.98 * half_s),
        ])
    }

    /// What the roll sensor can show: limited and rounded.
    fn within_roll_sensor(&self, mut roll_rad: f64) -> f64 {
        if let Some(limit_rad) = self.roll_limit_rad {
            roll_rad = roll_rad.clamp(-limit_rad, limit_rad);
        }
        if self.quantisation_rad > 0.0 {
            roll_rad = (roll_rad / self.quantisation_rad).round() * self.quantisation_rad;
        }
        roll_rad
    }

    /// The columns of a log of these sensors.
    pub fn columns(&self) -> [Signal; 7] {
        [
            Signal::Time,
            if self.steering_wheel { Signal::SteeringWheel } else { Signal::Steer },
            if self.inclinometer { Signal::Tilt } else { Signal::Roll },
            Signal::Speed,
            Signal::LateralAcceleration,
            Signal::YawRate,
            Signal::TrailerMass,
        ]
    }
}

/// Turns true rows into measured rows.
#[derive(Clone, Debug)]
pub struct Instruments {
    sensors: Sensors,
    noise_sd_rad: f64,
    gravity_mps2: f64,
    steering_ratio: f64,
    noise_source: StdRng,
    /// Random numbers of jitter, dropouts and input noise. They are separate, so that the noise of the
    /// roll angle does not depend on them.
    chance: StdRng,
    /// Noise of the roll angle at the previous row, and the time of that row.
    noise_before: Option<(f64, f64)>,
    /// The steer angle on the sensor's side of the play.
    steer_shown_rad: Option<f64>,
    /// True times and roll angles (to the road, to gravity), as far back as the delay.
    past: VecDeque<(f64, [f64; 3])>,
    chassis: Option<ChassisInstruments>,
    is_first: bool,
}

impl Instruments {
    /// The state before the first row. The steering ratio is used with [`Sensors::steering_wheel`] only.
    pub fn new(
        sensors: &Sensors,
        noise_sd_rad: f64,
        gravity_mps2: f64,
        steering_ratio: f64,
        seed: u64,
    ) -> Self {
        Self {
            sensors: *sensors,
            noise_sd_rad,
            gravity_mps2,
            steering_ratio,
            noise_source: StdRng::seed_from_u64(seed),
            chance: StdRng::seed_from_u64(!seed),
            noise_before: None,
            steer_shown_rad: None,
            past: VecDeque::new(),
            chassis: None,
            is_first: true,
        }
    }

    /// The same with sensors of the chassis. `roll_per_difference` is the suspension roll per
    /// difference of the levels: trailer, tractor.
    #[must_use]
    pub fn with_chassis(
        mut self,
        sensors: &ChassisSensors,
        roll_per_difference: [f64; 2],
        seed: u64,
    ) -> Self {
        let gravity_mps2 = self.gravity_mps2;
        self.chassis =
            Some(ChassisInstruments::new(*sensors, gravity_mps2, roll_per_difference, seed));
        self
    }

    /// The measured row for a true row.
    pub fn measure(&mut self, truth: &LogRow) -> LogRow {
        let sensors = self.sensors;
        let mut row = *truth;
        row.steer_rad = self.steer_through_play_rad(truth.steer_rad)
            + sensors.steer_offset_rad
            + self.chance_noise(sensors.steer_noise_rad);
        row.lateral_acceleration_mps2 += self.chance_noise(sensors.lateral_noise_mps2);
        if sensors.steering_wheel {
            row.steering_wheel_rad = row.steer_rad * self.steering_ratio;
            row.steer_rad = f64::NAN;
        }
        let felt_rad = if sensors.inclinometer {
            truth.lateral_acceleration_mps2 / self.gravity_mps2
        } else {
            0.0
        };
        let noise_rad = self.roll_noise_rad(truth.time_s);
        let lost = sensors.drop_out > 0.0 && self.chance.random_bool(sensors.drop_out);
        let delayed_rad = self.delayed_roll_rad(truth);
        let shown = |true_rad: f64, noise_rad: f64| {
            let shown_rad = true_rad + felt_rad + sensors.roll_offset_rad + noise_rad;
            if lost { f64::NAN } else { sensors.within_roll_sensor(shown_rad) }
        };
        let mut roll_rad = shown(delayed_rad[0], noise_rad);
        row.roll_to_gravity_rad = shown(delayed_rad[1], noise_rad);
        if truth.second_roll_rad.is_finite() {
            // White noise is its own; of slow noise both sensors have the same.
            row.second_roll_rad = shown(delayed_rad[2], self.roll_noise_rad(truth.time_s));
        }
        if let Some(chassis) = &mut self.chassis {
            chassis.measure(truth, &mut row);
        }
        if sensors.jitter_s > 0.0 && !self.is_first {
            row.time_s += sensors.jitter_s * self.chance.random_range(-1.0..1.0);
        }
        self.is_first = false;
        if sensors.inclinometer {
            row.tilt_rad = std::mem::replace(&mut roll_rad, f64::NAN);
        }
        row.roll_rad = roll_rad;
        row
    }

    /// White noise, or noise through a first-order lag with the same standard deviation.
    fn roll_noise_rad(&mut self, time_s: f64) -> f64 {
        let fresh = self.noise_sd_rad * standard_normal(&mut self.noise_source);
        let lag_s = self.sensors.noise_lag_s;
        let value = match self.noise_before {
            Some((before, then_s)) if lag_s > 0.0 => {
                let kept = libm::exp(-(time_s - then_s) / lag_s);
                kept * before + (1.0 - kept * kept).sqrt() * fresh
            }
            _ => fresh,
        };
        self.noise_before = Some((value, time_s));
        value
    }

    fn chance_noise(&mut self, sd: f64) -> f64 {
        if sd > 0.0 { sd * standard_normal(&mut self.chance) } else { 0.0 }
    }

    /// The measured angle moves only after the road wheels have taken up the play.
    fn steer_through_play_rad(&mut self, steer_rad: f64) -> f64 {
        let half_rad = 0.5 * self.sensors.steer_play_rad;
        let before_rad = self.steer_shown_rad.unwrap_or(steer_rad);
        let shown_rad = before_rad.clamp(steer_rad - half_rad, steer_rad + half_rad);
        self.steer_shown_rad = Some(shown_rad);
        shown_rad
    }

    /// The roll angle `delay_s` ago, interpolated linearly between rows; before the first row, its value.
    fn delayed_roll_rad(&mut self, truth: &LogRow) -> [f64; 3] {
        let now_rad = [truth.roll_rad, truth.roll_to_gravity_rad, truth.second_roll_rad];
        if self.sensors.delay_s <= 0.0 {
            return now_rad;
        }
        self.past.push_back((truth.time_s, now_rad));
        let then_s = truth.time_s - self.sensors.delay_s;
        while self.past.get(1).is_some_and(|next| next.0 <= then_s) {
            self.past.pop_front();
        }
        match (self.past.front(), self.past.get(1)) {
            (Some(before), Some(after)) if then_s > before.0 => [0, 1, 2].map(|k| {
                let change_rad = after.1[k] - before.1[k];
                before.1[k] + change_rad * (then_s - before.0) / (after.0 - before.0)
            }),
            (Some(before), _) => before.1,
            _ => now_rad,
        }
    }
}
