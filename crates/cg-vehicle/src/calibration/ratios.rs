//! The ratios of some runs, compared with those of the model.

use cg_core::{CHANNELS, Channel, Measured};
use nalgebra::{DMatrix, DVector};

use crate::belief::{Deviations, PARAMETERS, adjusted};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::lift::{LiftAxle, Positions};
use crate::linear::ratio_line;
use crate::load::Load;
use crate::ratio_spread::{
    STIFFNESSES, cornering_change, cornering_changes, height_change, log_ratios, mass_change,
    place_change, slow_sds, stiffness_variances,
};
use crate::vehicle::Vehicle;

/// The ratios that were identified from a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name of its log.
    pub log: String,
    /// Its load. A height that is not known is any possible one, from which the fit begins.
    pub load: Load,
    /// Standard deviation of its height, m; 0 is exact, and infinite not known.
    pub height_sd_m: f64,
    /// Standard deviation of its mass, kg; 0 is exact.
    pub trailer_mass_sd_kg: f64,
    /// Where the lift axles were.
    pub lift_axle: LiftAxle,
    /// Mean speed of its turns, m/s.
    pub speed_mps: f64,
    /// Lateral acceleration of its turns, g, which decides how soft the tires are; `None`: that of usual turns.
    pub turn_g: Option<f64>,
    /// Identified DC ratios and their standard deviations due to noise, in the order of
    /// [`Channel::ALL`]; `None` if the log does not have the signal.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Time since a trip that the truck made in service, s: the truck has changed since then, as a
    /// random walk. All such trips are alike, so they have the residual of the model in common. `None`
    /// for a run of a calibration.
    pub age_s: Option<f64>,
}

impl Run {
    /// Whether its height is known, exactly or not.
    pub fn height_is_known(&self) -> bool {
        self.height_sd_m.is_finite()
    }
}

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

/// What the model does not explain of an identified ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Misfit {
    /// Index of the run.
    pub run: usize,
    /// The channel.
    pub channel: Channel,
    /// Logarithm of the identified ratio divided by that of the model.
    pub log: f64,
    /// Variance from run to run that an interval has without a residual of the model: of the identification, of
    /// measured springs, of tires in turns, and of what is not known of the load.
    pub variance: f64,
}

/// The [misfits](Misfit) of runs of known height, with the vehicle as its file says.
///
/// # Errors
/// [`VehicleError`] if there is no ratio, or if a load is impossible for the model.
pub fn misfits(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &[Run],
) -> Result<Vec<Misfit>, VehicleError> {
    let ratios = Ratios::new((vehicle, variant), runs, 0.0)?;
    let (logs, slopes) = ratios.linearized(&Deviations::zeros())?;
    let noise = ratios.noise(&slopes)?;
    let of = |(k, o): (usize, &Observation)| Misfit {
        run: o.run,
        channel: o.channel,
        log: logs[k],
        variance: noise[(k, k)],
    };
    Ok(ratios.observations.iter().enumerate().map(of).collect())
}

/// One identified ratio.
pub(super) struct Observation {
    pub(super) run: usize,
    pub(super) channel: Channel,
    log_ratio: f64,
    variance: f64,
}

/// The ratios of some runs, and the model with which they are compared.
pub(super) struct Ratios<'a> {
    vehicle: Positions<'a>,
    variant: Variant,
    pub(super) runs: Vec<Run>,
    pub(super) observations: Vec<Observation>,
    residual_sd: f64,
}

