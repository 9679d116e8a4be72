//! Samples as C sees them.

use cg_core::Sample;
use cg_ffi::CgSample;

/// The structure of the header for a sample.
pub(crate) fn for_c(sample: &Sample<f32>) -> CgSample {
    CgSample {
        time_us: sample.time_us,
        steer_rad: sample.steer_rad,
        roll_rad: sample.roll_rad,
        roll_to_gravity_rad: sample.roll_to_gravity_rad,
        tilt_rad: sample.tilt_rad,
        suspension_roll_rad: sample.suspension_roll_rad,
        speed_mps: sample.speed_mps,
        lateral_acceleration_mps2: sample.lateral_acceleration_mps2,
        lateral_specific_force_mps2: sample.lateral_specific_force_mps2,
        tractor_suspension_roll_rad: sample.tractor_suspension_roll_rad,
        tractor_lateral_specific_force_mps2: sample.tractor_lateral_specific_force_mps2,
        tractor_tilt_rad: sample.tractor_tilt_rad,
        yaw_rate_radps: sample.yaw_rate_radps,
        trailer_mass_kg: sample.trailer_mass_kg,
    }
}
