//! What the tests of drawn trucks have in common.
#![allow(clippy::unwrap_used)] // helpers of tests

use cg_core::Channel;
use cg_logs::log::LogRow;
use cg_vehicle::Vehicle;
use cg_vehicle::belief::{Deviations, log_gain};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, StandardNormal};

/// Multiplies steer angle and lateral acceleration as the sensors of a truck with these deviations do, and as the part of the model
/// error does that no calibration removes, which is another one with each seed.
pub(crate) fn measure(rows: &mut [LogRow], (file, deviations): (&Vehicle, &Deviations), seed: u64) {
    let mut source = StdRng::seed_from_u64(seed);
    let residual_sd = file.uncertainty.residual_sd;
    let [steer, lateral] = [Channel::Steer, Channel::LateralAcceleration].map(|channel| {
        let normal: f64 = StandardNormal.sample(&mut source);
        (residual_sd * normal - log_gain(deviations, channel)).exp()
    });
    for row in rows {
        row.steer_rad *= steer;
        row.lateral_acceleration_mps2 *= lateral;
        row.yaw_rate_radps *= lateral;
    }
}

/// What comes of all of them, on two threads.
pub(crate) fn each<T: Sync, R: Send>(all: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let (first, second) = all.split_at(all.len() / 2);
    let made = |half: &[T]| half.iter().map(&of).collect::<Vec<R>>();
    std::thread::scope(|scope| {
        let other = scope.spawn(|| made(second));
        let mut all = made(first);
        all.extend(other.join().unwrap());
        all
    })
}
