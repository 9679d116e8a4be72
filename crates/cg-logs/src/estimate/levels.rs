//! Whether both level sensors of a pair follow the roll of the body, and equally far.

use cg_core::Quantity;
use serde::{Deserialize, Serialize};

use super::pair::Pair;

/// Least share that a working sensor has in the change of the difference of both. Roll moves both by the
/// same distance in opposite directions, so each has half of it; a sensor that stands still has none, and
/// the other one all. A vertical motion only adds to a share what it has in common with the roll.
const LEAST_SHARE: f64 = 0.1;
/// Least standard deviation of the difference, m: beside it, steps of a millimeter are no motion.
const MOVES_M: f64 = 1e-3;
/// The same beside which a level that shows one value all the time has frozen: steps of 5 mm, between two of which the other one
/// flickers, have up to 2.5 mm.
const MOVES_FAR_M: f64 = 3e-3;
/// Greatest distance of the mean share from a half. It is up to 0.011 in the drives of a multibody truck (braking in
/// curves, twisting frames) and 0.003 in those of the plant. A sensor with the gain `k` has `k/(1 + k)`, so that one of 0.85
/// is found, which makes a height 8 % too small. The statement needs three maneuvers, and three standard errors.
const UNEQUAL: f64 = 0.04;
const LEAST_MANEUVERS: f64 = 3.0;
/// In a drive that goes on, so many maneuvers are judged, the last ones.
const RECENT: usize = 3;
/// Minimum number of rows for a statement on a maneuver.
const LEAST_ROWS: f64 = 50.0;

/// The left level against the difference of both since the last maneuver.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Sides {
    rows: f64,
    /// The difference of left and right level, and the left one, m.
    levels_m: Pair,
    /// The left and the right level at first, and whether they have changed.
    first_m: [f64; 2],
    changed: [bool; 2],
}

/// The share of the left one in a maneuver, and whether one of them had frozen.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Turn {
    share: f64,
    is_frozen: bool,
}

impl Sides {
    fn push(&mut self, [left_m, right_m]: [f64; 2]) {
        let difference_m = left_m - right_m;
        if difference_m.is_finite() {
            self.rows += 1.0;
            let levels_m = [left_m, right_m];
            if self.rows < 2.0 {
                self.first_m = levels_m;
            }
            for side in 0..2 {
                self.changed[side] |= levels_m[side].to_bits() != self.first_m[side].to_bits();
            }
            self.levels_m.push(self.rows, [difference_m, left_m]);
        }
    }

    /// What the maneuver says, if they move enough.
    fn turn(&self) -> Option<Turn> {
        let moves = |least_m: f64| self.levels_m.square() > least_m * least_m * self.rows;
        (self.rows >= LEAST_ROWS && moves(MOVES_M)).then(|| Turn {
            share: self.levels_m.slope(),
            is_frozen: moves(MOVES_FAR_M) && !(self.changed[0] && self.changed[1]),
        })
    }
}

/// One pair of level sensors.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Levels {
    sides: Sides,
    maneuvers: u32,
    /// Maneuvers in which the left and the right one stood still.
    still: [u32; 2],
    /// Those in which one had frozen.
    frozen: u32,
    /// Maneuvers with a share of the left one, its mean, and the sum of the squares of the deviations.
    shares: f64,
    mean: f64,
    squares: f64,
    /// The last turns.
    recent: [Option<Turn>; RECENT],
}

impl Levels {
    fn close(&mut self) {
        if self.sides.rows >= LEAST_ROWS {
            self.maneuvers += 1;
            if let Some(turn) = self.sides.turn() {
                self.count(turn);
                self.recent.rotate_right(1);
                self.recent[0] = Some(turn);
            }
        }
        self.sides = Sides::default();
    }

