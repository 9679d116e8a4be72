//! Roll angles from a roll rate.
//!
//! A gyroscope has an offset, and as it is never mounted exactly level it feels a share of the yaw rate.
//! The roll angle is therefore
//!
//! ```text
//!     φ(t) = ∫ p dt + a + b t + c ψ(t)          ψ: the heading, the integral of the yaw rate
//! ```
//!
//! where b is the offset and c the angle of the mounting. On straight stretches before and after a turn the vehicle
//! stands upright, up to the bank of the road and to what is left of the lateral acceleration, `φ = s a_y`; least squares
//! over their rows gives a, b, c and s. The offset changes as the sensor warms up, so a and b are those of the turn; c and
//! s are those of the last turns too, with a memory of [`MEMORY`]. A turn without straight driving after it has no roll
//! angle.
//!
//! If the log has a roll angle, all of its rows take the place of the straight stretches, they also give the gain of
//! the rate, which must be near one, and what the sum leaves of the angle is added again below [`BLEND_S`] (a complementary
//! filter that runs in both directions).
//!
//! **Limit.** A straight stretch of another bank than the one before the turn moves the roll angle by a
//! share of the difference. Like every angle to gravity, the result feels the bank of the road.

use cg_core::math::linalg::Triangle;

use super::signal::LogRow;

/// Lateral acceleration below which the vehicle drives straight, m/s²: a tenth of a usual turn.
const STRAIGHT_MPS2: f64 = 0.3;
/// Yaw rate of this acceleration at 60 km/h, rad/s, if the speed is not known.
const STRAIGHT_RADPS: f64 = 0.018;
/// Time after which the roll of a turn has decayed, s.
const SETTLED_S: f64 = 1.0;
/// Straight driving that ends a turn, s.
const CLOSING_S: f64 = 3.0;
/// Straight driving that is kept before a turn, s.
const LEAD_S: f64 = 5.0;
/// The longest turn, and the largest number of rows that are kept. A longer turn has no roll angle.
const LONGEST_S: f64 = 300.0;
const MOST_ROWS: usize = 200_000;
/// The longest gap over which the rate is interpolated, s: 0.2 s of the fastest roll (0.1 rad/s) are a
/// degree.
const GAP_S: f64 = 0.2;
/// Standard deviations before the first turn: of the mounting (3°), and of the roll angle on a straight stretch (the crown of a road changes by 0.2°).
const MOUNTING_SD_RAD: f64 = 0.05;
const UPRIGHT_SD_RAD: f64 = 3.5e-3;
/// The same of the roll angle at [`STRAIGHT_MPS2`], rad: trucks roll by 0.01 to 0.03 rad per m/s².
const SWAY_SD_RAD: f64 = 0.01;
/// Weight of all earlier turns beside a new one, so that about five turns count.
const MEMORY: f64 = 0.8;
/// Turns from which the mounting is learned before a turn has a roll angle: from fewer, the angle
/// of a lane change is wrong by up to a seventh, which the interval of a height would not contain.
const LEARNING_TURNS: u64 = 3;
/// Standard deviation of the mounting up to which it counts as known, rad. Lane changes end with the heading with which they began, and
/// do not show it, and half a degree of it makes heights from them 4 % wrong; before the first turn it is known to three.
const KNOWN_RAD: f64 = 0.02;
/// Least scatter of straight stretches, as a share of [`UPRIGHT_SD_RAD`] squared: those of a log that was made by hand have none.
const LEAST_SCATTER: f64 = 1e-12;
/// Time constant below which a measured angle replaces the integrated one, s.
const BLEND_S: f64 = 2.0;
/// The gain that a rate must have beside an angle, and the least roll of a turn in which it shows, rad.
const GAINS: std::ops::RangeInclusive<f64> = 0.7..=1.4;
const LEAST_ROLL_RAD: f64 = 5e-3;

/// A row with what is integrated until it.
struct Kept {
    line: u64,
    row: LogRow,
    straight: bool,
    /// The lateral acceleration as a share of that of straight driving.
    lateral: f64,
    /// Time since the first row, integral of the roll rate and heading.
    time_s: f64,
    rolled_rad: f64,
    heading_rad: f64,
}

/// Which angle of a log is blended with the rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Angle {
    None,
    ToRoad,
    ToGravity,
}

