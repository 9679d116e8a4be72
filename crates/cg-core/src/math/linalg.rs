//! Recursive least squares in square-root form.
//!
//! The solution is stored as a triangular array:
//!
//! ```text
//!     ┌ R  z ┐        R   N × N, upper triangular, RᵀR = Σ φ φᵀ
//!     └ 0  ρ ┘        z   N,     R θ = z is the least-squares answer
//! ```
//!
//! Each new row `y = φᵀ θ + e` is added with at most `N` Givens rotations. The normal equations are
//! never formed, so `f32` loses only half as many digits. Consecutive rows can be added in blocks
//! with Householder reflections, which is three times as fast.
//!
//! **Reference.** Golub and Van Loan, *Matrix Computations*, 4th ed., §5.1.8 (rotation), §5.1.3
//! (reflection) and §6.5.3 (appending a row).

use crate::math::real::Real;
pub use crate::math::rows::{Packed, Rows};

/// A least-squares problem with at most `N` unknowns, to which rows are added one at a time.
///
/// It has a fixed size and uses no heap. One [`push`](Self::push) costs up to `N` square roots and
/// about `5 N² / 2` multiplications; zeros in the row cost nothing. `R` is stored as a square
/// array, or as [`Packed`] where memory is scarce.
///
/// ```
/// use cg_core::math::linalg::Triangle;
///
/// let mut line = Triangle::<f64, 2>::new();
/// for x in [0.0, 1.0, 2.0] {
///     line.push([1.0, x], 3.0 + 0.5 * x);
/// }
/// let theta = line.solve(2).unwrap();
/// assert!((theta[0] - 3.0).abs() < 1e-12 && (theta[1] - 0.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; N]: serde::Serialize, R: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; N]: serde::Deserialize<'de>, R: serde::Deserialize<'de>"
    ))
)]
pub struct Triangle<T, const N: usize, R = [[T; N]; N]> {
    r: R,
    z: [T; N],
    residual_sum_of_squares: T,
}

impl<T: Real, const N: usize, R: Rows<T>> Default for Triangle<T, N, R> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize, R: Rows<T>> Triangle<T, N, R> {
    /// A problem without any rows.
    pub const fn new() -> Self {
        Self { r: R::EMPTY, z: [T::ZERO; N], residual_sum_of_squares: T::ZERO }
    }

    /// Adds the row `regressors · θ = observation`.
    #[inline(never)] // one copy in the firmware image, like the functions below
    pub fn push(&mut self, mut regressors: [T; N], mut observation: T) {
        for (i, z) in self.z.iter_mut().enumerate() {
            let Some((x, right)) = regressors.get_mut(i..).and_then(<[T]>::split_first_mut) else {
                break;
            };
            if *x == T::zero() {
                continue;
            }
            let Some((diagonal, upper)) = self.r.row_mut(i).split_first_mut() else { break };
            // ┌ c  s ┐ ┌ r ┐   ┌ √(r² + x²) ┐
            // └-s  c ┘ └ x ┘ = └     0      ┘
            let length = (*diagonal * *diagonal + *x * *x).root();
            if length == T::zero() {
                continue; // the square of x underflows, so the row contains no information on θ_i
            }
            let inverse = T::one() / length;
            let (c, s) = (*diagonal * inverse, *x * inverse);
            *diagonal = length;
            for (upper, lower) in upper.iter_mut().zip(right) {
                (*upper, *lower) = (c * *upper + s * *lower, c * *lower - s * *upper);
            }
            (*z, observation) = (c * *z + s * observation, c * observation - s * *z);
        }
        self.residual_sum_of_squares += observation * observation;
    }

    /// Adds `B` rows at once, given by columns: `columns[j][b]` is regressor `j` of row `b`.
    ///
    /// The result is that of `B` calls of [`push`](Self::push), in a third of the time: it needs
    /// one Householder reflection per unknown instead of `B` rotations. Rows of zeros have no
    /// effect. The contents of both arrays are overwritten and have no meaning afterwards.
    #[inline(never)]
    pub fn push_block<const B: usize>(
        &mut self,
        columns: &mut [[T; B]; N],
        observations: &mut [T; B],
    ) {
        self.push_first_columns(columns, observations);
    }

