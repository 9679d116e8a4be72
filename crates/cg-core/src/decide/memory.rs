//! The learned state of an estimator as plain numbers, which can be stored while the power is off.

use crate::decide::height::Fusion;
use crate::decide::load::Said;
use crate::math::real::Real;
use crate::truck::channel::CHANNELS;
use crate::truck::ratio::Measured;

/// The fused heights and the state of the load. The open maneuver is not included, so it is lost at
/// a restart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory<T, const C: usize = CHANNELS> {
    /// The fused maneuvers of each channel, in the order of the design's
    /// [channels](crate::Design::channels).
    pub fused: [Fusion<T>; C],
    /// Correlations of the systematic errors of the channels.
    pub correlation: [[T; C]; C],
    /// Last known trailer mass.
    pub trailer_mass_kg: T,
    /// Trailer mass of the last maneuver, if there was one.
    pub load_mass_kg: Option<T>,
    /// A maneuver that contradicts the fused heights and waits for a second one that agrees with
    /// it. Per channel: the height with its standard deviation due to noise, and the systematic
    /// standard deviation.
    pub waiting: Option<[Said<T>; C]>,
}

impl<T: Real, const C: usize> Memory<T, C> {
    /// The heights for an estimator with another design of the same truck, one that has learned: what was systematic in them is not
    /// in the heights to come, so it counts as noise. A maneuver that waits for another one is forgotten.
    #[must_use]
    pub fn of_another_design(self) -> Self {
        Self { fused: self.fused.map(Fusion::loosened), waiting: None, ..self }
    }

    /// Whether every number is in its possible range.
    pub fn is_sound(&self) -> bool {
        let positive = |x: T| x.present() && x > T::zero();
        let said = |(height, systematic_sd): &(Measured<T>, T)| {
            positive(height.value) && positive(height.sd) && systematic_sd.present()
        };
        self.fused.iter().all(Fusion::is_sound)
            && self.correlation.iter().flatten().all(|entry| entry.abs() <= T::one())
            && positive(self.trailer_mass_kg)
            && self.load_mass_kg.is_none_or(positive)
            && self.waiting.iter().flatten().flatten().all(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: (Measured<f64>, f64) = (Measured { value: 2.0, sd: 0.1 }, 0.05);

    fn good() -> Memory<f64, 2> {
        Memory {
            fused: [Fusion::new(); 2],
            correlation: [[1.0, 0.5], [0.5, 1.0]],
            trailer_mass_kg: 20e3,
            load_mass_kg: Some(20e3),
            waiting: Some([Some(GOOD), None]),
        }
    }

    /// The total standard deviation remains, and a height to come counts for what it knows.
    #[test]
    fn heights_of_another_design_do_not_bind() {
        let mut memory = good();
        memory.fused[0].push(Measured { value: 2.0, sd: 0.01 }, 0.1);
        memory.fused[0].push(Measured { value: 2.0, sd: 0.01 }, 0.1);
        let before = memory.fused[0].height().unwrap();
        let mut after = memory.of_another_design();
        let found = after.fused[0].height().unwrap();
        assert!((found.height_m.sd - before.height_m.sd).abs() < 1e-12 && found.maneuvers == 2);
        assert!((found.random_sd_m - before.height_m.sd).abs() < 1e-12);
        assert!(after.waiting.is_none() && after.is_sound());
        after.fused[0].push(Measured { value: 1.9, sd: 0.01 }, 0.02);
        assert!((after.fused[0].height().unwrap().height_m.value - 1.901).abs() < 1e-4);
        assert_eq!(after.fused[1].height(), None);
    }

    #[test]
    fn every_number_is_looked_at() {
        assert!(good().is_sound());
        assert!(Memory { load_mass_kg: None, waiting: None, ..good() }.is_sound());
        assert!(Memory { correlation: [[1.0, -1.0], [-1.0, 1.0]], ..good() }.is_sound());
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(!Memory { trailer_mass_kg: wrong, ..good() }.is_sound());
            assert!(!Memory { load_mass_kg: Some(wrong), ..good() }.is_sound());
            for (value, sd) in [(wrong, 0.1), (2.0, wrong)] {
                let said = Some((Measured { value, sd }, 0.05));
                assert!(!Memory { waiting: Some([said, None]), ..good() }.is_sound());
                assert!(!Memory { waiting: Some([Some(GOOD), said]), ..good() }.is_sound());
            }
        }
        for wrong in [1.01, -1.01, f64::NAN] {
            assert!(!Memory { correlation: [[1.0, wrong], [0.5, 1.0]], ..good() }.is_sound());
        }
        let endless = Some((GOOD.0, f64::INFINITY));
        assert!(!Memory { waiting: Some([endless, None]), ..good() }.is_sound());
    }
}
