//! The cornering stiffness of tires in a turn.
//!
//! A tire holds the less per slip angle the more it slips, and two tires hold less together if one of them
//! carries the load of both. Both effects depend on the lateral acceleration, so no linear tire is right in
//! every turn. The linear model has the mean of usual turns, and the rest is part of the uncertainty. It counts most
//! where the steer angle of a turn is a small difference of slip angles.

use crate::characteristics::lateral_force_n;
use crate::vehicle::{PlacedAxle, Vehicle};

/// Lateral accelerations of usual drives, in g. Mean and variance of the three are those of turns that are distributed evenly
/// from 0.06 to 0.2 g (Chebyshev's quadrature).
pub(crate) const TURNS_G: [f64; TURNS] = [0.0805, 0.13, 0.1795];
/// Number of such turns.
pub(crate) const TURNS: usize = 3;
/// Slip angle of a gentle turn, rad, from which that of a turn is searched; and one at which tires slide.
const FIRST_SLIP_RAD: f64 = 0.01;
const GREATEST_SLIP_RAD: f64 = 0.3;
/// Share of a force to which its slip angle is found: nearly the rounding.
const SETTLED: f64 = 1e-12;
/// Number of steps that are more than enough, as the force increases by straight lines.
const MOST_STEPS: usize = 60;

/// Logarithms of the cornering stiffness of the steered axles, the tractor's other axles and the trailer's, over
/// that of the vehicle file at the static load.
pub(crate) type Softer = [f64; 3];

/// The cornering stiffness in turns of some lateral accelerations, at the static loads of the axles and their roll
/// angles per lateral acceleration, in rad/(m/s²).
pub(crate) fn softer_in<const N: usize>(
    vehicle: &Vehicle,
    (axle_load_n, rolls): (&[f64], &[f64]),
    turns_g: [f64; N],
) -> [Softer; N] {
    let mut turning = [[0.0; 3]; N];
    let mut of_file = [0.0; 3];
    for ((placed, load_n), rad_per_mps2) in vehicle.axles().iter().zip(axle_load_n).zip(rolls) {
        let group = group(placed);
        of_file[group] += placed.tyres() * placed.tyre.stiffness_at(load_n / placed.tyres()).0;
        for (turning, lateral_g) in turning.iter_mut().zip(turns_g) {
            let roll_rad = rad_per_mps2 * lateral_g * vehicle.gravity_mps2;
            turning[group] += secant(placed, *load_n, lateral_g * load_n, roll_rad);
        }
    }
    turning.map(|turning| std::array::from_fn(|group| libm::log(turning[group] / of_file[group])))
}

/// The mean of the turns.
#[allow(clippy::cast_precision_loss)] // three
pub(crate) fn mean(turns: &[Softer; TURNS]) -> Softer {
    std::array::from_fn(|group| {
        turns.iter().map(|softer| softer[group]).sum::<f64>() / TURNS as f64
    })
}

/// Index of an axle in [`Softer`].
pub(crate) fn group(placed: &PlacedAxle<'_>) -> usize {
    if placed.on_trailer { 2 } else { usize::from(!placed.steered) }
}

/// Lateral force of an axle per slip angle in the turn with such a force, N/rad, if it carries a load and rolls by an
/// angle.
fn secant(placed: &PlacedAxle<'_>, axle_load_n: f64, force_n: f64, roll_rad: f64) -> f64 {
    let tyre = placed.tyre;
    let sides = placed.axle.tyre_positions_m.iter().flat_map(|&y| [y, -y]);
    let loads_n: Vec<f64> = sides
        .map(|y| axle_load_n / placed.tyres() + y * roll_rad * tyre.vertical_stiffness_n_per_m)
        .map(|load_n| load_n.max(0.0))
        .collect();
    let held_n = |slip_rad: f64| -> f64 {
        loads_n.iter().map(|&load_n| lateral_force_n(tyre, slip_rad, load_n)).sum()
    };
    let slip_rad = slip_rad(force_n, held_n);
    held_n(slip_rad) / slip_rad
}

