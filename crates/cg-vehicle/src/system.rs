//! Linear systems with one input and one output.

use nalgebra::{Complex, DMatrix, DVector};

use crate::error::VehicleError;
use crate::matrix::{by_real_part, eigenvalues, exponential};

/// A transfer function in factored and polynomial form.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Coefficients in descending powers of s.
    pub numerator: Vec<f64>,
    /// Coefficients in descending powers of s; the first is one.
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

/// The state-space system `ẋ = A x + b u`, `y = c x + d u`.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// `A`.
    pub a: DMatrix<f64>,
    /// `b`.
    pub b: DVector<f64>,
    /// `c`, as a column.
    pub c: DVector<f64>,
    /// `d`.
    pub d: f64,
}

/// A rational function in ascending powers of s, with `denominator[n] = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational {
    /// Numerator coefficients, ascending.
    pub numerator: Vec<f64>,
    /// Denominator coefficients, ascending; the last is one.
    pub denominator: Vec<f64>,
}

impl Rational {
    /// Value at s = 0.
    pub fn dc_gain(&self) -> f64 {
        self.numerator[0] / self.denominator[0]
    }

    /// The state-space system in companion form. The numerator may have the same degree as the
    /// denominator.
    pub fn system(&self) -> System {
        let n = self.denominator.len() - 1;
        let at = |k: usize| self.numerator.get(k).copied().unwrap_or(0.0);
        let d = at(n);
        let mut a = DMatrix::zeros(n, n);
        for i in 0..n {
            if i + 1 < n {
                a[(i, i + 1)] = 1.0;
            }
            a[(n - 1, i)] = -self.denominator[i];
        }
        let mut b = DVector::zeros(n);
        if n > 0 {
            b[n - 1] = 1.0;
        }
        let c = DVector::from_fn(n, |i, _| at(i) - d * self.denominator[i]);
        System { a, b, c, d }
    }
}

fn pole_at_zero() -> VehicleError {
    VehicleError::Model("the model has a pole at zero: no steady turn".to_owned())
}

/// The polynomial with these roots and this leading coefficient, in descending powers.
pub(crate) fn polynomial(roots: &[(f64, f64)], leading: f64) -> Vec<f64> {
    let mut coefficients = vec![Complex::new(leading, 0.0)];
    for &(re, im) in roots {
        let root = Complex::new(re, im);
        coefficients.push(Complex::new(0.0, 0.0));
        for k in (1..coefficients.len()).rev() {
            let lower = coefficients[k - 1];
            coefficients[k] -= root * lower;
        }
    }
    coefficients.into_iter().map(|c| c.re).collect()
}

/// The product of two polynomials in ascending powers.
pub fn multiplied(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; (a.len() + b.len()).saturating_sub(1)];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The numerator for which the quotient with `denominator` has the first terms of `series`.
pub(crate) fn matched_numerator(denominator: &[f64], series: &[f64]) -> Vec<f64> {
    (0..denominator.len()).map(|k| (0..=k).map(|j| denominator[j] * series[k - j]).sum()).collect()
}

/// The steady oscillations of `ẋ = A x + b u`. With `A = Q H Qᵀ`, where `H` is zero below the diagonal next to the main one, a
/// frequency costs `n²` and not `n³` operations.
pub(crate) struct Oscillations {
    to_states: DMatrix<f64>,
    hessenberg: DMatrix<f64>,
    input: DVector<f64>,
}

impl Oscillations {
    pub(crate) fn of(a: &DMatrix<f64>, b: &DVector<f64>) -> Self {
        let (to_states, hessenberg) = if a.nrows() > 1 {
            a.clone().hessenberg().unpack()
        } else {
            (DMatrix::identity(a.nrows(), a.nrows()), a.clone())
        };
        Self { input: to_states.tr_mul(b), to_states, hessenberg }
    }

