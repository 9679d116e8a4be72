//! The shapes of the responses: the compensation function `F(s)` of each channel from calibration runs.
//!
//! `F(s)` turns the roll angle of the calibrated model into the measured one (section 5.4). The DC ratio
//! is the matter of [`crate::belief`], so `F(0) = 1`, and in each stretch of a log a constant factor and
//! the offset of the roll sensor are free:
//!
//! ```text
//!     y = g F(s) G(s) u + o + e,     F(s) = (b_n sⁿ + … + b_1 s + a_0) / (sⁿ + … + a_1 s + a_0)
//! ```
//!
//! `G` is the reduced model at the height, mass and speed of the run. All logs are fitted together, each
//! with the same weight. Poles and zeros are stable (minimum phase) and lie in the band of a truck's
//! motion.
//!
//! The order is chosen by logs that the fit has not seen: some of them in turn are left out, and predicted
//! with the function of the others and the reduced model of order 5 that the chip would run. An order
//! counts only if it predicts every log better than no function, and a higher one only if it leaves less
//! than 80 % of what the lower one does. An information criterion would not serve: what is left is not
//! noise but the same small error of the model in every row of a maneuver, so a few hundred rows would
//! justify any order. With fewer than three logs the function that is judged would be that of a single
//! log, whose sensors and maneuver it describes as well as the truck; the order is then 0.
//!
//! **Reference.** Stone, *J. R. Stat. Soc. B* 36 (1974) (cross-validation).

use cg_core::{CHANNELS, Channel};

use super::shape_fit::{Response, fitted, is_of_the_truck, left, none};
use crate::belief::Belief;
use crate::design::models_at;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::load::Load;
use crate::reduction::{ReducedModels, Shapes};
use crate::system::Rational;
use crate::vehicle::Vehicle;

pub use super::shape_fit::{GREATEST_ORDER, INTERVAL_S};

/// Share of what an order leaves below which a higher order counts.
const BETTER: f64 = 0.8;
/// Least number of logs.
pub(crate) const LEAST_RUNS: usize = 3;
/// Greatest number of times that logs are left out.
const FOLDS: usize = 5;
/// Least number of rows of a stretch: three seconds.
const LEAST_ROWS: usize = 60;

/// Consecutive rows of a log, [`INTERVAL_S`] apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stretch {
    /// Input of the channel; any unit.
    pub input: Vec<f64>,
    /// Measured roll angle after the lags of the channel, rad.
    pub measured_rad: Vec<f64>,
    /// Whether the model of the channel is valid.
    pub used: Vec<bool>,
}

/// What a calibration run shows of the shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeRun {
    /// Its load.
    pub load: Load,
    /// Mean speed of its turns, m/s.
    pub speed_mps: f64,
    /// Its rows, for each channel in the order of [`Channel::ALL`].
    pub channels: [Vec<Stretch>; CHANNELS],
}

/// The chosen function of a channel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// The channel.
    pub channel: Channel,
    /// The function with `F(0) = 1`; `None` is order 0.
    pub function: Option<Rational>,
    /// For each order from 0, what it leaves of the roll angle of each log that was left out: rms as
    /// a share. Only order 0 with fewer than three logs.
    pub left_out: Vec<Vec<f64>>,
}

impl Shape {
    /// The order of the function.
    pub fn order(&self) -> usize {
        self.function.as_ref().map_or(0, |function| function.denominator.len() - 1)
    }
}

/// The model of a run on board, and the responses of a channel.
struct Run<'a> {
    models: ReducedModels,
    pace: f64,
    stretches: Vec<&'a Stretch>,
}

impl Run<'_> {
    /// The responses of the model with this function, reduced to order 5 again.
    fn responses(
        &self,
        channel: Channel,
        function: Option<&Rational>,
    ) -> Result<Vec<Response>, VehicleError> {
        let mut shapes = Shapes::default();
        shapes[channel.index()] = function.cloned();
        let mut model = self.models.compensated(&shapes)?.of_channels[channel.index()];
        model.change_pace(self.pace);
        let mut denominator = model.denominator.to_vec();
        denominator.push(1.0);
        let system = Rational { numerator: model.numerator.to_vec(), denominator }.system();
        let responses = self.stretches.iter().map(|stretch| {
            let start = stretch.input.first().copied().unwrap_or(0.0);
            let input: Vec<f64> = stretch.input.iter().map(|value| value - start).collect();
            let model_rad = system.response(&input, INTERVAL_S);
            Response::new(model_rad, &stretch.measured_rad, &stretch.used)
        });
        Ok(responses.collect())
    }

    /// What the model with this function leaves of the roll angles of the run, rms as a share.
    fn left(&self, channel: Channel, function: Option<&Rational>) -> Result<f64, VehicleError> {
        Ok(left(&none(), &self.responses(channel, function)?).sqrt())
    }
}

