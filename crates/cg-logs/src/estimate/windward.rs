//! What a side wind makes of the ratios.
//!
//! A wind from one direction rolls the body by another angle in each direction of travel. Where the lateral acceleration goes
//! with the direction of travel, that roll is taken for a part of the ratio: in a single turn it is, in a drive to all sides
//! hardly. How much follows from the path alone, so it is known for each maneuver up to speed and direction of the wind.

use cg_core::{Channel, Design, Maneuver, Sample, Status};
use cg_vehicle::side_wind::SideWind;
use cg_vehicle::wind::{GUST_S, GUSTS};
use serde::{Deserialize, Serialize};

use super::by_wind::ByWind;
use super::felt::path_by_steer_mps2;
use super::tilts::height_sd_of_ratio_m;

/// Half-life of the weight of straight driving before a turn, as in the estimator, s.
const FADE_S: f64 = 2.0;
/// Time between samples that says nothing of the heading between them, s.
const GAP_S: f64 = 1.0;
/// Least speed at which a lateral acceleration tells how fast the heading changes, m/s.
const MOVES_MPS: f64 = 3.0;

/// A heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Heading {
    cos: f64,
    sin: f64,
}

impl Default for Heading {
    fn default() -> Self {
        Self { cos: 1.0, sin: 0.0 }
    }
}

impl Heading {
    fn turn(&mut self, angle_rad: f64) {
        let (sin, cos) = libm::sincos(angle_rad);
        let Self { cos: c, sin: s } = *self;
        let (c, s) = (c * cos - s * sin, s * cos + c * sin);
        // Rounding must not change its length in a drive of days.
        let length = libm::hypot(c, s);
        *self = Self { cos: c / length, sin: s / length };
    }
}

/// What a regression has for each sample: the lateral acceleration, m/s², one for the offset of the roll sensor, and the time for
/// its drift, s.
const REGRESSORS: usize = 3;
const OFFSET: usize = 1;
const DRIFT: usize = 2;

/// A number for each regressor.
type Each = [f64; REGRESSORS];

/// Sums over time since the last maneuver, for the part of a wind in the slope of the roll angle over the lateral acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Sums {
    /// Of products of the regressors.
    products: [Each; REGRESSORS],
    /// Of their products with the speed times both parts of the heading, `v cos ψ` and `v sin ψ`.
    of_wind: [Each; 2],
    /// Of the regressors times speed, as far as a gust of that time still blows.
    held: Each,
    /// Of their products with what blows at the same time.
    of_gusts: [Each; REGRESSORS],
}

impl Sums {
    /// Reduces the weight of all samples so far, and makes them earlier.
    fn fade(&mut self, factor: f64, passed_s: f64) {
        let scale = |each: &mut Each, factor: f64| each.iter_mut().for_each(|sum| *sum *= factor);
        let later = |each: &mut Each| each[DRIFT] -= passed_s * each[OFFSET];
        for each in self.products.iter_mut().chain(&mut self.of_wind) {
            scale(each, factor);
            later(each);
        }
        self.of_gusts.iter_mut().for_each(|each| scale(each, factor * factor));
        self.of_gusts.iter_mut().for_each(later);
        for matrix in [&mut self.products, &mut self.of_gusts] {
            let offset = matrix[OFFSET];
            for (sum, offset) in matrix[DRIFT].iter_mut().zip(offset) {
                *sum -= passed_s * offset;
            }
        }
        scale(&mut self.held, factor);
        later(&mut self.held);
    }

    fn push(&mut self, passed_s: f64, sample: Each, (heading, speed_mps): (Heading, f64)) {
        let weighted = sample.map(|value| passed_s * value);
        let decay = libm::exp(-passed_s / GUST_S);
        for i in 0..REGRESSORS {
            let moved = weighted[i] * speed_mps;
            self.held[i] *= decay;
            for k in 0..REGRESSORS {
                self.products[i][k] += weighted[i] * sample[k];
            }
            self.of_wind[0][i] += moved * heading.cos;
            self.of_wind[1][i] += moved * heading.sin;
        }
        for i in 0..REGRESSORS {
            for k in 0..REGRESSORS {
                // Half of what a sample has with itself, because the other sum of each pair is not made.
                let moved = weighted[k] * speed_mps;
                self.of_gusts[i][k] += weighted[i] * speed_mps * (self.held[k] + 0.5 * moved);
            }
        }
        for (held, value) in self.held.iter_mut().zip(weighted) {
            *held += value * speed_mps;
        }
    }

