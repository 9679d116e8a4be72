//! The first rows of a table: whether its channels have rasters of their own, and the rows until they are given.

use std::collections::VecDeque;

use cg_core::Quantity;

use super::error::{LogError, Position};
use super::options::LogOptions;
use super::plausibility::Plausibility;
use super::signal::{LogRow, Signal};

/// Roll angles, which give the rows of aligned channels, and what they are compared with.
pub(super) const ROLLS: [Signal; 6] = [
    Signal::Roll,
    Signal::RollToGravity,
    Signal::Tilt,
    Signal::SuspensionRoll,
    Signal::LevelLeft,
    Signal::TractorSuspensionRoll,
];
const INPUTS: [Signal; 6] = [
    Signal::Steer,
    Signal::SteeringWheel,
    Signal::LateralAcceleration,
    Signal::LateralSpecificForce,
    Signal::YawRate,
    Signal::TractorLateralSpecificForce,
];

/// Whether the channels of a table have rasters of their own: fewer than half of its first rows with a roll angle have an
/// input too, though both occur, or another quantity stands mostly in rows without a roll angle.
#[derive(Clone, Debug, Default)]
pub struct Rasters {
    rows: usize,
    rolls: usize,
    both: usize,
    inputs: usize,
    /// Number of values of each quantity, and of those in a row with a roll angle.
    values: [(usize, usize); Quantity::COUNT],
}

impl Rasters {
    /// Number of rows that are looked at.
    const LOOK: usize = 500;

    /// The rasters of a table with these rows, of which no more than needed are taken.
    pub fn of(rows: impl IntoIterator<Item = LogRow>) -> Self {
        let mut rasters = Self::default();
        for row in rows {
            rasters.push(&row);
            if rasters.is_known() {
                break;
            }
        }
        rasters
    }

    /// Those of a table whose channels are known to have time stamps of their own.
    pub fn apart() -> Self {
        // A row with a roll angle, and one with an input.
        Self { rows: 2, rolls: 1, inputs: 1, ..Self::default() }
    }

    fn push(&mut self, row: &LogRow) {
        let has = |signal: &Signal| !row.get(*signal).is_nan();
        let (roll, input) = (ROLLS.iter().any(has), INPUTS.iter().any(has));
        self.rows += 1;
        self.rolls += usize::from(roll);
        self.both += usize::from(roll && input);
        self.inputs += usize::from(input);
        for (quantity, (values, both)) in Quantity::ALL.into_iter().zip(&mut self.values) {
            let is_here = has(&Signal::from(quantity));
            *values += usize::from(is_here);
            *both += usize::from(roll && is_here);
        }
    }

    /// Whether no further row is needed.
    fn is_known(&self) -> bool {
        self.rows >= Self::LOOK || 2 * self.both >= Self::LOOK
    }

    /// Whether the channels have rasters of their own, as far as is known.
    pub fn differ(&self) -> bool {
        // A quantity that comes more often than the roll angle may have a value in all rows of it.
        let is_apart = |(values, both): &(usize, usize)| 2 * both < self.rolls.min(*values);
        (self.inputs > 0 && 2 * self.both < self.rolls) || self.values.iter().any(is_apart)
    }
}

/// Rows that were read before they are given, and what ended them if the table or an error did.
pub(super) struct Beginning {
    rasters: Rasters,
    /// What the truck can have, if it is known. What is found is told only when the rows are given.
    plausibility: Option<Plausibility>,
    rows: VecDeque<(Position, [f64; Signal::COUNT])>,
    end: Option<(Position, Result<bool, LogError>)>,
    /// The position of what was given last.
    position: Position,
}

impl Beginning {
    /// The beginning of a table whose header ends at this position.
    pub(super) fn new(options: &LogOptions, position: Position) -> Self {
        Self {
            rasters: Rasters::default(),
            plausibility: options.settings.map(Plausibility::new),
            rows: VecDeque::new(),
            end: None,
            position,
        }
    }

