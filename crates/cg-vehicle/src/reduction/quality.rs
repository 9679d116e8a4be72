//! The error of a reduced model compared with the full one.

use crate::error::VehicleError;
use crate::system::{Oscillations, System};

/// Samples per second at which step responses are compared.
const RATE_HZ: f64 = 100.0;
/// Frequencies per decade of the search for the H∞ norm, before refinement.
const PER_DECADE: u32 = 60;

/// The rounded step of unit height (eq. 5.3) at time `t_s` after its start; zero before.
pub fn rounded_step(t_s: f64, rate_per_s: f64) -> f64 {
    if t_s <= 0.0 { 0.0 } else { 2.0 * (libm::exp2(-libm::exp(-rate_per_s * t_s)) - 0.5) }
}

/// The input of the thesis's comparisons: a rounded step (eq. 5.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput {
    /// Amplitude, rad.
    pub amplitude_rad: f64,
    /// Rate `a`, 1/s.
    pub rate_per_s: f64,
    /// Duration, s.
    pub duration_s: f64,
}

impl StepInput {
    /// Interval of [`samples`](Self::samples), s.
    pub const INTERVAL_S: f64 = 1.0 / RATE_HZ;

    /// The samples of the input.
    pub fn samples(&self) -> Vec<f64> {
        // The duration is checked and positive, and gives a few thousand samples.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = (self.duration_s * RATE_HZ).round().max(0.0) as u32 + 1;
        (0..count)
            .map(|k| self.amplitude_rad * rounded_step(f64::from(k) / RATE_HZ, self.rate_per_s))
            .collect()
    }
}

/// Mean square of the difference of two responses, which are given in radians, in the thesis's unit
/// (degree²).
pub fn mean_square_degree2(one: &[f64], other: &[f64]) -> f64 {
    #[allow(clippy::cast_precision_loss)]
    let n = one.len().min(other.len()) as f64;
    let sum: f64 = one
        .iter()
        .zip(other)
        .map(|(a, b)| (a - b).to_degrees())
        .map(|difference| difference * difference)
        .sum();
    sum / n
}

/// Mean square of the difference between the step responses of two systems, in degree².
pub fn step_error_degree2(one: &System, other: &System, input: &StepInput) -> f64 {
    let samples = input.samples();
    let respond = |system: &System| system.response(&samples, StepInput::INTERVAL_S);
    mean_square_degree2(&respond(one), &respond(other))
}

/// The H∞ norm, `max |G(iω)|`.
///
/// It is searched on a logarithmic grid that extends a factor of 100 beyond the poles on both
/// sides, and the greatest value is refined by golden-section search. A resonance narrower than a
/// sixtieth of a decade could be missed, but a vehicle has none.
///
/// # Errors
/// If the system is unstable, because it has no norm, or if its eigenvalues do not converge.
pub fn h_infinity(system: &System) -> Result<f64, VehicleError> {
    if !system.is_stable()? {
        return Err(VehicleError::Model("an unstable model has no H-infinity norm".to_owned()));
    }
    let sizes: Vec<f64> = system.poles()?.iter().map(|(re, im)| libm::hypot(*re, *im)).collect();
    let slowest = sizes.iter().copied().fold(f64::INFINITY, f64::min) / 100.0;
    let fastest = sizes.iter().copied().fold(0.0, f64::max) * 100.0;
    if sizes.is_empty() {
        return Ok(system.d.abs());
    }
    let oscillations = Oscillations::of(&system.a, &system.b);
    let at = |log: f64| system.magnitude_of(&oscillations, libm::exp(log));
    let (low, high) = (libm::log(slowest), libm::log(fastest));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a few hundred
    let steps = ((high - low) / std::f64::consts::LN_10 * f64::from(PER_DECADE)).ceil() as u32;
    let spacing = (high - low) / f64::from(steps);
    let mut best = (low, system.magnitude(0.0)?.max(system.d.abs()));
    for k in 0..=steps {
        let log = low + f64::from(k) * spacing;
        let magnitude = at(log)?;
        if magnitude > best.1 {
            best = (log, magnitude);
        }
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (best.0 - spacing, best.0 + spacing);
    for _ in 0..40 {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if at(c)? > at(d)? { b = d } else { a = c }
    }
    Ok(best.1.max(at(0.5 * (a + b))?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::Rational;

    #[test]
    fn the_norm_of_a_resonance_is_its_peak() {
        // 1/(s² + 2 ζ s + 1) peaks at 1/(2 ζ √(1 − ζ²)).
        let zeta: f64 = 0.05;
        let system =
            Rational { numerator: vec![1.0], denominator: vec![1.0, 2.0 * zeta, 1.0] }.system();
        let peak = 1.0 / (2.0 * zeta * (1.0 - zeta * zeta).sqrt());
        assert!((h_infinity(&system).unwrap() / peak - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_gain_differs_by_its_mean_square() {
        let gain = |d: f64| Rational { numerator: vec![d], denominator: vec![1.0] }.system();
        let input = StepInput { amplitude_rad: 0.01, rate_per_s: 1e4, duration_s: 10.0 };
        let error = step_error_degree2(&gain(1.0), &gain(3.0), &input);
        // The first of 1001 samples is zero.
        let known = 0.02_f64.to_degrees().powi(2) * 1000.0 / 1001.0;
        assert!((error / known - 1.0).abs() < 1e-9, "{error} {known}");
    }
}
