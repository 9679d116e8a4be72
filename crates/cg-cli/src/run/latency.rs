//! A histogram of delays in constant memory.

use super::events::Latency;

/// Number of classes per power of two. The error of a percentile is at most 6 %.
const CLASSES: usize = 16;
const OCTAVES: usize = 32;

/// Delays in microseconds, counted in classes whose width grows with the delay.
#[derive(Debug)]
pub(crate) struct Histogram {
    counts: Vec<u64>,
    total: u64,
    greatest_us: u64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; CLASSES * OCTAVES], total: 0, greatest_us: 0 }
    }
}

impl Histogram {
    pub(crate) fn push(&mut self, delay_us: u64) {
        let last = self.counts.len() - 1;
        self.counts[class(delay_us).min(last)] += 1;
        self.total += 1;
        self.greatest_us = self.greatest_us.max(delay_us);
    }

    /// The delay that this share of the delays does not exceed, µs.
    fn quantile_us(&self, share: f64) -> f64 {
        #[allow(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss
        )]
        let rank = (share * self.total as f64).ceil() as u64;
        let mut seen = 0;
        for (class, count) in self.counts.iter().enumerate() {
            seen += count;
            if seen >= rank {
                return upper_us(class);
            }
        }
        0.0
    }

    pub(crate) fn summary(&self) -> Option<Latency> {
        #[allow(clippy::cast_precision_loss)]
        let greatest_us = self.greatest_us as f64;
        let ms = |us: f64| us.min(greatest_us) * 1e-3;
        (self.total > 0).then(|| Latency {
            p50: ms(self.quantile_us(0.5)),
            p99: ms(self.quantile_us(0.99)),
            greatest: ms(greatest_us),
        })
    }
}

/// One class per microsecond up to 16 µs, then sixteen classes per power of two.
fn class(us: u64) -> usize {
    let octave = us.max(1).ilog2().saturating_sub(3) as usize;
    if octave == 0 {
        return usize::try_from(us).unwrap_or(0);
    }
    let within = usize::try_from(us >> (octave - 1)).unwrap_or(0) - CLASSES;
    octave * CLASSES + within
}

#[allow(clippy::cast_precision_loss)] // small numbers
fn upper_us(class: usize) -> f64 {
    let octave = class / CLASSES;
    if octave == 0 {
        return class as f64;
    }
    ((class % CLASSES + CLASSES + 1) as f64) * (1_u64 << (octave - 1)) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_right_to_a_sixteenth() {
        let mut histogram = Histogram::default();
        for us in 1..=100_000 {
            histogram.push(us);
        }
        let Latency { p50, p99, greatest } = histogram.summary().unwrap();
        assert!((p50 / 50.0 - 1.0).abs() < 1.0 / 16.0, "{p50}");
        assert!((p99 / 99.0 - 1.0).abs() < 1.0 / 16.0, "{p99}");
        assert!((greatest - 100.0).abs() < 1e-9);
    }

    #[test]
    fn classes_grow_without_gaps() {
        for us in 0..100_000 {
            let step = class(us + 1) - class(us);
            assert!(step <= 1, "{us}");
        }
        assert_eq!(Histogram::default().summary(), None);
        Histogram::default().push(u64::MAX);
    }
}