/// The slip angle that holds a lateral force, by the method of false position with its Illinois rule.
fn slip_rad(force_n: f64, held_n: impl Fn(f64) -> f64) -> f64 {
    let missing_n = |slip_rad: f64| held_n(slip_rad) - force_n;
    let (mut low, mut high) = ((0.0, -force_n), (FIRST_SLIP_RAD, missing_n(FIRST_SLIP_RAD)));
    while high.1 < 0.0 && high.0 < GREATEST_SLIP_RAD {
        let twice_rad = 2.0 * high.0;
        (low, high) = (high, (twice_rad, missing_n(twice_rad)));
    }
    // Tires that slide hold less.
    if high.1 < 0.0 || !(force_n > 0.0) {
        return high.0;
    }
    let mut kept_high = None;
    for _ in 0..MOST_STEPS {
        let slip_rad = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let missing = (slip_rad, missing_n(slip_rad));
        if !(missing.1.abs() > SETTLED * force_n) {
            return slip_rad;
        }
        // An end that stays twice counts half, so that it does not stay forever.
        let below = missing.1 < 0.0;
        let again = kept_high == Some(below);
        let share = if again { 0.5 } else { 1.0 };
        if below {
            (low, high.1) = (missing, share * high.1);
        } else {
            (low.1, high) = (share * low.1, missing);
        }
        kept_high = Some(below);
    }
    high.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::Variant;
    use crate::linear::Laden;

    fn kraz() -> Vehicle {
        Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml"))
            .unwrap()
    }

    /// What usual turns make of the tires that the file gives, and what they make of those of the linear model.
    fn softer(vehicle: &Vehicle) -> [[Softer; TURNS]; 2] {
        let laden = Laden::new(vehicle, Variant::Complete, vehicle.reference_load()).unwrap();
        [laden.clone().with_tires_of_the_file(), laden]
            .map(|laden| laden.softer_in(TURNS_G).unwrap())
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
                let force_n = lateral_g * load_n;
                let [found, leaning] = [0.0, 0.01]
                    .map(|roll_rad| secant(&placed, load_n, force_n, roll_rad) / placed.tyres());
                assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
                assert!(leaning < found && leaning > 0.9 * found, "{leaning} {found}");
            }
        }
        let [of_file, _] = softer(&vehicle);
        for group in 0..3 {
            let [gentle, usual, strong] = of_file.map(|softer| softer[group]);
            assert!(strong < usual && usual < gentle && gentle < 0.0 && strong > -0.3);
        }
    }

    /// The linear model of the reference load has the mean of the turns. Softer tires change how the axles roll a
    /// little, which changes the tires by less than a tenth of that.
    #[test]
    fn the_linear_model_has_the_mean_of_the_turns() {
        let [of_file, left] = softer(&kraz());
        let (mean_of_file, mean_left) = (mean(&of_file), mean(&left));
        for group in 0..3 {
            assert!(mean_left[group].abs() < 0.01 * mean_of_file[group].abs(), "{mean_left:?}");
            for (file, left) in of_file.iter().zip(&left) {
                let expected = file[group] - mean_of_file[group];
                assert!((left[group] - expected).abs() < 0.01 * mean_of_file[group].abs());
            }
        }
    }

    /// The model of one turn has its tires, except that the axles roll a little more with them.
    #[test]
    fn a_model_can_be_that_of_one_turn() {
        let vehicle = kraz();
        let laden = Laden::new(&vehicle, Variant::Complete, vehicle.reference_load()).unwrap();
        for lateral_g in TURNS_G {
            let [before] = laden.softer_in([lateral_g]).unwrap();
            let [left] = laden.clone().in_turn(lateral_g).unwrap().softer_in([lateral_g]).unwrap();
            for (before, left) in before.iter().zip(left) {
                assert!(left.abs() < 0.02 * before.abs() + 1e-6, "{lateral_g}: {left} {before}");
            }
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
        let at = softer(&vehicle);
        assert!(at.iter().flatten().flatten().all(|by| by.abs() < 1e-8), "{at:?}");
    }
}
