//! Estimates the uncertain parameters of a truck from runs with a known height.
//!
//! One run determines the compensation `R_c` of each channel, as in the thesis (section 5.4, eq.
//! 5.19). Several runs determine the physical parameters of [`crate::belief`]: the values that
//! agree best with the prior and with all runs (maximum a posteriori, Gauss-Newton on the
//! logarithms of the DC ratios):
//!
//! ```text
//!     y = f(x) + e,     x ~ N(0, P0),     e ~ N(0, R)
//!     K = P0 Hᵀ (H P0 Hᵀ + R)⁻¹,     x = K (y − f(x) + H x),     P = (I − K H) P0 (I − K H)ᵀ + K R Kᵀ
//! ```
//!
//! With one run, `K` is not the optimal gain but the one that changes the gains of the sensors
//! only. The form of `P` is valid for any gain, so the covariance remains correct. The height of a run
//! may be unknown (`heights`); `K` is then blind to it.
//!
//! **Reference.** Tarantola, *Inverse Problem Theory*, §3.2 (Gauss-Newton on a Gaussian prior);
//! Gelb, *Applied Optimal Estimation*, §4.2 (covariance of a suboptimal gain).

use cg_core::Measured;
use nalgebra::{DMatrix, DVector};

use super::heights::{Heights, Innovation};
use super::judgment::Judgment;
use super::ratios::{Ratios, Residual, Run};
use super::walk::Walk;
use crate::belief::{Belief, Covariance, Deviations, PARAMETERS, Parameter};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::vehicle::Vehicle;

/// Number of Gauss-Newton steps after which a short step is good enough. The ratios are nearly linear in
/// the parameters, so three are usually enough.
const STEPS: usize = 12;
/// Number of whole steps. On top of a calibration that the runs contradict, steps shrink slowly.
const WHOLE_STEPS: usize = 30;
/// Greatest number of steps. The friction of measured springs bends the ratios where it just ceases to hold the
/// spring, and whole steps can then jump from one side of the bend to the other for ever. Each further step is
/// therefore halved until it lowers the sum of squares.
const MOST_STEPS: usize = 80;
/// Number of times that a step is halved: to below [`SHORT`] for steps of less than one.
const HALVINGS: usize = 17;
/// What such a step must take from the sum of squares: less moves no parameter by more than 3 % (the root) of a
/// standard deviation.
const LOWER: f64 = 1e-3;
/// A step below this (logarithm or meters) ends the iteration.
const SETTLED: f64 = 1e-10;
/// A step below this is short.
const SHORT: f64 = 1e-5;
/// Share of a prior variance below which a parameter follows from the others.
const KNOWN: f64 = 1e-12;

/// The method by which the parameters are determined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Procedure {
    /// All parameters, as the runs and the prior make them most probable.
    #[default]
    MaximumAPosteriori,
    /// Only `R_c` of each channel, from one run, as in the thesis.
    Compensation,
}

cg_core::words!(Procedure {
    MaximumAPosteriori => "maximum-a-posteriori", "all parameters of the truck", "posterior";
    Compensation => "compensation", "the compensation R_c of each channel alone, from one run (the thesis)";
});

/// The result of a calibration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fitted {
    /// The method.
    pub procedure: Procedure,
    /// The posterior.
    pub belief: Belief,
    /// Residuals, one for each run and channel.
    pub residuals: Vec<Residual>,
    /// For each run the height that was found, m; `None` if it was known.
    pub heights: Vec<Option<Measured<f64>>>,
    /// `rᵀ R⁻¹ r + xᵀ P0⁻¹ x` at the solution, `x` from the prior's mean. If the standard deviations of prior and noise are
    /// correct, it is distributed as χ² with [`degrees_of_freedom`](Self::degrees_of_freedom).
    pub chi_square: f64,
}

impl Fitted {
    /// One for each residual, less one for each height that was not known.
    pub fn degrees_of_freedom(&self) -> usize {
        self.residuals.len().saturating_sub(self.heights.iter().flatten().count())
    }

    /// The runs of this fit at the heights that were found.
    pub(super) fn placed(&self, runs: &[Run]) -> Vec<Run> {
        let mut runs = runs.to_vec();
        for (run, found) in runs.iter_mut().zip(&self.heights) {
            run.load.cg_height_m = found.map_or(run.load.cg_height_m, |height_m| height_m.value);
        }
        runs
    }

    /// Whether the runs are possible for the vehicle file.
    pub fn judgment(&self) -> Judgment {
        match self.procedure {
            // One factor for each ratio explains everything.
            Procedure::Compensation => Judgment::Sound,
            Procedure::MaximumAPosteriori => {
                Judgment::of(self.chi_square, self.degrees_of_freedom())
            }
        }
    }

    /// Whether the runs that this fit has and an `earlier` one does not have are possible for the truck
    /// of the earlier one. The difference of both sums of squares is distributed as χ² with one degree
    /// of freedom for each of these ratios.
    pub fn judgment_after(&self, earlier: &Self) -> Judgment {
        let more = self.degrees_of_freedom().saturating_sub(earlier.degrees_of_freedom());
        Judgment::of(self.chi_square - earlier.chi_square, more)
    }
}

