//! Which uncertain parameters matter most for the height.
//!
//! The height follows from a DC ratio `R(h, p)`. If a parameter differs from its assumed value by
//! `δp`, the height that explains the same ratio differs by `δh = −(∂ln R/∂p)/(∂ln R/∂h) δp`.

use cg_core::{CHANNELS, Channel};

use crate::belief::{Belief, PARAMETERS, Parameter};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::linear::ratio_line;
use crate::load::Load;
use crate::ratio_spread::log_ratios;
use crate::vehicle::Vehicle;

/// What a parameter contributes to the uncertainty of the height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Influence {
    /// The parameter.
    pub parameter: Parameter,
    /// Its standard deviation: relative for a factor, otherwise in meters.
    pub sd: f64,
    /// Standard deviation of the height due to this parameter alone, relative to the height, in the
    /// order of [`Channel::ALL`].
    pub height_sd: [f64; CHANNELS],
}

/// What all parameters contribute.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Influences {
    /// All parameters, beginning with the one that matters most: that with the greatest root mean
    /// square over the channels.
    pub parameters: Vec<Influence>,
    /// Standard deviation of the height due to the model and the sensors' gains, relative to the
    /// height: all parameters, measured springs, the place of the payload and the rest of the model error.
    pub height_sd: [f64; CHANNELS],
}

/// The influence of every uncertain parameter on the height of a load, at a speed.
///
/// # Errors
/// [`VehicleError`] if the model has no positive steady-state roll angle, or if a ratio does not
/// depend on the height.
pub fn influences(
    vehicle: &Vehicle,
    belief: &Belief,
    speed_mps: f64,
    load: Load,
) -> Result<Influences, VehicleError> {
    let variant = Variant::Complete;
    let (_, slopes) = log_ratios(vehicle, variant, (speed_mps, None), load, &belief.mean)?;
    let per_height = height_slopes(&belief.applied_to(vehicle), speed_mps, load)?;
    let relative = per_height.map(|slope| 1.0 / (slope * load.cg_height_m).abs());
    let covariance = belief.ratio_covariance(vehicle, variant, speed_mps, load)?;
    let mut parameters: Vec<Influence> = (0..PARAMETERS)
        .map(|k| {
            let sd = belief.covariance[(k, k)].sqrt();
            let height_sd = std::array::from_fn(|i| (slopes[i][k] * sd * relative[i]).abs());
            Influence { parameter: Parameter::ALL[k], sd, height_sd }
        })
        .collect();
    let square = |one: &Influence| one.height_sd.iter().map(|sd| sd * sd).sum::<f64>();
    parameters.sort_by(|a, b| square(b).total_cmp(&square(a)));
    let height_sd = std::array::from_fn(|i| covariance[i][i].sqrt() * relative[i]);
    Ok(Influences { parameters, height_sd })
}

/// `∂ln R/∂h` of all channels, 1/m.
fn height_slopes(
    vehicle: &Vehicle,
    speed_mps: f64,
    load: Load,
) -> Result<[f64; CHANNELS], VehicleError> {
    let lines = ratio_line(vehicle, Variant::Complete, speed_mps, load)?;
    let slopes = lines.map(|line| line.relative_slope_at(load.cg_height_m));
    for channel in Channel::ALL {
        let slope = slopes[channel.index()];
        if slope == 0.0 || !slope.is_finite() {
            return Err(VehicleError::Model(format!(
                "the ratio of the channel {channel} does not depend on the height"
            )));
        }
    }
    Ok(slopes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::adjusted;
    use crate::guide::{TruckKind, template};
    use crate::linear::{Laden, ratio_line_at};

    /// The height that explains the ratio of a changed truck, found by bisection. The changed truck's tires are as
    /// soft in usual turns as those of the unchanged one, which the slopes leave out as well.
    #[test]
    fn a_changed_truck_is_mistaken_for_another_height() {
        let vehicle = Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap();
        let (load, speed_mps) = (vehicle.reference_load(), 15.0);
        let mut belief = Belief::prior(&vehicle);
        belief.covariance *= 1e-6; // small deviations, for which the slopes are exact to 1e-3
        let found = influences(&vehicle, &belief, speed_mps, load).unwrap();
        let unchanged = Laden::new(&vehicle, Variant::Complete, load).unwrap();
        let softness = unchanged.motion().map(|motion| motion.cornering);
        let lines = ratio_line_at(&unchanged, speed_mps).unwrap();
        for one in found.parameters.iter().filter(|one| one.parameter as usize <= 8) {
            let mut deviations = belief.mean;
            deviations[one.parameter as usize] = one.sd;
            let truck = adjusted(&vehicle, &deviations);
            let changed = Laden::with_tires(&truck, Variant::Complete, load, softness).unwrap();
            let changed = ratio_line_at(&changed, speed_mps).unwrap();
            for i in 0..CHANNELS {
                let wanted = changed[i].ratio_at(load.cg_height_m);
                let (mut low, mut high) = (0.9 * load.cg_height_m, 1.1 * load.cg_height_m);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let above = lines[i].ratio_at(middle) > wanted;
                    let rising = lines[i].ratio_at(high) > lines[i].ratio_at(low);
                    if above == rising { high = middle } else { low = middle }
                }
                let moved = (0.5 * (low + high) / load.cg_height_m - 1.0).abs();
                // Both sides are differences of numbers with 12 digits.
                let close = (moved - one.height_sd[i]).abs() <= 2e-3 * moved + 1e-9;
                assert!(close, "{:?} {i}: {moved} {}", one.parameter, one.height_sd[i]);
            }
        }
    }
}