    /// The state `(iω − A)⁻¹ b` at an angular frequency, per unit of input.
    ///
    /// # Errors
    /// If there is a pole at this frequency.
    pub(crate) fn state_at(&self, omega_radps: f64) -> Result<DVector<Complex<f64>>, VehicleError> {
        let n = self.input.len();
        // The rows of `iω − H` with the right-hand side.
        let mut rows: Vec<Vec<Complex<f64>>> = (0..n)
            .map(|i| {
                let entry = |j: usize| Complex::new(-self.hessenberg[(i, j)], 0.0);
                (0..n).map(entry).chain([Complex::new(self.input[i], 0.0)]).collect()
            })
            .collect();
        for (i, row) in rows.iter_mut().enumerate() {
            row[i].im = omega_radps;
        }
        for k in 1..n {
            let [upper, lower] = &mut rows[k - 1..=k] else { continue };
            if lower[k - 1].norm_sqr() > upper[k - 1].norm_sqr() {
                std::mem::swap(upper, lower);
            }
            let factor = lower[k - 1] / upper[k - 1];
            for (below, above) in lower[k..].iter_mut().zip(&upper[k..]) {
                *below -= factor * above;
            }
        }
        let mut found = DVector::from_element(n, Complex::new(0.0, 0.0));
        for (k, row) in rows.iter().enumerate().rev() {
            let known: Complex<f64> = (k + 1..n).map(|j| row[j] * found[j]).sum();
            found[k] = (row[n] - known) / row[k];
        }
        if !found.iter().all(|x| x.re.is_finite() && x.im.is_finite()) {
            return Err(pole_at_zero());
        }
        let part = |of: fn(&Complex<f64>) -> f64| &self.to_states * found.map(|x| of(&x));
        Ok(part(|x| x.re).zip_map(&part(|x| x.im), Complex::new))
    }
}

/// The response `c x + d` to a unit of input.
pub(crate) fn response_of(state: &DVector<Complex<f64>>, c: &DVector<f64>, d: f64) -> Complex<f64> {
    state.iter().zip(c.iter()).map(|(x, c)| x * *c).sum::<Complex<f64>>() + d
}

