//! What the linear model answers: transfer functions, poles, zeros, steady values, time histories.

use faer::c64;
use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;

/// First-order form `ẋ = A x + b δ` with the responses as rows on `x`.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// `A`.
    pub a: DMatrix<f64>,
    /// `b`: per radian of road-wheel steer angle.
    pub b: DVector<f64>,
    /// Roll angle of the trailer's sprung mass, rad.
    pub trailer_roll: DVector<f64>,
    /// Roll angle of the tractor's sprung mass, rad.
    pub tractor_roll: DVector<f64>,
    /// Yaw rate of the trailer, rad/s.
    pub trailer_yaw_rate: DVector<f64>,
    /// Yaw rate of the tractor, rad/s.
    pub tractor_yaw_rate: DVector<f64>,
    /// Yaw angle of the tractor less that of the trailer, rad.
    pub articulation: DVector<f64>,
    /// Lateral velocity of the tractor's sprung c.g., m/s.
    pub tractor_lateral_velocity: DVector<f64>,
    /// Roll angle of each axle, rad, tractor first.
    pub axle_roll: Vec<DVector<f64>>,
    /// Lateral acceleration of the trailer's sprung c.g., m/s².
    pub lateral_acceleration: DVector<f64>,
    /// Its part that follows the steer angle at once, m/s² per rad.
    pub lateral_feedthrough: f64,
}

/// A transfer function in factored and polynomial form.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Coefficients in descending powers of s.
    pub numerator: Vec<f64>,
    /// Coefficients in descending powers of s, the first is one.
    pub denominator: Vec<f64>,
    /// Roots of the denominator, rad/s, `(re, im)`.
    pub poles: Vec<(f64, f64)>,
    /// Roots of the numerator, rad/s, `(re, im)`.
    pub zeros: Vec<(f64, f64)>,
    /// Leading coefficient of the numerator.
    pub gain: f64,
    /// Value at s = 0.
    pub dc_gain: f64,
}

fn eigen_error<E: std::fmt::Debug>(error: E) -> VehicleError {
    VehicleError::Model(format!("the eigenvalues of the model do not converge ({error:?})"))
}

/// Largest real part first.
fn sorted(values: impl Iterator<Item = c64>) -> Vec<(f64, f64)> {
    let mut pairs: Vec<(f64, f64)> = values.map(|value| (value.re, value.im)).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    pairs
}

/// Polynomial with these roots and leading coefficient, descending powers.
fn polynomial(roots: &[(f64, f64)], leading: f64) -> Vec<f64> {
    let mut coefficients = vec![c64::new(leading, 0.0)];
    for &(re, im) in roots {
        let root = c64::new(re, im);
        coefficients.push(c64::new(0.0, 0.0));
        for k in (1..coefficients.len()).rev() {
            let lower = coefficients[k - 1];
            coefficients[k] -= root * lower;
        }
    }
    coefficients.into_iter().map(|c| c.re).collect()
}

