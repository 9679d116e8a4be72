//! The fixture logs, compiled in.

use cg_core::Sample;

include!(concat!(env!("OUT_DIR"), "/log.rs"));

/// Time, steer, roll, speed, lateral acceleration, yaw rate, trailer mass.
const COLUMNS: usize = 7;

/// The samples, in order.
pub fn samples() -> impl Iterator<Item = Sample<f32>> {
    LOG.chunks_exact(4 * COLUMNS).map(|row| {
        let mut words = row.chunks_exact(4).map(|word| {
            word.iter().rev().fold(0_u32, |value, byte| (value << 8) | u32::from(*byte))
        });
        let mut next = || words.next().unwrap_or(0);
        let time_us = u64::from(next());
        let mut signal = || f32::from_bits(next());
        Sample {
            steer_rad: signal(),
            roll_rad: signal(),
            speed_mps: signal(),
            lateral_acceleration_mps2: signal(),
            yaw_rate_radps: signal(),
            trailer_mass_kg: signal(),
            ..Sample::absent(time_us)
        }
    })
}
