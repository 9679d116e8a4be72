//! Parameters of the static stability factor of a rigid trailer: half track and unsprung mass; how far loads may stand
//! beside the middle; and the tightest turn.

use cg_core::RolloverDesign;
use cg_core::truck::rollover::TIGHTEST_MPS;

use super::roll_plane::RollPlane;
use crate::balance::static_balance;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The trailer is supported by its own axles and, through the fifth wheel, by the tractor's rear
/// axles. The effective half track is the mean of these axles, weighted with the trailer load that
/// each carries.
pub(crate) fn rollover(vehicle: &Vehicle, load: Load) -> Result<RolloverDesign<f64>, VehicleError> {
    let balance = static_balance(vehicle, load)?;
    let axles = vehicle.axles();
    let hitch_behind_m = vehicle.tractor.hitch_behind_cg_m;
    let middle_m = |positions_m: &[f64]| {
        #[allow(clippy::cast_precision_loss)] // one or two tires
        let n = positions_m.len() as f64;
        positions_m.iter().sum::<f64>() / n
    };
    let nearest_hitch = axles
        .iter()
        .filter(|placed| !placed.on_trailer)
        .min_by(|a, b| {
            let far = |placed: f64| (placed + hitch_behind_m).abs();
            far(a.position_m).total_cmp(&far(b.position_m))
        })
        .map_or(0.0, |placed| middle_m(&placed.axle.tyre_positions_m));
    let (mut moment, mut force_n) = (balance.hitch_load_n * nearest_hitch, balance.hitch_load_n);
    let (mut unsprung, mut center) = (0.0, 0.0);
    for (placed, load_n) in axles.iter().zip(&balance.axle_load_n) {
        if placed.on_trailer {
            moment += load_n * middle_m(&placed.axle.tyre_positions_m);
            force_n += load_n;
            unsprung += placed.axle.unsprung_mass_kg;
            center += placed.axle.unsprung_mass_kg * placed.axle.center_height_m;
        }
    }
    let vehicle = &*vehicle.with_springs_at(load)?;
    let tightest_turn_g = RollPlane::new(vehicle, load, TIGHTEST_MPS, 1.0)?.tightest_turn_g();
    Ok(RolloverDesign {
        tightest_turn_g,
        half_track_m: moment / force_n,
        unsprung_mass_kg: unsprung,
        unsprung_height_m: center / unsprung,
        payload_beside_sd_m: vehicle.uncertainty.payload_beside_sd_m,
    })
}
