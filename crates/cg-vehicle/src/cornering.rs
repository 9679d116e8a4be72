//! How far the cornering stiffness of tires in a turn is from that of the linear model.
//!
//! A tire holds the less per slip angle the more it slips, and two tires hold less together if one of them
//! carries the load of both. Both effects depend on the lateral acceleration, so no linear tire is right in
//! every turn. What remains counts most where the steer angle of a turn is a small difference of slip angles.

use crate::balance::static_balance;
use crate::characteristics::Grip;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::linear::{Laden, SteadyLines};
use crate::load::Load;
use crate::vehicle::{PlacedAxle, Vehicle};

/// Lateral accelerations of usual drives, in g: both ends and the middle.
const TURNS_G: [f64; TURNS] = [0.06, 0.13, 0.2];
/// Number of such turns.
pub(crate) const TURNS: usize = 3;
/// Slip angle that no tire reaches in a usual turn, rad.
const GREATEST_SLIP_RAD: f64 = 0.3;
/// Number of halvings of that angle: to 1e-10 rad.
const HALVINGS: usize = 32;

/// Logarithms of the cornering stiffness of the steered axles, the tractor's other axles and the trailer's, over
/// that of the linear model.
pub(crate) type Softer = [f64; 3];

/// The cornering stiffness in usual turns of different lateral acceleration.
///
/// # Errors
/// As [`SteadyLines::new`].
pub(crate) fn softer_in_turns(
    vehicle: &Vehicle,
    load: Load,
) -> Result<[Softer; TURNS], VehicleError> {
    let laden = Laden::new(vehicle, Variant::Complete, load)?;
    let rolls = SteadyLines::at_speed(&laden, vehicle.nominal_speed_mps)?.axle_rolls();
    let balance = static_balance(vehicle, load)?;
    let axles: Vec<_> = vehicle.axles().into_iter().zip(balance.axle_load_n).zip(rolls).collect();
    Ok(TURNS_G.map(|lateral_g| {
        let mut sums = [[0.0; 2]; 3];
        for ((placed, load_n), rad_per_mps2) in &axles {
            let roll_rad = rad_per_mps2 * lateral_g * vehicle.gravity_mps2;
            let group = if placed.on_trailer { 2 } else { usize::from(!placed.steered) };
            sums[group][0] += secant(placed, *load_n, roll_rad, lateral_g);
            sums[group][1] += placed.tyres() * placed.tyre.stiffness_at(load_n / placed.tyres()).0;
        }
        sums.map(|[turning, linear]| libm::log(turning / linear))
    }))
}

/// Lateral force of an axle per slip angle at the angle that holds its load in a turn, N/rad.
fn secant(placed: &PlacedAxle<'_>, load_n: f64, roll_rad: f64, lateral_g: f64) -> f64 {
    let grip = Grip::new(placed.tyre, false);
    let pressed_n = load_n / placed.tyres();
    let force_n = |slip_rad: f64| {
        let positions_m = placed.axle.tyre_positions_m.iter();
        let loads_n = positions_m
            .flat_map(|&y| [y, -y])
            .map(|y| (pressed_n + y * roll_rad * placed.tyre.vertical_stiffness_n_per_m).max(0.0));
        // The force is opposite to the slip.
        -loads_n.map(|load_n| grip.at(slip_rad, load_n).0).sum::<f64>()
    };
    let (mut low_rad, mut high_rad) = (0.0, GREATEST_SLIP_RAD);
    for _ in 0..HALVINGS {
        let middle_rad = 0.5 * (low_rad + high_rad);
        if force_n(middle_rad) < lateral_g * load_n {
            low_rad = middle_rad;
        } else {
            high_rad = middle_rad;
        }
    }
    force_n(high_rad) / high_rad
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kraz() -> Vehicle {
        Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml"))
            .unwrap()
    }

    /// Without load transfer it is the secant of the slip table, which has the same straight lines between its
    /// nodes. With it the tires, whose grip grows less than their load, hold less.
    #[test]
    fn load_transfer_and_slip_make_an_axle_softer() {
        let vehicle = kraz();
        for placed in vehicle.axles() {
            let load_n = 20e3 * placed.tyres();
            let table = placed.tyre.lateral_force.as_ref().unwrap();
            for lateral_g in TURNS_G {
                let [_, expected] = table.slopes_n_per_rad(20e3, lateral_g).unwrap();
                let found = secant(&placed, load_n, 0.0, lateral_g) / placed.tyres();
                assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
                let leaning = secant(&placed, load_n, 0.01, lateral_g) / placed.tyres();
                assert!(leaning < found && leaning > 0.9 * found, "{leaning} {found}");
            }
        }
        let at = softer_in_turns(&vehicle, vehicle.reference_load()).unwrap();
        for group in 0..3 {
            let [gentle, usual, strong] = at.map(|softer| softer[group]);
            assert!(strong < usual && usual < gentle && gentle < 0.0 && strong > -0.3, "{at:?}");
        }
    }

    /// A force in proportion to slip and load is the same in every turn.
    #[test]
    fn tires_in_proportion_to_their_load_do_not_change() {
        let mut vehicle = kraz();
        for tyre in &mut vehicle.tyre {
            tyre.lateral_force = None;
            tyre.cornering_stiffness_n_per_rad =
                tyre.load_n.iter().map(|load_n| 6.0 * load_n).collect();
        }
        let at = softer_in_turns(&vehicle, vehicle.reference_load()).unwrap();
        assert!(at.iter().flatten().all(|by| by.abs() < 1e-8), "{at:?}");
    }
}
