//! Eigenvalues and exponential of a matrix, with the same bits on every computer.
//!
//! Like `libm` for functions of a number, this uses only operations whose rounding IEEE 754 prescribes, in an order that
//! does not depend on the processor. (faer, and matrixmultiply below nalgebra with its feature `std`, choose by the
//! processor how they sum and whether they round between product and sum.)

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, Schur};

use crate::error::VehicleError;

/// QR steps for each row; usually two or three are enough.
const STEPS: usize = 100;

/// Greatest size of an element. The squares of greater ones are infinite, and balancing would go on for ever.
const GREATEST: f64 = 1e150;

/// The eigenvalues `(re, im)`, the largest real part first.
///
/// # Errors
/// If they do not converge, or an element is not finite or is greater than 1e150.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<(f64, f64)>, VehicleError> {
    let diverged =
        || VehicleError::Model("the eigenvalues of the model do not converge".to_owned());
    let n = matrix.nrows();
    if n == 0 {
        return Ok(Vec::new());
    }
    if !matrix.iter().all(|value| value.abs() <= GREATEST) {
        return Err(diverged());
    }
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let schur = Schur::try_new(balanced, f64::EPSILON, STEPS * n).ok_or_else(diverged)?;
    let (_, t) = schur.unpack();
    let mut values = Vec::with_capacity(n);
    let mut k = 0;
    while k < n {
        if k + 1 == n || t[(k + 1, k)] == 0.0 {
            values.push((t[(k, k)], 0.0));
            k += 1;
            continue;
        }
        // A block of two rows has a complex pair, or by rounding two real values that are almost equal.
        let (middle, half) =
            (f64::midpoint(t[(k, k)], t[(k + 1, k + 1)]), 0.5 * (t[(k, k)] - t[(k + 1, k + 1)]));
        let square = half * half + t[(k, k + 1)] * t[(k + 1, k)];
        let apart = square.abs().sqrt();
        let (re, im) = if square < 0.0 { (0.0, apart) } else { (apart, 0.0) };
        values.extend([(middle - re, -im), (middle + re, im)]);
        k += 2;
    }
    by_real_part(&mut values);
    Ok(values)
}

/// Sorts roots, the largest real part first.
pub(crate) fn by_real_part(roots: &mut [(f64, f64)]) {
    roots.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
}

/// The exponential of a matrix: the Taylor series of the matrix divided by a power of two, squared as often.
#[must_use]
pub fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    /// The remainder of a matrix of norm 1/2 is 0.5¹⁷/17! = 2e-20.
    const TERMS: u32 = 16;
    let n = matrix.nrows();
    let mut norm = matrix.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    let mut scaled = matrix.clone();
    let mut squarings = 0;
    while norm > 0.5 && norm.is_finite() {
        norm *= 0.5;
        scaled *= 0.5;
        squarings += 1;
    }
    // Horner's scheme: 1 + X (1 + X/2 (1 + X/3 (…))).
    let mut sum = DMatrix::identity(n, n);
    for k in (1..=TERMS).rev() {
        sum = DMatrix::identity(n, n) + &scaled * sum / f64::from(k);
    }
    for _ in 0..squarings {
        sum = &sum * &sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    /// A matrix with this block diagonal in the axes of a matrix that is well conditioned.
    #[allow(clippy::cast_precision_loss)] // small indices
    fn similar(diagonal: &DMatrix<f64>) -> DMatrix<f64> {
        let n = diagonal.nrows();
        let axes =
            DMatrix::from_fn(
                n,
                n,
                |i, j| {
                    if i == j { 2.0 } else { 1.0 / (1.0 + (3 * i + 5 * j) as f64) }
                },
            );
        &axes * diagonal * axes.clone().try_inverse().unwrap()
    }

    #[test]
    fn eigenvalues_are_those_of_the_blocks() {
        // −1 ± 5i, −2 twice, −300, 0.5
        let mut blocks = DMatrix::from_diagonal(&DVector::from_row_slice(&[
            -1.0, -1.0, -2.0, -2.0, -300.0, 0.5,
        ]));
        blocks[(0, 1)] = 25.0;
        blocks[(1, 0)] = -1.0;
        let found = eigenvalues(&similar(&blocks)).unwrap();
        let expected =
            [(0.5, 0.0), (-1.0, -5.0), (-1.0, 5.0), (-2.0, 0.0), (-2.0, 0.0), (-300.0, 0.0)];
        // Backward stable: ε times the size of the matrix and the condition of the axes, which is below 10.
        for (found, expected) in found.iter().zip(expected) {
            assert!((found.0 - expected.0).abs() < 1e-12 * 300.0, "{found:?} {expected:?}");
            assert!((found.1 - expected.1).abs() < 1e-12 * 300.0, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn what_has_no_eigenvalues_is_an_error_and_not_an_endless_loop() {
        for bad in [f64::NAN, f64::INFINITY, 1e200, -1e300] {
            let mut matrix = DMatrix::identity(4, 4);
            matrix[(1, 2)] = bad;
            assert!(eigenvalues(&matrix).is_err());
        }
        // Squares that are almost zero or almost infinite.
        for size in [1e-150, 1e149] {
            let matrix = DMatrix::from_row_slice(2, 2, &[0.0, size, -size, 0.0]);
            let found = eigenvalues(&matrix).unwrap();
            // A few roundings.
            assert!((found[1].1 / size - 1.0).abs() < 8.0 * f64::EPSILON, "{found:?}");
        }
        assert_eq!(eigenvalues(&DMatrix::zeros(0, 0)).unwrap(), []);
        assert_eq!(eigenvalues(&DMatrix::zeros(3, 3)).unwrap(), [(0.0, 0.0); 3]);
    }

    #[test]
    fn the_exponential_turns_and_decays() {
        // exp of −a ± iω is e^(−a) times a turn by ω; the greatest norm here is 40.
        for (a, omega) in [(0.01, 0.3_f64), (3.0, 20.0), (0.0, 0.0)] {
            let block = DMatrix::from_row_slice(2, 2, &[-a, omega, -omega, -a]);
            let expected = DMatrix::from_row_slice(
                2,
                2,
                &[omega.cos(), omega.sin(), -omega.sin(), omega.cos()],
            ) * (-a).exp();
            let found = exponential(&similar(&block));
            // Each squaring doubles the relative error; there are at most seven.
            assert!(
                (found - similar(&expected)).norm() < 128.0 * 10.0 * f64::EPSILON,
                "{a} {omega}"
            );
        }
    }
}
