//! Measured springs: two force curves that enclose the friction.

use crate::tables::Spring;

/// Two curves with common nodes; the end segments are extended.
#[derive(Clone, Debug)]
pub struct Envelope {
    deflection_m: Vec<f64>,
    /// For each segment: force at its start and slope, for compression and then for extension.
    segment: Vec<[f64; 4]>,
}

impl Envelope {
    /// The curves of a measured spring.
    pub fn new(spring: &Spring) -> Self {
        let x = &spring.deflection_m;
        let segment = (0..x.len().saturating_sub(1))
            .map(|i| {
                let slope = |y: &[f64]| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
                let (up, down) = (&spring.compression_n, &spring.extension_n);
                [up[i], slope(up), down[i], slope(down)]
            })
            .collect();
        Self { deflection_m: x.clone(), segment }
    }

    #[inline]
    fn segment(&self, x: f64) -> (f64, &[f64; 4]) {
        let mut i = 0;
        while i + 1 < self.segment.len() && x >= self.deflection_m[i + 1] {
            i += 1;
        }
        (x - self.deflection_m[i], &self.segment[i])
    }

    /// Force on the curve towards which the spring moves.
    #[inline]
    pub fn towards(&self, x: f64, rate: f64) -> f64 {
        let (dx, s) = self.segment(x);
        if rate > 0.0 { s[0] + s[1] * dx } else { s[2] + s[3] * dx }
    }

    /// Force midway between the curves, and its slope.
    pub fn middle(&self, x: f64) -> (f64, f64) {
        let (dx, s) = self.segment(x);
        (0.5 * (s[0] + s[2] + (s[1] + s[3]) * dx), 0.5 * (s[1] + s[3]))
    }

    /// The greater of the slopes of both curves.
    pub fn steepest(&self, x: f64) -> f64 {
        let (_, s) = self.segment(x);
        s[1].max(s[3])
    }

    /// Half the distance between the curves.
    pub fn friction_n(&self, x: f64) -> f64 {
        let (dx, s) = self.segment(x);
        0.5 * (s[0] - s[2] + (s[1] - s[3]) * dx)
    }

    /// Deflection at which the force midway between the curves is `force_n`. The curves must be
    /// increasing.
    pub fn deflection_at(&self, force_n: f64) -> f64 {
        let last = self.segment.len() - 1;
        let segment = |i: usize| self.middle(self.deflection_m[i]);
        let i = (0..last).find(|&i| segment(i + 1).0 >= force_n).unwrap_or(last);
        let (start, slope) = segment(i);
        self.deflection_m[i] + (force_n - start) / slope
    }
}
