//! Steer histories over time (sections 2.6 and 5.3).

use std::f64::consts::TAU;

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use cg_vehicle::reduction::quality::rounded_step;

/// An open-loop maneuver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Maneuver {
    /// Rounded step `2 δ_m (2^(−e^(−a t)) − 1/2)` (eq. 5.3), held to the end.
    RoundedStep,
    /// A steady turn with both transitions: into the turn, held, and out of it.
    SteadyTurn,
    /// A change to the next lane: one full sine of three seconds.
    LaneChange,
    /// A sine of 0.2 Hz to the end.
    Sine,
    /// A steer angle that grows linearly to the end (or to rollover).
    Ramp,
    /// Ordinary driving: smoothed random turns to both sides, and straight sections.
    Drive,
}

cg_core::words!(Maneuver {
    RoundedStep => "rounded-step", "Rounded step, held";
    SteadyTurn => "steady-turn", "Into a turn and out again, or a driver on a circle";
    LaneChange => "lane-change", "One sine of three seconds, or a driver through a gate";
    Sine => "sine", "Sine of 0.2 Hz";
    Ramp => "ramp", "Linearly growing, to the end or until it rolls over";
    Drive => "drive", "Minutes of ordinary driving: random turns to both sides and straights";
});

/// A path for the preview driver (section 2.6).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Course {
    /// Turn of constant radius through an angle, to the left if positive; then straight ahead.
    Turn {
        /// Angle.
        angle_rad: f64,
        /// Radius.
        radius_m: f64,
    },
    /// Lane change of 3.65 m to the left over a gate length, 15 m after the start (eq. 2.5).
    Gate {
        /// Gate length.
        gate_m: f64,
    },
}

impl Course {
    /// Its length from the start of the vehicle.
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Turn { angle_rad, radius_m } => angle_rad.abs() * radius_m,
            Self::Gate { gate_m } => 15.0 + gate_m,
        }
    }
}

const LANE_CHANGE_S: f64 = 3.0;
const SINE_HZ: f64 = 0.2;
/// Time constant of the driver's steering in [`Maneuver::Drive`].
const DRIVER_LAG_S: f64 = 0.5;
/// Time constant of the driver's speed changes: half the speed changes at 0.4 m/s² at most.
const SPEED_LAG_S: f64 = 8.0;
/// Number of speeds at which the steer angle of the same lateral acceleration is computed;
/// interpolated linearly between them.
const SPEEDS: usize = 17;

/// A target value from a time on.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start_s: f64,
    target: f64,
}

/// Sum of the segments' changes, each through a critically damped second-order lag.
fn smoothed(segments: &[Segment], first: f64, lag_s: f64, time_s: f64) -> f64 {
    let (mut previous, mut value) = (first, first);
    for segment in segments.iter().take_while(|segment| segment.start_s < time_s) {
        let x = (time_s - segment.start_s) / lag_s;
        value += (segment.target - previous) * (1.0 - (1.0 + x) * libm::exp(-x));
        previous = segment.target;
    }
    value
}

/// Steer angle and speed in time: straight driving at first, then the maneuver.
#[derive(Clone, Debug)]
pub struct Histories {
    maneuver: Maneuver,
    amplitude_rad: f64,
    speed_mps: f64,
    start_s: f64,
    duration_s: f64,
    step_rate_per_s: f64,
    /// Steer angles of a drive.
    turns: Vec<Segment>,
    /// Speeds of a drive.
    speeds: Vec<Segment>,
    /// Steer angle of the same lateral acceleration as at [`Self::speed_mps`], over speed.
    scale: Vec<(f64, f64)>,
}

impl Histories {
    /// Default rate `a` of the rounded step, 1/s.
    pub const STEP_RATE_PER_S: f64 = 3.0;

    /// A maneuver of the given amplitude (road-wheel angle) at constant speed between two times;
    /// `seed` determines the turns of a [`Maneuver::Drive`].
    pub fn new(
        maneuver: Maneuver,
        amplitude_rad: f64,
        speed_mps: f64,
        (start_s, duration_s): (f64, f64),
        seed: u64,
    ) -> Self {
        let mut turns = Vec::new();
        if maneuver == Maneuver::Drive {
            let mut rng = StdRng::seed_from_u64(seed);
            let mut time_s = start_s;
            while time_s < duration_s {
                let straight = rng.random_bool(0.35);
                let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                let size = if straight { 0.0 } else { side * rng.random_range(0.4..1.0) };
                turns.push(Segment { start_s: time_s, target: size * amplitude_rad });
                time_s += rng.random_range(4.0..15.0);
            }
        }
        Self {
            maneuver,
            amplitude_rad,
            speed_mps,
            start_s,
            duration_s,
            step_rate_per_s: Self::STEP_RATE_PER_S,
            turns,
            speeds: Vec::new(),
            scale: Vec::new(),
        }
    }

