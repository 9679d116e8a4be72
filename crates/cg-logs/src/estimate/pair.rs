//! Two signals compared with each other.

use serde::{Deserialize, Serialize};

/// Running means and sums of products of two signals.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pair {
    pub(super) mean: [f64; 2],
    /// Sums of the squares of the first signal and of the products, about the means.
    pub(super) sums: [f64; 2],
}

impl Pair {
    pub(super) fn push(&mut self, rows: f64, [x, y]: [f64; 2]) {
        let before = [x - self.mean[0], y - self.mean[1]];
        self.mean[0] += before[0] / rows;
        self.mean[1] += before[1] / rows;
        self.sums[0] += before[0] * (x - self.mean[0]);
        self.sums[1] += before[0] * (y - self.mean[1]);
    }

    /// Slope of the second signal with respect to the first.
    pub(super) fn slope(&self) -> f64 {
        self.sums[1] / self.sums[0]
    }

    /// Sum of the squares of the first signal about its mean.
    pub(super) fn square(&self) -> f64 {
        self.sums[0]
    }
}
