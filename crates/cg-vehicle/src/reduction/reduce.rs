//! The reduced models of order 5 for the estimator.
//!
//! The thesis expands the transfer function into a continued fraction about s = 0 (Cauer's second
//! form, eqs. 5.9–5.11) and keeps `2n + 1` quotients. This truncation is the `[n/n]` Padé
//! approximant at s = 0, which is computed here directly from the Taylor coefficients.
//!
//! The Padé approximant of a stable model can be unstable and is then not used. The denominator
//! instead has the five slowest poles of the model, and the numerator matches the first six Taylor
//! coefficients.
//!
//! A transfer function from an acceleration to a roll angle has no useful approximant at s = 0: the
//! tractor rolls before the trailer's body is accelerated, so the acceleration has zeros in the
//! right half-plane, and at 0.5 Hz the approximant is wrong by more than the roll angle itself. The
//! estimator therefore delays the roll angle of these channels by two lags
//! ([`cg_core::truck::channel::ROLL_LAG_S`]), and `in_band` fits the model to the frequency response
//! that is left.
//!
//! **Reference.** Chen and Shieh, *A novel approach to linear model simplification*, Int. J.
//! Control 8 (1968); Baker and Graves-Morris, *Padé Approximants*, 2nd ed., §1.1.

use cg_core::truck::reduced::ORDER;
use cg_core::{CHANNELS, Channel, Reduced5};

use crate::error::VehicleError;
use crate::reduction::in_band::{Band, in_band, nearest};
use crate::reduction::pade::pade;
use crate::response::StateSpace;
use crate::system::{Rational, matched_numerator, multiplied};

/// The method by which a reduced model was obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Padé approximant at s = 0.
    Pade,
    /// The model's own slowest poles, with the numerator matched at s = 0.
    SlowestPoles,
}

fn fixed(rational: &Rational) -> Reduced5<f64> {
    let mut reduced = Reduced5 {
        numerator: [0.0; ORDER + 1],
        denominator: [0.0; ORDER],
        speed_slope: [0.0; ORDER],
    };
    reduced.numerator.copy_from_slice(&rational.numerator);
    reduced.denominator.copy_from_slice(&rational.denominator[..ORDER]);
    reduced
}

/// The denominator with the five slowest poles. Complex pairs stay together; if a pair would give a
/// sixth pole, it is replaced by one real pole of the same magnitude.
fn slowest_poles(poles: &[(f64, f64)]) -> Vec<f64> {
    let mut upper: Vec<(f64, f64)> = poles.iter().copied().filter(|pole| pole.1 >= 0.0).collect();
    upper.sort_by(|a, b| libm::hypot(a.0, a.1).total_cmp(&libm::hypot(b.0, b.1)));
    let mut denominator = vec![1.0];
    for (re, im) in upper {
        let degree = denominator.len() - 1;
        match ORDER - degree {
            0 => break,
            1 => denominator = multiplied(&denominator, &[libm::hypot(re, im), 1.0]),
            _ if im == 0.0 => denominator = multiplied(&denominator, &[-re, 1.0]),
            _ => denominator = multiplied(&denominator, &[re * re + im * im, -2.0 * re, 1.0]),
        }
    }
    denominator
}

/// The model of order 5 with the Taylor coefficients `series` at s = 0, from a function with these poles.
fn of_order_five(series: &[f64], poles: &[(f64, f64)]) -> (Reduced5<f64>, Method) {
    let approximant = pade(series, ORDER).map(|r| fixed(&r)).filter(Reduced5::is_stable);
    if let Some(model) = approximant {
        return (model, Method::Pade);
    }
    let denominator = slowest_poles(poles);
    let numerator = matched_numerator(&denominator, series);
    (fixed(&Rational { numerator, denominator }), Method::SlowestPoles)
}

/// The compensation function `F(s)` of each channel, in the order of [`Channel::ALL`], with `F(0) = 1`;
/// `None` is a function of order 0.
pub type Shapes = [Option<Rational>; CHANNELS];

/// The reduced models of order 5 of a vehicle model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReducedModels {
    /// The model of each channel, in the order of [`Channel::ALL`]. The models from an acceleration
    /// have the denominator of that from the steer angle and explain the roll angle after the two
    /// lags of the estimator.
    pub of_channels: [Reduced5<f64>; CHANNELS],
    /// The method by which the model for the steer angle was obtained.
    pub method: Method,
}

