//! The structures of the header, field by field. The header documents them.
#![allow(missing_docs)]

use cg_core::{Height, Measured, Rollover, Sample, Status, Step};
use cg_core::{Outcome, Reject};

/// Number of channels of a design for C.
pub const CHANNELS: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgSample {
    pub time_us: u64,
    pub steer_rad: f32,
    pub roll_rad: f32,
    pub roll_to_gravity_rad: f32,
    pub tilt_rad: f32,
    pub suspension_roll_rad: f32,
    pub speed_mps: f32,
    pub lateral_acceleration_mps2: f32,
    pub lateral_specific_force_mps2: f32,
    pub tractor_suspension_roll_rad: f32,
    pub tractor_lateral_specific_force_mps2: f32,
    pub tractor_tilt_rad: f32,
    pub yaw_rate_radps: f32,
    pub trailer_mass_kg: f32,
}

impl CgSample {
    /// Converts to the estimator's sample.
    pub fn sample(&self) -> Sample<f32> {
        Sample {
            time_us: self.time_us,
            steer_rad: self.steer_rad,
            roll_rad: self.roll_rad,
            roll_to_gravity_rad: self.roll_to_gravity_rad,
            tilt_rad: self.tilt_rad,
            suspension_roll_rad: self.suspension_roll_rad,
            speed_mps: self.speed_mps,
            lateral_acceleration_mps2: self.lateral_acceleration_mps2,
            lateral_specific_force_mps2: self.lateral_specific_force_mps2,
            tractor_suspension_roll_rad: self.tractor_suspension_roll_rad,
            tractor_lateral_specific_force_mps2: self.tractor_lateral_specific_force_mps2,
            tractor_tilt_rad: self.tractor_tilt_rad,
            yaw_rate_radps: self.yaw_rate_radps,
            trailer_mass_kg: self.trailer_mass_kg,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgMeasured {
    pub value: f32,
    pub sd: f32,
}

impl CgMeasured {
    const NONE: Self = Self { value: f32::NAN, sd: f32::NAN };

    fn new(measured: Measured<f32>) -> Self {
        Self { value: measured.value, sd: measured.sd }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgOutcome {
    pub reject: i32,
    pub ratio: CgMeasured,
    pub snr_db: f32,
    pub height_m: CgMeasured,
    pub systematic_sd_m: f32,
    pub road_sd_m: f32,
}

impl CgOutcome {
    const ZERO: Self = Self {
        reject: 0,
        ratio: CgMeasured { value: 0.0, sd: 0.0 },
        snr_db: 0.0,
        height_m: CgMeasured { value: 0.0, sd: 0.0 },
        systematic_sd_m: 0.0,
        road_sd_m: 0.0,
    };

    fn new(outcome: &Outcome<f32>) -> Self {
        let reject = match outcome.height_m {
            Ok(_) => 0,
            Err(Reject::Absent) => 1,
            Err(Reject::Unexcited(_)) => 2,
            Err(Reject::Imprecise { .. }) => 3,
            Err(Reject::OutsideDesign { .. }) => 4,
            Err(Reject::Height(_)) => 5,
            Err(_) => 6,
        };
        let fit = outcome.fit.as_ref();
        Self {
            reject,
            ratio: fit.map_or(CgMeasured::NONE, |fit| CgMeasured::new(fit.ratio)),
            snr_db: fit.map_or(f32::NAN, |fit| fit.snr_db),
            height_m: outcome.height_m.map_or(CgMeasured::NONE, CgMeasured::new),
            systematic_sd_m: outcome.systematic_sd_m,
            road_sd_m: outcome.road_sd_m,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgStep {
    pub status: i32,
    pub closed: i32,
    pub start_us: u64,
    pub end_us: u64,
    pub speed_mps: f32,
    pub trailer_mass_kg: f32,
    pub outcomes: [CgOutcome; CHANNELS],
}

impl CgStep {
    /// Converts to the structure of the header.
    pub fn new(step: &Step<f32, CHANNELS>) -> Self {
        let mut out = Self {
            status: match step.status {
                Status::Absent => 0,
                Status::Straight => 1,
                Status::Turning => 2,
            },
            closed: 0,
            start_us: 0,
            end_us: 0,
            speed_mps: 0.0,
            trailer_mass_kg: 0.0,
            outcomes: [CgOutcome::ZERO; CHANNELS],
        };
        if let Some(closed) = &step.closed {
            out.closed = 1;
            (out.start_us, out.end_us) = (closed.start_us, closed.end_us);
            (out.speed_mps, out.trailer_mass_kg) = (closed.speed_mps, closed.trailer_mass_kg);
            out.outcomes = closed.outcomes.each_ref().map(CgOutcome::new);
        }
        out
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgHeight {
    pub height_m: CgMeasured,
    pub random_sd_m: f32,
    pub maneuvers: u32,
}

impl CgHeight {
    /// Converts to the structure of the header.
    pub fn new(height: &Height<f32>) -> Self {
        Self {
            height_m: CgMeasured::new(height.height_m),
            random_sd_m: height.random_sd_m,
            maneuvers: height.maneuvers,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CgRollover {
    pub static_stability_factor_g: f32,
    pub static_rollover_threshold_g: CgMeasured,
}

impl CgRollover {
    /// Converts to the structure of the header.
    pub fn new(rollover: &Rollover<f32>) -> Self {
        Self {
            static_stability_factor_g: rollover.static_stability_factor_g,
            static_rollover_threshold_g: CgMeasured::new(rollover.static_rollover_threshold_g),
        }
    }
}
