//! What is not known of the gains of inclinometers.

use cg_core::{Channel, Design, Quantity, RatioLine};

/// Standard deviation of the difference of two gains, relative: half a percent for each of both sensors, by their scale and by
/// their temperature. A calibration finds what the gains were then.
const DIFFERENCE_SD: f64 = 0.005 * std::f64::consts::SQRT_2;

/// Which roll angles come from inclinometers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tilts {
    /// The trailer's roll angle: what one inclinometer shows less the lateral acceleration.
    roll: bool,
    /// The suspension roll of the trailer: the difference of two.
    suspension: bool,
    /// The suspension roll of the tractor, likewise.
    tractor: bool,
}

impl Tilts {
    /// Those of the quantities that have arrived and are used.
    pub fn of(has: impl Fn(Quantity) -> bool) -> Self {
        let without = |others: [Quantity; 2]| !others.into_iter().any(&has);
        Self {
            roll: has(Quantity::Tilt) && without([Quantity::Roll, Quantity::RollToGravity]),
            suspension: has(Quantity::AxleTilt)
                && without([Quantity::SuspensionRoll, Quantity::LevelLeft]),
            tractor: has(Quantity::TractorAxleTilt)
                && without([Quantity::TractorSuspensionRoll, Quantity::TractorLevelLeft]),
        }
    }

    /// Standard deviation of the height of a channel, m, due to the gains, at a speed, m/s, and a trailer mass, kg.
    ///
    /// An inclinometer shows the specific force divided by g, of which the roll angle is a small part: what remains if another
    /// sensor of the same force is subtracted. Gains that differ by `δ` change the ratio of the roll angle to an acceleration
    /// by about `δ/g`, whatever the load is.
    pub fn height_sd_m(
        self,
        design: &Design<f64>,
        (channel, height_m): (Channel, f64),
        [speed_mps, trailer_mass_kg]: [f64; 2],
    ) -> f64 {
        // A steer angle makes the truck roll by its lateral acceleration.
        let pair = match channel {
            Channel::Steer | Channel::LateralAcceleration if self.roll => {
                Channel::LateralAcceleration
            }
            Channel::Suspension if self.suspension => channel,
            Channel::Tractor if self.tractor => channel,
            _ => return 0.0,
        };
        let line = |channel| design.line(channel, speed_mps, trailer_mass_kg);
        let (Some(own), Some(by_force)) = (line(channel), line(pair)) else { return 0.0 };
        let ratio = design.channels[pair.index()].compensation * by_force.ratio_at(height_m);
        height_sd_of_ratio_m(&own, height_m, DIFFERENCE_SD / (design.gravity_mps2 * ratio))
    }
}

/// Standard deviation of a height, m, whose ratio has a relative standard deviation. No height is more uncertain than by
/// itself.
pub(super) fn height_sd_of_ratio_m(line: &RatioLine<f64>, height_m: f64, relative_sd: f64) -> f64 {
    let sd_m = (relative_sd / line.relative_slope_at(height_m)).abs();
    if sd_m < height_m { sd_m } else { height_m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design};

    const SPEED_MPS: f64 = 15.0;

    fn sd_m(channel: Channel, signals: &[Quantity]) -> f64 {
        let tilts = Tilts::of(|quantity| signals.contains(&quantity));
        tilts.height_sd_m(&design(), (channel, 2.0), [SPEED_MPS, MASS_KG])
    }

    /// A height from a ratio that is greater by the standard deviation differs by that of the height, to first order.
    #[test]
    fn the_height_moves_as_much_as_the_gains_move_the_ratio() {
        let design = design();
        for (channel, signals) in [
            (Channel::LateralAcceleration, &[Quantity::Tilt][..]),
            (Channel::Suspension, &[Quantity::Tilt, Quantity::AxleTilt]),
            (Channel::Tractor, &[Quantity::TractorTilt, Quantity::TractorAxleTilt]),
        ] {
            let line = design.line(channel, SPEED_MPS, MASS_KG).unwrap();
            let compensation = design.channels[channel.index()].compensation;
            let sd_m = sd_m(channel, signals);
            let step = 0.01;
            let moved = compensation * (line.ratio_at(2.0 + step * sd_m) - line.ratio_at(2.0));
            let expected = step * 0.5_f64.sqrt() * 0.01 / design.gravity_mps2;
            assert!((moved.abs() / expected - 1.0).abs() < 0.01, "{channel} {moved} {expected}");
        }
    }

    /// The steer angle and the lateral acceleration explain the same roll angle.
    #[test]
    fn both_channels_of_one_inclinometer_are_as_uncertain_as_their_slopes_say() {
        let design = design();
        let relative = |channel: Channel| {
            let line = design.line(channel, SPEED_MPS, MASS_KG).unwrap();
            sd_m(channel, &[Quantity::Tilt]) * line.relative_slope_at(2.0).abs()
        };
        let [steer, lateral] = [Channel::Steer, Channel::LateralAcceleration].map(relative);
        assert!((steer / lateral - 1.0).abs() < 1e-9, "{steer} {lateral}");
        assert!(lateral > 0.0);
    }

    #[test]
    fn other_sensors_come_first() {
        for (channel, signals) in [
            (Channel::Steer, &[Quantity::Roll, Quantity::Tilt][..]),
            (Channel::LateralAcceleration, &[Quantity::RollToGravity, Quantity::Tilt]),
            (Channel::Suspension, &[Quantity::SuspensionRoll, Quantity::Tilt, Quantity::AxleTilt]),
            (Channel::Suspension, &[Quantity::LevelLeft, Quantity::LevelRight, Quantity::AxleTilt]),
            (Channel::Suspension, &[Quantity::TractorTilt, Quantity::TractorAxleTilt]),
            (Channel::Tractor, &[Quantity::TractorLevelLeft, Quantity::TractorAxleTilt]),
        ] {
            assert!(sd_m(channel, signals) <= 0.0, "{channel} {signals:?}");
        }
    }
}
