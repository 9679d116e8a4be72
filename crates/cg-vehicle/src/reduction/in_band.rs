//! The model of a channel that is best in the band of usual maneuvers.
//!
//! The weighted square of `N(iω)/B(iω) − G(iω)/(1 + iωT)²` over the frequencies is minimized over
//! the numerator `N`, which is a linear problem. `G` is the exact transfer function from the input of
//! the channel to its roll angle, `B` a given denominator, and `T` the time constant of the lags
//! through which the estimator passes the measured roll angle. `N(0)/B(0) = G(0)` is exact.

use cg_core::Channel;
use cg_core::truck::channel::ROLL_LAG_S;
use nalgebra::{Complex, DMatrix, DVector};

use crate::error::VehicleError;
use crate::response::StateSpace;
use crate::system::{response_of, state_at};

/// Least and greatest frequency. Trailers roll in lane changes at 1.5 to 3 rad/s; beyond 12 rad/s a
/// driver excites nothing.
const BAND_RADPS: (f64, f64) = (0.1, 12.0);
/// Number of frequencies. They are 10 % apart, so a resonance with a damping ratio of 0.1, the least
/// of leaf springs, has some.
const FREQUENCIES: u32 = 50;
/// Unit of the frequency in the equations, which makes the coefficients similar.
const UNIT_RADPS: f64 = 3.0;

/// Frequencies of the fit, each with the state of the model per radian of steer angle.
pub(super) struct Band {
    points: Vec<(f64, DVector<Complex<f64>>)>,
}

impl Band {
    /// The states of a model in steady oscillations.
    pub(super) fn new(model: &StateSpace) -> Result<Self, VehicleError> {
        let ratio = BAND_RADPS.1 / BAND_RADPS.0;
        let points = (0..FREQUENCIES)
            .map(|k| {
                let place = f64::from(k) / f64::from(FREQUENCIES - 1);
                let omega_radps = BAND_RADPS.0 * ratio.powf(place);
                Ok((omega_radps, state_at(&model.a, &model.b, omega_radps)?))
            })
            .collect::<Result<_, VehicleError>>()?;
        Ok(Self { points })
    }
}

/// The amplitude of a driver's steer angle: turns that are entered and left (`1/ω`) and lane changes
/// (constant up to 4 rad/s). The frequencies are equally spaced on a logarithmic scale, so `√ω` is
/// the root of their spacing.
fn usual_steer(omega_radps: f64) -> f64 {
    let square = omega_radps * omega_radps;
    ((1.0 / square + 1.0) / (1.0 + (square / 16.0).powi(2)) * omega_radps).sqrt()
}

/// A polynomial in ascending powers of `iω`.
fn polynomial_at(coefficients: &[f64], omega_radps: f64) -> Complex<f64> {
    let s = Complex::new(0.0, omega_radps);
    coefficients.iter().rev().fold(Complex::new(0.0, 0.0), |sum, &c| sum * s + c)
}

/// The numerator (ascending) of a channel's model for this denominator (ascending); `None` for the
/// channel of the steer angle.
///
/// # Errors
/// If the model has a pole at zero, or the problem cannot be solved.
pub(super) fn in_band(
    model: &StateSpace,
    band: &Band,
    channel: Channel,
    denominator: &[f64],
) -> Result<Option<Vec<f64>>, VehicleError> {
    let Some((input_row, feedthrough)) = model.input_row(channel.input()) else {
        return Ok(None);
    };
    let output_row = model.output_row(channel.output());
    let steady_input = model.steady(input_row, feedthrough)?;
    let steady = model.steady(output_row, 0.0)? / steady_input;
    let constant = steady * denominator[0];
    let unknown = denominator.len() - 1;
    let rows = 2 * band.points.len();
    let mut matrix = DMatrix::zeros(rows, unknown);
    let mut rhs = DVector::zeros(rows);
    for (i, (omega_radps, state)) in band.points.iter().enumerate() {
        let lag = Complex::new(1.0, omega_radps * ROLL_LAG_S);
        let input = response_of(state, input_row, feedthrough) / steady_input;
        let output = response_of(state, output_row, 0.0) / (lag * lag * steady_input * steady);
        let weight = usual_steer(*omega_radps);
        let response = input * weight / polynomial_at(denominator, *omega_radps);
        let known = output * weight - response * (constant / steady);
        (rhs[2 * i], rhs[2 * i + 1]) = (known.re, known.im);
        let mut power = response * denominator[0];
        for k in 0..unknown {
            power *= Complex::new(0.0, omega_radps / UNIT_RADPS);
            (matrix[(2 * i, k)], matrix[(2 * i + 1, k)]) = (power.re, power.im);
        }
    }
    let solution = matrix
        .svd(true, true)
        .solve(&rhs, f64::EPSILON)
        .map_err(|error| VehicleError::Model(format!("reduced model: {error}")))?;
    let mut numerator = vec![constant];
    let mut unit = 1.0;
    for share in solution.iter() {
        unit *= UNIT_RADPS;
        numerator.push(share * constant / unit);
    }
    Ok(Some(numerator))
}
