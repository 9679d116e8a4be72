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
//! only. The form of `P` is valid for any gain, so the covariance remains correct.
//!
//! **Reference.** Tarantola, *Inverse Problem Theory*, §3.2 (Gauss-Newton on a Gaussian prior);
//! Gelb, *Applied Optimal Estimation*, §4.2 (covariance of a suboptimal gain).

use cg_core::{CHANNELS, Channel, Measured};
use nalgebra::{DMatrix, DVector};

use super::judgment::Judgment;
use super::walk::Walk;
use crate::belief::{
    Belief, Covariance, Deviations, PARAMETERS, Parameter, STIFFNESSES, log_ratios, place_change,
    stiffness_variances,
};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// Greatest number of Gauss-Newton steps. The ratios are nearly linear in the parameters, so three
/// are usually enough.
const STEPS: usize = 12;
/// A step below this (logarithm or meters) ends the iteration.
const SETTLED: f64 = 1e-10;

/// The ratios that were identified from a run with known height.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name of its log.
    pub log: String,
    /// Known load.
    pub load: Load,
    /// Mean speed of its turns, m/s.
    pub speed_mps: f64,
    /// Identified DC ratios and their standard deviations due to noise, in the order of
    /// [`Channel::ALL`]; `None` if the log does not have the signal.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Time since a trip that the truck made in service, s: the truck has changed since then, as a
    /// random walk. All such trips are alike, so they have the residual of the model in common. `None`
    /// for a run of a calibration.
    pub age_s: Option<f64>,
}

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
    MaximumAPosteriori => "maximum-a-posteriori", "all parameters of the truck";
    Compensation => "compensation", "the compensation R_c of each channel alone, from one run (the thesis)";
});

/// An identified ratio compared with that of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Residual {
    /// Index of the run.
    pub run: usize,
    /// The channel.
    pub channel: Channel,
    /// Logarithm of the identified ratio divided by the predicted one, for the vehicle file without
    /// calibration.
    pub before: f64,
    /// The same after calibration.
    pub after: f64,
}

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
    /// `rᵀ R⁻¹ r + xᵀ P0⁻¹ x` at the solution. If the standard deviations of prior and noise are
    /// correct, it is distributed as χ² with one degree of freedom per residual.
    pub chi_square: f64,
}

impl Fitted {
    /// Whether the runs are possible for the vehicle file.
    pub fn judgment(&self) -> Judgment {
        match self.procedure {
            // One factor for each ratio explains everything.
            Procedure::Compensation => Judgment::Sound,
            Procedure::MaximumAPosteriori => Judgment::of(self.chi_square, self.residuals.len()),
        }
    }

    /// Whether the runs that this fit has and an `earlier` one does not have are possible for the truck
    /// of the earlier one. The difference of both sums of squares is distributed as χ² with one degree
    /// of freedom for each ratio more.
    pub fn judgment_after(&self, earlier: &Self) -> Judgment {
        let more = self.residuals.len().saturating_sub(earlier.residuals.len());
        Judgment::of(self.chi_square - earlier.chi_square, more)
    }
}

