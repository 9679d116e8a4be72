//! Least squares, one row at a time, in square-root form.
//!
//! The triangular array
//!
//! ```text
//!     ┌ R  z ┐        R   N × N, upper triangular, RᵀR = Σ φ φᵀ
//!     └ 0  ρ ┘        z   N,     R θ = z is the least-squares answer
//! ```
//!
//! takes each new row `y = φᵀ θ + e` in with at most `N` Givens rotations.
//! Nothing is ever squared, so `f32` loses half as many digits as the normal
//! equations would. Rows that come in a stream are taken in blocks, with Householder
//! reflections, which is three times as fast.
//!
//! **Reference.** Golub and Van Loan, *Matrix Computations*, 4th ed., §5.1.8 (rotation), §5.1.3
//! (reflection) and §6.5.3 (appending a row).

use crate::real::Real;

/// A running least-squares problem with at most `N` unknowns.
///
/// All inline, no heap. One [`push`](Self::push) costs up to `N` square roots and
/// about `5 N² / 2` multiplications; zeros in the row are free.
///
/// ```
/// use cg_core::linalg::Triangle;
///
/// let mut line = Triangle::<f64, 2>::new();
/// for x in [0.0, 1.0, 2.0] {
///     line.push([1.0, x], 3.0 + 0.5 * x);
/// }
/// let theta = line.solve(2).unwrap();
/// assert!((theta[0] - 3.0).abs() < 1e-12 && (theta[1] - 0.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Triangle<T, const N: usize> {
    r: [[T; N]; N],
    z: [T; N],
    residual_sum_of_squares: T,
}

impl<T: Real, const N: usize> Default for Triangle<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> Triangle<T, N> {
    /// The empty problem.
    pub const fn new() -> Self {
        Self { r: [[T::ZERO; N]; N], z: [T::ZERO; N], residual_sum_of_squares: T::ZERO }
    }

    /// Takes in the row `regressors · θ = observation`.
    #[inline]
    pub fn push(&mut self, mut regressors: [T; N], mut observation: T) {
        for i in 0..N {
            let x = regressors[i];
            if x == T::zero() {
                continue;
            }
            let row = &mut self.r[i];
            let diagonal = row[i];
            // ┌ c  s ┐ ┌ r ┐   ┌ √(r² + x²) ┐
            // └-s  c ┘ └ x ┘ = └     0      ┘
            let length = (diagonal * diagonal + x * x).root();
            if length == T::zero() {
                continue; // x so small that its square underflows: no information
            }
            let inverse = T::one() / length;
            let (c, s) = (diagonal * inverse, x * inverse);
            row[i] = length;
            for j in i + 1..N {
                let (upper, lower) = (row[j], regressors[j]);
                row[j] = c * upper + s * lower;
                regressors[j] = c * lower - s * upper;
            }
            let upper = self.z[i];
            self.z[i] = c * upper + s * observation;
            observation = c * observation - s * upper;
        }
        self.residual_sum_of_squares += observation * observation;
    }

    /// Takes in `B` rows at once, column by column: `columns[j][b]` is regressor `j` of row `b`.
    ///
    /// The same answer as `B` calls of [`push`](Self::push), with one Householder reflection
    /// per unknown in place of `B` rotations: a third of the time. Rows of zeros say nothing.
    /// What stays in the block afterwards has no meaning.
    pub fn push_block<const B: usize>(
        &mut self,
        columns: &mut [[T; B]; N],
        observations: &mut [T; B],
    ) {
        for j in 0..N {
            let v = columns[j];
            let tail = dot(&v, &v);
            // (I − β u uᵀ) (r, v)ᵀ = (α, 0)ᵀ with u = (r − α, v); α has the sign that does not
            // cancel.
            let diagonal = self.r[j][j];
            let length = (diagonal * diagonal + tail).root();
            let alpha = if diagonal > T::zero() { -length } else { length };
            let head = diagonal - alpha;
            let beta = T::one() / (length * head.abs());
            if tail == T::zero() || !beta.present() {
                continue; // nothing there, or so small that its square underflows
            }
            self.r[j][j] = alpha;
            for k in j + 1..N {
                reflect(head, &v, beta, &mut self.r[j][k], &mut columns[k]);
            }
            reflect(head, &v, beta, &mut self.z[j], observations);
        }
        self.residual_sum_of_squares += dot(observations, observations);
    }

    /// The least-squares answer if only unknowns `a` and `b` differ from zero; `None` if no row
    /// determines `a`. An undetermined `b` stays zero.
    pub fn solve_pair(&self, a: usize, b: usize) -> Option<[T; N]> {
        let (mut aa, mut ab, mut bb) = (T::zero(), T::zero(), T::zero());
        let (mut az, mut bz) = (T::zero(), T::zero());
        for (row, z) in self.r.iter().zip(self.z) {
            let (x, y) = (*row.get(a)?, *row.get(b)?);
            aa += x * x;
            ab += x * y;
            bb += y * y;
            az += x * z;
            bz += y * z;
        }
        let determinant = aa * bb - ab * ab;
        let (first, second) = if determinant > T::zero() {
            ((az * bb - bz * ab) / determinant, (bz * aa - az * ab) / determinant)
        } else {
            (az / aa, T::zero())
        };
        let mut theta = [T::zero(); N];
        *theta.get_mut(a)? = first;
        *theta.get_mut(b)? = second;
        first.present().then_some(theta)
    }