    /// What least squares with an offset and a drift, which have both slopes of the wind, take for the slope.
    fn gust(&self) -> Gust {
        let p = &self.products;
        let determinant = p[OFFSET][OFFSET] * p[DRIFT][DRIFT] - p[OFFSET][DRIFT] * p[OFFSET][DRIFT];
        let solved = |first: usize, second: usize| {
            p[0][first] * p[second][second] - p[0][second] * p[first][second]
        };
        let [offset, drift] = [solved(OFFSET, DRIFT), solved(DRIFT, OFFSET)];
        // The lateral acceleration less what offset and drift explain of it.
        let rest: Each = [1.0, -offset / determinant, -drift / determinant];
        let along =
            |each: &Each| each.iter().zip(rest).map(|(sum, share)| sum * share).sum::<f64>();
        let squares = along(&p[0]);
        let gusts: Each = self.of_gusts.map(|each| along(&each));
        let gust = Gust {
            slopes: self.of_wind.map(|each| along(&each) / squares),
            random: 2.0 * along(&gusts) / (squares * squares),
        };
        if gust.is_sound() { gust } else { Gust::default() }
    }
}

/// What the wind makes of the ratio of one maneuver, over its speed and what it does to the trailer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gust {
    /// The slope of the part across the body for a wind from each of two directions at right angles, s.
    slopes: [f64; 2],
    /// The same of its gusts: variance, s².
    random: f64,
}

impl Gust {
    /// Whether these are numbers that a maneuver can have.
    fn is_sound(&self) -> bool {
        let Self { slopes: [first, second], random } = *self;
        first.is_finite() && second.is_finite() && random.is_finite() && random >= 0.0
    }
}

/// Those of some maneuvers of a load together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gusts {
    sum: Gust,
    maneuvers: f64,
}

impl Gusts {
    /// Adds that of a maneuver.
    pub fn push(&mut self, gust: Gust) {
        for (sum, slope) in self.sum.slopes.iter_mut().zip(gust.slopes) {
            *sum += slope;
        }
        self.sum.random += gust.random;
        self.maneuvers += 1.0;
    }

    /// Whether there is no maneuver.
    pub fn is_none(&self) -> bool {
        self.maneuvers <= 0.0
    }

    /// Whether these are numbers that maneuvers can come to.
    pub(crate) fn is_sound(&self) -> bool {
        self.sum.is_sound() && self.maneuvers.is_finite() && self.maneuvers >= 0.0
    }

    /// The part of the wind in the ratio of a channel, relative, at a speed, m/s, with a trailer mass, kg, and the height
    /// of its c.g., m.
    ///
    /// The wind has the same direction in all of these maneuvers, and any. The suspension of the tractor is taken to roll by the
    /// same share as the trailer; it rolls by less.
    pub fn in_ratio(
        &self,
        (side, design): (Option<SideWind>, &Design<f64>),
        channel: Channel,
        [speed_mps, trailer_mass_kg, height_m]: [f64; 3],
    ) -> ByWind {
        let load = [trailer_mass_kg, height_m];
        let Some(side) = side.filter(|_| !self.is_none()) else { return ByWind::default() };
        let (rolls, rad_per_mps) = match channel {
            Channel::Suspension => (channel, side.suspension_rad_per_mps(load)),
            _ => (Channel::LateralAcceleration, side.roll_rad_per_mps(load)),
        };
        let Some(line) = design.line(rolls, speed_mps, trailer_mass_kg) else {
            return ByWind::default();
        };
        let Gust { slopes: [first, second], random } = self.sum;
        let of_each = 0.5 * (first * first + second * second + GUSTS * GUSTS * random);
        let per_s = rad_per_mps / line.ratio_at(height_m);
        let sd = (per_s * of_each.sqrt() / self.maneuvers).abs();
        ByWind { sd, is_stated: side.is_stated }
    }
}

