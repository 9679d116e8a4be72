//! Comparison and combination of the heights of all channels.

use crate::decide::height::Height;
use crate::math::real::Real;
use crate::truck::channel::{CHANNELS, Output};
use crate::truck::ratio::Measured;

/// χ² that chance exceeds with a probability of 1 %, and of 0.01 %, for one, two and three degrees of
/// freedom. There are at most four channels.
const LIMITS: [[f64; 2]; CHANNELS - 1] = [[6.635, 15.137], [9.210, 18.421], [11.345, 21.108]];

/// The result of comparing and combining the channels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Combined<T> {
    /// The heights agree within their joint uncertainty, or only one channel has a height.
    Agreed(Height<T>),
    /// The heights differ by more than chance explains (probability 1 %). There is a height, with
    /// an interval that is wider by the Birge ratio `√(χ²/freedom)`.
    Doubtful {
        /// The height.
        height: Height<T>,
        /// χ² of the differences between the heights; see [`Heights::combined`].
        chi_square: T,
        /// Its degrees of freedom: one less than the number of heights.
        freedom: u32,
    },
    /// The heights contradict each other (probability 0.01 %). There is no combined height.
    Contradictory {
        /// χ² of the differences between the heights; see [`Heights::combined`].
        chi_square: T,
        /// Its degrees of freedom: one less than the number of heights.
        freedom: u32,
    },
    /// One channel gives a height that this trailer cannot have, and no other channel shows that its
    /// input is wrong. The roll angle may be wrong. There is no height.
    Impossible,
}

impl<T: Real> Combined<T> {
    /// The combined height; `None` for [`Contradictory`](Self::Contradictory) and
    /// [`Impossible`](Self::Impossible).
    pub fn height(&self) -> Option<Height<T>> {
        match *self {
            Self::Agreed(height) | Self::Doubtful { height, .. } => Some(height),
            _ => None,
        }
    }
}

/// The heights of all channels, and what their errors have in common.
#[derive(Clone, Copy, Debug)]
pub struct Heights<T, const C: usize> {
    /// The height of each channel, if it has one.
    pub of_channels: [Option<Height<T>>; C],
    /// Correlations of the uncertainty that model, calibration and road leave in the heights.
    pub correlation: [[T; C]; C],
    /// The roll angle that each channel explains. Channels with the same roll angle have the same
    /// noise.
    pub outputs: [Option<Output>; C],
}

impl<T: Real, const C: usize> Heights<T, C> {
    /// Compares the heights of all channels and combines them if they agree; `None` if there is
    /// none.
    ///
    /// The channels are added one by one, the most accurate first. Each is compared with the mean
    /// of those before it and gets the weight for which the variance of the new mean is smallest,
    /// within 0 and 1. A weight outside would rely on the correlation of the errors. χ² is the sum
    /// of the squared differences, each divided by its variance.
    pub fn combined(&self) -> Option<Combined<T>> {
        let covariances = self.covariances();
        let mut left = self.of_channels;
        let (mut mean, first) = Self::take_most_accurate(&mut left)?;
        let (mut value, mut maneuvers) = (first.height_m.value, first.maneuvers);
        let (mut chi_square, mut freedom) = (T::zero(), 0_u32);
        while let Some((alone, next)) = Self::take_most_accurate(&mut left) {
            let difference = value - next.height_m.value;
            let square = difference * difference / covariances.of_difference(&mean, &alone);
            // This form of the comparison lets two heights without uncertainty (0/0) agree.
            if square > T::zero() {
                chi_square += square;
            }
            freedom += 1;
            let weight = covariances.best_weight(&mean, &alone);
            for (share, one) in mean.iter_mut().zip(alone) {
                *share = *share * (T::one() - weight) + one * weight;
            }
            value += weight * (next.height_m.value - value);
            maneuvers = maneuvers.max(next.maneuvers);
        }
        let [doubtful, contradiction] = match freedom {
            0 | 1 => LIMITS[0],
            2 => LIMITS[1],
            _ => LIMITS[2],
        };
        if chi_square > T::of(contradiction) {
            return Some(Combined::Contradictory { chi_square, freedom });
        }
        let random = product(&mean, &covariances.random, &mean).max(T::zero());
        let whole = product(&mean, &covariances.whole, &mean).max(T::zero());
        let mut height = Height {
            height_m: Measured { value, sd: whole.root() },
            random_sd_m: random.root(),
            maneuvers,
        };
        Some(if chi_square > T::of(doubtful) {
            height.height_m.sd *= (chi_square / T::of(f64::from(freedom))).root();
            Combined::Doubtful { height, chi_square, freedom }
        } else {
            Combined::Agreed(height)
        })
    }

