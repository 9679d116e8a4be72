//! The wind on the side of the trailer's body, which makes it roll as a lateral acceleration does.
//!
//! The force is that of the dynamic pressure on the side area, in proportion to the sine of the angle at which the air meets the
//! body: `F = ½ ρ C A |w| w_y`, with the velocity `w` of the air against the body and its part `w_y` across it. `C` is that of a long
//! box across the wind; no truck was measured.

use serde::{Deserialize, Serialize};

/// Density of air at 15 °C and sea level.
const AIR_KG_PER_M3: f64 = 1.225;
/// Force on a long box across the wind over dynamic pressure and side area.
const ACROSS: f64 = 1.1;

/// Standard deviation of the gusts of a wind over its mean speed: what is usual a few meters above open ground.
pub const GUSTS: f64 = 0.15;
/// The time for which a gust lasts, s.
pub const GUST_S: f64 = 3.0;

/// The side of the trailer's body, and the wind where the truck drives.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Area of the body seen from the side.
    pub side_area_m2: f64,
    /// Height of the middle of that area.
    pub side_height_m: f64,
    /// Root mean square of the speed of the wind at this height, from any direction.
    #[serde(default = "usual_speed")]
    pub speed_mps: f64,
}

fn usual_speed() -> f64 {
    Wind::USUAL.speed_mps
}

impl Wind {
    /// A long box body in a usual wind.
    pub const USUAL: Self = Self { side_area_m2: 36.0, side_height_m: 2.4, speed_mps: 3.0 };

    /// Force on the side over the product of the air's speed and its part across the body, N/(m/s)².
    pub fn n_per_m2ps2(&self) -> f64 {
        0.5 * AIR_KG_PER_M3 * ACROSS * self.side_area_m2
    }

    /// Force on the side, N, of air that moves against the body with these velocities along and across it, m/s.
    pub fn force_n(&self, [along_mps, across_mps]: [f64; 2]) -> f64 {
        self.n_per_m2ps2() * libm::hypot(along_mps, across_mps) * across_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: air of 20 m/s that comes at 30 degrees has 400 m²/s² and a sine of one half.
    #[test]
    fn the_force_is_that_of_the_dynamic_pressure() {
        let found_n = Wind::USUAL.force_n([20.0 * 0.75_f64.sqrt(), -10.0]);
        let by_hand_n = 0.5 * 1.225 * 1.1 * 36.0 * 400.0 * -0.5;
        assert!((found_n / by_hand_n - 1.0).abs() < 1e-12, "{found_n}");
    }
}