    /// Multiplies the weight of everything seen so far by `factor` (exponential
    /// forgetting; `root_factor` is its square root).
    pub fn scale(&mut self, root_factor: T) {
        for i in 0..N {
            for j in i..N {
                self.r[i][j] *= root_factor;
            }
            self.z[i] *= root_factor;
        }
        self.residual_sum_of_squares *= root_factor * root_factor;
    }

    /// The least-squares answer for the first `n` unknowns (the others are zero),
    /// or the index of the first one that no row determines.
    ///
    /// # Errors
    /// `Err(i)` if the `i`-th pivot vanishes against the largest one.
    pub fn solve(&self, n: usize) -> Result<[T; N], usize> {
        self.pivots(n)?;
        let mut theta = [T::zero(); N];
        for i in (0..N).rev() {
            if i < n {
                let mut sum = self.z[i];
                for j in i + 1..N {
                    sum -= self.r[i][j] * theta[j];
                }
                theta[i] = sum / self.r[i][i];
            }
        }
        Ok(theta)
    }

    fn pivots(&self, n: usize) -> Result<(), usize> {
        let mut largest = T::zero();
        for i in 0..N {
            if i < n {
                largest = largest.max(self.r[i][i].abs());
            }
        }
        // A pivot below N ε of the largest is rounding, not information.
        let least = largest * T::machine_epsilon() * T::of(8.0);
        for i in 0..N {
            // Written so that NaN fails too.
            if i < n && !(self.r[i][i].abs() > least) {
                return Err(i);
            }
        }
        Ok(())
    }

    /// `‖R⁻ᵀ g‖²`: the variance of `gᵀ θ` for unit noise.
    ///
    /// Only valid when [`solve`](Self::solve) with the same `n` succeeds.
    pub fn variance_of(&self, gradient: &[T; N], n: usize) -> T {
        self.forward(gradient, n).iter().fold(T::zero(), |sum, w| sum + *w * *w)
    }

    /// `(RᵀR)⁻¹ c`: how far a change `c` of `Σ φ y` moves the answer.
    ///
    /// Only valid when [`solve`](Self::solve) with the same `n` succeeds.
    pub fn shift_for(&self, change: &[T; N], n: usize) -> [T; N] {
        let mut w = self.forward(change, n);
        for i in (0..N).rev() {
            if i < n {
                let mut value = w[i];
                for j in i + 1..N {
                    value -= self.r[i][j] * w[j];
                }
                w[i] = value / self.r[i][i];
            }
        }
        w
    }

    /// `R⁻ᵀ g`.
    fn forward(&self, gradient: &[T; N], n: usize) -> [T; N] {
        let mut w = [T::zero(); N];
        for i in 0..N {
            if i < n {
                let mut value = gradient[i];
                for j in 0..i {
                    value -= self.r[j][i] * w[j];
                }
                w[i] = value / self.r[i][i];
            }
        }
        w
    }

    /// `(RᵀR)⁻¹`: the covariance of θ for unit noise (rows and columns beyond `n` are zero).
    pub fn covariance(&self, n: usize) -> [[T; N]; N] {
        let mut covariance = [[T::zero(); N]; N];
        let mut inverse = [[T::zero(); N]; N]; // R⁻¹, upper triangular, column by column
        for k in 0..N {
            if k >= n {
                continue;
            }
            for i in (0..N).rev() {
                if i > k {
                    continue;
                }
                let mut sum = if i == k { T::one() } else { T::zero() };
                for j in i + 1..N {
                    sum -= self.r[i][j] * inverse[j][k];
                }
                inverse[i][k] = sum / self.r[i][i];
            }
        }
        for i in 0..N {
            for j in 0..N {
                for k in 0..N {
                    covariance[i][j] += inverse[i][k] * inverse[j][k];
                }
            }
        }
        covariance
    }

    /// The sum of squared residuals of all rows at the answer `theta`.
    pub fn sum_of_squares_at(&self, theta: &[T; N]) -> T {
        let mut sum = self.residual_sum_of_squares;
        for i in 0..N {
            let mut residual = self.z[i];
            for j in i..N {
                residual -= self.r[i][j] * theta[j];
            }
            sum += residual * residual;
        }
        sum
    }
}

/// `Σ a b` in four interleaved sums: an order of summation that vector units can keep, the same
/// on every target.
#[inline]
fn dot<T: Real, const B: usize>(a: &[T; B], b: &[T; B]) -> T {
    let mut lanes = [T::zero(); 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += *a * *b;
        }
    }
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// Reflects one column `(top, rest)`.
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

    #[test]
    fn blocks_and_single_rows_agree() {
        let mut single = Triangle::<f64, 3>::new();
        let mut block = Triangle::<f64, 3>::new();
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
            block.push_block(&mut columns, &mut observations);
        }
        let (a, b) = (single.solve(3).unwrap(), block.solve(3).unwrap());
        for j in 0..3 {
            assert!((a[j] - b[j]).abs() < 1e-13);
        }
        let sum = single.sum_of_squares_at(&a);
        assert!((sum / block.sum_of_squares_at(&b) - 1.0).abs() < 1e-12);
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
}