    /// The same for rows whose regressors are zero beyond those of the given columns.
    #[inline]
    pub(crate) fn push_first_columns<const B: usize>(
        &mut self,
        columns: &mut [[T; B]],
        observations: &mut [T; B],
    ) {
        for (j, z) in self.z.iter_mut().enumerate() {
            let Some((v, right)) = columns.get_mut(j..).and_then(<[_]>::split_first_mut) else {
                break;
            };
            let tail = dot(v, v);
            if tail == T::zero() {
                continue; // the column is zero, or so small that its square underflows
            }
            let Some((diagonal, upper)) = self.r.row_mut(j).split_first_mut() else { break };
            // (I − β u uᵀ) (r, v)ᵀ = (α, 0)ᵀ with u = (r − α, v). The sign of α is chosen to avoid
            // cancellation in r − α.
            let length = (*diagonal * *diagonal + tail).root();
            let alpha = if *diagonal > T::zero() { -length } else { length };
            let head = *diagonal - alpha;
            let beta = T::one() / (length * head.abs());
            if !beta.present() {
                continue; // likewise
            }
            *diagonal = alpha;
            for (upper, column) in upper.iter_mut().zip(right) {
                reflect(head, v, beta, upper, column);
            }
            reflect(head, v, beta, z, observations);
        }
        self.residual_sum_of_squares += dot(observations, observations);
    }

    /// Exponential forgetting: multiplies the weight of all rows so far by `root_factor²`.
    pub fn scale(&mut self, root_factor: T) {
        for i in 0..N {
            for element in self.r.row_mut(i) {
                *element *= root_factor;
            }
        }
        for z in &mut self.z {
            *z *= root_factor;
        }
        self.residual_sum_of_squares *= root_factor * root_factor;
    }

    /// Subtracts `times` the regressor `from` from the later regressor `column`, in all rows so
    /// far.
    pub fn shift(&mut self, column: usize, from: usize, times: T) {
        for i in 0..=from {
            let row = self.r.row_mut(i);
            let Some(&other) = row.get(from - i) else { break };
            if let Some(element) = row.get_mut(column - i) {
                *element -= times * other;
            }
        }
    }

    /// The least-squares solution for the first `n` unknowns; the others are zero.
    ///
    /// # Errors
    /// `Err(i)` if the rows do not determine unknown `i`: its pivot is negligible compared with the
    /// largest one. `i` is the first such unknown.
    #[inline(never)]
    pub fn solve(&self, n: usize) -> Result<[T; N], usize> {
        self.pivots(n)?;
        Ok(self.backward(self.z, n))
    }

    #[allow(clippy::redundant_closure_for_method_calls, reason = "there are several of that name")]
    fn pivots(&self, n: usize) -> Result<(), usize> {
        let pivot = |i: usize| self.r.row(i).first().map_or(T::zero(), |pivot| pivot.abs());
        let mut largest = T::zero();
        for i in 0..n.min(N) {
            largest = largest.max(pivot(i));
        }
        // A pivot below 8 ε of the largest one is due to rounding and carries no information.
        let least = largest * T::machine_epsilon() * T::of(8.0);
        for i in 0..n.min(N) {
            // This form of the comparison also rejects NaN.
            if !(pivot(i) > least) {
                return Err(i);
            }
        }
        Ok(())
    }

    /// The last of the first `n` unknowns in the solution for all of them, and its standard
    /// deviation for noise of unit variance. It shows whether this unknown improves a model without
    /// it.
    ///
    /// Only valid if [`solve`](Self::solve) succeeds with the same `n`.
    pub fn last_of(&self, n: usize) -> Option<(T, T)> {
        let i = n.checked_sub(1)?;
        let inverse = T::one() / self.r.row(i).first()?.abs();
        Some((*self.z.get(i)? / *self.r.row(i).first()?, inverse))
    }

    /// `‖R⁻ᵀ g‖²`: the variance of `gᵀ θ` for noise of unit variance.
    ///
    /// Only valid if [`solve`](Self::solve) succeeds with the same `n`.
    pub fn variance_of(&self, gradient: &[T; N], n: usize) -> T {
        self.forward(gradient, n).iter().fold(T::zero(), |sum, w| sum + *w * *w)
    }

    /// `(RᵀR)⁻¹ c`: the change of the solution due to a change `c` of `Σ φ y`.
    ///
    /// Only valid if [`solve`](Self::solve) succeeds with the same `n`.
    pub fn shift_for(&self, change: &[T; N], n: usize) -> [T; N] {
        self.backward(self.forward(change, n), n)
    }

    /// `R⁻ᵀ g`.
    #[inline(never)]
    fn forward(&self, gradient: &[T; N], n: usize) -> [T; N] {
        let mut w = *gradient;
        for i in 0..N {
            let Some((value, rest)) = w.get_mut(i..).and_then(<[T]>::split_first_mut) else {
                break;
            };
            if i >= n {
                *value = T::zero();
            }
            if *value == T::zero() {
                continue;
            }
            let row = self.r.row(i);
            *value /= row.first().copied().unwrap_or(T::one());
            for (x, r) in rest.iter_mut().zip(row.iter().skip(1)) {
                *x -= *r * *value;
            }
        }
        w
    }

