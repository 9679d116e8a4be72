//! What the noise and the mounting of a roll rate make of the ratios, if the roll angle is its integral.

use cg_core::{Channel, Design, Maneuver, Output};
use serde::{Deserialize, Serialize};

use super::tilts::height_sd_of_ratio_m;
use crate::log::LogRow;

/// Standard deviation of the gain of a turn over what the noise adds up to in it, `N √T/φ`, with the greatest roll angle `φ`
/// and the duration `T`, if offset and drift are found from the same rows. By simulation it is 0.29 for a turn with a
/// constant roll angle, 0.38 to 0.44 for a sine to one side over 0.3 to 0.85 of the time, and half of that for one to both
/// sides.
const SHARE: f64 = 0.4;

/// The noise of the roll rate, and the turns of a load.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Rated {
    /// The last two rates, rad/s, and the time of the last one, s.
    last: Option<([f64; 2], f64)>,
    /// Mean of `N²`, the variance of the integral per second, rad²/s, and the number of rows.
    walk: f64,
    rows: f64,
    /// The greatest roll angle since the last maneuver, rad.
    greatest_rad: f64,
    /// Sum of `T/φ²` over the maneuvers of the load that gave a height, s/rad², and their number.
    turns: f64,
    maneuvers: f64,
    /// The greatest [`LogRow::roll_gain_sd`] since the last maneuver, and the sum over the maneuvers of the load.
    gain_sd: f64,
    gain_sds: f64,
}

impl Rated {
    /// Takes a row.
    pub fn push(&mut self, row: &LogRow) {
        let LogRow { time_s, roll_rate_radps, roll_to_gravity_rad, .. } = *row;
        if !(roll_rate_radps.is_finite() && roll_to_gravity_rad.is_finite()) {
            self.last = None;
            return;
        }
        self.greatest_rad = self.greatest_rad.max(roll_to_gravity_rad.abs());
        self.gain_sd = self.gain_sd.max(row.roll_gain_sd);
        let Some((before, last_s)) = self.last.replace(([roll_rate_radps; 2], time_s)) else {
            return;
        };
        // White noise of variance σ² has a second difference of variance 6 σ², and the motion hardly any.
        let bent_radps = before[0] - 2.0 * before[1] + roll_rate_radps;
        self.rows += 1.0;
        self.walk += ((time_s - last_s) * bent_radps * bent_radps / 6.0 - self.walk) / self.rows;
        self.last = Some(([before[1], roll_rate_radps], time_s));
    }

