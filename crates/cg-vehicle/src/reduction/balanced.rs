//! Balanced truncation: keeps the states that are both easily reachable and easily observable.
//!
//! With the Gramians `P` (reachability) and `Q` (observability),
//!
//! ```text
//!     A P + P Aᵀ + b bᵀ = 0,     Aᵀ Q + Q A + c cᵀ = 0
//! ```
//!
//! the square roots of the eigenvalues of `P Q` (Hankel singular values σ) are the contributions of
//! the balanced states. The reduced model of order r is stable, and its error is below
//! `2 (σ_(r+1) + … + σ_n)` at every frequency. With [`Keep::SteadyState`] the other states are set
//! to their steady state instead of being deleted. The error has the same bound, and the DC gain,
//! on which the height depends, is exact.
//!
//! **Reference.** Moore, IEEE Trans. Autom. Control 26 (1981); Liu and Anderson, *Singular perturbation
//! approximation of balanced systems*, Int. J. Control 50 (1989); Antoulas, *Approximation of
//! Large-Scale Dynamical Systems*, §7.1.

use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::system::System;

/// The property of the full model that a reduced model has exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Keep {
    /// The instantaneous response (truncation).
    HighFrequency,
    /// The steady-state value (residualization).
    SteadyState,
}

/// Reduces a stable system to `order` states; also returns the Hankel singular values.
///
/// # Errors
/// [`VehicleError::Model`] if the system is unstable or has no more than `order` states.
pub fn balanced(
    system: &System,
    order: usize,
    keep: Keep,
) -> Result<(System, Vec<f64>), VehicleError> {
    if order >= system.order() {
        return Err(VehicleError::Model(format!(
            "a model of order {} cannot be reduced to order {order}",
            system.order()
        )));
    }
    if !system.is_stable()? {
        return Err(VehicleError::Model("an unstable model cannot be balanced".to_owned()));
    }
    let reach = root(&lyapunov(&system.a, &system.b)?);
    let see = root(&lyapunov(&system.a.transpose(), &system.c)?);
    let svd = (see.transpose() * &reach).svd(true, true);
    let (Some(left), Some(right)) = (svd.u, svd.v_t) else {
        return Err(VehicleError::Model("the Gramians cannot be balanced".to_owned()));
    };
    let sigma: Vec<f64> = svd.singular_values.iter().copied().collect();
    // States without any contribution cannot be scaled to equal size, so they are deleted first.
    let kept = sigma.iter().take_while(|&&s| s > sigma[0] * f64::EPSILON).count();
    if kept < order {
        return Err(VehicleError::Model(format!("the model has only {kept} effective states")));
    }
    let scale = DVector::from_fn(kept, |i, _| 1.0 / sigma[i].sqrt());
    let scale = DMatrix::from_diagonal(&scale);
    let onto = &reach * right.rows(0, kept).transpose() * &scale;
    let from = &scale * left.columns(0, kept).transpose() * see.transpose();
    let whole = System {
        a: &from * &system.a * &onto,
        b: &from * &system.b,
        c: onto.transpose() * &system.c,
        d: system.d,
    };
    let reduced = match keep {
        Keep::HighFrequency => truncated(&whole, order),
        Keep::SteadyState => residualised(&whole, order)?,
    };
    Ok((reduced, sigma))
}

fn truncated(whole: &System, order: usize) -> System {
    System {
        a: whole.a.view((0, 0), (order, order)).into_owned(),
        b: whole.b.rows(0, order).into_owned(),
        c: whole.c.rows(0, order).into_owned(),
        d: whole.d,
    }
}

/// Sets the fast states to their steady state: `x2 = −A22⁻¹ (A21 x1 + b2 u)`.
fn residualised(whole: &System, order: usize) -> Result<System, VehicleError> {
    let rest = whole.order() - order;
    if rest == 0 {
        return Ok(whole.clone());
    }
    let fast = whole.a.view((order, order), (rest, rest)).into_owned().lu();
    let singular = || VehicleError::Model("the fast states have no steady state".to_owned());
    let a21 = whole.a.view((order, 0), (rest, order)).into_owned();
    let settled_state = fast.solve(&a21).ok_or_else(singular)?;
    let settled_input = fast.solve(&whole.b.rows(order, rest).into_owned()).ok_or_else(singular)?;
    let a12 = whole.a.view((0, order), (order, rest));
    let c2 = whole.c.rows(order, rest);
    Ok(System {
        a: whole.a.view((0, 0), (order, order)) - a12 * &settled_state,
        b: whole.b.rows(0, order) - a12 * &settled_input,
        c: whole.c.rows(0, order) - settled_state.transpose() * c2,
        d: whole.d - c2.dot(&settled_input),
    })
}

/// Solves `A X + X Aᵀ + b bᵀ = 0` as one linear system in the n² entries of `X`.
fn lyapunov(a: &DMatrix<f64>, b: &DVector<f64>) -> Result<DMatrix<f64>, VehicleError> {
    let n = a.nrows();
    let eye = DMatrix::identity(n, n);
    let operator = eye.kronecker(a) + a.kronecker(&eye);
    let input = b * b.transpose();
    let rhs = DVector::from_column_slice((-input).as_slice());
    let x = operator
        .lu()
        .solve(&rhs)
        .ok_or_else(|| VehicleError::Model("the Lyapunov equation is singular".to_owned()))?;
    let x = DMatrix::from_column_slice(n, n, x.as_slice());
    Ok(0.5 * (&x + x.transpose()))
}

/// `L` with `L Lᵀ = X` for a symmetric, positive semidefinite matrix. Small eigenvalues can be
/// negative due to rounding and are set to zero.
fn root(x: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = x.clone().symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduction::quality::h_infinity;
    use crate::system::Rational;

    /// (s + 0.5) / ((s + 1)(s + 3)(s + 40))
    fn system() -> System {
        Rational { numerator: vec![0.5, 1.0], denominator: vec![120.0, 163.0, 44.0, 1.0] }.system()
    }

    #[test]
    fn the_error_stays_below_twice_the_sum_of_what_is_left_out() {
        for keep in [Keep::HighFrequency, Keep::SteadyState] {
            for order in [1, 2] {
                let (reduced, sigma) = balanced(&system(), order, keep).unwrap();
                let bound = 2.0 * sigma[order..].iter().sum::<f64>();
                let error = h_infinity(&system().minus(&reduced)).unwrap();
                assert!(error <= bound * (1.0 + 1e-9), "{keep:?} {order}: {error} {bound}");
                assert!(reduced.is_stable().unwrap());
            }
        }
    }

    #[test]
    fn residualisation_keeps_the_steady_value() {
        let (reduced, _) = balanced(&system(), 1, Keep::SteadyState).unwrap();
        let steady = |system: &System| system.moments(1).unwrap()[0];
        assert!((steady(&reduced) / steady(&system()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_unstable_model_is_refused() {
        let unstable =
            Rational { numerator: vec![1.0], denominator: vec![-1.0, 1.0, 1.0] }.system();
        assert!(balanced(&unstable, 1, Keep::SteadyState).is_err());
        assert!(balanced(&system(), 3, Keep::SteadyState).is_err());
    }
}