/// The path since the last maneuver, and the turns of a load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Windward {
    time_us: u64,
    /// The last speed, m/s.
    speed_mps: f64,
    heading: Heading,
    sums: Sums,
    turns: bool,
    last: Gust,
    of_load: Gusts,
}

impl Windward {
    /// After a restart, those before which came to this.
    pub fn kept(of_load: Gusts) -> Self {
        Self { of_load, ..Self::default() }
    }

    /// Takes the next sample, or the mean of some, and the state of the estimator after it.
    pub fn push(&mut self, sample: &Sample<f64>, status: Status, design: &Design<f64>) {
        if sample.speed_mps.is_finite() {
            self.speed_mps = sample.speed_mps;
        }
        let speed_mps = self.speed_mps;
        let Some(path_mps2) = path_mps2(&Sample { speed_mps, ..*sample }, design) else { return };
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let passed_s = sample.time_us.saturating_sub(self.time_us) as f64 * 1e-6;
        self.time_us = sample.time_us;
        if !(passed_s <= GAP_S && speed_mps >= MOVES_MPS) {
            return;
        }
        let by_path_radps = path_mps2 / speed_mps;
        let measured_radps = sample.yaw_rate_radps;
        let rate_radps = if measured_radps.is_nan() { by_path_radps } else { measured_radps };
        self.heading.turn(rate_radps * passed_s);
        self.turns |= status == Status::Turning;
        let fading = if self.turns { 1.0 } else { libm::exp2(-passed_s / FADE_S) };
        self.sums.fade(fading, passed_s);
        self.sums.push(passed_s, [path_mps2, 1.0, 0.0], (self.heading, speed_mps));
    }

    /// Takes the end of a maneuver; `true` if it is the first of another load.
    pub fn close(&mut self, maneuver: &Maneuver<f64>, is_of_another_load: bool) {
        if is_of_another_load {
            self.of_load = Gusts::default();
        }
        self.last = self.sums.gust();
        // Of a truck without a side, and of a crawling one, nothing was followed.
        let has_path = self.sums.products[OFFSET][OFFSET] > 0.0;
        if has_path && maneuver.outcomes.iter().any(|outcome| outcome.height_m.is_ok()) {
            self.of_load.push(self.last);
        }
        (self.sums, self.turns) = (Sums::default(), false);
    }

    /// That of the last maneuver.
    pub fn last(&self) -> Gust {
        self.last
    }

    /// That of the maneuvers of the load that gave a height.
    pub fn of_load(&self) -> Gusts {
        self.of_load
    }

    /// The part of the wind in the height of a channel, m, at a speed, m/s, and a trailer mass, kg.
    pub fn in_height(
        &self,
        (side, design): (Option<SideWind>, &Design<f64>),
        (channel, height_m): (Channel, f64),
        [speed_mps, trailer_mass_kg]: [f64; 2],
    ) -> ByWind {
        let turn = [speed_mps, trailer_mass_kg, height_m];
        let ratio = self.of_load.in_ratio((side, design), channel, turn);
        let line = design.line(channel, speed_mps, trailer_mass_kg);
        let sd = line.map_or(0.0, |line| height_sd_of_ratio_m(&line, height_m, ratio.sd));
        ByWind { sd, ..ratio }
    }
}

