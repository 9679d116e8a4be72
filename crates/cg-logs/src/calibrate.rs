//! Calibration from logs with a known height.
//!
//! The runs are identified with the design, and the calibration changes the design. The calibration
//! is therefore done twice.

use std::str::FromStr;

use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::{Calibration, Run, fit};
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

use crate::estimate::{EstimateOptions, LogEstimator};
use crate::malformed::Malformed;

/// Number of passes. A further pass would change the result by less than 0.1 %.
const PASSES: usize = 2;

/// A log with a known height.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownLog {
    /// Name of the log.
    pub log: String,
    /// Height of the c.g. of the trailer's sprung mass, m.
    pub height_m: f64,
    /// Mass of the whole semitrailer, kg; `None` uses the mass in the log.
    pub trailer_mass_kg: Option<f64>,
}

/// Reads `LOG=HEIGHT_M[,TRAILER_MASS_KG]`.
impl FromStr for KnownLog {
    type Err = Malformed;

    fn from_str(text: &str) -> Result<Self, Malformed> {
        let form = "expected LOG=HEIGHT_M or LOG=HEIGHT_M,TRAILER_MASS_KG";
        let (log, load) = text.rsplit_once('=').ok_or(form)?;
        let (height, mass) = match load.split_once(',') {
            Some((height, mass)) => (height, Some(mass)),
            None => (load, None),
        };
        let positive = |name: &str, text: &str| {
            text.trim()
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite() && *value > 0.0)
                .ok_or_else(|| format!("{name} \"{text}\" is not a positive number; {form}"))
        };
        if log.is_empty() {
            return Err(form.into());
        }
        Ok(Self {
            log: log.to_owned(),
            height_m: positive("height", height)?,
            trailer_mass_kg: mass.map(|mass| positive("trailer mass", mass)).transpose()?,
        })
    }
}

/// Calibrates a vehicle with logs. `feed` passes the rows of a log to the given estimator.
///
/// # Errors
/// The errors of `feed`, and [`VehicleError`] if a log is given twice, if it has no turn or no
/// trailer mass, or if its load is impossible for the vehicle.
pub fn calibrate<E: From<VehicleError>>(
    vehicle: &Vehicle,
    variant: Variant,
    logs: &[KnownLog],
    mut feed: impl FnMut(&KnownLog, &mut LogEstimator) -> Result<(), E>,
) -> Result<Calibration, E> {
    check(vehicle, logs)?;
    let mut belief = Belief::prior(vehicle);
    let mut outcome = None;
    for _ in 0..PASSES {
        let mut design = design_with(vehicle, variant, &belief)?;
        // The height is known and only the ratio is needed, so no height is rejected.
        design.least_height_m = -1e3;
        design.greatest_height_m = 1e3;
        let mut runs = Vec::with_capacity(logs.len());
        for known in logs {
            let options = EstimateOptions {
                variant,
                trailer_mass_kg: known.trailer_mass_kg,
                ..EstimateOptions::default()
            }
            .on_roads_of(vehicle);
            let mut estimator =
                LogEstimator::from_design(&design, vehicle.align_settings(), options);
            feed(known, &mut estimator)?;
            runs.push(run(vehicle, known, estimator)?);
        }
        let fitted = fit(vehicle, variant, &runs)?;
        belief = fitted.belief.clone();
        outcome = Some((runs, fitted));
    }
    let (runs, fitted) = outcome.ok_or_else(|| VehicleError::Model("no pass".to_owned()))?;
    Ok(Calibration::new(vehicle, variant, &runs, &fitted)?)
}

/// Checks what can be checked before a log is read.
fn check(vehicle: &Vehicle, logs: &[KnownLog]) -> Result<(), VehicleError> {
    let (least_m, greatest_m) = (vehicle.height.least_m, vehicle.height.greatest_m);
    for (i, known) in logs.iter().enumerate() {
        if !(least_m..=greatest_m).contains(&known.height_m) {
            return Err(VehicleError::Model(format!(
                "{}: height {} m is outside the vehicle file's range {least_m} to {greatest_m} m",
                known.log, known.height_m
            )));
        }
        if logs[..i].iter().any(|other| other.log == known.log) {
            return Err(VehicleError::Model(format!("{}: given twice", known.log)));
        }
        if let Some(trailer_mass_kg) = known.trailer_mass_kg {
            vehicle.trailer_sprung_mass(Load { trailer_mass_kg, cg_height_m: known.height_m })?;
        }
    }
    Ok(())
}

fn run(vehicle: &Vehicle, known: &KnownLog, estimator: LogEstimator) -> Result<Run, VehicleError> {
    let identified = estimator.identified();
    if !identified.trailer_mass_is_known {
        return Err(VehicleError::Model(format!(
            "{}: the log has no trailer mass; give it with the run's height (on the command line \
             LOG=HEIGHT_M,TRAILER_MASS_KG)",
            known.log
        )));
    }
    if identified.ratio.iter().all(Option::is_none) {
        return Err(VehicleError::Model(format!(
            "{}: no ratio can be identified: {}",
            known.log,
            identified.messages.join("; ")
        )));
    }
    let load = Load { trailer_mass_kg: identified.trailer_mass_kg, cg_height_m: known.height_m };
    vehicle.trailer_sprung_mass(load)?;
    Ok(Run {
        log: known.log.clone(),
        load,
        speed_mps: identified.speed_mps,
        ratio: identified.ratio,
    })
}