impl<'a> Ratios<'a> {
    pub(super) fn new(
        (vehicle, variant): (&'a Vehicle, Variant),
        runs: &[Run],
        residual_sd: f64,
    ) -> Result<Self, VehicleError> {
        let observations = observations(runs)?;
        let vehicle = Positions::of(vehicle)?;
        runs.iter().try_for_each(|run| vehicle.at(run.lift_axle).map(drop))?;
        Ok(Self { vehicle, variant, runs: runs.to_vec(), observations, residual_sd })
    }

    /// Time since each ratio, s.
    pub(super) fn ages_s(&self) -> Vec<f64> {
        let age_s = |o: &Observation| self.runs[o.run].age_s.unwrap_or(0.0).max(0.0);
        self.observations.iter().map(age_s).collect()
    }

    /// What each ratio leaves unexplained without and with the calibration.
    pub(super) fn residuals(&self, [before, after]: [&DVector<f64>; 2]) -> Vec<Residual> {
        let residual = |(k, o): (usize, &Observation)| Residual {
            run: o.run,
            channel: o.channel,
            before: before[k],
            after: after[k],
        };
        self.observations.iter().enumerate().map(residual).collect()
    }

    /// What the ratios leave unexplained at a state of the parameters, and their slopes.
    pub(super) fn linearized(
        &self,
        mean: &Deviations,
    ) -> Result<(DVector<f64>, DMatrix<f64>), VehicleError> {
        let n = self.observations.len();
        let (mut misfit, mut h) = (DVector::zeros(n), DMatrix::zeros(n, PARAMETERS));
        let of_runs = self
            .runs
            .iter()
            .map(|run| {
                let turn = (run.speed_mps, run.turn_g);
                log_ratios(self.vehicle.at(run.lift_axle)?, self.variant, turn, run.load, mean).map_err(|error| {
                    VehicleError::Model(format!(
                        "{}: {error}; check the heights and masses of the runs, and whether their logs \
                         are of this vehicle",
                        run.log
                    ))
                })
            })
            .collect::<Result<Vec<_>, VehicleError>>()?;
        for (k, observation) in self.observations.iter().enumerate() {
            let (logs, slopes) = &of_runs[observation.run];
            misfit[k] = observation.log_ratio - logs[observation.channel.index()];
            h.row_mut(k).copy_from(&slopes[observation.channel.index()].transpose());
        }
        Ok((misfit, h))
    }

    /// Slopes of the logarithms of a run's ratios over its height, 1/m, in the order of [`Channel::ALL`].
    pub(super) fn height_slopes(
        &self,
        run: usize,
        mean: &Deviations,
    ) -> Result<[f64; CHANNELS], VehicleError> {
        let Run { speed_mps, load, lift_axle, .. } = self.runs[run];
        let vehicle = self.vehicle.at(lift_axle)?;
        let lines = ratio_line(&adjusted(vehicle, mean), self.variant, speed_mps, load)?;
        Ok(lines.map(|line| line.relative_slope_at(load.cg_height_m)))
    }

    /// Covariance of what no parameter explains: the noise of each ratio, the residual of the model, and
    /// in each run the roll stiffness of measured springs and what is not known of the load. `slopes` are
    /// those of the vehicle file.
    pub(super) fn noise(&self, slopes: &DMatrix<f64>) -> Result<DMatrix<f64>, VehicleError> {
        let Self { vehicle, runs, observations, residual_sd, .. } = self;
        let in_service = |run: usize| runs[run].age_s.is_some();
        let variances = observations.iter().map(|o| o.variance + residual_sd * residual_sd);
        let mut noise =
            DMatrix::from_diagonal(&DVector::from_iterator(observations.len(), variances));
        for (i, one) in observations.iter().enumerate() {
            for (j, other) in observations.iter().enumerate() {
                let alike = in_service(one.run) && in_service(other.run);
                if i != j && alike && one.channel == other.channel {
                    noise[(i, j)] += residual_sd * residual_sd;
                }
            }
        }
        // Slow turns of a truck have it all alike.
        let of_slowness = |o: &Observation| slow_sds(runs[o.run].speed_mps)[o.channel.index()];
        let slow = DVector::from_iterator(observations.len(), observations.iter().map(of_slowness));
        noise.ger(1.0, &slow, &slow, 1.0);
        let first_in_service = (0..runs.len()).find(|&run| in_service(run));
        for (run, Run { load, turn_g, lift_axle, .. }) in runs.iter().enumerate() {
            let vehicle = vehicle.at(*lift_axle)?;
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
            let by_turns = match *turn_g {
                Some(turn_g) => vec![cornering_change(vehicle, self.variant, *load, turn_g)?],
                None => cornering_changes(vehicle, self.variant, *load)?.to_vec(),
            };
            for change in by_turns {
                let by_turn = slopes * DVector::from_column_slice(change.as_slice());
                let moved = DVector::from_fn(observations.len(), |k, _| of_run(k) * by_turn[k]);
                noise.ger(1.0, &moved, &moved, 1.0);
            }
        }
        self.add_loads(&mut noise)?;
        Ok(noise)
    }

    /// Adds the place of the payload and the errors of its mass and its height, which are others in each run and the
    /// same for all ratios of a run.
    fn add_loads(&self, noise: &mut DMatrix<f64>) -> Result<(), VehicleError> {
        let Self { vehicle, variant, runs, observations, .. } = self;
        let variant = *variant;
        let file = Deviations::zeros();
        for (i, run) in runs.iter().enumerate() {
            let vehicle = vehicle.at(run.lift_axle)?;
            let weighed = (run.load, run.trailer_mass_sd_kg);
            let measured = (run.load, run.height_sd_m);
            for change in [
                place_change(vehicle, variant, run.speed_mps, run.load, &file)?,
                mass_change(vehicle, variant, run.speed_mps, weighed)?,
                height_change(vehicle, variant, run.speed_mps, measured)?,
            ] {
                let of_run =
                    |o: &Observation| if o.run == i { change[o.channel.index()] } else { 0.0 };
                let moved =
                    DVector::from_iterator(observations.len(), observations.iter().map(of_run));
                noise.ger(1.0, &moved, &moved, 1.0);
            }
        }
        Ok(())
    }
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
                log_ratio: libm::log(ratio.value),
                variance: ratio.relative_variance(),
            });
        }
    }
    if observations.is_empty() {
        return Err(VehicleError::Model("no run gave a ratio to calibrate with".to_owned()));
    }
    Ok(observations)
}
