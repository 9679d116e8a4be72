//! Whether both level sensors of a pair follow the roll of the body.

use cg_core::Quantity;
use serde::{Deserialize, Serialize};

use super::pair::Pair;

/// Least share that a working sensor has in the change of the difference of both. Roll moves both by the
/// same distance in opposite directions, so each has half of it; a sensor that stands still has none, and
/// the other one all. A vertical motion only adds to a share what it has in common with the roll.
const LEAST_SHARE: f64 = 0.1;
/// Least standard deviation of the difference, m: beside it, steps of a millimeter are no motion.
const MOVES_M: f64 = 1e-3;
/// Minimum number of rows for a statement on a maneuver.
const LEAST_ROWS: f64 = 50.0;

/// The left level against the difference of both since the last maneuver.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Sides {
    rows: f64,
    /// The difference of left and right level, and the left one, m.
    levels_m: Pair,
}

impl Sides {
    fn push(&mut self, [left_m, right_m]: [f64; 2]) {
        let difference_m = left_m - right_m;
        if difference_m.is_finite() {
            self.rows += 1.0;
            self.levels_m.push(self.rows, [difference_m, left_m]);
        }
    }

    /// The side that stands still while the other one moves.
    fn still(&self) -> Option<usize> {
        let moves = self.levels_m.square() > MOVES_M * MOVES_M * self.rows;
        if self.rows < LEAST_ROWS || !moves {
            return None;
        }
        match self.levels_m.slope() {
            share if share < LEAST_SHARE => Some(0),
            share if share > 1.0 - LEAST_SHARE => Some(1),
            _ => None,
        }
    }
}

/// One pair of level sensors.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Levels {
    sides: Sides,
    maneuvers: u32,
    /// Maneuvers in which the left and the right one stood still.
    still: [u32; 2],
}

impl Levels {
    fn close(&mut self) {
        if self.sides.rows >= LEAST_ROWS {
            self.maneuvers += 1;
            if let Some(side) = self.sides.still() {
                self.still[side] += 1;
            }
        }
        self.sides = Sides::default();
    }

    /// What is wrong with the sensors of this unit. A single one of several maneuvers may be chance.
    fn contradiction(&self, unit: &str) -> Option<String> {
        let (side, turns) = if self.still[0] > self.still[1] {
            ("left", self.still[0])
        } else {
            ("right", self.still[1])
        };
        (turns >= self.maneuvers.clamp(1, 2)).then(|| {
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
    pub(super) fn push(&mut self, level_m: impl Fn(Quantity) -> f64) {
        let [trailer, tractor] = [
            [Quantity::LevelLeft, Quantity::LevelRight],
            [Quantity::TractorLevelLeft, Quantity::TractorLevelRight],
        ];
        self.trailer.sides.push(trailer.map(&level_m));
        self.tractor.sides.push(tractor.map(&level_m));
    }

    /// Ends a maneuver.
    pub(super) fn close(&mut self) {
        self.trailer.close();
        self.tractor.close();
    }

    /// The sensor that does not work, if there is one.
    pub(super) fn contradiction(&self) -> Option<String> {
        self.trailer.contradiction("trailer").or_else(|| self.tractor.contradiction("tractor"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of three maneuvers; the left one works up to this maneuver.
    fn told(works_until: u32, noise_m: f64) -> Option<String> {
        let mut check = LevelCheck::default();
        for maneuver in 0..3 {
            for k in 0..200_u32 {
                let roll_m = 0.005 * (f64::from(k) / 20.0).sin();
                let noise = if k % 2 == 0 { noise_m } else { -noise_m };
                let heave_m = 0.5 * roll_m.abs();
                let left_m = if maneuver < works_until { heave_m + roll_m } else { 0.0 };
                check.push(|quantity| match quantity {
                    Quantity::LevelLeft => left_m + noise,
                    Quantity::LevelRight => heave_m - roll_m,
                    _ => f64::NAN,
                });
            }
            check.close();
        }
        check.contradiction()
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
        assert_eq!(told(2, 0.0), None, "a single one of several");
    }
}