impl System {
    /// Number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// The poles, rad/s, `(re, im)`.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn poles(&self) -> Result<Vec<(f64, f64)>, VehicleError> {
        eigenvalues(&self.a)
    }

    /// Whether all poles are in the left half plane.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn is_stable(&self) -> Result<bool, VehicleError> {
        Ok(self.poles()?.iter().all(|pole| pole.0 < 0.0))
    }

    /// The first `count` Taylor coefficients of the transfer function at s = 0.
    ///
    /// # Errors
    /// If the model has a pole at zero.
    pub fn moments(&self, count: usize) -> Result<Vec<f64>, VehicleError> {
        if self.order() == 0 {
            return Ok((0..count).map(|k| if k == 0 { self.d } else { 0.0 }).collect());
        }
        let lu = self.a.clone().lu();
        let mut state = self.b.clone();
        let mut moments = Vec::with_capacity(count);
        for k in 0..count {
            state = lu.solve(&state).ok_or_else(pole_at_zero)?;
            moments.push(if k == 0 { self.d } else { 0.0 } - self.c.dot(&state));
        }
        Ok(moments)
    }

    /// This system and another one in series.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let (n, m) = (self.order(), next.order());
        let mut a = DMatrix::zeros(n + m, n + m);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, n), (m, m)).copy_from(&next.a);
        a.view_mut((n, 0), (m, n)).copy_from(&(&next.b * self.c.transpose()));
        let mut b = DVector::zeros(n + m);
        b.rows_mut(0, n).copy_from(&self.b);
        b.rows_mut(n, m).copy_from(&(&next.b * self.d));
        let mut c = DVector::zeros(n + m);
        c.rows_mut(0, n).copy_from(&(&self.c * next.d));
        c.rows_mut(n, m).copy_from(&next.c);
        Self { a, b, c, d: next.d * self.d }
    }

    /// The difference between this system and another one with the same input.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let (n, m) = (self.order(), other.order());
        let mut a = DMatrix::zeros(n + m, n + m);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, n), (m, m)).copy_from(&other.a);
        let mut b = DVector::zeros(n + m);
        b.rows_mut(0, n).copy_from(&self.b);
        b.rows_mut(n, m).copy_from(&other.b);
        let mut c = DVector::zeros(n + m);
        c.rows_mut(0, n).copy_from(&self.c);
        c.rows_mut(n, m).copy_from(&-&other.c);
        Self { a, b, c, d: self.d - other.d }
    }

    /// The magnitude `|G(iω)|` at an angular frequency.
    ///
    /// # Errors
    /// If there is a pole at this frequency.
    pub fn magnitude(&self, omega_radps: f64) -> Result<f64, VehicleError> {
        if self.order() == 0 {
            return Ok(self.d.abs());
        }
        self.magnitude_of(&Oscillations::of(&self.a, &self.b), omega_radps)
    }

    /// The [magnitude](Self::magnitude) from the oscillations of this system, for many frequencies.
    pub(crate) fn magnitude_of(
        &self,
        oscillations: &Oscillations,
        omega_radps: f64,
    ) -> Result<f64, VehicleError> {
        let response = response_of(&oscillations.state_at(omega_radps)?, &self.c, self.d);
        Ok(libm::hypot(response.re, response.im))
    }

    /// The transfer function.
    ///
    /// The poles are eigenvalues and the zeros generalized eigenvalues. The alternative, expanding
    /// the determinant of the thesis's `D(s)`, loses all digits in double precision.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn transfer_function(&self) -> Result<TransferFunction, VehicleError> {
        let n = self.order();
        let poles = self.poles()?;
        let zeros = self.zeros(&poles)?;
        // The leading coefficient is the first nonzero Markov parameter d, cb, cAb …
        let mut markov = self.b.clone();
        let gain = match n - zeros.len().min(n) {
            0 => self.d,
            excess => {
                for _ in 1..excess {
                    markov = &self.a * markov;
                }
                self.c.dot(&markov)
            }
        };
        Ok(TransferFunction {
            numerator: polynomial(&zeros, gain),
            denominator: polynomial(&poles, 1.0),
            poles,
            zeros,
            gain,
            dc_gain: self.moments(1)?[0],
        })
    }

    /// The roots of the numerator, rad/s: where `det P(s) = 0`.
    ///
    /// ```text
    ///            ┌ A − sI  b ┐
    ///     P(s) = └   c     d ┘
    /// ```
    ///
    /// With `E = diag(I, 0)`, `P(s) = P(σ) − (s − σ) E` is singular where `1/(s − σ)` is an eigenvalue of `P(σ)⁻¹ E`. Its
    /// rounding changes a root by `ε |s − σ|²/σ`, which is little if `σ` is as large as the fastest root.
    fn zeros(&self, poles: &[(f64, f64)]) -> Result<Vec<(f64, f64)>, VehicleError> {
        let n = self.order();
        // The row and column of input and output are scaled to the size of A, which does not change the zeros.
        let size = self.a.norm();
        let (input, output) = (size / self.b.norm(), size / self.c.norm());
        let fastest = poles.iter().map(|(re, im)| libm::hypot(*re, *im)).fold(0.0, f64::max);
        // A zero of a truck is in this place only by accident.
        let shift = 1.234 * fastest;
        let pencil = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => self.a[(i, j)] - if i == j { shift } else { 0.0 },
            (true, false) => self.b[i] * input,
            (false, true) => self.c[j] * output,
            (false, false) => self.d * input * output,
        });
        let inverse = pencil.lu().solve(&DMatrix::identity(n + 1, n)).ok_or_else(|| {
            VehicleError::Model("the response has no transfer function: it is zero".to_owned())
        })?;
        // Zeros at infinity are found as ∞ or, because of rounding, as ε^(−1/k) ≥ 1e5 times the size.
        let near = |(re, im): &(f64, f64)| libm::hypot(*re, *im) < 1e3 * fastest;
        let mut zeros: Vec<(f64, f64)> = eigenvalues(&inverse.rows(0, n).into_owned())?
            .into_iter()
            .map(|(re, im)| {
                let square = re * re + im * im;
                (shift + re / square, -im / square)
            })
            .filter(near)
            .collect();
        by_real_part(&mut zeros);
        Ok(zeros)
    }

    /// The transfer function as a rational function. It is meant for reduced models: at high orders
    /// the range of its coefficients exceeds double precision.
    ///
    /// # Errors
    /// If the eigenvalues do not converge.
    pub fn rational(&self) -> Result<Rational, VehicleError> {
        let mut denominator = polynomial(&self.poles()?, 1.0);
        denominator.reverse();
        // The numerator follows from the moments: N = D (t0 + t1 s + …), up to the degree of D.
        let series = self.moments(denominator.len())?;
        Ok(Rational { numerator: matched_numerator(&denominator, &series), denominator })
    }

    /// The response from rest to an input that is linear between samples, `interval_s` apart. The
    /// input is zero before the first sample and jumps to it.
    pub fn response(&self, input: &[f64], interval_s: f64) -> Vec<f64> {
        let mut simulation = Simulation::new(&self.a, &self.b, interval_s);
        let mut output = Vec::with_capacity(input.len());
        for (k, &u) in input.iter().enumerate() {
            if k == 0 {
                simulation.start(u);
            } else {
                simulation.push(u);
            }
            output.push(self.c.dot(&simulation.state) + self.d * u);
        }
        output
    }
}

/// Simulation of a linear model sample by sample, starting from rest. It is exact for an input that
/// is linear between samples.
#[derive(Clone, Debug)]
pub struct Simulation {
    transition: DMatrix<f64>,
    held: DVector<f64>,
    ramp: DVector<f64>,
    /// The present state of the model.
    pub state: DVector<f64>,
    /// Room for the next one.
    next: DVector<f64>,
    input: f64,
}