    /// Takes the end of a maneuver; `true` if it is the first of another load.
    pub fn close(&mut self, maneuver: &Maneuver<f64>, is_of_another_load: bool) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let duration_s = maneuver.end_us.saturating_sub(maneuver.start_us) as f64 * 1e-6;
        if is_of_another_load {
            (self.turns, self.maneuvers, self.gain_sds) = (0.0, 0.0, 0.0);
        }
        let greatest_rad = std::mem::take(&mut self.greatest_rad);
        let gain_sd = std::mem::take(&mut self.gain_sd);
        let gave = maneuver.outcomes.iter().any(|outcome| outcome.height_m.is_ok());
        if gave && greatest_rad > 0.0 {
            self.turns += duration_s / (greatest_rad * greatest_rad);
            self.maneuvers += 1.0;
            self.gain_sds += gain_sd;
        }
    }

    /// Relative standard deviation of the ratio of a channel; zero without a roll rate. The noise of each maneuver is
    /// another one; how the sensor is mounted is learned once for all of them.
    pub fn ratio_sd(&self, channel: Channel) -> f64 {
        if channel.output() != Output::Roll || self.maneuvers < 1.0 {
            return 0.0;
        }
        libm::hypot(SHARE * (self.walk * self.turns).sqrt(), self.gain_sds) / self.maneuvers
    }

    /// That of its height, m, at a speed, m/s, and a trailer mass, kg.
    pub fn height_sd_m(
        &self,
        design: &Design<f64>,
        (channel, height_m): (Channel, f64),
        [speed_mps, trailer_mass_kg]: [f64; 2],
    ) -> f64 {
        let Some(line) = design.line(channel, speed_mps, trailer_mass_kg) else { return 0.0 };
        height_sd_of_ratio_m(&line, height_m, self.ratio_sd(channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design, maneuver};
    use cg_core::Measured;
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};

    const RATE_HZ: f64 = 50.0;

    /// A turn of 20 s with a roll angle of 0.03 rad, whose rate has this noise.
    fn turn(rated: &mut Rated, noise_radps: f64, seed: u64) {
        let mut source = StdRng::seed_from_u64(seed);
        rated.push(&LogRow::ABSENT); // the times begin anew
        for row in 0..1000 {
            let time_s = f64::from(row) / RATE_HZ;
            let noise: f64 = StandardNormal.sample(&mut source);
            let phase = std::f64::consts::TAU * time_s / 20.0;
            let motion_radps = 0.015 * std::f64::consts::TAU / 20.0 * phase.sin();
            rated.push(&LogRow {
                time_s,
                roll_rate_radps: motion_radps + noise_radps * noise,
                roll_to_gravity_rad: 0.015 * (1.0 - phase.cos()),
                ..LogRow::ABSENT
            });
        }
        rated.close(&turn_of_20_s(true), false);
    }

    fn turn_of_20_s(gave: bool) -> Maneuver<f64> {
        let mut turn = maneuver();
        (turn.start_us, turn.end_us) = (0, 20_000_000);
        if gave {
            turn.outcomes[Channel::Steer.index()].height_m = Ok(Measured { value: 2.0, sd: 0.01 });
        }
        turn
    }

    #[test]
    fn the_noise_of_the_rate_adds_up_in_a_turn_and_averages_out_over_turns() {
        let mut rated = Rated::default();
        assert!(rated.ratio_sd(Channel::Steer) <= 0.0);
        turn(&mut rated, 2e-3, 1);
        // 2 mrad/s at 50 Hz are 0.28 mrad in a second and 1.26 mrad in 20 s, of 0.03 rad.
        let expected = 0.4 * 2e-3 * (20.0_f64 / 50.0).sqrt() / 0.03;
        let one = rated.ratio_sd(Channel::LateralAcceleration);
        // A variance of 1000 rows, whose second differences are correlated, is known to 6 %, and its root to 3 %.
        assert!((one / expected - 1.0).abs() < 0.1, "{one} {expected}");
        assert!(rated.ratio_sd(Channel::Suspension) <= 0.0);
        // A ratio in proportion to the height.
        let height_sd_m = rated.height_sd_m(&design(), (Channel::Steer, 2.0), [15.0, MASS_KG]);
        assert!((height_sd_m - 2.0 * one).abs() < 1e-12);
        for seed in 2..=4 {
            turn(&mut rated, 2e-3, seed);
        }
        let four = rated.ratio_sd(Channel::Steer);
        assert!((four / expected * 2.0 - 1.0).abs() < 0.1, "{four} {expected}");
        rated.greatest_rad = 0.03;
        rated.close(&turn_of_20_s(false), false);
        let with_rejected = rated.ratio_sd(Channel::Steer);
        assert!((with_rejected / four - 1.0).abs() < 0.01, "a turn without a height counts not");
        rated.close(&turn_of_20_s(true), true);
        assert!(rated.ratio_sd(Channel::Steer) <= 0.0, "the new load has no turn yet");
    }

    #[test]
    fn how_the_sensor_is_mounted_is_the_same_in_all_turns() {
        let mut rated = Rated::default();
        for roll_gain_sd in [0.01, 0.03] {
            turn(&mut rated, 0.0, 1);
            let row = LogRow {
                time_s: 20.0,
                roll_rate_radps: 0.0,
                roll_to_gravity_rad: 0.03,
                ..LogRow::ABSENT
            };
            rated.push(&LogRow { roll_gain_sd, ..row });
            rated.close(&turn_of_20_s(true), false);
        }
        // The turns without it count, too.
        assert!(
            (rated.ratio_sd(Channel::Steer) - 0.01).abs() < 1e-4,
            "{}",
            rated.ratio_sd(Channel::Steer)
        );
    }

    #[test]
    fn a_smooth_rate_and_an_angle_without_a_rate_add_nothing() {
        let mut rated = Rated::default();
        turn(&mut rated, 0.0, 1);
        assert!(rated.ratio_sd(Channel::Steer) < 1e-4, "{}", rated.ratio_sd(Channel::Steer));
        let mut measured = Rated::default();
        measured.push(&LogRow { time_s: 0.0, roll_to_gravity_rad: 0.03, ..LogRow::ABSENT });
        measured.close(&turn_of_20_s(true), false);
        assert!(measured.ratio_sd(Channel::Steer) <= 0.0);
    }
}
