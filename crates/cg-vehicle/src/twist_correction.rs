//! Takes from the suspension rolls what road twist adds to them.
//!
//! The lateral acceleration that the truck feels, `a_e = f − g φ`, less that of its path is gravity times the bank. The roll
//! angle relative to the road follows from the suspension roll, the path from yaw rate and speed. How the bank changes over
//! the way times what the [truck](RoadTwist) makes of it is the error of the suspension roll.
//!
//! It is taken away only where the drive itself shows it: a regression of the suspension roll on the specific force, its first
//! two rates and this error gives a coefficient of about one where the road is twisted, and of zero where the bank
//! is that of the whole truck, or where there is none.

use cg_core::{Channel, Quantity, Sample, Signals};
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::road_twist::{PairOnTwist, RoadTwist};
use crate::trailer_path::since_s;

/// Time constant of each of the low-passes in series, s. The shorter, the less does the correction lag behind the road; the
/// derivatives multiply noise by its reciprocal.
const LAG_S: f64 = 0.2;
/// Times between rows beyond which the low-passes begin again, s.
const GAP_S: f64 = 0.5;
/// Least speed, m/s. In turns of a slower truck the trailer stands at an angle to the tractor, and their paths are others.
const LEAST_MPS: f64 = 8.0;
/// Time over which the rows of the regression are means, s: longer than the truck's own motion and shorter than a ramp.
const BLOCK_S: f64 = 2.0;
/// A row of the regression counts for this share when the next one comes, so that the last ten minutes count.
const KEPT: f64 = 1.0 - BLOCK_S / 600.0;
/// Least number of rows.
const LEAST_ROWS: f64 = 10.0;
/// How many standard deviations the coefficient must be from the next one. They are those of white noise.
const SURE: f64 = 3.0;
/// Coefficient from which the road counts as twisted. Drives of five trucks on banked and flat roads without twist had -0.5 to
/// 0.1, those with twist 0.4 to 1.1, on air springs and in roundabouts 0.1 to 0.6 (`cg simulate`, 14 t at 1.9 m).
const TWISTED: f64 = 0.35;
/// Offset, specific force, its rates, error by twist.
const UNKNOWNS: usize = 5;
/// The place of the last one.
const BY_TWIST: usize = UNKNOWNS - 1;

/// Three low-passes in series.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct LowPass([f64; 3]);

impl LowPass {
    /// Takes a value with the weight of the time that has passed; a weight of one begins with it.
    fn push(&mut self, mut value: f64, weight: f64) {
        for stage in &mut self.0 {
            *stage += weight * (value - *stage);
            value = *stage;
        }
    }

    /// The value, its rate and its second rate, all with the lag of three stages.
    fn rates(&self) -> [f64; 3] {
        let [first, second, third] = self.0;
        let rate = (second - third) / LAG_S;
        [third, rate, ((first - second) / LAG_S - rate) / LAG_S]
    }
}

/// Sums of the products of the regressors and of the suspension roll.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Evidence {
    products: [[f64; UNKNOWNS + 1]; UNKNOWNS + 1],
    rows: f64,
    /// Whether the road is twisted as far as the rows show it.
    shown: Option<bool>,
}

impl Evidence {
    fn push(&mut self, row: &[f64; UNKNOWNS + 1]) {
        for (i, products) in self.products.iter_mut().enumerate() {
            for (k, product) in products.iter_mut().enumerate() {
                *product = KEPT * *product + row[i] * row[k];
            }
        }
        self.rows = KEPT * self.rows + 1.0;
        if let Some([coefficient, sd]) = self.coefficient()
            && (coefficient - TWISTED).abs() > SURE * sd
        {
            self.shown = Some(coefficient > TWISTED);
        }
    }

    /// The coefficient of the error by twist, and its standard deviation.
    fn coefficient(&self) -> Option<[f64; 2]> {
        #[allow(clippy::cast_precision_loss)] // a handful
        let freedom = self.rows - UNKNOWNS as f64;
        let at = |i: usize, k: usize| self.products[i][k];
        let inverse = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(at).cholesky()?.inverse();
        let with_roll = SVector::<f64, UNKNOWNS>::from_fn(|i, _| at(i, UNKNOWNS));
        let found = inverse * with_roll;
        let rest = at(UNKNOWNS, UNKNOWNS) - found.dot(&with_roll);
        let variance = inverse[(BY_TWIST, BY_TWIST)] * rest.max(0.0) / freedom;
        (self.rows > LEAST_ROWS).then(|| [found[BY_TWIST], variance.sqrt()])
    }
}

