//! The numbers that a calibration can have. A number beyond these limits is an error of a unit, or the
//! file is damaged.

use cg_core::Channel;

use crate::belief::{Covariance, PARAMETERS, Parameter};
use crate::calibration::entry::{Compensations, ParameterEntry, RunEntry, ShapeEntry, Unit};
use crate::calibration::shape_fit::{GREATEST_ORDER, is_possible};
use crate::limits::{GREATEST_HEIGHT_M, GREATEST_SPEED_MPS, GREATEST_TRAILER_MASS_KG, positive};

/// Factors of parameters, `R_c` included: degrees in place of radians are a factor of 57.
const FACTOR: [f64; 2] = [1e-3, 1e3];
/// Greatest shift of a height.
const GREATEST_SHIFT_M: f64 = GREATEST_HEIGHT_M;
/// Greatest standard deviation, relative or in meters. In a vehicle file, none is greater than 1.
const GREATEST_SD: f64 = 2.0;
/// Greatest standard deviation of a height that a run of unknown height gives: it tells nothing then.
const GREATEST_HEIGHT_SD_M: f64 = 1e3;
/// Greatest sum of squares; the Birge ratio of one run is then a thousand.
const GREATEST_CHI_SQUARE: f64 = 1e6;
/// Greatest lateral acceleration of turns, g; no truck comes near to it.
const GREATEST_TURN_G: f64 = 1.0;
/// Greatest DC ratio, rad per rad or per m/s²; usual ones are below 3.
const GREATEST_RATIO: f64 = 1e3;
/// The least eigenvalue of a covariance may be this far below zero by rounding.
const ROUNDING: f64 = 1e-12;

fn within(name: &str, value: f64, [least, greatest]: [f64; 2]) -> Result<(), String> {
    if (least..=greatest).contains(&value) {
        return Ok(());
    }
    Err(format!("{name} = {value} is impossible: it must lie between {least} and {greatest}"))
}

/// Checks the parameters and their covariance as a whole.
pub(super) fn parameters(
    parameters: &[ParameterEntry],
    covariance: &[Vec<f64>],
) -> Result<(), String> {
    let complete = parameters.len() == PARAMETERS
        && parameters.iter().zip(Parameter::ALL).all(|(entry, name)| entry.name == name)
        && covariance.len() == PARAMETERS
        && covariance.iter().all(|row| row.len() == PARAMETERS);
    if !complete {
        return Err(format!(
            "a calibration has {PARAMETERS} parameters in their order and a covariance of that size"
        ));
    }
    for (k, entry) in parameters.iter().enumerate() {
        let name = entry.name.words();
        if entry.unit != Unit::of(entry.name) {
            return Err(format!("the unit of {name} is wrong"));
        }
        match entry.unit {
            Unit::Factor => within(name, entry.value, FACTOR)?,
            Unit::M => within(name, entry.value, [-GREATEST_SHIFT_M, GREATEST_SHIFT_M])?,
        }
        for sd in [entry.sd, entry.prior_sd] {
            within(&format!("standard deviation of {name}"), sd, [0.0, GREATEST_SD])?;
        }
        let variance = covariance[k][k];
        within(&format!("variance of {name}"), variance, [0.0, GREATEST_SD * GREATEST_SD])?;
        within(&format!("determined share of {name}"), entry.determined, [-1e3, 1.0])?;
    }
    let matrix = Covariance::from_fn(|i, j| covariance[i][j]);
    // A sum with a number that is none is none, so the comparison fails.
    let asymmetry: f64 =
        (matrix - matrix.transpose()).iter().map(|difference| difference.abs()).sum();
    let positive = (matrix + Covariance::from_diagonal_element(ROUNDING)).cholesky().is_some();
    if !(asymmetry <= ROUNDING && positive) {
        return Err("the covariance is not symmetric and positive semidefinite".to_owned());
    }
    Ok(())
}

/// Checks `R_c` of each channel.
pub(super) fn compensations(of: &Compensations) -> Result<(), String> {
    [of.steer, of.lateral_acceleration, of.suspension, of.tractor]
        .into_iter()
        .try_for_each(|compensation| within("R_c", compensation, FACTOR))
}

/// Checks the rest of the model error and the sum of squares.
pub(super) fn misfit(residual_sd: f64, chi_square: f64) -> Result<(), String> {
    within("residual_sd", residual_sd, [0.0, 1.0])?;
    within("chi_square", chi_square, [0.0, GREATEST_CHI_SQUARE])
}

/// Checks a run.
pub(super) fn run(run: &RunEntry) -> Result<(), String> {
    let numbers = || {
        positive("height_m", run.height_m, GREATEST_HEIGHT_M)?;
        positive("trailer_mass_kg", run.trailer_mass_kg, GREATEST_TRAILER_MASS_KG)?;
        positive("speed_mps", run.speed_mps, GREATEST_SPEED_MPS)?;
        run.channel.iter().try_for_each(|entry| {
            positive("ratio", entry.ratio, GREATEST_RATIO)?;
            positive("model_ratio", entry.model_ratio, GREATEST_RATIO)
        })
    };
    numbers().map_err(|error| format!("run {}: {error}", run.log))?;
    within("trailer_mass_sd_kg", run.trailer_mass_sd_kg, [0.0, GREATEST_TRAILER_MASS_KG])?;
    within("known_height_sd_m", run.known_height_sd_m, [0.0, GREATEST_HEIGHT_M])?;
    if let Some(turn_g) = run.turn_g {
        within("turn_g", turn_g, [0.0, GREATEST_TURN_G])?;
    }
    if let Some(height_sd_m) = run.height_sd_m {
        within("height_sd_m", height_sd_m, [0.0, GREATEST_HEIGHT_SD_M])?;
    }
    run.channel.iter().try_for_each(|entry| {
        within("ratio_sd", entry.ratio_sd, [0.0, GREATEST_RATIO])?;
        [entry.before_percent, entry.after_percent]
            .into_iter()
            .try_for_each(|percent| within("percentage", percent, [-100.0, 1e8]))
    })
}

/// Checks the compensation functions: at most one for each channel, stable, minimum phase, `F(0) = 1`.
pub(super) fn shapes(shapes: &[ShapeEntry]) -> Result<(), String> {
    for (k, shape) in shapes.iter().enumerate() {
        let name = &shape.name;
        name.parse::<Channel>().map_err(|error| format!("shape: {error}"))?;
        if shapes[..k].iter().any(|other| other.name == *name) {
            return Err(format!("shape: {name} has two entries"));
        }
        let long = shape.order + 1;
        let has_length = [&shape.numerator, &shape.denominator].iter().all(|c| c.len() == long);
        if shape.order > GREATEST_ORDER || !has_length {
            return Err(format!(
                "shape: {name} must have an order of at most {GREATEST_ORDER}, and one \
                                coefficient more than that in numerator and denominator"
            ));
        }
        for percent in [shape.before_percent, shape.after_percent] {
            within(&format!("shape: percentage of {name}"), percent, [0.0, 1e8])?;
        }
        let Some((_, function)) = shape.function() else { continue };
        let leading = function.denominator.last().copied().unwrap_or(0.0);
        if !((leading - 1.0).abs() <= 0.0 && is_possible(&function).map_err(|e| e.to_string())?) {
            return Err(format!(
                "shape: F(s) of {name} is not stable, of minimum phase and one at s = 0"
            ));
        }
    }
    Ok(())
}
