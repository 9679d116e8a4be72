//! What another run would tell: the load with which it helps most.

use cg_core::{CHANNELS, Channel};
use nalgebra::{DMatrix, DVector};

use super::ratios::Run;
use crate::balance::greatest_mass_kg;
use crate::belief::{Belief, Covariance, PARAMETERS};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::load::Load;
use crate::ratio_spread::Changes;
use crate::vehicle::Vehicle;

/// Relative standard deviation by noise of a usual ratio.
const NOISE_SD: f64 = 0.005;
/// A run that leaves more than this share of the standard deviation is not worth it.
const WORTH: f64 = 0.9;

/// A line on the run that would help most, at the nominal speed: empty, half full or full. It counts
/// what it does to the least certain of these loads, in the best of the channels that the runs have.
pub(super) fn advice(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &[Run],
    belief: &Belief,
) -> Result<Option<String>, VehicleError> {
    if variant != Variant::Complete {
        return Ok(None); // known at one load only
    }
    let (empty_kg, full_kg) = (vehicle.empty_trailer_mass_kg(), greatest_mass_kg(vehicle));
    let reference_m = vehicle.reference_load().cg_height_m;
    let loads = [
        (empty_kg, vehicle.trailer.tare.cg_height_m),
        (0.5 * (empty_kg + full_kg), reference_m),
        (full_kg, reference_m),
    ]
    .map(|(trailer_mass_kg, cg_height_m)| Load { trailer_mass_kg, cg_height_m });
    let used =
        Channel::ALL.map(|channel| runs.iter().any(|run| run.ratio[channel.index()].is_some()));
    let at = |load| {
        let speeds_mps = [vehicle.nominal_speed_mps];
        Ok((load, Changes::new(vehicle, variant, speeds_mps, load, &belief.mean)?))
    };
    let changes = loads.into_iter().map(at).collect::<Result<Vec<_>, VehicleError>>()?;
    let worst = |belief: &Belief| {
        let mut worst = (0.0, loads[0]);
        for (load, changes) in &changes {
            let [covariance] = changes.covariances(belief);
            let sds = (0..CHANNELS).filter(|&k| used[k]).map(|k| covariance[k][k].sqrt());
            let sd = sds.fold(f64::INFINITY, f64::min);
            if sd > worst.0 {
                worst = (sd, *load);
            }
        }
        worst
    };
    let (now, load) = worst(belief);
    let mut best = (now, loads[0]);
    for (load, changes) in &changes {
        let (then, _) = worst(&after(belief, changes, used));
        if then < best.0 {
            best = (then, *load);
        }
    }
    let least_certain = format!("{:.1} t", load.trailer_mass_kg / 1e3);
    Ok(Some(if best.0 > WORTH * now {
        format!(
            "the ratio is known to {:.1} % or better at all loads; another run would hardly change it",
            100.0 * now
        )
    } else {
        format!(
            "another run would help most with a trailer of {:.1} t: the ratio is now known to {:.1} % at {least_certain}, where it is \
             least certain, and would then be known to {:.1} % or better at all loads",
            best.1.trailer_mass_kg / 1e3,
            100.0 * now,
            100.0 * best.0,
        )
    }))
}

/// The belief after one more run with a load at which the ratios change like this, in these channels.
fn after(belief: &Belief, changes: &Changes<1>, used: [bool; CHANNELS]) -> Belief {
    let ([(_, slopes)], [by_place]) = (&changes.of_parameters, &changes.by_place);
    let rows: Vec<usize> = (0..CHANNELS).filter(|&k| used[k]).collect();
    let h = DMatrix::from_fn(rows.len(), PARAMETERS, |i, j| slopes[rows[i]][j]);
    let p = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| belief.covariance[(i, j)]);
    let variance = belief.residual_sd * belief.residual_sd + NOISE_SD * NOISE_SD;
    let mut noise = DMatrix::from_diagonal(&DVector::from_element(rows.len(), variance));
    let moved = DVector::from_iterator(rows.len(), rows.iter().map(|&k| by_place[k]));
    noise.ger(1.0, &moved, &moved, 1.0);
    let innovation = (&h * &p * h.transpose() + noise).cholesky();
    let told = innovation.map_or_else(
        || DMatrix::zeros(PARAMETERS, PARAMETERS),
        |innovation| &p * h.transpose() * innovation.solve(&(&h * &p)),
    );
    let covariance = Covariance::from_fn(|i, j| p[(i, j)] - 0.5 * (told[(i, j)] + told[(j, i)]));
    Belief { covariance, ..belief.clone() }
}
