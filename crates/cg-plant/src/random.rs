//! Normally distributed noise with the same bits on every computer.

use rand::RngCore;
use rand_distr::{Distribution, Open01, StandardNormal};

/// Where the tails of [`StandardNormal`] begin.
const TAIL: f64 = 3.654_152_885_361_009;

/// A source of random numbers that remembers the last two of them, the older one first.
struct Remembered<'a, R> {
    source: &'a mut R,
    last: [u64; 2],
}

impl<R: RngCore> RngCore for Remembered<'_, R> {
    fn next_u64(&mut self) -> u64 {
        self.last = [self.last[1], self.source.next_u64()];
        self.last[1]
    }
    fn next_u32(&mut self) -> u32 {
        self.source.next_u32()
    }
    fn fill_bytes(&mut self, bytes: &mut [u8]) {
        self.source.fill_bytes(bytes);
    }
}

/// One random number.
struct Once(u64);

impl RngCore for Once {
    fn next_u64(&mut self) -> u64 {
        self.0
    }
    #[allow(clippy::cast_possible_truncation)] // half of the bits
    fn next_u32(&mut self) -> u32 {
        self.0 as u32
    }
    fn fill_bytes(&mut self, bytes: &mut [u8]) {
        rand::rand_core::impls::fill_bytes_via_next(self, bytes);
    }
}

/// A number of the standard normal distribution.
///
/// [`StandardNormal`] multiplies a random number by a constant, except in one of 3900 draws: a number in the tails is
/// `TAIL − ln(u)/TAIL` with the logarithm of the system, whose last bit differs between systems. Here that number is computed
/// again, from the same `u`, which is the last but one that was drawn.
pub fn standard_normal(source: &mut impl RngCore) -> f64 {
    let mut remembered = Remembered { source, last: [0; 2] };
    let value: f64 = StandardNormal.sample(&mut remembered);
    if value.abs() <= TAIL {
        return value;
    }
    let [drawn, _] = remembered.last;
    let u: f64 = Open01.sample(&mut Once(drawn));
    (TAIL - libm::log(u) / TAIL).copysign(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    #[test]
    fn the_tails_are_those_of_the_library_up_to_rounding() {
        let (mut ours, mut theirs) = (StdRng::seed_from_u64(7), StdRng::seed_from_u64(7));
        let mut far = [0, 0];
        for _ in 0..1_000_000 {
            let (value, expected): (f64, f64) =
                (standard_normal(&mut ours), StandardNormal.sample(&mut theirs));
            if value.abs() > TAIL {
                far[usize::from(value > 0.0)] += 1;
                // Two logarithms of less than 37, each within one unit in the last place, over TAIL.
                assert!((value - expected).abs() < 4e-15, "{value} {expected}");
            } else {
                assert_eq!(value.to_bits(), expected.to_bits());
            }
        }
        // One draw in 3874 lies beyond 3.654, half of them on each side: 129 ± 11.
        assert!(far.iter().all(|count| (85..175).contains(count)), "{far:?}");
        assert_eq!(ours.next_u64(), theirs.next_u64());
    }
}