/// The pair of a unit.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Unit {
    last_us: Option<u64>,
    yaw: LowPass,
    /// Yaw rate times speed.
    turn: LowPass,
    /// The lateral acceleration that it feels.
    felt: LowPass,
    force: LowPass,
    suspension: LowPass,
    /// Sums over the present block, its rows, and the time since its beginning.
    block: [f64; UNKNOWNS + 1],
    rows: f64,
    block_s: f64,
    evidence: Evidence,
}

/// What a unit and its sensors do at a time.
struct Motion {
    time_us: u64,
    speed_mps: f64,
    yaw_radps: f64,
    suspension_rad: f64,
    force_mps2: f64,
    gravity_mps2: f64,
}

impl Unit {
    /// The error of the suspension roll by road twist, rad. The yaw rate is that of a trailer whose axles are `ahead_m` behind the
    /// unit, `r1 = r2 + (l/U) r2'`.
    fn error_rad(&mut self, now: &Motion, of: &PairOnTwist, ahead_m: f64) -> f64 {
        let &Motion { speed_mps, yaw_radps, suspension_rad, force_mps2, gravity_mps2, .. } = now;
        let weight = self.weight(now.time_us);
        self.yaw.push(yaw_radps, weight);
        self.turn.push(yaw_radps * speed_mps, weight);
        self.felt.push(force_mps2 - gravity_mps2 * of.roll_of_suspension * suspension_rad, weight);
        self.force.push(force_mps2, weight);
        self.suspension.push(suspension_rad, weight);
        let [_, path_mps3, _] = self.turn.rates();
        let [_, _, yaw_radps3] = self.yaw.rates();
        let [_, felt_mps3, felt_mps4] = self.felt.rates();
        let slipping_mps3 = of.slip_rad_per_mps2 * speed_mps * felt_mps4;
        let by_bank_mps3 = felt_mps3 - (path_mps3 + ahead_m * yaw_radps3 - slipping_mps3);
        let error_rad = of.suspension_m * by_bank_mps3 / (gravity_mps2 * speed_mps);
        let [force, rate, second_rate] = self.force.rates();
        let row = [1.0, force, rate, second_rate, error_rad, self.suspension.rates()[0]];
        for (sum, value) in self.block.iter_mut().zip(row) {
            *sum += value;
        }
        self.rows += 1.0;
        error_rad
    }

    /// The weight of a row at this time in the low-passes. A block that has ended is a row of the regression.
    fn weight(&mut self, time_us: u64) -> f64 {
        let passed_s = since_s(&mut self.last_us, time_us);
        self.block_s += passed_s;
        let goes_on = passed_s < GAP_S;
        if !(goes_on && self.block_s < BLOCK_S) {
            let sums = core::mem::take(&mut self.block);
            if goes_on {
                self.evidence.push(&sums.map(|sum| sum / self.rows));
            }
            (self.rows, self.block_s) = (0.0, 0.0);
        }
        if goes_on { passed_s / (LAG_S + passed_s) } else { 1.0 }
    }
}

/// The yaw rates of a truck.
#[derive(Clone, Copy, Debug)]
pub(crate) struct YawRates {
    /// That of the tractor, if it is known.
    pub(crate) tractor_radps: Option<f64>,
    /// That of the trailer, NaN if it is not known.
    pub(crate) trailer_radps: f64,
}

/// Corrects the suspension rolls of a drive.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct TwistCorrection {
    tractor: Unit,
    trailer: Unit,
}

