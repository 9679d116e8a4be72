//! Time to rollover: the time until a limit is reached if the present motion continues.
//!
//! **Reference.** Chen and Peng, quoted in the thesis, 1.2.4. Their model continues the present
//! steer angle. On board, only the present rate of a measured quantity is available.

use super::ramp::Ramp;

/// Time until `|value|` reaches `limit` at the present rate; zero beyond the limit, `None` if it
/// moves away from the limit or does not change.
///
/// ```
/// use cg_plant::rollover::time_to_rollover_s;
///
/// // 0.2 g, growing by 0.05 g each second, threshold 0.35 g:
/// let time_s = time_to_rollover_s(0.20, 0.05, 0.35).unwrap();
/// assert!((time_s - 3.0).abs() < 1e-12);
/// assert_eq!(time_to_rollover_s(-0.2, 0.05, 0.35), None);
/// ```
pub fn time_to_rollover_s(value: f64, rate_per_s: f64, limit: f64) -> Option<f64> {
    let approach = rate_per_s * value.signum();
    if value.abs() >= limit {
        Some(0.0)
    } else if approach > 0.0 {
        Some((limit - value.abs()) / approach)
    } else {
        None
    }
}

/// Time to rollover in a ramp, from one instant of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TimeToRollover {
    /// Lateral acceleration at the instant.
    pub lateral_acceleration_mps2: f64,
    /// From the rate of the lateral acceleration over the last half second.
    pub predicted_s: f64,
    /// Until the last inner wheel that is not steered left the road.
    pub simulated_s: f64,
}

impl TimeToRollover {
    /// Window over which the rate is computed.
    const WINDOW_S: f64 = 0.5;

    /// From the instant when the lateral acceleration is half of the threshold.
    pub fn half_way(ramp: &Ramp, threshold_mps2: f64) -> Option<Self> {
        let lateral = |i: usize| ramp.points[i].lateral_acceleration_mps2;
        let i = (0..ramp.points.len()).find(|&i| lateral(i) >= 0.5 * threshold_mps2)?;
        let now_s = ramp.points[i].time_s;
        let j = (0..i).rev().find(|&j| now_s - ramp.points[j].time_s >= Self::WINDOW_S - 1e-9)?;
        let rate = (lateral(i) - lateral(j)) / (now_s - ramp.points[j].time_s);
        Some(Self {
            lateral_acceleration_mps2: lateral(i),
            predicted_s: time_to_rollover_s(lateral(i), rate, threshold_mps2)?,
            simulated_s: ramp.lifted_s()? - now_s,
        })
    }
}