/// The lateral acceleration of the path, m/s², from whatever shows it best.
fn path_mps2(sample: &Sample<f64>, design: &Design<f64>) -> Option<f64> {
    [
        sample.lateral_acceleration_mps2,
        sample.yaw_rate_radps * sample.speed_mps,
        sample.lateral_specific_force_mps2,
        sample.tractor_lateral_specific_force_mps2,
    ]
    .into_iter()
    .find(|mps2| mps2.is_finite())
    .or_else(|| Some(path_by_steer_mps2(sample, design)))
    .filter(|mps2| mps2.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design, maneuver};
    use cg_core::{Measured, Settings};

    const SPEED_MPS: f64 = 14.0;
    const STEP_S: f64 = 0.05;

    /// A turn of 12 s to one side after two seconds of straight driving, m/s².
    fn turn_mps2(k: u32) -> f64 {
        let since_s = STEP_S * f64::from(k) - 2.0;
        if since_s > 0.0 { 1.7 * (1.0 - (-since_s).exp()) } else { 0.0 }
    }

    /// The samples of such a turn, with times in µs.
    fn drive(windward: &mut Windward, start_us: u64, sign: f64) {
        for k in 0..280_u32 {
            let path_mps2 = sign * turn_mps2(k);
            let mut sample = Sample::absent(start_us + 50_000 * u64::from(k));
            (sample.lateral_acceleration_mps2, sample.speed_mps) = (path_mps2, SPEED_MPS);
            let status = if path_mps2.abs() > 0.0 { Status::Turning } else { Status::Straight };
            windward.push(&sample, status, &design());
        }
    }

    fn with_height() -> Maneuver<f64> {
        let mut one = maneuver();
        one.outcomes[0].height_m = Ok(Measured { value: 2.0, sd: 0.1 });
        one
    }

    /// Written out: least squares over all samples with their weights, and all pairs of gusts.
    #[test]
    fn the_slope_of_the_wind_is_that_of_least_squares() {
        let fade_s =
            std::time::Duration::from_micros(Settings::<f64>::truck().fade_us).as_secs_f64();
        assert!((fade_s - FADE_S).abs() < 1e-9);
        let mut windward = Windward::default();
        drive(&mut windward, 5_000_000, 1.0);
        windward.close(&with_height(), false);
        // The first sample only says when the second one is.
        let used = 1..280_u32;
        let mut heading_rad = 0.0;
        let rows: Vec<[f64; 5]> = used
            .map(|k| {
                let a = turn_mps2(k);
                heading_rad += STEP_S * a / SPEED_MPS;
                let straight_s = STEP_S * f64::from(40_u32.saturating_sub(k));
                let weight = STEP_S * (-straight_s / FADE_S).exp2();
                [weight, a, STEP_S * f64::from(k), heading_rad.cos(), heading_rad.sin()]
            })
            .collect();
        let sum =
            |of: &dyn Fn(&[f64; 5]) -> f64| rows.iter().map(|row| row[0] * of(row)).sum::<f64>();
        // Gram and Schmidt: the time less its mean, then the acceleration less its mean and what the time has of it.
        let (all, mean_s) = (sum(&|_| 1.0), sum(&|row| row[2]) / sum(&|_| 1.0));
        let mean = sum(&|row| row[1]) / all;
        let by_time =
            sum(&|row| (row[2] - mean_s) * row[1]) / sum(&|row| (row[2] - mean_s).powi(2));
        let rest = |row: &[f64; 5]| row[1] - mean - by_time * (row[2] - mean_s);
        let squares = sum(&|row| rest(row).powi(2));
        let mut random = 0.0;
        for (i, one) in rows.iter().enumerate() {
            for (k, other) in rows.iter().enumerate() {
                let apart_s = STEP_S * f64::from(u32::try_from(i.abs_diff(k)).unwrap());
                let both = one[0] * rest(one) * other[0] * rest(other);
                random += SPEED_MPS * SPEED_MPS * both * (-apart_s / GUST_S).exp();
            }
        }
        let gust = windward.last();
        for (slope, part) in gust.slopes.into_iter().zip([3, 4]) {
            let expected = SPEED_MPS * sum(&|row| rest(row) * row[part]) / squares;
            assert!((slope / expected - 1.0).abs() < 1e-9, "{slope} for {expected}");
        }
        let expected = random / (squares * squares);
        assert!((gust.random / expected - 1.0).abs() < 1e-9, "{} for {expected}", gust.random);
    }

    /// Two turns that begin in opposite directions feel the wind from opposite sides; only gusts remain, by half.
    #[test]
    fn a_wind_cancels_in_turns_from_opposite_directions() {
        let (design, turn) = (design(), [SPEED_MPS, MASS_KG, 2.0]);
        let side = (Some(side()), &design);
        let sd = |gusts: Gusts| gusts.in_ratio(side, Channel::LateralAcceleration, turn).within();
        let mut one = Windward::default();
        drive(&mut one, 5_000_000, 1.0);
        one.close(&with_height(), false);
        let mut both = one;
        both.heading = Heading { cos: -1.0, sin: 0.0 };
        drive(&mut both, 60_000_000, 1.0);
        both.close(&with_height(), false);
        let [first, second] = both.of_load().sum.slopes;
        let [alone, _] = one.of_load().sum.slopes;
        assert!(first.abs() + second.abs() < 1e-9 * alone.abs(), "{first} {second} of {alone}");
        // The design's roll angle is 0.01 h per m/s².
        let per_s = side.0.unwrap().roll_rad_per_mps([MASS_KG, 2.0]) / 0.02;
        let by_gusts = GUSTS * one.last().random.sqrt() * per_s / 2.0;
        let found = sd(both.of_load());
        assert!((found / by_gusts - 1.0).abs() < 1e-6, "{found} for {by_gusts}");
        assert!(found < 0.5 * sd(one.of_load()));
        // Without a side there is no wind; another load has turns of its own; a maneuver without a height does not count.
        let without = both.of_load().in_ratio((None, &design), Channel::Suspension, turn);
        assert!(without.within() <= 0.0 && without.message(0.0).is_none());
        let before = both.of_load();
        drive(&mut both, 90_000_000, 1.0);
        both.close(&maneuver(), false);
        assert_eq!(both.of_load(), before);
        // Neither does one whose path was not followed: it would be averaged as one without a wind.
        both.close(&with_height(), false);
        assert_eq!(both.of_load(), before);
        both.close(&maneuver(), true);
        assert!(both.of_load().is_none() && Windward::kept(before).of_load() == before);
    }

    fn side() -> SideWind {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/euro.toml");
        let mut vehicle = cg_vehicle::Vehicle::load(file).unwrap();
        vehicle.wind = Some(cg_vehicle::wind::Wind::USUAL);
        SideWind::of(&vehicle).unwrap().unwrap()
    }

    /// The design's roll angle goes with the height, so a ratio that is uncertain by 5 % is a height that is. A steer angle alone
    /// says the same: the design's angle is ten times as large as that of 1 m/s².
    #[test]
    fn a_steer_angle_alone_shows_the_path() {
        let mut windward = Windward::default();
        for k in 0..280_u32 {
            let mut sample = Sample::absent(50_000 * u64::from(k));
            (sample.steer_rad, sample.speed_mps) = (0.1 * turn_mps2(k), SPEED_MPS);
            windward.push(&sample, Status::Turning, &design());
        }
        windward.close(&with_height(), false);
        let mut by_path = Windward::default();
        for k in 0..280_u32 {
            let mut sample = Sample::absent(50_000 * u64::from(k));
            sample.yaw_rate_radps = turn_mps2(k) / SPEED_MPS;
            // A speed holds until the next one.
            sample.speed_mps = if k % 10 == 0 { SPEED_MPS } else { f64::NAN };
            by_path.push(&sample, Status::Turning, &design());
        }
        by_path.close(&with_height(), false);
        let (design, channel) = (design(), Channel::LateralAcceleration);
        let side = (Some(side()), &design);
        let of = |one: Windward, channel: Channel| {
            one.of_load().in_ratio(side, channel, [SPEED_MPS, MASS_KG, 2.0]).within()
        };
        let [found, expected] = [windward, by_path].map(|one| of(one, channel));
        let suspension = of(by_path, Channel::Suspension) / of(by_path, channel);
        assert!(suspension > 0.1 && suspension < 1.0, "{suspension}");
        assert!(
            expected > 0.005 && (found / expected - 1.0).abs() < 1e-9,
            "{found} for {expected}"
        );
        let height_sd_m = by_path.in_height(side, (channel, 2.0), [SPEED_MPS, MASS_KG]).within();
        assert!((height_sd_m / (2.0 * expected) - 1.0).abs() < 1e-9, "{height_sd_m}");
    }
}
