//! Eigenvalues and eigenvectors of real matrices.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, Schur};

use crate::error::VehicleError;

/// The QR algorithm needs two or three iterations per eigenvalue.
const ITERATIONS_PER_STATE: usize = 100;

fn diverged() -> VehicleError {
    VehicleError::Model("the eigenvalues of the model do not converge".to_owned())
}

/// The eigenvalues of a square matrix, those of a pair one after the other.
///
/// The matrix is balanced first: states in units of their own (radians, meters per second) would cost
/// digits otherwise.
///
/// # Errors
/// If they do not converge.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, VehicleError> {
    let mut balanced = matrix.clone();
    if !balanced.iter().all(|value| value.is_finite()) {
        return Err(diverged());
    }
    balance_parlett_reinsch(&mut balanced);
    let most = ITERATIONS_PER_STATE * matrix.nrows().max(1);
    let schur = Schur::try_new(balanced, f64::EPSILON, most).ok_or_else(diverged)?;
    Ok(schur.complex_eigenvalues().iter().copied().collect())
}

/// An eigenvalue, and for every state its participation in the eigenvector's motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Participation {
    /// The eigenvalue.
    pub value: Complex<f64>,
    /// `v_k w_k / (wᵀ v)` of the right and left eigenvectors `v` and `w` (Pérez-Arriaga, Verghese and
    /// Schweppe, IEEE Trans. PAS 101, 1982); they do not depend on the units and add up to one.
    pub factors: DVector<Complex<f64>>,
}

/// The eigenvalues of a square matrix with the participation of the states.
///
/// # Errors
/// If they do not converge, or the matrix has a multiple eigenvalue with one eigenvector.
pub fn participation(matrix: &DMatrix<f64>) -> Result<Vec<Participation>, VehicleError> {
    let n = matrix.nrows();
    let size = matrix.norm();
    eigenvalues(matrix)?
        .into_iter()
        .map(|value| {
            let shifted = DMatrix::from_fn(n, n, |i, j| {
                let diagonal = if i == j { value } else { Complex::new(0.0, 0.0) };
                Complex::new(matrix[(i, j)], 0.0) - diagonal
            });
            let right = null_vector(&shifted, size).ok_or_else(diverged)?;
            let left = null_vector(&shifted.transpose(), size).ok_or_else(diverged)?;
            let factors = right.component_mul(&left);
            let sum = factors.sum();
            let factors = factors.map(|factor| factor / sum);
            let finite = factors.iter().all(|factor| factor.norm().is_finite());
            finite.then_some(Participation { value, factors }).ok_or_else(diverged)
        })
        .collect()
}

/// The vector that a matrix with an eigenvalue near zero maps to nearly nothing, by inverse iteration.
/// Two steps from any start are enough, because the eigenvalue is known to its last digits.
fn null_vector(matrix: &DMatrix<Complex<f64>>, size: f64) -> Option<DVector<Complex<f64>>> {
    let n = matrix.nrows();
    let mut moved = matrix.clone();
    // An exact eigenvalue gives a pivot of zero.
    for k in 0..n {
        moved[(k, k)] += Complex::new(size * f64::EPSILON, 0.0);
    }
    let lu = moved.lu();
    let mut vector = DVector::from_fn(n, |k, _| Complex::new(1.0, 1.0 / (k + 1) as f64));
    for _ in 0..3 {
        vector = lu.solve(&vector)?;
        vector.unscale_mut(vector.norm());
    }
    Some(vector)
}
