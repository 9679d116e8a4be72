//! The speed along a road: at most its limits, with gentle accelerations.

use super::table::Road;
use cg_vehicle::limits::GREATEST_SPEED_MPS;

/// Greatest acceleration of a laden truck.
const ACCELERATION_MPS2: f64 = 0.4;
/// Greatest deceleration of a driver who looks ahead.
const DECELERATION_MPS2: f64 = 0.6;
/// Distance between the points.
const SPACING_M: f64 = 0.5;
/// Half of the distance over which the square of the speed is averaged, in points.
const HALF_POINTS: usize = 20;

/// The speed over the distance on a road.
#[derive(Clone, Debug)]
pub struct Pace {
    start_m: f64,
    square: Vec<f64>,
}

impl Road {
    /// Time of a usual drive on it, whole seconds: 120 or 150 s of the usual kinds, otherwise until
    /// the end of the table. The road has a speed limit.
    pub fn usual_duration_s(&self) -> f64 {
        let [start_m, end_m] = self.ends_m();
        let whole_s = self.pace().time_s(start_m, end_m).floor();
        self.usual_duration_s.map_or(whole_s, |usual_s| usual_s.min(whole_s))
    }

    /// The speed that a driver chooses: the limits, reduced where the next curve demands it and after
    /// it. The square of the speed is averaged over 20 m, so that the acceleration has no jumps.
    pub fn pace(&self) -> Pace {
        let [start_m, end_m] = self.ends_m();
        // At most 2e7 points, for a road of 10 000 km.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = ((end_m - start_m) / SPACING_M).ceil() as usize + 1;
        #[allow(clippy::cast_precision_loss)]
        let limits: Vec<f64> = (0..count)
            .map(|k| {
                let mps = self.at(start_m + SPACING_M * k as f64).speed_mps.min(GREATEST_SPEED_MPS);
                mps * mps
            })
            .collect();
        // The least limit within the distance of the average keeps the average below every limit.
        let mut square: Vec<f64> = (0..count)
            .map(|k| around(k, count).map(|i| limits[i]).fold(f64::INFINITY, f64::min))
            .collect();
        for k in 1..count {
            square[k] = square[k].min(square[k - 1] + 2.0 * ACCELERATION_MPS2 * SPACING_M);
        }
        for k in (1..count).rev() {
            square[k - 1] = square[k - 1].min(square[k] + 2.0 * DECELERATION_MPS2 * SPACING_M);
        }
        let mut sums = vec![0.0];
        for value in &square {
            sums.push(sums[sums.len() - 1] + value);
        }
        let mean = |k: usize| {
            let range = around(k, count);
            #[allow(clippy::cast_precision_loss)] // tens of points
            let n = range.len() as f64;
            (sums[range.end] - sums[range.start]) / n
        };
        Pace { start_m, square: (0..count).map(mean).collect() }
    }
}

/// The points around a point, the same number on both sides.
fn around(k: usize, count: usize) -> std::ops::Range<usize> {
    let half = HALF_POINTS.min(k).min(count - 1 - k);
    k - half..k + half + 1
}

impl Pace {
    /// The speed at a distance.
    pub fn speed_mps(&self, distance_m: f64) -> f64 {
        let at = ((distance_m - self.start_m) / SPACING_M).max(0.0);
        // The cast saturates; the index is then limited to the table.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let i = (at as usize).min(self.square.len() - 2);
        #[allow(clippy::cast_precision_loss)]
        let share = (at - i as f64).min(1.0);
        (self.square[i] + share * (self.square[i + 1] - self.square[i])).sqrt()
    }

    /// Time from one distance to a greater one.
    pub fn time_s(&self, from_m: f64, to_m: f64) -> f64 {
        let (mut time_s, mut at_m) = (0.0, from_m);
        while at_m < to_m {
            let step_m = SPACING_M.min(to_m - at_m);
            time_s += step_m / self.speed_mps(at_m + 0.5 * step_m);
            at_m += step_m;
        }
        time_s
    }
}
