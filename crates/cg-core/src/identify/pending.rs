//! Buffer that collects rows of a regression into blocks.

use crate::math::linalg::{Rows, Triangle};
use crate::math::real::Real;

/// Number of rows that are added to the triangle at once on a chip. One more would save it 4 % of a sample, and cost
/// 184 bytes of its memory.
pub const BLOCK: usize = 4;

/// The same where memory is plentiful: a computer then waits less for the roots and divisions, one after the other, of each
/// block.
pub const LONG_BLOCK: usize = 16;

/// Rows that wait until their block of `B` is full. The rest of the block is zero and has no effect.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [[T; B]; N]: serde::Serialize, [T; B]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [[T; B]; N]: serde::Deserialize<'de>, [T; B]: serde::Deserialize<'de>"
    ))
)]
pub(crate) struct Pending<T, const N: usize, const B: usize> {
    rows: usize,
    columns: [[T; B]; N],
    observations: [T; B],
}

impl<T: Real, const N: usize, const B: usize> Pending<T, N, B> {
    pub(crate) const fn new() -> Self {
        let zero = T::ZERO;
        Self { rows: 0, columns: [[zero; B]; N], observations: [zero; B] }
    }

    fn push(&mut self, row: [T; N], observation: T) {
        if let Some(place) = self.observations.get_mut(self.rows) {
            *place = observation;
            for (column, value) in self.columns.iter_mut().zip(row) {
                if let Some(place) = column.get_mut(self.rows) {
                    *place = value;
                }
            }
            self.rows += 1;
        }
    }

    /// Adds a row, and the block to a triangle once it is full.
    pub(crate) fn push_into<R: Rows<T>>(
        &mut self,
        triangle: &mut Triangle<T, N, R>,
        row: [T; N],
        observation: T,
    ) {
        self.push(row, observation);
        if self.rows == B {
            self.fold_into(triangle);
        }
    }

    /// The same for a row whose regressors are zero but for the first ones, as in all rows of this buffer.
    #[inline]
    pub(crate) fn push_first_into(
        &mut self,
        triangle: &mut Triangle<T, N>,
        regressors: &[T],
        observation: T,
    ) {
        if let Some(place) = self.observations.get_mut(self.rows) {
            *place = observation;
        }
        for (column, value) in self.columns.iter_mut().zip(regressors) {
            if let Some(place) = column.get_mut(self.rows) {
                *place = *value;
            }
        }
        self.rows += 1;
        if self.rows == B {
            let columns = self.columns.get_mut(..regressors.len()).unwrap_or(&mut []);
            triangle.push_first_columns(columns, &mut self.observations);
            columns.fill([T::ZERO; B]);
            (self.observations, self.rows) = ([T::ZERO; B], 0);
        }
    }

    /// Adds the waiting rows to a triangle and empties the buffer.
    pub(crate) fn fold_into<R: Rows<T>>(&mut self, triangle: &mut Triangle<T, N, R>) {
        triangle.push_block(&mut self.columns, &mut self.observations);
        *self = Self::new();
    }
}
