//! The rollover threshold of a design at a height, mass and speed, and how uncertain it is.

use crate::math::real::Real;
use crate::truck::axis::locate;
use crate::truck::design::Design;
use crate::truck::ratio::Measured;
use crate::truck::rollover::{Rollover, Turns};

/// Relative standard deviation of the difference between the thresholds of a design and those of the nonlinear vehicle
/// (docs/plant.md has a table: from -4.5 to +1.4 %, and lower only where the truck oversteers), and how much greater it is for each
/// g above half a g. Low loads and empty trailers are near the limit of their tires there, and too low by up to 10 %.
const MODEL_SD: (f64, f64) = (0.015, 0.3);
/// The same of turns at 40 km/h; that of slower ones is greater as they are tighter, by their squared curvature (2 % more at 30
/// km/h, 4 % at 25).
const TIGHT_SD: f64 = 0.006;

impl<T: Real, const C: usize> Design<T, C> {
    /// The rollover measures at a height of the sprung c.g., a trailer mass and a speed. If the
    /// speed is NaN (not known), the smallest threshold applies. `None` if the mass is outside the
    /// axis.
    ///
    /// The threshold is uncertain by the height, by its model, and by the place of the payload
    /// ([`earlier_g`](Self::earlier_g)).
    pub fn rollover(
        &self,
        height: Measured<T>,
        trailer_mass_kg: T,
        speed_mps: T,
    ) -> Option<Rollover<T>> {
        let (j, share) = locate(&self.trailer_mass_kg, trailer_mass_kg)?;
        let line = self.thresholds.get(j)?.blend(self.thresholds.get(j + 1)?, share);
        let turns = Turns::at(speed_mps);
        let threshold_g = line.in_turns(&turns, self.rollover.tightest_turn_g);
        let span_m = [self.least_height_m, self.greatest_height_m];
        let mut found = self.rollover.at(height, trailer_mass_kg, &threshold_g, span_m);
        let beside_g = self.earlier_g(&found, trailer_mass_kg, self.rollover.payload_beside_sd_m);
        let Measured { value, sd } = found.static_rollover_threshold_g;
        let near_sliding_g = (value - T::of(0.5)).max(T::zero());
        let by_turn = T::of(TIGHT_SD) * turns.tightness;
        let by_model_g = (T::of(MODEL_SD.0) + T::of(MODEL_SD.1) * near_sliding_g + by_turn) * value;
        found.static_rollover_threshold_g.sd =
            (sd * sd + by_model_g * by_model_g + beside_g * beside_g).sqrt();
        Some(found)
    }

    /// How much earlier, in g, the trailer tips in turns away from a payload that stands beside the middle: the offset
    /// of the trailer's c.g. over its height, as of a rigid trailer.
    pub fn earlier_g(&self, rollover: &Rollover<T>, trailer_mass_kg: T, beside_m: T) -> T {
        let [lightest_kg, ..] = self.trailer_mass_kg;
        let offset_m = beside_m * (trailer_mass_kg - lightest_kg) / trailer_mass_kg;
        rollover.static_stability_factor_g * offset_m / self.rollover.half_track_m
    }
}