    /// Counts a maneuver.
    fn count(&mut self, Turn { share, is_frozen }: Turn) {
        self.frozen += u32::from(is_frozen);
        if share < LEAST_SHARE {
            self.still[0] += 1;
        } else if share > 1.0 - LEAST_SHARE {
            self.still[1] += 1;
        }
        self.shares += 1.0;
        let before = share - self.mean;
        self.mean += before / self.shares;
        self.squares += before * (share - self.mean);
    }

    /// What is wrong with the sensors of this unit, at present or in the whole log.
    fn contradiction(&self, unit: &str, at_present: bool) -> Option<String> {
        let recent = self.recently();
        let of_recent = || recent.dead(unit).or_else(|| recent.unequal(unit));
        let of_all = || self.dead(unit).or_else(|| self.unequal(unit)).filter(|_| !at_present);
        of_recent().or_else(of_all)
    }

    /// The last maneuvers alone.
    fn recently(&self) -> Self {
        let mut recent = Self::default();
        for (age, turn) in self.recent.into_iter().flatten().enumerate() {
            recent.maneuvers += 1;
            // A sensor that has worked in two maneuvers is believed again.
            recent.count(Turn { is_frozen: turn.is_frozen && age < 2, ..turn });
        }
        recent
    }

    /// That one of them moves less than the other.
    fn unequal(&self, unit: &str) -> Option<String> {
        let error = (self.squares / (self.shares - 1.0) / self.shares).sqrt();
        let off = (self.mean - 0.5).abs();
        if !(self.shares >= LEAST_MANEUVERS && off > UNEQUAL + 3.0 * error) {
            return None;
        }
        let [less, more] = if self.mean < 0.5 { ["left", "right"] } else { ["right", "left"] };
        let gain = (0.5 - off) / (0.5 + off);
        Some(format!(
            "in turns the {less} level of the {unit} changes {gain:.2} times as much as the {more} one, which the roll of \
             a body does not: the linkage or the gain of one of the sensors is wrong"
        ))
    }

    /// That one of them stands still. A single one of several maneuvers may be chance, unless not a single value differs.
    fn dead(&self, unit: &str) -> Option<String> {
        let (side, turns) = if self.still[0] > self.still[1] {
            ("left", self.still[0])
        } else {
            ("right", self.still[1])
        };
        let least = if self.frozen > 0 { 1 } else { self.maneuvers.clamp(1, 2) };
        (turns >= least).then(|| {
            format!(
                "in {turns} of {} maneuvers the {side} level of the {unit} stood still while the other one \
                 moved: that sensor, its linkage or its signal is dead",
                self.maneuvers
            )
        })
    }
}

/// Checks the level sensors of one log.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct LevelCheck {
    trailer: Levels,
    tractor: Levels,
}

impl LevelCheck {
    /// Takes the levels at one time, m; NaN without a value.
    #[inline]
    pub(super) fn push(&mut self, level_m: impl Fn(Quantity) -> f64) {
        let trailer_m = [level_m(Quantity::LevelLeft), level_m(Quantity::LevelRight)];
        self.trailer.sides.push(trailer_m);
        let tractor_m = [level_m(Quantity::TractorLevelLeft), level_m(Quantity::TractorLevelRight)];
        self.tractor.sides.push(tractor_m);
    }

    /// Ends a maneuver.
    pub(super) fn close(&mut self) {
        self.trailer.close();
        self.tractor.close();
    }