/// Reduces a vehicle model to order 5. `others` are models of the same vehicle and load at other
/// speeds, each with `U0/U − 1`; without them, the reduced models are those of one speed.
///
/// # Errors
/// [`VehicleError::Model`] if the vehicle model itself is unstable.
pub fn reduce(
    model: &StateSpace,
    others: &[(f64, StateSpace)],
) -> Result<ReducedModels, VehicleError> {
    let system = model.to_trailer_roll();
    let poles = system.poles()?;
    if let Some((re, im)) = poles.iter().find(|pole| pole.0 >= 0.0) {
        return Err(VehicleError::Model(format!(
            "the vehicle is unstable at this speed and load (pole {re:.3} {im:+.3}i rad/s)"
        )));
    }
    let terms = 2 * ORDER + 1;
    let (steer, method) = of_order_five(&system.moments(terms)?, &poles);
    let mut denominator = steer.denominator.to_vec();
    denominator.push(1.0);
    let band = Band::new(model, 0.0)?;
    let mut bands = Vec::new();
    for (pace, other) in others {
        // An unstable truck does not oscillate steadily.
        if other.to_trailer_roll().is_stable()? {
            bands.push(Band::new(other, *pace)?);
        }
    }
    let mut of_channels = [steer; CHANNELS];
    for (channel, reduced) in Channel::ALL.into_iter().zip(&mut of_channels) {
        let Some(fit) = in_band(&band, &bands, channel, &denominator)? else { continue };
        reduced.numerator = std::array::from_fn(|k| fit.gain * fit.numerator[k]);
        reduced.speed_slope = std::array::from_fn(|k| fit.gain * fit.speed_slope[k]);
    }
    Ok(ReducedModels { of_channels, method })
}

/// A model as a rational function with this numerator.
fn rational(model: &Reduced5<f64>, numerator: &[f64]) -> Rational {
    let mut denominator = model.denominator.to_vec();
    denominator.push(1.0);
    Rational { numerator: numerator.to_vec(), denominator }
}

/// The product of a model and a function, of the order of both.
fn product(model: &Rational, function: &Rational) -> Rational {
    Rational {
        numerator: multiplied(&model.numerator, &function.numerator),
        denominator: multiplied(&model.denominator, &function.denominator),
    }
}

impl ReducedModels {
    /// The compensated models: each is multiplied by the function of its channel, which has `F(0) = 1`,
    /// and reduced to order 5 again (section 5.5). From an acceleration, the denominator remains, and the
    /// numerator is the nearest to the product in the band of usual maneuvers.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if eigenvalues do not converge.
    pub fn compensated(&self, functions: &Shapes) -> Result<Self, VehicleError> {
        let mut compensated = *self;
        for (channel, function) in Channel::ALL.into_iter().zip(functions) {
            let Some(function) = function else { continue };
            let reduced = &mut compensated.of_channels[channel.index()];
            let own = product(&rational(reduced, &reduced.numerator), function);
            if channel.lags_roll() {
                let slope = [&[0.0], &reduced.speed_slope[..]].concat();
                let slope = product(&rational(reduced, &slope), function);
                let denominator = rational(reduced, &[]).denominator;
                let numerator = nearest(&own, &denominator, reduced.numerator[0], ORDER)?;
                let slope = nearest(&slope, &denominator, 0.0, ORDER - 1)?;
                reduced.numerator.copy_from_slice(&numerator);
                reduced.speed_slope.copy_from_slice(&slope[1..]);
            } else {
                let system = own.system();
                (*reduced, compensated.method) =
                    of_order_five(&system.moments(2 * ORDER + 1)?, &system.poles()?);
            }
        }
        Ok(compensated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_poles_make_a_stable_denominator_of_degree_five() {
        for poles in [
            vec![(-1.0, 2.0), (-1.0, -2.0), (-3.0, 0.0), (-2.0, 4.0), (-2.0, -4.0), (-9.0, 0.0)],
            vec![(-1.0, 2.0), (-1.0, -2.0), (-2.0, 4.0), (-2.0, -4.0), (-5.0, 6.0), (-5.0, -6.0)],
        ] {
            let denominator = slowest_poles(&poles);
            assert_eq!(denominator.len(), ORDER + 1);
            let numerator = vec![1.0; ORDER + 1];
            assert!(fixed(&Rational { numerator, denominator }).is_stable());
        }
    }
}