fn check(procedure: Procedure, runs: &[Run]) -> Result<(), VehicleError> {
    let reason = match (procedure, runs) {
        (Procedure::MaximumAPosteriori, _) | (_, [Run { age_s: None, .. }]) => return Ok(()),
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
/// or if there is more than one run for [`Procedure::Compensation`].
pub fn fit(
    vehicle: &Vehicle,
    variant: Variant,
    procedure: Procedure,
    runs: &[Run],
) -> Result<Fitted, VehicleError> {
    check(procedure, runs)?;
    let prior = Belief::prior(vehicle);
    let observations = observations(runs)?;
    let linearized =
        |mean: &Deviations| linearized((vehicle, variant), (runs, &observations), mean);
    let p0 = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| prior.covariance[(i, j)]);
    let (before, slopes) = linearized(&prior.mean)?;
    let age_s = |o: &Observation| runs[o.run].age_s.unwrap_or(0.0).max(0.0);
    let walk = Walk::new(&p0, &observations.iter().map(age_s).collect::<Vec<_>>());
    let mut alone = noise(vehicle, (runs, &observations), &slopes)?;
    add_places(&mut alone, (vehicle, variant), (runs, &observations))?;
    let mut noise = alone.clone();
    let mut mean = prior.mean;
    let mut step = f64::INFINITY;
    let mut covariance = p0.clone();
    for _ in 0..STEPS {
        if step <= SETTLED {
            break;
        }
        let (misfit, h) = linearized(&mean)?;
        noise = walk.added_to(&alone, &h);
        let gain = match procedure {
            Procedure::Compensation => sensors_only(&observations),
            Procedure::MaximumAPosteriori => optimal_gain(&p0, &h, &noise)?,
        };
        let x = DVector::from_column_slice(mean.as_slice());
        let next = match procedure {
            Procedure::Compensation => &x + &gain * &misfit,
            Procedure::MaximumAPosteriori => &gain * (&misfit + &h * &x),
        };
        step = (&next - &x).amax();
        mean = Deviations::from_column_slice(next.as_slice());
        let rest = DMatrix::identity(PARAMETERS, PARAMETERS) - &gain * &h;
        covariance = &rest * &p0 * rest.transpose() + &gain * &noise * gain.transpose();
    }
    if !(step <= SETTLED.sqrt()) {
        return Err(VehicleError::Unsettled);
    }
    let (after, _) = linearized(&mean)?;
    let residuals = residuals(&observations, [&before, &after]);
    let prior_of = match procedure {
        Procedure::Compensation => None,
        Procedure::MaximumAPosteriori => Some((&mean, &p0)),
    };
    let chi_square = sum_of_squares(&after, noise, prior_of)?;
    let mut covariance = Covariance::from_fn(|i, j| covariance[(i, j)]);
    if walk.is_some() {
        let (misfit, h) = linearized(&mean)?;
        let left = misfit + &h * DVector::from_column_slice(mean.as_slice());
        let noise = walk.added_to(&alone, &h);
        (mean, covariance) = walk.carried(&p0, (&h, &left), &noise).ok_or_else(singular)?;
    }
    let covariance = Covariance::from_fn(|i, j| 0.5 * (covariance[(i, j)] + covariance[(j, i)]));
    let belief = Belief { mean, covariance, ..prior };
    Ok(Fitted { procedure, belief, residuals, chi_square })
}

fn residuals(observations: &[Observation], [before, after]: [&DVector<f64>; 2]) -> Vec<Residual> {
    let residual = |(k, o): (usize, &Observation)| Residual {
        run: o.run,
        channel: o.channel,
        before: before[k],
        after: after[k],
    };
    observations.iter().enumerate().map(residual).collect()
}

/// `rᵀ R⁻¹ r`, and `xᵀ P0⁻¹ x` if the parameters `x` have a prior covariance `P0`.
fn sum_of_squares(
    left: &DVector<f64>,
    noise: DMatrix<f64>,
    prior: Option<(&Deviations, &DMatrix<f64>)>,
) -> Result<f64, VehicleError> {
    let explained = noise.cholesky().map(|cholesky| cholesky.solve(left)).ok_or_else(singular)?;
    let of_noise = left.dot(&explained);
    Ok(prior.map_or(of_noise, |(x, p0)| {
        // A parameter without prior variance does not change.
        let moved = (0..PARAMETERS).filter(|&k| p0[(k, k)] > 0.0);
        moved.fold(of_noise, |sum, k| sum + x[k] * x[k] / p0[(k, k)])
    }))
}

/// Covariance of what no parameter explains: the noise of each ratio, the residual of the model, and
/// in each run the roll stiffness of measured springs.
fn noise(
    vehicle: &Vehicle,
    (runs, observations): (&[Run], &[Observation]),
    slopes: &DMatrix<f64>,
) -> Result<DMatrix<f64>, VehicleError> {
    let residual_sd = vehicle.uncertainty.residual_sd;
    let in_service = |run: usize| runs[run].age_s.is_some();
    let variances = observations.iter().map(|o| o.variance + residual_sd * residual_sd);
    let mut noise = DMatrix::from_diagonal(&DVector::from_iterator(observations.len(), variances));
    for (i, one) in observations.iter().enumerate() {
        for (j, other) in observations.iter().enumerate() {
            let alike = in_service(one.run) && in_service(other.run);
            if i != j && alike && one.channel == other.channel {
                noise[(i, j)] += residual_sd * residual_sd;
            }
        }
    }
    let first_in_service = (0..runs.len()).find(|&run| in_service(run));
    for (run, Run { load, .. }) in runs.iter().enumerate() {
        // Trips in service are alike, so this is common to all of them.
        if in_service(run) && Some(run) != first_in_service {
            continue;
        }
        let alike = |other: usize| other == run || in_service(run) && in_service(other);
        let of_run = |k: usize| f64::from(u8::from(alike(observations[k].run)));
        for (parameter, variance) in
            STIFFNESSES.into_iter().zip(stiffness_variances(vehicle, *load)?)
        {
            let moved = DVector::from_fn(observations.len(), |k, _| {
                of_run(k) * slopes[(k, parameter as usize)]
            });
            noise.ger(variance, &moved, &moved, 1.0);
        }
    }
    Ok(noise)
}

/// Adds the place of the payload, which is another one in each run and the same for all ratios of a run.
fn add_places(
    noise: &mut DMatrix<f64>,
    (vehicle, variant): (&Vehicle, Variant),
    (runs, observations): (&[Run], &[Observation]),
) -> Result<(), VehicleError> {
    let file = Deviations::zeros();
    for (i, run) in runs.iter().enumerate() {
        let by_place = place_change(vehicle, variant, run.speed_mps, run.load, &file)?;
        let moved = DVector::from_iterator(
            observations.len(),
            observations.iter().map(|o| if o.run == i { by_place[o.channel.index()] } else { 0.0 }),
        );
        noise.ger(1.0, &moved, &moved, 1.0);
    }
    Ok(())
}

/// What the observations leave unexplained at a state of the parameters, and their slopes.
fn linearized(
    (vehicle, variant): (&Vehicle, Variant),
    (runs, observations): (&[Run], &[Observation]),
    mean: &Deviations,
) -> Result<(DVector<f64>, DMatrix<f64>), VehicleError> {
    let n = observations.len();
    let (mut misfit, mut h) = (DVector::zeros(n), DMatrix::zeros(n, PARAMETERS));
    let of_runs = runs
        .iter()
        .map(|run| log_ratios(vehicle, variant, run.speed_mps, run.load, mean))
        .collect::<Result<Vec<_>, VehicleError>>()?;
    for (k, observation) in observations.iter().enumerate() {
        let (logs, slopes) = &of_runs[observation.run];
        misfit[k] = observation.log_ratio - logs[observation.channel.index()];
        h.row_mut(k).copy_from(&slopes[observation.channel.index()].transpose());
    }
    Ok((misfit, h))
}

/// One identified ratio.
struct Observation {
    run: usize,
    channel: Channel,
    log_ratio: f64,
    variance: f64,
}

fn observations(runs: &[Run]) -> Result<Vec<Observation>, VehicleError> {
    let mut observations = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        for channel in Channel::ALL {
            let Some(ratio) = run.ratio[channel.index()] else { continue };
            if !(ratio.value > 0.0 && ratio.sd.is_finite()) {
                return Err(VehicleError::Model(format!(
                    "{}: the identified ratio of the {channel} channel is {:.4}: roll and input \
                     have opposite signs; reverse the sign of a sensor with ⟨flip⟩",
                    run.log, ratio.value
                )));
            }
            observations.push(Observation {
                run: i,
                channel,
                log_ratio: ratio.value.ln(),
                variance: ratio.relative_variance(),
            });
        }
    }
    if observations.is_empty() {
        return Err(VehicleError::Model("no run gave a ratio to calibrate with".to_owned()));
    }
    Ok(observations)
}

/// The misfit of each channel changes the gain of its sensor only.
fn sensors_only(observations: &[Observation]) -> DMatrix<f64> {
    let mut gain = DMatrix::zeros(PARAMETERS, observations.len());
    for (k, observation) in observations.iter().enumerate() {
        let parameter = Parameter::of_input(observation.channel.input());
        gain[(parameter as usize, k)] = 1.0;
    }
    gain
}

fn optimal_gain(
    p0: &DMatrix<f64>,
    h: &DMatrix<f64>,
    noise: &DMatrix<f64>,
) -> Result<DMatrix<f64>, VehicleError> {
    let innovation = h * p0 * h.transpose() + noise;
    let solved = innovation.cholesky().map(|cholesky| cholesky.solve(&(h * p0)));
    solved.map(|gain| gain.transpose()).ok_or_else(singular)
}

fn singular() -> VehicleError {
    VehicleError::Model(
        "the calibration is singular: give the vehicle file's [uncertainty] positive numbers"
            .to_owned(),
    )
}