impl Simulation {
    /// A simulation of `ẋ = A x + b u` with a fixed interval.
    pub fn new(a: &DMatrix<f64>, b: &DVector<f64>, interval_s: f64) -> Self {
        let n = a.nrows();
        let mut m = DMatrix::zeros(n + 2, n + 2);
        m.view_mut((0, 0), (n, n)).copy_from(&(a * interval_s));
        m.view_mut((0, n), (n, 1)).copy_from(&(b * interval_s));
        m[(n, n + 1)] = 1.0;
        let exponential = exponential(&m);
        Self {
            transition: exponential.view((0, 0), (n, n)).into_owned(),
            held: exponential.view((0, n), (n, 1)).column(0).into_owned(),
            ramp: exponential.view((0, n + 1), (n, 1)).column(0).into_owned(),
            state: DVector::zeros(n),
            next: DVector::zeros(n),
            input: 0.0,
        }
    }

    /// Continues with the equations of another model that has the same states.
    pub fn continue_as(&mut self, next: &Self) {
        self.transition.copy_from(&next.transition);
        self.held.copy_from(&next.held);
        self.ramp.copy_from(&next.ramp);
    }

    /// Sets the input at the first sample.
    pub fn start(&mut self, input: f64) {
        self.input = input;
    }

    /// Advances one interval, at the end of which the input is `input`.
    pub fn push(&mut self, input: f64) {
        self.next.gemv(1.0, &self.transition, &self.state, 0.0);
        self.next.axpy(self.input, &self.held, 1.0);
        self.next.axpy(input - self.input, &self.ramp, 1.0);
        std::mem::swap(&mut self.state, &mut self.next);
        self.input = input;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lag(gain: f64, pole: f64) -> System {
        Rational { numerator: vec![gain * pole], denominator: vec![pole, 1.0] }.system()
    }

    #[test]
    fn a_chain_multiplies_and_a_difference_subtracts() {
        let (a, b) = (
            lag(2.0, 1.0),
            Rational { numerator: vec![3.0, 1.0], denominator: vec![4.0, 1.0] }.system(),
        );
        for omega in [0.0, 0.7, 5.0] {
            let product = a.magnitude(omega).unwrap() * b.magnitude(omega).unwrap();
            assert!((a.then(&b).magnitude(omega).unwrap() - product).abs() < 1e-14);
        }
        assert!((a.minus(&b).moments(1).unwrap()[0] - (2.0 - 0.75)).abs() < 1e-14);
        assert!(a.minus(&a).magnitude(1.0).unwrap() < 1e-15);
    }

    /// The state solves its equations, `iω x = A x + b`, up to rounding. The first column begins with a zero, so that rows change places.
    #[test]
    #[allow(clippy::cast_precision_loss)] // a few rows
    fn an_oscillation_solves_its_equations() {
        let a = DMatrix::from_fn(6, 6, |i, j| {
            let wave = (1.7 * (1 + i * i + 3 * j) as f64).sin();
            if i == j { f64::from(u8::from(i > 0)) * -4.0 } else { 2.0 * wave }
        });
        let b = DVector::from_fn(6, |i, _| 1.0 + i as f64);
        let oscillations = Oscillations::of(&a, &b);
        for omega_radps in [0.0, 0.3, 7.0] {
            let x = oscillations.state_at(omega_radps).unwrap();
            for i in 0..6 {
                let forced: Complex<f64> =
                    (0..6).map(|j| x[j] * a[(i, j)]).sum::<Complex<f64>>() + b[i];
                let residual = x[i] * Complex::new(0.0, omega_radps) - forced;
                assert!(residual.norm_sqr() < 1e-24, "{omega_radps} rad/s, {i}: {residual}");
            }
        }
        let integrator = Oscillations::of(&DMatrix::zeros(1, 1), &DVector::from_element(1, 1.0));
        assert!(integrator.state_at(0.0).is_err());
    }

    #[test]
    fn the_response_to_a_ramp_is_exact() {
        // y = t − τ(1 − e^(−t/τ)) for a lag of τ = 0.5
        let input: Vec<f64> = (0..5).map(|k| 0.2 * f64::from(k)).collect();
        let output = lag(1.0, 2.0).response(&input, 0.2);
        for (t, y) in input.iter().zip(output) {
            assert!((y - (t - 0.5 * (1.0 - (-t / 0.5).exp()))).abs() < 1e-14);
        }
    }
}
