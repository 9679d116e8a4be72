//! The friction of measured springs in the roll angle of each channel.

use cg_core::{CHANNELS, Channel, Friction, Input, Output};

use crate::balance::static_balance;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::linear::{SteadyLines, usual_roll_rad};
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The friction in the roll angle of each channel, at a load.
///
/// The springs of a unit act together on the roll angle of its suspension: `δ` is the sum of their moments
/// over the roll stiffness of the linear model, and `β` their mean, weighted by these moments. The
/// trailer's roll angle to the road contains that of the tires, which friction does not change.
///
/// # Errors
/// As [`SteadyLines::new`].
pub fn roll_friction(
    vehicle: &Vehicle,
    load: Load,
) -> Result<[Friction<f64>; CHANNELS], VehicleError> {
    if !vehicle.has_measured_springs() {
        return Ok([Friction::NONE; CHANNELS]);
    }
    let lines = SteadyLines::new(vehicle, Variant::Complete, vehicle.nominal_speed_mps, load)?;
    let roll = |output| lines.line(output, Input::LateralAcceleration).ratio_at(load.cg_height_m);
    let on_springs = roll(Output::SuspensionRoll) / roll(Output::Roll);
    let [tractor, trailer] = of_suspensions(vehicle, load)?;
    Ok(Channel::ALL.map(|channel| match channel.output() {
        Output::TractorSuspensionRoll => tractor,
        Output::SuspensionRoll => trailer,
        Output::Roll => Friction {
            usual_share: trailer.usual_share * on_springs,
            roll_rad: trailer.roll_rad,
            deflection_rad: trailer.deflection_rad / on_springs,
        },
    }))
}

/// The friction in the suspension roll of tractor and trailer.
fn of_suspensions(vehicle: &Vehicle, load: Load) -> Result<[Friction<f64>; 2], VehicleError> {
    let vehicle = &*vehicle.with_springs_at(load)?;
    let balance = static_balance(vehicle, load)?;
    let usual_rad = usual_roll_rad(vehicle, load.trailer_mass_kg)?;
    Ok([false, true].map(|on_trailer| {
        let amplitude_rad = usual_rad[usize::from(on_trailer)];
        let [mut stiffness, mut free, mut moment_nm, mut turns] = [0.0; 4];
        for (placed, &load_n) in vehicle.axles().iter().zip(&balance.axle_load_n) {
            if placed.on_trailer == on_trailer {
                stiffness += vehicle.roll_stiffness(placed, load_n, amplitude_rad, 1.0);
                free += vehicle.roll_stiffness(placed, load_n, amplitude_rad, 0.0);
                let (own_nm, deflection_rad) = vehicle.roll_friction(placed, load_n, amplitude_rad);
                moment_nm += own_nm;
                turns += own_nm * deflection_rad;
            }
        }
        if moment_nm > 0.0 && stiffness > free {
            Friction {
                usual_share: 1.0 - free / stiffness,
                roll_rad: moment_nm / stiffness,
                deflection_rad: turns / moment_nm,
            }
        } else {
            Friction::NONE
        }
    }))
}
