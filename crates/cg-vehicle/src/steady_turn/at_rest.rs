//! The vehicle at rest, pulled sideways or on a tilting table, until its last inner wheel lifts.
//!
//! Both tests are the roll plane without a curve: every mass is pulled sideways in proportion to its
//! weight, and the wheels do not slide. On a table that is tilted by `φ`, the force across it is
//! `m g sin φ` and the weight on it is only `m g cos φ`. The springs and tires therefore extend and
//! raise the c.g., which is the drawback of the test (the thesis, 1.2.2):
//!
//! ```text
//!     side-pull ratio     α(g, h)              tilt-table ratio    tan φ = α(g cos φ, h + z)
//!     z                   (1 − cos φ) Σ F² c / Σ F      F load of a support of the trailer, c its compliance
//! ```
//!
//! `α` is the threshold of the roll plane in units of its own gravity. A rigid vehicle has `T/2h` in both.
//!
//! **Reference.** Chrstos and Guenther, *The Measurement of Static Rollover Metrics*, SAE 920582;
//! Winkler et al., *Repeatability of the Tilt-Table Test Method*, SAE 930832.

use super::roll_plane::RollPlane;
use crate::balance::static_balance;
use crate::characteristics::Envelope;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::{PlacedAxle, Vehicle};

/// At this speed a turn at the threshold has a radius of kilometers: no articulation, and the slip
/// angles within a group are equal.
const STRAIGHT_MPS: f64 = 100.0;
/// Number of iterations of the tilt; each reduces the error to a tenth or less.
const ROUNDS: usize = 30;
/// A change of the ratio below this ends the iteration.
const SETTLED: f64 = 1e-9;

/// Side-pull ratio: the greatest force that pulls the vehicle sideways, in proportion to its masses,
/// divided by its weight.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn side_pull_ratio(vehicle: &Vehicle, load: Load) -> Result<f64, VehicleError> {
    let vehicle = &*vehicle.with_springs_at(load)?;
    Ok(RollPlane::new(vehicle, load, STRAIGHT_MPS, 1.0)?.threshold_g(load.cg_height_m))
}

/// Tilt-table ratio: the tangent of the angle at which the vehicle tips.
///
/// # Errors
/// [`VehicleError`] if the load is impossible.
pub fn tilt_table_ratio(vehicle: &Vehicle, load: Load) -> Result<f64, VehicleError> {
    // The springs stay as they are on the level: a leveling valve does not follow the test.
    let level = vehicle.with_springs_at(load)?;
    let rise_m = rise_per_share_m(&level, load)?;
    let mut tilted = level.clone().into_owned();
    let mut ratio = side_pull_ratio(vehicle, load)?;
    for _ in 0..ROUNDS {
        let share = 1.0 / (1.0 + ratio * ratio).sqrt();
        tilted.gravity_mps2 = share * level.gravity_mps2;
        let plane = RollPlane::new(&tilted, load, STRAIGHT_MPS, 1.0)?;
        let next = plane.threshold_g(load.cg_height_m + (1.0 - share) * rise_m);
        let change = (next - ratio).abs();
        ratio = next;
        if change < SETTLED {
            break;
        }
    }
    Ok(ratio)
}

/// How far the trailer's c.g. would rise without any weight, if springs and tires stayed linear at
/// their load. Its position is the mean of those of its supports, weighted with their loads.
fn rise_per_share_m(vehicle: &Vehicle, load: Load) -> Result<f64, VehicleError> {
    let balance = static_balance(vehicle, load)?;
    let axles = vehicle.axles();
    let supports = |on_trailer: bool| {
        let of = move |(placed, _): &(&PlacedAxle<'_>, &f64)| {
            placed.on_trailer == on_trailer && !placed.steered
        };
        axles.iter().zip(&balance.axle_load_n).filter(of)
    };
    let rise_m = |placed: &PlacedAxle<'_>, load_n: f64| {
        let tyres_n_per_m = placed.tyres() * placed.tyre.vertical_stiffness_n_per_m;
        let sprung_n = load_n - placed.axle.unsprung_mass_kg * vehicle.gravity_mps2;
        let spring_n_per_m =
            vehicle.spring_of(placed.axle).map_or(placed.axle.spring_stiffness_n_per_m, |spring| {
                let envelope = Envelope::new(spring);
                envelope.middle(envelope.deflection_at(0.5 * sprung_n)).1
            });
        load_n / tyres_n_per_m + 0.5 * sprung_n / spring_n_per_m
    };
    // The fifth wheel rises with the axles below it.
    #[allow(clippy::cast_precision_loss)] // a few axles
    let count = supports(false).count().max(1) as f64;
    let at_hitch_m = supports(false).map(|(placed, n)| rise_m(placed, *n)).sum::<f64>() / count;
    let (mut moment, mut force_n) = (balance.hitch_load_n * at_hitch_m, balance.hitch_load_n);
    for (placed, load_n) in supports(true) {
        moment += load_n * rise_m(placed, *load_n);
        force_n += load_n;
    }
    Ok(moment / force_n)
}
