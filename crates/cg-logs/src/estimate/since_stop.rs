//! Whether the load was another one after a stop, by all turns since the stop together.
//!
//! The estimator compares one turn after a stop with the heights before it. A turn that is weak, on a banked road or with much
//! noise agrees with both, and the new load is then averaged into the old one. Here the turns since the stop are fused apart, and
//! their mean is compared with that of the turns before.

use cg_core::decide::height::Fusion;
use cg_core::decide::load::{NOT_COMMON, STANDING_MPS, STOP_US};
use cg_core::{CHANNELS, Channel, Height, Maneuver, Sample};
use serde::{Deserialize, Serialize};

use super::engine::Engine;
use super::options::EstimateOptions;

/// Least number of turns since the stop.
const LEAST_TURNS: u32 = 3;
/// Standard deviations of a difference that is no chance, although it is looked at after every turn.
const DIFFERENT: f64 = 4.5;

/// The heights before and since a stop.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct SinceStop {
    last_us: Option<u64>,
    standing_us: u64,
    before: Option<[Fusion<f64>; CHANNELS]>,
    since: [Fusion<f64>; CHANNELS],
    changed_us: Option<u64>,
}

impl SinceStop {
    /// After a restart, which may have been a stop.
    pub fn restarted(engine: &Engine) -> Self {
        Self { before: Some(engine.memory().fused), ..Self::default() }
    }

    /// Takes the next sample.
    pub fn push(&mut self, sample: &Sample<f64>, engine: &Engine) {
        let interval_us = self.last_us.map_or(0, |last_us| sample.time_us.saturating_sub(last_us));
        self.last_us = Some(sample.time_us);
        let before_us = self.standing_us;
        self.standing_us = if sample.speed_mps.abs() < STANDING_MPS {
            before_us.saturating_add(interval_us)
        } else {
            0
        };
        let begins = before_us < STOP_US && self.standing_us >= STOP_US;
        if begins || interval_us >= STOP_US {
            let Self { last_us, standing_us, changed_us, .. } = *self;
            *self = Self { last_us, standing_us, changed_us, ..Self::restarted(engine) };
        }
    }

    /// The end of the maneuver that revealed another load, by itself or together with others, µs.
    pub fn load_since_us(&self) -> Option<u64> {
        self.changed_us
    }

    /// Takes a maneuver after the estimator has. Whether it is the first of another load by itself, or shows together with the
    /// others since the stop that they are of another load than those before it: the estimator then goes on with these alone.
    pub fn close(
        &mut self,
        maneuver: &Maneuver<f64>,
        (engine, options): (&mut Engine, &EstimateOptions),
    ) -> bool {
        let by_itself = engine.load_since_us() == Some(maneuver.end_us);
        if by_itself || self.together(maneuver, (engine, options)) {
            self.before = None;
            self.changed_us = Some(maneuver.end_us);
        }
        self.changed_us == Some(maneuver.end_us)
    }

    fn together(
        &mut self,
        maneuver: &Maneuver<f64>,
        (engine, options): (&mut Engine, &EstimateOptions),
    ) -> bool {
        let Some(before) = &self.before else { return false };
        for (since, outcome) in self.since.iter_mut().zip(&maneuver.outcomes) {
            if let Ok(height_m) = outcome.height_m {
                since.push(height_m, outcome.systematic_sd_m);
            }
        }
        let best = engine.best_channel().map(Channel::index);
        let both =
            best.and_then(|place| Some((before[place].height()?, self.since[place].height()?)));
        if !both.is_some_and(|(before, since)| are_different(&before, &since)) {
            return false;
        }
        let memory = cg_core::Memory { fused: self.since, waiting: None, ..engine.memory() };
        let Some(other) = Engine::restored(engine.design(), options, &memory) else { return false };
        *engine = other;
        true
    }
}

fn are_different(before: &Height<f64>, since: &Height<f64>) -> bool {
    let systematic = |height: &Height<f64>| {
        let [total, random] = [height.height_m.sd, height.random_sd_m];
        (total * total - random * random).max(0.0).sqrt()
    };
    let own = NOT_COMMON * systematic(before).max(systematic(since));
    let sd = libm::hypot(libm::hypot(before.random_sd_m, since.random_sd_m), own);
    let difference_m = (since.height_m.value - before.height_m.value).abs();
    since.maneuvers >= LEAST_TURNS && difference_m > DIFFERENT * sd
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{design, maneuver};
    use cg_core::Measured;

    fn turn(value: f64, sd: f64) -> Maneuver<f64> {
        let mut one = maneuver();
        one.outcomes[Channel::Steer.index()].height_m = Ok(Measured { value, sd });
        one.outcomes[Channel::Steer.index()].systematic_sd_m = 0.05;
        one
    }

    /// A truck that knows 2.0 ± 0.02 m of its load and has stopped.
    fn stopped(options: &EstimateOptions) -> (Engine, SinceStop) {
        let mut memory = Engine::new(&design(), options).memory();
        memory.fused[Channel::Steer.index()].push(Measured { value: 2.0, sd: 0.02 }, 0.05);
        let engine = Engine::restored(&design(), options, &memory).unwrap();
        let mut stop = SinceStop::default();
        let standing = [1, 30_000_000, 59_999_999, 60_000_001].map(|time_us| (time_us, 0.0));
        for (time_us, speed_mps) in [(0, 10.0)].into_iter().chain(standing) {
            stop.push(&Sample { speed_mps, ..Sample::absent(time_us) }, &engine);
            assert_eq!(stop.before.is_some(), time_us > 60_000_000, "{time_us}");
        }
        (engine, stop)
    }

    /// Turns of 0.09 m each: three are 0.052 m, with 0.02 and 0.015 m 0.058 m, so 0.26 m are different.
    #[test]
    fn turns_that_say_little_each_say_it_together() {
        let options = EstimateOptions::default();
        for (height_m, changes) in [(2.24, false), (2.3, true)] {
            let (mut engine, mut stop) = stopped(&options);
            let turn = turn(height_m, 0.09);
            let mut close = || stop.close(&turn, (&mut engine, &options));
            assert_eq!([close(), close(), close()], [false, false, changes], "{height_m}");
            let found = engine.height(Channel::Steer).unwrap();
            if changes {
                assert!((found.height_m.value - height_m).abs() < 1e-9 && found.maneuvers == 3);
                let mut next = turn;
                next.end_us += 1;
                assert!(!stop.close(&next, (&mut engine, &options)), "once");
                assert_eq!(stop.load_since_us(), Some(turn.end_us));
            }
        }
    }

    #[test]
    fn without_a_stop_nothing_is_compared() {
        let options = EstimateOptions::default();
        let (mut engine, _) = stopped(&options);
        let mut stop = SinceStop::default();
        for _ in 0..5 {
            assert!(!stop.close(&turn(2.9, 0.01), (&mut engine, &options)));
        }
        assert_eq!(stop.load_since_us(), None);
    }
}