impl StateSpace {
    /// The poles, rad/s, `(re, im)`.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn poles(&self) -> Result<Vec<(f64, f64)>, VehicleError> {
        let n = self.a.nrows();
        let a = faer::Mat::from_fn(n, n, |i, j| self.a[(i, j)]);
        Ok(sorted(a.eigenvalues().map_err(eigen_error)?.into_iter()))
    }

    /// The steady value of a response per radian of steer.
    ///
    /// # Errors
    /// If the model has a pole at zero.
    pub fn steady(&self, row: &DVector<f64>, feedthrough: f64) -> Result<f64, VehicleError> {
        let state = self.a.clone().lu().solve(&self.b).ok_or_else(|| {
            VehicleError::Model("the model has a pole at zero: no steady turn".to_owned())
        })?;
        Ok(feedthrough - row.dot(&state))
    }

    /// The transfer function from steer to a response.
    ///
    /// Poles are eigenvalues, zeros generalised eigenvalues; expanding the determinant of the
    /// source's `D(s)` instead would lose all digits in double precision.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn transfer_function(
        &self,
        row: &DVector<f64>,
        feedthrough: f64,
    ) -> Result<TransferFunction, VehicleError> {
        let n = self.a.nrows();
        let poles = self.poles()?;
        // det ┌ A − λI  b ┐ = 0
        //     └   c     d ┘
        // Rows and columns of input and output are scaled to the size of A: zeros do not change.
        let size = self.a.norm();
        let (input, output) = (size / self.b.norm(), size / row.norm());
        let pencil = faer::Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => self.a[(i, j)],
            (true, false) => self.b[i] * input,
            (false, true) => row[j] * output,
            (false, false) => feedthrough * input * output,
        });
        let identity =
            faer::Mat::from_fn(n + 1, n + 1, |i, j| if i == j && i < n { 1.0 } else { 0.0 });
        let eigen = pencil.generalized_eigen(&identity).map_err(eigen_error)?;
        let (alpha, beta) = (eigen.S_a(), eigen.S_b());
        let fastest = poles.iter().map(|(re, im)| re.hypot(*im)).fold(0.0, f64::max);
        let zeros = sorted(
            alpha
                .column_vector()
                .iter()
                .zip(beta.column_vector().iter())
                .map(|(a, b)| *a / *b)
                // Zeros at infinity come out as ∞ or, perturbed, as ε^(−1/k) ≥ 1e5 of the size.
                .filter(|z| z.re.hypot(z.im) < 1e3 * fastest),
        );
        // The first non-vanishing Markov parameter d, cb, cAb … is the leading coefficient.
        let mut markov = self.b.clone();
        let gain = match n - zeros.len().min(n) {
            0 => feedthrough,
            excess => {
                for _ in 1..excess {
                    markov = &self.a * markov;
                }
                row.dot(&markov)
            }
        };
        Ok(TransferFunction {
            numerator: polynomial(&zeros, gain),
            denominator: polynomial(&poles, 1.0),
            poles,
            zeros,
            gain,
            dc_gain: self.steady(row, feedthrough)?,
        })
    }

    /// The Taylor coefficients at s = 0 of the transfer function to a response.
    ///
    /// # Errors
    /// If the model has a pole at zero.
    pub fn moments(
        &self,
        row: &DVector<f64>,
        feedthrough: f64,
        count: usize,
    ) -> Result<Vec<f64>, VehicleError> {
        let lu = self.a.clone().lu();
        let mut state = self.b.clone();
        let mut moments = Vec::with_capacity(count);
        for k in 0..count {
            state = lu.solve(&state).ok_or_else(|| {
                VehicleError::Model("the model has a pole at zero: no steady turn".to_owned())
            })?;
            moments.push(if k == 0 { feedthrough } else { 0.0 } - row.dot(&state));
        }
        Ok(moments)
    }

    /// A simulation from rest, exact for steer angles that are straight lines between samples.
    pub fn simulation(&self, interval_s: f64) -> Simulation {
        let n = self.a.nrows();
        let mut m = DMatrix::zeros(n + 2, n + 2);
        m.view_mut((0, 0), (n, n)).copy_from(&(&self.a * interval_s));
        m.view_mut((0, n), (n, 1)).copy_from(&(&self.b * interval_s));
        m[(n, n + 1)] = 1.0;
        let exponential = m.exp();
        Simulation {
            transition: exponential.view((0, 0), (n, n)).into_owned(),
            held: exponential.view((0, n), (n, 1)).column(0).into_owned(),
            ramp: exponential.view((0, n + 1), (n, 1)).column(0).into_owned(),
            state: DVector::zeros(n),
            steer_rad: 0.0,
        }
    }
}

/// The linear model sample by sample.
#[derive(Clone, Debug)]
pub struct Simulation {
    transition: DMatrix<f64>,
    held: DVector<f64>,
    ramp: DVector<f64>,
    /// The state of the model now.
    pub state: DVector<f64>,
    steer_rad: f64,
}

impl Simulation {
    /// Advances one interval, to the steer angle `steer_rad`.
    pub fn push(&mut self, steer_rad: f64) {
        self.state = &self.transition * &self.state
            + &self.held * self.steer_rad
            + &self.ramp * (steer_rad - self.steer_rad);
        self.steer_rad = steer_rad;
    }
}