/// Turns rates into roll angles, one turn at a time.
pub(super) struct RollAngles {
    angle: Angle,
    kept: Vec<Kept>,
    /// Rows whose angle is known.
    ready: std::collections::VecDeque<(u64, LogRow)>,
    straight_s: f64,
    /// Whether a turn is among the kept rows.
    turned: bool,
    /// Whether the rate is absent for too long since the last straight stretch.
    broken: bool,
    last_rate_s: f64,
    /// What is known of mounting and sway. What was known before the first turn fades, too: if it stays, heights of kraz in the test
    /// `roll_rate` are wrong by 4.2 % rms in place of 2.5.
    common: Triangle<f64, 2>,
    /// The same without what is known before the first turn, which the uncertainty needs in full.
    measured: Triangle<f64, 2>,
    /// Number of stretches in `common`, of which each has its share.
    stretches: f64,
    /// Number of turns from which the mounting is known.
    learned: u64,
    /// Counts of turns: with an angle, without one, and with a rate that contradicts the angle.
    turns: [u64; 3],
    gain: f64,
}

/// With what is known of mounting and sway before the first turn.
fn with_prior(mut measured: Triangle<f64, 2>) -> Triangle<f64, 2> {
    measured.push([1.0 / MOUNTING_SD_RAD, 0.0], 0.0);
    measured.push([0.0, 1.0 / SWAY_SD_RAD], 0.0);
    measured
}

impl RollAngles {
    pub(super) fn new(has_roll: bool, has_roll_to_gravity: bool) -> Self {
        let angle = match (has_roll, has_roll_to_gravity) {
            (true, _) => Angle::ToRoad,
            (false, true) => Angle::ToGravity,
            (false, false) => Angle::None,
        };
        let measured = Triangle::new();
        Self {
            angle,
            kept: Vec::new(),
            ready: std::collections::VecDeque::new(),
            straight_s: 0.0,
            turned: false,
            broken: false,
            last_rate_s: f64::NEG_INFINITY,
            common: with_prior(measured),
            measured,
            stretches: 0.0,
            learned: 0,
            turns: [0; 3],
            gain: f64::NAN,
        }
    }

    /// Adds the next row.
    pub(super) fn push(&mut self, line: u64, row: LogRow) {
        let (lateral, yaw_radps) = motion(&row);
        let calm = lateral.abs() < 1.0;
        let (step_s, rate_radps, turn_radps, before) = match self.kept.last() {
            None => (0.0, row.roll_rate_radps, yaw_radps, (0.0, 0.0, 0.0)),
            Some(last) => (
                row.time_s - last.row.time_s,
                mean(last.row.roll_rate_radps, row.roll_rate_radps),
                mean(motion(&last.row).1, yaw_radps),
                (last.time_s, last.rolled_rad, last.heading_rad),
            ),
        };
        if !row.roll_rate_radps.is_nan() {
            self.last_rate_s = row.time_s;
        }
        self.broken |= row.time_s - self.last_rate_s > GAP_S || step_s > GAP_S;
        self.straight_s = if calm { self.straight_s + step_s } else { 0.0 };
        let straight = calm && self.straight_s >= SETTLED_S;
        self.turned |= !calm;
        let or_zero = |x: f64| if x.is_nan() { 0.0 } else { x };
        self.kept.push(Kept {
            line,
            row,
            straight,
            lateral,
            time_s: before.0 + step_s,
            rolled_rad: before.1 + or_zero(rate_radps) * step_s,
            heading_rad: before.2 + or_zero(turn_radps) * step_s,
        });
        let over = self.kept.len() > MOST_ROWS || before.0 + step_s > LONGEST_S;
        if self.turned && self.straight_s >= SETTLED_S + CLOSING_S {
            self.close(CLOSING_S);
        } else if !self.turned && self.straight_s > SETTLED_S + 2.0 * LEAD_S {
            self.close(LEAD_S);
        } else if over {
            self.broken = true;
            self.close(0.0);
        }
    }

    /// The next row whose roll angle is known, with its line.
    pub(super) fn next(&mut self) -> Option<(u64, LogRow)> {
        self.ready.pop_front()
    }

    /// Ends the log.
    pub(super) fn finish(&mut self) {
        // A turn that is still open has no straight stretch after it.
        self.broken |=
            self.turned && self.angle == Angle::None && self.straight_s < SETTLED_S + 1.0;
        self.close(0.0);
    }

