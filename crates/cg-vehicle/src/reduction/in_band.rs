//! The numerators that are best in the band of usual maneuvers.
//!
//! The weighted square of `N(iω)/B(iω) − G(iω)/(1 + iωT)²` over the frequencies is minimized over
//! the numerator `N`, which is a linear problem. `G` is the exact transfer function from the input of
//! a channel to its roll angle, scaled to `G(0) = 1`, `B` the given denominator, and `T` the time
//! constant of the lags through which the estimator passes the measured roll angle. `N(0) = B(0)` is
//! exact.
//!
//! The input has noise, which the roll angle does not follow, so what a model makes of it is left as
//! well. Without this part of the square, a model follows the acceleration of an empty trailer best by
//! powers of `s` that let the noise pass beyond the band.
//!
//! At another speed `U` the numerator is `N + (U0/U − 1) M`, and `M` is fitted in the same way to
//! what `N` leaves at the other speeds. The distance between the axles passes in a time of `1/U`, so
//! the error of this form is small.

use cg_core::truck::channel::ROLL_LAG_S;
use cg_core::{Channel, Input};
use nalgebra::{Complex, DMatrix, DVector};

use crate::error::VehicleError;
use crate::response::StateSpace;
use crate::system::{Oscillations, Rational, response_of};

/// Least and greatest frequency. Trailers roll in lane changes at 1.5 to 3 rad/s; beyond 12 rad/s a
/// driver excites nothing.
const BAND_RADPS: (f64, f64) = (0.1, 12.0);
/// Number of frequencies. They are 10 % apart, so a resonance with a damping ratio of 0.1, the least
/// of leaf springs, has some.
const FREQUENCIES: u32 = 50;
/// Standard deviation of the white noise at 50 Hz of an accelerometer on a chassis, and of a lateral acceleration,
/// which is often the yaw rate times the speed, m/s².
const FORCE_NOISE_MPS2: f64 = 0.03;
const LATERAL_NOISE_MPS2: f64 = 0.015;
/// The spectrum of unit noise over a turn of 15 s, `√(Δt T)`, divided by a change of the acceleration of
/// 1.5 m/s², whose spectrum is `1/ω`.
const NOISE_PER_TURN: f64 = 0.55 / 1.5;
/// Half the sampling rate of 50 Hz.
const GREATEST_NOISE_RADPS: f64 = 157.0;
/// Unit of the frequency in the equations, which makes the coefficients similar.
const UNIT_RADPS: f64 = 3.0;

/// The states of a model in steady oscillations, per radian of steer angle.
pub(super) struct Band<'a> {
    model: &'a StateSpace,
    /// `U0/U − 1`.
    pace: f64,
    points: Vec<(f64, DVector<Complex<f64>>)>,
}

/// A point of the fit: frequency, the input with its weight, and the weighted roll angle that is to
/// be explained.
type Point = (f64, Complex<f64>, Complex<f64>);

/// Frequencies from the least of the band on, as far apart as those of the band.
fn spaced() -> impl Iterator<Item = f64> {
    let ratio = BAND_RADPS.1 / BAND_RADPS.0;
    (0..).map(move |k| {
        let place = f64::from(k) / f64::from(FREQUENCIES - 1);
        BAND_RADPS.0 * libm::pow(ratio, place)
    })
}

/// The frequencies of the band.
fn frequencies() -> impl Iterator<Item = f64> {
    spaced().take(FREQUENCIES as usize)
}

/// The noise of an input relative to a turn, which no roll angle follows.
fn noise(input: Input) -> impl Iterator<Item = Point> {
    let sd_mps2 =
        if input == Input::LateralAcceleration { LATERAL_NOISE_MPS2 } else { FORCE_NOISE_MPS2 };
    let zero = Complex::new(0.0, 0.0);
    let passing = spaced().take_while(|&omega_radps| omega_radps < GREATEST_NOISE_RADPS);
    passing.map(move |omega_radps| {
        let size = NOISE_PER_TURN * sd_mps2 * omega_radps.sqrt();
        (omega_radps, Complex::new(size, 0.0), zero)
    })
}

impl<'a> Band<'a> {
    /// The states of a model at `pace`.
    pub(super) fn new(model: &'a StateSpace, pace: f64) -> Result<Self, VehicleError> {
        let oscillations = Oscillations::of(&model.a, &model.b);
        let points = frequencies()
            .map(|omega_radps| Ok((omega_radps, oscillations.state_at(omega_radps)?)))
            .collect::<Result<_, VehicleError>>()?;
        Ok(Self { model, pace, points })
    }

    /// The roll angle of a channel in a slow turn per unit of its input, and both in oscillations, relative
    /// to those of a slow turn; `None` for the channel of the steer angle.
    fn points(&self, channel: Channel) -> Result<Option<(f64, Vec<Point>)>, VehicleError> {
        let model = self.model;
        let Some((input_row, feedthrough)) = model.input_row(channel.input()) else {
            return Ok(None);
        };
        let output_row = model.output_row(channel.output());
        let steady_output = model.steady(output_row, 0.0)?;
        let steady_input = model.steady(input_row, feedthrough)?;
        let points = self.points.iter().map(|(omega_radps, state)| {
            let lag = Complex::new(1.0, omega_radps * ROLL_LAG_S);
            let input = response_of(state, input_row, feedthrough) / steady_input;
            let output = response_of(state, output_row, 0.0) / (lag * lag * steady_output);
            let weight = usual_steer(*omega_radps);
            (*omega_radps, input * weight, output * weight)
        });
        Ok(Some((steady_output / steady_input, points.chain(noise(channel.input())).collect())))
    }
}

