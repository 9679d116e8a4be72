//! How the triangle of a least-squares problem is stored.

use crate::math::real::Real;

/// Storage of the upper triangle `R`. Row `i` starts at its diagonal element.
pub trait Rows<T>: Copy {
    /// The triangle with all elements zero.
    const EMPTY: Self;

    /// Row `i`, from its diagonal element to its last element; empty if `i` is beyond the last row.
    fn row(&self, i: usize) -> &[T];

    /// Row `i` as in [`row`](Self::row), mutable.
    fn row_mut(&mut self, i: usize) -> &mut [T];
}

/// Stores the triangle in a square array, whose lower half is not used.
impl<T: Real, const N: usize> Rows<T> for [[T; N]; N] {
    const EMPTY: Self = [[T::ZERO; N]; N];

    #[inline]
    fn row(&self, i: usize) -> &[T] {
        self.get(i).and_then(|row| row.get(i..)).unwrap_or(&[])
    }

    #[inline]
    fn row_mut(&mut self, i: usize) -> &mut [T] {
        self.get_mut(i).and_then(|row| row.get_mut(i..)).unwrap_or(&mut [])
    }
}

/// Stores the rows of the triangle one after the other in `P = N (N + 1)/2` numbers, which takes
/// half the memory of a square array.
#[derive(Clone, Copy, Debug)]
pub struct Packed<T, const N: usize, const P: usize>(pub(crate) [T; P]);

impl<T, const N: usize, const P: usize> Packed<T, N, P> {
    /// Index range of row `i`.
    const fn place(i: usize) -> core::ops::Range<usize> {
        let start = (i * (2 * N + 1 - i)) / 2;
        start..start + (N - i)
    }
}

impl<T: Real, const N: usize, const P: usize> Rows<T> for Packed<T, N, P> {
    const EMPTY: Self = {
        assert!(P == N * (N + 1) / 2, "P is the number of elements of a triangle");
        Self([T::ZERO; P])
    };

    #[inline(never)] // one copy in the firmware image
    fn row(&self, i: usize) -> &[T] {
        if i < N { self.0.get(Self::place(i)).unwrap_or(&[]) } else { &[] }
    }

    #[inline(never)]
    fn row_mut(&mut self, i: usize) -> &mut [T] {
        if i < N { self.0.get_mut(Self::place(i)).unwrap_or(&mut []) } else { &mut [] }
    }
}