    /// `R⁻¹ w`.
    #[inline(never)]
    fn backward(&self, mut w: [T; N], n: usize) -> [T; N] {
        for i in (0..N).rev() {
            let row = self.r.row(i);
            let Some((value, rest)) = w.get_mut(i..).and_then(<[T]>::split_first_mut) else {
                break;
            };
            if i >= n {
                *value = T::zero();
                continue;
            }
            for (x, r) in rest.iter().zip(row.iter().skip(1)) {
                *value -= *r * *x;
            }
            *value /= row.first().copied().unwrap_or(T::one());
        }
        w
    }

    /// `(RᵀR)⁻¹`: the covariance of θ for noise of unit variance (rows and columns from `n` on are
    /// zero).
    ///
    /// Only valid if [`solve`](Self::solve) succeeds with the same `n`.
    pub fn covariance(&self, n: usize) -> [[T; N]; N] {
        let mut covariance = [[T::zero(); N]; N];
        for (k, column) in covariance.iter_mut().enumerate().take(n) {
            let mut unit = [T::zero(); N];
            if let Some(place) = unit.get_mut(k) {
                *place = T::one();
            }
            *column = self.shift_for(&unit, n); // the matrix is symmetric, so a column is a row
        }
        covariance
    }

    /// The sum of the squared residuals of all rows at `theta`.
    #[inline(never)]
    pub fn sum_of_squares_at(&self, theta: &[T; N]) -> T {
        let mut sum = self.residual_sum_of_squares;
        for (i, z) in self.z.iter().enumerate() {
            let mut residual = *z;
            for (r, x) in self.r.row(i).iter().zip(theta.iter().skip(i)) {
                residual -= *r * *x;
            }
            sum += residual * residual;
        }
        sum
    }
}

/// `Σ a b` in four interleaved sums. This order of summation suits vector units and is the same on
/// every target.
#[inline]
fn dot<T: Real, const B: usize>(a: &[T; B], b: &[T; B]) -> T {
    let ((a, more), (b, others)) = (a.split_at(B.min(4)), b.split_at(B.min(4)));
    let mut lanes = [T::zero(); 4];
    for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
        *lane = *a * *b;
    }
    for (a, b) in more.chunks(4).zip(others.chunks(4)) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += *a * *b;
        }
    }
    (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
}