/// The functions of all channels that the logs have. A run in which the model is unstable does not count.
///
/// # Errors
/// [`VehicleError`] if eigenvalues do not converge.
pub fn shapes(
    file: &Vehicle,
    variant: Variant,
    belief: &Belief,
    runs: &[ShapeRun],
) -> Result<Vec<Shape>, VehicleError> {
    let vehicle = belief.applied_to(file);
    let model = |run: &ShapeRun| models_at(&vehicle, variant, run.load).ok();
    let runs: Vec<(&ShapeRun, ReducedModels)> =
        runs.iter().filter_map(|run| Some((run, model(run)?))).collect();
    let mut shapes = Vec::new();
    for channel in Channel::ALL {
        let mut of_channel = Vec::new();
        for &(run, models) in &runs {
            let usable =
                |one: &&Stretch| one.used.iter().filter(|&&used| used).count() >= LEAST_ROWS;
            let stretches: Vec<_> = run.channels[channel.index()].iter().filter(usable).collect();
            if !stretches.is_empty() {
                let pace = vehicle.nominal_speed_mps / run.speed_mps - 1.0;
                of_channel.push(Run { models, pace, stretches });
            }
        }
        if !of_channel.is_empty() {
            shapes.push(chosen(channel, &of_channel)?);
        }
    }
    Ok(shapes)
}

/// Chooses the function of a channel.
fn chosen(channel: Channel, runs: &[Run<'_>]) -> Result<Shape, VehicleError> {
    let without = |run: &Run<'_>| run.left(channel, None);
    let mut left_out = vec![runs.iter().map(without).collect::<Result<Vec<_>, _>>()?];
    if runs.len() < LEAST_RUNS {
        return Ok(Shape { channel, function: None, left_out });
    }
    let models = |run: &Run<'_>| run.responses(channel, None);
    let responses = runs.iter().map(models).collect::<Result<Vec<_>, _>>()?;
    left_out.resize(1 + GREATEST_ORDER, vec![0.0; runs.len()]);
    let folds = runs.len().min(FOLDS);
    for fold in 0..folds {
        let others = responses.iter().enumerate().filter(|(k, _)| k % folds != fold);
        let others: Vec<&[Response]> = others.map(|(_, run)| run.as_slice()).collect();
        for (order, function) in (1..).zip(fitted(&others)?) {
            for k in (fold..runs.len()).step_by(folds) {
                left_out[order][k] = runs[k].left(channel, Some(&function))?;
            }
        }
    }
    let all: Vec<&[Response]> = responses.iter().map(Vec::as_slice).collect();
    let functions = fitted(&all)?;
    let counts = functions.iter().map(is_of_the_truck).collect::<Result<Vec<_>, _>>()?;
    let order = order_of(&left_out, &counts);
    let function = order.checked_sub(1).and_then(|k| functions.into_iter().nth(k));
    Ok(Shape { channel, function, left_out })
}

/// The order for what each order leaves of each log. Those from 1 on must also count.
fn order_of(left_out: &[Vec<f64>], counts: &[bool]) -> usize {
    let square = |order: usize| left_out[order].iter().map(|share| share * share).sum::<f64>();
    let mut order = 0;
    for next in 1..left_out.len() {
        let pays = left_out[next].iter().zip(&left_out[0]).all(|(with, without)| with < without);
        if counts[next - 1] && pays && square(next) < BETTER * BETTER * square(order) {
            order = next;
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_counts_if_it_pays_in_every_log() {
        let of = |left_out: &[[f64; 2]]| {
            order_of(&left_out.iter().map(|logs| logs.to_vec()).collect::<Vec<_>>(), &[true; 3])
        };
        assert_eq!(of(&[[0.02, 0.03]]), 0);
        assert_eq!(of(&[[0.02, 0.03], [0.01, 0.02], [0.009, 0.02], [0.01, 0.02]]), 1);
        assert_eq!(of(&[[0.02, 0.03], [0.01, 0.02], [0.005, 0.01], [0.01, 0.02]]), 2);
        // Better together, but worse in one of them.
        assert_eq!(of(&[[0.02, 0.03], [0.021, 0.01], [0.021, 0.01], [0.021, 0.01]]), 0);
        // A higher order may be the first that pays.
        assert_eq!(of(&[[0.02, 0.03], [0.021, 0.03], [0.01, 0.01], [0.01, 0.01]]), 2);
        assert_eq!(of(&[[0.02, 0.03], [f64::NAN, 0.01]]), 0);
        let slow_root = order_of(&[vec![0.02; 2], vec![0.01; 2], vec![0.007; 2]], &[false, true]);
        assert_eq!(slow_root, 2);
    }
}