fn check(procedure: Procedure, runs: &[Run]) -> Result<(), VehicleError> {
    let reason = match (procedure, runs) {
        (Procedure::MaximumAPosteriori, _) => return Ok(()),
        (_, [run @ Run { age_s: None, .. }]) if run.height_is_known() => return Ok(()),
        (_, [Run { age_s: None, .. }]) => "whose height is known".to_owned(),
        (_, [_]) => "not a trip in service".to_owned(),
        _ => format!("but there are {}", runs.len()),
    };
    Err(VehicleError::Model(format!(
        "the procedure \"{procedure}\" needs exactly one run, {reason}"
    )))
}

/// Estimates the parameters of a vehicle from runs.
///
/// # Errors
/// [`VehicleError`] if there is no run, if there is no ratio, if the load is impossible for the model,
/// if no possible height gives the ratios of a run of unknown height, or if there is more than one run for
/// [`Procedure::Compensation`].
pub fn fit(
    vehicle: &Vehicle,
    variant: Variant,
    procedure: Procedure,
    runs: &[Run],
) -> Result<Fitted, VehicleError> {
    let prior = Prior { belief: Belief::prior(vehicle), age_s: 0.0 };
    fit_from((vehicle, variant), procedure, &prior, runs)
}

/// What is known of a truck before its runs, such as a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// The truck at that time.
    pub belief: Belief,
    /// Time since then, s; if a run is older, the prior holds at the time of the run.
    pub age_s: f64,
}

/// The same from another prior than that of the vehicle file.
///
/// # Errors
/// As [`fit`].
pub fn fit_from(
    (vehicle, variant): (&Vehicle, Variant),
    procedure: Procedure,
    Prior { belief: prior, age_s }: &Prior,
    runs: &[Run],
) -> Result<Fitted, VehicleError> {
    check(procedure, runs)?;
    let p0 = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| prior.covariance[(i, j)]);
    let mut ratios = Ratios::new((vehicle, variant), runs, prior.residual_sd)?;
    let mut heights = Heights::of(vehicle, runs);
    let walk = Walk::new(vehicle, *age_s, &ratios.ages_s());
    let file = Deviations::zeros();
    let (mut before, slopes) = ratios.linearized(&file)?;
    let mut alone = ratios.noise(&slopes)?;
    let mut truck = Estimate { mean: prior.mean, covariance: p0.clone(), noise: alone.clone() };
    let mut step = f64::INFINITY;
    for k in 0..MOST_STEPS {
        if step <= if k < STEPS { SETTLED } else { SHORT } {
            break;
        }
        let last = truck.mean;
        (truck, step) = match procedure {
            Procedure::Compensation => (compensated(&last, &p0, (&ratios, &alone))?, 0.0),
            Procedure::MaximumAPosteriori => {
                let start = (&prior.mean, &p0);
                most_probable(&last, start, (&mut ratios, &alone), (&walk, &mut heights))?
            }
        };
        // Unknown heights take whole steps, too.
        if k >= WHOLE_STEPS && heights.count() == 0 {
            truck.mean = lowering(&last, truck.mean, |mean| {
                let (left, slopes) = ratios.linearized(mean)?;
                let noise = walk.added_to(&alone, &slopes);
                sum_of_squares(&left, noise, Some((mean - prior.mean, &p0)))
            })?;
        }
        step = step.max((truck.mean - last).amax());
        if heights.count() > 0 {
            let slopes;
            (before, slopes) = ratios.linearized(&file)?;
            alone = ratios.noise(&slopes)?;
        }
    }
    if !(step <= SHORT) {
        return Err(VehicleError::Unsettled);
    }
    let Estimate { mut mean, covariance, noise } = truck;
    let (after, h) = ratios.linearized(&mean)?;
    let residuals = ratios.residuals([&before, &after]);
    let prior_of = match procedure {
        Procedure::Compensation => None,
        Procedure::MaximumAPosteriori => Some((mean - prior.mean, &p0)),
    };
    let chi_square = sum_of_squares(&after, noise, prior_of)?;
    let mut covariance = Covariance::from_fn(|i, j| covariance[(i, j)]);
    if walk.is_some() {
        let left = after + &h * DVector::from_column_slice((mean - prior.mean).as_slice());
        let noise = walk.added_to(&alone, &h);
        let innovation = innovation((&p0, &h, &noise), heights.slopes(&ratios, &mean)?)?;
        let moved;
        (moved, covariance) = walk.carried(&p0, (&h, &left), &innovation);
        mean = prior.mean + moved;
    }
    let covariance = Covariance::from_fn(|i, j| 0.5 * (covariance[(i, j)] + covariance[(j, i)]));
    let belief = Belief { mean, covariance, ..prior.clone() };
    let heights = heights.found(&ratios.runs)?;
    Ok(Fitted { procedure, belief, residuals, heights, chi_square })
}