/// Applies the reflection to one column `(top, rest)`.
#[inline]
fn reflect<T: Real, const B: usize>(head: T, v: &[T; B], beta: T, top: &mut T, rest: &mut [T; B]) {
    let share = (head * *top + dot(v, rest)) * beta;
    *top -= share * head;
    for (x, v) in rest.iter_mut().zip(v) {
        *x -= share * *v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scaled_problem_has_the_same_answer_and_less_weight() {
        let mut triangle = Triangle::<f64, 2>::new();
        for x in [0.0, 1.0, 3.0] {
            triangle.push([1.0, x], 2.0 - x);
        }
        let before = (triangle.solve(2).unwrap(), triangle.variance_of(&[1.0, 0.0], 2));
        triangle.scale(0.5);
        let after = (triangle.solve(2).unwrap(), triangle.variance_of(&[1.0, 0.0], 2));
        assert!((before.0[0] - after.0[0]).abs() < 1e-14);
        assert!((after.1 / before.1 - 4.0).abs() < 1e-12);
    }

    /// The same rows with the time origin shifted to `t − 3`, in a square and in a packed triangle.
    #[test]
    fn a_shifted_regressor_is_that_of_the_shifted_rows() {
        let (mut whole, mut later) = (Triangle::<f64, 3>::new(), Triangle::<f64, 3>::new());
        let mut packed = Triangle::<f64, 3, Packed<f64, 3, 6>>::new();
        for t in [0.0, 1.0, 2.0, 5.0] {
            let y = 1.0 + 0.3 * t + 0.01 * t * t;
            whole.push([t * t, 1.0, t], y);
            packed.push([t * t, 1.0, t], y);
            later.push([t * t, 1.0, t - 3.0], y);
        }
        whole.shift(2, 1, 3.0);
        packed.shift(2, 1, 3.0);
        let known = later.solve(3).unwrap();
        for found in [whole.solve(3).unwrap(), packed.solve(3).unwrap()] {
            for (found, known) in found.iter().zip(known) {
                assert!((found - known).abs() < 1e-12, "{found} {known}");
            }
        }
        // y = 0.01 t² + 1.9 + 0.3 (t − 3)
        assert!((known[1] - 1.9).abs() < 1e-12);
    }

    #[test]
    fn blocks_and_single_rows_agree() {
        let [mut single, mut block, mut first] = [(); 3].map(|()| Triangle::<f64, 3>::new());
        for start in 0..5 {
            let (mut columns, mut observations) = ([[0.0; 8]; 3], [0.0; 8]);
            for b in 0..8 {
                let x = f64::from(start * 8) + f64::from(u8::try_from(b).unwrap());
                let row = [1.0, 0.1 * x, (0.7 * x).sin()];
                observations[b] = (0.3 * x).cos();
                for j in 0..3 {
                    columns[j][b] = row[j];
                }
                single.push(row, observations[b]);
            }
            let (mut of_two, mut same) = ([columns[0], columns[1]], observations);
            first.push_first_columns(&mut of_two, &mut same);
            block.push_block(&mut columns, &mut observations);
        }
        assert_eq!(first.solve(2), block.solve(2));
        let (a, b) = (single.solve(3).unwrap(), block.solve(3).unwrap());
        for j in 0..3 {
            assert!((a[j] - b[j]).abs() < 1e-13);
        }
        let sum = single.sum_of_squares_at(&a);
        assert!((sum / block.sum_of_squares_at(&b) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn packed_rows_give_the_same_answers_as_a_square() {
        let mut square = Triangle::<f64, 3>::new();
        let mut packed = Triangle::<f64, 3, Packed<f64, 3, 6>>::new();
        for k in 0..9 {
            let x = f64::from(k);
            let row = [1.0, x, (x * 1.7).sin()];
            square.push(row, (0.4 * x).cos());
            packed.push(row, (0.4 * x).cos());
        }
        assert_eq!(square.solve(3), packed.solve(3));
        assert_eq!(square.solve(2), packed.solve(2));
        assert_eq!(square.covariance(3), packed.covariance(3));
        // The last unknown and its standard deviation agree with the full solution and its
        // covariance.
        let (value, sd) = packed.last_of(3).unwrap();
        assert!((value - square.solve(3).unwrap()[2]).abs() < 1e-14);
        assert!((sd * sd - square.covariance(3)[2][2]).abs() < 1e-14);
        assert!(packed.last_of(0).is_none());
    }

    #[test]
    fn values_whose_squares_underflow_do_no_harm() {
        let mut triangle = Triangle::<f32, 2>::new();
        triangle.push_block(&mut [[1e-20, 0.0, 0.0, 0.0], [1e-30, 1e-22, 0.0, 0.0]], &mut [0.0; 4]);
        triangle.push_block(
            &mut [[1.0, 0.0, 2.0, 0.0], [0.0, 1.0, 1.0, 0.0]],
            &mut [1.0, 2.0, 4.0, 0.0],
        );
        let theta = triangle.solve(2).unwrap();
        assert!((theta[0] - 1.0).abs() < 1e-6 && (theta[1] - 2.0).abs() < 1e-6);
    }

    #[test]
    fn an_undetermined_unknown_is_named() {
        let mut triangle = Triangle::<f32, 3>::new();
        for x in [1.0_f32, 2.0, 3.0] {
            triangle.push([1.0, 0.0, x], x);
        }
        assert_eq!(triangle.solve(3), Err(1));
    }

    #[test]
    fn variance_and_covariance_agree() {
        let mut triangle = Triangle::<f64, 3>::new();
        for k in 0..9 {
            let x = f64::from(k);
            triangle.push([1.0, x, (x * 1.7).sin()], x);
        }
        let g = [0.3, -1.0, 2.0];
        let covariance = triangle.covariance(3);
        let mut quadratic = 0.0;
        for i in 0..3 {
            for j in 0..3 {
                quadratic += g[i] * covariance[i][j] * g[j];
            }
        }
        assert!((quadratic / triangle.variance_of(&g, 3) - 1.0).abs() < 1e-10);
    }

    /// Pivots up to eight ε of the largest one are treated as rounding.
    #[test]
    fn a_pivot_counts_from_eight_epsilon_on() {
        for (epsilons, found) in [(7.0, Err(1)), (9.0, Ok(()))] {
            let mut triangle = Triangle::<f64, 2>::new();
            triangle.push([-2.0, 0.0], 1.0);
            triangle.push([0.0, 2.0 * epsilons * f64::EPSILON], 0.0);
            assert_eq!(triangle.solve(2).map(|_| ()), found, "{epsilons}");
        }
    }
}