/// The amplitude of a driver's steer angle: turns that are entered and left (`1/ω`) and lane changes
/// (constant up to 4 rad/s). The frequencies are equally spaced on a logarithmic scale, so `√ω` is
/// the root of their spacing.
fn usual_steer(omega_radps: f64) -> f64 {
    let square = omega_radps * omega_radps;
    ((1.0 / square + 1.0) / (1.0 + square * square / 256.0) * omega_radps).sqrt()
}

/// A polynomial in ascending powers of `iω`.
fn polynomial_at(coefficients: &[f64], omega_radps: f64) -> Complex<f64> {
    let s = Complex::new(0.0, omega_radps);
    coefficients.iter().rev().fold(Complex::new(0.0, 0.0), |sum, &c| sum * s + c)
}

/// The coefficients `c1 … cn` for which `Σ ck sᵏ/B` best turns the inputs into the roll angles.
fn fitted(points: &[Point], denominator: &[f64], unknown: usize) -> Result<Vec<f64>, VehicleError> {
    let mut matrix = DMatrix::zeros(2 * points.len(), unknown);
    let mut rhs = DVector::zeros(2 * points.len());
    for (i, (omega_radps, input, output)) in points.iter().enumerate() {
        (rhs[2 * i], rhs[2 * i + 1]) = (output.re, output.im);
        let mut power = input / polynomial_at(denominator, *omega_radps) * denominator[0];
        for k in 0..unknown {
            power *= Complex::new(0.0, omega_radps / UNIT_RADPS);
            (matrix[(2 * i, k)], matrix[(2 * i + 1, k)]) = (power.re, power.im);
        }
    }
    let solution = matrix
        .svd(true, true)
        .solve(&rhs, f64::EPSILON)
        .map_err(|error| VehicleError::Model(format!("reduced model: {error}")))?;
    let mut unit = denominator[0];
    Ok(solution
        .iter()
        .map(|share| {
            unit /= UNIT_RADPS;
            share * unit
        })
        .collect())
}

/// What a numerator leaves of the roll angles, with the input multiplied by `factor`.
fn left_by(
    numerator: &[f64],
    denominator: &[f64],
    points: Vec<Point>,
    factor: f64,
) -> impl Iterator<Item = Point> {
    points.into_iter().map(move |(omega_radps, input, output)| {
        let at = |polynomial: &[f64]| polynomial_at(polynomial, omega_radps);
        let known = input * at(numerator) / at(denominator);
        (omega_radps, input * factor, output - known)
    })
}

/// The numerator of a channel.
pub(super) struct InBand {
    /// The DC ratio, by which both numerators are to be multiplied.
    pub(super) gain: f64,
    /// `N`, ascending, with `N(0) = B(0)`.
    pub(super) numerator: Vec<f64>,
    /// `M`, the change of the numerator (from s¹ on) per unit of `U0/U − 1`; zero without other speeds.
    pub(super) speed_slope: Vec<f64>,
}

/// The numerator of a channel for this denominator, from a model at the nominal speed and others;
/// `None` for the channel of the steer angle.
pub(super) fn in_band(
    nominal: &Band<'_>,
    others: &[Band<'_>],
    channel: Channel,
    denominator: &[f64],
) -> Result<Option<InBand>, VehicleError> {
    let Some((gain, points)) = nominal.points(channel)? else { return Ok(None) };
    let order = denominator.len() - 1;
    let mut numerator = vec![denominator[0]];
    let points: Vec<Point> = left_by(&numerator, denominator, points, 1.0).collect();
    numerator.extend(fitted(&points, denominator, order)?);
    let mut points = Vec::new();
    for (pace, known) in others.iter().map(|other| (other.pace, other.points(channel))) {
        if let Some((_, known)) = known? {
            points.extend(left_by(&numerator, denominator, known, pace));
        }
    }
    let mut speed_slope = vec![0.0; order];
    if !points.is_empty() {
        // Without the highest power, by which the noise of the input would pass without delay.
        let slope = fitted(&points, denominator, order - 1)?;
        speed_slope[..order - 1].copy_from_slice(&slope);
    }
    Ok(Some(InBand { gain, numerator, speed_slope }))
}

/// The numerator, with `constant` at s = 0, whose quotient with `denominator` is nearest to `wanted` in the
/// band. It is of this `degree`.
pub(super) fn nearest(
    wanted: &Rational,
    denominator: &[f64],
    constant: f64,
    degree: usize,
) -> Result<Vec<f64>, VehicleError> {
    let points = frequencies().map(|omega_radps| {
        let at = |polynomial: &[f64]| polynomial_at(polynomial, omega_radps);
        let left = at(&wanted.numerator) / at(&wanted.denominator) - constant / at(denominator);
        let weight = usual_steer(omega_radps);
        (omega_radps, Complex::new(weight, 0.0), left * weight)
    });
    let mut numerator = vec![constant];
    numerator.extend(fitted(&points.collect::<Vec<_>>(), denominator, degree)?);
    numerator.resize(denominator.len(), 0.0);
    Ok(numerator)
}
