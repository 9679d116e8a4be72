//! Steer histories over time (sections 2.6 and 5.3).

use std::f64::consts::TAU;

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// An open-loop maneuver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maneuver {
    /// Rounded step `2 δ_m (2^(−e^(−a t)) − 1/2)` (eq. 5.3), held to the end.
    RoundedStep,
    /// Into a turn, held, and out again: a steady turn with both transitions.
    SteadyTurn,
    /// One full sine of three seconds: out to the next lane.
    LaneChange,
    /// A sine of 0.2 Hz to the end.
    Sine,
    /// Steer angle growing linearly to the end.
    Ramp,
    /// Ordinary driving: random turns to both sides and straights, smoothed.
    Drive,
}

/// Rate `a` of the rounded step, 1/s.
const STEP_RATE_PER_S: f64 = 3.0;
const LANE_CHANGE_S: f64 = 3.0;
const SINE_HZ: f64 = 0.2;
/// Time constant of the driver's hands in [`Maneuver::Drive`].
const DRIVER_LAG_S: f64 = 0.5;

/// The rounded step of unit height (eq. 5.3) at time `t_s` after its start; zero before.
pub fn rounded_step(t_s: f64, rate_per_s: f64) -> f64 {
    if t_s <= 0.0 { 0.0 } else { 2.0 * ((-(-rate_per_s * t_s).exp()).exp2() - 0.5) }
}

/// A maneuver in time: straight driving until `start_s`, then the maneuver, `duration_s` in all.
#[derive(Clone, Debug)]
pub struct SteerHistory {
    maneuver: Maneuver,
    amplitude_rad: f64,
    start_s: f64,
    duration_s: f64,
    /// `(start, steer)` of each segment of a drive.
    segments: Vec<(f64, f64)>,
}

impl SteerHistory {
    /// A maneuver of the given amplitude (road-wheel angle); `seed` decides the turns of a
    /// [`Maneuver::Drive`].
    pub fn new(
        maneuver: Maneuver,
        amplitude_rad: f64,
        start_s: f64,
        duration_s: f64,
        seed: u64,
    ) -> Self {
        let mut segments = Vec::new();
        if maneuver == Maneuver::Drive {
            let mut rng = StdRng::seed_from_u64(seed);
            let mut time_s = start_s;
            while time_s < duration_s {
                let straight = rng.random_bool(0.35);
                let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                let size = if straight { 0.0 } else { side * rng.random_range(0.4..1.0) };
                segments.push((time_s, size * amplitude_rad));
                time_s += rng.random_range(4.0..15.0);
            }
        }
        Self { maneuver, amplitude_rad, start_s, duration_s, segments }
    }

    /// Road-wheel steer angle at a time, rad.
    pub fn steer_rad(&self, time_s: f64) -> f64 {
        let t = time_s - self.start_s;
        if t <= 0.0 {
            return 0.0;
        }
        let held_s = (self.duration_s - self.start_s).max(f64::MIN_POSITIVE);
        let unit = match self.maneuver {
            Maneuver::RoundedStep => rounded_step(t, STEP_RATE_PER_S),
            Maneuver::SteadyTurn => {
                rounded_step(t, STEP_RATE_PER_S) - rounded_step(t - 0.7 * held_s, STEP_RATE_PER_S)
            }
            Maneuver::LaneChange if t < LANE_CHANGE_S => (TAU * t / LANE_CHANGE_S).sin(),
            Maneuver::LaneChange => 0.0,
            Maneuver::Sine => (TAU * SINE_HZ * t).sin(),
            Maneuver::Ramp => t / held_s,
            Maneuver::Drive => return self.driven(time_s),
        };
        self.amplitude_rad * unit
    }

    /// Sum of the segments' changes, each through a critically damped second-order lag.
    fn driven(&self, time_s: f64) -> f64 {
        let mut previous = 0.0;
        let mut steer = 0.0;
        for &(start_s, target) in self.segments.iter().take_while(|(start_s, _)| *start_s < time_s)
        {
            let x = (time_s - start_s) / DRIVER_LAG_S;
            steer += (target - previous) * (1.0 - (1.0 + x) * (-x).exp());
            previous = target;
        }
        steer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rounded_step_starts_at_zero_and_ends_at_one() {
        assert!(rounded_step(0.0, 3.0).abs() < 1e-15);
        assert!(rounded_step(1e-9, 3.0).abs() < 1e-8); // 2^(−1) = 1/2: no jump
        assert!((rounded_step(20.0, 3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_drive_turns_to_both_sides_and_is_smooth() {
        let history = SteerHistory::new(Maneuver::Drive, 0.05, 2.0, 200.0, 1);
        let steer: Vec<f64> = (0..20_000).map(|k| history.steer_rad(f64::from(k) * 0.01)).collect();
        assert!(steer.iter().any(|s| *s > 0.02) && steer.iter().any(|s| *s < -0.02));
        // The lag's greatest slope is Δ/(e T): 0.1 rad in 0.01 s of T = 0.5 s.
        let jump = steer.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(jump <= 0.1 * 0.01 / (std::f64::consts::E * DRIVER_LAG_S) * 1.01);
    }
}
