//! Yaw damping from the decay after a steer pulse.
//!
//! **Reference.** El-Gindy, quoted in the thesis, 1.2.3: at 100 km/h the steering wheel is turned
//! by 80 degrees and back in half a sine of 0.1 s. The result is the logarithmic decrement of the
//! peaks of the lateral acceleration of the rearmost trailer.

use std::f64::consts::PI;

use crate::plant::{Progress, YawRollPlant};
use cg_vehicle::error::VehicleError;

/// Length of the pulse.
pub const PULSE_S: f64 = 0.1;
/// Angle of the steering wheel.
pub const PULSE_WHEEL_RAD: f64 = 80.0 * PI / 180.0;
/// Duration of the observed decay.
const WATCHED_S: f64 = 8.0;
/// Peaks below this share of the first one are due to friction and rounding.
const LEAST: f64 = 0.02;

/// The trailer's response to a pulse, sampled at each step after the end of the pulse.
///
/// # Errors
/// If the vehicle cannot drive straight, or rolls over.
pub fn after_pulse(
    plant: &YawRollPlant,
    speed_mps: f64,
    amplitude_rad: f64,
) -> Result<Vec<f64>, VehicleError> {
    let mut run = plant.start(speed_mps)?;
    let mut seen = Vec::new();
    while run.time_s() < WATCHED_S {
        let time_s = run.time_s() + plant.step_s();
        let unit = if time_s < PULSE_S { libm::sin(PI * time_s / PULSE_S) } else { 0.0 };
        if run.push(amplitude_rad * unit, speed_mps, plant.step_s()) != Progress::Running {
            run.upright()?;
        }
        if time_s > PULSE_S {
            seen.push(run.sample().trailer.lateral_acceleration_mps2);
        }
    }
    Ok(seen)
}

/// Damping ratio from successive peaks of alternating sign, by their logarithmic decrement; `None`
/// if there are fewer than two. The first peak is that of the pulse itself and does not count.
pub fn damping_ratio(samples: &[f64]) -> Option<f64> {
    let mut peaks: Vec<f64> = Vec::new();
    for three in samples.windows(3) {
        let [before, here, after] = [three[0], three[1], three[2]];
        if (here - before) * (after - here) < 0.0 && here * (here - before) > 0.0 {
            match peaks.last_mut() {
                // Only the greatest value of a swing.
                Some(last) if *last * here > 0.0 => {
                    *last = if here.abs() > last.abs() { here } else { *last };
                }
                _ => peaks.push(here),
            }
        }
    }
    let first = peaks.get(1)?.abs();
    let kept: Vec<f64> =
        peaks[1..].iter().map(|peak| peak.abs()).take_while(|peak| *peak > LEAST * first).collect();
    let (last, swings) = (kept.last()?, kept.len() - 1);
    if swings == 0 {
        return None;
    }
    #[allow(clippy::cast_precision_loss)] // a few peaks
    let decrement = libm::log(first / last) / swings as f64;
    Some(decrement / libm::hypot(decrement, PI))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decrement_of_a_damped_sine_is_its_damping() {
        for zeta in [0.1_f64, 0.25, 0.5] {
            let (omega, damped) = (4.0, 4.0 * (1.0 - zeta * zeta).sqrt());
            let samples: Vec<f64> = (0..8000)
                .map(|k| {
                    let t = f64::from(k) * 1e-3;
                    (-zeta * omega * t).exp() * (damped * t).sin()
                })
                .collect();
            let found = damping_ratio(&samples).unwrap();
            // On a grid of 1 ms each peak is wrong by (ω dt)²/2 of its height.
            assert!((found - zeta).abs() < 1e-4, "{found} {zeta}");
        }
        assert_eq!(damping_ratio(&[3.0, 2.0, 1.0, 0.5]), None);
    }
}
