//! Maneuvers that contradict the height so far and were therefore not fused.
//!
//! The estimator leaves a maneuver out until a second one agrees with it. That is right for a single outlier, but if
//! many are left out, the height depends on which came first.

use cg_core::{CHANNELS, Channel, HeightError, Maneuver, Reject};
use serde::{Deserialize, Serialize};

use super::engine::Engine;

/// Share of left-out maneuvers from which on none of the others is known to be right.
const MANY: f64 = 0.2;
/// Relative difference of a height that contradicts nothing.
const AGREES: f64 = 0.02;
/// The most left-out maneuvers that are kept, the last ones.
const MOST: usize = 1000;

/// The maneuvers of a load that were left out.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LeftOut {
    /// Number of fused heights after the last maneuver.
    fused: u32,
    heights_m: Vec<[Option<f64>; CHANNELS]>,
}

impl LeftOut {
    /// None so far, for an estimator that may have heights from before a restart.
    pub fn new(engine: &Engine) -> Self {
        Self { fused: fused(engine), heights_m: Vec::new() }
    }

    /// Takes a maneuver after the estimator has; `true` if it is the first of another load.
    pub fn close(&mut self, maneuver: &Maneuver<f64>, engine: &Engine, is_of_another_load: bool) {
        // A height that no load can have contradicts the others as well.
        let heights_m = maneuver.outcomes.map(|one| match one.height_m {
            Ok(height) => Some(height.value),
            Err(Reject::Height(HeightError::OutOfRange { height_m })) => Some(height_m),
            Err(_) => None,
        });
        let before = std::mem::replace(&mut self.fused, fused(engine));
        if is_of_another_load {
            self.heights_m.clear();
        } else if self.fused == before && heights_m.iter().any(Option::is_some) {
            if self.heights_m.len() == MOST {
                self.heights_m.remove(0);
            }
            self.heights_m.push(heights_m);
        }
    }

    /// What the left-out maneuvers say of a fused height, m, of this many maneuvers in a channel.
    pub fn doubt(&self, channel: Channel, (height_m, maneuvers): (f64, u32)) -> Doubt {
        let heights_m = self.heights_m.iter().filter_map(|one| one[channel.index()]);
        let (mut least_m, mut greatest_m) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut squares_m2, mut left_out) = (0.0, 0);
        for one_m in heights_m {
            (least_m, greatest_m) = (least_m.min(one_m), greatest_m.max(one_m));
            squares_m2 += (one_m - height_m) * (one_m - height_m);
            left_out += 1;
        }
        let all = left_out + maneuvers;
        let is_wide = f64::from(left_out) > MANY * f64::from(all);
        let sd_m = if is_wide { (squares_m2 / f64::from(all)).sqrt() } else { 0.0 };
        let range_m = [least_m, greatest_m];
        let is_elsewhere = range_m.iter().all(|one_m| (one_m / height_m - 1.0).abs() < AGREES);
        Doubt { left_out, all, range_m, is_elsewhere, sd_m }
    }
}

fn fused(engine: &Engine) -> u32 {
    let heights = Channel::ALL.into_iter().filter_map(|channel| engine.height(channel));
    heights.map(|height| height.maneuvers).sum()
}

/// What left-out maneuvers say of a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    left_out: u32,
    all: u32,
    range_m: [f64; 2],
    /// Whether these heights agree, so that those of another channel contradict.
    is_elsewhere: bool,
    /// Standard deviation that this adds to the height, m: the root mean square of how far all maneuvers are from the
    /// fused ones, if more than a fifth were left out.
    pub sd_m: f64,
}

impl Doubt {
    /// What is said of the maneuvers that were left out.
    pub fn message(&self) -> Option<String> {
        let Self { left_out, all, range_m: [least_m, greatest_m], is_elsewhere, sd_m } = *self;
        let what = if is_elsewhere {
            "contradict the others in another channel and are left out".to_owned()
        } else if left_out == 1 {
            format!(
                "contradict the height of the others and are left out, with a height of {least_m:.2} m"
            )
        } else {
            format!(
                "contradict the height of the others and are left out, with heights from {least_m:.2} to \
                 {greatest_m:.2} m"
            )
        };
        let so = if sd_m > 0.0 { ", so the interval was made wider" } else { "" };
        (left_out > 0).then(|| {
            format!(
                "{left_out} of {all} maneuvers {what}{so}: the load shifted, or a sensor does not measure turns to both sides \
                 alike"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::options::EstimateOptions;
    use crate::estimate::trial::{design, maneuver};

    #[test]
    fn a_height_that_no_load_can_have_contradicts_the_others() {
        let engine = Engine::new(&design(), &EstimateOptions::default());
        let mut left_out = LeftOut::new(&engine);
        let mut impossible = maneuver();
        let why = Reject::Height(HeightError::OutOfRange { height_m: 6.4 });
        impossible.outcomes[Channel::Steer.index()].height_m = Err(why);
        left_out.close(&impossible, &engine, false);
        left_out.close(&maneuver(), &engine, false); // without a ratio
        let message = left_out.doubt(Channel::Steer, (1.7, 9)).message().unwrap();
        assert!(message.contains("1 of 10") && message.contains("6.40 m"), "{message}");
    }

    /// By hand: one of nine is an outlier; two of four at 0.4 m are 0.4/√2 m.
    #[test]
    fn many_that_were_left_out_widen_the_interval() {
        let left_out = |heights_m: &[f64]| {
            let heights_m = heights_m.iter().map(|&height_m| {
                let mut of_channels = [None; CHANNELS];
                of_channels[Channel::Steer.index()] = Some(height_m);
                of_channels
            });
            LeftOut { fused: 0, heights_m: heights_m.collect() }
        };
        let none = left_out(&[]).doubt(Channel::Steer, (1.7, 2));
        assert_eq!((none.message(), none.sd_m), (None, 0.0));
        let one = left_out(&[2.1]).doubt(Channel::Steer, (1.7, 8));
        let message = one.message().unwrap();
        assert!(one.sd_m == 0.0 && message.contains("1 of 9") && !message.contains("wider"));
        let half = left_out(&[2.1, 1.3]).doubt(Channel::Steer, (1.7, 2));
        assert!((half.sd_m - 0.4 / 2.0_f64.sqrt()).abs() < 1e-12);
        let message = half.message().unwrap();
        assert!(message.contains("2 of 4") && message.contains("from 1.30 to 2.10 m, so"));
        let elsewhere = left_out(&[1.72, 1.69]).doubt(Channel::Steer, (1.7, 8)).message().unwrap();
        assert!(elsewhere.contains("in another channel"), "{elsewhere}");
        let other = left_out(&[2.1]).doubt(Channel::Tractor, (1.7, 1));
        assert_eq!(other.message(), None);
    }
}
