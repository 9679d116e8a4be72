//! What a bank that changes along the truck (road twist) does to its pairs.
//!
//! Each axle stands on a bank of its own. Where that changes by `β'` per meter, tractor and trailer roll against each other, and
//! the suspension rolls by a multiple of `β'` beside what it does under the same specific force on an even road.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use crate::balance::static_balance;
use crate::equations::{Equations, Variant, q, w};
use crate::error::VehicleError;
use crate::linear::Laden;
use crate::vehicle::{PlacedAxle, Vehicle};

/// What road twist does to the pair of a unit, and how the bank of the road under it follows from its sensors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PairOnTwist {
    /// Suspension roll that road twist adds to that of the same specific force on an even road, rad per rad/m.
    pub suspension_m: f64,
    /// Roll angle relative to the road over suspension roll on an even road.
    pub roll_of_suspension: f64,
    /// Slip angle of the axles per lateral acceleration that they feel, rad/(m/s²). The place above them moves sideways by it, so
    /// its lateral acceleration is yaw rate times speed less its rate times speed.
    pub slip_rad_per_mps2: f64,
}

/// What road twist does to the pairs of a truck with its reference load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RoadTwist {
    /// To that of the tractor.
    pub tractor: PairOnTwist,
    /// To that of the trailer.
    pub trailer: PairOnTwist,
    /// Distance from the fifth wheel to the middle of the trailer's axles, m.
    pub trailer_wheelbase_m: f64,
}

impl RoadTwist {
    /// That of a vehicle.
    ///
    /// The road rolls each axle by the roll stiffness of its tires times its own bank. In the lateral and yaw equations
    /// of a standing vehicle there is nothing of it.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let load = vehicle.reference_load();
        let laden = Laden::new(vehicle, Variant::Complete, load)?;
        let equations = Equations::of(&laden, vehicle.nominal_speed_mps)?;
        let axles = vehicle.axles();
        let on = |bank_rad: &dyn Fn(&PlacedAxle<'_>) -> f64| {
            let moment_nm =
                |axle: &PlacedAxle<'_>| axle.tyre_roll_stiffness_nm_per_rad() * bank_rad(axle);
            let moments = axles.iter().enumerate();
            equations.standing(moments.map(|(i, axle)| (w::AXLE + i, moment_nm(axle))))
        };
        let ahead_m = |axle: &PlacedAxle<'_>| {
            let ahead_m = axle.position_m + vehicle.tractor.hitch_behind_cg_m;
            if axle.on_trailer { -axle.position_m } else { ahead_m }
        };
        let (even, twisted) = (on(&|_| 1.0)?, on(&ahead_m)?);
        let slips = slips(vehicle, &laden)?;
        let [tractor, trailer] = [0, 1].map(|unit| {
            let roll = |angles: &DVector<f64>| equations.roll_at_force(unit).dot(angles);
            let suspension = |angles: &DVector<f64>| {
                angles[q::ROLL_1 + unit] - equations.mean_axle_roll(unit).dot(angles)
            };
            // Standing, the specific force is gravity times the roll angle.
            let ratio = suspension(&even) / roll(&even);
            PairOnTwist {
                suspension_m: suspension(&twisted) - ratio * roll(&twisted),
                roll_of_suspension: (roll(&even) - 1.0) / suspension(&even),
                slip_rad_per_mps2: slips[unit],
            }
        });
        Ok(Self { tractor, trailer, trailer_wheelbase_m: vehicle.trailer_wheelbase_m() })
    }
}

/// The slip angles of the axles under the sensors of tractor and trailer in usual turns. An axle bears its share of the mass,
/// also sideways.
fn slips(vehicle: &Vehicle, laden: &Laden<'_>) -> Result<[f64; 2], VehicleError> {
    let loads_n = static_balance(vehicle, vehicle.reference_load())?.axle_load_n;
    let [_, drive, trailer] = laden.motion().map_or([1.0; 3], |motion| motion.cornering);
    Ok([(false, drive), (true, trailer)].map(|(on_trailer, softer)| {
        let (mut mass_kg, mut cornering_n_per_rad) = (0.0, 0.0);
        for (i, placed) in vehicle.axles_of_unit(on_trailer) {
            let (of_tyre, _) = placed.tyre.stiffness_at(loads_n[i] / placed.tyres());
            mass_kg += loads_n[i] / vehicle.gravity_mps2;
            cornering_n_per_rad += placed.tyres() * softer * of_tyre;
        }
        mass_kg / cornering_n_per_rad
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::{TruckKind, template};
    use crate::linear::SteadyLines;
    use cg_core::Channel;

    fn truck() -> Vehicle {
        Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap()
    }

    /// On an even bank the truck stands as it drives through a curve, whose ratios are known: `φ/a = R`, `s/f = S/(1 + g R)`. They
    /// differ by what a lateral force does beside the weight, which acts at the height of the road and not of the axle.
    #[test]
    fn an_even_bank_rolls_the_truck_as_a_curve_does() {
        let truck = truck();
        let (twist, load) = (RoadTwist::of(&truck).unwrap(), truck.reference_load());
        let lines =
            SteadyLines::new(&truck, Variant::Complete, truck.nominal_speed_mps, load).unwrap();
        let [roll, pair] = [Channel::LateralAcceleration, Channel::Suspension]
            .map(|channel| lines.channel(channel).ratio_at(load.cg_height_m));
        let of_suspension = roll / (pair * (1.0 + truck.gravity_mps2 * roll));
        let error = twist.trailer.roll_of_suspension / of_suspension - 1.0;
        assert!(error.abs() < 0.02, "{error}");
    }

    /// A fifth wheel that transmits no moment leaves the trailer alone. The tractor then follows its front axle, and not the trailer
    /// behind it.
    #[test]
    fn only_the_fifth_wheel_twists_the_trailer() {
        let mut truck = truck();
        let usual = RoadTwist::of(&truck).unwrap();
        assert!(usual.trailer.suspension_m > 1.0 && usual.tractor.suspension_m < -1.0, "{usual:?}");
        truck.hitch.roll_stiffness_nm_per_rad *= 1e-6;
        let alone = RoadTwist::of(&truck).unwrap();
        let less = alone.trailer.suspension_m / usual.trailer.suspension_m;
        assert!(less.abs() < 1e-3, "{alone:?}");
        assert!(alone.tractor.suspension_m > 0.1, "{alone:?}");
    }

    /// An axle with twice the cornering stiffness slips half as far.
    #[test]
    fn stiffer_tires_slip_less() {
        let mut truck = truck();
        let usual = RoadTwist::of(&truck).unwrap();
        for tyre in &mut truck.tyre {
            for stiffness in &mut tyre.cornering_stiffness_n_per_rad {
                *stiffness *= 2.0;
            }
        }
        let stiffer = RoadTwist::of(&truck).unwrap();
        for (usual, stiffer) in [(usual.tractor, stiffer.tractor), (usual.trailer, stiffer.trailer)]
        {
            let share = stiffer.slip_rad_per_mps2 / usual.slip_rad_per_mps2;
            assert!((share - 0.5).abs() < 1e-3, "{share}");
            // Tires of trucks slip by half a degree to a degree per m/s².
            assert!((0.005..0.02).contains(&usual.slip_rad_per_mps2), "{usual:?}");
        }
    }
}