    /// Gives the kept rows their angles, except those of the last `lead_s` seconds, which are also the
    /// beginning of what follows.
    fn close(&mut self, lead_s: f64) {
        let turned = std::mem::take(&mut self.turned);
        let (fitted, gain_sd) = if self.broken { None } else { self.fitted(turned) }.unzip();
        let broken = std::mem::take(&mut self.broken);
        if turned {
            self.turns[usize::from(fitted.is_none())] += 1;
        }
        let end_s = self.kept.last().map_or(0.0, |last| last.time_s);
        let stays = |kept: &Kept| !broken && kept.time_s > end_s - lead_s;
        let emitted = self.kept.iter().position(stays).unwrap_or(self.kept.len());
        for (index, kept) in self.kept.drain(..emitted).enumerate() {
            let mut row = kept.row;
            let angle = fitted.as_ref().map_or(f64::NAN, |angles| angles[index]);
            row.roll_gain_sd = gain_sd.unwrap_or(f64::NAN);
            // A rate in a row with an angle to gravity is that of which the angle is the integral.
            if self.angle == Angle::ToGravity {
                row.roll_rate_radps = f64::NAN;
            }
            match self.angle {
                Angle::None if !angle.is_finite() => row.roll_to_gravity_rad = f64::NAN,
                Angle::None => row.roll_to_gravity_rad = angle,
                // Without a result, the measured angle stays.
                Angle::ToRoad if angle.is_finite() => row.roll_rad = angle,
                Angle::ToGravity if angle.is_finite() => row.roll_to_gravity_rad = angle,
                Angle::ToRoad | Angle::ToGravity => {}
            }
            self.ready.push_back((kept.line, row));
        }
    }

    /// The angle of every kept row, and the relative standard deviation of those of a turn by mounting and sway; `None` if nothing
    /// determines them.
    fn fitted(&mut self, turned: bool) -> Option<(Vec<f64>, f64)> {
        match self.angle {
            Angle::None => self.between_straights(turned),
            // The measured angle gives the mounting and the gain in every turn.
            Angle::ToRoad | Angle::ToGravity => Some((self.blended(turned)?, 0.0)),
        }
    }