    /// The sensor that does not work, at present or in the whole log.
    pub(super) fn contradiction(&self, at_present: bool) -> Option<String> {
        let of_tractor = || self.tractor.contradiction("tractor", at_present);
        self.trailer.contradiction("trailer", at_present).or_else(of_tractor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of this many maneuvers, in which a level sensor shows what `left` makes of the number of the maneuver
    /// and the level.
    fn checked(maneuvers: u32, noise_m: f64, left: impl Fn(u32, f64) -> f64) -> Option<String> {
        let mut check = LevelCheck::default();
        for maneuver in 0..maneuvers {
            for k in 0..200_u32 {
                // Two turns to each side.
                let roll_m = 0.005 * (f64::from(k) * std::f64::consts::TAU / 100.0).sin();
                let noise = if k % 2 == 0 { noise_m } else { -noise_m };
                let heave_m = 0.5 * roll_m.abs();
                check.push(|quantity| match quantity {
                    Quantity::LevelLeft => left(maneuver, heave_m + roll_m) + noise,
                    Quantity::LevelRight => heave_m - roll_m,
                    _ => f64::NAN,
                });
            }
            check.close();
        }
        check.contradiction(false)
    }

    /// Levels of three maneuvers; the left one works up to this maneuver.
    fn told(works_until: u32, noise_m: f64) -> Option<String> {
        checked(3, noise_m, |maneuver, left_m| if maneuver < works_until { left_m } else { 0.0 })
    }

    /// A gain `k` of one side gives it a share of `k/(1 + k)`: 0.46 is reached at 0.85. Braking in one turn moves both levels
    /// and changes its share alone.
    #[test]
    fn a_level_that_moves_less_than_the_other_is_named() {
        let with = |gain: f64, maneuvers| checked(maneuvers, 0.0, |_, left_m| gain * left_m);
        assert!(with(0.87, 3).is_none() && with(1.14, 3).is_none() && with(0.5, 2).is_none());
        let less = with(0.83, 3).unwrap();
        assert!(less.starts_with("in turns the left level of the trailer changes 0.8"), "{less}");
        assert!(with(1.4, 3).unwrap().starts_with("in turns the right level"));
        assert_eq!(checked(3, 0.0, |maneuver, m| if maneuver == 1 { 0.5 * m } else { m }), None);
    }

    /// Two maneuvers after it works again, in a drive that goes on; a log remembers it.
    #[test]
    fn a_level_that_works_again_is_believed() {
        let dead_then = |good: u32| {
            let mut check = LevelCheck::default();
            for maneuver in 0..4 + good {
                for k in 0..100_u32 {
                    let roll_m = 0.005 * (f64::from(k) * std::f64::consts::TAU / 100.0).sin();
                    check.push(|quantity| match quantity {
                        Quantity::LevelLeft if maneuver < 4 => 0.0,
                        Quantity::LevelLeft => roll_m,
                        Quantity::LevelRight => -roll_m,
                        _ => f64::NAN,
                    });
                }
                check.close();
            }
            check
        };
        for (good, is_told) in [(0, true), (1, true), (2, false), (9, false)] {
            let found = dead_then(good).contradiction(true);
            assert_eq!(found.is_some(), is_told, "{good}: {found:?}");
        }
        assert!(dead_then(9).contradiction(false).is_some());
    }

    #[test]
    fn a_level_that_stands_still_is_named() {
        assert_eq!(told(3, 0.0), None);
        let message = told(0, 0.0).unwrap();
        assert!(
            message.starts_with("in 3 of 3 maneuvers the left level of the trailer"),
            "{message}"
        );
        assert!(told(1, 5e-4).unwrap().starts_with("in 2 of 3"));
        assert_eq!(told(2, 5e-4), None, "a single one of several");
        assert!(told(2, 0.0).unwrap().starts_with("in 1 of 3"), "without any noise");
        // In the last one, the right level flickers between steps of 5 mm, or moves by two of them.
        for (step_m, is_told) in [(0.005, false), (0.010, true)] {
            let mut check = LevelCheck::default();
            for maneuver in 0..4 {
                for k in 0..100_u32 {
                    let roll_m = 0.005 * (f64::from(k) * std::f64::consts::TAU / 100.0).sin();
                    let last_m = [0.0, if k % 2 == 0 { step_m } else { 0.0 }];
                    let levels_m = if maneuver < 3 { [roll_m, -roll_m] } else { last_m };
                    check.push(|quantity| match quantity {
                        Quantity::LevelLeft => levels_m[0],
                        Quantity::LevelRight => levels_m[1],
                        _ => f64::NAN,
                    });
                }
                check.close();
            }
            assert_eq!(check.contradiction(false).is_some(), is_told, "{step_m}");
        }
    }
}