    /// Removes the height with the smallest standard deviation. Returns the weights of all channels
    /// in a mean of this height alone, and the height.
    fn take_most_accurate(left: &mut [Option<Height<T>>; C]) -> Option<([T; C], Height<T>)> {
        let mut best: Option<(usize, Height<T>)> = None;
        for (place, height) in left.iter().enumerate() {
            if let Some(height) = height
                && best.is_none_or(|(_, best)| height.height_m.sd < best.height_m.sd)
            {
                best = Some((place, *height));
            }
        }
        let (place, height) = best?;
        *left.get_mut(place)? = None;
        let mut alone = [T::zero(); C];
        *alone.get_mut(place)? = T::one();
        Some((alone, height))
    }

    /// The covariances of the heights; zero for a channel without one.
    fn covariances(&self) -> Covariances<T, C> {
        let mut found = Covariances {
            random: [[T::zero(); C]; C],
            whole: [[T::zero(); C]; C],
            independent: [[T::zero(); C]; C],
        };
        let rows = found.random.iter_mut().zip(&mut found.whole).zip(&mut found.independent);
        let heights = || self.of_channels.iter().zip(&self.outputs).enumerate();
        for (((i, (one, output)), correlations), ((random, whole), independent)) in
            heights().zip(&self.correlation).zip(rows)
        {
            let entries = random.iter_mut().zip(whole).zip(independent);
            for (((j, (other, its_output)), correlation), ((random, whole), independent)) in
                heights().zip(correlations).zip(entries)
            {
                let (Some(one), Some(other)) = (one, other) else { continue };
                let noise = one.random_sd_m * other.random_sd_m;
                let correlation = if i == j { T::one() } else { *correlation };
                let systematic = correlation * one.systematic_sd_m() * other.systematic_sd_m();
                *random = if output == its_output { noise } else { T::zero() };
                *whole = *random + systematic;
                *independent = if i == j { noise + systematic } else { systematic };
            }
        }
        found
    }
}

/// Covariances of the heights of all channels.
struct Covariances<T, const C: usize> {
    /// Noise, taken as fully correlated between channels with the same roll angle.
    random: [[T; C]; C],
    /// Noise as above, and the systematic part.
    whole: [[T; C]; C],
    /// The same, with noise that is independent in all channels.
    independent: [[T; C]; C],
}

impl<T: Real, const C: usize> Covariances<T, C> {
    /// The weight of the height `alone` beside `mean` for the smallest variance.
    fn best_weight(&self, mean: &[T; C], alone: &[T; C]) -> T {
        let mine = product(mean, &self.whole, mean);
        let its = product(alone, &self.whole, alone);
        let common = product(mean, &self.whole, alone);
        let spread = mine + its - T::of(2.0) * common;
        if spread > T::zero() {
            ((mine - common) / spread).max(T::zero()).min(T::one())
        } else {
            T::zero()
        }
    }

    /// The variance of the difference between `mean` and the height `alone`. The effects of noise
    /// on the heights are taken as independent.
    fn of_difference(&self, mean: &[T; C], alone: &[T; C]) -> T {
        let mut difference = *mean;
        for (share, one) in difference.iter_mut().zip(alone) {
            *share -= *one;
        }
        product(&difference, &self.independent, &difference)
    }
}