    /// Whether the next row has to be looked at.
    pub(super) fn is_open(&self) -> bool {
        self.end.is_none() && !self.rasters.is_known()
    }

    pub(super) fn rasters(&self) -> &Rasters {
        &self.rasters
    }

    /// Takes a row with its position and the quantities that it may have, if there was one, or what ended the rows.
    pub(super) fn push(
        &mut self,
        more: Result<bool, LogError>,
        position: Position,
        quantities: &[Quantity],
        values: &[f64; Signal::COUNT],
    ) {
        if !matches!(more, Ok(true)) {
            self.end = Some((position, more));
            return;
        }
        self.rows.push_back((position, *values));
        let mut values = *values;
        if let Some(plausibility) = &mut self.plausibility {
            plausibility.check(quantities, &mut values, || position);
        }
        self.rasters.push(&LogRow::from_values(values));
    }

    /// Gives the next row, or what ended the rows; `None` if there is neither.
    pub(super) fn next(
        &mut self,
        values: &mut [f64; Signal::COUNT],
    ) -> Option<Result<bool, LogError>> {
        if let Some((position, next)) = self.rows.pop_front() {
            (self.position, *values) = (position, next);
            return Some(Ok(true));
        }
        let (position, end) = self.end.take()?;
        self.position = position;
        Some(end)
    }

    /// The position of what was given last.
    pub(super) fn position(&self) -> Position {
        self.position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROLL: LogRow = LogRow { roll_rad: 0.1, ..LogRow::ABSENT };
    const BOTH: LogRow = LogRow { steer_rad: 0.1, ..ROLL };
    const INPUT: LogRow = LogRow { steer_rad: 0.1, ..LogRow::ABSENT };

    /// The rasters of rows of which so many have both, then so many a roll angle, then so many an input.
    fn differ([both, rolls, inputs]: [usize; 3]) -> bool {
        let rows = [(BOTH, both), (ROLL, rolls), (INPUT, inputs)];
        let rows = rows.into_iter().flat_map(|(row, count)| std::iter::repeat_n(row, count));
        Rasters::of(rows).differ()
    }

    #[test]
    fn rasters_differ_if_fewer_than_half_of_the_rolls_have_an_input() {
        for (rows, known) in [
            ([2, 2, 0], false),
            ([2, 3, 0], true),
            ([0, 9, 0], false),
            ([0, 9, 1], true),
            ([0, 0, 9], false),
            ([249, 251, 0], true),
            ([250, 251, 0], false), // no more than 500 rows are looked at
            ([0, 499, 1], true),
            ([0, 500, 1], false),
        ] {
            assert_eq!(differ(rows), known, "{rows:?}");
        }
    }

    /// A lateral acceleration or a mass with rows of its own, and a steer angle that comes five times as often as the roll angle.
    #[test]
    fn rasters_differ_if_one_quantity_has_rows_of_its_own() {
        let lateral = LogRow { lateral_acceleration_mps2: 1.0, ..LogRow::ABSENT };
        let alternating = |row: LogRow| [BOTH, BOTH, row].into_iter().cycle().take(300);
        assert!(Rasters::of(alternating(lateral)).differ());
        let beside = LogRow { steer_rad: 0.1, ..lateral };
        assert!(Rasters::of(alternating(beside)).differ());
        assert!(!Rasters::of(alternating(LogRow { roll_rad: 0.1, ..beside })).differ());
        let mass = LogRow { trailer_mass_kg: 2e4, ..LogRow::ABSENT };
        assert!(Rasters::of(std::iter::once(mass).chain(std::iter::repeat_n(BOTH, 300))).differ());
        let often = [BOTH, INPUT, INPUT, INPUT, INPUT].into_iter().cycle().take(300);
        assert!(!Rasters::of(often).differ());
    }

    /// The rows after half of the most have both cannot change the answer.
    #[test]
    fn no_more_rows_are_taken_than_are_needed() {
        let mut taken = 0;
        Rasters::of(std::iter::repeat_n(BOTH, 500).inspect(|_| taken += 1));
        assert_eq!(taken, 250);
    }
}
