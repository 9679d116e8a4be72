//! The wind of a scenario: a mean with gusts in its direction.

use rand::SeedableRng;
use rand::rngs::StdRng;

use super::scenario::Scenario;
use crate::random::standard_normal;
use cg_vehicle::wind::{GUST_S, GUSTS};

/// Another stream of random numbers than those of sensors and drive.
const STREAM: u64 = 0x7769_6e64;

/// The wind, from one sample to the next.
pub(super) struct Weather {
    mean_mps: f64,
    from_rad: f64,
    /// The present gust, in standard deviations.
    gust: f64,
    source: StdRng,
}

impl Weather {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            mean_mps: scenario.wind_mps,
            from_rad: scenario.wind_from_rad,
            gust: 0.0,
            source: StdRng::seed_from_u64(scenario.seed ^ STREAM),
        }
    }

    /// Its mean velocity in the axes of the way at the start: forward, to the left.
    pub(super) fn mean_mps(&self) -> [f64; 2] {
        self.velocity_mps(self.mean_mps)
    }

    /// Its velocity after an interval, s.
    pub(super) fn next_mps(&mut self, interval_s: f64) -> [f64; 2] {
        if self.mean_mps > 0.0 {
            let kept = libm::exp(-interval_s / GUST_S);
            let new = (1.0 - kept * kept).sqrt() * standard_normal(&mut self.source);
            self.gust = kept * self.gust + new;
        }
        self.velocity_mps(self.mean_mps * (1.0 + GUSTS * self.gust))
    }

    /// A wind from ahead blows backward, one from the left to the right.
    fn velocity_mps(&self, speed_mps: f64) -> [f64; 2] {
        if self.mean_mps <= 0.0 {
            return [0.0; 2];
        }
        let (sin, cos) = libm::sincos(self.from_rad);
        [-speed_mps * cos, -speed_mps * sin]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maneuver::Maneuver;
    use cg_vehicle::Vehicle;
    use cg_vehicle::guide::{TruckKind, template};

    /// The standard error of the mean of 6000 s of gusts that last 3 s is 0.15 √(6/6000) = 0.0047 of the mean, and that of their
    /// standard deviation about as much; four of both.
    #[test]
    fn gusts_have_their_mean_and_their_size() {
        let vehicle = Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap();
        let scenario = Scenario {
            wind_mps: 5.0,
            wind_from_rad: std::f64::consts::FRAC_PI_2,
            ..Scenario::of(&vehicle, Maneuver::Drive)
        };
        let mut weather = Weather::new(&scenario);
        let speeds: Vec<f64> = (0..60_000).map(|_| -weather.next_mps(0.1)[1]).collect();
        let mean = speeds.iter().sum::<f64>() / 6e4;
        let sd = (speeds.iter().map(|speed| (speed - mean).powi(2)).sum::<f64>() / 6e4).sqrt();
        assert!((mean / 5.0 - 1.0).abs() < 0.02 && (sd / 5.0 - GUSTS).abs() < 0.02, "{mean} {sd}");
        assert!(weather.mean_mps()[0].abs() < 1e-12);
        let calm = Weather::new(&Scenario { wind_mps: 0.0, ..scenario }).next_mps(0.1);
        assert!(calm.iter().all(|part| part.abs() <= 0.0));
    }
}