impl TwistCorrection {
    /// Corrects the suspension rolls of a sample, at a speed in m/s.
    pub(crate) fn correct(
        &mut self,
        sample: &mut Sample<f64>,
        speed_mps: f64,
        yaw: YawRates,
        of: &RoadTwist,
        gravity_mps2: f64,
    ) {
        let (time_us, YawRates { tractor_radps, trailer_radps }) = (sample.time_us, yaw);
        let has_pair =
            !sample.suspension_roll_rad.is_nan() || !sample.tractor_suspension_roll_rad.is_nan();
        if !(has_pair && speed_mps > LEAST_MPS && Quantity::YawRate.plausible(trailer_radps)) {
            return;
        }
        let ahead_m = if tractor_radps.is_some() { 0.0 } else { of.trailer_wheelbase_m };
        let signals = Signals::of(&sample.checked(), speed_mps, gravity_mps2);
        let motion = |pair: Channel, yaw_radps| {
            let suspension_rad = signals.output(pair.output());
            let force_mps2 = signals.input(pair.input());
            let is_whole = suspension_rad.is_finite() && force_mps2.is_finite();
            is_whole.then_some(Motion {
                time_us,
                speed_mps,
                yaw_radps,
                suspension_rad,
                force_mps2,
                gravity_mps2,
            })
        };
        if let Some(now) = motion(Channel::Tractor, tractor_radps.unwrap_or(trailer_radps)) {
            let error_rad = self.tractor.error_rad(&now, &of.tractor, ahead_m);
            // Both stand on the same road.
            let shown = self.tractor.evidence.shown.or(self.trailer.evidence.shown);
            if shown.unwrap_or(false) {
                sample.tractor_suspension_roll_rad -= error_rad;
            }
        }
        if let Some(now) = motion(Channel::Suspension, trailer_radps) {
            let error_rad = self.trailer.error_rad(&now, &of.trailer, 0.0);
            let shown = self.trailer.evidence.shown.or(self.tractor.evidence.shown);
            if shown.unwrap_or(false) {
                sample.suspension_roll_rad -= error_rad;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use crate::guide::{TruckKind, template};

    const GRAVITY_MPS2: f64 = 9.81;
    const SPEED_MPS: f64 = 20.0;
    const STEP_US: u64 = 20_000;
    /// A curve of eight seconds every twenty, to alternating sides.
    const PERIOD_S: f64 = 20.0;
    const CURVE_S: f64 = 8.0;
    const SUSPENSION: f64 = 0.01;
    const PATH_MPS2: f64 = 1.7;
    const BANK_RAD: f64 = 0.05;

    fn of_truck() -> RoadTwist {
        let truck = Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap();
        RoadTwist::of(&truck).unwrap()
    }

    type Change = fn(&mut Sample<f64>);

    /// A curve and its rate.
    fn curve(time_s: f64) -> [f64; 2] {
        let (turn, side) = ((time_s / PERIOD_S).floor(), [1.0, -1.0]);
        let phase = (time_s / PERIOD_S - turn) * PERIOD_S / CURVE_S * std::f64::consts::PI;
        if phase > std::f64::consts::PI {
            return [0.0; 2];
        }
        let side = if turn.rem_euclid(2.0) < 0.5 { side[0] } else { side[1] };
        let (sin, cos) = phase.sin_cos();
        [side * sin * sin, side * 2.0 * sin * cos * std::f64::consts::PI / CURVE_S]
    }

    /// The trailer in curves with superelevation that begin a second after their bank, and the part of its suspension roll that is
    /// that of road twist.
    fn trailer(time_us: u64, of: &RoadTwist, twist: f64) -> (Sample<f64>, f64) {
        #[allow(clippy::cast_precision_loss)]
        let time_s = time_us as f64 * 1e-6;
        let ([path, path_rate], [bank, bank_rate]) = (curve(time_s), curve(time_s + 1.0));
        let felt_mps2 = PATH_MPS2 * path - GRAVITY_MPS2 * BANK_RAD * bank;
        let felt_mps3 = PATH_MPS2 * path_rate - GRAVITY_MPS2 * BANK_RAD * bank_rate;
        let even_rad = SUSPENSION * felt_mps2;
        let roll_rad = of.trailer.roll_of_suspension * even_rad;
        let error_rad = twist * of.trailer.suspension_m * -BANK_RAD * bank_rate / SPEED_MPS;
        let slipping_mps2 = of.trailer.slip_rad_per_mps2 * SPEED_MPS * felt_mps3;
        let mut sample = Sample::absent(time_us);
        sample.speed_mps = SPEED_MPS;
        sample.yaw_rate_radps = (PATH_MPS2 * path + slipping_mps2) / SPEED_MPS;
        sample.suspension_roll_rad = even_rad + error_rad;
        sample.lateral_specific_force_mps2 = felt_mps2 + GRAVITY_MPS2 * roll_rad;
        (sample, error_rad)
    }

    fn yaw(sample: &Sample<f64>) -> YawRates {
        YawRates { tractor_radps: None, trailer_radps: sample.yaw_rate_radps }
    }

    fn rms(values: &[f64]) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let count = values.len() as f64;
        (values.iter().map(|value| value * value).sum::<f64>() / count).sqrt()
    }

    /// What is taken from the suspension roll in a drive of some minutes, and the error by twist as late as the low-passes make it.
    fn taken(twist: f64) -> [Vec<f64>; 2] {
        let (of, mut correction) = (of_truck(), TwistCorrection::default());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let lag_us = (3.0 * LAG_S * 1e6) as u64;
        let rows = (1..=10_000).map(|k| k * STEP_US).map(|time_us| {
            let (sample, _) = trailer(time_us, &of, twist);
            let mut corrected = sample;
            correction.correct(&mut corrected, SPEED_MPS, yaw(&sample), &of, GRAVITY_MPS2);
            let (_, earlier_rad) = trailer(time_us.saturating_sub(lag_us), &of, 1.0);
            (sample.suspension_roll_rad - corrected.suspension_roll_rad, earlier_rad)
        });
        let (taken, errors) = rows.unzip();
        [taken, errors]
    }

    /// What is taken is what twist adds, but for what the error does to the roll angle from which it follows itself. That is the
    /// rate of 1.4 times the error (0.8 rad/s in these curves) at 20 m/s times 1.8 m, a tenth.
    #[test]
    fn what_twist_adds_is_taken() {
        let [taken, errors] = taken(1.0);
        // Ten rows of two seconds, and a curve.
        let first = taken.iter().position(|taken| *taken != 0.0).unwrap();
        assert!((1000..2000).contains(&first), "{first}");
        let rest: Vec<f64> =
            taken[first..].iter().zip(&errors[first..]).map(|(a, b)| a - b).collect();
        let share = rms(&rest) / rms(&errors);
        assert!(rms(&errors) > 3e-4 && share < 0.15, "{share}");
    }

    /// The whole truck on one bank.
    #[test]
    fn where_the_drive_does_not_show_it_nothing_is_taken() {
        let [taken, errors] = taken(0.0);
        assert!(taken.iter().all(|taken| *taken == 0.0) && rms(&errors) > 3e-4);
    }

    /// Without a yaw rate, at a crawl, or where a value is impossible, a sample is as it was.
    #[test]
    fn samples_without_what_is_needed_are_left_alone() {
        let (of, mut correction) = (of_truck(), TwistCorrection::default());
        let changes: [Change; 5] = [
            |sample| sample.yaw_rate_radps = f64::NAN,
            |sample| sample.yaw_rate_radps = 1e300,
            |sample| sample.speed_mps = 0.9 * LEAST_MPS,
            |sample| sample.lateral_specific_force_mps2 = f64::NAN,
            |sample| sample.lateral_specific_force_mps2 = 1e300,
        ];
        let mut corrected = 0;
        for k in 1..4000_u64 {
            let (mut sample, _) = trailer(k * STEP_US, &of, 1.0);
            let place = usize::try_from(k % 7).unwrap();
            if let Some(change) = changes.get(place) {
                change(&mut sample);
            }
            let before_rad = sample.suspension_roll_rad;
            let (speed_mps, yaw) = (sample.speed_mps, yaw(&sample));
            correction.correct(&mut sample, speed_mps, yaw, &of, GRAVITY_MPS2);
            let is_same = sample.suspension_roll_rad.to_bits() == before_rad.to_bits();
            assert!(is_same || place >= changes.len(), "{k}: {sample:?}");
            assert!((sample.suspension_roll_rad - before_rad).abs() < 0.02, "{k}: {sample:?}");
            corrected += usize::from(!is_same);
        }
        assert!(corrected > 500, "{corrected}");
    }
}
