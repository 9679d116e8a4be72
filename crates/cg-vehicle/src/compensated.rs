//! The compensated models of a calibrated truck at one speed and load, from `F(s)` to what the chip runs.

use cg_core::{Channel, Reduced5};

use crate::belief::Belief;
use crate::design::models_at;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::load::Load;
use crate::reduction::quality::rounded_step;
use crate::system::{Rational, multiplied};
use crate::vehicle::Vehicle;

/// The rounded step of the comparison: rate (1/s), interval (s), and number of samples (12 s).
const STEP: (f64, f64, u32) = (2.0, 0.02, 600);

/// The compensated model of a channel, with a DC gain of one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CompensatedModel {
    /// The channel.
    pub channel: Channel,
    /// `F(s)`; one if its order is 0.
    pub function: Rational,
    /// The reduced model of the calibrated truck times `F(s)`.
    pub product: Rational,
    /// The product reduced to order 5, which runs on board.
    pub reduced: Rational,
    /// How much `F(s)` changes the response to a rounded step, rms as a share of the response.
    pub change: f64,
    /// What the reduction to order 5 leaves of the response of the product, likewise.
    pub reduction_error: f64,
}

/// A model as a rational function with a DC gain of one.
fn unit(model: &Reduced5<f64>, pace: f64) -> Rational {
    let mut model = model.at_unit_gain();
    model.change_pace(pace);
    let denominator = model.denominator.into_iter().chain([1.0]).collect();
    Rational { numerator: model.numerator.to_vec(), denominator }
}

/// The difference between two models in a rounded step, as a share of the response of the second.
fn difference(one: &Rational, other: &Rational) -> f64 {
    let (rate_per_s, interval_s, samples) = STEP;
    let step: Vec<f64> =
        (0..samples).map(|k| rounded_step(f64::from(k) * interval_s, rate_per_s)).collect();
    let [one, other] = [one, other].map(|model| model.system().response(&step, interval_s));
    let power = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let left = power(&mut one.iter().zip(&other).map(|(a, b)| a - b));
    (left / power(&mut other.iter().copied())).sqrt()
}

/// The compensated models of all channels of a truck.
///
/// # Errors
/// [`VehicleError`] if the truck is unstable with this load.
pub fn compensated_models(
    file: &Vehicle,
    variant: Variant,
    belief: &Belief,
    (speed_mps, load): (f64, Load),
) -> Result<Vec<CompensatedModel>, VehicleError> {
    let models = models_at(&belief.applied_to(file), variant, load)?;
    let compensated = models.compensated(&belief.shapes)?;
    let pace = file.nominal_speed_mps / speed_mps - 1.0;
    let of = |channel: Channel| {
        let k = channel.index();
        let model = unit(&models.of_channels[k], pace);
        let one = Rational { numerator: vec![1.0], denominator: vec![1.0] };
        let function = belief.shapes[k].clone().unwrap_or(one);
        let product = Rational {
            numerator: multiplied(&model.numerator, &function.numerator),
            denominator: multiplied(&model.denominator, &function.denominator),
        };
        let reduced = unit(&compensated.of_channels[k], pace);
        let (change, reduction_error) =
            (difference(&product, &model), difference(&reduced, &product));
        CompensatedModel { channel, function, product, reduced, change, reduction_error }
    };
    Ok(Channel::ALL.map(of).to_vec())
}