    fn between_straights(&mut self, turned: bool) -> Option<(Vec<f64>, f64)> {
        let straight: Vec<&Kept> = self.kept.iter().filter(|kept| kept.straight).collect();
        // Before a turn and after it.
        let (first, last) = (straight.first()?, straight.last()?);
        let around = self
            .kept
            .iter()
            .any(|kept| !kept.straight && kept.time_s > first.time_s && kept.time_s < last.time_s);
        if turned && !around {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // far below 2^52
        let count = straight.len() as f64;
        let over = |of: fn(&Kept) -> f64| straight.iter().map(|k| of(k)).sum::<f64>() / count;
        let time = over(|k| k.time_s);
        // Each row counts as its share of the two stretches, whose bank is not known.
        let weight = 1.0 / (UPRIGHT_SD_RAD * (0.5 * count).sqrt());
        let times: f64 = straight.iter().map(|k| (k.time_s - time) * (k.time_s - time)).sum();
        // The line over time that straight rows have.
        let line = |of: fn(&Kept) -> f64| {
            let mean = over(of);
            let slope = straight.iter().map(|k| (k.time_s - time) * of(k)).sum::<f64>() / times;
            move |kept: &Kept| mean + slope * (kept.time_s - time)
        };
        let (roll_line, turn_line) = (line(|k| k.rolled_rad), line(|k| k.heading_rad));
        let sway_line = line(|k| k.lateral);
        let (mut common, mut measured) = (self.common, self.measured);
        if self.learned > 0 {
            common.scale(MEMORY.sqrt());
            measured.scale(MEMORY.sqrt());
        }
        // What the lines leave.
        let rolled = |kept: &Kept| kept.rolled_rad - roll_line(kept);
        let turned_by = |kept: &Kept| kept.heading_rad - turn_line(kept);
        for kept in &straight {
            let swayed = kept.lateral - sway_line(kept);
            let row = [weight * turned_by(kept), -weight * swayed];
            common.push(row, -weight * rolled(kept));
            measured.push(row, -weight * rolled(kept));
        }
        let [mounting, sway] = common.solve(2).ok()?;
        let angle =
            |kept: &Kept| rolled(kept) + mounting * turned_by(kept) + sway * sway_line(kept);
        let angles: Vec<f64> = self.kept.iter().map(angle).collect();
        if !turned {
            return Some((angles, f64::NAN));
        }
        let stretches = MEMORY * self.stretches + 2.0;
        // What a radian of the mounting, and a unit of the sway, make of the turn, as shares of its angle.
        let turn = || self.kept.iter().zip(&angles).filter(|(kept, _)| kept.lateral.abs() >= 1.0);
        let square: f64 = turn().map(|(_, angle)| angle * angle).sum();
        let share = |of: &dyn Fn(&Kept) -> f64| {
            turn().map(|(k, angle)| angle * of(k)).sum::<f64>() / square
        };
        let shares = [share(&turned_by), share(&sway_line)];
        // How far straight stretches are from upright is measured, too. That as many as two of them are used up by what is learned
        // is found from the intervals of perfect gyroscopes (test `roll_rate` of `cg-plant`).
        let free = (stretches - 2.0).max(1.0);
        let scatter = common.sum_of_squares_at(&[mounting, sway]) / free;
        let scatter = scatter.max(LEAST_SCATTER);
        // Lane changes do not show the mounting: what is known before the first turn is as uncertain however little they scatter.
        let mut known = measured;
        known.scale(scatter.sqrt().recip());
        let sd_of = |of: &[f64; 2]| with_prior(known).variance_of(of, 2).sqrt();
        let (gain_sd, mounting_sd) = (sd_of(&shares), sd_of(&[1.0, 0.0]));
        (self.common, self.measured, self.stretches) = (common, measured, stretches);
        self.learned += 1;
        let is_known = self.learned > LEARNING_TURNS && mounting_sd < KNOWN_RAD;
        is_known.then_some((angles, gain_sd))
    }

    /// The measured angle with its fast part from the rate.
    fn blended(&mut self, turned: bool) -> Option<Vec<f64>> {
        let measured = |kept: &Kept| match self.angle {
            Angle::ToRoad => kept.row.roll_rad,
            _ => kept.row.roll_to_gravity_rad,
        };
        let mut fit = Triangle::<f64, 4>::new();
        let known = || self.kept.iter().filter(|kept| measured(kept).is_finite());
        for kept in known() {
            fit.push([1.0, kept.time_s, kept.heading_rad, kept.rolled_rad], measured(kept));
        }
        // Without a yaw rate the heading is zero.
        let turns = self.kept.iter().any(|kept| kept.heading_rad != 0.0);
        if !turns {
            fit.push([0.0, 0.0, 1.0, 0.0], 0.0);
        }
        let [level, offset, mounting, gain] = fit.solve(4).ok()?;
        let (low, high) = known().fold((f64::MAX, f64::MIN), |(low, high), kept| {
            (low.min(measured(kept)), high.max(measured(kept)))
        });
        if !turned || high - low < LEAST_ROLL_RAD {
            return None;
        }
        if !GAINS.contains(&gain) {
            self.gain = gain;
            self.turns[2] += 1;
            return None;
        }
        let integrated: Vec<f64> = self
            .kept
            .iter()
            .map(|kept| {
                level + offset * kept.time_s + mounting * kept.heading_rad + gain * kept.rolled_rad
            })
            .collect();
        let times_s: Vec<f64> = self.kept.iter().map(|kept| kept.time_s).collect();
        let mut rest: Vec<f64> =
            self.kept.iter().zip(&integrated).map(|(kept, angle)| measured(kept) - angle).collect();
        slow(&times_s, &mut rest);
        Some(integrated.iter().zip(rest).map(|(angle, rest)| angle + rest).collect())
    }

    /// What was found, as text for the user.
    pub(super) fn remarks(&self) -> Vec<String> {
        let [with, without, contradicting] = self.turns;
        let mut remarks = Vec::new();
        match self.angle {
            Angle::None => {
                remarks.push(format!(
                    "the roll angle is the integral of roll_rate, upright on straight stretches \
                     ({with} of {} turns); it feels the bank of the road, unless the road was flat (⟨road flat⟩)",
                    with + without
                ));
                if without > 0 {
                    remarks.push(format!(
                        "{without} turns have no roll angle: the first {LEARNING_TURNS} only show \
                         how the sensor of roll_rate is mounted, which lane changes do not (drive turns to another direction \
                         first), and turns need straight driving (below 0.3 m/s² for 4 s, \
                         with a lateral acceleration or a yaw rate in the log) before and after them"
                    ));
                }
            }
            Angle::ToRoad | Angle::ToGravity if contradicting > 0 => remarks.push(format!(
                "roll_rate is not used in {contradicting} turns: it is {:.2} times the change of the \
                 roll angle{}",
                1.0 / self.gain,
                if self.gain < 0.0 {
                    "; one of the sensors is reversed (⟨flip roll_rate⟩)"
                } else {
                    "; check its unit"
                }
            )),
            Angle::ToRoad | Angle::ToGravity if with > 0 => remarks.push(format!(
                "in {with} turns the fast part of the roll angle is that of roll_rate"
            )),
            Angle::ToRoad | Angle::ToGravity => {}
        }
        remarks
    }
}

/// The lateral acceleration as a share of that of straight driving, and the yaw rate, rad/s. Without any
/// sensor of either, the vehicle counts as turning.
fn motion(row: &LogRow) -> (f64, f64) {
    let lateral_mps2 = [
        row.yaw_rate_radps * row.speed_mps,
        row.lateral_acceleration_mps2,
        row.lateral_specific_force_mps2,
    ]
    .into_iter()
    .find(|value| !value.is_nan());
    let share = match lateral_mps2 {
        Some(value) => value / STRAIGHT_MPS2,
        None if row.yaw_rate_radps.is_nan() => f64::INFINITY,
        None => row.yaw_rate_radps / STRAIGHT_RADPS,
    };
    let moving = row.speed_mps > 3.0;
    let yaw_radps = match lateral_mps2 {
        Some(value) if row.yaw_rate_radps.is_nan() && moving => value / row.speed_mps,
        _ => row.yaw_rate_radps,
    };
    (share, yaw_radps)
}

/// The mean of two values, or the one that is there.
fn mean(one: f64, other: f64) -> f64 {
    match (one.is_nan(), other.is_nan()) {
        (false, false) => 0.5 * (one + other),
        (true, _) => other,
        (_, true) => one,
    }
}

/// A low-pass filter of first order that runs forward and then backward, so that it has no delay. Absent
/// values are passed over.
fn slow(times_s: &[f64], values: &mut [f64]) {
    let mut run = |order: &mut dyn Iterator<Item = usize>| {
        let mut state = f64::NAN;
        let mut last_s = f64::NAN;
        for k in order {
            if state.is_nan() {
                state = values[k];
            } else if !values[k].is_nan() {
                state +=
                    (values[k] - state) * (1.0 - libm::exp(-(times_s[k] - last_s).abs() / BLEND_S));
            }
            last_s = times_s[k];
            values[k] = state;
        }
    };
    run(&mut (0..times_s.len()));
    run(&mut (0..times_s.len()).rev());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight stretch of 15 s, which has no turn whose gain could be wrong, and then a turn of 10 s to the left every 25 s.
    #[test]
    fn only_rows_of_turns_say_how_well_the_mounting_is_known() {
        let mut angles = RollAngles::new(false, false);
        let (mut rows, mut told) = (0, 0);
        for k in 0..7500_u32 {
            let time_s = f64::from(k) / 50.0;
            let phase = (time_s - 15.0).rem_euclid(25.0) / 10.0;
            let turns = time_s >= 15.0 && phase < 1.0;
            let wave = if turns { std::f64::consts::TAU * phase } else { 0.0 };
            angles.push(
                u64::from(k),
                LogRow {
                    time_s,
                    speed_mps: 15.0,
                    yaw_rate_radps: 0.05 * (1.0 - libm::cos(wave)),
                    // Half a degree per m/s², and a mounting of 0.02 rad.
                    roll_rate_radps: 0.13 * 0.05 * libm::sin(wave) * std::f64::consts::TAU / 10.0
                        - 0.02 * 0.05 * (1.0 - libm::cos(wave)),
                    ..LogRow::ABSENT
                },
            );
            while let Some((_, row)) = angles.next() {
                if row.roll_to_gravity_rad.is_finite() && row.time_s < 9.0 {
                    rows += 1;
                    assert!(row.roll_gain_sd.is_nan(), "{row:?}");
                }
                told += u32::from((1e-6..0.05).contains(&row.roll_gain_sd));
                assert!(row.roll_gain_sd.is_nan() || row.roll_gain_sd < 0.05, "{row:?}");
            }
        }
        assert!(rows > 300 && told > 500, "{rows} {told}");
    }
}