/// The truck after a step of the iteration, and the covariance of the ratios with which it was made.
struct Estimate {
    mean: Deviations,
    covariance: DMatrix<f64>,
    noise: DMatrix<f64>,
}

impl Estimate {
    /// Valid for any gain.
    fn new(
        mean: &DVector<f64>,
        gain: &DMatrix<f64>,
        (p0, h, noise): (&DMatrix<f64>, &DMatrix<f64>, DMatrix<f64>),
    ) -> Self {
        let rest = DMatrix::identity(PARAMETERS, PARAMETERS) - gain * h;
        let covariance = &rest * p0 * rest.transpose() + gain * &noise * gain.transpose();
        Self { mean: Deviations::from_column_slice(mean.as_slice()), covariance, noise }
    }
}

/// The misfit of each channel changes the gain of its sensor only.
fn compensated(
    mean: &Deviations,
    p0: &DMatrix<f64>,
    (ratios, noise): (&Ratios<'_>, &DMatrix<f64>),
) -> Result<Estimate, VehicleError> {
    let (misfit, h) = ratios.linearized(mean)?;
    let mut gain = DMatrix::zeros(PARAMETERS, ratios.observations.len());
    for (k, observation) in ratios.observations.iter().enumerate() {
        let parameter = Parameter::of_input(observation.channel.input());
        gain[(parameter as usize, k)] = 1.0;
    }
    let next = DVector::from_column_slice(mean.as_slice()) + &gain * &misfit;
    Ok(Estimate::new(&next, &gain, (p0, &h, noise.clone())))
}

/// A step of Gauss and Newton; unknown heights take theirs, whose greatest length is returned, m.
fn most_probable(
    mean: &Deviations,
    (x0, p0): (&Deviations, &DMatrix<f64>),
    (ratios, alone): (&mut Ratios<'_>, &DMatrix<f64>),
    (walk, heights): (&Walk, &mut Heights),
) -> Result<(Estimate, f64), VehicleError> {
    let (misfit, h) = ratios.linearized(mean)?;
    let noise = walk.added_to(alone, &h);
    let innovation = innovation((p0, &h, &noise), heights.slopes(ratios, mean)?)?;
    let gain = innovation.solve(&(&h * p0)).transpose();
    let left = &misfit + &h * DVector::from_column_slice((mean - x0).as_slice());
    let step_m = heights.step(&mut ratios.runs, (&innovation, &left));
    let next = DVector::from_column_slice(x0.as_slice()) + &gain * left;
    Ok((Estimate::new(&next, &gain, (p0, &h, noise)), step_m))
}

/// The truck after the greatest part of a step that lowers the sum of squares; where none does, that before it.
fn lowering(
    last: &Deviations,
    whole: Deviations,
    sum: impl Fn(&Deviations) -> Result<f64, VehicleError>,
) -> Result<Deviations, VehicleError> {
    let before = sum(last)?;
    let mut step = whole - last;
    for _ in 0..=HALVINGS {
        let next = last + step;
        if sum(&next).is_ok_and(|after| after < before - LOWER) {
            return Ok(next);
        }
        step *= 0.5;
    }
    Ok(*last)
}

/// The covariance of the ratios before they are used: what is known of the parameters, and the noise.
fn innovation(
    (p0, h, noise): (&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>),
    by_height: DMatrix<f64>,
) -> Result<Innovation, VehicleError> {
    Innovation::new(h * p0 * h.transpose() + noise, by_height).ok_or_else(singular)
}

/// `rᵀ R⁻¹ r`, and `xᵀ P0⁻¹ x` if the parameters `x` have a prior covariance `P0`.
fn sum_of_squares(
    left: &DVector<f64>,
    noise: DMatrix<f64>,
    prior: Option<(Deviations, &DMatrix<f64>)>,
) -> Result<f64, VehicleError> {
    let explained = noise.cholesky().map(|cholesky| cholesky.solve(left)).ok_or_else(singular)?;
    let of_noise = left.dot(&explained);
    Ok(prior.map_or(of_noise, |(x, p0)| add_moves(of_noise, x, p0.clone())))
}

/// Adds `xᵀ P⁻¹ x`, one parameter after the other: each counts apart from what those before it tell of it.
fn add_moves(sum: f64, mut x: Deviations, mut p: DMatrix<f64>) -> f64 {
    let before = p.diagonal();
    let mut sum = sum;
    for k in 0..PARAMETERS {
        let variance = p[(k, k)];
        // A parameter without prior variance does not change.
        if !(variance > KNOWN * before[k]) {
            continue;
        }
        sum += x[k] * x[k] / variance;
        for i in k + 1..PARAMETERS {
            let share = p[(i, k)] / variance;
            x[i] -= share * x[k];
            for j in k + 1..PARAMETERS {
                p[(i, j)] -= share * p[(k, j)];
            }
        }
    }
    sum
}

fn singular() -> VehicleError {
    VehicleError::Model(
        "the calibration is singular: give the vehicle file's [uncertainty] positive numbers"
            .to_owned(),
    )
}
