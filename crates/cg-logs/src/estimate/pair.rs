//! Two signals compared with each other.

use serde::{Deserialize, Serialize};

/// Correlation of two signals above which one may be the other with a lag: a lag of an eighth of a period.
const LEAST_CORRELATION: f64 = 0.7;

/// Running means and sums of products of two signals.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pair {
    pub(super) mean: [f64; 2],
    /// Sums of the squares of the first signal, of the products, and of the squares of the second one, about the means.
    pub(super) sums: [f64; 3],
}

impl Pair {
    pub(super) fn push(&mut self, rows: f64, [x, y]: [f64; 2]) {
        let before = [x - self.mean[0], y - self.mean[1]];
        self.mean[0] += before[0] / rows;
        self.mean[1] += before[1] / rows;
        self.sums[0] += before[0] * (x - self.mean[0]);
        self.sums[1] += before[0] * (y - self.mean[1]);
        self.sums[2] += before[1] * (y - self.mean[1]);
    }

    /// What has been seen counts for half.
    pub(super) fn forget_half(&mut self) {
        self.sums = self.sums.map(|sum| 0.5 * sum);
    }

    /// Slope of the second signal with respect to the first.
    pub(super) fn slope(&self) -> f64 {
        self.sums[1] / self.sums[0]
    }

    /// How much the second signal varies compared with the first, which a lag does not change.
    pub(super) fn ratio(&self) -> f64 {
        (self.sums[2] / self.sums[0]).sqrt()
    }

    /// The slope, or the [ratio](Self::ratio) if that is nearer to one and the second signal may follow the first with a
    /// lag, which makes the slope smaller.
    pub(super) fn gain(&self) -> f64 {
        let [slope, ratio] = [self.slope(), self.ratio()];
        let lags = slope > LEAST_CORRELATION * ratio;
        if lags && (ratio - 1.0).abs() < (slope - 1.0).abs() { ratio } else { slope }
    }

    /// Sum of the squares of the second signal about its mean.
    pub(super) fn second_square(&self) -> f64 {
        self.sums[2]
    }

    /// Sum of the squares of the first signal about its mean.
    pub(super) fn square(&self) -> f64 {
        self.sums[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lag of 0.6 rad makes a slope of cos 0.6 = 0.83 and leaves the ratio; one of 1.2 rad is no lag of a trailer.
    #[test]
    fn a_lag_does_not_change_a_gain() {
        for (lag_rad, factor, gain) in
            [(0.6, 1.0, 1.0), (0.6, 0.7, 0.7), (1.2, 1.0, 0.36), (3.0, 1.0, -0.99)]
        {
            let mut pair = Pair::default();
            for k in 0..1000_u32 {
                let angle_rad = f64::from(k) * std::f64::consts::TAU / 100.0;
                let both = [angle_rad.sin(), factor * (angle_rad - lag_rad).sin()];
                pair.push(f64::from(k + 1), both);
            }
            assert!((pair.gain() - gain).abs() < 0.01, "{lag_rad}: {}", pair.gain());
        }
    }
}