/// `aᵀ M b`: the covariance of two weighted sums of the heights.
#[inline(never)]
fn product<T: Real, const C: usize>(a: &[T; C], matrix: &[[T; C]; C], b: &[T; C]) -> T {
    let mut sum = T::zero();
    for (a, row) in a.iter().zip(matrix) {
        for (b, entry) in b.iter().zip(row) {
            sum += *a * *b * *entry;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two channels with the same roll angle.
    fn combined(a: Height<f64>, b: Height<f64>, correlation: f64) -> Option<Combined<f64>> {
        Heights {
            of_channels: [Some(a), Some(b)],
            correlation: [[1.0, correlation], [correlation, 1.0]],
            outputs: [Some(Output::Roll); 2],
        }
        .combined()
    }

    /// The mean of two heights that are too uncertain to contradict each other.
    fn mean(a: Height<f64>, b: Height<f64>, correlation: f64) -> Height<f64> {
        combined(a, b, correlation).unwrap().height().unwrap()
    }

    #[test]
    fn channels_are_weighted_by_what_each_knows_alone() {
        let height = |value: f64, sd: f64| Height {
            height_m: Measured { value, sd },
            random_sd_m: 0.0,
            maneuvers: 1,
        };
        let (a, b) = (height(1.9, 0.03), height(2.0, 0.04));
        // Independent: the weights are 16/25 and 9/25, and the sd is 0.03·0.04/0.05.
        let combined = mean(a, b, 0.0).height_m;
        assert!((combined.value - (1.9 * 16.0 + 2.0 * 9.0) / 25.0).abs() < 1e-12);
        assert!((combined.sd - 0.024).abs() < 1e-12);
        // If the correlation exceeds the ratio of the sd's, the worse height adds no information.
        // At this correlation, only heights that are closer do not contradict each other.
        let a = height(1.95, 0.03);
        assert_eq!(mean(a, b, 0.8).height_m, a.height_m);
        assert_eq!(mean(b, a, 0.8).height_m, a.height_m);
    }

    #[test]
    fn channels_are_compared_before_they_are_combined() {
        let height = |value: f64, random: f64| Height {
            height_m: Measured { value, sd: (0.03_f64.powi(2) + random * random).sqrt() },
            random_sd_m: random,
            maneuvers: 1,
        };
        // The standard deviation of the difference, for independent systematic parts of 0.03 and
        // noise of 0.04 in one channel.
        let sd = (2.0 * 0.03_f64.powi(2) + 0.04_f64.powi(2)).sqrt();
        let beside = |deviations: f64| {
            combined(height(2.0, 0.0), height(2.0 + deviations * sd, 0.04), 0.0).unwrap()
        };
        assert!(matches!(beside(2.57), Combined::Agreed(_)));
        let Combined::Doubtful { height: wide, chi_square, freedom: 1 } = beside(2.6) else {
            panic!("1 %")
        };
        assert!((chi_square - 2.6_f64.powi(2)).abs() < 1e-9);
        let Combined::Agreed(narrow) = beside(0.0) else { panic!("equal") };
        assert!((wide.height_m.sd / narrow.height_m.sd - 2.6).abs() < 1e-9);
        assert!(beside(3.88).height().is_some());
        assert!(matches!(beside(-3.9), Combined::Contradictory { .. }));
        assert_eq!(beside(-3.9).height(), None);
        // An uncertainty that both channels share does not explain a difference.
        let shared = combined(height(2.0, 0.0), height(2.01, 0.0), 0.999).unwrap();
        assert!(matches!(shared, Combined::Contradictory { .. }));
    }

    /// Calculated by hand, with noise and systematic parts in both channels: common = 0.02·0.01 +
    /// 0.5·0.03·0.04 and weight = (mine − common)/(mine + theirs − 2 common).
    #[test]
    fn two_channels_with_noise_have_the_mean_that_is_best() {
        let height = |value: f64, random: f64, systematic: f64, maneuvers| Height {
            height_m: Measured { value, sd: random.hypot(systematic) },
            random_sd_m: random,
            maneuvers,
        };
        let (a, b) = (height(2.0, 0.02, 0.03, 3), height(2.05, 0.01, 0.04, 5));
        let (mine, theirs, common): (f64, f64, f64) = (0.0013, 0.0017, 0.0002 + 0.0006);
        let weight = (mine - common) / (mine + theirs - 2.0 * common);
        let Some(Combined::Agreed(found)) = combined(a, b, 0.5) else { panic!("0.05 m") };
        assert!((found.height_m.value - (2.0 + 0.05 * weight)).abs() < 1e-12);
        let best = (mine * theirs - common * common) / (mine + theirs - 2.0 * common);
        assert!((found.height_m.sd - best.sqrt()).abs() < 1e-12);
        assert!((found.random_sd_m - (0.02 - 0.01 * weight)).abs() < 1e-12);
        assert_eq!(found.maneuvers, 5);
        // The variance of the difference: independent noise, and 0.03² + 0.04² − 2·0.5·0.03·0.04.
        let variance = 0.0004 + 0.0001 + 0.0009 + 0.0016 - 0.0012_f64;
        let other =
            Height { height_m: Measured { value: 2.0 + 3.0 * variance.sqrt(), ..b.height_m }, ..b };
        let Some(Combined::Doubtful { chi_square, .. }) = combined(a, other, 0.5) else {
            panic!("3 sd")
        };
        assert!((chi_square - 9.0).abs() < 1e-9);
    }
}