    /// The same with another rate of the rounded step.
    #[must_use]
    pub fn with_step_rate(self, step_rate_per_s: f64) -> Self {
        Self { step_rate_per_s, ..self }
    }

    /// The same at speeds that change by up to this share in both directions, every 15 to 45 s.
    /// `scale` returns the factor of the steer angle that gives the same lateral acceleration at a
    /// speed.
    ///
    /// # Errors
    /// The first error of `scale`.
    pub fn with_speed_change<E>(
        mut self,
        share: f64,
        seed: u64,
        scale: impl Fn(f64) -> Result<f64, E>,
    ) -> Result<Self, E> {
        let mut rng = StdRng::seed_from_u64(seed.rotate_left(32) ^ 1);
        let mut time_s = self.start_s;
        while time_s < self.duration_s {
            let target = self.speed_mps * (1.0 + share * rng.random_range(-1.0..1.0));
            self.speeds.push(Segment { start_s: time_s, target });
            time_s += rng.random_range(15.0..45.0);
        }
        for k in 0..SPEEDS {
            #[allow(clippy::cast_precision_loss)] // an index
            let along = 2.0 * k as f64 / (SPEEDS - 1) as f64 - 1.0;
            let speed_mps = self.speed_mps * (1.0 + share * along);
            self.scale.push((speed_mps, scale(speed_mps)?));
        }
        Ok(self)
    }

    /// The amplitude.
    pub fn amplitude_rad(&self) -> f64 {
        self.amplitude_rad
    }

    /// Whether the speed changes.
    pub fn changes_speed(&self) -> bool {
        !self.speeds.is_empty()
    }

    /// Forward speed at a time.
    pub fn speed_mps(&self, time_s: f64) -> f64 {
        smoothed(&self.speeds, self.speed_mps, SPEED_LAG_S, time_s)
    }

    /// Road-wheel steer angle at a time.
    pub fn steer_rad(&self, time_s: f64) -> f64 {
        let t = time_s - self.start_s;
        if t <= 0.0 {
            return 0.0;
        }
        let held_s = (self.duration_s - self.start_s).max(f64::MIN_POSITIVE);
        let step = |t_s: f64| rounded_step(t_s, self.step_rate_per_s);
        let unit = match self.maneuver {
            Maneuver::RoundedStep => step(t),
            Maneuver::SteadyTurn => step(t) - step(t - 0.7 * held_s),
            Maneuver::LaneChange if t < LANE_CHANGE_S => libm::sin(TAU * t / LANE_CHANGE_S),
            Maneuver::LaneChange => 0.0,
            Maneuver::Sine => libm::sin(TAU * SINE_HZ * t),
            Maneuver::Ramp => t / held_s,
            Maneuver::Drive => {
                let steer_rad = smoothed(&self.turns, 0.0, DRIVER_LAG_S, time_s);
                return steer_rad * self.scale_at(self.speed_mps(time_s));
            }
        };
        self.amplitude_rad * unit
    }

    fn scale_at(&self, speed_mps: f64) -> f64 {
        let Some(last) = self.scale.len().checked_sub(2) else { return 1.0 };
        let i = self.scale.iter().rposition(|(at, _)| *at <= speed_mps).unwrap_or(0).min(last);
        let ((a, low), (b, high)) = (self.scale[i], self.scale[i + 1]);
        low + (high - low) * (speed_mps - a) / (b - a)
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
        let history = Histories::new(Maneuver::Drive, 0.05, 14.0, (2.0, 200.0), 1);
        let steer: Vec<f64> = (0..20_000).map(|k| history.steer_rad(f64::from(k) * 0.01)).collect();
        assert!(steer.iter().any(|s| *s > 0.02) && steer.iter().any(|s| *s < -0.02));
        // The greatest slope of the lag is Δ/(e T): 0.1 rad in 0.01 s of T = 0.5 s.
        let jump = steer.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(jump <= 0.1 * 0.01 / (std::f64::consts::E * DRIVER_LAG_S) * 1.01);
    }

    #[test]
    fn a_drive_changes_its_speed_within_its_share_and_gently() {
        let history = Histories::new(Maneuver::Drive, 0.05, 14.0, (2.0, 600.0), 1)
            .with_speed_change(0.3, 1, |speed_mps| Ok::<_, ()>(14.0 / speed_mps))
            .unwrap();
        let speed: Vec<f64> = (0..6000).map(|k| history.speed_mps(f64::from(k) * 0.1)).collect();
        let least = speed.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = speed.iter().copied().fold(0.0, f64::max);
        assert!(least > 14.0 * 0.7 && greatest < 14.0 * 1.3, "{least} {greatest}");
        assert!(greatest - least > 3.0, "{least} {greatest}");
        // One change gives 8.4/(e 8) = 0.39 m/s²; a change may begin before the last one has ended.
        let jump = speed.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.06, "{jump}");
    }
}
